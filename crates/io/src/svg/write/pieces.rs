//! The markup of an element taken apart: plain paths with their paint, and what has to stay as it is.

use std::{collections::BTreeMap, str::FromStr};

use arabesque_core::{Error, Result};
use kurbo::{Affine, BezPath, Shape as _};

use crate::{
    svg::{
        namespace::{INKSCAPE, SVG, XLINK},
        parse::length::unit_of,
    },
    text::xml::escape,
};

/// Attributes of one node, sorted by name.
type Attributes = BTreeMap<String, String>;

/// A part of an element, in the coordinates of the exemplar.
#[derive(Clone, Debug)]
pub(crate) enum MarkupPiece {
    /// Start tag of a group that does something to what is in it.
    Open(String),
    /// End tag of the last open group.
    Close,
    /// A path with everything that paints it.
    Path(PaintedPath),
    /// Markup that cannot be flattened: pictures, text, links, and whatever refers to a gradient, a clip or a filter.
    Whole(String),
}

/// A path with everything that paints it.
#[derive(Clone, Debug)]
pub(crate) struct PaintedPath {
    pub(crate) path: BezPath,
    /// Paint and the rest, except what scales with the element.
    pub(crate) attributes: Attributes,
    /// `stroke-width`, `stroke-dasharray` and `stroke-dashoffset`, in exemplar units.
    pub(crate) lengths: Vec<(&'static str, Vec<f64>)>,
}

impl PaintedPath {
    /// Whether the inside is painted.
    pub(crate) fn is_filled(&self) -> bool {
        self.attributes.get("fill").is_none_or(|v| v != "none")
    }

