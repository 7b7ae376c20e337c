//! Places of a pattern that look alike: whose neighbourhoods are similar [Ma 2011 §6.3].
//!
//! An edit of one element is carried to every element whose neighbourhood is like its own. What the paper reuses for that is its distance
//! between neighbourhoods [Ma 2011 eq. 1]: samples are matched with samples of the same class, nearest first, in the frame of the centre,
//! and the squares of what is left between them are added. Here the elements of one result are compared with one another.
//!
//! | step | module |
//! |---|---|
//! | how far apart elements are, and how many of them make a neighbourhood | `scale` |
//! | the distance of two neighbourhoods in a frame | `compare` |
//! | where a pattern ends | `edge` |
//! | all places like one | `places` |
//!
//! Departures: what only one of two neighbourhoods has costs as much as a mean spacing, so that a place beside a hole is like no other; but
//! what is missing beyond the edge of the pattern costs nothing [Ma 2011 eq. 6], so that places at its edge are like those inside. The
//! frame of a place is that of its own element, or where that fits worse than the threshold, the page: a die that lies turned in a grid
//! of dice is in the place of any other.

mod compare;
mod edge;
mod places;
mod scale;
#[cfg(test)]
mod tests;

pub use places::{Alike, Places, Spot, Turned};
