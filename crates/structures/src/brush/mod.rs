//! A structure painted stroke by stroke.

pub(crate) mod session;
pub(crate) mod stroke;
#[cfg(test)]
mod tests;
