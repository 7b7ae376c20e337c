//! Curves along which the tests lay ribbons.

use arabesque_core::{Path, Vector, straight};

/// A path through points, straight from one to the next.
pub(crate) fn polyline(points: &[(f64, f64)]) -> Path<2> {
    Path::polyline(&points.iter().map(|&(x, y)| Vector::xy(x, y)).collect::<Vec<_>>())
}

/// A square with its sides along the axes, from its lowest corner on.
pub(crate) fn square(low: f64, high: f64) -> Path<2> {
    let c = [(low, low), (high, low), (high, high), (low, high), (low, low)].map(|(x, y)| Vector::xy(x, y));
    Path { cubics: c.windows(2).map(|w| straight(w[0], w[1])).collect(), closed: true }
}

/// A circle about a place on the diagonal.
pub(crate) fn ring(centre: f64, r: f64) -> Path<2> {
    let k = 0.552_284_75 * r;
    let p = |dx: f64, dy: f64| Vector::xy(centre + dx, centre + dy);
    let cubics = vec![
        [p(r, 0.0), p(r, k), p(k, r), p(0.0, r)],
        [p(0.0, r), p(-k, r), p(-r, k), p(-r, 0.0)],
        [p(-r, 0.0), p(-r, -k), p(-k, -r), p(0.0, -r)],
        [p(0.0, -r), p(k, -r), p(r, -k), p(r, 0.0)],
    ];
    Path { cubics, closed: true }
}
