//! What the solver sees of a mesh.

use arabesque_core::{Budget, Error, Result, TriangleMesh, Vector, Warning};
use rapier3d::{
    math::{Pose, Vector as Vec3},
    parry::{
        mass_properties::MassProperties,
        shape::{Compound, ConvexPolyhedron, SharedShape},
        transformation::vhacd::{VHACD, VHACDParameters},
    },
};

use crate::{
    pieces::{Piece, pieces},
    units::{vec3, vector},
};

/// Share by which ball, box and hull may differ in volume from the mesh that they stand for.
const TOLERANCE: f64 = 0.05;
/// Share of its hull that a convex mesh fills.
const CONVEX: f64 = 1.0 - 2.0 * TOLERANCE;
/// Most corners of a hull; more are as good as invisible and slow.
const MOST_CORNERS: usize = 64;
/// How far corners are drawn in on which a face does not stand, relative to the radius.
const DRAWN_IN: f32 = 0.01;
/// Most hulls for one mesh, and most of its pieces that are looked at by themselves.
const MOST_PARTS: usize = 32;
const MOST_PIECES: usize = 256;
/// A piece that is smaller than this share of what the hull of the mesh holds is no more than a speck.
const SPECK: f64 = 1e-7;
/// Most triangles of a mesh that is cut into hulls.
const MOST_TRIANGLES: usize = 50_000;
/// Work of cutting a mesh into hulls, and of each of its triangles and corners, in units of the budget.
const CUTTING: u64 = 400_000_000;
const PER_TRIANGLE: u64 = 20_000;
const PER_CORNER: u64 = 2_000;

/// What stands for a mesh where it touches others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Collider {
    /// The mesh is round, near enough.
    Ball,
    /// The mesh is a box, near enough.
    Cuboid,
    /// The mesh is convex, near enough.
    Hull,
    /// The mesh is cut into this many convex hulls.
    Hulls(usize),
}

/// A mesh, prepared once for all elements that look like it.
#[derive(Clone)]
pub struct Shape {
    /// In coordinates in which the origin is `centre` and the length is `radius`.
    solid: Solid,
    kind: Collider,
    centre: Vector<3>,
    radius: f64,
    volume: f64,
    inradius: f64,
    warning: Option<Warning>,
}

#[derive(Clone)]
enum Solid {
    Ball(f32),
    Parts(Vec<Part>),
}

#[derive(Clone)]
enum Part {
    Cuboid(Pose, Vec3),
    Hull(ConvexPolyhedron),
}

impl std::fmt::Debug for Shape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Shape({:?}, centre {:?}, radius {})", self.kind, self.centre.0, self.radius)
    }
}

impl Shape {
    /// What stands for `mesh`, which errors call `name`.
    ///
    /// # Errors
    /// [`Error::Input`] where the mesh is broken, has coordinates that are not numbers, or has no volume; when the budget is used up, or
    /// somebody asks to stop.
    pub fn new(mesh: &TriangleMesh, name: &str, budget: &Budget) -> Result<Self> {
        mesh.check(name)?;
        budget.spend(PER_CORNER * mesh.positions.len() as u64)?;
        let fail = |problem: &str| Err(Error::input(name, problem, "give it a thickness in the program it came from"));
        if mesh.triangles.is_empty() || mesh.positions.iter().any(|p| !p.is_finite()) {
            return fail("the mesh has no triangles or coordinates that are not numbers, expected a solid");
        }
        let middle = mesh.bounds().centre();
        let radius = mesh.positions.iter().map(|&p| (p - middle).norm()).fold(0.0, f64::max);
        if !(radius.is_finite() && radius > 0.0) {
            return fail("all corners of the mesh lie at one place, expected a solid");
        }
        let points: Vec<_> = mesh.positions.iter().map(|&p| vec3((p - middle) * (1.0 / radius))).collect();
        let Some(hull) = hull(&points) else { return fail("the mesh is flat, expected a solid with a volume") };
        let properties = MassProperties::from_convex_polyhedron(1.0, hull.points(), &triangles(&hull));
        let (hull_volume, centre) = (f64::from(properties.mass()), properties.local_com);
        if hull_volume < 1e-6 || !centre.is_finite() {
            return fail("the mesh is flat, expected a solid with a volume");
        }
        let points: Vec<_> = points.iter().map(|&p| p - centre).collect();
        let own = mesh_volume(&points, &mesh.triangles).map_or(hull_volume, f64::abs);
        let whole = Piece { points, triangles: mesh.triangles.clone() };
        let mut warning = None;
        let (solid, kind) = solid(whole, (own, hull_volume), &mut warning, (name, budget))?;
        let scale = radius.powi(3);
        let inradius = solid.inradius() * radius;
        Ok(Self {
            solid,
            kind,
            centre: middle + vector(centre) * radius,
            radius,
            volume: own * scale,
            inradius,
            warning,
        })
    }

