//! What of a drawing is an element, what a curve, what background.
//!
//! - Filled shapes, groups, `<use>` and filled pieces smaller than half of the frame are elements.
//! - A stroke without a fill is a curve where it is open, or larger than half of the frame. Where the drawing holds any such curve, its
//!   closed strokes outside groups are curves too, for they belong to the same net; else they are elements.
//! - Layers, groups that cover half of the frame, and groups of several things far apart are containers: their content is looked at.
//! - A filled compound path is taken apart into connected pieces unless it is small and its pieces lie close together (a paw print);
//!   pieces in the holes of another piece stay with it, and pieces of the same colour that abut are joined again.
//! - A fill that covers the frame is background; a stroke along the frame is left out.
//! - `data-arabesque` on an item overrides all this.

use std::rc::Rc;

use arabesque_core::{Bounds, FillRule, Outline, Result};
use kurbo::Affine;
use roxmltree::NodeId;

use super::{
    Method,
    curves::is_all_closed,
    extent::{bounds, clusters, longer, sole_shape},
    flatten,
    geometry::{Geometry, Painted},
    ink::Inker,
    item::{Item, Kind, Origin, Selection},
    meta::{Mark, Meta, Part},
    notes::Note,
    paint::fraction,
    pieces,
    scene::{Content, Node},
    style::{Own, Property as P},
};

/// Share of the frame from which on something is too large for an element.
const HALF: f64 = 0.5;
/// Share of the frame from which on a group of distant things is a container.
const ROOMY: f64 = 0.1;
/// Widest gap inside one thing, as a share of the smaller neighbour.
const GAP: f64 = 0.4;
/// Share of the frame that a background covers at least.
const COVER: f64 = 0.95;

/// What holds for everything inside a container.
#[derive(Clone)]
pub(super) struct Context {
    pub(super) parent: Affine,
    pub(super) layer: Option<Rc<str>>,
    opacity: f64,
    clip: Option<Rc<Outline<2>>>,
    mark: Option<Mark>,
    without: Rc<[String]>,
}

impl Context {
    /// Nothing but the transform from the parent to the root.
    pub(super) fn new(parent: Affine) -> Self {
        Self { parent, layer: None, opacity: 1.0, clip: None, mark: None, without: Rc::default() }
    }

    /// The same, but for the items of those names.
    pub(super) fn without(self, names: &[String]) -> Self {
        Self { without: names.into(), ..self }
    }
}

impl Context {
    fn excludes(&self, meta: &Meta) -> bool {
        let named = |name: &Option<String>| name.as_ref().is_some_and(|name| self.without.contains(name));
        named(&meta.id) || named(&meta.label)
    }
}

/// Walks the drawing.
struct Selector<'a, 's, 'i> {
    inker: &'i Inker<'a, 's>,
    frame: Bounds<2>,
    method: Method,
    /// Groups to be opened whatever they look like.
    opened: Vec<NodeId>,
    found: Selection,
}

/// What the roots hold. A single group that is all there is gets opened when it holds several separate things.
pub(super) fn select(
    inker: &Inker<'_, '_>,
    frame: Bounds<2>,
    method: Method,
    roots: &[(Context, Rc<Node>)],
) -> Result<Selection> {
    let mut opened: Vec<NodeId> = Vec::new();
    loop {
        let mut selector = Selector { inker, frame, method, opened: opened.clone(), found: Selection::default() };
        for (context, root) in roots {
            selector.open(root, context)?;
        }
        let lonely = match selector.found.items.as_slice() {
            [one] if one.origin == Origin::Whole && one.meta.mark.is_none() && one.meta.tag != "use" => Some(one),
            _ => None,
        };
        match lonely.filter(|one| is_spread(&one.parts)).map(|one| one.meta.xml) {
            Some(id) if !opened.contains(&id) => opened.push(id),
            _ => {
                if method == Method::Auto {
                    promote(&mut selector.found.items);
                }
                return super::join::join(selector.found, inker, frame, method);
            }
        }
    }
}

/// Makes closed strokes curves where there are others.
fn promote(items: &mut [Item]) {
    if items.iter().any(|item| item.kind == Kind::Curve) {
        items.iter_mut().filter(|item| item.origin == Origin::Stroke).for_each(|item| item.kind = Kind::Curve);
    }
}

/// Whether a node draws strokes without fills, and nothing else.
fn is_all_strokes(node: &Node) -> bool {
    match &node.content {
        Content::Group(children) => children.iter().all(|child| is_all_strokes(child)),
        Content::Shape(geometry) => geometry.paint == Painted::Style && !is_filled(node, geometry),
    }
}

