//! Lengths along polylines.

use crate::space::Vector;

/// Length of the polyline through `points`.
pub fn polyline_length<const D: usize>(points: &[Vector<D>]) -> f64 {
    points.windows(2).map(|w| (w[1] - w[0]).norm()).sum()
}

/// Arc length at every one of `points`, along the polyline through them: 0 at the first, even where there is none.
pub fn arc_lengths<const D: usize>(points: &[Vector<D>]) -> Vec<f64> {
    let mut arc = 0.0;
    let steps = points.windows(2).map(|w| {
        arc += (w[1] - w[0]).norm();
        arc
    });
    std::iter::once(0.0).chain(steps).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arc_lengths_end_with_the_length() {
        let points = [(0.0, 0.0), (3.0, 4.0), (3.0, 5.0)].map(|(x, y)| Vector::xy(x, y));
        assert_eq!(arc_lengths(&points), [0.0, 5.0, 6.0]);
        assert_eq!(polyline_length(&points), 6.0);
        assert_eq!((arc_lengths::<2>(&[]), polyline_length::<2>(&[])), (vec![0.0], 0.0));
    }
}
