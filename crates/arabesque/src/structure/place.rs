//! Where a structure goes.

use std::sync::Arc;

use arabesque_core::{
    Bounds, Domain, Error, Fields, Matrix, OrientationField, Path, PointSet, Result, ScalarField, Vector,
};
use arabesque_io::{file, geometry::Cloud, mesh::obj, svg};
use arabesque_structures::{Along, Flat, Shell, Solid, Territory, Thread, Tube};
use arabesque_surface::{Bend, DirectionField, Directions, MeshReport};

use crate::{
    method::RunContext,
    plane::{constant_factor, options},
    recipe::{Direction, FieldSource, Format, Input, Size, Structures},
    solid::read::{cloud, indexed_mesh},
};

/// How far a line may lie from its curve, as a share of its extent.
const CHORD: f64 = 1e-4;

/// Lines of a file.
enum Curves {
    Plane(Vec<Path<2>>),
    Space(Vec<Path<3>>),
}

/// The place in the plane that `job` asks for, whose files are embedded.
pub(super) fn in_plane(job: &mut Structures, context: &mut RunContext<'_>) -> Result<Arc<dyn Territory<2>>> {
    let place = job.place()?;
    let turned = degrees(job)?;
    let fields = Fields {
        orientation: (turned != 0.0).then(|| OrientationField::Constant(Matrix::rotation(turned.to_radians()))),
        scale: factor(job)?,
        ..Fields::default()
    };
    let sized = |size: &Size| sides(size).map(|[w, h]| Bounds::new(Vector::ZERO, Vector::xy(w, h)));
    let domain = match (place, &mut *job) {
        ("size", Structures { size: Some(size), .. }) => Domain::Box(sized(size)?),
        ("tile", Structures { tile: Some(size), .. }) => Domain::Torus(sized(size)?),
        ("domain", Structures { domain: Some(input), .. }) => {
            context.files.embed(input)?;
            let text = context.files.text(input)?;
            let (shape, _) = svg::read_shape(&text, input.id.as_deref(), &options(input, context.files))?;
            Domain::Region(Arc::new(shape))
        }
        ("along", Structures { along: Some(input), .. }) => {
            let Curves::Plane(paths) = curves(input, context)? else {
                return Err(elsewhere("along", "curves in space", "points in the plane", "give an SVG file"));
            };
            let threads = threads(&paths, job, turned)?;
            return Ok(Arc::new(Tube::new(threads, job.radius.unwrap_or_default())?));
        }
        (other, _) => return Err(elsewhere(other, "in space", "points in the plane", "give points with a z")),
    };
    Ok(Arc::new(Flat::new(domain, fields)))
}

