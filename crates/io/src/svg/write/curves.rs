//! Writing the strokes of a result: one path per paint of a stroke, those painted alike in one group.

use std::{collections::BTreeMap, fmt::Write as _};

use arabesque_core::{Bounds, Decimals, Drawn, Vector};

use crate::{
    svg::{drawing::Stroke, parse::meta::part, write::sheet::Sheet},
    text::{path_data::path_data, xml::escape},
};

/// Widths that differ by less than this share are the same.
const SAME_WIDTH: f64 = 1e-3;

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
        for (copy, shift) in shifts(&bounds).into_iter().enumerate() {
            path(&mut out, &CurveId { prefix, index, paint, copy }, drawn, stroke, shift, decimals);
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

fn path(out: &mut String, id: &CurveId<'_>, drawn: &Drawn<2>, stroke: &Stroke, shift: Vector<2>, decimals: Decimals) {
    let moved = if shift == Vector::ZERO { drawn.path.clone() } else { drawn.path.map(|p| p + shift) };
    let _ = write!(
        out,
        "<path id=\"{}\" d=\"{}\" data-arabesque-curve=\"{}\"",
        id.text(),
        path_data(&moved, decimals),
        drawn.source
    );
    if (drawn.scale - 1.0).abs() > SAME_WIDTH {
        out.push_str(&stroke.lengths(drawn.scale, decimals));
    }
    out.push_str(&stroke.effects);
    out.push_str("/>\n");
}
