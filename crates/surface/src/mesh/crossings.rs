//! Where a mesh passes through itself.

use arabesque_core::{Bounds, Budget, Result, Vector};
use rayon::prelude::*;

use super::{index::MeshIndex, triangle};

/// Most neighbours that one triangle is compared with: where there are more, triangles lie in heaps.
const MOST: usize = 400;
/// Most boxes that are looked at for one triangle: where there are more, thousands of triangles meet in one corner.
const LOOKED: usize = 20_000;

/// Triangles that cross another one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Crossings {
    pub(crate) count: usize,
    /// Near the first of them.
    pub(crate) first: Option<Vector<3>>,
    /// Whether every pair was compared.
    pub(crate) is_whole: bool,
}

/// Counts triangles that cross others which share no vertex with them.
pub(crate) fn crossings(index: &MeshIndex, budget: &Budget) -> Result<Crossings> {
    let topology = &index.topology;
    let one = |t: u32| {
        let corners = topology.corners(t);
        let bounds = Bounds::around(corners);
        let (mut crossed, mut compared, mut met) = (false, 0, 0);
        let own = topology.triangles[t as usize];
        let looked = index.meeting(&bounds, |other| {
            met += 1;
            let theirs = topology.triangles[other as usize];
            if other != t && !theirs.iter().any(|v| own.contains(v)) {
                let others = topology.corners(other);
                if overlap(&bounds, &Bounds::around(others)) {
                    compared += 1;
                    crossed = triangle::cross(&corners, &others);
                }
            }
            !crossed && compared < MOST && met < LOOKED
        });
        (crossed, compared < MOST && met < LOOKED, looked * 8 + compared as u64 * 60)
    };
    let chunks: Result<Vec<Crossings>> = (0..topology.triangles.len().div_ceil(512))
        .into_par_iter()
        .map(|chunk| {
            let (mut sum, mut meter) = (Crossings { is_whole: true, ..Crossings::default() }, budget.meter());
            for t in chunk * 512..(chunk * 512 + 512).min(topology.triangles.len()) {
                let (crossed, is_whole, work) = one(t as u32);
                meter.spend(work)?;
                sum.is_whole &= is_whole || crossed;
                if crossed {
                    sum.count += 1;
                    sum.first = sum.first.or_else(|| Some(triangle::at(&topology.corners(t as u32), [1.0 / 3.0; 3])));
                }
            }
            Ok(sum)
        })
        .collect();
    let chunks = chunks?;
    budget.spend(0)?;
    Ok(chunks.into_iter().fold(Crossings { is_whole: true, ..Crossings::default() }, |a, b| Crossings {
        count: a.count + b.count,
        first: a.first.or(b.first),
        is_whole: a.is_whole && b.is_whole,
    }))
}

/// Whether boxes have more in common than a side: what lies in boxes that touch does not cross.
fn overlap(a: &Bounds<3>, b: &Bounds<3>) -> bool {
    (0..3).all(|k| a.max[k] > b.min[k] && b.max[k] > a.min[k] || a.min[k] == a.max[k] || b.min[k] == b.max[k])
        && a.intersects(b)
}
