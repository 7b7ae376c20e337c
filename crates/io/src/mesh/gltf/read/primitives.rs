//! The primitives of one mesh of a glTF file: its triangles, with what their vertices have, and its points.

use std::{collections::BTreeMap, sync::Arc};

use arabesque_core::{Error, Limits, PointSet, Result, TriangleMesh, Vector, Warning};

use super::{
    accessor::Binary,
    document::{MaterialRecord, Primitive},
    points::append,
};
use crate::{
    geometry::{Polygons, attributes::Attribute},
    mesh::{
        colour::srgb,
        scene::{self, Attributes},
    },
};

/// Modes of the format.
const POINTS: u32 = 0;
const TRIANGLES: u32 = 4;
const STRIP: u32 = 5;
const FAN: u32 = 6;

/// What one mesh of a file holds, in coordinates of its own.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub(super) name: String,
    pub(super) mesh: TriangleMesh,
    /// How the triangles look.
    pub(super) looks: Vec<scene::Primitive>,
    /// Points; their colours are light.
    pub(super) points: PointSet<3>,
    pub(super) warnings: Vec<Warning>,
}

/// The attributes of the vertices of one primitive.
struct Vertices {
    positions: Vec<Vector<3>>,
    normals: Option<Vec<Vector<3>>>,
    /// Light, not shares of what a screen is given, with that of the material.
    colours: Option<Vec<[f64; 3]>>,
    /// What is written again as it is.
    attributes: Attributes,
}

impl Parts {
    /// Reads the primitives of a mesh. Those that share their vertices go on doing so.
    pub(super) fn read(binary: &Binary<'_>, number: usize) -> Result<Self> {
        let Some(record) = binary.document.meshes.get(number) else { return Ok(Self::default()) };
        let mut reader = Reader {
            binary,
            place: format!("{}: mesh {number}", binary.name),
            parts: Self { name: record.name.clone().unwrap_or_default(), ..Self::default() },
            first_of: BTreeMap::new(),
            coloured: false,
            smooth: true,
        };
        for primitive in &record.primitives {
            reader.primitive(primitive)?;
        }
        reader.finish()
    }
}

/// Where the vertices of a primitive are in the mesh.
#[derive(Clone)]
struct Found {
    first: u32,
    count: usize,
    attributes: Arc<Attributes>,
}

struct Reader<'a> {
    binary: &'a Binary<'a>,
    place: String,
    parts: Parts,
    /// Where the vertices of attributes begin, so that they are read once.
    first_of: BTreeMap<(Vec<usize>, Option<usize>), Found>,
    coloured: bool,
    smooth: bool,
}

