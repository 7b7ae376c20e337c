//! `arabesque relief`: every ground, kind of input and of output, and what is refused.

#![allow(clippy::unwrap_used, reason = "tests fail by panicking, their helpers too")]

#[path = "../common/mod.rs"]
mod common;

use common::{Folder, example};
use serde_json::Value;

/// Bumps one apart over a square of 4 with normals, as a table; nothing where `keeps` does not hold.
fn bumps(keeps: impl Fn(f64, f64) -> bool) -> String {
    let mut text = String::from("x,y,z,nx,ny,nz\n");
    for k in 0..2304_u32 {
        let (x, y) =
            (f64::from(k % 48) / 12.0 + 0.01 * f64::from(k % 3), f64::from(k / 48) / 12.0 + 0.01 * f64::from(k % 5));
        let (a, b) = (x * std::f64::consts::TAU, y * std::f64::consts::TAU);
        if keeps(x, y) {
            let (dx, dy) =
                (0.15 * a.cos() * b.sin() * std::f64::consts::TAU, 0.15 * a.sin() * b.cos() * std::f64::consts::TAU);
            let z = 0.15 * a.sin() * b.sin();
            let length = (dx * dx + dy * dy + 1.0_f64).sqrt();
            text += &format!("{x:.4},{y:.4},{z:.4},{:.6},{:.6},{:.6}\n", -dx / length, -dy / length, 1.0 / length);
        }
    }
    text
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("bumps.csv", bumps(|_, _| true));
    folder
}

fn json(folder: &Folder, line: &str) -> Value {
    serde_json::from_slice(&folder.ok(line).stdout).unwrap()
}

#[test]
fn points_meshes_pictures_and_tables_come_out() {
    let folder = folder();
    for name in ["out.ply", "out.obj", "out.glb", "out.csv", "out.json", "out.png", "out.toml"] {
        folder.ok(&format!("relief bumps.csv --extent 5x4 -o {name}"));
    }
    let made = json(&folder, "relief bumps.csv --extent 5x4 -o again.ply --json");
    let (points, reliefs) = (&made["outputs"][0]["points"], &made["outputs"][0]["reliefs"]);
    assert!(points.as_u64().unwrap() > 2400 && reliefs["patches"].as_u64().unwrap() > 4, "{made}");
    assert!(reliefs["cracks"].as_u64().unwrap() * 20 < reliefs["overlapped"].as_u64().unwrap(), "{made}");
    assert_eq!(folder.read("out.ply"), folder.read("again.ply"), "the same seed gives the same bytes");
    folder.ok("run out.ply -o repeated.ply");
    assert_eq!(folder.read("out.ply"), folder.read("repeated.ply"));
    let mesh = json(&folder, "relief bumps.csv --extent 5x4 --mesh -o mesh.ply --json");
    assert!(mesh["outputs"][0]["triangles"].as_u64().unwrap() > 4000, "{mesh}");
    folder.ok("relief bumps.csv --extent 5x4 --seed 3 --variations 2 -o some.ply");
    assert_ne!(folder.read("some-1.ply"), folder.read("some-2.ply"));
}

#[test]
fn any_number_of_threads_writes_the_same() {
    let folder = folder();
    for threads in [1, 2, 8] {
        folder.ok(&format!("relief bumps.csv --extent 6x5 --tile --threads {threads} -o t{threads}.ply --no-recipe"));
    }
    assert!(folder.read("t1.ply") == folder.read("t2.ply") && folder.read("t1.ply") == folder.read("t8.ply"));
}

#[test]
fn heights_go_in_and_come_out_with_16_bits() {
    let folder = folder();
    folder.ok("relief bumps.csv --extent 5x4 --height-field -o heights.png");
    let (_, values) = heights(&folder.read("heights.png"));
    let levels: std::collections::BTreeSet<_> = values.into_iter().collect();
    assert!(levels.len() > 500, "{} heights", levels.len());
    folder.ok("relief heights.png --extent 140x120 --height 8 --height-field -o more.png");
    let more = folder.read("more.png");
    let reader = png::Decoder::new(std::io::Cursor::new(&more)).read_info().unwrap();
    assert_eq!((reader.info().width, reader.info().height), (140, 120), "a pixel is a unit");
    folder.ok("run more.png -o again.png");
    assert_eq!(folder.read("again.png"), more);
}

