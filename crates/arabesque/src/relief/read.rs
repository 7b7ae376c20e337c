//! Reliefs as inputs: points, meshes, height fields.

use arabesque_core::{Budget, Error, PointSet, Result, Warning};
use arabesque_io::{
    geometry::{Cloud, read_geometry},
    raster::png::is_png,
};
use arabesque_surface::{MeshIndex, scatter};

use crate::{relief::heights, solid::read::raised};

/// Points that a mesh becomes, about.
const SAMPLES: f64 = 20_000.0;

/// What was read.
pub(super) struct Found {
    pub(super) points: PointSet<3>,
    /// In words.
    pub(super) kind: &'static str,
    pub(super) warnings: Vec<Warning>,
    /// Side of a pixel, of a height field.
    pub(super) pixel: Option<f64>,
}

/// Reads a relief; `height` is that of a height field.
pub(super) fn texture(name: &str, bytes: &[u8], height: Option<f64>, budget: &Budget) -> Result<Found> {
    if is_png(bytes) {
        let points = heights::points(name, bytes, height, budget)?;
        return Ok(Found { points, kind: "of a height field", warnings: Vec::new(), pixel: Some(1.0) });
    }
    if let Some(height) = height {
        return Err(Error::parameter("height", height, "a height field (PNG) as the texture, or nothing"));
    }
    let mut found = read_geometry(name, bytes, budget)?;
    let warnings = std::mem::take(&mut found.warnings);
    if found.is_mesh() {
        let mesh = found.into_mesh(name)?;
        let index = MeshIndex::new(&mesh, name, budget)?;
        let spacing = (index.area() / SAMPLES).sqrt();
        if !(spacing.is_finite() && spacing > 0.0) {
            return Err(Error::input(name, "a mesh whose triangles have no area", "give a mesh with a surface"));
        }
        let feet = scatter(&index, spacing, 0, budget)?;
        let colours = mesh.colours.as_ref().map(|colours| {
            let of = |at: &arabesque_surface::Closest| {
                let corners = mesh.triangles[at.triangle].map(|v| colours[v as usize]);
                std::array::from_fn(|c| (0..3).map(|k| corners[k][c] * at.barycentric[k]).sum())
            };
            feet.iter().map(of).collect()
        });
        let points = PointSet {
            positions: feet.iter().map(|f| f.point).collect(),
            normals: Some(feet.iter().map(|f| f.normal).collect()),
            colours,
            ..PointSet::default()
        };
        return Ok(Found { points, kind: "of a mesh", warnings, pixel: None });
    }
    let points = match found.points {
        Cloud::Space(points) => points,
        flat @ Cloud::Plane(_) => raised(flat),
    };
    if found.zero_normals > 0 {
        let problem = format!("{} of {} normals have no length", found.zero_normals, points.len());
        let advice = "write the points again with all their normals, or without, so that they are estimated";
        return Err(Error::input(name, problem, advice));
    }
    let kind = if points.normals.is_some() { "with normals" } else { "a scan without normals" };
    Ok(Found { points, kind, warnings, pixel: None })
}
