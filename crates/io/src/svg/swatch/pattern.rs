//! `<pattern>` paint servers that fill the page: the period that they repeat.

use std::rc::Rc;

use arabesque_core::{Bounds, Error, Result};
use kurbo::{Affine, Rect, Shape};
use roxmltree::Node as Xml;
use svgtypes::Length;

use crate::svg::{
    parse::{
        guard,
        length::{self, Axis, Viewport},
        notes::Note,
        paint::{fraction, reference},
        scene::{Content, Node, build_definition},
        source::{Source, clip_text, href},
        style::{Own, Property},
    },
    shape::extent::bounds,
    swatch::cell::Cell,
};

/// Share of the frame that what a pattern fills covers at least, unless it is all that is drawn.
const COVER: f64 = 0.95;
/// Patterns that take what they lack from one another.
const CHAIN: usize = 32;

/// A pattern that fills the page.
#[derive(Debug)]
pub(crate) struct Painted {
    pub(crate) cell: Cell,
    /// What it repeats, with the transforms from their parents to the cell.
    pub(crate) roots: Vec<(Affine, Rc<Node>)>,
    /// What fills the page below it, with the transforms from their parents to the root.
    pub(crate) below: Vec<(Affine, Rc<Node>)>,
    /// How messages call it.
    pub(crate) name: String,
    /// Opacity of what it fills.
    pub(crate) opacity: f64,
}

/// A shape of the drawing.
struct Leaf {
    node: Rc<Node>,
    parent: Affine,
    opacity: f64,
    extent: Bounds<2>,
}

/// The pattern that fills the page, or all that is drawn; `None` where there is none.
///
/// # Errors
/// [`Error::Input`] for a pattern without size or content, or one that refers to itself.
pub(crate) fn painted(source: &Source<'_>, root: &Rc<Node>, frame: Option<Bounds<2>>) -> Result<Option<Painted>> {
    let mut leaves = Vec::new();
    shapes(root, Affine::IDENTITY, 1.0, &mut leaves);
    let is_cover = |leaf: &Leaf| {
        frame.is_none_or(|frame| {
            let low = leaf.extent.min.zip(frame.min, f64::max);
            let high = leaf.extent.max.zip(frame.max, f64::min);
            Bounds::new(low, high).measure() >= COVER * frame.measure() && low[0] < high[0] && low[1] < high[1]
        })
    };
    let Some((top, below)) = leaves.split_last() else { return Ok(None) };
    let Some((id, pattern)) = pattern_of(source, top) else { return Ok(None) };
    let is_page = below.iter().all(|leaf| is_cover(leaf) && pattern_of(source, leaf).is_none());
    if !is_page || !(below.is_empty() || is_cover(top)) {
        return Ok(None);
    }
    let server =
        Server { source, pattern, chain: chain(source, pattern)?, leaf: top, name: format!("pattern \"{id}\"") };
    let below = below.iter().map(|leaf| (leaf.parent, Rc::clone(&leaf.node))).collect();
    let (cell, content) = server.cell()?;
    let roots = vec![(content, server.content()?)];
    let opacity = top.opacity * fraction(top.node.style.get(Property::FillOpacity));
    Ok(Some(Painted { cell, roots, below, name: server.name, opacity }))
}

/// The shapes that can be seen, in painting order.
fn shapes(node: &Rc<Node>, parent: Affine, opacity: f64, all: &mut Vec<Leaf>) {
    let opacity = opacity * node.own.get("opacity").map_or(1.0, fraction);
    let extent = || bounds(node, parent);
    match &node.content {
        Content::Group(children) => {
            children.iter().for_each(|child| shapes(child, parent * node.transform, opacity, all));
        }
        Content::Shape(_) if opacity > 0.0 && !extent().is_empty() => {
            all.push(Leaf { node: Rc::clone(node), parent, opacity, extent: extent() });
        }
        Content::Shape(_) => {}
    }
}

