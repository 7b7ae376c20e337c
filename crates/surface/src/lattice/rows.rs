//! Things in rows: where rows slip, each has room for a whole number of things, evenly apart.

use arabesque_core::{Bounds, Budget, Domain, GridIndex, Result, Vector};

use super::{
    laid::SurfaceLattice,
    links::{Axes, way},
};
use crate::mesh::{Closest, MeshIndex};

/// Things lie in one row when they are off it by less than this share of the distance of rows.
const SAME_ROW: f64 = 0.35;
/// The next one in a row lies nearer than so many repeats along it.
const REACH: f64 = 1.6;
/// A closed row is tighter than the pattern by no more than this share of a repeat, so that joints become wider rather than narrower; an
/// open one, whose ends stay, by no more than that.
const TIGHT: [f64; 2] = [0.15, 0.5];
/// How much things hold on to their places: a misfit is spread over about so many of them as 1 over the root of this. Sweeps until it is.
const HOLD: f64 = 0.07;
const SWEEPS: usize = 100;
/// A row is moved in so many steps, so that it stays on the mesh.
const STEPS: usize = 4;
/// Work for a thing that is moved, and for one that is looked at.
const MOVE: u64 = 4000;
const LOOK: u64 = 12;

/// A thing in a row.
#[derive(Clone, Copy, Debug)]
pub struct RowSite {
    /// The point of the mesh below it.
    pub at: Closest,
    /// Where it belongs in the pattern.
    pub offset: Vector<2>,
    /// What it is, for the caller.
    pub item: usize,
}

/// A row: its sites one after another, each with the way to the next as it is.
struct Row {
    sites: Vec<(usize, f64)>,
    is_closed: bool,
}

impl SurfaceLattice {
    /// Things at places of this lattice, moved along their rows until gaps differ from those of the pattern by as little as may be; rows that
    /// close up lose or gain whole repeats first. Nothing changes where rows do not slip.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    pub fn even_rows(
        &self,
        index: &MeshIndex,
        axes: &dyn Fn(&Closest) -> Axes,
        sites: Vec<RowSite>,
        budget: &Budget,
    ) -> Result<Vec<RowSite>> {
        let Some(along) = self.cell.rows() else { return Ok(sites) };
        let [repeat, apart] = self.cell.spreads();
        budget.spend(MOVE * (STEPS * sites.len()) as u64)?;
        let frames: Vec<Axes> = sites.iter().map(|site| axes(&site.at)).collect();
        let gaps = Gaps { sites: &sites, frames: &frames, along, repeat, apart, height: self.height };
        let mut evened = Vec::with_capacity(sites.len());
        for row in gaps.rows(budget)? {
            budget.spend(LOOK * (SWEEPS * row.sites.len()) as u64)?;
            for (site, shift) in gaps.evened(row) {
                let at = self.moved(index, axes, (sites[site].at, frames[site]), along * shift);
                evened.push(RowSite { at, ..sites[site] });
            }
        }
        Ok(evened)
    }

    /// A point of the mesh some way along its row.
    fn moved(
        &self,
        index: &MeshIndex,
        axes: &dyn Fn(&Closest) -> Axes,
        (mut at, mut frame): (Closest, Axes),
        shift: Vector<2>,
    ) -> Closest {
        if shift == Vector::ZERO {
            return at;
        }
        let step = shift * (1.0 / STEPS as f64);
        for _ in 0..STEPS {
            at = index.closest(at.point + at.normal * self.height + frame[0] * step[0] + frame[1] * step[1]);
            frame = axes(&at);
        }
        at
    }
}

/// How far away a site is along a row, and its number.
type Neighbour = (f64, usize);

/// Sites and what is between them.
struct Gaps<'a> {
    sites: &'a [RowSite],
    frames: &'a [Axes],
    along: Vector<2>,
    /// How far apart the pattern repeats along a row, and how far apart rows are.
    repeat: f64,
    apart: f64,
    height: f64,
}

