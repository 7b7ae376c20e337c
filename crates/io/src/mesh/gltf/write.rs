//! GLB out: points and meshes, each mesh once however many nodes show it.

use arabesque_core::{Bounds, Budget, Decimals, Error, Matrix, PointSet, Result, TriangleMesh};
use serde::Serialize;
use serde_json::{Value, json};

use super::{
    buffer::Buffer,
    colour::linear,
    container::{asset, container},
    scene::{Scene, SceneNode},
};

/// Work and bytes of one vertex and of one triangle.
const PER_VERTEX: u64 = 200;
const VERTEX_BYTES: usize = 80;
const TRIANGLE_BYTES: usize = 24;
/// Work and bytes of one node.
const PER_NODE: u64 = 2000;
const NODE_BYTES: usize = 300;
/// Mode of points in the format.
const POINTS: u32 = 0;
/// Largest whole number up to which floats hold all of them.
const WHOLE: i32 = 1 << 24;

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Document<'a> {
    asset: Value,
    scene: usize,
    scenes: [Value; 1],
    nodes: Vec<Node<'a>>,
    meshes: Vec<Value>,
    materials: [Value; 1],
    accessors: Vec<Value>,
    buffer_views: Vec<Value>,
    buffers: [Value; 1],
}

#[derive(Serialize)]
struct Node<'a> {
    name: &'a str,
    mesh: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    translation: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rotation: Option<[f64; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scale: Option<[f64; 3]>,
}

/// Writes a scene. Coordinates are written as they are: the format has y up.
///
/// # Errors
/// [`Error::Unsupported`] for numbers of groups and elements that floats do not hold, [`Error::Limit`] beyond 4 GiB or when the work or
/// the memory is used up, [`Error::Stopped`] when somebody asked to stop.
pub fn write_scene(scene: &Scene, recipe: Option<&str>, budget: &Budget) -> Result<Vec<u8>> {
    let vertices: usize = scene.meshes.iter().map(|m| m.mesh.positions.len()).sum::<usize>() + scene.points.len();
    let triangles: usize = scene.meshes.iter().map(|m| m.mesh.triangles.len()).sum();
    let bytes = [(vertices, VERTEX_BYTES), (triangles, TRIANGLE_BYTES), (scene.nodes.len(), NODE_BYTES)];
    let _held = budget.hold("the bytes of the scene", bytes.iter().map(|(n, each)| n.saturating_mul(*each)).sum())?;
    let mut buffer = Buffer::default();
    let mut meshes = Vec::new();
    for mesh in &scene.meshes {
        let primitive = triangles_of(&mesh.mesh, &mut buffer, budget)?;
        meshes.push(json!({ "name": mesh.name, "primitives": [primitive] }));
    }
    let mut nodes = Vec::with_capacity(scene.nodes.len() + 1);
    for node in &scene.nodes {
        budget.spend(PER_NODE)?;
        nodes.push(record(node, scene));
    }
    if !scene.points.is_empty() {
        nodes.push(Node { name: "points", mesh: meshes.len(), translation: None, rotation: None, scale: None });
        let primitive = points_of(&scene.points, &mut buffer, budget)?;
        meshes.push(json!({ "name": "points", "primitives": [primitive] }));
    }
    let document = Document {
        asset: asset(recipe),
        scene: 0,
        scenes: [scene_record(nodes.len(), scene.frame)],
        nodes,
        meshes,
        // Without a material things are of metal.
        materials: [json!({
            "name": "plain", "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 0.8 },
        })],
        accessors: buffer.accessors,
        buffer_views: buffer.views,
        buffers: [json!({ "byteLength": buffer.bytes.len() })],
    };
    container(&document, &buffer.bytes, "write PLY instead, or fewer points")
}

fn scene_record(nodes: usize, frame: Option<Bounds<3>>) -> Value {
    let mut record = json!({ "nodes": (0..nodes).collect::<Vec<_>>() });
    if let Some(frame) = frame {
        record["extras"] = json!({ "box": [frame.min.0, frame.max.0] });
    }
    record
}

fn triangles_of(mesh: &TriangleMesh, buffer: &mut Buffer, budget: &Budget) -> Result<Value> {
    budget.spend(PER_VERTEX.saturating_mul((mesh.positions.len() + mesh.triangles.len()) as u64))?;
    let mut attributes = json!({ "POSITION": buffer.vectors(&floats(mesh.positions.iter().map(|p| p.0)), true) });
    if let Some(normals) = &mesh.normals {
        attributes["NORMAL"] = buffer.vectors(&floats(normals.iter().map(|n| n.0)), false).into();
    }
    if let Some(colours) = &mesh.colours {
        attributes["COLOR_0"] = buffer.vectors(&floats(colours.iter().map(|c| c.map(linear))), false).into();
    }
    Ok(json!({ "attributes": attributes, "indices": buffer.indices(&mesh.triangles), "material": 0 }))
}

