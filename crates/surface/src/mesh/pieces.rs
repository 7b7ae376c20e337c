//! Long thin triangles cut into pieces, where their boxes would all lie in one another.

use arabesque_core::{Bounds, Budget, Held, Result, Vector};

use super::{topology::Topology, triangle};

type Corners = [Vector<3>; 3];

/// A piece is not cut where it is at most so many times as long as its triangle is wide.
const STOUT: f64 = 4.0;
/// Shortest length of what is cut, as a share of the mesh.
const SHORT: f64 = 1.0 / 32.0;
/// Most pieces for each triangle of the mesh, on average.
const EACH: f64 = 16.0;
/// Work of one piece.
const PIECE: u64 = 60;

/// The triangles of a mesh, some of them in pieces that together are the whole. Pieces of one triangle follow one another, and triangles
/// keep their order.
#[derive(Debug)]
pub(super) struct Pieces {
    corners: Vec<Corners>,
    triangle: Vec<u32>,
    _held: Held,
}

impl Pieces {
    /// The pieces of all triangles. Work and memory for them are drawn on `budget`.
    pub(super) fn new(topology: &Topology, size: Vector<3>, budget: &Budget) -> Result<Self> {
        let all = topology.triangles.len();
        let wanted: Vec<f64> = (0..all as u32).map(|t| stout(topology, t)).collect();
        let mut least = SHORT * size.norm();
        let count = |least: f64| -> f64 {
            let parts = |t: u32| (2.0 * length(&topology.corners(t)) / wanted[t as usize].max(least)).max(1.0);
            (0..all as u32).map(parts).sum()
        };
        let mut expected = count(least);
        budget.spend(PIECE * all as u64)?;
        while expected > EACH * all as f64 {
            least *= 2.0;
            expected = count(least);
            budget.spend(PIECE * all as u64)?;
        }
        let each = size_of::<Corners>() + size_of::<u32>() + size_of::<Bounds<3>>() * 2;
        let held = budget.hold("pieces of long thin triangles", (expected as usize).saturating_mul(each))?;
        let (mut corners, mut triangle) = (Vec::new(), Vec::new());
        for (t, &wanted) in (0..).zip(&wanted) {
            let before = corners.len();
            cut(topology.corners(t), wanted.max(least), &mut corners);
            triangle.resize(corners.len(), t);
            budget.spend(PIECE * (corners.len() - before) as u64)?;
        }
        Ok(Self { corners, triangle, _held: held })
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.corners.len()
    }

    /// The corners of a piece.
    pub(super) fn corners(&self, piece: u32) -> Corners {
        self.corners[piece as usize]
    }

    /// The triangle that a piece is of.
    pub(super) fn triangle(&self, piece: u32) -> u32 {
        self.triangle[piece as usize]
    }
}

/// The length that a triangle need not be cut below.
fn stout(topology: &Topology, t: u32) -> f64 {
    let longest = length(&topology.corners(t));
    if longest > 0.0 { STOUT * topology.double_area(t).norm() / longest } else { 0.0 }
}

/// The longest side.
fn length(corners: &Corners) -> f64 {
    (0..3).map(|k| (corners[(k + 1) % 3] - corners[k]).norm()).fold(0.0, f64::max)
}

/// Halves what is longer than `most` across its longest side. Every side that is cut halves, so that this ends after a few steps.
fn cut(corners: Corners, most: f64, pieces: &mut Vec<Corners>) {
    let mut open = vec![corners];
    while let Some(piece) = open.pop() {
        let side = |k: usize| (piece[(k + 1) % 3] - piece[k]).norm2();
        let k = (1..3).fold(0, |best, k| if side(k) > side(best) { k } else { best });
        if side(k).sqrt() <= most {
            pieces.push(piece);
            continue;
        }
        let [a, b, c] = [piece[k], piece[(k + 1) % 3], piece[(k + 2) % 3]];
        let middle = triangle::at(&piece, {
            let mut weights = [0.5; 3];
            weights[(k + 2) % 3] = 0.0;
            weights
        });
        open.extend([[a, middle, c], [middle, b, c]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_of_a_needle_are_short_and_together_the_whole() {
        let needle = [Vector([0.0; 3]), Vector([8.0, 0.1, 0.0]), Vector([8.0, 0.0, 0.3])];
        let mut pieces = Vec::new();
        cut(needle, 1.0, &mut pieces);
        assert!(pieces.len() >= 8 && pieces.len() < 100, "{}", pieces.len());
        assert!(pieces.iter().all(|piece| length(piece) <= 1.0));
        let area = |[a, b, c]: &Corners| (*b - *a).cross(*c - *a);
        let sum = pieces.iter().map(area).fold(Vector::ZERO, |sum, area| sum + area);
        assert!((sum - area(&needle)).norm() < 1e-12);
    }
}
