//! Repetitive structures as sums of Gaussians [Roveri 2015].

#![allow(clippy::needless_range_loop, reason = "coordinates are numbered alike in many arrays at once")]

mod energy;
mod exemplar;
mod layout;
mod output;
mod params;
mod prepared;
mod request;
mod run;
mod solve;
mod start;
mod territory;

pub use params::{Start, StructureParams, Window};
pub use prepared::Prepared;
pub use request::{PlacedElement, StructureOutcome, StructureRequest};
pub use territory::{
    Site, SitePlan, Territory,
    flat::Flat,
    shell::Shell,
    solid::Solid,
    tube::{Along, Thread, Tube},
};
