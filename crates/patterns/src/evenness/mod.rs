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

mod at_once;
mod distance_map;
mod ink;
mod moves;
mod natural;
mod page;
mod rounds;
mod share;
mod strokes;
#[cfg(test)]
mod tests;
mod work;

use std::sync::Arc;

use arabesque_core::{Budget, Exemplar, Matrix, Numbered, Result, Vector};

use crate::{
    dimension::Dimension,
    evenness::{
        ink::{Inks, Pose},
        natural::Natural,
        page::{Body, Measures, Page},
        share::{Shares, Spread},
        strokes::Strokes,
        work::{Moves, Work},
    },
    exemplar::{graph::net::Net, library::Library},
    output::{
        draft::{Item, Items},
        state::State,
    },
    params::Params,
};

/// Distances are told apart up to so many tolerated ones.
const REACH: f64 = 2.5;

/// Distances to the nearest neighbour that differ by less than this share are all the same.
const REGULAR: f64 = 0.02;

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
    /// Measures an exemplar, whose first `count` elements are no curve samples. `None` where too little is seen of it, and where its
    /// elements stand like those of a lattice: there neighbourhoods say everything, and nothing may give way.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(
        exemplar: &Exemplar<D>,
        library: &Library<D>,
        net: Option<&Net<D>>,
        count: usize,
        budget: &Budget,
    ) -> Result<Option<Self>> {
        if count < 2 || is_regular(library.nearest.get(..count).unwrap_or_default()) {
            return Ok(None);
        }
        let inks = Arc::new(Inks::new(exemplar, library, count, library.spacing, budget)?);
        let natural = Natural::new(exemplar, library, &inks, Strokes::of_exemplar(net, library), budget)?;
        let mass = masses(exemplar, count);
        let spread = Spread::new(library, mass, budget)?;
        Ok(natural.filter(|n| n.tolerated > 0.0).map(|natural| Self { inks, natural, spread }))
    }

    /// Evens out the elements of a state, which is as it was until [`Evened::write_back`]. Tells what there is from time to time. The
    /// second result says what cut it short, where anything did.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop, before there is anything.
    pub(crate) fn even_out(
        &self,
        state: &State<'_, D>,
        targets: &Numbered<f64>,
        params: &Params,
        tell: &mut dyn FnMut(&Items<D>) -> Result<()>,
    ) -> Result<(Evened<D>, Result<()>)> {
        let budget = state.budget.stage("evening out");
        let moves = Moves::new(params);
        let base = state.level.base;
        let is_element = |&i: &u32| state.item(i).alive && state.item(i).item.source < base;
        let numbers: Vec<u32> = state.items().numbers().filter(is_element).collect();
        let bodies: Vec<_> = numbers.iter().map(|&i| self.body(state, i)).collect();
        let shares = self.shares(state, &bodies, moves, &budget)?;
        let page = self.page(state, bodies, &budget)?;
        let targets = wanted(state.library, page.room(self.natural.tolerated), targets);
        let known = (&self.natural, state.library);
        let mut work =
            Work::new((page, shares), known, (state.extent, budget.clone()), (counts(state), targets), moves);
        let ended = rounds::run(&mut work, &budget, &mut |bodies| tell(&items(state, &numbers, bodies)));
        if ended.is_err() {
            work.undo(&mut state.budget.fresh().meter())?;
        }
        Ok((Evened { numbers, bodies: work.page.bodies }, ended))
    }

    /// Item `i` as a body. What is joined to strokes, or bound to another element, stays with that.
    fn body(&self, state: &State<'_, D>, i: u32) -> Body<D> {
        let (item, pose) = (&state.item(i).item, state.pose(i));
        let pose = Pose { source: item.source, centre: item.position, rotation: pose.rotation, scale: pose.scale };
        let is_joined = self.natural.clear(state.library.class[item.source]).is_none();
        Body { pose, fixed: item.frozen.is_some() || is_joined, alive: true }
    }

    fn page<'s>(&'s self, state: &State<'s, D>, bodies: Vec<Body<D>>, budget: &Budget) -> Result<Page<'s, D>> {
        let measures = Measures {
            spacing: state.library.spacing,
            tolerated: self.natural.tolerated,
            reach: REACH * self.natural.tolerated * state.extent.largest_spacing_scale,
        };
        Page::new(state.extent, &self.inks, bodies, measures, Strokes::of_page(state), budget)
    }

    fn shares<'s>(
        &'s self,
        state: &State<'s, D>,
        bodies: &[Body<D>],
        moves: Moves,
        budget: &Budget,
    ) -> Result<Option<Shares<'s, D>>> {
        let Some(spread) = self.spread.as_ref().filter(|_| moves.share) else { return Ok(None) };
        let mut shares = Shares::new(spread, state.extent, budget)?;
        bodies.iter().for_each(|b| shares.count((b.pose.source, b.pose.scale), b.pose.centre, 1.0));
        Ok(Some(shares))
    }
}

