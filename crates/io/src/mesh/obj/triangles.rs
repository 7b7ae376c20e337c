//! OBJ: meshes and points, read from `v`, `vn`, `f` and `p`.
//!
//! Read: vertices (`v`), perhaps with a colour behind their place; normals (`vn`); faces (`f`) of vertices, with or without texture
//! and normal, counted from 1 or back from the last one so far; points (`p`). `o` and `g` name the part of the faces that follow.
//! A file without faces and points is the points of its vertices; as many normals as vertices are theirs then.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Error, Result, Vector, Warning};

use crate::{
    geometry::{Cloud, Columns, Geometry, Polygons, attributes::Attribute},
    mesh::obj::lexer::{Lexer, logical_lines},
    text::short::{list, short},
};

/// Work for each byte, and bytes of a vertex.
const PER_BYTE: u64 = 10;
const VERTEX_BYTES: usize = 64;

/// Reads a mesh, or points.
///
/// # Errors
/// [`Error::Input`] with the line: a coordinate that is no finite number within the limits, a face of vertices that do not exist or of
/// fewer than three; [`Error::Limit`] for too many vertices or faces or when the work or the memory is used up.
pub fn read_mesh(name: &str, text: &str, budget: &Budget) -> Result<Geometry> {
    let budget = budget.stage("reading an OBJ file");
    let lexer = Lexer { name, budget: &budget, advice: "give a smaller mesh" };
    let mut reader = Reader::new(lexer);
    for (line, content) in logical_lines(text) {
        reader.statement(line, &content)?;
    }
    reader.finish()
}

/// What a corner of a face has beside its vertex.
#[derive(Clone, Copy, PartialEq)]
enum NormalOf {
    Nothing,
    One(usize),
    /// Corners at one vertex with different normals.
    Several,
}

struct Reader<'a> {
    lexer: Lexer<'a>,
    positions: Vec<Vector<3>>,
    colours: Vec<[f64; 3]>,
    normals: Vec<Vector<3>>,
    /// The normal of each vertex, by the corners of faces so far.
    normal_of: Vec<NormalOf>,
    polygons: Polygons,
    /// Vertices of `p` statements, with their line.
    points: Vec<(usize, usize)>,
    ignored: BTreeMap<String, usize>,
    uses: usize,
}

impl<'a> Reader<'a> {
    fn new(lexer: Lexer<'a>) -> Self {
        Self {
            lexer,
            positions: Vec::new(),
            colours: Vec::new(),
            normals: Vec::new(),
            normal_of: Vec::new(),
            polygons: Polygons::default(),
            points: Vec::new(),
            ignored: BTreeMap::new(),
            uses: 0,
        }
    }

    fn statement(&mut self, line: usize, content: &str) -> Result<()> {
        let mut words = content.split_whitespace();
        let Some(keyword) = words.next().filter(|word| !word.starts_with('#')) else { return Ok(()) };
        let limits = self.lexer.budget.limits();
        self.lexer.budget.spend(PER_BYTE * content.len() as u64)?;
        match keyword {
            "v" | "vn" | "f" | "p" => {
                // Words are counted before a list of them is made.
                let count = words.clone().count();
                self.lexer.check_limit("numbers in one line", count, ("nodes", limits.nodes), 1)?;
                self.uses += count;
                self.lexer.check_limit("numbers", self.uses, ("nodes", limits.nodes), 16)?;
                let words: Vec<&str> = words.collect();
                match keyword {
                    "v" => self.vertex(line, &words),
                    "vn" => self.normal(line, &words),
                    "f" => self.face(line, &words),
                    _ => self.point(line, &words),
                }
            }
            "o" | "g" => {
                self.polygons.begin_part(content.trim_start()[1..].trim());
                Ok(())
            }
            // How faces look, which says nothing about where they are.
            "vt" | "s" | "usemtl" | "mtllib" => Ok(()),
            _ => {
                *self.ignored.entry(short(keyword)).or_insert(0) += 1;
                Ok(())
            }
        }
    }

