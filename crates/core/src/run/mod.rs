//! What a run is asked, what it tells on the way, and what it gives back.

mod outcome;
mod patch;
mod request;
mod watch;

pub use outcome::{Covered, Drawn, EnergyPoint, Instance, Outcome, Placement, StopReason, Warning};
pub use patch::Patch;
pub use request::{Between, Border, Request};
pub use watch::{Forecast, Progress, Snapshot, Unobserved, Watch};
