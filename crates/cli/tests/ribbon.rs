//! Ribbons, end to end.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod common;

use std::{
    io::{BufRead, BufReader},
    path::Path,
    process::Stdio,
};

use common::{Folder, curves, drawn_strip, picture, pixels, stderr, stdout, strip, svg};

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("strip.png", strip());
    folder.write("strip.svg", drawn_strip());
    folder.write("curves.svg", curves());
    folder
}

/// Sum of alpha over 255.
fn ink(bytes: &[u8]) -> f64 {
    pixels(bytes).2.chunks_exact(4).map(|p| f64::from(p[3]) / 255.0).sum()
}

/// Mean difference of two pictures over white, in 8-bit steps.
fn difference(a: &[u8], b: &[u8]) -> f64 {
    let over =
        |p: &[u8]| -> [f64; 3] { std::array::from_fn(|k| 255.0 + (f64::from(p[k]) - 255.0) * f64::from(p[3]) / 255.0) };
    let off = |(p, q): (&[u8], &[u8])| over(p).iter().zip(over(q)).map(|(x, y)| (x - y).abs()).sum::<f64>() / 3.0;
    let total: f64 = a.chunks_exact(4).zip(b.chunks_exact(4)).map(off).sum();
    total / (a.len() / 4) as f64
}

/// An SVG text drawn with `scale` pixels a unit, straight alpha.
fn drawn(text: &str, scale: f32) -> Vec<u8> {
    let tree = resvg::usvg::Tree::from_str(text, &resvg::usvg::Options::default()).unwrap();
    let size = tree.size().to_int_size().scale_by(scale).unwrap();
    let mut pixmap = resvg::tiny_skia::Pixmap::new(size.width(), size.height()).unwrap();
    resvg::render(&tree, resvg::tiny_skia::Transform::from_scale(scale, scale), &mut pixmap.as_mut());
    pixmap
        .pixels()
        .iter()
        .flat_map(|p| {
            let c = p.demultiply();
            [c.red(), c.green(), c.blue(), c.alpha()]
        })
        .collect()
}

#[test]
fn a_picture_on_the_page_of_the_curves() {
    let folder = folder();
    let said = stderr(&folder.ok("ribbon strip.png --along curves.svg#wave -o out.png"));
    assert!(said.contains("pieces in 1 ribbon"), "{said}");
    let made = folder.read("out.png");
    let (width, height, data) = pixels(&made);
    assert_eq!((width, height), (160, 100));
    // The band is about 7 pixels wide on a curve of about 170.
    assert!((800.0..1700.0).contains(&ink(&made)), "{}", ink(&made));
    let alpha = |x: usize, y: usize| data[4 * (y * 160 + x) + 3];
    // No farther from the curve than the ribbon is wide.
    assert!((0..160).all(|x| alpha(x, 2) == 0 && alpha(x, 97) == 0));
    // It runs on without a gap: every column between the ends holds ink.
    assert!((16..145).all(|x| (0..100).any(|y| alpha(x, y) > 200)));
    folder.ok("ribbon strip.png --along curves.svg#wave -o big.png --pixels-per-unit 2");
    let (width, ..) = pixels(&folder.read("big.png"));
    assert_eq!(width, 320);
    assert!((ink(&folder.read("big.png")) / ink(&made) - 4.0).abs() < 0.2);
}

#[test]
fn all_shapes_a_layer_or_one() {
    let folder = folder();
    for (what, ribbons) in [("curves.svg", 3), ("curves.svg#Corners", 1), ("curves.svg#round", 1)] {
        let output = folder.ok(&format!("ribbon strip.png --along {what} -o o.json --relax --json"));
        let summary: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
        assert_eq!(summary["outputs"][0]["ribbons"], ribbons, "{what}");
        let made: serde_json::Value = serde_json::from_str(&folder.text("o.json")).unwrap();
        assert_eq!(made["ribbons"].as_array().unwrap().len(), ribbons);
        if what.ends_with("round") {
            assert_eq!(made["ribbons"][0]["closed"], true);
            assert_eq!(made["ribbons"][0]["along"], "curves.svg: circle \"round\"");
        }
    }
}

