//! Textures of reliefs: points, normals, height fields.

use crate::case::{Case, DONE, EITHER, REFUSED, USAGE};

/// A sheet of `side` by `side` points with these ends of their rows.
fn sheet(side: usize, end: impl Fn(usize) -> String) -> String {
    let row = |k: usize| {
        let (x, y) = (k % side, k / side);
        let z = 0.4 * ((x * 7 % 10) as f64 * 0.6).sin() * ((y * 3 % 10) as f64 * 0.6).cos();
        format!("{x} {y} {z:.3}{}\n", end(k))
    };
    (0..side * side).map(row).collect()
}

fn xyz(name: &str, text: impl Into<Vec<u8>>, codes: &'static [i32]) -> Case {
    Case::new(name, "relief in.xyz --extent 50x40 -o out.ply", codes).with("in.xyz", text)
}

/// A gray picture of 16 bits.
fn heights(width: u32, height: u32, value: impl Fn(u32) -> u16) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let data: Vec<u8> = (0..width * height).flat_map(|k| value(k).to_be_bytes()).collect();
    encoder.write_header().unwrap().write_image_data(&data).unwrap();
    bytes
}

fn png_case(name: &str, bytes: Vec<u8>, codes: &'static [i32]) -> Case {
    Case::new(name, "relief in.png --extent 60x60 --height-field -o out.png", codes).with("in.png", bytes)
}

/// Refused, as an option that does not suit or as a file that does not.
const TOLD: &[i32] = &[2, 3, 4];

pub(crate) fn cases() -> Vec<Case> {
    let up = |_: usize| " 0 0 1".to_owned();
    let mut cases = vec![
        xyz("a sheet with normals", sheet(40, up), DONE),
        xyz("a sheet without normals", sheet(40, |_| String::new()), EITHER),
        xyz("normals of no length", sheet(40, |_| " 0 0 0".into()), EITHER),
        xyz("one normal of no length", sheet(40, |k| if k == 99 { " 0 0 0".into() } else { up(k) }), EITHER),
        xyz("normals that are not numbers", sheet(40, |_| " nan 0 1".into()), REFUSED),
        xyz("normals that face both ways", sheet(40, |k| format!(" 0 0 {}", if k % 2 == 0 { 1 } else { -1 })), REFUSED),
        xyz("normals along the plane", sheet(40, |_| " 1 0 0".into()), EITHER),
        xyz("normals of 1e300", sheet(40, |_| " 0 0 1e300".into()), EITHER),
        xyz("all points in one place", "1 1 1 0 0 1\n".repeat(5000), REFUSED),
        xyz("points at two places", "1 1 1 0 0 1\n2 2 1 0 0 1\n".repeat(3000), EITHER),
        xyz("points on a line", (0..3000).map(|k| format!("{k} 0 0 0 0 1\n")).collect::<String>(), REFUSED),
        xyz("a far point", sheet(40, up) + "1e9 3 0 0 0 1\n", TOLD),
        xyz("a point at 1e154", sheet(40, up) + "1e154 3 0 0 0 1\n", TOLD),
        xyz("a point that is high", sheet(40, up) + "3 3 1e6 0 0 1\n", TOLD),
        xyz("nothing", "", REFUSED),
        xyz("zeros", vec![0_u8; 4000], REFUSED),
        png_case("a height field of waves", heights(64, 64, |k| ((k % 8) * 4000 + k / 64 % 8 * 3000) as u16), DONE),
        png_case("a flat height field", heights(64, 64, |_| 700), REFUSED),
        png_case("a height field of noise", heights(64, 64, |k| (k.wrapping_mul(2_654_435_761) >> 16) as u16), EITHER),
        png_case("a height field of one pixel", heights(1, 1, |_| 7), REFUSED),
        png_case("a height field of one row", heights(4000, 1, |k| k as u16), TOLD),
        png_case("half a height field", heights(64, 64, |k| k as u16)[..100].to_vec(), REFUSED),
    ];
    let good = sheet(40, up);
    for (options, codes) in [
        ("--extent 1e9x1e9", REFUSED),
        ("--extent 0x5", TOLD),
        ("--extent nanx5", TOLD),
        ("--extent 50x40 --patch 1e-9", EITHER),
        ("--extent 50x40 --patch 1e9", TOLD),
        ("--extent 50x40 --set cell=1e-9", TOLD),
        ("--extent 50x40 --set pairs=2000 --set stiffness=0", EITHER),
        ("--extent 50x40 --set tries=1000 --set reach=0.5", EITHER),
        ("--extent 50x40 --set border=0 --set overlap=0.5", EITHER),
        ("--extent 3x3 --tile", TOLD),
        ("--extent 50x40 --limit work=1 --limit work-per-element=1", EITHER),
        ("--extent 50x40 --limit memory=100000", TOLD),
        ("--extent 50x40 --time-limit 1ms", EITHER),
        ("--extent 50x40 --box 1,2,3", USAGE),
        ("--fill-hole", REFUSED),
        ("--fill-hole --extent 5x5", USAGE),
    ] {
        let line = format!("relief in.xyz {options} -o out.ply");
        cases.push(Case::new(format!("a relief with {options}"), line, codes).with("in.xyz", good.clone()));
    }
    for (name, mesh) in [
        ("a mesh without a surface", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
        ("a mesh of nothing", "v 0 0 0\n"),
        ("a tiny mesh", "v 0 0 0\nv 1e-6 0 0\nv 0 1e-6 0\nf 1 2 3\n"),
    ] {
        let case = Case::new(name, "relief in.xyz --on m.obj -o out.ply", EITHER);
        cases.push(case.with("in.xyz", good.clone()).with("m.obj", mesh));
    }
    cases
}
