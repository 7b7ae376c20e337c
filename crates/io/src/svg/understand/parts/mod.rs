//! Which parts of a drawing are one thing, what kind of thing that is, and what is no part of it at all.

pub(crate) mod alike;
pub(crate) mod bands;
pub(crate) mod beside;
pub(crate) mod cells;
pub(crate) mod components;
pub(crate) mod crowds;
pub(crate) mod gaps;
pub(crate) mod gradients;
pub(crate) mod groups;
pub(crate) mod hand;
pub(crate) mod hidden;
pub(crate) mod outlined;
pub(crate) mod rows;
pub(crate) mod uncovered;
