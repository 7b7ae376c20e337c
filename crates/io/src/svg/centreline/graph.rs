//! Thinned pixels as a graph: nodes where lines end or meet, and lines between them.

use std::collections::BTreeMap;

use arabesque_core::{Vector, polyline_length};

use super::raster::Raster;

/// Rounds of pruning and merging at most.
const ROUNDS: usize = 32;

/// A line between two nodes, or a closed one.
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// Node at the start and at the end; `None` for a closed line.
    pub(super) nodes: Option<[usize; 2]>,
    /// From node to node, both points included; a closed line does not repeat its first point.
    pub(super) points: Vec<Vector<2>>,
}

impl Line {
    pub(super) fn length(&self) -> f64 {
        let open = polyline_length(&self.points);
        let seam = self.points.last().zip(self.points.first()).map_or(0.0, |(a, b)| (*b - *a).norm());
        if self.nodes.is_none() { open + seam } else { open }
    }

    /// The same line the other way round.
    pub(super) fn reversed(&self) -> Self {
        let points = self.points.iter().rev().copied().collect();
        Self { nodes: self.nodes.map(|[a, b]| [b, a]), points }
    }
}

/// Nodes and lines.
#[derive(Clone, Debug, Default)]
pub(super) struct Graph {
    pub(super) nodes: Vec<Vector<2>>,
    pub(super) lines: Vec<Line>,
}

impl Graph {
    /// The graph of a thinned raster.
    pub(super) fn trace(raster: &Raster) -> Self {
        let mut graph = Self::default();
        let node_of = graph.find_nodes(raster);
        let mut visited = vec![false; raster.ink.len()];
        for (&pixel, &node) in &node_of {
            for start in raster.neighbours(pixel) {
                if !visited[start] && !node_of.contains_key(&start) {
                    graph.follow(raster, &node_of, &mut visited, ([pixel, start], Some(node)));
                }
            }
        }
        for pixel in raster.pixels() {
            if !visited[pixel] && !node_of.contains_key(&pixel) {
                graph.follow(raster, &node_of, &mut visited, ([pixel, pixel], None));
            }
        }
        graph
    }

    /// Pixels that have not two neighbours; those that touch are one node, at their mean.
    fn find_nodes(&mut self, raster: &Raster) -> BTreeMap<usize, usize> {
        let is_node = |p: usize| raster.neighbours(p).count() != 2;
        let mut node_of = BTreeMap::new();
        for pixel in raster.pixels().into_iter().filter(|&p| is_node(p)) {
            if node_of.contains_key(&pixel) {
                continue;
            }
            let node = self.nodes.len();
            let (mut open, mut members) = (vec![pixel], Vec::new());
            node_of.insert(pixel, node);
            while let Some(p) = open.pop() {
                members.push(raster.centre(p));
                for q in raster.neighbours(p).filter(|&q| is_node(q)) {
                    if node_of.insert(q, node).is_none() {
                        open.push(q);
                    }
                }
            }
            let sum = members.iter().fold(Vector::ZERO, |sum, &p| sum + p);
            self.nodes.push(sum * (1.0 / members.len() as f64));
        }
        node_of
    }

    /// Follows a line from a node, or around, until it meets a node or itself.
    fn follow(
        &mut self,
        raster: &Raster,
        node_of: &BTreeMap<usize, usize>,
        visited: &mut [bool],
        ([mut before, mut here], from): ([usize; 2], Option<usize>),
    ) {
        let mut points: Vec<_> = from.map(|node| self.nodes[node]).into_iter().collect();
        loop {
            visited[here] = true;
            points.push(raster.centre(here));
            let onward =
                raster.neighbours(here).filter(|&p| p != before && (from.is_some() || !node_of.contains_key(&p)));
            // A node ends the line, even where an unvisited pixel lies beside it.
            let next: Vec<usize> = onward.filter(|p| node_of.contains_key(p) || !visited[*p]).collect();
            if let Some(&node) = next.iter().find_map(|p| node_of.get(p)).filter(|_| from.is_some()) {
                points.push(self.nodes[node]);
                self.lines.push(Line { nodes: from.map(|from| [from, node]), points });
                return;
            }
            let Some(&p) = next.first() else {
                // Only closed lines run out of pixels; a line that comes back to its own first node pixel ends there.
                let nodes = from.map(|node| [node, node]);
                points.extend(from.map(|node| self.nodes[node]));
                self.lines.push(Line { nodes, points });
                return;
            };
            (before, here) = (here, p);
        }
    }

