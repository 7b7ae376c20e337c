//! The door of the crate for points: all parts, one after another.

use arabesque_core::{Budget, Error, MeshPart, PointSet, Progress, Result, StopReason, TriangleMesh, Warning, Watch};

use super::{
    parts::{Name, parts},
    report::Notes,
    sheet::{CELL, Job, LEAST},
};
use crate::{
    cloud::Neighbours,
    mesh::MeshIndex,
    params::{Method, SurfaceParams},
};

/// What errors call the points.
const NAME: &str = "points";
/// Work of a point, and of the cells around it where they have the usual size, as measured on spheres.
const EACH: [f64; 2] = [10_000.0, 12_000.0];
/// Share of the work foretold that has to be within the limit: forecasts are rough.
const HOPELESS: f64 = 0.25;
/// Elements of a result that a point counts as, for the work that each adds.
const POINT: f64 = 0.01;
/// Points of fewer have no work worth telling.
const WORTH_TELLING: usize = 50_000;
/// Fewest points of which a surface is made at all.
const FEWEST: usize = 10;

/// A surface that was made of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Reconstruction {
    /// The surface, with normals, with colours where the points have some, and with parts where they have groups or elements.
    pub mesh: TriangleMesh,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// Why it ended: where somebody asked to stop, parts are missing.
    pub stopped: StopReason,
}

/// Makes a surface of points: through points with normals by robust implicit moving least squares, around points with radii by metaballs. Groups and rigid elements
/// become parts of their own. Where the points surround something the surface is closed, elsewhere it ends near the outermost of them. `trim`, a closed mesh,
/// cuts off what is outside of it; a surface that is closed gets a lid there. The watch is asked after each part.
///
/// # Errors
/// [`Error::Input`] for points of which no surface can be made, [`Error::Parameter`] for parameters that are not allowed or do not fit the points, [`Error::Limit`] where the
/// cells are too small for the work and memory that the limits allow, [`Error::Stopped`].
pub fn reconstruct(
    points: &PointSet<3>,
    params: &SurfaceParams,
    trim: Option<&MeshIndex>,
    budget: &Budget,
    watch: &mut dyn Watch<TriangleMesh>,
) -> Result<Reconstruction> {
    params.check()?;
    check(points, budget)?;
    let cell = match (params.cell, params.cells) {
        (Some(_), Some(cells)) => return Err(Error::parameter("cells", cells, "either cell or cells, not both")),
        (cell, None) => cell,
        (None, Some(cells)) => {
            let longest = points.bounds().size().0.iter().fold(0.0_f64, |a, &b| a.max(b));
            Some(longest / cells as f64)
        }
    };
    let job = Job { params, cell, trim, budget };
    budget.allow_elements(POINT * points.len() as f64);
    foresee(&job, points, watch)?;
    let (mut mesh, mut notes) = (
        TriangleMesh { colours: points.colours.as_ref().map(|_| Vec::new()), ..TriangleMesh::default() },
        Notes::default(),
    );
    let found = parts(points, params.parts);
    let (total, mut stopped) = (found.len(), StopReason::Finished);
    for (done, (name, numbers)) in found.into_iter().enumerate() {
        let text = name.text();
        if numbers.len() < LEAST && params_need_a_sheet(points) {
            notes.too_few.push(text);
            continue;
        }
        let first = mesh.triangles.len();
        for patch in job.patches(&points.selected(&numbers), &text, &mut notes)? {
            patch.append_to(&mut mesh);
        }
        if mesh.triangles.len() == first {
            notes.empty.push(text.clone());
        }
        if name != Name::All && mesh.triangles.len() > first {
            mesh.parts.push(MeshPart { name: text, triangles: first..mesh.triangles.len() });
        }
        let progress = Progress {
            stage: "making surfaces".into(),
            done: done + 1,
            total,
            fraction: (done + 1) as f64 / total as f64,
            energy: None,
            count: done + 1,
        };
        if watch.step(&progress, &|| mesh.clone()).is_break() && done + 1 < total {
            stopped = StopReason::Stopped;
            break;
        }
    }
    if mesh.triangles.is_empty() && stopped == StopReason::Finished {
        let why = if trim.is_some() {
            "no surface passes between the points inside of the mesh that trims it"
        } else {
            "no surface passes between the points"
        };
        return Err(Error::no_result(
            why,
            "check the normals or radii of the points, set a smaller cell or a larger kernel",
        ));
    }
    Ok(Reconstruction { mesh, warnings: notes.warnings(), stopped })
}

/// Tells how much work it will be, about, and refuses what is far too much.
fn foresee(job: &Job<'_>, points: &PointSet<3>, watch: &mut dyn Watch<TriangleMesh>) -> Result<()> {
    if points.len() < WORTH_TELLING || job.method(points) == Method::Metaballs {
        return Ok(());
    }
    let usual = CELL * Neighbours::usual_spacing(&points.positions, job.params.neighbours, job.budget)?;
    // The number of cells along a surface.
    let finer = job.cell.map_or(1.0, |cell| (usual / cell).powi(2));
    let count = points.len() as f64;
    let work = count * (EACH[0] + EACH[1] * finer);
    watch.foreseen(&job.budget.forecast(count, work));
    // There is nothing to show before the end: what is hopeless is not begun.
    job.budget.foresee((work * HOPELESS) as u64)
}

/// Whether points need others around them to make a surface: balls do not.
fn params_need_a_sheet(points: &PointSet<3>) -> bool {
    points.normals.is_some() || points.radii.is_none()
}

/// Refuses what no surface can be made of.
fn check(points: &PointSet<3>, budget: &Budget) -> Result<()> {
    points.check(NAME)?;
    let limits = *budget.limits();
    budget.within(NAME, points.len(), ("nodes", limits.nodes))?;
    let far = |p: &arabesque_core::Vector<3>| !p.0.iter().all(|c| c.abs() <= limits.coordinate);
    if let Some(k) = points.positions.iter().position(far) {
        let problem = format!("point {} is not between -{l} and {l}", k + 1, l = limits.coordinate);
        return Err(Error::input(
            NAME,
            problem,
            "remove it, move the points to the origin, or raise the limit with --limit coordinate=N",
        ));
    }
    let bad = |r: &f64| !(r.is_finite() && *r > 0.0);
    if let Some(k) = points.radii.as_ref().and_then(|radii| radii.iter().position(bad)) {
        return Err(Error::input(
            NAME,
            format!("point {} has no radius", k + 1),
            "give each point a positive radius, or leave radii out",
        ));
    }
    if points.len() < FEWEST && params_need_a_sheet(points) || points.is_empty() {
        let problem = format!("{} points, expected at least {FEWEST}", points.len());
        return Err(Error::input(NAME, problem, "give points spread over a surface, or radii for metaballs"));
    }
    Ok(())
}