fn points_of(points: &PointSet<3>, buffer: &mut Buffer, budget: &Budget) -> Result<Value> {
    budget.spend(PER_VERTEX.saturating_mul(points.len() as u64))?;
    let mut attributes = json!({ "POSITION": buffer.vectors(&floats(points.positions.iter().map(|p| p.0)), true) });
    if let Some(normals) = &points.normals {
        attributes["NORMAL"] = buffer.vectors(&floats(normals.iter().map(|n| n.0)), false).into();
    }
    if let Some(colours) = &points.colours {
        attributes["COLOR_0"] = buffer.vectors(&floats(colours.iter().map(|c| c.map(linear))), false).into();
    }
    if let Some(radii) = &points.radii {
        attributes["_RADIUS"] = buffer.scalars(&radii.iter().map(|r| *r as f32).collect::<Vec<_>>()).into();
    }
    for (name, labels) in [("_GROUP", &points.groups), ("_ELEMENT", &points.elements)] {
        let Some(labels) = labels else { continue };
        if let Some(label) = labels.iter().find(|l| l.unsigned_abs() > WHOLE.unsigned_abs()) {
            let what = format!("{name} {label} in a GLB file, which holds floats,");
            return Err(Error::Unsupported { what, advice: "number them up to 16777216, or write PLY".into() });
        }
        attributes[name] = buffer.scalars(&labels.iter().map(|l| *l as f32).collect::<Vec<_>>()).into();
    }
    Ok(json!({ "attributes": attributes, "mode": POINTS, "material": 0 }))
}

fn floats(values: impl Iterator<Item = [f64; 3]>) -> Vec<[f32; 3]> {
    values.map(|v| v.map(|c| c as f32)).collect()
}

/// A node, with nine digits of its place; what changes nothing is left out.
fn record<'a>(node: &'a SceneNode, scene: &Scene) -> Node<'a> {
    let transform = &node.transform;
    let reach = scene.meshes[node.mesh].mesh.bounds().size().0.into_iter().fold(0.0, f64::max);
    let extent = transform.translation.0.iter().fold(reach * transform.scale, |most, c| most.max(c.abs()));
    let (place, share) = (Decimals::for_extent(extent).plus(3), Decimals::for_extent(1.0).plus(3));
    let scale = Decimals::for_extent(transform.scale).plus(3).round(transform.scale);
    let rotation = quaternion(&transform.rotation).map(|v| share.round(v));
    Node {
        name: &node.name,
        mesh: node.mesh,
        translation: Some(transform.translation.0.map(|v| place.round(v))).filter(|t| *t != [0.0; 3]),
        rotation: Some(rotation).filter(|r| *r != [0.0, 0.0, 0.0, 1.0]),
        scale: Some([scale; 3]).filter(|s| *s != [1.0; 3]),
    }
}

/// A rotation as a quaternion x, y, z, w, by its largest part.
fn quaternion(rotation: &Matrix<3>) -> [f64; 4] {
    let m = &rotation.0;
    let squares = [
        1.0 + m[0][0] - m[1][1] - m[2][2],
        1.0 - m[0][0] + m[1][1] - m[2][2],
        1.0 - m[0][0] - m[1][1] + m[2][2],
        1.0 + m[0][0] + m[1][1] + m[2][2],
    ];
    let largest = (0..4).max_by(|a, b| squares[*a].total_cmp(&squares[*b])).unwrap_or(3);
    let twice = squares[largest].max(f64::MIN_POSITIVE).sqrt();
    let products = match largest {
        0 => [squares[0], m[1][0] + m[0][1], m[0][2] + m[2][0], m[2][1] - m[1][2]],
        1 => [m[1][0] + m[0][1], squares[1], m[2][1] + m[1][2], m[0][2] - m[2][0]],
        2 => [m[0][2] + m[2][0], m[2][1] + m[1][2], squares[2], m[1][0] - m[0][1]],
        _ => [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1], squares[3]],
    };
    let sign = if products[3] < 0.0 { -0.5 } else { 0.5 };
    products.map(|v| sign * v / twice)
}