/// The place in space that `job` asks for, whose files are embedded.
pub(super) fn in_space(
    job: &mut Structures,
    exemplar: &PointSet<3>,
    context: &mut RunContext<'_>,
) -> Result<Arc<dyn Territory<3>>> {
    let place = job.place()?;
    let turned = degrees(job)?;
    let (sin, cos) = turned.to_radians().sin_cos();
    let about_z = Matrix([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]);
    let fields = Fields {
        orientation: (turned != 0.0).then_some(OrientationField::Constant(about_z)),
        scale: factor(job)?,
        ..Fields::default()
    };
    let height = exemplar.bounds();
    let sheet = |size: &Size| {
        let [w, h] = sides(size)?;
        Ok::<_, Error>(Bounds::new(Vector([0.0, 0.0, height.min[2]]), Vector([w, h, height.max[2]])))
    };
    let domain = match (place, &mut *job) {
        ("size", Structures { size: Some(size), .. }) => Domain::Box(sheet(size)?),
        ("tile", Structures { tile: Some(size), .. }) => {
            // A sheet closes up sideways alone: across itself the next one is far away.
            let mut around = sheet(size)?;
            around.max[2] += around.size().norm();
            Domain::Torus(around)
        }
        ("box", Structures { cuboid: Some(cuboid), .. }) => Domain::Box(cuboid.bounds()),
        ("along", Structures { along: Some(input), .. }) => {
            let paths = match curves(input, context)? {
                Curves::Space(paths) => paths,
                Curves::Plane(paths) => paths.iter().map(stood_up).collect(),
            };
            let threads = threads(&paths, job, turned)?;
            let across = height.size().0.into_iter().fold(f64::INFINITY, f64::min);
            return Ok(Arc::new(Tube::new(threads, job.radius.unwrap_or(0.5 * across))?));
        }
        ("on", Structures { on: Some(input), direction, .. }) => {
            let (index, warnings) = indexed_mesh(input, context.files)?;
            context.warnings.extend(warnings);
            let report = MeshReport::new(&index, context.budget())?;
            context.warnings.extend(report.surface_of(input.name())?);
            let field = DirectionField::new(&index, &directions(direction, context)?, context.budget())?;
            context.warnings.extend(field.warnings().iter().cloned());
            return Ok(Arc::new(Shell::new(Arc::new(index), Arc::new(field), fields.scale)));
        }
        ("inside", Structures { inside: Some(input), .. }) => {
            let (index, warnings) = indexed_mesh(input, context.files)?;
            context.warnings.extend(warnings);
            let report = MeshReport::new(&index, context.budget())?;
            context.warnings.extend(report.volume_of(input.name())?);
            return Ok(Arc::new(Solid::new(Arc::new(index), report.volume.abs(), fields)));
        }
        (other, _) => {
            return Err(elsewhere(
                other,
                "in the plane",
                "points in space",
                "give size, tile, box, along, on or inside",
            ));
        }
    };
    Ok(Arc::new(Flat::new(domain, fields)))
}

fn elsewhere(what: &str, place: &str, points: &str, advice: &str) -> Error {
    Error::Unsupported { what: format!("{what}: a place {place} for {points}"), advice: advice.into() }
}

/// Width and height in the units of the exemplar.
fn sides(size: &Size) -> Result<[f64; 2]> {
    match size.unit {
        None => Ok(size.sides),
        Some(_) => Err(Error::parameter("size", size, "plain numbers, because points have no unit of length")),
    }
}

fn degrees(job: &Structures) -> Result<f64> {
    match &job.orient {
        None => Ok(0.0),
        Some(FieldSource::Constant(v)) if v.is_finite() => Ok(*v),
        Some(FieldSource::Constant(v)) => Err(Error::parameter("orient", v, "degrees")),
        Some(FieldSource::File(_)) => {
            let what = "orient from a file, for a structure".into();
            Err(Error::Unsupported { what, advice: "give degrees".into() })
        }
    }
}

fn factor<const D: usize>(job: &Structures) -> Result<ScalarField<D>> {
    constant_factor("scale", job.scale.as_ref())
}

/// Where the pattern runs on a mesh; strokes are embedded.
pub(crate) fn directions(source: &mut Option<Direction>, context: &mut RunContext<'_>) -> Result<Directions> {
    Ok(match source {
        None => Directions::Curvature(Bend::Least),
        Some(Direction::Bend(bend)) => Directions::Curvature(*bend),
        Some(Direction::Towards(way)) => Directions::Constant(Vector(*way)),
        Some(Direction::Strokes(input)) => {
            let strokes = match curves(input, context)? {
                Curves::Space(paths) => paths,
                Curves::Plane(_) => {
                    return Err(elsewhere("direction", "curves in the plane", "a mesh", "give lines of an OBJ file"));
                }
            };
            Directions::Strokes(strokes.iter().map(|path| path.flatten(CHORD * path.bounds().size().norm())).collect())
        }
    })
}

/// The lines of a file, which is embedded.
fn curves(input: &mut Input, context: &mut RunContext<'_>) -> Result<Curves> {
    let bytes = context.files.embed(input)?;
    let (name, budget) = (input.name(), context.files.budget());
    let text = file::decode_text(name, &bytes, budget)?;
    if Format::of_path(name).ok().flatten() == Some(Format::Obj) && !text.trim_start().starts_with('<') {
        let lines = obj::read_lines(name, &text, budget)?;
        return Ok(Curves::Space(lines.into_iter().map(|(_, path)| path).collect()));
    }
    let lines = svg::read_lines(&text, input.id.as_deref(), &options(input, context.files))?;
    context.warnings.extend(lines.warnings);
    Ok(Curves::Plane(lines.paths.into_iter().map(|(_, path)| path).collect()))
}

