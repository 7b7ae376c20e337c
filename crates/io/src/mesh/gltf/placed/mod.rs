//! A scene as GLB whose elements can be changed: nodes that do not change keep their text, and meshes their bytes.
//!
//! An element is a node that shows a mesh of triangles, or one with nodes below it that do. Numbers of elements are the places of their nodes; once elements are gone, `asset`
//! says the numbers that are left. An element that is painted in another way shows a copy of its mesh with a material of its own.
//!
//! `elements` reads and writes the document, `node` a node of it, and `looks` meshes and materials; `text` is the same for glTF as text.

mod elements;
mod looks;
mod node;
#[cfg(test)]
mod tests;
mod text;

pub use elements::GlbElements;
pub use text::GltfElements;
