//! The things in one period: what is taken along as a whole, and what its edges cut.

use std::{collections::BTreeMap, rc::Rc};

use arabesque_core::{Bounds, Budget, DisjointSets, Result};
use kurbo::{Affine, BezPath, Point, Rect};

use crate::svg::{
    parse::{
        geometry::Painted,
        meta::{Mark, Part},
        scene::{Content, Node},
        style::Own,
    },
    shape::{
        extent::{bounds, clusters, outline_bounds, sole_shape},
        stroke::growth,
    },
    swatch::cell::Cell,
};

/// Shares as those by which the selection opens groups.
const HALF: f64 = 0.5;
const ROOMY: f64 = 0.1;
const GAP: f64 = 0.4;
/// Work for comparing two things.
const COMPARE: u64 = 20;

/// A thing in one period.
#[derive(Clone, Debug)]
pub(crate) struct Unit {
    /// What draws it, in coordinates of the cell.
    pub(crate) node: Rc<Node>,
    /// Box around its outline.
    pub(crate) extent: Rect,
    /// Its path, in coordinates of the cell, where it is one shape that the edges may cut.
    pub(crate) path: Option<BezPath>,
    /// Things of the same number are painted alike.
    pub(crate) look: usize,
    pub(crate) is_filled: bool,
    pub(crate) is_stroked: bool,
    /// Whether an edge cuts it.
    pub(crate) is_cut: bool,
}

/// Everything in one period, in painting order.
#[derive(Debug, Default)]
pub(crate) struct Units {
    pub(crate) all: Vec<Unit>,
    /// Edges (along x, along y) over which something reaches that is drawn once more at the opposite one.
    pub(crate) doubled: [usize; 2],
}

/// Numbers for ways of painting.
#[derive(Debug, Default)]
struct Looks(BTreeMap<String, usize>);

impl Looks {
    fn number(&mut self, text: String) -> usize {
        let next = self.0.len();
        *self.0.entry(text).or_insert(next)
    }
}

/// Takes a drawing apart; each root comes with the transform from its parent to the cell.
pub(crate) fn units(roots: &[(Affine, Rc<Node>)], cell: &Cell, budget: &Budget) -> Result<Units> {
    let mut taker = Taker { cell, budget, looks: Looks::default(), found: Vec::new() };
    for (parent, node) in roots {
        taker.open(node, *parent)?;
    }
    let mut units = Units { all: std::mem::take(&mut taker.found), doubled: [0; 2] };
    // Groups that an edge cuts are opened, and what is in them is looked at in turn.
    loop {
        undouble(&mut units, cell, budget)?;
        let is_group = |unit: &Unit| unit.is_cut && unit.path.is_none();
        if !units.all.iter().any(is_group) {
            return Ok(units);
        }
        for unit in std::mem::take(&mut units.all) {
            if is_group(&unit) { taker.enter(unit)? } else { taker.found.push(unit) }
        }
        units.all = std::mem::take(&mut taker.found);
    }
}

struct Taker<'c> {
    cell: &'c Cell,
    budget: &'c Budget,
    looks: Looks,
    found: Vec<Unit>,
}

