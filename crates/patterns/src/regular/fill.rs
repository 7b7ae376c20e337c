//! Filling a domain from an exemplar that repeats.

use arabesque_core::{
    Border, Budget, Covered, Domain, Drawn, Element, Error, Exemplar, Outcome, Request, Result, Role, Snapshot, Vector,
    Warning, Watch,
};

use crate::{
    ending,
    exemplar::{checks, library::farthest},
    obstacles::obstacles,
    regular::{
        areas,
        bend::fill::Pattern,
        choice::Cells,
        elements::Elements,
        grid::{Grid, Ground, Unfit},
        joints::Cell,
        kept::Kept,
        lost::lost,
        strokes::Strokes,
    },
    repeat::{
        Explains, Extent, Repeat,
        find::find_for,
        orbits::{Instance, Orbit, orbits},
    },
};

/// Elements that fit no place of the repeat, as a share of all, up to which the repeat explains the exemplar.
const UNEXPLAINED: f64 = 0.1;

/// Elements nearer to the frame than this share of the shorter vector may have been cut to fit.
const RIM: f64 = 0.35;

/// Residuals that differ by this share of the shorter vector count half as much as different things.
const RESIDUAL: f64 = 0.1;

/// Things lie off by no more than this share of the shorter vector where a pattern was constructed.
const EXACT: f64 = 5e-3;

/// Stretching that nobody sees.
const UNSEEN: f64 = 1e-3;

/// Work for an element, for the forecast.
const PER_ELEMENT: f64 = 2e3;

/// An exemplar that repeats, ready for any number of runs.
#[derive(Clone, Debug)]
pub struct Regular {
    pub(crate) repeat: Repeat,
    orbits: Vec<Orbit>,
    cells: Cells,
    cell: Option<Cell>,
    /// Whole elements that fit no place.
    others: usize,
    /// Elements out of all proportion to the frame.
    giants: usize,
    /// Elements that the frame has cut and that the repeat does not show whole.
    lost: usize,
}

/// What came of a request.
pub enum Filled<const D: usize> {
    /// The result.
    Done(Outcome<D>),
    /// The lattice cannot serve it, and what to say about that.
    Unfit(Vec<Warning>),
}