#[test]
fn gaps_are_filled_and_meshes_covered() {
    let folder = folder();
    folder.write("scan.csv", bumps(|x, y| (x - 2.0).hypot(y - 2.2) > 0.55));
    let made = json(&folder, "relief scan.csv --fill-hole -o whole.ply --json");
    let count = made["outputs"][0]["points"].as_u64().unwrap();
    assert!((2240..2370).contains(&count), "{made}");
    folder.write("floor.obj", "v 0 0 0\nv 6 0 0\nv 6 5 0\nv 0 5 0\nf 1 2 3\nf 1 3 4\n");
    let made = json(&folder, "relief bumps.csv --on floor.obj --direction 1,0,0 -o on.ply --json");
    let count = made["outputs"][0]["points"].as_u64().unwrap() as f64;
    assert!((count / 30.0 / 144.0 - 1.0).abs() < 0.2, "{made}");
}

#[test]
fn scans_without_normals_and_meshes_are_textures_too() {
    let folder = folder();
    let raw: String =
        bumps(|_, _| true).lines().skip(1).map(|l| l.split(',').take(3).collect::<Vec<_>>().join(" ") + "\n").collect();
    folder.write("raw.xyz", raw);
    folder.ok("relief raw.xyz --extent 5x4 -o raw.ply");
    folder.ok("relief bumps.csv --extent 4x4 --mesh -o mesh.obj");
    folder.ok("relief mesh.obj --extent 5x4 -o of-mesh.ply");
    folder.ok(&format!("relief {} --extent 1.2x1 -o wall.ply", example("relief-wall.ply")));
}

#[test]
fn what_is_odd_is_told() {
    let folder = folder();
    let raw: String =
        bumps(|_, _| true).lines().skip(1).map(|l| l.split(',').take(3).collect::<Vec<_>>().join(" ") + "\n").collect();
    folder.write("strays.xyz", raw + "1 1 1.5\n2 3 1.1\n3 1 -1.4\n");
    folder.write(
        "halves.csv",
        bumps(|_, _| true)
            .lines()
            .enumerate()
            .map(|(k, line)| match line.rsplit_once(',') {
                // The second half of the sheet faces down.
                Some((rest, z)) if k > 1152 => {
                    let turned: Vec<String> = rest
                        .split(',')
                        .enumerate()
                        .map(|(c, v)| if c > 2 { (-v.parse::<f64>().unwrap()).to_string() } else { v.to_owned() })
                        .collect();
                    format!("{},-{z}\n", turned.join(","))
                }
                _ => format!("{line}\n"),
            })
            .collect::<String>(),
    );
    let wide = |k: u32| (f64::from(k % 48) / 12.0, f64::from(k / 48) / 12.0);
    let chance = |k: u32| ((f64::from(k) * 12.9898).sin() * 43_758.545).rem_euclid(1.0);
    let hill = |k: u32, (x, y): (f64, f64)| {
        let (a, b, width) = (4.0 * chance(4 * k), 4.0 * chance(4 * k + 1), 0.15 + 0.45 * chance(4 * k + 2));
        0.4 * (chance(4 * k + 3) - 0.5) * (-((x - a).powi(2) + (y - b).powi(2)) / (width * width)).exp()
    };
    let height = |at: (f64, f64)| (0..25).map(|k| hill(k, at)).sum::<f64>();
    let hills: String = (0..2304).map(wide).map(|(x, y)| format!("{x} {y} {}\n", height((x, y)))).collect();
    folder.write("hills.xyz", hills);
    for (name, word) in [
        ("strays.xyz", "3 of 2307 points lie alone"),
        ("halves.csv", "normals face opposite ways"),
        ("hills.xyz", "does not repeat"),
    ] {
        let told = common::stderr(&folder.run(&format!("relief {name} --extent 4x3 -o {name}.ply")));
        assert!(told.contains(word), "{name}: {told}");
    }
}

#[test]
fn what_was_counted_is_told_as_json() {
    let folder = folder();
    let made = json(&folder, "relief bumps.csv --extent 6x6 -o all.ply --json");
    let reliefs = made["outputs"][0]["reliefs"].as_object().unwrap();
    for name in
        ["patches", "folds", "passed", "unbent", "overlapped", "by_ray", "by_projection", "seams", "cracks", "merged"]
    {
        assert!(reliefs[name].is_u64(), "{name}: {made}");
    }
    let n = |name: &str| reliefs[name].as_u64().unwrap();
    assert!(n("by_ray") + n("by_projection") > 0 && n("overlapped") > n("cracks") + n("seams"), "{made}");
}

