//! Whole runs of the methods that `fill` does not reach: ribbons, structures, reliefs, surfaces, and elements in space, each on a small
//! exemplar that is made of the bytes.
//!
//! With `FUZZ_SHOW` in the environment each recipe is printed, to be repeated by the program.
#![no_main]

use std::fmt::Write as _;

use arabesque::{
    Border, Cuboid, Direction, Format, Input, Job, OutputOptions, Physics, Recipe, Relief, Resources, Ribbon, Size, Space,
    Structures, Surface, Unobserved, recipe_in,
};
use arabesque_fuzz::{drawn, limits};
use libfuzzer_sys::{
    arbitrary::{Result, Unstructured},
    fuzz_target,
};

/// A tetrahedron as an OBJ mesh.
const PIECE: &str = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 4\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

fuzz_target!(|data: &[u8]| {
    let mut u = Unstructured::new(data);
    let Ok(recipe) = recipe(&mut u) else { return };
    if std::env::var_os("FUZZ_SHOW").is_some() {
        eprintln!("{}", recipe.to_toml().unwrap_or_default());
    }
    let first = made(&recipe);
    if data.len() % 8 == 0 {
        assert!(first == made(&recipe), "two runs give two results");
    }
});

fn made(recipe: &Recipe) -> Option<Vec<u8>> {
    let resources = Resources { limits: limits(), ..Resources::default() };
    let prepared = recipe.prepare(&resources).ok()?;
    let artwork = prepared.run(&prepared.request(), &mut Unobserved).ok()?;
    let bytes = artwork.encode(&recipe.output).ok()?.bytes;
    let again = recipe_in("result", &bytes).unwrap_or_else(|e| panic!("the result carries no recipe: {e}"));
    assert_eq!(again.job.name(), recipe.job.name());
    Some(bytes)
}

fn recipe(u: &mut Unstructured<'_>) -> Result<Recipe> {
    let (name, text, job, format) = match u.int_in_range(0..=4u8)? {
        0 => ("e.svg", drawn::drawing(u)?, Job::from(ribbon(u)?), Format::Svg),
        1 => ("e.csv", points(u)?, Job::from(structures(u)?), Format::Ply),
        2 => ("e.xyz", sheet(u)?, Job::from(relief(u)?), *u.choose(&[Format::Ply, Format::Obj, Format::Png])?),
        3 => ("e.xyz", sheet(u)?, Job::from(Surface::default()), Format::Ply),
        _ => ("e.obj", scene(u)?, Job::from(space(u)?), *u.choose(&[Format::Glb, Format::Obj, Format::Usda])?),
    };
    let mut recipe = Recipe::new(Input::file(name).embedding(text.as_bytes()), job);
    recipe.seed = u.arbitrary::<u8>()?.into();
    recipe.output = OutputOptions { format: Some(format), ..OutputOptions::default() };
    Ok(recipe)
}

fn embedded(name: &str, text: &str) -> Input {
    Input::file(name).embedding(text.as_bytes())
}

fn number(u: &mut Unstructured<'_>) -> Result<f64> {
    Ok(drawn::number(u)?.parse().unwrap_or(1.0))
}

fn size(u: &mut Unstructured<'_>) -> Result<Option<Size>> {
    Ok(format!("{}x{}", drawn::number(u)?, drawn::number(u)?).parse().ok())
}

fn ribbon(u: &mut Unstructured<'_>) -> Result<Ribbon> {
    let mut ribbon = Ribbon::new(embedded("c.svg", &drawn::drawing(u)?));
    ribbon.scale = if u.arbitrary()? { Some(number(u)?) } else { None };
    ribbon.relax = u.arbitrary()?;
    Ok(ribbon)
}

fn structures(u: &mut Unstructured<'_>) -> Result<Structures> {
    let mut job = Structures::default();
    match u.int_in_range(0..=4u8)? {
        0 => job.along = Some(embedded("c.obj", &polyline(u)?)),
        1 => job.on = Some(embedded("m.obj", &mesh(u)?)),
        2 => job.inside = Some(embedded("m.obj", &mesh(u)?)),
        3 => job.size = size(u)?,
        _ => job.cuboid = Some(cuboid(u)?),
    }
    job.mesh = u.ratio(1, 4u8)?;
    Ok(job)
}

fn relief(u: &mut Unstructured<'_>) -> Result<Relief> {
    let mut job = Relief::default();
    match u.int_in_range(0..=5u8)? {
        0 => job.fill_hole = true,
        1 => job.on = Some(embedded("m.obj", &mesh(u)?)),
        _ => job.extent = size(u)?,
    }
    job.tile = u.ratio(1, 4u8)?;
    job.mesh = u.ratio(1, 4u8)?;
    Ok(job)
}