    fn vertex(&mut self, line: usize, words: &[&str]) -> Result<()> {
        let position = self.lexer.vertex(line, words)?;
        self.lexer.check_limit("vertices", self.positions.len() + 1, ("nodes", self.lexer.budget.limits().nodes), 1)?;
        if words.len() >= 6 {
            let mut colour = [0.0; 3];
            for (k, share) in colour.iter_mut().enumerate() {
                *share = self.value(line, words[words.len() - 3 + k], Attribute::Colour(k))?;
            }
            self.colours.push(colour);
        }
        self.positions.push(position);
        self.normal_of.push(NormalOf::Nothing);
        Ok(())
    }

    fn value(&self, line: usize, word: &str, attribute: Attribute) -> Result<f64> {
        let Ok(value) = word.parse::<f64>() else {
            let problem = format!("\"{}\" is not a number", short(word));
            return self.lexer.fail(line, problem, "write numbers like 12.5 or 1.25e1");
        };
        let checked = attribute.checked(value, || word.to_owned(), self.lexer.budget.limits());
        checked.or_else(|(problem, advice)| self.lexer.fail(line, problem, advice))
    }

    fn normal(&mut self, line: usize, words: &[&str]) -> Result<()> {
        let &[x, y, z] = words else {
            let problem = format!("a normal of {} numbers", words.len());
            return self.lexer.fail(line, problem, "write it as vn 0 0 1");
        };
        let mut normal = Vector::ZERO;
        for (axis, word) in [x, y, z].into_iter().enumerate() {
            normal[axis] = self.value(line, word, Attribute::Normal(axis))?;
        }
        self.lexer.check_limit("normals", self.normals.len() + 1, ("nodes", self.lexer.budget.limits().nodes), 1)?;
        self.normals.push(normal);
        Ok(())
    }

    fn face(&mut self, line: usize, words: &[&str]) -> Result<()> {
        if words.len() < 3 {
            let problem = format!("a face of {} vertices", words.len());
            return self.lexer.fail(line, problem, "write at least three, such as f 1 2 3");
        }
        self.lexer.check_limit("faces", self.polygons.len() + 1, ("nodes", self.lexer.budget.limits().nodes), 1)?;
        let mut corners = Vec::with_capacity(words.len());
        for word in words {
            corners.push(self.corner(line, word)?);
        }
        self.polygons.push(line, corners);
        Ok(())
    }

    /// A corner such as `3`, `3/7`, `3//2` or `3/7/2`: its vertex.
    fn corner(&mut self, line: usize, word: &str) -> Result<u32> {
        let vertex = self.existing(line, word, self.positions.len(), "vertex")?;
        if let Some(normal) = word.split('/').nth(2).filter(|n| !n.is_empty()) {
            let normal = self.existing(line, normal, self.normals.len(), "normal")?;
            let known = self.normal_of[vertex];
            self.normal_of[vertex] = match known {
                NormalOf::Nothing => NormalOf::One(normal),
                NormalOf::One(k) if self.normals[k] == self.normals[normal] => known,
                _ => NormalOf::Several,
            };
        }
        // There are no more vertices than the limit, which is far below.
        Ok(vertex as u32)
    }

    /// The number of something that was there before, counted from zero.
    fn existing(&self, line: usize, word: &str, count: usize, what: &str) -> Result<usize> {
        let index = self.lexer.index(line, word, count)?;
        if index < count {
            return Ok(index);
        }
        let problem = format!("{what} {} where there are {count} so far", index + 1);
        self.lexer.fail(line, problem, &format!("correct the number of the {what}"))
    }

