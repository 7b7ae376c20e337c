//! The output as ink and empty space: where elements lie, and how far every place is from the two nearest of them.
//!
//! Two, so that it is known at once what a place would be like without the nearest. Distances are cut off at a reach beyond
//! which a place is empty in any case.

use std::sync::Arc;

use arabesque_core::{Budget, Domain, Held, Lattice, Matrix, Meter, Request, Result, Vector};
use rayon::prelude::*;

use crate::{
    border::Extent,
    dimension::Dimension,
    evenness::{
        ink::{Inks, Pose},
        strokes::Strokes,
    },
};

/// Cells to a mean spacing, in the plane and in space, and most cells of a page.
const CELLS: (f64, f64, usize) = (5.0, 3.0, 1 << 24);

/// Lists of elements by place: so many mean spacings across, and most of them.
const LISTS: (f64, usize) = (1.5, 1 << 22);

/// What lies beyond the border counts as ink at this distance from it, in tolerated ones: there may be some, or none.
const BORDER: f64 = 0.5;

/// Elements around which distances are measured before they are entered.
const TOGETHER: usize = 64;

/// No element.
pub(crate) const NOBODY: u32 = u32::MAX;

/// Nanoseconds for a cell that is looked at, and for an element and a cell.
pub(crate) const PRICE: (u64, u64) = (4, 8);

/// An element of the page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body<const D: usize> {
    pub(crate) pose: Pose<D>,
    /// Whether it must stay as it is.
    pub(crate) fixed: bool,
    pub(crate) alive: bool,
}

/// A place of the page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    /// The nearest elements, the nearest first.
    pub(crate) near: [u32; 2],
    /// How far they are.
    pub(crate) distance: [f32; 2],
    /// Distance from what never moves: strokes, obstacles, the border.
    pub(crate) still: f32,
    /// Distance from ink that is tolerated here; 0 outside the domain.
    pub(crate) tolerated: f32,
}

impl Cell {
    /// Distance from ink.
    pub(crate) fn empty(&self) -> f32 {
        self.distance[0].min(self.still)
    }

    /// Distance from ink without one of the elements.
    pub(crate) fn without(&self, body: u32) -> f32 {
        self.distance[usize::from(self.near[0] == body)].min(self.still)
    }

    fn insert(&mut self, body: u32, distance: f32) {
        if distance < self.distance[0] {
            self.near = [body, self.near[0]];
            self.distance = [distance, self.distance[0]];
        } else if distance < self.distance[1] {
            (self.near[1], self.distance[1]) = (body, distance);
        }
    }
}

/// The output.
pub(crate) struct Page<'a, const D: usize> {
    pub(crate) request: &'a Request<D>,
    pub(crate) inks: &'a Inks<D>,
    pub(crate) bodies: Vec<Body<D>>,
    pub(crate) strokes: Arc<Strokes<D>>,
    pub(crate) cells: Vec<Cell>,
    pub(crate) lattice: Lattice<D>,
    /// For each part of the page, the elements that are nearer to a place in it than the reach.
    lists: Vec<Vec<u32>>,
    /// The same for the elements that have their centre in it.
    homes: Vec<Vec<u32>>,
    /// Radius of the largest element.
    largest: f64,
    parts: Lattice<D>,
    /// Whether the pattern is turned and scaled as in the exemplar everywhere.
    pub(crate) is_neutral: bool,
    /// Distances from here on are all the same.
    pub(crate) reach: f64,
    /// `None` for a part, which is soon gone.
    _held: Option<Held>,
}

