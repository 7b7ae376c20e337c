//! Reliefs: more of a patch of surface detail, in the plane, on meshes, and in gaps of scans.

mod heights;
mod made;
mod read;

use std::sync::Arc;

use arabesque_core::{Bounds, Error, PointSet, Result, StopReason, Vector, Warning, Watch, rounded};
use arabesque_reliefs::{Ground, Prepared as Engine, ReliefOutcome, ReliefRequest};
use arabesque_surface::{DirectionField, Directions, MeshIndex, MeshReport};

use crate::{
    artwork::Artwork,
    method::{Preparation, Ready, RunContext, Show},
    plane::in_exemplar,
    recipe::{Job, Relief, Size},
    solid::read::indexed_mesh,
    structure::directions,
    surface::{Surfaced, surfaced},
};
use heights::Grid;
use made::{ReliefMade, ReliefMesh};

/// Edges of meshes are rounded by so many spacings at least.
const BEND: f64 = 8.0;
/// And by no more than this share of the shortest side of the box around the mesh; where that is less than the second share of what the relief
/// needs, edges stay as they are, since both sides of what is so thin have the relief in one another anyway.
const THIN: (f64, f64) = (0.2, 0.25);

/// A relief, understood.
#[derive(Debug)]
pub(crate) struct Texture {
    engine: Engine,
    /// What was read, in words.
    kind: &'static str,
    /// Side of a pixel, of a height field.
    pixel: Option<f64>,
}

/// Reads a relief to continue it.
pub(crate) fn prepare(job: &Relief, preparation: &mut Preparation<'_>) -> Result<Texture> {
    let params = job.engine_params()?;
    job.surface_params()?;
    job.check()?;
    let bytes = preparation.files.read(&preparation.exemplar)?;
    let found = read::texture(preparation.exemplar.name(), &bytes, job.height, preparation.files.budget())?;
    preparation.warnings.extend(found.warnings);
    preparation.exemplar = preparation.exemplar.embedding(&bytes);
    let name = preparation.exemplar.name();
    // Across the plane the box is as high as the points.
    let all = found.points.bounds();
    let proper = job.proper()?;
    let bounds = proper.map(|b| proper_box(&b, &all, &found.points, &params));
    let new = if job.fill_hole { Engine::with_gap } else { Engine::new };
    let engine = new(&found.points, bounds, &params, preparation.files.budget())
        .map_err(|error| in_exemplar(renamed(error, name), name))?;
    preparation.warnings.extend(engine.warnings().iter().cloned());
    Ok(Texture { engine, kind: found.kind, pixel: found.pixel })
}

/// The box of the relief proper in the axes of the file: `b` along the plane, all of the points across it.
fn proper_box(
    b: &Bounds<2>,
    all: &Bounds<3>,
    points: &PointSet<3>,
    params: &arabesque_reliefs::ReliefParams,
) -> Bounds<3> {
    let axes = arabesque_reliefs::Axes::of(points, params.plane);
    let (low, high) = (axes.lie(all.min), axes.lie(all.max));
    let corner = |p: Vector<2>, z: f64| axes.stand(Vector([p[0], p[1], z]));
    Bounds::new(corner(b.min, low[2]), corner(b.max, high[2]))
}

/// The engine knows no file names.
fn renamed(error: Error, name: &str) -> Error {
    match error {
        Error::Input { problem, advice, .. } => Error::input(name, problem, advice),
        other => other,
    }
}

impl Ready for Texture {
    fn understood(&self) -> String {
        let engine = &self.engine;
        let ([w, d, h], patch, spacing) =
            (engine.size().map(rounded), rounded(engine.patch()), rounded(engine.spacing()));
        let lean = match engine.axes().lean() {
            0.0 => String::new(),
            lean => format!(", from which it leans by {lean:.1} degrees"),
        };
        let across = ["x", "y", "z"][engine.axes().across_axis()];
        let repeats = match engine.repetition() {
            Some(length) => {
                format!("repeats after {} ({:.0} %){}", rounded(length), 100.0 * engine.regularity(), lattice(engine))
            }
            None => "does not repeat".to_owned(),
        };
        format!(
            "exemplar: a relief of {} points ({}), {spacing} apart, across {across}{lean}; its box is {w} by {d} and {h} high; it {repeats}; patches of {patch}",
            engine.points(),
            self.kind,
        )
    }

    fn run(self: Arc<Self>, mut context: RunContext<'_>, watch: &mut dyn Watch<Artwork>) -> Result<Artwork> {
        let Job::Relief(mut job) = context.job.clone() else {
            return Err(Error::parameter("request", context.job.name(), "a request for a relief"));
        };
        job.check()?;
        let ground = self.ground(&mut job, &mut context)?;
        let mut request = ReliefRequest::new(ground);
        (request.seed, request.budget) = (context.seed, context.budget().clone());
        let surface = if job.mesh { Some(job.surface_params()?) } else { None };
        let engine = &self.engine;
        let grid = job.height_field.then(|| Grid {
            axes: engine.axes(),
            extent: job.extent.as_ref().map(|size| size.sides),
            is_tile: job.tile,
            pixel: self.pixel.unwrap_or(0.5 * engine.spacing()),
            spacing: engine.spacing(),
        });
        context.job = Job::Relief(job);
        let origin = context.origin();
        let make = |points: PointSet<3>| ReliefMade::unfinished(points, grid);
        let outcome = engine.run(&request, &mut Show { watch, origin: &origin, make })?;
        let told: Vec<Warning> = std::mem::take(&mut context.warnings);
        // What the engine says again was said when it was prepared.
        let own = outcome.warnings.iter().filter(|w| !told.contains(w)).cloned().collect::<Vec<_>>();
        let outcome = ReliefOutcome { warnings: told.into_iter().chain(own).collect(), ..outcome };
        let Some(params) = surface else {
            return Ok(Artwork::new(origin, ReliefMade::new(outcome, grid)));
        };
        let told = (outcome.warnings.clone(), outcome.stopped);
        Ok(match surfaced(&outcome.points, told, &params, context.budget())? {
            Surfaced::Mesh(found) => Artwork::new(origin, ReliefMesh::new(found, outcome.statistics)),
            Surfaced::Left(warnings) => {
                let outcome = ReliefOutcome { warnings, stopped: StopReason::Stopped, ..outcome };
                Artwork::new(origin, ReliefMade::new(outcome, grid))
            }
        })
    }
}

