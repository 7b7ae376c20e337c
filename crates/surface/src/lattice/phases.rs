//! The place of the pattern that lies on each point of a surface.

use std::{cmp::Reverse, collections::BinaryHeap};

use arabesque_core::{Budget, Result, Stage, Stream, Vector};

use super::{cell::Cell, links::Link};

const BEGIN: Stage = Stage::new(461);

/// How often phases are evened out, with changes that go too far first and with those that are wanted at the end, and work for a link.
const SWEEPS: [(usize, f64); 2] = [(240, 1.75), (20, 1.0)];
/// The same for phases that only tell how much a lattice breaks.
const FEW: [(usize, f64); 2] = [(20, 1.75), (10, 1.0)];
const LINK: u64 = 12;
/// Sweeps end when no phase changes by more than this share of the shorter vector.
const STILL: f64 = 3e-4;

/// Phases that change along the links as the ways say, as far as that can be.
pub(super) fn phases(
    links: &[Vec<Link>],
    cell: &Cell,
    (seed, is_trial): (u64, bool),
    budget: &Budget,
) -> Result<Vec<Vector<2>>> {
    let mut phases = spread(links, cell, seed, budget)?;
    let count: u64 = links.iter().map(|own| own.len() as u64).sum();
    let sweeps = if is_trial { FEW } else { SWEEPS };
    for rate in sweeps.into_iter().flat_map(|(count, rate)| std::iter::repeat_n(rate, count)) {
        budget.spend(LINK * count)?;
        let mut most = 0.0_f64;
        for (i, own) in links.iter().enumerate() {
            let Some(change) = mean_change(phases[i], own, |j| Some(phases[j]), cell) else { continue };
            phases[i] += change * rate;
            most = most.max(change.norm());
        }
        if most < STILL * cell.shorter {
            break;
        }
    }
    Ok(phases)
}

/// Phases from one point to the next, those first that are near along ways that can be trusted.
fn spread(links: &[Vec<Link>], cell: &Cell, seed: u64, budget: &Budget) -> Result<Vec<Vector<2>>> {
    let mut stream = Stream::new(seed, BEGIN, 0);
    let mut phases: Vec<Option<Vector<2>>> = vec![None; links.len()];
    let mut meter = budget.meter();
    for start in 0..links.len() {
        if phases[start].is_some() {
            continue;
        }
        let [a, b] = cell.vectors;
        let begin = a * stream.unit() + b * stream.unit();
        let mut heap = BinaryHeap::from([(Reverse(0), Reverse(start as u32), None)]);
        while let Some((Reverse(far), Reverse(i), from)) = heap.pop() {
            let i = i as usize;
            meter.spend(50 + LINK * links[i].len() as u64)?;
            if phases[i].is_some() {
                continue;
            }
            let first = match from {
                None => begin,
                Some(from) => expected(from as usize, i, links, &phases).unwrap_or(begin),
            };
            let change = mean_change(first, &links[i], |j| phases[j], cell).unwrap_or(Vector::ZERO);
            phases[i] = Some(first + change);
            for link in links[i].iter().filter(|link| phases[link.to as usize].is_none()) {
                // Distances are not negative, so that their bits are in their order.
                let reached = f64::from_bits(far) + link.way.norm() / cell.trust(link);
                heap.push((Reverse(reached.to_bits()), Reverse(link.to), Some(i as u32)));
            }
        }
    }
    Ok(phases.into_iter().map(Option::unwrap_or_default).collect())
}

/// The phase of `i` as its neighbour `from` says.
fn expected(from: usize, i: usize, links: &[Vec<Link>], phases: &[Option<Vector<2>>]) -> Option<Vector<2>> {
    let link = links[from].iter().find(|link| link.to as usize == i)?;
    Some(phases[from]? + link.way)
}

/// By how much the neighbours that are known would change a phase, in the mean.
fn mean_change(
    phase: Vector<2>,
    links: &[Link],
    of: impl Fn(usize) -> Option<Vector<2>>,
    cell: &Cell,
) -> Option<Vector<2>> {
    cell.mean(links.iter().filter_map(|link| {
        let other = of(link.to as usize)?;
        Some(cell.change(other - link.way - phase, link))
    }))
}
