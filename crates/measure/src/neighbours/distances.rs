//! The nearest-neighbour function: how much clear space every element has, by class and by pair of classes.

use std::collections::BTreeMap;

use arabesque_core::Bounds;

use crate::{
    natural::{Natural, Rule, Side},
    neighbours::clearance::Near,
    quantiles::{quantile, shares},
    report::{Curve, Measure, NamedCurve},
    scene::Scene,
    verdict::Family,
};

/// Pairs of classes are told where they have so many neighbours, in the exemplar.
const FEWEST: usize = 12;
/// Share of neighbours that stand for the least distance.
const LEAST: f64 = 0.01;
/// The same in the mean of so few that they have no hundredth.
fn least_share(count: usize) -> f64 {
    LEAST.max(1.0 / (count as f64 + 1.0))
}

/// Longest list of classes that are told one by one.
const CLASSES: usize = 12;

/// A scene with who is near to whom.
pub(crate) struct Neighbourhood<'a, const D: usize> {
    pub(crate) scene: &'a Scene<'a, D>,
    pub(crate) near: &'a [Vec<Near>],
}

impl<const D: usize> Neighbourhood<'_, D> {
    /// Elements around which everything is seen.
    fn inner(&self, part: Option<&Bounds<D>>) -> impl Iterator<Item = usize> + '_ {
        let part = part.copied();
        let is_in = move |i: &usize| {
            let centre = self.scene.bodies[*i].centre;
            self.scene.is_inner(centre) && part.is_none_or(|part| part.contains(centre))
        };
        (0..self.near.len()).filter(is_in)
    }

    /// Clearances to the nearest element, sorted, in spacings; of one class alone where one is given.
    fn nearest(&self, class: Option<usize>, part: Option<&Bounds<D>>) -> Vec<f64> {
        let of_class = |i: &usize| class.is_none_or(|class| self.scene.bodies[*i].class == class);
        let least = |i: usize| self.near[i].iter().map(|n| n.clearance).reduce(f64::min);
        let mut found: Vec<f64> =
            self.inner(part).filter(of_class).filter_map(least).map(|d| d / self.scene.spacing).collect();
        found.sort_by(f64::total_cmp);
        found
    }

    /// Clearances from every element to the nearest of each class, by the pair of classes, sorted, in spacings.
    fn of_pairs(&self) -> BTreeMap<(usize, usize), Vec<f64>> {
        let mut pairs: BTreeMap<(usize, usize), Vec<f64>> = BTreeMap::new();
        for i in self.inner(None) {
            let mut least: BTreeMap<usize, f64> = BTreeMap::new();
            for n in &self.near[i] {
                let best = least.entry(self.scene.bodies[n.other].class).or_insert(f64::INFINITY);
                *best = best.min(n.clearance / self.scene.spacing);
            }
            let own = self.scene.bodies[i].class;
            for (other, d) in least {
                pairs.entry((own.min(other), own.max(other))).or_default().push(d);
            }
        }
        pairs.values_mut().for_each(|list| list.sort_by(f64::total_cmp));
        pairs
    }
}

/// Mean difference of two distributions, by their quantiles.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let steps = 40;
    let at = |k: usize| (k as f64 + 0.5) / f64::from(steps as u32);
    (0..steps).map(|k| (quantile(a, at(k)) - quantile(b, at(k))).abs()).sum::<f64>() / steps as f64
}

