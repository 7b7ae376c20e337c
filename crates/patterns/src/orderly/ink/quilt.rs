//! More of a sheet: patches that agree where they overlap, blended there [Efros 2001].
//!
//! Distances are blended, not colours, so that borders pass from patch to patch without a step.

use arabesque_core::{Budget, Result, Stage, Stream};

use crate::orderly::ink::sheet::Sheet;

/// Draws of this module.
const QUILT: Stage = Stage::new(14);

/// Side of a patch, in distances of borders, and as a share of the shorter side of the sheet at most; the part of it that overlaps.
const PATCH: (f64, f64) = (5.0, 0.5);
const OVERLAP: f64 = 0.4;
/// Places at which patches are tried, for each way, every so many; and which of their places are compared.
const TRIED: usize = 2;
const LOOKED: usize = 2;
/// Patches whose difference is within this share, and so much of the mean square, of the least are as good.
const AS_GOOD: (f64, f64) = (0.1, 2e-3);

/// A sheet of any size; around a tile, what is right of the last place is the first.
#[derive(Clone, Debug)]
pub(crate) struct Quilt {
    pub(crate) size: [usize; 2],
    pub(crate) values: Vec<f32>,
}

/// A place of a patch, and its place in the quilt, which is filled.
type Known = (usize, usize, usize);

/// Patches of a quilt.
struct Quilting<'a> {
    sheet: &'a Sheet,
    /// Side of a patch, and of the part that overlaps.
    side: [usize; 2],
    overlap: [usize; 2],
    is_filled: Vec<bool>,
    wraps: bool,
}

/// Makes a quilt of at least this size, or of exactly this one where it `wraps`.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn quilt(sheet: &Sheet, size: [usize; 2], wraps: bool, seed: u64, budget: &Budget) -> Result<Quilt> {
    let channels = sheet.channels();
    let count = size[0] * size[1];
    let _held = budget.hold("distances from borders", count * channels * size_of::<f32>())?;
    let mut quilt = Quilt { size, values: vec![0.0; count * channels] };
    let wanted = (PATCH.0 * sheet.apart / sheet.step).round() as usize;
    let side = [0, 1]
        .map(|k| wanted.clamp(6, ((PATCH.1 * sheet.size[k] as f64) as usize).max(6)).min(size[k]).min(sheet.size[k]));
    let overlap = side.map(|side| ((OVERLAP * side as f64) as usize).max(1));
    let mut quilting = Quilting { sheet, side, overlap, is_filled: vec![false; count], wraps };
    let starts: [Vec<usize>; 2] = [0, 1].map(|k| starts(size[k], side[k], overlap[k], wraps));
    for (n, &y) in starts[1].iter().enumerate() {
        for (m, &x) in starts[0].iter().enumerate() {
            let mut stream = Stream::new(seed, QUILT, (n * starts[0].len() + m) as u64);
            quilting.lay(&mut quilt, [x, y], &mut stream, budget)?;
        }
    }
    Ok(quilt)
}

/// Where patches begin along a side.
fn starts(size: usize, side: usize, overlap: usize, wraps: bool) -> Vec<usize> {
    let step = (side - overlap).max(1);
    let end = if wraps { size } else { size.saturating_sub(overlap).max(1) };
    let count = end.div_ceil(step).max(1);
    // Around a tile they are as far apart everywhere.
    (0..count).map(|k| if wraps { k * size / count } else { k * step }).collect()
}

