//! The pair-correlation function: how many elements lie at a distance from others, over what there would be at random.
//!
//! Distances are those of centres. Where the shell around an element leaves the domain, what it has is divided by the share of it that
//! lies inside (the local form of Ripley's correction). The noise of a count is taken out of differences: its square root has a variance of
//! a quarter.

use arabesque_core::{Bounds, Budget, Domain, GridIndex, Result, Vector};
use rayon::prelude::*;

use crate::{
    natural::{Natural, Rule, Side},
    report::{Curve, Measure, NamedCurve},
    scene::Scene,
    verdict::Family,
};

/// Classes that are told apart; the rest is one.
const CLASSES: usize = 6;
/// Width of a bin and number of bins, in spacings.
const BIN: f64 = 0.2;
const BINS: usize = 15;
/// Directions in which a shell is looked at.
const DIRECTIONS: usize = 24;
/// Work for each bin of an element, and for each pair.
const SHELL: u64 = 400;
const PAIR: u64 = 12;
/// Elements of a class or of the whole, below which nothing is told of it.
const FEWEST: f64 = 12.0;

/// Counts by pair of classes and bin.
#[derive(Clone, Debug)]
struct Pairs {
    classes: usize,
    /// Weighted number of pairs, by first class, second class, bin.
    found: Vec<f64>,
    /// The same at random.
    expected: Vec<f64>,
}

impl Pairs {
    fn none(classes: usize) -> Self {
        let cells = classes * classes * BINS;
        Self { classes, found: vec![0.0; cells], expected: vec![0.0; cells] }
    }

    fn at(&self, a: usize, b: usize, bin: usize) -> usize {
        (a * self.classes + b) * BINS + bin
    }

    /// The function of a pair in a bin, with the number of pairs at random; both orders are one.
    fn value(&self, (a, b): (usize, usize), bin: usize) -> (f64, f64) {
        let (one, two) = (self.at(a, b, bin), self.at(b, a, bin));
        let expected = self.expected[one] + self.expected[two];
        // A pair within one class is counted twice.
        ((self.found[one] + self.found[two]) / expected.max(1e-12), expected * if a == b { 0.25 } else { 0.5 })
    }

    /// Root mean square difference of the square roots of two functions over all pairs and bins, without the noise of the counts.
    fn difference(&self, other: Option<&Self>) -> f64 {
        let (mut sum, mut weight) = (0.0, 0.0);
        for a in 0..self.classes {
            for b in a..self.classes {
                for bin in 0..BINS {
                    let (own, pairs) = self.value((a, b), bin);
                    let (theirs, more) = other.map_or((1.0, f64::INFINITY), |o| o.value((a, b), bin));
                    let certain = pairs.min(more);
                    if certain < 2.0 {
                        continue;
                    }
                    let noise = 0.25 * (own.min(1.0) / pairs + theirs.min(1.0) / more);
                    // What is known of few pairs counts less, of more than a hundred not more.
                    let w = certain.min(100.0);
                    sum += w * ((own.sqrt() - theirs.sqrt()).powi(2) - noise);
                    weight += w;
                }
            }
        }
        (sum / f64::max(weight, 1e-12)).max(0.0).sqrt()
    }
}

/// Numbers of the classes that are told apart: the most frequent ones of the exemplar.
fn kinds<const D: usize>(exemplar: &Scene<'_, D>) -> Vec<usize> {
    let mut counts = vec![0_usize; exemplar.classes()];
    exemplar.bodies.iter().for_each(|b| counts[b.class] += 1);
    let mut order: Vec<usize> = (0..counts.len()).collect();
    order.sort_by_key(|&k| (std::cmp::Reverse(counts[k]), k));
    let mut kinds = vec![CLASSES.min(counts.len().saturating_sub(1)); counts.len()];
    for (kind, &class) in order.iter().enumerate() {
        kinds[class] = kind.min(CLASSES);
    }
    kinds
}

/// A scene with its elements found by place.
struct Placed<'a, const D: usize> {
    scene: &'a Scene<'a, D>,
    centres: Vec<Vector<D>>,
    kinds: Vec<usize>,
    index: GridIndex<D>,
}

