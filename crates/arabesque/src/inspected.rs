//! Exemplars of every kind, inspected.

use arabesque_core::Result;

use crate::{
    inspect::{Report, of_other, of_scene},
    recipe::{Input, Reading},
    resources::Resources,
    space::scene_understood,
};

/// Reads an exemplar and says what was understood.
///
/// # Errors
/// Those of reading it: a file that is not there, broken, beyond a limit, or no exemplar.
pub fn inspect(input: &Input, reading: impl Into<Reading>, resources: &Resources) -> Result<Report> {
    let bytes = resources.read(input)?;
    match scene_understood(input, &bytes, resources)? {
        Some(scene) => Ok(of_scene(input, scene)),
        None => of_other(input, &bytes, reading, resources),
    }
}
