//! Style sheets before the selector parser sees them: what it would stumble over is taken out, and told.

pub(crate) mod declarations;
pub(crate) mod rules;
pub(crate) mod variables;
