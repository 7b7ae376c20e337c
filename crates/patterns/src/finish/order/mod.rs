//! The order in which elements are painted: of two that overlap, the one on top is the one that is on top in the
//! exemplar.
//!
//! Every pair of elements that overlap in the output votes as the exemplar's pair of the same classes does whose
//! offset is nearest; the order that agrees with the votes is the painting order, and what no vote decides stays in the
//! order in which it came. Where votes run in circles, as in a weave, the weakest are overruled. On a torus each copy of
//! an element that is seen across an edge votes for itself, so that rows over rows close up around the seam.

mod table;
#[cfg(test)]
mod tests;

use arabesque_core::{Budget, Domain, Instance, Placement, Precedence, Result, Vector, Vote, Warning, precedence};
use rayon::prelude::*;

use crate::{
    dimension::Dimension,
    finish::clearance::{Arrangement, ExemplarClearance, PlacedFigure},
};
pub(crate) use table::ExemplarOrder;

/// Weight of the order in which the user's own elements lie, which is above that of any other vote.
const OWN: f64 = 100.0;

/// Work for a body that is sorted, and for a pair that votes.
const PRICE: (u64, u64) = (500, 300);

/// What sorting found out beside the order of the placements.
#[derive(Debug, Default)]
pub(crate) struct Sorted<const D: usize> {
    /// See [`arabesque_core::Outcome::sequence`].
    pub(crate) sequence: Vec<Instance<D>>,
    /// What no order can do justice to.
    pub(crate) warning: Option<Warning>,
}

/// Sorts placements from bottom to top, by what the exemplar's elements that overlap do. In space, and where no two
/// elements of the exemplar overlap, they stay as they are.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop; then the placements stay as they are.
pub(crate) fn sort<const D: usize>(
    placements: &mut Vec<Placement<D>>,
    order: Option<&ExemplarOrder>,
    clearance: Option<&ExemplarClearance>,
    domain: &Domain<D>,
    budget: &Budget,
) -> Result<Sorted<D>>
where
    Vector<D>: Dimension<D>,
{
    let (domain, flat) = (Vector::plane_domain(domain), Vector::plane_placements(placements));
    let (Some(order), Some(clearance), Some(domain), Some(flat)) = (order, clearance, domain, flat) else {
        return Ok(Sorted::default());
    };
    let budget = budget.stage("sorting what lies on what");
    let plane = Domain::Box(domain.bounds());
    let stack = Stack::new(flat, clearance, [domain, &plane], &budget)?;
    let votes = stack.votes(order)?;
    let Ordered { order, sequence, overruled } = stack.ordered(&votes)?;
    let mut sorted: Vec<Placement<2>> = order.iter().map(|&i| flat[i].clone()).collect();
    std::mem::swap(flat, &mut sorted);
    let around = |turns: [i32; 2]| std::array::from_fn(|k| turns.get(k).copied().unwrap_or(0));
    let sequence = sequence.into_iter().map(|i| Instance { placement: i.placement, around: around(i.around) });
    Ok(Sorted { sequence: sequence.collect(), warning: warning(overruled, votes.len()) })
}

/// What to say where no order agrees with all votes.
fn warning(overruled: usize, votes: usize) -> Option<Warning> {
    (overruled > 0).then(|| {
        Warning::new(
            format!(
                "elements cover one another in circles, which no order of painting can do: of {votes} overlaps \
                 {overruled} are the other way round than in the exemplar"
            ),
            "draw what weaves over and under as pieces that end where they go under",
        )
    })
}

/// Elements where they are seen.
struct Stack<'a> {
    placements: &'a [Placement<2>],
    /// What is drawn: of each placement itself first, then its copies on a torus.
    instances: Vec<Instance<2>>,
    arrangement: Arrangement<'a>,
    budget: &'a Budget,
}

/// An order of placements.
struct Ordered {
    order: Vec<usize>,
    sequence: Vec<Instance<2>>,
    /// Pairs that lie the wrong way round.
    overruled: usize,
}

