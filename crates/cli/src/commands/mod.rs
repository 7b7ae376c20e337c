//! One file a subcommand.

pub(crate) mod completions;
pub(crate) mod edit;
pub(crate) mod fill;
pub(crate) mod inspect;
pub(crate) mod man;
pub(crate) mod measure;
pub(crate) mod relief;
pub(crate) mod ribbon;
pub(crate) mod run;
pub(crate) mod surface;
pub(crate) mod telling;
