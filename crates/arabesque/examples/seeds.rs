//! Three pages from one exemplar, which is analysed once: `cargo run -p arabesque --example seeds`.

use arabesque::{Fill, Input, OutputOptions, Recipe, Resources, Unobserved};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let recipe = Recipe::new(Input::file("examples/autumn.svg"), Fill::page("400x300".parse()?));
    let prepared = recipe.prepare(&Resources::default())?;
    for seed in 0..3 {
        let artwork = prepared.run(&prepared.request().with_seed(seed), &mut Unobserved)?;
        std::fs::write(format!("autumn-{seed}.svg"), artwork.encode(&OutputOptions::default())?.bytes)?;
    }
    Ok(())
}
