//! Several periods laid out as an ordinary drawing.

use std::{collections::BTreeMap, rc::Rc};

use arabesque_core::{Bounds, Result, Vector};
use kurbo::{Affine, BezPath, PathEl, Point, Rect, Vec2};

use crate::svg::{
    parse::{
        geometry::Geometry,
        guard,
        scene::{Content, Node},
        source::Source,
        style::Own,
    },
    shape::extent::bounds,
    swatch::{
        cell::Cell,
        links::Links,
        pieces::Piece,
        units::Unit,
        weld::{Layout, weld},
    },
};

/// Work for each copy that is thought of.
const COPY: u64 = 10;
/// Things that an exemplar should show.
const WANTED: f64 = 30.0;
/// Periods, each way, that it shows at least and at most.
const LEAST: f64 = 2.0;
const MOST: f64 = 40.0;

/// Several periods as a drawing.
#[derive(Debug)]
pub(crate) struct Unrolled {
    /// Everything that is drawn.
    pub(crate) root: Rc<Node>,
    /// The box in which every copy is known: whole periods where these lie along the axes.
    pub(crate) window: Bounds<2>,
    /// The two shortest ways from a copy to the next that the cell tells of.
    pub(crate) period: [Vector<2>; 2],
}

/// What is in one period.
pub(crate) struct Period<'p> {
    pub(crate) cell: Cell,
    pub(crate) units: &'p [Unit],
    pub(crate) pieces: &'p [Piece],
    pub(crate) links: &'p Links,
}

