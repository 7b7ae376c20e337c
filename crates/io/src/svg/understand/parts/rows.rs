//! Rows and columns that were saved as groups: the courses of a wall, each a `<g>` or a copy by `<use>`.
//!
//! A thing that is drawn in parts lies in one place. A row of things goes from one side of the frame to the other, or as far as
//! one more step at each end, in short members of a few shapes; and there are several of its kind side by side, or it goes on
//! beyond the frame at both ends.

use std::{collections::BTreeSet, rc::Rc};

use arabesque_core::{Bounds, Budget, Result};
use kurbo::{Affine, PathEl};

use crate::svg::{
    parse::{
        geometry::{self, Painted},
        scene::{Content, Node},
    },
    shape::extent::{bounds, clusters},
    understand::{item::HALF, surroundings::Surroundings},
};

/// Fewest members of a row.
const FEWEST: usize = 3;
/// Share of the frame that a row covers at least, with the gaps at its ends.
const REACH: f64 = 0.85;
/// Widest step from one member to the next, as a multiple of the size of the larger one.
const STEP: f64 = 4.0;
/// How far members lie off the middle of their row, in terms of their median size across.
const OFF: f64 = 0.5;
/// Share of the frame that a row takes across at most.
const HIGH: f64 = HALF;
/// Rows within rows that are looked at.
const DEPTH: usize = 3;
/// Work for a part of a path that is compared.
const PART: u64 = 2;

/// Which way a row goes, as an axis, and whether it goes on beyond the frame at both ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Way {
    axis: usize,
    is_endless: bool,
}

/// Which of the nodes in a container are rows of things, each with siblings of its kind unless it goes on beyond the frame.
///
/// # Errors
/// As [`Budget::spend`].
pub(crate) fn rows(nodes: &[Rc<Node>], at: &Surroundings, frame: &Bounds<2>, budget: &Budget) -> Result<Vec<bool>> {
    let way = |node| Looker { frame, budget }.way(node, at.parent, DEPTH);
    let ways = nodes.iter().map(way).collect::<Result<Vec<_>>>()?;
    let count = |axis: usize| ways.iter().flatten().filter(|way| way.axis == axis).count();
    let counts = [count(0), count(1)];
    Ok(ways.iter().map(|way| way.is_some_and(|way| way.is_endless || counts[way.axis] > 1)).collect())
}

/// Looks at groups in a frame.
struct Looker<'a> {
    frame: &'a Bounds<2>,
    budget: &'a Budget,
}

