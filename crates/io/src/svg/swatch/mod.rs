//! Exemplars that are one period of a pattern: swatches, and what `<pattern>` fills a page with.
//!
//! One period is a torus. `units` finds the things in it, `pieces` cuts those that reach over its edges, `links` joins
//! what the edges have cut to what goes on at the opposite ones, `fit` tells where nothing does, and `unroll` lays out
//! as many periods as make an exemplar, with `weld` putting the cut things together. `pattern` finds the period in a
//! paint server, `found` one that the author does not speak of, and `period` decides between them.

pub(crate) mod cell;
pub(crate) mod fit;
pub(crate) mod found;
pub(crate) mod links;
pub(crate) mod meet;
pub(crate) mod pattern;
pub(crate) mod period;
pub(crate) mod pieces;
pub(crate) mod units;
pub(crate) mod unroll;
pub(crate) mod weld;

#[cfg(test)]
mod tests;
