//! The lines of an exemplar and the places where they meet, end or turn sharply: what every level samples alike [Tu 2020 §4.1.1].
//!
//! Curves are cut at the window. Two lines meet where they cross, and where an end comes as close to a line as the stroke is wide. Lines
//! that run side by side do not meet, however close they are.

use arabesque_core::{Bounds, Curve, Domain, GridIndex, Measured, Path, Vector};

use super::{
    contact::{Contact, crossings, end_contacts},
    trim::inside,
};

/// An end this many stroke widths from a line meets it: the ink of the two touches.
const TOUCH_WIDTHS: f64 = 1.0;

/// They also meet when they are closer than this share of the side of the window.
const TOUCH_SHARE: f64 = 0.003;

/// Turn from which on a joint of two segments is a corner, as the cosine of the angle: 40 degrees.
const CORNER: f64 = 0.766;

/// What a knot is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Knot {
    /// A line ends here.
    End,
    /// The window has cut a line here: it would go on.
    Cut,
    /// Lines meet.
    Junction,
    /// A line turns sharply.
    Corner,
}

/// A connected part of an exemplar curve.
#[derive(Clone, Debug)]
pub(crate) struct Line<const D: usize> {
    pub(crate) measured: Measured<D>,
    /// Index into the curves.
    pub(crate) curve: u32,
    /// Half of this is how far its ink reaches.
    pub(crate) width: f64,
    /// Whether the window cuts it at its start, at its end.
    pub(crate) is_cut: [bool; 2],
    /// Knots along it, by arc length: (arc, knot).
    pub(crate) stops: Vec<(f64, u32)>,
}

/// Lines and knots.
#[derive(Clone, Debug)]
pub(crate) struct Skeleton<const D: usize> {
    pub(crate) lines: Vec<Line<D>>,
    /// Place and kind of every knot.
    pub(crate) knots: Vec<(Vector<D>, Knot)>,
}

impl<const D: usize> Skeleton<D> {
    /// The skeleton of the curves inside `window`.
    pub(crate) fn new(curves: &[Curve<D>], window: &Bounds<D>) -> Self {
        let side = window.size().0.into_iter().fold(f64::INFINITY, f64::min);
        let lines: Vec<_> = curves.iter().enumerate().flat_map(|(k, c)| cut(k as u32, c, window, side)).collect();
        Self::of_lines(lines, side)
    }

    /// Finds the knots of lines; `side` is the size of the picture they are part of.
    pub(crate) fn of_lines(lines: Vec<Line<D>>, side: f64) -> Self {
        let touch = |line: &Line<D>| (TOUCH_WIDTHS * line.width).max(TOUCH_SHARE * side);
        let reach: Vec<f64> = lines.iter().map(touch).collect();
        let mut contacts = crossings(&lines, side, 1e-4 * side);
        contacts.extend(end_contacts(&lines, &reach, side));
        let mut skeleton = Self { lines, knots: Vec::new() };
        skeleton.join(&contacts, &reach);
        skeleton.end_lines(&reach);
        skeleton.find_corners(&reach);
        skeleton.lines.iter_mut().for_each(|line| line.stops.sort_by(|a, b| a.0.total_cmp(&b.0)));
        skeleton
    }

    /// Makes a knot of every cluster of contacts.
    fn join(&mut self, contacts: &[Contact<D>], reach: &[f64]) {
        let points: Vec<_> = contacts.iter().flat_map(|c| [c.place, c.place]).collect();
        let sides: Vec<(u32, f64)> = contacts.iter().flat_map(|c| c.sides).collect();
        let mut group = Groups::new(sides.len());
        (0..contacts.len()).for_each(|k| group.join(2 * k, 2 * k + 1));
        let widest = reach.iter().copied().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        let index = GridIndex::new(&points, widest, &Domain::Box(Bounds::around(points.iter().copied())));
        for (a, &(line, arc)) in sides.iter().enumerate() {
            index.within(points[a], reach[line as usize], |b, _| {
                let other = sides[b];
                if other.0 == line && self.gap(line, arc, other.1) <= 2.0 * reach[line as usize] {
                    group.join(a, b);
                }
            });
        }
        for members in group.sets() {
            let centre = members.iter().fold(Vector::ZERO, |sum, &m| sum + points[m]) * (1.0 / members.len() as f64);
            let knot = self.knots.len() as u32;
            self.knots.push((centre, Knot::Junction));
            self.stop_at(knot, &members, &sides, reach);
        }
    }

    /// Distance along a line.
    fn gap(&self, line: u32, a: f64, b: f64) -> f64 {
        let measured = &self.lines[line as usize].measured;
        let d = (a - b).abs();
        if measured.is_closed() { d.min(measured.length() - d) } else { d }
    }