    /// Lines at each node: index and whether the line ends (not starts) there.
    pub(super) fn incidence(&self) -> Vec<Vec<(usize, bool)>> {
        let mut at = vec![Vec::new(); self.nodes.len()];
        for (k, line) in self.lines.iter().enumerate() {
            if let Some([a, b]) = line.nodes {
                at[a].push((k, false));
                at[b].push((k, true));
            }
        }
        at
    }

    /// Takes away spurs, short loops and nodes that are none; merges junctions that `is_short` lines join.
    /// `is_spur` is asked of lines from a junction to a free end, in this direction.
    pub(super) fn tidy(&mut self, width: f64, is_spur: impl Fn(&Line) -> bool, is_short: impl Fn(&Line) -> bool) {
        for _ in 0..ROUNDS {
            self.lines.retain(|l| l.length() > 2.5 * width || l.nodes.is_some_and(|[a, b]| a != b));
            let changed = self.prune(&is_spur) | self.dissolve() | self.merge(&is_short);
            if !changed {
                break;
            }
        }
    }

    /// Takes away the shortest spur at each junction.
    fn prune(&mut self, is_spur: &impl Fn(&Line) -> bool) -> bool {
        let at = self.incidence();
        let mut gone = vec![false; self.lines.len()];
        for lines in at.iter().filter(|lines| lines.len() >= 3) {
            let spur = |&&(k, ends): &&(usize, bool)| {
                let other = self.lines[k].nodes.map(|[a, b]| if ends { a } else { b });
                other.is_some_and(|node| at[node].len() == 1)
                    && if ends { is_spur(&self.lines[k].reversed()) } else { is_spur(&self.lines[k]) }
            };
            let by_length =
                |a: &&(usize, bool), b: &&(usize, bool)| self.lines[a.0].length().total_cmp(&self.lines[b.0].length());
            if let Some((k, _)) = lines.iter().filter(spur).min_by(by_length) {
                gone[*k] = true;
            }
        }
        self.drop_lines(&gone)
    }

    fn drop_lines(&mut self, gone: &[bool]) -> bool {
        let mut k = 0;
        self.lines.retain(|_| {
            k += 1;
            !gone[k - 1]
        });
        gone.contains(&true)
    }

    /// Joins the two lines at every node of degree two.
    fn dissolve(&mut self) -> bool {
        let mut changed = false;
        let mut at = self.incidence();
        for node in 0..self.nodes.len() {
            let [(i, i_ends), (j, j_ends)] = at[node][..] else { continue };
            changed = true;
            at[node].clear();
            if i == j {
                let line = &mut self.lines[i];
                line.nodes = None;
                line.points.pop();
                continue;
            }
            let mut joined = if i_ends { self.lines[i].clone() } else { self.lines[i].reversed() };
            let rest = if j_ends { self.lines[j].reversed() } else { self.lines[j].clone() };
            let (Some([start, _]), Some([_, end])) = (joined.nodes, rest.nodes) else { continue };
            joined.points.extend(rest.points.iter().skip(1));
            joined.nodes = Some([start, end]);
            self.lines[i] = joined;
            self.lines[j] = Line { nodes: None, points: Vec::new() };
            for far in [start, end] {
                at[far].retain(|&(k, _)| k != j && k != i);
            }
            at[start].push((i, false));
            at[end].push((i, true));
        }
        self.lines.retain(|l| !l.points.is_empty());
        changed
    }

    /// Makes one node of two junctions that a short line joins.
    fn merge(&mut self, is_short: &impl Fn(&Line) -> bool) -> bool {
        let degree: Vec<usize> = self.incidence().iter().map(Vec::len).collect();
        let mut renamed: Vec<usize> = (0..self.nodes.len()).collect();
        // One merge a node and round keeps the names simple; the rounds do the rest.
        let mut taken = vec![false; self.nodes.len()];
        let mut gone = vec![false; self.lines.len()];
        for (k, line) in self.lines.iter().enumerate() {
            let Some([a, b]) = line.nodes else { continue };
            if a != b && degree[a].min(degree[b]) >= 3 && !taken[a] && !taken[b] && is_short(line) {
                (renamed[b], taken[a], taken[b], gone[k]) = (a, true, true, true);
                self.nodes[a] = (self.nodes[a] + self.nodes[b]) * 0.5;
            }
        }
        for line in &mut self.lines {
            let Some(nodes) = &mut line.nodes else { continue };
            *nodes = nodes.map(|n| renamed[n]);
            let [a, b] = nodes.map(|n| self.nodes[n]);
            if let [first, .., last] = line.points.as_mut_slice() {
                (*first, *last) = (a, b);
            }
        }
        self.drop_lines(&gone)
    }
}
