//! glTF in, as GLB or as text: the meshes and points of the scene that the file shows first.
//!
//! Read: triangles (also as strips and fans) with `POSITION`, `NORMAL`, `TANGENT`, `TEXCOORD_0`, `TEXCOORD_1` and `COLOR_0`, materials
//! with their textures and pictures; points with `_RADIUS`, `_GROUP` and `_ELEMENT`; quantised and sparse numbers; instances of
//! `EXT_mesh_gpu_instancing`. Colours of materials and vertices are linear in the format, and sRGB in the meshes here.

mod accessor;
mod buffers;
mod document;
mod extras;
mod ignored;
mod materials;
mod nodes;
mod points;
mod primitives;

use std::{collections::BTreeMap, sync::Arc};

use arabesque_core::{Budget, Error, Limits, Matrix, Result, TriangleMesh, Vector, Warning, rounded};

use self::{
    accessor::Binary,
    buffers::{Sources, buffers},
    document::read_document,
    nodes::{Placed, placed},
    points::{append, in_place},
    primitives::Parts,
};
use super::container::{chunks, is_glb};
use crate::{
    file::{Beside, NothingBeside},
    mesh::scene::{Attributes, Primitive, Scene, SceneMesh, SceneNode, Tree},
};

/// Reads a scene that refers to no other file.
///
/// # Errors
/// As [`read_scene_beside`], and [`Error::Input`] for buffers in files beside it; pictures beside it are left out with a warning.
pub fn read_scene(name: &str, bytes: &[u8], budget: &Budget) -> Result<Scene> {
    read_scene_beside(name, bytes, &NothingBeside, budget)
}

/// Reads a scene, with buffers and pictures that lie `beside` it.
///
/// # Errors
/// [`Error::Input`] with the number of the node, mesh or accessor for whatever leads nowhere or holds no numbers within the limits;
/// [`Error::Unsupported`] for compressed meshes; [`Error::Limit`] for too many nodes, vertices or bytes or when the work or the memory is
/// used up.
pub fn read_scene_beside(name: &str, bytes: &[u8], beside: &dyn Beside, budget: &Budget) -> Result<Scene> {
    let budget = budget.stage("reading a glTF file");
    let as_text = !is_glb(bytes)
        && bytes.trim_ascii_start().strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes).trim_ascii_start().starts_with(b"{");
    let (text, chunk) =
        if as_text { (bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes), &[][..]) } else { chunks(name, bytes)? };
    let document = read_document(name, text, &budget)?;
    let mut sources = Sources::new(name, beside, &budget);
    let buffers = buffers(document.buffers.iter().map(|b| b.uri.as_deref()), chunk, &mut sources)?;
    let binary = Binary { name, document: &document, buffers: &buffers, budget: &budget };
    let mut reader = Reader {
        binary,
        meshes: BTreeMap::new(),
        baked: BTreeMap::new(),
        complete: true,
        reshaped: Reshaped::default(),
        scene: Scene::default(),
    };
    let (places, branches) = placed(&binary)?;
    reader.check_size(&places)?;
    let mut tree = Tree { branches, of_node: Vec::new() };
    for place in &places {
        reader.place(place)?;
        tree.of_node.resize(reader.scene.nodes.len(), place.branch);
    }
    reader.warn();
    let flat = reader.reshaped.flat;
    // Meshes of one shape are told apart by their looks.
    let (looks, warnings) = materials::looks(&binary, &mut sources)?;
    reader.scene.looks = looks;
    let mut scene = reader.scene.assembled(&tree, &budget)?;
    let shown = document.scenes.get(document.scene.unwrap_or(0));
    extras::to_scene(shown.and_then(|s| s.extras.as_deref()), budget.limits().coordinate, &mut scene);
    scene.warnings.extend(warnings);
    if scene.nodes.is_empty() && scene.points.is_empty() && flat > 0 {
        let problem = format!("{flat} nodes with meshes, all scaled to nothing in some direction");
        return Err(Error::input(name, problem, "give their scales other values than 0"));
    }
    if scene.nodes.is_empty() && scene.points.is_empty() {
        return Err(Error::input(name, "no mesh and no points in its scene", "give a file with meshes or points"));
    }
    Ok(scene)
}

