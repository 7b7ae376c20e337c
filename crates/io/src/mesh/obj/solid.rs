//! OBJ: points and meshes out, the recipe in comment lines at the end.

use std::fmt::Write;

use arabesque_core::{Budget, Decimals, MeshPart, PointSet, Result, TriangleMesh, Vector};

use crate::table::records;

/// Comment that files of points and meshes start with.
pub const TITLE: &str = "# points and meshes";

/// Work and bytes of one vertex with all it may have, and of one triangle or point.
const PER_LINE: u64 = 600;
const VERTEX_BYTES: usize = 110;
const FACE_BYTES: usize = 50;
/// What sets the decimals of directions and of shares of colours.
const DIRECTION: f64 = 10.0;
const SHARE: f64 = 100.0;

/// Writes points as vertices and `p` statements, with normals as `vn` and colours behind the places. What else points have, OBJ does not
/// hold.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work or the memory is used up, [`arabesque_core::Error::Stopped`] when somebody asked to
/// stop.
pub fn write_cloud(points: &PointSet<3>, recipe: Option<&str>, budget: &Budget) -> Result<String> {
    let _held = budget.hold("the text of the points", points.len().saturating_mul(VERTEX_BYTES + FACE_BYTES))?;
    let mut out = vertices(&points.positions, points.normals.as_deref(), points.colours.as_deref(), budget)?;
    let mut meter = budget.meter();
    for n in 1..=points.len() {
        meter.spend(PER_LINE / 4)?;
        // Writing to a text does not fail.
        let _ = writeln!(out, "p {n}");
    }
    Ok(out + &recipe.map(records::recipe_comments).unwrap_or_default())
}

/// Writes a mesh: vertices with colours, normals, faces, and an `o` before the faces of each part.
///
/// # Errors
/// As [`write_cloud`].
pub fn write_mesh(mesh: &TriangleMesh, recipe: Option<&str>, budget: &Budget) -> Result<String> {
    let bytes = mesh.positions.len().saturating_mul(VERTEX_BYTES);
    let bytes = bytes.saturating_add(mesh.triangles.len().saturating_mul(FACE_BYTES));
    let _held = budget.hold("the text of the mesh", bytes)?;
    let mut out = vertices(&mesh.positions, mesh.normals.as_deref(), mesh.colours.as_deref(), budget)?;
    let mut meter = budget.meter();
    let mut parts = mesh.parts.iter().peekable();
    let mut end = usize::MAX;
    for (k, corners) in mesh.triangles.iter().enumerate() {
        meter.spend(PER_LINE)?;
        if let Some(part) = parts.next_if(|part| part.triangles.start <= k) {
            out += &format!("o {}\n", name_of(part));
            end = part.triangles.end;
        } else if k == end {
            // What belongs to no part follows one that does.
            out += "o\n";
        }
        let [a, b, c] = corners.map(|v| u64::from(v) + 1);
        let _ = match mesh.normals {
            Some(_) => writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}"),
            None => writeln!(out, "f {a} {b} {c}"),
        };
    }
    Ok(out + &recipe.map(records::recipe_comments).unwrap_or_default())
}

fn vertices(
    positions: &[Vector<3>],
    normals: Option<&[Vector<3>]>,
    colours: Option<&[[f64; 3]]>,
    budget: &Budget,
) -> Result<String> {
    let extent = arabesque_core::Bounds::around(positions.iter().copied()).size().0.into_iter().fold(0.0, f64::max);
    // One digit more than elsewhere, since corners of fine meshes are close together.
    let place = Decimals::for_extent(extent).plus(1);
    let [share, direction] = [SHARE, DIRECTION].map(Decimals::for_extent);
    let text = |v: [f64; 3], decimals: Decimals| v.map(|c| decimals.format(c)).join(" ");
    let mut out = format!("{TITLE}\n");
    let mut meter = budget.meter();
    for (n, position) in positions.iter().enumerate() {
        meter.spend(PER_LINE)?;
        out += "v ";
        out += &text(position.0, place);
        if let Some(colours) = colours {
            out.push(' ');
            out += &text(colours[n], share);
        }
        out.push('\n');
    }
    for normal in normals.into_iter().flatten() {
        meter.spend(PER_LINE)?;
        out += &format!("vn {}\n", text(normal.0, direction));
    }
    Ok(out)
}

/// The name of a part on one line, and not as what would be a comment.
fn name_of(part: &MeshPart) -> String {
    part.name.replace(['\n', '\r', '#', '\\'], " ").trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        geometry::Cloud,
        mesh::obj::{read_mesh, recipe_of},
    };

    fn mesh() -> TriangleMesh {
        let part = |name: &str, triangles| MeshPart { name: name.into(), triangles };
        TriangleMesh {
            positions: vec![
                Vector([0.0; 3]),
                Vector([1.0, 0.0, 0.0]),
                Vector([0.0, 1.0, 0.25]),
                Vector([0.0, 0.0, 1.0]),
            ],
            triangles: vec![[0, 1, 2], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            normals: Some(vec![
                Vector([0.0, 0.0, 1.0]),
                Vector([1.0, 0.0, 0.0]),
                Vector([0.0, 1.0, 0.0]),
                Vector([0.0, 0.6, 0.8]),
            ]),
            colours: Some(vec![[1.0, 0.0, 0.5], [0.25, 0.5, 0.75], [0.0; 3], [1.0; 3]]),
            parts: vec![part("lid of it", 0..1), part("rim", 1..3)],
        }
    }

    #[test]
    fn a_mesh_is_read_again_with_its_recipe() {
        let mesh = mesh();
        let text = write_mesh(&mesh, Some("seed = 1\n"), &Budget::default()).unwrap();
        assert!(text.starts_with(TITLE));
        assert_eq!(recipe_of(&text).as_deref(), Some("seed = 1\n"));
        let mut back = read_mesh("a.obj", &text, &Budget::default()).unwrap();
        assert!(back.warnings.is_empty(), "{:?}", back.warnings);
        assert_eq!(back.parts.pop().map(|p| (p.name, p.triangles)), Some((String::new(), 3..4)));
        assert_eq!(back.into_mesh("a.obj").unwrap(), mesh);
    }

    #[test]
    fn points_are_read_again() {
        let TriangleMesh { positions, normals, colours, .. } = mesh();
        let points = PointSet { positions, normals, colours, ..PointSet::default() };
        let text = write_cloud(&points, None, &Budget::default()).unwrap();
        let back = read_mesh("a.obj", &text, &Budget::default()).unwrap();
        assert_eq!((back.points, back.triangles.len()), (Cloud::Space(points), 0));
    }

    #[test]
    fn names_do_not_break_lines() {
        let mut mesh = mesh();
        mesh.parts[0].name = "a\nf 1 1 1 # \\".into();
        let text = write_mesh(&mesh, None, &Budget::default()).unwrap();
        assert!(text.contains("o a f 1 1 1\n"), "{text}");
    }

    #[test]
    fn quotes_in_names_do_not_hide_the_recipe() {
        let mut mesh = mesh();
        mesh.parts[0].name = "a 3\" pipe".into();
        let text = write_mesh(&mesh, Some("seed = 1\n"), &Budget::default()).unwrap();
        assert_eq!(recipe_of(&text).as_deref(), Some("seed = 1\n"));
        assert_eq!(crate::geometry::recipe_of(text.as_bytes()), recipe_of(&text));
    }
}
