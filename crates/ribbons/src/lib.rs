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
//! | separate objects: find, choose, place | `objects` | |
//!
//! | symbol | identifier |
//! |---|---|
//! | E, W, H | `StripExemplar`, `Strip` |
//! | b, δ, s | [`RibbonParams::width`], [`RibbonParams::step`], 1 / [`RibbonParams::scale`] |
//! | ξ, γ | `columns::pixel_cost`, `columns::GAMMA` |
//! | u | `Position` |
//! | L, R, C | `Columns::left`, `Columns::right`, `Form::rows` |
//! | P\[i, u\] | `Row::cost` |
//! | Ω | [`Ribbon::cost`] |
//! | M, T, β | `stitch::table`, [`Piece::shift`], `stitch::SKIPPED` |
//!
//! Where it departs from the paper: half-transparent pixels have a cost in between; a place where the ribbon overlaps itself belongs to the
//! piece whose curve is nearest instead of to none; parts that were shown a short while ago cost more ([`RibbonParams::repetition`]) and a
//! random preference varies the pattern ([`RibbonParams::variety`]); several exemplars pass into one another; exemplars may have a start and an
//! end; rows of an earlier run are taken over ([`Prepared::resume`]). A closed curve without a cycle among the paths of the first pass
//! is searched again from its best start. Lower bounds on the difference of columns make the exact optimum fast. Where the ink of two edges
//! lies apart, that costs more the farther it is (`columns::Crossing`): pixels alone make every break of a thin stem equally bad.
//!
//! An exemplar of separate objects, with transparent columns between them, has no edges to compare. Its objects are laid whole, one after
//! the other, with gaps drawn from its own: rigid where the curve leaves their chord by at most a tenth of the height of the exemplar, else
//! in fine slices along it. Corners divide a curve into parts; no object lies across one.
//!
//! Not handled: stochastic backgrounds.

mod constraints;
mod engine;
mod exemplar;
mod forecast;
mod geometry;
mod objects;
mod params;
mod pieces;
mod request;
mod search;

pub use constraints::mask::Mask;
pub use engine::{Memory, Prepared, RibbonOutcome};
pub use exemplar::strip::{PIXELS, StripExemplar, check_pixels};
pub use geometry::cage::{PIECES, ROWS};
pub use params::{Closing, RibbonParams, Search, Width};
pub use pieces::piece::{Piece, Ribbon};
pub use pieces::render::{Canvas, render, render_rows};
pub use pieces::{
    facets::{Facet, facets},
    rungs::{Rung, rungs},
    vector::{ShownArea, shown_areas},
};
pub use request::RibbonRequest;
