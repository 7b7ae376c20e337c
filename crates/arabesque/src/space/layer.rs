//! A single layer of things: bricks of a wall, tiles of a floor. Seen across the layer it is a drawing, and is continued as one: what
//! repeats goes on exactly, and outlines keep their distances.

use std::sync::Arc;

use arabesque_core::{
    Bounds, Budget, Domain, Element, Exemplar, GridIndex, Matrix, OrientationField, Outcome, Outline, Placement,
    Request as EngineRequest, Result, Similarity, Snapshot, Stage, Stream, Vector, Watch,
};
use arabesque_patterns::{Params, Prepared as Engine, Regular, repeat::Extent};
use arabesque_surface::{Axes, Closest, RowSite, SurfaceLattice};

use crate::space::shell::Shell;

const SOURCES: Stage = Stage::new(462);

/// Centres of a layer differ by less than this share of what its elements measure across it.
const SINGLE: f64 = 0.5;

/// Elements of a row may be wider than it by this factor, and this share of them has to fit: things laid by hand lean.
const ROOM: f64 = 1.08;
const MOST: f64 = 0.9;

/// Elements lie on one another from this share of their sizes; those that touch do not.
const LAP: f64 = 0.1;

/// Things that lie on one another are doubled when they are nearer than this share of the least distance of the exemplar.
const DOUBLED: f64 = 0.6;
/// Work for a thing that is looked at beside another one.
const NEAR: u64 = 100;

/// A layer as a drawing.
#[derive(Clone, Debug)]
pub(super) struct Layer {
    /// The axes of the drawing, and the one across it.
    axes: [usize; 2],
    pub(super) across: usize,
    /// The axis that is up.
    up: usize,
    drawing: Arc<Exemplar<2>>,
    engine: Engine<2>,
    /// Height of the middle of the exemplar's window across.
    middle: f64,
    /// Height of the floor of the exemplar, where the layer lies on one.
    floor: f64,
    /// The direction of rows that can slip along one another.
    rows: Option<Vector<2>>,
    /// Whether rows lie on one another.
    laps: bool,
    centres: Vec<Vector<3>>,
}

impl Layer {
    /// The exemplar as a drawing, if it is a single layer.
    ///
    /// # Errors
    /// As [`Engine::new`].
    pub(super) fn of(exemplar: &Exemplar<3>, params: &Params, budget: &Budget) -> Result<Option<Self>> {
        let Some(across) = (0..3).find(|&axis| is_single(exemplar, axis)) else { return Ok(None) };
        let axes = [[1, 2], [0, 2], [0, 1]][across];
        let flat = |p: Vector<3>| Vector(axes.map(|axis| p[axis]));
        let mut first: Vec<Option<Similarity<3>>> = vec![None; exemplar.classes.len()];
        let mut elements = Vec::with_capacity(exemplar.elements.len());
        for (n, element) in exemplar.elements.iter().enumerate() {
            let seen = exemplar.seen_pose(n);
            let own = *first[element.class].get_or_insert(seen);
            let turned = seen.rotation.compose(&own.rotation.transpose());
            let rotation = Matrix(axes.map(|r| axes.map(|c| turned.0[r][c]))).nearest_rotation();
            let ring = hull(element.outline.points().map(flat).collect());
            budget.spend(2000 + 100 * ring.len() as u64)?;
            let outline = Outline { rings: vec![ring] };
            let centre = outline.centroid().unwrap_or_else(|| flat(element.centre));
            elements.push(Element {
                class: element.class,
                centre,
                pose: Similarity::about(flat(own.translation), flat(element.pose.translation), rotation, 1.0),
                outline,
                colour: element.colour,
                lean: [Vector::ZERO; 3],
                role: element.role,
            });
        }
        let window = Bounds::new(flat(exemplar.window.min), flat(exemplar.window.max));
        let drawing = Arc::new(Exemplar::new("exemplar", elements, exemplar.classes.clone(), window)?);
        let engine = Engine::new(Arc::clone(&drawing), params, budget)?;
        let middle = exemplar.window.centre()[across];
        let centres: Vec<Vector<3>> = exemplar.elements.iter().map(|e| e.centre).collect();
        let stands = exemplar.heights.iter().zip(&centres).filter(|_| across == exemplar.up);
        let floor = stands.filter_map(|(height, centre)| Some(centre[across] - (*height)?)).next().unwrap_or(0.0);
        let rows = match engine.repeating() {
            Some(regular) => rows(&drawing, regular.repeat().lattice.vectors, budget)?,
            None => None,
        };
        let laps = rows.is_some_and(|(_, laps)| laps);
        let rows = rows.map(|(way, _)| way);
        let up = exemplar.up;
        Ok(Some(Self { axes, across, up, drawing, engine, middle, floor, rows, laps, centres }))
    }

