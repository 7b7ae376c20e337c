//! Quadrature points with the frame of the pattern there.

use arabesque_core::{Matrix, Vector};

/// A quadrature point [Roveri 2015 §4.3], and how the pattern is turned and scaled there [Roveri 2015 §6.2].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site<const D: usize> {
    /// Where it is, on the base of the output: a curve, a surface, or anywhere in a volume.
    pub place: Vector<D>,
    /// From directions of the exemplar to directions of the output.
    pub rotation: Matrix<D>,
    /// Size of the pattern; 2 is twice as large as in the exemplar.
    pub scale: f64,
    /// Share of the base that it stands for, in steps of the sites at its scale; about 1.
    pub weight: f64,
}

impl<const D: usize> Site<D> {
    /// An offset of the output from here, as the exemplar has it.
    #[inline]
    pub(crate) fn seen(&self, offset: Vector<D>) -> [f64; D] {
        let per = 1.0 / self.scale;
        std::array::from_fn(|c| (0..D).map(|r| self.rotation.0[r][c] * offset[r]).sum::<f64>() * per)
    }

    /// An offset in the exemplar, as the output has it here.
    pub(crate) fn shown(&self, offset: Vector<D>) -> Vector<D> {
        self.rotation.apply(offset) * self.scale
    }
}
