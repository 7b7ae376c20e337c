//! `arabesque measure`: reports as text, JSON and drawing, of good results, spoiled ones, and of what cannot be measured.

#![allow(clippy::unwrap_used, reason = "tests fail by panicking, their helpers too")]

#[path = "../common/mod.rs"]
mod common;

use common::{Folder, example, stdout, svg};
use serde_json::Value;

fn json(folder: &Folder, line: &str) -> Value {
    serde_json::from_slice(&folder.ok(line).stdout).unwrap()
}

fn family(report: &Value, name: &str) -> f64 {
    let families = report["families"].as_array().unwrap();
    families.iter().find(|f| f["family"] == name).map_or(0.0, |f| f["fault"].as_f64().unwrap())
}

/// A page of leaves and berries in rows, as another program would write it: every shape by itself, no names, no recipe.
fn drawn_elsewhere(is_there: impl Fn(i32, i32) -> bool, off: impl Fn(i32, i32) -> (f64, f64)) -> String {
    let mut body = String::from("<rect width=\"240\" height=\"240\" fill=\"#fffdf8\"/>\n");
    for (i, j) in (0..12).flat_map(|j| (0..12).map(move |i| (i, j))).filter(|&(i, j)| is_there(i, j)) {
        let (dx, dy) = off(i, j);
        let (x, y) = (f64::from(10 + 20 * i) + dx, f64::from(10 + 20 * j) + dy);
        body += &if i % 2 == 0 {
            format!(
                "<g transform=\"translate({x} {y})\"><path d=\"M-6 0C-3 -4 3 -4 6 0C3 4 -3 4 -6 0Z\" fill=\"#4a7\"/><path d=\"M-6 0L6 0\" stroke=\"#163\" fill=\"none\"/></g>\n"
            )
        } else {
            format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"3\" fill=\"#c22\"/>\n")
        };
    }
    svg("240", "240", "0 0 240 240", &body)
}

#[test]
fn a_result_is_told_as_text_json_and_drawing() {
    let folder = Folder::new();
    folder.ok("fill leaves.svg --size 240x240 -o page.svg");
    let text = stdout(&folder.ok("measure leaves.svg page.svg -o report.svg"));
    assert!(text.starts_with("page.svg: good") && text.contains("empty space, 99.9 %"), "{text}");
    assert!(text.contains("144 elements (exemplar: 16)"), "{text}");
    let report = folder.text("report.svg");
    assert!(report.contains("<g opacity=") && report.contains("evenness: good"), "{report}");
    let told = json(&folder, "measure leaves.svg page.svg --json");
    assert_eq!((&told["exemplar"], &told["reports"][0]["file"]), (&"leaves.svg".into(), &"page.svg".into()));
    let measures = told["reports"][0]["measures"].as_array().unwrap();
    assert!(measures.len() > 15 && measures.iter().all(|m| m["means"].as_str().unwrap().ends_with('.')));
    let all = stdout(&folder.ok("measure leaves.svg page.svg -v"));
    assert!(all.lines().count() > text.lines().count() + 10, "-v tells what every figure means");
    // The same command may write over its own report.
    folder.ok("measure leaves.svg page.svg --quiet -o report.svg");
}

#[test]
fn pages_drawn_elsewhere_are_measured_and_spoiled_ones_are_worse() {
    let folder = Folder::new();
    let still = |_, _| (0.0, 0.0);
    folder.write("true.svg", drawn_elsewhere(|_, _| true, still));
    folder.write("hole.svg", drawn_elsewhere(|i, j| (i - 5).abs() > 1 || (j - 6).abs() > 1, still));
    folder.write(
        "moved.svg",
        drawn_elsewhere(|_, _| true, |i, j| if (i + 3 * j) % 7 == 0 { (14.0, 2.0) } else { (0.0, 0.0) }),
    );
    let told = json(&folder, "measure leaves.svg true.svg hole.svg moved.svg --json -o r.svg");
    let report = |k: usize| &told["reports"][k];
    assert_eq!(report(0)["verdict"], "good", "{:#}", report(0)["families"]);
    assert!(family(report(1), "evenness") > 0.5 && family(report(2), "overlaps") > 0.3, "{:#}", report(2)["families"]);
    assert!(report(1)["marks"].as_array().unwrap().iter().any(|m| m["fault"] == "hole"));
    assert!(folder.text("r-2.svg").contains("spacings from ink"));
    assert!(folder.names().contains(&"r-1.svg".to_owned()) && folder.names().contains(&"r-3.svg".to_owned()));
}

