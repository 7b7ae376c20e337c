//! The sample graph of a set of lines at one level [Tu 2020 §4.1].

use std::sync::Arc;

use arabesque_core::{Budget, Measured, Numbered, Result, Vector};

use crate::exemplar::graph::{
    line::Line,
    skeleton::{Knot, Skeleton},
};

/// Most arms of a node that are told apart; further ones are left out of the comparison.
pub(crate) const ARMS: usize = 12;

/// No edge of the output is longer than this many sampling distances.
pub(crate) const MAX_EDGE: f64 = 2.2;

/// Edge sets up to this size are matched optimally, larger ones nearest pair first.
const EXACT: usize = 4;

/// Share of nodes with three edges from which on a new fork is nothing unusual.
const FORKS: f64 = 0.04;

/// Bytes of a node with its arms, and about how many nanoseconds it takes to find.
const NODE: usize = 500;

/// A stretch of a line: from arc length `from` to `to`, backwards when `to < from`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Piece {
    pub(crate) line: u32,
    pub(crate) from: f64,
    pub(crate) to: f64,
}

impl Piece {
    pub(crate) fn reversed(self) -> Self {
        Self { line: self.line, from: self.to, to: self.from }
    }
}

/// One end of an edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arm<const D: usize> {
    /// The node at the other end.
    pub(crate) to: u32,
    /// What lies between.
    pub(crate) piece: Piece,
    /// Direction in which the line leaves, a unit vector.
    pub(crate) tangent: Vector<D>,
}

/// The edge set of a sample, as vectors to the other ends [Tu 2020 eq. 5].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Star<const D: usize> {
    len: u8,
    arms: [[f32; D]; ARMS],
}

impl<const D: usize> Star<D> {
    pub(crate) const EMPTY: Self = Self { len: 0, arms: [[0.0; D]; ARMS] };

    pub(crate) fn new(vectors: impl Iterator<Item = Vector<D>>) -> Self {
        let mut star = Self::EMPTY;
        for (k, v) in vectors.take(ARMS).enumerate() {
            star.arms[k] = v.0.map(|x| x as f32);
            star.len = k as u8 + 1;
        }
        star
    }

    /// Number of edges.
    pub(crate) fn len(&self) -> usize {
        usize::from(self.len)
    }

    /// Work to compare it with another one, relative to the work for a line that goes on.
    pub(crate) fn price(&self) -> u64 {
        match self.len() as u64 {
            0..=2 => 1,
            3 => 4,
            arms => 2 * arms * arms,
        }
    }

    /// Difference of two edge sets: matched edges by the vectors to their other ends, the others at `single2` each;
    /// nothing where the first has no edges yet [Tu 2020 eq. 5].
    pub(crate) fn distance2(&self, other: &Self, single2: f32) -> f32 {
        if self.len == 0 {
            return 0.0;
        }
        let (few, many) = if self.len <= other.len { (self, other) } else { (other, self) };
        let surplus = f32::from(many.len - few.len) * single2;
        if let ([a, b], [c, d]) = (&few.arms[..few.len()], &many.arms[..many.len()]) {
            return f32::min(apart2(a, c) + apart2(b, d), apart2(a, d) + apart2(b, c));
        }
        let (few, many) = (&few.arms[..few.len()], &many.arms[..many.len()]);
        surplus + if few.len() <= EXACT { least(few, many, 0) } else { nearest_first(few, many) }
    }
}

fn apart2<const D: usize>(a: &[f32; D], b: &[f32; D]) -> f32 {
    (0..D).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum()
}

/// Least sum of squared differences when every vector of `few` gets one of `many` of its own.
fn least<const D: usize>(few: &[[f32; D]], many: &[[f32; D]], taken: u32) -> f32 {
    let Some((first, rest)) = few.split_first() else { return 0.0 };
    let mut best = f32::INFINITY;
    for (k, other) in many.iter().enumerate().filter(|(k, _)| taken & (1 << k) == 0) {
        let d2 = apart2(first, other);
        if d2 < best {
            best = best.min(d2 + least(rest, many, taken | (1 << k)));
        }
    }
    best
}

