//! Functions that are zero on a surface and positive outside of it, at the nodes of a sparse grid.

mod blocks;
mod metaballs;
mod rimls;

#[cfg(test)]
pub(crate) use blocks::Blocks;
pub(crate) use blocks::{BLOCK, Field, Node, SIDE};
pub(crate) use metaballs::{Balls, metaballs};
pub(crate) use rimls::{Kernel, Oriented, border_offset, rimls};
