//! Elements one by one: what each of them is, and whether it is as it should be.

pub(crate) mod shapes;
pub(crate) mod told;
