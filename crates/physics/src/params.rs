//! Parameters, with defaults that work.

use arabesque_core::params;

params! {
    /// How elements move. Lengths are in sizes of an element: the diameter of the ball of its volume.
    pub struct PhysicsParams {
        /// Friction between elements, and between them and what is around them.
        friction "friction": f64 = 0.5, in 0.0..=2.0;
        /// Farthest that an element moves in one call of substeps.
        reach "reach": f64 = 0.25, in 0.001..=100.0, unit "sizes";
        /// Farthest that an element turns in one call of substeps.
        turn "turn": f64 = 15.0, in 0.0..=180.0, unit "degrees";
        /// Most steps until all is at rest.
        steps "steps": usize = 400, in 1..=100_000;
        /// Speed below which an element counts as at rest.
        rest "rest": f64 = 0.05, in 0.0001..=1.0, unit "sizes per second";
    }
}
