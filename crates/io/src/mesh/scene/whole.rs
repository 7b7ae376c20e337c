//! One mesh as a scene of its parts, and a scene as one mesh.

use arabesque_core::{PointSet, Similarity, TriangleMesh, Vector, Warning};

use super::{
    look::Slot,
    model::{Scene, SceneMesh, SceneNode},
};
use crate::geometry::{Cloud, Geometry, welded};

impl Scene {
    /// Points alone.
    pub fn of_points(points: PointSet<3>) -> Self {
        Self { points, ..Self::default() }
    }

    /// One mesh, a node and a mesh for each of its parts.
    pub fn of_mesh(name: &str, mesh: &TriangleMesh) -> Self {
        let mut scene = Self::default();
        let mut add = |name: &str, mesh: TriangleMesh| {
            scene.nodes.push(SceneNode::new(name, scene.meshes.len(), Similarity::identity()));
            scene.meshes.push(SceneMesh::new(name, mesh));
        };
        if mesh.parts.is_empty() {
            add(name, mesh.clone());
            return scene;
        }
        let mut rest = 0;
        for part in &mesh.parts {
            if rest < part.triangles.start {
                add(name, part_of(mesh, rest..part.triangles.start));
            }
            add(&part.name, part_of(mesh, part.triangles.clone()));
            rest = rest.max(part.triangles.end);
        }
        if rest < mesh.triangles.len() {
            add(name, part_of(mesh, rest..mesh.triangles.len()));
        }
        scene
    }

    /// Where a mesh stands.
    pub fn places(&self, mesh: usize) -> Vec<Similarity<3>> {
        self.nodes.iter().filter(|node| node.mesh == mesh).map(|node| node.transform).collect()
    }

    /// Number of triangles, each mesh as often as it stands somewhere.
    pub fn triangles(&self) -> usize {
        self.nodes.iter().map(|node| self.meshes[node.mesh].mesh.triangles.len()).sum()
    }

    /// Everything in coordinates of the scene: one mesh with a part for each node, whose vertices at exactly one place are one; points
    /// alone where there is no mesh. Beside a mesh points are left out with a warning.
    pub fn into_geometry(self, name: &str) -> Geometry {
        let mut warnings = self.warnings;
        if self.nodes.is_empty() {
            let points = Cloud::Space(self.points);
            return Geometry { zero_normals: self.zero_normals, warnings, ..Geometry::of_points(points) };
        }
        if !self.points.is_empty() {
            let message = format!("{name}: {} points beside meshes are left out", self.points.len());
            warnings.push(Warning::new(message, "give a file of meshes alone, or of points alone"));
        }
        let pictures = self.looks.materials.iter().filter(|m| m.texture(Slot::BaseColour).is_some()).count();
        if pictures > 0 {
            let message = format!("{name}: pictures on {pictures} materials are passed over");
            warnings.push(Warning::new(message, "give vertices colours if they matter"));
        }
        let mut all = TriangleMesh::default();
        let coloured = self.nodes.iter().any(|node| self.meshes[node.mesh].mesh.colours.is_some());
        let smooth = self.nodes.iter().all(|node| self.meshes[node.mesh].mesh.normals.is_some());
        (all.colours, all.normals) = (coloured.then(Vec::new), smooth.then(Vec::new));
        for node in &self.nodes {
            append(&mut all, &self.meshes[node.mesh].mesh, node);
        }
        if all.parts.len() == 1 {
            all.parts.clear();
        }
        let sharp = all.normals.is_some();
        let mesh = welded(all);
        if sharp && mesh.normals.is_none() {
            let message =
                format!("{name}: vertices have a different normal on each side, so that the mesh has none of its own");
            warnings.push(Warning::new(message, "nothing need be done: edges stay as sharp as they are"));
        }
        Geometry { warnings, ..Geometry::from(mesh) }
    }
}

/// Adds a mesh in its place.
fn append(all: &mut TriangleMesh, mesh: &TriangleMesh, node: &SceneNode) {
    let (first, before) = (all.positions.len() as u32, all.triangles.len());
    all.positions.extend(mesh.positions.iter().map(|p| node.transform.apply(*p)));
    all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    let turn = |n: &Vector<3>| node.transform.rotation.apply(*n);
    if let (Some(normals), Some(own)) = (&mut all.normals, &mesh.normals) {
        normals.extend(own.iter().map(turn));
    }
    if let Some(colours) = &mut all.colours {
        match &mesh.colours {
            Some(own) => colours.extend_from_slice(own),
            None => colours.resize(all.positions.len(), [1.0; 3]),
        }
    }
    let triangles = before..all.triangles.len();
    all.parts.push(arabesque_core::MeshPart { name: node.name.clone(), triangles });
}

/// A run of triangles with the vertices that they need, in the order of their first use.
fn part_of(mesh: &TriangleMesh, run: std::ops::Range<usize>) -> TriangleMesh {
    let mut number_of = vec![u32::MAX; mesh.positions.len()];
    let mut used = Vec::new();
    let mut number = |v: u32| {
        let known = &mut number_of[v as usize];
        if *known == u32::MAX {
            *known = used.len() as u32;
            used.push(v as usize);
        }
        *known
    };
    let triangles = mesh.triangles[run].iter().map(|t| t.map(&mut number)).collect();
    TriangleMesh {
        positions: used.iter().map(|&v| mesh.positions[v]).collect(),
        triangles,
        normals: mesh.normals.as_ref().map(|n| used.iter().map(|&v| n[v]).collect()),
        colours: mesh.colours.as_ref().map(|c| used.iter().map(|&v| c[v]).collect()),
        parts: Vec::new(),
    }
}