/// Elements that were evened out.
pub(crate) struct Evened<const D: usize> {
    /// Items of the first bodies; the others are new.
    numbers: Vec<u32>,
    bodies: Vec<Body<D>>,
}

impl<const D: usize> Evened<D> {
    /// Changes the state from which they come.
    pub(crate) fn write_back(self, state: &mut State<'_, D>) {
        for (k, body) in self.bodies.iter().enumerate() {
            match self.numbers.get(k) {
                None if body.alive => _ = state.push(new_item(body), Matrix::identity()),
                None => {}
                Some(&i) if !body.alive => state.remove_item(i),
                Some(&i) => {
                    let item = state.item(i).item;
                    if item.source != body.pose.source {
                        state.set_source(i, body.pose.source);
                    }
                    if item.position != body.pose.centre {
                        state.move_item(i, body.pose.centre);
                    }
                }
            }
        }
        state.reindex();
    }
}

/// Whether all elements are as far from their nearest neighbour.
fn is_regular(nearest: &[f64]) -> bool {
    let mean = nearest.iter().sum::<f64>() / nearest.len() as f64;
    nearest.iter().all(|d| (d - mean).abs() <= REGULAR * mean)
}

fn new_item<const D: usize>(body: &Body<D>) -> Item<D> {
    Item { source: body.pose.source, position: body.pose.centre, frozen: None }
}

/// Bodies as the items that they would be.
fn items<const D: usize>(state: &State<'_, D>, numbers: &[u32], bodies: &[Body<D>]) -> Items<D> {
    let item = |(k, body): (usize, &Body<D>)| {
        let Some(live) = numbers.get(k).map(|&i| state.item(i)) else { return (new_item(body), Matrix::identity()) };
        let turn = if live.item.source == body.pose.source { live.turn } else { Matrix::identity() };
        (Item { frozen: live.item.frozen, ..new_item(body) }, turn)
    };
    bodies.iter().enumerate().filter(|(_, body)| body.alive).map(item).collect()
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

/// Living elements of each class whose centre lies inside.
fn counts<const D: usize>(state: &State<'_, D>) -> Numbered<f64> {
    let mut counts = Numbered::filled(0.0, state.library.classes());
    for live in state.items().iter().filter(|live| live.alive) {
        if state.domain().contains(live.item.position) {
            counts[state.library.class[live.item.source]] += 1.0;
        }
    }
    counts
}

/// Elements of each class that should have their centre inside: as many as the exemplar has for the room that there is. No more than
/// `most`, which knows how many keep to the rule of the border.
fn wanted<const D: usize>(library: &Library<D>, room: f64, most: &Numbered<f64>) -> Numbered<f64> {
    let shown =
        |class: u32| library.members(class).iter().filter(|&&e| library.view.contains(library.centre[e])).count();
    let wanted = |class: u32| (shown(class) as f64 * room / library.view.measure()).min(most[class]);
    (0..library.classes() as u32).map(wanted).collect()
}
