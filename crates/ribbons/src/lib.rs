//! Picture patterns along curves, undistorted and without repeating [Zhou 2013].
//!
//! The ribbon around a curve is cut into pieces. Each shows a part of an exemplar picture as it is: its left edge upright, its right edge
//! tilted by the turn of the curve. Which part, is the shortest path through all valid positions, where a step costs as much as the two
//! edges that meet differ; so the pattern goes on from piece to piece, finds its way around what is to be avoided, and bends without
//! being stretched.
//!
//! | step | module | source |
//! |---|---|---|
//! | cut the ribbon | `cage`, `space` | [Zhou 2013 §1.1, §1.3] |
//! | compare pixels and columns | `columns` | [Zhou 2013, "comparing pixels"; §1.3] |
//! | find valid positions | `valid`, `bits` | [Zhou 2013 §1.3, §2] |
//! | avoid regions, folds and overlaps | `mask` | [Zhou 2013 §3.1] |
//! | fill the rows of the table | `row`, `cluster` | [Zhou 2013 §1.4, eq. 1] |
//! | close closed curves | `solve` | [Zhou 2013 §1.5] |
//! | stitch | `stitch`, `piece` | [Zhou 2013 §3.2, eqs 2, 3] |
//! | draw | `render` | |
//!
//! | symbol | identifier |
//! |---|---|
//! | E, W, H | `Exemplar`, `Strip` |
//! | b, δ, s | [`Params::width`], [`Params::step`], 1 / [`Params::scale`] |
//! | ξ, γ | `columns::pixel_cost`, `columns::GAMMA` |
//! | u | `Position` |
//! | L, R, C | `Columns::left`, `Columns::right`, `Form::rows` |
//! | P\[i, u\] | `Row::cost` |
//! | Ω | [`Ribbon::cost`] |
//! | M, T, β | `stitch::table`, [`Piece::shift`], `stitch::SKIPPED` |
//!
//! Where it departs from the paper: half-transparent pixels have a cost in between; a place where the ribbon overlaps itself belongs to the
//! piece whose curve is nearest instead of to none; parts that were shown a short while ago cost more ([`Params::repetition`]) and a
//! random taste varies the pattern ([`Params::variety`]); several exemplars pass into one another; exemplars may have a start and an
//! end; rows of an earlier run are taken over ([`Prepared::resume`]). A closed curve without a cycle among the paths of the first pass
//! is searched again from its best start. Lower bounds on the difference of columns make the exact optimum fast.
//!
//! Not handled: stochastic backgrounds.

mod bits;
mod cage;
mod cluster;
mod columns;
mod demands;
mod engine;
mod mask;
mod params;
mod piece;
mod pieces;
mod render;
mod reuse;
mod row;
mod solve;
mod space;
mod stitch;
mod strip;
mod valid;

pub use cage::PIECES;
pub use engine::{Memory, Outcome, Prepared, Request};
pub use mask::Mask;
pub use params::{Closing, Params, Search, Width};
pub use piece::{Piece, Ribbon};
pub use pieces::{
    facets::{Facet, facets},
    rungs::{Rung, rungs},
    vector::{ShownArea, shown_areas},
};
pub use render::{Canvas, render};
pub use strip::{Exemplar, PIXELS};
