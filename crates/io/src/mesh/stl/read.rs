//! STL in: text and bytes told apart, since files of bytes may begin with the word of text.

use arabesque_core::{Budget, Error, Result};

use super::{binary, text};
use crate::geometry::Geometry;

/// Whether the bytes are those of an STL file: of text that begins with `solid` and goes on with triangles, or of exactly the length
/// that its header says.
pub fn is_stl(bytes: &[u8]) -> bool {
    binary::is_exact(bytes) || is_text(bytes)
}

/// Reads triangles. Corners of exactly the same coordinates become one vertex; several solids become parts. The order of the corners
/// counts, not the normals in the file.
///
/// # Errors
/// [`Error::Input`] with the line or the triangle for what is neither text nor bytes of triangles, and for coordinates that are no
/// finite numbers within the limits; [`Error::Limit`] for too many triangles or when the work or the memory is used up.
pub fn read_stl(name: &str, bytes: &[u8], budget: &Budget) -> Result<Geometry> {
    let budget = budget.stage("reading an STL file");
    let geometry = if !binary::is_exact(bytes) && is_text(bytes) {
        text::read(name, &String::from_utf8_lossy(bytes), &budget)?
    } else if binary::counts(bytes).is_some() {
        binary::read(name, bytes, &budget)?
    } else {
        return Err(Error::input(name, "a file that is no STL", "give an STL file of triangles"));
    };
    if geometry.is_mesh() {
        return Ok(geometry);
    }
    Err(Error::input(name, "no triangle found", "give an STL file of triangles"))
}

/// Whether a text begins as STL does: with the word `solid`, and with a triangle or an end behind the name.
fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    let word = start.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let head = &start[..start.len().min(4096)];
    let has = |word: &[u8]| head.windows(word.len()).any(|part| part.eq_ignore_ascii_case(word));
    word && (has(b"facet") || has(b"endsolid"))
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Limits, PointSet, Vector};

    use super::*;
    use crate::geometry::Cloud;

    /// Two triangles of a square; one has its normal the wrong way.
    const SQUARE: &str = "solid top left\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex \
         1 1 0\n  endloop\n endfacet\n FACET NORMAL 0 0 -1\n  OUTER LOOP\n   VERTEX 0 -0 0\n   VERTEX 1 1 0\n   VERTEX 0 \
         1e0 0\n  ENDLOOP\n ENDFACET\nendsolid\n";

    fn binary(header: &str, count: u32, corners: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = header.as_bytes().to_vec();
        bytes.resize(80, b' ');
        bytes.extend(count.to_le_bytes());
        for triangle in corners {
            bytes.extend([0; 12]);
            bytes.extend(triangle.iter().flatten().flat_map(|c| c.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    const CORNERS: [[[f32; 3]; 3]; 2] =
        [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]], [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]];

    fn read(bytes: impl AsRef<[u8]>) -> Result<Geometry> {
        read_stl("a.stl", bytes.as_ref(), &Budget::default())
    }

    #[test]
    fn equal_corners_of_text_are_one_vertex() {
        let geometry = read(SQUARE).unwrap();
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]].map(Vector);
        assert_eq!(geometry.points, Cloud::Space(PointSet::at(corners.to_vec())));
        assert_eq!(geometry.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert!(geometry.warnings[0].message.contains("normals of 1 triangles"), "{:?}", geometry.warnings);
    }

    #[test]
    fn bytes_that_begin_with_the_word_of_text_are_bytes() {
        let expected = read(SQUARE).unwrap();
        for header in ["solid facet endsolid", "made by hand"] {
            let geometry = read(binary(header, 2, &CORNERS)).unwrap();
            assert_eq!((&geometry.triangles, &geometry.points), (&expected.triangles, &expected.points));
            assert!(geometry.warnings.is_empty());
        }
    }

    #[test]
    fn solids_are_parts() {
        let two = [SQUARE, &SQUARE.replace("top left", "other")].concat();
        let parts = read(two).unwrap().parts;
        let runs: Vec<_> = parts.iter().map(|p| (p.name.as_str(), p.triangles.clone())).collect();
        assert_eq!(runs, [("top left", 0..2), ("other", 2..4)]);
    }

    #[test]
    fn bad_files_say_where_and_what() {
        let cut = SQUARE.find("endloop").unwrap();
        for (bytes, expected) in [
            (b"hello".to_vec(), "a file that is no STL"),
            (b"solid a\nendsolid a\n".to_vec(), "no triangle found"),
            (binary("", 0, &[]), "no triangle found"),
            (SQUARE.as_bytes()[..cut].to_vec(), "the file ends within a triangle"),
            (SQUARE.replace("1 1 0", "1 one 0").into_bytes(), "line 6: \"one\" is not a number"),
            (SQUARE.replace("1 1 0", "1 nan 0").into_bytes(), "line 6: nan where a coordinate"),
            (SQUARE.replace("1 1 0", "1 1").into_bytes(), "line 6: a vertex of 2 numbers"),
            (SQUARE.replacen("  endloop", "vertex 1 1 1\n", 1).into_bytes(), "line 7: a triangle of more than three"),
            (SQUARE.replacen("   vertex 1 0 0\n", "", 1).into_bytes(), "line 7: a triangle of 2 vertices"),
            (SQUARE.replace("endsolid", "end of it").into_bytes(), "line 16: \"end\" where facet"),
            (binary("", 3, &CORNERS), "3 triangles where there is room for 2 at most"),
            (binary("", u32::MAX, &CORNERS), "4294967295 triangles where"),
            (binary("", 1, &[[[f32::NAN; 3]; 3]]), "triangle 0, counted from 0: NaN where a coordinate"),
        ] {
            let message = read(&bytes).unwrap_err().to_string();
            assert!(message.contains(expected) && message.len() < 300, "{expected}: {message}");
        }
        let more = [binary("", 2, &CORNERS), vec![1]].concat();
        assert!(read(more).unwrap().warnings[0].message.contains("behind the last triangle"));
    }

    #[test]
    fn limits_hold() {
        for limits in [
            Limits { nodes: 1, ..Limits::default() },
            Limits { memory: 20, ..Limits::default() },
            Limits { work: 0, ..Limits::default() },
        ] {
            for bytes in [SQUARE.as_bytes().to_vec(), binary("", 2, &CORNERS)] {
                let read = read_stl("a", &bytes, &Budget::new(limits));
                assert!(matches!(read, Err(Error::Limit { .. })), "{limits:?}");
            }
        }
    }
}
