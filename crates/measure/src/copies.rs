//! How much was taken over from the exemplar in one piece.
//!
//! Features are the middles of elements by class, and the ends and junctions of strokes by degree. A part of the result is a copy when one
//! and the same shift carries every feature in it onto one of the exemplar. Such parts are grown from pairs of features with the same
//! nearest neighbour; those larger than a neighbourhood count. What the exemplar repeats by itself, shifted onto itself, is natural.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Budget, Domain, GridIndex, Result, Vector};

use crate::{
    natural::{Rule, Side},
    report::{Fault, Mark, Measure},
    scene::Scene,
    strokes::Graph,
    verdict::Family,
};

/// Difference of places that are the same, in spacings.
const SAME: f64 = 0.05;
/// The same where the exemplar is compared with itself: what repeats by hand is never the same to the point.
const LIKE: f64 = 0.15;
/// A part grows to features within this distance, in spacings.
const STEP: f64 = 1.8;
/// Area of a neighbourhood, in square spacings; a part must be larger.
const NEIGHBOURHOOD: f64 = 13.0;
/// Features of a part at least.
const FEWEST: usize = 10;
/// Shifts that are tried for one feature.
const SHIFTS: usize = 12;
/// Work for each feature that is looked at.
const LOOK: u64 = 30;
/// Copies that are marked.
const MARKS: usize = 6;

/// Places that can be recognised.
struct Features<const D: usize> {
    places: Vec<Vector<D>>,
    kinds: Vec<usize>,
    /// Way to the nearest other one, and its kind.
    nearest: Vec<Option<(Vector<D>, usize)>>,
    index: GridIndex<D>,
}

impl<const D: usize> Features<D> {
    fn of(scene: &Scene<'_, D>, graph: &Graph<D>, budget: &Budget) -> Result<Self> {
        let known = scene.bodies.iter().filter(|b| b.class < scene.classes() && scene.domain.contains(b.centre));
        let classes = scene.classes();
        let nodes = graph.nodes.iter().filter(|n| scene.domain.signed_distance(n.at) > 0.1 * scene.spacing);
        let (places, kinds): (Vec<Vector<D>>, Vec<usize>) =
            known.map(|b| (b.centre, b.class)).chain(nodes.map(|n| (n.at, classes + n.degree.min(6)))).unzip();
        let index = GridIndex::new(&places, scene.spacing, &Domain::Box(scene.domain.bounds()));
        let mut features = Self { nearest: vec![None; places.len()], places, kinds, index };
        let mut meter = budget.meter();
        for i in 0..features.places.len() {
            let p = features.places[i];
            meter.spend(LOOK + features.index.load(p, STEP * scene.spacing))?;
            let found = features.index.nearest(p, STEP * scene.spacing, Some(i));
            features.nearest[i] = found.map(|(j, _)| (features.places[j] - p, features.kinds[j]));
        }
        Ok(features)
    }
}

/// The exemplar as what copies are looked for in.
struct Origin<'a, const D: usize> {
    features: &'a Features<D>,
    /// Features by kind and kind of the nearest.
    by_kinds: BTreeMap<(usize, usize), Vec<usize>>,
    spacing: f64,
    /// Difference of places that are the same, in user units.
    same: f64,
    /// Features of a part from which on it is a copy.
    threshold: usize,
}

/// A part that is a copy.
struct Copied {
    members: Vec<usize>,
}

impl<'a, const D: usize> Origin<'a, D> {
    fn new(features: &'a Features<D>, spacing: f64, measure: f64, same: f64) -> Self {
        let mut by_kinds: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
        for (e, nearest) in features.nearest.iter().enumerate() {
            if let Some((_, kind)) = nearest {
                by_kinds.entry((features.kinds[e], *kind)).or_default().push(e);
            }
        }
        // By the first coordinate of the way, so that those near to a given one stand together.
        let way = |e: usize| features.nearest[e].map_or(0.0, |(way, _)| way[0]);
        by_kinds.values_mut().for_each(|list| list.sort_by(|&a, &b| way(a).total_cmp(&way(b)).then(a.cmp(&b))));
        let density = features.places.len() as f64 * spacing.powi(D as i32) / measure;
        Self {
            features,
            by_kinds,
            spacing,
            same: same * spacing,
            threshold: FEWEST.max((NEIGHBOURHOOD * density).ceil() as usize),
        }
    }

