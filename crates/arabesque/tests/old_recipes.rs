//! Results of earlier programs carry recipes in the flat form; they repeat to the byte.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, its helpers too")]

use std::{fs, path::Path};

use arabesque::{Job, OutputOptions, Recipe, Resources, Unobserved, recipe_in};

/// Files that the program wrote when recipes were flat, and the fingerprints of the results without their recipes, as
/// today's engine makes them.
const WRITTEN: &[(&str, &str)] = &[
    ("fill.svg", "ca5c6e05e9019226"),
    ("tile.png", "882cbe263a5d7cb2"),
    ("redo.svg", "ab9786d32452fc7e"),
    ("copy.svg", "cffbeab4e203bb21"),
    ("space.csv", "8bb97305a8e24b53"),
    ("size.json", "b0c9c14facf9ee82"),
    ("ribbon.svg", "199e8ef39136a227"),
    ("ribbon.obj", "7789fbe36f607f80"),
];

/// FNV-1a, 64 bits.
fn fingerprint(bytes: &[u8]) -> String {
    let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3));
    format!("{hash:016x}")
}

fn folder() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recipes")
}

fn recipe(name: &str) -> Recipe {
    recipe_in(name, &fs::read(folder().join(name)).unwrap()).unwrap()
}

#[test]
fn results_with_flat_recipes_repeat_to_the_byte() {
    for (name, expected) in WRITTEN {
        let recipe = recipe(name);
        // Everything that is needed travels in the file: no folder is given.
        let prepared = recipe.prepare(&Resources::default()).unwrap();
        let artwork = prepared.run(&prepared.request(), &mut Unobserved).unwrap();
        let bare = OutputOptions { bare: true, ..recipe.output.clone() };
        assert_eq!(fingerprint(&artwork.encode(&bare).unwrap().bytes), *expected, "{name}");
        // The recipe that is written now is one of today, and means the same.
        let written = artwork.recipe(&recipe.output).to_toml().unwrap();
        assert_eq!(Recipe::from_toml("again", &written).unwrap().job, artwork.recipe(&recipe.output).job, "{name}");
    }
}

#[test]
fn a_recipe_by_hand_in_the_flat_form_is_read() {
    let recipe = recipe("flat.toml");
    assert!(matches!(&recipe.job, Job::Fill(fill) if fill.params.set["matching"] == "hard"));
    let prepared = recipe.prepare(&Resources::beside(folder())).unwrap();
    let artwork = prepared.run(&prepared.request(), &mut Unobserved).unwrap();
    assert_eq!((artwork.seed(), artwork.summary().elements > 8), (8, true));
}
