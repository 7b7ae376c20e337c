//! Meshes that are whole scenes: their connected components as elements of their own.

use std::collections::HashMap;

use arabesque_core::{Budget, DisjointSets, Result, Similarity, TriangleMesh, Vector};

use super::{
    congruent::Sharing,
    look::{Attributes, Primitive},
    model::{Scene, SceneMesh, SceneNode},
};

/// Work of one corner.
const PER_CORNER: u64 = 150;
/// Bytes of one vertex and triangle on the way.
const BYTES: usize = 200;

impl Scene {
    /// Number of connected components of the meshes, each mesh once: more than there are meshes where one is a scene in itself. A mesh of
    /// several parts counts as one.
    ///
    /// # Errors
    /// Those of the budget.
    pub fn components(&self, budget: &Budget) -> Result<usize> {
        let count = |mesh: &SceneMesh| {
            if mesh.parts.is_empty() { Ok(components(&mesh.mesh, budget)?.len()) } else { Ok(1) }
        };
        self.meshes.iter().map(count).sum()
    }

    /// The same scene with a node for each connected component, none of them put together from parts. Triangles are connected where their corners are at exactly one place.
    /// Components of one shape, but for where they are, how they are turned and how large, share a mesh; those whose triangles are
    /// joined in the same way, though bent, are of one class, which is called after the node and has a number where there are several.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Limit`] for more components than [`arabesque_core::Limits::nodes`], and those of the budget.
    pub fn split_components(self, budget: &Budget) -> Result<Self> {
        let budget = budget.stage("splitting meshes");
        let vertices: usize = self.meshes.iter().map(|m| m.mesh.positions.len() + m.mesh.triangles.len()).sum();
        let _held = budget.hold("parts of the meshes", vertices.saturating_mul(BYTES))?;
        let mut sharing = Sharing::new(&self.looks, &budget);
        let mut pieces_of: Vec<Vec<Piece>> = Vec::new();
        for mesh in &self.meshes {
            let mut pieces = Vec::new();
            for triangles in components(&mesh.mesh, &budget)? {
                let (centre, part) = centred(part_of(mesh, &triangles));
                let found = sharing.add(part)?;
                pieces.push(Piece {
                    mesh: found.mesh,
                    kind: found.kind,
                    place: Similarity::shift(centre).after(&found.place),
                });
            }
            pieces_of.push(pieces);
        }
        let kinds = sharing.kinds();
        let mut nodes = Vec::new();
        for node in &self.nodes {
            let pieces = pieces_of.get(node.mesh).map(Vec::as_slice).unwrap_or_default();
            let limit = ("nodes", budget.limits().nodes);
            budget.within("components in all places", nodes.len() + pieces.len(), limit)?;
            for piece in pieces {
                budget.spend(PER_CORNER)?;
                let transform = node.transform.after(&piece.place);
                let class = class_of(node, (kinds > 1).then_some(piece.kind));
                nodes.push(SceneNode { mesh: piece.mesh, transform, class, ..node.clone() });
            }
        }
        Ok(Self { meshes: sharing.meshes(), nodes, ..self })
    }
}

impl Scene {
    /// The same scene with one mesh for those of one shape, as [`Scene::split_components`] finds them, none of them split. Meshes whose
    /// vertices are not in the order of their first use are compared as if they were.
    ///
    /// # Errors
    /// Those of the budget.
    pub fn share_shapes(self, budget: &Budget) -> Result<Self> {
        let budget = budget.stage("comparing meshes");
        let mut sharing = Sharing::new(&self.looks, &budget);
        let mut places = vec![(0, Similarity::identity()); self.meshes.len()];
        // What is put together comes after its parts.
        let (whole, together): (Vec<usize>, Vec<usize>) =
            (0..self.meshes.len()).partition(|n| self.meshes[*n].parts.is_empty());
        for number in whole.into_iter().chain(together) {
            let mesh = &self.meshes[number];
            let all: Vec<usize> = (0..mesh.mesh.triangles.len()).collect();
            let (centre, mut part) = centred(part_of(mesh, &all));
            part.parts = mesh.parts.iter().map(|own| in_place(own, &places, centre)).collect();
            let found = sharing.add(part)?;
            places[number] = (found.mesh, Similarity::shift(centre).after(&found.place));
        }
        let nodes = self.nodes.iter().filter_map(|node| {
            let (mesh, place) = places.get(node.mesh)?;
            Some(SceneNode { mesh: *mesh, transform: node.transform.after(place), ..node.clone() })
        });
        Ok(Self { nodes: nodes.collect(), meshes: sharing.meshes(), ..self })
    }
}