    /// Fills a box, in the middle of which the layer lies; `None` where that turns it about another axis.
    ///
    /// # Errors
    /// As [`Engine::run`].
    pub(super) fn run(
        &self,
        request: &EngineRequest<3>,
        watch: &mut dyn Watch<Snapshot<3>>,
    ) -> Result<Option<Outcome<3>>> {
        let Domain::Box(bounds) = &request.domain else { return Ok(None) };
        if request.fields.orientation.is_some() && self.across != self.up || !request.frozen.is_empty() {
            return Ok(None);
        }
        let flat = |p: Vector<3>| Vector(self.axes.map(|axis| p[axis]));
        let around = Bounds::new(flat(bounds.min), flat(bounds.max));
        let mut own = EngineRequest::new(Domain::Box(around));
        own.border = request.border;
        own.fields.scale = arabesque_core::ScalarField::Constant(request.fields.scale.range().0);
        own.fields.density = arabesque_core::ScalarField::Constant(request.fields.density.range().0);
        own.fields.orientation = match &request.fields.orientation {
            Some(OrientationField::Constant(m)) => {
                Some(OrientationField::Constant(Matrix(self.axes.map(|r| self.axes.map(|c| m.0[r][c])))))
            }
            _ => None,
        };
        (own.seed, own.budget) = (request.seed, request.budget.clone());
        let to = if request.ground.is_some() {
            bounds.min[self.across] + (self.middle - self.floor) * own.fields.scale.range().0
        } else {
            bounds.centre()[self.across]
        };
        let mut raised = Raised { watch, layer: self, to };
        let outcome = self.engine.run(&own, &mut raised)?;
        Ok(Some(Outcome {
            placements: outcome.placements.iter().map(|p| self.raised(p, to)).collect(),
            sequence: Vec::new(),
            curves: Vec::new(),
            areas: Vec::new(),
            energy: outcome.energy,
            warnings: outcome.warnings,
            stopped: outcome.stopped,
        }))
    }

    /// The lattice of the drawing, if it repeats in the plane.
    fn regular(&self) -> Option<&Regular> {
        self.engine.repeating().filter(|regular| regular.repeat().extent == Extent::Plane)
    }

    /// Whether the drawing repeats in the plane.
    pub(super) fn repeats(&self) -> bool {
        self.regular().is_some()
    }

    /// The lattice, longer by a factor, with the rows that slip; nothing for a drawing without.
    fn lattice(&self, wider: f64) -> ([Vector<2>; 2], Option<Vector<2>>) {
        let vectors = self.regular().map_or([Vector::ZERO; 2], |regular| regular.repeat().lattice.vectors);
        (vectors.map(|v| v * wider), self.rows)
    }

    /// Height of the middle of the layer over a mesh.
    fn height(&self, shell: &Shell, scale: f64) -> f64 {
        (self.middle - shell.under) * scale
    }

    /// The axes of the drawing at a point of a mesh.
    fn along(&self, shell: &Shell, at: &Closest) -> Axes {
        let rotation = shell.rotation(at);
        self.axes.map(|axis| Vector([0, 1, 2].map(|r| rotation.0[r][axis])))
    }

