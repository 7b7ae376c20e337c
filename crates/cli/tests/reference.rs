//! Pictures of whole runs, compared with those under `reference`. `ARABESQUE_BLESS=1` replaces them.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod common;

use std::path::Path;

use common::{Folder, example, pixels};

/// A pixel differs when a channel is off by more than this.
const TOLERANCE: u8 = 32;

fn compare(name: &str, line: &str) {
    let folder = Folder::new();
    folder.ok(&format!("fill {line} --seed 1 --no-recipe -o {name}.png"));
    let made = folder.read(&format!("{name}.png"));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference").join(format!("{name}.png"));
    if std::env::var_os("ARABESQUE_BLESS").is_some() {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, &made).unwrap();
        return;
    }
    let known =
        std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}; make it with ARABESQUE_BLESS=1", path.display()));
    let (a, b) = (pixels(&made), pixels(&known));
    assert_eq!((a.0, a.1), (b.0, b.1), "{name}: another size");
    let differs = |(p, q): &(&[u8], &[u8])| p.iter().zip(*q).any(|(x, y)| x.abs_diff(*y) > TOLERANCE);
    let count = a.2.chunks_exact(4).zip(b.2.chunks_exact(4)).filter(differs).count();
    if count * 1000 > a.2.len() / 4 {
        let beside = std::env::temp_dir().join(format!("arabesque-{name}.png"));
        std::fs::write(&beside, &made).unwrap();
        panic!(
            "{name}: {count} of {} pixels differ; see {}, and bless it if it is right",
            a.2.len() / 4,
            beside.display()
        );
    }
}

#[test]
fn page() {
    compare("page", &format!("{} --size 240x180 --dpi 64", example("autumn.svg")));
}

#[test]
fn heart() {
    compare("heart", &format!("{} --domain {} --dpi 32", example("cherries.svg"), example("heart.svg")));
}

#[test]
fn tile() {
    compare("tile", &format!("{} --tile 160x160 --dpi 64", example("birds.svg")));
}

#[test]
fn flow() {
    compare("flow", &format!("{} --size 240x240 --orient 35 --dpi 48", example("feathers.svg")));
}

#[test]
fn points() {
    compare("points", "points.csv --size 1x1 --dpi 48");
}

#[test]
fn net() {
    compare("net", &format!("{} --size 200x150 --dpi 64", example("quatrefoil.svg")));
}

#[test]
fn lace() {
    compare("lace", &format!("{} --domain {} --border turn --dpi 24", example("lace.svg"), example("heart.svg")));
}

#[test]
fn basket() {
    compare("basket", &format!("{} --tile 120x120 --dpi 64", example("basket.svg")));
}

/// Pictures of ordinary drawings, made as the gallery makes them, on small pages.
fn ordinary(names: &[(&str, &str)]) {
    for (name, options) in names {
        compare(name, &format!("{} {options} --dpi 96", example(&format!("{name}.svg"))));
    }
}

#[test]
fn tiles_that_touch() {
    ordinary(&[
        ("quilt", "--size 130x100"),
        ("bricks", "--size 130x100 --border inside"),
        ("beehive", "--size 130x100"),
        ("cubes", "--size 130x100 --orient 30"),
    ]);
}

#[test]
fn things_over_one_another() {
    ordinary(&[("scales", "--size 130x100"), ("lattice", "--size 130x100 --border clip")]);
}

#[test]
fn bands_through_the_frame() {
    ordinary(&[("tartan", "--size 200x150"), ("waves", "--size 200x150"), ("zigzag", "--tile auto")]);
}

#[test]
fn cells_and_swatches() {
    ordinary(&[("truchet", "--tile 105x90"), ("azulejo", "--tile auto")]);
}

#[test]
fn icons_of_loose_strokes() {
    ordinary(&[("doodles", "--size 200x150")]);
}
