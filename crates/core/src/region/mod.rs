//! Areas: outlines with their boolean operations, shapes that answer distances, and domains; segments and rings, which they are made of;
//! how much two outlines are alike.

mod crossings;
mod domain;
mod edge_tree;
mod local;
mod outline;
mod overlay;
pub mod ring;
pub mod segment;
mod shape;
mod signature;

pub use domain::{Domain, Ground, Region};
pub use outline::{FillRule, Outline, Ring};
pub use shape::Shape;
pub use signature::{Fit, Signature};
