//! Continuous curves [Tu 2020]: the samples of a stroke are items of the engine like any others, each of one sample;
//! what makes them curves is here.
//!
//! A curve sample is an item whose source is a node of the exemplar's sample graph. Layout, search, positions,
//! attributes and existence treat it as they treat a small element; the difference of edge sets enters the comparison
//! of neighbourhoods, and after each step edges and tangents are assigned. At the end of a level, edges are chained
//! into strokes, each with the stretch of exemplar line that was voted for it; the next level samples these more
//! densely, and after the last one they are the result.
//!
//! | step | file | source |
//! |---|---|---|
//! | edge assignment | `votes/edge_votes`, `votes/edges` | §4.3.4, eqs 17 to 22 |
//! | orientation assignment | `votes/tangents` | §4.3.4, fig. 9 |
//! | dangling ends, near misses, crossings | `repair` | beyond the paper |
//! | chaining | `draw/chains` | §4.4.2, fig. 11 |
//! | shape of a stroke | `draw/shape` | beyond the paper: the exemplar's own line, bent to its ends |
//! | next level | `draw/resample` | §4.3.5 |
//! | the border | `border/trim` | §4.3.1, the domain term |
//! | strokes that turn at it | `border/border_turn` | beyond the paper |
//!
//! Lines, knots and the sample graph of the exemplar [Tu 2020 §4.1] are in [`crate::exemplar::graph`].
//!
//! Beyond the paper: the samples between two knots carry the true line of the exemplar, so that corners stay corners
//! and arcs stay arcs; an edge that the window of the exemplar cuts off counts as one, so that nothing ends where
//! merely the example ends.

pub(crate) mod border;
pub(crate) mod draw;
pub(crate) mod repair;
pub(crate) mod strokes;
#[cfg(test)]
mod tests;
pub(crate) mod votes;
