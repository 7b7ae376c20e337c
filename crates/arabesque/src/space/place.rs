//! Where elements in space go: boxes, solids, layers on meshes.

use std::sync::Arc;

use arabesque_core::{
    Bounds, Budget, Domain, Error, Exemplar, Fields, Grid, Ground, Matrix, OrientationField, Region, Result, Rotations,
    Vector,
};
use arabesque_surface::{Closest, DirectionField, MeshIndex, MeshReport};

use crate::{
    method::RunContext,
    plane::constant_factor,
    recipe::{Direction, FieldSource, Space},
    space::scene::UP,
    structure::{covered, filled},
};

/// A place in space, with its fields.
pub(super) struct Place {
    pub(super) domain: Domain<3>,
    pub(super) fields: Fields<3>,
    /// What those stand on that stand on the floor of the exemplar.
    pub(super) ground: Option<Arc<dyn Ground<3>>>,
    /// The same as a layer on a mesh, where it is one.
    pub(super) shell: Option<Arc<Shell>>,
}

/// The place that `job` asks for, whose files are embedded. `across`: the axis across which the exemplar is a single layer.
pub(super) fn place(
    job: &mut Space,
    (exemplar, floor, across): (&Exemplar<3>, Option<f64>, Option<usize>),
    context: &mut RunContext<'_>,
) -> Result<Place> {
    let place = job.place()?;
    if job.direction.is_some() && place != "on" {
        let what = "direction for a place other than a mesh (--on)".into();
        return Err(Error::Unsupported { what, advice: "leave it out".into() });
    }
    let turned = degrees(job)?;
    let scale = constant_factor("scale", job.scale.as_ref())?;
    let density = constant_factor("density", job.density.as_ref())?;
    let largest = scale.range().1;
    let fields = |orientation| Fields { orientation, scale, density };
    let about_y = about(Vector([0.0, 1.0, 0.0]), turned);
    let constant = (turned != 0.0).then_some(OrientationField::Constant(about_y));
    match &mut *job {
        Space { cuboid: Some(cuboid), .. } => {
            let bounds = cuboid.bounds();
            let ground = floor.map(|_| Arc::new(Floor(bounds.min[UP])) as Arc<dyn Ground<3>>);
            Ok(Place { domain: Domain::Box(bounds), fields: fields(constant), ground, shell: None })
        }
        Space { inside: Some(input), .. } => {
            let (index, report) = filled(input, context)?;
            let bounds = index.bounds();
            let solid = Inside::new(index, &report, context.budget())?;
            let ground = floor.map(|_| Arc::new(Floor(bounds.min[UP])) as Arc<dyn Ground<3>>);
            Ok(Place { domain: Domain::Region(Arc::new(solid)), fields: fields(constant), ground, shell: None })
        }
        Space { on: Some(input), direction, .. } => {
            // A wall stands on the floor, but lies on a mesh: its rows run level.
            let across = across.unwrap_or(UP);
            let is_level = across != UP && direction.is_none();
            let mut level = Some(Direction::Towards([0.0, 1.0, 0.0]));
            let (index, field) = covered(input, if is_level { &mut level } else { direction }, context)?;
            let ends = exemplar.elements.iter().flat_map(|e| e.outline.points()).map(|p| p[across]);
            let under = floor.filter(|_| across == UP).unwrap_or_else(|| ends.fold(f64::INFINITY, f64::min));
            let heights = [exemplar.window.min[across], exemplar.window.max[across]].map(|y| (y - under) * largest);
            let turned = if is_level { turned - 90.0 } else { turned };
            let shell = Arc::new(Shell { index, field, turned: turned.to_radians(), heights, across, under });
            let rotations: Arc<dyn Rotations<3>> = shell.clone();
            let ground: Option<Arc<dyn Ground<3>>> = if across == UP { Some(shell.clone()) } else { None };
            let orientation = Some(OrientationField::Of(rotations));
            let domain = Domain::Region(shell.clone());
            Ok(Place { domain, fields: fields(orientation), ground, shell: Some(shell) })
        }
        Space { .. } => Err(Error::parameter("place", "none", "one of box, inside and on")),
    }
}

