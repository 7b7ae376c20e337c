//! Bending the right side of a piece so that it meets the next one [Zhou 2013 §3.2].

use arabesque_core::{Budget, Result};

use crate::exemplar::columns::{Columns, column_norm};

/// P: cost of an opaque sample that is skipped, in 8-bit colour steps [Zhou 2013 eq. 3].
const SKIPPED: f64 = 32.0;
/// Samples that all move less than this are left alone: nobody sees it.
const SEEN: f32 = 0.3;
/// Farthest that a sample is moved, as a share of the edge.
const FARTHEST: f64 = 0.06;

/// Work of one pair of samples.
const PAIR: u64 = 8;
/// Bytes of one pair of samples.
const BYTES: usize = size_of::<(f64, Move)>();

/// Work and bytes of aligning two edges of `rows` samples.
pub(crate) fn demand(rows: usize) -> (u64, usize) {
    let pairs = rows.saturating_mul(rows);
    (PAIR.saturating_mul(pairs as u64), BYTES.saturating_mul(pairs))
}

/// For each sample of the edge, how many samples farther down its colour is taken from: T\[i\] - i. Empty where the edges meet as they are.
fn alignment(right: &[[f32; 4]], left: &[[f32; 4]], budget: &Budget) -> Result<Vec<f32>> {
    let n = left.len().min(right.len());
    let _held = budget.hold("the stitches of two edges", demand(n).1)?;
    let table = table(right, left, n, budget)?;
    let (mut s, mut t) = (n - 1, n - 1);
    let mut matched = vec![(0.0_f32, 0.0_f32); n];
    loop {
        matched[s].0 += t as f32;
        matched[s].1 += 1.0;
        match table[s * n + t].1 {
            Move::Both => (s, t) = (s - 1, t - 1),
            Move::Left => s -= 1,
            Move::Right => t -= 1,
            Move::None => break,
        }
    }
    let most = (FARTHEST * n as f64) as f32;
    let shifts: Vec<f32> = matched.iter().enumerate().map(|(s, m)| (m.0 / m.1 - s as f32).clamp(-most, most)).collect();
    let shifts = smoothed(&shifts);
    Ok(if shifts.iter().all(|s| s.abs() < SEEN) { Vec::new() } else { shifts })
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Move {
    None,
    Both,
    Left,
    Right,
}

/// M\[s, t\] and the move that led there [Zhou 2013 eq. 2].
fn table(right: &[[f32; 4]], left: &[[f32; 4]], n: usize, budget: &Budget) -> Result<Vec<(f64, Move)>> {
    let mut table: Vec<(f64, Move)> = Vec::with_capacity(n * n);
    let mut meter = budget.meter();
    for s in 0..n {
        meter.spend(PAIR * n as u64)?;
        for t in 0..n {
            let skip = if left[s][3] > 0.0 || right[t][3] > 0.0 { SKIPPED } else { 0.0 };
            let here = f64::from(column_norm(left[s], right[t]));
            let mut best = (f64::INFINITY, Move::None);
            let mut offer = |cost: f64, step: Move| {
                if cost < best.0 {
                    best = (cost, step);
                }
            };
            if s > 0 && t > 0 {
                offer(table[(s - 1) * n + t - 1].0, Move::Both);
            }
            if s > 0 {
                offer(table[(s - 1) * n + t].0 + skip, Move::Left);
            }
            if t > 0 {
                offer(table[s * n + t - 1].0 + skip, Move::Right);
            }
            let (cost, step) = if s == 0 && t == 0 { (0.0, Move::None) } else { best };
            table.push((cost + here, step));
        }
    }
    Ok(table)
}

/// Steps of whole samples, smoothed over five.
fn smoothed(shifts: &[f32]) -> Vec<f32> {
    let last = shifts.len() - 1;
    let at = |k: usize, d: isize| shifts[k.saturating_add_signed(d).min(last)];
    (0..shifts.len())
        .map(|k| (at(k, -2) + 2.0 * at(k, -1) + 3.0 * at(k, 0) + 2.0 * at(k, 1) + at(k, 2)) / 9.0)
        .collect()
}

/// The alignment of the single columns `right` and `left`.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work or the memory is used up, [`arabesque_core::Error::Stopped`].
pub(crate) fn align(right: &Columns, left: &Columns, budget: &Budget) -> Result<Vec<f32>> {
    alignment(&right.pixels(0), &left.pixels(0), budget)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edge(dark: std::ops::Range<usize>) -> Vec<[f32; 4]> {
        (0..40).map(|k| if dark.contains(&k) { [20.0, 20.0, 20.0, 255.0] } else { [0.0; 4] }).collect()
    }

    #[test]
    fn equal_edges_are_left_alone() {
        assert!(alignment(&edge(10..20), &edge(10..20), &Budget::default()).unwrap().is_empty());
    }

    #[test]
    fn a_bar_is_moved_to_where_it_goes_on() {
        let shifts = alignment(&edge(13..23), &edge(10..20), &Budget::default()).unwrap();
        assert!((shifts[15] - 3.0).abs() < 0.6, "{shifts:?}");
        assert!(shifts[39] == 0.0, "{shifts:?}");
    }
}