/// Sum of squared differences when the nearest pair is matched first.
fn nearest_first<const D: usize>(few: &[[f32; D]], many: &[[f32; D]]) -> f32 {
    let (mut first, mut second) = ([false; ARMS], [false; ARMS]);
    let mut sum = 0.0;
    for _ in 0..few.len() {
        let mut best = (f32::INFINITY, 0, 0);
        for (i, a) in few.iter().enumerate().filter(|(i, _)| !first[*i]) {
            for (j, b) in many.iter().enumerate().filter(|(j, _)| !second[*j]) {
                let d2 = apart2(a, b);
                if d2 < best.0 {
                    best = (d2, i, j);
                }
            }
        }
        (first[best.1], second[best.2]) = (true, true);
        sum += best.0;
    }
    sum
}

/// A node of the sample graph.
#[derive(Clone, Debug)]
pub(crate) struct Node<const D: usize> {
    pub(crate) position: Vector<D>,
    pub(crate) arms: Vec<Arm<D>>,
    /// Curve whose stroke this is; at a junction, the one with the smallest number.
    pub(crate) curve: u32,
    /// What kind of knot it is, `None` between knots.
    pub(crate) knot: Option<Knot>,
    /// Directions in which the window cuts it off.
    pub(crate) beyond: Vec<Vector<D>>,
    /// Styles of the strokes through it, sorted.
    pub(crate) styles: Vec<usize>,
}

impl<const D: usize> Node<D> {
    fn new(position: Vector<D>, curve: u32, knot: Option<Knot>) -> Self {
        Self { position, arms: Vec::new(), curve, knot, beyond: Vec::new(), styles: Vec::new() }
    }

    /// Whether a stroke may run from one to the other.
    pub(crate) fn shares_style(&self, other: &Self) -> bool {
        self.styles.iter().any(|s| other.styles.contains(s))
    }

    /// The arm on which a stroke that comes along arm `k` goes on.
    pub(crate) fn onwards(&self, k: usize) -> Option<usize> {
        let own = self.arms[k].piece;
        let forwards = own.to > own.from;
        self.arms.iter().position(|other| {
            let p = other.piece;
            p.line == own.line && p.from == own.from && (p.to > p.from) != forwards
        })
    }
}

/// A sample graph: the knots of the skeleton first, then the samples between.
#[derive(Clone, Debug)]
pub(crate) struct Net<const D: usize> {
    pub(crate) nodes: Numbered<Node<D>>,
    /// Nodes along each line, by arc length.
    pub(crate) along: Numbered<Vec<(f64, u32)>>,
    /// Distance of neighbouring samples.
    pub(crate) spacing: f64,
    /// What was sampled.
    pub(crate) skeleton: Arc<Skeleton<D>>,
}

impl<const D: usize> Net<D> {
    /// Samples the lines at about `spacing`, rounded so that it divides each stretch between two knots.
    ///
    /// # Errors
    /// When there would be more samples than fit into the memory that is allowed.
    pub(crate) fn new(skeleton: &Arc<Skeleton<D>>, spacing: f64, budget: &Budget) -> Result<Self> {
        let length: f64 = skeleton.lines.iter().map(|line| line.measured.length()).sum();
        let expected = (length / spacing) as usize + skeleton.knots.len() + 3 * skeleton.lines.len();
        // Held for the moment alone: too many are refused.
        let _held = budget.hold("samples on curves", expected.saturating_mul(NODE))?;
        budget.spend(expected as u64 * NODE as u64)?;
        let knot = |&(position, kind): &(Vector<D>, Knot)| Node::new(position, u32::MAX, Some(kind));
        let mut net = Self {
            nodes: skeleton.knots.iter().map(knot).collect(),
            along: Numbered::new(),
            spacing,
            skeleton: Arc::clone(skeleton),
        };
        for (number, line) in skeleton.lines.iter().enumerate() {
            let along = net.walk(line);
            net.connect(line, number as u32, &along);
            net.along.push(along);
        }
        Ok(net)
    }

