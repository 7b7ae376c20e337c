//! Cutting paths of cubics at the border of an area, their shape kept.

use arabesque_core::{Bounds, Cubic, Outline, Path, Segment, Vector, cubic_at, cubic_part, segment};
use kurbo::{CubicBez, Line, PathSeg};

/// Which part of a path is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// What lies in the area.
    Inside,
    /// What lies outside of it.
    Outside,
}

/// Cuts at most this near to the end of a segment are at its end.
const END: f64 = 1e-7;

/// The parts of `path` on one side of the border of `area`; `None` where that is all of it.
pub fn cut(path: &Path<2>, area: &Outline<2>, side: Side) -> Option<Vec<Path<2>>> {
    let area = &area.near(&path.bounds());
    let edges: Vec<_> = area.edges().map(|e| (e, Bounds::around([e.0, e.1]))).collect();
    let mut runs: Vec<Vec<Cubic<2>>> = Vec::new();
    let (mut open, mut whole, mut from_start) = (false, true, false);
    for (k, cubic) in path.cubics.iter().enumerate() {
        let cuts = crossings(cubic, &edges);
        for (s, span) in cuts.windows(2).enumerate() {
            let wanted = area.contains(cubic_at(cubic, 0.5 * (span[0] + span[1]))) == (side == Side::Inside);
            whole &= wanted;
            if wanted {
                from_start |= k == 0 && s == 0;
                let part = if span[1] - span[0] >= 1.0 { *cubic } else { cubic_part(cubic, span[0], span[1]) };
                match runs.last_mut().filter(|_| open) {
                    Some(run) => run.push(part),
                    None => runs.push(vec![part]),
                }
            }
            open = wanted;
        }
    }
    if whole {
        return None;
    }
    // On a closed path the last stretch goes on in the first.
    if path.closed && open && from_start && runs.len() > 1 {
        let first = std::mem::take(&mut runs[0]);
        if let Some(last) = runs.last_mut() {
            last.extend(first);
        }
        runs.remove(0);
    }
    Some(runs.into_iter().map(|cubics| Path { cubics, closed: false }).collect())
}

/// Parameters at which a cubic crosses the edges, in rising order, with 0 before and 1 after them.
fn crossings(cubic: &Cubic<2>, edges: &[(Segment<2>, Bounds<2>)]) -> Vec<f64> {
    let extent = Bounds::around(cubic.iter().copied());
    let mut cuts = vec![0.0, 1.0];
    for ((a, b), _) in edges.iter().filter(|(_, around)| around.intersects(&extent)) {
        if is_linear(cubic) {
            cuts.extend(line_crossing((cubic[0], cubic[3]), (*a, *b)));
        } else {
            let [p0, p1, p2, p3] = cubic.map(|p| kurbo::Point::new(p[0], p[1]));
            let edge = Line::new((a[0], a[1]), (b[0], b[1]));
            let met = PathSeg::Cubic(CubicBez::new(p0, p1, p2, p3)).intersect_line(edge);
            cuts.extend(met.iter().map(|m| m.segment_t));
        }
    }
    cuts.retain(|t| *t == 0.0 || *t == 1.0 || (END..=1.0 - END).contains(t));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|b, a| *b - *a < END);
    cuts
}

/// Whether the parameter of a cubic runs evenly along a straight line.
fn is_linear(c: &Cubic<2>) -> bool {
    let along = c[3] - c[0];
    let off = |p: Vector<2>, share: f64| (p - (c[0] + along * share)).norm() <= 1e-9 * along.norm();
    off(c[1], 1.0 / 3.0) && off(c[2], 2.0 / 3.0)
}

/// The share of a line at which it crosses an edge, the ends of either included.
fn line_crossing(line: Segment<2>, edge: Segment<2>) -> Option<f64> {
    let [t, u] = segment::crossing(line, edge)?;
    ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u)).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Outline<2> {
        let corners = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)];
        Outline { rings: vec![corners.map(|(x, y)| Vector::xy(x, y)).to_vec()] }
    }

    fn circle(x: f64, y: f64, r: f64) -> Path<2> {
        use kurbo::Shape as _;
        crate::svg::shape::subpath::line(&kurbo::Circle::new((x, y), r).to_path(1e-6), true, 1e-9)
    }

    #[test]
    fn a_line_through_the_area_falls_into_three() {
        let line = Path::polyline(&[Vector::xy(-5.0, 5.0), Vector::xy(15.0, 5.0)]);
        let inside = cut(&line, &square(), Side::Inside).unwrap();
        assert_eq!(inside.len(), 1);
        assert!((inside[0].start().unwrap() - Vector::xy(0.0, 5.0)).norm() < 1e-9);
        assert!((inside[0].end().unwrap() - Vector::xy(10.0, 5.0)).norm() < 1e-9);
        assert_eq!(cut(&line, &square(), Side::Outside).unwrap().len(), 2);
    }

    #[test]
    fn what_does_not_reach_the_border_is_not_cut() {
        assert!(cut(&circle(5.0, 5.0, 2.0), &square(), Side::Inside).is_none());
        assert!(cut(&circle(50.0, 5.0, 2.0), &square(), Side::Outside).is_none());
        assert_eq!(cut(&circle(5.0, 5.0, 2.0), &square(), Side::Outside).unwrap(), []);
    }

    #[test]
    fn a_circle_on_the_border_is_halved_in_one_piece_each() {
        for (x, y) in [(0.0, 5.0), (10.0, 5.0), (5.0, 0.0), (5.0, 10.0)] {
            let (inside, outside) = (
                cut(&circle(x, y, 2.0), &square(), Side::Inside).unwrap(),
                cut(&circle(x, y, 2.0), &square(), Side::Outside).unwrap(),
            );
            assert_eq!((inside.len(), outside.len()), (1, 1), "{x} {y}");
            let on_border = |p: Vector<2>| square_distance(p).abs() < 1e-6;
            assert!(
                [&inside[0], &outside[0]].iter().all(|p| on_border(p.start().unwrap()) && on_border(p.end().unwrap()))
            );
        }
    }

    fn square_distance(p: Vector<2>) -> f64 {
        Bounds::new(Vector::ZERO, Vector::xy(10.0, 10.0)).signed_distance(p)
    }
}
