//! Bad input ends with a message that names the file, the place and the way out; nothing is written and nothing is lost.

mod common;

use common::{Folder, svg};

/// Runs `fill` on each content as exemplar and expects exit code 3 and a message with the word.
fn refused(cases: &[(&str, String, &str)]) {
    for (name, content, expected) in cases {
        let folder = Folder::new();
        folder.write(name, content);
        let message = folder.fails(3, &format!("fill {name} --size 80x80 -o out.svg"));
        assert!(message.starts_with("arabesque: error: ") && message.contains(name), "{message}");
        assert!(message.to_lowercase().contains(expected), "{name}: {message}");
    }
}

#[test]
fn what_is_no_exemplar() {
    let leaves = common::leaves();
    refused(&[
        ("text.svg", "hello".into(), "text.svg"),
        ("half.svg", leaves[..leaves.len() / 2].into(), "half.svg"),
        ("empty.svg", String::new(), "empty.svg"),
        ("html.svg", "<html><body/></html>".into(), "html.svg"),
        ("blank.svg", svg("80", "80", "0 0 80 80", ""), "no element"),
        (
            "frame.svg",
            svg(
                "80",
                "80",
                "0 0 80 80",
                "<path d=\"M0 10a8 8 0 0 1 0 16z\"/><path d=\"M80 13a8 8 0 0 0 0 16z\"/>\
             <path d=\"M30 80a8 8 0 0 1 16 0z\"/><path d=\"M33 0a8 8 0 0 0 16 0z\"/>",
            ),
            "frame",
        ),
        ("empty.csv", String::new(), "no point"),
        ("nan.csv", "x,y\n0,0\nnan,1\n".into(), "line 3"),
        ("inf.csv", "x,y\n0,0\n1,-inf\n".into(), "line 3"),
        ("huge.csv", "x,y\n0,0\n1,1e300\n".into(), "line 3"),
        ("same.csv", "x,y\n1,1\n1,1\n1,1\n".into(), "one place"),
        ("tiny.csv", "x,y\n0,0\n1e-300,1e-300\n".into(), "one place"),
    ]);
}

#[test]
fn bombs_and_depths_end_quickly() {
    let bomb = "<?xml version=\"1.0\"?><!DOCTYPE s [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;\"><!ENTITY c \"&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;\"><!ENTITY d \"&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;\"><!ENTITY e \"&d;&d;&d;&d;&d;&d;&d;&d;&d;&d;\">]><svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9\" height=\"9\"><text>&e;</text></svg>";
    let deep = svg("80", "80", "0 0 80 80", &("<g>".repeat(10_000) + "<circle r=\"3\"/>" + &"</g>".repeat(10_000)));
    refused(&[("bomb.svg", bomb.into(), "bomb.svg"), ("deep.svg", deep, "deep.svg")]);
}

#[test]
fn two_hundred_thousand_points_are_a_limit() {
    let lines: String = (0..200_000).map(|k| format!("{},{}\n", k % 500, k / 500)).collect();
    refused(&[("many.csv", format!("x,y\n{lines}"), "limit of 100000")]);
}

#[test]
fn bytes_that_are_no_text() {
    let folder = Folder::new();
    folder.write("bytes.svg", [b"<svg>".as_slice(), &[0xC3, 0x28, 0xFE]].concat());
    assert!(folder.fails(3, "fill bytes.svg --size 80x80 -o a.svg").contains("UTF-8"));
    assert!(folder.fails(3, "fill ramp.png --size 80x80 -o a.svg").contains("a picture where"));
}

#[test]
fn missing_and_unreadable_files() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("folder.svg")).unwrap();
    for (line, name) in [
        ("fill missing.svg --size 80x80 -o a.svg", "missing.svg"),
        ("fill folder.svg --size 80x80 -o a.svg", "folder.svg"),
        ("fill leaves.svg --domain missing.svg -o a.svg", "missing.svg"),
        ("fill leaves.svg --size 80x80 --avoid missing.svg -o a.svg", "missing.svg"),
        ("fill leaves.svg --size 80x80 --keep missing.svg -o a.svg", "missing.svg"),
        ("fill leaves.svg --size 80x80 --scale missing.png -o a.svg", "missing.png"),
        ("inspect missing.svg", "missing.svg"),
        ("run missing.svg -o a.svg", "missing.svg"),
    ] {
        assert!(folder.fails(3, line).contains(name), "{line}");
    }
}

#[test]
fn one_element_alone_is_an_exemplar_or_says_why_not() {
    let folder = Folder::new();
    folder.write("one.svg", svg("20", "20", "0 0 20 20", "<circle cx=\"10\" cy=\"10\" r=\"4\" fill=\"red\"/>"));
    let output = folder.run("fill one.svg --size 80x80 -o a.svg");
    match output.status.code() {
        Some(0) => assert!(folder.text("a.svg").contains("<use")),
        Some(3) => assert!(common::stderr(&output).contains("one")),
        other => panic!("{other:?}: {}", common::stderr(&output)),
    }
}

