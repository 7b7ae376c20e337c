//! What a command may use up: limits, what was drawn of them so far, and whether somebody asked to stop.

mod account;
mod limits;
mod meter;
mod stop;

pub use account::{Budget, Held};
pub use limits::Limits;
pub use meter::Meter;
pub use stop::{Cause, Stopper};
