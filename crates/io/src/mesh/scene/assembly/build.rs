//! Elements of several meshes, put together.

use std::{collections::BTreeMap, sync::Arc};

use arabesque_core::{Bounds, Budget, Result, Similarity, TriangleMesh};

use super::{
    choose::placed,
    tree::{Candidate, Tree},
};
use crate::mesh::{
    colour::linear,
    scene::{
        classes::stem,
        look::{Attributes, Primitive},
        model::{Scene, SceneMesh, SceneNode},
    },
};

/// Parts are in the same places where they differ by less than this share of an element.
const SAME: f64 = 1e-5;
/// Runs of one shape that are looked at for a mesh that there is already.
const LOOKED: usize = 64;
/// Work of one vertex of a mesh that is put together.
const PER_VERTEX: u64 = 200;

/// A scene where each of these branches, in order and none a part of another, is a node that shows one mesh of several parts.
///
/// # Errors
/// Those of the budget.
pub(super) fn built(
    scene: Scene,
    (tree, chosen, boxes): (&Tree, &[&Candidate], &[Bounds<3>]),
    budget: &Budget,
) -> Result<Scene> {
    let mut known: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
    let names = scene.classes();
    let called = class_names(&names.names, &names.of_node, tree, chosen);
    let mut meshes = scene.meshes.clone();
    let mut nodes = Vec::new();
    let mut next = 0;
    for (candidate, class) in chosen.iter().zip(called) {
        nodes.extend_from_slice(&scene.nodes[next..candidate.nodes.start]);
        next = candidate.nodes.end;
        let branch = &tree.branches[candidate.branch];
        let parts = placed(&scene, candidate);
        let list = known.entry(candidate.meshes.clone()).or_default();
        let found = list.iter().rev().take(LOOKED).find_map(|&mesh| Some((mesh, same(&meshes, mesh, &parts)?)));
        let (mesh, transform) = if let Some(found) = found {
            found
        } else {
            let place = branch.place.unwrap_or(parts[0].1);
            let frame = frame(place, &boxes[candidate.nodes.clone()]);
            let name = if branch.name.trim().is_empty() { class.clone() } else { stem(&branch.name).to_owned() };
            let vertices = |(mesh, _): &(usize, Similarity<3>)| scene.meshes[*mesh].mesh.positions.len();
            let size = parts.iter().map(vertices).sum::<usize>();
            budget.spend(PER_VERTEX.saturating_mul(size as u64))?;
            let back = frame.inverse();
            let part = |node: &SceneNode| SceneNode { transform: back.after(&node.transform), ..node.clone() };
            meshes.push(scene.put_together(&name, scene.nodes[candidate.nodes.clone()].iter().map(part).collect()));
            list.push(meshes.len() - 1);
            (meshes.len() - 1, frame)
        };
        let (id, source) = (branch.id, branch.source);
        nodes.push(SceneNode { name: branch.name.clone(), mesh, transform, class: Some(class), id, source });
    }
    nodes.extend_from_slice(&scene.nodes[next..]);
    Ok(Scene { meshes, nodes, ..scene })
}

/// The class of every element: what the file says, or its name without a number, with the kinds of its parts where elements of one name
/// differ in these; those kinds alone where there is no name.
fn class_names(names: &[String], of_node: &[usize], tree: &Tree, chosen: &[&Candidate]) -> Vec<String> {
    let parts = |candidate: &Candidate| {
        let mut kinds: Vec<&str> = Vec::new();
        for name in of_node[candidate.nodes.clone()].iter().map(|class| names[*class].as_str()) {
            if !kinds.contains(&name) {
                kinds.push(name);
            }
        }
        kinds.join("+")
    };
    let mut parts_of: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let own = |candidate: &Candidate| stem(&tree.branches[candidate.branch].name).to_owned();
    for candidate in chosen {
        let list = parts_of.entry(own(candidate)).or_default();
        let kinds = parts(candidate);
        if !list.contains(&kinds) {
            list.push(kinds);
        }
    }
    let class = |candidate: &&Candidate| {
        let said = tree.branches[candidate.branch].class.as_deref().map(str::trim).filter(|said| !said.is_empty());
        let name = own(candidate);
        match (said, parts_of.get(&name).map_or(0, Vec::len)) {
            (Some(said), _) => said.to_owned(),
            _ if name.is_empty() => parts(candidate),
            (None, 0 | 1) => name,
            _ => format!("{name} of {}", parts(candidate)),
        }
    };
    chosen.iter().map(class).collect()
}

