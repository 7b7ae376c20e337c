//! JSON: points with attributes and triangles.

use arabesque_core::{Budget, Decimals, Held, PointSet, Result, TriangleMesh, Vector, Warning};
use serde::Serialize;

use crate::json::warning::{WarningRecord, warning_records};

/// Work and bytes of one point or triangle, roughly.
const PER_ROW: u64 = 2000;
const ROW_BYTES: usize = 400;
/// What sets the decimals of directions and of shares of colours.
const DIRECTION: f64 = 10.0;
const SHARE: f64 = 100.0;

#[derive(Serialize)]
struct File<'a> {
    generator: &'static str,
    version: &'static str,
    count: usize,
    bounds: Option<[Vec<f64>; 2]>,
    positions: Vec<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    normals: Option<Vec<Vec<f64>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    colours: Option<Vec<Vec<f64>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    radii: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    groups: Option<&'a [i32]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    elements: Option<&'a [i32]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    classes: Option<&'a [i32]>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    triangles: &'a [[u32; 3]],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    parts: Vec<PartRecord<'a>>,
    warnings: Vec<WarningRecord<'a>>,
    stopped: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    recipe: Option<&'a str>,
}

#[derive(Serialize)]
struct PartRecord<'a> {
    name: &'a str,
    triangles: [usize; 2],
}

/// What a file says beside points and triangles.
#[derive(Clone, Copy, Debug)]
pub struct Report<'a> {
    /// What the user should know.
    pub warnings: &'a [Warning],
    /// Why the run ended: `finished`, `early` or `limit`.
    pub stopped: &'a str,
    /// The recipe, as TOML.
    pub recipe: Option<&'a str>,
}

/// Writes points with all their attributes as one JSON object of lists, with six significant digits of their extent.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work or the memory is used up, [`arabesque_core::Error::Stopped`] when somebody asked to
/// stop.
pub fn write_cloud<const D: usize>(points: &PointSet<D>, report: &Report<'_>, budget: &Budget) -> Result<String> {
    let _held = room(points.len(), budget)?;
    let digits = Digits::of(points.bounds().size());
    let file = File {
        radii: points.radii.as_ref().map(|radii| radii.iter().map(|r| digits.place.plus(2).round(*r)).collect()),
        groups: points.groups.as_deref(),
        elements: points.elements.as_deref(),
        classes: points.classes.as_deref(),
        normals: points.normals.as_ref().map(|list| rows(list.iter().map(|n| n.0), digits.direction)),
        colours: points.colours.as_ref().map(|list| rows(list.iter().copied(), digits.share)),
        ..file(&points.positions, digits, report)
    };
    text(&file)
}

/// Writes a mesh: its vertices as points, its triangles as three numbers of vertices each, counted from 0, and its parts as the first
/// triangle of each and the one behind its last.
///
/// # Errors
/// As [`write_cloud`].
pub fn write_mesh(mesh: &TriangleMesh, report: &Report<'_>, budget: &Budget) -> Result<String> {
    let _held = room(mesh.positions.len().saturating_add(mesh.triangles.len()), budget)?;
    let digits = Digits::of(mesh.bounds().size());
    let part = |part: &'_ arabesque_core::MeshPart| [part.triangles.start, part.triangles.end];
    let file = File {
        normals: mesh.normals.as_ref().map(|list| rows(list.iter().map(|n| n.0), digits.direction)),
        colours: mesh.colours.as_ref().map(|list| rows(list.iter().copied(), digits.share)),
        triangles: &mesh.triangles,
        parts: mesh.parts.iter().map(|p| PartRecord { name: &p.name, triangles: part(p) }).collect(),
        ..file(&mesh.positions, digits, report)
    };
    text(&file)
}

#[derive(Clone, Copy)]
struct Digits {
    place: Decimals,
    direction: Decimals,
    share: Decimals,
}

impl Digits {
    fn of<const D: usize>(size: Vector<D>) -> Self {
        let extent = size.0.into_iter().fold(0.0, f64::max);
        let [place, direction, share] = [extent, DIRECTION, SHARE].map(Decimals::for_extent);
        Self { place: place.plus(1), direction, share }
    }
}