/// The pattern that fills a shape, and its id.
fn pattern_of<'a>(source: &Source<'a>, leaf: &Leaf) -> Option<(String, Xml<'a, 'a>)> {
    let Ok((id, _)) = reference(leaf.node.style.get(Property::Fill))? else { return None };
    let pattern = source.by_id(id).filter(|node| node.tag_name().name() == "pattern")?;
    Some((clip_text(id, 40).to_owned(), pattern))
}

/// A pattern and those that it takes from what it lacks itself.
fn chain<'a>(source: &Source<'a>, pattern: Xml<'a, 'a>) -> Result<Vec<Xml<'a, 'a>>> {
    let mut chain = vec![pattern];
    while let Some(next) = chain.last().filter(|n| href(**n).is_some()).and_then(|n| source.target(*n)) {
        if chain.iter().any(|n| n.id() == next.id()) || chain.len() > CHAIN {
            let problem = "a pattern that refers to itself, by href";
            return Err(Error::input(source.place(pattern), problem, "remove one of the references"));
        }
        if next.tag_name().name() != "pattern" {
            break;
        }
        chain.push(next);
    }
    Ok(chain)
}

/// A pattern and what it fills.
struct Server<'a, 's, 'l> {
    source: &'s Source<'a>,
    pattern: Xml<'a, 'a>,
    chain: Vec<Xml<'a, 'a>>,
    leaf: &'l Leaf,
    name: String,
}

