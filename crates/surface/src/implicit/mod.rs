//! Functions that are zero on a surface and positive outside of it, at the nodes of a sparse grid.

mod blocks;
mod metaballs;
mod rimls;

pub(crate) use blocks::{BLOCK, Blocks, Field, Node, SIDE};
pub(crate) use metaballs::{Balls, metaballs};
pub(crate) use rimls::{Kernel, Oriented, border_offset, rimls, rimls_bytes};
