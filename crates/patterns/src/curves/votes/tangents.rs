//! Orientation assignment: the directions in which strokes leave a sample [Tu 2020 §4.3.4, eq. 6, fig. 9].

use arabesque_core::{Meter, Numbered, Result, Vector, pairing};
use rayon::prelude::*;

use crate::output::state::State;

/// Nanoseconds for two directions that are compared.
const PAIR: u64 = 60;

/// Updates number and values of the tangents of every living curve sample.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop; then the tangents stay as they are.
pub(crate) fn assign<const D: usize>(state: &mut State<'_, D>) -> Result<()> {
    let level = state.level;
    let Some(net) = &level.net else { return Ok(()) };
    let budget = state.budget.stage("turning samples");
    let votes = votes(state);
    let updated: Vec<Vec<Vector<D>>> = (0..state.samples().len() as u32)
        .into_par_iter()
        .map(|s| {
            let own = state.tangents_of(s);
            if votes[s].is_empty() || state.is_frozen(s) {
                return Ok(own.to_vec());
            }
            let frame = state.request.fields.frame(state.sample(s).position);
            let turned = |v: Vector<D>| frame.rotation.apply(v);
            let sets: Vec<Vec<Vector<D>>> =
                votes[s].iter().map(|&e| net.directions(e).into_iter().map(turned).collect()).collect();
            update(own, &sets, &mut budget.meter())
        })
        .collect::<Result<_>>()?;
    budget.spend(0)?;
    state.set_tangents(updated);
    Ok(())
}

/// For every sample, the exemplar nodes that it was matched with; its own match first.
fn votes<const D: usize>(state: &State<'_, D>) -> Numbered<Vec<u32>> {
    let mut votes = Numbered::filled(Vec::new(), state.samples().len());
    for &s in state.living() {
        if let Some(matched) = &state.sample(s).matched {
            votes[s].extend(state.level.node_of(matched.input));
        }
    }
    for &s in state.living() {
        let Some(matched) = &state.sample(s).matched else { continue };
        for &(o, i) in &matched.pairs {
            votes[o].extend(state.level.node_of(i));
        }
    }
    votes
}

/// New tangents from the present ones and the sets voted for.
fn update<const D: usize>(own: &[Vector<D>], sets: &[Vec<Vector<D>>], meter: &mut Meter<'_>) -> Result<Vec<Vector<D>>> {
    let mean = sets.iter().map(|s| s.len() as f64).sum::<f64>() / sets.len() as f64;
    let number = mean.round() as usize;
    // To begin with, the tangents of the best match that has the right number.
    let first = sets.iter().find(|s| s.len() == number).unwrap_or(&sets[0]);
    let entries: Vec<_> = if own.is_empty() { first.clone() } else { own.to_vec() };
    let mut matched = vec![Vec::new(); entries.len()];
    let mut unmatched = Vec::new();
    for set in sets {
        meter.spend(PAIR * (1 + entries.len() * set.len()) as u64)?;
        let partner = partners(&entries, set);
        for (k, &v) in set.iter().enumerate() {
            match partner.iter().position(|p| *p == Some(k)) {
                Some(e) => matched[e].push(v),
                None => unmatched.push(v),
            }
        }
    }
    let mut kept: Vec<(Vector<D>, f64)> =
        entries.iter().zip(&matched).map(|(e, votes)| mean_direction(*e, votes)).collect();
    while kept.len() > number {
        let worst = (0..kept.len()).max_by(|&a, &b| kept[a].1.total_cmp(&kept[b].1)).unwrap_or(0);
        kept.remove(worst);
    }
    let mut result: Vec<_> = kept.into_iter().map(|k| k.0).collect();
    while result.len() < number && !unmatched.is_empty() {
        let median = median(&unmatched);
        result.push(median);
        unmatched.retain(|v| v.dot(median) < 0.7);
    }
    Ok(result)
}

/// For each entry the vote it is matched with: the largest sum of cosines, which is the smallest sum of angles for
/// small ones.
fn partners<const D: usize>(entries: &[Vector<D>], votes: &[Vector<D>]) -> Vec<Option<usize>> {
    pairing::pair_sides(entries.len(), votes.len(), |e, v| entries[e].dot(votes[v]))
}

/// Mean direction of the votes, and their spread: 0 for unanimous ones, 1 and more for none or contrary ones.
fn mean_direction<const D: usize>(entry: Vector<D>, votes: &[Vector<D>]) -> (Vector<D>, f64) {
    let sum = votes.iter().fold(Vector::ZERO, |s, v| s + *v);
    let length = sum.norm();
    if votes.is_empty() || length < 1e-9 {
        return (entry, 2.0);
    }
    (sum * (1.0 / length), 1.0 - length / votes.len() as f64)
}

/// The vote with the largest sum of cosines to all.
fn median<const D: usize>(votes: &[Vector<D>]) -> Vector<D> {
    let sum = votes.iter().fold(Vector::ZERO, |s, v| s + *v);
    votes.iter().copied().max_by(|a, b| a.dot(sum).total_cmp(&b.dot(sum))).unwrap_or(Vector::ZERO)
}

#[cfg(test)]
mod tests {
    use arabesque_core::Budget;

    use super::*;

    fn update(own: &[Vector<2>], sets: &[Vec<Vector<2>>]) -> Vec<Vector<2>> {
        super::update(own, sets, &mut Budget::default().meter()).unwrap()
    }

    fn d(degrees: f64) -> Vector<2> {
        Vector::xy(degrees.to_radians().cos(), degrees.to_radians().sin())
    }

    #[test]
    fn tangents_are_the_mean_of_their_votes() {
        let new = update(&[d(0.0), d(180.0)], &[vec![d(10.0), d(190.0)], vec![d(190.0), d(30.0)]]);
        assert_eq!(new.len(), 2);
        assert!(new[0].dot(d(20.0)) > 0.9999 && new[1].dot(d(190.0)) > 0.9999);
    }

    #[test]
    fn a_third_arm_grows_where_the_votes_have_it() {
        let tee = vec![d(0.0), d(90.0), d(180.0)];
        let new = update(&[d(0.0), d(180.0)], &[tee.clone(), tee]);
        assert_eq!(new.len(), 3);
        assert!(new[2].dot(d(90.0)) > 0.9999);
    }

    #[test]
    fn the_arm_that_the_votes_disagree_on_goes() {
        let own = [d(0.0), d(90.0), d(180.0)];
        let new = update(&own, &[vec![d(0.0), d(180.0)], vec![d(1.0), d(181.0)]]);
        assert_eq!(new.len(), 2);
        assert!(new[0].dot(d(0.5)) > 0.9999 && new[1].dot(d(180.5)) > 0.9999);
    }
}
