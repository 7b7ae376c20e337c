//! The ribbon around a curve, cut into pieces [Zhou 2013 §1.1, §1.3].

use arabesque_core::{Bounds, Budget, Error, Held, Measured, Path, Result, Vector, rounded};

use crate::params::{RibbonParams, STEP, Width};

/// Most pieces of one curve.
pub const PIECES: usize = 20_000;

/// Widest that a ribbon may be, and highest that an exemplar may be, in pixels of the search.
pub const ROWS: usize = 10_000;
/// Narrowest that a ribbon may be, in pixels of the search.
const NARROWEST: f64 = 0.01;
/// Work of measuring one point of a curve, and of one piece of a cage.
const POINT: u64 = 20;
/// Bytes of a point of a measured curve, with its place.
const POINT_BYTES: usize = 48;
const PIECE: u64 = 500;

/// Coordinates of forms are multiples of this many exemplar pixels, so that equal pieces are found equal.
const GRAIN: f64 = 1.0 / 1024.0;

/// An edge between two pieces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rung<const D: usize> {
    pub(crate) top: Vector<D>,
    pub(crate) bottom: Vector<D>,
}

impl<const D: usize> Rung<D> {
    /// Where the curve passes.
    pub(crate) fn centre(&self) -> Vector<D> {
        (self.top + self.bottom) * 0.5
    }

    /// From top to bottom, as a unit vector.
    pub(crate) fn down(&self) -> Vector<D> {
        (self.bottom - self.top).unit()
    }
}

/// A piece as it lies in the exemplar, in exemplar pixels from its top left corner. Its left and its right edge are tilted by half of
/// the turn of the curve each, so that the pattern enters and leaves it in the middle of the ribbon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Form {
    /// Bottom left corner.
    pub(crate) foot: Vector<2>,
    /// Top right corner.
    pub(crate) top: Vector<2>,
    /// Bottom right corner.
    pub(crate) bottom: Vector<2>,
}

impl Form {
    /// From the right corners of a piece whose left edge is upright and `left` long.
    pub(crate) fn new(left: f64, top: Vector<2>, bottom: Vector<2>) -> Self {
        let edge = (bottom - top) * (1.0 / (bottom - top).norm().max(1e-12)) + Vector::xy(0.0, 1.0);
        let upright = edge.unit_if_longer(1e-6).unwrap_or(Vector::xy(0.0, 1.0));
        let rounded = |c: f64| (c / GRAIN).round() * GRAIN;
        let turned = |p: Vector<2>| Vector::xy(-upright.cross(p), upright.dot(p)).map(rounded);
        Self { foot: turned(Vector::xy(0.0, left)), top: turned(top), bottom: turned(bottom) }
    }

    /// Length of the left edge.
    pub(crate) fn left(&self) -> f64 {
        self.foot.norm()
    }

    /// Samples of the left edge, C in the paper.
    pub(crate) fn rows(&self) -> usize {
        (self.left() - 2.0 * GRAIN).ceil().max(1.0) as usize
    }

    /// Middle of the right edge.
    pub(crate) fn exit(&self) -> Vector<2> {
        (self.top + self.bottom) * 0.5
    }

    /// Whether the upper and the lower end of the right edge lie before the left edge.
    fn ahead(&self) -> [bool; 2] {
        [self.top, self.bottom].map(|p| self.foot.cross(p) <= 0.0)
    }

    /// Shares of the left and the right edge, from top to bottom, that bound the piece: less than all of them where the edges cross.
    /// `None` where nothing is left.
    pub(crate) fn unfolded(&self) -> Option<[(f64, f64); 2]> {
        let (top, bottom) = (self.foot.cross(self.top), self.foot.cross(self.bottom));
        match self.ahead() {
            [true, true] => return Some([(0.0, 1.0); 2]),
            [false, false] => return None,
            _ => {}
        }
        let right = top / (top - bottom);
        let left = ((self.top + (self.bottom - self.top) * right).dot(self.foot) / self.foot.norm2()).clamp(0.0, 1.0);
        Some(if bottom > 0.0 { [(0.0, left), (0.0, right)] } else { [(left, 1.0), (right, 1.0)] })
    }

    /// How far inside the piece `p` lies, in pixels; negative outside.
    pub(crate) fn depth(&self, p: Vector<2>) -> f64 {
        let [top, bottom] = self.ahead();
        let mut depth = side(self.foot, Vector::ZERO, p).min(side(self.top, self.bottom, p));
        if top {
            depth = depth.min(side(Vector::ZERO, self.top, p));
        }
        if bottom {
            depth = depth.min(side(self.bottom, self.foot, p));
        }
        depth
    }