    /// Nodes of a line: its stops, and even samples between them.
    fn walk(&mut self, line: &Line<D>) -> Vec<(f64, u32)> {
        let (measured, length) = (&line.measured, line.measured.length());
        let mut along = Vec::new();
        for pair in line.stops.windows(2) {
            // Two lines between the same knots, and a line back to its knot, stay apart by a sample between.
            let least = if pair[0].1 == pair[1].1 { 3 } else { 1 + usize::from(self.are_joined(pair[0].1, pair[1].1)) };
            self.stretch(line, [pair[0].0, pair[1].0], least, &mut along);
        }
        match (line.stops.first(), line.stops.last()) {
            (Some(first), Some(last)) if measured.is_closed() => {
                let least = [1, 3, 2][line.stops.len().min(3) % 3];
                self.stretch(line, [last.0, first.0 + length], least, &mut along);
            }
            (None, _) => {
                self.sample(line, 0.0, &mut along);
                self.stretch(line, [0.0, length], 3, &mut along);
            }
            _ => {}
        }
        along.extend(&line.stops);
        along.sort_by(|a, b| a.0.total_cmp(&b.0));
        along
    }

    /// Even samples inside a stretch of a line, at least so many that they divide it into `least` parts.
    fn stretch(&mut self, line: &Line<D>, [from, to]: [f64; 2], least: usize, along: &mut Vec<(f64, u32)>) {
        let n = (((to - from) / self.spacing).round() as usize).max(least);
        for k in 1..n {
            self.sample(line, line.measured.wrap(from + (to - from) * k as f64 / n as f64), along);
        }
    }

    fn sample(&mut self, line: &Line<D>, arc: f64, along: &mut Vec<(f64, u32)>) {
        along.push((arc, self.nodes.len() as u32));
        let position = line.measured.point(arc);
        self.nodes.push(Node::new(position, line.curve, None));
    }

    fn are_joined(&self, a: u32, b: u32) -> bool {
        self.nodes[a].arms.iter().any(|arm| arm.to == b)
    }

    fn connect(&mut self, line: &Line<D>, number: u32, along: &[(f64, u32)]) {
        let (measured, length) = (&line.measured, line.measured.length());
        for pair in along.windows(2) {
            self.edge(measured, Piece { line: number, from: pair[0].0, to: pair[1].0 }, [pair[0].1, pair[1].1]);
        }
        if let (true, Some(first), Some(last)) = (measured.is_closed(), along.first(), along.last()) {
            self.edge(measured, Piece { line: number, from: last.0, to: first.0 + length }, [last.1, first.1]);
        }
        for &(_, node) in along {
            let node = &mut self.nodes[node];
            node.curve = node.curve.min(line.curve);
        }
        for (end, is_cut) in [(along.first(), line.is_cut[0]), (along.last(), line.is_cut[1])] {
            if let (Some(&(arc, node)), true, false) = (end, is_cut, measured.is_closed()) {
                let outwards = if arc <= 0.0 { -1.0 } else { 1.0 };
                let tangent = tangent(measured, arc, outwards, self.spacing);
                self.nodes[node].beyond.push(tangent);
            }
        }
    }

    fn edge(&mut self, measured: &Measured<D>, piece: Piece, [a, b]: [u32; 2]) {
        let out = tangent(measured, piece.from, 1.0, 0.3 * (piece.to - piece.from));
        let back = tangent(measured, piece.to, -1.0, 0.3 * (piece.to - piece.from));
        self.nodes[a].arms.push(Arm { to: b, piece, tangent: out });
        self.nodes[b].arms.push(Arm { to: a, piece: piece.reversed(), tangent: back });
    }

