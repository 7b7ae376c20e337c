//! What of a drawing is an element, what a curve, what background.
//!
//! - Filled shapes, groups, `<use>` and filled pieces smaller than half of the frame are elements.
//! - Strokes without a fill, each subpath by itself, are sorted by what they are joined to: a net that runs through, or
//!   a thing of their own (`parts::components`). A stroke of no length is a dot.
//! - Layers, groups that cover half of the frame, groups of several things far apart, and rows of things across the frame
//!   (`parts::rows`) are containers: their content is looked at.
//! - A compound path is taken apart into connected pieces unless it is small and its pieces lie close together
//!   (a paw print); pieces in the holes of another piece stay with it, and pieces of the same colour that abut are
//!   joined again.
//! - A fill that covers the frame is background; a stroke along the frame is left out, and so is what lies under
//!   something opaque (`parts::hidden`).
//! - `data-arabesque` on an item overrides all this.

use std::rc::Rc;

use arabesque_core::{Bounds, Budget, DisjointSets, FillRule, Outline, Result, ring};
use kurbo::Affine;
use roxmltree::NodeId;

use crate::svg::{
    options::{LargeFills, Method, Parts},
    parse::{
        geometry::{self, Geometry, Painted},
        guard,
        meta::{Mark, Part},
        notes::Note,
        paint::fraction,
        scene::{Content, Node},
        style::Property as P,
    },
    reason::Reason,
    shape::{
        extent::{SoleShape, bounds, clusters, longer, sole_shape},
        flatten,
        painted_area::Painter,
        subpath::{has_no_length, is_all_closed},
    },
    understand::{
        compound::Compound,
        item::{HALF, Item, Kind, Origin, Selection, size_of_fill},
        join::join,
        parts::{alike::put_alike_together, components::sort_strokes, hidden::drop_hidden, rows::rows},
        surroundings::Surroundings,
    },
};

/// Share of the frame from which on a group of distant things is a container.
const ROOMY: f64 = 0.1;
/// Widest gap inside one thing, as a share of the smaller neighbour.
const GAP: f64 = 0.4;
/// Share of the frame that a background covers at least.
const COVER: f64 = 0.95;

/// Items that may become one element, in the mean.
const PIECES: usize = 4;

/// Work for the box around a node: for each of its nodes and segments.
fn weight(node: &Node) -> u64 {
    match &node.content {
        Content::Group(children) => children.iter().map(|child| weight(child)).sum::<u64>() + 20,
        Content::Shape(geometry) => 20 + 10 * geometry.path.elements().len() as u64,
    }
}

/// What is marked by hand, or says that arabesque made it.
const MARKED_ELEMENT: (Kind, Origin, Reason) = (Kind::Element, Origin::Whole, Reason::MarkedElement);
const MARKED_CURVE: (Kind, Origin, Reason) = (Kind::Curve, Origin::Stroke, Reason::MarkedCurve);

/// Walks the drawing.
struct Selector<'a, 's, 'i> {
    painter: &'i Painter<'a, 's>,
    frame: Bounds<2>,
    method: Method,
    /// Groups to be opened whatever they look like.
    opened: Vec<NodeId>,
    found: Selection,
}

/// What the roots hold. A single group that is all there is gets opened when it holds several separate things.
pub(crate) fn select(
    painter: &Painter<'_, '_>,
    frame: Bounds<2>,
    (method, parts, large_fills): (Method, Parts, LargeFills),
    roots: &[(Surroundings, Rc<Node>)],
) -> Result<Selection> {
    let mut opened: Vec<NodeId> = Vec::new();
    loop {
        let mut selector = Selector { painter, frame, method, opened: opened.clone(), found: Selection::default() };
        for (context, root) in roots {
            selector.open(root, context)?;
        }
        let lonely = match selector.found.items.as_slice() {
            [one] if one.origin == Origin::Whole && one.meta.mark.is_none() && one.meta.tag != "use" => Some(one),
            _ => None,
        };
        let spread = match lonely {
            Some(one) if is_spread(&one.parts, painter.source.budget)? => Some(one.meta.xml),
            _ => None,
        };
        match spread {
            Some(id) if !opened.contains(&id) => opened.push(id),
            _ => {
                let mut found = selector.found;
                if method == Method::Auto {
                    found.items = sort_strokes(found.items, painter, frame)?;
                }
                drop_hidden(&mut found, painter.source)?;
                let mut found = join(found, painter, frame, (method, large_fills))?;
                if parts == Parts::Together && method != Method::Curves {
                    found.items = put_alike_together(found.items, painter, frame)?;
                }
                return Ok(found);
            }
        }
    }
}

