//! JSON: the elements of a scene as placements, in and out.
//!
//! `{"classes": ["plum"], "placements": [{"class": 0, "translation": [x, y, z], "rotation": [x, y, z, w], "scale": 1}], "box": [[..], [..]]}`.
//! A placement takes the coordinates of the mesh of its class to those of the scene; `mesh` is the number of the mesh where a class has
//! several, `source` the element of the exemplar that is copied, `id` the number of the element, `points` the centre line of one that is
//! bent.

use arabesque_core::{Bounds, Budget, Decimals, Error, Result, Similarity, Vector};
use serde::{Deserialize, Serialize};

use crate::{
    mesh::scene::{Scene, SceneNode, matrix_of, quaternion, stem},
    text::short::short,
};

/// Work and bytes of one placement, and work of a byte that is read.
const PER_PLACEMENT: u64 = 2500;
const PLACEMENT_BYTES: usize = 400;
const PER_BYTE: u64 = 20;
const GROWTH: usize = 6;

/// What is written beside the placements.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlacementsOptions<'a> {
    /// A recipe to carry along.
    pub recipe: Option<&'a str>,
    /// The centre line of each element that is bent, by the number of its node; empty for the others, or altogether.
    pub centre_lines: &'a [Vec<Vector<3>>],
}

#[derive(Serialize)]
struct File<'a> {
    generator: &'static str,
    classes: Vec<String>,
    meshes: Vec<&'a str>,
    placements: Vec<Placement>,
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    frame: Option<[[f64; 3]; 2]>,
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    deformable: &'a [String],
    #[serde(rename = "recipe", skip_serializing_if = "Option::is_none")]
    recipe: Option<&'a str>,
}

#[derive(Serialize)]
struct Placement {
    class: usize,
    mesh: usize,
    translation: [f64; 3],
    rotation: [f64; 4],
    scale: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    source: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    id: Option<u64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    points: Vec<[f64; 3]>,
}

/// Writes the elements of a scene.
///
/// # Errors
/// [`Error::Limit`] when the work or the memory is used up, [`Error::Stopped`] when somebody asked to stop.
pub fn write_placements(scene: &Scene, options: &PlacementsOptions<'_>, budget: &Budget) -> Result<String> {
    let corners: usize = options.centre_lines.iter().map(Vec::len).sum();
    let rows = scene.nodes.len() + corners / 4;
    budget.spend(PER_PLACEMENT.saturating_mul(rows as u64))?;
    let _held = budget.hold("the text of the placements", rows.saturating_mul(PLACEMENT_BYTES))?;
    let classes = scene.classes();
    let most = scene.nodes.iter().flat_map(|n| n.transform.translation.0).fold(0.0_f64, |most, c| most.max(c.abs()));
    let (place, share) = (Decimals::for_extent(most).plus(2), Decimals::for_extent(1.0).plus(2));
    let placement = |(number, node): (usize, &SceneNode)| Placement {
        class: classes.of_node[number],
        mesh: node.mesh,
        translation: node.transform.translation.0.map(|c| place.round(c)),
        rotation: quaternion(&node.transform.rotation).map(|c| share.round(c)),
        scale: Decimals::for_extent(node.transform.scale).plus(2).round(node.transform.scale),
        source: node.source,
        id: node.id,
        points: options.centre_lines.get(number).into_iter().flatten().map(|p| p.0.map(|c| place.round(c))).collect(),
    };
    let file = File {
        generator: "arabesque",
        placements: scene.nodes.iter().enumerate().map(placement).collect(),
        classes: classes.names,
        meshes: scene.meshes.iter().map(|m| m.name.as_str()).collect(),
        frame: scene.frame.map(|f| [f.min.0, f.max.0]),
        deformable: &scene.deformable,
        recipe: options.recipe,
    };
    let text = serde_json::to_string(&file)
        .map_err(|e| Error::input("result", e.to_string(), "report this together with the exemplar"))?;
    // A line for each placement.
    Ok(text.replace("{\"class\":", "\n{\"class\":") + "\n")
}

#[derive(Deserialize)]
struct FileIn {
    #[serde(default)]
    classes: Vec<String>,
    placements: Vec<PlacementIn>,
    #[serde(rename = "box")]
    frame: Option<[[f64; 3]; 2]>,
}

