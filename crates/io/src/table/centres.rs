//! The elements of a scene as points: where each is, of which class, how turned and how large, as CSV and PLY.

use std::fmt::Write;

use arabesque_core::{Budget, Decimals, Result, TriangleMesh, Vector};

use crate::{
    mesh::scene::{Scene, quaternion},
    table::records::recipe_comments,
};

/// Work and bytes of one element.
const PER_ROW: u64 = 2500;
const ROW_BYTES: usize = 160;

/// One element.
struct Row {
    centre: Vector<3>,
    class: usize,
    element: u64,
    /// x, y, z, w.
    quaternion: [f64; 4],
    scale: f64,
}

/// Writes the elements as a table: `x,y,z,class,element,qx,qy,qz,qw,scale`. A centre is that of the area of the mesh.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work or the memory is used up, [`arabesque_core::Error::Stopped`] when somebody asked to
/// stop.
pub fn write_centres_csv(scene: &Scene, recipe: Option<&str>, budget: &Budget) -> Result<String> {
    let (rows, classes) = rows(scene, budget)?;
    let _held = budget.hold("the text of the elements", rows.len().saturating_mul(ROW_BYTES))?;
    let (place, share) = decimals(&rows);
    let mut out = String::from("x,y,z,class,element,qx,qy,qz,qw,scale\n");
    for row in &rows {
        let centre = row.centre.0.map(|c| place.format(c)).join(",");
        let turned = row.quaternion.map(|v| share.format(v)).join(",");
        let class = quoted(&classes[row.class]);
        let scale = Decimals::for_extent(row.scale).format(row.scale);
        // Writing to a text does not fail.
        let _ = writeln!(out, "{centre},{class},{},{turned},{scale}", row.element);
    }
    Ok(out + &recipe.map(recipe_comments).unwrap_or_default())
}

/// Writes the elements as points of a PLY text: `x y z`, `class` and `element` as whole numbers, `qx qy qz qw` and `scale`. Comments
/// name the classes.
///
/// # Errors
/// As [`write_centres_csv`].
pub fn write_centres_ply(scene: &Scene, recipe: Option<&str>, budget: &Budget) -> Result<String> {
    let (rows, classes) = rows(scene, budget)?;
    let _held = budget.hold("the text of the elements", rows.len().saturating_mul(ROW_BYTES))?;
    let mut out = format!("ply\nformat ascii 1.0\ncomment written by arabesque {}\n", env!("CARGO_PKG_VERSION"));
    for (number, name) in classes.iter().enumerate() {
        let name: String =
            name.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }).take(100).collect();
        let _ = writeln!(out, "comment class {number} {name}");
    }
    out += &recipe.map(crate::mesh::ply::recipe_comments).unwrap_or_default();
    let _ = writeln!(out, "element vertex {}", rows.len());
    for (kind, names) in
        [("float", &["x", "y", "z"][..]), ("int", &["class", "element"]), ("float", &["qx", "qy", "qz", "qw", "scale"])]
    {
        names.iter().for_each(|name| out += &format!("property {kind} {name}\n"));
    }
    out += "end_header\n";
    let (place, share) = decimals(&rows);
    for row in &rows {
        let centre = row.centre.0.map(|c| place.format(c)).join(" ");
        let turned = row.quaternion.map(|v| share.format(v)).join(" ");
        let scale = Decimals::for_extent(row.scale).format(row.scale);
        let _ = writeln!(out, "{centre} {} {} {turned} {scale}", row.class, row.element);
    }
    Ok(out)
}

fn decimals(rows: &[Row]) -> (Decimals, Decimals) {
    let most = rows.iter().flat_map(|row| row.centre.0).fold(0.0_f64, |most, c| most.max(c.abs()));
    (Decimals::for_extent(most).plus(1), Decimals::for_extent(1.0))
}

fn rows(scene: &Scene, budget: &Budget) -> Result<(Vec<Row>, Vec<String>)> {
    let work = scene.meshes.iter().map(|m| m.mesh.triangles.len()).sum::<usize>() / 50 + scene.nodes.len();
    budget.spend(PER_ROW.saturating_mul(work as u64))?;
    let centres: Vec<Vector<3>> = scene.meshes.iter().map(|m| centre_of(&m.mesh)).collect();
    let classes = scene.classes();
    let row = |(number, node): (usize, &crate::mesh::scene::SceneNode)| Row {
        centre: node.transform.apply(centres.get(node.mesh).copied().unwrap_or(Vector::ZERO)),
        class: classes.of_node[number],
        element: node.id.unwrap_or(number as u64),
        quaternion: quaternion(&node.transform.rotation),
        scale: node.transform.scale,
    };
    Ok((scene.nodes.iter().enumerate().map(row).collect(), classes.names))
}

/// The middle of the area of a mesh; of its box where it has none.
fn centre_of(mesh: &TriangleMesh) -> Vector<3> {
    let (mut sum, mut area) = (Vector::ZERO, 0.0);
    for k in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(k);
        let own = mesh.double_area(k).norm();
        sum += (a + b + c) * (own / 3.0);
        area += own;
    }
    let middle = sum * (1.0 / area);
    if area > 0.0 && middle.is_finite() {
        return middle;
    }
    if mesh.positions.is_empty() { Vector::ZERO } else { mesh.bounds().centre() }
}

/// A name as a field of a table.
fn quoted(name: &str) -> String {
    let plain = name.chars().all(|c| c.is_alphanumeric() || "_-. /".contains(c));
    if plain && !name.is_empty() { name.to_owned() } else { format!("\"{}\"", name.replace('"', "\"\"")) }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Matrix, Similarity};

    use super::*;
    use crate::{
        geometry::read_geometry,
        mesh::scene::{SceneMesh, SceneNode},
    };

    fn scene() -> Scene {
        let mesh = TriangleMesh {
            positions: vec![Vector([0.0; 3]), Vector([3.0, 0.0, 0.0]), Vector([0.0, 3.0, 0.0])],
            triangles: vec![[0, 1, 2]],
            ..TriangleMesh::default()
        };
        let turned = Similarity {
            rotation: Matrix([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
            scale: 2.0,
            translation: Vector([10.0, 0.0, 0.0]),
        };
        Scene {
            meshes: vec![SceneMesh::new("", mesh)],
            nodes: vec![
                SceneNode::new("plum.001", 0, Similarity::identity()),
                SceneNode { id: Some(7), ..SceneNode::new("a,b", 0, turned) },
            ],
            ..Scene::default()
        }
    }

    #[test]
    fn elements_are_rows_of_their_centres() {
        let text = write_centres_csv(&scene(), Some("seed = 1\n"), &Budget::default()).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "x,y,z,class,element,qx,qy,qz,qw,scale");
        assert_eq!(lines[1], "1,1,0,plum,0,0,0,0,1,1");
        assert_eq!(lines[2], "8,2,0,\"a,b\",7,0,0,0.707107,0.707107,2");
        assert!(crate::table::records::recipe_of(&text).is_some());
    }

    #[test]
    fn points_of_a_ply_file_are_read_again() {
        let text = write_centres_ply(&scene(), Some("seed = 1\n"), &Budget::default()).unwrap();
        assert!(text.contains("comment class 1 a,b\n"), "{text}");
        let back = read_geometry("a.ply", text.as_bytes(), &Budget::default()).unwrap();
        assert_eq!(back.points.len(), 2);
        assert_eq!(crate::mesh::ply::recipe_of(text.as_bytes()).as_deref(), Some("seed = 1\n"));
    }
}
