//! Holes and clumps: how far places are from ink, and how evenly ink is spread.
//!
//! The empty-space function tells, for every distance, the share of places that have no ink so near. An eye sees its far end: the holes.
//! Unevenness is the standard deviation of the share of ink under a bell half a spacing wide, over its mean: holes and clumps together.

use arabesque_core::{Bounds, Budget, Result, Vector};
use rayon::prelude::*;

use crate::{
    natural::{Natural, Rule, Side},
    quantiles::{quantile, shares},
    report::{Curve, Fault, Mark, Measure},
    scene::Scene,
    spread::raster::Raster,
    verdict::Family,
};

/// Quantiles of the empty-space function that are told.
const QUANTILES: [f64; 5] = [0.5, 0.9, 0.99, 0.999, 1.0];
/// Least and most half width of the natural range of each, as a share of the exemplar's.
const WIDTHS: [(f64, f64); 5] = [(0.08, 0.16), (0.06, 0.14), (0.07, 0.14), (0.1, 0.2), (0.3, 0.5)];
const NAMES: [&str; 5] =
    ["empty space, half of the page", "empty space, 90 %", "empty space, 99 %", "empty space, 99.9 %", "largest hole"];
const MEANS: [&str; 5] = [
    "Half of all places are nearer to ink than this.",
    "Nine places in ten are nearer to ink than this; more means wider gaps everywhere.",
    "One place in a hundred is farther from ink than this; more means holes that the exemplar does not have.",
    "One place in a thousand is farther from ink than this; more means a few clear holes.",
    "No place is farther from ink than this; a larger page has rarer holes, so somewhat more is natural.",
];
/// Least and most half width of the natural range of unevenness, as a share of the exemplar's.
const UNEVEN: (f64, f64) = (0.09, 0.2);
/// Standard deviation of the bell under which ink is looked at, in spacings.
const BELL: f64 = 0.5;
/// What distances may be off where the exemplar has none, in spacings.
const NOTHING: f64 = 0.02;
/// Worst places that are marked, of each fault.
const MARKS: usize = 8;
/// More than the most ink anywhere in the exemplar by this factor is a clump.
const CLUMP: f64 = 1.06;
/// Work for each cell.
const CELL: u64 = 30;

/// A scene as ink on a grid.
pub(crate) struct Field<const D: usize> {
    pub(crate) raster: Raster<D>,
    pub(crate) distances: Vec<f32>,
    around: Vec<f32>,
    /// Depth of every cell below the border of the domain.
    pub(crate) depths: Vec<f32>,
    /// Cells around which everything is seen.
    inner: Vec<usize>,
}

/// Figures of a field, or of a part of it.
struct Figures {
    quantiles: [f64; 5],
    unevenness: f64,
    ink: f64,
}

impl<const D: usize> Field<D> {
    /// Draws a scene with cells of side `pitch`.
    pub(crate) fn of(scene: &Scene<'_, D>, pitch: f64, budget: &Budget) -> Result<Self> {
        let raster = Raster::of(scene, pitch, budget)?;
        let _held = budget.hold("the cells of a page", 24 * raster.ink.len())?;
        budget.spend(CELL * raster.ink.len() as u64)?;
        let depth = |k: usize| scene.domain.signed_distance(raster.middle(k)) as f32;
        let depths: Vec<f32> = (0..raster.ink.len()).into_par_iter().map(depth).collect();
        let inside: Vec<bool> = depths.iter().map(|&d| d >= 0.0).collect();
        let around = raster.smoothed(BELL * scene.spacing, &inside, budget)?;
        let distances = raster.distances(budget)?;
        let inner = (0..depths.len()).filter(|&k| f64::from(depths[k]) >= scene.margin).collect();
        Ok(Self { raster, distances, around, depths, inner })
    }

    fn cells(&self, part: Option<&Bounds<D>>) -> Vec<usize> {
        let in_part = |&&k: &&usize| part.is_none_or(|part| part.contains(self.raster.middle(k)));
        self.inner.iter().filter(in_part).copied().collect()
    }

    /// Distances of the cells of a part, sorted, in spacings.
    fn sorted(&self, cells: &[usize], spacing: f64) -> Vec<f64> {
        let mut sorted: Vec<f64> = cells.iter().map(|&k| f64::from(self.distances[k]) / spacing).collect();
        sorted.par_sort_unstable_by(f64::total_cmp);
        sorted
    }

    /// Share of ink of all that lies in a part, up to the border: ink is seen there as well as elsewhere.
    fn ink(&self, part: Option<&Bounds<D>>) -> f64 {
        let (mut all, mut ink) = (0.0, 0.0);
        for (k, _) in self.depths.iter().enumerate().filter(|(_, depth)| **depth >= 0.0) {
            if part.is_none_or(|part| part.contains(self.raster.middle(k))) {
                all += 1.0;
                ink += f64::from(u8::from(self.raster.ink[k]));
            }
        }
        ink / f64::max(all, 1.0)
    }

    fn figures(&self, part: Option<&Bounds<D>>, spacing: f64) -> Option<Figures> {
        let cells = self.cells(part);
        let sorted = self.sorted(&cells, spacing);
        if cells.is_empty() || sorted.last().is_some_and(|d| d.is_infinite()) {
            return None;
        }
        let n = cells.len() as f64;
        let mean = cells.iter().map(|&k| f64::from(self.around[k])).sum::<f64>() / n;
        let variance = cells.iter().map(|&k| (f64::from(self.around[k]) - mean).powi(2)).sum::<f64>() / n;
        Some(Figures {
            quantiles: QUANTILES.map(|q| quantile(&sorted, q)),
            unevenness: variance.sqrt() / mean.max(1e-9),
            ink: self.ink(part),
        })
    }
}

