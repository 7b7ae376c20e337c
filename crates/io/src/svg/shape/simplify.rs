//! Fewer nodes for the same line: what lies between two corners is fitted again.

use arabesque_core::{Cubic, Path, Vector, cubic_at, segment, straight};
use kurbo::{BezPath, CubicBez, PathSeg, Point, fit_to_cubic, simplify::SimplifyBezPath};

use crate::text::path_data::is_straight;

/// Turn at a node from which on it is a corner, in radians.
const CORNER: f64 = 0.2;
/// Segments between two corners beyond which they are fitted in portions.
const PORTION: usize = 48;

/// The same path within `tolerance`, with as few nodes as will do. Ends and corners stay where they are.
pub fn simplified(path: &Path<2>, tolerance: f64) -> Path<2> {
    let mut cubics: Vec<Cubic<2>> =
        path.cubics.iter().filter(|c| c[1..].iter().any(|p| (*p - c[0]).norm() > 1e-3 * tolerance)).copied().collect();
    if cubics.is_empty() || !cubics.iter().flatten().all(|p| p.is_finite()) {
        return path.clone();
    }
    for k in 1..cubics.len() {
        cubics[k][0] = cubics[k - 1][3];
    }
    if path.closed {
        // A closed path starts at a corner where it has one, so that none lies inside a stretch.
        let n = cubics.len();
        let start = (0..n).find(|&k| turn(&cubics[(k + n - 1) % n], &cubics[k]) > CORNER);
        cubics.rotate_left(start.unwrap_or(0));
        let end = cubics[0][0];
        if let Some(last) = cubics.last_mut() {
            last[3] = end;
        }
    }
    let mut fewer = Vec::new();
    let mut from = 0;
    for k in 1..=cubics.len() {
        if k == cubics.len() || turn(&cubics[k - 1], &cubics[k]) > CORNER || k - from >= PORTION {
            fewer.extend(stretch(&cubics[from..k], tolerance));
            from = k;
        }
    }
    Path { cubics: fewer, closed: path.closed }
}

/// The angle between the end of one cubic and the start of the next.
fn turn(a: &Cubic<2>, b: &Cubic<2>) -> f64 {
    let (u, v) = (direction([a[3], a[2], a[1], a[0]]) * -1.0, direction(*b));
    u.angle_to(v).abs()
}

/// The direction in which a cubic leaves its first point.
fn direction(c: Cubic<2>) -> Vector<2> {
    let size = (1..4).map(|k| (c[k] - c[0]).norm()).fold(0.0, f64::max);
    let first = (1..4).map(|k| c[k] - c[0]).find(|d| d.norm() > 1e-4 * size);
    first.unwrap_or(c[3] - c[0])
}

/// A stretch without corners with fewer segments, or as it is where that fails.
fn stretch(cubics: &[Cubic<2>], tolerance: f64) -> Vec<Cubic<2>> {
    let (Some(first), Some(last)) = (cubics.first(), cubics.last()) else { return Vec::new() };
    let whole = straight(first[0], last[3]);
    if (last[3] - first[0]).norm() > tolerance && deviates_at_most(cubics, &[whole], tolerance) {
        return vec![whole];
    }
    if cubics.len() == 1 {
        return cubics.to_vec();
    }
    let fitted = fitted(cubics, tolerance);
    let sound = fitted.iter().flatten().all(|p| p.is_finite());
    if fitted.is_empty()
        || fitted.len() >= cubics.len()
        || !sound
        || !deviates_at_most(cubics, &fitted, 2.0 * tolerance)
    {
        return cubics.to_vec();
    }
    fitted
}

/// As few cubics as fit, each over as many of the old ones as it can.
fn fitted(cubics: &[Cubic<2>], tolerance: f64) -> Vec<Cubic<2>> {
    let point = |p: Vector<2>| Point::new(p[0], p[1]);
    let segments = cubics.iter().map(|c| {
        let [p0, p1, p2, p3] = with_handles(c, 0.3 * tolerance).map(point);
        PathSeg::Cubic(CubicBez::new(p0, p1, p2, p3))
    });
    let path = BezPath::from_path_segments(segments);
    let source = SimplifyBezPath::new(path.elements().iter().copied());
    let n = cubics.len();
    let fit = |from: usize, to: usize| -> Option<Cubic<2>> {
        let share = |k: usize| k as f64 / n as f64;
        let (c, _) = fit_to_cubic(&source, share(from)..share(to), tolerance)?;
        // The ends stay to the last bit, so that what met still meets.
        let handle = |p: Point| Vector::xy(p.x, p.y);
        Some([cubics[from][0], handle(c.p1), handle(c.p2), cubics[to - 1][3]])
    };
    let mut result = Vec::new();
    let mut from = 0;
    while from < n {
        let (to, cubic) = longest(from, n, &fit).unwrap_or((from + 1, cubics[from]));
        result.push(cubic);
        from = to;
    }
    result
}