/// A curve of a drawing, where y points down, in space: as the drawing is seen, at height 0.
fn stood_up(path: &Path<2>) -> Path<3> {
    let up = |p: Vector<2>| Vector([p[0], -p[1], 0.0]);
    Path { cubics: path.cubics.iter().map(|c| c.map(up)).collect(), closed: path.closed }
}

/// The curves as lines with sizes and turns along them.
fn threads<const D: usize>(paths: &[Path<D>], job: &Structures, turned: f64) -> Result<Vec<Thread<D>>> {
    let Some(scale) = job.scale.as_ref().map_or(Some(1.0), |s| match s {
        FieldSource::Constant(v) => Some(*v),
        FieldSource::File(_) => None,
    }) else {
        return Err(Error::Unsupported {
            what: "scale from a file, along curves".into(),
            advice: "give a number".into(),
        });
    };
    let taper = match &job.taper {
        None => vec![(0.0, 1.0)],
        Some(text) => profile("taper", text)?,
    };
    let start = turned.to_radians();
    let end = start + job.twist.unwrap_or_default().to_radians();
    let thread = |path: &Path<D>| {
        let size = path.bounds().size().norm();
        Thread {
            scale: Along(taper.iter().map(|(at, factor)| (*at, factor * scale)).collect()),
            roll: Along(vec![(0.0, start), (1.0, end)]),
            ..Thread::new(path.flatten(CHORD * size))
        }
    };
    Ok(paths.iter().map(thread).collect())
}

/// Factors along a curve: `2`, `1..0.5` from start to end, or `0:1,0.5:2,1:1` at shares of the length.
fn profile(name: &str, text: &str) -> Result<Vec<(f64, f64)>> {
    let fail = || Error::parameter(name, text, "factors above 0, such as 1..0.5 from start to end, or 0:1,0.5:2,1:1");
    let number = |word: &str| word.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    let stops: Option<Vec<(f64, f64)>> = if let Some((from, to)) = text.split_once("..") {
        number(from).zip(number(to)).map(|(a, b)| vec![(0.0, a), (1.0, b)])
    } else if text.contains(':') {
        let pairs = text.split(',').map(|pair| pair.split_once(':').and_then(|(at, v)| number(at).zip(number(v))));
        pairs.collect()
    } else {
        number(text).map(|v| vec![(0.0, v)])
    };
    let stops = stops.ok_or_else(fail)?;
    let is_sound = stops.windows(2).all(|w| w[0].0 < w[1].0)
        && stops.iter().all(|(at, v)| (0.0..=1.0).contains(at) && (1e-3..=1e3).contains(v));
    if is_sound { Ok(stops) } else { Err(fail()) }
}

/// The points of a file that stay where they are; the file is embedded.
pub(super) fn kept<const D: usize>(
    input: &mut Input,
    context: &mut RunContext<'_>,
    of_dimension: impl Fn(Cloud) -> Option<PointSet<D>>,
) -> Result<PointSet<D>> {
    let bytes = context.files.embed(input)?;
    let (points, warnings) = cloud(input.name(), &bytes, context.files)?;
    context.warnings.extend(warnings);
    of_dimension(points).ok_or_else(|| {
        let problem = format!("points of another dimension than those of the exemplar, which have {D} coordinates");
        Error::input(input.name(), problem, "give points that a run on this exemplar made")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_along_a_curve_are_read() {
        assert_eq!(profile("taper", "2").unwrap(), [(0.0, 2.0)]);
        assert_eq!(profile("taper", "1..0.5").unwrap(), [(0.0, 1.0), (1.0, 0.5)]);
        assert_eq!(profile("taper", "0:1,0.5:2,1:1").unwrap().len(), 3);
        for text in ["", "0..1", "1..x", "0.5:1,0.2:1", "0:1,2:1", "nan", "-1"] {
            assert!(profile("taper", text).is_err(), "{text}");
        }
    }
}