/// Width, height and numbers of a gray picture with 16 bits.
fn heights(bytes: &[u8]) -> ([u32; 2], Vec<u16>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut values = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut values).unwrap();
    assert_eq!((info.bit_depth, info.color_type), (png::BitDepth::Sixteen, png::ColorType::Grayscale));
    ([info.width, info.height], values.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]])).collect())
}

/// Height fields of whole runs beside those under `reference`. `ARABESQUE_BLESS=1` replaces them.
#[test]
fn reliefs_look_as_they_did() {
    for (name, line) in [
        ("relief-dunes", "--extent 1.2x0.8 --seed 1"),
        ("relief-scales", "--extent 0.9x0.9 --tile --seed 1"),
        ("relief-bark", "--extent 1.1x0.8 --seed 2"),
    ] {
        let folder = folder();
        let texture = example(&format!("{name}.ply"));
        folder.ok(&format!("relief {texture} {line} --height-field --no-recipe -o out.png"));
        let made = folder.read("out.png");
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference").join(format!("{name}.png"));
        if std::env::var_os("ARABESQUE_BLESS").is_some() {
            std::fs::write(&path, &made).unwrap();
            continue;
        }
        let ((size, made), (known_size, known)) = (heights(&made), heights(&std::fs::read(&path).unwrap()));
        assert_eq!(size, known_size, "{name}");
        let off = made.iter().zip(&known).filter(|(a, b)| a.abs_diff(**b) > 2000).count();
        assert!(
            off * 100 <= made.len(),
            "{name}: {off} of {} heights differ; bless them if they are right",
            made.len()
        );
    }
}

#[test]
fn what_cannot_be_is_refused_with_what_to_do() {
    let folder = folder();
    folder.write("few.csv", "x,y,z\n0,0,0\n1,0,0\n0,1,0\n1,1,0.1\n");
    let normals = bumps(|_, _| true) + "1,1,0,0,0,nan\n";
    folder.write("nan.csv", normals);
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    folder.write("empty.obj", "v 0 0 0\nv 1 0 0\n");
    for (line, word) in [
        ("relief bumps.csv -o a.ply", "one of extent"),
        ("relief bumps.csv --extent 3mmx3mm -o a.ply", "plain numbers"),
        ("relief bumps.csv --extent 5x4 --patch 9 -o a.ply", "patch"),
        ("relief bumps.csv --extent 5x4 --plane x -o a.ply", "--plane"),
        ("relief bumps.csv --extent 5x4 --box 0,0,9,9 -o a.ply", "within the points"),
        ("relief bumps.csv --extent 5x4 --box 2,2,1,1 -o a.ply", "x0 below x1"),
        ("relief bumps.csv --extent 5x4 --height 3 -o a.ply", "height field"),
        ("relief bumps.csv --extent 0.5x4 --tile -o a.ply", "a tile of at least"),
        ("relief bumps.csv --fill-hole -o a.ply", "no gap"),
        ("relief bumps.csv --on empty.obj -o a.ply", "empty.obj"),
        ("relief bumps.csv --extent 5x4 -o a.svg", "svg"),
        ("relief few.csv --extent 5x4 -o a.ply", "4 points"),
        ("relief nan.csv --extent 5x4 -o a.ply", "nan.csv"),
        ("relief bumps.csv --extent 5x4 --set stifness=1 -o a.ply", "stiffness"),
        ("relief bumps.csv --extent 3000x3000 -o a.ply", "output-elements"),
    ] {
        let output = folder.run(line);
        let message = common::stderr(&output);
        assert!(!output.status.success() && message.contains(word), "{line}: {message}");
    }
}

/// A box that is `size` large, and half as much as that below and above 0.
fn block(size: [f64; 3]) -> String {
    let corner = |k: usize| [0, 1, 2].map(|i| if k >> i & 1 == 1 { 0.5 * size[i] } else { -0.5 * size[i] });
    let corners: String = (0..8).map(corner).map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    corners + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
}

#[test]
fn sharp_edges_of_meshes_are_rounded_but_for_those_of_foils() {
    let folder = folder();
    for (name, size, is_rounded) in [("cube", [6.0; 3], true), ("foil", [6.0, 6.0, 1e-3], false)] {
        folder.write(&format!("{name}.obj"), block(size));
        let run = folder.run(&format!("relief bumps.csv --on {name}.obj -o {name}.ply"));
        let told = common::stderr(&run);
        assert!(run.status.success() && told.contains("has sharp edges") == is_rounded, "{name}: {told}");
    }
}
