//! Nodes that belong together: what hangs below nodes that repeat is one element of several meshes.

mod build;
mod choose;
mod tree;

use arabesque_core::{Budget, Result};
pub(in crate::mesh) use tree::{Branch, Tree};

use self::{
    build::built,
    choose::Look,
    tree::{boxes, candidates},
};
use super::model::Scene;

/// Work of one node.
const PER_NODE: u64 = 2000;
/// An element has no more parts.
const PARTS: usize = 256;

impl Scene {
    /// The same scene with one node, which shows one mesh of several parts ([`super::SceneMesh::parts`]), for each branch of its tree that
    /// is one element: where the file says so; where other branches hold the same meshes, in the same places to one another or near to
    /// one another; where they are called alike, and so are their parts; and what stands beside such branches and is not larger. A branch
    /// that gathers elements, such as a collection or the root of all, is none.
    ///
    /// # Errors
    /// Those of the budget.
    pub(in crate::mesh) fn assembled(self, tree: &Tree, budget: &Budget) -> Result<Self> {
        budget.spend(PER_NODE.saturating_mul((self.nodes.len() + tree.branches.len()) as u64))?;
        let found = candidates(&self, tree, PARTS);
        if found.is_empty() {
            return Ok(self);
        }
        let boxes = boxes(&self);
        let chosen = Look { scene: &self, tree, candidates: &found, boxes: &boxes, budget }.chosen()?;
        if !chosen.is_empty() {
            let chosen: Vec<_> = chosen.into_iter().map(|k| &found[k]).collect();
            return built(self, (tree, &chosen, &boxes), budget);
        }
        // Copies may each have meshes of their own.
        let shared = self.clone().share_shapes(budget)?;
        if shared.meshes.len() == self.meshes.len() {
            return Ok(self);
        }
        let found = candidates(&shared, tree, PARTS);
        let chosen = Look { scene: &shared, tree, candidates: &found, boxes: &boxes, budget }.chosen()?;
        if chosen.is_empty() {
            return Ok(self);
        }
        let chosen: Vec<_> = chosen.into_iter().map(|k| &found[k]).collect();
        built(shared, (tree, &chosen, &boxes), budget)
    }
}
