//! Filling a domain with a pattern that repeats, bent by fields.

use arabesque_core::{Border, Domain, Exemplar, Outcome, Request, Result, Snapshot, Vector, Warning, Watch};

use crate::{
    ending,
    exemplar::checks,
    obstacles::obstacles,
    regular::{
        bend::{
            areas,
            charts::{Bent, Charts},
            elements::Bending,
            raster::{Raster, Wanted},
            strokes::BentStrokes,
        },
        elements::Elements,
        grid::Grid,
        joints::Cell,
    },
    repeat::{Extent, Repeat},
};

/// Work for an element, for the forecast.
const PER_ELEMENT: f64 = 6e3;

/// Stretching that is worth telling.
const TOLD: f64 = 0.02;

/// What is bent.
pub(crate) struct Pattern<'a> {
    pub(crate) repeat: &'a Repeat,
    pub(crate) elements: Elements<'a>,
    pub(crate) cell: Option<&'a Cell>,
}

impl Pattern<'_> {
    /// Fills the domain of a request; `None` where the lattice cannot follow its fields, or has to suit a tile or what stays as
    /// well.
    ///
    /// # Errors
    /// As for filling a flat page.
    pub(crate) fn bent(&self, request: &Request<2>, watch: &mut dyn Watch<Snapshot<2>>) -> Result<Option<Outcome<2>>> {
        let is_free = request.frozen.is_empty() && request.frozen_curves.is_empty();
        let turns = self.cell.is_some() && request.border == Border::Turn;
        if !is_free || turns || matches!(request.domain, Domain::Torus(_)) {
            return Ok(None);
        }
        let exemplar = self.elements.exemplar;
        let Some(charts) = self.charts(exemplar, request)? else { return Ok(None) };
        self.foresee(request, watch)?;
        let obstacles = obstacles(request)?;
        let lattice = &self.repeat.lattice;
        let bending = Bending { charts: &charts, lattice, request, obstacles: obstacles.as_ref() };
        let placed = bending.place(&self.elements, watch)?;
        let (mut cut_short, mut curves, mut drawn) = (placed.ended.err(), Vec::new(), Vec::new());
        if let (Some(cell), None) = (self.cell, &cut_short) {
            let flat = Grid::flat(self.repeat);
            let strokes = BentStrokes { bending: &bending, exemplar, cell, flat: &flat };
            cut_short = strokes.draw(&mut curves).and_then(|()| areas::draw(&strokes, &mut drawn)).err();
        }
        if placed.placements.is_empty() && curves.is_empty() && drawn.is_empty() {
            return match cut_short {
                Some(error) => Err(error),
                None => Ok(None),
            };
        }
        let mut warnings = told(&charts);
        let stopped = ending::reason(cut_short, &mut warnings)?;
        let (placements, sequence, energy) = (placed.placements, Vec::new(), Vec::new());
        Ok(Some(Outcome { placements, sequence, curves, areas: drawn, energy, warnings, stopped }))
    }

    /// The charts of the page and of what reaches into it.
    fn charts(&self, exemplar: &Exemplar<2>, request: &Request<2>) -> Result<Option<Charts>> {
        let budget = request.budget.stage("following the fields");
        let fields = &request.fields;
        let (smallest, largest) = fields.scale.range();
        let dense = fields.density.range();
        let sources = self.elements.orbits.iter().flat_map(|orbit| &orbit.instances);
        let elements = sources.map(|instance| &exemplar.elements[instance.element as usize]);
        let radius = elements.map(|e| e.outline.radius(e.centre)).fold(0.0, f64::max);
        let parts = self.cell.iter().flat_map(|cell| &cell.parts);
        let width = parts.map(|part| exemplar.curves[part.curve].width).fold(0.0, f64::max);
        let margin = largest * (radius.max(width) + 0.1 * self.repeat.lattice.shorter());
        let unit = self.repeat.lattice.shorter() * smallest * dense.1.powf(-0.5);
        let raster = Raster::over(&request.domain.bounds().grown(margin), unit);
        let wanted = Wanted::new(&raster, fields, &budget)?;
        let across = match self.repeat.extent {
            Extent::Stripes(along) => Some(Vector::xy(-along[1], along[0]).unit_or_zero()),
            Extent::Plane | Extent::Frieze => None,
        };
        let reach = margin + raster.step;
        let shows = |cell: &usize| request.domain.signed_distance(raster.centre(*cell)) >= -reach;
        let cells: Vec<usize> = (0..raster.count()).filter(shows).collect();
        let bent = Bent { raster: &raster, wanted: &wanted, lattice: &self.repeat.lattice, across };
        let Some(mut charts) = bent.charts(cells, &budget)? else { return Ok(None) };
        // What lies in the middle of the frame lies in the middle of the page.
        let middle = request.domain.bounds().centre();
        let from = |node: &usize| (raster.node(*node) - middle).norm2();
        let first = &charts.all[0];
        let nearest = first.nodes().iter().copied().min_by(|a, b| from(a).total_cmp(&from(b)));
        if let Some(image) = nearest.and_then(|node| first.image(node)) {
            charts.all.iter_mut().for_each(|chart| chart.move_by(exemplar.window.centre() - image));
        }
        Ok(Some(charts))
    }

    /// Tells what the run will take, and refuses what is too much.
    fn foresee(&self, request: &Request<2>, watch: &mut dyn Watch<Snapshot<2>>) -> Result<()> {
        let middle = request.fields.frame(request.domain.bounds().centre()).spacing_scale;
        let cells = request.domain.measure() / (self.repeat.lattice.cell() * middle * middle);
        let parts = self.cell.map_or(0, |cell| cell.parts.len() + cell.areas.len());
        let count = cells * (self.elements.orbits.len() + parts) as f64;
        checks::expected(count, &request.budget)?;
        request.budget.allow_elements(count);
        watch.foreseen(&request.budget.forecast(count, count * PER_ELEMENT));
        Ok(())
    }
}

/// What was done to the lattice.
fn told(charts: &Charts) -> Vec<Warning> {
    if charts.stretch < TOLD && charts.breaks == 0 {
        return Vec::new();
    }
    let breaks = match charts.breaks {
        0 => "nowhere".to_owned(),
        1 => "along one line".to_owned(),
        n => format!("along {n} lines"),
    };
    let message =
        format!("the fields stretch the repeat by up to {:.0} % and break it {breaks}", 100.0 * charts.stretch);
    vec![Warning::new(message, "fields that turn and grow more gently stretch and break it less")]
}
