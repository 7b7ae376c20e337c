//! An exemplar as a sheet of squared paper.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Budget, Curve, Element, Exemplar, Result, Role, Ruling, Vector, corners, ruling};

use crate::{
    orderly::ruled::star::{CROSSED, Look, Star, beside, opposite},
    repeat::lattice::{Lattice, Node},
};

/// How far a thing may lie from its node, as a share of the step.
const OFF: f64 = 0.12;
/// A side of the content along which lines are drawn over more than this share is its wall, beyond which nothing is told.
const WALL: f64 = 0.9;
/// Nodes nearer to the end of what is told than this share of a step are not told.
const RIM: f64 = 0.1;
/// Nodes of which everything is told, at least.
const LEAST: usize = 24;
/// Steps that have to be drawn there.
const STEPS: usize = 16;
/// Styles and nodes that are told apart at most.
const MOST: (usize, usize) = (250, 40_000);
/// Work for each node and each piece of a line.
const WORK: u64 = 50;

/// What is drawn at the nodes of an exemplar.
#[derive(Clone, Debug)]
pub(crate) struct Sheet {
    pub(crate) lattice: Lattice,
    /// Where its node at the origin lies.
    pub(crate) origin: Vector<2>,
    /// The lowest node, and the number of nodes each way.
    low: Node,
    size: [usize; 2],
    /// The nodes, row by row; what nobody tells is open.
    stars: Vec<Star>,
    pub(crate) looks: Vec<Look>,
    /// Numbers of the nodes of which everything is told.
    pub(crate) told: Vec<u32>,
    pub(crate) styles: Vec<u8>,
    pub(crate) classes: Vec<u32>,
    /// Whether no lines close around anything.
    pub(crate) is_forest: bool,
    /// Whether slanted steps cross between nodes.
    pub(crate) has_crossings: bool,
    /// The looks of the told nodes, each once.
    pub(crate) kinds: Vec<Look>,
    /// For each node the share of the told nodes that look like it.
    pub(crate) share: Vec<f64>,
    /// Steps along the walls, which are left out.
    pub(crate) walls: usize,
}