    /// Box around the piece.
    pub(crate) fn bounds(&self) -> Bounds<2> {
        Bounds::around([Vector::ZERO, self.foot, self.top, self.bottom])
    }
}

/// Distance of `p` from the line between two points: positive where a turn from the line towards `p` goes from x to y.
pub(crate) fn side(from: Vector<2>, to: Vector<2>, p: Vector<2>) -> f64 {
    (to - from).cross(p - from) / (to - from).norm().max(1e-12)
}

/// A ribbon cut into pieces.
#[derive(Clone, Debug)]
pub(crate) struct Cage<const D: usize> {
    /// Edges in order: one more than pieces, the last one the first again where the curve is closed.
    pub(crate) rungs: Vec<Rung<D>>,
    /// The pieces.
    pub(crate) forms: Vec<Form>,
    /// Whether the curve is closed.
    pub(crate) closed: bool,
    /// Length of a piece along the curve, in user units.
    pub(crate) step: f64,
    /// User units per exemplar pixel.
    pub(crate) scale: f64,
}

impl<const D: usize> Cage<D> {
    /// Number of pieces.
    pub(crate) fn len(&self) -> usize {
        self.forms.len()
    }
}

impl Cage<2> {
    /// Cuts the ribbon around `path`.
    pub(crate) fn along(path: &Path<2>, plan: &CagePlan<'_>) -> Result<Self> {
        let line = Line::new(path, plan)?;
        let scale = plan.scale();
        let mut down = Vector::xy(0.0, 1.0);
        let rungs: Vec<_> = (0..=line.pieces)
            .map(|k| {
                let along = line.direction(k);
                if along.norm() > 1e-9 * line.step {
                    down = Vector::xy(-along[1], along[0]) * (1.0 / along.norm());
                }
                line.rung(k, down)
            })
            .collect();
        let forms = rungs.windows(2).map(|w| form(&w[0], &w[1], scale)).collect();
        Ok(Self { rungs, forms, closed: line.closed(), step: line.step, scale })
    }

    /// `p` in pixels from the top left corner of piece `k`.
    pub(crate) fn local(&self, k: usize, p: Vector<2>) -> Vector<2> {
        let (along, down) = self.axes(k);
        let q = (p - self.rungs[k].top) * (1.0 / self.scale);
        Vector::xy(q.dot(along), q.dot(down))
    }

    /// The point that lies at `q` pixels from the top left corner of piece `k`.
    pub(crate) fn canvas(&self, k: usize, q: Vector<2>) -> Vector<2> {
        let (along, down) = self.axes(k);
        self.rungs[k].top + (along * q[0] + down * q[1]) * self.scale
    }

    /// Unit vectors on the canvas along the axes of the exemplar in piece `k`.
    fn axes(&self, k: usize) -> (Vector<2>, Vector<2>) {
        let (foot, edge) = (self.forms[k].foot * (1.0 / self.forms[k].left()), self.rungs[k].down());
        let (cos, sin) = (edge.dot(foot), foot.cross(edge));
        (Vector::xy(cos, sin), Vector::xy(-sin, cos))
    }

    /// Distance of `p` from the curve where piece `k` lies.
    pub(crate) fn distance(&self, k: usize, p: Vector<2>) -> f64 {
        let (a, b) = (self.rungs[k].centre(), self.rungs[k + 1].centre());
        let share = ((p - a).dot(b - a) / (b - a).norm2().max(1e-300)).clamp(0.0, 1.0);
        (p - a - (b - a) * share).norm()
    }

    /// Box around piece `k` on the canvas.
    pub(crate) fn bounds(&self, k: usize) -> Bounds<2> {
        let (a, b) = (&self.rungs[k], &self.rungs[k + 1]);
        Bounds::around([a.top, a.bottom, b.top, b.bottom])
    }
}

/// What all cages of one run have in common.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CagePlan<'a> {
    pub(crate) params: &'a RibbonParams,
    /// Height of the exemplar, in pixels.
    pub(crate) height: f64,
    /// What messages call the curve.
    pub(crate) place: &'a str,
    pub(crate) budget: &'a Budget,
}

