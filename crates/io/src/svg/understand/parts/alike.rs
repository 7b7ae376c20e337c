//! Things that are drawn in several loose parts: flowers of petals and a heart, eyes, tufts of strokes.
//!
//! What is strewn at random lies by itself, in pairs and in heaps of any number. Where nearly all that lies together is made of the same
//! parts, it was drawn as one thing.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Budget, DisjointSets, Outline, Result};

use crate::svg::{
    reason::Reason,
    shape::{extent::longer, painted_area::Painter},
    understand::{
        item::{HALF, Item},
        join::SEAM,
        parts::{
            components::merge,
            gaps::{Link, links},
            groups::is_loose,
        },
    },
};

/// Widest gap in a thing, as a share of the median size of the parts.
const WIDEST: f64 = 0.8;
/// Share of all that lies together, within the frame, that is of a kind that recurs; so often at least.
const SHARE: f64 = 0.85;
const RECURS: usize = 3;
/// How much wider the next gap is where parts may end, and how many such places are tried.
const STEP: f64 = 1.15;
const TRIES: usize = 16;
/// Share of the frame within which something reaches a side of it.
const NEAR: f64 = 1e-3;
/// Parts of one thing at most.
const MOST: usize = 64;

/// Puts parts together that come together in the same way again and again.
///
/// # Errors
/// As [`Budget::spend`].
pub(crate) fn put_alike_together(items: Vec<Item>, painter: &Painter<'_, '_>, frame: Bounds<2>) -> Result<Vec<Item>> {
    let parts: Vec<usize> = (0..items.len()).filter(|&i| is_loose(&items[i])).collect();
    match alike(&items, &parts, (frame, SEAM * longer(&frame)), painter.source.budget)? {
        Some(groups) => merge(&items, &groups, Reason::Recurring, painter, frame),
        None => Ok(items),
    }
}

/// The things that `parts` make, by what lies together: groups of items, all of them in one each; `None` where they make none.
///
/// # Errors
/// As [`Budget::spend`].
fn alike(
    items: &[Item],
    parts: &[usize],
    (frame, tolerance): (Bounds<2>, f64),
    budget: &Budget,
) -> Result<Option<Vec<Vec<usize>>>> {
    if parts.len() < 2 * RECURS {
        return Ok(None);
    }
    let outlines: Vec<&Outline<2>> = parts.iter().map(|&i| &items[i].outline).collect();
    let mut sizes: Vec<f64> = outlines.iter().map(|outline| longer(&outline.bounds())).collect();
    sizes.sort_by(f64::total_cmp);
    let widest = (WIDEST * sizes[sizes.len() / 2]).max(tolerance);
    let links = links(&outlines, widest, budget)?;
    let colours: Vec<String> = parts.iter().map(|&i| items[i].painted.colours_key()).collect();
    let boxes: Vec<Bounds<2>> = outlines.iter().map(|outline| outline.bounds()).collect();
    let all = Parts { colours: &colours, boxes: &boxes, frame };
    for count in ends(&links, tolerance) {
        let mut sets = DisjointSets::new(parts.len());
        links[..count].iter().for_each(|link| sets.join(link.ends.0, link.ends.1));
        let groups = sets.groups();
        if all.are_things(&groups) {
            let mut of_items = DisjointSets::new(items.len());
            for group in groups.iter().filter(|group| all.is_small(group)) {
                group.iter().for_each(|&k| of_items.join(parts[group[0]], parts[k]));
            }
            return Ok(Some(of_items.groups()));
        }
    }
    Ok(None)
}

/// How many of the links, shortest first, may lie inside things: those that are none, then up to where the gaps widen.
fn ends(links: &[Link], tolerance: f64) -> Vec<usize> {
    let touching = links.partition_point(|link| link.gap <= tolerance);
    let is_step = |k: &usize| *k == links.len() || links[*k].gap >= STEP * links[*k - 1].gap;
    let steps = (touching + 1..=links.len()).filter(is_step).take(TRIES);
    (touching > 0).then_some(touching).into_iter().chain(steps).collect()
}

