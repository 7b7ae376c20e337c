//! Cutting painted paths at the border of the domain.

use arabesque_core::{FillRule, Outline, Ring, Shape, Vector, segment};
use kurbo::{BezPath, PathEl};

/// The border that elements are cut at.
pub(crate) struct Cutter {
    shape: Shape,
    tolerance: f64,
}

/// What is left of a path.
#[derive(Debug)]
pub(crate) enum Remainder {
    /// It does not reach the border.
    Everything,
    /// Nothing is inside.
    Nothing,
    /// The inside part.
    Part(BezPath),
}

/// Areas that differ by less than this share are the same: polygon operations round to a fine grid.
const SAME_AREA: f64 = 1e-5;

impl Cutter {
    /// A cutter along `outline`; curves are replaced by chords within `tolerance`. `None` when it encloses no area.
    pub(crate) fn new(outline: &Outline<2>, tolerance: f64) -> Option<Self> {
        Some(Self { shape: Shape::from_outline(outline.clone())?, tolerance })
    }

    /// Whether everything within `radius` of `centre` is inside.
    pub(crate) fn spares(&self, centre: Vector<2>, radius: f64) -> bool {
        use arabesque_core::Region;
        self.shape.signed_distance(centre) >= radius
    }

    /// The inside part of a filled path.
    pub(crate) fn fill(&self, path: &BezPath, rule: FillRule) -> Remainder {
        let rings: Vec<Ring<2>> = self.polylines(path).into_iter().map(|(points, _)| points).collect();
        let area = Outline::union(&rings, rule);
        let inside = area.intersection(self.shape.outline());
        if inside.rings.is_empty() {
            return Remainder::Nothing;
        }
        if (inside.area() - area.area()).abs() <= SAME_AREA * area.area() {
            return Remainder::Everything;
        }
        let mut part = BezPath::new();
        for ring in &inside.rings {
            append(&mut part, ring, true);
        }
        Remainder::Part(part)
    }

    /// The inside part of the line of a path.
    pub(crate) fn stroke(&self, path: &BezPath) -> Remainder {
        let (mut part, mut whole) = (BezPath::new(), true);
        for (mut points, closed) in self.polylines(path) {
            if closed && let Some(&first) = points.first() {
                points.push(first);
            }
            for run in self.runs(&points, &mut whole) {
                append(&mut part, &run, false);
            }
        }
        match (whole, part.is_empty()) {
            (true, _) => Remainder::Everything,
            (false, true) => Remainder::Nothing,
            (false, false) => Remainder::Part(part),
        }
    }

    /// The inside stretches of a polyline; `whole` becomes false when something is left out.
    fn runs(&self, points: &[Vector<2>], whole: &mut bool) -> Vec<Vec<Vector<2>>> {
        let (mut runs, mut run) = (Vec::new(), Vec::<Vector<2>>::new());
        for pair in points.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let mut cuts = self.crossings(a, b);
            cuts.extend([0.0, 1.0]);
            cuts.sort_by(f64::total_cmp);
            for span in cuts.windows(2).filter(|s| s[1] > s[0]) {
                let at = |t: f64| a + (b - a) * t;
                if self.shape.outline().contains(at(0.5 * (span[0] + span[1]))) {
                    if run.is_empty() {
                        run.push(at(span[0]));
                    }
                    run.push(at(span[1]));
                } else {
                    *whole = false;
                    runs.extend((run.len() > 1).then(|| std::mem::take(&mut run)));
                    run.clear();
                }
            }
        }
        runs.extend((run.len() > 1).then_some(run));
        runs
    }

    /// Where the segment from `a` to `b` crosses the border, as shares of it.
    fn crossings(&self, a: Vector<2>, b: Vector<2>) -> Vec<f64> {
        let share = |edge| {
            let [t, u] = segment::crossing((a, b), edge)?;
            (t > 0.0 && t < 1.0 && (0.0..=1.0).contains(&u)).then_some(t)
        };
        self.shape.outline().edges().filter_map(share).collect()
    }

    /// The subpaths as polylines, and whether each is closed.
    fn polylines(&self, path: &BezPath) -> Vec<(Vec<Vector<2>>, bool)> {
        let mut lines: Vec<(Vec<Vector<2>>, bool)> = Vec::new();
        kurbo::flatten(path, self.tolerance, |el| match (el, lines.last_mut()) {
            (PathEl::MoveTo(p), _) => lines.push((vec![Vector::xy(p.x, p.y)], false)),
            (PathEl::LineTo(p), Some((points, _))) => points.push(Vector::xy(p.x, p.y)),
            (PathEl::ClosePath, Some((_, closed))) => *closed = true,
            _ => {}
        });
        lines.retain(|(points, _)| points.len() > 1);
        lines
    }
}

fn append(path: &mut BezPath, points: &[Vector<2>], closed: bool) {
    for (k, p) in points.iter().enumerate() {
        if k == 0 { path.move_to((p[0], p[1])) } else { path.line_to((p[0], p[1])) }
    }
    if closed {
        path.close_path();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::Shape as _;

    fn cutter() -> Cutter {
        let ring = vec![Vector::xy(0.0, 0.0), Vector::xy(10.0, 0.0), Vector::xy(10.0, 10.0), Vector::xy(0.0, 10.0)];
        Cutter::new(&Outline { rings: vec![ring] }, 0.01).unwrap()
    }

    #[test]
    fn a_disc_on_the_border_is_halved() {
        let disc = kurbo::Circle::new((0.0, 5.0), 2.0).to_path(1e-3);
        let Remainder::Part(half) = cutter().fill(&disc, FillRule::NonZero) else { panic!("not cut") };
        assert!((half.area().abs() - 2.0 * std::f64::consts::PI).abs() < 0.05);
        assert!(half.bounding_box().x0 >= -1e-6);
    }

    #[test]
    fn a_line_through_the_domain_keeps_its_inside() {
        let line = BezPath::from_svg("M-5 5L15 5").unwrap();
        let Remainder::Part(part) = cutter().stroke(&line) else { panic!("not cut") };
        assert_eq!(part.bounding_box(), kurbo::Rect::new(0.0, 5.0, 10.0, 5.0));
    }

    #[test]
    fn inside_and_outside_are_told_apart() {
        let c = cutter();
        let inside = kurbo::Circle::new((5.0, 5.0), 2.0).to_path(1e-3);
        let outside = kurbo::Circle::new((50.0, 5.0), 2.0).to_path(1e-3);
        assert!(matches!(c.fill(&inside, FillRule::NonZero), Remainder::Everything));
        assert!(matches!(c.stroke(&inside), Remainder::Everything));
        assert!(matches!(c.fill(&outside, FillRule::NonZero), Remainder::Nothing));
        assert!(matches!(c.stroke(&outside), Remainder::Nothing));
        assert!(c.spares(Vector::xy(5.0, 5.0), 4.9) && !c.spares(Vector::xy(5.0, 5.0), 5.1));
    }
}