fn degrees(job: &Space) -> Result<f64> {
    match &job.orient {
        None => Ok(0.0),
        Some(FieldSource::Constant(v)) if v.is_finite() => Ok(*v),
        Some(FieldSource::Constant(v)) => Err(Error::parameter("orient", v, "degrees")),
        Some(FieldSource::File(_)) => {
            Err(Error::Unsupported { what: "orient from a file, in space".into(), advice: "give degrees".into() })
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

/// A floor at this height.
#[derive(Debug)]
struct Floor(f64);

impl Ground<3> for Floor {
    fn height(&self, p: Vector<3>) -> f64 {
        p[UP] - self.0
    }

    fn at_height(&self, p: Vector<3>, height: f64) -> Vector<3> {
        Vector(std::array::from_fn(|k| if k == UP { self.0 + height } else { p[k] }))
    }
}

/// Nodes of the grid of distances along the longest side of a mesh.
const NODES: f64 = 48.0;
/// Nearer to the surface than so many cells the distance is worked out exactly.
const EXACT: f64 = 1.0;

/// The inside of a closed mesh.
#[derive(Debug)]
struct Inside {
    index: MeshIndex,
    volume: f64,
    /// 1 where normals lead out, -1 where they lead in; `None` where they do not tell.
    sense: Option<f64>,
    /// Distances on a grid, positive inside.
    distances: Grid<3, f64>,
    cell: f64,
}

impl Inside {
    fn new(index: MeshIndex, report: &MeshReport, budget: &Budget) -> Result<Self> {
        let size = index.bounds().size();
        let cell = size.0.into_iter().fold(0.0, f64::max) / NODES;
        let bounds = index.bounds().grown(2.0 * cell);
        let nodes = bounds.size().0.map(|side| (side / cell).ceil() as usize + 1);
        let mut distances = Grid { bounds, nodes, values: vec![0.0; nodes.iter().product()] };
        let places: Vec<_> = (0..distances.values.len()).map(|n| distances.node(n)).collect();
        distances.values = index.signed_distances(&places, budget)?;
        let is_sound = report.is_closed() && report.crossings_counted && !report.crossings.any();
        let sense = is_sound.then_some(if report.is_inverted() { -1.0 } else { 1.0 });
        Ok(Self { index, volume: report.volume.abs(), sense, distances, cell })
    }
}

impl Region<3> for Inside {
    fn bounds(&self) -> Bounds<3> {
        self.index.bounds()
    }

    fn measure(&self) -> f64 {
        self.volume
    }

    fn signed_distance(&self, p: Vector<3>) -> f64 {
        if self.distances.bounds.contains(p) {
            let mut distance = 0.0;
            self.distances.interpolate(p, |weight, value| distance += weight * value);
            if distance.abs() > EXACT * self.cell {
                return distance;
            }
        }
        match self.sense {
            Some(sense) => -sense * self.index.height(&self.index.closest(p), p),
            None => self.index.signed_distance(p),
        }
    }

    fn nearest_boundary(&self, p: Vector<3>) -> Vector<3> {
        self.index.closest(p).point
    }
}

/// A layer on a mesh: what lies between two heights over it.
#[derive(Debug)]
pub(super) struct Shell {
    pub(super) index: MeshIndex,
    field: DirectionField,
    /// Radians by which the pattern is turned about the normal.
    turned: f64,
    heights: [f64; 2],
    /// The axis of the exemplar that runs along the normal, and what lies on the mesh along it.
    across: usize,
    pub(super) under: f64,
}

impl Shell {
    /// The rotation of the exemplar at a point of the mesh.
    pub(super) fn rotation(&self, at: &Closest) -> Matrix<3> {
        let frame = self.field.frame(&self.index, at);
        let (sin, cos) = self.turned.sin_cos();
        let (first, normal) = (frame.tangent * cos + frame.bitangent() * sin, frame.normal);
        let columns = match self.across {
            0 => [normal, normal.cross(first), -first],
            1 => [first, normal, first.cross(normal)],
            _ => [first, normal.cross(first), normal],
        };
        Matrix(std::array::from_fn(|r| columns.map(|c| c[r])))
    }
}

impl Shell {
    /// The height over the mesh, and the distance to where the layer ends sideways, at the edge of an open mesh.
    fn foot(&self, p: Vector<3>) -> (f64, Closest) {
        let foot = self.index.closest(p);
        (self.index.height(&foot, p), foot)
    }
}

impl Region<3> for Shell {
    fn bounds(&self) -> Bounds<3> {
        self.index.bounds().grown(self.heights[0].abs().max(self.heights[1].abs()))
    }

    fn measure(&self) -> f64 {
        self.index.area() * (self.heights[1] - self.heights[0])
    }

    fn signed_distance(&self, p: Vector<3>) -> f64 {
        let (height, foot) = self.foot(p);
        // Beyond the edge of an open mesh the way to the foot leaves the normal.
        let away = p - foot.point;
        let beside = (away.norm2() - height * height).max(0.0).sqrt();
        let within = (height - self.heights[0]).min(self.heights[1] - height);
        if beside > 1e-6 * (1.0 + away.norm()) { within.min(-beside) } else { within }
    }

    fn nearest_boundary(&self, p: Vector<3>) -> Vector<3> {
        let (height, foot) = self.foot(p);
        let [low, high] = self.heights;
        let to = if height - low < high - height { low } else { high };
        foot.point + foot.normal * to
    }
}

impl Ground<3> for Shell {
    fn height(&self, p: Vector<3>) -> f64 {
        Self::foot(self, p).0
    }

    fn at_height(&self, p: Vector<3>, height: f64) -> Vector<3> {
        let foot = self.index.closest(p);
        foot.point + foot.normal * height
    }
}

impl Rotations<3> for Shell {
    fn at(&self, p: Vector<3>) -> Matrix<3> {
        self.rotation(&self.index.closest(p))
    }
}
