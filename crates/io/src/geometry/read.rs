//! Files of points and meshes of any kind, told apart by what they begin with, and by their ending where that says nothing.

use arabesque_core::{Budget, Error, Result};

use super::found::Geometry;
use crate::{
    file::{binary, called, decode_text},
    json,
    mesh::{gltf, obj, ply, stl},
    table::{points, records, xyz},
};

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Points with attributes and meshes, as text or bytes.
    Ply,
    /// Triangles, as text or bytes.
    Stl,
    /// Scenes of meshes and points: GLB, or glTF as text.
    Glb,
    /// Meshes, points and polylines, as text.
    Obj,
    /// A table whose header names its columns.
    Csv,
    /// A table of three or six columns.
    Xyz,
}

/// Endings of file names, in lower case.
const ENDINGS: [(&str, Kind); 13] = [
    ("ply", Kind::Ply),
    ("stl", Kind::Stl),
    ("glb", Kind::Glb),
    ("gltf", Kind::Glb),
    ("obj", Kind::Obj),
    ("csv", Kind::Csv),
    ("tsv", Kind::Csv),
    ("xyz", Kind::Xyz),
    ("xyzn", Kind::Xyz),
    ("xyzrgb", Kind::Xyz),
    ("pts", Kind::Xyz),
    ("asc", Kind::Xyz),
    ("txt", Kind::Xyz),
];

/// Bytes at the beginning that are looked at.
const HEAD: usize = 4096;

/// What kind of file it is; `None` where neither content nor ending say so.
pub fn kind_of(name: &str, bytes: &[u8]) -> Option<Kind> {
    if ply::is_ply(bytes) {
        return Some(Kind::Ply);
    }
    if gltf::is_gltf(bytes) {
        return Some(Kind::Glb);
    }
    if stl::is_stl(bytes) {
        return Some(Kind::Stl);
    }
    let ending = name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase()).unwrap_or_default();
    let by_name = ENDINGS.iter().find(|(known, _)| *known == ending).map(|(_, kind)| *kind);
    by_name.or_else(|| kind_of_text(&String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)])))
}

/// The kind of a text by its first lines.
fn kind_of_text(head: &str) -> Option<Kind> {
    let mut lines = head.lines().map(str::trim).filter(|line| records::is_data(line) && !line.starts_with("//"));
    let first = lines.next()?;
    let word = first.split_whitespace().next()?;
    if matches!(word, "v" | "vn" | "vt" | "o" | "g" | "mtllib") {
        return Some(Kind::Obj);
    }
    let numbers = first.split_whitespace().filter(|word| word.parse::<f64>().is_ok()).count();
    match (records::separator_of(first), first.split_whitespace().count()) {
        (Some(_), _) => Some(Kind::Csv),
        (None, words) if numbers == words && matches!(words, 1 | 3 | 6) => Some(Kind::Xyz),
        (None, _) => super::attributes::is_known(&word.to_ascii_lowercase()).then_some(Kind::Csv),
    }
}

/// Reads points with attributes and, where there are faces, their triangles. Of a scene its meshes are one, with a part for each node;
/// [`crate::mesh::gltf::read_scene`] keeps them apart.
///
/// # Errors
/// [`Error::Input`] for files that are none of these, [`Error::Unsupported`] for kinds that are known and not read, and those of the
/// reader of each kind.
pub fn read_geometry(name: &str, bytes: &[u8], budget: &Budget) -> Result<Geometry> {
    let text = || decode_text(name, bytes, budget);
    if let Some(kind) = binary(bytes).filter(|_| !gltf::is_gltf(bytes)) {
        return Err(neither(name, kind));
    }
    match kind_of(name, bytes) {
        Some(Kind::Ply) => ply::read_ply(name, bytes, budget),
        Some(Kind::Stl) => stl::read_stl(name, bytes, budget),
        Some(Kind::Glb) => Ok(gltf::read_scene(name, bytes, budget)?.into_geometry(name)),
        Some(Kind::Obj) => obj::read_mesh(name, &text()?, budget),
        Some(Kind::Csv) => points::read_table(name, &text()?, budget),
        Some(Kind::Xyz) => xyz::read_xyz(name, &text()?, budget),
        None => Err(neither(name, called(bytes))),
    }
}

fn neither(name: &str, kind: &str) -> Error {
    let advice = "give a mesh or points as PLY, STL, OBJ or GLB; points as CSV or XYZ too";
    Error::input(name, format!("{kind}, where a mesh or points were expected"), advice)
}

/// The recipe in a file of points or a mesh that this library wrote.
pub fn recipe_of(bytes: &[u8]) -> Option<String> {
    if ply::is_ply(bytes) {
        return ply::recipe_of(bytes);
    }
    if gltf::is_glb(bytes) {
        return gltf::recipe_of(bytes);
    }
    let text = std::str::from_utf8(bytes).ok()?;
    match text.trim_start().chars().next()? {
        '{' => json::recipe_of(text),
        // Tables begin with the names of their columns, everything else with a comment that says what it is.
        '#' => obj::recipe_of(text),
        _ => records::recipe_of(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_counts_before_the_ending() {
        for (name, bytes, kind) in [
            ("a.obj", "ply\nformat ascii 1.0\n", Some(Kind::Ply)),
            ("a.txt", "glTF", Some(Kind::Glb)),
            ("a", "solid a\nfacet normal 0 0 1\n", Some(Kind::Stl)),
            ("a.STL", "solid", Some(Kind::Stl)),
            ("a.xyz", "solid 1 2\n", Some(Kind::Xyz)),
            ("-", "# by hand\n\nv 1 2 3\n", Some(Kind::Obj)),
            ("-", "x,y,z\n1,2,3\n", Some(Kind::Csv)),
            ("-", "x y\n1 2\n", Some(Kind::Csv)),
            ("-", "1 2 3\n", Some(Kind::Xyz)),
            ("-", "<svg/>", None),
            ("-", "", None),
        ] {
            assert_eq!(kind_of(name, bytes.as_bytes()), kind, "{name}: {bytes}");
        }
    }

    #[test]
    fn every_kind_is_read_by_its_content() {
        let read = |name: &str, text: &str| read_geometry(name, text.as_bytes(), &Budget::default());
        for text in [
            "x,y,z\n1,2,3\n",
            "v 1 2 3\n",
            "1 2 3\n",
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\nproperty int z\nend_header\n1 2 3\n",
        ] {
            let geometry = read("-", text).unwrap();
            assert_eq!((geometry.points.len(), geometry.is_mesh()), (1, false), "{text}");
        }
        assert!(read("a.gltf", "{}").unwrap_err().to_string().contains("no mesh and no points"));
        assert!(
            read("a.svg", "<svg/>").unwrap_err().to_string().contains("an SVG or XML file, where a mesh or points")
        );
        assert!(recipe_of(b"x,y\n1,2\n# arabesque recipe:\n# seed = 1\n").is_some());
        assert!(recipe_of(&[0xFF, 0xFE]).is_none());
    }
}
