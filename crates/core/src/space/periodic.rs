//! Coordinates that come back after a period, as on a torus.

use crate::space::Vector;

/// `to - from` by the shortest way: around the back where coordinates have a period.
#[inline]
pub(crate) fn offset<const D: usize>(from: Vector<D>, to: Vector<D>, period: Option<Vector<D>>) -> Vector<D> {
    match period {
        Some(period) => (to - from).zip(period, |d, l| d - l * (d / l).round()),
        None => to - from,
    }
}