impl Reader<'_> {
    fn fail<T>(&self, problem: String) -> Result<T> {
        Err(Error::input(self.place.clone(), problem, "write the file again; it is damaged"))
    }

    /// Refuses more of something than the limit: primitives may refer to the same numbers over and over.
    fn check(&self, what: &str, found: usize) -> Result<()> {
        let limit = ("nodes", self.binary.budget.limits().nodes);
        self.binary.budget.within(&format!("{}: {what}", self.place), found, limit)
    }

    fn primitive(&mut self, primitive: &Primitive) -> Result<()> {
        match primitive.mode.unwrap_or(TRIANGLES) {
            POINTS => self.points(primitive),
            TRIANGLES | STRIP | FAN => self.triangles(primitive),
            // Lines are counted and told where everything is that is left out.
            _ => Ok(()),
        }
    }

    fn material(&self, primitive: &Primitive) -> Option<&MaterialRecord> {
        self.binary.document.materials.get(primitive.material?)
    }

    fn vertices(&mut self, primitive: &Primitive) -> Result<Vertices> {
        let Some(&position) = primitive.attributes.get("POSITION") else {
            return self.fail("a primitive without POSITION".into());
        };
        let positions = vectors(&self.binary.numbers(position, 3)?);
        let limits = self.binary.budget.limits();
        if let Some(bad) = positions.iter().flat_map(|p| p.0).find(|c| {
            // The sign of the place is of no matter here.
            Attribute::Position(0).checked(*c, String::new, limits).is_err()
        }) {
            let problem = format!("{bad} where a coordinate between -{0} and {0} was expected", limits.coordinate);
            if !bad.is_finite() {
                return self.fail(problem);
            }
            let raising = Limits::raising("coordinate", bad.abs());
            return Err(Error::input(self.place.clone(), problem, format!("scale the mesh down{raising}")));
        }
        let normals = primitive.attributes.get("NORMAL").map(|&n| self.binary.numbers(n, 3)).transpose()?;
        let normals = normals.map(|numbers| vectors(&numbers));
        let light = self.light(primitive)?;
        let colours = self.colours(primitive, &light, positions.len());
        let attributes = Attributes {
            uv: [self.floats(primitive, "TEXCOORD_0")?, self.floats(primitive, "TEXCOORD_1")?],
            tangents: self.floats(primitive, "TANGENT")?,
            colours: light,
        };
        let lists =
            [attributes.uv[0].len(), attributes.uv[1].len(), attributes.tangents.len(), attributes.colours.len()];
        let lengths = lists.into_iter().filter(|length| *length > 0).chain(normals.as_ref().map(Vec::len));
        if lengths.into_iter().any(|length| length != positions.len()) {
            return self.fail("a primitive whose attributes have different numbers of vertices".into());
        }
        if normals.iter().flatten().any(|n| !n.is_finite()) {
            return self.fail("a normal that is not finite".into());
        }
        Ok(Vertices { positions, normals, colours, attributes })
    }

    /// An attribute of `N` finite floats for each vertex; an empty list where there is none.
    fn floats<const N: usize>(&self, primitive: &Primitive, name: &str) -> Result<Vec<[f32; N]>> {
        let Some(&accessor) = primitive.attributes.get(name) else { return Ok(Vec::new()) };
        let numbers = self.binary.numbers(accessor, N)?;
        if numbers.iter().any(|v| !(*v as f32).is_finite()) {
            return self.fail(format!("a value of {name} that is not finite"));
        }
        Ok(numbers.chunks_exact(N).map(|c| std::array::from_fn(|k| c[k] as f32)).collect())
    }

    /// Colours of vertices with their opacity; an empty list where there are none.
    fn light(&self, primitive: &Primitive) -> Result<Vec<[f32; 4]>> {
        let Some(&accessor) = primitive.attributes.get("COLOR_0") else { return Ok(Vec::new()) };
        if self.binary.width(accessor) == Some(4) {
            return self.floats(primitive, "COLOR_0");
        }
        let colours: Vec<[f32; 3]> = self.floats(primitive, "COLOR_0")?;
        Ok(colours.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect())
    }

    /// What vertices and material give together.
    fn colours(&self, primitive: &Primitive, light: &[[f32; 4]], count: usize) -> Option<Vec<[f64; 3]>> {
        let paint = self.material(primitive).and_then(|material| material.pbr_metallic_roughness.as_ref());
        // What a picture is multiplied by says nothing without the picture.
        let factor = paint.filter(|p| p.base_color_texture.is_none()).and_then(|p| p.base_color_factor);
        let factor: Option<[f64; 3]> = factor.map(|[r, g, b, _]| [r, g, b]);
        if light.is_empty() {
            return factor.map(|colour| vec![colour; count]);
        }
        let factor = factor.unwrap_or([1.0; 3]);
        Some(light.iter().map(|c| std::array::from_fn(|k| f64::from(c[k]) * factor[k])).collect())
    }

    fn triangles(&mut self, primitive: &Primitive) -> Result<()> {
        let Found { first, count, attributes } = self.shared_vertices(primitive)?;
        let indices = match primitive.indices {
            Some(accessor) => self.binary.indices(accessor)?,
            None => (0..count as u32).collect(),
        };
        if let Some(bad) = indices.iter().find(|i| **i as usize >= count) {
            return self.fail(format!("vertex {bad} where there are {count}"));
        }
        let corners: Vec<u32> = indices.iter().map(|i| first + i).collect();
        let mode = primitive.mode.unwrap_or(TRIANGLES);
        let mut faces = Polygons::default();
        match mode {
            TRIANGLES => corners.chunks_exact(3).for_each(|t| faces.push(0, t.iter().copied())),
            STRIP => corners.windows(3).enumerate().for_each(|(k, t)| {
                faces.push(0, if k % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] });
            }),
            _ => corners.windows(2).skip(1).for_each(|t| faces.push(0, [corners[0], t[0], t[1]])),
        }
        let cut = faces.triangles((&self.place, "primitive"), &self.parts.mesh.positions, self.binary.budget)?;
        // Strips are turned by faces without area.
        if mode == TRIANGLES {
            self.parts.warnings.extend(cut.warnings);
        }
        let found = self.parts.mesh.triangles.len() + cut.triangles.len();
        self.check("triangles", found)?;
        self.parts.looks.push(scene::Primitive {
            triangles: self.parts.mesh.triangles.len()..found,
            vertices: first as usize..first as usize + count,
            material: primitive.material.filter(|m| *m < self.binary.document.materials.len()),
            attributes,
        });
        self.parts.mesh.triangles.extend(cut.triangles);
        Ok(())
    }

    /// The first vertex of a primitive in the mesh, and how many there are; what other primitives have read is shared.
    fn shared_vertices(&mut self, primitive: &Primitive) -> Result<Found> {
        let key = (primitive.attributes.values().copied().collect::<Vec<_>>(), primitive.material);
        if let Some(known) = self.first_of.get(&key) {
            return Ok(known.clone());
        }
        let vertices = self.vertices(primitive)?;
        let (first, count) = (self.parts.mesh.positions.len(), vertices.positions.len());
        self.check("vertices", first + count)?;
        let mesh = &mut self.parts.mesh;
        mesh.positions.extend(vertices.positions);
        self.coloured |= vertices.colours.is_some();
        self.smooth &= vertices.normals.is_some();
        let normals = vertices.normals.unwrap_or_else(|| vec![Vector::ZERO; count]);
        mesh.normals.get_or_insert_default().extend(normals.into_iter().map(Vector::unit_or_zero));
        let colours = vertices.colours.unwrap_or_else(|| vec![[1.0; 3]; count]);
        mesh.colours.get_or_insert_default().extend(colours.into_iter().map(|c| c.map(srgb)));
        let found = Found { first: first as u32, count, attributes: Arc::new(vertices.attributes) };
        self.first_of.insert(key, found.clone());
        Ok(found)
    }

    fn points(&mut self, primitive: &Primitive) -> Result<()> {
        let Vertices { positions, normals, colours, .. } = self.vertices(primitive)?;
        let mut set = PointSet { positions, normals, colours, ..PointSet::default() };
        set.radii = self.scalars(primitive, "_RADIUS", Attribute::Radius, set.len())?;
        let whole = |list: Vec<f64>| list.into_iter().map(|v| v as i32).collect();
        set.groups = self.scalars(primitive, "_GROUP", Attribute::Group, set.len())?.map(whole);
        set.elements = self.scalars(primitive, "_ELEMENT", Attribute::Element, set.len())?.map(whole);
        set.classes = self.scalars(primitive, "_CLASS", Attribute::Class, set.len())?.map(whole);
        if let Some(accessor) = primitive.indices {
            let indices = self.binary.indices(accessor)?;
            if let Some(bad) = indices.iter().find(|i| **i as usize >= set.len()) {
                return self.fail(format!("vertex {bad} where there are {}", set.len()));
            }
            set = set.selected(&indices.iter().map(|i| *i as usize).collect::<Vec<_>>());
        }
        self.check("points", self.parts.points.len() + set.len())?;
        if !append(&mut self.parts.points, set) {
            let message = format!("{}: attributes of some points alone are left out", self.place);
            self.parts.warnings.push(Warning::new(message, "give all points of a mesh the same attributes"));
        }
        Ok(())
    }

    fn scalars(
        &self,
        primitive: &Primitive,
        name: &str,
        attribute: Attribute,
        count: usize,
    ) -> Result<Option<Vec<f64>>> {
        let Some(&accessor) = primitive.attributes.get(name) else { return Ok(None) };
        let numbers = self.binary.numbers(accessor, 1)?;
        if numbers.len() != count {
            return self.fail(format!("{} values of {name} for {count} points", numbers.len()));
        }
        for value in &numbers {
            let checked = attribute.checked(*value, || value.to_string(), self.binary.budget.limits());
            if let Err((problem, _)) = checked {
                return self.fail(format!("{name}: {problem}"));
            }
        }
        Ok(Some(numbers))
    }

    fn finish(mut self) -> Result<Parts> {
        let mesh = &mut self.parts.mesh;
        if !self.coloured {
            mesh.colours = None;
        }
        if !self.smooth {
            mesh.normals = None;
        }
        mend(mesh);
        Ok(self.parts)
    }
}

/// Gives vertices whose normal has no length that of the triangles around them: a single one would cost a smooth mesh its look.
fn mend(mesh: &mut TriangleMesh) {
    let Some(mut normals) = mesh.normals.take() else { return };
    let is_zero: Vec<bool> = normals.iter().map(|n| *n == Vector::ZERO).collect();
    if is_zero.contains(&true) {
        for (k, corners) in mesh.triangles.iter().enumerate() {
            for v in corners.map(|v| v as usize).into_iter().filter(|v| is_zero[*v]) {
                normals[v] += mesh.double_area(k);
            }
        }
        let up = Vector([0.0, 1.0, 0.0]);
        for v in (0..normals.len()).filter(|v| is_zero[*v]) {
            normals[v] = Some(normals[v].unit_or_zero()).filter(|n| *n != Vector::ZERO).unwrap_or(up);
        }
    }
    mesh.normals = Some(normals);
}

fn vectors(numbers: &[f64]) -> Vec<Vector<3>> {
    numbers.chunks_exact(3).map(|c| Vector([c[0], c[1], c[2]])).collect()
}