    /// The edge set of a node. An arm that the window cuts off counts as one of the usual length.
    pub(crate) fn star(&self, node: u32) -> Star<D> {
        let node = &self.nodes[node];
        let arms = node.arms.iter().map(|arm| self.nodes[arm.to].position - node.position);
        Star::new(arms.chain(node.beyond.iter().map(|t| *t * self.spacing)))
    }

    /// Unit vectors in which strokes leave a node, those included that the window cuts off.
    pub(crate) fn directions(&self, node: u32) -> Vec<Vector<D>> {
        let node = &self.nodes[node];
        node.arms.iter().map(|a| a.tangent).chain(node.beyond.iter().copied()).collect()
    }

    /// Number of edges of a node, those included that the window cuts off.
    pub(crate) fn degree(&self, node: u32) -> usize {
        let node = &self.nodes[node];
        node.arms.len() + node.beyond.len()
    }

    /// Whether strokes branch: a fair share of the nodes has three edges.
    pub(crate) fn branches(&self) -> bool {
        let forks = (0..self.nodes.len() as u32).filter(|&n| self.degree(n) == 3).count();
        forks as f64 > FORKS * self.nodes.len() as f64
    }

    /// Where the node at `arc` of a line is: a line that ends at a junction may stop short of it by a touch.
    pub(crate) fn anchor(&self, line: u32, arc: f64) -> Vector<D> {
        let line = &self.skeleton.lines[line];
        let (arc, length) = (line.measured.wrap(arc), line.measured.length());
        let gap = |a: f64| {
            let d = (a - arc).abs();
            if line.measured.is_closed() { d.min(length - d) } else { d }
        };
        let stop = line.stops.iter().find(|(a, _)| gap(*a) <= 1e-9 * length);
        stop.map_or_else(|| line.measured.point(arc), |&(_, knot)| self.skeleton.knots[knot].0)
    }

    /// From the node at the start of a piece to that at its end.
    pub(crate) fn span(&self, piece: Piece) -> Vector<D> {
        self.anchor(piece.line, piece.to) - self.anchor(piece.line, piece.from)
    }

    /// The node of `line` nearest to `arc`.
    pub(crate) fn nearest(&self, line: u32, arc: f64, length: f64, is_closed: bool) -> Option<u32> {
        let gap = |a: f64| {
            let d = (a - arc).abs();
            if is_closed { d.min(length - d) } else { d }
        };
        self.along[line].iter().min_by(|a, b| gap(a.0).total_cmp(&gap(b.0))).map(|n| n.1)
    }
}

/// Unit direction of a line at `arc`, forwards for `sign` 1, over a short step on that side.
fn tangent<const D: usize>(measured: &Measured<D>, arc: f64, sign: f64, reach: f64) -> Vector<D> {
    let step = (0.05 * reach.abs()).max(1e-6 * measured.length());
    let p = measured.point(arc);
    let inwards = arc + sign * step;
    let beyond = !measured.is_closed() && !(0.0..=measured.length()).contains(&inwards);
    let way = if beyond { p - measured.point(arc - sign * step) } else { measured.point(inwards) - p };
    way.unit_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn star(vectors: &[(f64, f64)]) -> Star<2> {
        Star::new(vectors.iter().map(|&(x, y)| Vector::xy(x, y)))
    }

    #[test]
    fn the_order_of_edges_does_not_matter() {
        let a = star(&[(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)]);
        let b = star(&[(-1.0, 0.0), (1.0, 0.0), (0.0, 1.0)]);
        assert_eq!(a.distance2(&b, 1.0), 0.0);
    }

    #[test]
    fn a_surplus_edge_has_its_price_on_either_side() {
        let (a, b) = (star(&[(1.0, 0.0), (0.0, 1.0)]), star(&[(1.0, 0.0)]));
        assert_eq!(a.distance2(&b, 0.5), 0.5);
        assert_eq!(b.distance2(&a, 0.5), 0.5);
    }

    #[test]
    fn a_sample_without_edges_is_not_charged() {
        assert_eq!(Star::EMPTY.distance2(&star(&[(1.0, 0.0)]), 0.5), 0.0);
    }
}
