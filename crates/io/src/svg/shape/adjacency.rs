//! Which things touch: sweeps over boxes, and edges that meet.

use arabesque_core::{Bounds, Budget, Result, Segment, Vector, segment};

/// Calls `visit(i, j)`, i before j in the sweep, for each pair of boxes that meet once each is grown by its reach.
/// Stops when `visit` returns `false`.
///
/// # Errors
/// As [`Budget::spend`], for the pairs that are looked at.
pub(crate) fn meeting(
    boxes: &[Bounds<2>],
    reach: impl Fn(usize) -> f64,
    budget: &Budget,
    mut visit: impl FnMut(usize, usize) -> bool,
) -> Result<()> {
    let grown: Vec<_> = boxes.iter().enumerate().map(|(i, b)| b.grown(reach(i))).collect();
    let mut order: Vec<usize> = (0..boxes.len()).filter(|&i| !boxes[i].is_empty()).collect();
    order.sort_by(|&a, &b| grown[a].min[0].total_cmp(&grown[b].min[0]));
    let mut active: Vec<usize> = Vec::new();
    let mut meter = budget.meter();
    for &i in &order {
        active.retain(|&j| grown[j].max[0] >= grown[i].min[0]);
        meter.spend(PAIR * (1 + active.len() as u64))?;
        for &j in &active {
            if grown[j].intersects(&grown[i]) && !visit(j, i) {
                return Ok(());
            }
        }
        active.push(i);
    }
    Ok(())
}

/// Work for each pair of boxes, and of edges.
const PAIR: u64 = 5;

/// An edge between two points.
pub(crate) type Edge = Segment<2>;

/// How many pairs of edges may still be looked at.
#[derive(Debug)]
pub(crate) struct Looks(pub(crate) u64);

impl Looks {
    /// Whether `test`, which holds only for edges that come within `tolerance` of each other, holds for an edge of `a` and one of `b`; `None` when none is left.
    pub(crate) fn any(
        &mut self,
        a: &[Edge],
        b: &[Edge],
        tolerance: f64,
        test: impl Fn(Edge, Edge) -> bool,
    ) -> Option<bool> {
        self.0 = self.0.checked_sub((a.len() + b.len()) as u64)?;
        let around = |edges: &[Edge]| Bounds::around(edges.iter().flat_map(|e| [e.0, e.1]));
        let (box_a, box_b) = (around(a).grown(tolerance), around(b).grown(tolerance));
        let near = |edges: &[Edge], other: &Bounds<2>| -> Vec<Edge> {
            edges.iter().filter(|e| Bounds::around([e.0, e.1]).intersects(other)).copied().collect()
        };
        let (a, b) = (near(a, &box_b), near(b, &box_a));
        let b = Sorted::new(&b, tolerance);
        for p in a {
            let own = Bounds::around([p.0, p.1]).grown(tolerance);
            let near = b.near(&own);
            self.0 = self.0.checked_sub(near.len() as u64)?;
            if near.iter().any(|&(q, around)| around.intersects(&own) && test(p, q)) {
                return Some(true);
            }
        }
        Some(false)
    }
}

/// Edges in the order in which they begin along an axis, the one along which they reach farther: of thousands, few are near a place.
pub(crate) struct Sorted {
    axis: usize,
    /// Each with the box around it.
    edges: Vec<(Edge, Bounds<2>)>,
    /// How far the longest box reaches along the axis.
    longest: f64,
}

impl Sorted {
    /// Sorts edges, with boxes that are `grown` by a distance on all sides.
    pub(crate) fn new(edges: &[Edge], grown: f64) -> Self {
        let size = Bounds::around(edges.iter().flat_map(|e| [e.0, e.1])).size();
        let axis = usize::from(size[1] > size[0]);
        let mut edges: Vec<_> = edges.iter().map(|&e| (e, Bounds::around([e.0, e.1]).grown(grown))).collect();
        edges.sort_by(|(_, a), (_, b)| a.min[axis].total_cmp(&b.min[axis]));
        let longest = edges.iter().map(|(_, b)| b.size()[axis]).fold(0.0, f64::max);
        Self { axis, edges, longest }
    }

