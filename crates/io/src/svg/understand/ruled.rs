//! Strokes on squared paper: traces of circuits, walls. Each may be short and clear of the others, but no two are alike: they are
//! lines of one pattern, not things that come again.

use std::collections::BTreeSet;

use arabesque_core::{Bounds, Ruling, Vector, corners, ruling};
use kurbo::Affine;

use crate::svg::{
    parse::scene::{Content, Node},
    shape::{extent::longer, subpath},
    understand::item::{Item, Origin},
};

/// Pieces that are lines of one pattern, at least.
const PIECES: usize = 6;
/// Share of them that are unlike all others, at least.
const UNLIKE: f64 = 0.4;
/// Other strokes, such as pads, as a share of the lines at most, and as a share of the frame.
const OTHERS: (f64, f64) = (2.5, 0.12);

/// Which items are lines on squared paper, given connected pieces of those that may be; none where their pieces come again, or
/// anything else is drawn with strokes that is not small and closed.
pub(crate) fn on_paper(items: &[Item], pieces: &[&[usize]], frame: &Bounds<2>) -> Vec<bool> {
    let mut is_line = vec![false; items.len()];
    let mut lines: Vec<Vec<Vec<Vector<2>>>> = vec![Vec::new(); items.len()];
    let mut others = 0;
    for &i in pieces.iter().copied().flatten() {
        match straight_lines(&items[i]) {
            Some(found) => (is_line[i], lines[i]) = (true, found),
            None if items[i].outline.bounds().size().norm() < OTHERS.1 * longer(frame) => others += 1,
            None => return vec![false; items.len()],
        }
    }
    let all: Vec<Vec<Vector<2>>> = lines.iter().flatten().cloned().collect();
    let count = is_line.iter().filter(|line| **line).count();
    let none = vec![false; items.len()];
    if count < PIECES || others as f64 > OTHERS.0 * count as f64 {
        return none;
    }
    let Some(paper) = ruling(&all, frame) else { return none };
    let shapes: BTreeSet<Vec<Vec<[i64; 2]>>> = pieces.iter().map(|piece| shape(piece, &lines, &paper)).collect();
    let pieces = pieces.iter().filter(|piece| piece.iter().any(|&i| is_line[i])).count();
    if shapes.len() >= PIECES && shapes.len() as f64 >= UNLIKE * pieces as f64 { is_line } else { none }
}

/// The lines of a piece in steps from its corner, in an order that does not depend on how they were drawn.
fn shape(piece: &[usize], lines: &[Vec<Vec<Vector<2>>>], paper: &Ruling) -> Vec<Vec<[i64; 2]>> {
    let nodes = |line: &Vec<Vector<2>>| -> Vec<[i64; 2]> {
        line.iter().map(|&p| paper.coordinates(p).0.map(|c| c.round() as i64)).collect()
    };
    let mut all: Vec<Vec<[i64; 2]>> = piece.iter().flat_map(|&i| lines[i].iter().map(nodes)).collect();
    let least = |k: usize| all.iter().flatten().map(|node| node[k]).min().unwrap_or(0);
    let low = [least(0), least(1)];
    for line in &mut all {
        line.iter_mut().for_each(|node| *node = [node[0] - low[0], node[1] - low[1]]);
        let backwards: Vec<_> = line.iter().rev().copied().collect();
        *line = line.clone().min(backwards);
    }
    all.sort();
    all
}

/// The corners of all lines that a stroke draws, where it is straight between them.
fn straight_lines(item: &Item) -> Option<Vec<Vec<Vector<2>>>> {
    if item.origin != Origin::Stroke {
        return None;
    }
    let mut found = Vec::new();
    for (parent, node) in &item.parts {
        add_lines(node, *parent, &mut found)?;
    }
    Some(found)
}

fn add_lines(node: &Node, parent: Affine, into: &mut Vec<Vec<Vector<2>>>) -> Option<()> {
    let world = parent * node.transform;
    match &node.content {
        Content::Group(children) => children.iter().try_for_each(|child| add_lines(child, world, into)),
        Content::Shape(geometry) => {
            let path = world * geometry.path.clone();
            path.subpaths().try_for_each(|elements| {
                let closed = subpath::is_closed(elements);
                into.push(corners(&subpath::line(&elements.iter().copied().collect(), closed, 0.0))?);
                Some(())
            })
        }
    }
}
