//! Pairs of points of a patch and of what is there already, by which the patch is bent [Duranleau 2008 §5.2, eqs 1 to 3].
//!
//! Targets are chosen by clusters; each takes the source that costs least, one after another, and no source is taken twice. Then the choice is
//! made again a number of times with what pairs around say of length and direction.

use arabesque_core::{Budget, Result, Vector};
use arabesque_surface::OrientedPoints;
use rayon::prelude::*;

use crate::{params::ReliefParams, sample::Sample};

/// Cosine of the angle between the normals of a pair at most.
const FACING: f64 = 0.5;
/// Difference of surface variation at most.
const VARIATION: f64 = 0.12;
/// Sources that are looked at for each target at most.
const SOURCES: usize = 160;

/// A target, and the source that goes there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pair {
    pub(crate) source: Vector<3>,
    pub(crate) target: Vector<3>,
    pub(crate) cost: f64,
}

/// What a target might be paired with.
struct Choice {
    source: usize,
    /// From target to source, in units of the reach.
    way: Vector<3>,
    length: f64,
    cost: f64,
}

/// What pairing needs to know.
pub(crate) struct Pairing<'a> {
    pub(crate) params: &'a ReliefParams,
    /// How far the points of a pair may lie apart.
    pub(crate) reach: f64,
    /// How far pairs listen to one another.
    pub(crate) listening: f64,
}

impl Pairing<'_> {
    /// `c(s, q)` for all sources that are close enough and face alike (eq. 2), the cheapest first.
    fn choices(&self, target: &Sample, sources: &OrientedPoints, variations: &[f32]) -> Vec<Choice> {
        let params = self.params;
        let mut choices = Vec::new();
        sources.around(target.at, self.reach, |source, d2| {
            let facing = sources.normals()[source].dot(target.normal);
            let differs = f64::from(variations[source] - target.variation);
            if facing < FACING || differs.abs() > VARIATION {
                return;
            }
            let way = (sources.positions()[source] - target.at) * (1.0 / self.reach);
            let length = d2.sqrt() / self.reach;
            let cost =
                params.distance * length + 0.5 * params.normals * (1.0 - facing) + params.variation * differs * differs;
            choices.push(Choice { source, way, length, cost });
        });
        let cheaper = |a: &Choice, b: &Choice| a.cost.total_cmp(&b.cost).then(a.source.cmp(&b.source));
        if choices.len() > SOURCES {
            choices.select_nth_unstable_by(SOURCES, cheaper);
            choices.truncate(SOURCES);
        }
        choices.sort_unstable_by(cheaper);
        choices
    }

    /// Pairs for `targets`; those for which nothing fits have none.
    pub(crate) fn pairs(
        &self,
        targets: &[Sample],
        sources: &OrientedPoints,
        variations: &[f32],
        budget: &Budget,
    ) -> Result<Vec<Pair>> {
        let all: Vec<Vec<Choice>> =
            targets.par_iter().with_min_len(8).map(|q| self.choices(q, sources, variations)).collect();
        let looks: usize = all.iter().map(Vec::len).sum();
        budget.spend((looks * (20 + self.params.rounds * 6) + targets.len() * targets.len() * 8) as u64)?;
        let near = self.listeners(targets);
        let mut chosen = choose(&all, sources.len(), |_, _| 0.0);
        for _ in 0..self.params.rounds {
            let told: Vec<_> = near.iter().map(|near| told(near, &all, &chosen)).collect();
            let next = choose(&all, sources.len(), |q, choice| self.coherence(choice, told[q]));
            // What stays once stays for good.
            if next == chosen {
                break;
            }
            chosen = next;
        }
        let pair = |(q, choice): (usize, &Option<(usize, f64)>)| {
            let (k, cost) = (*choice)?;
            let source = sources.positions()[all[q][k].source];
            Some(Pair { source, target: targets[q].at, cost })
        };
        Ok(chosen.iter().enumerate().filter_map(pair).collect())
    }

    /// For each target the others that it listens to, with their weights.
    fn listeners(&self, targets: &[Sample]) -> Vec<Vec<(usize, f64)>> {
        let of = |q: &Sample| {
            let others = targets.iter().enumerate().map(|(r, other)| {
                let x = (q.at - other.at).norm() / self.listening;
                (r, (-x * x).exp())
            });
            others.filter(|(_, w)| *w > 1e-3).collect()
        };
        targets.iter().map(of).collect()
    }

    /// `g(s, q)`: how much longer than those around a pair is, and how far it leads elsewhere.
    fn coherence(&self, choice: &Choice, (length, way): (f64, Vector<3>)) -> f64 {
        let along = if choice.length > 1e-9 { choice.way.dot(way) / choice.length } else { 1.0 };
        // Where those around lead nowhere, no direction is wrong.
        let certain = way.norm();
        self.params.length * (choice.length - length).abs()
            + 0.5 * self.params.direction * (certain - along) * choice.length.min(1.0)
    }
}

