//! Elements in space that push one another apart, fall and come to rest [Ma 2011 §5].
//!
//! The paper runs a few steps of a physics solver after each search and assignment, so that elements neither run into one another nor
//! float: an energy term that nobody has to write down. Here the solver is rapier, alone in this room; methods never know of it, and whoever
//! runs one calls [`World::place`] and [`World::substeps`] between its iterations, and [`World::settle`] at the end.
//!
//! | step | module | source |
//! |---|---|---|
//! | a mesh becomes a solid: ball, box, convex hull, or several hulls; each of its pieces by itself | `shape`, `pieces` | |
//! | floors, walls, obstacles and containers | `surroundings`, `guard` | [Ma 2011 §5, "domain shape"] |
//! | a few gentle steps, or steps until all is at rest | `world`, over the sets of the solver in `scene` | [Ma 2011 §5, "interleaved physics solver"; fig. 15] |
//! | how deep things are in one another, and what floats | `figures` | [Ma 2011 fig. 15] |
//!
//! Where it departs from the paper:
//!
//! - Steps begin at rest, motion is damped and bounded by a share of an element's size, so that the pattern stays what it was.
//! - What the solver loses (a pose that is not a number, a fall out of the scene, a way through a surface) goes back to where it was; where
//!   all bursts apart, everything goes back to where it was shortly before. It is told.
//! - Where elements may reach over the sides of a box, their middles stay in it, as if the pile went on beyond.
//! - Masses lie within a factor of 20 of the median: the solver does badly with a pea below a pumpkin.
//!
//! The solver runs on one thread, from fresh sets in each call: the same bodies give the same bytes whatever ran before and however many threads
//! there are. Its feature `enhanced-determinism` makes results the same on all machines as well, for slower arithmetic; as the rest of
//! the house promises the same bytes on one machine, it is left off.

mod clearance;
mod figures;
mod guard;
mod params;
mod pieces;
mod scene;
mod setting;
mod shape;
mod surroundings;
mod units;
mod world;

pub use clearance::clearance;
pub use figures::Figures;
pub use params::PhysicsParams;
pub use setting::Body;
pub use shape::{Collider, Shape};
pub use surroundings::{Side, Surface, Surroundings, Wall};
pub use world::{Run, World};
