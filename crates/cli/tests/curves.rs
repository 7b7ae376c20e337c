//! Patterns of strokes, and making parts of a drawing anew.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{Folder, attributes, drawn, stderr, stdout, svg};

/// A square net of lines, 20 apart, in two styles.
fn net() -> String {
    let rows: String = (0..5)
        .map(|k| {
            format!(
                "<path class=\"warp\" d=\"M0 {y}H100\" fill=\"none\" stroke=\"#a33\" stroke-width=\"2\"/>\n",
                y = 10 + 20 * k
            )
        })
        .collect();
    let columns: String = (0..5)
        .map(|k| {
            format!(
                "<path class=\"weft\" d=\"M{x} 0V100\" fill=\"none\" stroke=\"#36c\" stroke-width=\"1.5\"/>\n",
                x = 10 + 20 * k
            )
        })
        .collect();
    svg("100", "100", "0 0 100 100", &(rows + &columns))
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("net.svg", net());
    folder
}

/// The lines of a file that its result lacks, recipe aside.
fn lines_lost(before: &str, after: &str) -> Vec<String> {
    let (head, rest) = after.split_once("<metadata>").unwrap();
    let after = format!("{head}{}", drawn(rest));
    before.lines().filter(|line| !after.contains(*line)).map(str::to_owned).collect()
}

#[test]
fn inspect_counts_curves_by_style() {
    let folder = folder();
    let text = stdout(&folder.ok("inspect net.svg -o net.png"));
    assert!(text.contains("curves: 10") && !text.contains("elements:"), "{text}");
    assert!(text.contains("style warp: 5 curves (0 closed)") && text.contains("length 500, width 1.5"), "{text}");
    let value: serde_json::Value = serde_json::from_str(&stdout(&folder.ok("inspect net.svg --json"))).unwrap();
    assert_eq!((&value["curves"], &value["styles"][1]["name"]), (&10.into(), &"weft".into()));
    let picture = folder.read("net.png");
    assert!(common::pixels(&picture).2.chunks(4).any(|p| p[0] != p[2]), "nothing coloured was drawn");
    let as_elements = folder.fails(3, "inspect net.svg --method elements");
    assert!(as_elements.contains("every element is cut by the frame"), "{as_elements}");
}

#[test]
fn strokes_turn_at_the_border() {
    let folder = folder();
    folder.ok("fill net.svg --size 160x160 --border turn -o out.svg");
    let text = folder.text("out.svg");
    let paths = attributes(drawn(&text), "d");
    assert!(paths.iter().any(|d| d.ends_with('Z')), "no stroke along the border: {paths:?}");
    folder.ok("run out.svg -o again.svg");
    assert_eq!(text, folder.text("again.svg"));
    // A tile has no border.
    folder.ok("fill net.svg --tile 100x100 --border turn -o turned.svg");
    folder.ok("fill net.svg --tile 100x100 -o tile.svg");
    assert_eq!(drawn(&folder.text("turned.svg")), drawn(&folder.text("tile.svg")));
    let message = folder.fails(2, "fill net.svg --redo 20,20,40,40 --border turn -o redone.svg");
    assert!(message.contains("the strokes around it go on"), "{message}");
}

#[test]
fn a_region_is_made_anew_and_the_rest_stays_to_the_byte() {
    let folder = folder();
    folder.ok("fill leaves.svg --redo 40,0,40,40 -o out.svg");
    let (before, after) = (folder.text("leaves.svg"), folder.text("out.svg"));
    let lost = lines_lost(&before, &after);
    // The root has new namespaces; four elements have their centre in the region.
    assert_eq!(lost.len(), 5, "{lost:?}");
    assert!(lost[0].starts_with("<svg"));
    let placed = attributes(&after, "data-arabesque-source");
    assert!((1..=8).contains(&placed.len()), "{}", placed.len());
    folder.ok("run out.svg -o again.svg");
    assert_eq!(folder.text("out.svg"), folder.text("again.svg"));
    folder.ok("fill out.svg --redo 0,0,20,80 -o twice.svg");
    folder.ok("run twice.svg -o again.svg");
    assert_eq!(folder.text("twice.svg"), folder.text("again.svg"), "an older recipe was found");
}