impl Regular {
    /// Finds the repeat of an exemplar; `None` where it has none that explains it.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Self>> {
        find_for(exemplar, budget, |repeat| Self::of(exemplar, repeat.clone(), budget))
    }

    /// With a repeat; `None` where that does not explain enough.
    fn of(exemplar: &Exemplar<2>, repeat: Repeat, budget: &Budget) -> Result<Option<Self>> {
        let has_lines = !exemplar.curves.is_empty() || !exemplar.areas.is_empty();
        if has_lines && repeat.explains == Explains::Places {
            return Ok(None);
        }
        let (orbits, others) = orbits(exemplar, &repeat, budget)?;
        let is_giant = |e: &&Element<2>| e.outline.radius(e.centre) > farthest(&exemplar.window);
        let whole = exemplar.elements.iter().filter(|e| e.role == Role::Source).count();
        let giants = exemplar.elements.iter().filter(|e| e.role == Role::Source).filter(is_giant).count();
        // What people cut to fit at the sides of the page explains nothing.
        let shorter = repeat.lattice.shorter();
        let inner = exemplar.window.grown(-RIM * shorter);
        let is_inner = |e: &&u32| {
            let bounds = exemplar.elements[**e as usize].outline.bounds();
            inner.contains(bounds.min) && inner.contains(bounds.max)
        };
        let unexplained = others.iter().filter(is_inner).count();
        if unexplained as f64 > UNEXPLAINED * whole as f64 || (orbits.is_empty() && !has_lines) {
            return Ok(None);
        }
        let cell = if has_lines {
            match Cell::new(exemplar, &repeat.lattice, budget)? {
                Some(cell) => Some(cell),
                None => return Ok(None),
            }
        } else {
            None
        };
        let unit = RESIDUAL * repeat.lattice.shorter();
        let cells = Cells::new(exemplar, &orbits, unit, budget)?;
        // By hand, and where only places repeat, nothing is where the frame has cut it.
        let is_exact = repeat.explains == Explains::Everything && repeat.jitter <= EXACT * shorter;
        let lost = match repeat.extent {
            Extent::Plane if is_exact => lost(exemplar, &repeat, (&orbits, cell.as_ref()), budget)?.len(),
            _ => 0,
        };
        Ok(Some(Self { repeat, orbits, cells, cell, others: others.len(), giants, lost }))
    }

    /// How many elements that the frame has cut the repeat does not show, or not whole: they are left out.
    pub fn lost(&self) -> usize {
        self.lost
    }

    /// A strip that would run past the domain runs through its middle.
    fn move_strip_into(&self, grid: &mut Grid, exemplar: &Exemplar<2>, request: &Request<2>) {
        if self.repeat.extent != Extent::Frieze {
            return;
        }
        let bounds = request.domain.bounds();
        let lines = exemplar.curves.iter().map(|curve| curve.path.bounds().centre());
        let places: Vec<_> = self.orbits.iter().map(|orbit| orbit.base).chain(lines).collect();
        let places: Vec<_> = places.into_iter().map(|p| grid.place(p, [0, 0])).collect();
        for axis in 0..2 {
            let (low, high) = (bounds.min[axis], bounds.max[axis]);
            let size = exemplar.window.size()[axis] * grid.scale();
            // The next strip lies as far away as the frame is wide.
            let is_across = grid.lattice.vectors.iter().any(|v| (v[axis].abs() - size).abs() < 1e-6 * size);
            let is_in = |p: &Vector<2>| low + (p[axis] - low).rem_euclid(size) <= high;
            if !is_across || places.is_empty() || places.iter().any(is_in) {
                continue;
            }
            let middle = places.iter().map(|p| p[axis]).sum::<f64>() / places.len() as f64;
            let mut by = Vector::ZERO;
            by[axis] = 0.5 * (low + high) - middle;
            grid.move_by(by);
        }
    }

    /// Fills a domain.
    ///
    /// # Errors
    /// [`Error::Limit`] when the output would be too large, or a limit is reached before there is anything;
    /// [`Error::Stopped`] when somebody asks to stop so early; [`Error::NoResult`] when nothing fits into the domain.
    pub(crate) fn fill(
        &self,
        exemplar: &Exemplar<2>,
        request: &Request<2>,
        watch: &mut dyn Watch<Snapshot<2>>,
    ) -> Result<Filled<2>> {
        // A tile has no border at which strokes could turn.
        let turns = request.border == Border::Turn && !matches!(request.domain, Domain::Torus(_));
        if self.cell.is_some() && turns {
            return Ok(Filled::Unfit(Vec::new()));
        }
        let mut grid = match Grid::new(&self.repeat, exemplar, request) {
            Ok(grid) => grid,
            Err(Unfit::Fields) => return self.bend(exemplar, request, watch),
            Err(Unfit::Tile) => return Ok(Filled::Unfit(vec![self.unfit_tile(request)])),
        };
        if request.frozen.is_empty() && request.known.is_none() {
            self.move_strip_into(&mut grid, exemplar, request);
        }
        self.foresee(&grid, request, watch)?;
        let obstacles = obstacles(request)?;
        let elements = Elements { exemplar, anchor: self.repeat.anchor, orbits: &self.orbits, cells: &self.cells };
        // What surrounds a region that is filled again has told the lattice already.
        if exemplar.hole.is_none() || request.known.is_none() {
            elements.join_kept(&mut grid, request)?;
        }
        if let (Some(cell), false) = (&self.cell, request.frozen_curves.is_empty())
            && !Kept::lies_on(request, exemplar, cell, &grid)?
        {
            return Ok(Filled::Unfit(Vec::new()));
        }
        let placed = elements.place(&grid, request, obstacles.as_ref(), watch)?;
        let (mut cut_short, mut curves, mut areas) = (placed.ended.err(), kept_strokes(request), Vec::new());
        if let (Some(cell), None) = (&self.cell, &cut_short) {
            cut_short = self
                .strokes(
                    exemplar,
                    cell,
                    &Ground { grid: &grid, request, obstacles: obstacles.as_ref() },
                    (&mut curves, &mut areas),
                )
                .err();
        }
        if placed.placements.is_empty() && curves.is_empty() && areas.is_empty() {
            return Err(cut_short.unwrap_or_else(|| {
                let what = if self.cell.is_some() { "stroke" } else { "element" };
                let advice = "make the domain larger, lower the scale, or allow elements to cross its border";
                Error::no_result(format!("no {what} fits into the domain"), advice)
            }));
        }
        let mut warnings = self.warnings(&grid, request);
        let stopped = ending::reason(cut_short, &mut warnings)?;
        let energy = Vec::new();
        let (placements, sequence) = (placed.placements, Vec::new());
        Ok(Filled::Done(Outcome { placements, sequence, curves, areas, energy, warnings, stopped }))
    }

    /// Fills a domain over which fields vary.
    fn bend(
        &self,
        exemplar: &Exemplar<2>,
        request: &Request<2>,
        watch: &mut dyn Watch<Snapshot<2>>,
    ) -> Result<Filled<2>> {
        let elements = Elements { exemplar, anchor: self.repeat.anchor, orbits: &self.orbits, cells: &self.cells };
        let pattern = Pattern { repeat: &self.repeat, elements, cell: self.cell.as_ref() };
        let Some(mut outcome) = pattern.bent(request, watch)? else {
            return Ok(Filled::Unfit(vec![Warning::new(
                "no lattice can follow the fields here, so that the repeat is not kept",
                "use fields that turn and grow more gently, or one direction and scale for the whole page",
            )]));
        };
        outcome.warnings.splice(0..0, self.left_out());
        Ok(Filled::Done(outcome))
    }

    /// The repeat by which it is continued.
    pub fn repeat(&self) -> &Repeat {
        &self.repeat
    }

    /// For each place of the cell the elements of the exemplar that show it, and where each would have its centre at the node at
    /// the origin.
    pub fn cell_places(&self, exemplar: &Exemplar<2>) -> Vec<Vec<(usize, Vector<2>)>> {
        let centre = |instance: &Instance| {
            let e = instance.element as usize;
            (e, exemplar.elements[e].centre - self.repeat.lattice.at(instance.node))
        };
        self.orbits.iter().map(|orbit| orbit.instances.iter().map(centre).collect()).collect()
    }

    /// Which elements lie at which place of the cell.
    pub(crate) fn places(&self) -> Vec<(usize, usize)> {
        let place = |(number, orbit): (usize, &Orbit)| {
            orbit.instances.iter().map(move |instance| (instance.element as usize, number)).collect::<Vec<_>>()
        };
        self.orbits.iter().enumerate().flat_map(place).collect()
    }

    /// Draws strokes and areas into `made`, where they stay when the run is cut short.
    fn strokes(
        &self,
        exemplar: &Exemplar<2>,
        cell: &Cell,
        ground: &Ground<'_>,
        made: (&mut Vec<Drawn<2>>, &mut Vec<Covered<2>>),
    ) -> Result<()> {
        let kept = Kept::new(ground.request, exemplar, ground.grid.lattice.shorter())?;
        let strokes = Strokes { exemplar, cell, kept: kept.as_ref() };
        let margin = strokes.widest() * ground.grid.scale();
        let nodes = strokes.nodes(ground, margin)?;
        strokes.draw(ground, &nodes, made.0)?;
        areas::draw(&cell.areas, cell.origin, ground, made.1)
    }

    /// Tells what the run will take, and refuses what is too much.
    fn foresee(&self, grid: &Grid, request: &Request<2>, watch: &mut dyn Watch<Snapshot<2>>) -> Result<()> {
        let cells = request.domain.measure() / grid.lattice.cell();
        let parts = self.cell.as_ref().map_or(0, |cell| cell.parts.len() + cell.areas.len());
        let count = cells * (self.orbits.len() + parts) as f64;
        checks::expected(count, &request.budget)?;
        request.budget.allow_elements(count);
        watch.foreseen(&request.budget.forecast(count, count * PER_ELEMENT));
        Ok(())
    }

    /// Warns of elements that are left out.
    fn left_out(&self) -> Vec<Warning> {
        let mut warnings: Vec<_> = checks::giants_left_out(self.giants).into_iter().collect();
        if self.others > 0 {
            warnings.push(Warning::new(
                format!("elements that fit no place of the repeat left out: {}", self.others),
                "set repeat=off to treat the pattern as irregular",
            ));
        }
        if self.lost > 0 {
            warnings.push(Warning::new(
                format!("elements cut by the frame that the repeat shows nowhere whole left out: {}", self.lost),
                "show more of the pattern, or draw them whole, reaching over the frame",
            ));
        }
        warnings
    }

    fn warnings(&self, grid: &Grid, request: &Request<2>) -> Vec<Warning> {
        let mut warnings = self.left_out();
        if grid.stretch > UNSEEN {
            warnings.push(Warning::new(
                format!(
                    "the tile does not suit the repeat, which is stretched by {:.1} % to fit",
                    100.0 * grid.stretch
                ),
                self.suiting(request),
            ));
        }
        warnings
    }

    fn unfit_tile(&self, request: &Request<2>) -> Warning {
        Warning::new("the tile does not suit the repeat of the exemplar, which is not kept", self.suiting(request))
    }

    /// Advice on sizes of tiles.
    fn suiting(&self, request: &Request<2>) -> String {
        let size = request.domain.bounds().size();
        match self.repeat.smallest_tile() {
            Some(least) => {
                let near = |k: usize| (size[k] / least[k]).round().max(1.0) * least[k];
                format!(
                    "the nearest tile that suits is {}x{}, the smallest {}x{} (--tile auto)",
                    short(near(0)),
                    short(near(1)),
                    short(least[0]),
                    short(least[1])
                )
            }
            None => "no tile along the axes suits it: make the tile larger, so that less stretching does".into(),
        }
    }
}

/// The strokes that the user drew, as they are.
fn kept_strokes(request: &Request<2>) -> Vec<Drawn<2>> {
    let one = |(n, drawn): (usize, &Drawn<2>)| Drawn { frozen: Some(n), ..drawn.clone() };
    request.frozen_curves.iter().enumerate().map(one).collect()
}

/// A length with as many digits as tell it from a wrong one.
fn short(length: f64) -> String {
    let text = format!("{length:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