    /// Features of the exemplar whose nearest neighbour lies as that of a feature of the result does.
    fn alike(&self, result: &Features<D>, r: usize) -> Vec<usize> {
        let Some((way, kind)) = result.nearest[r] else { return Vec::new() };
        let Some(list) = self.by_kinds.get(&(result.kinds[r], kind)) else { return Vec::new() };
        let same = self.same;
        let own = |e: usize| self.features.nearest[e].map_or(Vector::ZERO, |(way, _)| way);
        let from = list.partition_point(|&e| own(e)[0] < way[0] - same);
        let near = list[from..].iter().copied().take_while(|&e| own(e)[0] <= way[0] + same);
        let mut near: Vec<(f64, usize)> =
            near.map(|e| ((own(e) - way).norm(), e)).filter(|(d, _)| *d <= same).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.truncate(SHIFTS);
        near.into_iter().map(|(_, e)| e).collect()
    }

    /// The parts of `result` that are copies, each feature in the first large one that has it. Shifts shorter than `shortest` are none.
    fn copies(&self, result: &Features<D>, shortest: f64, budget: &Budget) -> Result<Vec<Copied>> {
        let mut meter = budget.meter();
        let mut is_copied = vec![false; result.places.len()];
        // The part that a feature was last looked at for.
        let mut seen = vec![usize::MAX; result.places.len()];
        let mut round = 0;
        let mut copies = Vec::new();
        for r in 0..result.places.len() {
            meter.spend(LOOK)?;
            if is_copied[r] {
                continue;
            }
            let mut best: Vec<usize> = Vec::new();
            for e in self.alike(result, r) {
                let shift = result.places[r] - self.features.places[e];
                if shift.norm() < shortest {
                    continue;
                }
                let part = self.grown(result, r, shift, (&mut seen, round), &mut meter)?;
                round += 1;
                if part.len() > best.len() {
                    best = part;
                }
                if best.len() >= 4 * self.threshold {
                    break;
                }
            }
            if best.len() >= self.threshold {
                best.iter().for_each(|&k| is_copied[k] = true);
                copies.push(Copied { members: best });
            }
        }
        Ok(copies)
    }

    /// The features around `r` that one shift takes onto those of the exemplar.
    fn grown(
        &self,
        result: &Features<D>,
        r: usize,
        shift: Vector<D>,
        (seen, round): (&mut [usize], usize),
        meter: &mut arabesque_core::Meter<'_>,
    ) -> Result<Vec<usize>> {
        let same = self.same;
        let mut part = vec![r];
        seen[r] = round;
        let mut next = 0;
        while next < part.len() {
            let p = result.places[part[next]];
            next += 1;
            let mut around = Vec::new();
            meter.spend(LOOK + 2 * result.index.load(p, STEP * self.spacing))?;
            result.index.within(p, STEP * self.spacing, |k, _| around.push(k));
            for k in around {
                if seen[k] == round {
                    continue;
                }
                seen[k] = round;
                let found = self.features.index.nearest(result.places[k] - shift, same, None);
                if found.is_some_and(|(e, _)| self.features.kinds[e] == result.kinds[k]) {
                    part.push(k);
                }
            }
        }
        Ok(part)
    }
}

/// Share of features in copies.
fn share(copies: &[Copied], all: usize) -> f64 {
    // A feature may be in two parts; it was copied once.
    let mut members: Vec<usize> = copies.iter().flat_map(|c| c.members.iter().copied()).collect();
    members.sort_unstable();
    members.dedup();
    members.len() as f64 / all.max(1) as f64
}

