//! Structures with meshes for rigid elements, as files: each mesh once, in all its places.

use arabesque_core::{EnergyPoint, PointSet, Result, StopReason, TriangleMesh, Warning};
use arabesque_io::{
    mesh::gltf::{Scene, SceneNode, write_scene},
    render::Item,
};
use arabesque_structures::StructureOutcome;

use super::shapes::Shapes;
use crate::{
    artwork::{Encoded, Geometry, Made, Sheet, Summary},
    recipe::Format,
    solid::write::{Said, encode_mesh, encode_points, picture},
};

/// Points and meshes in their places.
#[derive(Debug)]
pub(super) struct SceneMade {
    /// What the engine made, with the points that stand for meshes.
    outcome: StructureOutcome<3>,
    /// Points beside the meshes, unless there is a surface of them; meshes; the surface.
    scene: Scene,
}

/// The points of an outcome that stand for no mesh.
pub(super) fn beside(outcome: &StructureOutcome<3>, shapes: &Shapes) -> PointSet<3> {
    let mut stands = vec![false; outcome.points.len()];
    for element in outcome.elements.iter().filter(|e| (e.element as usize) < shapes.nodes.len()) {
        stands[element.points.clone()].fill(true);
    }
    let numbers: Vec<usize> = (0..stands.len()).filter(|&i| !stands[i]).collect();
    let mut points = outcome.points.selected(&numbers);
    points.elements = points.elements.filter(|list| list.iter().any(|&e| e != PointSet::<3>::CONTINUOUS));
    points
}

impl SceneMade {
    /// The meshes of `shapes` where `outcome` has their elements, beside `points`, or beside the surface of them.
    pub(super) fn new(
        outcome: StructureOutcome<3>,
        shapes: &Shapes,
        points: PointSet<3>,
        surface: Option<&TriangleMesh>,
    ) -> Self {
        let looks = shapes.looks.clone();
        let mut scene = Scene { meshes: shapes.meshes.clone(), looks, ..Scene::of_points(points) };
        for element in &outcome.elements {
            let Some(node) = shapes.nodes.get(element.element as usize) else { continue };
            let transform = element.pose.after(&node.transform);
            scene.nodes.push(SceneNode { transform, ..node.clone() });
        }
        if let Some(surface) = surface.filter(|s| !s.triangles.is_empty()) {
            scene.points = PointSet::default();
            let first = scene.meshes.len();
            let made = Scene::of_mesh("surface", surface);
            scene.meshes.extend(made.meshes);
            scene.nodes.extend(made.nodes.into_iter().map(|n| SceneNode { mesh: first + n.mesh, ..n }));
        }
        Self { outcome, scene }
    }

    /// All meshes as one, in the coordinates of the scene.
    fn merged(&self) -> TriangleMesh {
        let scene = Scene { points: PointSet::default(), warnings: Vec::new(), ..self.scene.clone() };
        // Without a node there are points alone, and a mesh without triangles.
        scene.into_geometry("").into_mesh("").unwrap_or_default()
    }

    fn said(&self) -> Said<'_> {
        Said { warnings: &self.outcome.warnings, stopped: self.outcome.stopped }
    }
}

impl Made for SceneMade {
    fn encode(&self, sheet: &Sheet<'_>) -> Result<Encoded> {
        let (points, budget) = (&self.scene.points, sheet.budget);
        match sheet.format {
            Format::Glb => {
                let bytes = write_scene(&self.scene, sheet.recipe, budget)?;
                Ok(Encoded { bytes, warnings: Vec::new(), companion: None })
            }
            Format::Png => {
                let places: Vec<_> = (0..self.scene.meshes.len()).map(|m| self.scene.places(m)).collect();
                let meshes = self.scene.meshes.iter().zip(&places);
                let mut items: Vec<Item<'_>> = meshes
                    .map(
                        |(m, places)| {
                            if m.name == "surface" { Item::Mesh(&m.mesh) } else { Item::Placed(&m.mesh, places) }
                        },
                    )
                    .collect();
                items.extend((!points.is_empty()).then_some(Item::Points(points)));
                picture(&items, sheet)
            }
            Format::Csv => encode_points(&self.outcome.points, Item::Points(&self.outcome.points), sheet, self.said()),
            _ => {
                budget.within("triangles in all places", self.scene.triangles(), ("nodes", budget.limits().nodes))?;
                let mut encoded = encode_mesh(&self.merged(), sheet, self.said())?;
                if !points.is_empty() {
                    let message = format!("{} points beside the meshes are left out", points.len());
                    encoded.warnings.push(Warning::new(message, "write glb, or make their surface with --mesh"));
                }
                Ok(encoded)
            }
        }
    }

    fn summary(&self) -> Summary {
        let energy = self.outcome.energy.last().map(|e| e.energy);
        Summary {
            points: self.scene.points.len(),
            elements: self.outcome.elements.len(),
            triangles: self.scene.triangles(),
            energy,
            ..Summary::default()
        }
    }

    fn geometry(&self) -> Geometry {
        Geometry::Mesh(self.merged())
    }

    fn warnings(&self) -> &[Warning] {
        &self.outcome.warnings
    }

    fn energy(&self) -> &[EnergyPoint] {
        &self.outcome.energy
    }

    fn stopped(&self) -> StopReason {
        self.outcome.stopped
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Budget, Matrix, Similarity, Stage, Stream, Unobserved, Vector};
    use arabesque_io::mesh::gltf::{SceneMesh, read_scene};

    use super::*;
    use crate::{Artwork, Input, OutputOptions, Recipe, Resources, Structures, recipe_in};

