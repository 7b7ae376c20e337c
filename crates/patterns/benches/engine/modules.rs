// The modules of the engine, in step with `src/lib.rs`, so that a benchmark can time one stage: stages are private to the crate. For
// `include!` in the root of a benchmark.

#[path = "../../src/border.rs"]
mod border;
#[path = "../../src/curves/mod.rs"]
mod curves;
#[path = "../../src/exemplar/mod.rs"]
mod exemplar;
#[path = "../../src/finish/mod.rs"]
mod finish;
#[path = "../../src/frozen.rs"]
mod frozen;
#[path = "../../src/layout/mod.rs"]
mod layout;
#[path = "../../src/optimise/mod.rs"]
mod optimise;
#[path = "../../src/output/mod.rs"]
mod output;
#[path = "../../src/params.rs"]
mod params;
#[path = "../../src/prepared.rs"]
mod prepared;
#[path = "../../src/run.rs"]
mod run;
