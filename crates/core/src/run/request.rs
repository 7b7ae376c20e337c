//! What to make: domain, fields, frozen parts and seed of one run.

use std::{fmt::Debug, sync::Arc};

use crate::{
    budget::Budget,
    choices,
    error::Result,
    field::Fields,
    region::{Domain, Ground, Outline},
    run::{Drawn, Placement},
    space::Bounds,
};

choices! {
    /// What happens where elements and strokes meet the border of the domain.
    pub enum Border {
        /// Elements lie wholly inside.
        Inside = "inside",
        /// Elements with their centre inside stay whole and may reach over the border.
        Cross = "cross",
        /// Whatever reaches into the domain is drawn, cut at the border.
        Clip = "clip",
        /// Strokes turn at the border and run along it; elements lie wholly inside.
        ///
        /// Strokes that reach the border run along it to their neighbour and come back as that, or where strokes of the exemplar branch,
        /// end on a stroke all along the border. All ink lies inside. On a torus, which has no border, and in space strokes are cut as
        /// for `Inside`.
        Turn = "turn",
    }
}

impl Default for Border {
    /// [`Border::Clip`].
    fn default() -> Self {
        Self::Clip
    }
}

/// What moves elements between the steps of a run, such as physics [Ma 2011 §5].
pub trait Between<const D: usize>: Debug + Send + Sync {
    /// Moves and turns elements a little; frozen ones stay, and none comes or goes. The same placements must always end in the same ones.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    fn step(&self, placements: &mut [Placement<D>], budget: &Budget) -> Result<()>;
}

/// What to make from a prepared exemplar.
#[derive(Clone, Debug)]
pub struct Request<const D: usize> {
    /// Where the output may lie.
    pub domain: Domain<D>,
    /// What happens at its border. Default: [`Border::Clip`].
    pub border: Border,
    /// What the elements of the exemplar that stand on the ground stand on here; without it they may be anywhere. Default none.
    pub ground: Option<Arc<dyn Ground<D>>>,
    /// How the pattern is turned, scaled and thinned.
    pub fields: Fields<D>,
    /// Elements that stay exactly where they are; the rest is fitted around them. Their `frozen` entry is ignored on input.
    pub frozen: Vec<Placement<D>>,
    /// Strokes that stay exactly where they are; new ones join them. Their `frozen` entry is ignored on input.
    pub frozen_curves: Vec<Drawn<D>>,
    /// Ink that is in the way but is not an element of the exemplar, in output coordinates: nothing may overlap it.
    pub obstacles: Vec<Outline<D>>,
    /// Box in which everything outside the domain stays as it is, so that new strokes end where the domain does. Default none.
    pub known: Option<Bounds<D>>,
    /// What moves elements after each step of a run. Default none.
    pub between: Option<Arc<dyn Between<D>>>,
    /// Seed of all random choices. Default 0.
    pub seed: u64,
    /// What the run may use up.
    pub budget: Budget,
}

impl<const D: usize> Request<D> {
    /// Fills `domain` with everything else at its default.
    pub fn new(domain: Domain<D>) -> Self {
        Self {
            domain,
            border: Border::default(),
            ground: None,
            fields: Fields::default(),
            frozen: Vec::new(),
            frozen_curves: Vec::new(),
            obstacles: Vec::new(),
            known: None,
            between: None,
            seed: 0,
            budget: Budget::default(),
        }
    }
}
