//! The rounds in which a page is evened out: everything settles, then clumps, holes, and places with too much or too little ink,
//! the worst first.

use arabesque_core::{Budget, Meter, Result, Vector};
use rayon::prelude::*;

use crate::{
    dimension::Dimension,
    evenness::{at_once::Task, page::Body, share::Shares, work::Work},
};

/// Rounds over the page; one that helps so many times less than the one that helped most is the last.
const ROUNDS: u32 = 3;
const LITTLE: usize = 12;

/// Sweeps over elements that pay.
const SWEEPS: usize = 4;

/// Elements around one that has moved that look again.
const NEXT: usize = 10;

/// A place is a hole when it is farther from ink than so many tolerated distances.
const HOLE: f64 = 1.05;

/// Shares of ink are worked on that are off by so many deviations more than what is natural.
const OFF: f64 = 0.3;

/// Elements are too near each other when so much is missing, in tolerated distances.
const NEAR: f64 = 0.02;

/// Share by which a class may have fewer elements than it should in the end, and how many beside: of a handful, one is more than a share.
const FEWER: (f64, f64) = (0.025, 1.5);

/// Places that are worked on before something is told.
const TOLD: usize = 48;

/// What there is, while it is worked on.
pub(crate) type Tell<'a, const D: usize> = &'a mut dyn FnMut(&[Body<D>]) -> Result<()>;

/// Evens out a page.
///
/// # Errors
/// What `tell` gives, and when the budget is used up or somebody asks to stop; then the move that was tried is undone by whoever calls.
pub(crate) fn run<const D: usize>(work: &mut Work<'_, D>, budget: &Budget, tell: Tell<'_, D>) -> Result<()>
where
    Vector<D>: Dimension<D>,
{
    let mut meter = budget.meter();
    let mut rounds = Rounds { work, tell, handled: 0 };
    let mut most = 0;
    for round in 1..=ROUNDS {
        rounds.work.now = round + 1;
        // What would draw in the elements around a hole leaves fewer of them than there should be: holes come first.
        let mut moves = rounds.holes(round, &mut meter)?;
        moves += rounds.clumps(round, &mut meter)?;
        moves += rounds.shares(round, &mut meter)?;
        most = moves.max(most);
        if moves * LITTLE <= most {
            break;
        }
        rounds.relax(&mut meter)?;
    }
    rounds.relax(&mut meter)?;
    // What still lies on something has no room: rather a few less than there should be.
    (rounds.work.fewer, rounds.work.spare) = FEWER;
    rounds.work.now += 1;
    if rounds.clumps(0, &mut meter)? > 0 {
        rounds.relax(&mut meter)?;
    }
    Ok(())
}

struct Rounds<'r, 'a, const D: usize> {
    work: &'r mut Work<'a, D>,
    tell: Tell<'r, D>,
    handled: usize,
}

impl<const D: usize> Rounds<'_, '_, D>
where
    Vector<D>: Dimension<D>,
{
    /// Lets elements that pay settle, and then those around the ones that did, until nothing moves.
    fn relax(&mut self, meter: &mut Meter<'_>) -> Result<()> {
        let mut open: Vec<u32> = (0..self.work.page.bodies.len() as u32).collect();
        for _ in 0..SWEEPS {
            let mut next = Vec::new();
            let unsettled = self.work.unsettled(&open)?;
            let (handled, tell) = (&mut self.handled, &mut self.tell);
            self.work.settle_all(unsettled, meter, &mut |work, b| {
                next.extend(work.group(work.page.body(b).pose.centre, NEXT));
                work.keep();
                *handled += 1;
                if handled.is_multiple_of(TOLD) { tell(&work.page.bodies) } else { Ok(()) }
            })?;
            next.sort_unstable();
            next.dedup();
            open = next;
        }
        Ok(())
    }

    /// Works on elements that are too near each other, the nearest first.
    fn clumps(&mut self, round: u32, meter: &mut Meter<'_>) -> Result<usize> {
        let work = &*self.work;
        let is_new = |b: &u32| work.has_changed(work.page.body(*b).pose.centre, round);
        let open: Vec<u32> = (0..work.page.bodies.len() as u32).filter(is_new).collect();
        let missing = |&b: &u32| Ok((work.worst(b, &mut work.budget.meter())?, b));
        let mut clumps: Vec<(f64, u32)> = open.par_iter().with_min_len(16).map(missing).collect::<Result<_>>()?;
        work.budget.spend(0)?;
        clumps.retain(|(missing, _)| *missing > NEAR);
        clumps.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        self.work_on(clumps.into_iter().map(|(_, b)| Clump(b)).collect(), meter)
    }

    /// Works on holes, the widest first.
    fn holes(&mut self, round: u32, meter: &mut Meter<'_>) -> Result<usize> {
        let page = &self.work.page;
        let depth = |c: usize| page.cells[c].empty() / page.cells[c].tolerated;
        let is_new = |c: &usize| self.work.has_changed(page.lattice.centre(*c), round);
        let deep = (0..page.cells.len()).filter(|&c| depth(c) > HOLE as f32).filter(is_new);
        let mut holes: Vec<(f32, usize)> = deep.map(|c| (depth(c), c)).collect();
        holes.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let hole = |(depth, cell)| Hole { depth, cell, place: page.lattice.centre(cell) };
        self.work_on(holes.into_iter().map(hole).collect(), meter)
    }

    /// Works on places where there is too much or too little ink around, the worst first.
    fn shares(&mut self, round: u32, meter: &mut Meter<'_>) -> Result<usize> {
        let off = self.work.shares.as_ref().map_or_else(Vec::new, Shares::off);
        let off = off.into_iter().filter(|(excess, _)| excess.abs() > OFF);
        self.work_on(off.map(|(excess, place)| Share { excess, place, round }).collect(), meter)
    }

    /// Does tasks; returns how many of them helped.
    fn work_on<T: Task<D>>(&mut self, tasks: Vec<T>, meter: &mut Meter<'_>) -> Result<usize> {
        let (handled, tell) = (&mut self.handled, &mut self.tell);
        let mut moves = 0;
        self.work.at_once(tasks, meter, &mut |work, helped| {
            moves += usize::from(helped);
            *handled += 1;
            if handled.is_multiple_of(TOLD) { tell(&work.page.bodies) } else { Ok(()) }
        })?;
        Ok(moves)
    }
}

