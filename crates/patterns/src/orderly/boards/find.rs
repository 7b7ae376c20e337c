//! Rows of boards in an exemplar.

use arabesque_core::{Budget, Element, Exemplar, Result, Role, Vector};

/// Share of the box around a board that it fills at least.
const FULL: f64 = 0.95;
/// How far sides may be from where others have them, as a share of the height of a row.
const OFF: f64 = 0.05;
/// Boards that are whole, rows, and boards in a row in the mean, at least.
const LEAST: (usize, usize, f64) = (8, 3, 1.5);
/// How far a row may end from the sides of the frame, in heights of a row.
const RAGGED: f64 = 0.6;
/// Gaps between boards of a row that are like the others, at least, as a share.
const EVEN: f64 = 0.97;
/// Work for each corner of a board.
const WORK: u64 = 20;

/// A board of a row: what covers the row from one joint to the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Board {
    pub(crate) element: u32,
    /// Where it begins and ends along the row.
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) class: u32,
    /// Whether it is whole, so that it may be copied.
    pub(crate) is_whole: bool,
}

/// A row of boards.
#[derive(Clone, Debug)]
pub(crate) struct Course {
    /// Where it begins and ends across.
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// From one end to the other.
    pub(crate) boards: Vec<Board>,
}

/// The rows of an exemplar.
#[derive(Clone, Debug)]
pub(crate) struct Courses {
    /// The way along rows, and the way from row to row.
    pub(crate) along: Vector<2>,
    pub(crate) across: Vector<2>,
    /// The rows that are shown whole, one after the other.
    pub(crate) rows: Vec<Course>,
    /// Gaps along and across; below zero where boards overlap.
    pub(crate) gaps: [f64; 2],
}

/// A board in coordinates along and across.
#[derive(Clone, Copy, Debug)]
struct Block {
    low: [f64; 2],
    high: [f64; 2],
    element: usize,
}

impl Courses {
    /// Finds rows of boards that lie end to end; `None` where anything else is drawn.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn find(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Self>> {
        let has_lines = !exemplar.curves.is_empty() || !exemplar.areas.is_empty();
        let whole = exemplar.elements.iter().filter(|e| e.role == Role::Source).count();
        if has_lines || exemplar.hole.is_some() || whole < LEAST.0 {
            return Ok(None);
        }
        budget.spend(WORK * exemplar.elements.iter().map(|e| e.outline.points().count() as u64).sum::<u64>())?;
        let Some(axis) = exemplar.elements.iter().find_map(longest_side) else { return Ok(None) };
        let other = Vector::xy(-axis[1], axis[0]);
        Ok(Self::along(axis, other, exemplar).or_else(|| Self::along(other, -axis, exemplar)))
    }

    fn along(along: Vector<2>, across: Vector<2>, exemplar: &Exemplar<2>) -> Option<Self> {
        let axes = [along, across];
        let blocks: Vec<Block> =
            exemplar.elements.iter().enumerate().map(|(e, element)| block(e, element, axes)).collect::<Option<_>>()?;
        let mut rows = rows(&blocks, exemplar)?;
        let height = rows.iter().map(|row| row.high - row.low).sum::<f64>() / rows.len() as f64;
        let between: Vec<f64> = rows.windows(2).map(|pair| pair[1].low - pair[0].high).collect();
        let gaps_along: Vec<f64> =
            rows.iter().flat_map(|row| row.boards.windows(2).map(|pair| pair[1].from - pair[0].to)).collect();
        let gaps = [even(gaps_along, OFF * height)?, even(between, OFF * height)?];
        // What the frame shows of the rows: from side to side.
        let corners = [exemplar.window.min, exemplar.window.max];
        let sides = corners.map(|corner| corner.dot(along));
        let reaches = |row: &Course| {
            let (Some(first), Some(last)) = (row.boards.first(), row.boards.last()) else { return false };
            let is_upright = along[0].abs() > 0.999 || along[1].abs() > 0.999;
            let [low, high] = [sides[0].min(sides[1]), sides[0].max(sides[1])];
            !is_upright || (first.from <= low + RAGGED * height && last.to >= high - RAGGED * height)
        };
        let count: usize = rows.iter().map(|row| row.boards.len()).sum();
        if !rows.iter().all(reaches) || (count as f64) < LEAST.2 * rows.len() as f64 {
            return None;
        }
        rows.retain(|row| row.boards.iter().any(|board| board.is_whole));
        Some(Self { along, across, rows, gaps })
    }
}

