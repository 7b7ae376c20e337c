//! Repetitive structures as sums of Gaussians [Roveri 2015].
//!
//! An exemplar is a set of points with attributes: directions, colours, radii, parts, rigid elements. Every point stands for a Gaussian
//! weighted by its attributes, so that exemplar and output are fields. Around each site of the output, and of a place in the exemplar that
//! goes with it, the fields are compared under a window; the points of the output, and the places, are moved until the sum of the
//! differences is as low as it gets. Sites have frames, so that the pattern turns and grows with a curve, a surface or a field.
//!
//! | step | module | source |
//! |---|---|---|
//! | understand the exemplar | `exemplar` | [Roveri 2015 §4.1] |
//! | find how far it repeats, and the window | `exemplar::repetition`, `prepared` | |
//! | lay sites over the domain | `territory`, `layout` | [Roveri 2015 §4.3, §6.2] |
//! | lay out the first points | `start` | [Roveri 2015 fig. 4] |
//! | error and slopes | `energy` | [Roveri 2015 §4.2, §4.3, eqs 2 to 6] |
//! | leave out what has settled | `solve::part`, `solve::round` | |
//! | local step: match | `solve::matching` | [Roveri 2015 §5.1] |
//! | global step: places, then attributes | `solve::merging`, `solve::newton`, `solve::apart`, `solve::attributes` | [Roveri 2015 §5.1] |
//! | sampling control | `solve::sampling` | [Roveri 2015 §5.1, eq. 7] |
//! | the multi-scale loop | `run` | [Roveri 2015, algorithm 1] |
//! | number parts | `output::parts` | [Keuper 2015] |
//! | cut, number elements | `output::finish` | |
//! | stroke by stroke | `brush` | [Roveri 2015 §6.2] |
//!
//! | symbol | identifier |
//! |---|---|
//! | x, a | `Output::places`, `Output::weights` |
//! | e, b | `Pattern::points`, `Pattern::weights` |
//! | q, R, s | [`Site::place`], [`Site::rotation`], [`Site::scale`] |
//! | m | `Matches::places` |
//! | σ, δ, w | `Kernel::sigma`, `Kernel::delta`, `Kernel::weights` |
//! | S, T | `View::error`, `Level::energy` |
//! | P | `Surplus::matched` |
//! | α | [`StructureParams::shrink`] |
//!
//! Where it departs from the paper:
//!
//! - The window is a Gaussian along the directions in which the exemplar repeats and has no end across them, and sites lie on the base of
//!   the output alone, a curve or a surface. So a match is a place on the base, and a structure never leaves its domain sideways.
//! - Sites are a window apart, not σ, farther for wider windows. The error density of a match that goes on from site to site is as smooth as
//!   the window, and windows of width δ at a distance of δ sum to a constant within 1e-4. Where the frames turn fast, windows are smaller.
//! - Pairs count as far as their points, not their middles, lie in the windows (`energy::kernel`): the sum over the exemplar is then one look-up
//!   in its field, the same for all windows.
//! - A round looks at what is in motion alone: sites around points that moved, came or went, and the points in their windows. All else stays
//!   to the last bit (`solve::part`).
//! - Beyond the border of the exemplar nothing is known: what a window sees there is left out, and the error divided by the rest.
//! - Points move along Gauss-Newton directions with a step that is halved until T falls, instead of a fixed step down the slope.
//! - A match has about as many points as the output has there, is not much emptier than the one before it, and points that nobody wants go
//!   only where there are too many: otherwise empty places fit empty places best, and thin structures dissolve.
//! - Levels end with narrow Gaussians ([`StructureParams::fine`]): with σ as wide as the spacing T hardly tells how points lie along a line or
//!   a surface.
//! - By default the output is grown from a seed: each site goes on from its neighbours until the exemplar ends, and then elsewhere in it, where
//!   what is there already fits and the exemplar goes on for long. Rigid elements fill the gaps that are left. Points are then shaken as
//!   unevenly as those of the exemplar lie, so that the output is not the exemplar to the point. Whole repetitions fill a closed curve where the
//!   exemplar repeats regularly.
//! - Parts that touch are told apart in the result by all that neighbours tell: how pairs that lie and face alike are in the exemplar, and how the
//!   windows see them.
//! - Rigid elements that stand on something continuous keep about the clear space of the exemplar: what is missing adds to the error (`solve::apart`), and
//!   bare places are filled at first.
//!
//! Not handled: a σ for each point, and a window for each kind of point.

#![allow(clippy::needless_range_loop, reason = "coordinates are numbered alike in many arrays at once")]

mod brush;
mod each;
mod energy;
mod exemplar;
mod layout;
mod output;
mod params;
mod prepared;
mod request;
mod run;
mod solve;
mod start;
mod territory;

pub use brush::{
    session::{Brush, StrokeOutcome},
    stroke::Stroke,
};
pub use exemplar::spacing::mean_spacing as spacing;
pub use params::{Start, StructureParams, Window};
pub use prepared::Prepared;
pub use request::{PlacedElement, StructureOutcome, StructureRequest};
pub use territory::{
    flat::Flat,
    plan::{SitePlan, Territory},
    shell::Shell,
    site::Site,
    solid::Solid,
    tube::{Along, Foot, Thread, Tube},
};
