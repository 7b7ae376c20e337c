//! Loose parts that are one thing: a sun and its rays, the strokes of a doodle.
//!
//! They lie closer together than things do: sorted by length, the shortest links between all parts jump once from the
//! gaps inside a thing to the space around it. Where no such jump is seen, every part is a thing of its own: strokes
//! strewn at random, rows of dashes.

use arabesque_core::{Bounds, Budget, DisjointSets, Outline, Result};

use crate::svg::{
    shape::extent::longer,
    understand::{
        item::{HALF, Item, Kind, Origin},
        parts::gaps::{Link, links},
    },
};

/// How many times wider the space around a thing is than the gaps inside it.
const JUMP: f64 = 1.7;
/// Jumps that are tried.
const JUMPS: usize = 8;
/// Share of all parts that are linked to others at least where parts make things.
const LINKED: f64 = 0.15;
/// Widest gap inside a thing, as a share of its size.
const WIDEST: f64 = 0.4;
/// Farthest that is looked, as a share of the frame.
const FARTHEST: f64 = 0.25;

/// Groups of items, all of them in one each: what is strewn loosely, strokes with or without fills, by what lies
/// together.
///
/// # Errors
/// As [`Budget::spend`].
pub(crate) fn together(items: &[Item], frame: Bounds<2>, budget: &Budget) -> Result<Vec<Vec<usize>>> {
    let alone = || (0..items.len()).map(|i| vec![i]).collect();
    let parts: Vec<usize> = (0..items.len()).filter(|&i| is_loose(&items[i])).collect();
    if parts.len() < 3 || parts.iter().all(|&i| is_small_fill(&items[i])) {
        return Ok(alone());
    }
    let outlines: Vec<&Outline<2>> = parts.iter().map(|&i| &items[i].outline).collect();
    let links = links(&outlines, FARTHEST * longer(&frame), budget)?;
    // Things have gaps of several widths: the last jump after which all groups are things counts.
    for count in jumps(&links, parts.len()) {
        let mut sets = DisjointSets::new(items.len());
        links[..count].iter().for_each(|link| sets.join(parts[link.ends.0], parts[link.ends.1]));
        let groups = sets.groups();
        let mut several = groups.iter().filter(|group| group.len() > 1);
        if several.all(|group| is_one(items, group, links[count - 1].gap, &frame)) {
            return Ok(groups);
        }
    }
    Ok(alone())
}

/// Whether items with gaps up to `widest` between them may be one thing.
fn is_one(items: &[Item], group: &[usize], widest: f64, frame: &Bounds<2>) -> bool {
    let extent = group.iter().fold(Bounds::EMPTY, |all, &i| all.union(&items[i].outline.bounds()));
    let has_stroke = group.iter().any(|&i| !is_small_fill(&items[i]));
    let is_small = (0..2).all(|k| extent.size()[k] < HALF * frame.size()[k]);
    is_small && has_stroke && widest <= WIDEST * longer(&extent)
}

/// How many of the links, shortest first, may be inside things: where their lengths jump, farthest jump first.
fn jumps(links: &[Link], parts: usize) -> Vec<usize> {
    let least = ((LINKED * parts as f64).ceil() as usize).max(1);
    let floor = links.iter().map(|link| link.gap).sum::<f64>() / links.len().max(1) as f64 * 0.02;
    let is_jump = |k: &usize| links[*k].gap >= JUMP * links[*k - 1].gap.max(floor);
    (least..links.len()).rev().filter(is_jump).take(JUMPS).collect()
}

/// Whether something may be a part of a larger thing.
pub(crate) fn is_loose(item: &Item) -> bool {
    let is_drawn = || item.parts.iter().any(|(_, node)| node.style.strokes());
    is_small_fill(item) || item.kind == Kind::Element && item.reason.is_loose() && is_drawn()
}

/// Whether something filled may be a part of a thing that is drawn with strokes too.
pub(crate) fn is_small_fill(item: &Item) -> bool {
    item.kind == Kind::Element && matches!(item.origin, Origin::Fill | Origin::Piece)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gaps(gaps: &[f64]) -> Vec<Link> {
        gaps.iter().map(|&gap| Link { gap, ends: (0, 0) }).collect()
    }

    #[test]
    fn a_jump_tells_the_gaps_inside_things_from_the_space_around() {
        assert_eq!(jumps(&gaps(&[1.0, 1.1, 1.3, 2.4, 5.0, 5.5, 6.0]), 8), [4, 3]);
        assert_eq!(jumps(&gaps(&[3.0, 3.2, 3.6, 4.1, 5.0, 5.5, 6.0]), 8), [0; 0], "strewn at random");
        assert_eq!(jumps(&gaps(&[1.0, 3.0, 3.6, 4.1, 5.0, 5.5, 6.0, 6.0, 7.0]), 10), [0; 0], "one pair by chance");
    }
}
