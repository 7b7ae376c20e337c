//! OBJ: scenes in, an element for each `o` or `g`.
//!
//! Read: vertices with a colour or without, texture vertices, normals, faces, `usemtl`, and the colours of materials in files that
//! `mtllib` names beside it. Elements of one shape share a mesh, as [`Scene::split_components`] finds them, but an element stays
//! one however many parts it has.

use std::collections::{BTreeMap, HashMap};

use arabesque_core::{Budget, Error, Result, TriangleMesh, Vector, Warning};

use super::{
    lexer::{Lexer, logical_lines},
    mtl::read_materials,
};
use crate::{
    file::{Beside, decode_text, name_beside},
    geometry::Polygons,
    mesh::scene::{Attributes, Looks, Material, Primitive, Scene, SceneMesh, SceneNode},
    text::short::short,
};

/// Work for each byte.
const PER_BYTE: u64 = 12;
const ADVICE: &str = "give a smaller scene";

/// Reads a scene; `beside` gives the files of materials.
///
/// # Errors
/// [`Error::Input`] with the line: a coordinate that is no finite number within the limits, a face of vertices that do not exist or of
/// fewer than three, no face at all; [`Error::Limit`] for too many vertices or faces or when the work or the memory is used up.
pub fn read_scene(name: &str, text: &str, beside: &dyn Beside, budget: &Budget) -> Result<Scene> {
    let budget = budget.stage("reading an OBJ file");
    let lexer = Lexer { name, budget: &budget, advice: ADVICE };
    let mut reader = Reader::new(lexer, beside);
    for (line, content) in logical_lines(text) {
        reader.statement(line, &content)?;
    }
    reader.finish()
}

struct Reader<'a> {
    lexer: Lexer<'a>,
    beside: &'a dyn Beside,
    positions: Vec<Vector<3>>,
    /// Colours as screens have them, by vertex.
    colours: Vec<Option<[f64; 3]>>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<Vector<3>>,
    corners: usize,
    /// The element that faces go to.
    open: Element,
    material: Option<usize>,
    scene: Scene,
    numbers: BTreeMap<String, usize>,
    ignored: BTreeMap<String, usize>,
}

/// The faces of one element so far.
#[derive(Default)]
struct Element {
    name: String,
    /// Number of each combination of vertex, texture vertex and normal.
    number_of: HashMap<[u32; 3], u32>,
    corners: Vec<[u32; 3]>,
    /// Faces of one material after another.
    runs: Vec<(Option<usize>, Polygons)>,
}

/// What a corner of a face does not have.
const NOTHING: u32 = u32::MAX;

impl<'a> Reader<'a> {
    fn new(lexer: Lexer<'a>, beside: &'a dyn Beside) -> Self {
        Self {
            lexer,
            beside,
            positions: Vec::new(),
            colours: Vec::new(),
            uvs: Vec::new(),
            normals: Vec::new(),
            corners: 0,
            open: Element::default(),
            material: None,
            scene: Scene::default(),
            numbers: BTreeMap::new(),
            ignored: BTreeMap::new(),
        }
    }

    fn statement(&mut self, line: usize, content: &str) -> Result<()> {
        let mut words = content.split_whitespace();
        let Some(keyword) = words.next().filter(|word| !word.starts_with('#')) else { return Ok(()) };
        let limits = self.lexer.budget.limits();
        self.lexer.budget.spend(PER_BYTE * content.len() as u64)?;
        let rest = content.trim_start()[keyword.len()..].trim();
        match keyword {
            "v" | "vt" | "vn" | "f" => {
                self.lexer.check_limit("numbers in one line", words.clone().count(), ("nodes", limits.nodes), 1)?;
                let words: Vec<&str> = words.collect();
                match keyword {
                    "v" => self.vertex(line, &words),
                    "vt" => self.uv(line, &words),
                    "vn" => self.normal(line, &words),
                    _ => self.face(line, &words),
                }
            }
            "o" | "g" => {
                self.close()?;
                self.open.name = rest.to_owned();
                Ok(())
            }
            "usemtl" => {
                self.material = Some(self.material_of(rest));
                Ok(())
            }
            "mtllib" => self.library(line, rest),
            "s" => Ok(()),
            _ => {
                *self.ignored.entry(short(keyword)).or_insert(0) += 1;
                Ok(())
            }
        }
    }