/// A component: which mesh it is, of which kind, and where it stands in the mesh that it was a part of.
struct Piece {
    mesh: usize,
    kind: usize,
    place: Similarity<3>,
}

fn class_of(node: &SceneNode, kind: Option<usize>) -> Option<String> {
    let Some(kind) = kind else { return node.class.clone() };
    let base = node.class.as_deref().unwrap_or(&node.name).trim();
    Some(format!("{} shape {}", if base.is_empty() { "part" } else { base }, kind + 1))
}

/// The triangles of every connected component, in the order of their first ones.
fn components(mesh: &TriangleMesh, budget: &Budget) -> Result<Vec<Vec<usize>>> {
    budget.spend(PER_CORNER.saturating_mul((mesh.positions.len() + 3 * mesh.triangles.len()) as u64))?;
    let mut sets = DisjointSets::new(mesh.positions.len());
    let mut first_at: HashMap<[u64; 3], usize> = HashMap::new();
    for (v, position) in mesh.positions.iter().enumerate() {
        // Adding zero makes one of the two zeros.
        sets.join(v, *first_at.entry(position.0.map(|c| (c + 0.0).to_bits())).or_insert(v));
    }
    for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|v| v as usize)) {
        sets.join(a, b);
        sets.join(b, c);
    }
    let mut number_of: HashMap<usize, usize> = HashMap::new();
    let mut found: Vec<Vec<usize>> = Vec::new();
    for (k, corners) in mesh.triangles.iter().enumerate() {
        let number = *number_of.entry(sets.of(corners[0] as usize)).or_insert(found.len());
        if number == found.len() {
            found.push(Vec::new());
        }
        found[number].push(k);
    }
    Ok(found)
}

/// Some triangles of a mesh, in ascending order, with what belongs to them; vertices in the order of their first use.
fn part_of(whole: &SceneMesh, triangles: &[usize]) -> SceneMesh {
    let mesh = &whole.mesh;
    let mut number_of: HashMap<u32, u32> = HashMap::new();
    let mut used: Vec<usize> = Vec::new();
    let mut corners = Vec::with_capacity(triangles.len());
    for &k in triangles {
        corners.push(mesh.triangles[k].map(|v| {
            *number_of.entry(v).or_insert_with(|| {
                used.push(v as usize);
                used.len() as u32 - 1
            })
        }));
    }
    let part = TriangleMesh {
        positions: used.iter().map(|&v| mesh.positions[v]).collect(),
        triangles: corners,
        normals: mesh.normals.as_ref().map(|list| used.iter().map(|&v| list[v]).collect()),
        colours: mesh.colours.as_ref().map(|list| used.iter().map(|&v| list[v]).collect()),
        parts: Vec::new(),
    };
    let primitives = whole.primitives.iter().filter_map(|p| primitive_of(p, triangles, &part, &used)).collect();
    SceneMesh { primitives, ..SceneMesh::new(whole.name.clone(), part) }
}

/// A part of a mesh, in terms of the meshes that are shared and of a mesh around the origin.
fn in_place(part: &SceneNode, places: &[(usize, Similarity<3>)], centre: Vector<3>) -> SceneNode {
    let (mesh, place) = places.get(part.mesh).copied().unwrap_or((part.mesh, Similarity::identity()));
    let transform = Similarity::shift(-centre).after(&part.transform).after(&place);
    SceneNode { mesh, transform, ..part.clone() }
}

/// What a primitive is in a part of its mesh; `None` for one that has no triangle there.
fn primitive_of(whole: &Primitive, triangles: &[usize], part: &TriangleMesh, used: &[usize]) -> Option<Primitive> {
    let run = triangles.partition_point(|k| *k < whole.triangles.start)
        ..triangles.partition_point(|k| *k < whole.triangles.end);
    let corners = || part.triangles[run.clone()].iter().flatten().map(|v| *v as usize);
    let vertices = corners().min()?..corners().max()? + 1;
    let own: Vec<Option<usize>> = used[vertices.clone()]
        .iter()
        .map(|v| v.checked_sub(whole.vertices.start).filter(|_| *v < whole.vertices.end))
        .collect();
    fn selected<T: Copy + Default>(list: &[T], own: &[Option<usize>]) -> Vec<T> {
        if list.is_empty() {
            return Vec::new();
        }
        own.iter().map(|v| v.and_then(|v| list.get(v)).copied().unwrap_or_default()).collect()
    }
    let all = &whole.attributes;
    let attributes = Attributes {
        uv: [selected(&all.uv[0], &own), selected(&all.uv[1], &own)],
        tangents: selected(&all.tangents, &own),
        colours: selected(&all.colours, &own),
    };
    Some(Primitive { triangles: run, vertices, material: whole.material, attributes: attributes.into() })
}

