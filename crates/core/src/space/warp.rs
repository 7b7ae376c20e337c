//! Bending by control points, as rigid as possible.
//!
//! Moving least squares: every point has its own rotation, the one that best carries the control points to their
//! targets when each counts by the inverse square of its distance to the point [Schaefer 2006 §2.3 in the plane, Zhu
//! 2007 §3 in space].

use crate::space::{Matrix, Vector};

/// Share of the rotation that fits all control points alike, mixed into each local fit: it decides where the nearby
/// control points leave the rotation open (one point, or points on a line in space), and changes nothing where they
/// agree with it.
const COMMON_SHARE: f64 = 1e-9;

/// A map of space that carries each control point to its target.
#[derive(Clone, Debug)]
pub struct Warp<'a, const D: usize> {
    control: &'a [(Vector<D>, Vector<D>)],
    common: Matrix<D>,
}

impl<'a, const D: usize> Warp<'a, D> {
    /// The map with `control[i].0` going to `control[i].1`.
    pub fn new(control: &'a [(Vector<D>, Vector<D>)]) -> Self {
        let even = vec![1.0; control.len()];
        let (.., covariance) = fit(control, &even);
        // Without a preference of the points for any rotation, the smallest turn is wanted.
        let common = mixed(&covariance, &Matrix::identity(), 1e-12).nearest_rotation_fast();
        Self { control, common }
    }

    /// Image of `p`.
    pub fn apply(&self, p: Vector<D>) -> Vector<D> {
        let distance2 = |c: &(Vector<D>, Vector<D>)| (c.0 - p).norm2();
        let nearest = self.control.iter().map(distance2).fold(f64::INFINITY, f64::min);
        if !nearest.is_finite() {
            return p;
        }
        if nearest < f64::MIN_POSITIVE {
            return mean_target(self.control.iter().filter(|c| distance2(c) < f64::MIN_POSITIVE));
        }
        // Relative to the nearest control point, so that nothing overflows next to one.
        let weights: Vec<f64> = self.control.iter().map(|c| nearest / distance2(c)).collect();
        let (from, to, covariance) = fit(self.control, &weights);
        mixed(&covariance, &self.common, COMMON_SHARE).nearest_rotation_fast().apply(p - from) + to
    }
}

/// Bends space as rigidly as possible so that `control[i].0` goes to `control[i].1`, and returns the image of `p`.
///
/// Exact at the control points; the mean of the targets where several control points coincide. A motion without bending
/// is reproduced when the targets are one. A single control point shifts; none leave `p` where it is.
pub fn warp<const D: usize>(control: &[(Vector<D>, Vector<D>)], p: Vector<D>) -> Vector<D> {
    Warp::new(control).apply(p)
}

/// Weighted means of control points and targets, and the covariance of targets with control points about them.
fn fit<const D: usize>(control: &[(Vector<D>, Vector<D>)], weights: &[f64]) -> (Vector<D>, Vector<D>, Matrix<D>) {
    let total = weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let (mut from, mut to) = (Vector::ZERO, Vector::ZERO);
    for (&(p, q), &w) in control.iter().zip(weights) {
        from += p * (w / total);
        to += q * (w / total);
    }
    let mut covariance = Matrix::zero();
    for (&(p, q), &w) in control.iter().zip(weights) {
        let (p, q) = (p - from, (q - to) * w);
        for (row, q) in covariance.0.iter_mut().zip(q.0) {
            for (entry, p) in row.iter_mut().zip(p.0) {
                *entry += q * p;
            }
        }
    }
    (from, to, covariance)
}

/// `covariance` plus `share` of its size in the direction of `rotation`; the rotation itself where the covariance
/// vanishes.
fn mixed<const D: usize>(covariance: &Matrix<D>, rotation: &Matrix<D>, share: f64) -> Matrix<D> {
    let size = covariance.0.iter().flatten().map(|v| v * v).sum::<f64>().sqrt();
    let amount = if size > 0.0 { share * size } else { 1.0 };
    Matrix(std::array::from_fn(|r| std::array::from_fn(|c| covariance.0[r][c] + amount * rotation.0[r][c])))
}