    /// What stands for the mesh.
    pub fn collider(&self) -> Collider {
        self.kind
    }

    /// What the user should know: that a mesh with hollows is taken for its hull.
    pub fn warning(&self) -> Option<&Warning> {
        self.warning.as_ref()
    }

    /// The middle of its volume, in coordinates of the mesh.
    pub fn centre(&self) -> Vector<3> {
        self.centre
    }

    /// Volume, in cubic units of the mesh.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// Diameter of the ball of its volume: what the lengths of [`crate::PhysicsParams`] are relative to.
    pub fn size(&self) -> f64 {
        (6.0 * self.volume / std::f64::consts::PI).cbrt()
    }

    /// Radius of about the largest ball within it.
    pub fn inradius(&self) -> f64 {
        self.inradius
    }

    /// The collider, `scale` times as large as the mesh.
    pub(crate) fn scaled(&self, scale: f64) -> Option<SharedShape> {
        let s = (scale * self.radius) as f32;
        Some(match &self.solid {
            Solid::Ball(r) => SharedShape::ball(r * s),
            Solid::Parts(parts) => {
                let mut scaled = parts.iter().map(|part| part.scaled(s)).collect::<Option<Vec<_>>>()?;
                match scaled.pop() {
                    Some((pose, only)) if scaled.is_empty() && pose == Pose::IDENTITY => only,
                    last => {
                        scaled.extend(last);
                        SharedShape::new(Compound::new(scaled))
                    }
                }
            }
        })
    }
}

impl Part {
    fn scaled(&self, s: f32) -> Option<(Pose, SharedShape)> {
        Some(match self {
            Self::Cuboid(pose, half) => {
                let pose =
                    if *pose == Pose::IDENTITY { *pose } else { Pose::from_parts(pose.translation * s, pose.rotation) };
                (pose, SharedShape::cuboid(half.x * s, half.y * s, half.z * s))
            }
            Self::Hull(hull) => (Pose::IDENTITY, SharedShape::new(hull.clone().scaled(Vec3::splat(s))?)),
        })
    }

    /// Distance from its middle to its faces.
    fn inradius(&self) -> f64 {
        match self {
            Self::Cuboid(_, half) => f64::from(half.min_element()),
            Self::Hull(hull) => hull_inradius(hull),
        }
    }
}

impl Solid {
    /// That of the part where it is largest.
    fn inradius(&self) -> f64 {
        match self {
            Self::Ball(r) => f64::from(*r),
            Self::Parts(parts) => parts.iter().map(Part::inradius).fold(0.0, f64::max),
        }
    }
}

fn hull_inradius(hull: &ConvexPolyhedron) -> f64 {
    let middle = hull.points().iter().fold(Vec3::ZERO, |sum, &p| sum + p) / hull.points().len().max(1) as f32;
    let depths = hull.faces().iter().map(|face| {
        let corner = hull.points()[hull.vertices_adj_to_face()[face.first_vertex_or_edge as usize] as usize];
        face.normal.dot(corner - middle)
    });
    f64::from(depths.fold(f32::INFINITY, f32::min).max(0.0))
}

/// Whether a mesh of so many triangles may be cut into hulls; with `warning` where not.
///
/// # Errors
/// When somebody asks to stop.
fn may_cut(count: usize, warning: &mut Option<Warning>, (name, budget): (&str, &Budget)) -> Result<bool> {
    let work = CUTTING + PER_TRIANGLE * count as u64;
    let mut refused = |why: String| {
        let message = format!("{name}: physics takes the mesh for its convex hull, hollows filled, for {why}");
        warning.get_or_insert(Warning::new(message, "make it simpler, or cut it into convex elements"));
        Ok(false)
    };
    if count > MOST_TRIANGLES {
        return refused(format!("it has {count} triangles, and at most {MOST_TRIANGLES} are cut into hulls"));
    }
    match budget.foresee(work) {
        Ok(()) => budget.spend(work).map(|()| true),
        Err(Error::Limit { .. }) => refused("no work is left for cutting it into hulls".into()),
        Err(error) => Err(error),
    }
}

