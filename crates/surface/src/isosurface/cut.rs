//! Cutting a surface along a level.

use arabesque_core::DisjointSets;

use super::patch::Patch;

/// Cuts keep so far from the ends of edges, as a share of them, so that no triangle is without area.
const MARGIN: f64 = 0.05;

/// The part of a surface where `values`, one for each vertex, are not positive. Edges are cut where the values between their ends reach zero.
pub(crate) fn cut(patch: Patch, values: &[f32]) -> Patch {
    let kept = |v: u32| values[v as usize] <= 0.0;
    if (0..patch.vertices.len() as u32).all(kept) {
        return patch;
    }
    let sides = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
    let ends = |(a, b): (u32, u32)| (a.min(b), a.max(b));
    let mut crossed: Vec<(u32, u32)> =
        patch.triangles.iter().flat_map(sides).filter(|&(a, b)| kept(a) != kept(b)).map(ends).collect();
    crossed.sort_unstable();
    crossed.dedup();
    let first = patch.vertices.len() as u32;
    let mut vertices = patch.vertices;
    for &(a, b) in &crossed {
        let (from, to) = (f64::from(values[a as usize]), f64::from(values[b as usize]));
        let share = (from / (from - to)).clamp(MARGIN, 1.0 - MARGIN);
        // A value that is not finite tells no place.
        let share = if share.is_finite() { share } else { 0.5 };
        vertices.push(vertices[a as usize].towards(&vertices[b as usize], share));
    }
    let between = |a: u32, b: u32| first + crossed.partition_point(|&edge| edge < ends((a, b))) as u32;
    let mut triangles = Vec::with_capacity(patch.triangles.len());
    for t in patch.triangles {
        match t.iter().filter(|&&v| kept(v)).count() {
            3 => triangles.push(t),
            2 => {
                let k = t.iter().position(|&v| !kept(v)).unwrap_or(0);
                let [out, a, b] = [t[k], t[(k + 1) % 3], t[(k + 2) % 3]];
                let (to_a, to_b) = (between(out, a), between(out, b));
                triangles.extend([[to_a, a, b], [to_a, b, to_b]]);
            }
            1 => {
                let k = t.iter().position(|&v| kept(v)).unwrap_or(0);
                let [own, a, b] = [t[k], t[(k + 1) % 3], t[(k + 2) % 3]];
                triangles.push([own, between(own, a), between(own, b)]);
            }
            _ => {}
        }
    }
    Patch { vertices, triangles }.compact()
}

/// For each vertex how far it is beyond the border of the points, positive where it is to be cut off. Places where points are sparse look like a border too; they are one only
/// where they hang together with an edge of the surface.
pub(crate) fn beyond_border(patch: &Patch) -> Vec<f32> {
    let mut values: Vec<f32> =
        patch.vertices.iter().map(|v| if v.beyond.is_nan() { 1.0 } else { v.beyond.min(2.0) - 1.0 }).collect();
    let mut sides: Vec<(u32, u32)> = patch
        .triangles
        .iter()
        .flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])])
        .map(|(a, b)| (a.min(b), a.max(b)))
        .collect();
    sides.sort_unstable();
    let mut sets = DisjointSets::new(values.len());
    let mut is_rim = vec![false; values.len()];
    for along in sides.chunk_by(|a, b| a == b) {
        let (a, b) = along[0];
        if values[a as usize] > 0.0 && values[b as usize] > 0.0 {
            sets.join(a as usize, b as usize);
        }
        if along.len() == 1 {
            is_rim[a as usize] = true;
            is_rim[b as usize] = true;
        }
    }
    let mut has_rim = vec![false; values.len()];
    for v in (0..values.len()).filter(|&v| is_rim[v] && values[v] > 0.0) {
        has_rim[sets.of(v)] = true;
    }
    for v in 0..values.len() {
        if values[v] > 0.0 && !has_rim[sets.of(v)] {
            values[v] = -1e-3;
        }
    }
    values
}
