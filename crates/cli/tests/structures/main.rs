//! What is wrong with the files of structures: exemplars, meshes and curves. Each is a clear error, or told and mended; nothing is half written.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

#[path = "../common/mod.rs"]
mod common;

use std::fmt::Write;

use common::{Folder, stderr};

/// A PLY file of rows with these properties.
fn ply(properties: &str, rows: &[String]) -> String {
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {}\n", rows.len());
    for name in properties.split(' ') {
        let kind = if name == "element" { "int" } else { "float" };
        writeln!(text, "property {kind} {name}").unwrap();
    }
    format!("{text}end_header\n{}\n", rows.join("\n"))
}

/// A sheet of 144 points, each with something more behind its coordinates.
fn sheet(more: impl Fn(usize) -> String) -> Vec<String> {
    let at = |k: usize| [(k % 12) as f64 / 12.0, (k / 12) as f64 / 12.0, 0.02 * (k as f64).sin()];
    (0..144).map(|k| (at(k), more(k))).map(|([x, y, z], more)| format!("{x} {y} {z}{more}")).collect()
}

/// A box from 0 to 2 with the given faces.
fn cuboid(faces: &str) -> String {
    let corner = |k: u32| format!("v {} {} {}\n", (k & 1) * 2, (k >> 1 & 1) * 2, (k >> 2 & 1) * 2);
    (0..8).map(corner).collect::<String>() + faces
}

const FACES: &str = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

#[test]
fn exemplars_that_are_none_are_refused() {
    let folder = Folder::new();
    let good = ply("x y z", &sheet(|_| String::new()));
    let cut = good.trim_end().rsplit_once('\n').unwrap().0.to_owned();
    let normals = |bad: &'static str| {
        ply("x y z nx ny nz", &sheet(|k| if k == 7 { format!(" {bad} 0 1") } else { " 0 0 1".into() }))
    };
    for (name, text, expected) in [
        ("few", ply("x y z", &sheet(|_| String::new())[..9]), "9 points; give at least 10"),
        ("same", ply("x y z", &vec!["1 2 3".to_owned(); 40]), "all points lie in one place"),
        ("nan", normals("nan"), "property nx: NaN where a finite number was expected"),
        ("cut", cut, "the file ends before x"),
        ("count", good.replace("vertex 144", "vertex 900000000000"), "rows of element vertex where there is room for"),
        ("negative", good.replace("vertex 144", "vertex -1"), "-1 where a number of vertex was expected"),
        ("type", good.replace("float x", "quad x"), "type quad where one of"),
        ("list", good.replace("float x", "list uchar float x"), "the property x is a list"),
        ("headless", good.replace("end_header\n", ""), "line"),
    ] {
        folder.write(&format!("{name}.ply"), text);
        let message = folder.fails(3, &format!("fill {name}.ply --size 1x1 -o out.ply"));
        assert!(message.contains(expected) && message.contains(name), "{name}: {message}");
        assert!(!folder.names().contains(&"out.ply".to_owned()), "{name}");
    }
    let small: Vec<String> = (0..25).map(|k| format!("{} {} 0.{}", k % 5, k / 5, k % 3)).collect();
    folder.write("small.ply", ply("x y z", &small));
    let message = folder.fails(3, "fill small.ply --size 9x9 -o out.ply");
    assert!(message.contains("spacings of its points long where it is shortest"), "{message}");
    folder.write("sheet.ply", good);
    let window = folder.fails(2, "fill sheet.ply --size 1x1 --set window=90 -o out.ply");
    assert!(window.contains("window = 90") && window.contains("half the length of the exemplar"), "{window}");
    let many = folder.fails(3, "fill sheet.ply --size 1x1 --limit elements=100 -o out.ply");
    assert!(many.contains("144 is over the limit of 100"), "{many}");
}

#[test]
fn what_is_odd_about_exemplars_is_told() {
    let folder = Folder::new();
    let line: Vec<String> = (0..100).map(|k| format!("{} 0 0", f64::from(k) / 100.0)).collect();
    for (name, text, expected) in [
        (
            "zero",
            ply("x y z nx ny nz", &sheet(|k| if k % 9 == 0 { " 0 0 0".into() } else { " 0 0 1".into() })),
            "16 of 144 normals have no length",
        ),
        ("flat", ply("x y z", &sheet(|_| String::new())).replace("0.02", "0"), ""),
        ("line", ply("x y z", &line), "all points of the exemplar lie on one line"),
        ("single", ply("x y z element", &sheet(|k| format!(" {k}"))), "rigid elements of one point: 144"),
    ] {
        folder.write(&format!("{name}.ply"), text);
        let told = stderr(&folder.ok(&format!("fill {name}.ply --size 1.1x1.1 -o {name}-out.ply")));
        assert!(told.contains(expected), "{name}: {told}");
    }
}

