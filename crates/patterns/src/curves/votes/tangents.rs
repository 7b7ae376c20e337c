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
    let directions: Numbered<Vec<Vector<D>>> = net.nodes.numbers().map(|node| net.directions(node)).collect();
    let updated: Vec<Vec<Vector<D>>> = (0..state.samples().len() as u32)
        .into_par_iter()
        .map_init(Desk::default, |desk, s| {
            let own = state.tangents_of(s);
            let votes = votes.of(s);
            if votes.is_empty() || state.is_frozen(s) {
                return Ok(own.to_vec());
            }
            let frame = state.request.fields.frame(state.sample(s).position);
            desk.clear();
            for &node in votes {
                desk.push(directions[node].iter().map(|&v| frame.rotation.apply(v)));
            }
            desk.update(own, &mut budget.meter())
        })
        .collect::<Result<_>>()?;
    budget.spend(0)?;
    state.set_tangents(updated);
    Ok(())
}

/// The exemplar nodes that each sample was matched with, its own match first.
struct NodeVotes {
    /// Those of sample `s`: `nodes[starts[s]..starts[s + 1]]`.
    starts: Vec<u32>,
    nodes: Vec<u32>,
}

impl NodeVotes {
    fn of(&self, s: u32) -> &[u32] {
        &self.nodes[self.starts[s as usize] as usize..self.starts[s as usize + 1] as usize]
    }
}

fn votes<const D: usize>(state: &State<'_, D>) -> NodeVotes {
    let level = state.level;
    let each = |visit: &mut dyn FnMut(u32, u32)| {
        let matched = || state.living().iter().filter_map(|&s| Some((s, state.sample(s).matched.as_ref()?)));
        for (s, m) in matched() {
            level.node_of(m.input).into_iter().for_each(|node| visit(s, node));
        }
        for &(o, i) in matched().flat_map(|(_, m)| &m.pairs) {
            level.node_of(i).into_iter().for_each(|node| visit(o, node));
        }
    };
    let mut starts = vec![0_u32; state.samples().len() + 1];
    each(&mut |s, _| starts[s as usize + 1] += 1);
    for s in 1..starts.len() {
        starts[s] += starts[s - 1];
    }
    let mut next = starts.clone();
    let mut nodes = vec![0; starts.last().map_or(0, |&n| n as usize)];
    each(&mut |s, node| {
        nodes[next[s as usize] as usize] = node;
        next[s as usize] += 1;
    });
    NodeVotes { starts, nodes }
}

/// Where the sets that were voted for one sample lie while its tangents are updated; kept from one sample to the next.
#[derive(Default)]
struct Desk<const D: usize> {
    /// The directions of all sets, and where each set ends.
    directions: Vec<Vector<D>>,
    ends: Vec<usize>,
    entries: Vec<Vector<D>>,
    /// Sum and number of the votes of each entry.
    matched: Vec<(Vector<D>, usize)>,
    unmatched: Vec<Vector<D>>,
    partner: Vec<Option<usize>>,
}

impl<const D: usize> Desk<D> {
    fn clear(&mut self) {
        self.directions.clear();
        self.ends.clear();
        self.unmatched.clear();
        self.entries.clear();
        self.matched.clear();
    }

    /// Adds a set.
    fn push(&mut self, set: impl Iterator<Item = Vector<D>>) {
        self.directions.extend(set);
        self.ends.push(self.directions.len());
    }

