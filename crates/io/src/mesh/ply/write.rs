//! PLY out: floats for positions, normals and radii, bytes for colours, whole numbers for groups and elements.

use std::fmt::Write;

use arabesque_core::{Budget, PointSet, Result, TriangleMesh, Vector};

use super::recipe::recipe_comments;

/// Work of one number.
const PER_NUMBER: u64 = 30;
/// Bytes of a number in text at most, roughly; of a face.
const NUMBER_BYTES: usize = 12;
const FACE_BYTES: usize = 36;

/// How numbers are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Encoding {
    /// Four bytes for a float, the lowest first.
    #[default]
    Binary,
    /// Decimal numbers, with the fewest digits that give the same float again.
    Text,
}

/// What [`write_ply`] writes.
#[derive(Clone, Copy, Debug)]
pub struct PlyFile<'a, const D: usize> {
    positions: &'a [Vector<D>],
    normals: Option<&'a [Vector<D>]>,
    colours: Option<&'a [[f64; 3]]>,
    radii: Option<&'a [f64]>,
    /// Name and values.
    labels: [(&'static str, Option<&'a [i32]>); 3],
    triangles: &'a [[u32; 3]],
    encoding: Encoding,
    recipe: Option<&'a str>,
}

impl<'a, const D: usize> PlyFile<'a, D> {
    /// Points with all their attributes.
    pub fn of_points(points: &'a PointSet<D>) -> Self {
        Self {
            positions: &points.positions,
            normals: points.normals.as_deref(),
            colours: points.colours.as_deref(),
            radii: points.radii.as_deref(),
            labels: [
                ("group", points.groups.as_deref()),
                ("element", points.elements.as_deref()),
                ("class", points.classes.as_deref()),
            ],
            triangles: &[],
            encoding: Encoding::default(),
            recipe: None,
        }
    }

    /// With triangles between the points.
    #[must_use]
    pub fn with_triangles(self, triangles: &'a [[u32; 3]]) -> Self {
        Self { triangles, ..self }
    }

    /// With numbers written in another way than the usual one.
    #[must_use]
    pub fn encoded(self, encoding: Encoding) -> Self {
        Self { encoding, ..self }
    }

    /// With a recipe, as TOML, in its comments.
    #[must_use]
    pub fn with_recipe(self, recipe: Option<&'a str>) -> Self {
        Self { recipe, ..self }
    }

    fn header(&self) -> String {
        let format = match self.encoding {
            Encoding::Binary => "binary_little_endian",
            Encoding::Text => "ascii",
        };
        let mut out = format!("ply\nformat {format} 1.0\n");
        out += concat!("comment written by arabesque ", env!("CARGO_PKG_VERSION"), "\n");
        out += &self.recipe.map(recipe_comments).unwrap_or_default();
        out += &format!("element vertex {}\n", self.positions.len());
        let mut properties = |kind: &str, names: &[&str]| {
            names.iter().for_each(|name| out += &format!("property {kind} {name}\n"));
        };
        properties("float", &["x", "y", "z"][..D]);
        if self.normals.is_some() {
            properties("float", &["nx", "ny", "nz"][..D]);
        }
        if self.colours.is_some() {
            properties("uchar", &["red", "green", "blue"]);
        }
        if self.radii.is_some() {
            properties("float", &["radius"]);
        }
        self.labels.iter().filter(|(_, l)| l.is_some()).for_each(|(name, _)| properties("int", &[name]));
        if !self.triangles.is_empty() {
            out += &format!("element face {}\nproperty list uchar int vertex_indices\n", self.triangles.len());
        }
        out + "end_header\n"
    }

    /// Numbers of one point.
    fn width(&self) -> usize {
        let vectors = D * (1 + usize::from(self.normals.is_some()));
        let labels = self.labels.iter().filter(|(_, l)| l.is_some()).count();
        vectors + 3 * usize::from(self.colours.is_some()) + usize::from(self.radii.is_some()) + labels
    }
}

impl<'a> PlyFile<'a, 3> {
    /// A mesh: its vertices, and a face for each triangle. Names of parts are not written.
    pub fn of_mesh(mesh: &'a TriangleMesh) -> Self {
        Self {
            positions: &mesh.positions,
            normals: mesh.normals.as_deref(),
            colours: mesh.colours.as_deref(),
            radii: None,
            labels: [("group", None), ("element", None), ("class", None)],
            triangles: &mesh.triangles,
            encoding: Encoding::default(),
            recipe: None,
        }
    }
}

/// Writes points or a mesh.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work or the memory is used up, [`arabesque_core::Error::Stopped`] when somebody asked to
/// stop.
pub fn write_ply<const D: usize>(file: &PlyFile<'_, D>, budget: &Budget) -> Result<Vec<u8>> {
    let header = file.header();
    let bytes = file.positions.len().saturating_mul(file.width() * NUMBER_BYTES);
    let bytes = bytes.saturating_add(file.triangles.len().saturating_mul(FACE_BYTES));
    let _held = budget.hold("the bytes of the PLY file", bytes.saturating_add(header.len()))?;
    let mut sink = Sink { bytes: header.into_bytes(), encoding: file.encoding, text: String::new() };
    let mut meter = budget.meter();
    for n in 0..file.positions.len() {
        meter.spend(PER_NUMBER * file.width() as u64)?;
        file.positions[n].0.iter().for_each(|v| sink.float(*v));
        file.normals.iter().flat_map(|normals| normals[n].0).for_each(|v| sink.float(v));
        file.colours.iter().flat_map(|colours| colours[n]).for_each(|v| sink.byte(colour_byte(v)));
        file.radii.iter().for_each(|radii| sink.float(radii[n]));
        file.labels.iter().filter_map(|(_, l)| *l).for_each(|labels| sink.whole(labels[n]));
        sink.end_of_row();
    }
    for corners in file.triangles {
        meter.spend(4 * PER_NUMBER)?;
        sink.byte(3);
        corners.iter().for_each(|c| sink.whole(*c as i32));
        sink.end_of_row();
    }
    Ok(sink.bytes)
}

/// A share of a colour as a byte.
pub(crate) fn colour_byte(share: f64) -> u8 {
    (share.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// Rows of numbers.
struct Sink {
    bytes: Vec<u8>,
    encoding: Encoding,
    /// The row of text so far.
    text: String,
}

impl Sink {
    fn float(&mut self, value: f64) {
        let value = value as f32;
        match self.encoding {
            Encoding::Binary => self.bytes.extend_from_slice(&value.to_le_bytes()),
            // Adding zero makes one of the two zeros.
            Encoding::Text => self.word(value + 0.0),
        }
    }

    fn whole(&mut self, value: i32) {
        match self.encoding {
            Encoding::Binary => self.bytes.extend_from_slice(&value.to_le_bytes()),
            Encoding::Text => self.word(value),
        }
    }

    fn byte(&mut self, value: u8) {
        match self.encoding {
            Encoding::Binary => self.bytes.push(value),
            Encoding::Text => self.word(value),
        }
    }

    fn word(&mut self, value: impl std::fmt::Display) {
        let gap = if self.text.is_empty() { "" } else { " " };
        // Writing to a text does not fail.
        let _ = write!(self.text, "{gap}{value}");
    }

    fn end_of_row(&mut self) {
        if self.encoding == Encoding::Text {
            self.text.push('\n');
            self.bytes.extend_from_slice(self.text.as_bytes());
            self.text.clear();
        }
    }
}
