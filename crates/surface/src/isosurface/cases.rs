//! How a surface may pass through a cube, given which of its corners are inside.
//!
//! The corners of a face that are inside are cut off by segments, each from an edge to an edge. Where two opposite corners of a face are inside and the other two are not, they may
//! be cut off one by one or together; the bilinear function on the face decides that for both cubes that share it [Nielson 1991]. So each edge that is crossed has one segment
//! in each of its two faces, and the segments make closed loops. Each loop is filled with a disc of triangles.
//!
//! Why the whole is manifold [Lorensen 1987 does not promise that]: a segment has one triangle in each of the two cubes of its face. Any other edge of a triangle leads through the inside of one
//! cube, for no two vertices on one face are joined by a diagonal (where that cannot be avoided the disc gets a vertex in its middle), so it has two triangles too. Around an edge of the grid that is crossed,
//! each of its four cubes has one run of triangles from one of its faces to the next, and together they go once around.

use std::sync::LazyLock;

/// A vertex in a cube: the edges of the cube come first, middles of loops from this number on.
pub(super) const MIDDLES: u8 = 12;

/// The triangles of one case.
#[derive(Clone, Debug, Default)]
pub(super) struct Case {
    /// Three vertices each.
    pub(super) triangles: Vec<[u8; 3]>,
    /// The loops that have a vertex in the middle.
    pub(super) middles: Vec<Vec<u8>>,
}

/// All cases: those of corners `c` at `starts[c]`, and there by the decisions on its ambiguous faces, the first of them as the lowest bit.
#[derive(Debug)]
pub(super) struct Cases {
    cases: Vec<Case>,
    starts: Vec<u32>,
    /// Ambiguous faces, as bits.
    ambiguous: Vec<u8>,
}

/// The cases, made at first use.
pub(super) static CASES: LazyLock<Cases> = LazyLock::new(Cases::new);

/// Corner at the low end of an edge. Edge `4 a + u + 2 v` runs along axis `a`, at `u` along the next axis and at `v` along the one after that.
pub(super) fn edge_start(edge: u8) -> u8 {
    let (axis, u, v) = (edge / 4, edge & 1, edge >> 1 & 1);
    u << ((axis + 1) % 3) | v << ((axis + 2) % 3)
}

/// Axis of an edge.
pub(super) fn edge_axis(edge: u8) -> u8 {
    edge / 4
}

/// The corners of face `2 a + side`, counter-clockwise from outside.
pub(super) fn face_corners(face: u8) -> [u8; 4] {
    let (axis, side) = (face / 2, face & 1);
    let corner = |u: u8, v: u8| side << axis | u << ((axis + 1) % 3) | v << ((axis + 2) % 3);
    let ring = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
    if side == 1 { ring } else { [ring[0], ring[3], ring[2], ring[1]] }
}

/// The edge between two corners that are next to one another.
fn edge_between(a: u8, b: u8) -> u8 {
    let low = a.min(b);
    let axis = (a ^ b).trailing_zeros() as u8;
    let (u, v) = (low >> ((axis + 1) % 3) & 1, low >> ((axis + 2) % 3) & 1);
    4 * axis + u + 2 * v
}

/// Whether two edges belong to one face.
fn share_face(a: u8, b: u8) -> bool {
    (0..6).any(|face| {
        let ring = face_corners(face);
        let has = |edge| (0..4).any(|k| edge_between(ring[k], ring[(k + 1) % 4]) == edge);
        has(a) && has(b)
    })
}

impl Cases {
    fn new() -> Self {
        let (mut cases, mut starts, mut ambiguous) = (Vec::new(), Vec::new(), Vec::new());
        for corners in 0..=u8::MAX {
            let faces: Vec<u8> = (0..6).filter(|&face| is_ambiguous(corners, face)).collect();
            starts.push(cases.len() as u32);
            ambiguous.push(faces.iter().fold(0, |bits, face| bits | 1 << face));
            for decisions in 0..1_u8 << faces.len() {
                let joined = faces.iter().enumerate().fold(0, |bits, (k, face)| bits | (decisions >> k & 1) << face);
                cases.push(Case::of(&loops(corners, joined)));
            }
        }
        Self { cases, starts, ambiguous }
    }

    /// The case of a cube; bit `c` of `corners` says that corner `c` is inside, and `joined` says for an ambiguous face whether its corners inside are cut off together.
    pub(super) fn of(&self, corners: u8, joined: impl Fn(u8) -> bool) -> &Case {
        let (mut decisions, mut bit) = (0, 0);
        let faces = self.ambiguous[corners as usize];
        for face in (0..6).filter(|face| faces >> face & 1 == 1) {
            decisions |= u32::from(joined(face)) << bit;
            bit += 1;
        }
        &self.cases[(self.starts[corners as usize] + decisions) as usize]
    }
}

/// Whether the corners of a face are inside and outside in turn.
fn is_ambiguous(corners: u8, face: u8) -> bool {
    let [a, b, c, d] = face_corners(face).map(|corner| corners >> corner & 1);
    a == c && b == d && a != b
}

