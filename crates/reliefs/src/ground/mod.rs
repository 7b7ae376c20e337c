//! Where patches are laid, and what is there so far.

pub(crate) mod canvas;
pub(crate) mod chart;
pub(crate) mod hole;
pub(crate) mod on_mesh;
pub(crate) mod plane;
pub(crate) mod relax;
pub(crate) mod store;