fn mean_target<'a, const D: usize>(pairs: impl Iterator<Item = &'a (Vector<D>, Vector<D>)>) -> Vector<D> {
    let (n, sum) = pairs.fold((0.0, Vector::ZERO), |(n, sum), c| (n + 1.0, sum + c.1));
    sum * (1.0 / f64::max(n, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        random::{Stage, Stream},
        space::Similarity,
    };

    fn random<const D: usize>(stream: &mut Stream) -> Vector<D> {
        Vector(std::array::from_fn(|_| stream.range(-5.0, 5.0)))
    }

    /// A proper rotation that is nothing special.
    fn turn<const D: usize>(stream: &mut Stream) -> Matrix<D> {
        Matrix::<D>(std::array::from_fn(|_| random::<D>(stream).0)).nearest_rotation()
    }

    fn reproduces_rigid_motions<const D: usize>() {
        let mut stream = Stream::new(5, Stage::TEST, D as u64);
        for _ in 0..50 {
            let motion = Similarity::about(random(&mut stream), random(&mut stream), turn(&mut stream), 1.0);
            let points: Vec<Vector<D>> = (0..5).map(|_| random(&mut stream)).collect();
            let control: Vec<_> = points.iter().map(|&p| (p, motion.apply(p))).collect();
            let p = random(&mut stream);
            assert!((warp(&control, p) - motion.apply(p)).norm() < 1e-8);
        }
    }

    #[test]
    fn a_rigid_motion_stays_rigid() {
        reproduces_rigid_motions::<2>();
        reproduces_rigid_motions::<3>();
    }

    fn keeps_control_points<const D: usize>() {
        let mut stream = Stream::new(6, Stage::TEST, D as u64);
        let control: Vec<_> = (0..6).map(|_| (random::<D>(&mut stream), random(&mut stream))).collect();
        for &(p, q) in &control {
            assert_eq!(warp(&control, p), q);
            let near = p + Vector::splat(1e-9);
            assert!((warp(&control, near) - q).norm() < 1e-6, "jumps next to a control point");
        }
    }

    #[test]
    fn control_points_go_to_their_targets() {
        keeps_control_points::<2>();
        keeps_control_points::<3>();
    }

    #[test]
    fn nothing_moves_without_control_and_one_point_shifts() {
        let p = Vector::xy(1.0, 2.0);
        assert_eq!(warp(&[], p), p);
        let moved = warp(&[(Vector::ZERO, Vector::xy(3.0, 0.0))], p);
        assert!((moved - Vector::xy(4.0, 2.0)).norm() < 1e-12);
    }

    #[test]
    fn coinciding_control_points_are_safe() {
        let a = Vector::xy(0.0, 0.0);
        let b = Vector::xy(1e-170, 0.0);
        let c = Vector::xy(1.0, 0.0);
        let control = [(a, Vector::xy(0.0, 0.0)), (b, Vector::xy(0.0, 2.0)), (c, Vector::xy(1.0, 0.0))];
        assert_eq!(warp(&control, a), Vector::xy(0.0, 1.0));
        assert!(warp(&control, Vector::xy(0.5, 0.5)).is_finite());
        assert!(warp(&control, Vector::xy(1e-150, 0.0)).is_finite());
    }

    #[test]
    fn a_stick_in_space_turns_without_twisting() {
        // Control points on the x axis go to the y axis; the z direction is free and must stay.
        let axis = |k: f64| (Vector([k, 0.0, 0.0]), Vector([0.0, k, 0.0]));
        let control = [axis(0.0), axis(1.0), axis(2.0)];
        let image = warp(&control, Vector([1.0, 0.0, 0.5]));
        assert!((image - Vector([0.0, 1.0, 0.5])).norm() < 1e-3, "{image:?}");
    }

    #[test]
    fn a_bent_row_keeps_lengths_across() {
        // A straight row bent to a quarter circle: a short stroke across stays across and as long.
        let bent = |x: f64| Vector::xy(4.0 * (x / 4.0).sin(), 4.0 - 4.0 * (x / 4.0).cos());
        let control: Vec<_> = (0..13).map(|k| f64::from(k) * 0.5).map(|x| (Vector::xy(x, 0.0), bent(x))).collect();
        let (low, high) = (warp(&control, Vector::xy(3.0, -0.2)), warp(&control, Vector::xy(3.0, 0.2)));
        assert!(((high - low).norm() - 0.4).abs() < 0.02);
        let across = Vector::xy(-(0.75_f64).sin(), (0.75_f64).cos());
        assert!(((high - low).dot(across) - 0.4).abs() < 0.02);
    }
}
