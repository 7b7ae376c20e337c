//! Square matrices, rotations above all.

use crate::space::Vector;

/// A square matrix, row by row: `m.0[r][c]`. Rotations are matrices with orthonormal rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix<const D: usize>(pub [[f64; D]; D]);

impl<const D: usize> Matrix<D> {
    /// The identity.
    #[inline]
    pub fn identity() -> Self {
        Self(std::array::from_fn(|r| std::array::from_fn(|c| f64::from(u8::from(r == c)))))
    }

    /// All zero.
    #[inline]
    pub const fn zero() -> Self {
        Self([[0.0; D]; D])
    }

    /// The transposed matrix: the inverse of a rotation.
    #[inline]
    pub fn transpose(&self) -> Self {
        Self(std::array::from_fn(|r| std::array::from_fn(|c| self.0[c][r])))
    }

    /// Matrix times column vector.
    #[inline]
    pub fn apply(&self, v: Vector<D>) -> Vector<D> {
        Vector(std::array::from_fn(|r| (0..D).map(|c| self.0[r][c] * v.0[c]).sum()))
    }

    /// Matrix product `self * other`.
    #[inline]
    pub fn compose(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|r| std::array::from_fn(|c| (0..D).map(|k| self.0[r][k] * other.0[k][c]).sum())))
    }

    /// The rotation nearest to this matrix in the Frobenius norm; the identity for a zero matrix. By singular values in any dimension.
    #[inline]
    pub fn nearest_rotation(&self) -> Self {
        let m = nalgebra::DMatrix::from_fn(D, D, |r, c| self.0[r][c]);
        if m.norm() <= f64::MIN_POSITIVE || m.iter().any(|v| !v.is_finite()) {
            return Self::identity();
        }
        let svd = m.svd(true, true);
        let (Some(mut u), Some(vt)) = (svd.u, svd.v_t) else {
            return Self::identity();
        };
        if (&u * &vt).determinant() < 0.0 {
            // Flip the axis of the smallest singular value, so that the result is a proper rotation.
            let last = svd.singular_values.imin();
            u.column_mut(last).neg_mut();
        }
        let q = u * vt;
        Self(std::array::from_fn(|r| std::array::from_fn(|c| q[(r, c)])))
    }

    /// [`Matrix::nearest_rotation`], in the plane in closed form: many times faster there, and the same except for the last bits.
    pub(crate) fn nearest_rotation_fast(&self) -> Self {
        if D != 2 {
            return self.nearest_rotation();
        }
        let (cos, sin) = (self.0[0][0] + self.0[1][1], self.0[1][0] - self.0[0][1]);
        let length = cos.hypot(sin);
        if length <= 0.0 || !length.is_finite() {
            return Self::identity();
        }
        let entries = [[cos / length, -sin / length], [sin / length, cos / length]];
        Self(std::array::from_fn(|r| std::array::from_fn(|c| entries[r][c])))
    }
}

impl Matrix<2> {
    /// Rotation that turns the x axis towards the y axis by `radians`.
    #[inline]
    pub fn rotation(radians: f64) -> Self {
        let (s, c) = radians.sin_cos();
        Self([[c, -s], [s, c]])
    }

    /// Angle of a rotation in radians, in (-pi, pi].
    #[inline]
    pub fn angle(&self) -> f64 {
        self.0[1][0].atan2(self.0[0][0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Stage, Stream};

    #[test]
    #[inline]
    fn the_fast_way_to_the_nearest_rotation_leads_to_the_same_one() {
        let mut stream = Stream::new(8, Stage::TEST, 0);
        for _ in 0..200 {
            let m = Matrix::<2>(std::array::from_fn(|_| std::array::from_fn(|_| stream.range(-2.0, 2.0))));
            let turned = m.nearest_rotation().angle() - m.nearest_rotation_fast().angle();
            // Where a mirror image is as near, any rotation is.
            let even = (m.0[0][0] + m.0[1][1]).hypot(m.0[1][0] - m.0[0][1]);
            assert!(even < 1e-6 || turned.sin().abs() < 1e-9 && turned.cos() > 0.0, "{m:?}: {turned}");
        }
        assert_eq!(Matrix::<2>::zero().nearest_rotation_fast(), Matrix::identity());
    }

    #[test]
    #[inline]
    fn nearest_rotation_of_a_scaled_rotation_is_that_rotation() {
        let r = Matrix::<2>::rotation(0.7);
        let scaled = Matrix(r.0.map(|row| row.map(|v| v * 3.0)));
        assert!((scaled.nearest_rotation().angle() - 0.7).abs() < 1e-12);
    }

    #[test]
    #[inline]
    fn nearest_rotation_never_mirrors() {
        let mirror = Matrix([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -0.1]]);
        let q = mirror.nearest_rotation();
        let det = q.0[0][0] * (q.0[1][1] * q.0[2][2] - q.0[1][2] * q.0[2][1])
            - q.0[0][1] * (q.0[1][0] * q.0[2][2] - q.0[1][2] * q.0[2][0])
            + q.0[0][2] * (q.0[1][0] * q.0[2][1] - q.0[1][1] * q.0[2][0]);
        assert!((det - 1.0).abs() < 1e-9);
    }
}