fn is_spread(parts: &[(Affine, Rc<Node>)]) -> bool {
    let boxes = parts.iter().flat_map(|(parent, node)| {
        let world = *parent * node.transform;
        node.children().iter().map(move |child| bounds(child, world))
    });
    clusters(&boxes.collect::<Vec<_>>(), GAP) > 1
}

impl Selector<'_, '_, '_> {
    fn share(&self, b: &Bounds<2>) -> f64 {
        b.measure() / self.frame.measure()
    }

    /// Looks at the content of a container.
    fn open(&mut self, node: &Rc<Node>, at: &Context) -> Result<()> {
        let world = at.parent * node.transform;
        let clip = self.inker.clip(node, world)?;
        let clip = match (&at.clip, clip) {
            (Some(a), Some(b)) => Some(Rc::new(a.intersection(&b))),
            (a, b) => b.map(Rc::new).or_else(|| a.clone()),
        };
        let opacity = at.opacity * node.own.get("opacity").map_or(1.0, fraction);
        if opacity == 0.0 {
            return Ok(());
        }
        self.note_effects(&node.own, &node.meta);
        let name = node.meta.label.as_ref().or(node.meta.id.as_ref());
        let layer = if node.meta.is_layer { name.map(|l| l.as_str().into()) } else { at.layer.clone() };
        let mark = node.meta.mark.or(at.mark);
        let inside = Context { parent: world, layer, opacity, clip, mark, without: Rc::clone(&at.without) };
        node.children().iter().try_for_each(|child| self.visit(child, &inside))
    }

    fn note_effects(&self, own: &Own, meta: &Meta) {
        if ["mask", "filter", "mix-blend-mode"].iter().any(|e| own.get(e).is_some_and(|v| v != "none" && v != "normal"))
        {
            self.inker.source.notes.add(Note::ContainerEffect, || meta.id.clone().unwrap_or_default());
        }
    }

    fn visit(&mut self, node: &Rc<Node>, at: &Context) -> Result<()> {
        let meta = &node.meta;
        if matches!(meta.part, Some(part) if part != Part::Exemplar) || at.excludes(meta) {
            return Ok(());
        }
        if meta.is_layer || self.opened.contains(&meta.xml) {
            return if meta.mark == Some(Mark::Ignore) { Ok(()) } else { self.open(node, at) };
        }
        match meta.mark.or(at.mark) {
            Some(Mark::Ignore) => return Ok(()),
            Some(Mark::Element) => return self.take(node, at, Kind::Element, Origin::Whole),
            Some(Mark::Curve) => return self.take(node, at, Kind::Curve, Origin::Stroke),
            None if meta.source.is_some() => return self.take(node, at, Kind::Element, Origin::Whole),
            None => {}
        }
        if let (Some((leaf, parent)), true) = (sole_shape(node, at.parent), meta.tag != "use") {
            return self.shape(node, leaf, parent, at);
        }
        let extent = self.visible(node, at)?;
        if extent.is_empty() {
            return Ok(());
        }
        if self.method == Method::Curves && is_all_strokes(node) {
            return self.open(node, at);
        }
        if self.is_container(node, &extent, at) {
            return self.open(node, at);
        }
        self.take(node, at, Kind::Element, Origin::Whole)
    }

    /// Box around what the clips leave of a node.
    fn visible(&self, node: &Node, at: &Context) -> Result<Bounds<2>> {
        let mut extent = bounds(node, at.parent);
        if let Some(clip) = self.inker.clip(node, at.parent * node.transform)? {
            let clip = clip.bounds();
            extent = Bounds::new(extent.min.zip(clip.min, f64::max), extent.max.zip(clip.max, f64::min));
        }
        Ok(extent)
    }

    fn is_container(&self, node: &Rc<Node>, extent: &Bounds<2>, at: &Context) -> bool {
        let share = self.share(extent);
        if share >= HALF {
            return true;
        }
        if node.meta.tag == "use" || share < ROOMY {
            return false;
        }
        let world = at.parent * node.transform;
        let boxes: Vec<_> = node.children().iter().map(|child| bounds(child, world)).collect();
        clusters(&boxes, GAP) >= 4
    }

    /// Takes a node as a whole.
    fn take(&mut self, node: &Rc<Node>, at: &Context, kind: Kind, origin: Origin) -> Result<()> {
        let item = Item {
            parts: vec![(at.parent, Rc::clone(node))],
            meta: named(node),
            layer: at.layer.clone(),
            opacity: at.opacity,
            outline: Outline::default(),
            ink: self.inker.ink(node, at.parent)?,
            kind,
            origin,
            lines: None,
            clip: at.clip.clone(),
            is_cut: false,
        };
        self.push(item, at);
        Ok(())
    }

    fn push(&mut self, mut item: Item, at: &Context) {
        item.outline = item.ink.outline();
        if let Some(clip) = &at.clip {
            let before = item.outline.area();
            item.outline = item.outline.intersection(clip);
            item.is_cut = item.outline.area() < 0.999 * before;
        }
        let extent = item.outline.bounds();
        if item.outline.rings.is_empty() || longer(&extent) <= self.inker.source.limits.extent {
            let seen = item.parts.iter().any(|(parent, node)| !bounds(node, *parent).is_empty());
            if item.parts.iter().any(|(_, node)| node.style.has_no_width()) {
                self.inker.source.notes.add(Note::NoWidth, || item.meta.id.clone().unwrap_or_default());
            }
            if seen && !item.is_cut {
                let meta = &item.meta;
                self.inker.source.notes.add(Note::ZeroSize, || meta.id.clone().unwrap_or_default());
            }
            return;
        }
        self.found.items.push(item);
    }

    /// Decides about a node that is, or wraps, a single shape.
    fn shape(&mut self, node: &Rc<Node>, leaf: &Rc<Node>, parent: Affine, at: &Context) -> Result<()> {
        let Content::Shape(geometry) = &leaf.content else { return Ok(()) };
        let extent = self.visible(node, at)?;
        let world = parent * leaf.transform;
        let filled = geometry.paint == Painted::Picture || is_filled(leaf, geometry);
        if filled && self.covers_frame(node, &extent, at)? {
            self.found.background.push((at.parent, Rc::clone(node)));
            return Ok(());
        }
        let closed = is_all_closed(&geometry.path);
        let origin = if filled { Origin::Fill } else { Origin::Stroke };
        if filled {
            if geometry.paint == Painted::Style && self.split(node, leaf, parent, at)? {
                return Ok(());
            }
            let kind = if self.share(&extent) < HALF { Kind::Element } else { Kind::Large };
            return self.take(node, at, kind, origin);
        }
        if closed && self.is_frame(leaf, geometry, world) {
            self.inker.source.notes.add(Note::Border, || node.meta.id.clone().unwrap_or_default());
            return Ok(());
        }
        let is_small = closed && self.share(&extent) < HALF && self.method != Method::Curves;
        let kind = if is_small { Kind::Element } else { Kind::Curve };
        self.take(node, at, kind, origin)
    }

    /// Whether a stroke encloses nearly the whole frame and hardly more.
    fn is_frame(&self, leaf: &Node, geometry: &Geometry, world: Affine) -> bool {
        let extent = bounds(leaf, world * leaf.transform.inverse());
        let near = 0.04 * longer(&self.frame);
        let close = |a: f64, b: f64| (a - b).abs() < near;
        let along = (0..2).all(|k| close(extent.min[k], self.frame.min[k]) && close(extent.max[k], self.frame.max[k]));
        along && flatten::filled(&geometry.path, world, FillRule::NonZero).area() >= 0.85 * self.frame.measure()
    }

    fn covers_frame(&self, node: &Rc<Node>, extent: &Bounds<2>, at: &Context) -> Result<bool> {
        let low = extent.min.zip(self.frame.min, f64::max);
        let high = extent.max.zip(self.frame.max, f64::min);
        let common = Bounds::new(low, high);
        if common.measure() < COVER * self.frame.measure() {
            return Ok(false);
        }
        let (a, b) = (self.frame.min, self.frame.max);
        let corners = vec![a, arabesque_core::Vector::xy(b[0], a[1]), b, arabesque_core::Vector::xy(a[0], b[1])];
        let outline = self.inker.ink(node, at.parent)?.outline().intersection(&Outline { rings: vec![corners] });
        Ok(outline.area() >= COVER * self.frame.measure())
    }

    /// Takes a compound path apart; `false` when it stays in one piece.
    fn split(&mut self, node: &Rc<Node>, leaf: &Rc<Node>, parent: Affine, at: &Context) -> Result<bool> {
        let Content::Shape(geometry) = &leaf.content else { return Ok(false) };
        let all: Vec<_> = geometry.path.subpaths().collect();
        if all.len() < 2 {
            return Ok(false);
        }
        let rule = flatten::fill_rule(leaf.style.get(P::FillRule));
        let Some(pieces) = pieces::pieces(&geometry.path, rule) else {
            self.inker.source.notes.add(Note::TooTangled, || node.meta.id.clone().unwrap_or_default());
            return Ok(false);
        };
        let mut inside = at.clone();
        let bare = self.unwrapped(node, leaf, parent, &mut inside)?;
        let nodes: Vec<_> = pieces.iter().map(|p| Rc::new(piece(&bare, &all, &p.subpaths))).collect();
        let boxes: Vec<_> = nodes.iter().map(|n| bounds(n, parent)).collect();
        if pieces.len() < 2 || self.is_compact(&boxes) {
            return Ok(false);
        }
        if leaf.style.get(P::Fill).starts_with("url(") {
            self.inker.source.notes.add(Note::SplitGradient, || node.meta.id.clone().unwrap_or_default());
        }
        let mut sets = super::touch::Sets::new(pieces.len());
        for (k, p) in pieces.iter().enumerate() {
            if let Some(home) = p.within.filter(|&home| self.share(&boxes[home]) < HALF) {
                sets.join(k, home);
            }
        }
        for group in sets.groups() {
            let whole: Vec<usize> = group.iter().flat_map(|&k| pieces[k].subpaths.iter().copied()).collect();
            let one = if group.len() == 1 { Rc::clone(&nodes[group[0]]) } else { Rc::new(piece(&bare, &all, &whole)) };
            let extent = bounds(&one, parent);
            let kind = if self.share(&extent) < HALF { Kind::Element } else { Kind::Large };
            let here = Context { parent, ..inside.clone() };
            self.take(&one, &here, kind, Origin::Piece)?;
        }
        Ok(true)
    }

    fn is_compact(&self, boxes: &[Bounds<2>]) -> bool {
        let all = boxes.iter().fold(Bounds::EMPTY, |all, b| all.union(b));
        self.share(&all) < ROOMY && clusters(boxes, GAP) == 1
    }

    /// The shape without its own clip and without the groups around it; what these do goes into the context.
    fn unwrapped(&self, node: &Rc<Node>, leaf: &Rc<Node>, parent: Affine, inside: &mut Context) -> Result<Node> {
        let mut at = node;
        let mut world = inside.parent;
        loop {
            world *= at.transform;
            if let Some(clip) = self.inker.clip(at, world)? {
                let both = inside.clip.as_ref().map_or_else(|| clip.clone(), |outer| outer.intersection(&clip));
                inside.clip = Some(Rc::new(both));
            }
            if Rc::ptr_eq(at, leaf) {
                break;
            }
            inside.opacity *= at.own.get("opacity").map_or(1.0, fraction);
            self.note_effects(&at.own, &at.meta);
            let [child] = at.children() else { break };
            at = child;
        }
        let _ = parent;
        let nameless = Meta { class: None, label: None, kind: None, shows: None, ..(*leaf.meta).clone() };
        Ok(Node { own: leaf.own.without("clip-path"), meta: Rc::new(nameless), ..(**leaf).clone() })
    }
}

