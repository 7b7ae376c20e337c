//! The pieces of a surface that hang together: the boards of a shelf, the members of a stack.

use std::collections::HashMap;

use arabesque_core::DisjointSets;
use rapier3d::math::Vector as Vec3;

/// A piece of a surface.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub(crate) points: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// The pieces of a surface whose triangles share corners, in the order of their first triangles; corners at one place are one.
pub(crate) fn pieces(points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Piece> {
    let mut first_at = HashMap::with_capacity(points.len());
    let welded: Vec<usize> = points
        .iter()
        .enumerate()
        .map(|(k, p)| *first_at.entry(p.to_array().map(|v| (v + 0.0).to_bits())).or_insert(k))
        .collect();
    let mut sets = DisjointSets::new(points.len());
    for [a, b, c] in triangles.iter().map(|t| t.map(|k| welded[k as usize])) {
        sets.join(a, b);
        sets.join(b, c);
    }
    let mut number_of = vec![None; points.len()];
    let mut found: Vec<Piece> = Vec::new();
    let mut own = vec![u32::MAX; points.len()];
    for corners in triangles.iter().map(|t| t.map(|k| welded[k as usize])) {
        let number = *number_of[sets.of(corners[0])].get_or_insert_with(|| {
            found.push(Piece { points: Vec::new(), triangles: Vec::new() });
            found.len() - 1
        });
        let piece = &mut found[number];
        piece.triangles.push(corners.map(|k| {
            if own[k] == u32::MAX {
                own[k] = piece.points.len() as u32;
                piece.points.push(points[k]);
            }
            own[k]
        }));
    }
    found
}
