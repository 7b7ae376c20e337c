//! What must be true of points and meshes that are read, and of what is written of them.

use arabesque_core::{Budget, MeshPart, PointSet, TriangleMesh, Vector};
use arabesque_io::{
    geometry::{Cloud, Geometry},
    mesh::{
        gltf::{self, Scene},
        obj,
        ply::{self, Encoding, PlyFile},
    },
    table::points,
};

use crate::limits;

/// The recipe that files are written with.
const RECIPE: &str = "seed = 1\nname = \"ümlaut \\\\\"\n";

/// Checks that points and triangles are whole, and that every format gives back as many of them.
pub fn geometry(geometry: &Geometry) {
    match &geometry.points {
        Cloud::Plane(points) => points_of(points, geometry.zero_normals),
        Cloud::Space(points) => points_of(points, geometry.zero_normals),
    }
    assert!(geometry.warnings.iter().all(|w| w.message.len() < 2000), "a warning without end");
    let count = geometry.points.len();
    assert!(geometry.triangles.iter().all(|[a, b, c]| a != b && b != c && c != a));
    assert!(geometry.triangles.iter().flatten().all(|v| (*v as usize) < count));
    let mut before = 0;
    for MeshPart { triangles, .. } in &geometry.parts {
        assert!(before <= triangles.start && triangles.start < triangles.end, "parts overlap, or hold nothing");
        before = triangles.end;
    }
    assert!(before <= geometry.triangles.len());
    if let Ok(mesh) = geometry.clone().into_mesh("fuzz") {
        mesh.check("fuzz").unwrap();
        mesh_of(&mesh);
    }
}

fn points_of<const D: usize>(points: &PointSet<D>, zero_normals: usize) {
    points.check("fuzz").unwrap();
    assert!(!points.is_empty() && points.positions.iter().all(|p| p.is_finite()));
    let normals = points.normals.iter().flatten();
    let zero = normals.filter(|n| {
        let is_zero = **n == Vector::ZERO;
        assert!(is_zero || (n.norm() - 1.0).abs() < 1e-9, "{n:?} has not length 1");
        is_zero
    });
    assert_eq!(zero.count(), zero_normals);
    assert!(points.colours.iter().flatten().flatten().all(|c| (0.0..=1.0).contains(c)));
    assert!(points.radii.iter().flatten().all(|r| *r > 0.0 && r.is_finite()));
    // A file of floats has no radius below the least of them.
    let radii_last = points.radii.iter().flatten().all(|r| *r as f32 > 0.0);
    for encoding in [Encoding::Binary, Encoding::Text] {
        let file = PlyFile::of_points(points).encoded(encoding).with_recipe(Some(RECIPE));
        let Ok(bytes) = ply::write_ply(&file, &Budget::new(limits())) else { return };
        assert_eq!(ply::recipe_of(&bytes).as_deref(), Some(RECIPE));
        if radii_last && let Ok(back) = ply::read_ply("again.ply", &bytes, &Budget::new(limits())) {
            assert_eq!(back.points.len(), points.len());
        }
    }
    let Ok(text) = points::write_table(points, Some(RECIPE), &Budget::new(limits())) else { return };
    assert_eq!(arabesque_io::geometry::recipe_of(text.as_bytes()).as_deref(), Some(RECIPE));
}

fn mesh_of(mesh: &TriangleMesh) {
    let budget = Budget::new(limits());
    if let Ok(text) = obj::write_mesh(mesh, Some(RECIPE), &budget) {
        assert_eq!(obj::recipe_of(&text).as_deref(), Some(RECIPE));
        if let Ok(back) = obj::read_mesh("again.obj", &text, &Budget::new(limits())) {
            assert_eq!((back.points.len(), back.triangles.len()), (mesh.positions.len(), mesh.triangles.len()));
        }
    }
    scene(&Scene::of_mesh("fuzz", mesh));
}

/// Checks that a scene is whole, and that it is read again as it is written.
pub fn scene(scene: &Scene) {
    assert!(scene.nodes.iter().all(|node| node.mesh < scene.meshes.len() && node.transform.scale > 0.0));
    for mesh in &scene.meshes {
        mesh.mesh.check("fuzz").unwrap();
        assert!(mesh.mesh.positions.iter().all(|p| p.is_finite()));
    }
    let Ok(bytes) = gltf::write_scene(scene, Some(RECIPE), &Budget::new(limits())) else { return };
    assert_eq!(gltf::recipe_of(&bytes).as_deref(), Some(RECIPE));
    match gltf::read_scene("again.glb", &bytes, &Budget::new(limits())) {
        Ok(back) => assert_eq!(
            (back.nodes.len(), back.triangles(), back.points.len()),
            (scene.nodes.len(), scene.triangles(), scene.points.len())
        ),
        // What lies beyond floats, and what is over the small limits here.
        Err(error) => assert!(error.to_string().len() < 2000, "{error}"),
    }
}
