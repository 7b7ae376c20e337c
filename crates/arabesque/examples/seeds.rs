//! Three pages from one exemplar, which is analysed once: `cargo run -p arabesque --example seeds`.

use arabesque::{Input, OutputOptions, Recipe, Unobserved};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut recipe = Recipe::new(Input::file("examples/autumn.svg"));
    recipe.size = Some("400x300".into());
    let prepared = recipe.prepare(None)?;
    for seed in 0..3 {
        let artwork = prepared.run(seed, &mut Unobserved)?;
        std::fs::write(format!("autumn-{seed}.svg"), artwork.encode(&OutputOptions::default())?.bytes)?;
    }
    Ok(())
}