impl<'a> Stack<'a> {
    /// `plane` is no torus: copies are bodies of their own in it.
    fn new(
        placements: &'a [Placement<2>],
        clearance: &'a ExemplarClearance,
        [domain, plane]: [&'a Domain<2>; 2],
        budget: &'a Budget,
    ) -> Result<Self> {
        budget.spend(PRICE.0 * placements.len() as u64)?;
        let (own, bodies) = clearance.bodies(placements, budget)?;
        let (mut instances, mut seen) = (Vec::new(), Vec::new());
        for (placement, body) in bodies.iter().enumerate() {
            for around in copies(body, domain) {
                let size = domain.period().unwrap_or(Vector::ZERO);
                let shift = Vector::xy(f64::from(around[0]) * size[0], f64::from(around[1]) * size[1]);
                instances.push(Instance { placement, around });
                seen.push(body.moved_to(body.centre + shift));
            }
        }
        budget.spend(PRICE.0 * seen.len() as u64)?;
        let arrangement = Arrangement::new(plane, budget.clone(), &clearance.figures, own, seen);
        Ok(Self { placements, instances, arrangement, budget })
    }

    /// The votes of all pairs of instances that overlap.
    fn votes(&self, order: &ExemplarOrder) -> Result<Vec<Vote>> {
        let of = |i: usize| self.votes_of(i, order);
        let votes: Vec<Vec<Vote>> = (0..self.instances.len()).into_par_iter().map(of).collect::<Result<_>>()?;
        self.budget.spend(0)?;
        Ok(votes.concat())
    }

    /// The votes of instance `i` and those after it.
    fn votes_of(&self, i: usize, order: &ExemplarOrder) -> Result<Vec<Vote>> {
        let mut meter = self.budget.meter();
        let a = &self.arrangement.bodies[i];
        let mut votes = Vec::new();
        if a.radius <= 0.0 {
            return Ok(votes);
        }
        for j in self.arrangement.neighbours(i, 0.0, &mut meter)?.into_iter().filter(|&j| j > i) {
            let b = &self.arrangement.bodies[j];
            meter.spend(PRICE.1)?;
            let weight = match [i, j].map(|k| self.placements[self.instances[k].placement].frozen) {
                [Some(m), Some(n)] => OWN * (n as f64 - m as f64),
                _ => order.above(a, b),
            };
            if weight == 0.0 || !self.arrangement.meet(a, b, &mut meter)? {
                continue;
            }
            let (first, second) = if weight > 0.0 { (i, j) } else { (j, i) };
            votes.push(Vote { first, second, weight: weight.abs() });
        }
        Ok(votes)
    }

    /// The order that agrees with the votes: of placements, where the copies of each can be drawn with it, else of
    /// instances.
    fn ordered(&self, votes: &[Vote]) -> Result<Ordered> {
        let of = |i: usize| self.instances[i].placement;
        let joint: Vec<Vote> = votes.iter().map(|v| Vote { first: of(v.first), second: of(v.second), ..*v }).collect();
        let Precedence { order, overruled } = precedence(self.placements.len(), &joint, self.budget)?;
        let has_copies = self.instances.len() > self.placements.len();
        if !has_copies {
            return Ok(Ordered { order, sequence: Vec::new(), overruled: overruled.len() });
        }
        let mut rank = vec![0; order.len()];
        order.iter().enumerate().for_each(|(k, &i)| rank[i] = k);
        if joint.iter().all(|v| rank[v.first] < rank[v.second]) {
            return Ok(Ordered { order, sequence: Vec::new(), overruled: 0 });
        }
        let Precedence { order: instances, overruled } = precedence(self.instances.len(), votes, self.budget)?;
        // An element is named by the place where it lies itself.
        let is_itself = |i: &&usize| self.instances[**i].around == [0, 0];
        let order: Vec<usize> = instances.iter().filter(is_itself).map(|&i| of(i)).collect();
        order.iter().enumerate().for_each(|(k, &i)| rank[i] = k);
        let renamed = |&i: &usize| Instance { placement: rank[of(i)], ..self.instances[i] };
        Ok(Ordered { order, sequence: instances.iter().map(renamed).collect(), overruled: overruled.len() })
    }
}

/// How often a body is moved along each side of a torus so that it is seen in its box: itself first.
fn copies(body: &PlacedFigure, domain: &Domain<2>) -> Vec<[i32; 2]> {
    let mut copies = vec![[0, 0]];
    let Domain::Torus(tile) = domain else { return copies };
    let size = tile.size();
    let range = |k: usize| {
        let first = ((tile.min[k] - body.centre[k] - body.radius) / size[k]).ceil();
        let last = ((tile.max[k] - body.centre[k] + body.radius) / size[k]).floor();
        first.max(-MOST_TURNS) as i32..=last.min(MOST_TURNS) as i32
    };
    copies.extend(range(1).flat_map(|y| range(0).map(move |x| [x, y])).filter(|&around| around != [0, 0]));
    copies
}

/// Farthest copy of an element on a torus: more would be needed by an element far larger than the tile.
const MOST_TURNS: f64 = 4.0;
