//! Where in an overlap the result ends and the patch begins: where both are most alike.
//!
//! The cells that differ most go first, each to the side that it lies beside, as water rises over a terrain that is turned upside down: the two
//! sides meet where the difference is least, so that the largest difference along the cut is as small as it can be [Cousty 2009].

use std::{cmp::Reverse, collections::BinaryHeap};

/// For each cell whether it is the result's side, given what is decided already and how much the others differ.
pub(crate) fn sides(decided: &[Option<bool>], difference: &[f32], width: usize) -> Vec<bool> {
    let mut sides = decided.to_vec();
    // Differences are not negative, so that their bits are in their order; of equal ones those come first that were reached first.
    let mut queue = BinaryHeap::new();
    let mut reached = 0_u32;
    let around = |k: usize| {
        let (x, y) = (k % width, k / width);
        let beside =
            [(x > 0, k.wrapping_sub(1)), (x + 1 < width, k + 1), (y > 0, k.wrapping_sub(width)), (true, k + width)];
        beside.into_iter().filter(|(is_in, other)| *is_in && *other < decided.len()).map(|(_, other)| other)
    };
    let mut reach = |queue: &mut BinaryHeap<_>, sides: &[Option<bool>], from: usize| {
        for to in around(from).filter(|&to| sides[to].is_none()) {
            reached += 1;
            queue.push((difference[to].to_bits(), Reverse(reached), to, from));
        }
    };
    (0..decided.len()).filter(|&k| decided[k].is_some()).for_each(|k| reach(&mut queue, decided, k));
    while let Some((_, _, to, from)) = queue.pop() {
        if sides[to].is_none() {
            sides[to] = sides[from];
            reach(&mut queue, &sides, to);
        }
    }
    // What nothing decided is beside: all is the patch's.
    sides.into_iter().map(|side| side.unwrap_or(false)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cut_runs_where_least_differs() {
        // Left is the result's, right the patch's; a valley of no difference winds between them.
        let (width, height) = (12, 9);
        let valley = |y: usize| 4 + [0, 1, 2, 3, 3, 2, 1, 0, 0][y];
        let decided: Vec<_> = (0..width * height)
            .map(|k| match k % width {
                0 => Some(true),
                11 => Some(false),
                _ => None,
            })
            .collect();
        let difference: Vec<f32> = (0..width * height)
            .map(|k| if k % width == valley(k / width) { 0.0 } else { 1.0 + (k * 7 % 5) as f32 })
            .collect();
        let sides = sides(&decided, &difference, width);
        for (k, side) in sides.into_iter().enumerate() {
            let (x, at) = (k % width, valley(k / width));
            assert!(x == at || side == (x < at), "cell {x} of row {}", k / width);
        }
    }
}
