//! Which style each line of the output has.

use arabesque_core::{Budget, Result, Stream};

use crate::orderly::abreast::find::Lines;

/// How many lines before one are compared, at most.
const BEFORE: usize = 8;
/// The same across the seam of a tile.
const AT_SEAM: usize = 4;
/// By how much the number of lines in a tile may differ from what suits their distance best, as a share, at least and at most.
const ROOM: (f64, f64, f64) = (0.12, 1.0, 32.0);
/// Beginnings that are tried for a tile.
const TRIES: usize = 24;
/// Work for comparing a line with one of the exemplar's.
const COMPARED: u64 = 3;

/// The styles of so many lines, one after the other: as the exemplar goes on.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn styles(lines: &Lines, count: usize, stream: &mut Stream, budget: &Budget) -> Result<Vec<usize>> {
    let known: Vec<usize> = lines.lines.iter().map(|line| line.style).collect();
    let mut at = stream.below(known.len());
    let (mut made, _held) = budget.list("lines side by side", count)?;
    let mut meter = budget.meter();
    while made.len() < count {
        meter.spend(COMPARED)?;
        if at >= known.len() {
            meter.spend(COMPARED * (2 * BEFORE * known.len()) as u64)?;
            at = after(&known, &made, stream);
        }
        made.push(known[at]);
        at += 1;
    }
    Ok(made)
}

/// Where the exemplar goes on after what comes nearest to the last lines made.
fn after(known: &[usize], made: &[usize], stream: &mut Stream) -> usize {
    let alike = |k: usize| {
        let pairs = known[..k].iter().rev().zip(made.iter().rev());
        pairs.take(BEFORE).take_while(|(a, b)| a == b).count()
    };
    let best = (1..known.len()).map(alike).max().unwrap_or(0);
    let all: Vec<usize> = (1..known.len()).filter(|&k| alike(k) == best).collect();
    if all.is_empty() { 0 } else { all[stream.below(all.len())] }
}

/// The styles of lines that close up: about `wanted` of them.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn closed(lines: &Lines, wanted: f64, stream: &mut Stream, budget: &Budget) -> Result<Vec<usize>> {
    let known: Vec<usize> = lines.lines.iter().map(|line| line.style).collect();
    let room = (ROOM.0 * wanted).clamp(ROOM.1, ROOM.2);
    let nearest = wanted.round().max(1.0);
    let counts = ((wanted - room).ceil().max(1.0) as usize)..=((wanted + room).floor().max(nearest) as usize);
    let is_uniform = known.iter().all(|style| *style == known[0]);
    if is_uniform {
        return Ok(vec![known[0]; nearest as usize]);
    }
    let mut best: Option<((usize, f64), Vec<usize>)> = None;
    for count in counts {
        for _ in 0..TRIES {
            let made = styles(lines, count, stream, budget)?;
            let cost = (unlike(&known, &made), (count as f64 - wanted).abs());
            if best.as_ref().is_none_or(|(least, _)| cost.0 < least.0 || (cost.0 == least.0 && cost.1 < least.1)) {
                best = Some((cost, made));
            }
        }
    }
    Ok(best.map_or_else(|| vec![known[0]; nearest as usize], |(_, made)| made))
}

/// Runs across the seam that the exemplar does not have.
fn unlike(known: &[usize], made: &[usize]) -> usize {
    let length = (AT_SEAM + 1).min(known.len());
    let run = |start: usize| (0..length).map(move |k| made[(start + k) % made.len()]);
    let is_known = |start: usize| known.windows(length).any(|there| there.iter().copied().eq(run(start)));
    (0..length).filter(|back| !is_known(made.len() * length - back)).count()
}
