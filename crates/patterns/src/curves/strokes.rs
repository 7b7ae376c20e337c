//! The strokes of a state: all steps from edges to paths, or only those without which there would be none.

use arabesque_core::{Drawn, Result, Vector};

use crate::{
    curves::{
        draw::{
            chains::{self, Chain},
            shape,
        },
        repair::mend,
        votes::edge_votes::{self, Votes},
    },
    dimension::Dimension,
    output::state::State,
    params::{Params, Switch},
};

/// The strokes of a state: mended, chained, and the samples moved to where the exemplar's shapes fit best.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop; then some of it is done.
pub(crate) fn chains<const D: usize>(params: &Params, state: &mut State<'_, D>) -> Result<Vec<Chain>> {
    let votes = edge_votes::collect_votes(state)?;
    if params.mending == Switch::On {
        mend::mend(state, &votes)?;
        state.reindex();
    }
    let chains = chains::chains(state, &votes, params.orientations == Switch::On)?;
    if params.shapes == Switch::On {
        let position = shape::polish(state, &chains)?;
        state.set_positions(position);
    }
    Ok(chains)
}

/// The paths of the strokes of a state.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn strokes<const D: usize>(params: &Params, mut state: State<'_, D>) -> Result<Vec<Drawn<D>>>
where
    Vector<D>: Dimension<D>,
{
    if state.level.net.is_none() {
        return Ok(Vec::new());
    }
    let chains = chains(params, &mut state)?;
    shape::strokes(&state, &chains)
}

/// The paths of the strokes as earlier votes have them, neither mended nor fitted.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn plain<const D: usize>(params: &Params, state: &State<'_, D>, votes: &Votes) -> Result<Vec<Drawn<D>>>
where
    Vector<D>: Dimension<D>,
{
    let chains = chains::chains(state, votes, params.orientations == Switch::On)?;
    shape::strokes(state, &chains)
}
