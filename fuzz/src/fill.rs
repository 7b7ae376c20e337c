//! Whole runs through the door of the library, on small exemplars that are made of the bytes: recipe, preparation, run, file.
//!
//! With `FUZZ_SHOW` in the environment each recipe is printed, to be repeated by the program.
#![no_main]

use std::{collections::BTreeMap, ops::ControlFlow};

use arabesque::{
    Artwork, Border, Cuboid, FieldFile, FieldSource, Fill, Format, Input, Job, Method, OutputOptions, Progress, Recipe,
    Redo, Region, Resources, Size, Space, Tile, Watch, core::options::Kind, patterns::Params, recipe_in,
};
use arabesque_fuzz::{check, drawn, limits};
use libfuzzer_sys::{
    arbitrary::{Result, Unstructured},
    fuzz_target,
};

fuzz_target!(|data: &[u8]| {
    let mut u = Unstructured::new(data);
    let Ok((recipe, steps)) = recipe(&mut u) else { return };
    if std::env::var_os("FUZZ_SHOW").is_some() {
        eprintln!("{}", recipe.to_toml().unwrap_or_default());
    }
    let first = made(&recipe, steps);
    if data.len() % 8 == 0 {
        assert!(first == made(&recipe, steps), "two runs give two results");
    }
});

/// Stops a run after so many steps, and takes a preview of the last one.
struct Stop(usize);

impl Watch<Artwork> for Stop {
    fn step(&mut self, _: &Progress, preview: &dyn Fn() -> Artwork) -> ControlFlow<()> {
        self.0 = self.0.saturating_sub(1);
        if self.0 > 0 {
            return ControlFlow::Continue(());
        }
        let _ = preview().summary();
        ControlFlow::Break(())
    }
}

fn made(recipe: &Recipe, steps: usize) -> Option<Vec<u8>> {
    let resources = Resources { limits: limits(), ..Resources::default() };
    let prepared = recipe.prepare(&resources).ok()?;
    let artwork = prepared.run(&prepared.request(), &mut Stop(steps)).ok()?;
    let summary = artwork.summary();
    // What is expected is held to the limit; elements that the engine adds may come on top.
    assert!(summary.elements <= 2 * limits().output_elements, "far more elements than allowed");
    let bytes = artwork.encode(&recipe.output).ok()?.bytes;
    let again = recipe_in("result", &bytes).unwrap_or_else(|e| panic!("the result carries no recipe: {e}"));
    assert_eq!(again.job.name(), recipe.job.name());
    if recipe.output.format == Some(Format::Svg) {
        check::markup(std::str::from_utf8(&bytes).unwrap_or_default());
    }
    Some(bytes)
}

/// A recipe that holds its exemplar, and after how many steps its run is stopped.
fn recipe(u: &mut Unstructured<'_>) -> Result<(Recipe, usize)> {
    let kind = u.int_in_range(0..=11u8)?;
    let steps = if u.ratio(1, 4u8)? { u.int_in_range(1..=20)? } else { usize::MAX };
    let (job, format) = match kind {
        0 => (Job::from(space(u)?), Format::Obj),
        1 => (Job::from(redo(u)?), Format::Svg),
        _ => (Job::from(fill(u)?), *u.choose(&[Format::Svg, Format::Svg, Format::Json, Format::Png])?),
    };
    let seed = u.arbitrary::<u8>()?.into();
    let expand = u.ratio(1, 4u8)?;
    let (name, text) = match (&job, kind) {
        (Job::Space(_), _) => ("e.obj", curves(u)?),
        (_, 2) => ("e.csv", points(u)?),
        _ => ("e.svg", drawn::drawing(u)?),
    };
    let mut recipe = Recipe::new(Input::file(name).embedding(text.as_bytes()), job);
    recipe.seed = seed;
    recipe.output = OutputOptions { format: Some(format), expand, ..OutputOptions::default() };
    Ok((recipe, steps))
}

fn size(u: &mut Unstructured<'_>) -> Result<Option<Size>> {
    let side = |u: &mut Unstructured<'_>| -> Result<f64> {
        Ok(if u.ratio(1, 20u8)? {
            drawn::number(u)?.parse().unwrap_or(1.0)
        } else {
            f64::from(u.int_in_range(1..=150u8)?)
        })
    };
    Ok(format!("{}x{}", side(u)?, side(u)?).parse().ok())
}