/// How texts of Unicode may begin.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// How many nodes have transforms that are no similarities.
#[derive(Default)]
struct Reshaped {
    stretched: usize,
    mirrored: usize,
    flat: usize,
}

struct Reader<'a> {
    binary: Binary<'a>,
    /// What is read of the meshes of the file, by number: read once, however many nodes show it.
    meshes: BTreeMap<usize, Parts>,
    /// Numbers of the meshes of the scene, by mesh of the file and the steps of how it was stretched.
    baked: BTreeMap<(usize, Option<[i64; 9]>), usize>,
    /// Whether all points so far have the same attributes.
    complete: bool,
    reshaped: Reshaped,
    scene: Scene,
}

impl Reader<'_> {
    /// Refuses scenes that are too large in all, before anything is put together.
    fn check_size(&mut self, places: &[Placed<'_>]) -> Result<()> {
        let mut totals = [0_usize; 2];
        for place in places {
            let parts = match self.meshes.get(&place.mesh) {
                Some(parts) => parts,
                None => {
                    let parts = Parts::read(&self.binary, place.mesh)?;
                    self.scene.warnings.extend(parts.warnings.iter().cloned());
                    self.meshes.entry(place.mesh).or_insert(parts)
                }
            };
            let more = [parts.mesh.positions.len() + parts.points.len(), parts.mesh.triangles.len()];
            totals = std::array::from_fn(|k| totals[k].saturating_add(more[k]));
        }
        let limit = ("nodes", self.binary.budget.limits().nodes);
        let check = |what: &str, total: usize| {
            self.binary.budget.within(&format!("{}: {what} in all places", self.binary.name), total, limit)
        };
        check("vertices", totals[0])?;
        check("triangles", totals[1])
    }

    fn place(&mut self, placed: &Placed<'_>) -> Result<()> {
        let Some(parts) = self.meshes.get(&placed.mesh) else { return Ok(()) };
        let name = self.binary.name;
        let most = self.binary.budget.limits().coordinate;
        let fits = |p: Vector<3>| p.0.iter().all(|c| c.abs() <= most);
        let positions = parts.mesh.positions.iter().chain(&parts.points.positions);
        if let Some(p) = positions.map(|p| placed.place.apply(*p)).find(|p| !fits(*p)) {
            let place = match placed.name {
                "" => format!("{name}: a node without a name"),
                called => format!("{name}: node {}", crate::text::short::short(called)),
            };
            let [x, y, z] = p.0.map(rounded);
            let problem =
                format!("a vertex at ({x}, {y}, {z}) where coordinates between -{most} and {most} were expected");
            let raising = Limits::raising("coordinate", p.0.iter().fold(0.0, |far: f64, c| far.max(c.abs())));
            let advice = format!("scale the mesh down, move it nearer to the origin{raising}");
            return Err(Error::input(place, problem, advice));
        }
        self.complete &= append(&mut self.scene.points, in_place(&parts.points, &placed.place));
        if parts.mesh.triangles.is_empty() {
            return Ok(());
        }
        if placed.place.is_flat() {
            self.reshaped.flat += 1;
            return Ok(());
        }
        let (transform, stretch) = placed.place.parted();
        if let Some(stretch) = stretch {
            let mirrored = handedness(&stretch) < 0.0;
            *(if mirrored { &mut self.reshaped.mirrored } else { &mut self.reshaped.stretched }) += 1;
        }
        let steps = stretch.map(|m| std::array::from_fn(|k| (m.0[k / 3][k % 3] / STRETCH_STEP).round() as i64));
        let known = self.baked.get(&(placed.mesh, steps)).copied();
        let mesh = known.unwrap_or_else(|| {
            let (mesh, primitives) = match &stretch {
                Some(stretch) => {
                    (baked(&parts.mesh, stretch), parts.looks.iter().map(|p| turned(p, stretch)).collect())
                }
                None => (parts.mesh.clone(), parts.looks.clone()),
            };
            self.scene.meshes.push(SceneMesh { primitives, ..SceneMesh::new(parts.name.clone(), mesh) });
            self.baked.insert((placed.mesh, steps), self.scene.meshes.len() - 1);
            self.scene.meshes.len() - 1
        });
        let mut node = SceneNode::new(placed.name, mesh, transform);
        extras::to_node(self.binary.document.nodes[placed.node].extras.as_deref(), &mut node);
        self.scene.nodes.push(node);
        Ok(())
    }

    fn warn(&mut self) {
        let name = self.binary.name;
        let scene = &mut self.scene;
        let mut warn = |message: String, advice: &str| {
            scene.warnings.push(Warning::new(format!("{name}: {message}"), advice));
        };
        if !self.complete {
            warn("attributes of some points alone are left out".into(), "give all points the same attributes");
        }
        let zero = scene.points.normals.iter().flatten().filter(|n| **n == Vector::ZERO).count();
        scene.zero_normals = zero;
        if zero > 0 {
            warn(format!("{zero} normals of points are zero"), "compute normals where the points come from");
        }
        let Reshaped { stretched, mirrored, flat } = self.reshaped;
        if stretched + mirrored > 0 {
            let parts = [(stretched, "nodes stretch what they show along one direction"), (mirrored, "mirror it")];
            let parts = match parts {
                [(0, _), (n, _)] => format!("{n} nodes mirror what they show"),
                [(n, what), (0, _)] => format!("{n} {what}"),
                [(n, what), (m, other)] => format!("{n} {what}, and {m} {other}"),
            };
            let message = format!("{parts}: each shape that arises is a mesh of its own");
            warn(message, "apply scales before saving, if these are to be copies of one element");
        }
        if flat > 0 {
            let message = format!("{flat} nodes whose transform leaves no volume are left out");
            warn(message, "give them scales other than zero");
        }
        scene.warnings.extend(ignored::warnings(name, self.binary.document));
    }
}