impl Texture {
    /// Where the relief goes; files are embedded.
    fn ground(&self, job: &mut Relief, context: &mut RunContext<'_>) -> Result<Ground> {
        if let Some(input) = &mut job.on {
            let (index, warnings) = indexed_mesh(input, context.files)?;
            context.warnings.extend(warnings);
            let report = MeshReport::new(&index, context.budget())?;
            context.warnings.extend(report.surface_of(input.name())?);
            let directions = directions(&mut job.direction, context)?;
            let (index, field) = self.shell(index, &directions, job.scale.unwrap_or(1.0), context)?;
            context.warnings.extend(field.warnings().iter().cloned());
            return Ok(Ground::Mesh(Arc::new(index), Arc::new(field), job.scale.unwrap_or(1.0)));
        }
        let extent = job.extent.as_ref().map(sides).transpose()?;
        context.warnings.extend(extent.and_then(|size| self.crumb(size)));
        match extent {
            Some(size) if job.tile => {
                context.warnings.extend(self.unsuited(size));
                Ok(Ground::Tile(size))
            }
            Some(size) => Ok(Ground::Plane(size)),
            None => Ok(Ground::Hole),
        }
    }

    /// The mesh with no edge sharper than the relief can bend over, since a convex edge would tear it and a hollow one fold it; and which way the
    /// relief runs there.
    fn shell(
        &self,
        mesh: MeshIndex,
        directions: &Directions,
        scale: f64,
        context: &mut RunContext<'_>,
    ) -> Result<(MeshIndex, DirectionField)> {
        self.engine.foresee(&mesh, scale, &context.budget().stage("laying patches"))?;
        let [_, _, height] = self.engine.size();
        let thinnest = mesh.bounds().size().0.into_iter().filter(|s| *s > 0.0).fold(f64::INFINITY, f64::min);
        let wanted = (0.5 * height).max(BEND * self.engine.spacing()) * scale;
        let radius = wanted.min(THIN.0 * thinnest);
        let is_thin = radius < THIN.1 * wanted;
        let round = if is_thin { None } else { mesh.with_round_edges(radius, context.budget())? };
        let Some(round) = round else {
            let field = DirectionField::new(&mesh, directions, context.budget())?;
            return Ok((mesh, field));
        };
        let message = format!(
            "the mesh has sharp edges: they are rounded by about {}, so that the relief goes on over them",
            rounded(radius)
        );
        context.warnings.push(Warning::new(message, "bevel them in the mesh to say how"));
        // How the mesh bends at its edges says nothing of which way the relief runs between them.
        let field = match directions {
            Directions::Curvature(_) => {
                let field = DirectionField::new(&mesh, directions, context.budget())?;
                field.carried_over(&mesh, &round, context.budget())?
            }
            _ => DirectionField::new(&round, directions, context.budget())?,
        };
        Ok((round, field))
    }

    /// What to say of a tile after whose sides a strictly repeating texture does not come again.
    fn unsuited(&self, size: [f64; 2]) -> Option<Warning> {
        let better = self.engine.better_tile(size)?;
        let of = |k: usize| {
            let near: Vec<String> = better[k].iter().flatten().map(|length| rounded(*length)).collect();
            if near.is_empty() { "none near".to_owned() } else { near.join(" or ") }
        };
        let [w, d] = size.map(rounded);
        let message = format!("a tile of {w}x{d} does not suit what repeats: where it closes, the order is broken");
        let advice = format!("widths that suit: {}; depths that suit: {}", of(0), of(1));
        Some(Warning::new(message, advice))
    }

    /// What to say where so little is wanted that it does not show what the texture is.
    fn crumb(&self, size: [f64; 2]) -> Option<Warning> {
        let ([w, d, _], patch) = (self.engine.size(), self.engine.patch());
        let message = || {
            let [wanted, other, w, d, patch] = [size[0], size[1], w, d, patch].map(rounded);
            format!(
                "the extent {wanted}x{other} is smaller than one patch of {patch}; the texture itself is {w} by {d}"
            )
        };
        let advice = "give the extent in the units of the texture: of a height field in pixels";
        (size.iter().any(|s| *s > 0.0 && *s < patch)).then(|| Warning::new(message(), advice))
    }
}

/// The shifts of what repeats strictly.
fn lattice(engine: &Engine) -> String {
    let show = |[x, y]: [f64; 2]| format!("({}, {})", rounded(x), rounded(y));
    engine.repeat().map_or_else(String::new, |[a, b]| format!(", strictly by {} and {}", show(a), show(b)))
}

/// Width and depth in the units of the exemplar.
fn sides(size: &Size) -> Result<[f64; 2]> {
    match size.unit {
        None => Ok(size.sides),
        Some(_) => Err(Error::parameter("extent", size, "plain numbers, because points have no unit of length")),
    }
}
