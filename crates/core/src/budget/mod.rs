//! What a command may use up: limits, what was drawn of them so far, and whether somebody asked to stop.

mod account;
mod limits;
mod stop;

pub use account::{Budget, Held, Meter};
pub use limits::Limits;
pub use stop::{Cause, Stopper};
