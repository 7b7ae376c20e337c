//! GLB out: points and meshes with how they look, each mesh once however many nodes show it.

mod buffer;
mod looks;
mod nodes;
mod primitives;

use arabesque_core::{Budget, Result};
use serde::Serialize;
use serde_json::{Value, json};

pub(super) use self::buffer::Buffer;
use self::{
    looks::LooksOut,
    nodes::{Node, NodesOut},
    primitives::{points_of, primitives_of},
};
use super::container::{asset, container};
use crate::mesh::scene::Scene;

/// Bytes of one vertex, of one triangle and of one node.
const VERTEX_BYTES: usize = 120;
const TRIANGLE_BYTES: usize = 24;
const NODE_BYTES: usize = 300;

/// How a scene is written.
#[derive(Clone, Copy, Debug, Default)]
pub struct GltfOptions<'a> {
    /// A recipe to carry along.
    pub recipe: Option<&'a str>,
    /// Whether a mesh that stands in several places has one node with a list of them (`EXT_mesh_gpu_instancing`) instead of a node for
    /// each: smaller and faster to draw, and refused by programs that do not know the extension.
    pub instancing: bool,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Document<'a> {
    asset: Value,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    extensions_used: Vec<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    extensions_required: Vec<String>,
    scene: usize,
    scenes: [Value; 1],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    nodes: Vec<Node<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    meshes: Vec<Value>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    materials: Vec<Value>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    textures: Vec<Value>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    samplers: Vec<Value>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    images: Vec<Value>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    accessors: Vec<Value>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    buffer_views: Vec<Value>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    buffers: Vec<Value>,
}

/// Writes a scene with a node for each place. Coordinates are written as they are: the format has y up.
///
/// # Errors
/// As [`write_scene_with`].
pub fn write_scene(scene: &Scene, recipe: Option<&str>, budget: &Budget) -> Result<Vec<u8>> {
    write_scene_with(scene, &GltfOptions { recipe, ..GltfOptions::default() }, budget)
}

/// Writes a scene: the meshes that nodes show (what is put together as a node with its parts below it; as one mesh with `instancing`), the materials that these have, and their pictures, each once.
///
/// # Errors
/// [`arabesque_core::Error::Unsupported`] for numbers of groups and elements that floats do not hold, [`arabesque_core::Error::Input`]
/// for nodes whose mesh does not exist, [`arabesque_core::Error::Limit`] beyond 4 GiB or when the work or the memory is used up,
/// [`arabesque_core::Error::Stopped`] when somebody asked to stop.
pub fn write_scene_with(scene: &Scene, options: &GltfOptions<'_>, budget: &Budget) -> Result<Vec<u8>> {
    let _held = budget.hold("the bytes of the scene", size_of_file(scene))?;
    let mut buffer = Buffer::default();
    let mut looks = LooksOut::new(&scene.looks);
    let numbers = nodes::shown(scene, options.instancing)?;
    let mut meshes = Vec::new();
    for mesh in numbers.iter().map(|&n| &scene.meshes[n]) {
        let primitives = primitives_of(mesh, &mut buffer, &mut looks, budget)?;
        meshes.push(json!({ "name": mesh.name, "primitives": primitives }));
    }
    let mut out = NodesOut { scene, numbers: &numbers, budget };
    let (mut nodes, below) = if options.instancing { (out.instanced(&mut buffer)?, Vec::new()) } else { out.single()? };
    if !scene.points.is_empty() {
        nodes.push(Node::new("points", meshes.len()));
        let primitive = points_of(&scene.points, &mut buffer, &mut looks, budget)?;
        meshes.push(json!({ "name": "points", "primitives": [primitive] }));
    }
    let top = nodes.len();
    let nodes = nodes::with_children(nodes, below);
    let looks = looks.finish(&mut buffer);
    let instanced = nodes.iter().any(|node| node.is_instanced()).then(|| nodes::INSTANCING.to_owned());
    let document = Document {
        asset: asset(options.recipe),
        extensions_used: instanced.iter().chain(&looks.extensions).cloned().collect(),
        extensions_required: instanced.iter().chain(&looks.required).cloned().collect(),
        scene: 0,
        scenes: [scene_record(top, scene)],
        nodes,
        meshes,
        materials: looks.materials,
        textures: looks.textures,
        samplers: looks.samplers,
        images: looks.images,
        accessors: buffer.accessors,
        buffer_views: buffer.views,
        buffers: match buffer.bytes.len() {
            0 => Vec::new(),
            length => vec![json!({ "byteLength": length })],
        },
    };
    container(&document, &buffer.bytes, "write PLY instead, or fewer points")
}

fn size_of_file(scene: &Scene) -> usize {
    let vertices: usize = scene.meshes.iter().map(|m| m.mesh.positions.len()).sum::<usize>() + scene.points.len();
    let triangles: usize = scene.meshes.iter().map(|m| m.mesh.triangles.len()).sum();
    let pictures = scene.looks.pictures.iter().map(|p| p.bytes.len()).sum();
    let bytes = [(vertices, VERTEX_BYTES), (triangles, TRIANGLE_BYTES), (scene.nodes.len(), NODE_BYTES), (pictures, 2)];
    bytes.iter().fold(0, |sum, (n, each)| sum.saturating_add(n.saturating_mul(*each)))
}

fn scene_record(nodes: usize, scene: &Scene) -> Value {
    let mut record = json!({});
    // An empty list is not allowed.
    if nodes > 0 {
        record["nodes"] = (0..nodes).collect::<Vec<_>>().into();
    }
    if let Some(frame) = scene.frame.filter(|f| f.min.is_finite() && f.max.is_finite()) {
        record["extras"]["box"] = json!([frame.min.0, frame.max.0]);
    }
    if !scene.deformable.is_empty() {
        record["extras"]["deformable"] = scene.deformable.clone().into();
    }
    record
}