    /// Those whose boxes may meet a box, and some more.
    pub(crate) fn near(&self, around: &Bounds<2>) -> &[(Edge, Bounds<2>)] {
        let (axis, low, high) = (self.axis, around.min[self.axis] - self.longest, around.max[self.axis]);
        // Rounding may make a box a little longer than it is told.
        let slack = 1e-9 * (low.abs() + high.abs() + self.longest);
        let from = self.edges.partition_point(|(_, b)| b.min[axis] < low - slack);
        let to = self.edges.partition_point(|(_, b)| b.min[axis] <= high);
        self.edges.get(from..to).unwrap_or_default()
    }
}

/// Whether an edge of `a` comes within `tolerance` of an edge of `b`; `None` when no look is left.
pub(crate) fn edges_meet(a: &[Edge], b: &[Edge], tolerance: f64, looks: &mut Looks) -> Option<bool> {
    looks.any(a, b, tolerance, |p, q| edge_distance(p, q) <= tolerance)
}

/// Distance between two edges.
pub(crate) fn edge_distance(p: Edge, q: Edge) -> f64 {
    let side = |e: Edge, v: Vector<2>| (e.1 - e.0).cross(v - e.0);
    let apart = |e: Edge, f: Edge| side(e, f.0) * side(e, f.1) > 0.0;
    if !apart(p, q) && !apart(q, p) && Bounds::around([p.0, p.1]).intersects(&Bounds::around([q.0, q.1])) {
        return 0.0;
    }
    let ends = [(p.0, q), (p.1, q), (q.0, p), (q.1, p)];
    ends.into_iter().map(|(v, e)| point_distance(v, e)).fold(f64::INFINITY, f64::min)
}

/// As `segment::distance`, but with another rounding, on which the joints of touching shapes depend.
fn point_distance(v: Vector<2>, edge: Edge) -> f64 {
    (v - edge.0 - (edge.1 - edge.0) * segment::nearest_share(edge, v)).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges(ring: &[Vector<2>]) -> Vec<Edge> {
        arabesque_core::ring::edges(ring).collect()
    }

    fn square(x: f64, y: f64, side: f64) -> Vec<Vector<2>> {
        vec![Vector::xy(x, y), Vector::xy(x + side, y), Vector::xy(x + side, y + side), Vector::xy(x, y + side)]
    }

    #[test]
    fn boxes_that_meet_are_all_found() {
        let boxes: Vec<_> = (0..5).map(|k| Bounds::around(square(f64::from(k) * 2.0, 0.0, 1.5))).collect();
        let mut pairs = Vec::new();
        meeting(
            &boxes,
            |_| 0.3,
            &Budget::default(),
            |i, j| {
                pairs.push((i, j));
                true
            },
        )
        .unwrap();
        assert_eq!(pairs, [(0, 1), (1, 2), (2, 3), (3, 4)]);
    }

    #[test]
    fn of_many_edges_few_are_near_a_place_and_none_is_missed() {
        let all: Vec<Edge> = (0..1000)
            .map(|k| {
                let (at, slope) = (Vector::xy(f64::from(k), f64::from(k % 7)), f64::from(k % 3) - 1.0);
                (at, at + Vector::xy(1.5, slope))
            })
            .collect();
        let sorted = Sorted::new(&all, 0.5);
        for k in 0..200 {
            let asked =
                Bounds::around([Vector::xy(5.0 * f64::from(k), 2.0), Vector::xy(5.0 * f64::from(k) + 2.0, 4.0)]);
            let meet = |e: &&Edge| Bounds::around([e.0, e.1]).grown(0.5).intersects(&asked);
            let near = sorted.near(&asked);
            assert!(near.len() < 10, "{}", near.len());
            assert!(all.iter().filter(meet).all(|e| near.iter().any(|(other, _)| other == e)), "{k}");
        }
    }

    #[test]
    fn squares_meet_within_the_tolerance() {
        let (a, b) = (edges(&square(0.0, 0.0, 1.0)), edges(&square(1.1, 0.0, 1.0)));
        let mut looks = Looks(1000);
        assert_eq!(edges_meet(&a, &b, 0.2, &mut looks), Some(true));
        assert_eq!(edges_meet(&a, &b, 0.05, &mut looks), Some(false));
        assert_eq!(edges_meet(&a, &edges(&square(0.5, 0.5, 1.0)), 0.0, &mut looks), Some(true));
        assert_eq!(edges_meet(&a, &a, 0.0, &mut Looks(9)), None);
    }
}