impl Period<'_> {
    /// As many copies as make an exemplar; `base` lends what a root needs beside its content.
    ///
    /// # Errors
    /// As [`Source::count_node`] and [`Source::count_segments`]; [`arabesque_core::Error::Limit`] for too many copies.
    pub(crate) fn unroll(&self, source: &Source<'_>, base: &Node) -> Result<Unrolled> {
        let (window, layout) = self.window();
        let copies = layout.count().saturating_mul(self.units.len());
        if copies > source.limits.nodes {
            let what = format!("{}: copies of what one period holds", source.name);
            return Err(guard::over(what, copies, ("nodes", source.limits.nodes)));
        }
        source.budget.spend(COPY * copies as u64)?;
        let mut welded: BTreeMap<usize, Vec<BezPath>> = BTreeMap::new();
        for one in weld(self.pieces, self.links, &self.cell, layout, source.budget)? {
            welded.entry(one.unit).or_default().push(one.path);
        }
        let mut children = Vec::new();
        for (number, unit) in self.units.iter().enumerate() {
            if unit.is_cut {
                for path in welded.remove(&number).unwrap_or_default() {
                    let node = with_path(&unit.node, Affine::IDENTITY, &path);
                    let is_seen = unit.is_filled || self.reaches_in(&path, &window);
                    if is_seen && bounds(&node, self.cell.to_root).intersects(&window) {
                        source.count_node()?;
                        source.count_segments(path.elements().len())?;
                        children.push(Rc::new(node));
                    }
                }
                continue;
            }
            let extent = bounds(&unit.node, Affine::IDENTITY);
            let extent = Rect::new(extent.min[0], extent.min[1], extent.max[0], extent.max[1]);
            for tile in layout.tiles() {
                let shift = self.cell.shift(tile);
                let there = self.cell.to_root.transform_rect_bbox(extent + shift);
                if around(there).intersects(&window) {
                    source.count_node()?;
                    let transform = Affine::translate(shift) * unit.node.transform;
                    children.push(Rc::new(Node { transform, ..(*unit.node).clone() }));
                }
            }
        }
        let (transform, own, content) = (self.cell.to_root, Own::default(), Content::Group(children));
        let root = Rc::new(Node { transform, own, viewport_clip: None, content, ..base.clone() });
        Ok(Unrolled { root, window, period: self.vectors() })
    }

    /// Whether a good part of a stroke lies in the window: not, where it merely passes a corner.
    fn reaches_in(&self, path: &BezPath, window: &Bounds<2>) -> bool {
        let near = 5.0 * self.cell.near();
        let mut inside = 0.0;
        let mut last = Point::ZERO;
        kurbo::flatten(self.cell.to_root * path.clone(), 0.1 * near, |element| {
            let Some(at) = element.end_point() else { return };
            if let PathEl::LineTo(_) = element {
                let part = Bounds::around([last, at].map(|p| Vector::xy(p.x, p.y)));
                let common = Bounds::new(part.min.zip(window.min, f64::max), part.max.zip(window.max, f64::min));
                inside += if common.is_empty() { 0.0 } else { common.size().norm() };
            }
            last = at;
        });
        inside > near
    }

    /// The ways to the next copies.
    fn vectors(&self) -> [Vector<2>; 2] {
        let [a, b, c, d, ..] = self.cell.to_root.as_coeffs();
        let [w, h] = self.cell.size();
        [Vector::xy(a * w, b * w), Vector::xy(c * h, d * h)]
    }

    /// Where the box that is shown begins, from the corner of the cell: away from the middles of things, so that each counts once.
    fn offset(&self) -> Vec2 {
        const STEPS: usize = 32;
        let size = self.cell.size();
        let best = |axis: usize| {
            let middles: Vec<f64> = self.units.iter().map(|unit| self.middle(unit, axis) / size[axis]).collect();
            let room = |k: usize| {
                let at = k as f64 / STEPS as f64;
                let away = middles.iter().map(|m| (at - m - (at - m).round()).abs());
                away.fold(0.5, f64::min)
            };
            let mut least = 0;
            for k in 1..STEPS {
                if room(k) > room(least) + 1e-9 {
                    least = k;
                }
            }
            least as f64 / STEPS as f64 * size[axis]
        };
        Vec2::new(best(0), best(1))
    }

    /// About where the middle of a thing lies along an axis, from the corner of the cell: at an edge, where that cuts it.
    fn middle(&self, unit: &Unit, axis: usize) -> f64 {
        let (frame, near) = (self.cell.frame, self.cell.near());
        let (low, high, from, to) = if axis == 0 {
            (unit.extent.x0, unit.extent.x1, frame.x0, frame.x1)
        } else {
            (unit.extent.y0, unit.extent.y1, frame.y0, frame.y1)
        };
        let is_cut = unit.is_cut && (low <= from + near || high >= to - near);
        if is_cut { 0.0 } else { 0.5 * (low + high) - from }
    }

    /// The box that is shown, and the cells that reach into it, with those around them.
    fn window(&self) -> (Bounds<2>, Layout) {
        let [p, q] = self.vectors();
        let cut = self.pieces.len() as f64 / 2.0;
        let things = (self.units.iter().filter(|unit| !unit.is_cut).count() as f64 + cut).max(1.0);
        let area = (p[0] * q[1] - p[1] * q[0]).abs();
        let side = (WANTED / things * area).sqrt();
        let is_upright = p[1].abs() + q[0].abs() <= 1e-9 * (p.norm() + q.norm());
        let periods = |length: f64| (side / length).round().clamp(LEAST, MOST);
        let frame = self.cell.frame;
        let origin = frame.origin() + self.offset();
        let shown = if is_upright {
            let size = [frame.width() * periods(p.norm()), frame.height() * periods(q.norm())];
            self.cell.to_root.transform_rect_bbox(Rect::from_origin_size(origin, (size[0], size[1])))
        } else {
            let longest = p.norm().max(q.norm());
            let half = 0.5 * side.max(LEAST * longest).min(MOST * longest);
            let centre = self.cell.to_root * frame.center();
            Rect::new(centre.x - half, centre.y - half, centre.x + half, centre.y + half)
        };
        let reach = self.cell.to_root.inverse().transform_rect_bbox(shown);
        let cells = |at: f64, from: f64, length: f64| (at - from) / length;
        let low = [cells(reach.x0, frame.x0, frame.width()), cells(reach.y0, frame.y0, frame.height())];
        let high = [cells(reach.x1, frame.x0, frame.width()), cells(reach.y1, frame.y0, frame.height())];
        let layout =
            Layout { from: low.map(|v| (v + 1e-6).floor() as i64 - 1), to: high.map(|v| (v - 1e-6).ceil() as i64 + 1) };
        (around(shown), layout)
    }
}

fn around(rect: Rect) -> Bounds<2> {
    Bounds::new(Vector::xy(rect.x0, rect.y0), Vector::xy(rect.x1, rect.y1))
}

/// A node with one shape, with another path in its place; `parent` leads to the coordinates of the path.
fn with_path(node: &Node, parent: Affine, path: &BezPath) -> Node {
    let world = parent * node.transform;
    let content = match &node.content {
        Content::Shape(_) => Content::Shape(Rc::new(Geometry::from_path(world.inverse() * path.clone()))),
        Content::Group(children) => {
            Content::Group(children.iter().map(|child| Rc::new(with_path(child, world, path))).collect())
        }
    };
    Node { content, ..node.clone() }
}
