//! Files that carry a recipe.

use arabesque_core::{Error, Result};
use arabesque_io::{
    file, json,
    mesh::{
        gltf,
        obj::{self, strips},
    },
    raster::png,
    svg,
    table::csv,
};

use crate::recipe::{Format, Recipe};

/// Finds the recipe in a file: a TOML recipe, or a result in any format.
///
/// The format of a result becomes the format of the recipe's output.
///
/// # Errors
/// [`Error::Input`] when the file carries none, or a broken one.
pub fn recipe_in(name: &str, bytes: &[u8]) -> Result<Recipe> {
    let missing = |what: &str| {
        Error::input(name, format!("{what} without a recipe"), "give a recipe (TOML) or a result of arabesque")
    };
    if png::is_png(bytes) {
        return Recipe::from_toml(name, &png::recipe_of(bytes).ok_or_else(|| missing("a picture"))?);
    }
    if gltf::is_glb(bytes) {
        return Recipe::from_toml(name, &gltf::recipe_of(bytes).ok_or_else(|| missing("a mesh"))?);
    }
    let text = file::decode_text(name, bytes)?;
    let start = text.trim_start();
    let (found, what) = if start.starts_with('<') {
        (svg::recipe_of(&text), "a drawing")
    } else if start.starts_with('{') {
        (json::recipe_of(&text), "a JSON file")
    } else if Format::of_path(name).ok().flatten() == Some(Format::Csv) || start.starts_with("x,y,") {
        (csv::recipe_of(&text), "a file of points")
    } else if Format::of_path(name).ok().flatten() == Some(Format::Obj)
        || ["# curves as polylines", strips::TITLE].iter().any(|title| start.starts_with(title))
    {
        (obj::recipe_of(&text), "a file of curves")
    } else {
        return Recipe::from_toml(name, &text);
    };
    Recipe::from_toml(name, &found.ok_or_else(|| missing(what))?)
}
