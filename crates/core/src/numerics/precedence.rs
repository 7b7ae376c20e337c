//! Putting things into an order that agrees with votes on which of two comes first.

use std::{
    cmp::Reverse,
    collections::{BTreeMap, BinaryHeap},
};

use crate::{budget::Budget, error::Result};

/// Work units for a vote that is followed or sorted.
const PER_VOTE: u64 = 40;

/// A vote that one of two things comes before the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vote {
    /// Number of what comes first.
    pub first: usize,
    /// Number of what comes later.
    pub second: usize,
    /// How sure that is; above 0.
    pub weight: f64,
}

/// An order of things, and what it could not do justice to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Precedence {
    /// The numbers of the things in their order.
    pub order: Vec<usize>,
    /// Pairs of things whose votes the order contradicts, because they run in a circle with surer ones.
    pub overruled: Vec<(usize, usize)>,
}

/// Orders the numbers below `count` by votes.
///
/// Votes on the same pair are added up, opposite ones cancel out. What no vote decides keeps its order as far as it can:
/// of all things that may come next, the one with the lowest number does. Where votes run in circles they are followed
/// from the surest to the least sure, and one that contradicts those before it is overruled.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub fn precedence(count: usize, votes: &[Vote], budget: &Budget) -> Result<Precedence> {
    budget.spend(PER_VOTE * (count + votes.len()) as u64)?;
    let arcs = settled(count, votes);
    let mut graph = Graph::new(count, arcs.iter().map(|a| (a.first, a.second)));
    let order = graph.sorted();
    if order.len() == count {
        return Ok(Precedence { order, overruled: Vec::new() });
    }
    let circular = graph.circular();
    let (mut doubtful, mut kept): (Vec<Vote>, Vec<Vote>) =
        arcs.into_iter().partition(|a| circular[a.first] && circular[a.second]);
    doubtful.sort_by(|a, b| {
        let back = |v: &Vote| v.first > v.second;
        b.weight.total_cmp(&a.weight).then(back(a).cmp(&back(b))).then((a.first, a.second).cmp(&(b.first, b.second)))
    });
    let mut ranking = Ranking::new(count);
    let mut overruled = Vec::new();
    for arc in doubtful {
        if ranking.insert(arc.first, arc.second, budget)? {
            kept.push(arc);
        } else {
            overruled.push((arc.first, arc.second));
        }
    }
    overruled.sort_unstable();
    graph = Graph::new(count, kept.iter().map(|a| (a.first, a.second)));
    Ok(Precedence { order: graph.sorted(), overruled })
}

/// One vote for each pair, the way that most votes on it point.
fn settled(count: usize, votes: &[Vote]) -> Vec<Vote> {
    let mut sums: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for v in votes.iter().filter(|v| v.first != v.second && v.first.max(v.second) < count) {
        let sign = if v.first < v.second { 1.0 } else { -1.0 };
        *sums.entry((v.first.min(v.second), v.first.max(v.second))).or_default() += sign * v.weight;
    }
    let one = |((low, high), sum): ((usize, usize), f64)| match sum {
        s if s > 0.0 => Some(Vote { first: low, second: high, weight: s }),
        s if s < 0.0 => Some(Vote { first: high, second: low, weight: -s }),
        _ => None,
    };
    sums.into_iter().filter_map(one).collect()
}

/// Who comes before whom.
struct Graph {
    after: Vec<Vec<usize>>,
    before: Vec<Vec<usize>>,
}

impl Graph {
    fn new(count: usize, arcs: impl Iterator<Item = (usize, usize)>) -> Self {
        let mut graph = Self { after: vec![Vec::new(); count], before: vec![Vec::new(); count] };
        for (a, b) in arcs {
            graph.after[a].push(b);
            graph.before[b].push(a);
        }
        graph
    }

    /// Everything that is in no circle and behind none, the lowest number first of what may come next.
    fn sorted(&self) -> Vec<usize> {
        let mut waits: Vec<usize> = self.before.iter().map(Vec::len).collect();
        let mut ready: BinaryHeap<_> = (0..waits.len()).filter(|&i| waits[i] == 0).map(Reverse).collect();
        let mut order = Vec::with_capacity(waits.len());
        while let Some(Reverse(i)) = ready.pop() {
            order.push(i);
            for &j in &self.after[i] {
                waits[j] -= 1;
                if waits[j] == 0 {
                    ready.push(Reverse(j));
                }
            }
        }
        order
    }

    /// Which things are in a circle or on a way from one to another.
    fn circular(&self) -> Vec<bool> {
        let mut left = vec![true; self.after.len()];
        for (into, out) in [(&self.before, &self.after), (&self.after, &self.before)] {
            let mut waits: Vec<usize> = into.iter().map(|list| list.iter().filter(|&&j| left[j]).count()).collect();
            let mut ready: Vec<usize> = (0..waits.len()).filter(|&i| left[i] && waits[i] == 0).collect();
            while let Some(i) = ready.pop() {
                left[i] = false;
                for &j in out[i].iter().filter(|&&j| left[j]) {
                    waits[j] -= 1;
                    if waits[j] == 0 {
                        ready.push(j);
                    }
                }
            }
        }
        left
    }
}

/// An order that grows to fit one pair after the other [Pearce and Kelly 2006].
struct Ranking {
    rank: Vec<usize>,
    after: Vec<Vec<usize>>,
    before: Vec<Vec<usize>>,
    seen: Vec<bool>,
}

impl Ranking {
    fn new(count: usize) -> Self {
        let lists = vec![Vec::new(); count];
        Self { rank: (0..count).collect(), after: lists.clone(), before: lists, seen: vec![false; count] }
    }

