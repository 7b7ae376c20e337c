//! Edits of results, and edits that spread [Ma 2011 §6.3].
//!
//! A result is edited as its file has it, and nothing is run for that: `elements` reads the places of the elements from the file,
//! `resolve` works out what an edit comes to for each of them, and the file is written again with these places changed and everything
//! else as it was. `session` offers that in two steps, a proposal and its acceptance, and
//! `preview` marks what would change. The recipe in the file records the edit, and
//! `replay` makes the same of a run: the file is encoded as without edits, and edited; `applied` does it to what is in memory.

mod applied;
mod elements;
mod nearest;
mod preview;
mod replay;
mod resolve;
mod session;

pub use session::{Change, EditSession, PlacedItem, Proposal};

pub(crate) use applied::{to_geometry, to_points};
pub(crate) use replay::{Replayed, replay};
