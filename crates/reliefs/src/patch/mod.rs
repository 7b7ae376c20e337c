//! One patch: found, bent, blended.

pub(crate) mod blend;
pub(crate) mod cut;
pub(crate) mod mask;
pub(crate) mod notes;
pub(crate) mod pairing;
pub(crate) mod site;
pub(crate) mod spline;
pub(crate) mod usage;
pub(crate) mod warp;