#[test]
fn domains_that_cannot_be_filled() {
    let folder = Folder::new();
    folder.write("line.svg", svg("80", "80", "0 0 80 80", "<path d=\"M0 0L80 80\" stroke=\"red\" fill=\"none\"/>"));
    folder.write("flat.svg", svg("80", "80", "0 0 80 80", "<rect width=\"80\" height=\"0\"/>"));
    assert!(folder.fails(3, "fill leaves.svg --domain line.svg -o a.svg").contains("line.svg"));
    assert!(folder.fails(3, "fill leaves.svg --domain flat.svg -o a.svg").contains("flat.svg"));
    for line in ["fill leaves.svg --size 2x2 -o a.svg", "fill leaves.svg --size 1e-300x1e-300 -o a.svg"] {
        assert!(folder.fails(4, line).contains("smaller than one element"), "{line}");
    }
    assert!(folder.fails(4, "fill leaves.svg --tile 1e-4x1e8 -o a.svg").contains("smaller than the cell"));
    assert!(folder.fails(4, "fill leaves.svg --tile 1e-4x1e8 --set repeat=off -o a.svg").contains("wide"));
    assert!(folder.fails(3, "fill leaves.svg --size 1e8x1e8 -o a.svg").contains("limit"));
    folder.write("all.svg", svg("80", "80", "0 0 80 80", "<rect x=\"-10\" y=\"-10\" width=\"200\" height=\"200\"/>"));
    assert!(folder.fails(4, "fill leaves.svg --size 80x80 --avoid all.svg -o a.svg").contains("whole domain"));
}

#[test]
fn pictures_of_the_wrong_kind() {
    let folder = Folder::new();
    folder.write("photo.png", [0xFF, 0xD8, 0xFF, 0xE0]);
    assert!(
        folder
            .fails(3, "fill leaves.svg --size 80x80 --scale ring.svg -o a.svg")
            .contains("an SVG or XML file, where a PNG")
    );
    assert!(
        folder.fails(3, "fill leaves.svg --size 80x80 --density photo.png -o a.svg").contains("a JPEG picture, where")
    );
    assert!(folder.fails(3, "fill leaves.svg --size 80x80 --orient points.csv -o a.svg").contains("points.csv"));
    let whole = folder.read("ramp.png");
    folder.write("cut.png", &whole[..whole.len() / 2]);
    assert!(folder.fails(3, "fill leaves.svg --size 80x80 --scale cut.png -o a.svg").contains("broken PNG"));
}

#[test]
fn numbers_out_of_range() {
    let folder = Folder::new();
    for (option, expected) in [
        ("--size 0x80", "positive"),
        ("--size nanxnan", "positive"),
        ("--size 80", "width x height"),
        ("--size 1e300x1e300", "positive"),
        ("--size 80x80 --scale 0", "scale"),
        ("--size 80x80 --scale -1", "scale"),
        ("--size 80x80 --density nan", "density"),
        ("--size 80x80 --density 1e300", "density"),
        ("--size 80x80 --orient inf", "orient"),
        ("--size 80x80 --radius -1", "radius"),
        ("--size 80x80 --radius nan", "radius"),
        ("--size 80x80 --radius 1e6", "radius"),
        ("--size 80x80 --levels 0", "levels"),
        ("--size 80x80 --levels 99", "levels"),
        ("--size 80x80 --iterations 100000", "iterations"),
        ("--size 80x80 --threads 0", "threads"),
        ("--size 80x80 --seed -1", "seed"),
        ("--size 80x80 --variations 0", "variations"),
        ("--size 80x80 --time-limit 0", "duration"),
        ("--size 80x80 --time-limit soon", "duration"),
        ("--size 80x80 --dpi 0", "dpi"),
        ("--size 80x80 --pixels-per-unit nan", "pixels-per-unit"),
    ] {
        let png = if option.contains("dpi") || option.contains("pixels") { "a.png" } else { "a.svg" };
        let message = folder.fails(2, &format!("fill leaves.svg {option} -o {png}"));
        assert!(message.contains(expected), "{option}: {message}");
    }
    assert!(folder.fails(3, "fill leaves.svg --size 80x80 --dpi 1e7 -o a.png").contains("limit"));
}

#[test]
fn json_that_is_cut_off_is_called_so() {
    let folder = Folder::new();
    folder.write("cut.json", "{\"placements\": [1,\n 2");
    for line in ["edit cut.json --list", "run cut.json -o again.json"] {
        let message = folder.fails(3, line);
        assert!(message.contains("cut.json: line 2, column 2: broken JSON: EOF"), "{line}: {message}");
    }
    folder.write("list.json", "[[1, 2], [3");
    let message = folder.fails(3, "run list.json -o again.json");
    assert!(message.contains("list.json: a JSON file, where a recipe or a result was expected"), "{message}");
}
