//! Geometry textures from point-set surfaces [Duranleau 2008].

mod canvas;
mod chart;
mod fft;
mod field;
mod gap;
mod hole;
mod mask;
mod on_mesh;
mod pairing;
mod params;
mod patch;
mod plane;
mod prepared;
mod relax;
mod repetition;
mod request;
mod sample;
mod search;
mod spline;
mod store;
mod texture;

pub use params::{Plane, ReliefParams, Search};
pub use prepared::Prepared;
pub use request::{Ground, ReliefOutcome, ReliefRequest, Statistics};
pub use texture::Axes;