impl<'a> Server<'a, '_, '_> {
    fn attribute(&self, name: &str) -> Option<&'a str> {
        self.chain.iter().find_map(|n| n.attribute(name)).map(str::trim)
    }

    fn wrong(&self, problem: impl Into<String>, advice: &str) -> Error {
        Error::input(self.source.place(self.pattern), problem, advice)
    }

    /// The box around what is filled, strokes left out, in its own coordinates.
    fn filled(&self) -> Rect {
        match &self.leaf.node.content {
            Content::Shape(geometry) => geometry.path.bounding_box(),
            Content::Group(_) => Rect::ZERO,
        }
    }

    /// A length of the pattern: of the box around what is filled, or in user space.
    fn length(&self, name: &str, axis: Axis, in_box: bool) -> Result<f64> {
        let Some(text) = self.attribute(name) else { return Ok(0.0) };
        let length: Length = text
            .parse()
            .map_err(|_| self.wrong(format!("{name}=\"{}\" is not a length", clip_text(text, 40)), "write a number"))?;
        let unit = Viewport { width: 1.0, height: 1.0 };
        let value = if in_box { unit } else { self.leaf.node.viewport }.resolve(length, axis, 16.0);
        let filled = self.filled();
        let value = match (in_box, axis) {
            (false, _) => value,
            (true, Axis::X) => value * filled.width(),
            (true, _) => value * filled.height(),
        };
        Ok(value)
    }

    /// The cell, and the transform from the content to it.
    fn cell(&self) -> Result<(Cell, Affine)> {
        let in_box = self.attribute("patternUnits") != Some("userSpaceOnUse");
        let filled = self.filled();
        let base = if in_box { filled.origin().to_vec2() } else { kurbo::Vec2::ZERO };
        let (x, y) = (self.length("x", Axis::X, in_box)?, self.length("y", Axis::Y, in_box)?);
        let (w, h) = (self.length("width", Axis::X, in_box)?, self.length("height", Axis::Y, in_box)?);
        let least = self.source.limits.extent;
        let stated = |name| clip_text(self.attribute(name).unwrap_or("none"), 20).to_owned();
        if !(w > least && h > least && w.is_finite() && h.is_finite()) {
            let problem = format!("a pattern of no size: width {}, height {}", stated("width"), stated("height"));
            return Err(self.wrong(problem, "give it a positive width and height"));
        }
        let frame = Rect::from_origin_size((x + base.x, y + base.y), (w, h));
        let transform = match self.attribute("patternTransform") {
            Some(text) => self.transform(text)?,
            None => Affine::IDENTITY,
        };
        let to_root = self.leaf.parent * self.leaf.node.transform * transform;
        let [a, b, c, d, ..] = to_root.as_coeffs();
        let most = self.source.limits.coordinate;
        let corners = to_root.transform_rect_bbox(frame);
        let reaches = [corners.x0, corners.y0, corners.x1, corners.y1].iter().all(|v| v.abs() <= most);
        let is_sound = to_root.determinant().abs() > 1e-9 * (a * a + b * b + c * c + d * d) && reaches;
        if !is_sound {
            let problem = "a pattern whose transform leaves nothing of it, or moves it far away";
            return Err(self.wrong(problem, "correct its patternTransform"));
        }
        Ok((Cell { frame, to_root }, self.to_cell(frame)?))
    }

    fn transform(&self, text: &str) -> Result<Affine> {
        match text.parse::<svgtypes::Transform>() {
            Ok(t) => Ok(Affine::new([t.a, t.b, t.c, t.d, t.e, t.f])),
            Err(_) if matches!(text, "" | "none") => Ok(Affine::IDENTITY),
            Err(_) => {
                self.source.notes.add(Note::Transform, || clip_text(text, 40).to_owned());
                Ok(Affine::IDENTITY)
            }
        }
    }

    /// From the content to the cell: x and y are where the content has its origin, whatever its units are.
    fn to_cell(&self, frame: Rect) -> Result<Affine> {
        let origin = Affine::translate(frame.origin().to_vec2());
        if let Some(with_box) = self.chain.iter().find(|n| n.attribute("viewBox").is_some()) {
            let fit = length::fit(self.source, *with_box, frame.width(), frame.height())?;
            let shift = Affine::translate(kurbo::Vec2::new(fit.shift[0], fit.shift[1]));
            return Ok(origin * shift * Affine::scale_non_uniform(fit.scale[0], fit.scale[1]));
        }
        if self.attribute("patternContentUnits") == Some("objectBoundingBox") {
            let filled = self.filled();
            return Ok(origin * Affine::scale_non_uniform(filled.width(), filled.height()));
        }
        Ok(origin)
    }

    fn content(&self) -> Result<Rc<Node>> {
        let with_content = self.chain.iter().find(|n| n.children().any(|c| c.is_element()));
        let nothing = || self.wrong("a pattern that draws nothing", "draw something in it");
        let with_content = *with_content.ok_or_else(nothing)?;
        let node = build_definition(self.source, with_content, self.leaf.node.viewport)?.ok_or_else(nothing)?;
        let mut leaves = Vec::new();
        shapes(&node, Affine::IDENTITY, 1.0, &mut leaves);
        if leaves.is_empty() {
            return Err(nothing());
        }
        for leaf in &leaves {
            self.refuse_cycle(leaf)?;
        }
        let mut node = (*node).clone();
        node.own = Own::default();
        Ok(Rc::new(node))
    }

    /// Refuses what is filled with the pattern that it is in.
    fn refuse_cycle(&self, leaf: &Leaf) -> Result<()> {
        let mut inside = vec![self.pattern.id()];
        let mut next = pattern_of(self.source, leaf).map(|(_, pattern)| pattern);
        while let Some(pattern) = next {
            if inside.contains(&pattern.id()) {
                let problem = "a pattern that fills something in itself";
                return Err(self.wrong(problem, "fill what is in the pattern with plain colours"));
            }
            if inside.len() > CHAIN {
                let what = format!("{}: patterns within patterns", self.source.name);
                return Err(guard::too_much(what, inside.len(), CHAIN as u64));
            }
            inside.push(pattern.id());
            let filled = pattern.descendants().filter_map(|n| n.attribute("fill").and_then(reference));
            let inner = filled.filter_map(|found| found.ok()).filter_map(|(id, _)| self.source.by_id(id));
            next = { inner }.find(|n| n.tag_name().name() == "pattern");
        }
        Ok(())
    }
}
