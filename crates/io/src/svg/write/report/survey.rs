//! A drawing of what was understood of an exemplar.

use std::fmt::Write as _;

use arabesque_core::{Decimals, Role};

use crate::{
    svg::{
        drawing::{Drawing, Layer, Page},
        palette::PALETTE,
        reason::Reason,
        write::{
            document::{PREFIXES, Root},
            text::{outline_data, rectangle},
        },
    },
    text::{path_data::path_data, xml::escape},
};

/// The exemplar faded, every outline in the colour of its class (dashed where it is cut at the frame), the centres,
/// every curve in the colour of its style with dots at its ends, what is left out in grey dots, and the frame.
pub fn write_survey(drawing: &Drawing) -> String {
    let exemplar = &drawing.exemplar;
    let view =
        exemplar.elements.iter().fold(drawing.page.view.union(&exemplar.window), |b, e| b.union(&e.outline.bounds()));
    let size = view.size();
    let d = Decimals::for_extent(size[0].max(size[1]));
    let line = (0.02 * exemplar.spacing()).min(0.003 * size[0].max(size[1]));
    let page = Page { view, ..drawing.page };
    let mut out = Root { page, decimals: d, lengths: d, prefixes: &PREFIXES, attributes: "" }.start_tag();
    let _ = write!(out, "<defs>{}</defs>\n<g opacity=\"0.3\">\n", drawing.definitions);
    out.extend(drawing.background.iter().chain(drawing.fragments.iter().map(|f| &f.markup)).map(|m| format!("{m}\n")));
    faded_curves(&mut out, drawing, d);
    let _ = writeln!(out, "</g>\n<g fill=\"none\" stroke-width=\"{}\">", d.plus(2).format(line));
    let frame = outline_data(&rectangle(&exemplar.window), d);
    let _ = writeln!(out, "<path d=\"{frame}\" stroke=\"#000000\"/>");
    elements(&mut out, drawing, d, line);
    curves(&mut out, drawing, d, line);
    areas(&mut out, drawing, d);
    left_out(&mut out, drawing, d, line);
    out.push_str("</g>\n</svg>\n");
    out
}

fn elements(out: &mut String, drawing: &Drawing, d: Decimals, line: f64) {
    for (k, e) in drawing.exemplar.elements.iter().enumerate() {
        let colour = PALETTE[e.class % PALETTE.len()];
        let dash = if e.role == Role::Context {
            format!(" stroke-dasharray=\"{}\"", d.plus(2).format(4.0 * line))
        } else {
            String::new()
        };
        let label = escape(&format!("element {k}, {}", drawing.exemplar.classes[e.class].name));
        let (x, y) = (d.format(e.centre[0]), d.format(e.centre[1]));
        let _ = writeln!(
            out,
            "<g stroke=\"{colour}\"><title>{label}</title><path d=\"{}\"{dash}/><circle cx=\"{x}\" cy=\"{y}\" \
             r=\"{}\" fill=\"{colour}\"/></g>",
            outline_data(&e.outline, d),
            d.plus(2).format(1.5 * line)
        );
    }
}

/// The curves as the file has them, in all their paints.
pub(super) fn faded_curves(out: &mut String, drawing: &Drawing, d: Decimals) {
    for (area, fill) in drawing.exemplar.areas.iter().zip(&drawing.fills) {
        let _ = writeln!(out, "<path d=\"{}\"{} fill-rule=\"evenodd\"/>", outline_data(&area.outline, d), fill.paint);
    }
    let mut of_style = vec![Vec::new(); drawing.exemplar.styles.len()];
    for (curve, strokes) in drawing.exemplar.curves.iter().zip(&drawing.strokes) {
        of_style[curve.style].push((curve, strokes));
    }
    for layer in &drawing.layers {
        let &Layer::Strokes { style, paint } = layer else { continue };
        let curves = of_style.get(style).into_iter().flatten();
        for (curve, stroke) in curves.filter_map(|(curve, strokes)| Some((curve, strokes.get(paint)?))) {
            let (paint, width) = (&stroke.paint, d.plus(2).format(stroke.width));
            let _ = writeln!(out, "<path d=\"{}\"{paint} stroke-width=\"{width}\"/>", path_data(&curve.path, d));
        }
    }
}

fn curves(out: &mut String, drawing: &Drawing, d: Decimals, line: f64) {
    for (k, curve) in drawing.exemplar.curves.iter().enumerate() {
        // Classes come first in the palette.
        let colour = PALETTE[(drawing.exemplar.classes.len() + curve.style) % PALETTE.len()];
        let label = escape(&format!("curve {k}, {}", drawing.exemplar.styles[curve.style].name));
        let data = path_data(&curve.path, d);
        let _ = write!(out, "<g stroke=\"{colour}\"><title>{label}</title><path d=\"{data}\"/>");
        let ends = if curve.path.closed { [None, None] } else { [curve.path.start(), curve.path.end()] };
        for p in ends.into_iter().flatten() {
            let (x, y, r) = (d.format(p[0]), d.format(p[1]), d.plus(2).format(1.5 * line));
            let _ = write!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"{colour}\"/>");
        }
        out.push_str("</g>\n");
    }
}

/// The areas by their borders.
fn areas(out: &mut String, drawing: &Drawing, d: Decimals) {
    for (k, area) in drawing.exemplar.areas.iter().enumerate() {
        let colour = PALETTE[(drawing.exemplar.classes.len() + area.style) % PALETTE.len()];
        let label = escape(&format!("area {k}, {}", drawing.exemplar.styles[area.style].name));
        let data = outline_data(&area.outline, d);
        let _ = writeln!(out, "<g stroke=\"{colour}\"><title>{label}</title><path d=\"{data}\"/></g>");
    }
}

/// What is no part of the pattern, dotted in grey.
fn left_out(out: &mut String, drawing: &Drawing, d: Decimals, line: f64) {
    for known in drawing.understood.iter().filter(|known| known.reason != Reason::Background) {
        let label = escape(&format!("{}: {}", known.reason.taken_for(), known.reason.why()));
        for outline in known.outlines.iter().filter(|outline| !outline.rings.is_empty()) {
            let _ = writeln!(
                out,
                "<path d=\"{}\" stroke=\"#808080\" stroke-dasharray=\"{}\"><title>{label}</title></path>",
                outline_data(outline, d),
                d.plus(2).format(line)
            );
        }
    }
}