impl Taker<'_> {
    /// Takes what a container holds; its opacity goes to each.
    fn open(&mut self, node: &Rc<Node>, parent: Affine) -> Result<()> {
        let world = parent * node.transform;
        let first = self.found.len();
        node.children().iter().try_for_each(|child| self.visit(child, world))?;
        if let Some(opacity) = node.own.get("opacity") {
            let own = Own::opacity(opacity);
            for unit in &mut self.found[first..] {
                let content = Content::Group(vec![Rc::clone(&unit.node)]);
                let around = Node { transform: Affine::IDENTITY, own: own.clone(), content, ..(*unit.node).clone() };
                unit.node = Rc::new(Node { viewport_clip: None, ..around });
            }
        }
        Ok(())
    }

    fn visit(&mut self, node: &Rc<Node>, parent: Affine) -> Result<()> {
        self.budget.spend(COMPARE)?;
        let meta = &node.meta;
        if matches!(meta.part, Some(part) if part != Part::Exemplar) || meta.mark == Some(Mark::Ignore) {
            return Ok(());
        }
        let extent = bounds(node, parent);
        if !self.reaches_in(&extent) {
            return Ok(());
        }
        if self.is_container(node, parent, &extent)? {
            return self.open(node, parent);
        }
        self.take(node, parent);
        Ok(())
    }

    fn reaches_in(&self, extent: &Bounds<2>) -> bool {
        let (frame, near) = (self.cell.frame, self.cell.near());
        let inside = |k: usize, low: f64, high: f64| extent.max[k] > low + near && extent.min[k] < high - near;
        !extent.is_empty() && inside(0, frame.x0, frame.x1) && inside(1, frame.y0, frame.y1)
    }

    fn is_container(&self, node: &Rc<Node>, parent: Affine, extent: &Bounds<2>) -> Result<bool> {
        let is_whole = node.meta.mark.is_some() || node.meta.source.is_some() || !is_open(node, self.cell, parent);
        if is_whole || sole_shape(node, parent).is_some() {
            return Ok(false);
        }
        let share = extent.measure() / self.cell.frame.area();
        if node.meta.is_layer || share >= HALF {
            return Ok(true);
        }
        if node.meta.tag == "use" || share < ROOMY {
            return Ok(false);
        }
        let world = parent * node.transform;
        let boxes: Vec<_> = node.children().iter().map(|child| bounds(child, world)).collect();
        Ok(clusters(&boxes, GAP, self.budget)? >= 4)
    }

    /// Takes a node as one thing.
    fn take(&mut self, node: &Rc<Node>, parent: Affine) {
        let placed = Rc::new(Node { transform: parent * node.transform, ..(**node).clone() });
        let b = outline_bounds(&placed, Affine::IDENTITY);
        let extent = Rect::new(b.min[0], b.min[1], b.max[0], b.max[1]);
        let mut unit = Unit {
            node: placed,
            extent,
            path: None,
            look: 0,
            is_filled: false,
            is_stroked: false,
            is_cut: node.meta.mark.is_none() && node.meta.source.is_none() && !self.is_inside(&extent),
        };
        if let Some((look, path)) = self.shape(&unit.node) {
            unit.look = self.looks.number(look);
            let leaf = sole_shape(&unit.node, Affine::IDENTITY).map(|sole| Rc::clone(sole.leaf));
            unit.is_filled = leaf.as_ref().is_some_and(|leaf| leaf.style.fills());
            unit.is_stroked = leaf.as_ref().is_some_and(|leaf| leaf.style.strokes());
            // What has its stroke around it is whole where it merely reaches an edge.
            let frame = self.cell.frame.inflate(self.cell.near(), self.cell.near());
            let is_whole = unit.is_filled && unit.is_stroked && frame.union(extent) == frame;
            unit.is_cut &= !is_whole;
            unit.path = Some(path);
        }
        self.found.push(unit);
    }

    fn is_inside(&self, extent: &Rect) -> bool {
        let inner = self.cell.frame.inflate(-self.cell.near(), -self.cell.near());
        inner.union(*extent) == inner
    }

    /// How the only shape of a node is painted, in words, and its path.
    fn shape(&self, node: &Rc<Node>) -> Option<(String, BezPath)> {
        let sole = sole_shape(node, Affine::IDENTITY)?;
        let Content::Shape(geometry) = &sole.leaf.content else { return None };
        let world = sole.parent * sole.leaf.transform;
        let is_plain = geometry.paint == Painted::Style && world.determinant().abs() > 0.0;
        if !is_plain || !is_open(node, self.cell, Affine::IDENTITY) {
            return None;
        }
        Some((first_look(node, Affine::IDENTITY), world * geometry.path.clone()))
    }

    /// Takes what a group holds that an edge cuts; what cannot be opened is clipped.
    fn enter(&mut self, unit: Unit) -> Result<()> {
        let node = &unit.node;
        if !node.children().is_empty() && is_open(node, self.cell, Affine::IDENTITY) {
            return self.open(node, Affine::IDENTITY);
        }
        let content = Content::Group(vec![Rc::clone(node)]);
        let around = Node { transform: Affine::IDENTITY, own: Own::default(), content, ..(**node).clone() };
        let clipped = Rc::new(Node { viewport_clip: Some(self.cell.frame), ..around });
        self.found.push(Unit { node: clipped, is_cut: false, ..unit });
        Ok(())
    }
}

/// Whether a node and the groups around its only shape do nothing to what they hold, except for opacity, and for clips beyond the cell.
fn is_open(node: &Node, cell: &Cell, parent: Affine) -> bool {
    let world = parent * node.transform;
    let clip = node.viewport_clip.map(|clip| world.transform_rect_bbox(clip).inflate(cell.near(), cell.near()));
    let is_clear = clip.is_none_or(|clip| clip.union(cell.frame) == clip);
    let is_plain = node.own.get("clip-path").is_none_or(|v| v == "none") && !node.own.has_effects();
    is_clear && is_plain && if let [only] = node.children() { is_open(only, cell, world) } else { true }
}

