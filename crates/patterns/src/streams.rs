//! The stages of a run that draw random numbers. Results depend on the numbers; 3 and 4 stay free
//! for deciding on existence and for clearance.

use arabesque_core::Stage;

/// Laying out the first samples.
pub(crate) const INITIALISE: Stage = Stage::new(1);
/// Random candidates of the search.
pub(crate) const SEARCH: Stage = Stage::new(2);
