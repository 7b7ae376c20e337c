//! A lattice of the plane laid on a surface: rows of bricks around a dome.
//!
//! Points are scattered over the surface, each with the two axes of the pattern there. Every point gets the place of the pattern that lies
//! on it, as a phase: a vector up to those of the lattice. Along a link between neighbours the phase should change by the way from
//! one to the other, seen in their axes [Jakob 2015; Knoppel 2015]. Phases spread from one point over the whole surface, and are then
//! evened out. Where the surface bends or the axes turn so that no lattice can follow, it breaks, in as few places as that needs.

mod cell;
mod laid;
mod links;
mod phases;
mod places;
mod rows;

pub use laid::SurfaceLattice;
pub use links::Axes;
pub use places::LatticePlace;
pub use rows::RowSite;
