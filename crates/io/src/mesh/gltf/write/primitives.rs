//! The primitives of meshes and points of a GLB file.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Error, PointSet, Result, TriangleMesh, Vector};
use serde_json::{Value, json};

use super::{buffer::Buffer, looks::LooksOut};
use crate::mesh::{
    colour::linear,
    scene::{Primitive, SceneMesh},
};

/// Work of one vertex and of one triangle.
const PER_VERTEX: u64 = 200;
/// Mode of points in the format.
const POINTS: u32 = 0;
/// Largest whole number up to which floats hold all of them.
const WHOLE: i32 = 1 << 24;

/// The primitives of a mesh: those that it has, or one with the colours of its vertices.
pub(super) fn primitives_of(
    mesh: &SceneMesh,
    buffer: &mut Buffer,
    looks: &mut LooksOut<'_>,
    budget: &Budget,
) -> Result<Vec<Value>> {
    let count = mesh.mesh.positions.len() + mesh.mesh.triangles.len();
    budget.spend(PER_VERTEX.saturating_mul(count as u64))?;
    if !fit(mesh, looks.materials()) {
        let mut attributes = geometry(&mesh.mesh, 0..mesh.mesh.positions.len(), buffer);
        if let Some(colours) = &mesh.mesh.colours {
            attributes["COLOR_0"] = buffer.vectors(&floats(colours.iter().map(|c| c.map(linear))), false).into();
        }
        let indices = buffer.indices(&mesh.mesh.triangles);
        return Ok(vec![json!({ "attributes": attributes, "indices": indices, "material": looks.plain() })]);
    }
    let mut known: BTreeMap<usize, Value> = BTreeMap::new();
    let mut records = Vec::new();
    for primitive in mesh.primitives.iter().filter(|p| !p.triangles.is_empty()) {
        let first = primitive.vertices.start;
        let attributes = match known.get(&first) {
            Some(known) => known.clone(),
            None => {
                let mut attributes = geometry(&mesh.mesh, primitive.vertices.clone(), buffer);
                looks_of(primitive, &mut attributes, buffer);
                known.entry(first).or_insert(attributes).clone()
            }
        };
        let own: Vec<[u32; 3]> =
            mesh.mesh.triangles[primitive.triangles.clone()].iter().map(|t| t.map(|v| v - first as u32)).collect();
        let indices = buffer.indices(&own);
        let material = looks.material(primitive.material);
        records.push(json!({ "attributes": attributes, "indices": indices, "material": material }));
    }
    Ok(records)
}

/// Whether the primitives of a mesh are runs of all its triangles with materials that exist and what their vertices need.
fn fit(mesh: &SceneMesh, materials: usize) -> bool {
    let (vertices, triangles) = (mesh.mesh.positions.len(), &mesh.mesh.triangles);
    let mut next = 0;
    for p in &mesh.primitives {
        let starts = std::mem::replace(&mut next, p.triangles.end);
        if p.triangles.start != starts || p.triangles.end < starts || p.vertices.end > vertices {
            return false;
        }
        if p.material.is_some_and(|m| m >= materials) {
            return false;
        }
        let Some(own) = triangles.get(p.triangles.clone()) else { return false };
        let inside = |v: &u32| p.vertices.contains(&(*v as usize));
        let a = &p.attributes;
        let mut lengths = [a.uv[0].len(), a.uv[1].len(), a.tangents.len(), a.colours.len()].into_iter();
        if !own.iter().flatten().all(inside) || !lengths.all(|n| n == 0 || n == p.vertices.len()) {
            return false;
        }
    }
    !mesh.primitives.is_empty() && next == triangles.len()
}

/// Places and normals of a run of vertices.
fn geometry(mesh: &TriangleMesh, run: std::ops::Range<usize>, buffer: &mut Buffer) -> Value {
    let places = floats(mesh.positions[run.clone()].iter().map(|p| p.0));
    let mut attributes = json!({ "POSITION": buffer.vectors(&places, true) });
    if let Some(normals) = mesh.normals.as_ref().and_then(|normals| normals.get(run)) {
        attributes["NORMAL"] = buffer.vectors(&units(normals), false).into();
    }
    attributes
}