#[test]
fn every_format_repeats_byte_for_byte() {
    let folder = folder();
    for format in ["png", "svg", "json", "obj", "glb"] {
        folder.ok(&format!(
            "ribbon strip.png --along curves.svg#wave -o a.{format} --seed 5 --threads 1 --width 20..30 --first 7,0"
        ));
        folder.ok(&format!("run a.{format} -o b.{format} --threads 2"));
        assert!(folder.read(&format!("a.{format}")) == folder.read(&format!("b.{format}")), "{format}");
        folder.ok(&format!("run a.{format} -o c.{format} --seed 6"));
        assert!(folder.read(&format!("a.{format}")) != folder.read(&format!("c.{format}")), "{format}");
    }
    // The inputs travel in the recipe.
    std::fs::remove_file(folder.path("strip.png")).unwrap();
    std::fs::remove_file(folder.path("curves.svg")).unwrap();
    folder.ok("run a.png -o d.png");
    assert!(folder.read("a.png") == folder.read("d.png"));
    folder.ok("run a.svg -o e.toml");
    folder.ok("run e.toml -o e.svg");
    assert!(folder.read("a.svg") == folder.read("e.svg"));
}

#[test]
fn variations_have_seeds_of_their_own() {
    let folder = folder();
    folder.ok("ribbon strip.png --along curves.svg#wave -o v.png --variations 2 --quiet");
    assert!(folder.read("v-1.png") != folder.read("v-2.png"));
    folder.ok("ribbon strip.png --along curves.svg#wave -o w.png --seed 1");
    assert!(folder.read("v-2.png") == folder.read("w.png"));
}

#[test]
fn the_drawing_looks_like_the_picture() {
    let folder = folder();
    for (exemplar, most) in [("strip.png", 1.0), ("strip.svg", 2.5)] {
        for curve in ["wave", "round"] {
            let line = format!("ribbon {exemplar} --along curves.svg#{curve} --pixels-per-unit 2");
            folder.ok(&format!("{line} -o o.png"));
            folder.ok(&format!("{line} -o o.svg"));
            let (_, _, picture) = pixels(&folder.read("o.png"));
            let text = folder.text("o.svg");
            let off = difference(&picture, &drawn(&text, 2.0));
            assert!(off < most, "{exemplar} {curve}: {off}");
            assert_eq!(text.matches("data:image/png").count(), usize::from(exemplar == "strip.png"));
        }
    }
}

#[test]
fn a_drawing_stays_vector_with_one_path_a_shape() {
    let folder = folder();
    folder.ok("ribbon strip.svg --along curves.svg#wave -o o.svg");
    let text = folder.text("o.svg");
    let result = common::drawn(&text);
    assert_eq!((result.matches("<path").count(), result.matches("<image").count()), (3, 0), "{result}");
    // The band is joined from piece to piece.
    let band = result.lines().find(|line| line.contains("#2a6e5a")).unwrap();
    assert!(band.matches('M').count() <= 3, "{band}");
}

/// Every pixel of the result on which `forbidden` lies.
fn forbidden_ink(result: &[u8], forbidden: impl Fn(f64, f64) -> bool) -> usize {
    let (width, _, data) = pixels(result);
    let hit = |k: usize| forbidden((k as u32 % width) as f64 + 0.5, (k as u32 / width) as f64 + 0.5);
    data.chunks_exact(4).enumerate().filter(|(k, p)| p[3] > 0 && hit(*k)).count()
}

#[test]
fn no_ink_on_what_is_avoided() {
    let folder = folder();
    folder.write(
        "rock.svg",
        svg("160", "100", "0 0 160 100", "<g transform=\"translate(80 50)\"><circle id=\"rock\" r=\"5\"/></g>"),
    );
    let disc = |x: f64, y: f64| (x - 80.0).hypot(y - 50.0) < 5.0;
    let line = "ribbon strip.png --along curves.svg#wave --width 40 -o";
    folder.ok(&format!("{line} free.png"));
    assert!(forbidden_ink(&folder.read("free.png"), disc) > 0, "the test must be able to fail");
    folder.ok(&format!("{line} shape.png --avoid rock.svg#rock"));
    assert_eq!(forbidden_ink(&folder.read("shape.png"), disc), 0);
    assert!(ink(&folder.read("shape.png")) > 600.0);
    // The same as a picture of half the resolution; light and transparent pixels are free.
    folder.write(
        "rock.png",
        picture(80, 50, |x, y| match disc(2.0 * f64::from(x) + 1.0, 2.0 * f64::from(y) + 1.0) {
            true => [20, 20, 60, 255],
            false if x < 40 => [0; 4],
            false => [250, 250, 250, 255],
        }),
    );
    folder.ok(&format!("{line} picture.png --avoid rock.png"));
    let dark = |x: f64, y: f64| disc(2.0 * (x / 2.0).floor() + 1.0, 2.0 * (y / 2.0).floor() + 1.0);
    assert_eq!(forbidden_ink(&folder.read("picture.png"), dark), 0);
}