/// The simplest solid that is near enough to the mesh, whose volume is `own` and that of its hull `of_hull`.
fn solid(
    whole: Piece,
    (own, of_hull): (f64, f64),
    warning: &mut Option<Warning>,
    (name, budget): (&str, &Budget),
) -> Result<(Solid, Collider)> {
    if own > CONVEX * of_hull {
        let norms = whole.points.iter().map(|p| p.length());
        let (least, most) = norms.fold((f32::INFINITY, 0.0_f32), |(a, b), r| (a.min(r), b.max(r)));
        let round = 4.0 / 3.0 * std::f64::consts::PI * f64::from(most).powi(3);
        if least > 0.97 * most && own > 0.85 * round {
            return Ok((Solid::Ball((own / round).cbrt() as f32 * most), Collider::Ball));
        }
    }
    // What is put together of solid pieces, a shelf of its boards, touches with these, exactly as they are.
    let several = if own > CONVEX * of_hull { Vec::new() } else { pieces(&whole.points, &whole.triangles) };
    let mut parts = Vec::new();
    if (2..=MOST_PIECES).contains(&several.len()) {
        for piece in &several {
            parts.extend(parts_of(piece, None, warning, (name, budget))?);
        }
    } else {
        parts = parts_of(&whole, Some((own, of_hull)), warning, (name, budget))?;
    }
    let kind = match parts.as_slice() {
        [] => {
            return Err(Error::input(
                name,
                "no hull of the mesh could be made",
                "close its surface, or make it simpler",
            ));
        }
        [Part::Cuboid(..)] => Collider::Cuboid,
        [Part::Hull(_)] => Collider::Hull,
        _ => Collider::Hulls(parts.len()),
    };
    Ok((Solid::Parts(parts), kind))
}

/// The convex parts of a piece, whose volume and that of its hull may be known; none for a piece that is flat.
fn parts_of(
    piece: &Piece,
    volumes: Option<(f64, f64)>,
    warning: &mut Option<Warning>,
    (name, budget): (&str, &Budget),
) -> Result<Vec<Part>> {
    budget.spend(PER_CORNER * piece.points.len() as u64)?;
    let Some(around) = hull(&piece.points) else { return Ok(Vec::new()) };
    let (own, of_hull) = volumes.unwrap_or_else(|| {
        let of_hull =
            f64::from(MassProperties::from_convex_polyhedron(1.0, around.points(), &triangles(&around)).mass());
        (mesh_volume(&piece.points, &piece.triangles).map_or(of_hull, f64::abs), of_hull)
    });
    if of_hull < SPECK {
        return Ok(Vec::new());
    }
    if own > CONVEX * of_hull {
        let near = |a: f64, b: f64| (a - b).abs() <= TOLERANCE * b;
        return Ok(match box_around(piece) {
            Some((pose, half)) if near(own, 8.0 * f64::from(half.x * half.y * half.z)) => {
                vec![Part::Cuboid(pose, half)]
            }
            _ => vec![Part::Hull(around)],
        });
    }
    if !may_cut(piece.triangles.len(), warning, (name, budget))? {
        return Ok(vec![Part::Hull(around)]);
    }
    let parameters =
        VHACDParameters { resolution: 48, max_convex_hulls: MOST_PARTS as u32, concavity: 0.02, ..Default::default() };
    let cut = VHACD::decompose(&parameters, &piece.points, &piece.triangles, false).compute_convex_hulls(4);
    let hulls: Vec<_> = cut.iter().filter_map(|(points, _)| hull(points)).take(MOST_PARTS).map(Part::Hull).collect();
    Ok(if hulls.is_empty() { vec![Part::Hull(around)] } else { hulls })
}

/// The hull of points, of at most [`MOST_CORNERS`] corners, standing on four corners of each face; `None` where they lie in a plane.
fn hull(points: &[Vec3]) -> Option<ConvexPolyhedron> {
    let hull = plain_hull(points)?;
    let corners = on_four_corners(&hull);
    if corners == hull.points() {
        return Some(hull);
    }
    let (corners, faces) = rapier3d::parry::transformation::try_convex_hull(&corners).ok()?;
    ConvexPolyhedron::from_convex_mesh(corners, &faces).or(Some(hull))
}

fn plain_hull(points: &[Vec3]) -> Option<ConvexPolyhedron> {
    let (corners, faces) = rapier3d::parry::transformation::try_convex_hull(points).ok()?;
    if corners.len() <= MOST_CORNERS {
        return ConvexPolyhedron::from_convex_mesh(corners, &faces);
    }
    // The farthest corner in each of many directions, spread as the seeds of a sunflower.
    let direction = |k: usize| {
        let (z, turn) = (1.0 - (2.0 * k as f32 + 1.0) / MOST_CORNERS as f32, 2.399_963_2 * k as f32);
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * turn.cos(), r * turn.sin(), z)
    };
    let farthest =
        |d: Vec3| (1..corners.len()).fold(0, |best, k| if corners[k].dot(d) > corners[best].dot(d) { k } else { best });
    let mut kept: Vec<_> = (0..MOST_CORNERS).map(|k| farthest(direction(k))).collect();
    kept.sort_unstable();
    kept.dedup();
    let kept: Vec<_> = kept.into_iter().map(|k| corners[k]).collect();
    let (corners, faces) = rapier3d::parry::transformation::try_convex_hull(&kept).ok()?;
    ConvexPolyhedron::from_convex_mesh(corners, &faces)
}