    /// One stop for every passage of a line through a knot.
    fn stop_at(&mut self, knot: u32, members: &[usize], sides: &[(u32, f64)], reach: &[f64]) {
        let mut passages: Vec<(u32, f64)> = members.iter().map(|&m| sides[m]).collect();
        passages.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut kept: Vec<(u32, f64)> = Vec::new();
        for (line, arc) in passages {
            let near = 2.5 * reach[line as usize];
            if kept.iter().all(|&(l, a)| l != line || self.gap(line, a, arc) > near) {
                kept.push((line, arc));
            }
        }
        for (line, arc) in kept {
            let own = &mut self.lines[line as usize];
            let (length, near) = (own.measured.length(), reach[line as usize]);
            // An end that meets something is where the line ends: the rest is overshoot.
            let arc = match own.measured.is_closed() {
                false if arc <= near => 0.0,
                false if arc >= length - near => length,
                _ => arc,
            };
            own.stops.push((arc, knot));
        }
    }

    /// Knots at the ends that meet nothing.
    fn end_lines(&mut self, reach: &[f64]) {
        for (line, reach) in self.lines.iter_mut().zip(reach) {
            if line.measured.is_closed() {
                continue;
            }
            let length = line.measured.length();
            for (arc, is_cut) in [(0.0, line.is_cut[0]), (length, line.is_cut[1])] {
                if line.stops.iter().any(|(a, _)| (a - arc).abs() < reach.min(0.25 * length)) {
                    continue;
                }
                let kind = if is_cut { Knot::Cut } else { Knot::End };
                line.stops.push((arc, self.knots.len() as u32));
                self.knots.push((line.measured.point(arc), kind));
            }
        }
    }

    fn find_corners(&mut self, reach: &[f64]) {
        for (line, reach) in self.lines.iter_mut().zip(reach) {
            for arc in corners(&line.measured, *reach) {
                let length = line.measured.length();
                let near = |a: f64| {
                    let d = (a - arc).abs();
                    let d = if line.measured.is_closed() { d.min(length - d) } else { d };
                    d < 1.5 * reach
                };
                if !line.stops.iter().any(|&(a, _)| near(a)) {
                    line.stops.push((arc, self.knots.len() as u32));
                    self.knots.push((line.measured.point(arc), Knot::Corner));
                }
            }
        }
    }
}

/// Arc lengths of the corners, where the directions over `reach` before and after differ.
fn corners<const D: usize>(measured: &Measured<D>, reach: f64) -> Vec<f64> {
    let length = measured.length();
    let mut arc = 0.0;
    let mut found = Vec::new();
    let cubics = &measured.path().cubics;
    for (k, c) in cubics.iter().enumerate() {
        arc += Measured::new(Path { cubics: vec![*c], closed: false }, reach * 0.05).length();
        let arc = arc.min(length);
        let last = k + 1 == cubics.len();
        if last && !measured.is_closed() {
            break;
        }
        let here = measured.point(arc);
        let before = here - measured.point(arc - reach);
        let after = measured.point(if last { reach } else { arc + reach }) - here;
        let turn = before.dot(after) / (before.norm() * after.norm()).max(f64::MIN_POSITIVE);
        if turn < CORNER {
            found.push(if last { 0.0 } else { arc });
        }
    }
    found
}

/// The parts of a curve inside the window.
fn cut<const D: usize>(k: u32, curve: &Curve<D>, window: &Bounds<D>, side: f64) -> Vec<Line<D>> {
    let measured = Measured::new(curve.path.clone(), 5e-4 * side);
    let near = (0.5 * curve.width).max(1e-3 * side);
    let on_frame = |p: Vector<D>| window.signed_distance(p) < near;
    let line = |path: Path<D>, is_cut| Line {
        measured: Measured::new(path, 5e-4 * side),
        curve: k,
        width: curve.width,
        is_cut,
        stops: Vec::new(),
    };
    let spans = inside(&measured, side / 200.0, &|p| window.contains(p));
    let whole = matches!(spans.as_slice(), [(a, b)] if *a <= 0.0 && *b >= measured.length());
    if whole && measured.is_closed() {
        return vec![line(curve.path.clone(), [false; 2])];
    }
    let lines = spans.into_iter().map(|(a, b)| {
        let path = measured.part(a, b);
        let ends = [path.start(), path.end()].map(|p| p.is_some_and(on_frame));
        line(path, ends)
    });
    lines.filter(|l| l.measured.length() > near).collect()
}

/// Disjoint sets.
struct Groups(Vec<usize>);

impl Groups {
    fn new(n: usize) -> Self {
        Self((0..n).collect())
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }

    /// The sets, each by its smallest member.
    fn sets(mut self) -> Vec<Vec<usize>> {
        let mut sets = vec![Vec::new(); self.0.len()];
        (0..self.0.len()).for_each(|i| {
            let root = self.root(i);
            sets[root].push(i);
        });
        sets.retain(|s| !s.is_empty());
        sets
    }
}
