//! How many elements of each class there are, and whether they grow more or fewer from place to place.

use arabesque_core::{Bounds, Domain};

use crate::{
    natural::{Rule, Side},
    report::{ClassDensity, Measure},
    scene::Scene,
    verdict::Family,
};

/// Standard deviations that the worst of several classes may be off.
const DEVIATIONS: f64 = 3.0;
/// Variance of a count over its mean, at least and at most: a lattice has little, points at random one.
const FANO: (f64, f64) = (0.05, 1.2);
/// What the border of a window does to a count: its variance, for each square root of the count.
const BORDER: f64 = 0.25;

/// Elements of the classes in a window.
struct Counts {
    all: f64,
    of_class: Vec<f64>,
    measure: f64,
}

fn counts<const D: usize>(scene: &Scene<'_, D>, part: &Bounds<D>) -> Counts {
    let all = scene.domain.bounds();
    let mut counts =
        Counts { all: 0.0, of_class: vec![0.0; scene.classes()], measure: measure_of(&scene.domain, part) };
    for body in &scene.bodies {
        // Half of what the border cuts has its middle inside; where the middle of a part is that of the whole is not known.
        let (place, weight) = if body.is_whole { (body.centre, 1.0) } else { (all.clamp(body.centre), 0.5) };
        if !part.contains(place) || (body.is_whole && !scene.domain.contains(place)) {
            continue;
        }
        counts.all += weight;
        if let Some(count) = counts.of_class.get_mut(body.class) {
            *count += weight;
        }
    }
    counts
}

/// Cells along each side with which the part of a shape in a box is measured.
const CELLS: [usize; 2] = [160, 32];

/// Area or volume of what lies in a part of a domain.
fn measure_of<const D: usize>(domain: &Domain<D>, part: &Bounds<D>) -> f64 {
    if let Domain::Box(all) = domain {
        let common = Bounds::new(all.min.zip(part.min, f64::max), all.max.zip(part.max, f64::min));
        return if common.is_empty() { 0.0 } else { common.measure() };
    }
    let cells = [CELLS[usize::from(D > 2)]; D];
    let all: usize = cells.iter().product();
    let inside = (0..all).filter(|&k| domain.contains(part.cell_centre(k, &cells))).count();
    part.measure() * inside as f64 / all as f64
}

/// Variance over mean of counts in parts of the exemplar.
fn fano(parts: &[f64]) -> f64 {
    let n = parts.len() as f64;
    let mean = parts.iter().sum::<f64>() / n;
    let variance = parts.iter().map(|c| (c - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    (variance / mean.max(1e-9)).clamp(FANO.0, FANO.1)
}

/// Variance of a count.
fn variance(count: f64, fano: f64) -> f64 {
    (fano * count).max(BORDER * count.sqrt()).max(0.25)
}

/// Compares the numbers of elements.
pub(crate) fn density<const D: usize>(
    exemplar: &Scene<'_, D>,
    result: &Scene<'_, D>,
) -> (Vec<Measure>, Vec<ClassDensity>) {
    let (own, found) = (counts(exemplar, &exemplar.domain.bounds()), counts(result, &result.domain.bounds()));
    if own.all < 4.0 || own.measure <= 0.0 || found.measure <= 0.0 {
        return (Vec::new(), Vec::new());
    }
    let quarters: Vec<Counts> =
        exemplar.parts().iter().filter(|(_, share)| *share < 0.5).map(|(part, _)| counts(exemplar, part)).collect();
    let times = found.measure / own.measure;
    // Standard deviation of the ratio of two densities.
    let deviation = |count: f64, fano: f64| {
        let expected = count * times;
        (variance(count, fano) / count.powi(2) + variance(expected, fano) / expected.powi(2)).sqrt()
    };
    let of_all = fano(&quarters.iter().map(|q| q.all).collect::<Vec<_>>());
    let rule = Rule {
        name: "elements in all",
        family: Family::Density,
        unit: "of the exemplar's",
        means: "Elements for each unit of area over those of the exemplar; less means too few.",
        side: Side::Both,
        least: 0.03,
        most: 0.3,
    };
    let half = (DEVIATIONS * deviation(own.all, of_all)).clamp(rule.least, rule.most);
    let mut measures = vec![rule.judge_within(1.0, half, found.all / times / own.all)];
    measures.extend(of_classes(exemplar, (&own, &found), &|k| {
        let fano = fano(&quarters.iter().map(|q| q.of_class[k]).collect::<Vec<_>>());
        (fano, DEVIATIONS * deviation(own.of_class[k], fano))
    }));
    measures.extend(drift(result, of_all));
    let cell = exemplar.spacing.powi(D as i32);
    let classes = (0..exemplar.classes()).map(|k| ClassDensity {
        class: exemplar.content.classes[k].name.clone(),
        exemplar: own.of_class[k] / own.measure * cell,
        result: found.of_class[k] / found.measure * cell,
    });
    (measures, classes.collect())
}

/// The class whose number is off most.
fn of_classes<const D: usize>(
    exemplar: &Scene<'_, D>,
    (own, found): (&Counts, &Counts),
    natural: &dyn Fn(usize) -> (f64, f64),
) -> Option<Measure> {
    let rule = Rule {
        name: "elements by class",
        family: Family::Density,
        unit: "of the exemplar's",
        means: "The class whose number is off most, over its share in the exemplar; a class that is missing has 0.",
        side: Side::Both,
        least: 0.05,
        most: 0.8,
    };
    if exemplar.classes() < 2 {
        return None;
    }
    let times = found.measure / own.measure;
    let each = (0..exemplar.classes()).filter(|&k| own.of_class[k] >= 3.0).map(|k| {
        let (_, half) = natural(k);
        let mut measure =
            rule.judge_within(1.0, half.clamp(rule.least, rule.most), found.of_class[k] / times / own.of_class[k]);
        measure.about = Some(exemplar.content.classes[k].name.clone());
        measure
    });
    each.max_by(|a, b| a.fault.total_cmp(&b.fault))
}

/// How much the halves of the result differ in density, the worst way across.
fn drift<const D: usize>(result: &Scene<'_, D>, fano: f64) -> Option<Measure> {
    let all = result.domain.bounds();
    let rule = Rule {
        name: "drift of density",
        family: Family::Density,
        unit: "share",
        means: "How much denser one half of the page is than the other, the worst way across; a true pattern stays the same everywhere.",
        side: Side::Above,
        least: 0.03,
        most: 0.5,
    };
    let across = (0..D).filter_map(|axis| {
        let halves = [0.0, 0.5].map(|start| {
            let mut half = all;
            half.min[axis] = all.min[axis] + start * all.size()[axis];
            half.max[axis] = half.min[axis] + 0.5 * all.size()[axis];
            counts(result, &half)
        });
        let [a, b] = &halves;
        if a.all + b.all < 8.0 || a.measure <= 0.0 || b.measure <= 0.0 {
            return None;
        }
        let (one, two) = (a.all / a.measure, b.all / b.measure);
        let mean = 0.5 * (a.all + b.all);
        let half = DEVIATIONS * (2.0 * variance(mean, fano)).sqrt() / mean;
        let mut measure =
            rule.judge_within(0.0, half.clamp(rule.least, rule.most), 2.0 * (one - two).abs() / (one + two));
        measure.about = Some(["left and right", "top and bottom", "front and back"][axis.min(2)].to_owned());
        Some(measure)
    });
    across.max_by(|a, b| a.fault.total_cmp(&b.fault))
}