    /// Takes in that `a` comes before `b`; false, and nothing is changed, when `b` must come before `a`.
    fn insert(&mut self, a: usize, b: usize, budget: &Budget) -> Result<bool> {
        let (low, high) = (self.rank[b], self.rank[a]);
        budget.spend(PER_VOTE)?;
        if low < high {
            let later = self.reached(b, budget, |ranking, i| (&ranking.after[i], ranking.rank[i] <= high))?;
            if later.contains(&a) {
                return Ok(false);
            }
            let sooner = self.reached(a, budget, |ranking, i| (&ranking.before[i], ranking.rank[i] >= low))?;
            self.exchange(sooner, later);
        }
        self.after[a].push(b);
        self.before[b].push(a);
        Ok(true)
    }

    /// What is reached from `start` by the lists that `next` gives, as far as it says yes.
    fn reached(
        &mut self,
        start: usize,
        budget: &Budget,
        next: impl Fn(&Self, usize) -> (&Vec<usize>, bool),
    ) -> Result<Vec<usize>> {
        let (mut found, mut at) = (vec![start], 0);
        self.seen[start] = true;
        while let Some(&i) = found.get(at) {
            at += 1;
            let list: Vec<usize> = next(self, i).0.iter().copied().filter(|&j| next(self, j).1).collect();
            for j in list {
                if !std::mem::replace(&mut self.seen[j], true) {
                    found.push(j);
                }
            }
        }
        let looked: usize = found.iter().map(|&i| 1 + next(self, i).0.len()).sum();
        found.iter().for_each(|&i| self.seen[i] = false);
        budget.spend(PER_VOTE * looked as u64)?;
        Ok(found)
    }

    /// Gives the ranks of both lists to them anew, `sooner` first, each list in its own order.
    fn exchange(&mut self, mut sooner: Vec<usize>, mut later: Vec<usize>) {
        sooner.sort_unstable_by_key(|&i| self.rank[i]);
        later.sort_unstable_by_key(|&i| self.rank[i]);
        let moved: Vec<usize> = sooner.into_iter().chain(later).collect();
        let mut ranks: Vec<usize> = moved.iter().map(|&i| self.rank[i]).collect();
        ranks.sort_unstable();
        moved.into_iter().zip(ranks).for_each(|(i, rank)| self.rank[i] = rank);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn vote(first: usize, second: usize, weight: f64) -> Vote {
        Vote { first, second, weight }
    }

    fn ordered(count: usize, votes: &[Vote]) -> Precedence {
        precedence(count, votes, &Budget::default()).unwrap()
    }

    /// Whether `to` is reached from `from`.
    fn leads(arcs: &[(usize, usize)], from: usize, to: usize) -> bool {
        let (mut found, mut at) = (vec![from], 0);
        while at < found.len() {
            let i = found[at];
            at += 1;
            found.extend(
                arcs.iter().filter(|a| a.0 == i).map(|a| a.1).filter(|j| !found.contains(j)).collect::<Vec<_>>(),
            );
        }
        found.contains(&to)
    }

    #[test]
    fn what_no_vote_decides_keeps_its_order() {
        assert_eq!(ordered(4, &[]).order, [0, 1, 2, 3]);
        assert_eq!(ordered(4, &[vote(3, 1, 1.0)]).order, [0, 2, 3, 1]);
        assert_eq!(ordered(3, &[vote(2, 0, 1.0), vote(0, 2, 1.0)]).order, [0, 1, 2], "opposite votes cancel out");
        assert_eq!(ordered(3, &[vote(2, 0, 2.0), vote(0, 2, 1.0)]).order, [1, 2, 0]);
    }

    #[test]
    fn a_circle_is_cut_at_its_weakest_vote() {
        let circle = [vote(0, 1, 3.0), vote(1, 2, 1.0), vote(2, 0, 2.0)];
        assert_eq!(ordered(3, &circle), Precedence { order: vec![2, 0, 1], overruled: vec![(1, 2)] });
    }

    #[test]
    fn votes_on_nothing_are_left_out() {
        assert_eq!(ordered(2, &[vote(0, 0, 1.0), vote(5, 0, 1.0), vote(0, 5, 1.0)]).order, [0, 1]);
        assert!(ordered(0, &[]).order.is_empty());
    }

    proptest! {
        #[test]
        fn the_surest_votes_win_as_by_brute_force(votes in prop::collection::vec((0..9_usize, 0..9_usize, 1..40_u32), 0..40)) {
            let votes: Vec<Vote> = votes.into_iter().map(|(a, b, w)| vote(a, b, f64::from(w))).collect();
            let mut arcs = settled(9, &votes);
            arcs.sort_by(|a, b| {
                let back = |v: &Vote| v.first > v.second;
                b.weight.total_cmp(&a.weight).then(back(a).cmp(&back(b))).then((a.first, a.second).cmp(&(b.first, b.second)))
            });
            let (mut kept, mut overruled) = (Vec::new(), Vec::new());
            for arc in arcs {
                let against = leads(&kept, arc.second, arc.first);
                if against { overruled.push((arc.first, arc.second)) } else { kept.push((arc.first, arc.second)) }
            }
            overruled.sort_unstable();
            let found = ordered(9, &votes);
            prop_assert_eq!(&found.overruled, &overruled);
            let mut all = found.order.clone();
            all.sort_unstable();
            prop_assert_eq!(all, (0..9).collect::<Vec<_>>());
            let rank = |i: usize| found.order.iter().position(|&j| j == i);
            prop_assert!(kept.iter().all(|&(a, b)| rank(a) < rank(b)));
        }
    }
}
