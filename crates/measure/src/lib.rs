//! How good is a result? A quality report of any result beside its exemplar, whoever made it.
//!
//! A true pattern goes on as its exemplar does: everything that can be measured of another part of it lies where it lies in parts of the
//! exemplar. So every figure is told beside the exemplar's own and the range that is natural, which halves, quarters and overlapping
//! halves of the exemplar tell (`natural`), with a verdict: within the range is good, within twice of it to be watched, beyond is bad.
//!
//! | family | figures | module |
//! |---|---|---|
//! | evenness | empty-space function, unevenness of ink | `spread` |
//! | density | ink, elements by class, drift over the page | `spread` |
//! | distances | nearest-neighbour function of clear spaces, pair-correlation function | `neighbours` |
//! | overlaps | number, depth, share | `neighbours` |
//! | elements | broken, mirrored, turned, scaled | `elements` |
//! | strokes | ends, junctions, kinks, length, width, bends, directions | `strokes` |
//! | copies | share and size of what was taken over in one piece | `copies` |
//! | border | ink along it, elements that it cuts | `spread` |
//!
//! The functions are the usual ones of spatial statistics [Illian 2008]. Everything is near-linear in what is drawn and in the cells of
//! the page, draws on a [`Budget`](arabesque_core::Budget), and is the same for any number of threads. The result need not know of its exemplar; where it says
//! which elements are copies of which, that is believed if the outlines agree.
//!
//! Not measured: what lies over what, dashes and gradients, patterns that a field bends (turns and sizes can be left out), and what
//! repeats from one end of a page to the other. In space: everything that takes outlines.

mod copies;
mod elements;
mod measure;
mod natural;
mod neighbours;
mod quantiles;
mod report;
mod scene;
mod spread;
mod strokes;
mod verdict;

pub use measure::{Options, Subject, measure};
pub use report::{ClassDensity, Curve, FamilyFault, Fault, Functions, Mark, Measure, NamedCurve, Report};
pub use verdict::{Family, Verdict};
