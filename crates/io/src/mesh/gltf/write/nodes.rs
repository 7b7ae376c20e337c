//! Nodes of a GLB file: one for each place of a mesh, or one for all places of one kind.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Decimals, Error, Result, Similarity};
use serde::Serialize;
use serde_json::{Value, json};

use super::buffer::Buffer;
use crate::mesh::scene::{Scene, SceneNode, quaternion};

/// Work of one node.
const PER_NODE: u64 = 2000;
/// The extension by which one node stands in many places.
pub(super) const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// A node as the document has it.
#[derive(Serialize)]
pub(super) struct Node<'a> {
    #[serde(skip_serializing_if = "str::is_empty")]
    name: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    mesh: Option<usize>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    children: Vec<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    translation: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rotation: Option<[f64; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scale: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    extensions: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    extras: Option<Value>,
}

impl<'a> Node<'a> {
    pub(super) fn new(name: &'a str, mesh: usize) -> Self {
        Self {
            name,
            mesh: Some(mesh),
            children: Vec::new(),
            translation: None,
            rotation: None,
            scale: None,
            extensions: None,
            extras: None,
        }
    }

    pub(super) fn is_instanced(&self) -> bool {
        self.extensions.is_some()
    }
}

/// Numbers of the meshes that nodes show, in order; of what is put together, those of the parts, unless it is written as `one`.
///
/// # Errors
/// [`Error::Input`] for a node or a part whose mesh does not exist.
pub(super) fn shown(scene: &Scene, one: bool) -> Result<Vec<usize>> {
    let mut used = vec![false; scene.meshes.len()];
    let missing = |mesh: usize, what: String| {
        let problem = format!("mesh {mesh} where there are {}", scene.meshes.len());
        Error::input(what, problem, "add the mesh, or remove the node")
    };
    for (number, node) in scene.nodes.iter().enumerate() {
        let Some(shape) = scene.meshes.get(node.mesh) else {
            return Err(missing(node.mesh, format!("node {number} of the scene")));
        };
        if std::mem::replace(&mut used[node.mesh], true) {
            continue;
        }
        if let Some(part) = shape.parts.iter().find(|part| part.mesh >= scene.meshes.len()) {
            return Err(missing(part.mesh, format!("part {} of a mesh", part.name)));
        }
    }
    let is_seen = |n: usize| !scene.meshes[n].mesh.triangles.is_empty();
    let nodes = (0..used.len()).filter(|&n| used[n]);
    let mut numbers: Vec<usize> = nodes
        .flat_map(|n| match scene.meshes[n].parts.as_slice() {
            [] => vec![n],
            _ if one => vec![n],
            parts => parts.iter().map(|part| part.mesh).collect(),
        })
        .filter(|&n| is_seen(n))
        .collect();
    numbers.sort_unstable();
    numbers.dedup();
    Ok(numbers)
}

type Nodes<'a> = Vec<Node<'a>>;

/// What nodes are made of.
pub(super) struct NodesOut<'a, 'b> {
    pub(super) scene: &'a Scene,
    /// Numbers of the meshes that are written, in order.
    pub(super) numbers: &'b [usize],
    pub(super) budget: &'b Budget,
}

