//! PLY in.
//!
//! Read: the element `vertex` with `x`, `y` and, in space, `z`, normals, colours, `radius`, `group` and `element` under their usual
//! names ([`crate::geometry`]), of any type of numbers; the lists `vertex_indices` of the element `face`, and the strips of the
//! element `tristrips`. Everything else is parsed and passed over.

use arabesque_core::{Budget, Error, Result, Warning};

use super::{
    header::{Element, Header, read_header},
    rows::Rows,
    scalar::Scalar,
};
use crate::{
    geometry::{
        Cloud, Columns, Geometry, Polygons,
        attributes::{Attribute, NAMES, columns_of},
    },
    text::short::{list, short},
};

/// Names of the list of corners.
const CORNERS: [&str; 4] = ["vertex_indices", "vertex_index", "vertex_ids", "vertices"];

/// Reads points and, where there are faces, their triangles.
///
/// # Errors
/// [`Error::Input`] with the line, or with the element and its number, for whatever is not as the header says, for coordinates that are
/// no finite numbers within the limits, and for faces of vertices that do not exist; [`Error::Limit`] for too many rows or when the
/// work or the memory is used up.
pub fn read_ply(name: &str, bytes: &[u8], budget: &Budget) -> Result<Geometry> {
    let budget = budget.stage("reading a PLY file");
    let header = read_header(name, bytes, &budget)?;
    let rows = Rows::new(name, bytes, &header, &budget);
    let mut reader = Reader { name, budget: &budget, rows, columns: None, faces: Faces::default(), passed: Vec::new() };
    for element in &header.elements {
        reader.element(element)?;
    }
    reader.finish(&header)
}

struct Reader<'a> {
    name: &'a str,
    budget: &'a Budget,
    rows: Rows<'a>,
    columns: Option<Columns>,
    faces: Faces,
    /// Elements and properties that are passed over.
    passed: Vec<String>,
}

/// Faces and strips of triangles, whose vertices may follow later in the file.
#[derive(Default)]
struct Faces {
    polygons: Polygons,
    /// What the numbers of the faces count.
    noun: &'static str,
}

