//! Where elements in space go: boxes, solids, layers on meshes, tubes around curves.

mod fields;
mod floor;
mod inside;
mod masked;
mod tube;

use std::sync::Arc;

use arabesque_core::{
    Border, Domain, Error, Exemplar, Fields, Ground, Matrix, OrientationField, Result, Rotations, ScalarField, Vector,
};
use arabesque_surface::DirectionField;

use crate::{
    method::RunContext,
    recipe::{Direction, FieldSource, Input, Space},
    space::{
        layer::Layer,
        shell::{Lying, Shell},
        suiting::suiting,
    },
    structure::{directions, filled, lines, surface},
};
use floor::Floor;
use inside::Inside;
use masked::Masked;
use tube::Tube;

/// A place in space, with its fields.
pub(super) struct Place {
    pub(super) domain: Domain<3>,
    pub(super) fields: Fields<3>,
    /// What those stand on that stand on the floor of the exemplar.
    pub(super) ground: Option<Arc<dyn Ground<3>>>,
    /// The same as a layer on a mesh, where it is one.
    pub(super) shell: Option<Arc<Shell>>,
}

/// What fills the place.
#[derive(Clone, Copy)]
pub(super) struct Filling<'a> {
    pub(super) exemplar: &'a Exemplar<3>,
    /// Height of its floor, where it has one.
    pub(super) floor: Option<f64>,
    /// The same as a drawing, where it is a single layer.
    pub(super) layer: Option<&'a Layer>,
}

/// The place that `job` asks for, whose files are embedded.
pub(super) fn place(job: &mut Space, filling: Filling<'_>, context: &mut RunContext<'_>) -> Result<Place> {
    suits(job)?;
    let mut place = bare(job, filling, context)?;
    if !job.avoid.is_empty() {
        place.domain = masked(&mut job.avoid, place.domain, context)?;
        place.shell = None;
    }
    let bounds = place.domain.bounds();
    place.fields.scale = fields::scalar("scale", job.scale.as_mut(), &bounds, context)?;
    place.fields.density = fields::scalar("density", job.density.as_mut(), &bounds, context)?;
    Ok(place)
}

/// The place without fields of numbers and without what is avoided.
fn bare(job: &mut Space, filling: Filling<'_>, context: &mut RunContext<'_>) -> Result<Place> {
    let up = job.up.axis();
    let turned = degrees(job)?;
    let floor = |height: f64| filling.floor.map(|_| Arc::new(Floor { axis: up, height }) as Arc<dyn Ground<3>>);
    match &mut *job {
        Space { cuboid: Some(cuboid), .. } => {
            let bounds = cuboid.bounds();
            let fields = turned_fields(job, &bounds, context)?;
            Ok(Place { domain: Domain::Box(bounds), fields, ground: floor(bounds.min[up]), shell: None })
        }
        Space { inside: Some(input), .. } => {
            let (index, report) = filled(input, Inside::questions, context)?;
            let bounds = index.bounds();
            let solid = Inside::new(index, &report, context.budget())?;
            let fields = turned_fields(job, &bounds, context)?;
            Ok(Place { domain: Domain::Region(Arc::new(solid)), fields, ground: floor(bounds.min[up]), shell: None })
        }
        Space { on: Some(_), .. } => on_mesh(job, filling, turned, context),
        Space { along: Some(input), tube, twist, .. } => {
            let lines = lines("along", input, context)?;
            let size = filling.exemplar.window.size();
            let radius = tube.unwrap_or(0.5 * size[1].min(size[2]));
            let tube = Arc::new(Tube::new(lines, radius, [turned, twist.unwrap_or_default()])?);
            let rotations: Arc<dyn Rotations<3>> = tube.clone();
            let fields = Fields { orientation: Some(OrientationField::Of(rotations)), ..Fields::default() };
            Ok(Place { domain: Domain::Region(tube), fields, ground: None, shell: None })
        }
        Space { .. } => Err(Error::parameter("place", "none", "one of box, inside, on and along")),
    }
}

/// Flat elements on a bent mesh may reach out of their layer by this share of its thickness.
const BENT: f64 = 0.3;