    /// The share of a mesh on which the lattice does not go on.
    ///
    /// # Errors
    /// As [`SurfaceLattice::new`].
    pub(super) fn broken(&self, shell: &Shell, scale: f64, budget: &Budget) -> Result<f64> {
        let (axes, height) = (|at: &Closest| self.along(shell, at), self.height(shell, scale));
        SurfaceLattice::tried(&shell.index, &axes, self.lattice(scale), height, budget)
    }

    /// Covers a mesh, if the drawing repeats: its lattice is laid on the mesh and breaks where that bends too much; `None` if it does not.
    ///
    /// # Errors
    /// As [`SurfaceLattice::new`] and [`Engine::without_overlaps`].
    pub(super) fn cover(
        &self,
        (shell, solids): (&Shell, &Engine<3>),
        request: &EngineRequest<3>,
    ) -> Result<Option<Outcome<3>>> {
        let Some(regular) = self.regular().filter(|_| request.frozen.is_empty()) else { return Ok(None) };
        let (scale, density) = (request.fields.scale.range().0, request.fields.density.range().0);
        let wider = scale / density.sqrt();
        let budget = request.budget.stage("laying the lattice on the mesh");
        let (axes, height) = (|at: &Closest| self.along(shell, at), self.height(shell, scale));
        let lattice = SurfaceLattice::new(&shell.index, &axes, self.lattice(wider), height, (request.seed, &budget))?;
        let (mut sites, mut shown) = (Vec::new(), Vec::new());
        for (number, of_place) in regular.cell_places(&self.drawing).iter().enumerate() {
            let sum = of_place.iter().fold(Vector::ZERO, |sum, (_, centre)| sum + *centre);
            let mean = sum * (1.0 / of_place.len().max(1) as f64);
            let mut random = Stream::new(request.seed, SOURCES, number as u64);
            for place in lattice.places(&shell.index, mean * wider, &budget)? {
                sites.push(RowSite { at: place.at, offset: mean * wider, item: shown.len() });
                let (source, centre) = of_place[random.below(of_place.len())];
                shown.push((source, (centre - mean) * wider));
            }
        }
        let sites = lattice.even_rows(&shell.index, &axes, sites, &budget)?;
        let mut placements: Vec<_> =
            sites.iter().map(|site| self.on_mesh(shell, &site.at, shown[site.item], scale)).collect();
        if self.laps {
            let [a, b] = regular.repeat().lattice.vectors.map(Vector::norm);
            take_out_doubled(&mut placements, &self.centres, (a.max(b), wider), &budget)?;
        }
        solids.without_overlaps(placements, self.laps, request).map(Some)
    }

    /// An element of the exemplar over a point of a mesh, off by what it is off in the exemplar.
    fn on_mesh(&self, shell: &Shell, at: &Closest, (source, off): (usize, Vector<2>), scale: f64) -> Placement<3> {
        let axes = self.along(shell, at).into_iter().zip(off.0);
        let moved = axes.fold(Vector::ZERO, |sum, (axis, v)| sum + axis * v);
        let at = shell.index.closest(at.point + moved);
        let above = (self.centres[source][self.across] - shell.under) * scale;
        let place = at.point + at.normal * above;
        let transform = Similarity::about(self.centres[source], place, shell.rotation(&at), scale);
        Placement { source, transform, control: Vec::new(), frozen: None }
    }

    /// A place in the drawing as one in space, where the middle of the layer comes to the height `to`.
    fn raised(&self, placement: &Placement<2>, to: f64) -> Placement<3> {
        let own = &placement.transform;
        let mut rotation = Matrix::<3>::identity();
        for (r, &row) in self.axes.iter().enumerate() {
            for (c, &column) in self.axes.iter().enumerate() {
                rotation.0[row][column] = own.rotation.0[r][c];
            }
        }
        let centre = self.centres[placement.source];
        let flat = own.apply(Vector(self.axes.map(|axis| centre[axis])));
        let mut place = Vector([0.0; 3]);
        (place[self.axes[0]], place[self.axes[1]]) = (flat[0], flat[1]);
        place[self.across] = to + (centre[self.across] - self.middle) * own.scale;
        Placement {
            source: placement.source,
            transform: Similarity::about(centre, place, rotation, own.scale),
            control: Vec::new(),
            frozen: placement.frozen,
        }
    }
}