    fn room(&self, what: &str, count: usize) -> Result<()> {
        self.lexer.check_limit(what, count + 1, ("nodes", self.lexer.budget.limits().nodes), 1)
    }

    fn vertex(&mut self, line: usize, words: &[&str]) -> Result<()> {
        let position = self.lexer.vertex(line, words)?;
        self.room("vertices", self.positions.len())?;
        let colour = (words.len() >= 6).then(|| {
            let share = |k: usize| words[words.len() - 3 + k].parse::<f64>().unwrap_or(1.0);
            let colour: [f64; 3] = std::array::from_fn(share);
            let full = if colour.iter().any(|c| *c > 1.0) { 255.0 } else { 1.0 };
            colour.map(|c| (c / full).clamp(0.0, 1.0))
        });
        self.positions.push(position);
        self.colours.push(colour);
        Ok(())
    }

    fn uv(&mut self, line: usize, words: &[&str]) -> Result<()> {
        self.room("texture vertices", self.uvs.len())?;
        let mut uv = [0.0; 2];
        for (value, word) in uv.iter_mut().zip(words) {
            *value = self.lexer.coordinate(line, word)?;
        }
        // Up is the other way there.
        self.uvs.push([uv[0] as f32, (1.0 - uv[1]) as f32]);
        Ok(())
    }

    fn normal(&mut self, line: usize, words: &[&str]) -> Result<()> {
        let &[x, y, z] = words else {
            let problem = format!("a normal of {} numbers", words.len());
            return self.lexer.fail(line, problem, "write it as vn 0 0 1");
        };
        self.room("normals", self.normals.len())?;
        let mut normal = Vector::ZERO;
        for (axis, word) in [x, y, z].into_iter().enumerate() {
            normal[axis] = self.lexer.coordinate(line, word)?;
        }
        self.normals.push(normal.unit_or_zero());
        Ok(())
    }

    fn face(&mut self, line: usize, words: &[&str]) -> Result<()> {
        if words.len() < 3 {
            let problem = format!("a face of {} vertices", words.len());
            return self.lexer.fail(line, problem, "write at least three, such as f 1 2 3");
        }
        self.corners += words.len();
        self.lexer.check_limit("corners of faces", self.corners, ("nodes", self.lexer.budget.limits().nodes), 3)?;
        let mut face = Vec::with_capacity(words.len());
        for word in words {
            let key = self.corner(line, word)?;
            let element = &mut self.open;
            let next = element.corners.len() as u32;
            let number = *element.number_of.entry(key).or_insert(next);
            if number == next {
                element.corners.push(key);
            }
            face.push(number);
        }
        let material = self.material;
        let runs = &mut self.open.runs;
        if runs.last().is_none_or(|(last, _)| *last != material) {
            runs.push((material, Polygons::default()));
        }
        if let Some((_, polygons)) = runs.last_mut() {
            polygons.push(line, face);
        }
        Ok(())
    }

    /// A corner such as `3`, `3/7`, `3//2` or `3/7/2`.
    fn corner(&self, line: usize, word: &str) -> Result<[u32; 3]> {
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let mut key = [NOTHING; 3];
        for ((k, part), what) in word.split('/').take(3).enumerate().zip(["vertex", "texture vertex", "normal"]) {
            if k > 0 && part.is_empty() {
                continue;
            }
            let index = self.lexer.index(line, part, counts[k])?;
            if index >= counts[k] {
                let problem = format!("{what} {} where there are {} so far", index + 1, counts[k]);
                return self.lexer.fail(line, problem, &format!("correct the number of the {what}"));
            }
            // There are no more of them than the limit, which is far below.
            key[k] = index as u32;
        }
        Ok(key)
    }