fn rows<const N: usize>(list: impl Iterator<Item = [f64; N]>, decimals: Decimals) -> Vec<Vec<f64>> {
    list.map(|row| row.iter().map(|v| decimals.round(*v)).collect()).collect()
}

fn file<'a, const D: usize>(positions: &[Vector<D>], digits: Digits, report: &Report<'a>) -> File<'a> {
    let bounds = arabesque_core::Bounds::around(positions.iter().copied());
    let corner = |v: Vector<D>| v.0.iter().map(|c| digits.place.round(*c)).collect();
    File {
        generator: "arabesque",
        version: env!("CARGO_PKG_VERSION"),
        count: positions.len(),
        bounds: (!bounds.is_empty()).then(|| [corner(bounds.min), corner(bounds.max)]),
        positions: rows(positions.iter().map(|p| p.0), digits.place),
        normals: None,
        colours: None,
        radii: None,
        groups: None,
        elements: None,
        classes: None,
        triangles: &[],
        parts: Vec::new(),
        warnings: warning_records(report.warnings),
        stopped: report.stopped,
        recipe: report.recipe,
    }
}

/// Work and memory for so many points and triangles.
fn room(rows: usize, budget: &Budget) -> Result<Held> {
    budget.spend(PER_ROW.saturating_mul(rows as u64))?;
    budget.hold("the text of the result", rows.saturating_mul(ROW_BYTES))
}

fn text(file: &File<'_>) -> Result<String> {
    let text = serde_json::to_string(file)
        .map_err(|e| arabesque_core::Error::input("result", e.to_string(), "report this together with the exemplar"))?;
    Ok(laid_out(&text))
}

/// One line for each entry of the object: lists of numbers are long enough without a line for each number.
fn laid_out(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 256);
    let (mut depth, mut quoted, mut escaped) = (0_usize, false, false);
    for c in text.chars() {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => quoted = !quoted,
            '{' | '[' if !quoted => depth += 1,
            '}' | ']' if !quoted => depth -= 1,
            _ => {}
        }
        if c == '}' && depth == 0 && !quoted {
            out.push('\n');
        }
        out.push(c);
        match c {
            '{' | ',' if depth == 1 && !quoted => out.push_str("\n  "),
            ':' if depth == 1 && !quoted => out.push(' '),
            _ => {}
        }
    }
    out + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::json::recipe_of;

    #[test]
    fn points_say_what_they_have() {
        let mut points = PointSet::at(vec![Vector::xy(0.123_456_789, 0.0), Vector::xy(1.0, 2.0)]);
        points.groups = Some(vec![3, 4]);
        let warnings = [Warning::new("a \"bracket\" }", "none")];
        let report = Report { warnings: &warnings, stopped: "finished", recipe: Some("seed = 3\n") };
        let text = write_cloud(&points, &report, &Budget::default()).unwrap();
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(value["positions"][0], serde_json::json!([0.123457, 0.0]));
        assert_eq!((&value["groups"], &value["normals"]), (&serde_json::json!([3, 4]), &serde_json::Value::Null));
        assert_eq!(value["bounds"][1], serde_json::json!([1.0, 2.0]));
        assert_eq!(value["warnings"][0]["message"], "a \"bracket\" }");
        assert!(text.starts_with("{\n  \"generator\": \"arabesque\",\n") && text.ends_with("\n}\n"), "{text}");
        assert_eq!(recipe_of(&text).unwrap(), "seed = 3\n");
    }

    #[test]
    fn meshes_have_triangles_and_parts() {
        let mesh = TriangleMesh {
            positions: vec![Vector([0.0; 3]), Vector([1.0, 0.0, 0.0]), Vector([0.0, 1.0, 0.0])],
            triangles: vec![[0, 1, 2]],
            parts: vec![arabesque_core::MeshPart { name: "lid".into(), triangles: 0..1 }],
            ..TriangleMesh::default()
        };
        let report = Report { warnings: &[], stopped: "early", recipe: None };
        let text = write_mesh(&mesh, &report, &Budget::default()).unwrap();
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(value["triangles"], serde_json::json!([[0, 1, 2]]));
        assert_eq!(value["parts"][0], serde_json::json!({ "name": "lid", "triangles": [0, 1] }));
    }
}
