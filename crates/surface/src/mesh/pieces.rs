//! Boxes around pieces of long thin triangles.
//!
//! The box around a triangle that is long, thin and askew is nearly empty, and the boxes of many of them around one corner, as in the tip of a
//! cone, all overlap: whoever looks for the nearest one looks at them all. Boxes around pieces of them hardly do.

use arabesque_core::{Bounds, Budget, Held, Result, Vector};

use super::topology::Topology;
use crate::tree::Tree;

/// A triangle is thin whose height is less than this share of its longest side.
const THIN: f64 = 1.0 / 24.0;
/// It is askew when two sides of its box are longer than this share of it.
const ASKEW: f64 = 1.0 / 12.0;
/// Fewer thin triangles are no burden.
const FEW: usize = 64;
/// Most pieces along one triangle, and of all of them together, about.
const MOST: usize = 32;
const ROOM: usize = 1 << 20;
/// How often a piece is halved at most.
const DEPTH: usize = 16;
/// By how much boxes are larger than what they hold, for the rounding of halves, as a share of the longest side.
const ROUNDING: f64 = 1e-12;

/// Boxes around all triangles, several around those that are long, thin and askew.
#[derive(Debug)]
pub(super) struct Pieces {
    tree: Tree,
    /// For each box its triangle, in their order.
    of: Vec<u32>,
    _held: Held,
}

impl Pieces {
    /// `None` where there are too few such triangles to be a burden, or far too many to be cut.
    ///
    /// # Errors
    /// As [`Budget::spend`] and [`Budget::hold`].
    pub(super) fn new(topology: &Topology, budget: &Budget) -> Result<Option<Self>> {
        let count = topology.triangles.len();
        budget.spend(20 * count as u64)?;
        let thin = (0..count as u32).filter(|&t| is_thin(&topology.corners(t))).count();
        let along = (ROOM / (2 * thin.max(1))).min(MOST);
        if thin < FEW || along < 2 {
            return Ok(None);
        }
        let most = count.saturating_add(4 * along * thin);
        let held = budget.hold("boxes around long thin triangles", most.saturating_mul(size_of::<Bounds<3>>()))?;
        let (mut boxes, mut of, mut meter) = (Vec::new(), Vec::new(), budget.meter());
        for t in 0..count as u32 {
            let corners = topology.corners(t);
            if is_thin(&corners) {
                let longest = longest(&corners).1;
                split(corners, (longest / along as f64, ROUNDING * longest), DEPTH, &mut boxes);
            } else {
                boxes.push(Bounds::around(corners));
            }
            meter.spend(40 * (boxes.len() - of.len()) as u64)?;
            of.resize(boxes.len(), t);
        }
        Ok(Some(Self { tree: Tree::new(&boxes, budget)?, of, _held: held }))
    }

    /// As [`Tree::nearest`], for triangles.
    pub(super) fn nearest(
        &self,
        p: Vector<3>,
        limit: f64,
        distance2: impl Fn(u32) -> f64,
    ) -> (Option<(u32, f64)>, u64) {
        let (found, looked) = self.tree.nearest(p, limit, |piece| Some(distance2(self.of[piece as usize])));
        (found.map(|(piece, d2)| (self.of[piece as usize], d2)), looked)
    }
}

/// The longest side, from its corner to the next, and its length.
fn longest(corners: &[Vector<3>; 3]) -> (usize, f64) {
    let length = |k: usize| (corners[(k + 1) % 3] - corners[k]).norm();
    (0..3).map(|k| (k, length(k))).fold((0, 0.0), |best, side| if side.1 > best.1 { side } else { best })
}

fn is_thin(corners: &[Vector<3>; 3]) -> bool {
    let [a, b, c] = *corners;
    let side = longest(corners).1;
    let mut sides = Bounds::around(*corners).size().0;
    sides.sort_by(f64::total_cmp);
    (b - a).cross(c - a).norm() < THIN * side * side && sides[1] > ASKEW * side
}

/// Halves a triangle along its longest side until that is no longer than `until`, and adds the boxes of the pieces.
fn split(corners: [Vector<3>; 3], (until, margin): (f64, f64), depth: usize, boxes: &mut Vec<Bounds<3>>) {
    let (k, length) = longest(&corners);
    if length <= until || depth == 0 {
        boxes.push(Bounds::around(corners).grown(margin));
        return;
    }
    let next = (k + 1) % 3;
    let middle = (corners[k] + corners[next]) * 0.5;
    for end in [next, k] {
        let mut half = corners;
        half[end] = middle;
        split(half, (until, margin), depth - 1, boxes);
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Stage, Stream, TriangleMesh};

    use super::super::triangle;
    use super::*;

    /// A cone of so many triangles around its tip.
    fn cone(count: u32) -> Topology {
        let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(count);
        let rim = (0..count).map(|k| Vector([6.0 * angle(k).cos(), 6.0 * angle(k).sin(), 0.0]));
        let positions = std::iter::once(Vector([0.0, 0.0, 8.0])).chain(rim).collect();
        let triangles = (0..count).map(|k| [0, k + 1, (k + 1) % count + 1]).collect();
        let mesh = TriangleMesh { positions, triangles, ..TriangleMesh::default() };
        Topology::new(&mesh, &Budget::default()).unwrap()
    }

    #[test]
    fn the_nearest_triangle_is_found_without_looking_at_all() {
        let (topology, budget) = (cone(5000), Budget::default());
        let pieces = Pieces::new(&topology, &budget).unwrap().unwrap();
        let mut random = Stream::new(1, Stage::TEST, 0);
        let mut all = 0;
        for _ in 0..40 {
            let p = Vector([random.range(-7.0, 7.0), random.range(-7.0, 7.0), random.range(-1.0, 9.0)]);
            let d2 = |t: u32| {
                let corners = topology.corners(t);
                (triangle::at(&corners, triangle::nearest(&corners, p)) - p).norm2()
            };
            let nearest = (0..5000).min_by(|&a, &b| d2(a).total_cmp(&d2(b))).unwrap();
            let (found, looked) = pieces.nearest(p, f64::INFINITY, d2);
            assert_eq!(found, Some((nearest, d2(nearest))));
            all += looked;
        }
        assert!(all < 40 * 1500, "{all} looks for 40 questions");
    }

    #[test]
    fn usual_meshes_have_no_pieces() {
        assert!(Pieces::new(&cone(40), &Budget::default()).unwrap().is_none());
    }
}
