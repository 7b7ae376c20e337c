//! Points of a solid that lie inside of another one, or of itself.

use arabesque_core::{Bounds, Budget, Result, Vector};
use rayon::prelude::*;

use crate::{dipoles::Dipoles, tree::Tree};

/// On a closed surface the winding number is one half, inside of another solid one more.
const BURIED: f64 = 1.05;
/// Share of points with an opposite one close by from which there may be solids inside of one another.
const TOUCHING: usize = 200;

/// The points of a sheet that are inside of what the sheet surrounds: where rings pass through one another they hide no surface, but disturb it. Sheets that keep clear
/// of themselves have none. `sheet` has numbers of points, and so has the answer, in the same order.
pub(crate) fn buried(
    points: &[Vector<3>],
    normals: &[Vector<3>],
    spacing: &[f64],
    sheet: &[usize],
    budget: &Budget,
) -> Result<Vec<usize>> {
    budget.spend(sheet.len() as u64 * 500)?;
    let boxes: Vec<_> = sheet.iter().map(|&i| Bounds::new(points[i], points[i])).collect();
    let tree = Tree::new(&boxes);
    if facing(points, normals, spacing, sheet, &tree) * TOUCHING < sheet.len() {
        return Ok(Vec::new());
    }
    let piece = |k: u32| {
        let i = sheet[k as usize];
        (points[i], normals[i] * (spacing[i] * spacing[i]))
    };
    let dipoles = Dipoles::new(&tree, piece);
    let chunk = |chunk: &[usize]| -> Result<Vec<usize>> {
        let (mut found, mut meter) = (Vec::new(), budget.meter());
        for &i in chunk {
            // Pieces are discs, not points: near-by ones fill less than a dipole would.
            let angle = |k: u32| {
                let (at, area) = piece(k);
                let (offset, soft) = (at - points[i], 0.5 * spacing[sheet[k as usize]]);
                area.dot(offset) / (offset.norm2() + soft * soft).powf(1.5)
            };
            let (winding, looked) = dipoles.winding(&tree, points[i], angle);
            meter.spend(looked * 12)?;
            found.extend((winding > BURIED).then_some(i));
        }
        Ok(found)
    };
    let chunks: Result<Vec<_>> = sheet.par_chunks(256).map(chunk).collect();
    Ok(chunks?.into_iter().flatten().collect())
}

/// How many of some points spread over the sheet have one close by that faces them or their back.
fn facing(points: &[Vector<3>], normals: &[Vector<3>], spacing: &[f64], sheet: &[usize], tree: &Tree) -> usize {
    let is_faced = |&i: &usize| {
        let (mut is_faced, reach) = (false, 1.5 * spacing[i]);
        tree.meeting(&Bounds::new(points[i], points[i]).grown(reach), |k| {
            let j = sheet[k as usize];
            is_faced = (points[j] - points[i]).norm() < reach && normals[j].dot(normals[i]) < -0.5;
            !is_faced
        });
        is_faced
    };
    sheet.par_iter().filter(|i| is_faced(i)).count()
}
