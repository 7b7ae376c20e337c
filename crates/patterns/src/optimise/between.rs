//! What somebody else does to the elements after each step [Ma 2011 §5, "interleaved physics solver"].

use arabesque_core::{Matrix, Placement, Result};

use crate::{
    finish::placements::placements,
    output::{draft::Item, state::State},
};

/// Lets the elements be moved and turned, and gives notice of those that were.
pub(crate) fn step<const D: usize>(state: &mut State<'_, D>) -> Result<()> {
    let Some(between) = &state.request.between else { return Ok(()) };
    let is_element = |i: &u32| state.item(*i).alive && state.item(*i).item.source < state.level.base;
    let numbers: Vec<u32> = state.items().numbers().filter(is_element).collect();
    let items: Vec<(Item<D>, Matrix<D>)> = numbers.iter().map(|&i| (state.item(i).item, state.item(i).turn)).collect();
    let before = placements(&items, state.request, state.extent, state.level.base);
    let mut after = before.clone();
    between.step(&mut after, &state.budget.stage("moving elements"))?;
    for ((i, before), after) in numbers.into_iter().zip(&before).zip(&after) {
        if before.transform != after.transform && before.frozen.is_none() {
            place(state, i, after);
        }
    }
    Ok(())
}

fn place<const D: usize>(state: &mut State<'_, D>, i: u32, placement: &Placement<D>) {
    let position = placement.transform.apply(state.library.centre[state.item(i).item.source]);
    let frame = state.request.fields.frame(position);
    state.place_item(i, position, frame.rotation.transpose().compose(&placement.transform.rotation));
}
