//! Pictures of points and meshes: a small renderer without perspective, made so that structure can be read.
//!
//! Everything is drawn four times as finely as it is shown: depth, direction and colour of what is in front (`frame`, `triangles`,
//! `dabs`). Light comes from the upper left of the eye, and weaker from its right and from all around; what lies deep between other
//! things is darker, by how much of the space around it they fill (`occlusion`), and what is far off a little paler (`light`). So
//! folds, crossings and gaps are seen without any shadow that would have to be understood.

mod dabs;
mod frame;
mod light;
mod normals;
mod occlusion;
mod palette;
mod picture;
mod spacing;
mod subject;
#[cfg(test)]
mod tests;
mod triangles;
mod view;

pub use picture::{Background, Extent, Look, draw, write_picture, write_picture_within};
pub use subject::Item;
pub use view::View;
