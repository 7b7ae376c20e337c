//! Points and offsets in two or three dimensions.

use std::ops::{Add, AddAssign, Index, IndexMut, Mul, Neg, Sub, SubAssign};

/// A point or an offset of `D` coordinates, in the exemplar's units unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<const D: usize>(pub [f64; D]);

impl<const D: usize> Vector<D> {
    /// The origin.
    pub const ZERO: Self = Self([0.0; D]);

    /// The same value in every coordinate.
    #[inline]
    pub const fn splat(value: f64) -> Self {
        Self([value; D])
    }

    /// Inner product.
    #[inline]
    pub fn dot(self, other: Self) -> f64 {
        (0..D).map(|k| self.0[k] * other.0[k]).sum()
    }

    /// Squared length.
    #[inline]
    pub fn norm2(self) -> f64 {
        self.dot(self)
    }

    /// Length.
    #[inline]
    pub fn norm(self) -> f64 {
        self.norm2().sqrt()
    }

    /// The vector at length 1. A vector without a length has no direction: its coordinates are NaN then.
    #[inline]
    pub fn unit(self) -> Self {
        self * (1.0 / self.norm())
    }

    /// The vector at length 1; zero stays zero.
    #[inline]
    pub fn unit_or_zero(self) -> Self {
        self * (1.0 / self.norm().max(f64::MIN_POSITIVE))
    }

    /// The vector at length 1, or `None` when it is no longer than `least`.
    #[inline]
    pub fn unit_if_longer(self, least: f64) -> Option<Self> {
        let length = self.norm();
        (length > least).then(|| self * (1.0 / length))
    }

    /// Cosine of the angle between two vectors, in [-1, 1]; 0 when either is zero.
    #[inline]
    pub fn cosine(self, other: Self) -> f64 {
        (self.dot(other) / (self.norm() * other.norm()).max(f64::MIN_POSITIVE)).clamp(-1.0, 1.0)
    }

    /// Applies `f` to each coordinate.
    #[inline]
    pub fn map(self, f: impl FnMut(f64) -> f64) -> Self {
        Self(self.0.map(f))
    }

    /// Combines two vectors coordinate by coordinate.
    #[inline]
    pub fn zip(self, other: Self, mut f: impl FnMut(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|k| f(self.0[k], other.0[k])))
    }

    /// Whether every coordinate is a finite number.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.0.iter().all(|c| c.is_finite())
    }
}

impl Vector<2> {
    /// The vector with coordinates `x` and `y`.
    #[inline]
    pub const fn xy(x: f64, y: f64) -> Self {
        Self([x, y])
    }

    /// z coordinate of the cross product: positive when `other` lies counter-clockwise of `self` in a y-up frame.
    #[inline]
    pub fn cross(self, other: Self) -> f64 {
        self.0[0] * other.0[1] - self.0[1] * other.0[0]
    }

    /// Angle from this vector to `other` in radians, in [-pi, pi]: positive when it turns from x towards y.
    #[inline]
    pub fn angle_to(self, other: Self) -> f64 {
        self.cross(other).atan2(self.dot(other))
    }
}

impl Vector<3> {
    /// Cross product: perpendicular to both, as long as the area between them.
    #[inline]
    pub fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }
}

impl<const D: usize> Default for Vector<D> {
    #[inline]
    fn default() -> Self {
        Self::ZERO
    }
}

impl<const D: usize> Index<usize> for Vector<D> {
    type Output = f64;
    #[inline]
    fn index(&self, k: usize) -> &f64 {
        &self.0[k]
    }
}

impl<const D: usize> IndexMut<usize> for Vector<D> {
    #[inline]
    fn index_mut(&mut self, k: usize) -> &mut f64 {
        &mut self.0[k]
    }
}

impl<const D: usize> Add for Vector<D> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<const D: usize> Sub for Vector<D> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<const D: usize> Mul<f64> for Vector<D> {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f64) -> Self {
        self.map(|a| a * factor)
    }
}

impl<const D: usize> Neg for Vector<D> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl<const D: usize> AddAssign for Vector<D> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const D: usize> SubAssign for Vector<D> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn units_point_the_same_way_whatever_becomes_of_zero(x in -1e3..1e3, y in -1e3..1e3, z in -1e3..1e3) {
            let v = Vector([x, y, z]);
            prop_assume!(v.norm() > 1e-6);
            for unit in [v.unit(), v.unit_or_zero(), v.unit_if_longer(1e-6).unwrap()] {
                prop_assert!((unit.norm() - 1.0).abs() < 1e-12 && (unit.cosine(v) - 1.0).abs() < 1e-12);
            }
        }

        #[test]
        fn angles_add_up(a in -3.0..3.0, b in -3.0..3.0_f64) {
            let at = |angle: f64| Vector::xy(angle.cos(), angle.sin());
            let turned = at(a).angle_to(at(b));
            prop_assert!((Vector::xy(turned.cos(), turned.sin()) - at(b - a)).norm() < 1e-12);
            prop_assert!((turned.cos() - at(a).cosine(at(b))).abs() < 1e-12);
        }
    }

    #[test]
    #[inline]
    fn a_vector_without_length_has_no_direction() {
        let zero = Vector::<3>::ZERO;
        assert_eq!((zero.unit_or_zero(), zero.unit_if_longer(0.0)), (zero, None));
        assert!(!zero.unit().is_finite());
        assert_eq!(zero.cosine(Vector([1.0, 0.0, 0.0])), 0.0);
        assert!(Vector::xy(0.5, 0.0).unit_if_longer(0.5).is_none());
    }
}