/// How the first shape of a node is painted, as text.
pub(crate) fn first_look(node: &Node, parent: Affine) -> String {
    let mut text: String = node.own.iter().map(|(name, value)| format!("{name}:{value};")).collect();
    let world = parent * node.transform;
    match &node.content {
        Content::Group(children) => text.extend(children.first().map(|child| first_look(child, world))),
        Content::Shape(_) => {
            text.extend(node.style.attributes().map(|(name, value)| format!("{name}={value};")));
            if node.style.strokes() {
                text += &format!("{:.3e}", growth(world));
            }
        }
    }
    text
}

/// Things that reach over an edge and are drawn again a period farther on are one thing: the first of them stays, whole.
fn undouble(units: &mut Units, cell: &Cell, budget: &Budget) -> Result<()> {
    let (frame, near) = (cell.frame, cell.near());
    let inner = frame.inflate(near, near);
    let mut over: Vec<usize> =
        (0..units.all.len()).filter(|&i| units.all[i].is_cut && inner.union(units.all[i].extent) != inner).collect();
    over.sort_by(|&a, &b| units.all[a].extent.x0.total_cmp(&units.all[b].extent.x0));
    let mut sets = DisjointSets::new(units.all.len());
    let mut is_doubled = vec![false; units.all.len()];
    for &i in &over {
        for tile in [[1, 0], [0, 1], [1, 1], [1, -1]] {
            let shift = cell.shift(tile);
            let want = units.all[i].extent + shift;
            let first = over.partition_point(|&j| units.all[j].extent.x0 < want.x0 - near);
            for &j in over[first..].iter().take_while(|&&j| units.all[j].extent.x0 <= want.x0 + near) {
                budget.spend(COMPARE)?;
                let other = units.all[j].extent;
                let corners = [other.y0 - want.y0, other.x1 - want.x1, other.y1 - want.y1];
                let is_near = corners.iter().all(|d| d.abs() <= near);
                if i != j && is_near && is_copy(&units.all[i].node, &units.all[j].node, shift, near) {
                    sets.join(i, j);
                    (is_doubled[i], is_doubled[j]) = (true, true);
                    (0..2).for_each(|k| units.doubled[k] += tile[k].unsigned_abs() as usize);
                }
            }
        }
    }
    let mut is_first = vec![true; units.all.len()];
    for group in sets.groups() {
        group.iter().skip(1).for_each(|&i| is_first[i] = false);
    }
    let mut k = 0;
    units.all.retain_mut(|unit| {
        unit.is_cut &= !is_doubled[k];
        k += 1;
        is_first[k - 1]
    });
    Ok(())
}

/// Whether `b` is `a` moved by `shift`.
fn is_copy(a: &Node, b: &Node, shift: kurbo::Vec2, near: f64) -> bool {
    fn shapes<'n>(node: &'n Node, parent: Affine, all: &mut Vec<(&'n Node, Affine)>) {
        let world = parent * node.transform;
        if let Content::Shape(_) = node.content {
            all.push((node, world));
        }
        node.children().iter().for_each(|child| shapes(child, world, all));
    }
    let (mut of_a, mut of_b) = (Vec::new(), Vec::new());
    shapes(a, Affine::translate(shift), &mut of_a);
    shapes(b, Affine::IDENTITY, &mut of_b);
    let is_same = |(a, at): &(&Node, Affine), (b, bt): &(&Node, Affine)| {
        let (Content::Shape(ga), Content::Shape(gb)) = (&a.content, &b.content) else { return false };
        let points = |path: &BezPath, world: Affine| -> Vec<Point> {
            (world * path.clone()).elements().iter().filter_map(|e| e.end_point()).collect()
        };
        let (pa, pb) = (points(&ga.path, *at), points(&gb.path, *bt));
        let is_near = || pa.iter().zip(&pb).all(|(p, q)| (*p - *q).hypot() <= near);
        a.style.looks_like(&b.style) && a.own == b.own && pa.len() == pb.len() && is_near()
    };
    of_a.len() == of_b.len() && of_a.iter().zip(&of_b).all(|(a, b)| is_same(a, b))
}