    /// New tangents from the present ones and the sets voted for, of which there is one at least.
    fn update(&mut self, own: &[Vector<D>], meter: &mut Meter<'_>) -> Result<Vec<Vector<D>>> {
        let Self { directions, ends, entries, matched, unmatched, partner } = self;
        let sets = || {
            let starts = std::iter::once(0).chain(ends.iter().copied());
            starts.zip(ends.iter()).map(|(start, &end)| &directions[start..end])
        };
        let mean = sets().map(|s| s.len() as f64).sum::<f64>() / ends.len() as f64;
        let number = mean.round() as usize;
        // To begin with, the tangents of the best match that has the right number.
        let first = sets().find(|s| s.len() == number).or_else(|| sets().next()).unwrap_or_default();
        entries.extend_from_slice(if own.is_empty() { first } else { own });
        matched.resize(entries.len(), (Vector::ZERO, 0));
        for set in sets() {
            meter.spend(PAIR * (1 + entries.len() * set.len()) as u64)?;
            partners(entries, set, partner);
            for (k, &v) in set.iter().enumerate() {
                match partner.iter().position(|p| *p == Some(k)) {
                    Some(e) => matched[e] = (matched[e].0 + v, matched[e].1 + 1),
                    None => unmatched.push(v),
                }
            }
        }
        let mut kept: Vec<(Vector<D>, f64)> =
            entries.iter().zip(matched.iter()).map(|(e, &(sum, count))| mean_direction(*e, sum, count)).collect();
        while kept.len() > number {
            let worst = (0..kept.len()).max_by(|&a, &b| kept[a].1.total_cmp(&kept[b].1)).unwrap_or(0);
            kept.remove(worst);
        }
        let mut result: Vec<_> = kept.into_iter().map(|k| k.0).collect();
        while result.len() < number && !unmatched.is_empty() {
            let median = median(unmatched);
            result.push(median);
            unmatched.retain(|v| v.dot(median) < 0.7);
        }
        Ok(result)
    }
}

/// Most cosines that are compared where they stand; of more, a list is sorted.
const FEW: usize = 36;

/// For each entry the vote it is matched with: the largest sum of cosines, which is the smallest sum of angles for
/// small ones; the largest cosine first, of ties the first.
fn partners<const D: usize>(entries: &[Vector<D>], votes: &[Vector<D>], partner: &mut Vec<Option<usize>>) {
    let (rows, columns) = (entries.len(), votes.len());
    partner.clear();
    if rows * columns > FEW {
        partner.extend(pairing::pair_sides(rows, columns, |e, v| entries[e].dot(votes[v])));
        return;
    }
    let mut cost = [f64::INFINITY; FEW];
    for (k, cost) in cost.iter_mut().enumerate().take(rows * columns) {
        *cost = -entries[k / columns].dot(votes[k % columns]);
    }
    partner.resize(rows, None);
    let mut is_taken = [false; FEW];
    for _ in 0..rows.min(columns) {
        let free = (0..rows * columns).filter(|k| partner[k / columns].is_none() && !is_taken[k % columns]);
        if let Some(k) = free.min_by(|&a, &b| cost[a].total_cmp(&cost[b])) {
            partner[k / columns] = Some(k % columns);
            is_taken[k % columns] = true;
        }
    }
}

/// Mean direction of so many votes, given their sum, and their spread: 0 for unanimous ones, 1 and more for none or contrary ones.
fn mean_direction<const D: usize>(entry: Vector<D>, sum: Vector<D>, count: usize) -> (Vector<D>, f64) {
    let length = sum.norm();
    if count == 0 || length < 1e-9 {
        return (entry, 2.0);
    }
    (sum * (1.0 / length), 1.0 - length / count as f64)
}

/// The vote with the largest sum of cosines to all.
fn median<const D: usize>(votes: &[Vector<D>]) -> Vector<D> {
    let sum = votes.iter().fold(Vector::ZERO, |s, v| s + *v);
    votes.iter().copied().max_by(|a, b| a.dot(sum).total_cmp(&b.dot(sum))).unwrap_or(Vector::ZERO)
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Budget, Stage, Stream};

    use super::*;

    fn update(own: &[Vector<2>], sets: &[Vec<Vector<2>>]) -> Vec<Vector<2>> {
        let mut desk = Desk::default();
        sets.iter().for_each(|set| desk.push(set.iter().copied()));
        desk.update(own, &mut Budget::default().meter()).unwrap()
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

    #[test]
    fn a_few_are_matched_as_a_sorted_list_would_match_them() {
        let mut random = Stream::new(5, Stage::TEST, 0);
        for (rows, columns) in [(1, 1), (2, 2), (3, 2), (2, 5), (6, 6), (0, 3), (3, 0), (5, 7)] {
            // Whole multiples of a right angle among them, so that there are ties.
            let mut draw =
                |_| d(if random.unit() < 0.5 { 90.0 * random.below(4) as f64 } else { random.range(0.0, 360.0) });
            let entries: Vec<_> = (0..rows).map(&mut draw).collect();
            let votes: Vec<_> = (0..columns).map(&mut draw).collect();
            let mut partner = Vec::new();
            partners(&entries, &votes, &mut partner);
            assert_eq!(partner, pairing::pair_sides(rows, columns, |e, v| entries[e].dot(votes[v])));
        }
    }
}