/// Parts, each with its colours and the box around it.
struct Parts<'a> {
    colours: &'a [String],
    boxes: &'a [Bounds<2>],
    frame: Bounds<2>,
}

impl Parts<'_> {
    fn extent(&self, group: &[usize]) -> Bounds<2> {
        group.iter().fold(Bounds::EMPTY, |all, &k| all.union(&self.boxes[k]))
    }

    fn is_small(&self, group: &[usize]) -> bool {
        let size = self.extent(group).size();
        group.len() <= MOST && (0..2).all(|k| size[k] < HALF * self.frame.size()[k])
    }

    fn is_inside(&self, group: &[usize]) -> bool {
        let (extent, near) = (self.extent(group), NEAR * longer(&self.frame));
        (0..2).all(|k| extent.min[k] > self.frame.min[k] + near && extent.max[k] < self.frame.max[k] - near)
    }

    /// How many parts a group has of each colour, in falling order.
    fn signature(&self, group: &[usize]) -> Vec<usize> {
        let mut of_colour: BTreeMap<&str, usize> = BTreeMap::new();
        group.iter().for_each(|&k| *of_colour.entry(&self.colours[k]).or_default() += 1);
        let mut counts: Vec<usize> = of_colour.into_values().collect();
        counts.sort_unstable_by(|a, b| b.cmp(a));
        counts
    }

    /// Whether nearly all that lies together within the frame is made of the same parts as others.
    fn are_things(&self, groups: &[Vec<usize>]) -> bool {
        let inside: Vec<&Vec<usize>> = groups.iter().filter(|group| self.is_inside(group)).collect();
        let mut often: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
        let several = inside.iter().filter(|group| group.len() > 1 && self.is_small(group));
        several.for_each(|group| *often.entry(self.signature(group)).or_default() += 1);
        let again: usize = often.values().filter(|n| **n >= RECURS).sum();
        again > 0 && again as f64 >= SHARE * inside.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::Vector;

    use super::*;

    /// Whether boxes of one side at these places, in these colours and groups, are things.
    fn are_things(parts: &[(f64, f64, &str)], groups: &[Vec<usize>]) -> bool {
        let boxes: Vec<Bounds<2>> =
            parts.iter().map(|&(x, y, _)| Bounds::new(Vector::xy(x, y), Vector::xy(x + 4.0, y + 4.0))).collect();
        let colours: Vec<String> = parts.iter().map(|part| part.2.to_owned()).collect();
        let frame = Bounds::new(Vector::ZERO, Vector::xy(100.0, 100.0));
        Parts { colours: &colours, boxes: &boxes, frame }.are_things(groups)
    }

    #[test]
    fn what_is_made_of_the_same_parts_is_a_thing() {
        let parts: Vec<_> = (0..8)
            .map(|k| (10.0 + 20.0 * f64::from(k / 2), 5.0 + 3.0 * f64::from(k % 2), ["red", "blue"][k as usize % 2]))
            .collect();
        let pairs: Vec<Vec<usize>> = (0..4).map(|k| vec![2 * k, 2 * k + 1]).collect();
        assert!(are_things(&parts, &pairs));
        let strewn = [vec![0, 1], vec![2, 3], vec![4], vec![5], vec![6, 7]];
        assert!(!are_things(&parts, &strewn));
        assert!(!are_things(&parts, &[(0..8).collect()]), "all in one");
    }

    #[test]
    fn gaps_are_tried_from_none_upwards() {
        let links: Vec<Link> = [0.0, 0.0, 1.0, 1.05, 3.0].map(|gap| Link { gap, ends: (0, 0) }).to_vec();
        assert_eq!(ends(&links, 0.1), [2, 4, 5]);
    }
}