fn space(u: &mut Unstructured<'_>) -> Result<Space> {
    let mut job = Space::new(cuboid(u)?);
    match u.int_in_range(0..=4u8)? {
        0 => job = Space::along(embedded("c.obj", &polyline(u)?)),
        1 => job = Space::on(embedded("m.obj", &mesh(u)?)),
        2 => job = Space::inside(embedded("m.obj", &mesh(u)?)),
        _ => {}
    }
    job.floor = u.ratio(1, 3u8)?;
    if job.on.is_some() && u.arbitrary()? {
        job.direction = Some(Direction::parse("0,1,0"));
    }
    if u.ratio(1, 4u8)? {
        job.physics = Some(Physics::Settle);
    }
    job.border = if u.arbitrary()? { u.choose(Border::NAMES)?.parse().ok() } else { None };
    Ok(job)
}

fn cuboid(u: &mut Unstructured<'_>) -> Result<Cuboid> {
    Ok(Cuboid([number(u)?, number(u)?, number(u)?]))
}

/// Points of a grid that is bent by a few bytes, with normals at times.
fn sheet(u: &mut Unstructured<'_>) -> Result<String> {
    let (side, bumps, normals) = (u.int_in_range(3..=24usize)?, u.arbitrary::<[u8; 4]>()?, u.arbitrary::<bool>()?);
    let mut text = String::new();
    for k in 0..side * side {
        let (x, y) = (k % side, k / side);
        let z = (f64::from(bumps[(x + 2 * y) % 4]) / 128.0).sin();
        write(&mut text, format_args!("{x} {y} {z}"));
        text.push_str(if normals { " 0 0 1\n" } else { "\n" });
    }
    for _ in 0..u.int_in_range(0..=3u8)? {
        write(&mut text, format_args!("{} {} {}\n", drawn::number(u)?, drawn::number(u)?, drawn::number(u)?));
    }
    Ok(text)
}

/// Points with normals, and groups or radii.
fn points(u: &mut Unstructured<'_>) -> Result<String> {
    let extra = *u.choose(&["", ",group", ",radius", ",element"])?;
    let mut text = format!("x,y,z,nx,ny,nz{extra}\n");
    for _ in 0..u.int_in_range(8..=50u8)? {
        let at = [(); 3].map(|()| f64::from(u.arbitrary::<u8>().unwrap_or(7)) / 64.0);
        write(&mut text, format_args!("{},{},{},0,0,1", at[0], at[1], at[2]));
        if !extra.is_empty() {
            write(&mut text, format_args!(",{}", u.int_in_range(0..=3u8)?));
        }
        text.push('\n');
    }
    Ok(text)
}

/// A line through a few places.
fn polyline(u: &mut Unstructured<'_>) -> Result<String> {
    let (mut text, count) = (String::new(), u.int_in_range(2..=6u8)?);
    for _ in 0..count {
        write(&mut text, format_args!("v {} {} {}\n", drawn::number(u)?, drawn::number(u)?, drawn::number(u)?));
    }
    text.push('l');
    (1..=count).for_each(|k| write(&mut text, format_args!(" {k}")));
    text.push('\n');
    Ok(text)
}

/// A tetrahedron whose corners and faces a few bytes have changed.
fn mesh(u: &mut Unstructured<'_>) -> Result<String> {
    if u.arbitrary()? {
        return Ok(PIECE.replace('4', "30"));
    }
    let mut text = String::new();
    let count = u.int_in_range(3..=8u8)?;
    for _ in 0..count {
        write(&mut text, format_args!("v {} {} {}\n", drawn::number(u)?, drawn::number(u)?, drawn::number(u)?));
    }
    for _ in 0..u.int_in_range(1..=8u8)? {
        let corner = [(); 3].map(|()| u.int_in_range(1..=count).unwrap_or(1));
        write(&mut text, format_args!("f {} {} {}\n", corner[0], corner[1], corner[2]));
    }
    Ok(text)
}

/// Small things here and there.
fn scene(u: &mut Unstructured<'_>) -> Result<String> {
    let mut text = String::new();
    for k in 0..u.int_in_range(2..=24usize)? {
        let at = [(); 3].map(|()| f64::from(u.arbitrary::<u8>().unwrap_or(9)) / 8.0);
        let thin = f64::from(u.int_in_range(0..=16u8)?) / 8.0;
        write(&mut text, format_args!("o thing{k}\n"));
        for corner in [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, thin]] {
            let p: Vec<f64> = corner.iter().zip(at).map(|(c, a)| c + a).collect();
            write(&mut text, format_args!("v {} {} {}\n", p[0], p[1], p[2]));
        }
        for face in [[1, 3, 2], [1, 2, 4], [2, 3, 4], [1, 4, 3]].map(|face| face.map(|v| v + 4 * k)) {
            write(&mut text, format_args!("f {} {} {}\n", face[0], face[1], face[2]));
        }
    }
    Ok(text)
}

fn write(text: &mut String, what: std::fmt::Arguments<'_>) {
    text.write_fmt(what).expect("a text takes whatever is written to it");
}
