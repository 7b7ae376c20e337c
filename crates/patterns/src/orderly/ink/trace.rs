//! Rings around what is positive.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Result, Ring, Vector};

/// Work for each cell.
const WORK: u64 = 10;

/// Values on a grid: how many each way, and each of them; beyond it everything is negative.
pub(crate) struct Values<'a> {
    pub(crate) size: [usize; 2],
    pub(crate) at: &'a dyn Fn(usize, usize) -> f64,
}

/// A side between two places next to one another: the first, counted from 1, and whether it leads along y.
type Side = (i64, i64, bool);

/// The rings around what is positive, in steps of the grid from its first place. By the even-odd rule they fill it.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn rings(values: &Values<'_>, budget: &Budget) -> Result<Vec<Ring<2>>> {
    let [width, height] = values.size.map(|n| n as i64);
    let value = |i: i64, j: i64| {
        let is_in = i >= 0 && j >= 0 && i < width && j < height;
        if is_in { (values.at)(i as usize, j as usize) } else { -1.0 }
    };
    let mut links: BTreeMap<Side, Vec<Side>> = BTreeMap::new();
    for j in -1..height {
        budget.spend(WORK * (width + 1) as u64)?;
        for i in -1..width {
            let corners = [value(i, j), value(i + 1, j), value(i + 1, j + 1), value(i, j + 1)];
            let sides = [(i, j, false), (i + 1, j, true), (i, j + 1, false), (i, j, true)];
            let crossed: Vec<usize> = (0..4).filter(|&k| (corners[k] > 0.0) != (corners[(k + 1) % 4] > 0.0)).collect();
            let pairs: Vec<[usize; 2]> = match crossed[..] {
                [a, b] => vec![[a, b]],
                // Of a saddle, what is in the middle tells what hangs together.
                [_, _, _, _] => {
                    let middle = corners.iter().sum::<f64>() > 0.0;
                    if middle == (corners[0] > 0.0) { vec![[0, 1], [2, 3]] } else { vec![[3, 0], [1, 2]] }
                }
                _ => Vec::new(),
            };
            for [a, b] in pairs {
                links.entry(sides[a]).or_default().push(sides[b]);
                links.entry(sides[b]).or_default().push(sides[a]);
            }
        }
    }
    let place = |(i, j, upright): Side| {
        let (a, b) = (value(i, j), if upright { value(i, j + 1) } else { value(i + 1, j) });
        let t = a / (a - b);
        if upright { Vector::xy(i as f64, j as f64 + t) } else { Vector::xy(i as f64 + t, j as f64) }
    };
    let mut made = Vec::new();
    while let Some((&first, _)) = links.first_key_value() {
        let mut ring = Vec::new();
        let mut at = first;
        while let Some(next) = links.get_mut(&at).and_then(Vec::pop) {
            ring.push(place(at));
            if let Some(back) = links.get_mut(&next)
                && let Some(k) = back.iter().position(|side| *side == at)
            {
                back.swap_remove(k);
            }
            if links.get(&at).is_some_and(Vec::is_empty) {
                links.remove(&at);
            }
            at = next;
        }
        links.remove(&at);
        if ring.len() > 3 {
            made.push(smoothed(&ring));
        }
    }
    Ok(made)
}

/// A ring with its corners cut once.
fn smoothed(ring: &[Vector<2>]) -> Ring<2> {
    let sides = ring.iter().copied().zip(ring.iter().copied().cycle().skip(1));
    sides.flat_map(|(a, b)| [a * 0.75 + b * 0.25, a * 0.25 + b * 0.75]).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use arabesque_core::{Outline, ring};

    use super::*;

    #[test]
    fn a_disc_with_a_hole_has_two_rings() {
        let at = |i: usize, j: usize| {
            let r = ((i as f64 - 20.0).powi(2) + (j as f64 - 20.0).powi(2)).sqrt();
            (15.0 - r).min(r - 6.0)
        };
        let found = rings(&Values { size: [41, 41], at: &at }, &Budget::default()).unwrap();
        assert_eq!(found.len(), 2);
        let mut areas: Vec<f64> = found.iter().map(|r| ring::area(r).abs()).collect();
        areas.sort_by(f64::total_cmp);
        let disc = |r: f64| std::f64::consts::PI * r * r;
        assert!((areas[0] / disc(6.0) - 1.0).abs() < 0.03 && (areas[1] / disc(15.0) - 1.0).abs() < 0.02, "{areas:?}");
    }

    #[test]
    fn what_reaches_the_end_of_the_grid_is_closed_there() {
        let found = rings(&Values { size: [10, 10], at: &|_, _| 1.0 }, &Budget::default()).unwrap();
        assert_eq!(found.len(), 1);
        let bounds = Outline { rings: found }.bounds();
        assert!(bounds.min[0] < 0.0 && bounds.max[1] > 9.0);
    }
}
