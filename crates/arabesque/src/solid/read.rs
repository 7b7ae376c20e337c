//! Points and meshes as inputs.

use arabesque_core::{PointSet, Result, TriangleMesh, Warning};
use arabesque_io::geometry::{Cloud, Geometry, Kind, kind_of, read_geometry};
use arabesque_surface::MeshIndex;

use crate::{recipe::Input, resources::Files, solid::scene::scene_of};

/// The points of a file, with normals only where all of them have a length, and what is to be told of it.
pub(crate) fn cloud(name: &str, bytes: &[u8], files: &Files) -> Result<(Cloud, Vec<Warning>)> {
    let Geometry { mut points, zero_normals, mut warnings, .. } = read_geometry(name, bytes, files.budget())?;
    if zero_normals > 0 {
        let dropped = match &mut points {
            Cloud::Plane(points) => points.normals.take().map(|n| n.len()),
            Cloud::Space(points) => points.normals.take().map(|n| n.len()),
        };
        warnings.push(Warning::new(
            format!(
                "{name}: {zero_normals} of {} normals have no length: none of them is used",
                dropped.unwrap_or_default()
            ),
            "write the points again with all their normals, or without",
        ));
    }
    Ok((points, warnings))
}

/// The points of a file in space; those of the plane lie at height 0.
pub(crate) fn raised(points: Cloud) -> PointSet<3> {
    match points {
        Cloud::Space(points) => points,
        Cloud::Plane(points) => {
            let up = |v: arabesque_core::Vector<2>| arabesque_core::Vector([v[0], v[1], 0.0]);
            let PointSet { positions, normals, colours, radii, groups, elements, classes } = points;
            PointSet {
                positions: positions.into_iter().map(up).collect(),
                normals: normals.map(|list| list.into_iter().map(up).collect()),
                colours,
                radii,
                groups,
                elements,
                classes,
            }
        }
    }
}

/// The mesh of a file that a request reads; the file is embedded.
pub(crate) fn mesh(input: &mut Input, files: &Files) -> Result<(TriangleMesh, Vec<Warning>)> {
    let bytes = files.embed(input)?;
    let name = input.name();
    let mut found = match kind_of(name, &bytes) {
        // What a glTF file names lies beside it.
        Some(Kind::Glb) => scene_of(input, &bytes, files)?.into_geometry(name),
        _ => read_geometry(name, &bytes, files.budget())?,
    };
    let warnings = std::mem::take(&mut found.warnings);
    Ok((found.into_mesh(input.name())?, warnings))
}

/// The same, prepared for questions.
pub(crate) fn indexed_mesh(input: &mut Input, files: &Files) -> Result<(MeshIndex, Vec<Warning>)> {
    let (mesh, warnings) = mesh(input, files)?;
    Ok((MeshIndex::new(&mesh, input.name(), files.budget())?, warnings))
}
