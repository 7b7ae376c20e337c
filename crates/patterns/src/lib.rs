//! Sample-graph synthesis of discrete elements and continuous curves: one engine, whose presets are [Ma 2011] and
//! [Tu 2020].
//!
//! Elements of an exemplar become samples; output samples are matched with exemplar samples by their neighbourhoods,
//! and the matches say where every element belongs, which one it is, and whether it should be there. Coarse levels
//! settle the arrangement, fine ones the poses.
//!
//! | step | module | source |
//! |---|---|---|
//! | sample the elements | `exemplar`: `samples`, `level` | [Ma 2011 §3.1], [Tu 2020 §4.1.1] |
//! | sample the curves | `exemplar::graph` | [Tu 2020 §4.1.1] |
//! | lay out the output | `layout` | [Tu 2020 §4.3.2], [Ma 2011 §4.1] |
//! | search | `optimise`: `search`, `matching`, `assignment` | [Ma 2011 §4.2], [Tu 2020 §4.2, §4.3.3] |
//! | assign positions | `optimise`: `positions` | [Ma 2011 eqs 3, 4], [Tu 2020 eqs 14, 15] |
//! | assign attributes | `optimise`: `attributes` | [Ma 2011 eq. 5] |
//! | assign existence | `optimise`: `existence`, `targets` | [Tu 2020 §4.3.4, appendix A] |
//! | assign edges and tangents, draw strokes | `curves` | [Tu 2020 §4.3.4, §4.4.2] |
//! | even out holes and clumps | `evenness` | after [Roveri 2015 §4] |
//! | place | `finish` | [Ma 2011 §3.1], [Schaefer 2006] |
//! | find places like one of a result, for edits that spread | [`alike`] | [Ma 2011 §6.3] |
//!
//! An exemplar that repeats needs none of this: `repeat` finds its lattice, and `regular` continues it exactly. One that does not
//! repeat and still keeps to lines of its own, such as a maze, is continued along them by `orderly`; a layer that
//! repeats over one that does not is taken by itself (`apart`). Elements that bend are
//! laid out and moved by `soft`, sample by sample.
//!
//! Everything knows only what stands above it in this list: `exemplar` (worked out once), `output` (what is made, in
//! the state it is in), then the steps of `layout`, `optimise`, `curves`, `evenness` and `finish`, which do not know one another,
//! and `run`, which calls them.
//!
//! | symbol | identifier |
//! |---|---|
//! | s_o, s_i | `Sample`, index into `Level::position` |
//! | n(s) | `Surroundings`, `Level::neighbours` |
//! | k | `Library::outlier` |
//! | q(s) | `Feature` |
//! | c(s_o) | `existence::confidences` |
//! | r | `Level::radius` |
//! | E(s), o(s) | `State::links_of`, `Star`; `State::tangents_of` |
//!
//! Where it departs from the papers, each departure measured to be better and switchable by [`Params`]: patches are
//! laid out in register with what is there and prefer not to go on copying; missing elements cost as much as surplus
//! ones; numbers of elements are kept near those of the exemplar; holes larger than any in the exemplar are laid out
//! anew; the space between outlines is compared as well, and evened out; a start in disorder keeps its largest part in order and is grown anew around it; strokes that cross or run
//! side by side as the exemplar's never do are taken apart; overlaps are mended on the real outlines.
//!
//! Not handled: interleaved physics; anything outside two and three dimensions.

pub mod alike;
mod apart;
mod border;
mod curves;
mod dimension;
mod ending;
mod evenness;
mod exemplar;
mod finish;
mod frozen;
mod irregular;
mod layout;
mod obstacles;
mod optimise;
mod orderly;
mod output;
mod params;
mod prepared;
mod regular;
pub mod repeat;
mod run;
mod soft;
#[cfg(feature = "bench-stages")]
#[doc(hidden)]
pub mod stages;
mod streams;

pub use dimension::Dimension;
pub use finish::clearance::overlap_ratio;
#[doc(hidden)]
pub use orderly::Orderly;
pub use params::{Attributes, Clearance, Deform, Existence, Initialisation, Matching, Params, Repeats, Search, Switch};
#[doc(hidden)]
pub use prepared::Compiled;
pub use prepared::{Known, Prepared, regular};
pub use regular::Regular;