impl Quilting<'_> {
    /// The place in the quilt that one of a patch has.
    fn place(&self, quilt: &Quilt, at: [usize; 2], [i, j]: [usize; 2]) -> Option<usize> {
        let (mut x, mut y) = (at[0] + i, at[1] + j);
        if self.wraps {
            (x, y) = (x % quilt.size[0], y % quilt.size[1]);
        }
        (x < quilt.size[0] && y < quilt.size[1]).then(|| y * quilt.size[0] + x)
    }

    /// Lays the patch that fits best.
    fn lay(&mut self, quilt: &mut Quilt, at: [usize; 2], stream: &mut Stream, budget: &Budget) -> Result<()> {
        let (sheet, channels) = (self.sheet, self.sheet.channels());
        let mut known: Vec<Known> = Vec::new();
        for j in (0..self.side[1]).step_by(LOOKED) {
            for i in (0..self.side[0]).step_by(LOOKED) {
                if let Some(n) = self.place(quilt, at, [i, j]).filter(|&n| self.is_filled[n]) {
                    known.push((i, j, n));
                }
            }
        }
        let room = [0, 1].map(|k| sheet.size[k] - self.side[k]);
        let tried: Vec<[usize; 2]> =
            (0..=room[1]).step_by(TRIED).flat_map(|y| (0..=room[0]).step_by(TRIED).map(move |x| [x, y])).collect();
        budget.spend((tried.len() * (known.len() * channels / 4 + 2)) as u64)?;
        let chosen = if known.is_empty() {
            tried[stream.below(tried.len())]
        } else {
            let (mut costs, mut best) = (Vec::new(), f32::INFINITY);
            for &patch in &tried {
                let cost = self.cost(quilt, &known, patch, best);
                best = best.min(cost);
                costs.push(cost);
            }
            let usual = (sheet.far * sheet.far) as f32 * known.len() as f32;
            let most = best * (1.0 + AS_GOOD.0 as f32) + AS_GOOD.1 as f32 * usual;
            let good: Vec<[usize; 2]> =
                tried.iter().zip(&costs).filter(|(_, cost)| **cost <= most).map(|(patch, _)| *patch).collect();
            good[stream.below(good.len())]
        };
        let lift = self.lift(quilt, &known, chosen);
        self.blend(quilt, at, (chosen, lift));
        Ok(())
    }

    /// Where a place of a patch has its values in the sheet.
    fn source(&self, patch: [usize; 2], [i, j]: [usize; 2]) -> usize {
        ((patch[1] + j) * self.sheet.size[0] + patch[0] + i) * self.sheet.channels()
    }

    /// By which whole number a patch of heights has to be lifted to fit.
    fn lift(&self, quilt: &Quilt, known: &[Known], patch: [usize; 2]) -> f32 {
        if !self.sheet.is_height || known.is_empty() {
            return 0.0;
        }
        let off = |&(i, j, n): &Known| quilt.values[n] - self.sheet.values[self.source(patch, [i, j])];
        (known.iter().map(off).sum::<f32>() / known.len() as f32).round()
    }

    /// How much a patch differs from what is there; more than `best` where that is known to be too much.
    fn cost(&self, quilt: &Quilt, known: &[Known], patch: [usize; 2], best: f32) -> f32 {
        let (lift, channels) = (self.lift(quilt, known, patch), self.sheet.channels());
        let mut cost = 0.0;
        for &(i, j, n) in known {
            let m = self.source(patch, [i, j]);
            for c in 0..channels {
                let off = self.sheet.values[m + c] + lift - quilt.values[n * channels + c];
                cost += off * off;
            }
            if cost > 1.5 * best {
                break;
            }
        }
        cost
    }

    /// Blends a patch of the sheet into the quilt.
    fn blend(&mut self, quilt: &mut Quilt, at: [usize; 2], (patch, lift): ([usize; 2], f32)) {
        let (sheet, channels) = (self.sheet, self.sheet.channels());
        let mut laid = Vec::new();
        for j in 0..self.side[1] {
            for i in 0..self.side[0] {
                let Some(n) = self.place(quilt, at, [i, j]) else { continue };
                // How far in the patch counts alone: where others lie it begins to count at its sides.
                let alone = !self.is_filled[n];
                let share = if alone { 1.0 } else { self.share(quilt, at, i, 0) * self.share(quilt, at, j, 1) };
                let m = self.source(patch, [i, j]);
                for c in 0..channels {
                    let value = &mut quilt.values[n * channels + c];
                    *value += share * (sheet.values[m + c] + lift - *value);
                }
                laid.push(n);
            }
        }
        laid.into_iter().for_each(|n| self.is_filled[n] = true);
    }

    /// How much a patch counts at a place along one of its sides: from nothing where others end at its start, and around a tile where the
    /// first begin at its end.
    fn share(&self, quilt: &Quilt, at: [usize; 2], i: usize, k: usize) -> f32 {
        let ends = self.wraps && at[k] + self.side[k] >= quilt.size[k];
        let from_start = if at[k] > 0 { i } else { usize::MAX };
        let from_end = if ends { self.side[k] - 1 - i } else { usize::MAX };
        let t = ((from_start.min(from_end) as f32 + 0.5) / self.overlap[k] as f32).min(1.0);
        t * t * (3.0 - 2.0 * t)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use super::*;

    #[test]
    fn stripes_stay_stripes_and_close_around_a_tile() {
        let wave = |i: usize| (8.0 * (i as f64 * std::f64::consts::TAU / 12.0).sin()) as f32;
        let values = (0..60 * 60).map(|n| wave(n / 60)).collect();
        let sheet =
            Sheet { sources: vec![0], size: [60, 60], step: 1.0, apart: 6.0, values, far: 12.0, is_height: false };
        let made = quilt(&sheet, [96, 96], true, 3, &Budget::default()).unwrap();
        let at = |x: usize, y: usize| made.values[y * 96 + x];
        for y in 0..96 {
            let row: Vec<f32> = (0..96).map(|x| at(x, y)).collect();
            let spread = row.iter().fold(0.0_f32, |most, v| most.max((v - row[0]).abs()));
            assert!(spread < 2.5, "row {y}: {spread}");
        }
        let crossings = (0..96).filter(|&y| (at(5, y) > 0.0) != (at(5, (y + 1) % 96) > 0.0)).count();
        assert!((14..=18).contains(&crossings), "{crossings}");
    }
}
