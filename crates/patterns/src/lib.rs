//! Sample-graph synthesis.

mod assignment;
mod attributes;
mod buckets;
mod canvas;
mod clearance;
mod coverage;
mod deform;
mod engine;
mod existence;
mod extent;
mod features;
mod grow;
mod level;
mod library;
mod matching;
mod noise;
mod params;
mod positions;
mod samples;
mod search;
mod solver;
mod state;
mod targets;

pub use clearance::overlap_ratio;
pub use deform::warp;
pub use engine::Prepared;
pub use params::{Attributes, Clearance, Deform, Existence, Initialisation, Matching, OptionInfo, Params, Search};