/// Whether the elements lie side by side across an axis, as those do that all stand on a floor.
fn is_single(exemplar: &Exemplar<3>, axis: usize) -> bool {
    if axis == exemplar.up && !exemplar.heights.is_empty() && exemplar.heights.iter().all(Option::is_some) {
        return true;
    }
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        high - low
    };
    let spread = range(&mut exemplar.elements.iter().map(|e| e.centre[axis]));
    let mut sizes: Vec<f64> =
        exemplar.elements.iter().map(|e| range(&mut e.outline.points().map(|p| p[axis]))).collect();
    sizes.sort_by(f64::total_cmp);
    spread < SINGLE * sizes.get(sizes.len() / 2).copied().unwrap_or(0.0)
}

/// The direction of rows of a lattice that could slip along one another: a short vector of it, x rather than y. Rows that lie beside one
/// another can, and so can those that lie on one another anyhow, as shingles do: which of the two it is comes second.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
fn rows(drawing: &Exemplar<2>, [a, b]: [Vector<2>; 2], budget: &Budget) -> Result<Option<(Vector<2>, bool)>> {
    let cell = a.cross(b).abs();
    let combinations = (-2_i8..=2).flat_map(|i| (-2_i8..=2).map(move |j| (f64::from(i), f64::from(j))));
    let mut ways: Vec<Vector<2>> = combinations.map(|(i, j)| a * i + b * j).filter(|v| v.norm() > 0.0).collect();
    ways.sort_by(|v, w| v[1].abs().total_cmp(&w[1].abs()).then(v.norm().total_cmp(&w.norm())));
    for way in ways {
        let (along, apart) = (way.unit_or_zero(), cell / way.norm());
        budget.spend(NEAR * drawing.elements.len() as u64)?;
        let widths = drawing.elements.iter().map(|e| {
            let (low, high) = range(&e.outline, left(along));
            high - low
        });
        let beside = widths.filter(|width| *width <= apart * ROOM).count() as f64;
        let is_beside = beside >= MOST * drawing.elements.len() as f64;
        if is_beside || lap(drawing, along, apart, budget)? {
            return Ok(Some((along, !is_beside)));
        }
    }
    Ok(None)
}

/// Whether rows along `way`, so far apart, lie on one another: most elements on two or more of the rows beside theirs, as tiles in bond do.
fn lap(drawing: &Exemplar<2>, way: Vector<2>, apart: f64, budget: &Budget) -> Result<bool> {
    let across = left(way);
    let centres: Vec<_> = drawing.elements.iter().map(|e| e.centre).collect();
    let sizes = drawing.elements.iter().map(|e| e.outline.bounds().size().norm());
    let reach = sizes.fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let index = GridIndex::new(&centres, reach, &Domain::Box(drawing.window));
    let mut lying = 0;
    for e in &drawing.elements {
        let mut on = 0;
        let looked = index.within(e.centre, reach, |k, offset| {
            let off = across.dot(offset).abs();
            let is_next = off > 0.5 * apart && off < 1.5 * apart;
            on += usize::from(is_next && laps(&e.outline, &drawing.elements[k].outline));
        });
        budget.spend(NEAR * (1 + looked))?;
        lying += usize::from(on >= 2);
    }
    Ok(lying * 2 > drawing.elements.len())
}