    /// A long tetrahedron around the origin.
    fn gem() -> TriangleMesh {
        let corners = [[0.06, 0.0, -0.02], [-0.03, 0.025, -0.02], [-0.03, -0.025, -0.02], [0.0, 0.0, 0.04]];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        TriangleMesh { positions: corners.map(Vector).to_vec(), triangles, ..TriangleMesh::default() }
    }

    /// Gems in a loose grid on the unit square, turned a little, on a sheet of points where `is_set`.
    fn gems(count: usize, is_set: bool) -> Vec<u8> {
        let mut stream = Stream::new(3, Stage::TEST, 0);
        let mut node = |k: usize| {
            let mut near = |n: usize| (n as f64 + 0.5 + stream.range(-0.1, 0.1)) / 6.0;
            let at = Vector([near(k % 6), near(k / 6), 0.02]);
            let turned = stream.range(-0.4, 0.4);
            let (sin, cos) = turned.sin_cos();
            let rotation = Matrix([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]);
            SceneNode::new(format!("gem {k}"), 0, Similarity::about(Vector::ZERO, at, rotation, 1.0))
        };
        let nodes = (0..count).map(&mut node).collect();
        let sheet = (0..400).map(|k| Vector([(f64::from(k % 20) + 0.5) / 20.0, (f64::from(k / 20) + 0.5) / 20.0, 0.0]));
        let positions: Vec<_> = sheet.filter(|_| is_set).collect();
        let normals = is_set.then(|| vec![Vector([0.0, 0.0, 1.0]); positions.len()]);
        let points = PointSet { normals, ..PointSet::at(positions) };
        let scene = Scene { meshes: vec![SceneMesh::new("gem", gem())], nodes, ..Scene::of_points(points) };
        write_scene(&scene, None, &Budget::default()).unwrap()
    }

    fn run(bytes: &[u8], mesh: bool) -> Result<Artwork> {
        let job = Structures { size: Some("1.3x1.2".parse()?), mesh, ..Structures::default() };
        let prepared = Recipe::new(Input::file("gems.glb").embedding(bytes), job).prepare(&Resources::default())?;
        prepared.run(&prepared.request(), &mut Unobserved)
    }

    fn encoded(artwork: &Artwork, format: Format) -> Encoded {
        artwork.encode(&OutputOptions { format: Some(format), ..OutputOptions::default() }).unwrap()
    }

    fn scene(artwork: &Artwork) -> Scene {
        read_scene("out.glb", &encoded(artwork, Format::Glb).bytes, &Budget::default()).unwrap()
    }

    #[test]
    fn nodes_come_back_as_their_mesh_in_many_places() {
        let artwork = run(&gems(36, false), false).unwrap();
        let found = scene(&artwork);
        assert_eq!((found.meshes.len(), found.points.len()), (1, 0));
        let count = found.nodes.len();
        assert!((44..=68).contains(&count), "{count} for about 56");
        let close = |a: &Vector<3>, b: &Vector<3>| (*a - *b).norm() < 1e-6;
        assert!(found.meshes[0].mesh.positions.iter().zip(&gem().positions).all(|(a, b)| close(a, b)));
        // Upright and turned no more than those of the exemplar, so no mirror and no tumbling.
        for node in &found.nodes {
            assert!((node.transform.scale - 1.0).abs() < 1e-6 && node.name.starts_with("gem "));
            assert!(node.transform.rotation.0[2][2] > 0.9 && node.transform.rotation.0[0][0] > 0.5, "{node:?}");
        }
        assert_eq!((artwork.summary().elements, artwork.summary().triangles), (count, 4 * count));
    }

    #[test]
    fn files_without_places_hold_all_of_it_as_one_mesh() {
        let artwork = run(&gems(36, false), false).unwrap();
        let nodes = artwork.summary().elements;
        for format in [Format::Ply, Format::Obj] {
            let Encoded { bytes, warnings, .. } = encoded(&artwork, format);
            let name = format!("out.{}", format.name());
            let mesh = arabesque_io::geometry::read_geometry(&name, &bytes, &Budget::default()).unwrap();
            assert_eq!((mesh.points.len(), mesh.triangles.len()), (4 * nodes, 4 * nodes), "{name}");
            assert!(warnings.is_empty(), "{warnings:?}");
            assert!(matches!(recipe_in(&name, &bytes).unwrap().job, crate::Job::Structures(_)));
        }
        let Geometry::Mesh(mesh) = artwork.geometry() else { panic!("a mesh") };
        assert_eq!(mesh.parts.len(), nodes);
        assert!(encoded(&artwork, Format::Png).bytes.len() > 1000);
    }

    #[test]
    fn points_beside_meshes_stay_points_or_become_a_surface() {
        let bytes = gems(36, true);
        let artwork = run(&bytes, false).unwrap();
        let found = scene(&artwork);
        let (points, nodes) = (found.points.len(), found.nodes.len());
        assert!((500..740).contains(&points) && (40..=70).contains(&nodes), "{points} {nodes}");
        assert!(found.points.normals.is_some() && found.points.elements.is_none());
        let told = encoded(&artwork, Format::Ply).warnings;
        assert!(told[0].message.contains("points beside the meshes are left out"), "{told:?}");
        let surfaced = scene(&run(&bytes, true).unwrap());
        assert_eq!((surfaced.meshes.len(), surfaced.nodes.len(), surfaced.points.len()), (2, nodes + 1, 0));
    }

    #[test]
    fn what_is_too_little_to_repeat_is_told() {
        let told = run(&gems(3, false), false).unwrap_err().to_string();
        assert!(told.contains("0 points and 3 meshes in their places") && told.contains("at least 10"), "{told}");
    }
}
