//! Writing the strokes of a result: one path per paint of a stroke, those painted alike in one group.

use std::{collections::BTreeMap, fmt::Write as _};

use arabesque_core::{Bounds, Cubic, Decimals, Domain, Drawn, Measured, Path, Vector};

use crate::{
    svg::{drawing::Stroke, parse::meta::part, write::sheet::Sheet},
    text::{path_data::path_data, xml::escape},
};

/// Widths that differ by less than this share are the same.
const SAME_WIDTH: f64 = 1e-3;

/// Ends of a stroke are this near to a whole number of tiles apart where it goes around, as a share of the tile.
const SAME_PLACE: f64 = 1e-6;

/// A stroke is measured to this share of the period of its dashes.
const MEASURED: f64 = 1e-3;

/// The strokes of a sheet by style, with their numbers.
pub(crate) type ByStyle<'a> = BTreeMap<usize, Vec<(usize, &'a Drawn<2>)>>;

/// The strokes of a sheet that are not kept from another file.
pub(crate) fn by_style<'a>(sheet: &Sheet<'a>) -> ByStyle<'a> {
    let mut by_style = ByStyle::new();
    for (index, drawn) in sheet.curves.iter().enumerate().filter(|(_, d)| d.frozen.is_none() && !d.path.is_empty()) {
        by_style.entry(sheet.drawing.exemplar.curves[drawn.source].style).or_default().push((index, drawn));
    }
    by_style
}

/// A layer of strokes: a style, and which of its paints.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StrokeLayer {
    pub(crate) style: usize,
    pub(crate) paint: usize,
}

/// Markup of a layer of the strokes `members`; `shifts` tells under which shifts a box is seen.
pub(crate) fn curves(
    sheet: &Sheet<'_>,
    layer: StrokeLayer,
    members: &[(usize, &Drawn<2>)],
    prefix: &str,
    decimals: Decimals,
    shifts: &dyn Fn(&Bounds<2>) -> Vec<Vector<2>>,
) -> String {
    let mut out = String::new();
    let paints = members.first().and_then(|(_, drawn)| sheet.drawing.strokes.get(drawn.source));
    let Some(stroke) = paints.and_then(|paints| paints.get(layer.paint)) else { return out };
    let StrokeLayer { style, paint } = layer;
    let suffix = if paint == 0 { String::new() } else { format!("-{}", paint + 1) };
    let _ = writeln!(
        out,
        "<g inkscape:groupmode=\"layer\" inkscape:label=\"{}\" id=\"{prefix}-style-{style}{suffix}\"{}{}>",
        escape(&label(stroke, &sheet.drawing.exemplar.styles[style].name, (paint, paints.map_or(1, Vec::len)))),
        stroke.paint,
        stroke.lengths(1.0, decimals)
    );
    for &(index, drawn) in members {
        let bounds = drawn.path.bounds().grown(0.5 * stroke.width * drawn.scale);
        let shifts = shifts(&bounds);
        let (lines, dashes) = match around(&drawn.path, sheet.domain) {
            Some(turns) => (run_on(&drawn.path, turns, &shifts, sheet.domain), whole_dashes(drawn, stroke)),
            None => (shifts.into_iter().map(|shift| moved(&drawn.path, shift)).collect(), 1.0),
        };
        for (copy, line) in lines.iter().enumerate() {
            let id = CurveId { prefix, index, paint, copy }.text();
            let _ = write!(
                out,
                "<path id=\"{id}\" d=\"{}\" data-arabesque-curve=\"{}\"",
                path_data(line, decimals),
                drawn.source
            );
            if (drawn.scale - 1.0).abs() > SAME_WIDTH || dashes != 1.0 {
                out.push_str(&stroke.with_dashes(dashes).lengths(drawn.scale, decimals));
            }
            out.push_str(&stroke.effects);
            out.push_str("/>\n");
        }
    }
    out.push_str("</g>\n");
    out
}

/// The name of the layer that strokes came from, else that of their style, with which of its paints they are where it
/// has several; names that would make the layer part of a job are not handed on.
fn label(stroke: &Stroke, style: &str, (paint, paints): (usize, usize)) -> String {
    let layer = stroke.layer.as_deref().filter(|name| part(name).is_none());
    match layer {
        Some(layer) => layer.to_owned(),
        None if paints > 1 => format!("{style} ({} of {paints})", paint + 1),
        None => style.to_owned(),
    }
}

/// What the id of a path says: which stroke of the result it is, in which of its paints, and which copy on a torus.
struct CurveId<'a> {
    prefix: &'a str,
    index: usize,
    paint: usize,
    copy: usize,
}

impl CurveId<'_> {
    fn text(&self) -> String {
        let paint = if self.paint == 0 { String::new() } else { format!("-paint-{}", self.paint + 1) };
        let copy = if self.copy == 0 { String::new() } else { format!("-{}", self.copy) };
        format!("{}-curve-{}{paint}{copy}", self.prefix, self.index)
    }
}

