//! Writing the filled areas of a result: one path each, those painted alike in one group.

use std::fmt::Write as _;

use arabesque_core::{Bounds, Covered, Decimals, Outline, Vector};

use crate::{
    svg::{
        parse::meta::part,
        write::{sheet::Sheet, text::outline_data},
    },
    text::xml::escape,
};

/// Markup of the areas of a style; `shifts` tells under which shifts a box is seen.
pub(crate) fn areas(
    sheet: &Sheet<'_>,
    style: usize,
    prefix: &str,
    decimals: Decimals,
    shifts: &dyn Fn(&Bounds<2>) -> Vec<Vector<2>>,
) -> String {
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
        for (copy, shift) in shifts(&area.outline.bounds()).into_iter().enumerate() {
            let copy = if copy == 0 { String::new() } else { format!("-{copy}") };
            let moved = |p: &Vector<2>| *p + shift;
            let rings = area.outline.rings.iter().map(|ring| ring.iter().map(moved).collect()).collect();
            let _ = writeln!(
                out,
                "<path id=\"{prefix}-area-{index}{copy}\" d=\"{}\" data-arabesque-area=\"{}\"{}/>",
                outline_data(&Outline { rings }, decimals),
                area.source,
                fill.effects
            );
        }
    }
    out.push_str("</g>\n");
    out
}
