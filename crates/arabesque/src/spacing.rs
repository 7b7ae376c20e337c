//! The mean distance scale of an exemplar of any kind.

use arabesque_core::{Bounds, Exemplar, Measured, Path, net_line_spacing};

/// A path that leaves the window is looked at in at least so many places.
const FEWEST_STEPS: usize = 500;

/// What stands for a distance where there are areas alone, as a share of the side of the frame.
const AREAS: f64 = 0.02;

/// Mean distance of elements, or of the lines of a net, whichever is smaller.
pub(crate) fn spacing<const D: usize>(exemplar: &Exemplar<D>) -> f64 {
    let of_elements = exemplar.spacing();
    if exemplar.curves.is_empty() && exemplar.elements.is_empty() {
        // Areas alone: nothing of them is too small to be shown.
        return AREAS * exemplar.view().side();
    }
    if exemplar.curves.is_empty() {
        return of_elements;
    }
    let size = exemplar.window.size().norm();
    let length: f64 = exemplar.curves.iter().map(|c| length_inside(&c.path, &exemplar.window, 1e-3 * size)).sum();
    let of_curves = net_line_spacing::<D>(exemplar.window.measure(), length).min(size);
    if exemplar.elements.is_empty() { of_curves } else { of_elements.min(of_curves) }
}

/// Length of the chords whose middles lie in the window.
fn length_inside<const D: usize>(path: &Path<D>, window: &Bounds<D>, tolerance: f64) -> f64 {
    let bounds = path.bounds();
    if window.contains(bounds.min) && window.contains(bounds.max) {
        return length(path, tolerance);
    }
    let measured = Measured::new(path.clone(), tolerance);
    let steps = 2 * measured.points().len() + FEWEST_STEPS;
    let step = measured.length() / steps as f64;
    let inside = |k: &usize| window.contains(measured.point((*k as f64 + 0.5) * step));
    (0..steps).filter(inside).count() as f64 * step
}

/// Length of a path, its chords within `tolerance` of it.
pub(crate) fn length<const D: usize>(path: &Path<D>, tolerance: f64) -> f64 {
    Measured::new(path.clone(), tolerance).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use arabesque_core::{Class, Contents, Curve, Vector};

    #[test]
    fn a_square_net_has_the_spacing_of_its_lines() {
        let line = |a, b| Curve { path: Path::polyline(&[a, b]), style: 0, width: 1.0, colour: [0.0; 3] };
        let at = |k: u8| 10.0 * f64::from(k) + 5.0;
        let rows = (0..10).map(|k| line(Vector::xy(0.0, at(k)), Vector::xy(100.0, at(k))));
        let columns = (0..10).map(|k| line(Vector::xy(at(k), 0.0), Vector::xy(at(k), 100.0)));
        let window = Bounds::new(Vector::ZERO, Vector::xy(100.0, 100.0));
        let styles = vec![Class { name: "s".into() }];
        let net = Contents { curves: rows.chain(columns).collect(), styles, ..Contents::default() };
        let exemplar = Exemplar::with_curves("t", net, window).unwrap();
        assert!((spacing(&exemplar) - 10.0).abs() < 1e-9);
    }
}
