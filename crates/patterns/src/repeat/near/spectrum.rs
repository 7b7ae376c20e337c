//! The lattice of places with one of them in each cell, by the waves that add up over it.

use arabesque_core::{Budget, Result, Vector};
use rayon::prelude::*;

use crate::repeat::{lattice::Lattice, near::places::Places};

/// Places that are asked at most: those nearest to the middle.
const MOST: usize = 120;

/// Waves are looked for that are so long, in terms of the mean distance of places: from, to.
const WAVES: (f64, f64) = (0.5, 2.6);

/// Steps between waves, in terms of the one that has one more crest over all places.
const STEP: f64 = 0.3;

/// Share of the places that must lie on the crests of a wave, where 1 is all of them exactly and 0 is chance.
const ON_CRESTS: f64 = 0.72;

/// Waves that are followed to where they add up most.
const FOLLOWED: usize = 64;

/// Area of a cell in terms of what a place has for itself.
const CELL: (f64, f64) = (0.6, 1.6);

/// Work for a wave at a place.
const WAVE: u64 = 1;

/// The lattice with one place in each cell, roughly; `None` where there is none.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn lattice(places: &Places, budget: &Budget) -> Result<Option<Lattice>> {
    let middle = places.whole.iter().fold(Vector::ZERO, |sum, (p, _)| sum + *p) * (1.0 / places.whole.len() as f64);
    let mut near: Vec<Vector<2>> = places.whole.iter().map(|(p, _)| (*p - middle) * (1.0 / places.unit)).collect();
    near.sort_by(|a, b| a.norm2().total_cmp(&b.norm2()).then(a[0].total_cmp(&b[0])).then(a[1].total_cmp(&b[1])));
    near.truncate(MOST);
    let waves = Waves { places: near };
    let mut found = waves.peaks(budget)?;
    found.retain(|(_, amplitude)| *amplitude >= ON_CRESTS);
    found.sort_by(|(a, _), (b, _)| a.norm2().total_cmp(&b.norm2()));
    // The longest waves that are independent: all others of the lattice are their sums.
    for (k, (a, _)) in found.iter().enumerate() {
        for (b, _) in &found[k + 1..] {
            let measure = a.cross(*b);
            let cell = 1.0 / measure.abs();
            if !(CELL.0..=CELL.1).contains(&cell) || waves.amplitude(*a + *b).min(waves.amplitude(*a - *b)) < 0.5 {
                continue;
            }
            let scale = places.unit / measure;
            return Ok(Lattice::new(Vector::xy(b[1], -b[0]) * scale, Vector::xy(-a[1], a[0]) * scale));
        }
    }
    Ok(None)
}

/// Places about their middle, in units of their mean distance.
struct Waves {
    places: Vec<Vector<2>>,
}

impl Waves {
    /// How well the places lie on the crests of a wave, in [0, 1]; `wave`: its crests per unit, across them.
    fn amplitude(&self, wave: Vector<2>) -> f64 {
        let (mut sum, mut sum_of_sines) = (0.0, 0.0);
        for p in &self.places {
            let (sin, cos) = (std::f64::consts::TAU * wave.dot(*p)).sin_cos();
            sum += cos;
            sum_of_sines += sin;
        }
        f64::hypot(sum, sum_of_sines) / self.places.len() as f64
    }

    /// Waves that add up more than those around them, the strongest of them.
    fn peaks(&self, budget: &Budget) -> Result<Vec<(Vector<2>, f64)>> {
        let extent = self.places.iter().map(|p| p.norm()).fold(1.0, f64::max);
        let step = STEP / (2.0 * extent);
        let (least, most) = (1.0 / WAVES.1, 1.0 / WAVES.0);
        let count = (most / step).ceil() as usize;
        let wide = 2 * count + 1;
        budget.spend(WAVE * (wide * (count + 1) * self.places.len()) as u64)?;
        let rows: Vec<Vec<f64>> = (0..=count).into_par_iter().map(|j| self.row(j as f64 * step, count, step)).collect();
        let mut peaks = Vec::new();
        for (j, row) in rows.iter().enumerate() {
            for (i, &here) in row.iter().enumerate() {
                let wave = Vector::xy((i as f64 - count as f64) * step, j as f64 * step);
                let is_asked = (least..=most).contains(&wave.norm()) && (j > 0 || i > count);
                if !is_asked || here < 0.6 * ON_CRESTS {
                    continue;
                }
                let around = (-1..=1_i64).flat_map(|dj| (-1..=1_i64).map(move |di| (di, dj)));
                let is_peak = around.filter(|step| *step != (0, 0)).all(|(di, dj)| {
                    let (x, y) = (i as i64 + di, j as i64 + dj);
                    // What lies below the axis is the same wave the other way round.
                    let (x, y) = if y < 0 { (wide as i64 - 1 - x, -y) } else { (x, y) };
                    let there = rows.get(y as usize).and_then(|row| row.get(x as usize));
                    there.is_none_or(|there| (*there, y, x) <= (here, j as i64, i as i64))
                });
                if is_peak {
                    peaks.push((wave, here));
                }
            }
        }
        peaks.sort_by(|(_, a), (_, b)| b.total_cmp(a));
        peaks.truncate(FOLLOWED);
        budget.spend(WAVE * (peaks.len() * 48 * self.places.len()) as u64 * 8)?;
        Ok(peaks.into_par_iter().map(|(wave, amplitude)| self.followed(wave, amplitude, step)).collect())
    }

    /// The amplitudes of waves along a row, each a turn of the last.
    fn row(&self, y: f64, count: usize, step: f64) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); 2 * count + 1];
        for p in &self.places {
            let start = std::f64::consts::TAU * (y * p[1] - count as f64 * step * p[0]);
            let (mut sin, mut cos) = start.sin_cos();
            let (turn_sin, turn_cos) = (std::f64::consts::TAU * step * p[0]).sin_cos();
            for sum in &mut sums {
                sum.0 += cos;
                sum.1 += sin;
                (cos, sin) = (cos * turn_cos - sin * turn_sin, sin * turn_cos + cos * turn_sin);
            }
        }
        let share = 1.0 / self.places.len() as f64;
        sums.into_iter().map(|(cos, sin)| f64::hypot(cos, sin) * share).collect()
    }

    /// Where a wave adds up most, near where it was met.
    fn followed(&self, mut wave: Vector<2>, mut amplitude: f64, step: f64) -> (Vector<2>, f64) {
        let mut stride = 0.5 * step;
        for _ in 0..12 {
            let ways = [(stride, 0.0), (-stride, 0.0), (0.0, stride), (0.0, -stride)];
            let tried = ways.map(|(x, y)| wave + Vector::xy(x, y)).map(|w| (w, self.amplitude(w)));
            match tried.into_iter().max_by(|(_, a), (_, b)| a.total_cmp(b)) {
                Some((better, more)) if more > amplitude => (wave, amplitude) = (better, more),
                _ => stride *= 0.5,
            }
        }
        (wave, amplitude)
    }
}