/// The farthest end that still fits, looked for in growing and then in shrinking steps.
fn longest(from: usize, n: usize, fit: &impl Fn(usize, usize) -> Option<Cubic<2>>) -> Option<(usize, Cubic<2>)> {
    let (mut best, mut step) = (None, 2);
    while from + step <= n {
        match fit(from, from + step) {
            Some(cubic) => best = Some((from + step, cubic)),
            None => break,
        }
        if from + step == n {
            return best;
        }
        step = (2 * step).min(n - from);
    }
    let mut low = best.map_or(from + 1, |(to, _)| to);
    let mut high = (from + step).min(n + 1);
    while low + 1 < high {
        let middle = usize::midpoint(low, high);
        match fit(from, middle) {
            Some(cubic) => {
                best = Some((middle, cubic));
                low = middle;
            }
            None => high = middle,
        }
    }
    best
}

/// The same cubic with handles of at least `length` where they had none: a fit needs the direction at the ends.
fn with_handles(c: &Cubic<2>, length: f64) -> Cubic<2> {
    let long = |from: Vector<2>, handle: Vector<2>, way: Vector<2>| {
        let short = (handle - from).norm() < 0.1 * length && way.norm() > length;
        if short { from + way * (length / way.norm()) } else { handle }
    };
    [c[0], long(c[0], c[1], direction(*c)), long(c[3], c[2], direction([c[3], c[2], c[1], c[0]])), c[3]]
}

/// Points of each segment that are compared.
const COMPARED: usize = 6;

/// Whether no point of `old` is farther than `tolerance` from `new`.
fn deviates_at_most(old: &[Cubic<2>], new: &[Cubic<2>], tolerance: f64) -> bool {
    let line = Path { cubics: new.to_vec(), closed: false }.flatten(0.2 * tolerance);
    let near = |p: Vector<2>| line.windows(2).any(|w| segment::distance((w[0], w[1]), p) <= tolerance);
    let samples = |c: &Cubic<2>| {
        let ends = if is_straight(c, 0.01 * tolerance) { 1 } else { COMPARED };
        (1..=ends).all(|k| near(cubic_at(c, k as f64 / ends as f64)))
    };
    old.iter().all(samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polyline(n: usize, at: impl Fn(f64) -> (f64, f64)) -> Path<2> {
        let points: Vec<_> = (0..=n).map(|k| at(k as f64 / n as f64)).map(|(x, y)| Vector::xy(x, y)).collect();
        Path::polyline(&points)
    }

    #[test]
    fn two_hundred_points_of_a_sine_become_few_cubics() {
        let sine = polyline(200, |t| (60.0 * t, 10.0 * (12.0 * t).sin()));
        let few = simplified(&sine, 0.05);
        assert!(few.cubics.len() < 24, "{}", few.cubics.len());
        assert!(deviates_at_most(&sine.cubics, &few.cubics, 0.1));
        assert_eq!((few.start(), few.end()), (sine.start(), sine.end()));
    }

    #[test]
    fn corners_stay_and_straight_stretches_become_one() {
        let zigzag = polyline(40, |t| (40.0 * t, if t < 0.5 { 20.0 * t } else { 20.0 * (1.0 - t) }));
        let few = simplified(&zigzag, 0.01);
        assert_eq!(few.cubics.len(), 2);
        assert!((few.cubics[0][3] - Vector::xy(20.0, 10.0)).norm() < 1e-12);
    }

    #[test]
    fn a_circle_of_many_parts_stays_closed_and_round() {
        let tau = std::f64::consts::TAU;
        let mut circle = polyline(90, |t| (10.0 * (tau * t).cos(), 10.0 * (tau * t).sin()));
        circle.closed = true;
        let few = simplified(&circle, 0.02);
        assert!(few.closed && few.cubics.len() <= 24, "{}", few.cubics.len());
        assert!(few.flatten(0.01).iter().all(|p| (p.norm() - 10.0).abs() < 0.06));
        assert!((few.start().unwrap() - few.end().unwrap()).norm() < 1e-9);
    }

    #[test]
    fn degenerate_paths_come_back() {
        let dot = Path::polyline(&[Vector::ZERO, Vector::xy(1e-9, 0.0)]);
        assert_eq!(simplified(&dot, 0.1), dot);
        assert_eq!(simplified(&Path::<2>::default(), 0.1), Path::default());
        let there_and_back = Path::polyline(&[Vector::ZERO, Vector::xy(5.0, 0.0), Vector::ZERO]);
        assert_eq!(simplified(&there_and_back, 0.1).cubics.len(), 2);
    }
}