/// Whether two convex outlines lie on one another by more than [`LAP`] of what either measures in any direction.
fn laps(a: &Outline<2>, b: &Outline<2>) -> bool {
    let rings = a.rings.iter().chain(&b.rings);
    let mut edges = rings.flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
    edges.all(|(p, q)| {
        let normal = left(*q - *p).unit_or_zero();
        let ([a0, a1], [b0, b1]) = (<[f64; 2]>::from(range(a, normal)), <[f64; 2]>::from(range(b, normal)));
        a1.min(b1) - a0.max(b0) > LAP * (a1 - a0).min(b1 - b0)
    })
}

/// Takes out what is far nearer to another one than any two elements of the exemplar are: things that lie on one another anyhow are not
/// told by their overlaps. `within` is no less than the distance of those, and `wider` by how much the output is larger.
fn take_out_doubled(
    placements: &mut Vec<Placement<3>>,
    centres: &[Vector<3>],
    (within, wider): (f64, f64),
    budget: &Budget,
) -> Result<()> {
    let index = GridIndex::new(centres, within, &Domain::Box(Bounds::around(centres.iter().copied()).grown(within)));
    let mut nearest = within;
    for (k, &centre) in centres.iter().enumerate() {
        let (found, looked) = index.nearest_counted(centre, within, Some(k));
        budget.spend(NEAR * (1 + looked))?;
        nearest = found.map_or(nearest, |(_, distance)| nearest.min(distance));
    }
    let least = DOUBLED * wider * nearest;
    let places: Vec<_> = placements.iter().map(|p| p.transform.apply(centres[p.source])).collect();
    let index = GridIndex::new(&places, least, &Domain::Box(Bounds::around(places.iter().copied()).grown(least)));
    let mut gone = vec![false; places.len()];
    for (i, &place) in places.iter().enumerate() {
        let mut is_doubled = false;
        let looked = index.within(place, least, |j, _| is_doubled |= j < i && !gone[j]);
        budget.spend(NEAR * (1 + looked))?;
        gone[i] = is_doubled;
    }
    let mut gone = gone.into_iter();
    placements.retain(|_| gone.next() != Some(true));
    Ok(())
}

/// A vector turned by a quarter.
fn left(v: Vector<2>) -> Vector<2> {
    Vector::xy(-v[1], v[0])
}

/// From where to where an outline reaches along a direction.
fn range(outline: &Outline<2>, along: Vector<2>) -> (f64, f64) {
    let places = outline.points().map(|p| along.dot(p));
    places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// The convex hull of points of the plane, counter-clockwise.
fn hull(mut points: Vec<Vector<2>>) -> Vec<Vector<2>> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let half = |points: &mut dyn Iterator<Item = Vector<2>>| {
        let mut chain: Vec<Vector<2>> = Vec::new();
        for p in points {
            while let [.., a, b] = chain.as_slice()
                && (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut ring = half(&mut points.iter().copied());
    ring.extend(half(&mut points.iter().rev().copied()));
    ring
}

/// Shows what the drawing has so far as it is in space.
struct Raised<'a> {
    watch: &'a mut dyn Watch<Snapshot<3>>,
    layer: &'a Layer,
    to: f64,
}

impl Watch<Snapshot<2>> for Raised<'_> {
    fn foreseen(&mut self, forecast: &arabesque_core::Forecast) {
        self.watch.foreseen(forecast);
    }

    fn step(
        &mut self,
        progress: &arabesque_core::Progress,
        preview: &dyn Fn() -> Snapshot<2>,
    ) -> std::ops::ControlFlow<()> {
        let (layer, to) = (self.layer, self.to);
        self.watch.step(progress, &|| {
            let flat = preview();
            let placements = flat.placements.iter().map(|p| layer.raised(p, to)).collect();
            Snapshot { placements, ..Snapshot::default() }
        })
    }
}

/// A layer that can be shared.
pub(super) fn layer(exemplar: &Exemplar<3>, params: &Params, budget: &Budget) -> Result<Option<Arc<Layer>>> {
    Ok(Layer::of(exemplar, params, budget)?.map(Arc::new))
}