    /// The number of a material, which may be described later or not at all.
    fn material_of(&mut self, name: &str) -> usize {
        let materials = &mut self.scene.looks.materials;
        *self.numbers.entry(name.to_owned()).or_insert_with(|| {
            materials.push(Material { name: name.to_owned(), ..Material::default() });
            materials.len() - 1
        })
    }

    fn library(&mut self, line: usize, reference: &str) -> Result<()> {
        let place = format!("{}: line {line}", self.lexer.name);
        let budget = self.lexer.budget;
        let found = name_beside(&place, reference).and_then(|name| self.beside.read(&name, budget));
        let text = found.and_then(|bytes| decode_text(reference, &bytes, budget));
        match text {
            Ok(text) => {
                budget.spend(PER_BYTE * text.len() as u64)?;
                for material in read_materials(&text, budget.limits().nodes) {
                    let number = self.material_of(&material.name);
                    self.scene.looks.materials[number] = material;
                }
                Ok(())
            }
            Err(Error::Input { place, problem, .. }) => {
                let message = format!("{}: line {line}: materials are left out: {place}: {problem}", self.lexer.name);
                self.scene.warnings.push(Warning::new(message, "put the file of materials beside the scene"));
                Ok(())
            }
            Err(other) => Err(other),
        }
    }

    /// Takes down the element whose faces are over.
    fn close(&mut self) -> Result<()> {
        let element = std::mem::take(&mut self.open);
        if element.runs.is_empty() {
            return Ok(());
        }
        let positions: Vec<Vector<3>> = element.corners.iter().map(|c| self.positions[c[0] as usize]).collect();
        let all = |k: usize| element.corners.iter().all(|c| c[k] != NOTHING);
        let normals = all(2).then(|| element.corners.iter().map(|c| self.normals[c[2] as usize]).collect::<Vec<_>>());
        let normals = normals.filter(|list| !list.contains(&Vector::ZERO));
        let own: Vec<Option<[f64; 3]>> = element.corners.iter().map(|c| self.colours[c[0] as usize]).collect();
        let uv = if all(1) { element.corners.iter().map(|c| self.uvs[c[1] as usize]).collect() } else { Vec::new() };
        let light = |c: &Option<[f64; 3]>| {
            let [r, g, b] = c.unwrap_or([1.0; 3]).map(|c| crate::mesh::colour::linear(c) as f32);
            [r, g, b, 1.0]
        };
        let coloured = own.iter().any(Option::is_some);
        let colours = if coloured { own.iter().map(light).collect() } else { Vec::new() };
        let attributes = std::sync::Arc::new(Attributes { uv: [uv, Vec::new()], colours, ..Attributes::default() });
        let mut triangles = Vec::new();
        let mut primitives = Vec::new();
        let mut shown = vec![None; positions.len()];
        for (material, polygons) in element.runs {
            let cut = polygons.triangles((self.lexer.name, "line"), &positions, self.lexer.budget)?;
            let run = triangles.len()..triangles.len() + cut.triangles.len();
            self.scene.warnings.extend(cut.warnings);
            for v in cut.triangles.iter().flatten() {
                shown[*v as usize] = shown[*v as usize].or(material);
            }
            triangles.extend(cut.triangles);
            let attributes = std::sync::Arc::clone(&attributes);
            primitives.push(Primitive { triangles: run, vertices: 0..positions.len(), material, attributes });
        }
        if triangles.is_empty() {
            return Ok(());
        }
        let colour = |v: usize| own[v].or_else(|| Some(self.scene.looks.materials[shown[v]?].screen_colour()));
        let found: Vec<_> = (0..positions.len()).map(colour).collect();
        let colours = found.iter().any(Option::is_some).then(|| found.iter().map(|c| c.unwrap_or([1.0; 3])).collect());
        let mesh = TriangleMesh { positions, triangles, normals, colours, parts: Vec::new() };
        let shape = SceneMesh { primitives, ..SceneMesh::new(element.name.clone(), mesh) };
        let node = SceneNode { mesh: self.scene.meshes.len(), ..SceneNode::default() };
        self.scene.nodes.push(SceneNode { name: element.name, ..node });
        self.scene.meshes.push(shape);
        Ok(())
    }