#[test]
fn a_shape_of_the_file_may_be_the_region() {
    let folder = folder();
    let marked = folder
        .text("leaves.svg")
        .replace("</svg>", "<circle id=\"hole\" cx=\"60\" cy=\"20\" r=\"18\" fill=\"none\"/>\n</svg>");
    folder.write("marked.svg", &marked);
    folder.ok("fill marked.svg --redo #hole -o out.svg");
    assert!(folder.text("out.svg").contains("<circle id=\"hole\" cx=\"60\" cy=\"20\" r=\"18\" fill=\"none\"/>"));
    folder.ok("fill leaves.svg --redo marked.svg#hole -o other.svg");
    std::fs::remove_file(folder.path("marked.svg")).unwrap();
    folder.ok("run other.svg -o again.svg");
    assert_eq!(folder.text("other.svg"), folder.text("again.svg"));
}

#[test]
fn a_pattern_is_continued_in_another_region() {
    let folder = folder();
    let half = folder.text("leaves.svg").replace(
        "width=\"80\" height=\"80\" viewBox=\"0 0 80 80\"",
        "width=\"160\" height=\"80\" viewBox=\"0 0 160 80\"",
    );
    folder.write("half.svg", half.replace("<rect width=\"80\"", "<rect width=\"160\""));
    folder.ok("fill half.svg --from 0,0,80,80 --to 80,0,80,80 -o out.svg");
    let (before, after) = (folder.text("half.svg"), folder.text("out.svg"));
    assert_eq!(lines_lost(&before, &after).len(), 1, "only the root may change");
    let count = attributes(&after, "data-arabesque-source").len();
    assert!((10..=24).contains(&count), "{count}");
    folder.ok("run out.svg -o again.svg");
    assert_eq!(after, folder.text("again.svg"));
}

#[test]
fn regions_that_make_no_sense_are_refused() {
    let folder = folder();
    for (code, line, expected) in [
        (3, "fill leaves.svg --redo 500,0,10,10 -o a.svg", "off the page"),
        (3, "fill leaves.svg --redo 0,0,80,80 -o a.svg", "too little of the drawing"),
        (3, "fill leaves.svg --redo #nothing -o a.svg", "nothing visible has the id"),
        (3, "fill leaves.svg --from 500,0,10,10 --to 0,0,40,40 -o a.svg", "off the drawing"),
        (3, "fill leaves.svg --from 18,18,4,4 --to 0,0,40,40 -o a.svg", "nothing of the drawing lies in"),
        (3, "fill leaves.svg --from 0,0,40,40 --to 100,0,40,40 -o a.svg", "off the page"),
        (3, "fill points.csv --redo 0,0,1,1 -o a.svg", "give an SVG drawing"),
        (2, "fill leaves.svg --redo 0,0,10 -o a.svg", "x,y,w,h"),
        (2, "fill leaves.svg --redo 0,0,10,10 --size 9x9 -o a.svg", "--size"),
        (2, "fill leaves.svg --from 0,0,10,10 -o a.svg", "--to"),
        (2, "fill leaves.svg --redo 0,0,10,10 --keep ring.svg -o a.svg", "given with size, tile, domain or keep"),
    ] {
        let message = folder.fails(code, line);
        assert!(message.contains(expected), "{line}: {message}");
    }
}

#[test]
fn degenerate_strokes_are_told() {
    let folder = folder();
    let twice = "<path d=\"M0 10H100\" class=\"warp\" fill=\"none\" stroke=\"#a33\" stroke-width=\"2\"/><path d=\"M5 5L5 5\" stroke=\"red\"/>";
    folder.write("bad.svg", net().replace("</svg>", &format!("{twice}</svg>")));
    let told = stderr(&folder.ok("inspect bad.svg"));
    assert!(told.contains("on top of one like it") && told.contains("without"), "{told}");
    assert!(!drawn(&net()).is_empty());
}

