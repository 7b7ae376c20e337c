//! Points of a solid that lie inside of another one, or of itself.

use arabesque_core::{Bounds, Budget, Meter, Result, Vector};
use rayon::prelude::*;

use crate::{dipoles::Dipoles, tree::Tree};

/// On a closed surface the winding number is one half, in a hollow up to one, inside of another solid one more: a point is buried at so many times what most have.
const BURIED: f64 = 2.2;
/// Where most have less, too little is surrounded to tell.
const OPEN: f64 = 0.1;
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
    budget.spend(sheet.len() as u64 * 100)?;
    let boxes: Vec<_> = sheet.iter().map(|&i| Bounds::new(points[i], points[i])).collect();
    let tree = Tree::new(&boxes, budget)?;
    if facing((points, normals, spacing), sheet, &tree, budget)? * TOUCHING < sheet.len() {
        return Ok(Vec::new());
    }
    let piece = |k: u32| {
        let i = sheet[k as usize];
        (points[i], normals[i] * (spacing[i] * spacing[i]))
    };
    let dipoles = Dipoles::new(&tree, piece);
    let chunk = |chunk: &[usize]| -> Result<Vec<f64>> {
        let (mut found, mut meter) = (Vec::new(), budget.meter());
        for &i in chunk {
            // Pieces are discs, not points: near-by ones fill less than a dipole would.
            let angle = |k: u32| {
                let (at, area) = piece(k);
                let (offset, soft) = (at - points[i], 0.3 * spacing[sheet[k as usize]]);
                area.dot(offset) / (offset.norm2() + soft * soft).powf(1.5)
            };
            let (winding, looked) = dipoles.winding(&tree, points[i], angle);
            meter.spend(looked * 12)?;
            found.push(winding);
        }
        Ok(found)
    };
    let chunks: Result<Vec<_>> = sheet.par_chunks(256).map(chunk).collect();
    let chunks = chunks?;
    budget.spend(0)?;
    let windings: Vec<f64> = chunks.into_iter().flatten().collect();
    let mut sorted = windings.clone();
    let half = sorted.len() / 2;
    let usual = *sorted.select_nth_unstable_by(half, f64::total_cmp).1;
    let is_buried = |&(_, &winding): &(&usize, &f64)| usual > OPEN && winding > BURIED * usual;
    Ok(sheet.iter().zip(&windings).filter(is_buried).map(|(&i, _)| i).collect())
}

/// How many of some points spread over the sheet have one close by that faces them or their back.
fn facing(
    (points, normals, spacing): (&[Vector<3>], &[Vector<3>], &[f64]),
    sheet: &[usize],
    tree: &Tree,
    budget: &Budget,
) -> Result<usize> {
    let is_faced = |i: usize, meter: &mut Meter<'_>| -> Result<bool> {
        let (mut is_faced, reach) = (false, 1.5 * spacing[i]);
        let looked = tree.meeting(&Bounds::new(points[i], points[i]).grown(reach), |k| {
            let j = sheet[k as usize];
            is_faced = (points[j] - points[i]).norm() < reach && normals[j].dot(normals[i]) < -0.5;
            !is_faced
        });
        meter.spend(looked * 8)?;
        Ok(is_faced)
    };
    let chunk = |chunk: &[usize]| -> Result<usize> {
        let mut meter = budget.meter();
        chunk.iter().try_fold(0, |count, &i| Ok(count + usize::from(is_faced(i, &mut meter)?)))
    };
    let facing = sheet.par_chunks(256).map(chunk).try_reduce(|| 0, |a, b| Ok(a + b))?;
    budget.spend(0)?;
    Ok(facing)
}
