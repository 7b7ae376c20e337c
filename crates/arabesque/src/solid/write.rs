//! Points and meshes as files.

use arabesque_core::{Error, PointSet, Result, StopReason, TriangleMesh, Warning};
use arabesque_io::{
    json::geometry as json,
    mesh::{
        gltf::{self, Scene},
        obj,
        ply::{PlyFile, write_ply},
    },
    render::{Item, Look, write_picture_within},
    table::points,
};

use crate::{
    artwork::{Encoded, Sheet, draft},
    recipe::Format,
};

/// What is said in a file beside what was made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Said<'a> {
    pub(crate) warnings: &'a [Warning],
    pub(crate) stopped: StopReason,
}

impl<'a> Said<'a> {
    fn report(self, recipe: Option<&'a str>) -> json::Report<'a> {
        let stopped = match self.stopped {
            StopReason::Finished => "finished",
            StopReason::Stopped => "early",
            StopReason::Limit => "limit",
        };
        json::Report { warnings: self.warnings, stopped, recipe }
    }
}

/// Writes a mesh.
pub(crate) fn encode_mesh(mesh: &TriangleMesh, sheet: &Sheet<'_>, said: Said<'_>) -> Result<Encoded> {
    let (recipe, budget) = (sheet.recipe, sheet.budget);
    let bytes = match sheet.format {
        Format::Ply => write_ply(&PlyFile::of_mesh(mesh).with_recipe(recipe), budget)?,
        Format::Obj => obj::write_mesh(mesh, recipe, budget)?.into_bytes(),
        Format::Glb => gltf::write_scene(&Scene::of_mesh("surface", mesh), recipe, budget)?,
        Format::Json => json::write_mesh(mesh, &said.report(recipe), budget)?.into_bytes(),
        Format::Png => return picture(&[Item::Mesh(mesh)], sheet),
        Format::Svg | Format::Csv | Format::Gltf | Format::Usda | Format::Toml => {
            return Err(refused("a surface", sheet.format, "write ply, obj, glb, json or png"));
        }
    };
    Ok(Encoded { bytes, warnings: Vec::new(), companion: None })
}

/// Writes points; `item` is how they are drawn.
pub(crate) fn encode_points<const D: usize>(
    points: &PointSet<D>,
    item: Item<'_>,
    sheet: &Sheet<'_>,
    said: Said<'_>,
) -> Result<Encoded> {
    let (recipe, budget) = (sheet.recipe, sheet.budget);
    let mut warnings = Vec::new();
    let bytes = match sheet.format {
        Format::Ply => write_ply(&PlyFile::of_points(points).with_recipe(recipe), budget)?,
        Format::Obj | Format::Glb => {
            let Item::Points(points) = item else {
                return Err(refused("points in the plane", sheet.format, "write csv, json, ply or png"));
            };
            if sheet.format == Format::Glb {
                gltf::write_scene(&Scene::of_points(points.clone()), recipe, budget)?
            } else {
                let labels = [&points.groups, &points.elements, &points.classes];
                if points.radii.is_some() || labels.iter().any(|l| l.is_some()) {
                    let message = "an OBJ file holds no radii, groups, elements and classes of points: left out";
                    warnings.push(Warning::new(message, "write ply, csv or json"));
                }
                obj::write_cloud(points, recipe, budget)?.into_bytes()
            }
        }
        Format::Csv => points::write_table(points, recipe, budget)?.into_bytes(),
        Format::Json => json::write_cloud(points, &said.report(recipe), budget)?.into_bytes(),
        Format::Png => return picture(&[item], sheet),
        Format::Svg | Format::Gltf | Format::Usda | Format::Toml => {
            return Err(refused("points with attributes", sheet.format, "write ply, csv, obj, glb, json or png"));
        }
    };
    Ok(Encoded { bytes, warnings, companion: None })
}

/// A shaded picture.
pub(crate) fn picture(items: &[Item<'_>], sheet: &Sheet<'_>) -> Result<Encoded> {
    if sheet.output.dpi.is_some() || sheet.output.pixels_per_unit.is_some() {
        let what = "a resolution for a picture of what lies in space".into();
        return Err(Error::Unsupported { what, advice: "leave dpi and pixels-per-unit out".into() });
    }
    let view = sheet.output.view.as_deref().map(str::parse).transpose()?;
    let look = Look { view, ..Look::default() };
    let most = sheet.most_pixels(draft::SHADED);
    Ok(draft::told(write_picture_within(items, &look, most, sheet.recipe, sheet.budget)?))
}

/// A format that cannot hold what was made.
pub(crate) fn refused(what: &str, format: Format, advice: &str) -> Error {
    Error::Unsupported { what: format!("{what} as {}", format.name()), advice: advice.into() }
}
