//! The lines of an exemplar and the places where they meet, end or turn sharply: what every level samples alike
//! [Tu 2020 §4.1.1].
//!
//! Curves are cut at the window. Two lines meet where they cross, and where an end comes as close to a line as the
//! stroke is wide. Lines that run side by side do not meet, however close they are.

use arabesque_core::{
    Budget, Curve, DisjointSets, Error, Measured, Meter, Numbered, Path, Result, Vector, View, spans_inside,
};

use crate::exemplar::graph::{
    contact::{Contact, MAX_CONTACTS, crossings, end_contacts},
    line::Line,
};

/// An end this many stroke widths from a line meets it: the ink of the two touches.
const TOUCH_WIDTHS: f64 = 1.0;

/// They also meet when they are closer than this share of the side of the window.
const TOUCH_SHARE: f64 = 0.003;

/// Turn from which on a joint of two segments is a corner, as the cosine of the angle: 40 degrees.
const CORNER: f64 = 0.766;

/// Most knots of an exemplar: with more, each neighbourhood would take minutes to be compared with all others.
const MAX_KNOTS: usize = 10_000;

/// No more corners are looked for when there are so many knots.
const ENOUGH_KNOTS: usize = 4 * MAX_KNOTS;

/// Nanoseconds for a place at which a curve is looked at.
const LOOK: u64 = 60;

/// An end is at the frame when it is this near, as a share of the side of the window, however wide the stroke is.
const AT_FRAME: f64 = 0.02;

/// Shorter parts of a curve are scraps that the window left, as a share of its side.
const SCRAP: f64 = 1e-3;

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

/// Lines and knots.
#[derive(Clone, Debug)]
pub(crate) struct Skeleton<const D: usize> {
    pub(crate) lines: Numbered<Line<D>>,
    /// Place and kind of every knot.
    pub(crate) knots: Numbered<(Vector<D>, Knot)>,
}

impl<const D: usize> Skeleton<D> {
    /// The skeleton of the curves that are in `view`.
    ///
    /// # Errors
    /// [`Error::Limit`] when they meet in too many places.
    pub(crate) fn new(curves: &[Curve<D>], view: &View<D>, budget: &Budget) -> Result<Self> {
        let side = view.side();
        let mut lines = Numbered::new();
        for (k, curve) in curves.iter().enumerate() {
            for line in cut(k as u32, curve, view, budget)? {
                lines.push(line);
            }
        }
        let too_many = |found: String| Error::Limit {
            what: "places of the exemplar where strokes meet, end or turn sharply".into(),
            found,
            limit: MAX_KNOTS.to_string(),
            advice: "show a smaller part of the pattern, or draw it with fewer lines".into(),
        };
        let contacts = contacts(&lines, side, budget)?;
        if contacts.len() >= MAX_CONTACTS {
            return Err(too_many(format!("{MAX_CONTACTS} or more")));
        }
        let skeleton = Self::joined(lines, &contacts, side, budget)?;
        match skeleton.knots.len() {
            0..=MAX_KNOTS => Ok(skeleton),
            found => Err(too_many(found.to_string())),
        }
    }

    /// Finds the knots of lines; `side` is the size of the picture they are part of. Of a tangle, only the first
    /// [`MAX_CONTACTS`] contacts count.
    pub(crate) fn of_lines(lines: Numbered<Line<D>>, side: f64, budget: &Budget) -> Result<Self> {
        let contacts = contacts(&lines, side, budget)?;
        Self::joined(lines, &contacts, side, budget)
    }

    /// Whether lines meet so close to a place that what lies there is part of the junction; `side` is the size of the
    /// picture.
    pub(crate) fn is_in_junction(&self, place: Vector<D>, side: f64) -> bool {
        let is_near = |p: Vector<D>| (p - place).norm() <= TOUCH_SHARE * side;
        self.knots.iter().any(|&(p, knot)| knot == Knot::Junction && is_near(p))
    }

    fn joined(lines: Numbered<Line<D>>, contacts: &[Contact<D>], side: f64, budget: &Budget) -> Result<Self> {
        let reach = reach(&lines, side);
        let mut meter = budget.meter();
        let mut skeleton = Self { lines, knots: Numbered::new() };
        skeleton.join(contacts, &reach, &mut meter)?;
        skeleton.end_lines(&reach, &mut meter)?;
        skeleton.find_corners(&reach, &mut meter)?;
        skeleton.lines.iter_mut().for_each(|line| line.stops.sort_by(|a, b| a.0.total_cmp(&b.0)));
        Ok(skeleton)
    }