#[test]
fn a_mesh_is_complete_and_in_bounds() {
    let folder = folder();
    folder.ok("ribbon strip.png --along curves.svg#wave -o o.glb");
    let bytes = folder.read("o.glb");
    let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], number(8)), (b"glTF".as_slice(), bytes.len()));
    let text = number(12);
    let document: serde_json::Value = serde_json::from_slice(&bytes[20..20 + text]).unwrap();
    let binary = &bytes[28 + text..];
    let primitive = &document["meshes"][0]["primitives"][0];
    let accessor = |k: &serde_json::Value| document["accessors"][k.as_u64().unwrap() as usize].clone();
    let positions = accessor(&primitive["attributes"]["POSITION"]);
    let texture = accessor(&primitive["attributes"]["TEXCOORD_0"]);
    let count = positions["count"].as_u64().unwrap();
    assert_eq!(texture["count"], count);
    // y points up: the page lies between 0 and -100.
    assert!(positions["min"][1].as_f64().unwrap() > -100.0 && positions["max"][1].as_f64().unwrap() < 0.0);
    assert!(positions["max"][0].as_f64().unwrap() < 160.0);
    let view = |a: &serde_json::Value| {
        let view = &document["bufferViews"][a["bufferView"].as_u64().unwrap() as usize];
        let (from, length) =
            (view["byteOffset"].as_u64().unwrap() as usize, view["byteLength"].as_u64().unwrap() as usize);
        &binary[from..from + length]
    };
    let coordinates = view(&texture).chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()));
    assert!(coordinates.into_iter().all(|t| (0.0..=1.0).contains(&t)));
    let indices = accessor(&primitive["indices"]);
    let corners = view(&indices).chunks_exact(4).map(|b| u32::from_le_bytes(b.try_into().unwrap()));
    assert!(corners.into_iter().all(|k| u64::from(k) < count));
    let held = view(&document["images"][0]);
    assert_eq!((pixels(held).0, pixels(held).1), (60, 24));
}

