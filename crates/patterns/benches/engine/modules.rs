// The modules of the engine, in step with `src/lib.rs`, so that a benchmark can time one stage: stages are private to the crate. For
// `include!` in the root of a benchmark.

#[path = "../../src/assignment.rs"]
mod assignment;
#[path = "../../src/attributes.rs"]
mod attributes;
#[path = "../../src/buckets.rs"]
mod buckets;
#[path = "../../src/canvas.rs"]
mod canvas;
#[path = "../../src/clearance/mod.rs"]
mod clearance;
#[path = "../../src/coverage.rs"]
mod coverage;
#[path = "../../src/curves/mod.rs"]
mod curves;
#[path = "../../src/deform.rs"]
mod deform;
#[path = "../../src/engine.rs"]
mod engine;
#[path = "../../src/existence.rs"]
mod existence;
#[path = "../../src/extent.rs"]
mod extent;
#[path = "../../src/features.rs"]
mod features;
#[path = "../../src/finish.rs"]
mod finish;
#[path = "../../src/frozen.rs"]
mod frozen;
#[path = "../../src/grains.rs"]
mod grains;
#[path = "../../src/grow.rs"]
mod grow;
#[path = "../../src/kinds.rs"]
mod kinds;
#[path = "../../src/layout.rs"]
mod layout;
#[path = "../../src/level.rs"]
mod level;
#[path = "../../src/library.rs"]
mod library;
#[path = "../../src/matching.rs"]
mod matching;
#[path = "../../src/noise.rs"]
mod noise;
#[path = "../../src/params.rs"]
mod params;
#[path = "../../src/positions.rs"]
mod positions;
#[path = "../../src/run.rs"]
mod run;
#[path = "../../src/samples.rs"]
mod samples;
#[path = "../../src/search.rs"]
mod search;
#[path = "../../src/setting.rs"]
mod setting;
#[path = "../../src/solver.rs"]
mod solver;
#[path = "../../src/streams.rs"]
mod streams;
#[path = "../../src/state.rs"]
mod state;
#[path = "../../src/targets.rs"]
mod targets;