impl<'a, const D: usize> Page<'a, D>
where
    Vector<D>: Dimension<D>,
{
    /// A page of `bodies`; `tolerated`: distance from ink that is tolerated, in exemplar units.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(
        extent: &Extent<'a, D>,
        inks: &'a Inks<D>,
        bodies: Vec<Body<D>>,
        measures: Measures,
        strokes: Strokes<D>,
        budget: &Budget,
    ) -> Result<Self> {
        let request = extent.request();
        let is_periodic = request.domain.period().is_some();
        let step = measures.spacing * extent.smallest_spacing_scale / if D == 2 { CELLS.0 } else { CELLS.1 };
        let bounds = request.domain.bounds();
        let counts = bounds.size().0.map(|side| ((side / step).ceil().max(1.0) as usize).min(1 << 20));
        let lattice = Lattice::at_most(bounds, counts, is_periodic, CELLS.2);
        let around = if is_periodic { bounds } else { bounds.grown(extent.margin) };
        let part = LISTS.0 * measures.spacing * extent.smallest_spacing_scale;
        let counts = around.size().0.map(|side| ((side / part).ceil().max(1.0) as usize).min(1 << 20));
        let parts = Lattice::at_most(around, counts, is_periodic, LISTS.1);
        let (mut cells, held) = budget.list("places of the page", lattice.count())?;
        budget.spend(20 * PRICE.0 * lattice.count() as u64)?;
        cells.par_extend((0..lattice.count()).into_par_iter().map(|c| still(extent, lattice.centre(c), &measures)));
        let (lists, homes) = (vec![Vec::new(); parts.count()], vec![Vec::new(); parts.count()]);
        let reach = measures.reach;
        let is_neutral = request.fields.are_neutral();
        let mut page = Self {
            request,
            inks,
            bodies,
            strokes: Arc::new(strokes),
            cells,
            lattice,
            lists,
            homes,
            largest: 0.0,
            parts,
            is_neutral,
            reach,
            _held: Some(held),
        };
        let mut meter = budget.meter();
        for k in 0..page.strokes.places.len() {
            page.draw(page.strokes.places[k], &mut meter)?;
        }
        page.spread_all(budget)?;
        Ok(page)
    }
}

/// Lengths that a page is made by, in exemplar units but for the reach.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measures {
    pub(crate) spacing: f64,
    pub(crate) tolerated: f64,
    pub(crate) reach: f64,
}

