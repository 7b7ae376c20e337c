//! How many elements of each class the output should have.

use arabesque_core::{Border, Bounds, Exemplar, Numbered, Request, Result};

use crate::{border::Extent, exemplar::library::Library};

/// Cells along the longest side of the grid that measures the output.
const CELLS: f64 = 96.0;

/// Share of its half width that an element at a wall keeps from it.
const PRESSED: f64 = 0.5;

/// Numbers of elements of each class: their intensity in the exemplar's window times the usable measure of the output,
/// each place counted by its local scale and density.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn class_targets<const D: usize>(
    library: &Library<D>,
    request: &Request<D>,
    extent: &Extent<'_, D>,
    base: u32,
) -> Result<Numbered<f64>> {
    let budget = request.budget.stage("measuring what is to be filled");
    let mut meter = budget.meter();
    let reach = border_reach(library, extent.exemplar(), request.border, base);
    let bounds = match request.domain.period() {
        Some(_) => request.domain.bounds(),
        None => request.domain.bounds().grown(extent.margin),
    };
    let size = bounds.size();
    let step = size.0.into_iter().fold(0.0, f64::max) / if D == 2 { CELLS } else { 0.4 * CELLS };
    let cells: [usize; D] = std::array::from_fn(|k| ((size[k] / step).ceil() as usize).max(1));
    let count: usize = cells.iter().product();
    let cell_measure = bounds.measure() / count as f64;
    let slab = slab(extent.exemplar(), library);
    let mut usable = vec![0.0; library.classes()];
    for c in 0..count {
        let p = bounds.cell_centre(c, &cells);
        meter.spend(100 + 2 * reach.len() as u64)?;
        let frame = request.fields.frame(p);
        let distance = request.domain.signed_distance(p);
        if extent.is_blocked(p, 0.0) {
            continue;
        }
        let low = match (&slab, &request.ground) {
            (Some(slab), Some(ground)) => Some(ground.height(p) <= slab.thickness * frame.element_scale),
            _ => None,
        };
        for (c, (sum, reach)) in usable.iter_mut().zip(&reach).enumerate() {
            if low.is_some_and(|low| slab.as_ref().is_some_and(|slab| slab.stands[c] != low)) {
                continue;
            }
            if distance >= reach * frame.element_scale {
                *sum += cell_measure / frame.spacing_scale.powi(D as i32);
            }
        }
    }
    let mut intensity = intensities(library);
    if let (Some(slab), Some(_)) = (&slab, &request.ground) {
        let share = slab.share;
        for (value, stands) in intensity.iter_mut().zip(&slab.stands) {
            *value /= if *stands { share } else { (1.0 - share).max(0.05) };
        }
    }
    Ok(usable.iter().zip(intensity).map(|(area, per)| area * per).collect())
}

/// The part of the exemplar near the ground, where those that stand on it are and nothing else is.
struct Slab {
    /// Up to which height it is.
    thickness: f64,
    /// Its share of the exemplar's window.
    share: f64,
    /// Whether each class stands on the ground.
    stands: Vec<bool>,
}

fn slab<const D: usize>(exemplar: &Exemplar<D>, library: &Library<D>) -> Option<Slab> {
    let standing: Vec<f64> = exemplar.heights.iter().flatten().copied().collect();
    if standing.is_empty() {
        return None;
    }
    let mean = standing.iter().sum::<f64>() / standing.len() as f64;
    let up = exemplar.up.min(D - 1);
    let floors = exemplar.elements.iter().zip(&exemplar.heights).find_map(|(e, h)| Some(e.centre[up] - (*h)?));
    let (low, high) = (exemplar.window.min[up], exemplar.window.max[up]);
    let everything = exemplar.heights.iter().all(Option::is_some);
    let thickness = if everything { f64::INFINITY } else { 2.0 * mean };
    let is_standing = |c: u32| library.members(c).iter().any(|&e| exemplar.heights[e as usize].is_some());
    let stands = (0..library.classes() as u32).map(is_standing).collect();
    let within = (floors? + thickness).min(high) - low;
    Some(Slab { thickness, share: (within / (high - low)).clamp(0.02, if everything { 1.0 } else { 0.98 }), stands })
}

/// How far inside the border the centres of each class lie in the mean; negative outside.
fn border_reach<const D: usize>(library: &Library<D>, exemplar: &Exemplar<D>, border: Border, base: u32) -> Vec<f64> {
    (0..library.classes() as u32)
        .map(|c| {
            let members = library.members(c);
            let reach = |e: u32| to_wall(exemplar, e).unwrap_or(library.radius[e]);
            let mean = members.iter().map(|&e| reach(e)).sum::<f64>() / members.len().max(1) as f64;
            let is_stroke = members.first().is_some_and(|&e| e >= base);
            match if is_stroke { Border::Clip } else { border } {
                Border::Inside | Border::Turn => mean,
                Border::Cross => 0.0,
                Border::Clip => -0.8 * mean,
            }
        })
        .collect()
}

/// How near to a wall the centre of a solid element comes, in the mean: long ones lie along it, and what lies in a heap is pressed to it, so
/// that it is nearer than half of its mean width.
fn to_wall<const D: usize>(exemplar: &Exemplar<D>, element: u32) -> Option<f64> {
    let element = exemplar.elements.get(element as usize).filter(|_| !exemplar.solids.is_empty())?;
    let size = Bounds::around(element.outline.points()).size();
    Some(PRESSED * 0.5 * size.0.into_iter().sum::<f64>() / D as f64)
}

/// Elements of each class per measure of the exemplar's window.
fn intensities<const D: usize>(library: &Library<D>) -> Vec<f64> {
    let inside = |e: &&u32| library.view.contains(library.centre[**e]);
    let count = |c: u32| library.members(c).iter().filter(inside).count() as f64;
    (0..library.classes() as u32).map(|c| count(c) / library.view.measure()).collect()
}