/// An element that is too near another one.
struct Clump(u32);

impl<const D: usize> Task<D> for Clump
where
    Vector<D>: Dimension<D>,
{
    fn place(&self, work: &Work<'_, D>) -> Vector<D> {
        work.page.body(self.0).pose.centre
    }

    fn is_open(&self, work: &Work<'_, D>, _: &mut Vec<bool>, meter: &mut Meter<'_>) -> Result<bool> {
        Ok(work.worst(self.0, meter)? > NEAR)
    }

    fn act(&self, work: &mut Work<'_, D>, meter: &mut Meter<'_>) -> Result<bool> {
        let Some(b) = work.here(self.0) else { return Ok(false) };
        let p = work.page.body(b).pose.centre;
        let mut helped = work.is_surplus(b) && work.thin(b, meter)?;
        if !helped {
            helped = work.give_way(p, meter)? > 0.0;
            work.keep();
        }
        if work.worst(b, meter)? > NEAR {
            helped |= work.exchange(p, 1, meter)? || work.thin(b, meter)?;
        }
        Ok(helped)
    }
}

/// A place that was farther from ink than is tolerated, by so many tolerated distances.
struct Hole<const D: usize> {
    depth: f32,
    cell: usize,
    place: Vector<D>,
}

impl<const D: usize> Task<D> for Hole<D>
where
    Vector<D>: Dimension<D>,
{
    fn place(&self, _: &Work<'_, D>) -> Vector<D> {
        self.place
    }

    /// A hole is looked at once a round.
    fn is_open(&self, work: &Work<'_, D>, done: &mut Vec<bool>, _: &mut Meter<'_>) -> Result<bool> {
        let page = &work.page;
        let cell = &page.cells[self.cell];
        done.resize(page.cells.len(), false);
        if done[self.cell] || cell.empty() / cell.tolerated < self.depth * 0.98 {
            return Ok(false);
        }
        let around = 0.5 * f64::from(cell.empty());
        page.lattice.around(self.place, around, |c, _| done[c] = true);
        Ok(true)
    }

    fn act(&self, work: &mut Work<'_, D>, meter: &mut Meter<'_>) -> Result<bool> {
        let p = self.place;
        Ok(work.fill(p, meter)? || work.exchange(p, 3, meter)? || work.give_way(p, meter)? > 0.0)
    }
}

/// A place with more or less ink around than usual, by so many deviations more than is natural.
struct Share<const D: usize> {
    excess: f64,
    place: Vector<D>,
    round: u32,
}

impl<const D: usize> Task<D> for Share<D>
where
    Vector<D>: Dimension<D>,
{
    fn place(&self, _: &Work<'_, D>) -> Vector<D> {
        self.place
    }

    fn is_open(&self, work: &Work<'_, D>, _: &mut Vec<bool>, _: &mut Meter<'_>) -> Result<bool> {
        Ok(work.has_changed(self.place, self.round))
    }

    fn act(&self, work: &mut Work<'_, D>, meter: &mut Meter<'_>) -> Result<bool> {
        let p = self.place;
        let mut helped = work.exchange(p, 5, meter)?;
        if let (false, true, Some(hole)) = (helped, self.excess < 0.0, work.emptiest(p)) {
            helped = work.fill(hole, meter)?;
        }
        if !helped && self.excess > 0.0 {
            for b in work.group(p, 5) {
                helped = helped || (work.is_surplus(b) && work.thin(b, meter)?);
            }
        }
        Ok(helped)
    }
}