impl CagePlan<'_> {
    /// User units per pixel of the search.
    pub(crate) fn scale(&self) -> f64 {
        self.params.scale * self.params.coarse as f64
    }

    /// Refuses ribbons that are too wide or too narrow for the search.
    pub(crate) fn check_width(&self) -> Result<()> {
        let stations = match &self.params.width {
            Width::Exemplar => return Ok(()),
            Width::Constant(width) => &[(0.0, *width)][..],
            Width::Profile(stations) => stations,
        };
        let widths = || stations.iter().map(|s| s.1);
        let (least, most) = (widths().fold(f64::INFINITY, f64::min), widths().fold(0.0, f64::max));
        if most / self.scale() > ROWS as f64 {
            return Err(Error::Limit {
                what: "width of the ribbon".into(),
                found: format!("{} pixels of the exemplar", rounded(most / self.scale())),
                limit: ROWS.to_string(),
                advice: "use a smaller --width or a larger --scale".into(),
            });
        }
        if least / self.scale() < NARROWEST {
            let expected =
                format!("at least {}, a hundredth of a pixel of the exemplar", rounded(NARROWEST * self.scale()));
            return Err(Error::parameter("width", least, expected));
        }
        Ok(())
    }

    /// Length of a piece in user units, before it is rounded.
    fn step(&self) -> f64 {
        self.params.step.unwrap_or(STEP * self.height * self.params.scale)
    }
}

/// A curve by arc length, divided into pieces of equal length, except for the last, which takes what is left: a change of the curve leaves
/// the pieces before it as they are.
pub(crate) struct Line<'a, const D: usize> {
    line: Measured<D>,
    params: &'a RibbonParams,
    /// Height of the exemplar, in user units.
    height: f64,
    pub(crate) pieces: usize,
    pub(crate) step: f64,
    /// The memory of its points.
    _held: Held,
}

impl<'a, const D: usize> Line<'a, D> {
    pub(crate) fn new(path: &Path<D>, plan: &CagePlan<'a>) -> Result<Self> {
        let CagePlan { params, height, place, budget } = *plan;
        if path.cubics.iter().flatten().any(|p| !p.is_finite()) {
            let advice = "give every point of the curve as a number";
            return Err(Error::input(place, "a coordinate that is not a finite number", advice));
        }
        let (step, fine) = (plan.step(), 0.01 * plan.step());
        let points = Measured::count(path, fine);
        budget.spend(POINT * points as u64)?;
        let bytes = points.saturating_mul(POINT_BYTES).saturating_add(size_of_val(path.cubics.as_slice()));
        let held = budget.hold(&format!("{place}: points along the curve"), bytes)?;
        let line = Measured::new(path.clone(), fine);
        let length = line.length();
        if length < 1e-3 * step || length.is_nan() {
            let problem = format!("a curve of length {length:.3}, where a pattern is to be laid along it");
            return Err(Error::input(place, problem, "draw a longer curve"));
        }
        let n = (length / step).round().max(if line.is_closed() { 3.0 } else { 1.0 });
        if n > PIECES as f64 {
            return Err(Error::Limit {
                what: format!("{place}: pieces along the curve"),
                found: n.to_string(),
                limit: PIECES.to_string(),
                advice: "use longer pieces (--step) or a larger --scale".into(),
            });
        }
        budget.spend(PIECE * n as u64)?;
        let (step, height) = (step.min(length / (n - 0.5)), height * params.scale);
        Ok(Self { step, pieces: n as usize, line, params, height, _held: held })
    }

    pub(crate) fn closed(&self) -> bool {
        self.line.is_closed()
    }

    /// Arc length at rung `k`.
    fn arc(&self, k: usize) -> f64 {
        match k == self.pieces {
            true if self.closed() => 0.0,
            true => self.line.length(),
            false => k as f64 * self.step,
        }
    }

    /// Direction of the curve at rung `k`: the chord around it, as long as the ribbon is wide, so that a corner is turned within the width.
    pub(crate) fn direction(&self, k: usize) -> Vector<D> {
        let (arc, length) = (self.arc(k), self.line.length());
        let wanted = 0.25 * self.width(k).min(length);
        let half = if self.closed() { wanted } else { wanted.min(arc.min(length - arc).max(0.5 * self.step)) };
        self.line.point(arc + half) - self.line.point(arc - half)
    }

    fn width(&self, k: usize) -> f64 {
        self.params.width.at(self.arc(k) / self.line.length(), self.height)
    }

    /// Rung `k`, square to the curve along the unit vector `down`.
    pub(crate) fn rung(&self, k: usize, down: Vector<D>) -> Rung<D> {
        let (centre, half) = (self.line.point(self.arc(k)), down * (0.5 * self.width(k)));
        Rung { top: centre - half, bottom: centre + half }
    }
}

/// M(p - T) / scale.
fn flat(rung: &Rung<2>, p: Vector<2>, scale: f64) -> Vector<2> {
    let down = rung.down();
    let q = (p - rung.top) * (1.0 / scale);
    Vector::xy(q.dot(Vector::xy(down[1], -down[0])), q.dot(down))
}

