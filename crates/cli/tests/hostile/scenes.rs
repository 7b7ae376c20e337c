//! Scenes of meshes in space, and the meshes and curves that they fill.

use crate::case::{Case, DONE, EITHER, REFUSED, USAGE};

/// Refused, as an option that does not suit or as a file that does not.
const TOLD: &[i32] = &[2, 3, 4];

/// A tetrahedron at a place, as an object of its own.
fn piece(name: &str, number: usize, [x, y, z]: [f64; 3], size: f64) -> String {
    let corners = [[0.0, 0.0, 0.0], [size, 0.0, 0.0], [0.0, size, 0.0], [0.0, 0.0, size]];
    let corners = corners.map(|[a, b, c]| format!("v {} {} {}\n", x + a, y + b, z + c)).concat();
    let faces = [[1, 3, 2], [1, 2, 4], [2, 3, 4], [1, 4, 3]].map(|face| face.map(|v| v + 4 * number));
    let faces = faces.map(|[a, b, c]| format!("f {a} {b} {c}\n")).concat();
    format!("o {name}\n{corners}{faces}")
}

/// So many pieces in a loose heap.
fn heap(count: usize, size: f64) -> String {
    let place = |k: usize| [(k * 7 % 5) as f64 * 1.4, (k / 25) as f64 * 1.3, (k * 3 % 5) as f64 * 1.5];
    (0..count).map(|k| piece(&format!("piece.{k}"), k, place(k), size)).collect()
}

fn boxed(name: impl Into<String>, scene: impl Into<Vec<u8>>, codes: &'static [i32]) -> Case {
    Case::new(name, "fill in.obj --box 8x5x8 -o out.glb", codes).with("in.obj", scene)
}

/// glTF as text, with one triangle beside whatever else it has.
fn gltf(nodes: &str, rest: &str) -> String {
    format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[0]}}],\"nodes\":[{nodes}],{rest}\
         \"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}}}}]}}],\
         \"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]}}],\
         \"bufferViews\":[{{\"buffer\":0,\"byteLength\":36}}],\
         \"buffers\":[{{\"byteLength\":36,\"uri\":\"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}}]}}"
    )
}

fn text(name: &str, scene: String, codes: &'static [i32]) -> Case {
    Case::new(name, "fill in.gltf --box 8x5x8 -o out.glb", codes).with("in.gltf", scene)
}