#[test]
fn a_shape_is_measured_where_it_is_filled() {
    let folder = Folder::new();
    folder.write("dots.svg", {
        let dots: String = (0..100)
            .map(|k| {
                let (x, y) = (8 * (k % 10) + 4, 8 * (k / 10) + 4);
                format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\" fill=\"#c22\"/>", 2 + k * 7 % 3)
            })
            .collect();
        svg("80", "80", "0 0 80 80", &dots)
    });
    folder.ok("fill dots.svg --domain ring.svg -o ring-page.svg");
    // The recipe says what was filled; without it the empty middle and corners are holes.
    let by_recipe = json(&folder, "measure dots.svg ring-page.svg --json");
    assert_eq!(by_recipe["reports"][0]["domain"], "shape");
    folder.ok("fill dots.svg --domain ring.svg --no-recipe -o bare.svg");
    let page = json(&folder, "measure dots.svg bare.svg --json");
    let shape = json(&folder, "measure dots.svg bare.svg --domain ring.svg#ring --json");
    assert_eq!(page["reports"][0]["domain"], "page");
    let largest = |told: &Value| {
        let measures = told["reports"][0]["measures"].as_array().unwrap().clone();
        measures.iter().find(|m| m["name"] == "largest hole").unwrap()["result"].as_f64().unwrap()
    };
    assert!(largest(&page) > 2.0 * largest(&shape), "{} {}", largest(&page), largest(&shape));
    assert!((largest(&by_recipe) - largest(&shape)).abs() < 0.1);
}

#[test]
fn points_and_curves_in_space_are_measured() {
    let folder = Folder::new();
    folder.ok("fill points.csv --size 2x2 -o page.csv");
    let told = json(&folder, "measure points.csv page.csv --json -o points.svg");
    assert_eq!(told["reports"][0]["kind"], "points");
    assert!(folder.text("points.svg").contains("<circle"));
    let foam = example("foam.obj");
    let told = json(&folder, &format!("measure {foam} {foam} --json"));
    assert_eq!(told["reports"][0]["kind"], "curves in space");
    assert!(told["reports"][0]["measures"].as_array().unwrap().iter().any(|m| m["name"] == "junctions of four"));
    assert!(folder.fails(3, &format!("measure {foam} {foam} -o a.svg")).contains("a picture of what lies in space"));
}

#[test]
fn what_cannot_be_measured_is_told() {
    let folder = Folder::new();
    folder.write("empty.svg", svg("240", "240", "0 0 240 240", ""));
    folder.write("broken.svg", "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9");
    folder.write("tiny.svg", svg("9", "9", "0 0 9 9", "<circle cx=\"4\" cy=\"4\" r=\"3\" fill=\"#c22\"/>"));
    let dots = "<circle cx=\"40\" cy=\"40\" r=\"3\" fill=\"#c22\"/><circle cx=\"60\" cy=\"40\" r=\"3\" fill=\"#c22\"/>";
    folder.write("huge.svg", svg("900000", "900000", "0 0 900000 900000", dots));
    let cases = [
        (3, "measure leaves.svg empty.svg", "empty.svg: no element and no curve found"),
        (3, "measure leaves.svg broken.svg", "broken.svg"),
        (3, "measure leaves.svg missing.svg", "missing.svg"),
        (3, "measure missing.svg leaves.svg", "exemplar missing.svg"),
        (3, "measure leaves.svg ramp.png", "a picture where an SVG drawing"),
        (3, "measure leaves.svg points.csv", "points, where the exemplar is a drawing"),
        (3, "measure points.csv leaves.svg", "a drawing, where the exemplar is points"),
        (3, "measure leaves.svg tiny.svg", "tiny.svg: 9 across"),
        (3, "measure leaves.svg huge.svg", "--limit output-elements="),
        (3, "measure leaves.svg leaves.svg --limit work=1", "--limit work="),
        (3, "measure leaves.svg leaves.svg --domain missing.svg", "--domain missing.svg"),
        (2, "measure leaves.svg", "RESULT"),
        (2, "measure leaves.svg leaves.svg -o a.png", "written as .svg"),
        (2, "measure leaves.svg leaves.svg ring.svg -o -", "the picture of one result"),
        (2, "measure - -", "standard input can be read once"),
        (1, "measure leaves.svg ring.svg -o leaves.svg", "it is an input as well"),
    ];
    for (code, line, expected) in cases {
        let message = folder.fails(code, line);
        assert!(message.contains(expected), "{line}: {message}");
    }
}

#[test]
fn the_report_does_not_depend_on_threads() {
    let folder = Folder::new();
    folder.write("page.svg", drawn_elsewhere(|i, j| (i + j) % 5 > 0, |i, j| (f64::from(i % 3), f64::from(j % 4))));
    let with = |threads: u32| {
        let line = format!("measure leaves.svg page.svg --threads {threads} --json -o r{threads}.svg");
        let told = stdout(&folder.ok(&line));
        // How much memory was in use at once depends on the threads; nothing else does.
        let told: Vec<_> = told.lines().filter(|line| !line.starts_with("  \"memory\":")).map(str::to_owned).collect();
        (told, folder.text(&format!("r{threads}.svg")))
    };
    assert_eq!(with(1), with(3));
}
