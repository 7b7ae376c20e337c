//! Which part of which exemplar each piece may show: ends of the curve, transitions, a fixed first piece.

use std::{ops::Range, sync::Arc};

use arabesque_core::{Budget, Error, Result};
use rayon::prelude::*;

use crate::{
    constraints::valid::{Demands, Grade, Offset, Site},
    exemplar::strip::Strip,
    geometry::cage::Cage,
    params::{RibbonParams, WANDER},
    request::RibbonRequest,
};

/// Half of the length of a transition, in heights of the exemplar.
const TRANSITION: f64 = 1.5;

/// Room beside the least detour, in heights of the exemplar.
const RESERVE: f64 = 0.1;
/// How fast a detour may begin and end: across against along.
const SLOPE: f64 = 0.25;

/// Everything that the demands on the pieces of one curve follow from.
pub(crate) struct Plan<'a, const D: usize> {
    pub(crate) strip: &'a Strip,
    pub(crate) params: &'a RibbonParams,
    pub(crate) request: &'a RibbonRequest<D>,
    pub(crate) cage: &'a Cage<D>,
    pub(crate) budget: &'a Budget,
}

impl<const D: usize> Plan<'_, D> {
    /// What is asked of each piece, beside the pixels that must stay `free`.
    pub(crate) fn demands(&self, free: Vec<Arc<Vec<Offset>>>) -> Result<Vec<Demands>> {
        let changes = changes(&self.request.changes, self.strip.spans.len())?;
        let mut demands: Vec<Demands> = free
            .into_iter()
            .enumerate()
            .map(|(k, forbidden)| Demands { columns: self.body(k, &changes), forbidden, ..Demands::default() })
            .collect();
        if !self.cage.closed {
            self.start(&mut demands);
            self.end(&mut demands);
        }
        for (k, wander) in self.wander(&demands)?.into_iter().enumerate() {
            demands[k].rows = Some(self.rows(k, wander));
        }
        self.first(&mut demands)?;
        Ok(demands)
    }

    /// Length of a piece, in pixels of the search.
    fn step(&self) -> f64 {
        self.cage.step / self.cage.scale
    }

    /// How far each piece may leave the middle, in pixels of the search: no farther than it must to have a valid position, and on the
    /// way there and back.
    fn wander(&self, demands: &[Demands]) -> Result<Vec<f64>> {
        let height = self.strip.height as f64;
        let limit = (self.params.wander.unwrap_or(WANDER) * height).max(1.0);
        let n = demands.len();
        if self.params.wander.is_some() {
            return Ok(vec![limit; n]);
        }
        let needed =
            (0..n).into_par_iter().map(|k| self.needed(k, &demands[k], limit)).collect::<Result<Vec<f64>>>()?;
        let reserve = |j: usize| if needed[j] > limit { needed[j] + RESERVE * height } else { limit };
        let away = |j: usize, k: usize| {
            let there = j.abs_diff(k);
            let pieces = if self.cage.closed { there.min(n - there) } else { there };
            reserve(j) - SLOPE * pieces as f64 * self.step()
        };
        let detours: Vec<usize> = (0..n).filter(|&j| needed[j] > limit).collect();
        let farthest = |k: usize| {
            self.budget.spend(detours.len() as u64 + 1)?;
            Ok(detours.iter().map(|&j| away(j, k)).fold(limit, f64::max))
        };
        (0..n).map(farthest).collect()
    }

    /// The least distance from the middle, among those tried, within which piece `k` has a valid position, by the strictest grade that has
    /// any: what is cut or covered wherever it lies need not leave the middle for that. All of the ribbon where it has none.
    fn needed(&self, k: usize, demands: &Demands, limit: f64) -> Result<f64> {
        let most = self.strip.height as f64 + self.cage.forms[k].left();
        let site = Site { strip: self.strip, form: &self.cage.forms[k], demands, budget: self.budget };
        let grades = if self.params.relax { &Grade::ALL[..] } else { &Grade::ALL[..1] };
        for &grade in grades {
            let tried = std::iter::successors(Some(limit), |w| Some(w * 1.5)).take_while(|w| *w < most);
            for wander in tried.chain([most]) {
                if site.has_any(Some(&self.rows(k, wander)), grade)? {
                    return Ok(wander);
                }
            }
        }
        Ok(most)
    }

    /// The rows of the top left corner of piece `k` within `wander` of the middle.
    fn rows(&self, k: usize, wander: f64) -> Range<i64> {
        let middle = 0.5 * (self.strip.height as f64 - self.cage.forms[k].foot[1]);
        (middle - wander).ceil() as i64..(middle + wander).floor() as i64 + 1
    }

    /// Columns of the exemplars that are in use where piece `k` lies, without the parts for the ends.
    fn body(&self, k: usize, changes: &[f64]) -> Vec<Range<usize>> {
        let share = (k as f64 + 0.5) / self.cage.len() as f64;
        let half = TRANSITION * self.strip.height as f64 / (self.step() * self.cage.len() as f64);
        let used = |e: usize| {
            let from = if e == 0 { f64::NEG_INFINITY } else { changes[e - 1] - half };
            let to = changes.get(e).map_or(f64::INFINITY, |c| c + half);
            // A closed curve passes from the last exemplar into the first around its start.
            let wrapped = self.cage.closed && !changes.is_empty() && (share < half || share > 1.0 - half);
            (from..=to).contains(&share) || (wrapped && (e == 0 || e == changes.len()))
        };
        (0..self.strip.spans.len()).filter(|&e| used(e)).map(|e| self.inner(e)).collect()
    }

    fn inner(&self, exemplar: usize) -> Range<usize> {
        let span = &self.strip.spans[exemplar];
        let from = self.strip.starts[exemplar].as_ref().map_or(span.start, |s| s.end);
        let to = self.strip.ends[exemplar]
            .as_ref()
            .map_or(span.end, |e| e.start.saturating_sub(self.step().ceil() as usize));
        from..to.max(from)
    }

    /// The pieces within the start show it from its beginning on.
    fn start(&self, demands: &mut [Demands]) {
        let Some(range) = self.strip.starts.first().cloned().flatten() else { return };
        for (k, demand) in demands.iter_mut().enumerate() {
            let done = k as f64 * self.step();
            if done + 0.5 * self.step() >= range.len() as f64 {
                break;
            }
            let x = range.start + done.round() as usize;
            demand.columns = one(x..x + 1);
            demand.loose_left = k == 0;
        }
    }

    /// The pieces within the end show it up to its last column.
    fn end(&self, demands: &mut [Demands]) {
        let Some(range) = self.strip.ends.last().cloned().flatten() else { return };
        for (k, demand) in demands.iter_mut().rev().enumerate() {
            let rest = (k + 1) as f64 * self.step();
            if rest - 0.5 * self.step() >= range.len() as f64 {
                break;
            }
            let x = (range.end - 1).saturating_sub(rest.ceil() as usize);
            demand.columns = one(x..x + 1);
            demand.loose_right = k == 0;
        }
    }

    fn first(&self, demands: &mut [Demands]) -> Result<()> {
        let (Some((x, y)), Some(demand)) = (self.request.first, demands.first_mut()) else { return Ok(()) };
        let coarse = self.params.coarse;
        let (x, y) = (x / coarse, y.div_euclid(coarse as i64));
        let (width, height) = (self.strip.width, self.strip.height as i64);
        if x >= width || !(-height..height).contains(&y) {
            let expected = format!("a column below {} and a row between {} and {}", width * coarse, -height, height);
            return Err(Error::parameter("first", format!("{x},{y}"), expected));
        }
        demand.columns = one(x..x + 1);
        demand.rows = Some(y..y + 1);
        Ok(())
    }
}

/// Shares of the length at which one of `n` exemplars passes into the next.
///
/// # Errors
/// [`Error::Parameter`] unless `given` is empty or one rising share between each exemplar and the next.
pub(crate) fn changes(given: &[f64], n: usize) -> Result<Vec<f64>> {
    if given.is_empty() {
        return Ok((1..n).map(|k| k as f64 / n as f64).collect());
    }
    let rising = given.windows(2).all(|w| w[0] < w[1]) && given.iter().all(|c| (0.0..=1.0).contains(c));
    if given.len() + 1 != n || !rising {
        let expected = format!("{} rising numbers from 0 to 1, one between each exemplar and the next", n - 1);
        return Err(Error::parameter("changes", format!("{given:?}"), expected));
    }
    Ok(given.to_vec())
}

/// A list of one range of columns.
fn one(columns: Range<usize>) -> Vec<Range<usize>> {
    std::iter::once(columns).collect()
}
