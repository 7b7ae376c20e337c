//! Places of the page that are worked on at the same time.
//!
//! Each is worked on in a copy of its surroundings; what comes of it is carried over to the page in the order of the places. Those
//! whose surroundings overlap wait for one another, so that the result is that of working on one after the other, and the same for
//! any number of threads.

use arabesque_core::{Meter, Result, Vector};
use rayon::prelude::*;

use crate::{
    dimension::Dimension,
    evenness::{
        ink::Pose,
        moves::FAR,
        page::NOBODY,
        share::Shares,
        work::{Part, Work},
    },
};

/// Most places that are worked on at the same time, before something is told.
const BATCH: usize = 64;

/// How far around a place elements may be that are moved, in mean spacings.
const GROUP: f64 = 2.0;

/// Nanoseconds for a part of the page that is looked at.
const LOOK: u64 = 4;

/// What is done about a place.
pub(crate) trait Task<const D: usize>: Sync {
    /// The place.
    fn place(&self, work: &Work<'_, D>) -> Vector<D>;

    /// Whether there is still something to do; asked before it is done, on the whole page.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    fn is_open(&self, work: &Work<'_, D>, done: &mut Vec<bool>, meter: &mut Meter<'_>) -> Result<bool>;

    /// Does it, on the page or a part of it. Returns whether it helped.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    fn act(&self, work: &mut Work<'_, D>, meter: &mut Meter<'_>) -> Result<bool>;
}

/// What becomes of one element.
enum Change<const D: usize> {
    Pose(u32, Pose<D>),
    Add(Pose<D>),
    Remove(u32),
}

/// What came of a task.
struct Done<const D: usize> {
    changes: Vec<Change<D>>,
    helped: bool,
}

impl<const D: usize> Work<'_, D>
where
    Vector<D>: Dimension<D>,
{
    /// Does tasks, those first that come first. Calls `told` after each, with whether it helped.
    ///
    /// # Errors
    /// What `told` gives, and when the budget is used up or somebody asks to stop.
    pub(crate) fn at_once<T: Task<D>>(
        &mut self,
        tasks: Vec<T>,
        meter: &mut Meter<'_>,
        told: &mut dyn FnMut(&mut Self, bool) -> Result<()>,
    ) -> Result<()> {
        let radius = self.surroundings();
        let mut seen = vec![0_u32; self.page.parts()];
        let mut finished = Vec::new();
        let mut open = tasks;
        let mut turn = 0;
        while !open.is_empty() {
            turn += 1;
            let mut rest = open.into_iter();
            let (mut now, mut later) = (Vec::new(), Vec::new());
            for task in rest.by_ref() {
                let p = task.place(self);
                if !self.is_apart(p, radius, &seen, turn, meter)? {
                    later.push(task);
                } else if task.is_open(self, &mut finished, meter)? {
                    self.page.parts_within(p, radius, |part| seen[part] = turn);
                    now.push(task);
                }
                if now.len() == BATCH {
                    break;
                }
            }
            let here = || vec![NOBODY; self.page.bodies.len()];
            let act = |here: &mut Vec<u32>, task: &T| self.done(task, radius, here);
            let done = now.par_iter().map_init(here, act).collect::<Result<Vec<_>>>()?;
            self.budget.spend(0)?;
            let mut again = Vec::new();
            for (task, done) in now.into_iter().zip(done) {
                // Those before it may have taken up what there may be more or less of a class.
                if !self.suits(&done) {
                    again.push(task);
                    continue;
                }
                self.carry_over(&done, meter)?;
                told(self, done.helped)?;
            }
            again.extend(later);
            again.extend(rest);
            open = again;
        }
        Ok(())
    }

    /// How far around a place its surroundings reach.
    fn surroundings(&self) -> f64 {
        let scale = self.extent.largest_spacing_scale;
        let largest = self.page.largest().min(self.page.reach);
        let sight = largest + self.page.reach.max(self.natural.widest * scale);
        let shares = self.shares.as_ref().map_or(0.0, Shares::widest);
        (GROUP * self.library.spacing + 2.0 * FAR * self.natural.tolerated) * scale + sight.max(shares)
    }

    /// Whether nobody works around a place this turn.
    fn is_apart(&self, p: Vector<D>, radius: f64, seen: &[u32], turn: u32, meter: &mut Meter<'_>) -> Result<bool> {
        if seen[self.page.part(p)] == turn {
            return Ok(false);
        }
        let (mut looked, mut is_apart) = (0, true);
        self.page.parts_within(p, radius, |part| {
            looked += 1;
            is_apart &= seen[part] != turn;
        });
        meter.spend(LOOK * looked)?;
        Ok(is_apart)
    }

    /// What comes of a task in a copy of its surroundings.
    fn done(&self, task: &impl Task<D>, radius: f64, here: &mut [u32]) -> Result<Done<D>> {
        let mut part = self.part_around(task.place(self), radius, here);
        let helped = task.act(&mut part, &mut self.budget.meter())?;
        part.keep();
        let Some(Part { mut kept, numbers, .. }) = part.part else { return Ok(Done { changes: Vec::new(), helped }) };
        kept.sort_unstable();
        kept.dedup();
        let change = |k: u32| {
            let body = &part.page.bodies[k as usize];
            match numbers.get(k as usize) {
                None => body.alive.then_some(Change::Add(body.pose)),
                Some(&b) if !body.alive => Some(Change::Remove(b)),
                Some(&b) => (self.page.body(b).pose != body.pose).then_some(Change::Pose(b, body.pose)),
            }
        };
        Ok(Done { changes: kept.into_iter().filter_map(change).collect(), helped })
    }

    /// Whether there may still be as many of each class as there would be.
    fn suits(&self, done: &Done<D>) -> bool {
        let class = |pose: &Pose<D>| self.library.class[pose.source];
        done.changes.iter().all(|change| match change {
            Change::Pose(..) => true,
            Change::Add(pose) => self.wants(class(pose)),
            Change::Remove(b) => self.spares(class(&self.page.body(*b).pose)),
        })
    }

    fn carry_over(&mut self, done: &Done<D>, meter: &mut Meter<'_>) -> Result<()> {
        for change in &done.changes {
            match *change {
                Change::Pose(b, pose) => self.change(b, pose, meter)?,
                Change::Add(pose) => _ = self.add(pose, meter)?,
                Change::Remove(b) => self.remove(b, meter)?,
            }
        }
        self.keep();
        Ok(())
    }
}