    /// Makes a knot of every cluster of contacts.
    fn join(&mut self, contacts: &[Contact<D>], reach: &Numbered<f64>, meter: &mut Meter<'_>) -> Result<()> {
        let points: Vec<_> = contacts.iter().flat_map(|c| [c.place, c.place]).collect();
        let sides: Vec<(u32, f64)> = contacts.iter().flat_map(|c| c.sides).collect();
        let mut group = DisjointSets::new(sides.len());
        (0..contacts.len()).for_each(|k| group.join(2 * k, 2 * k + 1));
        meter.spend(400 * contacts.len() as u64)?;
        for (a, b) in self.passages(&points, &sides, reach, meter)? {
            group.join(a, b);
        }
        for members in group.groups() {
            let centre = members.iter().fold(Vector::ZERO, |sum, &m| sum + points[m]) * (1.0 / members.len() as f64);
            let knot = self.knots.len() as u32;
            // Of a junction on the frame nobody sees all arms.
            let is_cut = |&m: &usize| is_cut_at(&self.lines[sides[m].0], sides[m].1, reach[sides[m].0]);
            let kind = if members.iter().all(is_cut) { Knot::Cut } else { Knot::Junction };
            self.knots.push((centre, kind));
            self.stop_at(knot, &members, &sides, reach);
            meter.spend(200 * members.len() as u64)?;
        }
        Ok(())
    }

    /// The touches of each line that lie close together, along it and in the plane, in pairs.
    fn passages(
        &self,
        points: &[Vector<D>],
        sides: &[(u32, f64)],
        reach: &Numbered<f64>,
        meter: &mut Meter<'_>,
    ) -> Result<Vec<(usize, usize)>> {
        let mut pairs = Vec::new();
        let mut order: Vec<usize> = (0..sides.len()).collect();
        order.sort_by(|&a, &b| sides[a].0.cmp(&sides[b].0).then(sides[a].1.total_cmp(&sides[b].1)));
        for run in order.chunk_by(|&a, &b| sides[a].0 == sides[b].0) {
            let line = sides[run[0]].0;
            let near = reach[line];
            for (k, &a) in run.iter().enumerate() {
                // Ahead along the line; on a closed one, past its start too.
                let ahead = (k + 1..k + run.len()).map(|i| run[i % run.len()]);
                for b in ahead.take_while(|&b| self.gap(line, sides[a].1, sides[b].1) <= 2.0 * near) {
                    meter.spend(10)?;
                    if (points[b] - points[a]).norm() <= near {
                        pairs.push((a, b));
                    }
                }
            }
        }
        Ok(pairs)
    }

    /// Distance along a line.
    fn gap(&self, line: u32, a: f64, b: f64) -> f64 {
        let measured = &self.lines[line].measured;
        let d = (a - b).abs();
        if measured.is_closed() { d.min(measured.length() - d) } else { d }
    }