fn fill(u: &mut Unstructured<'_>) -> Result<Fill> {
    let mut fill = Fill { border: border(u)?, method: method(u)?, ..Fill::default() };
    match u.int_in_range(0..=6u8)? {
        0 => {}
        1 => fill.domain = Some(embedded("domain.svg", drawn::drawing(u)?)),
        2 | 3 => fill.tile = size(u)?.map(Tile::Of),
        _ => fill.size = size(u)?,
    }
    if u.ratio(1, 8u8)? {
        fill.keep = Some(embedded("keep.svg", drawn::drawing(u)?));
    }
    if u.ratio(1, 8u8)? {
        fill.avoid.push(embedded("avoid.svg", drawn::drawing(u)?));
    }
    if u.ratio(1, 8u8)? {
        let flow = embedded("flow.svg", drawn::drawing(u)?);
        fill.orient = Some(FieldSource::File(FieldFile { range: None, file: flow }));
    }
    fill.scale = constant(u)?;
    fill.density = constant(u)?;
    fill.params.set = parameters(u)?;
    Ok(fill)
}

fn redo(u: &mut Unstructured<'_>) -> Result<Redo> {
    let region = |u: &mut Unstructured<'_>| -> Result<Region> {
        let [x, y, w, h] = [(); 4].map(|()| u.arbitrary::<u8>().unwrap_or(9)).map(|n| f64::from(n) / 2.5);
        Ok(Region::Box([x, y, w + 1.0, h + 1.0]))
    };
    let mut redo = Redo { border: border(u)?, method: method(u)?, ..Redo::of(region(u)?) };
    if u.ratio(1, 3u8)? {
        redo.from = Some(region(u)?);
    }
    redo.scale = constant(u)?;
    redo.params.set = parameters(u)?;
    Ok(redo)
}

fn space(u: &mut Unstructured<'_>) -> Result<Space> {
    let sides = [(); 3].map(|()| u.int_in_range(1..=12u8).unwrap_or(3)).map(f64::from);
    let mut space = Space { border: border(u)?, method: method(u)?, ..Space::new(Cuboid(sides)) };
    space.params.set = parameters(u)?;
    Ok(space)
}

fn border(u: &mut Unstructured<'_>) -> Result<Option<Border>> {
    let name = u.choose(Border::NAMES)?;
    Ok(if u.arbitrary()? { name.parse().ok() } else { None })
}

fn method(u: &mut Unstructured<'_>) -> Result<Method> {
    Ok(*u.choose(&[Method::Auto, Method::Auto, Method::Elements, Method::Curves])?)
}

fn constant(u: &mut Unstructured<'_>) -> Result<Option<FieldSource>> {
    let value = match u.int_in_range(0..=19u8)? {
        0 => drawn::number(u)?.parse().unwrap_or(1.0),
        1..=4 => f64::from(u.int_in_range(1..=40u8)?) / 10.0,
        _ => return Ok(None),
    };
    Ok(Some(FieldSource::Constant(value)))
}

/// At most three parameters of the engine, anywhere in their ranges, mostly at the low end.
fn parameters(u: &mut Unstructured<'_>) -> Result<BTreeMap<String, String>> {
    let specs = Params::specs();
    let mut set = BTreeMap::new();
    for _ in 0..u.int_in_range(0..=3u8)? {
        let spec = u.choose(&specs)?;
        let value = match spec.kind {
            Kind::Choice(names) => (*u.choose(names)?).to_owned(),
            Kind::Switch => (*u.choose(&["off", "on"])?).to_owned(),
            Kind::Integer { min, max } => u.int_in_range(min..=max.min(min + 9))?.to_string(),
            Kind::Real { min, max } if u.ratio(1, 5u8)? => (if u.arbitrary()? { min } else { max }).to_string(),
            Kind::Real { min, max } => (f64::from(u.arbitrary::<u8>()?) / 32.0).clamp(min, max).to_string(),
            Kind::Text(_) => continue,
        };
        set.insert(spec.name.to_owned(), value);
    }
    Ok(set)
}

fn embedded(name: &str, text: String) -> Input {
    Input::file(name).embedding(text.as_bytes())
}

fn points(u: &mut Unstructured<'_>) -> Result<String> {
    let mut text = String::from("x,y,class\n");
    for _ in 0..u.int_in_range(1..=40u8)? {
        text += &format!("{},{},{}\n", drawn::number(u)?, drawn::number(u)?, u.int_in_range(0..=2u8)?);
    }
    Ok(text)
}

fn curves(u: &mut Unstructured<'_>) -> Result<String> {
    let mut text = String::new();
    let count = u.int_in_range(2..=30u8)?;
    for _ in 0..count {
        let at = [(); 3].map(|()| u.int_in_range(0..=20u8).unwrap_or(1)).map(|n| f64::from(n) / 4.0);
        text += &format!("v {} {} {}\n", at[0], at[1], at[2]);
    }
    for _ in 0..u.int_in_range(1..=12u8)? {
        text.push('l');
        for _ in 0..u.int_in_range(2..=5u8)? {
            text += &format!(" {}", u.int_in_range(1..=count)?);
        }
        text.push('\n');
    }
    Ok(text)
}