    fn point(&mut self, line: usize, words: &[&str]) -> Result<()> {
        for word in words {
            let vertex = self.existing(line, word, self.positions.len(), "vertex")?;
            self.points.push((line, vertex));
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Geometry> {
        let name = self.lexer.name;
        if self.positions.is_empty() {
            return Err(Error::input(name, "no vertex found", "give a file with vertices, such as v 1 2 3"));
        }
        let _held = self.lexer.budget.hold("the mesh", self.positions.len().saturating_mul(VERTEX_BYTES))?;
        let mut warnings = self.warnings();
        let normals = self.normals_of_vertices(&mut warnings);
        let colours = (self.colours.len() == self.positions.len()).then(|| std::mem::take(&mut self.colours));
        if colours.is_none() && !self.colours.is_empty() {
            let message = format!("{name}: colours of some vertices alone are left out");
            warnings.push(Warning::new(message, "give all vertices a colour"));
        }
        let cut = std::mem::take(&mut self.polygons).triangles((name, "line"), &self.positions, self.lexer.budget)?;
        let columns = columns(&self.positions, normals, colours);
        let mut geometry = columns.into_geometry(name, self.lexer.budget)?;
        warnings.append(&mut geometry.warnings);
        warnings.extend(cut.warnings);
        if cut.triangles.is_empty() && !self.points.is_empty() {
            geometry.points = selected(geometry.points, &self.points);
            geometry.zero_normals = geometry.points.zero_normals();
        }
        let parts = if cut.parts.len() > 1 { cut.parts } else { Vec::new() };
        Ok(Geometry { triangles: cut.triangles, parts, warnings, ..geometry })
    }

    fn normals_of_vertices(&mut self, warnings: &mut Vec<Warning>) -> Option<Vec<Vector<3>>> {
        if self.polygons.len() == 0 {
            let complete = !self.normals.is_empty() && self.normals.len() == self.positions.len();
            return complete.then(|| std::mem::take(&mut self.normals));
        }
        let one = |of: &NormalOf| match *of {
            NormalOf::One(k) => Some(self.normals[k]),
            _ => None,
        };
        if self.normal_of.contains(&NormalOf::Several) {
            let count = self.normal_of.iter().filter(|of| **of == NormalOf::Several).count();
            let message = format!(
                "{}: {count} vertices have a different normal on each side, so that the mesh has none of its own",
                self.lexer.name
            );
            warnings.push(Warning::new(message, "nothing need be done: edges stay as sharp as they are"));
        }
        self.normal_of.iter().map(one).collect()
    }

    fn warnings(&self) -> Vec<Warning> {
        if self.ignored.is_empty() {
            return Vec::new();
        }
        let words = list(self.ignored.iter().map(|(word, n)| format!("{word} ({n})")));
        let message =
            format!("{}: statements that are neither faces nor points are passed over: {words}", self.lexer.name);
        vec![Warning::new(message, "nothing need be done if they do not matter")]
    }
}

/// The vertices as columns, which are checked and scaled as those of any file.
fn columns(positions: &[Vector<3>], normals: Option<Vec<Vector<3>>>, colours: Option<Vec<[f64; 3]>>) -> Columns {
    let mut columns = Columns::default();
    for k in 0..3 {
        let mut set = |attribute: Attribute, values: Vec<f64>| columns.values[attribute.index()] = values;
        set(Attribute::Position(k), positions.iter().map(|p| p[k]).collect());
        set(Attribute::Normal(k), normals.iter().flatten().map(|n| n[k]).collect());
        set(Attribute::Colour(k), colours.iter().flatten().map(|c| c[k]).collect());
    }
    columns
}

/// The points that `p` statements name.
fn selected(points: Cloud, numbers: &[(usize, usize)]) -> Cloud {
    let numbers: Vec<usize> = numbers.iter().map(|(_, vertex)| *vertex).collect();
    match points {
        Cloud::Plane(points) => Cloud::Plane(points.selected(&numbers)),
        Cloud::Space(points) => Cloud::Space(points.selected(&numbers)),
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Limits, PointSet};

    use super::*;

    fn read(text: &str) -> Result<Geometry> {
        read_mesh("a.obj", text, &Budget::default())
    }

    fn points(geometry: &Geometry) -> &PointSet<3> {
        match &geometry.points {
            Cloud::Space(points) => points,
            Cloud::Plane(_) => panic!("there is a z"),
        }
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\n";

    #[test]
    fn normals_without_a_length_are_those_of_the_points_that_are_named() {
        let of =
            |numbers: &str| read(&format!("v 0 0 0\nvn 0 0 0\nv 1 2 3\nvn 1 0 0\np {numbers}\n")).unwrap().zero_normals;
        assert_eq!([of("1 1"), of("2"), of("1 2")], [2, 0, 1]);
    }

    #[test]
    fn corners_of_every_form_are_understood() {
        for face in ["1 2 3 4", "1/1 2/1 3/1 4/1", "1//1 2//1 3//1 4//1", "1/1/1 2/1/1 3/1/1 4/1/1", "-4 -3 -2 -1"] {
            let geometry = read(&format!("{SQUARE}f {face}\n")).unwrap();
            assert_eq!(geometry.triangles, [[0, 1, 2], [0, 2, 3]], "{face}");
            let expected = face.contains("/1 2/1/1") || face.contains("//");
            assert_eq!(points(&geometry).normals.is_some(), expected, "{face}");
            assert!(geometry.warnings.is_empty(), "{:?}", geometry.warnings);
        }
    }

    #[test]
    fn sharp_edges_leave_a_mesh_without_normals() {
        let text = format!("{SQUARE}vn 1 0 0\nf 1//1 2//1 3//1\nf 1//2 3//2 4//2\n");
        let geometry = read(&text).unwrap();
        assert!(points(&geometry).normals.is_none());
        assert!(geometry.warnings[0].message.contains("2 vertices have a different normal"), "{:?}", geometry.warnings);
    }

    #[test]
    fn groups_are_parts_and_colours_go_with_vertices() {
        let text =
            "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 0.5\no lid of it\nf 1 2 3\ng rim\nusemtl a\nf 3 2 1\nl 1 2\n";
        let geometry = read(text).unwrap();
        let parts: Vec<_> = geometry.parts.iter().map(|p| (p.name.as_str(), p.triangles.clone())).collect();
        assert_eq!(parts, [("lid of it", 0..1), ("rim", 1..2)]);
        assert_eq!(points(&geometry).colours.as_ref().map(|c| c[2]), Some([0.0, 0.0, 0.5]));
        assert!(geometry.warnings[0].message.contains("passed over: l (1)"), "{:?}", geometry.warnings);
    }

    #[test]
    fn points_are_named_ones_or_all_vertices() {
        assert_eq!(points(&read(&format!("{SQUARE}p 2 -1\n")).unwrap()).positions.len(), 2);
        let cloud = read("v 0 0 0\nvn 0 0 2\nv 1 0 0\nvn 1 0 0\n").unwrap();
        assert_eq!(points(&cloud).normals.as_ref().map(|n| n[0]), Some(Vector([0.0, 0.0, 1.0])));
        assert!(!cloud.is_mesh());
    }

    #[test]
    fn bad_lines_are_named() {
        for (text, expected) in [
            ("v 0 0 nan\n", "a.obj: line 1: nan where a coordinate"),
            ("v 0 0\n", "a vertex of 2 numbers"),
            ("v 0 0 0 1 2 -3\n", "-3 where 0 to 1"),
            ("v 0 0 0\nvn 0 1\n", "line 2: a normal of 2 numbers"),
            ("v 0 0 0\nvn 0 1 inf\n", "line 2: inf where a finite number"),
            ("v 0 0 0\nf 1 1\n", "line 2: a face of 2 vertices"),
            ("v 0 0 0\nf 1 1 2\n", "line 2: vertex 2 where there are 1 so far"),
            ("v 0 0 0\nf 1 1 0\n", "\"0\" is not a vertex"),
            ("v 0 0 0\nf 1//1 1 1\n", "line 2: normal 1 where there are 0 so far"),
            ("v 0 0 0\np 2\n", "line 2: vertex 2 where"),
            ("f 1 2 3\n", "line 1: vertex 1 where there are 0 so far"),
            ("", "no vertex found"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(expected), "{text:?}: {message}");
        }
    }

    #[test]
    fn limits_hold() {
        let text = format!("{SQUARE}f 1 2 3\nf 1 3 4\n");
        for limits in [
            Limits { nodes: 3, ..Limits::default() },
            Limits { memory: 20, ..Limits::default() },
            Limits { work: 0, ..Limits::default() },
        ] {
            let read = read_mesh("a", &text, &Budget::new(limits));
            assert!(matches!(read, Err(Error::Limit { .. })), "{limits:?}");
        }
    }
}