impl Looker<'_> {
    /// The way that a node goes as a row, or as several rows on one another.
    fn way(&self, node: &Rc<Node>, parent: Affine, depth: usize) -> Result<Option<Way>> {
        let (mut node, mut world) = (node, parent * node.transform);
        loop {
            if geometry::is_shape(node.meta.tag) || node.meta.mark.is_some() || node.meta.source.is_some() {
                return Ok(None);
            }
            match node.children() {
                [only] => (node, world) = (only, world * only.transform),
                _ => break,
            }
        }
        let members = node.children();
        if members.len() < 2 {
            return Ok(None);
        }
        let extents = members.iter().map(|member| self.extent(member, world)).collect::<Result<Vec<_>>>()?;
        for axis in 0..2 {
            if let Some(is_endless) = self.is_row(members, &extents, axis)? {
                return Ok(Some(Way { axis, is_endless }));
            }
        }
        if depth == 0 {
            return Ok(None);
        }
        let mut all: Option<Way> = None;
        for member in members {
            let Some(way) = self.way(member, world, depth - 1)? else { return Ok(None) };
            if all.is_some_and(|all| all.axis != way.axis) {
                return Ok(None);
            }
            let is_endless = way.is_endless && all.is_none_or(|all| all.is_endless);
            all = Some(Way { is_endless, ..way });
        }
        Ok(all)
    }

    fn extent(&self, node: &Node, parent: Affine) -> Result<Bounds<2>> {
        self.budget.spend(parts(node))?;
        Ok(bounds(node, parent))
    }

    /// Whether members lie in rows along an axis; if so, whether all of these go on beyond the frame.
    fn is_row(&self, members: &[Rc<Node>], extents: &[Bounds<2>], axis: usize) -> Result<Option<bool>> {
        let across = 1 - axis;
        let seen: Vec<usize> = (0..members.len()).filter(|&k| !extents[k].is_empty()).collect();
        let all = seen.iter().fold(Bounds::EMPTY, |all, &k| all.union(&extents[k]));
        if seen.len() < FEWEST || all.size()[across] > HIGH * self.frame.size()[across] {
            return Ok(None);
        }
        let mut heights: Vec<f64> = seen.iter().map(|&k| extents[k].size()[across]).collect();
        heights.sort_by(f64::total_cmp);
        let off = OFF * heights[heights.len() / 2];
        let middle = |k: usize| 0.5 * (extents[k].min[across] + extents[k].max[across]);
        let mut order = seen.clone();
        order.sort_by(|&a, &b| middle(a).total_cmp(&middle(b)));
        let mut is_endless = true;
        for row in order.chunk_by(|&a, &b| middle(b) - middle(a) <= off) {
            let is_straight = middle(row[row.len() - 1]) - middle(row[0]) <= 2.0 * off;
            let boxes: Vec<Bounds<2>> = row.iter().map(|&k| extents[k]).collect();
            match self.is_across(boxes, axis) {
                Some(beyond) if is_straight => is_endless &= beyond,
                _ => return Ok(None),
            }
        }
        let is_separate = || Ok(clusters(extents, 0.0, self.budget)? == seen.len());
        let kinds: BTreeSet<String> = seen.iter().map(|&k| kind(&members[k])).collect();
        // Letters of a word differ, and end in the frame; what goes on beyond it in things apart is no word.
        let are_alike = kinds.len() <= ((seen.len() + 1) / 3).max(1);
        Ok(if are_alike || is_endless && is_separate()? { Some(is_endless) } else { None })
    }

    /// Whether short things follow one another across the frame along an axis; if so, whether they go on beyond it.
    fn is_across(&self, mut boxes: Vec<Bounds<2>>, axis: usize) -> Option<bool> {
        let (low, high) = (self.frame.min[axis], self.frame.max[axis]);
        let length = high - low;
        if boxes.len() < FEWEST || boxes.iter().any(|b| b.size()[axis] > HALF * length) {
            return None;
        }
        boxes.sort_by(|a, b| (a.min[axis] + a.max[axis]).total_cmp(&(b.min[axis] + b.max[axis])));
        let step = |a: &Bounds<2>, b: &Bounds<2>| 0.5 * (b.min[axis] + b.max[axis] - a.min[axis] - a.max[axis]);
        let size = |b: &Bounds<2>| b.size()[axis];
        if boxes.windows(2).any(|two| step(&two[0], &two[1]) > STEP * size(&two[0]).max(size(&two[1]))) {
            return None;
        }
        let gap = |two: &[Bounds<2>]| (two[1].min[axis] - two[0].max[axis]).max(0.0);
        let gap = boxes.windows(2).map(gap).sum::<f64>() / (boxes.len() - 1) as f64;
        let all = boxes.iter().fold(Bounds::EMPTY, |all, b| all.union(b));
        let (from, to) = (all.min[axis].max(low) - gap, all.max[axis].min(high) + gap);
        let beyond = all.min[axis] < low && all.max[axis] > high;
        (to - from >= REACH * length).then_some(beyond)
    }
}

/// Work for the box around a node.
fn parts(node: &Node) -> u64 {
    match &node.content {
        Content::Group(children) => 20 + children.iter().map(|child| parts(child)).sum::<u64>(),
        Content::Shape(geometry) => 20 + PART * geometry.path.elements().len() as u64,
    }
}

/// What a node is made of: equal for things of one construction, whatever their size, place and paint.
fn kind(node: &Node) -> String {
    let mut kind = String::new();
    push_kind(node, &mut kind);
    kind
}

fn push_kind(node: &Node, kind: &mut String) {
    match &node.content {
        Content::Group(children) => children.iter().for_each(|child| push_kind(child, kind)),
        Content::Shape(geometry) => {
            if geometry.paint == Painted::Picture {
                kind.push('p');
            }
            kind.extend(geometry.path.elements().iter().map(|part| match part {
                PathEl::MoveTo(_) => 'M',
                PathEl::LineTo(_) => 'L',
                PathEl::QuadTo(..) => 'Q',
                PathEl::CurveTo(..) => 'C',
                PathEl::ClosePath => 'Z',
            }));
        }
    }
}
