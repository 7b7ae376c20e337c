//! What is left to tidy after cutting.

use arabesque_core::DisjointSets;

use super::patch::Patch;

/// Drops parts that hang together and are smaller than `least` in area, but never all; answers how many, and their share of the area.
pub(crate) fn crumbs(patch: &mut Patch, least: f64) -> (usize, f64) {
    let mut sets = DisjointSets::new(patch.vertices.len());
    for t in &patch.triangles {
        sets.join(t[0] as usize, t[1] as usize);
        sets.join(t[0] as usize, t[2] as usize);
    }
    let mut areas = vec![0.0; patch.vertices.len()];
    for t in &patch.triangles {
        let [a, b, c] = t.map(|v| patch.vertices[v as usize].at);
        areas[sets.of(t[0] as usize)] += 0.5 * (b - a).cross(c - a).norm();
    }
    let largest = areas.iter().copied().fold(0.0, f64::max);
    let least = least.min(largest);
    let small = || areas.iter().filter(|&&area| area > 0.0 && area < least);
    let (dropped, share) = (small().count(), small().sum::<f64>() / areas.iter().sum::<f64>().max(f64::MIN_POSITIVE));
    if dropped > 0 {
        patch.triangles.retain(|t| areas[sets.of(t[0] as usize)] >= least);
        *patch = std::mem::take(patch).compact();
    }
    (dropped, share)
}

/// Gives each fan of triangles a vertex of its own, where several fans meet in one vertex.
pub(crate) fn pinches(patch: &mut Patch) {
    // Corners of triangles by vertex; those that share an edge at the vertex are of one fan.
    let mut corners: Vec<(u32, u32)> =
        patch.triangles.iter().enumerate().flat_map(|(t, c)| c.map(|v| (v, t as u32))).collect();
    corners.sort_unstable();
    for at in corners.chunk_by(|a, b| a.0 == b.0) {
        let v = at[0].0;
        // The next and the previous vertex of each triangle.
        let wings: Vec<(u32, u32)> = at
            .iter()
            .map(|&(_, t)| {
                let c = patch.triangles[t as usize];
                let k = c.iter().position(|&w| w == v).unwrap_or(0);
                (c[(k + 1) % 3], c[(k + 2) % 3])
            })
            .collect();
        let mut sets = DisjointSets::new(at.len());
        for i in 0..at.len() {
            for j in 0..i {
                if wings[i].0 == wings[j].1 || wings[i].1 == wings[j].0 {
                    sets.join(i, j);
                }
            }
        }
        for fan in sets.groups().iter().skip(1) {
            let copy = patch.vertices.len() as u32;
            patch.vertices.push(patch.vertices[v as usize]);
            for &i in fan {
                let triangle = &mut patch.triangles[at[i].1 as usize];
                triangle.iter_mut().filter(|w| **w == v).for_each(|w| *w = copy);
            }
        }
    }
}
