//! Elements written out in page coordinates: moved or bent, and cut at the border.

use std::{cell::OnceCell, fmt::Write as _};

use arabesque_core::{Budget, Decimals, FillRule, Outline, Result, Similarity, Vector};
use kurbo::{Affine, BezPath, CubicBez, ParamCurve, PathEl, PathSeg, Point};

use crate::{
    svg::{
        drawing::Drawing,
        write::{
            cut::{Cutter, Remainder},
            pieces::{MarkupPiece, PaintedPath, take_apart},
            sheet::Style,
        },
    },
    text::xml::escape,
};

/// How an element gets from the exemplar to the page.
pub(crate) enum Warp<'a> {
    /// Moved as a whole.
    Rigid(Similarity<2>),
    /// Bent point by point; what cannot be bent is moved by the similarity.
    Bent(&'a dyn Fn(Vector<2>) -> Vector<2>, Similarity<2>),
}

impl Warp<'_> {
    fn similarity(&self) -> &Similarity<2> {
        match self {
            Self::Rigid(s) | Self::Bent(_, s) => s,
        }
    }
}

/// One element in page coordinates.
#[derive(Debug, Default)]
pub(crate) struct Flat {
    /// Its markup; empty when nothing of it is inside.
    pub(crate) markup: String,
    /// Pieces that are not plain paths and were only moved.
    pub(crate) kept_whole: usize,
}

/// Every segment of a bent path is cut into so many cubics.
const PIECES_PER_SEGMENT: usize = 4;
/// Chords of cut curves stay this near to them, in last written decimals of a page of a thousand units.
const CUT_TOLERANCE: f64 = 0.02;

/// Writes elements in page coordinates, each exemplar element taken apart once.
pub(crate) struct Flattener<'a> {
    drawing: &'a Drawing,
    cutter: Option<Cutter>,
    /// Id of the clip path of the domain, where there is one.
    clip: Option<&'a str>,
    decimals: Decimals,
    pieces: Vec<OnceCell<Vec<MarkupPiece>>>,
}

impl<'a> Flattener<'a> {
    /// A flattener that cuts along `cut`, if given; what cannot be cut is clipped by the clip path with the id `clip`.
    ///
    /// # Errors
    /// As [`Cutter::new`].
    pub(crate) fn new(
        drawing: &'a Drawing,
        cut: Option<&Outline<2>>,
        clip: Option<&'a str>,
        decimals: Decimals,
        budget: &Budget,
    ) -> Result<Self> {
        let spacing = drawing.exemplar.spacing();
        let cutter = |outline| Cutter::new(outline, CUT_TOLERANCE * 0.05 * spacing, budget);
        Ok(Self {
            cutter: cut.map_or(Ok(None), cutter)?,
            pieces: drawing.fragments.iter().map(|_| OnceCell::new()).collect(),
            drawing,
            clip,
            decimals,
        })
    }

    fn pieces(&self, source: usize) -> Result<&[MarkupPiece]> {
        let cell = &self.pieces[source];
        if cell.get().is_none() {
            let taken = take_apart(&self.drawing.fragments[source].markup)?;
            return Ok(cell.get_or_init(|| taken));
        }
        Ok(cell.get().map_or(&[], Vec::as_slice))
    }

    /// Writes exemplar element `source`.
    pub(crate) fn element(&self, source: usize, warp: &Warp<'_>, style: Style) -> Result<Flat> {
        let element = &self.drawing.exemplar.elements[source];
        let moved = warp.similarity();
        let reach = element.outline.radius(element.centre)
            * moved.scale
            * if matches!(warp, Warp::Bent(..)) { 2.0 } else { 1.0 };
        let cutter = self.cutter.as_ref().filter(|c| !c.spares(moved.apply(element.centre), reach));
        let mut flat = Flat::default();
        for piece in self.pieces(source)? {
            match piece {
                MarkupPiece::Open(tag) => flat.markup.push_str(tag),
                MarkupPiece::Close => flat.markup.push_str("</g>"),
                MarkupPiece::Path(path) => self.path(path, warp, cutter, &mut flat.markup)?,
                MarkupPiece::Whole(markup) => {
                    flat.kept_whole += usize::from(style == Style::Expanded);
                    let placed = format!("<g transform=\"{}\">{markup}</g>", self.matrix(moved));
                    match (cutter, self.clip) {
                        // What cannot be cut is at least not seen beyond the border.
                        (Some(_), Some(clip)) => {
                            let _ = write!(flat.markup, "<g clip-path=\"url(#{clip})\">{placed}</g>");
                        }
                        _ => flat.markup.push_str(&placed),
                    }
                }
            }
        }
        Ok(flat)
    }

    fn path(&self, painted: &PaintedPath, warp: &Warp<'_>, cutter: Option<&Cutter>, out: &mut String) -> Result<()> {
        let path = match warp {
            Warp::Rigid(s) => affine(s) * painted.path.clone(),
            Warp::Bent(bend, _) => bent(&painted.path, bend),
        };
        let scale = warp.similarity().scale;
        let Some(cutter) = cutter else {
            self.push(out, painted, &path, scale, Paint::Both);
            return Ok(());
        };
        let rule = match painted.attributes.get("fill-rule").map(String::as_str) {
            Some("evenodd") => FillRule::EvenOdd,
            _ => FillRule::NonZero,
        };
        let fill = if painted.is_filled() { cutter.fill(&path, rule)? } else { Remainder::Nothing };
        let stroke = if painted.is_stroked() { cutter.stroke(&path)? } else { Remainder::Nothing };
        match (fill, stroke) {
            (Remainder::Everything, Remainder::Everything) => self.push(out, painted, &path, scale, Paint::Both),
            (fill, stroke) => {
                self.push_part(out, painted, &CutPath { whole: &path, rest: &fill }, scale, Paint::Fill);
                self.push_part(out, painted, &CutPath { whole: &path, rest: &stroke }, scale, Paint::Stroke);
            }
        }
        Ok(())
    }