/// Coordinates for an element: those of its branch, unless their origin is far off, as where every place is said by the parts.
fn frame(place: Similarity<3>, boxes: &[Bounds<3>]) -> Similarity<3> {
    let around = boxes.iter().fold(Bounds::EMPTY, |all, own| all.union(own));
    if around.grown(around.size().norm()).contains(place.translation) {
        return place;
    }
    Similarity { translation: around.centre(), ..place }
}

/// Where a mesh of several parts comes to lie so that its parts are these, if that is so.
fn same(meshes: &[SceneMesh], mesh: usize, parts: &[(usize, Similarity<3>)]) -> Option<Similarity<3>> {
    let mut own: Vec<&SceneNode> = meshes[mesh].parts.iter().collect();
    own.sort_by_key(|part| part.mesh);
    let first = own.first()?;
    let transform = parts.first()?.1.after(&first.transform.inverse());
    let size = meshes[mesh].mesh.bounds().size().norm() * transform.scale;
    let is_same = own.iter().zip(parts).all(|(own, (mesh, place))| {
        let there = transform.after(&own.transform);
        let turned = (0..9).map(|n| (there.rotation.0[n / 3][n % 3] - place.rotation.0[n / 3][n % 3]).abs());
        own.mesh == *mesh
            && (there.translation - place.translation).norm() <= SAME * size
            && (there.scale - place.scale).abs() <= SAME * place.scale
            && turned.fold(0.0, f64::max) <= SAME
    });
    is_same.then_some(transform)
}

impl Scene {
    /// Some of its meshes as one of several parts; `parts` tell where they stand in its coordinates.
    pub fn put_together(&self, name: &str, parts: Vec<SceneNode>) -> SceneMesh {
        let shapes: Vec<&SceneMesh> = parts.iter().map(|part| &self.meshes[part.mesh]).collect();
        let is_smooth = shapes.iter().all(|shape| shape.mesh.normals.is_some());
        let is_coloured = shapes.iter().any(|shape| shape.mesh.colours.is_some());
        let has_looks = shapes.iter().any(|shape| !shape.primitives.is_empty());
        let mut whole = SceneMesh::new(name, TriangleMesh::default());
        let mesh = &mut whole.mesh;
        (mesh.normals, mesh.colours) = (is_smooth.then(Vec::new), is_coloured.then(Vec::new));
        for (part, shape) in parts.iter().zip(shapes) {
            let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
            let own = &shape.mesh;
            mesh.positions.extend(own.positions.iter().map(|p| part.transform.apply(*p)));
            mesh.triangles.extend(own.triangles.iter().map(|t| t.map(|v| v + vertices as u32)));
            if let (Some(all), Some(normals)) = (&mut mesh.normals, &own.normals) {
                all.extend(normals.iter().map(|n| part.transform.rotation.apply(*n)));
            }
            if let Some(all) = &mut mesh.colours {
                all.extend(own.colours.iter().flatten());
                all.resize(vertices + own.positions.len(), [1.0; 3]);
            }
            if has_looks {
                let runs = if shape.primitives.is_empty() { vec![plain(own)] } else { shape.primitives.clone() };
                whole.primitives.extend(runs.into_iter().map(|run| moved(run, part, [vertices, triangles])));
            }
        }
        SceneMesh { parts, ..whole }
    }
}

/// A mesh that has nothing but colours as one run of triangles.
fn plain(mesh: &TriangleMesh) -> Primitive {
    let colour = |c: &[f64; 3]| {
        let [r, g, b] = c.map(|share| linear(share) as f32);
        [r, g, b, 1.0]
    };
    let colours = mesh.colours.iter().flatten().map(colour).collect();
    let attributes = Arc::new(Attributes { colours, ..Attributes::default() });
    Primitive { triangles: 0..mesh.triangles.len(), vertices: 0..mesh.positions.len(), material: None, attributes }
}

/// A run of triangles behind others.
fn moved(mut run: Primitive, part: &SceneNode, [vertices, triangles]: [usize; 2]) -> Primitive {
    run.triangles = run.triangles.start + triangles..run.triangles.end + triangles;
    run.vertices = run.vertices.start + vertices..run.vertices.end + vertices;
    if !run.attributes.tangents.is_empty() {
        let mut attributes = (*run.attributes).clone();
        for tangent in &mut attributes.tangents {
            let [x, y, z, side] = *tangent;
            let v = arabesque_core::Vector([x, y, z].map(f64::from));
            let [x, y, z] = part.transform.rotation.apply(v).0.map(|c| c as f32);
            *tangent = [x, y, z, side];
        }
        run.attributes = Arc::new(attributes);
    }
    run
}