/// The direction of the longest side of an element.
fn longest_side(element: &Element<2>) -> Option<Vector<2>> {
    let sides = element.outline.edges().map(|side| side.1 - side.0);
    let longest = sides.max_by(|a, b| a.norm2().total_cmp(&b.norm2()))?;
    let unit = longest.unit_or_zero();
    let unit = if unit[0].abs() < 1e-6 { Vector::xy(0.0, 1.0) } else { unit };
    let unit = if unit[1].abs() < 1e-6 { Vector::xy(1.0, 0.0) } else { unit };
    (unit.norm() > 0.0).then_some(unit)
}

/// An element as a block, where it is one.
fn block(number: usize, element: &Element<2>, axes: [Vector<2>; 2]) -> Option<Block> {
    let range = |axis: Vector<2>| {
        let all = element.outline.points().map(|p| p.dot(axis));
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    let [(x, to_x), (y, to_y)] = axes.map(range);
    let box_area = (to_x - x) * (to_y - y);
    let is_full = box_area > 0.0 && element.outline.area() >= FULL * box_area;
    is_full.then_some(Block { low: [x, y], high: [to_x, to_y], element: number })
}

/// Blocks in rows, from one side to the other; `None` where some lie in none.
fn rows(blocks: &[Block], exemplar: &Exemplar<2>) -> Option<Vec<Course>> {
    let is_whole = |block: &Block| exemplar.elements[block.element].role == Role::Source;
    let mut whole: Vec<&Block> = blocks.iter().filter(|block| is_whole(block)).collect();
    whole.sort_by(|a, b| (a.low[1] + a.high[1]).total_cmp(&(b.low[1] + b.high[1])));
    let mut rows: Vec<(Course, f64)> = Vec::new();
    for block in &whole {
        let height = block.high[1] - block.low[1];
        let is_in = |row: &(Course, f64)| {
            (block.low[1] - row.0.low).abs() < OFF * height && (block.high[1] - row.0.high).abs() < OFF * height
        };
        match rows.last_mut() {
            Some(row) if is_in(row) => row.1 += 1.0,
            _ => rows.push((Course { low: block.low[1], high: block.high[1], boards: Vec::new() }, 1.0)),
        }
    }
    if rows.len() < LEAST.1 {
        return None;
    }
    let mut rows: Vec<Course> = rows.into_iter().map(|row| row.0).collect();
    for block in blocks {
        let middle = 0.5 * (block.low[1] + block.high[1]);
        // Rows are in order: the one whose middle is nearest.
        let above = rows.partition_point(|row| row.low + row.high < 2.0 * middle);
        let off = |&k: &usize| (rows[k].low + rows[k].high - 2.0 * middle).abs();
        let near = (above.saturating_sub(1)..rows.len().min(above + 1)).min_by(|a, b| off(a).total_cmp(&off(b)));
        let Some(row) = near.map(|k| &mut rows[k]).filter(|row| row.low < middle && middle < row.high) else {
            // Rows that the frame has cut tell nothing of their height.
            if is_whole(block) {
                return None;
            }
            continue;
        };
        let height = row.high - row.low;
        let is_flush = (block.low[1] - row.low).abs() < OFF * height && (block.high[1] - row.high).abs() < OFF * height;
        if !is_flush && is_whole(block) {
            return None;
        }
        let class = exemplar.elements[block.element].class as u32;
        let (from, to) = (block.low[0], block.high[0]);
        row.boards.push(Board {
            element: block.element as u32,
            from,
            to,
            class,
            is_whole: is_whole(block) && is_flush,
        });
    }
    rows.iter_mut().for_each(|row| row.boards.sort_by(|a, b| a.from.total_cmp(&b.from)));
    Some(rows)
}

/// The usual one of gaps, where nearly all are like it.
fn even(mut gaps: Vec<f64>, tolerance: f64) -> Option<f64> {
    gaps.sort_by(f64::total_cmp);
    let usual = *gaps.get(gaps.len() / 2)?;
    let like = gaps.iter().filter(|gap| (*gap - usual).abs() <= tolerance).count();
    (like as f64 >= EVEN * gaps.len() as f64).then_some(usual)
}
