//! Filled areas on a bent lattice: united flat in the coordinates of the exemplar, and carried over point by point.

use arabesque_core::{Budget, Covered, FillRule, Outline, Result, Ring, Vector};

use crate::regular::{
    areas::{Cut, united},
    bend::{chart::Chart, strokes::BentStrokes},
    grid::Ground,
};

/// Points of borders that are carried over are no farther apart than this share of the shorter vector.
const STEP: f64 = 0.06;

/// Work for a point that is carried over.
const POINT: u64 = 1500;

/// Adds the areas of all charts to `made`.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop; what is made by then is whole.
pub(crate) fn draw(strokes: &BentStrokes<'_>, made: &mut Vec<Covered<2>>) -> Result<()> {
    let bending = strokes.bending;
    let budget = &bending.request.budget.stage("filling areas");
    let cut = Cut::new(&Ground { grid: strokes.flat, request: bending.request, obstacles: bending.obstacles });
    let charts = &bending.charts.all;
    let nodes = charts.iter().map(|chart| strokes.nodes(chart)).collect::<Result<Vec<_>>>()?;
    for area in &strokes.cell.areas {
        let mut parts: Vec<Ring<2>> = Vec::new();
        for (chart, nodes) in charts.iter().zip(&nodes) {
            let flat = united(area, strokes.flat, nodes, budget)?;
            let inside = flat.try_intersection(&Outline { rings: chart.border() }, budget)?;
            for ring in &inside.rings {
                parts.push(carried(chart, ring, STEP * bending.lattice.shorter(), budget)?);
            }
        }
        let whole = Outline::try_union(&parts, FillRule::EvenOdd, budget)?;
        let outline = cut.apply(whole, budget)?;
        if !outline.rings.is_empty() {
            made.push(Covered { outline, source: area.source, paint: strokes.flat.map() });
        }
    }
    Ok(())
}

fn carried(chart: &Chart, ring: &[Vector<2>], step: f64, budget: &Budget) -> Result<Ring<2>> {
    let mut bent = Vec::with_capacity(ring.len());
    for (k, &a) in ring.iter().enumerate() {
        let b = ring[(k + 1) % ring.len()];
        let count = ((b - a).norm() / step).ceil().clamp(1.0, 1e5);
        budget.spend(POINT * count as u64)?;
        let images = (0..count as usize).map(|n| a + (b - a) * (n as f64 / count));
        bent.extend(images.filter_map(|image| Some(chart.find_near(image)?.at)));
    }
    Ok(bent)
}