impl Gaps<'_> {
    fn place(&self, i: usize) -> Vector<3> {
        self.sites[i].at.point + self.sites[i].at.normal * self.height
    }

    /// From one site to another: along the row and across it.
    fn way(&self, i: usize, j: usize) -> [f64; 2] {
        let way = way((self.place(i), self.frames[i]), (self.place(j), self.frames[j]));
        [way.dot(self.along), self.along.cross(way)]
    }

    /// The way from one site to the next as the pattern has it.
    fn wanted(&self, i: usize, j: usize) -> f64 {
        let away = (self.sites[j].offset - self.sites[i].offset).dot(self.along);
        let rest = away.rem_euclid(self.repeat);
        if rest < 0.02 * self.repeat { rest + self.repeat } else { rest }
    }

    /// The rows: sites each of which is the next of the one before, and that the one before of it.
    fn rows(&self, budget: &Budget) -> Result<Vec<Row>> {
        let places: Vec<_> = (0..self.sites.len()).map(|i| self.place(i)).collect();
        let reach = REACH * self.repeat;
        let bounds = Bounds::around(places.iter().copied()).grown(reach);
        let near = GridIndex::new(&places, reach, &Domain::Box(bounds));
        let mut meter = budget.meter();
        let (mut next, mut before) = (vec![None; places.len()], vec![None; places.len()]);
        for (i, &p) in places.iter().enumerate() {
            let (mut first, mut last) = (None::<Neighbour>, None::<Neighbour>);
            let looked = near.within(p, reach, |j, _| {
                if j == i || self.frames[i][0].dot(self.frames[j][0]) < 0.5 {
                    return;
                }
                let [along, across] = self.way(i, j);
                if across.abs() < SAME_ROW * self.apart {
                    if along > 0.0 && first.is_none_or(|(far, _)| along < far) {
                        first = Some((along, j));
                    } else if along < 0.0 && last.is_none_or(|(far, _)| -along < far) {
                        last = Some((-along, j));
                    }
                }
            });
            meter.spend(100 + LOOK * looked)?;
            (next[i], before[i]) = (first.map(|(_, j)| j), last.map(|(_, j)| j));
        }
        let follows = |i: usize| next[i].filter(|&j: &usize| before[j] == Some(i));
        let leads = |j: usize| before[j].filter(|&i: &usize| next[i] == Some(j));
        let mut is_in = vec![false; places.len()];
        let mut rows = Vec::new();
        // Open rows from their starts; what is left then is closed.
        for is_closed in [false, true] {
            for start in 0..places.len() {
                if is_in[start] || !is_closed && leads(start).is_some() {
                    continue;
                }
                let (mut sites, mut at) = (Vec::new(), Some(start));
                while let Some(i) = at.filter(|&i| !is_in[i]) {
                    is_in[i] = true;
                    at = follows(i);
                    sites.push((i, at.map_or(0.0, |j| self.way(i, j)[0])));
                }
                rows.push(Row { sites, is_closed });
            }
        }
        Ok(rows)
    }

    /// How many sites of a row are one repeat of the pattern.
    fn period(&self, row: &Row) -> usize {
        let length: f64 = row.sites.windows(2).map(|w| self.wanted(w[0].0, w[1].0)).sum::<f64>() + self.repeat;
        ((row.sites.len() as f64 * self.repeat / length).round() as usize).max(1)
    }

    /// By how much each gap of a row is wider than in the pattern.
    fn misfits(&self, row: &Row) -> Vec<f64> {
        let n = row.sites.len();
        let gaps = if row.is_closed { n } else { n - 1 };
        (0..gaps).map(|k| row.sites[k].1 - self.wanted(row.sites[k].0, row.sites[(k + 1) % n].0)).collect()
    }

    /// The sites of a row, less or more by whole repeats where it is too tight or too wide for them, and how far each moves so that all
    /// misfits are alike; the ends of an open row stay.
    fn evened(&self, mut row: Row) -> Vec<(usize, f64)> {
        let much = self.misfits(&row).iter().sum::<f64>() / self.repeat;
        let many = if row.is_closed { (much + TIGHT[0]).floor() } else { (much + TIGHT[1]).floor().min(0.0) };
        let period = self.period(&row);
        // Where each lies from where it is said to be: what is put in lies beyond the one that it is like.
        let mut beyond = vec![0.0; row.sites.len()];
        for _ in 0..(many.abs() as usize).min(row.sites.len() / (2 * period)) {
            if many < 0.0 { row.take_out(period, &mut beyond) } else { row.put_in(period, &mut beyond) }
        }
        let shifts = evened(&self.misfits(&row), row.is_closed);
        row.sites.iter().zip(beyond).zip(shifts).map(|(((site, _), beyond), shift)| (*site, beyond + shift)).collect()
    }
}

impl Row {
    /// Where the run of so many sites begins that has least room, or most; the ends of an open row are no part of it.
    fn run(&self, length: usize, sign: f64) -> Option<usize> {
        let n = self.sites.len();
        if n < length + 2 {
            return None;
        }
        let room = |k: usize| sign * (0..=length).map(|m| self.sites[(k + n - 1 + m) % n].1).sum::<f64>();
        let starts = if self.is_closed { 0..n } else { 1..n - length };
        starts.min_by(|&a, &b| room(a).total_cmp(&room(b)))
    }

    /// A closed row with another of its sites as the first.
    fn begun_at(&mut self, start: usize, beyond: &mut [f64]) {
        self.sites.rotate_left(start);
        beyond.rotate_left(start);
    }