impl<'a> NodesOut<'a, '_> {
    /// The nodes whose mesh is written, with its number in the file.
    fn written(&self) -> impl Iterator<Item = (&'a SceneNode, usize)> {
        self.scene.nodes.iter().filter_map(|node| Some((node, self.numbers.binary_search(&node.mesh).ok()?)))
    }

    /// A node for each place, and the nodes below each of them.
    pub(super) fn single(&mut self) -> Result<(Nodes<'a>, Vec<Nodes<'a>>)> {
        let reaches = self.reaches();
        let number = |mesh: usize| self.numbers.binary_search(&mesh).ok();
        let mut whole: BTreeMap<usize, f64> = BTreeMap::new();
        let (mut nodes, mut below) = (Vec::with_capacity(self.scene.nodes.len()), Vec::new());
        for node in &self.scene.nodes {
            let shape = &self.scene.meshes[node.mesh];
            self.budget.spend(PER_NODE.saturating_mul(1 + shape.parts.len() as u64))?;
            if shape.parts.is_empty() {
                nodes.extend(number(node.mesh).map(|mesh| record(node, mesh, reaches[mesh])));
            } else {
                let reach = || shape.mesh.bounds().size().0.into_iter().fold(0.0, f64::max);
                nodes.push(record_above(node, *whole.entry(node.mesh).or_insert_with(reach)));
                let parts = shape.parts.iter().filter_map(|part| Some((part, number(part.mesh)?)));
                let parts = parts.map(|(part, mesh)| record(part, mesh, reaches[mesh])).collect();
                below.resize_with(nodes.len() - 1, Vec::new);
                below.push(parts);
            }
        }
        Ok((nodes, below))
    }

    /// How far each mesh that is written reaches.
    fn reaches(&self) -> Vec<f64> {
        let reach = |&n: &usize| self.scene.meshes[n].mesh.bounds().size().0.into_iter().fold(0.0, f64::max);
        self.numbers.iter().map(reach).collect()
    }

    /// A node for all places that a mesh has in one class.
    pub(super) fn instanced(&mut self, buffer: &mut Buffer) -> Result<Vec<Node<'a>>> {
        let mut groups: BTreeMap<(usize, Option<&str>), Vec<&SceneNode>> = BTreeMap::new();
        for (node, mesh) in self.written() {
            self.budget.spend(PER_NODE)?;
            groups.entry((mesh, node.class.as_deref())).or_default().push(node);
        }
        let reaches = self.reaches();
        let mut nodes = Vec::new();
        for ((mesh, class), members) in groups {
            let [first, _, ..] = members[..] else {
                nodes.extend(members.iter().map(|node| record(node, mesh, reaches[mesh])));
                continue;
            };
            let places: Vec<Similarity<3>> = members.iter().map(|node| node.transform).collect();
            let name = class.unwrap_or(&self.scene.meshes[first.mesh].name);
            let name = if name.is_empty() { &first.name } else { name };
            let attributes = instances(&places, buffer);
            let extensions = Some(json!({ INSTANCING: { "attributes": attributes } }));
            let extras = class.map(|class| json!({ "class": class }));
            nodes.push(Node { extensions, extras, ..Node::new(name, mesh) });
        }
        Ok(nodes)
    }
}

/// Lists of places; what changes nothing in any of them is left out.
fn instances(places: &[Similarity<3>], buffer: &mut Buffer) -> Value {
    let floats = |v: [f64; 3]| v.map(|c| c as f32);
    let translations: Vec<[f32; 3]> = places.iter().map(|p| floats(p.translation.0)).collect();
    let rotations: Vec<[f32; 4]> = places.iter().map(|p| quaternion(&p.rotation).map(|v| v as f32)).collect();
    let scales: Vec<[f32; 3]> = places.iter().map(|p| [p.scale as f32; 3]).collect();
    let mut attributes = json!({ "TRANSLATION": buffer.instances(&translations) });
    if rotations.iter().any(|r| *r != [0.0, 0.0, 0.0, 1.0]) {
        attributes["ROTATION"] = buffer.instances(&rotations).into();
    }
    if scales.iter().any(|s| *s != [1.0; 3]) {
        attributes["SCALE"] = buffer.instances(&scales).into();
    }
    attributes
}

/// The node of an element whose parts hang below it.
fn record_above(node: &SceneNode, reach: f64) -> Node<'_> {
    let mut node = Node { mesh: None, ..record(node, 0, reach) };
    node.extras.get_or_insert_with(|| json!({}))["element"] = true.into();
    node
}

/// Puts the nodes below others behind all of them.
pub(super) fn with_children<'a>(mut nodes: Nodes<'a>, below: Vec<Nodes<'a>>) -> Nodes<'a> {
    for (number, children) in below.into_iter().enumerate() {
        nodes[number].children = (nodes.len()..nodes.len() + children.len()).collect();
        nodes.extend(children);
    }
    nodes
}

/// A node, with nine digits of its place; what changes nothing is left out.
fn record(node: &SceneNode, mesh: usize, reach: f64) -> Node<'_> {
    let transform = &node.transform;
    let extent = transform.translation.0.iter().fold(reach * transform.scale, |most, c| most.max(c.abs()));
    let (place, share) = (Decimals::for_extent(extent).plus(3), Decimals::for_extent(1.0).plus(3));
    let scale = Decimals::for_extent(transform.scale).plus(3).round(transform.scale);
    let rotation = quaternion(&transform.rotation).map(|v| share.round(v));
    let mut extras = json!({});
    if let Some(class) = &node.class {
        extras["class"] = class.as_str().into();
    }
    for (key, number) in [("id", node.id), ("source", node.source)] {
        if let Some(number) = number {
            extras[key] = number.into();
        }
    }
    Node {
        translation: Some(transform.translation.0.map(|v| place.round(v))).filter(|t| *t != [0.0; 3]),
        rotation: Some(rotation).filter(|r| *r != [0.0, 0.0, 0.0, 1.0]),
        scale: Some([scale; 3]).filter(|s| *s != [1.0; 3]),
        extras: extras.as_object().is_some_and(|e| !e.is_empty()).then_some(extras),
        ..Node::new(&node.name, mesh)
    }
}
