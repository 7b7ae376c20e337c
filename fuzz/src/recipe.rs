//! Feeds recipes, and results that carry one, to those who look for them; a recipe that holds all it reads is prepared and run.
#![no_main]

use arabesque::{Carrier, OutputOptions, Recipe, Resources, Unobserved, carried_recipe, is_result, recipe_in};
use arabesque_fuzz::limits;
use libfuzzer_sys::fuzz_target;

/// The name may tell the format.
const NAMES: [&str; 4] = ["fuzz.toml", "fuzz.csv", "fuzz.obj", "-"];

fuzz_target!(|data: &[u8]| {
    let name = NAMES[data.len() % NAMES.len()];
    let _ = is_result(data);
    let (recipe, carrier) = match carried_recipe(name, data) {
        Ok(found) => found,
        Err(error) => return assert!(error.to_string().len() < 3000, "a message without end: {error}"),
    };
    assert!(carrier == Carrier::Recipe || data.len() > 20);
    let Ok(text) = recipe.to_toml() else { return };
    // Numbers that are none are equal to nothing.
    let again = recipe_in("again.toml", text.as_bytes()).unwrap_or_else(|e| panic!("{e}: {text}"));
    assert_eq!(again.to_toml().ok(), Some(text));
    if recipe.inputs().iter().all(|(_, input)| input.content.is_some()) {
        run(&recipe);
    }
});

/// Reads no file: the recipe holds them all.
fn run(recipe: &Recipe) {
    let resources = Resources { limits: limits(), ..Resources::default() };
    let Ok(prepared) = recipe.prepare(&resources) else { return };
    let Ok(artwork) = prepared.run(&prepared.request(), &mut Unobserved) else { return };
    let output = OutputOptions { path: None, ..recipe.output.clone() };
    let Ok(file) = artwork.encode(&output) else { return };
    assert!(output.bare || recipe_in("result", &file.bytes).is_ok());
}