/// A mesh around the origin, and where its middle was.
fn centred(mut mesh: SceneMesh) -> (Vector<3>, SceneMesh) {
    let centre = mesh.mesh.bounds().centre();
    mesh.mesh.positions.iter_mut().for_each(|p| *p -= centre);
    (centre, mesh)
}

#[cfg(test)]
mod tests {
    use arabesque_core::Matrix;

    use super::*;
    use crate::mesh::scene::{Looks, Material};

    /// Tetrahedra in places, as one mesh whose triangles do not share vertices.
    fn heap(corners: [[f64; 3]; 4], places: &[Similarity<3>]) -> TriangleMesh {
        let mut mesh = TriangleMesh::default();
        for place in places {
            for face in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] {
                let first = mesh.positions.len() as u32;
                mesh.positions.extend(face.map(|k: usize| place.apply(Vector(corners[k]))));
                mesh.triangles.push([first, first + 1, first + 2]);
            }
        }
        mesh
    }

    const LONG: [[f64; 3]; 4] = [[3.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.2], [0.0, 0.0, 1.5]];

    fn places() -> Vec<Similarity<3>> {
        let turn = |a: f64| Matrix([[a.cos(), -a.sin(), 0.0], [a.sin(), a.cos(), 0.0], [0.0, 0.0, 1.0]]);
        let place = |k: u32| {
            let k = f64::from(k);
            Similarity { rotation: turn(k), scale: 1.0 + k / 4.0, translation: Vector([10.0 * k, k * k, -k]) }
        };
        (0..4).map(place).collect()
    }

    #[test]
    fn components_of_one_shape_share_a_mesh_and_stay_where_they_were() {
        let mesh = heap(LONG, &places());
        let scene = Scene::of_mesh("heap", &mesh);
        assert_eq!(scene.components(&Budget::default()).unwrap(), 4);
        let split = scene.split_components(&Budget::default()).unwrap();
        assert_eq!((split.meshes.len(), split.nodes.len()), (1, 4));
        for (k, node) in split.nodes.iter().enumerate() {
            for (v, p) in split.meshes[0].mesh.positions.iter().enumerate() {
                let off = (node.transform.apply(*p) - mesh.positions[12 * k + v]).norm();
                assert!(off < 1e-9, "vertex {v} of {k} is off by {off}");
            }
        }
        assert_eq!(split.classes().names, ["heap"]);
    }

    #[test]
    fn other_shapes_mirrors_and_other_materials_are_meshes_of_their_own() {
        let mirror = LONG.map(|[x, y, z]| [x, y, -z]);
        let mut mesh = heap(LONG, &places()[..2]);
        for more in [heap(mirror, &places()[2..3]), heap(LONG.map(|[x, y, z]| [2.0 * x, y, z]), &places()[3..])] {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(more.positions);
            mesh.triangles.extend(more.triangles.iter().map(|t| t.map(|v| v + first)));
        }
        let mut scene = Scene::of_mesh("", &mesh);
        assert_eq!(scene.clone().split_components(&Budget::default()).unwrap().meshes.len(), 3);
        scene.looks = Looks { materials: vec![Material::default(); 2], ..Looks::default() };
        let run = |triangles: std::ops::Range<usize>, material| Primitive {
            vertices: 3 * triangles.start..3 * triangles.end,
            triangles,
            material: Some(material),
            ..Primitive::default()
        };
        scene.meshes[0].primitives = vec![run(0..4, 0), run(4..16, 1)];
        let split = scene.split_components(&Budget::default()).unwrap();
        assert_eq!(split.meshes.len(), 4);
        assert_eq!(split.meshes[1].primitives[0].material, Some(1));
        assert_eq!(split.meshes[1].primitives[0].triangles, 0..4);
    }
}
