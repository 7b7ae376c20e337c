//! Cutting painted paths at the border of the domain.

use arabesque_core::{Bounds, Budget, FillRule, Outline, Region, Result, Ring, Segment, Shape, Vector, ring, segment};
use kurbo::{BezPath, PathEl};

/// The border that elements are cut at.
pub(crate) struct Cutter {
    shape: Shape,
    tolerance: f64,
    budget: Budget,
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

/// Work for each piece of a line and each edge of the border near it.
const PER_EDGE: u64 = 4;

/// Areas that differ by less than this share are the same: polygon operations round to a fine grid.
const SAME_AREA: f64 = 1e-5;

impl Cutter {
    /// A cutter along `outline`; curves are replaced by chords within `tolerance`. `None` when it encloses no area.
    ///
    /// # Errors
    /// As [`Shape::try_from_outline`].
    pub(crate) fn new(outline: &Outline<2>, tolerance: f64, budget: &Budget) -> Result<Option<Self>> {
        let shape = Shape::try_from_outline(outline.clone(), budget)?;
        Ok(shape.map(|shape| Self { shape, tolerance, budget: budget.clone() }))
    }

    /// Whether everything within `radius` of `centre` is inside.
    pub(crate) fn spares(&self, centre: Vector<2>, radius: f64) -> bool {
        self.shape.signed_distance(centre) >= radius
    }

    /// The inside part of a filled path.
    ///
    /// # Errors
    /// As [`Outline::try_union`].
    pub(crate) fn fill(&self, path: &BezPath, rule: FillRule) -> Result<Remainder> {
        let rings: Vec<Ring<2>> = self.polylines(path).into_iter().map(|(points, _)| points).collect();
        let area = Outline::try_union(&rings, rule, &self.budget)?;
        let inside = area.try_intersection(self.shape.outline(), &self.budget)?;
        if inside.rings.is_empty() {
            return Ok(Remainder::Nothing);
        }
        if (inside.area() - area.area()).abs() <= SAME_AREA * area.area() {
            return Ok(Remainder::Everything);
        }
        let mut part = BezPath::new();
        for ring in &inside.rings {
            append(&mut part, ring, true);
        }
        Ok(Remainder::Part(part))
    }

    /// The inside part of the line of a path.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    pub(crate) fn stroke(&self, path: &BezPath) -> Result<Remainder> {
        let (mut part, mut whole) = (BezPath::new(), true);
        let lines = self.polylines(path);
        let extent = Bounds::around(lines.iter().flat_map(|(points, _)| points.iter().copied()));
        let border: Vec<_> = self.shape.outline().near(&extent).edges().collect();
        let pieces: usize = lines.iter().map(|(points, _)| points.len()).sum();
        self.budget.spend(PER_EDGE * (self.shape.outline().rings.iter().map(Vec::len).sum::<usize>()) as u64)?;
        let mut meter = self.budget.meter();
        (0..pieces).try_for_each(|_| meter.spend(PER_EDGE * border.len() as u64))?;
        for (mut points, closed) in lines {
            if closed && let Some(&first) = points.first() {
                points.push(first);
            }
            for run in runs(&points, &border, &mut whole) {
                append(&mut part, &run, false);
            }
        }
        Ok(match (whole, part.is_empty()) {
            (true, _) => Remainder::Everything,
            (false, true) => Remainder::Nothing,
            (false, false) => Remainder::Part(part),
        })
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

/// The inside stretches of a polyline; `whole` becomes false when something is left out.
fn runs(points: &[Vector<2>], border: &[Segment<2>], whole: &mut bool) -> Vec<Vec<Vector<2>>> {
    let (mut runs, mut run) = (Vec::new(), Vec::<Vector<2>>::new());
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let mut cuts = crossings((a, b), border);
        cuts.extend([0.0, 1.0]);
        cuts.sort_by(f64::total_cmp);
        for span in cuts.windows(2).filter(|s| s[1] > s[0]) {
            let at = |t: f64| a + (b - a) * t;
            if ring::covers(border.iter().copied(), at(0.5 * (span[0] + span[1]))) {
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

/// Where a segment crosses the border, as shares of it.
fn crossings(line: Segment<2>, border: &[Segment<2>]) -> Vec<f64> {
    let share = |edge: &Segment<2>| {
        let [t, u] = segment::crossing(line, *edge)?;
        (t > 0.0 && t < 1.0 && (0.0..=1.0).contains(&u)).then_some(t)
    };
    border.iter().filter_map(share).collect()
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
        Cutter::new(&Outline { rings: vec![ring] }, 0.01, &Budget::default()).unwrap().unwrap()
    }

    #[test]
    fn a_disc_on_the_border_is_halved() {
        let disc = kurbo::Circle::new((0.0, 5.0), 2.0).to_path(1e-3);
        let Remainder::Part(half) = cutter().fill(&disc, FillRule::NonZero).unwrap() else { panic!("not cut") };
        assert!((half.area().abs() - 2.0 * std::f64::consts::PI).abs() < 0.05);
        assert!(half.bounding_box().x0 >= -1e-6);
    }

    #[test]
    fn a_line_through_the_domain_keeps_its_inside() {
        let line = BezPath::from_svg("M-5 5L15 5").unwrap();
        let Remainder::Part(part) = cutter().stroke(&line).unwrap() else { panic!("not cut") };
        assert_eq!(part.bounding_box(), kurbo::Rect::new(0.0, 5.0, 10.0, 5.0));
    }

    #[test]
    fn inside_and_outside_are_told_apart() {
        let c = cutter();
        let inside = kurbo::Circle::new((5.0, 5.0), 2.0).to_path(1e-3);
        let outside = kurbo::Circle::new((50.0, 5.0), 2.0).to_path(1e-3);
        assert!(matches!(c.fill(&inside, FillRule::NonZero).unwrap(), Remainder::Everything));
        assert!(matches!(c.stroke(&inside).unwrap(), Remainder::Everything));
        assert!(matches!(c.fill(&outside, FillRule::NonZero).unwrap(), Remainder::Nothing));
        assert!(matches!(c.stroke(&outside).unwrap(), Remainder::Nothing));
        assert!(c.spares(Vector::xy(5.0, 5.0), 4.9) && !c.spares(Vector::xy(5.0, 5.0), 5.1));
    }
}