/// The loops in which the surface meets the faces of a cube, as edges; seen from outside of the surface they run clockwise.
fn loops(corners: u8, joined: u8) -> Vec<Vec<u8>> {
    let mut next = [u8::MAX; 12];
    for face in 0..6 {
        let ring = face_corners(face);
        let inside = |k: usize| corners >> ring[k % 4] & 1 == 1;
        let edge = |k: usize| edge_between(ring[k % 4], ring[(k + 1) % 4]);
        // A segment from where the ring comes out to where it goes in: back to this corner, or on to the next one that is inside.
        for out in (0..4).filter(|&k| inside(k) && !inside(k + 1)) {
            let onwards = (1..4).map(|step| out + step).find(|&k| !inside(k) && inside(k + 1));
            let backwards = (1..4).map(|step| out + 4 - step).find(|&k| !inside(k) && inside(k + 1));
            let into = if joined >> face & 1 == 1 { onwards } else { backwards };
            next[edge(out) as usize] = into.map_or(u8::MAX, edge);
        }
    }
    let mut found = Vec::new();
    for start in 0..12 {
        let mut ring = Vec::new();
        let mut at = start;
        while next[at as usize] != u8::MAX {
            ring.push(at);
            at = std::mem::replace(&mut next[at as usize], u8::MAX);
        }
        if !ring.is_empty() {
            found.push(ring);
        }
    }
    found
}

impl Case {
    fn of(loops: &[Vec<u8>]) -> Self {
        let mut case = Self::default();
        for ring in loops {
            let mut triangles = Vec::new();
            if filled(ring, 0, ring.len() - 1, &mut triangles) {
                case.triangles.extend(triangles);
            } else {
                let middle = MIDDLES + case.middles.len() as u8;
                let next = |k: usize| ring[(k + 1) % ring.len()];
                case.triangles.extend((0..ring.len()).map(|k| [next(k), ring[k], middle]));
                case.middles.push(ring.clone());
            }
        }
        case
    }
}

/// Fills the part of a ring from `i` to `j` with triangles, if it can be done without diagonals on a face.
fn filled(ring: &[u8], i: usize, j: usize, triangles: &mut Vec<[u8; 3]>) -> bool {
    if j - i < 2 {
        return true;
    }
    let may = |a: usize, b: usize| b - a == 1 || a == 0 && b == ring.len() - 1 || !share_face(ring[a], ring[b]);
    // From the middle outwards: triangles that are less thin.
    let mut between: Vec<usize> = (i + 1..j).collect();
    between.sort_by_key(|&k| (2 * k).abs_diff(i + j));
    for k in between {
        let so_far = triangles.len();
        if may(i, k) && may(k, j) && filled(ring, i, k, triangles) && filled(ring, k, j, triangles) {
            triangles.push([ring[j], ring[k], ring[i]]);
            return true;
        }
        triangles.truncate(so_far);
    }
    false
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// Every edge of a case's triangles with the directions in which it is run through.
    fn edges(case: &Case) -> BTreeMap<(u8, u8), Vec<bool>> {
        let mut edges: BTreeMap<_, Vec<bool>> = BTreeMap::new();
        for t in &case.triangles {
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                edges.entry((a.min(b), a.max(b))).or_default().push(a < b);
            }
        }
        edges
    }

    #[test]
    fn each_case_is_discs_whose_rims_are_segments_on_faces() {
        for corners in 0..=u8::MAX {
            for joined in 0..64_u8 {
                let case = CASES.of(corners, |face| joined >> face & 1 == 1);
                let mut ends = [0; 12];
                for ((a, b), ways) in edges(case) {
                    let on_face = b < MIDDLES && share_face(a, b);
                    assert_eq!(ways.len(), if on_face { 1 } else { 2 }, "{corners:08b} {joined:06b}: {a} {b}");
                    assert!(on_face || ways[0] != ways[1]);
                    if on_face {
                        ends[a as usize] += 1;
                        ends[b as usize] += 1;
                    }
                }
                for edge in 0..12 {
                    let (from, to) = (edge_start(edge), edge_start(edge) | 1 << edge_axis(edge));
                    let crossed = (corners >> from ^ corners >> to) & 1 == 1;
                    assert_eq!(ends[edge as usize], if crossed { 2 } else { 0 }, "{corners:08b}: edge {edge}");
                }
            }
        }
    }

    #[test]
    fn a_corner_is_cut_off_by_a_triangle_that_faces_away_from_it() {
        let case = CASES.of(0b1, |_| false);
        assert_eq!(case.triangles.len(), 1);
        let middle = |edge: u8| {
            let mut p = arabesque_core::Vector([0, 1, 2].map(|k| f64::from(edge_start(edge) >> k & 1)));
            p[edge_axis(edge) as usize] += 0.5;
            p
        };
        let [a, b, c] = case.triangles[0].map(middle);
        assert!((b - a).cross(c - a).0.iter().all(|&n| n > 0.0));
    }

    #[test]
    fn two_corners_of_a_face_are_cut_off_one_by_one_or_together() {
        // Corners 0 and 3 of the lower face.
        let apart = CASES.of(0b1001, |_| false);
        assert_eq!(apart.triangles.len(), 2);
        let together = CASES.of(0b1001, |_| true);
        assert_eq!(together.triangles.len(), 4);
    }
}
