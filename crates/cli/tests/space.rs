//! Boxes in space: networks of curves, clouds of points.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod common;

use common::{Folder, example};

/// A cubic lattice of bars, five to a side, in its box.
fn lattice() -> String {
    let mut text = String::from("# box 0 0 0 5 5 5\no bars\n");
    let mut vertices = 0;
    for i in 0..5 {
        for j in 0..5 {
            let (u, v) = (f64::from(i) + 0.5, f64::from(j) + 0.5);
            let bar = |k: i32, text: &mut String| {
                let w = f64::from(k);
                *text += &format!("v {w} {u} {v}\nv {u} {w} {v}\nv {u} {v} {w}\n");
            };
            bar(0, &mut text);
            (0..5).for_each(|k| {
                let w = f64::from(k) + 0.5;
                text += &format!("v {w} {u} {v}\nv {u} {w} {v}\nv {u} {v} {w}\n");
            });
            bar(5, &mut text);
            for axis in 1..=3 {
                let line: Vec<String> = (0..7).map(|k| (vertices + axis + 3 * k).to_string()).collect();
                text += &format!("l {}\n", line.join(" "));
            }
            vertices += 21;
        }
    }
    text
}

#[test]
fn a_network_fills_a_box_and_repeats_itself() {
    let folder = Folder::new();
    folder.write("net.obj", lattice());
    folder.ok("fill net.obj --box 6x5x4 --seed 2 -o a.obj --threads 1");
    folder.ok("run a.obj -o b.obj --threads 2");
    let (a, b) = (folder.text("a.obj"), folder.text("b.obj"));
    assert!(a == b);
    assert!(a.contains("# box 0 0 0 6 5 4\n") && a.contains("g bars\n") && a.lines().any(|l| l.starts_with("l ")));
    for line in a.lines().filter_map(|l| l.strip_prefix("v ")) {
        let p: Vec<f64> = line.split(' ').map(|v| v.parse().unwrap()).collect();
        assert!(p.iter().zip([6.0, 5.0, 4.0]).all(|(v, side)| (-1e-6..=side + 1e-6).contains(v)), "{line}");
    }
    // The result is an exemplar itself.
    folder.ok("inspect a.obj");
}

#[test]
fn inspection_counts_curves_and_junctions() {
    let folder = Folder::new();
    folder.write("net.obj", lattice());
    let report: serde_json::Value = serde_json::from_slice(&folder.ok("inspect net.obj --json").stdout).unwrap();
    assert_eq!(
        (&report["kind"], &report["curves"], &report["junctions"]),
        (&"curves in space".into(), &75.into(), &125.into())
    );
    assert!((report["styles"][0]["length"].as_f64().unwrap() - 375.0).abs() < 1e-6);
    assert!((report["spacing"].as_f64().unwrap() - 1.0).abs() < 1e-6);
    let said = String::from_utf8(folder.ok("inspect net.obj").stdout).unwrap();
    assert!(said.contains("75, 125 junctions"), "{said}");
}

#[test]
fn the_summary_counts_curves_of_space() {
    let folder = Folder::new();
    folder.write("net.obj", lattice());
    let output = folder.ok("fill net.obj --box 4x4x4 -o a.json --json");
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let made = &summary["outputs"][0];
    assert!(made["curves"].as_u64().unwrap() > 0 && made["styles"]["bars"] == made["curves"]);
    let written: serde_json::Value = serde_json::from_slice(&folder.read("a.json")).unwrap();
    assert_eq!(written["page"]["size"], serde_json::json!([4.0, 4.0, 4.0]));
    assert!(written["recipe"].as_str().unwrap().contains("box = \"4x4x4\""));
}

#[test]
fn points_fill_a_box() {
    let folder = Folder::new();
    let rows: String = (0..125).map(|k| format!("{},{},{},p\n", k % 5, k / 5 % 5, k / 25)).collect();
    folder.write("cloud.csv", format!("x,y,z,class\n{rows}"));
    folder.ok("fill cloud.csv --box 6x6x6 -o a.csv");
    let text = folder.text("a.csv");
    assert!(text.starts_with("x,y,z,class\n"));
    assert!((100..400).contains(&text.lines().filter(|l| l.ends_with(",p")).count()));
    folder.ok("run a.csv -o b.csv");
    assert!(folder.text("b.csv") == text);
}

