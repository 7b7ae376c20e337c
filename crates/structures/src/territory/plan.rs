//! What a territory is asked for.

use std::fmt;

use arabesque_core::{Bounds, Budget, Domain, Result, Vector};

use super::site::Site;

/// What sites are asked for.
#[derive(Clone, Copy, Debug)]
pub struct SitePlan<const D: usize> {
    /// Distance from one to the next, in the units of the exemplar: times the scale in the output.
    pub step: f64,
    /// How far beyond the border there are sites too, in the same units: what lies there is cut off at the end.
    pub margin: f64,
    /// The coordinates along which the exemplar repeats.
    pub base: [bool; D],
    /// The place of its base across itself.
    pub axis: Vector<D>,
    /// How far its points are from the base.
    pub thickness: f64,
    /// How far it is from where it looks like itself again, where it repeats regularly.
    pub repetition: Option<f64>,
}

/// Part of the plane or of space that a structure is made in.
pub trait Territory<const D: usize>: Send + Sync + fmt::Debug {
    /// Quadrature points all over it, in an order in which neighbours come near each other.
    ///
    /// # Errors
    /// When there is no room for one, or when the budget is used up.
    fn sites(&self, plan: &SitePlan<D>, budget: &Budget) -> Result<Vec<Site<D>>>;

    /// Whether a point of the output belongs to it. What is nearer to the base than the structure is thick, but beyond its border, does not.
    fn contains(&self, p: Vector<D>, plan: &SitePlan<D>) -> bool;

    /// A box around all that can come, or the torus that it comes around.
    fn surroundings(&self) -> Domain<D>;

    /// Length, area or volume of the base for an exemplar that repeats along so many directions.
    fn measure(&self, repeats: usize) -> f64;

    /// Smallest box around it.
    fn bounds(&self) -> Bounds<D> {
        self.surroundings().bounds()
    }
}