/// Whether a node draws strokes without fills, and nothing else.
fn is_all_strokes(node: &Node) -> bool {
    match &node.content {
        Content::Group(children) => children.iter().all(|child| is_all_strokes(child)),
        Content::Shape(geometry) => geometry.paint == Painted::Style && !is_filled(node, geometry),
    }
}

fn is_spread(parts: &[(Affine, Rc<Node>)], budget: &Budget) -> Result<bool> {
    let boxes = parts.iter().flat_map(|(parent, node)| {
        let world = *parent * node.transform;
        node.children().iter().map(move |child| bounds(child, world))
    });
    Ok(clusters(&boxes.collect::<Vec<_>>(), GAP, budget)? > 1)
}

impl Selector<'_, '_, '_> {
    fn share(&self, b: &Bounds<2>) -> f64 {
        b.measure() / self.frame.measure()
    }

    /// Looks at the content of a container.
    fn open(&mut self, node: &Rc<Node>, at: &Surroundings) -> Result<()> {
        let world = at.parent * node.transform;
        let clip = self.painter.clip(node, world)?;
        let clip = match (&at.clip, clip) {
            (Some(a), Some(b)) => Some(Rc::new(a.try_intersection(&b, self.painter.source.budget)?)),
            (a, b) => b.map(Rc::new).or_else(|| a.clone()),
        };
        let opacity = at.opacity * node.own.get("opacity").map_or(1.0, fraction);
        if opacity == 0.0 {
            return Ok(());
        }
        if geometry::is_shape(node.meta.tag) {
            // A shape that holds others has markers.
            self.painter.source.notes.add(Note::Marker, || node.meta.id.clone().unwrap_or_default());
        }
        if node.own.get("opacity").is_some_and(|o| fraction(o) < 1.0) && self.overlaps(node, world)? {
            self.painter.source.notes.add(Note::ContainerOpacity, || node.meta.id.clone().unwrap_or_default());
        }
        if node.own.has_effects() {
            self.painter.source.notes.add(Note::ContainerEffect, || node.meta.id.clone().unwrap_or_default());
        }
        let name = node.meta.label.as_ref().or(node.meta.id.as_ref());
        let layer = if node.meta.is_layer { name.map(|l| l.as_str().into()) } else { at.layer.clone() };
        let mark = node.meta.mark.or(at.mark);
        let inside = Surroundings { parent: world, layer, opacity, clip, mark, without: Rc::clone(&at.without) };
        let rows = rows(node.children(), &inside, &self.frame, self.painter.source.budget)?;
        node.children().iter().zip(rows).try_for_each(|(child, is_row)| self.visit(child, &inside, is_row))
    }

    /// Looks at one thing in a container, which may be a row of things.
    fn visit(&mut self, node: &Rc<Node>, at: &Surroundings, is_row: bool) -> Result<()> {
        let meta = &node.meta;
        if matches!(meta.part, Some(part) if part != Part::Exemplar) || at.excludes(meta) {
            return Ok(());
        }
        if meta.is_layer || self.opened.contains(&meta.xml) {
            return if meta.mark == Some(Mark::Ignore) { Ok(()) } else { self.open(node, at) };
        }
        match meta.mark.or(at.mark) {
            Some(Mark::Ignore) => return Ok(()),
            Some(Mark::Element) => return self.take(node, at, MARKED_ELEMENT),
            Some(Mark::Curve) => return self.take(node, at, MARKED_CURVE),
            None if meta.source.is_some() => return self.take(node, at, MARKED_ELEMENT),
            None => {}
        }
        if let (Some(only), true) = (sole_shape(node, at.parent), meta.tag != "use") {
            return self.shape(node, &only, at);
        }
        let extent = self.visible(node, at)?;
        if extent.is_empty() {
            return Ok(());
        }
        if self.method == Method::Curves && is_all_strokes(node) {
            return self.open(node, at);
        }
        if is_row || self.is_container(node, &extent, at)? {
            return self.open(node, at);
        }
        self.take(node, at, (Kind::Element, Origin::Whole, Reason::Group))
    }

    /// Whether things in a container lie on one another.
    fn overlaps(&self, node: &Node, world: Affine) -> Result<bool> {
        let boxes: Vec<_> =
            node.children().iter().map(|child| bounds(child, world)).filter(|b| !b.is_empty()).collect();
        Ok(clusters(&boxes, 0.0, self.painter.source.budget)? < boxes.len())
    }

    /// Box around what the clips leave of a node.
    fn visible(&self, node: &Node, at: &Surroundings) -> Result<Bounds<2>> {
        self.painter.source.budget.spend(weight(node))?;
        let mut extent = bounds(node, at.parent);
        if let Some(clip) = self.painter.clip(node, at.parent * node.transform)? {
            let clip = clip.bounds();
            extent = Bounds::new(extent.min.zip(clip.min, f64::max), extent.max.zip(clip.max, f64::min));
        }
        Ok(extent)
    }

    fn is_container(&self, node: &Rc<Node>, extent: &Bounds<2>, at: &Surroundings) -> Result<bool> {
        let share = self.share(extent);
        if share >= HALF || self.is_marked_line(node, extent) {
            return Ok(true);
        }
        if node.meta.tag == "use" || share < ROOMY {
            return Ok(false);
        }
        let world = at.parent * node.transform;
        let boxes: Vec<_> = node.children().iter().map(|child| bounds(child, world)).collect();
        Ok(clusters(&boxes, GAP, self.painter.source.budget)? >= 4)
    }

    /// Whether a node is a stroke with markers that runs through half of the frame: it is continued, and its markers are things beside it.
    fn is_marked_line(&self, node: &Node, extent: &Bounds<2>) -> bool {
        let line = node.children().first().filter(|_| geometry::is_shape(node.meta.tag));
        let is_open = line.is_some_and(|line| is_all_strokes(line));
        is_open && (0..2).any(|k| extent.size()[k] >= HALF * self.frame.size()[k])
    }

    /// Takes a node as a whole.
    fn take(&mut self, node: &Rc<Node>, at: &Surroundings, taken: (Kind, Origin, Reason)) -> Result<()> {
        self.found.items.extend(Item::taken(self.painter, node, at, taken)?);
        self.check_count()
    }

    /// Refuses so many items that joining them will not help.
    fn check_count(&self) -> Result<()> {
        let (found, source) = (self.found.items.len(), self.painter.source);
        if found <= PIECES * source.limits.elements {
            return Ok(());
        }
        let what = format!("{}: elements", source.name);
        Err(guard::over(what, found, ("elements", source.limits.elements)))
    }

    /// Decides about a node that is, or wraps, a single shape.
    fn shape(&mut self, node: &Rc<Node>, only: &SoleShape<'_>, at: &Surroundings) -> Result<()> {
        let leaf = only.leaf;
        let Content::Shape(geometry) = &leaf.content else { return Ok(()) };
        let extent = self.visible(node, at)?;
        let filled = geometry.paint == Painted::Picture || is_filled(leaf, geometry);
        if filled && self.covers_frame(node, &extent, at)? {
            self.found.background.push((at.parent, Rc::clone(node)));
            return self.left_out(Reason::Background, node, at);
        }
        if !filled {
            return self.stroke(node, only, at);
        }
        let compound = match geometry.paint {
            Painted::Style => Compound::new(self.painter, node, only, at)?.map(Rc::new),
            Painted::Picture => None,
        };
        if let Some(compound) = &compound
            && !self.is_compact(compound)?
        {
            return self.split(compound);
        }
        let (kind, reason) = size_of_fill(self.share(&extent), Reason::Fill);
        let whole = Item::taken(self.painter, node, at, (kind, Origin::Fill, reason))?;
        self.found.items.extend(whole.map(|item| Item { compound: compound.map(Compound::all), ..item }));
        self.check_count()
    }

    /// Takes a shape that has no fill, subpath by subpath unless these are one small thing.
    fn stroke(&mut self, node: &Rc<Node>, only: &SoleShape<'_>, at: &Surroundings) -> Result<()> {
        let is_curve = node.meta.curve.or(only.leaf.meta.curve).is_some();
        let compound = match self.method {
            Method::Curves => None,
            _ if is_curve || !only.leaf.style.strokes() => None,
            _ => Compound::of_stroke(self.painter, node, only, at)?,
        };
        let Some(compound) = compound else { return self.line(node, only, at, is_curve) };
        if self.is_compact(&compound)? {
            return self.line(node, only, at, is_curve);
        }
        compound.note_losses(self.painter);
        for k in 0..compound.pieces.len() {
            let piece = Rc::new(compound.node(&[k]));
            let only = SoleShape { leaf: &piece, parent: compound.context.parent };
            self.line(&piece, &only, &compound.context, false)?;
        }
        Ok(())
    }

    /// Takes a stroke that is not taken apart.
    fn line(&mut self, node: &Rc<Node>, only: &SoleShape<'_>, at: &Surroundings, is_curve: bool) -> Result<()> {
        let Content::Shape(geometry) = &only.leaf.content else { return Ok(()) };
        if is_curve {
            return self.take(node, at, MARKED_CURVE);
        }
        if has_no_length(&geometry.path) && only.leaf.style.strokes() {
            if only.leaf.style.get(P::StrokeLinecap) == "butt" {
                self.painter.source.notes.add(Note::ZeroLength, || node.meta.id.clone().unwrap_or_default());
                return Ok(());
            }
            return self.take(node, at, (Kind::Element, Origin::Stroke, Reason::Dot));
        }
        let world = only.parent * only.leaf.transform;
        if is_all_closed(&geometry.path) && self.is_frame(only.leaf, geometry, world)? {
            self.painter.source.notes.add(Note::Border, || node.meta.id.clone().unwrap_or_default());
            self.left_out(Reason::Border, node, at)?;
            return Ok(());
        }
        let taken = match self.method {
            Method::Curves => (Kind::Curve, Origin::Stroke, Reason::Asked),
            _ => (Kind::Element, Origin::Stroke, Reason::Stroke),
        };
        self.take(node, at, taken)
    }

    /// Remembers what is no part of the pattern.
    fn left_out(&mut self, reason: Reason, node: &Rc<Node>, at: &Surroundings) -> Result<()> {
        let outline = self.painter.painted(node, at.parent)?.outline(self.painter.source.budget)?;
        let name = node.meta.label.as_ref().or(node.meta.id.as_ref()).cloned().unwrap_or_default();
        self.found.left_out.push((reason, name, outline));
        Ok(())
    }

    /// Whether a stroke encloses nearly the whole frame and hardly more.
    fn is_frame(&self, leaf: &Node, geometry: &Geometry, world: Affine) -> Result<bool> {
        let extent = bounds(leaf, world * leaf.transform.inverse());
        let near = 0.04 * longer(&self.frame);
        let close = |a: f64, b: f64| (a - b).abs() < near;
        let along = (0..2).all(|k| close(extent.min[k], self.frame.min[k]) && close(extent.max[k], self.frame.max[k]));
        let budget = self.painter.source.budget;
        let area = || Ok(flatten::filled(&geometry.path, world, FillRule::NonZero, budget)?.area());
        Ok(along && area()? >= 0.85 * self.frame.measure())
    }

    fn covers_frame(&self, node: &Rc<Node>, extent: &Bounds<2>, at: &Surroundings) -> Result<bool> {
        let low = extent.min.zip(self.frame.min, f64::max);
        let high = extent.max.zip(self.frame.max, f64::min);
        let common = Bounds::new(low, high);
        if common.measure() < COVER * self.frame.measure() {
            return Ok(false);
        }
        let (a, b) = (self.frame.min, self.frame.max);
        let corners = vec![a, arabesque_core::Vector::xy(b[0], a[1]), b, arabesque_core::Vector::xy(a[0], b[1])];
        let budget = self.painter.source.budget;
        let painted = self.painter.painted(node, at.parent)?.outline(budget)?;
        let outline = painted.try_intersection(&Outline { rings: vec![corners] }, budget)?;
        Ok(outline.area() >= COVER * self.frame.measure())
    }

    /// Takes the pieces of a compound path, those in the hole of another with it.
    fn split(&mut self, compound: &Rc<Compound>) -> Result<()> {
        compound.note_losses(self.painter);
        let mut sets = DisjointSets::new(compound.pieces.len());
        for (k, p) in compound.pieces.iter().enumerate() {
            if let Some(home) = p.within.filter(|&home| self.share(&compound.boxes[home]) < HALF) {
                sets.join(k, home);
            }
        }
        for group in sets.groups() {
            self.found.items.extend(Item::of_pieces(compound, self.painter, group, self.frame)?);
            self.check_count()?;
        }
        Ok(())
    }

    fn is_compact(&self, compound: &Compound) -> Result<bool> {
        let all = compound.boxes.iter().fold(Bounds::EMPTY, |all, b| all.union(b));
        Ok(self.share(&all) < ROOMY && clusters(&compound.boxes, GAP, self.painter.source.budget)? == 1)
    }
}

/// Whether a fill covers more than a line.
fn is_filled(leaf: &Node, geometry: &Geometry) -> bool {
    if !leaf.style.fills() {
        return false;
    }
    let extent = geometry.path.control_box();
    let rings = flatten::rings(&geometry.path);
    let area: f64 = rings.iter().map(|r| ring::area(r).abs()).sum();
    area > 1e-9 * (extent.width() + extent.height()).powi(2)
}
