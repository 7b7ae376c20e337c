//! Where a structure goes.

use std::sync::Arc;

use arabesque_core::{
    Bounds, Domain, Error, Fields, Matrix, OrientationField, Path, PointSet, Result, Vector, Warning, arc_lengths,
};
use arabesque_io::{file, geometry::Cloud, mesh::obj, svg};
use arabesque_structures::{Along, Flat, Shell, Solid, Territory, Thread, Tube};
use arabesque_surface::{Bend, DirectionField, Directions, MeshIndex, MeshReport};

use crate::{
    method::RunContext,
    plane::options,
    recipe::{Direction, Format, Input, Size, Structures},
    solid::read::indexed_mesh,
    structure::{
        fields::{self, degrees, factor},
        shapes::exemplar,
    },
};

/// How far a line may lie from its curve, as a share of its extent.
const CHORD: f64 = 1e-4;
/// Cosine of the turn from which a structure folds.
const FOLD: f64 = 0.54;

/// Lines of a file.
enum Curves {
    Plane(Vec<Path<2>>),
    Space(Vec<Path<3>>),
}

/// The place in the plane that `job` asks for, whose files are embedded.
pub(super) fn in_plane(job: &mut Structures, context: &mut RunContext<'_>) -> Result<Arc<dyn Territory<2>>> {
    let place = job.place()?;
    suits(job, place, 2)?;
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
            let threads = threads(&paths, job, 0.0)?;
            return Ok(Arc::new(Tube::new(threads, job.radius.unwrap_or_default())?));
        }
        (other, _) => return Err(elsewhere(other, "in space", "points in the plane", "give points with a z")),
    };
    let bounds = domain.bounds();
    let fields = fields::over(&bounds, job, context)?;
    fields::without_avoided(Arc::new(Flat::new(domain, fields)), &bounds, &mut job.avoid, context)
}

/// The place in space that `job` asks for, whose files are embedded.
pub(super) fn in_space(
    job: &mut Structures,
    exemplar: &PointSet<3>,
    context: &mut RunContext<'_>,
) -> Result<Arc<dyn Territory<3>>> {
    let place = job.place()?;
    suits(job, place, 3)?;
    let height = exemplar.bounds();
    let sheet = |size: &Size| {
        let [w, h] = sides(size)?;
        Ok::<_, Error>(Bounds::new(Vector([0.0, 0.0, height.min[2]]), Vector([w, h, height.max[2]])))
    };
    match (place, &mut *job) {
        ("size", Structures { size: Some(size), .. }) => {
            let bounds = sheet(size)?;
            on_sheet(Domain::Box(bounds), job, context)
        }
        ("tile", Structures { tile: Some(size), .. }) => {
            // A sheet closes up sideways alone: across itself the next one is far away.
            let mut around = sheet(size)?;
            around.max[2] += around.size().norm();
            on_sheet(Domain::Torus(around), job, context)
        }
        ("box", Structures { cuboid: Some(cuboid), .. }) => {
            let domain = Domain::Box(cuboid.bounds());
            Ok(Arc::new(Flat::new(domain, even(job, place)?)))
        }
        ("along", Structures { along: Some(input), .. }) => {
            let paths = match curves(input, context)? {
                Curves::Space(paths) => paths,
                Curves::Plane(paths) => paths.iter().map(stood_up).collect(),
            };
            let threads = threads(&paths, job, degrees(job, place)?)?;
            let across = height.size().0.into_iter().fold(f64::INFINITY, f64::min);
            context.warnings.extend(folds(&threads, 0.5 * across));
            Ok(Arc::new(Tube::new(threads, job.radius.unwrap_or(0.5 * across))?))
        }
        ("on", Structures { on: Some(input), direction, .. }) => {
            let (index, field) = covered(input, direction, context)?;
            let shell = Shell::new(Arc::new(index), Arc::new(field), factor(job, place)?);
            Ok(Arc::new(shell.turned(degrees(job, place)?.to_radians())))
        }
        ("inside", Structures { inside: Some(input), .. }) => {
            let (index, report) = filled(input, |_| 0.0, context)?;
            Ok(Arc::new(Solid::new(Arc::new(index), report.volume.abs(), even(job, place)?)))
        }
        (other, _) => {
            Err(elsewhere(other, "in the plane", "points in space", "give size, tile, box, along, on or inside"))
        }
    }
}

/// A mesh to cover, with directions along it; the files are embedded.
pub(crate) fn covered(
    input: &mut Input,
    direction: &mut Option<Direction>,
    context: &mut RunContext<'_>,
) -> Result<(MeshIndex, DirectionField)> {
    let index = surface(input, context)?;
    let field = DirectionField::new(&index, &directions(direction, context)?, context.budget())?;
    context.warnings.extend(field.warnings().iter().cloned());
    Ok((index, field))
}

/// A mesh to cover; the file is embedded.
pub(crate) fn surface(input: &mut Input, context: &mut RunContext<'_>) -> Result<MeshIndex> {
    let (index, warnings) = indexed_mesh(input, context.files)?;
    context.warnings.extend(warnings);
    let report = MeshReport::new(&index, context.budget())?;
    context.warnings.extend(report.surface_of(input.name())?);
    Ok(index)
}

/// Lines in space, as polylines; the file is embedded. `option` is what they are for.
pub(crate) fn lines(option: &str, input: &mut Input, context: &mut RunContext<'_>) -> Result<Vec<Vec<Vector<3>>>> {
    match curves(input, context)? {
        Curves::Space(paths) => {
            Ok(paths.iter().map(|path| path.flatten(CHORD * path.bounds().size().norm())).collect())
        }
        Curves::Plane(_) => Err(elsewhere(option, "in the plane", "elements in space", "give lines of an OBJ file")),
    }
}

