//! Where pieces may lie: what must stay free, what each piece may show, and which positions that leaves.

pub(crate) mod demands;
pub(crate) mod mask;
pub(crate) mod valid;
