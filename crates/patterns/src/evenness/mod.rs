//! Evening out: empty space and least distances as in the exemplar.
//!
//! Neighbourhoods are compared by a few samples of each element, with outliers at a bounded price. So the energy hardly sees
//! where ink is: seams of patches leave gaps that are too narrow for any element, and beside them clumps. What is compared
//! here is the space between outlines, as [Roveri 2015 §4] compares densities both ways: no place of the output is to be
//! farther from ink than the exemplar tolerates, and no two elements nearer than such elements are there.
//!
//! Worst places first, a hole is filled, an element beside it exchanged for one that suits the room, or its surroundings
//! drawn in; elements that are too near each other give way, are exchanged, or one of them goes. A move is kept only if it
//! lowers the price of the page, and numbers of elements stay as they should be. What the exemplar itself leaves open costs
//! nothing: clusters stay clusters.

mod distance_map;
mod ink;
mod moves;
mod natural;
mod page;
mod share;
mod work;

use std::sync::Arc;

use arabesque_core::{Budget, Exemplar, Meter, Numbered, Result, Vector};

use crate::{
    dimension::Dimension,
    evenness::{
        ink::Inks,
        natural::Natural,
        page::{Body, Measures, Page},
        share::{Shares, Spread},
        work::Work,
    },
    exemplar::library::Library,
    output::{draft::Item, state::State},
};

/// Distances are told apart up to so many tolerated ones.
const REACH: f64 = 2.5;

/// Rounds over the page.
const ROUNDS: usize = 4;

/// Sweeps over elements that pay.
const SWEEPS: usize = 6;

/// A place is a hole when it is farther from ink than so many tolerated distances.
const HOLE: f64 = 1.05;

/// Shares of ink are worked on that are off by so many deviations more than what is natural.
const OFF: f64 = 0.5;

/// Elements are too near each other when so much is missing, in tolerated distances.
const NEAR: f64 = 0.02;

/// The exemplar, prepared for evening out.
#[derive(Clone, Debug)]
pub(crate) struct Evenness<const D: usize> {
    inks: Arc<Inks<D>>,
    natural: Natural,
    spread: Option<Spread>,
}

impl<const D: usize> Evenness<D>
where
    Vector<D>: Dimension<D>,
{
    /// Measures an exemplar, whose first `count` elements are no curve samples. `None` where too little is seen of it.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(
        exemplar: &Exemplar<D>,
        library: &Library<D>,
        count: usize,
        budget: &Budget,
    ) -> Result<Option<Self>> {
        if count < 2 {
            return Ok(None);
        }
        let inks = Arc::new(Inks::new(exemplar, library, count, library.spacing, budget)?);
        let natural = Natural::new(exemplar, library, &inks, budget)?;
        let mass = masses(exemplar, count);
        let spread = Spread::new(library, mass, budget)?;
        Ok(natural.filter(|n| n.tolerated > 0.0).map(|natural| Self { inks, natural, spread }))
    }

    /// Evens out a state.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop; then the state stays as it was.
    pub(crate) fn even_out(&self, state: &mut State<'_, D>, targets: &Numbered<f64>) -> Result<()> {
        let budget = state.budget.stage("evening out");
        let base = state.level.base;
        let numbers: Vec<u32> =
            state.items().numbers().filter(|&i| state.item(i).alive && state.item(i).item.source < base).collect();
        let body = |&i: &u32| {
            let pose = state.pose(i);
            let item = &state.item(i).item;
            let pose =
                ink::Pose { source: item.source, centre: item.position, rotation: pose.rotation, scale: pose.scale };
            Body { pose, fixed: item.frozen.is_some(), alive: true }
        };
        let bodies: Vec<_> = numbers.iter().map(body).collect();
        let strokes = strokes(state);
        let largest = state.extent.largest_spacing_scale;
        let measures = Measures {
            spacing: state.library.spacing,
            tolerated: self.natural.tolerated,
            reach: REACH * self.natural.tolerated * largest,
        };
        let page = Page::new(state.extent, &self.inks, bodies.clone(), measures, &strokes, &budget)?;
        let counts = counts(state);
        let mut shares = match &self.spread {
            Some(spread) => Some(Shares::new(spread, state.extent, &budget)?),
            None => None,
        };
        for body in &bodies {
            if let Some(shares) = &mut shares {
                shares.count((body.pose.source, body.pose.scale), body.pose.centre, 1.0);
            }
        }
        let mut work = Work::new((page, shares), (&self.natural, state.library), state.extent, targets, counts);
        run(&mut work, &budget)?;
        let Work { page, .. } = work;
        for (k, body) in page.bodies.iter().enumerate() {
            let Some((&i, before)) = numbers.get(k).zip(bodies.get(k)) else {
                if body.alive {
                    let item = Item { source: body.pose.source, position: body.pose.centre, frozen: None };
                    state.push(item, arabesque_core::Matrix::identity());
                }
                continue;
            };
            if !body.alive {
                state.remove_item(i);
            } else if body.pose != before.pose {
                if body.pose.source != before.pose.source {
                    state.set_source(i, body.pose.source);
                }
                state.move_item(i, body.pose.centre);
            }
        }
        state.reindex();
        Ok(())
    }
}

/// Ink of the strokes: places along them, and half their width.
fn strokes<const D: usize>(state: &State<'_, D>) -> Vec<(Vector<D>, f64)> {
    let mut places = Vec::new();
    for &s in state.living() {
        let Some(_) = state.node(s) else { continue };
        let radius = state.library.radius[state.source(s)];
        let (p, links) = (state.sample(s).position, state.links_of(s));
        places.push((p, radius));
        for &o in links.iter().filter(|&&o| o > s) {
            let offset = state.offset(s, o);
            places.extend((1..4).map(|k| (p + offset * (0.25 * f64::from(k)), radius)));
        }
    }
    places
}