#[derive(Deserialize)]
struct PlacementIn {
    class: ClassIn,
    #[serde(default)]
    mesh: Option<usize>,
    translation: [f64; 3],
    #[serde(default)]
    rotation: Option<[f64; 4]>,
    #[serde(default)]
    scale: Option<f64>,
    #[serde(default)]
    source: Option<u64>,
    #[serde(default)]
    id: Option<u64>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum ClassIn {
    Number(usize),
    Name(String),
}

/// Reads placements of the meshes of another scene, `shapes`: its meshes with other nodes.
///
/// # Errors
/// [`Error::Input`] with the number of the placement: a class that `shapes` does not have, a mesh that does not exist, numbers beyond the
/// limits, a scale of 0 or less; [`Error::Limit`] for too many of them or when the work or the memory is used up.
pub fn read_placements(name: &str, text: &str, shapes: &Scene, budget: &Budget) -> Result<Scene> {
    let budget = budget.stage("reading placements");
    budget.spend(PER_BYTE.saturating_mul(text.len() as u64))?;
    let _held = budget.hold("placements", text.len().saturating_mul(GROWTH))?;
    let file: FileIn = serde_json::from_str(text)
        .map_err(|e| Error::input(name, e.to_string(), "give placements as arabesque writes them"))?;
    budget.within(&format!("{name}: placements"), file.placements.len(), ("nodes", budget.limits().nodes))?;
    let known = shapes.classes();
    let mut meshes = vec![0; known.names.len()];
    for (number, &class) in known.of_node.iter().enumerate().rev() {
        meshes[class] = shapes.nodes[number].mesh;
    }
    let most = budget.limits().coordinate;
    let mut nodes = Vec::with_capacity(file.placements.len());
    for (number, placement) in file.placements.into_iter().enumerate() {
        let fail =
            |problem: String| Err(Error::input(format!("{name}: placement {number}"), problem, "correct or remove it"));
        let class = match &placement.class {
            ClassIn::Name(class) => class.as_str(),
            ClassIn::Number(n) => match file.classes.get(*n) {
                Some(class) => class.as_str(),
                None => return fail(format!("class {n} where there are {}", file.classes.len())),
            },
        };
        let index =
            known.names.iter().position(|n| n == class).or_else(|| known.names.iter().position(|n| n == stem(class)));
        let Some(index) = index else {
            let names = crate::text::short::list(&known.names);
            return fail(format!("class \"{}\", which is none of {names}", short(class)));
        };
        let scale = placement.scale.unwrap_or(1.0);
        let rotation = placement.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
        let fits = placement.translation.iter().all(|c| c.abs() <= most) && rotation.iter().all(|c| c.is_finite());
        if !(fits && scale > 0.0 && scale <= most) {
            return fail("a place that is not finite, or beyond the limits, or a scale of 0 or less".into());
        }
        let mesh = placement.mesh.unwrap_or(meshes[index]);
        if mesh >= shapes.meshes.len() {
            return fail(format!("mesh {mesh} where there are {}", shapes.meshes.len()));
        }
        let transform = Similarity { rotation: matrix_of(rotation), scale, translation: Vector(placement.translation) };
        let class = Some(known.names[index].clone());
        let (id, source) = (placement.id, placement.source);
        nodes.push(SceneNode { class, id, source, ..SceneNode::new(&known.names[index], mesh, transform) });
    }
    let frame =
        file.frame.filter(|[low, high]| (0..3).all(|k| low[k] < high[k] && low[k].abs().max(high[k].abs()) <= most));
    let frame = frame.map(|[low, high]| Bounds::new(Vector(low), Vector(high)));
    Ok(Scene { nodes, frame, points: Default::default(), zero_normals: 0, warnings: Vec::new(), ..shapes.clone() })
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Matrix, TriangleMesh};

    use super::*;
    use crate::mesh::scene::SceneMesh;

    fn scene() -> Scene {
        let turned = Similarity {
            rotation: Matrix([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
            scale: 2.5,
            translation: Vector([10.0, -0.25, 3.0]),
        };
        let node = |name: &str, mesh, transform| SceneNode {
            class: Some(name.into()),
            ..SceneNode::new(name, mesh, transform)
        };
        Scene {
            meshes: vec![
                SceneMesh::new("plum", TriangleMesh::default()),
                SceneMesh::new("fig", TriangleMesh::default()),
            ],
            nodes: vec![
                node("fig", 1, Similarity::identity()),
                SceneNode { id: Some(3), source: Some(8), ..node("plum", 0, turned) },
            ],
            frame: Some(Bounds::new(Vector::ZERO, Vector([1.0, 2.0, 3.0]))),
            ..Scene::default()
        }
    }

    #[test]
    fn placements_come_back_on_the_meshes_of_their_classes() {
        let scene = scene();
        let lines = [Vec::new(), vec![Vector([1.0, 2.0, 3.0])]];
        let options = PlacementsOptions { recipe: Some("seed = 1\n"), centre_lines: &lines };
        let text = write_placements(&scene, &options, &Budget::default()).unwrap();
        assert!(text.contains("\"points\":[[1.0,2.0,3.0]]"), "{text}");
        assert_eq!(crate::json::recipe_of(&text).as_deref(), Some("seed = 1\n"));
        let back = read_placements("a.json", &text, &scene, &Budget::default()).unwrap();
        for (a, b) in back.nodes.iter().zip(&scene.nodes) {
            assert!((a.transform.apply(Vector::splat(1.0)) - b.transform.apply(Vector::splat(1.0))).norm() < 1e-6);
            assert_eq!((&a.class, a.id, a.source, a.mesh), (&b.class, b.id, b.source, b.mesh));
        }
        assert_eq!((back.nodes.len(), back.frame), (2, scene.frame));
    }

    #[test]
    fn what_is_wrong_is_told_with_its_number() {
        for (text, expected) in [
            ("{}", "missing field `placements`"),
            (r#"{"placements": [{"class": 0, "translation": [0, 0, 0]}]}"#, "placement 0: class 0 where there are 0"),
            (
                r#"{"placements": [{"class": "pear", "translation": [0, 0, 0]}]}"#,
                "\"pear\", which is none of fig, plum",
            ),
            (r#"{"placements": [{"class": "fig", "translation": [0, 0, 1e30]}]}"#, "beyond the limits"),
            (r#"{"placements": [{"class": "fig", "translation": [0, 0, 0], "scale": -1}]}"#, "a scale of 0 or less"),
            (r#"{"placements": [{"class": "fig", "translation": [0, 0, 0], "mesh": 9}]}"#, "mesh 9 where there are 2"),
        ] {
            let message = read_placements("a.json", text, &scene(), &Budget::default()).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        let by_name = r#"{"placements": [{"class": "plum.007", "translation": [0, 0, 0]}]}"#;
        let scene = read_placements("a.json", by_name, &scene(), &Budget::default()).unwrap();
        assert_eq!(scene.nodes[0].mesh, 0);
    }
}