/// The corners of a hull, those of faces with more than four drawn in a little except for the four that span most: contacts look at four
/// corners of a face, the first ones it has, and a can would stand on a sliver of its bottom.
fn on_four_corners(hull: &ConvexPolyhedron) -> Vec<Vec3> {
    let mut corners = hull.points().to_vec();
    for face in hull.faces() {
        let first = face.first_vertex_or_edge as usize;
        let ring = &hull.vertices_adj_to_face()[first..first + face.num_vertices_or_edges as usize];
        if ring.len() <= 4 {
            continue;
        }
        let n = ring.len();
        let area = |four: [usize; 4]| {
            let [a, b, c, d] = four.map(|k| hull.points()[ring[k] as usize]);
            (c - a).cross(d - b).length()
        };
        let fours = (0..n).flat_map(|k| {
            // About a quarter of the way around from one to the next.
            [0, 1]
                .map(|more| [k, (k + n / 4 + more * usize::from(n % 4 > 1)) % n, (k + n / 2) % n, (k + 3 * n / 4) % n])
        });
        let best = fours.max_by(|a, b| area(*a).total_cmp(&area(*b))).unwrap_or([0, 1, 2, 3]);
        for (k, &corner) in ring.iter().enumerate() {
            if !best.contains(&k) {
                corners[corner as usize] -= face.normal * DRAWN_IN;
            }
        }
    }
    corners
}

/// The faces of a hull, as fans of triangles.
fn triangles(hull: &ConvexPolyhedron) -> Vec<[u32; 3]> {
    let mut all = Vec::new();
    for face in hull.faces() {
        let first = face.first_vertex_or_edge as usize;
        let corners = &hull.vertices_adj_to_face()[first..first + face.num_vertices_or_edges as usize];
        all.extend((1..corners.len().saturating_sub(1)).map(|k| [corners[0], corners[k], corners[k + 1]]));
    }
    all
}

/// Volume of a closed surface, negative where it is inside out; `None` where it is not closed.
pub(crate) fn mesh_volume(points: &[Vec3], triangles: &[[u32; 3]]) -> Option<f64> {
    // Over the surface of a solid the areas sum to nothing, and they do not where something is missing.
    let (mut sum, mut area, mut volume) = (Vector::ZERO, 0.0, 0.0);
    for t in triangles {
        let [a, b, c] = t.map(|k| vector(points[k as usize]));
        let normal = (b - a).cross(c - a);
        sum += normal;
        area += normal.norm();
        volume += a.dot(b.cross(c)) / 6.0;
    }
    (sum.norm() < 1e-3 * area && volume.abs() > 1e-6).then_some(volume)
}

/// The box around the points whose sides lie as the largest faces of the piece do: its pose and half its sides.
fn box_around(Piece { points, triangles }: &Piece) -> Option<(Pose, Vec3)> {
    let normals: Vec<_> =
        triangles.iter().map(|t| t.map(|k| points[k as usize])).map(|[a, b, c]| (b - a).cross(c - a)).collect();
    let largest = |weight: &dyn Fn(Vec3) -> f32| {
        let best = (0..normals.len())
            .fold(0, |best, k| if weight(normals[k]) > 1.001 * weight(normals[best]) { k } else { best });
        normals.get(best).copied()
    };
    let x = largest(&|n| n.length())?.try_normalize()?;
    let across = |n: Vec3| n - x * n.dot(x);
    let y = across(largest(&|n| if n.dot(x).abs() < 0.1 * n.length() { n.length() } else { 0.0 })?).try_normalize()?;
    let axes = [x, y, x.cross(y)];
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for p in points {
        for (k, axis) in axes.iter().enumerate() {
            (low[k], high[k]) = (low[k].min(p.dot(*axis)), high[k].max(p.dot(*axis)));
        }
    }
    let middle = (0..3).fold(Vec3::ZERO, |sum, k| sum + axes[k] * (0.5 * (low[k] + high[k])));
    let rotation = rapier3d::math::Rotation::from_mat3(&rapier3d::math::Matrix::from_cols(axes[0], axes[1], axes[2]));
    let half = Vec3::new(high[0] - low[0], high[1] - low[1], high[2] - low[2]) * 0.5;
    Some((Pose::from_parts(middle, rotation), half))
}

#[cfg(test)]
#[path = "shape_tests.rs"]
mod tests;