/// A place before anything lies around it.
fn still<const D: usize>(extent: &Extent<'_, D>, p: Vector<D>, measures: &Measures) -> Cell
where
    Vector<D>: Dimension<D>,
{
    let reach = measures.reach as f32;
    let depth = extent.room(p);
    let scale = extent.request().fields.frame(p).spacing_scale;
    let local = measures.tolerated * scale;
    let tolerated = if depth > 0.0 { local as f32 } else { f32::INFINITY };
    let still = if depth > 0.0 { (depth + BORDER * local) as f32 } else { 0.0 };
    Cell { near: [NOBODY; 2], distance: [reach; 2], still: still.min(reach), tolerated }
}

impl<const D: usize> Page<'_, D> {
    pub(crate) fn domain(&self) -> &Domain<D> {
        &self.request.domain
    }

    pub(crate) fn body(&self, b: u32) -> &Body<D> {
        &self.bodies[b as usize]
    }

    /// The pose of an element turned by `turn` from the local frame.
    pub(crate) fn pose(&self, source: u32, centre: Vector<D>, turn: &Matrix<D>) -> Pose<D> {
        let centre = self.domain().wrap(centre);
        if self.is_neutral {
            return Pose { source, centre, rotation: *turn, scale: 1.0 };
        }
        let frame = self.request.fields.frame(centre);
        Pose { source, centre, rotation: frame.rotation.compose(turn), scale: frame.element_scale }
    }

    /// How much of the exemplar would fill the domain, where `tolerated` is the distance from ink that is tolerated there.
    pub(crate) fn room(&self, tolerated: f64) -> f64 {
        let measure: f64 = self.lattice.cell().0.into_iter().product();
        let inside = self.cells.iter().filter(|cell| cell.tolerated.is_finite());
        inside.map(|cell| measure * (tolerated / f64::from(cell.tolerated)).powi(D as i32)).sum()
    }

    /// An offset at `p` in exemplar directions.
    pub(crate) fn unturned(&self, p: Vector<D>, offset: Vector<D>) -> Vector<D> {
        if self.is_neutral { offset } else { self.request.fields.frame(p).rotation.transpose().apply(offset) }
    }

    /// By how much gaps are wider at `p` than in the exemplar.
    pub(crate) fn spacing_scale(&self, p: Vector<D>) -> f64 {
        if self.is_neutral { 1.0 } else { self.request.fields.frame(p).spacing_scale }
    }

    /// The places in the box around a ball and the elements near them, as a page of its own, and the numbers that these have on this one.
    /// What is changed there and lies inside with all that it touches is as if it were changed here. `here` is [`NOBODY`] for every
    /// element, and is so again afterwards.
    pub(crate) fn part_around(&self, p: Vector<D>, radius: f64, here: &mut [u32]) -> (Self, Vec<u32>) {
        let side = self.parts.cell().0.into_iter().fold(0.0, f64::max);
        // What is nearer than the reach to a place inside has its centre in one of these parts, or is very large.
        let around = radius + side + self.largest.min(self.reach) + self.reach;
        let (lattice, parts) = (self.lattice.part(p, radius), self.parts.part(p, around));
        let mut numbers = Vec::new();
        self.parts.around(p, around, |part, _| numbers.extend_from_slice(&self.homes[part]));
        if self.largest > self.reach {
            self.parts.around(p, radius + side, |part, _| numbers.extend_from_slice(&self.lists[part]));
        }
        numbers.sort_unstable();
        numbers.dedup();
        numbers.iter().zip(0..).for_each(|(&b, k)| here[b as usize] = k);
        let number = |b: u32| here.get(b as usize).copied().unwrap_or(NOBODY);
        let (mut lists, mut homes) = (vec![Vec::new(); parts.count()], Vec::with_capacity(parts.count()));
        self.parts.around(p, around, |part, _| homes.push(self.homes[part].iter().map(|&b| number(b)).collect()));
        // Distances are looked up for places inside alone.
        let mut known = Vec::new();
        self.parts.around(p, radius + side, |part, _| known.push(part));
        let mut known = known.into_iter();
        parts.around(p, radius + side, |part, _| {
            let list = known.next().map(|whole| self.lists[whole].iter().map(|&b| number(b)));
            lists[part] = list.into_iter().flatten().filter(|&k| k != NOBODY).collect();
        });
        let mut cells = Vec::with_capacity(lattice.count());
        self.lattice
            .around(p, radius, |c, _| cells.push(Cell { near: self.cells[c].near.map(number), ..self.cells[c] }));
        numbers.iter().for_each(|&b| here[b as usize] = NOBODY);
        let bodies = numbers.iter().map(|&b| *self.body(b)).collect();
        let strokes = Arc::clone(&self.strokes);
        (Self { bodies, strokes, cells, lattice, lists, homes, parts, _held: None, ..*self }, numbers)
    }

    /// Makes the ink of a stroke part of what is still.
    fn draw(&mut self, (place, radius): (Vector<D>, f64), meter: &mut Meter<'_>) -> Result<()> {
        let mut looked = 0;
        let (cells, lattice) = (&mut self.cells, &self.lattice);
        lattice.around(place, radius + self.reach, |c, at| {
            looked += 1;
            let distance = ((lattice.centre_at(at) - place).norm() - radius).max(0.0) as f32;
            cells[c].still = cells[c].still.min(distance);
        });
        meter.spend(PRICE.0 * looked)
    }

    /// Calls `visit(cell, distance)` for the places nearer than the reach to an element in some pose.
    fn around(&self, pose: &Pose<D>, mut visit: impl FnMut(usize, f32)) -> u64 {
        let mut looked = 0;
        let reach = self.inks.radius(pose) + self.reach;
        self.lattice.around(pose.centre, reach, |c, at| {
            looked += 1;
            let offset = self.lattice.centre_at(at) - pose.centre;
            if offset.norm2() < reach * reach {
                visit(c, self.inks.distance(pose, offset) as f32);
            }
        });
        looked
    }

    /// Calls `visit(cell)` for the same places, where their distances do not matter.
    fn places_around(&self, pose: &Pose<D>, mut visit: impl FnMut(usize)) -> u64 {
        let mut looked = 0;
        let reach = self.inks.radius(pose) + self.reach;
        self.lattice.around(pose.centre, reach, |c, at| {
            looked += 1;
            if (self.lattice.centre_at(at) - pose.centre).norm2() < reach * reach {
                visit(c);
            }
        });
        looked
    }

    /// Tells the places around all elements of them: distances are measured at the same time, and entered in order.
    fn spread_all(&mut self, budget: &Budget) -> Result<()> {
        let living: Vec<u32> = (0..self.bodies.len() as u32).filter(|&b| self.body(b).alive).collect();
        for some in living.chunks(TOGETHER) {
            let measured = |&b: &u32| {
                let mut found = Vec::new();
                let looked = self.around(&self.body(b).pose, |c, distance| found.push((c, distance)));
                budget.spend(PRICE.1 * looked)?;
                Ok(found)
            };
            let measured: Vec<Vec<(usize, f32)>> = some.par_iter().map(measured).collect::<Result<_>>()?;
            for (&b, found) in some.iter().zip(measured) {
                self.enter(b);
                found.into_iter().for_each(|(c, distance)| self.cells[c].insert(b, distance));
            }
        }
        Ok(())
    }

    /// Tells the places around an element of it.
    fn spread(&mut self, b: u32, meter: &mut Meter<'_>) -> Result<()> {
        let pose = self.body(b).pose;
        let mut found = Vec::new();
        let looked = self.around(&pose, |c, distance| found.push((c, distance)));
        found.into_iter().for_each(|(c, distance)| self.cells[c].insert(b, distance));
        meter.spend(PRICE.1 * looked)
    }

    fn enter(&mut self, b: u32) {
        let (pose, lists) = (self.bodies[b as usize].pose, &mut self.lists);
        let radius = self.inks.radius(&pose);
        self.parts.around(pose.centre, radius + self.reach, |part, _| lists[part].push(b));
        self.largest = self.largest.max(radius);
        let home = self.part(pose.centre);
        self.homes[home].push(b);
    }

    fn leave(&mut self, b: u32) {
        let (pose, lists) = (self.bodies[b as usize].pose, &mut self.lists);
        self.parts.around(pose.centre, self.inks.radius(&pose) + self.reach, |part, _| lists[part].retain(|&o| o != b));
        let home = self.part(pose.centre);
        self.homes[home].retain(|&o| o != b);
    }

    /// Radius of the largest element.
    pub(crate) fn largest(&self) -> f64 {
        self.largest
    }

    /// Number of parts.
    pub(crate) fn parts(&self) -> usize {
        self.parts.count()
    }

    /// The part of the page that holds `p`.
    pub(crate) fn part(&self, p: Vector<D>) -> usize {
        self.parts.at(p).unwrap_or_else(|| self.parts.nearest(p))
    }

    /// Calls `visit(part)` for the parts to whose places an element may be nearer than the reach.
    pub(crate) fn parts_around(&self, pose: &Pose<D>, mut visit: impl FnMut(usize)) {
        self.parts.around(pose.centre, self.inks.radius(pose) + self.reach, |part, _| visit(part));
    }

    /// Calls `visit(part)` for the parts that the box around a ball touches.
    pub(crate) fn parts_within(&self, p: Vector<D>, radius: f64, mut visit: impl FnMut(usize)) {
        self.parts.around(p, radius, |part, _| visit(part));
    }

    /// Elements that may be nearer to `p` than the reach.
    pub(crate) fn near(&self, p: Vector<D>) -> &[u32] {
        &self.lists[self.part(p)]
    }

    /// Living elements whose circle comes nearer than `gap` to a circle, ascending.
    pub(crate) fn neighbours(&self, centre: Vector<D>, radius: f64, except: u32) -> Vec<u32> {
        let is_near = |&o: &u32| {
            let pose = &self.body(o).pose;
            let reach = radius + self.inks.radius(pose);
            o != except && self.domain().offset(centre, pose.centre).norm2() < reach * reach
        };
        let mut found = Vec::new();
        if self.largest <= self.reach {
            let meet = |part: usize, _| found.extend(self.homes[part].iter().copied().filter(is_near));
            self.parts.around(centre, radius + self.largest, meet);
            found.sort_unstable();
        } else {
            // One large element does not make all look far.
            self.parts.around(centre, radius, |part, _| found.extend(self.lists[part].iter().copied().filter(is_near)));
            found.sort_unstable();
            found.dedup();
        }
        found
    }

    /// Puts an element elsewhere, or in place of another.
    pub(crate) fn change(&mut self, b: u32, pose: Pose<D>, meter: &mut Meter<'_>) -> Result<()> {
        let before = self.body(b).pose;
        self.leave(b);
        self.bodies[b as usize].pose = pose;
        self.enter(b);
        let mut found = Vec::new();
        let mut looked = self.around(&pose, |c, distance| found.push((c, distance)));
        let mut open = Vec::new();
        for (c, distance) in found {
            if !self.cells[c].adjust(b, distance) {
                open.push(c);
            }
        }
        let far = (self.inks.radius(&pose) + self.reach) * (1.0 - 1e-9);
        looked += self.places_around(&before, |c| {
            let is_far = || self.domain().offset(pose.centre, self.lattice.centre(c)).norm2() >= far * far;
            if self.cells[c].near.contains(&b) && is_far() {
                open.push(c);
            }
        });
        open.sort_unstable();
        open.dedup();
        meter.spend(PRICE.1 * looked)?;
        open.into_iter().try_for_each(|c| self.look(c, meter))
    }

    /// Adds an element.
    pub(crate) fn add(&mut self, pose: Pose<D>, meter: &mut Meter<'_>) -> Result<u32> {
        let b = self.bodies.len() as u32;
        self.bodies.push(Body { pose, fixed: false, alive: true });
        self.enter(b);
        self.spread(b, meter)?;
        Ok(b)
    }

    /// Takes an element away.
    pub(crate) fn remove(&mut self, b: u32, meter: &mut Meter<'_>) -> Result<()> {
        self.leave(b);
        self.bodies[b as usize].alive = false;
        let pose = self.body(b).pose;
        let mut open = Vec::new();
        let looked = self.places_around(&pose, |c| {
            if self.cells[c].near.contains(&b) {
                open.push(c);
            }
        });
        meter.spend(PRICE.1 * looked)?;
        open.into_iter().try_for_each(|c| self.look(c, meter))
    }

    /// Puts back an element that was taken away.
    pub(crate) fn restore(&mut self, b: u32, meter: &mut Meter<'_>) -> Result<()> {
        self.bodies[b as usize].alive = true;
        self.enter(b);
        self.spread(b, meter)
    }

    /// Finds the elements nearest to a place.
    fn look(&mut self, c: usize, meter: &mut Meter<'_>) -> Result<()> {
        let p = self.lattice.centre(c);
        let mut cell = Cell { near: [NOBODY; 2], distance: [self.reach as f32; 2], ..self.cells[c] };
        let near = self.near(p);
        meter.spend(PRICE.1 * near.len() as u64)?;
        for &b in near {
            let pose = &self.body(b).pose;
            let offset = self.domain().offset(pose.centre, p);
            let least = self.inks.radius(pose) + f64::from(cell.distance[1]);
            if offset.norm2() < least * least {
                cell.insert(b, self.inks.distance(pose, offset) as f32);
            }
        }
        self.cells[c] = cell;
        Ok(())
    }
}

impl Cell {
    /// Takes notice of an element that has moved; false where another one may be nearer now.
    fn adjust(&mut self, body: u32, distance: f32) -> bool {
        match self.near.iter().position(|&b| b == body) {
            None => self.insert(body, distance),
            Some(k) if distance <= self.distance[k] || (k == 0 && distance <= self.distance[1]) => {
                self.distance[k] = distance;
                if k == 1 && distance < self.distance[0] {
                    self.near.swap(0, 1);
                    self.distance.swap(0, 1);
                }
            }
            Some(_) => return false,
        }
        true
    }
}