/// A closed mesh to fill, with what is known of it; the file is embedded. A mesh that could not answer as many `questions` as are asked of one
/// in such a box is refused before it is looked over.
pub(crate) fn filled(
    input: &mut Input,
    questions: fn(&Bounds<3>) -> f64,
    context: &mut RunContext<'_>,
) -> Result<(MeshIndex, MeshReport)> {
    let (index, warnings) = indexed_mesh(input, context.files)?;
    context.warnings.extend(warnings);
    index.expect(questions(&index.bounds()), context.budget())?;
    let report = MeshReport::new(&index, context.budget())?;
    context.warnings.extend(report.volume_of(input.name())?);
    Ok((index, report))
}

/// A sheet in space: fields and what is avoided lie over it.
fn on_sheet(domain: Domain<3>, job: &mut Structures, context: &RunContext<'_>) -> Result<Arc<dyn Territory<3>>> {
    let around = domain.bounds();
    let flat = |v: Vector<3>| Vector::xy(v[0], v[1]);
    let bounds = Bounds::new(flat(around.min), flat(around.max));
    let fields = fields::raised(fields::over(&bounds, job, context)?);
    fields::without_avoided(Arc::new(Flat::new(domain, fields)), &bounds, &mut job.avoid, context)
}

/// Fields that are the same everywhere; the turn is about z.
fn even(job: &Structures, place: &str) -> Result<Fields<3>> {
    let turned = degrees(job, place)?;
    let (sin, cos) = turned.to_radians().sin_cos();
    let about_z = Matrix([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]);
    let orientation = (turned != 0.0).then_some(OrientationField::Constant(about_z));
    Ok(Fields { orientation, scale: factor(job, place)?, ..Fields::default() })
}

/// Refuses what is given and has no meaning for `place`.
fn suits(job: &Structures, place: &str, dimension: usize) -> Result<()> {
    let is_flat = matches!(place, "size" | "tile" | "domain");
    let along = place == "along";
    let given = [
        ("direction", job.direction.is_some() && place != "on", "a place other than a mesh (--on)"),
        ("taper", job.taper.is_some() && !along, "a place other than curves (--along)"),
        ("twist", job.twist.is_some() && !along, "a place other than curves (--along)"),
        ("tube", job.radius.is_some() && !along, "a place other than curves (--along)"),
        ("twist", job.twist.is_some() && dimension == 2, "curves in the plane, about which nothing turns"),
        ("orient", job.orient.is_some() && along && dimension == 2, "curves in the plane, about which nothing turns"),
        ("avoid", !job.avoid.is_empty() && !is_flat, "a place that is not flat (--size, --tile, --domain)"),
    ];
    match given.into_iter().find(|(_, is_given, _)| *is_given) {
        None => Ok(()),
        Some((name, _, with)) => {
            Err(Error::Unsupported { what: format!("{name} for {with}"), advice: "leave it out".into() })
        }
    }
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
                    let problem = "curves in the plane, where curves on the mesh were expected";
                    return Err(Error::input(input.name(), problem, "give lines of an OBJ file"));
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
    let scale = factor::<D>(job, "along")?.range().0;
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

/// Tells where curves bend more sharply than a structure that reaches so far to their sides, times their scale, can follow.
fn folds(threads: &[Thread<3>], reach: f64) -> Option<Warning> {
    let mut places = threads.iter().flat_map(|thread| {
        let lengths = arc_lengths(&thread.corners);
        let length = lengths.last().copied().unwrap_or(0.0);
        let sharp = move |k: &usize| {
            let far = reach * thread.scale.at(lengths[*k] / length.max(f64::MIN_POSITIVE));
            let at = |s: f64| {
                let after = lengths.partition_point(|&l| l < s).clamp(1, lengths.len() - 1);
                let share = (s - lengths[after - 1]) / (lengths[after] - lengths[after - 1]).max(f64::MIN_POSITIVE);
                thread.corners[after - 1] + (thread.corners[after] - thread.corners[after - 1]) * share.clamp(0.0, 1.0)
            };
            let here = thread.corners[*k];
            let (before, after) = (here - at(lengths[*k] - far), at(lengths[*k] + far) - here);
            // A circle of that radius turns by one radian in that length.
            before.dot(after) < before.norm() * after.norm() * FOLD
        };
        let inner = 1..thread.corners.len().saturating_sub(1);
        inner.filter(sharp).map(|k| thread.corners[k]).collect::<Vec<_>>()
    });
    let first = places.next()?;
    let [x, y, z] = first.0.map(|c| (c * 1e4).round() / 1e4);
    let message = format!("the curve bends so sharply at ({x}, {y}, {z}) that the structure folds there");
    Some(Warning::new(message, "round the curve, or make the structure smaller with --scale"))
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
    let (points, shapes, warnings) = exemplar(input.name(), &bytes, context.files)?;
    if !shapes.is_empty() {
        let what = format!("{}: meshes among the points to keep", input.name());
        return Err(Error::Unsupported { what, advice: "give points alone".into() });
    }
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
    fn a_curve_that_bends_too_sharply_is_told() {
        let bent = |corners: &[[f64; 3]]| vec![Thread::new(corners.iter().map(|c| Vector(*c)).collect())];
        let corner = bent(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
        let told = folds(&corner, 0.1).unwrap().message;
        assert!(told.contains("at (1, 0, 0)"), "{told}");
        let arc = |r: f64| -> Vec<[f64; 3]> {
            (0..60).map(|k| 0.1 * f64::from(k)).map(|a| [r * a.cos(), r * a.sin(), 0.0]).collect()
        };
        assert!(folds(&bent(&arc(0.3)), 0.1).is_none() && folds(&bent(&arc(0.05)), 0.1).is_some());
    }

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
