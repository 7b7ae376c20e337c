//! The version of arabesque that writes a recipe.

/// This version.
pub(super) fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}
