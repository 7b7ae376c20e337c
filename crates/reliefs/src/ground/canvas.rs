//! What patches are laid on.

use arabesque_core::Result;

use crate::{ground::relax::Period, patch::notes::Notes, sample::Sample};

/// A ground that is covered patch by patch.
pub(crate) trait Canvas {
    /// Lays the next patch; `None` when there is none left.
    fn step(&mut self) -> Result<Option<Notes>>;

    /// How many there will be, about.
    fn steps(&self) -> usize;

    /// Points so far.
    fn count(&self) -> usize;

    /// The points of the result, in its frame: what is beyond its border is cut off [Duranleau 2008 §4, step 8].
    fn samples(&self) -> Vec<Sample>;

    /// The same, when no more patches are laid.
    fn into_samples(self: Box<Self>) -> Vec<Sample>;

    /// How the result repeats.
    fn period(&self) -> Period {
        None
    }

    /// The sides of the rectangle from the origin that points may not leave.
    fn extent(&self) -> Option<[f64; 2]> {
        None
    }

    /// Whether samples are in the frame of the texture, whose plane is x, y: not so for what stands on a mesh.
    fn is_flat(&self) -> bool {
        true
    }

    /// How much larger than the texture the result is.
    fn scale(&self) -> f64 {
        1.0
    }
}
