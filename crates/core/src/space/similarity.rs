//! Similarity transforms: turn, scale, shift.

use crate::space::{Matrix, Vector};

/// `p -> scale * rotation * p + translation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity<const D: usize> {
    /// A proper rotation.
    pub rotation: Matrix<D>,
    /// Positive scale factor.
    pub scale: f64,
    /// Shift, applied last.
    pub translation: Vector<D>,
}

impl<const D: usize> Similarity<D> {
    /// The transform that changes nothing.
    pub fn identity() -> Self {
        Self { rotation: Matrix::identity(), scale: 1.0, translation: Vector::ZERO }
    }

    /// A pure shift.
    pub fn shift(translation: Vector<D>) -> Self {
        Self { translation, ..Self::identity() }
    }

    /// Turn by `rotation` and scale by `scale` about `pivot`, which lands on `target`.
    pub fn about(pivot: Vector<D>, target: Vector<D>, rotation: Matrix<D>, scale: f64) -> Self {
        Self { rotation, scale, translation: target - rotation.apply(pivot) * scale }
    }

    /// Image of a point.
    pub fn apply(&self, p: Vector<D>) -> Vector<D> {
        self.apply_offset(p) + self.translation
    }

    /// Image of an offset: the shift plays no part.
    pub fn apply_offset(&self, v: Vector<D>) -> Vector<D> {
        self.rotation.apply(v) * self.scale
    }

    /// The transform that undoes this one.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        let scale = 1.0 / self.scale;
        Self { rotation, scale, translation: -(rotation.apply(self.translation) * scale) }
    }

    /// `self` after `first`.
    pub fn after(&self, first: &Self) -> Self {
        Self {
            rotation: self.rotation.compose(&first.rotation),
            scale: self.scale * first.scale,
            translation: self.apply(first.translation),
        }
    }

    /// Rigid motion times `scale` that best carries `from[i]` to `to[i]` in the least-squares sense [Umeyama 1991 §III].
    ///
    /// `from` and `to` run parallel. With fewer than two distinct points the rotation is `fallback`.
    pub fn fit(from: &[Vector<D>], to: &[Vector<D>], scale: f64, fallback: Matrix<D>) -> Self {
        let n = from.len().max(1) as f64;
        let mean = |points: &[Vector<D>]| points.iter().fold(Vector::ZERO, |sum, &p| sum + p) * (1.0 / n);
        let (a, b) = (mean(from), mean(to));
        let mut covariance = Matrix::<D>::zero();
        let mut spread = 0.0;
        for (&p, &q) in from.iter().zip(to) {
            let (p, q) = (p - a, q - b);
            spread += p.norm2();
            for r in 0..D {
                for c in 0..D {
                    covariance.0[r][c] += q[r] * p[c];
                }
            }
        }
        let rotation = if spread > 0.0 { covariance.nearest_rotation() } else { fallback };
        Self::about(a, b, rotation, scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fit_recovers_a_rigid_motion() {
        let motion = Similarity::about(Vector::xy(1.0, 2.0), Vector::xy(-3.0, 0.5), Matrix::rotation(1.1), 1.0);
        let from = [Vector::xy(0.0, 0.0), Vector::xy(2.0, 0.0), Vector::xy(0.5, 1.0)];
        let to = from.map(|p| motion.apply(p));
        let got = Similarity::fit(&from, &to, 1.0, Matrix::identity());
        for p in from {
            assert!((got.apply(p) - motion.apply(p)).norm() < 1e-12);
        }
    }

    #[test]
    fn inverse_undoes() {
        let m = Similarity { rotation: Matrix::rotation(0.4), scale: 2.5, translation: Vector::xy(7.0, -1.0) };
        let p = Vector::xy(3.0, 4.0);
        assert!((m.inverse().apply(m.apply(p)) - p).norm() < 1e-12);
        assert!((m.after(&m.inverse()).apply(p) - p).norm() < 1e-12);
    }
}