#[test]
fn a_curve_in_space_carries_a_strip() {
    let folder = folder();
    let vertices: String = (0..40)
        .map(|k| {
            let t = f64::from(k) * 0.2;
            format!("v {} {} {}\n", 40.0 * t.cos(), 40.0 * t.sin(), 12.0 * t)
        })
        .collect();
    let line: Vec<String> = (1..=40).map(|k| k.to_string()).collect();
    folder.write("helix.obj", format!("{vertices}l {}\n", line.join(" ")));
    for format in ["obj", "glb", "json"] {
        folder.ok(&format!("ribbon strip.png --along helix.obj -o s.{format}"));
        folder.ok(&format!("run s.{format} -o t.{format}"));
        assert!(folder.read(&format!("s.{format}")) == folder.read(&format!("t.{format}")), "{format}");
    }
    let text = folder.text("s.obj");
    let heights = text.lines().filter_map(|l| l.strip_prefix("v ")?.split(' ').nth(2)?.parse::<f64>().ok());
    assert!(heights.fold(0.0, f64::max) > 80.0);
    for (options, expected) in [
        ("-o s.png", "in space as png"),
        ("-o s.glb --avoid ring.svg", "avoid"),
        ("-o s.glb --on-canvas 9x9", "canvas"),
    ] {
        let message = folder.fails(3, &format!("ribbon strip.png --along helix.obj {options}"));
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn exemplars_pass_into_one_another_and_ends_are_kept() {
    let folder = folder();
    let red = picture(60, 24, |x, y| match (i64::from(y) - 12).abs() {
        0..=3 if x % 9 < 5 => [200, 30, 30, 255],
        0..=3 => [180, 20, 60, 255],
        _ => [0; 4],
    });
    folder.write("red.png", red);
    folder.ok("ribbon strip.png red.png --along curves.svg#wave --changes 0.3 -o two.json");
    let made: serde_json::Value = serde_json::from_str(&folder.text("two.json")).unwrap();
    let sources: Vec<u64> =
        made["ribbons"][0]["pieces"].as_array().unwrap().iter().map(|p| p["source"].as_u64().unwrap()).collect();
    assert_eq!((sources[0], sources[sources.len() - 1]), (0, 1));
    let first = sources.iter().filter(|s| **s == 0).count();
    assert!(first * 2 < sources.len(), "{sources:?}");
    folder.ok("ribbon strip.png --along curves.svg#wave --start 0..18 -o ends.json");
    let made: serde_json::Value = serde_json::from_str(&folder.text("ends.json")).unwrap();
    let left = |k: usize| made["ribbons"][0]["pieces"][k]["texture"][0][0].as_f64().unwrap();
    assert!(left(0) < 1.0 && left(1) < 10.0 && left(8) >= 18.0, "{} {} {}", left(0), left(1), left(8));
}

#[test]
fn a_time_limit_without_anything_to_write_says_so() {
    let folder = folder();
    let message = folder.fails(4, "ribbon strip.png --along curves.svg#wave -o o.json --time-limit 0.000001s");
    assert!(message.contains("the time was up"), "{message}");
}

#[cfg(unix)]
#[test]
fn a_signal_writes_the_ribbon_as_far_as_it_got() {
    let folder = folder();
    folder.write(
        "long.png",
        picture(600, 60, |x, y| {
            let off = (f64::from(y) - 30.0 - 6.0 * (f64::from(x) / 17.0).sin()).abs();
            if off < 5.0 { [(x % 251) as u8, (x * 7 % 255) as u8, 90, 255] } else { [0; 4] }
        }),
    );
    folder.write("long.svg", svg("9000", "100", "0 0 9000 100", "<path d=\"M0 50H9000\"/>"));
    let line = "ribbon long.png --along long.svg -o o.json -v --json --step 3 --set search=exhaustive";
    let mut child = folder.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut told = BufReader::new(child.stderr.take().unwrap());
    let mut said = String::new();
    while !said.contains("laying pieces") {
        said.clear();
        assert!(told.read_line(&mut said).unwrap() > 0, "the run ended before it began");
    }
    std::process::Command::new("kill").args(["-TERM", &child.id().to_string()]).output().unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(143));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["outputs"][0]["stopped"], "interrupted");
    let made: serde_json::Value = serde_json::from_str(&folder.text("o.json")).unwrap();
    let pieces = made["ribbons"][0]["pieces"].as_array().unwrap().len();
    assert!((1..3000).contains(&pieces), "{pieces}");
}

#[test]
fn reference_ribbons() {
    let folder = folder();
    for (name, line) in [
        ("ribbon", "ribbon strip.png --along curves.svg#wave --pixels-per-unit 2"),
        ("ribbon-closed", "ribbon strip.png --along curves.svg#round --closing exact"),
        ("ribbon-vector", "ribbon strip.svg --along curves.svg#wave"),
    ] {
        let vector = name.ends_with("vector");
        folder.ok(&format!("{line} --no-recipe -o {name}.{}", if vector { "svg" } else { "png" }));
        let made = if vector {
            drawn(&folder.text("ribbon-vector.svg"), 2.0)
        } else {
            pixels(&folder.read(&format!("{name}.png"))).2
        };
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference").join(format!("{name}.png"));
        if std::env::var_os("ARABESQUE_BLESS").is_some() {
            let width = if name == "ribbon-closed" { 160 } else { 320 };
            let at = |x: u32, y: u32| made[4 * (y * width + x) as usize..][..4].try_into().unwrap();
            std::fs::write(&path, picture(width, made.len() as u32 / 4 / width, at)).unwrap();
            continue;
        }
        let known = pixels(&std::fs::read(&path).unwrap()).2;
        assert_eq!(made.len(), known.len(), "{name}: another size");
        let off = difference(&made, &known);
        assert!(off < 0.1, "{name}: {off}; look at it, and bless it with ARABESQUE_BLESS=1 if it is right");
    }
}
