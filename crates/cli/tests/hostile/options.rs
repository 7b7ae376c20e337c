//! Options with values that make no sense.

use crate::case::{Case, DONE, NOTHING, USAGE, dots_and};

/// What odd values may end with.
const ANY: &[i32] = &[0, 1, 2, 3, 4];

fn fill(options: &str, codes: &'static [i32]) -> Case {
    Case::new(options, format!("fill in.svg -o out.svg {options}"), codes).with("in.svg", dots_and(""))
}

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = vec![
        fill("--size 90x90", DONE),
        fill("--size 1x1", NOTHING),
        fill("--size 1e-9x1e-9", ANY),
        fill("--size 90x90 --limit pixel=7", USAGE),
        fill("--size 90x90 --limit pixels", USAGE),
        fill("--size 90x90 --limit memory=-1", USAGE),
        fill("--size 90x90 --limit elements=5", &[3]),
        fill("--size 1900x1900 --set repeat=off --limit memory=1048576", &[3]),
        // To continue a repeat takes next to no memory.
        fill("--size 90x90 --limit memory=1048576", &[0, 3]),
        fill("--size 90x90 --threads 0", USAGE),
        fill("--size 90x90 --threads 100000", USAGE),
        fill("--size 90x90 --seed -1", USAGE),
        fill("--size 90x90 --variations 0", USAGE),
        fill("--size 90x90 --format doc", USAGE),
        fill("--size 90x90 --dpi 0 --format png", ANY),
        fill("--size 90x90 --dpi 1e9 --format png", ANY),
        fill("--size 90x90 --pixels-per-unit nan --format png", ANY),
        fill("--size 1000x1000 --pixels-per-unit 40 --format png", ANY),
        fill("--size 90x90 --format obj", ANY),
        fill("--size 90x90 --format glb", ANY),
        fill("--size 90x90 --tile 90x90", USAGE),
    ];
    let sides = [
        "0x0",
        "0x9",
        "-1x9",
        "nanx9",
        "infx9",
        "1e5x1e5",
        "1e9x1e9",
        "1e308x1e308",
        "1e309x1",
        "9",
        "x",
        "9x9x9",
        "9mmx9",
        "9furlongx9",
        "1e9x1e-9",
        "90x",
        "9e",
    ];
    for side in sides {
        cases.push(fill(&format!("--size {side}"), ANY));
        cases.push(fill(&format!("--tile {side}"), ANY));
    }
    for cuboid in ["5x5", "0x5x5", "1e9x1e9x1e9", "nanx5x5", "5x5x5", "1e-9x5x5", "1e308x1e308x1e308"] {
        cases.push(fill(&format!("--box {cuboid}"), ANY));
        let csv: String = (0..125).map(|k| format!("{},{},{}\n", k % 5, k / 5 % 5, k / 25)).collect();
        let line = format!("fill in.csv -o out.csv --box {cuboid}");
        cases.push(Case::new(format!("points in a box {cuboid}"), line, ANY).with("in.csv", csv));
    }
    for region in [
        "0,0,9,9",
        "0,0,0,0",
        "9,9,-9,-9",
        "nan,0,9,9",
        "1e9,1e9,9,9",
        "-1e9,-1e9,2e9,2e9",
        "1e308,0,1e308,9",
        "#none",
        "0,0,9",
        "x",
    ] {
        cases.push(fill(&format!("--redo {region}"), ANY));
        cases.push(fill(&format!("--from {region} --to 20,20,60,60"), ANY));
    }
    for value in ["0", "-1", "nan", "inf", "1e-9", "1e9", "1e308", "x", "none.png", "in.svg"] {
        for field in ["orient", "scale", "density"] {
            cases.push(fill(&format!("--size 90x90 --{field} {value}"), ANY));
        }
        cases.push(fill(&format!("--size 90x90 --radius {value}"), ANY));
    }
    cases
}
