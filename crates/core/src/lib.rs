//! The vocabulary of arabesque.
//!
//! | word | type |
//! |---|---|
//! | exemplar | [`Exemplar`]: the small example, as [`Element`]s with [`Outline`]s in [`Class`]es, and [`Curve`]s along [`Path`]s |
//! | domain | [`Domain`]: box, torus, or any [`Region`] such as a [`Shape`] |
//! | fields | [`Fields`]: orientation, scale and density over the domain |
//! | request | [`Request`]: domain, border, fields, frozen parts, seed |
//! | outcome | [`Outcome`]: [`Placement`]s and [`Drawn`] curves, energy trace, warnings |
//!
//! Methods take an exemplar and a request, tell an [`Observer`] how they fare, and return an outcome.
//! Nothing here reads files, prints, or synthesises.

mod arc;
mod bounds;
mod domain;
mod error;
mod exemplar;
mod field;
mod grid_index;
mod image;
mod limits;
mod observer;
mod outcome;
mod outline;
mod patch;
mod path;
mod random;
mod request;
mod shape;
mod similarity;
mod vector;

pub use arc::Measured;
pub use bounds::Bounds;
pub use domain::{Domain, Region};
pub use error::{Error, Result};
pub use exemplar::{Class, Curve, Element, Exemplar, Role, View};
pub use field::{Fields, FlowStroke, Frame, Grid, OrientationField, ScalarField};
pub use grid_index::GridIndex;
pub use image::Image;
pub use limits::Limits;
pub use observer::{Observer, Preview, Progress, Unobserved};
pub use outcome::{Drawn, EnergyPoint, Outcome, Placement, StopReason, Warning};
pub use outline::{FillRule, Outline, Ring, ring_area};
pub use patch::Patch;
pub use path::{Cubic, Path, cubic_at, cubic_part, straight};
pub use random::{Stage, Stream};
pub use request::{Border, Request};
pub use shape::Shape;
pub use similarity::Similarity;
pub use vector::{Matrix, Vector};
