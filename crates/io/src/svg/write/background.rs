//! The background of a result: a plain colour fills the domain, anything else is repeated frame by frame.

use std::fmt::Write as _;

use arabesque_core::{Decimals, Domain, Error, Outline, Result, Vector, Warning, rounded};

use crate::{
    svg::write::{
        pieces::wrapped,
        sheet::Sheet,
        text::{outline_data, rectangle},
    },
    text::xml::escape,
};

/// Repeats beyond this number would make a file that nobody can open.
const MAX_REPEATS: f64 = 100_000.0;

/// Markup that fills the domain of `sheet` with the background `markup` of its exemplar, and what is wrong with it.
pub(crate) fn background(
    markup: &str,
    sheet: &Sheet<'_>,
    prefix: &str,
    d: Decimals,
) -> Result<(String, Option<Warning>)> {
    let area = sheet.shape.cloned().unwrap_or_else(|| rectangle(&sheet.domain.bounds()));
    let text = wrapped(markup);
    let document = roxmltree::Document::parse(&text)
        .map_err(|e| Error::input("background of the exemplar", e.to_string(), "draw it as a plain rectangle"))?;
    match plain_colour(document.root_element()) {
        Some(paint) => Ok((format!("<path d=\"{}\" fill-rule=\"evenodd\"{paint}/>", outline_data(&area, d)), None)),
        None => Ok((repeated(markup, sheet, prefix, d)?, seam(sheet))),
    }
}

/// A warning when a background that is more than a colour does not fit a tile.
fn seam(sheet: &Sheet<'_>) -> Option<Warning> {
    let Domain::Torus(tile) = sheet.domain else { return None };
    let (window, tile) = (sheet.drawing.exemplar.window.size(), tile.size());
    let fits = |k: usize| (tile[k] / window[k] - (tile[k] / window[k]).round()).abs() < 1e-6;
    (!(fits(0) && fits(1))).then(|| {
        Warning::new(
            "the background is more than one colour and shows a seam in the tile",
            format!(
                "make the tile a multiple of {} x {}, or the background one colour",
                rounded(window[0]),
                rounded(window[1])
            ),
        )
    })
}

/// The paint attributes of a background that is one shape of one colour.
fn plain_colour(root: roxmltree::Node<'_, '_>) -> Option<String> {
    let (mut node, mut paint) = (root, String::new());
    loop {
        let mut children = node.children().filter(roxmltree::Node::is_element);
        let only = children.next();
        if children.next().is_some() {
            return None;
        }
        let Some(child) = only else { break };
        node = child;
        for attribute in node.attributes() {
            let (name, value) = (attribute.name(), attribute.value());
            if value.contains("url(") || (name == "stroke" && value != "none") || name.contains("href") {
                return None;
            }
            if is_paint(name) {
                let _ = write!(paint, " {name}=\"{}\"", escape(value));
            }
        }
    }
    let is_shape = matches!(node.tag_name().name(), "rect" | "path" | "polygon");
    // The same attribute on a group and on the shape in it would be written twice.
    let names: Vec<_> = paint.split('"').step_by(2).map(str::trim).filter(|n| !n.is_empty()).collect();
    let distinct = names.iter().enumerate().all(|(k, n)| !names[..k].contains(n));
    (is_shape && distinct).then_some(paint)
}

fn is_paint(name: &str) -> bool {
    matches!(name, "fill" | "fill-opacity" | "opacity" | "style" | "class")
}

fn repeated(markup: &str, sheet: &Sheet<'_>, prefix: &str, d: Decimals) -> Result<String> {
    let (window, area) = (sheet.drawing.exemplar.window, sheet.domain.bounds());
    let size = window.size();
    let count = |k: usize| (area.size()[k] / size[k]).ceil().max(1.0);
    if count(0) * count(1) > MAX_REPEATS {
        return Err(Error::Unsupported {
            what: format!("repeating the background {} times", count(0) * count(1)),
            advice: "give the exemplar a background of one colour, or none".into(),
        });
    }
    let clip: Outline<2> = sheet.shape.cloned().unwrap_or_else(|| rectangle(&area));
    let mut out = format!(
        "<clipPath id=\"{prefix}-behind\"><path d=\"{}\" clip-rule=\"evenodd\"/></clipPath>\n<g \
         clip-path=\"url(#{prefix}-behind)\">\n",
        outline_data(&clip, d)
    );
    for row in 0..count(1) as usize {
        for column in 0..count(0) as usize {
            let shift = area.min - window.min + Vector::xy(column as f64 * size[0], row as f64 * size[1]);
            let at = format!("translate({} {})", d.format(shift[0]), d.format(shift[1]));
            if row == 0 && column == 0 {
                let _ = writeln!(out, "<g transform=\"{at}\"><g id=\"{prefix}-ground\">{markup}</g></g>");
            } else {
                let _ = writeln!(out, "<use href=\"#{prefix}-ground\" transform=\"{at}\"/>");
            }
        }
    }
    out.push_str("</g>");
    Ok(out)
}