#[test]
fn strokes_come_out_in_the_styles_of_the_exemplar() {
    let folder = folder();
    let told = stderr(&folder.ok("fill net.svg --size 80x80 -o out.svg"));
    assert!(told.contains(" curves in ") && !told.contains("elements"), "{told}");
    let text = folder.text("out.svg");
    let paths = attributes(drawn(&text), "data-arabesque-curve").len();
    assert!(paths >= 4, "{paths}");
    for style in ["warp", "weft"] {
        assert_eq!(text.matches(&format!("inkscape:label=\"{style}\"")).count(), 1, "{style}");
    }
    folder.ok("run out.svg -o again.svg");
    assert_eq!(text, folder.text("again.svg"));
    let value: serde_json::Value =
        serde_json::from_str(&stdout(&folder.ok("fill net.svg --size 80x80 -o out.json --json"))).unwrap();
    let output = &value["outputs"][0];
    assert_eq!((output["curves"].as_u64(), output["elements"].as_u64()), (Some(paths as u64), Some(0)));
    let file: serde_json::Value = serde_json::from_str(&folder.text("out.json")).unwrap();
    let curves = file["curves"].as_array().unwrap();
    assert_eq!(curves.len(), paths);
    assert!(curves.iter().all(|c| c["d"].as_str().unwrap().starts_with('M') && c["length"].as_f64().unwrap() > 0.0));
    assert!(curves.iter().any(|c| c["style"] == "weft" && c["width"] == 1.5));
}

#[test]
fn points_cannot_hold_curves() {
    let folder = folder();
    assert!(folder.fails(3, "fill net.svg --size 80x80 -o out.csv").contains("write SVG or JSON"));
}

#[test]
fn what_was_drawn_is_kept_as_it_was_drawn() {
    let folder = folder();
    let line = "<path  d=\"M0 30 h 50 v 5\" fill=\"none\" stroke=\"#a33\" stroke-width=\"2\"/>";
    folder.write(
        "drawn.svg",
        svg("80", "80", "0 0 80 80", &format!("{line}<path d=\"M5 60H25\" fill=\"none\" stroke=\"#0f0\"/>")),
    );
    folder.ok("fill net.svg --size 80x80 --keep drawn.svg -o out.svg");
    let text = folder.text("out.svg");
    let (kept, new) = drawn(&text).split_once("Arabesque output").unwrap();
    assert!(kept.contains("d=\"M0 30 h 50 v 5\"") && !new.contains("M0 30"), "{text}");
    assert!(new.contains("M5 60H25"), "what is no stroke of the exemplar is kept too");
    assert!(!attributes(new, "data-arabesque-curve").is_empty());
}

#[test]
fn strokes_are_cut_where_a_region_is_made_anew() {
    let folder = folder();
    folder.ok("fill net.svg --redo 0,0,36,36 -o out.svg");
    let (before, after) = (folder.text("net.svg"), folder.text("out.svg"));
    let lost = lines_lost(&before, &after);
    assert_eq!(lost.len(), 5, "the root, two rows and two columns that reach into the region: {lost:?}");
    assert!(after.contains("M36 10L100 10") && after.contains("M10 36L10 100"), "{after}");
    let new: String = after.lines().filter(|line| line.contains("data-arabesque-curve")).collect();
    assert!(after.contains("Arabesque output") && !new.is_empty());
    for data in attributes(&new, "d") {
        let numbers =
            data.split(|c: char| !c.is_ascii_digit() && c != '.' && c != '-').filter_map(|n| n.parse::<f64>().ok());
        assert!(numbers.into_iter().all(|n| n < 45.0), "a new stroke leaves the region: {data}");
    }
}

#[test]
fn elements_and_curves_come_out_together() {
    let folder = folder();
    let dots: String = (0..25)
        .map(|k| format!("<circle cx=\"{}\" cy=\"{}\" r=\"4\" fill=\"#a60\"/>\n", 20 * (k % 5), 20 * (k / 5)))
        .collect();
    folder.write("both.svg", net().replace("</svg>", &format!("{dots}</svg>")));
    let told = stderr(&folder.ok("fill both.svg --size 80x80 -o out.svg"));
    assert!(told.contains(" curves and ") && told.contains(" elements in "), "{told}");
    let text = folder.text("out.svg");
    assert!(text.rfind("data-arabesque-curve").unwrap() < text.find("<use ").unwrap(), "the dots lie above the net");
    folder.ok("fill both.svg --size 80x80 -o out.csv");
}
