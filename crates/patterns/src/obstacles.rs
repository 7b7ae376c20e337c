//! What is in the way on a page.

use arabesque_core::{FillRule, Request, Result, Shape};

/// The union of what is in the way.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn obstacles(request: &Request<2>) -> Result<Option<Shape>> {
    let rings: Vec<_> = request.obstacles.iter().flat_map(|o| o.rings.iter().cloned()).collect();
    Shape::try_new(&rings, FillRule::NonZero, &request.budget.stage("looking at what is in the way"))
}