    fn push_part(&self, out: &mut String, painted: &PaintedPath, part: &CutPath<'_>, scale: f64, paint: Paint) {
        match part.rest {
            Remainder::Nothing => {}
            Remainder::Everything => self.push(out, painted, part.whole, scale, paint),
            Remainder::Part(rest) => self.push(out, painted, rest, scale, paint),
        }
    }

    fn push(&self, out: &mut String, painted: &PaintedPath, path: &BezPath, scale: f64, paint: Paint) {
        let _ = write!(out, "<path d=\"{}\"", self.data(path));
        for (name, value) in &painted.attributes {
            let replaced = matches!((name.as_str(), paint), ("stroke", Paint::Fill) | ("fill", Paint::Stroke));
            if !replaced {
                let _ = write!(out, " {name}=\"{}\"", escape(value));
            }
        }
        match paint {
            Paint::Both => {}
            Paint::Fill => out.push_str(" stroke=\"none\""),
            Paint::Stroke => out.push_str(" fill=\"none\""),
        }
        if paint != Paint::Fill {
            for (name, numbers) in &painted.lengths {
                let list: Vec<_> = numbers.iter().map(|v| self.decimals.plus(1).format(v * scale)).collect();
                let _ = write!(out, " {name}=\"{}\"", list.join(" "));
            }
        }
        out.push_str("/>");
    }

    fn data(&self, path: &BezPath) -> String {
        let mut data = String::new();
        let mut put = |letter: char, points: &[Point]| {
            data.push(letter);
            for (k, p) in points.iter().enumerate() {
                let gap = if k == 0 { "" } else { " " };
                let _ = write!(data, "{gap}{} {}", self.decimals.format(p.x), self.decimals.format(p.y));
            }
        };
        for el in path.elements() {
            match *el {
                PathEl::MoveTo(p) => put('M', &[p]),
                PathEl::LineTo(p) => put('L', &[p]),
                PathEl::QuadTo(p, q) => put('Q', &[p, q]),
                PathEl::CurveTo(p, q, r) => put('C', &[p, q, r]),
                PathEl::ClosePath => put('Z', &[]),
            }
        }
        data
    }

    fn matrix(&self, s: &Similarity<2>) -> String {
        let m = affine(s).as_coeffs();
        let linear: Vec<_> = m[..4].iter().map(|&v| self.decimals.plus(3).format(v)).collect();
        format!("matrix({} {} {})", linear.join(" "), self.decimals.format(m[4]), self.decimals.format(m[5]))
    }
}

/// A path, and what the border leaves of it.
struct CutPath<'a> {
    whole: &'a BezPath,
    rest: &'a Remainder,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Paint {
    Both,
    Fill,
    Stroke,
}

fn affine(s: &Similarity<2>) -> Affine {
    let (r, k, t) = (s.rotation.0, s.scale, s.translation);
    Affine::new([r[0][0] * k, r[1][0] * k, r[0][1] * k, r[1][1] * k, t[0], t[1]])
}

/// A path bent point by point: its segments as short cubics whose control points are moved.
fn bent(path: &BezPath, bend: &dyn Fn(Vector<2>) -> Vector<2>) -> BezPath {
    let to = |p: Point| {
        let q = bend(Vector::xy(p.x, p.y));
        Point::new(q[0], q[1])
    };
    let mut out = BezPath::new();
    let segment = |out: &mut BezPath, seg: PathSeg| {
        let cubic: CubicBez = seg.to_cubic();
        for k in 0..PIECES_PER_SEGMENT {
            let n = PIECES_PER_SEGMENT as f64;
            let piece = cubic.subsegment(k as f64 / n..(k + 1) as f64 / n);
            out.curve_to(to(piece.p1), to(piece.p2), to(piece.p3));
        }
    };
    let (mut start, mut last) = (Point::ORIGIN, Point::ORIGIN);
    for el in path.elements() {
        match *el {
            PathEl::MoveTo(p) => {
                out.move_to(to(p));
                start = p;
            }
            PathEl::LineTo(p) => segment(&mut out, PathSeg::Line(kurbo::Line::new(last, p))),
            PathEl::QuadTo(p, q) => segment(&mut out, PathSeg::Quad(kurbo::QuadBez::new(last, p, q))),
            PathEl::CurveTo(p, q, r) => segment(&mut out, PathSeg::Cubic(CubicBez::new(last, p, q, r))),
            PathEl::ClosePath => {
                if last != start {
                    segment(&mut out, PathSeg::Line(kurbo::Line::new(last, start)));
                }
                out.close_path();
            }
        }
        last = el.end_point().unwrap_or(start);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bending_with_a_shift_is_a_shift() {
        let path = BezPath::from_svg("M0 0L4 0Q4 4 0 4Z").unwrap();
        let moved = bent(&path, &|p| p + Vector::xy(10.0, 1.0));
        use kurbo::Shape as _;
        assert_eq!(moved.bounding_box(), path.bounding_box() + kurbo::Vec2::new(10.0, 1.0));
        assert!((moved.area() - path.area()).abs() < 1e-9);
    }
}
