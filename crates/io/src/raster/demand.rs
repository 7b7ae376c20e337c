//! What it will take to draw: memory of layers, and work, by the same rules as the renderer.

use arabesque_core::{Budget, Result};
use resvg::{
    tiny_skia::{self, Transform},
    usvg::{Group, ImageKind, Node, Paint, Path, Tree},
};

/// A layer is at most this many times as large as the picture.
pub(super) const LAYER: f64 = 25.0;

/// Work of visiting one node, of one corner of a path, of one side of a path in one row, and of one pixel.
const NODE: u64 = 200;
const CORNER: f64 = 60.0;
const ROW: f64 = 20.0;
const PIXEL: f64 = 2.0;
/// Work of one corner of a path that turns out to lie elsewhere.
const ELSEWHERE: f64 = 10.0;
/// Pictures that a filter holds at one time, for each of its steps.
const FILTER: f64 = 3.0;

/// Pixels and work.
#[derive(Debug, Default)]
pub(super) struct Demand {
    /// Most pixels of all layers that are held at one time.
    pub(super) layers: f64,
    /// Most layers that are held at one time.
    pub(super) deepest: f64,
    /// Most pixels of patterns and embedded pictures, which are as large whatever part is drawn.
    pub(super) fixed: f64,
    /// Units of work to draw all of it.
    pub(super) work: f64,
    /// Units of work for each band more.
    pub(super) again: f64,
}

/// A group that is still to be visited.
struct Visit<'a> {
    group: &'a Group,
    transform: Transform,
    /// Pixels and layers that are held while it is drawn.
    layers: f64,
    deep: f64,
    fixed: f64,
}

impl Demand {
    /// That of `tree` on a picture of `size` pixels. Everything that is drawn several times is counted several times.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Limit`] when counting alone uses up the work.
    pub(super) fn of(tree: &Tree, transform: Transform, size: [f64; 2], budget: &Budget) -> Result<Self> {
        let mut demand = Self::default();
        let mut meter = budget.meter();
        let mut left = vec![Visit { group: tree.root(), transform, layers: 0.0, deep: 0.0, fixed: 0.0 }];
        while let Some(visit) = left.pop() {
            let inner = demand.enter(&visit, size, &mut left);
            for node in inner.group.children() {
                meter.spend(NODE)?;
                demand.work += NODE as f64;
                match node {
                    Node::Group(group) => left.push(Visit { group, ..inner }),
                    Node::Text(text) => left.push(Visit { group: text.flattened(), ..inner }),
                    Node::Path(path) => {
                        meter.spend(path.data().len() as u64)?;
                        demand.path(path, &inner, size, &mut left);
                    }
                    Node::Image(image) => {
                        let pixels = f64::from(image.size().width()) * f64::from(image.size().height());
                        demand.hold(inner.layers + size[0] * size[1], inner.deep + 1.0, inner.fixed + 2.0 * pixels);
                        demand.work += 10.0 * pixels + PIXEL * size[0] * size[1];
                        if let ImageKind::SVG(tree) = image.kind() {
                            let above = Visit { group: tree.root(), ..inner };
                            left.push(Visit {
                                layers: above.layers + size[0] * size[1],
                                deep: above.deep + 1.0,
                                ..above
                            });
                        }
                    }
                }
            }
        }
        Ok(demand)
    }

    /// What is held at one place.
    fn hold(&mut self, layers: f64, deep: f64, fixed: f64) {
        self.layers = self.layers.max(layers);
        self.deepest = self.deepest.max(deep);
        self.fixed = self.fixed.max(fixed);
    }

    /// The group with its own layer, which its clips and masks are drawn beside.
    fn enter<'a>(&mut self, visit: &Visit<'a>, size: [f64; 2], left: &mut Vec<Visit<'a>>) -> Visit<'a> {
        let group = visit.group;
        let transform = visit.transform.pre_concat(group.transform());
        let inner = Visit { transform, ..*visit };
        if !group.should_isolate() {
            return inner;
        }
        let pixels = reach(group.layer_bounding_box().to_rect(), transform, size, 2.0);
        let steps: usize = group.filters().iter().map(|f| f.primitives().len()).sum();
        let filters = FILTER * steps as f64;
        let mut count = 1.0 + filters;
        let beside = |count: f64| Visit { layers: visit.layers + count * pixels, deep: visit.deep + count, ..inner };
        let mut clip = group.clip_path();
        while let Some(path) = clip {
            count += 1.0;
            left.push(Visit { group: path.root(), ..beside(count) });
            clip = path.clip_path();
        }
        let mut mask = group.mask();
        while let Some(inside) = mask {
            count += 1.0;
            left.push(Visit { group: inside.root(), ..beside(count) });
            mask = inside.mask();
        }
        self.work += PIXEL * count * pixels + 20.0 * filters * pixels;
        self.hold(visit.layers + count * pixels, visit.deep + count, visit.fixed);
        beside(1.0)
    }

    fn path<'a>(&mut self, path: &'a Path, inner: &Visit<'a>, size: [f64; 2], left: &mut Vec<Visit<'a>>) {
        let points = path.data().points();
        let corners = points.len() as f64;
        let row = |p: &tiny_skia::Point| {
            let mut at = *p;
            inner.transform.map_point(&mut at);
            f64::from(at.y).clamp(0.0, size[1])
        };
        let rows: f64 = points.windows(2).map(|w| (row(&w[1]) - row(&w[0])).abs()).sum();
        let paints = [path.fill().map(|f| f.paint()), path.stroke().map(|s| s.paint())];
        let strokes = f64::from(u8::from(paints[1].is_some()));
        let pixels = reach(path.bounding_box(), inner.transform, size, 0.0);
        self.work += (1.0 + 3.0 * strokes) * (corners * CORNER + rows * ROW) + PIXEL * pixels;
        self.again += corners * ELSEWHERE;
        for paint in paints.into_iter().flatten() {
            let Paint::Pattern(pattern) = paint else { continue };
            let (sx, sy) = inner.transform.pre_concat(pattern.transform()).get_scale();
            let tile = f64::from(pattern.rect().width() * sx) * f64::from(pattern.rect().height() * sy);
            self.work += PIXEL * tile;
            self.hold(inner.layers, inner.deep, inner.fixed + tile);
            let transform = Transform::from_scale(sx, sy);
            left.push(Visit { group: pattern.root(), transform, fixed: inner.fixed + tile, ..*inner });
        }
    }
}

/// Pixels of a box, as far as it lies within `times` pictures around the picture.
fn reach(area: tiny_skia::Rect, transform: Transform, size: [f64; 2], times: f64) -> f64 {
    let Some(area) = area.transform(transform) else { return size[0] * size[1] };
    let side = |from: f32, to: f32, n: f64| {
        let clamp = |v: f64| v.clamp(-times * n, (1.0 + times) * n);
        clamp(f64::from(to) + 2.0) - clamp(f64::from(from) - 2.0)
    };
    side(area.left(), area.right(), size[0]) * side(area.top(), area.bottom(), size[1])
}
