//! The part of a run that is in motion: sites that are open, the points in their windows, and what stands around these.
//!
//! All else stays as it is, to the last bit. A run leaves out in this way what has settled, and a stroke of a brush what is out of its
//! reach: the steps of the solver know nothing of it, for a part is a small run in which some matches and points stand.

use arabesque_core::{Budget, GridIndex, Result, Vector};

use crate::{
    energy::{
        level::{Level, Matches},
        links::{Lists, SiteIndex},
    },
    output::state::Output,
    territory::site::Site,
};

/// A part of the sites and points of a level.
pub(crate) struct Part<const D: usize> {
    /// Numbers of its sites in the whole, the open ones first.
    pub(crate) numbers: Vec<usize>,
    /// How many are open.
    pub(crate) open: usize,
    sites: Vec<Site<D>>,
    index: SiteIndex<D>,
    /// Who is next to whom.
    pub(crate) around: Lists,
    /// The points: first those that stand, then those that may move.
    pub(crate) output: Output<D>,
    /// Where its sites look.
    pub(crate) places: Vec<Vector<D>>,
    /// For each point of the whole whether it may move.
    moves: Vec<bool>,
}

impl<const D: usize> Part<D> {
    /// The part of `level` in which the sites for which `open` says so are open.
    pub(crate) fn new(
        level: &Level<'_, D>,
        (around, step): (&Lists, f64),
        output: &Output<D>,
        matches: &[Vector<D>],
        open: &[bool],
        budget: &Budget,
    ) -> Result<Self> {
        let mut numbers: Vec<usize> = (0..level.sites.len()).filter(|&q| open[q]).collect();
        let count = numbers.len();
        let mut meter = budget.meter();
        let radius = level.tables.kernel.pairs();
        let index = GridIndex::new(&output.places, radius, level.domain);
        let mut moves = vec![false; output.places.len()];
        for &q in &numbers {
            let site = &level.sites[q];
            let looked = index.within(site.place, level.tables.reach.radius() * site.scale, |i, offset| {
                if !output.is_kept(i) && level.tables.reach.holds(&site.seen(offset)) {
                    output.members(i).for_each(|k| moves[k] = true);
                }
            });
            meter.spend(20 + 12 * looked)?;
        }
        let largest = level.sites.iter().map(|s| s.scale).fold(0.0, f64::max);
        let mut stands = vec![false; output.places.len()];
        let mut known: Vec<bool> = open.to_vec();
        for i in (0..moves.len()).filter(|&i| moves[i]) {
            let looked = index.within(output.places[i], radius * largest, |j, _| {
                if !moves[j] {
                    output.members(j).for_each(|k| stands[k] = true);
                }
            });
            meter.spend(20 + 6 * looked)?;
        }
        let mut near = Vec::new();
        for i in (0..moves.len()).filter(|&i| moves[i] || stands[i]) {
            let looked = level.index.windows(level.sites, output.places[i], &level.tables.reach, |q, _| near.push(q));
            meter.spend(20 + 12 * looked)?;
        }
        near.extend(numbers.iter().flat_map(|&q| around.of(q).iter().map(|&n| n as usize)));
        for q in near {
            if !std::mem::replace(&mut known[q], true) {
                numbers.push(q);
            }
        }
        numbers[count..].sort_unstable();
        Ok(Self::of(level, (around, step), (output, matches), (numbers, count), (moves, &stands)))
    }

    fn of(
        level: &Level<'_, D>,
        (around, step): (&Lists, f64),
        (output, matches): (&Output<D>, &[Vector<D>]),
        (numbers, open): (Vec<usize>, usize),
        (moves, stands): (Vec<bool>, &[bool]),
    ) -> Self {
        let sites: Vec<Site<D>> = numbers.iter().map(|&q| level.sites[q]).collect();
        let mut own = vec![u32::MAX; level.sites.len()];
        numbers.iter().enumerate().for_each(|(n, &q)| own[q] = n as u32);
        let lists: Vec<Vec<u32>> = numbers
            .iter()
            .map(|&q| around.of(q).iter().map(|&n| own[n as usize]).filter(|&n| n != u32::MAX).collect())
            .collect();
        let mut chosen = Output::default();
        output.heads().filter(|&i| stands[i]).for_each(|i| {
            chosen.take(level.pattern, output, i);
        });
        chosen.kept = chosen.places.len();
        output.heads().filter(|&i| moves[i]).for_each(|i| {
            chosen.take(level.pattern, output, i);
        });
        Self {
            index: SiteIndex::new(&sites, step, level.domain),
            around: Lists::new(&lists),
            output: chosen,
            places: numbers.iter().map(|&q| matches[q]).collect(),
            numbers,
            open,
            sites,
            moves,
        }
    }

    /// The level as this part sees it.
    pub(crate) fn level<'t>(&'t self, whole: &Level<'t, D>) -> Level<'t, D> {
        Level { sites: &self.sites, index: &self.index, open: self.open, ..*whole }
    }

    /// Puts points and matches back into the whole: what stood stays as it is, what may move comes after it.
    pub(crate) fn back(
        &self,
        level: &Level<'_, D>,
        (output, matches): (&Output<D>, &Matches<D>),
        whole: (&mut Output<D>, &mut [Vector<D>]),
    ) {
        let mut joined = Output::default();
        for i in whole.0.heads().filter(|&i| !self.moves[i]) {
            let count = joined.take(level.pattern, whole.0, i);
            joined.kept += if whole.0.is_kept(i) { count } else { 0 };
        }
        for i in output.heads().filter(|&i| !output.is_kept(i)) {
            joined.take(level.pattern, output, i);
        }
        *whole.0 = joined;
        self.numbers[..self.open].iter().zip(&matches.places).for_each(|(&q, &m)| whole.1[q] = m);
    }
}