    fn finish(mut self) -> Result<Scene> {
        self.close()?;
        let name = self.lexer.name;
        if self.scene.nodes.is_empty() {
            return Err(Error::input(name, "no face found", "give a file with faces, such as f 1 2 3"));
        }
        if !self.ignored.is_empty() {
            let message = format!("{name}: statements are left out: {}", crate::text::short::list(self.ignored.keys()));
            self.scene.warnings.push(Warning::new(message, "nothing need be done where they say nothing of shapes"));
        }
        let Looks { materials, .. } = &self.scene.looks;
        self.lexer.check_limit("materials", materials.len(), ("nodes", self.lexer.budget.limits().nodes), 1)?;
        self.scene.share_shapes(self.lexer.budget)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::{file::NothingBeside, mesh::obj::write_scene};

    const TWO: &str = "mtllib a.mtl\no plum.001\nv 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 3\nusemtl red\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n\
                       o plum.002\nv 10 0 0\nv 10 4 0\nv 8 0 0\nv 10 0 6\nf 5 7 6\nf 5 6 8\nf 6 7 8\nf 7 5 8\n";

    fn read(text: &str) -> Result<Scene> {
        let files = BTreeMap::from([("a.mtl".to_owned(), Arc::from(b"newmtl red\nKd 1 0 0\n".as_slice()))]);
        read_scene("a.obj", text, &files, &Budget::default())
    }

    #[test]
    fn objects_are_elements_and_those_of_one_shape_share_it() {
        let scene = read(TWO).unwrap();
        assert_eq!((scene.meshes.len(), scene.nodes.len()), (1, 2));
        assert_eq!(scene.classes().names, ["plum"]);
        assert!((scene.nodes[1].transform.scale - 2.0).abs() < 1e-9);
        assert_eq!(scene.looks.materials[0].base_colour, [1.0, 0.0, 0.0, 1.0]);
        assert_eq!(scene.meshes[0].mesh.colours.as_ref().unwrap()[0], [1.0, 0.0, 0.0]);
        let without = read_scene("a.obj", TWO, &NothingBeside, &Budget::default()).unwrap();
        assert!(without.warnings[0].message.contains("line 1: materials are left out"), "{:?}", without.warnings);
    }

    #[test]
    fn what_is_written_is_read_again() {
        let scene = read(TWO).unwrap();
        let out = write_scene(&scene, Some("a.mtl"), Some("seed = 1\n"), &Budget::default()).unwrap();
        assert!(out.obj.contains("mtllib a.mtl\no plum.001\n") && out.obj.contains("usemtl red_0\n"), "{}", out.obj);
        assert_eq!(crate::mesh::obj::recipe_of(&out.obj).as_deref(), Some("seed = 1\n"));
        let files = BTreeMap::from([("a.mtl".to_owned(), Arc::from(out.mtl.unwrap().as_bytes()))]);
        let back = read_scene("b.obj", &out.obj, &files, &Budget::default()).unwrap();
        assert_eq!((back.meshes.len(), back.nodes.len()), (1, 2));
        for (a, b) in scene.nodes.iter().zip(&back.nodes) {
            let p = |s: &Scene, n: &SceneNode| n.transform.apply(s.meshes[n.mesh].mesh.positions[3]);
            assert!((p(&scene, a) - p(&back, b)).norm() < 1e-5);
        }
        let plain = write_scene(&scene, None, None, &Budget::default()).unwrap();
        assert!(plain.mtl.is_none() && plain.obj.contains("v 0 0 0 1 0 0\n"), "{}", plain.obj);
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        for (text, expected) in [
            ("v 0 0 0\n", "no face found"),
            ("v 0 0 nan\n", "line 1: nan where a coordinate"),
            ("v 0 0 0\nf 1 1\n", "line 2: a face of 2 vertices"),
            ("v 0 0 0\nf 1 2 3\n", "line 2: vertex 2 where there are 1 so far"),
            ("v 0 0 0\nf 1/1 1/1 1/1\n", "line 2: texture vertex 1 where there are 0 so far"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