/// Compares the clear space around elements.
pub(crate) fn distances<const D: usize>(
    exemplar: &Neighbourhood<'_, D>,
    result: &Neighbourhood<'_, D>,
) -> (Vec<Measure>, Vec<NamedCurve>) {
    let (own, found) = (exemplar.nearest(None, None), result.nearest(None, None));
    if own.len() < FEWEST || found.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let times = result.scene.domain.measure() / exemplar.scene.domain.measure();
    let parts: Vec<(Vec<f64>, f64)> = exemplar
        .scene
        .parts()
        .into_iter()
        .map(|(part, share)| (exemplar.nearest(None, Some(&part)), share))
        .filter(|(list, _)| list.len() >= 4)
        .collect();
    let natural = |of: &dyn Fn(&[f64]) -> f64| Natural {
        whole: of(&own),
        parts: parts.iter().map(|(list, share)| (of(list), *share)).collect(),
        times,
    };
    let mut measures = Vec::new();
    let rules = [
        (
            "nearest element, closest",
            least_share(own.len()),
            "The closest of the exemplar have this much clear space, and as many in a hundred here; less means that some come too close.",
            Side::Below,
        ),
        ("nearest element, half", 0.5, "Half of the elements have less clear space than this.", Side::Both),
    ];
    for (name, q, means, side) in rules {
        let whole = quantile(&own, q);
        let (least, most) = (0.12 * whole + 0.03, 0.3 * whole + 0.04);
        let rule = Rule { name, family: Family::Distances, unit: "spacings", means, side, least, most };
        measures.push(rule.judge(&natural(&|list| quantile(list, q)), quantile(&found, q)));
    }
    let scatter = difference(&own, &[quantile(&own, 0.5); 2]);
    let rule = Rule {
        name: "nearest elements, all",
        family: Family::Distances,
        unit: "spacings",
        means: "Mean difference between the clear space around elements here and in the exemplar, from the closest to the loneliest.",
        side: Side::Above,
        least: 0.03,
        most: 0.03 + 0.4 * scatter,
    };
    measures.push(rule.judge(&natural(&|list| difference(list, &own)), difference(&found, &own)));
    measures.extend(closest_pair(exemplar, result));
    (measures, curves(exemplar, result))
}

/// The pair of classes whose least distance is off most.
fn closest_pair<const D: usize>(exemplar: &Neighbourhood<'_, D>, result: &Neighbourhood<'_, D>) -> Option<Measure> {
    if exemplar.scene.classes() < 2 {
        return None;
    }
    let found = result.of_pairs();
    let name = |k: usize| exemplar.scene.content.classes.get(k).map_or("unlike any", |c| c.name.as_str());
    let each = exemplar.of_pairs().into_iter().filter(|(_, list)| list.len() >= FEWEST).filter_map(|(pair, own)| {
        let found = found.get(&pair).filter(|list| list.len() >= FEWEST)?;
        // The least of few is no hundredth: the same share is looked at in both. How certain it is, the next ones tell.
        let share = least_share(own.len());
        let (least, next) = (quantile(&own, share), quantile(&own, 0.15_f64.max(3.0 * share)));
        let rule = Rule {
            name: "least distance by pair of classes",
            family: Family::Distances,
            unit: "spacings",
            means: "The pair of classes that come closer than they do in the exemplar: the clear space of the closest.",
            side: Side::Below,
            least: 0.05,
            most: 0.5,
        };
        let half = (0.15 * least + (next - least)).max(rule.least);
        let mut measure = rule.judge_within(least, half, quantile(found, share));
        measure.about = Some(format!("{} and {}", name(pair.0), name(pair.1)));
        Some(measure)
    });
    each.max_by(|a, b| a.fault.total_cmp(&b.fault))
}

fn curves<const D: usize>(exemplar: &Neighbourhood<'_, D>, result: &Neighbourhood<'_, D>) -> Vec<NamedCurve> {
    let quantiles = |list: &[f64]| shares().map(|q| quantile(list, q)).collect();
    let class = |k: usize| {
        let (own, found) = (exemplar.nearest(Some(k), None), result.nearest(Some(k), None));
        let curve = Curve { at: shares().collect(), exemplar: quantiles(&own), result: quantiles(&found) };
        let classes = vec![exemplar.scene.content.classes[k].name.clone()];
        (own.len() >= FEWEST && !found.is_empty()).then_some(NamedCurve { classes, curve })
    };
    (0..exemplar.scene.classes().min(CLASSES)).filter_map(class).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distributions_differ_by_what_one_is_moved() {
        let a: Vec<f64> = (0..50).map(|k| 0.02 * f64::from(k)).collect();
        let b: Vec<f64> = a.iter().map(|v| v + 0.3).collect();
        assert!((difference(&a, &b) - 0.3).abs() < 1e-9 && difference(&a, &a) == 0.0);
    }
}
