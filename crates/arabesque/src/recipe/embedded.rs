//! Files that carry a recipe.

use arabesque_core::{Budget, Error, Result};
use arabesque_io::{
    file, json,
    mesh::{
        gltf,
        obj::{self, MATERIALS_TITLE, SCENE_TITLE, solid, strips},
        ply,
    },
    raster::png,
    svg,
    table::csv,
};

use crate::recipe::{Format, Recipe};

/// In the place of a recipe in pictures that have none, such as those of `inspect`: they are known as ours by it.
pub(crate) const NO_RECIPE: &str = "# drawn by arabesque, without a recipe\n";

/// What a recipe was found in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carrier {
    /// The file is the recipe.
    Recipe,
    /// A result, in whatever format, with the recipe inside it.
    Result,
}

/// Finds the recipe in a file: a TOML recipe, or a result in any format.
///
/// The format of a result becomes the format of the recipe's output.
///
/// # Errors
/// [`Error::Input`] when the file carries none, or a broken one.
pub fn recipe_in(name: &str, bytes: &[u8]) -> Result<Recipe> {
    carried_recipe(name, bytes).map(|(recipe, _)| recipe)
}

/// The same, with what it was found in.
///
/// # Errors
/// As [`recipe_in`].
pub fn carried_recipe(name: &str, bytes: &[u8]) -> Result<(Recipe, Carrier)> {
    let (found, what) = if png::is_png(bytes) {
        (png::recipe_of(bytes), "a picture")
    } else if gltf::is_glb(bytes) {
        (gltf::recipe_of(bytes), "a mesh")
    } else if ply::is_ply(bytes) {
        (ply::recipe_of(bytes), "a PLY file")
    } else {
        let text = file::decode_text(name, bytes, &Budget::default())?;
        let start = text.trim_start();
        let ending = Format::of_path(name).ok().flatten();
        let kind = file::called(text.as_bytes());
        if start.starts_with('<') && kind != file::HTML {
            (svg::recipe_of(&text), "a drawing")
        } else if start.starts_with('{') {
            if let Some(flaw) = json::broken::flaw(&text) {
                return Err(Error::input(name, flaw, "give the whole file, as it was written"));
            }
            (json::recipe_of(&text).or_else(|| gltf::recipe_of(text.as_bytes())), "a JSON file")
        } else if ending == Some(Format::Csv) || start.starts_with("x,y,") {
            (csv::recipe_of(&text), "a file of points")
        } else if ending == Some(Format::Usda) || start.starts_with("#usda") {
            (csv::recipe_of(&text), "a USD file")
        } else if ending == Some(Format::Obj) || is_of_curves(start.as_bytes()) {
            (obj::recipe_of(&text), "a file of curves")
        } else if ending == Some(Format::Json) || (kind != file::TOML && ending != Some(Format::Toml)) {
            let problem = format!("{kind}, where a recipe or a result was expected");
            return Err(Error::input(name, problem, "give a recipe (TOML) or a result of arabesque"));
        } else {
            return Ok((Recipe::from_toml(name, &text)?, Carrier::Recipe));
        }
    };
    let Some(found) = found.filter(|text| text != NO_RECIPE) else {
        let advice = "give a recipe (TOML) or a result of arabesque";
        return Err(Error::input(name, format!("{what} without a recipe"), advice));
    };
    Ok((Recipe::from_toml(name, &found)?, Carrier::Result))
}

/// Whether a file is something that arabesque wrote: a result or a picture with a recipe, a JSON, GLB or SVG file that names
/// arabesque as where it comes from, or a recipe as the program writes it, with its version and the fingerprint of its exemplar.
/// Points and pictures without a recipe do not say where they come from.
///
/// Only the marks are looked for, however large the file is; a broken one counts as well.
pub fn is_result(bytes: &[u8]) -> bool {
    let has = |mark: &str| contains(bytes, mark.as_bytes());
    let begins = |mark: &str| contains(&bytes[..bytes.len().min(HEAD)], mark.as_bytes());
    if png::is_png(bytes) {
        return has("iTXtarabesque recipe\0");
    }
    if ply::is_ply(bytes) {
        return begins("\ncomment arabesque recipe:\n");
    }
    if gltf::is_glb(bytes) {
        return begins("\"generator\":\"arabesque ") || has("\"arabesque recipe\":");
    }
    match bytes.trim_ascii_start() {
        [b'<', ..] => begins("xmlns:arabesque=\"urn:arabesque:1\"") || has("<arabesque:recipe"),
        [b'{', ..] => {
            let is_scene = gltf::is_gltf(bytes) && has("\"generator\":\"arabesque ");
            is_scene || begins("\"generator\": \"arabesque\"") || begins("{\"generator\":\"arabesque\"")
        }
        start @ [b'#', ..] => is_of_curves(start),
        [b'x', b',', ..] => has("\n# arabesque recipe:\n"),
        start => start.starts_with(b"arabesque = \"") && has("\n[exemplar]\npath = ") && has("\nhash = \""),
    }
}

/// Whether an OBJ file, or one of materials, begins as those of arabesque do.
fn is_of_curves(start: &[u8]) -> bool {
    ["# curves as polylines", strips::TITLE, solid::TITLE, SCENE_TITLE, MATERIALS_TITLE]
        .iter()
        .any(|title| start.starts_with(title.as_bytes()))
}

/// Bytes at the beginning of a file in which the marks of its kind stand.
const HEAD: usize = 4096;

fn contains(bytes: &[u8], mark: &[u8]) -> bool {
    // The first byte of a mark sorts nearly everything out.
    let Some((&first, _)) = mark.split_first() else { return true };
    let mut rest = bytes;
    while let Some(at) = rest.iter().position(|&b| b == first) {
        if rest[at..].starts_with(mark) {
            return true;
        }
        rest = &rest[at + 1..];
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_others_are_no_results() {
        for text in [
            "",
            "precious",
            "<svg xmlns='http://www.w3.org/2000/svg'/>",
            "<p>Every result has an element arabesque:recipe, as in xmlns:arabesque.</p>",
            "{\"generator\": \"another\"}",
            "x,y,class\n1,2,a\n",
            "# notes on arabesque\n",
            "exemplar = \"leaves.svg\"\n[fill]\nsize = \"80x80\"\n",
            "arabesque = \"0.1.0\"\nexemplar = \"leaves.svg\"\n",
            "\u{89}PNG\r\n",
        ] {
            assert!(!is_result(text.as_bytes()), "{text}");
        }
    }

    #[test]
    fn marks_are_found_wherever_they_are() {
        assert!(contains(b"aaab", b"aab") && contains(b"ab", b"") && contains(b"ab", b"ab"));
        assert!(!contains(b"ab", b"abc") && !contains(b"", b"a"));
    }
}