impl<'a, const D: usize> Placed<'a, D> {
    /// `kinds` of the classes; what is of none of them is left out.
    fn new(scene: &'a Scene<'a, D>, kinds: &[usize]) -> Self {
        let inside = scene.bodies.iter().filter(|b| b.class < kinds.len() && scene.domain.contains(b.centre));
        let (centres, kinds): (Vec<Vector<D>>, Vec<usize>) = inside.map(|b| (b.centre, kinds[b.class])).unzip();
        let bounds = Domain::Box(scene.domain.bounds());
        let index = GridIndex::new(&centres, BIN * BINS as f64 * scene.spacing * 0.5, &bounds);
        Self { scene, centres, kinds, index }
    }

    /// The pairs whose first element lies in a part.
    fn count(&self, part: Option<&Bounds<D>>, classes: usize, budget: &Budget) -> Result<Pairs> {
        let width = BIN * self.scene.spacing;
        let measure = self.scene.domain.measure();
        let mut of_kind = vec![0.0; classes];
        self.kinds.iter().for_each(|&k| of_kind[k] += 1.0);
        let ways: Vec<Vector<D>> = directions();
        let ball =
            |r: f64| if D == 2 { std::f64::consts::PI * r * r } else { 4.0 / 3.0 * std::f64::consts::PI * r.powi(3) };
        let chosen: Vec<usize> =
            (0..self.centres.len()).filter(|&i| part.is_none_or(|part| part.contains(self.centres[i]))).collect();
        let chunk = |chunk: &[usize]| -> Result<Pairs> {
            let mut pairs = Pairs::none(classes);
            let mut meter = budget.meter();
            for &i in chunk {
                let (p, kind) = (self.centres[i], self.kinds[i]);
                let depth = self.scene.domain.signed_distance(p);
                let mut shares = [1.0_f64; BINS];
                for (bin, share) in shares.iter_mut().enumerate() {
                    let r = (bin as f64 + 0.5) * width;
                    if r > depth {
                        meter.spend(SHELL)?;
                        let inside = ways.iter().filter(|&&way| self.scene.domain.contains(p + way * r)).count();
                        *share = inside as f64 / ways.len() as f64;
                    }
                    // Where nearly nothing of a shell is seen, it tells nothing.
                    if *share < 0.2 {
                        *share = 0.0;
                        continue;
                    }
                    let shell = (ball((bin as f64 + 1.0) * width) - ball(bin as f64 * width)) / measure;
                    for (other, count) in of_kind.iter().enumerate() {
                        let at = pairs.at(kind, other, bin);
                        pairs.expected[at] += shell * (count - f64::from(u8::from(other == kind)));
                    }
                }
                let reach = BINS as f64 * width;
                meter.spend(PAIR * self.index.load(p, reach))?;
                self.index.within(p, reach, |j, offset| {
                    let bin = (offset.norm() / width) as usize;
                    if j != i && bin < BINS && shares[bin] > 0.0 {
                        let at = pairs.at(kind, self.kinds[j], bin);
                        pairs.found[at] += 1.0 / shares[bin];
                    }
                });
            }
            Ok(pairs)
        };
        let parts: Vec<Pairs> = chosen.par_chunks(256).map(chunk).collect::<Result<_>>()?;
        budget.spend(0)?;
        Ok(parts.into_iter().fold(Pairs::none(classes), |mut all, part| {
            all.found.iter_mut().zip(part.found).for_each(|(a, b)| *a += b);
            all.expected.iter_mut().zip(part.expected).for_each(|(a, b)| *a += b);
            all
        }))
    }
}

/// Directions that spread evenly.
fn directions<const D: usize>() -> Vec<Vector<D>> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let way = |k: usize| {
        if D == 2 {
            let turn = k as f64 / DIRECTIONS as f64 * std::f64::consts::TAU;
            return Vector(std::array::from_fn(|axis| if axis == 0 { turn.cos() } else { turn.sin() }));
        }
        let z = 1.0 - 2.0 * (k as f64 + 0.5) / DIRECTIONS as f64;
        let (turn, flat) = (golden * k as f64, (1.0 - z * z).sqrt());
        Vector(std::array::from_fn(|axis| [turn.cos() * flat, turn.sin() * flat, z][axis.min(2)]))
    };
    (0..DIRECTIONS).map(way).collect()
}

