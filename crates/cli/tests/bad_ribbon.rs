//! Bad input for ribbons ends with a message that names the file, the place and the way out; nothing is written.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod common;

use common::{Folder, curves, picture, stderr, strip, svg};

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("strip.png", strip());
    folder.write("curves.svg", curves());
    folder
}

fn refused(folder: &Folder, code: i32, line: &str, expected: &[&str]) {
    let message = folder.fails(code, line);
    assert!(message.starts_with("arabesque: error: "), "{message}");
    for word in expected {
        assert!(message.contains(word), "{line}: {message}");
    }
}

#[test]
fn exemplars_without_a_transparent_background() {
    let folder = folder();
    folder.write("opaque.png", picture(40, 20, |x, _| [x as u8, 0, 0, 255]));
    folder.write("clear.png", picture(40, 20, |_, _| [9, 9, 9, 0]));
    folder.write("tiny.png", picture(2, 1, |_, _| [9, 9, 9, 99]));
    let strip = strip();
    folder.write("half.png", &strip[..strip.len() / 2]);
    folder.write("words.png", "not a picture");
    folder.write("empty.svg", svg("60", "24", "0 0 60 24", ""));
    for (name, expected) in [
        ("ramp.png", "ramp.png: a picture without an alpha channel"),
        ("opaque.png", "opaque.png: no pixel is transparent"),
        ("clear.png", "clear.png: every pixel is transparent"),
        ("tiny.png", "tiny.png: 2 x 1 pixels"),
        ("half.png", "half.png: broken PNG"),
        ("words.png", "words.png: plain text, where a PNG picture was expected"),
        ("empty.svg", "empty.svg: every pixel is transparent"),
        ("missing.png", "missing.png"),
    ] {
        refused(&folder, 3, &format!("ribbon {name} --along curves.svg#wave -o o.png"), &[expected]);
    }
    // Of several, the right one is named.
    refused(&folder, 3, "ribbon strip.png clear.png --along curves.svg#wave -o o.png", &["clear.png: every pixel"]);
}

#[test]
fn a_large_exemplar_may_be_searched_coarsely() {
    let folder = folder();
    folder.write("large.png", picture(1400, 300, |_, y| if y / 20 == 7 { [200, 0, 0, 255] } else { [0; 4] }));
    refused(&folder, 3, "ribbon large.png --along curves.svg#wave -o o.png", &["large.png", "420000", "--coarse 2"]);
}

