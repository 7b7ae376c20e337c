//! Writing the filled areas of a result: one path each, those painted alike in one group.

use std::{borrow::Cow, fmt::Write as _};

use arabesque_core::{Covered, Decimals, Matrix, Outline, Vector};

use crate::{
    svg::{
        parse::meta::part,
        write::{sheet::Sheet, text::outline_data},
    },
    text::xml::{escape, number},
};

/// Markup of the areas of a style, each once: on a torus they cover all of the tile.
pub(crate) fn areas(sheet: &Sheet<'_>, style: usize, prefix: &str, decimals: Decimals) -> String {
    let exemplar = &sheet.drawing.exemplar;
    let is_of_style = |(_, area): &(usize, &Covered<2>)| exemplar.areas[area.source].style == style;
    let members: Vec<_> = sheet.areas.iter().enumerate().filter(is_of_style).collect();
    let mut out = String::new();
    let Some(fill) = members.first().and_then(|(_, area)| sheet.drawing.fills.get(area.source)) else { return out };
    let layer = fill.layer.as_deref().filter(|name| part(name).is_none());
    let label = escape(layer.unwrap_or(&exemplar.styles[style].name));
    let _ = writeln!(
        out,
        "<g inkscape:groupmode=\"layer\" inkscape:label=\"{label}\" id=\"{prefix}-style-{style}\"{} fill-rule=\"evenodd\">",
        fill.paint
    );
    for (index, area) in members {
        let (outline, transform) = with_paint(area, fill.paint.contains("url("));
        let _ = writeln!(
            out,
            "<path id=\"{prefix}-area-{index}\" d=\"{}\"{transform} data-arabesque-area=\"{}\"{}/>",
            outline_data(&outline, decimals),
            area.source,
            fill.effects
        );
    }
    out.push_str("</g>\n");
    out
}

/// The outline of an area, and the transform with which it is drawn: where its paint is not the same everywhere, both are
/// those of the exemplar.
fn with_paint(area: &Covered<2>, varies: bool) -> (Cow<'_, Outline<2>>, String) {
    let (linear, shift) = area.paint;
    let [[a, b], [c, d]] = linear.0;
    let measure = a * d - b * c;
    let is_still = linear == Matrix::identity() && shift == Vector::ZERO;
    if !varies || is_still || measure == 0.0 {
        return (Cow::Borrowed(&area.outline), String::new());
    }
    let back = |p: &Vector<2>| {
        let v = *p - shift;
        Vector::xy(d * v[0] - b * v[1], a * v[1] - c * v[0]) * (1.0 / measure)
    };
    let rings = area.outline.rings.iter().map(|ring| ring.iter().map(back).collect()).collect();
    let numbers = [a, c, b, d, shift[0], shift[1]].map(number).join(" ");
    (Cow::Owned(Outline { rings }), format!(" transform=\"matrix({numbers})\""))
}
