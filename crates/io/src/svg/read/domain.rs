//! Shapes that say where to fill and where not.

use std::rc::Rc;

use arabesque_core::{Bounds, Error, FillRule, Outline, Result, Shape};
use kurbo::{Affine, BezPath};

use crate::{
    svg::{
        drawing::Page,
        options::ReadOptions,
        parse::{
            meta::Part,
            notes::Note,
            scene::{Content, Node},
            style::Property as P,
        },
        read::document::{Document, Opened, by_id, parts},
        shape::{
            flatten::{self, flattened},
            painted_area::Painter,
            subpath::is_closed,
        },
    },
    text::{short::list, unit::Unit},
};

/// Reads an area from a text of which nothing else is read.
///
/// # Errors
/// As for [`Document::with`] and [`Document::shape`].
pub fn read_shape(text: &str, id: Option<&str>, options: &ReadOptions) -> Result<(Shape, Page)> {
    Document::with(text, options, |document| document.shape(id))
}

impl Document<'_> {
    /// Reads the area enclosed by all shapes of the file (of its layer "Domain" where it has one), or by the item with
    /// the given id.
    ///
    /// Stroke widths do not count. A shape without fill encloses by the even-odd rule, any other by its own rule. Where
    /// one shape covers the whole page and others do not, it is taken for a background.
    ///
    /// # Errors
    /// [`Error::Input`] when the text is not usable SVG, nothing has that id, a line is open, or no area is enclosed;
    /// [`Error::Limit`] when the file is too large.
    pub fn shape(&self, id: Option<&str>) -> Result<(Shape, Page)> {
        let Opened { source, root, page, .. } = self.open()?;
        let source = &source;
        let painter = Painter::new(source);
        let layers = parts(&root, Part::Domain);
        let (place, nodes) = match id {
            Some(id) => (format!("{}#{id}", source.name), vec![by_id(source, &root, id)?]),
            None if !layers.is_empty() => (format!("{}: layer \"Domain\"", source.name), layers),
            None => (source.name.to_owned(), vec![(Affine::IDENTITY, Rc::clone(&root))]),
        };
        let frame = page.filter(|_| id.is_none()).map(|p| p.view);
        let shape = shape(&painter, &place, &nodes, frame)?;
        let view = page.unwrap_or(Page { view: shape.outline().bounds(), unit: Unit::Px, unit_per_user: 1.0 });
        Ok((shape, view))
    }
}

/// A path with the transform to the root and the rule by which it encloses area.
struct DomainPath {
    path: BezPath,
    rule: FillRule,
    clip: Option<Outline<2>>,
    is_open: bool,
    name: String,
}

/// The area that all shapes in some nodes enclose, `place` for messages; what covers the `frame` is left out where
/// there are others.
pub(crate) fn shape(
    painter: &Painter<'_, '_>,
    place: &str,
    nodes: &[(Affine, Rc<Node>)],
    frame: Option<Bounds<2>>,
) -> Result<Shape> {
    let budget = painter.source.budget;
    let mut borders = Vec::new();
    for (parent, node) in nodes {
        collect(painter, node, *parent, None, &mut borders)?;
    }
    let mut areas = Vec::new();
    let mut open = Vec::new();
    for border in &borders {
        if border.is_open {
            open.push(border.name.as_str());
            continue;
        }
        let area = flatten::filled_finely(&border.path, border.rule, budget)?;
        areas.push(match &border.clip {
            Some(clip) => area.try_intersection(clip, budget)?,
            None => area,
        });
    }
    areas.retain(|a| !a.rings.is_empty());
    leave_background(painter, &mut areas, frame);
    let rings: Vec<_> = areas.iter().flat_map(|a| a.rings.iter().cloned()).collect();
    if let Some(shape) = Shape::try_new(&rings, FillRule::NonZero, budget)? {
        return Ok(shape);
    }
    if open.is_empty() {
        return Err(Error::input(place, "no shape with an area found", "draw a closed shape"));
    }
    let problem = format!("the outline is open ({}), expected a closed shape", list(&open));
    Err(Error::input(place, problem, "close the path: join its end to its start"))
}

/// Drops shapes that cover the page where there are others.
fn leave_background(painter: &Painter<'_, '_>, areas: &mut Vec<Outline<2>>, frame: Option<Bounds<2>>) {
    let Some(frame) = frame else { return };
    let covers = |a: &Outline<2>| a.area() >= 0.95 * frame.measure() && a.bounds().grown(0.05).contains(frame.centre());
    if areas.iter().any(|a| !covers(a)) && areas.iter().any(covers) {
        areas.retain(|a| !covers(a));
        painter.source.notes.add(Note::DomainBackground, String::new);
    }
}

fn collect(
    painter: &Painter<'_, '_>,
    node: &Node,
    parent: Affine,
    clip: Option<&Outline<2>>,
    borders: &mut Vec<DomainPath>,
) -> Result<()> {
    let world = parent * node.transform;
    let own = painter.clip(node, world)?;
    let both = match (clip, own) {
        (Some(a), Some(b)) => Some(a.try_intersection(&b, painter.source.budget)?),
        (a, b) => b.or_else(|| a.cloned()),
    };
    if let Content::Shape(geometry) = &node.content {
        painter.check(node, geometry, world)?;
        let path = world * geometry.path.clone();
        let is_filled = node.style.get(P::Fill) != "none";
        let rule = if is_filled { flatten::fill_rule(node.style.get(P::FillRule)) } else { FillRule::EvenOdd };
        let name = node.meta.label.clone().or_else(|| node.meta.id.clone()).unwrap_or_else(|| node.meta.tag.to_owned());
        let is_open = !is_filled && !path.subpaths().any(is_nearly_closed);
        borders.push(DomainPath { path, rule, clip: both.clone(), is_open, name });
    }
    node.children().iter().try_for_each(|child| collect(painter, child, world, both.as_ref(), borders))
}

/// Whether a subpath ends at its start, or so near that it was meant to.
fn is_nearly_closed(elements: &[kurbo::PathEl]) -> bool {
    let ends = (elements.first().and_then(|e| e.end_point()), elements.last().and_then(|e| e.end_point()));
    let points = flattened(elements);
    let size = Bounds::around(points).size().norm();
    is_closed(elements) || matches!(ends, (Some(a), Some(b)) if elements.len() > 2 && a.distance(b) <= 1e-3 * size)
}
