//! How much of an exemplar its strokes cover.

use arabesque_core::{Bounds, Domain, GridIndex, Vector};

use crate::exemplar::graph::skeleton::Skeleton;

/// Places along each side of the window that are looked at, in the plane and in space.
const GRID: (usize, usize) = (48, 14);

/// Points on a line lie this share of its width apart.
const STEP: f64 = 0.25;

/// Most points on all lines.
const MAX_POINTS: f64 = 200_000.0;

/// Share of the window that lies under strokes, as round bars of their width: 0 to 1. Strokes without that much ink are
/// not looked at and count as nothing.
pub(crate) fn coverage<const D: usize>(skeleton: &Skeleton<D>, window: &Bounds<D>, least: f64) -> f64 {
    let ink = |width: f64| if D == 2 { width } else { 0.25 * std::f64::consts::PI * width * width };
    let total: f64 = skeleton.lines.iter().map(|l| ink(l.width) * l.measured.length()).sum();
    if total < least * window.measure() {
        return 0.0;
    }
    let length: f64 = skeleton.lines.iter().map(|l| l.measured.length()).sum();
    let (mut points, mut reach) = (Vec::new(), Vec::new());
    for line in &skeleton.lines {
        let step = (STEP * line.width).max(length / MAX_POINTS);
        let count = (line.measured.length() / step).ceil().max(1.0) as usize;
        points.extend((0..=count).map(|k| line.measured.point(line.measured.length() * k as f64 / count as f64)));
        reach.resize(points.len(), 0.5 * line.width.hypot(step));
    }
    let widest = reach.iter().copied().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let index = GridIndex::new(&points, widest, &Domain::Box(Bounds::around(points.iter().copied())));
    let places = places(window);
    let is_covered = |p: &&Vector<D>| {
        let mut hit = false;
        index.within(**p, widest, |j, offset| hit |= offset.norm() <= reach[j]);
        hit
    };
    places.iter().filter(is_covered).count() as f64 / places.len() as f64
}

/// A grid of places all over a box.
fn places<const D: usize>(window: &Bounds<D>) -> Vec<Vector<D>> {
    let n = if D == 2 { GRID.0 } else { GRID.1 };
    (0..n.pow(D as u32)).map(|number| window.cell_centre(number, &[n; D])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use arabesque_core::{Curve, Path};

    fn stripes(width: f64) -> f64 {
        let window = Bounds::new(Vector::ZERO, Vector::xy(100.0, 100.0));
        let stripe = |y: f64| Curve {
            path: Path::polyline(&[Vector::xy(0.0, y), Vector::xy(100.0, y)]),
            style: 0,
            width,
            colour: [0.0; 3],
        };
        let curves: Vec<_> = (0..10).map(|k| stripe(10.0 * f64::from(k) + 5.0)).collect();
        coverage(&Skeleton::new(&curves, &window.into(), &arabesque_core::Budget::default()).unwrap(), &window, 0.1)
    }

    #[test]
    fn stripes_cover_their_width() {
        assert!((stripes(4.0) - 0.4).abs() < 0.06, "{}", stripes(4.0));
        assert_eq!(stripes(0.5), 0.0);
        assert_eq!(stripes(12.0), 1.0);
    }
}