fn form(a: &Rung<2>, b: &Rung<2>, scale: f64) -> Form {
    let left = (a.bottom - a.top).norm() / scale;
    Form::new(left, flat(a, b.top, scale), flat(a, b.bottom, scale))
}

#[cfg(test)]
mod tests {
    use super::*;
    use arabesque_core::straight;

    fn along(path: &Path<2>, params: &RibbonParams) -> Result<Cage<2>> {
        let plan = CagePlan { params, height: 20.0, place: "c.svg#a", budget: &Budget::default() };
        plan.check_width()?;
        Cage::along(path, &plan)
    }

    fn cage(path: &Path<2>, step: f64) -> Cage<2> {
        along(path, &RibbonParams { step: Some(step), ..RibbonParams::default() }).unwrap()
    }

    #[test]
    fn a_straight_ribbon_has_equal_rectangles() {
        let cage = cage(&Path::polyline(&[Vector::xy(3.0, 50.0), Vector::xy(103.0, 50.0)]), 10.0);
        assert_eq!(cage.len(), 10);
        assert!(cage.forms.iter().all(|f| *f == cage.forms[0]));
        assert_eq!((cage.forms[0].foot, cage.forms[0].top[1]), (Vector::xy(0.0, 20.0), 0.0));
        assert!((cage.rungs[0].top - Vector::xy(3.0, 40.0)).norm() < 1e-9);
        let p = Vector::xy(17.0, 43.0);
        assert!((cage.canvas(1, cage.local(1, p)) - p).norm() < 1e-9);
    }

    #[test]
    fn a_tight_bend_folds_on_its_inner_side() {
        let corners = [Vector::xy(0.0, 0.0), Vector::xy(50.0, 0.0), Vector::xy(10.0, 20.0)];
        let cage = cage(&Path::polyline(&corners), 5.0);
        let folded: Vec<_> = cage.forms.iter().filter(|f| f.foot.cross(f.bottom) > 0.0).collect();
        assert!(!folded.is_empty());
        for form in folded {
            let [(l0, l1), (r0, r1)] = form.unfolded().unwrap();
            assert!(l0 == 0.0 && r0 == 0.0 && l1 <= 1.0 && r1 < 1.0);
        }
    }

    #[test]
    fn a_closed_ribbon_ends_where_it_begins() {
        let c = [(0.0, 0.0), (60.0, 0.0), (60.0, 60.0), (0.0, 60.0), (0.0, 0.0)].map(|(x, y)| Vector::xy(x, y));
        let path = Path { cubics: c.windows(2).map(|w| straight(w[0], w[1])).collect(), closed: true };
        let cage = cage(&path, 5.0);
        assert_eq!(cage.rungs.len(), cage.len() + 1);
        assert_eq!(cage.rungs[0], *cage.rungs.last().unwrap());
    }

    #[test]
    fn curves_without_length_are_refused() {
        let dot = Path { cubics: vec![straight(Vector::ZERO, Vector::ZERO)], closed: false };
        let error = along(&dot, &RibbonParams::default()).unwrap_err();
        assert!(error.to_string().starts_with("c.svg#a: a curve of length 0"), "{error}");
    }

    #[test]
    fn widths_and_lengths_that_cannot_be_laid_are_refused_at_once() {
        let line = Path::polyline(&[Vector::ZERO, Vector::xy(1e9, 0.0)]);
        let short = Path::polyline(&[Vector::ZERO, Vector::xy(50.0, 0.0)]);
        let wide = |width, scale| RibbonParams { width: Width::Constant(width), scale, ..RibbonParams::default() };
        let profile = Width::Profile(vec![(0.0, 20.0), (1.0, 1e300)]);
        for (path, params, word) in [
            (&short, wide(1e9, 1.0), "width of the ribbon: 1e9 pixels"),
            (&short, wide(20.0, 1e-300), "width of the ribbon"),
            (&short, RibbonParams { width: profile, ..RibbonParams::default() }, "width of the ribbon"),
            (&short, wide(1e-300, 1.0), "hundredth of a pixel"),
            (&short, wide(20.0, 1e6), "hundredth of a pixel"),
            (&short, RibbonParams { step: Some(1e-300), ..RibbonParams::default() }, "pieces along the curve"),
            (&line, RibbonParams::default(), "pieces along the curve: 500000000 is over"),
            (&short, RibbonParams { scale: 1e300, ..RibbonParams::default() }, "a curve of length 50"),
        ] {
            let error = along(path, &params).unwrap_err().to_string();
            assert!(error.contains(word), "{word}: {error}");
        }
    }
}
