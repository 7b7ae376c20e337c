//! Places spread over meshes: on the surface, in a shell around it, and inside.

mod blocks;
mod scatter;

pub use blocks::{inside_grid, shell_grid};
pub use scatter::scatter;