impl Sheet {
    /// The sheet of an exemplar; `None` where it does not keep to one.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Self>> {
        if exemplar.curves.is_empty() || !exemplar.areas.is_empty() || exemplar.hole.is_some() {
            return Ok(None);
        }
        if exemplar.styles.len() > MOST.0 {
            return Ok(None);
        }
        let lines: Option<Vec<Vec<Vector<2>>>> = exemplar.curves.iter().map(|c| corners(&c.path)).collect();
        let Some(lines) = lines else { return Ok(None) };
        budget.spend(WORK * lines.iter().map(|line| line.len() as u64).sum::<u64>())?;
        let Some(ruling) = ruling(&lines, &exemplar.window) else { return Ok(None) };
        let Some(mut sheet) = Self::blank(exemplar, &ruling) else { return Ok(None) };
        for (number, line) in (1..).zip(&lines) {
            for pair in line.windows(2) {
                sheet.draw(pair[0], pair[1], number);
            }
        }
        if !exemplar.elements.iter().enumerate().all(|(e, element)| sheet.put(e, element)) {
            return Ok(None);
        }
        sheet.settle(exemplar);
        budget.spend(WORK * sheet.stars.len() as u64)?;
        Ok(sheet.tells_enough().then_some(sheet))
    }

    fn blank(exemplar: &Exemplar<2>, ruling: &Ruling) -> Option<Self> {
        let lattice = Lattice::new(ruling.vectors[0], ruling.vectors[1])?;
        let [rows, columns] = lattice.nodes_in(ruling.origin, &exemplar.window);
        let low = [rows.start() - 1, columns.start() - 1];
        let size = [(rows.end() - low[0] + 2) as usize, (columns.end() - low[1] + 2) as usize];
        let count = size[0].checked_mul(size[1]).filter(|count| *count <= MOST.1)?;
        // Pens of one style and another width look different.
        let mut pens: Vec<(usize, f64)> = Vec::new();
        let pen = |curve: &Curve<2>| {
            let is_same = |known: &(usize, f64)| known.0 == curve.style && (known.1 / curve.width - 1.0).abs() < 0.02;
            let at = pens.iter().position(is_same).unwrap_or_else(|| {
                pens.push((curve.style, curve.width));
                pens.len() - 1
            });
            u8::try_from(at + 1).ok()
        };
        let styles = exemplar.curves.iter().map(pen).collect::<Option<Vec<u8>>>()?;
        let classes = exemplar.elements.iter().map(|e| e.class as u32 + 1).collect();
        let stars = vec![Star { steps: [Some(0); 8], thing: Some(0) }; count];
        let (looks, told) = (Vec::new(), Vec::new());
        let origin = ruling.origin;
        let (is_forest, has_crossings, walls, share, kinds) = (false, false, 0, Vec::new(), Vec::new());
        Some(Self {
            lattice,
            origin,
            low,
            size,
            stars,
            looks,
            told,
            styles,
            classes,
            is_forest,
            has_crossings,
            kinds,
            share,
            walls,
        })
    }

    /// The number of a node on the sheet.
    pub(crate) fn number(&self, node: Node) -> Option<usize> {
        let [i, j] = [node[0] - self.low[0], node[1] - self.low[1]];
        let is_on = i >= 0 && j >= 0 && (i as usize) < self.size[0] && (j as usize) < self.size[1];
        is_on.then(|| j as usize * self.size[0] + i as usize)
    }

    /// The node with a number.
    pub(crate) fn node(&self, number: usize) -> Node {
        [self.low[0] + (number % self.size[0]) as i64, self.low[1] + (number / self.size[0]) as i64]
    }

    pub(crate) fn star(&self, number: usize) -> &Star {
        &self.stars[number]
    }

    /// Draws a line as steps; where the frame has cut it between nodes, to the next node.
    fn draw(&mut self, from: Vector<2>, to: Vector<2>, curve: u32) {
        let [a, b] = [from, to].map(|p| self.lattice.coordinates(p - self.origin));
        let d = b - a;
        let length = d[0].abs().max(d[1].abs());
        let sign = |x: f64| if x.abs() < 0.5 * length { 0 } else { x.signum() as i64 };
        let step = [sign(d[0]), sign(d[1])];
        let Some(way) = super::star::WAYS.iter().position(|w| *w == step) else { return };
        // The ends, moved outwards along the line to nodes.
        let k = usize::from(step[0] == 0);
        let outwards = |x: f64, s: i64| if s < 0 { (x + 1e-1).floor() } else { (x - 1e-1).ceil() };
        let first = outwards(a[k], -step[k]);
        let count = ((outwards(b[k], step[k]) - first) * step[k] as f64).round() as i64;
        let back = (first - a[k]) * step[k] as f64;
        let mut node = [0, 1].map(|k| (a[k] + back * step[k] as f64).round() as i64);
        for _ in 0..count {
            let next = beside(node, way);
            for (at, way) in [(node, way), (next, opposite(way))] {
                if let Some(n) = self.number(at) {
                    self.stars[n].steps[way] = Some(curve);
                }
            }
            node = next;
        }
    }

    /// Puts a thing on its node; `false` where it lies on none.
    fn put(&mut self, e: usize, element: &Element<2>) -> bool {
        let (node, rest) = self.lattice.nearest(element.centre - self.origin);
        if element.role == Role::Context {
            return true;
        }
        if rest.norm() > OFF * self.lattice.shorter() {
            return false;
        }
        match self.number(node) {
            Some(n) if self.stars[n].thing == Some(0) => self.stars[n].thing = Some(e as u32 + 1),
            _ => return false,
        }
        true
    }

    /// Decides of which nodes everything is told.
    fn settle(&mut self, exemplar: &Exemplar<2>) {
        let inside = self.inside(exemplar);
        let rim = RIM * self.lattice.shorter();
        for n in 0..self.stars.len() {
            let p = self.origin + self.lattice.at(self.node(n));
            if inside.signed_distance(p) > rim {
                self.told.push(n as u32);
            } else {
                self.stars[n] = Star::default();
            }
        }
        // Things cut by the frame are there, but nobody may copy what lies around them.
        for element in exemplar.elements.iter().filter(|e| e.role == Role::Context) {
            let (node, _) = self.lattice.nearest(element.centre - self.origin);
            if let Some(n) = self.number(node) {
                self.told.retain(|t| *t as usize != n);
            }
        }
        self.looks = self.stars.iter().map(|star| Look::of(star, &self.styles, &self.classes)).collect();
        self.is_forest = self.is_without_rings();
        let crosses = |&n: &u32| [1, 3].into_iter().any(|way| self.is_crossed(n as usize, way));
        self.has_crossings = self.told.iter().any(crosses);
        let mut counts: BTreeMap<Look, usize> = BTreeMap::new();
        self.told.iter().for_each(|&n| *counts.entry(self.looks[n as usize]).or_default() += 1);
        self.kinds = counts.keys().copied().collect();
        let all = self.told.len() as f64;
        self.share = self.looks.iter().map(|look| counts.get(look).map_or(0.0, |&count| count as f64 / all)).collect();
    }

    /// Whether a slanted step from a node is drawn, and the one that crosses it.
    fn is_crossed(&self, n: usize, way: usize) -> bool {
        self.stars[n].steps[way].is_some_and(|curve| curve > 0) && self.crossing(n, way) == Some(true)
    }

    /// Whether the slanted step that would cross the one from a node is drawn, where that is told.
    pub(crate) fn crossing(&self, n: usize, way: usize) -> Option<bool> {
        let other = self.number(beside(self.node(n), CROSSED[way / 2].0))?;
        self.stars[other].steps[CROSSED[way / 2].1].map(|curve| curve > 0)
    }

    /// The part of the frame of which everything is told: to a wall around the content, where there is one.
    fn inside(&mut self, exemplar: &Exemplar<2>) -> Bounds<2> {
        let mut inside = exemplar.window;
        let content = exemplar.curves.iter().fold(Bounds::EMPTY, |all, curve| all.union(&curve.path.bounds()));
        let near = RIM * self.lattice.shorter();
        for k in 0..2 {
            for side in [content.min[k], content.max[k]] {
                let is_along = |a: &Vector<2>, b: &Vector<2>| (a[k] - side).abs() < near && (b[k] - side).abs() < near;
                let pairs = exemplar.curves.iter().flat_map(|curve| &curve.path.cubics);
                let drawn = pairs.filter(|c| is_along(&c[0], &c[3])).map(|c| (c[3] - c[0]).norm()).sum::<f64>();
                if drawn < WALL * content.size()[1 - k] {
                    continue;
                }
                self.walls += 1;
                if side == content.min[k] {
                    inside.min[k] = inside.min[k].max(side);
                } else {
                    inside.max[k] = inside.max[k].min(side);
                }
            }
        }
        inside
    }

    /// Whether the steps between nodes that are told close around nothing.
    fn is_without_rings(&self) -> bool {
        let place: BTreeMap<u32, usize> = self.told.iter().enumerate().map(|(k, &n)| (n, k)).collect();
        let mut sets = arabesque_core::DisjointSets::new(self.told.len());
        for (k, &n) in self.told.iter().enumerate() {
            for way in 0..4 {
                if self.stars[n as usize].steps[way].is_none_or(|curve| curve == 0) {
                    continue;
                }
                let there = self.number(beside(self.node(n as usize), way)).and_then(|m| place.get(&(m as u32)));
                if let Some(&other) = there {
                    if sets.of(k) == sets.of(other) {
                        return false;
                    }
                    sets.join(k, other);
                }
            }
        }
        true
    }

    fn tells_enough(&self) -> bool {
        let drawn = |n: &u32| self.stars[*n as usize].steps.iter().flatten().filter(|curve| **curve > 0).count();
        self.told.len() >= LEAST && self.told.iter().map(drawn).sum::<usize>() >= 2 * STEPS
    }
}
