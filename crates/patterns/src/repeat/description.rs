//! What is known of a repeat.

use arabesque_core::Vector;

use crate::repeat::{lattice::Lattice, marks::Anchor};

/// What a lattice explains of an exemplar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Explains {
    /// Everything: what is there, and where.
    Everything,
    /// Where elements are, but not which ones.
    Places,
}

/// In which directions an exemplar repeats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// In two independent ones.
    Plane,
    /// In one; along the other, of this direction, nothing changes: stripes.
    Stripes(Vector<2>),
    /// In one: a frieze. The second vector is the height of the frame.
    Frieze,
}

/// What an exemplar repeats by.
#[derive(Clone, Debug, PartialEq)]
pub struct Repeat {
    /// The translations that take it to itself.
    pub lattice: Lattice,
    /// What they explain.
    pub explains: Explains,
    /// Whether both vectors were found in the exemplar.
    pub extent: Extent,
    /// The point of an element that lies on the lattice.
    pub anchor: Anchor,
    /// Root mean square distance of the marks of the exemplar from where the lattice has them, in its units.
    pub jitter: f64,
    /// Share of the marks that the lattice takes to others of their kind, in [0, 1].
    pub share: f64,
}

impl Repeat {
    /// A lattice of the plane that a drawing is made on, and that explains all of it.
    pub(crate) fn drawn(lattice: Lattice) -> Self {
        let (explains, extent) = (Explains::Everything, Extent::Plane);
        Self { lattice, explains, extent, anchor: Anchor::Centre, jitter: 0.0, share: 1.0 }
    }
}
