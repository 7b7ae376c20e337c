//! From optimised items to placements: bending, the rule of the border, clearance.

use arabesque_core::{Budget, Matrix, Placement, Request, Result, Vector, Warning};

use crate::{
    border::Extent,
    dimension::Dimension,
    finish::clearance::{self, ExemplarClearance},
    output::{
        draft::{Frozen, Item, Items},
        state::{LiveItem, State},
    },
    params::{Clearance, Deform, Params},
};

/// How the items lie, in terms of their exemplar elements. Those from `base` on are curve samples and left out.
pub(crate) fn placements<const D: usize>(
    items: &Items<D>,
    request: &Request<D>,
    extent: &Extent<'_, D>,
    base: u32,
) -> Vec<Placement<D>> {
    let one = |(item, turn): &(Item<D>, Matrix<D>)| match item.frozen {
        Some(Frozen::Element(n)) => Placement { frozen: Some(n as usize), ..request.frozen[n as usize].clone() },
        Some(Frozen::Stroke) | None => Placement {
            source: item.source as usize,
            transform: extent.turned(item.source, item.position, turn),
            control: Vec::new(),
            frozen: None,
        },
    };
    items.iter().filter(|(item, _)| item.source < base).map(one).collect()
}

/// Control points of one item, see [`Placement::control`].
pub(crate) type Bend<const D: usize> = Vec<(Vector<D>, Vector<D>)>;

/// Control points of the living items of a state whose samples go their own ways, one per sample; `None` where elements
/// stay rigid.
pub(crate) fn bends<const D: usize>(state: &State<'_, D>) -> Option<Vec<Bend<D>>> {
    (state.deform == Deform::AsRigidAsPossible).then(|| {
        state
            .items()
            .iter()
            .filter(|live| live.alive && live.item.source < state.level.base)
            .map(|live| bend(state, live))
            .collect()
    })
}

fn bend<const D: usize>(state: &State<'_, D>, live: &LiveItem<D>) -> Bend<D> {
    if live.count < 2 || live.item.frozen.is_some() {
        return Vec::new();
    }
    let (centre, origin) = (state.library.centre[live.item.source], live.item.position);
    let parts = &state.level.parts[live.item.source];
    // On a torus, samples across the edge are brought next to their element.
    let near = |s: u32| origin + state.domain().offset(origin, state.sample(s).position);
    (live.first..live.first + live.count).zip(parts).map(|(s, &offset)| (centre + offset, near(s))).collect()
}

/// Mends overlaps and drops what the rule of the border excludes. Warnings tell what could not be kept.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop; then overlaps stay as they are.
pub(crate) fn mend<const D: usize>(
    placements: &mut Vec<Placement<D>>,
    limits: Option<&ExemplarClearance>,
    extent: &Extent<'_, D>,
    params: &Params,
    budget: &Budget,
) -> Result<Vec<Warning>>
where
    Vector<D>: Dimension<D>,
{
    placements.retain(|p| p.frozen.is_some() || extent.may_show(p));
    if params.clearance == Clearance::Ignored {
        return Ok(Vec::new());
    }
    let summary = clearance::repair(limits, extent.request(), placements, budget)?;
    placements.retain(|p| p.frozen.is_some() || extent.may_show(p));
    Ok(summary.warning(placements.len()).into_iter().collect())
}