#[test]
fn curves_that_are_none() {
    let folder = folder();
    for (name, body, expected) in [
        ("nothing", "", "no path or shape"),
        ("point", "<path id=\"p\" d=\"M5 5\"/>", "point.svg"),
        ("still", "<path id=\"p\" d=\"M5 5L5 5\"/>", "without any length"),
        ("nan", "<path id=\"p\" d=\"MNaN 5L5 5\"/>", "nan.svg"),
        ("far", "<path id=\"p\" d=\"M0 0L1e30 5\"/>", "far.svg"),
        ("short", "<path id=\"p\" d=\"M5 5h0.001\"/>", "short.svg: path \"p\": a curve of length"),
    ] {
        folder.write(&format!("{name}.svg"), svg("160", "100", "0 0 160 100", body));
        refused(&folder, 3, &format!("ribbon strip.png --along {name}.svg -o o.png"), &[expected]);
    }
    folder.write("words.svg", "hello");
    refused(&folder, 3, "ribbon strip.png --along words.svg -o o.png", &["words.svg"]);
    refused(&folder, 3, "ribbon strip.png --along strip.png -o o.png", &["strip.png: a picture where curves"]);
    refused(&folder, 3, "ribbon strip.png --along missing.svg -o o.png", &["missing.svg"]);
    refused(&folder, 3, "ribbon strip.png --along curves.svg#wvae -o o.png", &["\"wvae\"", "did you mean \"wave\"?"]);
    folder.write("broken.obj", "v 0 0 0\nv 1 0 nan\nl 1 2\n");
    refused(&folder, 3, "ribbon strip.png --along broken.obj -o o.glb", &["broken.obj: line 2"]);
    folder.write("faces.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    refused(&folder, 3, "ribbon strip.png --along faces.obj -o o.glb", &["faces.obj: no line"]);
}

#[test]
fn thousands_of_kinks_end_with_a_message_or_a_ribbon() {
    let folder = folder();
    let zigzag: String = (0..3000).map(|k| format!("L{} {}", f64::from(k) / 20.0, 40 + 2 * (k % 2))).collect();
    folder.write("kinks.svg", svg("160", "100", "0 0 160 100", &format!("<path id=\"k\" d=\"M0 40{zigzag}\"/>")));
    let output = folder.run("ribbon strip.png --along kinks.svg -o o.png");
    assert!(matches!(output.status.code(), Some(3 | 4)), "{}", stderr(&output));
    assert!(stderr(&output).contains("kinks.svg"), "{}", stderr(&output));
}

#[test]
fn places_without_a_valid_part() {
    let folder = folder();
    folder.write(
        "wall.svg",
        svg("160", "100", "0 0 160 100", "<rect id=\"wall\" x=\"70\" width=\"20\" height=\"100\"/>"),
    );
    let line = "ribbon strip.png --along curves.svg#wave -o o.png --avoid wall.svg";
    refused(&folder, 4, line, &["curves.svg: path \"wave\"", "piece", "--relax"]);
    folder.ok(&format!("{line} --relax"));
    std::fs::remove_file(folder.path("o.png")).unwrap();
    folder.write("all.svg", svg("160", "100", "0 0 160 100", "<rect x=\"-9\" y=\"-9\" width=\"200\" height=\"200\"/>"));
    let line = "ribbon strip.png --along curves.svg#wave -o o.png --avoid all.svg";
    refused(&folder, 4, line, &["covers the whole canvas"]);
    refused(
        &folder,
        3,
        "ribbon strip.png --along curves.svg#wave -o o.png --avoid wall.svg#wal",
        &["did you mean \"wall\"?"],
    );
}

#[test]
fn sizes_and_parameters() {
    let folder = folder();
    for (code, options, expected) in [
        (3, "--pixels-per-unit 1000", "--pixels-per-unit"),
        (3, "--on-canvas 1e6x1e6", "size of the canvas"),
        (3, "--step 0.0001", "pieces along the curve"),
        (2, "--pixels-per-unit -1", "a positive number"),
        (2, "--on-canvas 10", "width x height"),
        (2, "--width 0", "width"),
        (2, "--width 20..x", "20..40"),
        (2, "--step nan", "step"),
        (2, "--scale 0", "scale"),
        (2, "--first 900,0", "first"),
        (2, "--changes 0.5", "changes"),
        (2, "--coarse 17", "coarse"),
        (2, "--set vareity=1", "did you mean variety"),
        (2, "--set search=fast", "exhaustive"),
        (3, "--start 50..80", "columns 50 to 80"),
    ] {
        refused(&folder, code, &format!("ribbon strip.png --along curves.svg#wave -o o.png {options}"), &[expected]);
    }
    folder.fails(2, "ribbon strip.png --along curves.svg#wave -o o.pgn");
    folder.fails(3, "ribbon strip.png --along curves.svg#wave -o o.csv");
    folder.fails(2, "ribbon strip.png -o o.png");
}

#[test]
fn a_wide_ribbon_works_and_is_warned_of() {
    let folder = folder();
    let wide = stderr(&folder.ok("ribbon strip.png --along curves.svg#wave -o o.png --width 60"));
    assert!(!wide.contains("warning: the ribbon is"), "{wide}");
    let wider = stderr(&folder.ok("ribbon strip.png --along curves.svg#bend -o o.png --width 20..100 --relax"));
    assert!(wider.contains("warning: the ribbon is up to 100 wide"), "{wider}");
}

#[test]
fn recipes_that_contradict_themselves() {
    let folder = folder();
    let recipe = |more: &str| format!("exemplar = \"strip.png\"\n{more}\n[ribbon]\nalong = \"curves.svg#wave\"\n");
    folder.write("tile.toml", recipe("tile = \"9x9\""));
    refused(&folder, 3, "run tile.toml -o o.png", &["tile together with ribbon"]);
    folder.write("typo.toml", recipe("").replace("along", "alnog"));
    refused(&folder, 3, "run typo.toml -o o.png", &["line 4", "`along`"]);
    folder.write("good.toml", recipe("scale = 0.8") + "width = \"20..30\"\nstep = 5\n");
    folder.ok("run good.toml -o o.png");
}
