//! Edits of a recipe, made to what its run made.

use arabesque_core::{Budget, Error, Result};

use super::{
    elements::{AnyChanges, Elements},
    resolve::resolve,
};
use crate::recipe::{Edit, Format, Recipe};

/// What the edits of a recipe come to.
#[derive(Debug)]
pub(crate) struct Replayed {
    /// One after the other.
    pub(crate) changes: Vec<AnyChanges>,
}

/// Works out what the edits of a recipe come to for what its run made, which `encode` gives as a file of any format. The edits are made
/// to that file, as they were when they were recorded.
pub(crate) fn replay(recipe: &Recipe, encode: impl Fn(Format) -> Result<Vec<u8>>, budget: &Budget) -> Result<Replayed> {
    let mut replayed = Replayed { changes: Vec::new() };
    let mut file: Option<(Format, Vec<u8>)> = None;
    for (number, edit) in recipe.edits.iter().enumerate() {
        let format = edit.on.unwrap_or_else(|| usual(recipe));
        let bytes = match file.take() {
            Some((known, bytes)) if known == format => bytes,
            _ => replayed.apply(encode(format)?, format, recipe, budget)?,
        };
        let elements = Elements::open("the result of the run", &bytes, format, Some(recipe), budget)?;
        check(edit, number, &elements)?;
        let changes = match &elements {
            Elements::Plane(file) => resolve(edit, file.layout(), budget).map(|r| AnyChanges::Plane(r.changes)),
            Elements::Space(file) => resolve(edit, file.layout(), budget).map(|r| AnyChanges::Space(r.changes)),
        };
        let changes = changes.map_err(|error| in_edit(number, error))?;
        file = Some((format, elements.rewritten(&changes, None, budget)?));
        replayed.changes.push(changes);
    }
    Ok(replayed)
}

impl Replayed {
    /// A file of any format that can be edited, with all edits.
    pub(crate) fn apply(&self, bytes: Vec<u8>, format: Format, recipe: &Recipe, budget: &Budget) -> Result<Vec<u8>> {
        let mut bytes = bytes;
        for changes in &self.changes {
            let elements = Elements::open("the result of the run", &bytes, format, Some(recipe), budget)?;
            bytes = elements.rewritten(changes, None, budget)?;
        }
        Ok(bytes)
    }
}

/// The format in which edits are made where they do not say.
fn usual(recipe: &Recipe) -> Format {
    let can_be_edited = |f: &Format| matches!(f, Format::Svg | Format::Json | Format::Csv | Format::Glb);
    recipe.output.format.filter(can_be_edited).unwrap_or_else(|| recipe.usual_format())
}

/// Refuses to edit another result than the one that was edited.
fn check(edit: &Edit, number: usize, elements: &Elements) -> Result<()> {
    let Some(of) = &edit.of else { return Ok(()) };
    if *of == elements.fingerprint() {
        return Ok(());
    }
    Err(Error::input(
        format!("edit {} of the recipe", number + 1),
        "made to another result than this run made: the seed, the size, a file, the version or a time limit differs",
        "leave the edits out (--no-edits) and make them again, or remove the line `of` to make them anyhow",
    ))
}

/// The same error, which says in which edit.
fn in_edit(number: usize, error: Error) -> Error {
    match error {
        Error::Parameter { name, value, expected } => {
            Error::Parameter { name: format!("edit {} of the recipe: {name}", number + 1), value, expected }
        }
        other => other,
    }
}
