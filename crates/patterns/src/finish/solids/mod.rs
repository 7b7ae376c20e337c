//! Elements with a volume: apart as far as in the exemplar, as many as there should be.
//!
//! Samples make the pattern, but only volumes say whether two elements touch [Ma 2011 §5, figs. 14 and 15]. Overlaps deeper than the
//! exemplar's are taken apart by moving and turning both as little as possible; what stays too deep is taken out, and what is missing goes
//! where there is room for it.

mod contact;
mod fill;
mod pairs;
mod place;
mod relax;
mod things;
mod voids;

use arabesque_core::{Exemplar, Numbered, Placement, Result};

use crate::{border::Extent, exemplar::library::Library};
use contact::Allowed;
use things::Things;

/// Elements may differ from the number that there should be by this share.
const SLACK: f64 = 0.015;
/// Thin things that a surface bends apart may reach into one another by this share of their radius.
const BENT: f64 = 0.06;
/// Rounds of taking out, putting in and moving.
const ROUNDS: usize = 4;
/// Steps at most in which overlaps are taken apart.
const STEPS: usize = 20;

/// Takes out what lies too deep in others, and what does not suit the border: things at the places of a lattice would lose their order if
/// they were moved apart. Where things lie on one another by rows, as shingles do (`laps`), overlaps are left.
///
/// # Errors
/// As [`mend`].
pub(crate) fn take_out<const D: usize>(
    placements: &mut Vec<Placement<D>>,
    laps: bool,
    (exemplar, library): (&Exemplar<D>, &Library<D>),
    extent: &Extent<'_, D>,
) -> Result<()> {
    if exemplar.solids.is_empty() {
        return Ok(());
    }
    let budget = extent.request().budget.stage("taking elements out");
    let allowed = Allowed::measure(exemplar, library, &budget)?;
    let mut things = Things::new(placements, exemplar, library, extent, &allowed);
    let any = Numbered::filled(f64::INFINITY, library.classes());
    let thinned = things.thin(&any, (SLACK, if laps { f64::INFINITY } else { BENT }), &budget);
    *placements = things.into_placements();
    placements.retain(|p| p.frozen.is_some() || extent.keeps_rule(p));
    thinned
}

/// Mends overlaps, numbers and, where they are to be `even`, voids of elements with a volume; anything else stays as it is.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop; then the elements are as far as that has come.
pub(crate) fn mend<const D: usize>(
    placements: &mut Vec<Placement<D>>,
    exemplar: &Exemplar<D>,
    library: &Library<D>,
    extent: &Extent<'_, D>,
    (targets, even): (&Numbered<f64>, bool),
) -> Result<()> {
    if exemplar.solids.is_empty() {
        return Ok(());
    }
    let budget = extent.request().budget.stage("taking elements apart");
    let allowed = Allowed::measure(exemplar, library, &budget)?;
    let mut things = Things::new(placements, exemplar, library, extent, &allowed);
    let natural = if even { things.natural_room(&budget)? } else { None };
    let mended = (0..ROUNDS).try_for_each(|round| {
        things.relax(STEPS, &budget)?;
        if let Some(natural) = natural.filter(|_| round + 1 < ROUNDS) {
            things.close_voids(natural, &budget)?;
        }
        things.thin(targets, (SLACK, 0.0), &budget)?;
        if round + 1 < ROUNDS { things.fill(targets, SLACK, round as u64, &budget) } else { Ok(()) }
    });
    *placements = things.into_placements();
    placements.retain(|p| p.frozen.is_some() || extent.keeps_rule(p));
    mended
}