fn files() -> Vec<Case> {
    let tall = "v 0 0 0\n".repeat(50_000) + "f 1 2 3\n";
    let chain = (0..5000).map(|k| format!("{{\"children\":[{}]}},", k + 1)).collect::<String>() + "{\"mesh\":0}";
    let ring = "{\"children\":[1]},{\"children\":[0],\"mesh\":0}".to_owned();
    vec![
        boxed("a heap of pieces", heap(60, 1.0), DONE),
        boxed("two pieces", heap(2, 1.0), EITHER),
        boxed("one piece", heap(1, 1.0), EITHER),
        boxed("nothing", "", REFUSED),
        boxed("vertices without a face", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", TOLD),
        boxed("all at one place", (0..50).map(|k| piece("a", k, [0.0; 3], 1.0)).collect::<String>(), EITHER),
        boxed("pieces of no size", heap(40, 0.0), TOLD),
        boxed("pieces of 1e-8", heap(40, 1e-8), EITHER),
        boxed("pieces far larger than the box", heap(40, 500.0), TOLD),
        boxed("a piece at 1e9", heap(40, 1.0) + &piece("far", 40, [1e9, 0.0, 0.0], 1.0), EITHER),
        boxed("a piece at 1e154", heap(40, 1.0) + &piece("far", 40, [1e154, 0.0, 0.0], 1.0), TOLD),
        boxed("a corner that is not a number", heap(9, 1.0) + "v nan 0 0\nf 1 2 37\n", TOLD),
        boxed("faces of vertices that are not there", "o a\nv 0 0 0\nf 1 2 3\n".repeat(20), REFUSED),
        boxed("fifty thousand vertices at one place", tall, TOLD),
        boxed("zeros", vec![0_u8; 4000], REFUSED),
        text("half a document", gltf("{\"mesh\":0}", "")[..200].to_owned(), REFUSED),
        text("a chain of five thousand nodes", gltf(&chain, ""), EITHER),
        text("nodes that hold one another", gltf(&ring, ""), REFUSED),
        text("a matrix of zeros", gltf(&format!("{{\"mesh\":0,\"matrix\":[{}]}}", ["0"; 16].join(",")), ""), TOLD),
        text("a scale of 1e300", gltf("{\"mesh\":0,\"scale\":[1e300,1,1]}", ""), TOLD),
        text("a mesh that is not there", gltf("{\"mesh\":7}", ""), REFUSED),
        text("a buffer of a file that is elsewhere", gltf("{\"mesh\":0}", "").replace("data:", "../../"), REFUSED),
        text("a buffer of a billion bytes", gltf("{\"mesh\":0}", "").replace(":36,", ":1000000000,"), REFUSED),
        text("a billion vertices", gltf("{\"mesh\":0}", "").replace("\"count\":3", "\"count\":1000000000"), REFUSED),
    ]
}

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = files();
    for (options, codes) in [
        ("--box 0x5x5", TOLD),
        ("--box 1e9x1e9x1e9", REFUSED),
        ("--box 0.1x0.1x0.1", TOLD),
        ("--box 6x4x6 --floor --physics", EITHER),
        ("--box 6x4x6 --physics=9999999", TOLD),
        ("--box 6x4x6 --physics --gravity nan,0,0", TOLD),
        ("--box 6x4x6 --physics --friction 1e9", TOLD),
        ("--box 6x4x6 --scale 1e9", TOLD),
        ("--box 6x4x6 --density 1e-9", TOLD),
        ("--box 6x4x6 --set samples=64", EITHER),
        ("--box 6x4x6 --constrain nobody=floor", TOLD),
        ("--box 6x4x6 --deform", EITHER),
        ("--box 6x4x6 --limit memory=1048576", TOLD),
        ("--box 6x4x6 --time-limit 1ms", EITHER),
        ("--box 6x4x6 --inside m.obj", USAGE),
        ("--inside m.obj", EITHER),
        ("--on m.obj", EITHER),
        ("--along m.obj", TOLD),
    ] {
        let case = Case::new(format!("a scene with {options}"), format!("fill in.obj {options} -o out.glb"), codes);
        cases.push(case.with("in.obj", heap(40, 1.0)).with("m.obj", piece("m", 0, [0.0; 3], 9.0)));
    }
    for (name, option, file, codes) in [
        ("an open mesh", "--inside", "v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n".to_owned(), TOLD),
        ("a mesh that is flat", "--inside", "v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\nf 1 3 2\n".to_owned(), TOLD),
        ("a mesh turned inside out", "--inside", piece("m", 0, [0.0; 3], -9.0), EITHER),
        ("a tiny mesh", "--on", piece("m", 0, [0.0; 3], 1e-6), TOLD),
        ("a curve of one place", "--along", "v 0 0 0\nl 1 1\n".to_owned(), TOLD),
        ("a curve that turns back", "--along", "v 0 0 0\nv 9 0 0\nl 1 2 1 2 1\n".to_owned(), EITHER),
        ("a curve of ten thousand corners", "--along", long(), EITHER),
        ("a cone of thirty thousand slivers", "--inside", cone(15_000), REFUSED),
    ] {
        let case = Case::new(name, format!("fill in.obj {option} m.obj -o out.glb"), codes);
        cases.push(case.with("in.obj", heap(40, 1.0)).with("m.obj", file));
    }
    cases
}

/// A cone whose triangles all meet in its tip or in the middle of its base.
fn cone(count: u32) -> String {
    let rim = |k: u32| (f64::from(k) / f64::from(count) * std::f64::consts::TAU).sin_cos();
    let corners: String = (0..count).map(|k| format!("v {} 0 {}\n", 9.0 * rim(k).0, 9.0 * rim(k).1)).collect();
    let next = |k: u32| (k + 3, (k + 1) % count + 3);
    let faces: String = (0..count).map(next).map(|(a, b)| format!("f 1 {a} {b}\nf 2 {b} {a}\n")).collect();
    format!("v 0 9 0\nv 0 0 0\n{corners}{faces}")
}

/// A curve that winds along a short way.
fn long() -> String {
    let corners: String = (0..10_000).map(|k| format!("v {} {} 0\n", f64::from(k) * 1e-3, k % 2)).collect();
    let line: String = (1..=10_000).map(|k| format!(" {k}")).collect();
    format!("{corners}l{line}\n")
}