/// What a primitive has beside places and normals.
fn looks_of(primitive: &Primitive, attributes: &mut Value, buffer: &mut Buffer) {
    let own = &primitive.attributes;
    for (name, uv) in ["TEXCOORD_0", "TEXCOORD_1"].into_iter().zip(&own.uv).filter(|(_, uv)| !uv.is_empty()) {
        attributes[name] = buffer.vectors(uv, false).into();
    }
    // Tangents mean nothing without normals.
    if !own.tangents.is_empty() && attributes.get("NORMAL").is_some() {
        let tangent = |&[x, y, z, w]: &[f32; 4]| {
            let unit = Vector([x, y, z].map(f64::from)).unit_or_zero();
            let [x, y, z] = if unit == Vector::ZERO { [1.0, 0.0, 0.0] } else { unit.0.map(|c| c as f32) };
            [x, y, z, if w < 0.0 { -1.0 } else { 1.0 }]
        };
        attributes["TANGENT"] = buffer.vectors(&own.tangents.iter().map(tangent).collect::<Vec<_>>(), false).into();
    }
    if !own.colours.is_empty() {
        // Floats may lie in a range of their own; the format has shares.
        let colours: Vec<[f32; 4]> = own.colours.iter().map(|c| c.map(|v| v.clamp(0.0, 1.0))).collect();
        attributes["COLOR_0"] = buffer.vectors(&colours, false).into();
    }
}

/// The primitive of points.
pub(super) fn points_of(
    points: &PointSet<3>,
    buffer: &mut Buffer,
    looks: &mut LooksOut<'_>,
    budget: &Budget,
) -> Result<Value> {
    budget.spend(PER_VERTEX.saturating_mul(points.len() as u64))?;
    let mut attributes = json!({ "POSITION": buffer.vectors(&floats(points.positions.iter().map(|p| p.0)), true) });
    if let Some(normals) = &points.normals {
        attributes["NORMAL"] = buffer.vectors(&floats(normals.iter().map(|n| n.0)), false).into();
    }
    if let Some(colours) = &points.colours {
        attributes["COLOR_0"] = buffer.vectors(&floats(colours.iter().map(|c| c.map(linear))), false).into();
    }
    if let Some(radii) = &points.radii {
        attributes["_RADIUS"] = buffer.scalars(&radii.iter().map(|r| *r as f32).collect::<Vec<_>>()).into();
    }
    for (name, labels) in [("_GROUP", &points.groups), ("_ELEMENT", &points.elements), ("_CLASS", &points.classes)] {
        let Some(labels) = labels else { continue };
        if let Some(label) = labels.iter().find(|l| l.unsigned_abs() > WHOLE.unsigned_abs()) {
            let what = format!("{name} {label} in a GLB file, which holds floats,");
            return Err(Error::Unsupported { what, advice: "number them up to 16777216, or write PLY".into() });
        }
        attributes[name] = buffer.scalars(&labels.iter().map(|l| *l as f32).collect::<Vec<_>>()).into();
    }
    Ok(json!({ "attributes": attributes, "mode": POINTS, "material": looks.plain() }))
}

fn floats(values: impl Iterator<Item = [f64; 3]>) -> Vec<[f32; 3]> {
    values.map(|v| v.map(|c| c as f32)).collect()
}

/// Normals at length 1 as floats; those without a length point up.
fn units(normals: &[Vector<3>]) -> Vec<[f32; 3]> {
    let unit = |n: &Vector<3>| Some(n.unit_or_zero()).filter(|n| *n != Vector::ZERO).unwrap_or(Vector([0.0, 1.0, 0.0]));
    floats(normals.iter().map(|n| unit(n).0))
}
