//! Exemplars that nothing can be made of: what is there is told before any work is done.

use arabesque_core::{Budget, Domain, Error, Exemplar, GridIndex, Request, Result, Role, Spread, Warning};

use crate::exemplar::level_exemplar::LevelExemplar;

/// Elements of which the mean one has so many beside it lie in heaps.
const HEAP: f64 = 1000.0;

/// Most samples on the curves of an exemplar at one level.
const MAX_NODES: f64 = 10_000.0;

/// A stroke that is alone says something about a pattern when it is as long as this share of the side of the frame.
const LONE: f64 = 0.25;

/// Refuses elements that lie on top of one another: nothing tells how they are to be laid out, and every one of them would
/// have to be compared with all others.
pub(crate) fn places<const D: usize>(exemplar: &Exemplar<D>) -> Result<()> {
    let centres: Vec<_> = exemplar.elements.iter().map(|e| e.centre).collect();
    let advice = "draw them apart, so that the exemplar shows distances and directions";
    if exemplar.curves.is_empty() && exemplar.areas.is_empty() && Spread::of(centres.iter().copied()) == Spread::Place {
        let problem = format!("all {} elements lie at one place", centres.len());
        return Err(Error::input("exemplar", problem, advice));
    }
    let index = GridIndex::new(&centres, exemplar.spacing(), &Domain::Box(exemplar.window));
    match index.fullest().filter(|_| index.crowding() > HEAP) {
        Some((count, place)) => {
            let problem = format!("{count} elements lie in one heap, around {:.4?}", place.0);
            Err(Error::input("exemplar", problem, advice))
        }
        None => Ok(()),
    }
}

/// Refuses a single stroke that is short, or straight in a frame that shows nothing beside it: nothing tells what belongs there.
pub(crate) fn strokes<const D: usize>(exemplar: &Exemplar<D>) -> Result<()> {
    let ([curve], true) = (exemplar.curves.as_slice(), exemplar.elements.is_empty() && exemplar.areas.is_empty())
    else {
        return Ok(());
    };
    let extent = curve.path.bounds().size().0.into_iter().fold(0.0, f64::max);
    let side = exemplar.view().side();
    let is_straight = || !Spread::of(curve.path.flatten(1e-3 * side).into_iter()).fills::<D>();
    let problem = if extent < LONE * side {
        "one short stroke only, expected several"
    } else if side < LONE * extent && is_straight() {
        "one straight stroke only, expected several"
    } else {
        return Ok(());
    };
    let advice = "repeat it a few times in the exemplar, so that it shows distances and directions";
    Err(Error::input("exemplar", problem, advice))
}

/// Refuses frozen elements that are copies of nothing.
pub(crate) fn frozen<const D: usize>(exemplar: &Exemplar<D>, request: &Request<D>) -> Result<()> {
    let known = exemplar.elements.len();
    match request.frozen.iter().find(|p| p.source >= known) {
        Some(p) => Err(Error::parameter("frozen source", p.source, format!("below {known}, the number of elements"))),
        None => Ok(()),
    }
}

/// Refuses an exemplar of elements of which fewer than two may be copied.
pub(crate) fn several<const D: usize>(exemplar: &Exemplar<D>) -> Result<()> {
    let cut = exemplar.elements.iter().filter(|e| e.role == Role::Context).count();
    if exemplar.elements.len() - cut >= 2 {
        return Ok(());
    }
    let (problem, advice) = match cut {
        0 => (
            "one element only, expected at least two".to_owned(),
            "repeat the element a few times in the exemplar, so that it shows distances and directions",
        ),
        1 => (
            "one whole element only, expected at least two: the frame cuts the other one".to_owned(),
            "draw it whole, reaching over the frame",
        ),
        _ => (
            format!("one whole element only, expected at least two: the frame cuts the other {cut}"),
            "draw them whole, reaching over the frame, or show two whole periods of what repeats",
        ),
    };
    Err(Error::input("exemplar", problem, advice))
}

/// Refuses results of which so many elements are expected.
pub(crate) fn expected(count: f64, budget: &Budget) -> Result<()> {
    let limit = budget.limits().output_elements;
    if count <= limit as f64 {
        return Ok(());
    }
    Err(Error::Limit {
        what: "elements of the result".into(),
        found: format!("about {count:.0}"),
        limit: limit.to_string(),
        advice: "fill a smaller domain, or raise the scale".into(),
    })
}

/// Refuses an exemplar of elements that are all out of proportion.
pub(crate) fn sizes<const D: usize>(exemplar: &Exemplar<D>, levels: &[LevelExemplar<D>]) -> Result<()> {
    let Some(library) = levels.first().map(|s| &s.library).filter(|l| l.giants > 0 && exemplar.curves.is_empty())
    else {
        return Ok(());
    };
    if library.copyable.iter().any(|copyable| *copyable) {
        return Ok(());
    }
    let problem = "every element is far larger than the frame";
    Err(Error::input("exemplar", problem, "make the frame larger, or draw the elements smaller"))
}

/// What to say about elements that are out of proportion, among others.
pub(crate) fn giants_left_out(count: usize) -> Option<Warning> {
    let message = format!("elements far larger than the frame of the exemplar are not copied: {count}");
    (count > 0).then(|| Warning::new(message, "draw them smaller, or make the frame larger"))
}

/// Refuses curves that lie so densely that every neighbourhood holds hundreds of samples.
pub(crate) fn density(nodes: f64) -> Result<()> {
    if nodes <= MAX_NODES {
        return Ok(());
    }
    Err(Error::Limit {
        what: "samples on the curves of the exemplar".into(),
        found: format!("about {nodes:.0}"),
        limit: MAX_NODES.to_string(),
        advice: "show a smaller part of the pattern, draw it with fewer lines, or set a larger spacing".into(),
    })
}
