//! The ribbon around a curve, in the plane and in space.

pub(crate) mod cage;
pub(crate) mod space;
