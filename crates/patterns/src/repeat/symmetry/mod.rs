//! The symmetry of what repeats: which of the seventeen wallpaper groups, or of the seven frieze groups, an exemplar has.
//!
//! A group is known by its operations beside the translations: rotations by a half, a third, a quarter or a sixth of a
//! turn, reflections and glides. Only those that take the lattice to itself need to be asked. Where each of them would
//! move things is read off marks of the kind of which a cell has fewest, and whether it takes the whole content of the
//! cell to itself is then looked up. Nothing depends on where the cell was cut out ([Schattschneider 1978]).

mod content;
mod groups;
mod lines;
mod operations;
mod shapes;
mod torus;

pub use groups::{FriezeGroup, PlaneGroup, Symmetry};
pub use operations::symmetry;
