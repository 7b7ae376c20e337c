//! The window that a set of points was probably cut from.

use crate::{
    index::GridIndex,
    region::Domain,
    space::{Bounds, Vector, cell_place},
};

/// Share of the estimated margin that is used: a window that is too large claims emptiness that nobody has seen, and thins the output.
const KEPT_MARGIN: f64 = 0.15;

/// Points of which the mean one has so many in its cell lie in heaps: their cells tell nothing, and would take for ever to measure.
const HEAPED: f64 = 1000.0;

/// The window that points were probably cut from: their bounding box, moved outwards so far that its density is that of the interior.
///
/// The interior density is one over the mean Voronoi cell of the points whose cell does not reach the bounding box. A lattice gets half
/// its step around it, a random set nearly nothing; half the mean spacing serves when too few cells are whole.
pub(super) fn window_around<const D: usize>(points: &[Vector<D>]) -> Bounds<D> {
    let tight = Bounds::around(points.iter().copied());
    let extent = tight.size().map(|s| s.max(1e-9));
    let spacing = (extent.0.iter().product::<f64>() / points.len().max(1) as f64).powf(1.0 / D as f64);
    let grown = |margin: f64| {
        Bounds::new(tight.min - extent.map(|s| margin.min(0.5 * s)), tight.max + extent.map(|s| margin.min(0.5 * s)))
    };
    let Some(cell) = interior_cell(points, &tight, spacing) else {
        return grown(0.5 * spacing);
    };
    let wanted = cell * points.len() as f64;
    let (mut low, mut high) = (0.0, 1.5 * spacing);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if grown(middle).measure() < wanted { low = middle } else { high = middle }
    }
    grown(KEPT_MARGIN * low)
}

/// Distances to the nearest neighbour in a lattice differ by less than this share of their mean.
const EVEN: f64 = 0.12;

/// What a lattice of points is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLattice {
    /// Mean distance to the nearest neighbour.
    pub step: f64,
    /// Measure of a cell; `None` where too few of them are surrounded.
    pub cell: Option<f64>,
}

/// The lattice that points lie in, more or less: all have their nearest neighbour at about one distance. `None` for others.
pub fn point_lattice<const D: usize>(points: &[Vector<D>]) -> Option<PointLattice> {
    let tight = Bounds::around(points.iter().copied());
    let spacing = (tight.measure() / points.len().max(1) as f64).powf(1.0 / D as f64);
    if points.len() < 9 || spacing <= 0.0 {
        return None;
    }
    let index = GridIndex::new(points, spacing, &Domain::Box(tight));
    if index.crowding() > HEAPED {
        return None;
    }
    let nearest: Option<Vec<f64>> =
        points.iter().enumerate().map(|(i, &p)| index.nearest(p, 3.0 * spacing, Some(i)).map(|n| n.1)).collect();
    let nearest = nearest?;
    let step = nearest.iter().sum::<f64>() / nearest.len() as f64;
    let variance = nearest.iter().map(|d| (d - step).powi(2)).sum::<f64>() / nearest.len() as f64;
    let is_even = variance.sqrt() <= EVEN * step;
    is_even.then(|| PointLattice { step, cell: interior_cell(points, &tight, spacing) })
}

/// Mean measure of the Voronoi cells that do not reach the box, found by sampling; `None` when fewer than nine are whole.
fn interior_cell<const D: usize>(points: &[Vector<D>], tight: &Bounds<D>, spacing: f64) -> Option<f64> {
    let index = GridIndex::new(points, spacing, &Domain::Box(*tight));
    if index.crowding() > HEAPED {
        return None;
    }
    let per_point = if points.len() > 20_000 { 16.0 } else { 128.0 };
    let side = ((points.len() as f64 * per_point).powf(1.0 / D as f64).ceil() as usize).clamp(8, 4096);
    let (mut hits, mut cut) = (vec![0_u32; points.len()], vec![false; points.len()]);
    for sample in 0..side.pow(D as u32) {
        let p = tight.cell_centre(sample, &[side; D]);
        let rim = cell_place(sample, &[side; D]).into_iter().any(|i| i == 0 || i == side - 1);
        let (nearest, _) = (0..6).find_map(|n| index.nearest(p, spacing * f64::from(1 << n), None))?;
        hits[nearest] += 1;
        cut[nearest] |= rim;
    }
    let whole: Vec<f64> = (0..points.len()).filter(|&i| !cut[i]).map(|i| f64::from(hits[i])).collect();
    let sample_measure = tight.measure() / side.pow(D as u32) as f64;
    (whole.len() >= 9).then(|| whole.iter().sum::<f64>() / whole.len() as f64 * sample_measure)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        exemplar::Exemplar,
        random::{Stage, Stream},
    };

    #[test]
    fn the_window_of_a_grid_gives_back_its_spacing() {
        let points: Vec<_> = (0..100).map(|i| Vector::xy(f64::from(i % 10), f64::from(i / 10))).collect();
        let e = Exemplar::from_points("t", &points, &[0; 100], &["a".into()]).unwrap();
        assert!((e.spacing() - 0.915).abs() < 0.02, "{}", e.spacing());
    }

    #[test]
    fn the_window_of_random_points_is_hardly_larger_than_their_box() {
        let mut random = Stream::new(5, Stage::TEST, 0);
        let points: Vec<_> = (0..400).map(|_| Vector::xy(random.unit(), random.unit())).collect();
        let e = Exemplar::from_points("t", &points, &[0; 400], &["a".into()]).unwrap();
        assert!((e.window.measure() - 1.0).abs() < 0.06, "{:?}", e.window);
    }
}