/// What counts as one stretch, but for rounding.
const STRETCH_STEP: f64 = 1e-5;

/// Positive where a transform keeps right hands right hands.
fn handedness(linear: &Matrix<3>) -> f64 {
    let [a, b, c] = linear.0.map(Vector);
    a.cross(b).dot(c)
}

/// The primitive of a mesh that is stretched: its triangles stay in their order, its tangents follow the surface.
fn turned(primitive: &Primitive, stretch: &Matrix<3>) -> Primitive {
    if primitive.attributes.tangents.is_empty() {
        return primitive.clone();
    }
    let side = if handedness(stretch) < 0.0 { -1.0 } else { 1.0 };
    let tangent = |&[x, y, z, w]: &[f32; 4]| {
        let [x, y, z] = stretch.apply(Vector([x, y, z].map(f64::from))).unit_or_zero().0.map(|c| c as f32);
        [x, y, z, w * side]
    };
    let tangents = primitive.attributes.tangents.iter().map(tangent).collect();
    let attributes = Attributes { tangents, ..(*primitive.attributes).clone() };
    Primitive { attributes: Arc::new(attributes), ..primitive.clone() }
}

/// A mesh after the part of a transform that no similarity has: stretched, or turned inside out.
fn baked(mesh: &TriangleMesh, stretch: &Matrix<3>) -> TriangleMesh {
    let inside_out = handedness(stretch) < 0.0;
    let [a, b, c] = stretch.0.map(Vector);
    // Rows of the transposed inverse, but for a factor that does not turn them.
    let sign = if inside_out { -1.0 } else { 1.0 };
    let rows = [b.cross(c), c.cross(a), a.cross(b)].map(|row| row * sign);
    let normal = |n: &Vector<3>| Vector(rows.map(|row| row.dot(*n))).unit_or_zero();
    let turned = |t: &[u32; 3]| if inside_out { [t[0], t[2], t[1]] } else { *t };
    TriangleMesh {
        positions: mesh.positions.iter().map(|p| stretch.apply(*p)).collect(),
        triangles: mesh.triangles.iter().map(turned).collect(),
        normals: mesh.normals.as_ref().map(|normals| normals.iter().map(normal).collect()),
        ..mesh.clone()
    }
}