/// Looks for what was taken over.
pub(crate) fn copies<const D: usize>(
    exemplar: (&Scene<'_, D>, &Graph<D>),
    result: (&Scene<'_, D>, &Graph<D>),
    budget: &Budget,
) -> Result<Option<(Vec<Measure>, Vec<Mark>)>> {
    let own = Features::of(exemplar.0, exemplar.1, budget)?;
    let found = Features::of(result.0, result.1, budget)?;
    let origin = |same: f64| Origin::new(&own, exemplar.0.spacing, exemplar.0.domain.measure(), same);
    let (origin, by_nature) = (origin(SAME), origin(LIKE));
    if own.places.len() < 2 * origin.threshold || found.places.len() < FEWEST {
        return Ok(None);
    }
    let by_itself = by_nature.copies(&own, 0.5 * exemplar.0.spacing, budget)?;
    let taken = origin.copies(&found, -1.0, budget)?;
    let largest = |copies: &[Copied]| copies.iter().map(|c| c.members.len()).max().unwrap_or(0) as f64;
    let natural = share(&by_itself, own.places.len());
    let rule = Rule {
        name: "copied",
        family: Family::Copies,
        unit: "share",
        means: "Share of the page that lies in parts, larger than a neighbourhood, that are shifted copies of parts of the exemplar.",
        side: Side::Above,
        least: 0.35,
        most: 0.35,
    };
    let mut measures = vec![rule.judge_within(natural, rule.least, share(&taken, found.places.len()))];
    let rule = Rule {
        name: "largest copy",
        family: Family::Copies,
        unit: "of the exemplar",
        means: "Size of the largest part that is a copy, over the whole exemplar; 1 means that all of it was pasted.",
        side: Side::Above,
        least: 0.8,
        most: 0.8,
    };
    let size = own.places.len() as f64;
    measures.push(rule.judge_within(largest(&by_itself) / size, rule.least, largest(&taken) / size));
    // In a pattern that repeats every part is a copy of another.
    let marks = if natural > 0.5 { Vec::new() } else { marks(taken, &found, size) };
    Ok(Some((measures, marks)))
}

fn marks<const D: usize>(mut copies: Vec<Copied>, result: &Features<D>, size: f64) -> Vec<Mark> {
    copies.sort_by(|a, b| b.members.len().cmp(&a.members.len()).then(a.members.cmp(&b.members)));
    let mark = |copy: Copied| {
        let places: Vec<Vector<D>> = copy.members.iter().map(|&k| result.places[k]).collect();
        let at = Bounds::around(places.iter().copied()).centre();
        Mark {
            fault: Fault::Copy,
            at: at.0.to_vec(),
            radius: places.iter().map(|&p| (p - at).norm()).fold(0.0, f64::max),
            says: format!("{:.0} % of the exemplar in one piece", 100.0 * places.len() as f64 / size),
            outline: vec![hull(&places)],
        }
    };
    copies.into_iter().take(MARKS).map(mark).collect()
}

/// The convex hull of points of the plane; nothing in space.
fn hull<const D: usize>(places: &[Vector<D>]) -> Vec<[f64; 2]> {
    if D != 2 {
        return Vec::new();
    }
    let mut points: Vec<[f64; 2]> = places.iter().map(|p| [p[0], p[1]]).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut lower = half(&mut points.iter().copied());
    lower.extend(half(&mut points.iter().rev().copied()));
    lower
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Exemplar, Stage, Stream};

    use super::*;

    fn scattered(seed: u64, side: f64, count: usize) -> Vec<Vector<2>> {
        let mut random = Stream::new(seed, Stage::TEST, 0);
        (0..count).map(|_| Vector::xy(random.range(0.0, side), random.range(0.0, side))).collect()
    }

    fn content(points: &[Vector<2>], side: f64) -> Exemplar<2> {
        let mut content = Exemplar::from_points("t", points, &vec![0; points.len()], &["a".into()]).unwrap();
        content.window = Bounds::new(Vector::ZERO, Vector::splat(side));
        content
    }

    fn copied(exemplar: &[Vector<2>], result: &[Vector<2>]) -> (f64, usize) {
        let (own, found) = (content(exemplar, 10.0), content(result, 20.0));
        let budget = Budget::default();
        let scene = |c| Scene::new(c, Domain::Box(c.window), 1.0, &budget).unwrap();
        let graph = Graph::default();
        let told = copies((&scene(&own), &graph), (&scene(&found), &graph), &budget).unwrap().unwrap();
        (told.0[0].result, told.1.len())
    }

    #[test]
    fn a_pasted_page_is_a_copy_and_another_page_is_none() {
        let exemplar = scattered(3, 10.0, 100);
        let shifts = [(0.0, 0.0), (10.0, 0.0), (0.0, 10.0), (10.0, 10.0)].map(|(x, y)| Vector::xy(x, y));
        let pasted: Vec<_> = shifts.iter().flat_map(|&s| exemplar.iter().map(move |&p| p + s)).collect();
        let (share, marks) = copied(&exemplar, &pasted);
        assert!(share > 0.9 && marks >= 4, "{share} {marks}");
        let (share, marks) = copied(&exemplar, &scattered(4, 20.0, 400));
        assert!(share < 0.05 && marks == 0, "{share} {marks}");
    }

    #[test]
    fn what_repeats_is_a_copy_by_nature() {
        let lattice = |n: usize| -> Vec<Vector<2>> {
            (0..n * n).map(|k| Vector::xy((k % n) as f64 + 0.5, (k / n) as f64 + 0.5)).collect()
        };
        let (own, found) = (content(&lattice(10), 10.0), content(&lattice(20), 20.0));
        let budget = Budget::default();
        let scene = |c| Scene::new(c, Domain::Box(c.window), 1.0, &budget).unwrap();
        let graph = Graph::default();
        let (measures, marks) = copies((&scene(&own), &graph), (&scene(&found), &graph), &budget).unwrap().unwrap();
        assert!(measures[0].exemplar > 0.9 && measures[0].fault < 0.1 && marks.is_empty(), "{measures:?}");
    }

    #[test]
    fn a_hull_goes_around() {
        let square = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (1.0, 1.0)].map(|(x, y)| Vector::xy(x, y));
        assert_eq!(hull(&square).len(), 4);
    }
}