/// A layer on a mesh.
fn on_mesh(job: &mut Space, filling: Filling<'_>, turned: f64, context: &mut RunContext<'_>) -> Result<Place> {
    let Filling { exemplar, floor, layer } = filling;
    let up = job.up.axis();
    let border = job.border;
    let Space { on: Some(input), direction, scale, .. } = job else {
        return Err(Error::parameter("place", "none", "a mesh"));
    };
    let scale = match scale {
        Some(FieldSource::Constant(factor)) if *factor > 0.0 => *factor,
        _ => 1.0,
    };
    // A wall stands on the floor, but lies on a mesh: its rows run level.
    let across = layer.map_or(up, |layer| layer.across);
    let ends = exemplar.elements.iter().flat_map(|e| e.outline.points()).map(|p| p[across]);
    let (low, high) = ends.fold((f64::MAX, f64::MIN), |(low, high), h| (low.min(h), high.max(h)));
    let under = floor.filter(|_| across == up).unwrap_or(low);
    let heights = [exemplar.window.min[across], exemplar.window.max[across]].map(|h| (h - under) * scale);
    // Whole elements reach farther than their centres, and on a bent mesh farther than on a flat one.
    let slack = BENT * (high - low);
    let reach = match border {
        Some(Border::Inside) => [(low - under - slack) * scale, (high - under + slack) * scale],
        _ => heights,
    };
    let lying = Lying { turned, heights, reach, across, under };
    let index = Arc::new(surface(input, context)?);
    let shell = match layer.filter(|layer| layer.repeats() && direction.is_none()) {
        Some(layer) => suiting(&index, lying, (layer, up, scale), context.budget())?,
        None if across != up && direction.is_none() => {
            let mut level = Some(Direction::Towards([1, 2, 3].map(|k| if k == up + 1 { 1.0 } else { 0.0 })));
            let field = DirectionField::new(&index, &directions(&mut level, context)?, context.budget())?;
            Shell::new(&index, field, Lying { turned: turned - 90.0, ..lying })
        }
        None => {
            let field = DirectionField::new(&index, &directions(direction, context)?, context.budget())?;
            context.warnings.extend(field.warnings().iter().cloned());
            Shell::new(&index, field, lying)
        }
    };
    let shell = Arc::new(shell.with_distances(context.budget())?);
    let rotations: Arc<dyn Rotations<3>> = shell.clone();
    let ground: Option<Arc<dyn Ground<3>>> = if across == up { Some(shell.clone()) } else { None };
    let fields = Fields { orientation: Some(OrientationField::Of(rotations)), ..Fields::default() };
    Ok(Place { domain: Domain::Region(shell.clone()), fields, ground, shell: Some(shell) })
}

/// The part of a place that lies in none of these meshes.
fn masked(avoid: &mut [Input], domain: Domain<3>, context: &mut RunContext<'_>) -> Result<Domain<3>> {
    let mut masks = Vec::with_capacity(avoid.len());
    for input in avoid {
        let (index, report) = filled(input, Inside::questions, context)?;
        masks.push(Inside::new(index, &report, context.budget())?);
    }
    Ok(Domain::Region(Arc::new(Masked::new(domain, masks, context.budget())?)))
}

/// Refuses what is given and has no meaning for the place.
fn suits(job: &Space) -> Result<()> {
    let place = job.place()?;
    let given = [
        ("direction", job.direction.is_some() && place != "on", "a place other than a mesh (--on)"),
        ("tube", job.tube.is_some() && place != "along", "a place other than curves (--along)"),
        ("twist", job.twist.is_some() && place != "along", "a place other than curves (--along)"),
        ("floor", job.floor && place == "along", "a tube around curves, which has none"),
        ("avoid", !job.avoid.is_empty() && place == "on", "a layer on a mesh"),
    ];
    match given.into_iter().find(|(_, is_given, _)| *is_given) {
        None => Ok(()),
        Some((name, _, with)) => {
            Err(Error::Unsupported { what: format!("{name} for {with}"), advice: "leave it out".into() })
        }
    }
}

/// How the pattern is turned in a box or a solid: about what is up, or along strokes.
fn turned_fields(
    job: &mut Space,
    bounds: &arabesque_core::Bounds<3>,
    context: &mut RunContext<'_>,
) -> Result<Fields<3>> {
    let up = job.up.axis();
    let axis = Vector(std::array::from_fn(|k| if k == up { 1.0 } else { 0.0 }));
    let orientation = match &mut job.orient {
        Some(FieldSource::File(field)) => {
            let strokes = lines("orient", &mut field.file, context)?;
            Some(fields::along_strokes(&strokes, (bounds, axis), context.budget())?)
        }
        _ => {
            let turned = degrees(job)?;
            (turned != 0.0).then(|| OrientationField::Constant(about(axis, turned)))
        }
    };
    Ok(Fields { orientation, scale: ScalarField::Constant(1.0), density: ScalarField::Constant(1.0) })
}

fn degrees(job: &Space) -> Result<f64> {
    match &job.orient {
        None => Ok(0.0),
        Some(FieldSource::Constant(v)) if v.is_finite() => Ok(*v),
        Some(FieldSource::Constant(v)) => Err(Error::parameter("orient", v, "degrees")),
        Some(FieldSource::File(_)) if job.cuboid.is_some() || job.inside.is_some() => Ok(0.0),
        Some(FieldSource::File(_)) => {
            let advice = "give degrees; on a mesh, --direction takes strokes";
            Err(Error::Unsupported {
                what: "orient from a file, on a mesh or along curves".into(),
                advice: advice.into(),
            })
        }
    }
}

/// The rotation by `degrees` about an axis of length 1.
fn about(axis: Vector<3>, degrees: f64) -> Matrix<3> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let turned = |v: Vector<3>| v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos));
    let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|v| turned(Vector(v)));
    Matrix(std::array::from_fn(|r| columns.map(|c| c[r])))
}
