//! GLB in: the meshes and points of the scene that the file shows first.
//!
//! Read: triangles (also as strips and fans) with `POSITION`, `NORMAL` and `COLOR_0`, or the colour of their material; points with the
//! same and with `_RADIUS`, `_GROUP` and `_ELEMENT`; quantised numbers; instances of `EXT_mesh_gpu_instancing`. Colours are linear in
//! the format and sRGB here.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Budget, Error, Result, Similarity, TriangleMesh, Vector, Warning};

use super::{
    accessor::Binary,
    container::chunks,
    document::{Document, read_document},
    nodes::{Affine, Placed, placed},
    points::{append, in_place},
    primitives::Parts,
    scene::{Scene, SceneMesh, SceneNode},
};
/// Reads a scene.
///
/// # Errors
/// [`Error::Input`] with the number of the node, mesh or accessor for whatever leads nowhere or holds no numbers within the limits;
/// [`Error::Unsupported`] for compressed meshes and for data outside of the file; [`Error::Limit`] for too many nodes or vertices or
/// when the work or the memory is used up.
pub fn read_scene(name: &str, bytes: &[u8], budget: &Budget) -> Result<Scene> {
    let budget = budget.stage("reading a GLB file");
    let (text, binary) = chunks(name, bytes)?;
    let document = read_document(name, text, &budget)?;
    let binary = Binary { name, document: &document, bytes: binary, budget: &budget };
    let mut reader =
        Reader { binary, meshes: BTreeMap::new(), baked: BTreeMap::new(), complete: true, scene: Scene::default() };
    let places = placed(&binary)?;
    reader.check_size(&places)?;
    for place in &places {
        reader.place(place)?;
    }
    reader.warn();
    let mut scene = reader.scene;
    scene.frame = frame(&document);
    if scene.nodes.is_empty() && scene.points.is_empty() {
        return Err(Error::input(name, "no mesh and no points in its scene", "give a file with meshes or points"));
    }
    Ok(scene)
}

/// The box that the scene says its centres fill; anything else of that name is somebody else's.
fn frame(document: &Document) -> Option<Bounds<3>> {
    let record = document.scenes.get(document.scene.unwrap_or(0))?;
    let [low, high]: [[f64; 3]; 2] = serde_json::from_value(record.extras.get("box")?.clone()).ok()?;
    let sound = |v: [f64; 3]| v.iter().all(|c| c.is_finite() && c.abs() <= 1e12);
    let is_box = sound(low) && sound(high) && (0..3).all(|k| low[k] < high[k]);
    is_box.then(|| Bounds::new(Vector(low), Vector(high)))
}

struct Reader<'a> {
    binary: Binary<'a>,
    /// What is read of the meshes of the file, by number: read once, however many nodes show it.
    meshes: BTreeMap<usize, Parts>,
    /// Numbers of the meshes of the scene, by mesh of the file and the bits of what was done to it.
    baked: BTreeMap<(usize, Option<[u64; 9]>), usize>,
    /// Whether all points so far have the same attributes.
    complete: bool,
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
            let place = format!("{name}: node {}", crate::text::short::short(placed.name));
            let problem = format!("a vertex at {:?} where coordinates between -{most} and {most} were expected", p.0);
            return Err(Error::input(place, problem, "scale the mesh down, or move it nearer to the origin"));
        }
        self.complete &= append(&mut self.scene.points, in_place(&parts.points, &placed.place));
        if parts.mesh.triangles.is_empty() {
            return Ok(());
        }
        let similarity = placed.place.similarity();
        let bits = similarity.is_none().then(|| {
            let entries: [f64; 9] = std::array::from_fn(|k| placed.place.linear.0[k / 3][k % 3]);
            entries.map(f64::to_bits)
        });
        let known = self.baked.get(&(placed.mesh, bits)).copied();
        let mesh = known.unwrap_or_else(|| {
            let mesh = if similarity.is_none() { baked(&parts.mesh, &placed.place) } else { parts.mesh.clone() };
            self.scene.meshes.push(SceneMesh { name: parts.name.clone(), mesh });
            self.baked.insert((placed.mesh, bits), self.scene.meshes.len() - 1);
            self.scene.meshes.len() - 1
        });
        let transform = similarity.unwrap_or_else(|| Similarity::shift(placed.place.shift));
        self.scene.nodes.push(SceneNode { name: placed.name.to_owned(), mesh, transform });
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
        let document = self.binary.document;
        let skins = document.nodes.iter().filter(|node| node.skin.is_some()).count();
        let shapes = document.meshes.iter().flat_map(|m| &m.primitives).filter(|p| !p.targets.is_empty()).count();
        if skins + shapes > 0 {
            let message = "meshes are read as they rest; skins and shape keys are passed over";
            warn(message.into(), "apply them before the file is saved");
        }
    }
}

/// A mesh after the part of a transform that no similarity has: stretched, or turned inside out.
fn baked(mesh: &TriangleMesh, place: &Affine) -> TriangleMesh {
    let inside_out = place.determinant() < 0.0;
    let [a, b, c] = place.linear.0.map(Vector);
    // Rows of the transposed inverse, but for a factor that does not turn them.
    let sign = if inside_out { -1.0 } else { 1.0 };
    let rows = [b.cross(c), c.cross(a), a.cross(b)].map(|row| row * sign);
    let normal = |n: &Vector<3>| Vector(rows.map(|row| row.dot(*n))).unit_or_zero();
    let turned = |t: &[u32; 3]| if inside_out { [t[0], t[2], t[1]] } else { *t };
    TriangleMesh {
        positions: mesh.positions.iter().map(|p| place.linear.apply(*p)).collect(),
        triangles: mesh.triangles.iter().map(turned).collect(),
        normals: mesh.normals.as_ref().map(|normals| normals.iter().map(normal).collect()),
        ..mesh.clone()
    }
}