#[test]
fn meshes_and_curves_that_are_none_are_refused() {
    let folder = Folder::new();
    folder.write("sheet.ply", ply("x y z", &sheet(|_| String::new())));
    let cube: Vec<String> = (0..512).map(|k| format!("{} {} {}", k % 8, k / 8 % 8, k / 64)).collect();
    folder.write("cube.ply", ply("x y z", &cube));
    folder.write("empty.obj", cuboid(""));
    folder.write("open.obj", cuboid(FACES.rsplit_once("f 2").unwrap().0));
    folder.write("giant.obj", cuboid(FACES).replace("v 2", "v 2e20"));
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    folder.write("point.obj", "v 0 0 0\nv 0 0 0\nl 1 2\n");
    for (place, expected) in [
        ("cube.ply --inside empty.obj", "points without faces, where a mesh was expected"),
        ("cube.ply --inside open.obj", "an open surface, expected a closed one: open edges: 4, the first at (2, 1, 0)"),
        ("cube.ply --inside giant.obj", "where a coordinate between"),
        ("cube.ply --inside flat.obj", "it encloses nothing"),
        ("sheet.ply --on flat.obj", "no triangle has an area"),
        ("sheet.ply --on empty.obj", "points without faces"),
        ("sheet.ply --inside open.obj", "does not repeat along three directions"),
        ("sheet.ply --along point.obj", "no line of any length"),
    ] {
        let message = folder.fails(3, &format!("fill {place} -o out.ply"));
        assert!(message.contains(expected), "{place}: {message}");
        assert!(!folder.names().contains(&"out.ply".to_owned()), "{place}");
    }
}

#[test]
fn what_is_odd_about_meshes_and_curves_is_told() {
    let folder = Folder::new();
    let cube: Vec<String> = (0..512).map(|k| format!("{} {} {}", k % 8, k / 8 % 8, k / 64)).collect();
    folder.write("cube.ply", ply("x y z", &cube));
    let turned: String = FACES
        .lines()
        .map(|f| f.split(' ').skip(1).collect::<Vec<_>>())
        .map(|f| format!("f {} {} {} {}\n", f[3], f[2], f[1], f[0]))
        .collect();
    folder.write("inverted.obj", cuboid(&turned));
    let second: String = (0..8)
        .map(|k: u32| {
            format!(
                "v {} {} {}\n",
                (k & 1) * 2 + 1,
                f64::from((k >> 1 & 1) * 2) + 0.9,
                f64::from((k >> 2 & 1) * 2) + 0.8
            )
        })
        .collect();
    let shifted: String = FACES
        .lines()
        .map(|f| {
            format!(
                "f {}\n",
                f.split(' ').skip(1).map(|v| (v.parse::<u32>().unwrap() + 8).to_string()).collect::<Vec<_>>().join(" ")
            )
        })
        .collect();
    folder.write("crossing.obj", cuboid("") + &second + FACES + &shifted);
    let screw: Vec<String> = (0..200)
        .map(f64::from)
        .map(|k| format!("{} {} {}", k / 200.0, 0.05 * (0.3 * k).cos(), 0.05 * (0.3 * k).sin()))
        .collect();
    folder.write("screw.ply", ply("x y z", &screw));
    folder.write("fold.obj", "v 0 0 0\nv 1 0 0\nv 0 0.01 0\nl 1 2 3\n");
    for (call, expected) in [
        ("cube.ply --inside inverted.obj --scale 0.3 --set rounds=1", "its triangles face inwards"),
        (
            "cube.ply --inside crossing.obj --scale 0.4 --set rounds=1",
            "triangles that pass through others: 12, the first at",
        ),
        ("screw.ply --along fold.obj", "bends so sharply at (1, 0, 0) that the structure folds there"),
    ] {
        let told = stderr(&folder.ok(&format!("fill {call} -o out.ply --force")));
        assert!(told.contains(expected), "{call}: {told}");
    }
}