    /// Whether the line is painted.
    pub(crate) fn is_stroked(&self) -> bool {
        self.attributes.get("stroke").is_some_and(|v| v != "none")
    }
}

/// Attributes that belong to the node itself and are not handed down to what is in it.
const OWN: [&str; 9] =
    ["opacity", "clip-path", "mask", "filter", "mix-blend-mode", "isolation", "display", "overflow", "class"];
/// Attributes that describe the geometry, or that would name something twice.
const GEOMETRY: [&str; 18] = [
    "d",
    "x",
    "y",
    "width",
    "height",
    "rx",
    "ry",
    "cx",
    "cy",
    "r",
    "x1",
    "y1",
    "x2",
    "y2",
    "points",
    "transform",
    "id",
    "style",
];
const LENGTHS: [&str; 3] = ["stroke-width", "stroke-dasharray", "stroke-dashoffset"];
/// Tolerance for turning circles and arcs into cubics, in exemplar units relative to the size of the shape.
const ARC_TOLERANCE: f64 = 1e-4;

/// `markup` as a document of its own, with the namespaces that it may use.
pub(crate) fn wrapped(markup: &str) -> String {
    format!(
        "<svg xmlns=\"{SVG}\" xmlns:xlink=\"{XLINK}\" xmlns:inkscape=\"{INKSCAPE}\" \
         xmlns:sodipodi=\"http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd\">{markup}</svg>"
    )
}

/// Takes the markup of one element apart.
///
/// # Errors
/// [`Error::Input`] when it is not well-formed, or a path in it cannot be read.
pub(crate) fn take_apart(markup: &str) -> Result<Vec<MarkupPiece>> {
    let text = wrapped(markup);
    let document = roxmltree::Document::parse(&text).map_err(|e| broken(&e.to_string()))?;
    let mut pieces = Vec::new();
    for child in document.root_element().children().filter(roxmltree::Node::is_element) {
        visit(child, Affine::IDENTITY, &Attributes::new(), &mut pieces)?;
    }
    Ok(pieces)
}

fn broken(problem: &str) -> Error {
    Error::input("an element of the exemplar", problem, "draw it again with plain paths, or write without expanding")
}

fn visit(node: roxmltree::Node<'_, '_>, above: Affine, handed: &Attributes, out: &mut Vec<MarkupPiece>) -> Result<()> {
    let name = node.tag_name().name();
    if matches!(name, "title" | "desc" | "metadata") {
        return Ok(());
    }
    let own = attributes(node);
    let refers = own.values().chain(handed.values()).any(|v| v.contains("url("));
    let transform = above * transform_of(node)?;
    let mut merged = handed.clone();
    merged.extend(own.iter().filter(|(n, _)| !OWN.contains(&n.as_str())).map(|(n, v)| (n.clone(), v.clone())));
    if matches!(name, "g" | "a") && !refers {
        return group(node, transform, &own, &merged, out);
    }
    if !refers
        && is_even(transform, &merged)
        && let Some(path) = path_of(node)?
    {
        out.push(painted(&(transform * path), transform, &own, merged));
        return Ok(());
    }
    out.push(MarkupPiece::Whole(whole(node, above, handed)));
    Ok(())
}

fn group(
    node: roxmltree::Node<'_, '_>,
    transform: Affine,
    own: &Attributes,
    merged: &Attributes,
    out: &mut Vec<MarkupPiece>,
) -> Result<()> {
    let kept: String = own_text(own, |n| OWN.contains(&n) && n != "class");
    if !kept.is_empty() {
        out.push(MarkupPiece::Open(format!("<g{kept}>")));
    }
    for child in node.children().filter(roxmltree::Node::is_element) {
        visit(child, transform, merged, out)?;
    }
    if !kept.is_empty() {
        out.push(MarkupPiece::Close);
    }
    Ok(())
}

fn own_text(own: &Attributes, keep: impl Fn(&str) -> bool) -> String {
    own.iter().filter(|(n, _)| keep(n)).map(|(n, v)| declaration(n, v)).collect()
}

/// An attribute, or a style for the two properties that have no attribute.
fn declaration(name: &str, value: &str) -> String {
    match name {
        "mix-blend-mode" | "isolation" => format!(" style=\"{name}:{}\"", escape(value)),
        _ => format!(" {name}=\"{}\"", escape(value)),
    }
}

/// Attributes and style declarations of a node; a declaration wins over an attribute.
fn attributes(node: roxmltree::Node<'_, '_>) -> Attributes {
    let mut found: Attributes = node
        .attributes()
        .filter(|a| a.namespace().is_none() && !GEOMETRY.contains(&a.name()))
        .map(|a| (a.name().to_owned(), a.value().to_owned()))
        .collect();
    for part in node.attribute("style").unwrap_or_default().split(';') {
        if let Some((name, value)) = part.split_once(':') {
            let value = value.trim().trim_end_matches("!important").trim();
            if is_property(name.trim()) {
                found.insert(name.trim().to_owned(), value.to_owned());
            }
        }
    }
    found
}

/// Whether a style declaration has a presentation attribute of the same name; vendors' own properties have none.
fn is_property(name: &str) -> bool {
    !name.is_empty() && !name.starts_with('-') && name.chars().all(|c| c.is_ascii_lowercase() || c == '-')
}

fn transform_of(node: roxmltree::Node<'_, '_>) -> Result<Affine> {
    let Some(text) = node.attribute("transform") else { return Ok(Affine::IDENTITY) };
    let t = svgtypes::Transform::from_str(text).map_err(|e| broken(&e.to_string()))?;
    Ok(Affine::new([t.a, t.b, t.c, t.d, t.e, t.f]))
}

/// Whether strokes keep their shape under the transform: it is a similarity, mirrored or not, or there is no stroke.
fn is_even(transform: Affine, attributes: &Attributes) -> bool {
    let [a, b, c, d, ..] = transform.as_coeffs();
    let (p, q) = (a.hypot(b), c.hypot(d));
    let similar = (p - q).abs() <= 1e-3 * p.max(q) && (a * c + b * d).abs() <= 1e-3 * p * q;
    similar || attributes.get("stroke").is_none_or(|s| s == "none")
}

fn painted(path: &BezPath, transform: Affine, own: &Attributes, mut attributes: Attributes) -> MarkupPiece {
    let scale = transform.determinant().abs().sqrt();
    attributes.extend(
        own.iter().filter(|(n, _)| OWN.contains(&n.as_str()) && *n != "class").map(|(n, v)| (n.clone(), v.clone())),
    );
    let stroked = attributes.get("stroke").is_some_and(|s| s != "none");
    let mut lengths = Vec::new();
    for name in LENGTHS {
        let value = attributes.remove(name);
        let default = (name == "stroke-width").then(|| "1".to_owned());
        let Some(text) = value.or(default).filter(|_| stroked) else { continue };
        let numbers: Vec<f64> = text.split([',', ' ']).filter_map(length).map(|v| v * scale).collect();
        if !numbers.is_empty() {
            lengths.push((name, numbers));
        }
    }
    MarkupPiece::Path(PaintedPath { path: path.clone(), attributes, lengths })
}

/// A length in user units; percentages have no meaning once the element has left its page.
fn length(text: &str) -> Option<f64> {
    let l = svgtypes::Length::from_str(text.trim()).ok()?;
    Some(l.number * unit_of(l.unit)?.pixels())
}

/// The path of a basic shape in its own coordinates; `None` for everything else.
fn path_of(node: roxmltree::Node<'_, '_>) -> Result<Option<BezPath>> {
    let number = |name: &str| node.attribute(name).and_then(length).unwrap_or(0.0);
    Ok(Some(match node.tag_name().name() {
        "path" => BezPath::from_svg(node.attribute("d").unwrap_or_default()).map_err(|e| broken(&e.to_string()))?,
        "rect" => rectangle(&number),
        "circle" => ellipse(number("cx"), number("cy"), number("r"), number("r")),
        "ellipse" => ellipse(number("cx"), number("cy"), number("rx"), number("ry")),
        "line" => {
            let mut path = BezPath::new();
            path.move_to((number("x1"), number("y1")));
            path.line_to((number("x2"), number("y2")));
            path
        }
        "polyline" => polygon(node, false),
        "polygon" => polygon(node, true),
        _ => return Ok(None),
    }))
}

fn rectangle(number: &impl Fn(&str) -> f64) -> BezPath {
    let (x, y, w, h) = (number("x"), number("y"), number("width"), number("height"));
    let (rx, ry) = (number("rx"), number("ry"));
    let rx = if rx > 0.0 { rx } else { ry };
    let ry = if ry > 0.0 { ry } else { rx };
    let rect = kurbo::Rect::new(x, y, x + w, y + h);
    if rx <= 0.0 || ry <= 0.0 {
        return rect.to_path(ARC_TOLERANCE);
    }
    // A corner with two radii is a round corner in a stretched frame.
    let stretch = ry / rx;
    let round = kurbo::Rect::new(x, y / stretch, x + w, (y + h) / stretch).to_rounded_rect(rx.min(0.5 * w));
    Affine::scale_non_uniform(1.0, stretch) * round.to_path(ARC_TOLERANCE * w.min(h))
}

fn ellipse(cx: f64, cy: f64, rx: f64, ry: f64) -> BezPath {
    kurbo::Ellipse::new((cx, cy), (rx, ry), 0.0).to_path(ARC_TOLERANCE * rx.max(ry).max(f64::MIN_POSITIVE))
}

fn polygon(node: roxmltree::Node<'_, '_>, closed: bool) -> BezPath {
    let mut path = BezPath::new();
    for (k, p) in svgtypes::PointsParser::from(node.attribute("points").unwrap_or_default()).enumerate() {
        if k == 0 { path.move_to(p) } else { path.line_to(p) }
    }
    if closed && !path.is_empty() {
        path.close_path();
    }
    path
}

/// A node as it stands in the file, without ids, under the transform and the paint that it had there.
fn whole(node: roxmltree::Node<'_, '_>, above: Affine, handed: &Attributes) -> String {
    let markup = without_ids(node);
    let paint: String = own_text(handed, |_| true);
    let m = above.as_coeffs();
    if above == Affine::IDENTITY && paint.is_empty() {
        return markup;
    }
    format!("<g transform=\"matrix({} {} {} {} {} {})\"{paint}>{markup}</g>", m[0], m[1], m[2], m[3], m[4], m[5])
}

fn without_ids(node: roxmltree::Node<'_, '_>) -> String {
    let text = node.document().input_text();
    let range = node.range();
    let mut out = String::new();
    let mut from = range.start;
    for inner in node.descendants() {
        for attribute in inner.attributes().filter(|a| a.name() == "id" && a.namespace().is_none()) {
            let cut = attribute.range();
            out.push_str(text.get(from..cut.start).unwrap_or_default().trim_end());
            from = cut.end;
        }
    }
    out.push_str(text.get(from..range.end).unwrap_or_default());
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn only_path(markup: &str) -> PaintedPath {
        match take_apart(markup).unwrap().as_slice() {
            [MarkupPiece::Path(p)] => p.clone(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn transforms_and_paint_are_handed_down() {
        let p = only_path(
            "<g transform=\"translate(10 0)\" fill=\"red\" style=\"stroke:#000\"><g transform=\"scale(2)\">\
             <rect id=\"r\" width=\"3\" height=\"1\" stroke-width=\"2\"/></g></g>",
        );
        assert_eq!(p.path.bounding_box(), kurbo::Rect::new(10.0, 0.0, 16.0, 2.0));
        assert_eq!(p.attributes["fill"], "red");
        assert_eq!(p.lengths, [("stroke-width", vec![4.0])]);
    }

    #[test]
    fn gradients_pictures_and_uneven_strokes_stay_whole() {
        for markup in [
            "<rect id=\"x\" width=\"1\" height=\"1\" fill=\"url(#g)\"/>",
            "<g fill=\"url(#g)\"><rect width=\"1\" height=\"1\"/></g>",
            "<image width=\"1\" height=\"1\"/>",
            "<path transform=\"scale(1 3)\" d=\"M0 0L1 1\" stroke=\"red\"/>",
        ] {
            let pieces = take_apart(markup).unwrap();
            assert!(matches!(&pieces[..], [MarkupPiece::Whole(text)] if !text.contains("id=")), "{markup}: {pieces:?}");
        }
    }

    #[test]
    fn group_opacity_stays_a_group() {
        let pieces = take_apart("<g opacity=\"0.5\"><circle r=\"1\"/></g>").unwrap();
        assert!(matches!(&pieces[..], [MarkupPiece::Open(_), MarkupPiece::Path(_), MarkupPiece::Close]));
    }
}
