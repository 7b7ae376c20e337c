//! Where an element of a tile is seen: itself, and copies of it across the edges.

use arabesque_core::{Bounds, Vector};

/// The shifts under which a box is seen in a tile, no shift first.
pub(crate) fn shifts(bounds: &Bounds<2>, tile: &Bounds<2>) -> Vec<Vector<2>> {
    if bounds.is_empty() {
        return vec![Vector::ZERO];
    }
    let size = tile.size();
    let range = |k: usize| {
        let first = ((tile.min[k] - bounds.max[k]) / size[k]).ceil() as i64;
        let last = ((tile.max[k] - bounds.min[k]) / size[k]).floor() as i64;
        first..=last
    };
    let mut shifts: Vec<_> = range(1).flat_map(|y| range(0).map(move |x| (x, y))).collect();
    shifts.sort_by_key(|&(x, y)| (x != 0 || y != 0, y, x));
    shifts.into_iter().map(|(x, y)| Vector::xy(x as f64 * size[0], y as f64 * size[1])).collect()
}