/// What is told of holes and clumps.
pub(crate) struct Evenness {
    pub(crate) measures: Vec<Measure>,
    pub(crate) curve: Option<Curve>,
    pub(crate) marks: Vec<Mark>,
}

/// Compares the ink of two scenes.
pub(crate) fn evenness<const D: usize>(
    exemplar: (&Scene<'_, D>, &Field<D>),
    result: (&Scene<'_, D>, &Field<D>),
) -> Option<Evenness> {
    let spacing = exemplar.0.spacing;
    let times = result.0.domain.measure() / exemplar.0.domain.measure();
    let (own, found) = (exemplar.1.figures(None, spacing)?, result.1.figures(None, spacing)?);
    let parts: Vec<(Figures, f64)> = exemplar
        .0
        .parts()
        .into_iter()
        .filter_map(|(part, share)| Some((exemplar.1.figures(Some(&part), spacing)?, share)))
        .collect();
    let natural = |of: &dyn Fn(&Figures) -> f64| Natural {
        whole: of(&own),
        parts: parts.iter().map(|(figures, share)| (of(figures), *share)).collect(),
        times,
    };
    let mut measures = Vec::new();
    for k in 0..QUANTILES.len() {
        let whole = own.quantiles[k];
        let rule = Rule {
            name: NAMES[k],
            family: Family::Evenness,
            unit: "spacings",
            means: MEANS[k],
            side: if k < 2 { Side::Both } else { Side::Above },
            least: WIDTHS[k].0 * whole + NOTHING,
            most: WIDTHS[k].1 * whole + NOTHING,
        };
        measures.push(rule.judge(&natural(&|f| f.quantiles[k]), found.quantiles[k]));
    }
    let rule = Rule {
        name: "unevenness",
        family: Family::Evenness,
        unit: "ratio",
        means: "How much the share of ink under a bell half a spacing wide varies, over its mean; more means holes and clumps.",
        side: Side::Above,
        least: UNEVEN.0 * own.unevenness + 0.01,
        most: UNEVEN.1 * own.unevenness + 0.01,
    };
    measures.push(rule.judge(&natural(&|f| f.unevenness), found.unevenness));
    let rule = Rule {
        name: "ink",
        family: Family::Density,
        unit: "share",
        means: "Share of the page that is covered; less means that things are too few or too small.",
        side: Side::Both,
        least: 0.06 * own.ink + 0.002,
        most: 0.2 * own.ink + 0.002,
    };
    measures.push(rule.judge(&natural(&|f| f.ink), found.ink));
    let curve = |field: &Field<D>| {
        let sorted = field.sorted(&field.cells(None), spacing);
        shares().map(|q| quantile(&sorted, q)).collect::<Vec<f64>>()
    };
    let curve = Curve { at: shares().collect(), exemplar: curve(exemplar.1), result: curve(result.1) };
    let widest = measures[3].high.unwrap_or(0.0).max(own.quantiles[4] * 1.1);
    let mut marks = holes(result, widest * spacing, own.quantiles[4]);
    let most = exemplar.1.inner.iter().map(|&k| exemplar.1.around[k]).fold(0.0, f32::max);
    marks.extend(clumps(result, CLUMP * f64::from(most)));
    Some(Evenness { measures, curve: Some(curve), marks })
}

/// The worst cells by `value`, none within the reach of a worse one.
fn worst_cells<const D: usize>(
    field: &Field<D>,
    values: &[f32],
    least: f64,
    reach: impl Fn(f64) -> f64,
) -> Vec<(Vector<D>, f64)> {
    let mut cells: Vec<usize> = field.inner.iter().copied().filter(|&k| f64::from(values[k]) > least).collect();
    cells.sort_by(|&a, &b| values[b].total_cmp(&values[a]).then(a.cmp(&b)));
    let mut found: Vec<(Vector<D>, f64)> = Vec::new();
    for k in cells {
        let (p, value) = (field.raster.middle(k), f64::from(values[k]));
        if found.iter().all(|(q, other)| (p - *q).norm() > reach(*other)) {
            found.push((p, value));
            if found.len() == MARKS {
                break;
            }
        }
    }
    found
}

fn holes<const D: usize>(result: (&Scene<'_, D>, &Field<D>), widest: f64, natural: f64) -> Vec<Mark> {
    let (scene, field) = result;
    let cells = worst_cells(field, &field.distances, widest, |d| 1.5 * d);
    let mark = |(at, d): (Vector<D>, f64)| Mark {
        fault: Fault::Hole,
        at: at.0.to_vec(),
        radius: d,
        says: format!("{:.2} spacings from ink, where the exemplar has {natural:.2} at most", d / scene.spacing),
        outline: Vec::new(),
    };
    cells.into_iter().map(mark).collect()
}

fn clumps<const D: usize>(result: (&Scene<'_, D>, &Field<D>), most: f64) -> Vec<Mark> {
    let (scene, field) = result;
    let reach = 2.5 * scene.spacing;
    let mark = |(at, share): (Vector<D>, f64)| Mark {
        fault: Fault::Clump,
        at: at.0.to_vec(),
        radius: 1.25 * scene.spacing,
        says: format!(
            "{:.0} % ink around, where the exemplar has {:.0} % at most",
            100.0 * share,
            100.0 * most / CLUMP
        ),
        outline: Vec::new(),
    };
    worst_cells(field, &field.around, most, |_| reach).into_iter().map(mark).collect()
}