/// Compares the pairs of elements.
pub(crate) fn pairs<const D: usize>(
    exemplar: &Scene<'_, D>,
    result: &Scene<'_, D>,
    budget: &Budget,
) -> Result<(Option<Measure>, Vec<NamedCurve>)> {
    let kinds = kinds(exemplar);
    let classes = kinds.iter().max().map_or(0, |k| k + 1);
    let (one, two) = (Placed::new(exemplar, &kinds), Placed::new(result, &kinds));
    if (one.centres.len() as f64) < FEWEST || (two.centres.len() as f64) < FEWEST {
        return Ok((None, Vec::new()));
    }
    let (own, found) = (one.count(None, classes, budget)?, two.count(None, classes, budget)?);
    // How far the exemplar itself is from chance is what differences are told in.
    let order = own.difference(None).max(0.15);
    let mut parts = Vec::new();
    for (part, share) in exemplar.parts() {
        let part = one.count(Some(&part), classes, budget)?;
        parts.push((part.difference(Some(&own)) / order, share));
    }
    let rule = Rule {
        name: "pairs of elements",
        family: Family::Distances,
        unit: "ratio",
        means: "How different the distances between elements are, by class: 0 as in the exemplar, 1 as if they were scattered at random.",
        side: Side::Above,
        least: 0.25,
        most: 0.4,
    };
    let times = result.domain.measure() / exemplar.domain.measure();
    let measure = rule.judge(&Natural { whole: 0.0, parts, times }, found.difference(Some(&own)) / order);
    Ok((Some(measure), curves(exemplar, &kinds, (&own, &found))))
}

fn curves<const D: usize>(exemplar: &Scene<'_, D>, kinds: &[usize], (own, found): (&Pairs, &Pairs)) -> Vec<NamedCurve> {
    let name = |kind: usize| {
        let members: Vec<usize> = (0..kinds.len()).filter(|&k| kinds[k] == kind).collect();
        match members.as_slice() {
            [class] => exemplar.content.classes[*class].name.clone(),
            _ => "others".to_owned(),
        }
    };
    let mut curves = Vec::new();
    for a in 0..own.classes {
        for b in a..own.classes {
            let values = |pairs: &Pairs| (0..BINS).map(|bin| pairs.value((a, b), bin).0).collect::<Vec<f64>>();
            let at = (0..BINS).map(|bin| (bin as f64 + 0.5) * BIN).collect();
            let curve = Curve { at, exemplar: values(own), result: values(found) };
            curves.push(NamedCurve { classes: vec![name(a), name(b)], curve });
        }
    }
    curves
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Exemplar, Stage, Stream};

    use super::*;

    fn function(points: &[Vector<2>], side: f64, spacing: f64) -> Vec<f64> {
        let mut content = Exemplar::from_points("t", points, &vec![0; points.len()], &["a".into()]).unwrap();
        content.window = Bounds::new(Vector::ZERO, Vector::splat(side));
        let budget = Budget::default();
        let scene = Scene::new(&content, Domain::Box(content.window), spacing, &budget).unwrap();
        let pairs = Placed::new(&scene, &[0]).count(None, 1, &budget).unwrap();
        (0..BINS).map(|bin| pairs.value((0, 0), bin).0).collect()
    }

    #[test]
    fn points_at_random_have_one_everywhere_even_at_the_border() {
        let mut random = Stream::new(5, Stage::TEST, 0);
        let points: Vec<_> = (0..4000).map(|_| Vector::xy(random.range(0.0, 20.0), random.range(0.0, 20.0))).collect();
        for (bin, g) in function(&points, 20.0, 1.0).into_iter().enumerate() {
            assert!((g - 1.0).abs() < 0.08, "bin {bin}: {g}");
        }
    }

    #[test]
    fn a_lattice_has_pairs_at_its_steps_alone() {
        let points: Vec<_> = (0..400).map(|k| Vector::xy(f64::from(k % 20) + 0.5, f64::from(k / 20) + 0.5)).collect();
        let g = function(&points, 20.0, 1.0);
        assert!(g[..4].iter().all(|v| *v == 0.0) && g[5] > 2.0, "{g:?}");
        assert!(g[6] == 0.0 && g[7] > 2.0 && g[8] == 0.0, "the diagonal, then nothing: {g:?}");
    }

    #[test]
    fn a_hard_core_leaves_the_near_bins_empty() {
        let mut random = Stream::new(6, Stage::TEST, 0);
        let mut points: Vec<Vector<2>> = Vec::new();
        for _ in 0..20_000 {
            let p = Vector::xy(random.range(0.0, 20.0), random.range(0.0, 20.0));
            if points.iter().all(|&q| (p - q).norm() >= 0.8) {
                points.push(p);
            }
        }
        let g = function(&points, 20.0, 1.0);
        assert!(g[..4].iter().all(|v| *v == 0.0) && g[4] > 1.2, "{g:?}");
    }
}