/// Ink of the first elements of an exemplar; the same for each where none has any.
fn masses<const D: usize>(exemplar: &Exemplar<D>, count: usize) -> Numbered<f64>
where
    Vector<D>: Dimension<D>,
{
    let area = |e: usize| Vector::plane_exemplar(exemplar).map_or(0.0, |plane| plane.elements[e].outline.area());
    let masses: Numbered<f64> = (0..count).map(area).collect();
    if masses.iter().any(|m| *m > 0.0) { masses } else { Numbered::filled(1.0, count) }
}

/// Living items of each class, as they are counted against the targets.
fn counts<const D: usize>(state: &State<'_, D>) -> Numbered<f64> {
    let mut counts = Numbered::filled(0.0, state.library.classes());
    for live in state.items().iter().filter(|live| live.alive) {
        if live.item.frozen.is_none() || state.domain().contains(live.item.position) {
            counts[state.library.class[live.item.source]] += 1.0;
        }
    }
    counts
}

fn run<const D: usize>(work: &mut Work<'_, D>, budget: &Budget) -> Result<()>
where
    Vector<D>: Dimension<D>,
{
    let mut meter = budget.meter();
    for _ in 0..ROUNDS {
        let mut moves = 0;
        relax(work, &mut meter)?;
        moves += thin_clumps(work, &mut meter)?;
        moves += fill_holes(work, &mut meter)?;
        moves += balance(work, &mut meter)?;
        if moves == 0 {
            break;
        }
    }
    relax(work, &mut meter)
}

/// Works on holes, the widest first.
fn fill_holes<const D: usize>(work: &mut Work<'_, D>, meter: &mut Meter<'_>) -> Result<usize>
where
    Vector<D>: Dimension<D>,
{
    let cells = &work.page.cells;
    let depth = |c: usize| cells[c].empty() / cells[c].tolerated;
    let mut holes: Vec<(f32, usize)> =
        (0..cells.len()).filter(|&c| depth(c) > HOLE as f32).map(|c| (depth(c), c)).collect();
    holes.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut moves = 0;
    let mut done: Vec<bool> = vec![false; work.page.cells.len()];
    for (before, c) in holes {
        let cell = &work.page.cells[c];
        if done[c] || cell.empty() / cell.tolerated < before * 0.98 {
            continue;
        }
        let p = work.page.lattice.centre(c);
        // The hole is looked at once a round.
        let lattice = work.page.lattice.clone();
        lattice.around(p, 0.5 * f64::from(cell.empty()), |c, _| done[c] = true);
        let helped = work.fill(p, meter)? || work.exchange(p, 3, meter)? || work.give_way(p, meter)? > 0.0;
        work.keep();
        moves += usize::from(helped);
    }
    Ok(moves)
}

/// Lets elements that pay settle, and then those around the ones that did, until nothing moves.
fn relax<const D: usize>(work: &mut Work<'_, D>, meter: &mut Meter<'_>) -> Result<()>
where
    Vector<D>: Dimension<D>,
{
    let mut open: Vec<u32> = (0..work.page.bodies.len() as u32).collect();
    for _ in 0..SWEEPS {
        let mut next = Vec::new();
        for b in open {
            if work.settle(b, meter)? > 0.0 {
                let pose = work.page.body(b).pose;
                next.extend(work.group(pose.centre, work.page.bodies.len()));
            }
        }
        work.keep();
        next.sort_unstable();
        next.dedup();
        open = next;
    }
    Ok(())
}

/// Works on elements that are too near each other, the nearest first.
fn thin_clumps<const D: usize>(work: &mut Work<'_, D>, meter: &mut Meter<'_>) -> Result<usize>
where
    Vector<D>: Dimension<D>,
{
    let mut clumps = Vec::new();
    for b in 0..work.page.bodies.len() as u32 {
        let missing = work.worst(b, meter)?;
        if missing > NEAR {
            clumps.push((missing, b));
        }
    }
    clumps.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut moves = 0;
    for (_, b) in clumps {
        if work.worst(b, meter)? <= NEAR {
            continue;
        }
        let p = work.page.body(b).pose.centre;
        let mut helped = work.give_way(p, meter)? > 0.0;
        work.keep();
        if work.worst(b, meter)? > NEAR {
            helped |= work.exchange(p, 1, meter)? || work.thin(b, meter)?;
        }
        moves += usize::from(helped);
    }
    Ok(moves)
}

/// Works on places where there is too much or too little ink around, the worst first.
fn balance<const D: usize>(work: &mut Work<'_, D>, meter: &mut Meter<'_>) -> Result<usize>
where
    Vector<D>: Dimension<D>,
{
    let off = work.shares.as_ref().map_or_else(Vec::new, Shares::off);
    let mut moves = 0;
    for (excess, p) in off.into_iter().filter(|(excess, _)| excess.abs() > OFF) {
        let mut helped = work.exchange(p, 5, meter)?;
        if !helped && excess < 0.0 {
            if let Some(hole) = work.emptiest(p) {
                helped = work.fill(hole, meter)?;
            }
        }
        if !helped && excess > 0.0 {
            for b in work.group(p, 5) {
                helped = helped || work.thin(b, meter)?;
            }
        }
        moves += usize::from(helped);
    }
    Ok(moves)
}
