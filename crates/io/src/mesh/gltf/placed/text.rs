//! A scene as text, changed as the GLB file that it stands for.

use arabesque_core::{Budget, Result};

use super::GlbElements;
use crate::{
    mesh::gltf::container::{as_text, from_text},
    placed::layout::{Changes, Layout, PlacedFile},
};

/// A scene as `.gltf`, with the elements in it.
#[derive(Debug)]
pub struct GltfElements(GlbElements);

impl GltfElements {
    /// The elements of a scene whose bytes stand in it.
    ///
    /// # Errors
    /// As [`GlbElements::open`]; [`arabesque_core::Error::Unsupported`] for a text whose bytes lie elsewhere.
    pub fn open(name: &str, text: &str, budget: &Budget) -> Result<Self> {
        GlbElements::open(name, &from_text(name, text, budget)?, budget).map(Self)
    }
}

impl PlacedFile<3> for GltfElements {
    fn layout(&self) -> &Layout<3> {
        self.0.layout()
    }

    fn rewritten(&self, changes: &Changes<3>, recipe: Option<&str>, budget: &Budget) -> Result<Vec<u8>> {
        as_text(&self.0.rewritten(changes, recipe, budget)?, budget)
    }
}
