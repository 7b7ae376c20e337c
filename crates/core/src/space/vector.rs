//! Points, offsets and matrices in two or three dimensions.

use std::ops::{Add, AddAssign, Index, IndexMut, Mul, Neg, Sub, SubAssign};

/// A point or an offset of `D` coordinates, in the exemplar's units unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<const D: usize>(pub [f64; D]);

impl<const D: usize> Vector<D> {
    /// The origin.
    pub const ZERO: Self = Self([0.0; D]);

    /// The same value in every coordinate.
    pub const fn splat(value: f64) -> Self {
        Self([value; D])
    }

    /// Inner product.
    pub fn dot(self, other: Self) -> f64 {
        (0..D).map(|k| self.0[k] * other.0[k]).sum()
    }

    /// Squared length.
    pub fn norm2(self) -> f64 {
        self.dot(self)
    }

    /// Length.
    pub fn norm(self) -> f64 {
        self.norm2().sqrt()
    }

    /// Applies `f` to each coordinate.
    pub fn map(self, f: impl FnMut(f64) -> f64) -> Self {
        Self(self.0.map(f))
    }

    /// Combines two vectors coordinate by coordinate.
    pub fn zip(self, other: Self, mut f: impl FnMut(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|k| f(self.0[k], other.0[k])))
    }

    /// Whether every coordinate is a finite number.
    pub fn is_finite(self) -> bool {
        self.0.iter().all(|c| c.is_finite())
    }
}

impl Vector<2> {
    /// The vector with coordinates `x` and `y`.
    pub const fn xy(x: f64, y: f64) -> Self {
        Self([x, y])
    }

    /// z coordinate of the cross product: positive when `other` lies counter-clockwise of `self` in a y-up frame.
    pub fn cross(self, other: Self) -> f64 {
        self.0[0] * other.0[1] - self.0[1] * other.0[0]
    }
}

impl<const D: usize> Default for Vector<D> {
    fn default() -> Self {
        Self::ZERO
    }
}

impl<const D: usize> Index<usize> for Vector<D> {
    type Output = f64;
    fn index(&self, k: usize) -> &f64 {
        &self.0[k]
    }
}

impl<const D: usize> IndexMut<usize> for Vector<D> {
    fn index_mut(&mut self, k: usize) -> &mut f64 {
        &mut self.0[k]
    }
}

impl<const D: usize> Add for Vector<D> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<const D: usize> Sub for Vector<D> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<const D: usize> Mul<f64> for Vector<D> {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        self.map(|a| a * factor)
    }
}

impl<const D: usize> Neg for Vector<D> {
    type Output = Self;
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl<const D: usize> AddAssign for Vector<D> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const D: usize> SubAssign for Vector<D> {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

/// A square matrix, row by row: `m.0[r][c]`. Rotations are matrices with orthonormal rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix<const D: usize>(pub [[f64; D]; D]);

impl<const D: usize> Matrix<D> {
    /// The identity.
    pub fn identity() -> Self {
        Self(std::array::from_fn(|r| std::array::from_fn(|c| f64::from(u8::from(r == c)))))
    }

    /// All zero.
    pub const fn zero() -> Self {
        Self([[0.0; D]; D])
    }

    /// The transposed matrix: the inverse of a rotation.
    pub fn transpose(&self) -> Self {
        Self(std::array::from_fn(|r| std::array::from_fn(|c| self.0[c][r])))
    }

    /// Matrix times column vector.
    pub fn apply(&self, v: Vector<D>) -> Vector<D> {
        Vector(std::array::from_fn(|r| (0..D).map(|c| self.0[r][c] * v.0[c]).sum()))
    }

    /// Matrix product `self * other`.
    pub fn compose(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|r| std::array::from_fn(|c| (0..D).map(|k| self.0[r][k] * other.0[k][c]).sum())))
    }

    /// The rotation nearest to this matrix in the Frobenius norm; the identity for a zero matrix.
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
}

impl Matrix<2> {
    /// Rotation that turns the x axis towards the y axis by `radians`.
    pub fn rotation(radians: f64) -> Self {
        let (s, c) = radians.sin_cos();
        Self([[c, -s], [s, c]])
    }

    /// Angle of a rotation in radians, in (-pi, pi].
    pub fn angle(&self) -> f64 {
        self.0[1][0].atan2(self.0[0][0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_rotation_of_a_scaled_rotation_is_that_rotation() {
        let r = Matrix::<2>::rotation(0.7);
        let scaled = Matrix(r.0.map(|row| row.map(|v| v * 3.0)));
        assert!((scaled.nearest_rotation().angle() - 0.7).abs() < 1e-12);
    }

    #[test]
    fn nearest_rotation_never_mirrors() {
        let mirror = Matrix([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -0.1]]);
        let q = mirror.nearest_rotation();
        let det = q.0[0][0] * (q.0[1][1] * q.0[2][2] - q.0[1][2] * q.0[2][1])
            - q.0[0][1] * (q.0[1][0] * q.0[2][2] - q.0[1][2] * q.0[2][0])
            + q.0[0][2] * (q.0[1][0] * q.0[2][1] - q.0[1][1] * q.0[2][0]);
        assert!((det - 1.0).abs() < 1e-9);
    }
}