fn piece(bare: &Node, all: &[&[kurbo::PathEl]], subpaths: &[usize]) -> Node {
    let geometry = Geometry::from_path(pieces::chosen(all, subpaths));
    Node { content: Content::Shape(Rc::new(geometry)), ..bare.clone() }
}

/// The names of a node, completed by those of the only shape in it.
fn named(node: &Rc<Node>) -> Rc<Meta> {
    match sole_shape(node, Affine::IDENTITY) {
        Some((leaf, _)) if !Rc::ptr_eq(leaf, node) => {
            let (outer, inner) = (&*node.meta, &*leaf.meta);
            Rc::new(Meta {
                class: outer.class.clone().or_else(|| inner.class.clone()),
                label: outer.label.clone().or_else(|| inner.label.clone()),
                kind: outer.kind.clone().or_else(|| inner.kind.clone()),
                shows: outer.shows.clone().or_else(|| inner.shows.clone()),
                ..outer.clone()
            })
        }
        _ => Rc::clone(&node.meta),
    }
}

/// Whether a fill covers more than a line.
fn is_filled(leaf: &Node, geometry: &Geometry) -> bool {
    if !leaf.style.fills() {
        return false;
    }
    let extent = geometry.path.control_box();
    let rings = flatten::rings(&geometry.path);
    let area: f64 = rings.iter().map(|r| arabesque_core::ring_area(r).abs()).sum();
    area > 1e-9 * (extent.width() + extent.height()).powi(2)
}

/// Whether a subpath ends where it starts.
pub(super) fn is_closed(elements: &[kurbo::PathEl]) -> bool {
    if matches!(elements.last(), Some(kurbo::PathEl::ClosePath)) {
        return true;
    }
    let ends = (elements.first().and_then(|e| e.end_point()), elements.last().and_then(|e| e.end_point()));
    elements.len() > 2 && matches!(ends, (Some(a), Some(b)) if a.distance(b) < 1e-9)
}
