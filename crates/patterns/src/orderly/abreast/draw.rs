//! Lines of heights as smooth paths.

use arabesque_core::{Cubic, Path, Vector};

/// How far a path may lie from the heights, as a share of the distance of lines.
const NEAR: f64 = 0.004;
/// Columns that one segment spans at most.
const LONGEST: usize = 64;

/// A smooth path through points in columns: as few segments as it takes.
pub(crate) fn smooth(points: &[Vector<2>], gap: f64) -> Path<2> {
    let last = points.len().saturating_sub(1);
    let mut path = Path::default();
    let mut from = 0;
    while from < last {
        let mut to = from + 1;
        let mut ahead = 2;
        while ahead <= LONGEST && from + ahead <= last && is_near(points, from, from + ahead, NEAR * gap) {
            to = from + ahead;
            ahead *= 2;
        }
        path.cubics.push(segment(points, from, to));
        from = to;
    }
    path
}

/// From one column to another: the slopes at both ends are those of the columns around them.
fn segment(points: &[Vector<2>], from: usize, to: usize) -> Cubic<2> {
    let slope = |k: usize| {
        let (a, b) = (k.saturating_sub(1), (k + 1).min(points.len() - 1));
        (points[b] - points[a]) * (1.0 / (b - a).max(1) as f64)
    };
    let third = (to - from) as f64 / 3.0;
    [points[from], points[from] + slope(from) * third, points[to] - slope(to) * third, points[to]]
}

fn is_near(points: &[Vector<2>], from: usize, to: usize, within: f64) -> bool {
    let cubic = segment(points, from, to);
    let at = |k: usize| arabesque_core::cubic_at(&cubic, (k - from) as f64 / (to - from) as f64);
    (from + 1..to).all(|k| (at(k) - points[k]).norm() <= within)
}
