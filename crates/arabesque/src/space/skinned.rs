//! The scene of elements that have bent.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Matrix, Placement, Similarity, TriangleMesh, Vector};
use arabesque_io::mesh::{
    gltf::{Scene, SceneMesh, SceneNode},
    scene::{Attributes, Primitive},
};
use arabesque_surface::Skin;

use super::scene::Bodies;

/// Elements in other places, each that has bent with a mesh of its own.
pub(super) fn skinned(bodies: &Bodies, placements: &[Placement<3>], frame: Option<Bounds<3>>) -> Scene {
    let (exemplar, scene) = (&bodies.exemplar, &bodies.scene);
    let mut skins: BTreeMap<usize, Skin> = BTreeMap::new();
    let (mut nodes, mut meshes) = (Vec::with_capacity(placements.len()), scene.meshes.clone());
    for placement in placements {
        let source = &scene.nodes[placement.source];
        let soft = &exemplar.softs[placement.source];
        let name = exemplar.classes[exemplar.elements[placement.source].class].name.clone();
        let known = Some(placement.source as u64);
        let to: Vec<Vector<3>> = placement.control.iter().map(|(_, to)| *to).collect();
        if to.len() != soft.samples.len() || soft.build == arabesque_core::Build::Rigid {
            let transform = placement.transform.after(&source.transform);
            nodes.push(SceneNode { name, transform, source: known, ..source.clone() });
            continue;
        }
        let shape = &scene.meshes[source.mesh];
        let skin = skins.entry(placement.source).or_insert_with(|| {
            let vertices: Vec<_> = shape.mesh.positions.iter().map(|p| source.transform.apply(*p)).collect();
            Skin::new(soft.build, &soft.samples, &vertices)
        });
        let (places, turned) = skin.moved(&to, placement.transform.scale);
        let middle = soft.middle(&to);
        let turned: Vec<_> = turned.iter().map(|turn| turn.compose(&source.transform.rotation)).collect();
        meshes.push(bent(shape, places.into_iter().map(|p| p - middle).collect(), &turned));
        let transform = Similarity::shift(middle);
        nodes.push(SceneNode { name, mesh: meshes.len() - 1, transform, source: known, ..source.clone() });
    }
    without_unused(Scene { nodes, meshes, frame, ..(**scene).clone() })
}

/// A mesh with its vertices elsewhere, each turned.
fn bent(shape: &SceneMesh, positions: Vec<Vector<3>>, turned: &[Matrix<3>]) -> SceneMesh {
    let own = &shape.mesh;
    let normals = own.normals.as_ref();
    let mesh = TriangleMesh {
        positions,
        normals: normals.map(|list| list.iter().zip(turned).map(|(n, turn)| turn.apply(*n)).collect()),
        ..own.clone()
    };
    let primitives = shape.primitives.iter().map(|p| turned_primitive(p, turned)).collect();
    SceneMesh { primitives, ..SceneMesh::new(shape.name.clone(), mesh) }
}

fn turned_primitive(primitive: &Primitive, turned: &[Matrix<3>]) -> Primitive {
    if primitive.attributes.tangents.is_empty() {
        return primitive.clone();
    }
    let turns = turned.iter().skip(primitive.vertices.start);
    let tangent = |([x, y, z, side], turn): (&[f32; 4], &Matrix<3>)| {
        let v = turn.apply(Vector([f64::from(*x), f64::from(*y), f64::from(*z)]));
        [v[0] as f32, v[1] as f32, v[2] as f32, *side]
    };
    let tangents = primitive.attributes.tangents.iter().zip(turns).map(tangent).collect();
    let attributes = Attributes { tangents, ..(*primitive.attributes).clone() };
    Primitive { attributes: attributes.into(), ..primitive.clone() }
}

/// The same scene without the meshes that no node shows, each whole.
pub(super) fn without_unused(scene: Scene) -> Scene {
    let mut number = vec![None; scene.meshes.len()];
    scene.nodes.iter().for_each(|node| number[node.mesh] = Some(0));
    number.iter_mut().flatten().enumerate().for_each(|(n, entry)| *entry = n);
    // What is put together is written as one mesh, as what bends is.
    let whole = |mesh: SceneMesh| SceneMesh { parts: Vec::new(), ..mesh };
    let kept = scene.meshes.into_iter().zip(&number).filter(|(_, n)| n.is_some()).map(|(mesh, _)| whole(mesh));
    let meshes = kept.collect();
    let nodes = scene.nodes.into_iter().map(|node| SceneNode { mesh: number[node.mesh].unwrap_or(0), ..node });
    let nodes = nodes.collect();
    Scene { meshes, nodes, ..scene }
}