fn moved(path: &Path<2>, by: Vector<2>) -> Path<2> {
    if by == Vector::ZERO { path.clone() } else { path.map(|p| p + by) }
}

/// How many tiles farther a stroke ends than it begins, where it goes on in its own copy there.
fn around(path: &Path<2>, domain: &Domain<2>) -> Option<[i64; 2]> {
    let size = domain.period()?;
    let (start, end) = (path.start()?, path.end()?);
    let turns = [0, 1].map(|k| ((end[k] - start[k]) / size[k]).round());
    let off = end - start - Vector::xy(turns[0] * size[0], turns[1] * size[1]);
    (!path.closed && turns != [0.0, 0.0] && off.norm() <= SAME_PLACE * size.norm()).then(|| turns.map(|n| n as i64))
}

/// A stroke that goes on in its own copies, as lines from beyond one side of the tile to beyond another: where lines of
/// tiles side by side are cut, none of them ends. `shifts`: under which the stroke is seen in the tile.
fn run_on(path: &Path<2>, [i, j]: [i64; 2], shifts: &[Vector<2>], domain: &Domain<2>) -> Vec<Path<2>> {
    let Some(size) = domain.period() else { return Vec::new() };
    let mut lines: BTreeMap<[i64; 2], (i64, i64)> = BTreeMap::new();
    for shift in shifts {
        let [a, b] = [0, 1].map(|k| (shift[k] / size[k]).round() as i64);
        let turn = if i != 0 { a.div_euclid(i) } else { b.div_euclid(j) };
        let turns = lines.entry([a - turn * i, b - turn * j]).or_insert((turn, turn));
        *turns = (turns.0.min(turn), turns.1.max(turn));
    }
    let line = |([a, b], (first, last)): ([i64; 2], (i64, i64))| {
        let mut cubics: Vec<Cubic<2>> = Vec::new();
        for turn in first - 1..=last + 1 {
            let by = Vector::xy((a + turn * i) as f64 * size[0], (b + turn * j) as f64 * size[1]);
            let joint = cubics.len();
            cubics.extend(moved(path, by).cubics);
            if joint > 0 {
                cubics[joint][0] = cubics[joint - 1][3];
            }
        }
        Path { cubics, closed: false }
    };
    lines.into_iter().map(line).collect()
}

/// The factor by which the dashes of a stroke become a whole number of periods, so that they go on in its copies.
fn whole_dashes(drawn: &Drawn<2>, stroke: &Stroke) -> f64 {
    let twice = if stroke.dashes.len() % 2 == 1 { 2.0 } else { 1.0 };
    let period = twice * stroke.dashes.iter().sum::<f64>() * drawn.scale;
    if stroke.dashes.is_empty() || period <= 0.0 {
        return 1.0;
    }
    let length = Measured::new(drawn.path.clone(), MEASURED * period).length();
    length / (period * (length / period).round().max(1.0))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use super::*;

    fn tile() -> Domain<2> {
        Domain::Torus(Bounds::new(Vector::ZERO, Vector::xy(40.0, 20.0)))
    }

    fn line(a: (f64, f64), b: (f64, f64)) -> Path<2> {
        Path::polyline(&[Vector::xy(a.0, a.1), Vector::xy(b.0, b.1)])
    }

    #[test]
    fn a_line_around_the_tile_runs_over_both_of_its_sides() {
        let path = line((13.0, 5.0), (53.0, 5.0));
        let turns = around(&path, &tile()).unwrap();
        let lines = run_on(&path, turns, &[Vector::ZERO, Vector::xy(-40.0, 0.0)], &tile());
        assert_eq!((turns, lines.len()), ([1, 0], 1));
        assert!(lines[0].start().unwrap()[0] < 0.0 && lines[0].end().unwrap()[0] > 40.0);
    }

    #[test]
    fn a_slanted_line_is_as_many_lines_as_it_passes_the_tile() {
        let path = line((0.0, 0.0), (40.0, 40.0));
        let turns = around(&path, &tile()).unwrap();
        let lines = run_on(&path, turns, &[Vector::ZERO, Vector::xy(0.0, -20.0)], &tile());
        assert_eq!((turns, lines.len()), ([1, 2], 2));
    }

    #[test]
    fn what_ends_in_the_tile_or_closes_does_not_run_on() {
        assert_eq!(around(&line((3.0, 5.0), (33.0, 5.0)), &tile()), None);
        assert_eq!(around(&line((3.0, 5.0), (43.0, 5.0)), &Domain::Box(tile().bounds())), None);
        let ring = Path { closed: true, ..line((3.0, 5.0), (43.0, 5.0)) };
        assert_eq!(around(&ring, &tile()), None);
    }
}