/// Mean length and direction of the pairs around a target.
fn told(near: &[(usize, f64)], all: &[Vec<Choice>], chosen: &[Option<(usize, f64)>]) -> (f64, Vector<3>) {
    let (mut length, mut way, mut sum) = (0.0, Vector::ZERO, 0.0);
    for &(r, w) in near {
        if let Some((k, _)) = chosen[r] {
            let choice = &all[r][k];
            length += choice.length * w;
            way += choice.way * w;
            sum += w;
        }
    }
    (if sum > 0.0 { length / sum } else { 0.0 }, way.unit_or_zero())
}

/// For each target in turn the choice whose source is not taken and that costs least, with `more` on top of its own cost.
fn choose(all: &[Vec<Choice>], sources: usize, more: impl Fn(usize, &Choice) -> f64) -> Vec<Option<(usize, f64)>> {
    let mut taken = vec![false; sources];
    let mut of = |(q, choices): (usize, &Vec<Choice>)| {
        let mut best: Option<(usize, f64)> = None;
        for (k, choice) in choices.iter().enumerate() {
            // Those that follow cost as much or more, and nothing makes them cheaper.
            if best.is_some_and(|(_, least)| choice.cost >= least) {
                break;
            }
            if taken[choice.source] {
                continue;
            }
            let cost = choice.cost + more(q, choice).max(0.0);
            if best.is_none_or(|(_, least)| cost < least) {
                best = Some((k, cost));
            }
        }
        if let Some((k, _)) = best {
            taken[choices[k].source] = true;
        }
        best
    };
    all.iter().enumerate().map(&mut of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(at: [f64; 3]) -> Sample {
        Sample { at: Vector(at), normal: Vector([0.0, 0.0, 1.0]), ..Sample::default() }
    }

    fn bumps(shift: f64) -> (OrientedPoints, Vec<f32>) {
        let at = |k: usize| Vector([(k % 30) as f64 * 0.1 + shift, (k / 30) as f64 * 0.1, 0.0]);
        let points: Vec<_> = (0..900).map(at).collect();
        let variations = points.iter().map(|p| (0.1 * (0.5 + 0.5 * ((p[0] - shift) * 4.0).sin())) as f32).collect();
        (OrientedPoints::new(points, vec![Vector([0.0, 0.0, 1.0]); 900], 0.25, &Budget::default()).unwrap(), variations)
    }

    #[test]
    fn pairs_follow_what_the_surface_does_and_agree() {
        let (sources, variations) = bumps(0.2);
        let targets: Vec<_> = (0..60)
            .map(|k| {
                let at = [1.0 + f64::from(k % 10) * 0.1, 1.0 + f64::from(k / 10) * 0.1, 0.0];
                Sample { variation: (0.1 * (0.5 + 0.5 * (at[0] * 4.0).sin())) as f32, ..sample(at) }
            })
            .collect();
        let params = ReliefParams { variation: 1000.0, distance: 0.3, ..ReliefParams::default() };
        let pairing = Pairing { params: &params, reach: 0.5, listening: 0.3 };
        let pairs = pairing.pairs(&targets, &sources, &variations, &Budget::default()).unwrap();
        assert_eq!(pairs.len(), 60);
        let shift = pairs.iter().fold(Vector::ZERO, |sum, p| sum + (p.source - p.target)) * (1.0 / 60.0);
        assert!((shift - Vector([0.2, 0.0, 0.0])).norm() < 0.1, "{shift:?}");
        let mut sources: Vec<_> = pairs.iter().map(|p| p.source.0.map(f64::to_bits)).collect();
        sources.sort_unstable();
        sources.dedup();
        assert_eq!(sources.len(), 60, "a source is taken twice");
    }

    #[test]
    fn looking_no_farther_than_costs_allow_chooses_as_looking_at_all() {
        let choice = |q: usize, k: usize| Choice {
            source: (q * 7 + k * 5) % 40,
            way: Vector::ZERO,
            length: ((q * 13 + k * 29) % 17) as f64 / 17.0,
            cost: k as f64 * 0.1 + (q % 3) as f64 * 0.01,
        };
        let all: Vec<Vec<Choice>> = (0..30).map(|q| (0..20).map(|k| choice(q, k)).collect()).collect();
        let more = |_: usize, choice: &Choice| choice.length;
        let mut taken = std::collections::BTreeSet::new();
        let naive: Vec<Option<(usize, f64)>> = all
            .iter()
            .map(|choices| {
                let free = choices.iter().enumerate().filter(|(_, c)| !taken.contains(&c.source));
                let best = free.map(|(k, c)| (k, c.cost + c.length)).min_by(|a, b| a.1.total_cmp(&b.1));
                taken.extend(best.map(|(k, _)| choices[k].source));
                best
            })
            .collect();
        assert_eq!(choose(&all, 40, more), naive);
    }

    #[test]
    fn what_faces_away_or_is_too_far_is_no_pair() {
        let (sources, variations) = bumps(0.0);
        let params = ReliefParams::default();
        let pairing = Pairing { params: &params, reach: 0.3, listening: 0.3 };
        let away = Sample { normal: Vector([0.0, 0.0, -1.0]), ..sample([1.0, 1.0, 0.0]) };
        let far = sample([1.0, 1.0, 0.4]);
        let bent = Sample { variation: 0.3, ..sample([1.0, 1.0, 0.0]) };
        assert!(pairing.pairs(&[away, far, bent], &sources, &variations, &Budget::default()).unwrap().is_empty());
    }
}
