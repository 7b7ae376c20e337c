//! Meshes of things that bend: their centre line, balls that stand for them, and the mesh once samples of it have moved.

mod balls;
mod skin;
#[cfg(test)]
mod tests;
mod tube;

pub use balls::balls;
pub use skin::Skin;
pub use tube::Tube;