impl Reader<'_> {
    fn element(&mut self, element: &Element) -> Result<()> {
        self.rows.check_room(element)?;
        let what = format!("{}: rows of element {}", self.name, short(&element.name));
        self.budget.within(&what, element.count, ("nodes", self.budget.limits().nodes))?;
        let corners = element.properties.iter().position(|p| CORNERS.contains(&&*p.name) && p.length.is_some());
        match (element.name.as_str(), corners) {
            ("vertex", _) => self.vertices(element),
            ("face" | "faces" | "tristrips", Some(corners)) if element.properties[corners].kind.is_whole() => {
                self.faces(element, corners)
            }
            ("face" | "faces", _) if element.count > 0 => Err(Error::input(
                self.name,
                format!("element {} without a list of whole numbers vertex_indices", element.name),
                "write the faces as property list uchar int vertex_indices",
            )),
            _ => {
                if element.count > 0 {
                    self.passed.push(format!("element {}", short(&element.name)));
                }
                self.rows.each(element, None, |_, _, _| Ok(()))
            }
        }
    }

    fn vertices(&mut self, element: &Element) -> Result<()> {
        let names: Vec<String> = element
            .properties
            .iter()
            // A list is no value of a point.
            .map(|p| if p.length.is_none() { p.name.clone() } else { String::new() })
            .collect();
        let found = columns_of(&names);
        for axis in [Attribute::Position(0), Attribute::Position(1)] {
            if found[axis.index()].is_none() {
                let own = |name: &str, is_list: bool| is_list && name == axis.name();
                if element.properties.iter().any(|p| own(&p.name, p.length.is_some())) {
                    let problem = format!("the property {} is a list, where a number was expected", axis.name());
                    return Err(Error::input(self.name, problem, "write one number for each vertex"));
                }
                let known: Vec<String> = names.iter().filter(|name| !name.is_empty()).cloned().collect();
                let problem = format!("no property {} among {}", axis.name(), list(&known));
                return Err(Error::input(self.name, problem, "name the coordinates x, y and, in space, z"));
            }
        }
        let unused = (0..names.len()).filter(|k| !found.contains(&Some(*k)));
        self.passed.extend(unused.map(|k| element.properties[k].name.clone()));
        let used: Vec<(Attribute, usize)> = NAMES.iter().filter_map(|(a, _)| Some((*a, found[a.index()]?))).collect();
        let mut columns = Columns::with_room(found.map(|k| k.is_some()), element.count, self.budget)?;
        columns.full = found[Attribute::Colour(0).index()].and_then(|k| full_colour(element.properties[k].kind));
        let limits = self.budget.limits();
        self.rows.each(element, None, |_, row, place| {
            for &(attribute, k) in &used {
                let value = row.numbers[k];
                let checked = attribute.checked(value, || value.to_string(), limits);
                let value = checked.map_err(|(problem, advice)| {
                    Error::input(format!("{}, property {}", place(), short(&names[k])), problem, advice)
                })?;
                columns.values[attribute.index()].push(value);
            }
            Ok(())
        })?;
        self.columns = Some(columns);
        Ok(())
    }

    fn faces(&mut self, element: &Element, corners: usize) -> Result<()> {
        let is_strips = element.name == "tristrips";
        let others = element.properties.iter().enumerate().filter(|(k, _)| *k != corners);
        self.passed.extend(others.map(|(_, p)| format!("{} of {}", p.name, element.name)));
        self.faces.noun = "face";
        let polygons = &mut self.faces.polygons;
        let (budget, name) = (self.budget, self.name);
        self.rows.each(element, Some(corners), |number, row, place| {
            let found = polygons.corners() + row.items.len();
            budget.within(&format!("{name}: corners of faces"), found, ("segments", budget.limits().segments * 4))?;
            if is_strips {
                return strips(&row.items, polygons, place);
            }
            let index = |item: f64| u32::try_from(item as i64).map_err(|_| negative(item, place));
            let corners = row.items.iter().map(|item| index(*item)).collect::<Result<Vec<_>>>()?;
            polygons.push(number, corners);
            Ok(())
        })
    }

    fn finish(mut self, header: &Header) -> Result<Geometry> {
        let Some(columns) = self.columns.take().filter(|columns| !columns.values[0].is_empty()) else {
            let names = list(header.elements.iter().map(|e| &e.name));
            let problem = format!("no vertex; the elements are: {names}");
            return Err(Error::input(self.name, problem, "give a file with an element vertex"));
        };
        let mut geometry = columns.into_geometry(self.name, self.budget)?;
        if self.faces.polygons.len() > 0 {
            self.add_faces(&mut geometry)?;
        }
        let mut warn = |message: String, advice: &str| {
            geometry.warnings.push(Warning::new(format!("{}: {message}", self.name), advice));
        };
        if !self.passed.is_empty() {
            warn(format!("passed over: {}", list(&self.passed)), "nothing need be done if they do not matter");
        }
        if let Some(left) = self.rows.left_over() {
            warn(format!("{left} behind the last element are passed over"), "correct the counts in the header");
        }
        Ok(geometry)
    }

    fn add_faces(&mut self, geometry: &mut Geometry) -> Result<()> {
        let faces = std::mem::take(&mut self.faces);
        let Cloud::Space(points) = &geometry.points else {
            let message = format!("{}: faces of points without z are left out", self.name);
            geometry.warnings.push(Warning::new(message, "add a property z, such as 0 everywhere"));
            return Ok(());
        };
        let cut = faces.polygons.triangles((self.name, faces.noun), &points.positions, self.budget)?;
        geometry.triangles = cut.triangles;
        geometry.warnings.extend(cut.warnings);
        Ok(())
    }
}

/// What stands for a full colour: the largest number of a type without sign, one for fractions.
fn full_colour(kind: Scalar) -> Option<f64> {
    kind.full_colour().or((!kind.is_whole()).then_some(1.0))
}

fn negative(item: f64, place: &dyn Fn() -> String) -> Error {
    Error::input(place(), format!("vertex {item} where 0, 1, ... was expected"), "correct the number of the vertex")
}

/// Strips of triangles, parted by -1: each further vertex makes one with the two before it, every other one turned around.
fn strips(items: &[f64], polygons: &mut Polygons, place: &dyn Fn() -> String) -> Result<()> {
    for strip in items.split(|item| *item == -1.0) {
        let indices = strip.iter().map(|&item| u32::try_from(item as i64).map_err(|_| negative(item, place)));
        let indices = indices.collect::<Result<Vec<_>>>()?;
        for (k, corners) in indices.windows(3).enumerate() {
            let [a, b, c] = [corners[0], corners[1], corners[2]];
            // A repeated vertex turns the strip; it is no face.
            if a != b && b != c && c != a {
                polygons.push(polygons.len(), if k % 2 == 0 { [a, b, c] } else { [b, a, c] });
            }
        }
    }
    Ok(())
}
