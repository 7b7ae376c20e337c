//! The colour of a paint, and the mean colour of a gradient.

use roxmltree::Node as Xml;
use svgtypes::Color;

use crate::svg::parse::{
    css::style_declarations,
    paint::{fraction, reference},
    sheet::variables::default_of,
    source::{Source, href},
};

/// Colour of a paint, sRGB in [0, 1]; of a gradient the mean of its stops; middle grey where nothing better is known.
pub(crate) fn of_paint(source: &Source<'_>, paint: &str) -> [f64; 3] {
    match reference(paint) {
        None => parsed(paint).unwrap_or([0.5; 3]),
        Some(Ok((id, fallback))) => of_gradient(source, id).or_else(|| parsed(fallback)).unwrap_or([0.5; 3]),
        Some(Err(_)) => [0.5; 3],
    }
}

fn parsed(text: &str) -> Option<[f64; 3]> {
    let c: Color = default_of(text)?.trim().parse().ok()?;
    Some([c.red, c.green, c.blue].map(|v| f64::from(v) / 255.0))
}

fn of_gradient(source: &Source<'_>, id: &str) -> Option<[f64; 3]> {
    let mut node = source.by_id(id)?;
    // Gradients share stops through references; a ring of references ends after a few.
    for _ in 0..16 {
        let known = source.colours.borrow().get(&node.id().get()).copied();
        let mean = known.unwrap_or_else(|| mean_of_stops(node));
        source.colours.borrow_mut().insert(node.id().get(), mean);
        if mean.is_some() {
            return mean;
        }
        href(node)?;
        node = source.target(node)?;
    }
    None
}

/// The mean colour of the stops that a gradient has itself.
fn mean_of_stops(node: Xml<'_, '_>) -> Option<[f64; 3]> {
    let stops: Vec<_> = node.children().filter(|c| c.tag_name().name() == "stop").filter_map(stop_colour).collect();
    let n = stops.len() as f64;
    (!stops.is_empty()).then(|| std::array::from_fn(|k| stops.iter().map(|c| c[k]).sum::<f64>() / n))
}

fn stop_colour(stop: Xml<'_, '_>) -> Option<[f64; 3]> {
    let mut colour = stop.attribute("stop-color").and_then(parsed);
    let mut opacity = stop.attribute("stop-opacity").map_or(1.0, fraction);
    for declaration in style_declarations(stop.attribute("style").unwrap_or_default()) {
        match declaration.name {
            "stop-color" => colour = parsed(declaration.value).or(colour),
            "stop-opacity" => opacity = fraction(declaration.value),
            _ => {}
        }
    }
    // On a white page a transparent stop shows white.
    colour.map(|c| c.map(|v| v * opacity + 1.0 - opacity))
}