    /// One stop for every passage of a line through a knot.
    fn stop_at(&mut self, knot: u32, members: &[usize], sides: &[(u32, f64)], reach: &Numbered<f64>) {
        let mut passages: Vec<(u32, f64)> = members.iter().map(|&m| sides[m]).collect();
        passages.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut kept: Vec<(u32, f64)> = Vec::new();
        for (line, arc) in passages {
            let near = 2.5 * reach[line];
            let on_line = kept.iter().rev().take_while(|(l, _)| *l == line);
            if on_line.into_iter().all(|&(_, a)| self.gap(line, a, arc) > near) {
                kept.push((line, arc));
            }
        }
        for (line, arc) in kept {
            let own = &mut self.lines[line];
            let (length, near) = (own.measured.length(), reach[line]);
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
    fn end_lines(&mut self, reach: &Numbered<f64>, meter: &mut Meter<'_>) -> Result<()> {
        for (line, reach) in self.lines.iter_mut().zip(reach) {
            if line.measured.is_closed() {
                continue;
            }
            meter.spend(100 + 2 * line.stops.len() as u64)?;
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
        Ok(())
    }

    fn find_corners(&mut self, reach: &Numbered<f64>, meter: &mut Meter<'_>) -> Result<()> {
        for (line, reach) in self.lines.iter_mut().zip(reach) {
            meter.spend(10 * LOOK * line.measured.path().cubics.len() as u64)?;
            for arc in corners(&line.measured, *reach) {
                meter.spend(20 + 2 * line.stops.len() as u64)?;
                if self.knots.len() > ENOUGH_KNOTS {
                    break;
                }
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
        Ok(())
    }
}

/// How near an end comes to a line that it meets, for each line.
fn reach<const D: usize>(lines: &Numbered<Line<D>>, side: f64) -> Numbered<f64> {
    lines.iter().map(|line| (TOUCH_WIDTHS * line.width).max(TOUCH_SHARE * side)).collect()
}

/// All places where lines touch.
fn contacts<const D: usize>(lines: &Numbered<Line<D>>, side: f64, budget: &Budget) -> Result<Vec<Contact<D>>> {
    let reach = reach(lines, side);
    let mut contacts = crossings(lines, side, 1e-4 * side, budget)?;
    contacts.extend(end_contacts(lines, &reach, side, budget)?);
    Ok(contacts)
}

/// Whether the window has cut a line within `reach` of a place on it.
fn is_cut_at<const D: usize>(line: &Line<D>, arc: f64, reach: f64) -> bool {
    (line.is_cut[0] && arc <= reach) || (line.is_cut[1] && arc >= line.measured.length() - reach)
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
        let turn = before.cosine(after);
        if turn < CORNER {
            found.push(if last { 0.0 } else { arc });
        }
    }
    found
}

/// The parts of a curve inside the window.
fn cut<const D: usize>(k: u32, curve: &Curve<D>, view: &View<D>, budget: &Budget) -> Result<Vec<Line<D>>> {
    let side = view.side();
    budget.spend(20 * LOOK * curve.path.cubics.len() as u64)?;
    let measured = Measured::new(curve.path.clone(), 5e-4 * side);
    let looks = (200.0 * measured.length() / side).min(1e5) + 10.0 * measured.points().len() as f64;
    budget.spend(looks as u64 * LOOK)?;
    let near = (0.5 * curve.width).min(AT_FRAME * side).max(SCRAP * side);
    let line = |path: Path<D>, is_cut| Line {
        measured: Measured::new(path, 5e-4 * side),
        curve: k,
        width: curve.width,
        is_cut,
        stops: Vec::new(),
    };
    let spans = spans_inside(&measured, side / 200.0, &|p| view.contains(p));
    let whole = matches!(spans.as_slice(), [(a, b)] if *a <= 0.0 && *b >= measured.length());
    let pieces: Vec<Path<D>> = match whole && measured.is_closed() {
        true => vec![curve.path.clone()],
        false => spans.into_iter().map(|(a, b)| measured.part(a, b)).collect(),
    };
    let lines = pieces.into_iter().flat_map(|path| cut_at_corners(path, view, side, near)).map(|path| {
        let on_frame = |p: Vector<D>| view.signed_distance(p) < near;
        let ends = [path.start(), path.end()].map(|p| !path.closed && p.is_some_and(on_frame));
        line(path, ends)
    });
    Ok(lines.filter(|l| l.measured.length() > SCRAP * side).collect())
}

/// Cuts a path at its corners on the frame: where two lines cross exactly there, the window shows a corner.
fn cut_at_corners<const D: usize>(path: Path<D>, view: &View<D>, side: f64, near: f64) -> Vec<Path<D>> {
    let measured = Measured::new(path, 5e-4 * side);
    let length = measured.length();
    let is_inner = |arc: f64| measured.is_closed() || (arc > near && arc < length - near);
    let mut places = corners(&measured, near.max(TOUCH_SHARE * side));
    places.retain(|&arc| is_inner(arc) && view.signed_distance(measured.point(arc)) < near);
    places.sort_by(f64::total_cmp);
    let Some((&first, &last)) = places.first().zip(places.last()) else { return vec![measured.path().clone()] };
    let mut pieces: Vec<_> = places.windows(2).map(|w| measured.part(w[0], w[1])).collect();
    if measured.is_closed() {
        pieces.push(measured.part(last, first + length));
    } else {
        pieces.insert(0, measured.part(0.0, first));
        pieces.push(measured.part(last, length));
    }
    pieces
}
