//! What a scene holds: points, meshes, and where they stand.

use arabesque_core::{Bounds, PointSet, Similarity, TriangleMesh, Warning};

use super::look::{Looks, Primitive};

/// A mesh that may stand in several places.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneMesh {
    /// What the file calls it.
    pub name: String,
    /// The mesh, in coordinates of its own. Its colours are those of vertices and materials together, without textures.
    pub mesh: TriangleMesh,
    /// How its triangles look, as runs of them with a material each; empty where nothing but the colours of `mesh` is known. Runs that
    /// do not fit the mesh count as none.
    pub primitives: Vec<Primitive>,
    /// Where it is put together from several meshes of the scene: these, in its coordinates. They have no parts themselves, and `mesh` and
    /// `primitives` are all of them together; without parts it is whole.
    pub parts: Vec<SceneNode>,
}

impl SceneMesh {
    /// A mesh that looks as its own colours say.
    pub fn new(name: impl Into<String>, mesh: TriangleMesh) -> Self {
        Self { name: name.into(), mesh, ..Self::default() }
    }
}

/// A place of a mesh: an element.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneNode {
    /// What the file calls it.
    pub name: String,
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// From the coordinates of the mesh to those of the scene.
    pub transform: Similarity<3>,
    /// The class of the element, where the file says it; [`Scene::classes`] finds one for every node.
    pub class: Option<String>,
    /// The number by which the element is known, where it has one.
    pub id: Option<u64>,
    /// The number of the element of the exemplar that it copies, where that is known.
    pub source: Option<u64>,
}

impl Default for SceneNode {
    fn default() -> Self {
        Self::new("", 0, Similarity::identity())
    }
}

impl SceneNode {
    /// A place of a mesh of which nothing else is known.
    pub fn new(name: impl Into<String>, mesh: usize, transform: Similarity<3>) -> Self {
        Self { name: name.into(), mesh, transform, class: None, id: None, source: None }
    }
}

/// Points and meshes in their places. Coordinates are those of the file: where y is up in it, y is up here.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// The points of all nodes, in coordinates of the scene.
    pub points: PointSet<3>,
    /// How many points have a normal without a length.
    pub zero_normals: usize,
    /// Every mesh once. Where a node turns a mesh inside out, or stretches it more along one direction than along another, the mesh
    /// is one of its own, so that nodes need nothing but similarities.
    pub meshes: Vec<SceneMesh>,
    /// Where the meshes stand, in the order of the file.
    pub nodes: Vec<SceneNode>,
    /// Materials, textures and pictures that [`SceneMesh::primitives`] refer to.
    pub looks: Looks,
    /// The part of space that the scene is a piece of: the box that its centres fill, where the file says so.
    pub frame: Option<Bounds<3>>,
    /// Names of classes whose elements bend, where the file says so.
    pub deformable: Vec<String>,
    /// What was left out.
    pub warnings: Vec<Warning>,
}
