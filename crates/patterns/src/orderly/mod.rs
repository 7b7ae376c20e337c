//! Drawings that do not repeat and still keep to lines of their own: walls, traces and tiles of lines on squared paper
//! (`ruled`), boards in rows (`boards`), lines that run side by side (`abreast`); and straight lines of others, made straight again (`straight`).
//!
//! Neighbourhoods of samples would bend what is straight there, since nothing tells them that it is. Such drawings are
//! continued on their own terms, node by node, board by board or line by line, so that what is straight stays straight and what lies in line stays
//! in line.

pub(crate) mod abreast;
pub(crate) mod boards;
pub(crate) mod ruled;
pub(crate) mod straight;

use arabesque_core::{Budget, Exemplar, Outcome, Request, Result, Snapshot, Watch};

use abreast::Abreast;
use boards::Boards;
use ruled::Ruled;

/// An exemplar that keeps to lines of its own, ready for any number of runs.
#[derive(Clone, Debug)]
pub struct Orderly(Kind);

#[derive(Clone, Debug)]
enum Kind {
    /// Lines on squared paper.
    Ruled(Ruled),
    /// Boards in rows.
    Boards(Boards),
    /// Lines side by side.
    Abreast(Abreast),
}

impl Orderly {
    /// Finds what the exemplar keeps to; `None` where it keeps to nothing.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Self>> {
        if let Some(ruled) = Ruled::new(exemplar, budget)? {
            return Ok(Some(Self(Kind::Ruled(ruled))));
        }
        if let Some(boards) = Boards::new(exemplar, budget)? {
            return Ok(Some(Self(Kind::Boards(boards))));
        }
        Ok(Abreast::new(exemplar, budget)?.map(|lines| Self(Kind::Abreast(lines))))
    }

    /// Fills a domain; `None` where the request asks for what only the engine for irregular patterns does.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Limit`] when the output would be too large, or a limit is reached before there is anything;
    /// [`arabesque_core::Error::Stopped`] when somebody asks to stop so early; [`arabesque_core::Error::NoResult`] when nothing
    /// fits into the domain.
    pub(crate) fn fill(
        &self,
        exemplar: &Exemplar<2>,
        request: &Request<2>,
        watch: &mut dyn Watch<Snapshot<2>>,
    ) -> Result<Option<Outcome<2>>> {
        match &self.0 {
            Kind::Ruled(ruled) => ruled.fill(exemplar, request, watch),
            Kind::Boards(boards) => boards.fill(exemplar, request, watch),
            Kind::Abreast(lines) => lines.fill(exemplar, request, watch),
        }
    }
}