    /// Takes out the run that has least room.
    fn take_out(&mut self, length: usize, beyond: &mut Vec<f64>) {
        let Some(mut start) = self.run(length, 1.0) else { return };
        if self.is_closed {
            self.begun_at((start + self.sites.len() - 1) % self.sites.len(), beyond);
            start = 1;
        }
        let room: f64 = self.sites.drain(start..start + length).map(|(_, gap)| gap).sum();
        beyond.drain(start..start + length);
        self.sites[start - 1].1 += room;
    }

    /// Doubles the run of a closed row that has most room: both share it.
    fn put_in(&mut self, length: usize, beyond: &mut Vec<f64>) {
        let Some(start) = self.run(length, -1.0) else { return };
        self.begun_at(start, beyond);
        let room: f64 = self.sites[..length].iter().map(|(_, gap)| gap).sum();
        let mut from = 0.0;
        for k in 0..length {
            let (site, gap) = self.sites[k];
            self.sites[k].1 = 0.5 * gap;
            self.sites.insert(length + k, (site, 0.5 * gap));
            // What lay so far from the start of the run lies half as far, and its double as far behind half of the room.
            let own = beyond[k];
            beyond[k] = own - 0.5 * from;
            beyond.insert(length + k, own + 0.5 * (room - from));
            from += gap;
        }
    }
}

/// How far each site of a row moves so that misfits become alike near by and moves stay small; the ends of an open row stay.
fn evened(misfits: &[f64], is_closed: bool) -> Vec<f64> {
    let gaps = misfits.len();
    let sites = if is_closed { gaps } else { gaps + 1 };
    let mut shifts = vec![0.0; sites];
    if gaps < 2 {
        return shifts;
    }
    let inner = if is_closed { 0..sites } else { 1..sites - 1 };
    for _ in 0..SWEEPS {
        for k in inner.clone() {
            let (before, after) = ((k + sites - 1) % sites, (k + 1) % sites);
            let wanted = misfits[k] - misfits[before];
            shifts[k] = (wanted + shifts[before] + shifts[after]) / (2.0 + HOLD);
        }
    }
    shifts
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Stage, Stream};

    use super::*;

    #[test]
    fn runs_are_taken_out_and_doubled_in_rows_of_any_length() {
        let mut stream = Stream::new(5, Stage::TEST, 0);
        for n in 1..9 {
            for (length, is_closed) in [(1, true), (2, true), (3, true), (1, false), (2, false)] {
                let sites: Vec<_> = (0..n).map(|k| (k, stream.range(0.5, 1.5))).collect();
                let row = || Row { sites: sites.clone(), is_closed };
                let total = |row: &Row| row.sites.iter().map(|(_, gap)| gap).sum::<f64>();
                let changes = n >= length + 2;
                let (mut less, mut beyond) = (row(), vec![0.0; n]);
                less.take_out(length, &mut beyond);
                assert_eq!((less.sites.len(), beyond.len()), if changes { (n - length, n - length) } else { (n, n) });
                assert!((total(&less) - total(&row())).abs() < 1e-12);
                if is_closed {
                    let (mut more, mut beyond) = (row(), vec![0.0; n]);
                    more.put_in(length, &mut beyond);
                    assert_eq!(
                        (more.sites.len(), beyond.len()),
                        if changes { (n + length, n + length) } else { (n, n) }
                    );
                    assert!((total(&more) - total(&row())).abs() < 1e-12);
                }
            }
        }
        // The double of one lies half of the way to the next.
        let mut row = Row { sites: vec![(0, 1.0), (1, 1.8), (2, 1.0)], is_closed: true };
        let mut beyond = vec![0.0; 3];
        row.put_in(1, &mut beyond);
        let double = row.sites.iter().zip(&beyond).find(|(_, beyond)| **beyond > 0.0).map(|((site, _), b)| (*site, *b));
        assert!(matches!(double, Some((1 | 2, at)) if at > 0.4), "{double:?}");
    }

    #[test]
    fn misfits_are_shared_with_what_is_near() {
        let after = |misfits: &[f64], shifts: &[f64]| -> Vec<f64> {
            let n = shifts.len();
            misfits.iter().enumerate().map(|(k, m)| m + shifts[(k + 1) % n] - shifts[k]).collect()
        };
        let mut misfits = [0.0; 30];
        misfits[7] = 0.6;
        for is_closed in [true, false] {
            let shifts = evened(&misfits, is_closed);
            assert_eq!(shifts.len(), if is_closed { 30 } else { 31 });
            let left = after(&misfits, &shifts);
            assert!(left.iter().all(|m| (-0.01..0.13).contains(m)), "{left:?}");
            assert!(left[20].abs() < 0.005 && (left.iter().sum::<f64>() - 0.6).abs() < 1e-9);
        }
        assert_eq!(evened(&[0.4], false), [0.0; 2]);
    }
}
