//! Strokes on one geometry, such as a casing and its core, as one stroke with several paints.

use std::collections::BTreeMap;

use arabesque_core::{Area, Bounds, Budget, Class, Curve, Path, Result};

use crate::svg::{
    drawing::Stroke,
    layers::coincide::{Line, cut_alike},
    shape::duplicates::{NEAR, Seen},
    understand::curves::Curves,
};

/// Most paints of one stroke.
const MOST_PAINTS: usize = 32;

/// Lines are one when they are nearer to each other than this share of the narrowest stroke, or [`NEAR`], and at most
/// so many times that.
const OF_WIDTH: f64 = 0.02;
const WIDEST: f64 = 8.0;

/// Lines on one geometry.
#[derive(Clone, Debug)]
pub(crate) struct Stack {
    pub(crate) path: Path<2>,
    /// Numbers of the lines that it is, or is a piece of, from bottom to top; no two of one paint.
    pub(crate) members: Vec<usize>,
    /// Second ones in the same paint, which are not among the members.
    pub(crate) doubled: usize,
    /// Lines beyond the number of paints that one stroke may have, which are not either.
    pub(crate) surplus: usize,
}

impl Stack {
    /// A line in one paint.
    pub(crate) fn of_one(path: Path<2>, member: usize) -> Self {
        Self { path, members: vec![member], doubled: 0, surplus: 0 }
    }
}

/// The distance below which strokes lie on one line.
pub(crate) fn nearness<'a>(window: &Bounds<2>, widths: impl Iterator<Item = &'a f64>) -> f64 {
    let least = NEAR * window.size().norm();
    let narrowest = widths.copied().filter(|w| *w > 0.0).fold(f64::INFINITY, f64::min);
    (OF_WIDTH * narrowest).min(WIDEST * least).max(least)
}

/// Lines with the numbers of their paints, in drawing order, put together where they lie on one geometry, whatever
/// their nodes, their direction, and where they are split.
///
/// # Errors
/// As [`Budget::spend`].
pub(crate) fn stacks(lines: Vec<(Path<2>, usize)>, near: f64, budget: &Budget) -> Result<Vec<Stack>> {
    let lines: Vec<Line> =
        lines.into_iter().enumerate().map(|(origin, (path, paint))| Line { path, paint, origin }).collect();
    let paints: Vec<usize> = lines.iter().map(|l| l.paint).collect();
    let mut seen = Seen::nearer_than(near);
    let mut stacks: Vec<Stack> = Vec::new();
    for line in cut_alike(lines, near, budget)? {
        match seen.find_or_add(0, &line.path, budget)? {
            None => stacks.push(Stack::of_one(line.path, line.origin)),
            Some(known) => {
                let stack = &mut stacks[known];
                if stack.members.iter().any(|&m| paints[m] == line.paint) {
                    stack.doubled += 1;
                } else {
                    stack.members.push(line.origin);
                }
            }
        }
    }
    for stack in &mut stacks {
        // The lowest is often the widest, and the highest hide those below them.
        let surplus = stack.members.len().saturating_sub(MOST_PAINTS);
        stack.members.drain(1..1 + surplus);
        stack.surplus = surplus;
    }
    Ok(stacks)
}

/// The curves of a drawing with all their paints.
#[derive(Debug, Default)]
pub(crate) struct Stacked {
    pub(crate) curves: Vec<Curve<2>>,
    pub(crate) areas: Vec<Area<2>>,
    /// How area `i` is painted.
    pub(crate) fills: Vec<Stroke>,
    pub(crate) styles: Vec<Class>,
    /// How curve `i` is painted, from bottom to top.
    pub(crate) strokes: Vec<Vec<Stroke>>,
    /// The paints of each style from bottom to top, as numbers of the styles that there were before.
    pub(crate) paints: Vec<Vec<usize>>,
    /// Strokes that were dropped because one like them is there.
    pub(crate) doubled: usize,
    /// Strokes that were dropped because there are too many on one geometry.
    pub(crate) surplus: usize,
}

/// Puts curves on one geometry together; ways to be painted are then those of all paints of a curve.
///
/// # Errors
/// As [`Budget::spend`].
pub(crate) fn stacked(found: Curves, window: &Bounds<2>, budget: &Budget) -> Result<Stacked> {
    let Curves { curves, mut areas, fills, styles, strokes } = found;
    let near = nearness(window, curves.iter().map(|c| &c.width));
    // Styles differ by layer too, paints do not.
    let paints = paints_of(&strokes);
    let lines = curves.iter().zip(&paints).map(|(c, &paint)| (c.path.clone(), paint)).collect();
    let stacks = if styles.len() < 2 { Vec::new() } else { stacks(lines, near, budget)? };
    if stacks.len() == curves.len() && stacks.iter().all(|s| s.members.len() == 1) || stacks.is_empty() {
        let paints = (0..styles.len()).map(|s| vec![s]).collect();
        let strokes = strokes.into_iter().map(|s| vec![s]).collect();
        return Ok(Stacked { curves, areas, fills, styles, strokes, paints, doubled: 0, surplus: 0 });
    }
    let mut style_of: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
    let mut out = Stacked::default();
    for stack in stacks {
        let paints: Vec<usize> = stack.members.iter().map(|&m| curves[m].style).collect();
        let style = *style_of.entry(paints.clone()).or_insert_with(|| {
            out.styles.push(Class { name: joint_name(&styles, &paints) });
            out.paints.push(paints);
            out.styles.len() - 1
        });
        let width = stack.members.iter().map(|&m| curves[m].width).fold(0.0, f64::max);
        let colour = stack.members.last().map_or([0.0; 3], |&m| curves[m].colour);
        out.strokes.push(stack.members.iter().map(|&m| strokes[m].clone()).collect());
        out.curves.push(Curve { path: stack.path, style, width, colour });
        out.doubled += stack.doubled;
        out.surplus += stack.surplus;
    }
    for area in &mut areas {
        area.style = *style_of.entry(vec![area.style]).or_insert_with_key(|paints| {
            out.styles.push(Class { name: joint_name(&styles, paints) });
            out.paints.push(paints.clone());
            out.styles.len() - 1
        });
    }
    (out.areas, out.fills) = (areas, fills);
    Ok(out)
}

/// The number of the paint of each stroke: the same for those that look the same.
pub(crate) fn paints_of(strokes: &[Stroke]) -> Vec<usize> {
    let mut known = BTreeMap::new();
    let number = |stroke: &Stroke| {
        let next = known.len();
        *known.entry(stroke.key()).or_insert(next)
    };
    strokes.iter().map(number).collect()
}

/// The names of several ways to be painted, as one.
fn joint_name(styles: &[Class], paints: &[usize]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for &p in paints {
        let name = styles[p].name.as_str();
        if !names.contains(&name) && names.len() < 4 {
            names.push(name);
        }
    }
    names.join(" + ")
}