#[test]
fn what_does_not_fit_space_is_told() {
    let folder = Folder::new();
    folder.write("net.obj", lattice());
    folder.write("bad.obj", "v 0 0 0\nv 1 1 1\nl 1 3\n");
    for (code, line, expected) in [
        (3, "fill net.obj --size 5x5 -o a.svg", "--box 10x10x10"),
        (3, "fill leaves.svg --box 5x5x5 -o a.obj", "of the plane"),
        (3, "fill bad.obj --box 5x5x5 -o a.obj", "bad.obj: line 3: vertex 3"),
        (3, "inspect bad.obj", "line 3: vertex 3"),
    ] {
        let message = folder.fails(code, line);
        assert!(message.contains(expected), "{line}: {message}");
    }
    for (line, expected) in [
        ("fill net.obj --box 5x5 -o a.obj", "three positive numbers"),
        ("fill net.obj --box 5x5x5 -o a.svg", "write obj"),
        ("fill leaves.svg --size 80x80 -o a.obj", "curves in space"),
        ("fill net.obj --box 5x5x5 --avoid ring.svg -o a.obj", "avoid for points and curves in space"),
        ("fill net.obj --box 5x5x5 --physics -o a.obj", "physics for anything but elements in space"),
        ("fill net.obj --box 5x5x5 --physics=0 -o a.obj", "from 1 to 100, or settle"),
        ("fill net.obj --box 5x5x5 --physics --gravity 0,-1 -o a.obj", "three numbers"),
        ("fill net.obj --box 5x5x5 --friction 1 -o a.obj", "--physics"),
    ] {
        let output = folder.run(line);
        assert_ne!(output.status.code(), Some(0), "{line}");
        assert!(common::stderr(&output).contains(expected), "{line}: {}", common::stderr(&output));
    }
}

#[test]
fn the_shipped_foam_is_a_network() {
    let folder = Folder::new();
    let output = folder.ok(&format!("inspect {} --json", example("foam.obj")));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(report["junctions"].as_u64().unwrap() > 100 && report["warnings"].as_array().unwrap().is_empty());
}

/// The number of nodes of a GLB file, and the names of its meshes.
fn nodes(bytes: &[u8]) -> (usize, Vec<String>) {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let document: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let meshes = document["meshes"].as_array().unwrap();
    let names = meshes.iter().map(|mesh| mesh["name"].as_str().unwrap().to_owned()).collect();
    (document["nodes"].as_array().unwrap().len(), names)
}

#[test]
fn a_scene_of_meshes_fills_a_box_and_repeats_itself() {
    let folder = Folder::new();
    let scene = example("scene-vegetables.glb");
    folder.ok(&format!("fill {scene} --box 4x3x4 --seed 3 -o a.glb --threads 1"));
    folder.ok("run a.glb -o b.glb --threads 2");
    let (a, b) = (folder.read("a.glb"), folder.read("b.glb"));
    assert!(a == b);
    let (count, mut meshes) = nodes(&a);
    meshes.sort();
    // 143 elements in 146 cubic units of the exemplar.
    assert!((40..=55).contains(&count), "{count} for about 47");
    assert_eq!(meshes, ["bean", "die", "kernel"], "each mesh once");
    let other = folder.ok(&format!("fill {scene} --box 4x3x4 --seed 4 -o c.glb"));
    assert!(other.status.success() && folder.read("c.glb") != a);
}

#[test]
fn a_single_layer_goes_on_as_exactly_as_a_drawing() {
    let folder = Folder::new();
    let scene = example("scene-bricks.glb");
    folder.ok(&format!("fill {scene} --box 12x0.5x9 --floor -o wall.glb"));
    let (count, _) = nodes(&folder.read("wall.glb"));
    // 153 bricks on 146 square units.
    assert!((100..=126).contains(&count), "{count} for about 113");
}

#[test]
fn meshes_are_filled_and_covered_and_what_makes_no_sense_is_refused() {
    let folder = Folder::new();
    let scene = example("scene-plums.glb");
    let ball = "# a cube\nv 0 0 0\nv 5 0 0\nv 0 5 0\nv 5 5 0\nv 0 0 5\nv 5 0 5\nv 0 5 5\nv 5 5 5\n\
        f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    folder.write("cube.obj", ball);
    folder.ok(&format!("fill {scene} --inside cube.obj -o in.glb"));
    let (count, _) = nodes(&folder.read("in.glb"));
    assert!((40..=125).contains(&count), "{count} in 125 cubic units, whole ones alone");
    folder.write("sheet.obj", "v 0 0 0\nv 6 0 0\nv 6 0 6\nv 0 0 6\nf 1 4 3 2\n");
    let bricks = example("scene-bricks.glb");
    folder.ok(&format!("fill {bricks} --on sheet.obj -o on.glb"));
    let refused = folder.run(&format!("fill {scene} --inside sheet.obj -o x.glb"));
    assert_eq!(refused.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("open"), "{refused:?}");
    let both = folder.run(&format!("fill {scene} --box 4x4x4 --direction most -o x.glb"));
    assert!(String::from_utf8_lossy(&both.stderr).contains("direction"), "{both:?}");
}
