//! Markup painted in another way.

use arabesque_core::{Error, Result};

use crate::{
    placed::{layout::Paint, splice::Splices},
    svg::write::pieces::wrapped,
    text::xml::escape,
};

/// What can be set, and what it takes.
const PROPERTIES: [(&str, Takes); 6] = [
    ("fill", Takes::Colour),
    ("stroke", Takes::Colour),
    ("stroke-width", Takes::Length),
    ("opacity", Takes::Share),
    ("fill-opacity", Takes::Share),
    ("stroke-opacity", Takes::Share),
];

#[derive(Clone, Copy)]
enum Takes {
    Colour,
    Length,
    Share,
}

/// Refuses what is no property that can be set, and values that it does not take.
///
/// # Errors
/// [`Error::Parameter`].
pub fn check_paint(paint: &Paint) -> Result<()> {
    let Some((_, takes)) = PROPERTIES.iter().find(|(name, _)| *name == paint.property) else {
        let names = PROPERTIES.map(|(name, _)| name);
        let hint = arabesque_core::suggest::did_you_mean(&paint.property, names);
        return Err(Error::parameter("set", &paint.property, format!("one of {}{hint}", names.join(", "))));
    };
    let number = paint.value.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    let (fits, expected) = match takes {
        Takes::Colour => (is_colour(&paint.value), "a colour such as #c0392b, or none"),
        Takes::Length => (number.is_some_and(|v| (0.0..1e9).contains(&v)), "a number from 0 to below 1e9"),
        Takes::Share => (number.is_some_and(|v| (0.0..=1.0).contains(&v)), "a number from 0 to 1"),
    };
    if fits { Ok(()) } else { Err(Error::parameter(&*paint.property, &paint.value, expected)) }
}

fn is_colour(value: &str) -> bool {
    let is_function = value.trim_start().starts_with("url(");
    value == "none" || (!is_function && value.parse::<svgtypes::Color>().is_ok())
}

/// Tags of what can be painted.
const SHAPES: [&str; 8] = ["path", "rect", "circle", "ellipse", "line", "polyline", "polygon", "text"];

/// Markup with other paint: every shape that has a fill gets the new fill, and every one that has a stroke the new stroke. Opacity of the
/// whole is not the business of what is in it.
///
/// # Errors
/// [`Error::Input`] for markup that is not well-formed.
pub(super) fn repainted(markup: &str, paint: &[Paint]) -> Result<String> {
    let mut markup = markup.to_owned();
    for paint in paint.iter().filter(|paint| paint.property != "opacity") {
        markup = with(&markup, paint)?;
    }
    Ok(markup)
}

fn with(markup: &str, paint: &Paint) -> Result<String> {
    let text = wrapped(markup);
    let document = roxmltree::Document::parse(&text)
        .map_err(|e| Error::input("an element of the result", e.to_string(), "edit a result as arabesque wrote it"))?;
    let (kind, _) = paint.property.split_once('-').unwrap_or((&paint.property, ""));
    let mut splices = Splices::default();
    for node in document.descendants().filter(|n| SHAPES.contains(&n.tag_name().name())) {
        let has = value_of(node, kind).map_or(kind == "fill", |value| value != "none");
        if !has {
            continue;
        }
        if let Some(style) =
            node.attributes().find(|a| a.name() == "style" && in_style(a.value(), &paint.property).is_some())
        {
            let Some(at) = in_style(style.value(), &paint.property) else { continue };
            let new = format!("{}{}{}", &style.value()[..at.start], paint.value, &style.value()[at.end..]);
            splices.put(style.range_value(), escape(&new));
        } else if let Some(own) = node.attribute_node(paint.property.as_str()) {
            splices.put(own.range_value(), escape(&paint.value));
        } else {
            let slot = node.range().start + 1 + node.tag_name().name().len();
            splices.put(slot..slot, format!(" {}=\"{}\"", paint.property, escape(&paint.value)));
        }
    }
    let new = splices.apply(&text);
    let root = document.root_element();
    let before = root.first_child().map_or(0, |child| child.range().start);
    let after = text.len() - root.last_child().map_or(text.len(), |child| child.range().end);
    Ok(new[before..new.len() - after].to_owned())
}

/// The value that a property has at a node: its own, or that of what is around it.
fn value_of<'a>(node: roxmltree::Node<'a, '_>, property: &str) -> Option<&'a str> {
    node.ancestors().find_map(|node| {
        let style = node.attribute("style").and_then(|style| Some(&style[in_style(style, property)?]));
        style.or_else(|| node.attribute(property)).map(str::trim)
    })
}

/// Where in a list of declarations the value of a property stands.
fn in_style(style: &str, property: &str) -> Option<std::ops::Range<usize>> {
    let mut at = 0;
    for declaration in style.split(';') {
        if let Some((name, value)) = declaration.split_once(':')
            && name.trim() == property
        {
            let from = at + name.len() + 1;
            return Some(from..from + value.len());
        }
        at += declaration.len() + 1;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paint(property: &str, value: &str) -> Paint {
        Paint { property: property.into(), value: value.into() }
    }

    #[test]
    fn fills_and_strokes_that_are_there_are_replaced() {
        let markup = "<g><path d=\"M0 0\"/><circle r=\"1\" fill=\"none\" stroke=\"red\"/>\
                      <rect style=\"fill:blue;stroke: none\" fill=\"x\"/></g>";
        let painted =
            repainted(markup, &[paint("fill", "#abc"), paint("stroke", "green"), paint("opacity", "0.5")]).unwrap();
        assert_eq!(
            painted,
            "<g><path fill=\"#abc\" d=\"M0 0\"/><circle r=\"1\" fill=\"none\" stroke=\"green\"/>\
             <rect style=\"fill:#abc;stroke: none\" fill=\"x\"/></g>"
        );
        let wide = repainted("<path stroke=\"red\"/><path/>", &[paint("stroke-width", "3")]).unwrap();
        assert_eq!(wide, "<path stroke-width=\"3\" stroke=\"red\"/><path/>");
    }

    #[test]
    fn what_is_no_paint_is_refused() {
        for (property, value, expected) in [
            ("fil", "red", "did you mean fill"),
            ("transform", "scale(0)", "one of fill"),
            ("fill", "url(#a)", "a colour"),
            ("fill", "\"/><script>", "a colour"),
            ("opacity", "nan", "from 0 to 1"),
            ("opacity", "1.5", "from 0 to 1"),
            ("stroke-width", "-1", "from 0 to below 1e9"),
        ] {
            let message = check_paint(&paint(property, value)).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        for (property, value) in [("fill", "#ff8800"), ("fill", "none"), ("stroke", "tomato"), ("opacity", "0.5")] {
            check_paint(&paint(property, value)).unwrap();
        }
    }
}
