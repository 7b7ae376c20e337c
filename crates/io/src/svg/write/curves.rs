//! Writing the strokes of a result: one path per stroke, those painted alike in one group.

use std::{collections::BTreeMap, fmt::Write as _};

use arabesque_core::{Bounds, Decimals, Drawn, Vector};

use crate::{
    svg::{drawing::Stroke, parse::meta::part, write::sheet::Sheet},
    text::{path_data::path_data, xml::escape},
};

/// Widths that differ by less than this share are the same.
const SAME_WIDTH: f64 = 1e-3;

/// Markup of the strokes of a sheet that are not kept from another file; `shifts` tells under which shifts a box is
/// seen.
pub(crate) fn curves(
    sheet: &Sheet<'_>,
    prefix: &str,
    decimals: Decimals,
    shifts: &dyn Fn(&Bounds<2>) -> Vec<Vector<2>>,
) -> String {
    let exemplar = &sheet.drawing.exemplar;
    let mut by_style: BTreeMap<usize, Vec<(usize, &Drawn<2>)>> = BTreeMap::new();
    for (index, drawn) in sheet.curves.iter().enumerate().filter(|(_, d)| d.frozen.is_none() && !d.path.is_empty()) {
        by_style.entry(exemplar.curves[drawn.source].style).or_default().push((index, drawn));
    }
    let mut out = String::new();
    for (style, members) in by_style {
        let Some(stroke) = members.first().and_then(|(_, drawn)| sheet.drawing.strokes.get(drawn.source)) else {
            continue;
        };
        let _ = writeln!(
            out,
            "<g inkscape:groupmode=\"layer\" inkscape:label=\"{}\" id=\"{prefix}-style-{style}\"{}{}>",
            escape(&label(stroke, &exemplar.styles[style].name)),
            stroke.paint,
            stroke.lengths(1.0, decimals)
        );
        for (index, drawn) in members {
            let bounds = drawn.path.bounds().grown(0.5 * stroke.width * drawn.scale);
            for (copy, shift) in shifts(&bounds).into_iter().enumerate() {
                path(&mut out, &CurveId { prefix, index, copy }, drawn, stroke, shift, decimals);
            }
        }
        out.push_str("</g>\n");
    }
    out
}

/// The name of the layer that strokes came from, else that of their style; names that would make the layer part of a
/// job are not handed on.
fn label(stroke: &Stroke, style: &str) -> String {
    let layer = stroke.layer.as_deref().filter(|name| part(name).is_none());
    layer.unwrap_or(style).to_owned()
}

/// What the id of a path says: which stroke of the result it is, and which copy of it on a torus.
struct CurveId<'a> {
    prefix: &'a str,
    index: usize,
    copy: usize,
}

impl CurveId<'_> {
    fn text(&self) -> String {
        let copy = if self.copy == 0 { String::new() } else { format!("-{}", self.copy) };
        format!("{}-curve-{}{copy}", self.prefix, self.index)
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
