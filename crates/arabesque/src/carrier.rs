//! Files that carry a recipe.

use arabesque_core::{Error, Result};
use arabesque_io::{csv, file, json, obj, png, svg};

use crate::{Format, Recipe};

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
    let text = file::decode_text(name, bytes)?;
    let start = text.trim_start();
    let (found, what) = if start.starts_with('<') {
        (svg::recipe_of(&text), "a drawing")
    } else if start.starts_with('{') {
        (json::recipe_of(&text), "a JSON file")
    } else if Format::of_path(name).ok().flatten() == Some(Format::Csv) || start.starts_with("x,y,") {
        (csv::recipe_of(&text), "a file of points")
    } else if Format::of_path(name).ok().flatten() == Some(Format::Obj) || start.starts_with("# curves as polylines") {
        (obj::recipe_of(&text), "a file of curves")
    } else {
        return Recipe::from_toml(name, &text);
    };
    Recipe::from_toml(name, &found.ok_or_else(|| missing(what))?)
}
