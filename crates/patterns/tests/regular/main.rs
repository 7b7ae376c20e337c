//! Patterns that repeat are continued exactly, and their repeat and symmetry are found.

#![allow(clippy::unwrap_used, reason = "a test may panic, its helpers as well")]

mod by_hand;
mod drawing;
mod elements;
mod friezes;
mod groups;
mod measure;
mod random;
mod regions;
mod strokes;
mod surroundings;
mod symmetry;
mod tiles;
