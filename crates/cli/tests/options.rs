//! Every option does what its help says.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod common;

use common::{Folder, attributes, drawn, pixels, stderr, stdout};
use serde_json::Value;

fn json(folder: &Folder, line: &str) -> Value {
    folder.ok(&format!("{line} -o out.json"));
    serde_json::from_slice(&folder.read("out.json")).unwrap()
}

fn count(value: &Value) -> usize {
    value["placements"].as_array().unwrap().len()
}

#[test]
fn size_in_user_units_keeps_the_density() {
    let folder = Folder::new();
    let value = json(&folder, "fill leaves.svg --size 160x160");
    let n = count(&value);
    assert!((48..=110).contains(&n), "{n} elements where about 64 were expected");
    assert_eq!(value["page"]["size"], serde_json::json!([160.0, 160.0]));
}

#[test]
fn size_with_units_sets_the_page() {
    let folder = Folder::new();
    folder.ok("fill leaves.svg --size 50mmx40mm -o a.svg");
    let text = folder.text("a.svg");
    assert!(text.contains("width=\"50mm\" height=\"40mm\""), "{}", &text[..400]);
    assert!(text.contains("viewBox=\"0 0 188.976 151.181\""), "{}", &text[..400]);
    folder.ok("fill leaves.svg --size 2inx1in -o b.svg");
    assert!(folder.text("b.svg").contains("width=\"2in\" height=\"1in\" viewBox=\"0 0 192 96\""));
}

#[test]
fn millimetres_in_are_millimetres_out() {
    let folder = Folder::new();
    folder.write(
        "mm.svg",
        common::leaves().replace("width=\"80\" height=\"80\" viewBox", "width=\"80mm\" height=\"80mm\" viewBox"),
    );
    folder.ok("fill mm.svg --size 120x100 -o a.svg");
    assert!(folder.text("a.svg").contains("width=\"120mm\" height=\"100mm\" viewBox=\"0 0 120 100\""));
}

#[test]
fn a_domain_in_millimetres_meets_an_exemplar_in_pixels() {
    let folder = Folder::new();
    let ring = common::ring().replace("width=\"160\" height=\"160\" viewBox", "width=\"80mm\" height=\"80mm\" viewBox");
    folder.write("mm.svg", ring);
    folder.ok("fill leaves.svg --domain mm.svg -o a.svg");
    let text = folder.text("a.svg");
    assert!(text.contains("width=\"80mm\" height=\"80mm\" viewBox=\"0 0 302.362 302.362\""), "{}", &text[..500]);
    let placed = attributes(drawn(&text), "data-arabesque-source").len();
    assert!((120..260).contains(&placed), "{placed} elements on 4 times the area of the exemplar and more");
}

#[test]
fn a_domain_with_a_hole_is_filled_and_nothing_else() {
    let folder = Folder::new();
    let value = json(&folder, "fill leaves.svg --domain ring.svg --border cross");
    for p in value["placements"].as_array().unwrap() {
        let centre = &p["centre"];
        let r = (centre[0].as_f64().unwrap() - 80.0).hypot(centre[1].as_f64().unwrap() - 80.0);
        assert!((24.5..=70.5).contains(&r), "a centre at radius {r}");
    }
    // The rows go on where they are in the exemplar: at odd tens from the middle, 28 of which lie in the ring.
    assert_eq!(count(&value), 28);
    folder.ok("fill leaves.svg --domain ring.svg#ring -o a.svg");
    assert!(folder.text("a.svg").contains("clip-path=\"url(#arabesque-domain)\""));
    assert!(folder.fails(3, "fill leaves.svg --domain ring.svg#rong -o a2.svg").contains("rong"));
}

#[test]
fn border_inside_is_stricter_than_cross_and_cross_than_clip() {
    let folder = Folder::new();
    let reach = |border: &str| {
        let value = json(&folder, &format!("fill leaves.svg --size 100x100 --border {border}"));
        let outside = |p: &Value| {
            let (x, y) = (p["centre"][0].as_f64().unwrap(), p["centre"][1].as_f64().unwrap());
            [x, y, 100.0 - x, 100.0 - y].into_iter().fold(f64::INFINITY, f64::min)
        };
        value["placements"].as_array().unwrap().iter().map(outside).fold(f64::INFINITY, f64::min)
    };
    assert!(reach("inside") >= 2.9, "an element reaches over the border");
    assert!(reach("cross") >= -1e-6, "a centre lies outside");
    assert!(reach("clip") >= -6.1, "an element lies wholly outside");
}

#[test]
fn a_tile_repeats_what_crosses_its_edge() {
    let folder = Folder::new();
    let birds = common::example("birds.svg");
    folder.ok(&format!("fill {birds} --tile 90x70 -o tile.svg"));
    let text = folder.text("tile.svg");
    let all = attributes(drawn(&text), "data-arabesque-source").len();
    let ids = attributes(drawn(&text), "id");
    let copies = ids
        .iter()
        .filter(|id| id.matches('-').count() == 2 && id.starts_with("arabesque-") && !id.contains("element"))
        .count();
    assert!(copies > 0 && copies < all, "{copies} copies of {all}");
    folder.ok(&format!("fill {birds} --tile 90x70 -o tile.png"));
    assert_eq!(pixels(&folder.read("tile.png")).0, 90);
}

#[test]
fn a_quarter_turn_swaps_the_axes_of_every_element() {
    let folder = Folder::new();
    let value = json(&folder, "fill leaves.svg --size 120x120 --orient 90 --set attributes=kept");
    for p in value["placements"].as_array().unwrap() {
        let t: Vec<f64> = p["transform"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
        assert!(t[0].abs() < 0.3 && t[1] > 0.9, "{t:?}");
    }
}

#[test]
fn scale_and_density_change_size_and_number() {
    let folder = Folder::new();
    let plain = count(&json(&folder, "fill leaves.svg --size 160x160"));
    let value = json(&folder, "fill leaves.svg --size 160x160 --scale 2");
    let t = value["placements"][0]["transform"].as_array().unwrap();
    let scale = t[0].as_f64().unwrap().hypot(t[1].as_f64().unwrap());
    assert!((scale - 2.0).abs() < 0.3, "{scale}");
    assert!(count(&value) < plain / 2);
    assert!(count(&json(&folder, "fill leaves.svg --size 160x160 --density 0.4")) < plain * 7 / 10);
}

#[test]
fn pictures_steer_scale_density_and_direction() {
    let folder = Folder::new();
    let halves = |line: &str| {
        let value = json(&folder, line);
        let right = |p: &&Value| p["centre"][0].as_f64().unwrap() > 80.0;
        let all = value["placements"].as_array().unwrap();
        let n = all.iter().filter(right).count();
        (all.len() - n, n)
    };
    let (left, right) = halves("fill leaves.svg --size 160x160 --density ramp.png@0.2..1");
    assert!(right > left, "{left} {right}");
    let (left, right) = halves("fill leaves.svg --size 160x160 --scale ramp.png");
    assert!(left > right, "{left} {right}");
    folder.ok("fill leaves.svg --size 80x80 --orient ramp.png -o a.svg");
}

#[test]
fn strokes_turn_the_pattern() {
    let folder = Folder::new();
    folder.write(
        "flow.svg",
        common::svg("120", "120", "0 0 120 120", "<path d=\"M60 5L60 115\" fill=\"none\" stroke=\"#000\"/>"),
    );
    let value = json(&folder, "fill leaves.svg --size 120x120 --orient flow.svg");
    let turned =
        value["placements"].as_array().unwrap().iter().filter(|p| p["transform"][1].as_f64().unwrap() > 0.9).count();
    assert!(turned * 10 >= count(&value) * 9, "{turned} of {}", count(&value));
}

#[test]
fn avoided_shapes_stay_free() {
    let folder = Folder::new();
    folder.write(
        "hole.svg",
        common::svg("160", "160", "0 0 160 160", "<rect x=\"50\" y=\"50\" width=\"60\" height=\"60\"/>"),
    );
    folder.write("corner.svg", common::svg("160", "160", "0 0 160 160", "<rect width=\"30\" height=\"30\"/>"));
    let value = json(&folder, "fill leaves.svg --size 160x160 --avoid hole.svg --avoid corner.svg");
    for p in value["placements"].as_array().unwrap() {
        let (x, y) = (p["centre"][0].as_f64().unwrap(), p["centre"][1].as_f64().unwrap());
        assert!(!((50.0..110.0).contains(&x) && (50.0..110.0).contains(&y)), "{x} {y}");
        assert!(!(x < 30.0 && y < 30.0), "{x} {y}");
    }
    assert!(count(&value) > 20);
}

#[test]
fn kept_elements_stay_where_they_are() {
    let folder = Folder::new();
    let kept = "<circle class=\"berry\" cx=\"61.25\" cy=\"47.5\" r=\"3\" fill=\"#c22\"/>";
    folder.write("kept.svg", common::svg("120", "120", "0 0 120 120", kept));
    let value = json(&folder, "fill leaves.svg --size 120x120 --keep kept.svg");
    let placed: Vec<_> = value["placements"].as_array().unwrap().iter().filter(|p| p.get("kept").is_some()).collect();
    assert_eq!(placed.len(), 1);
    assert_eq!(placed[0]["class"], "berry");
    assert_eq!(placed[0]["centre"], serde_json::json!([61.25, 47.5]));
    folder.ok("fill leaves.svg --size 120x120 --keep kept.svg -o a.svg");
    assert!(folder.text("a.svg").contains("data-arabesque-kept=\"true\""));
}

#[test]
fn the_engine_takes_its_options() {
    let folder = Folder::new();
    for option in [
        "--preset ma2011",
        "--preset tu2020",
        "--levels 1",
        "--iterations 1",
        "--radius 25",
        "--method elements",
        "--set levels=1 --set iterations=2",
    ] {
        folder.ok(&format!("fill leaves.svg --size 80x80 {option} -o a.svg"));
        let name = option.split_whitespace().nth(1).unwrap().split('=').next().unwrap();
        assert!(folder.text("a.svg").contains(name), "{option} is not in the recipe");
    }
    let value = json(&folder, "fill leaves.svg --size 80x80 --levels 1 --iterations 2");
    assert!(value["energy"].as_array().unwrap().iter().all(|e| e["level"] == 0));
}

#[test]
fn elements_bend_only_when_asked_to() {
    let folder = Folder::new();
    let exemplar = common::example("feathers.svg");
    let value = json(&folder, &format!("fill {exemplar} --size 160x160"));
    assert!(value["placements"].as_array().unwrap().iter().all(|p| p.get("control").is_none()));
    let value = json(&folder, &format!("fill {exemplar} --size 160x160 --set deform=arap"));
    assert!(value["placements"].as_array().unwrap().iter().any(|p| p.get("control").is_some()));
    folder.ok(&format!("fill {exemplar} --size 160x160 --set deform=arap -o a.svg"));
    assert!(folder.text("a.svg").lines().any(|l| l.starts_with("<g id=") && l.contains("data-arabesque-source")));
}

#[test]
fn seeds_differ_and_variations_have_their_own() {
    let folder = Folder::new();
    let output = folder.ok("fill leaves.svg --size 80x80 --seed 5 --variations 3 -o v.svg --json");
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["outputs"][2]["path"], "v-3.svg");
    assert_eq!(summary["outputs"][2]["seed"], 7);
    folder.ok("fill leaves.svg --size 80x80 --seed 6 -o one.svg");
    assert_eq!(folder.read("one.svg"), folder.read("v-2.svg"));
    assert_ne!(folder.read("v-1.svg"), folder.read("v-2.svg"));
    assert!(!folder.path("v.svg").exists());
}

#[test]
fn pictures_have_the_size_that_was_asked_for() {
    let folder = Folder::new();
    for (option, size) in [("", 80), ("--dpi 192", 160), ("--pixels-per-unit 3", 240)] {
        folder.ok(&format!("fill leaves.svg --size 80x40 {option} -o a.png"));
        let (width, height, rgba) = pixels(&folder.read("a.png"));
        assert_eq!((width, height), (size, size / 2), "{option}");
        assert!(rgba.chunks_exact(4).all(|p| p[3] == 255), "the background is missing");
    }
}

#[test]
fn format_goes_by_extension_or_by_name() {
    let folder = Folder::new();
    folder.ok("fill leaves.svg --size 80x80 --format csv -o points.txt");
    assert!(folder.text("points.txt").starts_with("x,y,class\n"));
    folder.ok("fill leaves.svg --size 80x80 -o noextension");
    assert!(folder.text("noextension").starts_with("<?xml"));
    folder.ok("fill leaves.svg --size 80x80 -o job.toml");
    assert!(folder.text("job.toml").contains("size = \"80x80\""));
    assert!(folder.fails(2, "fill leaves.svg --size 80x80 -o a.swg").contains("did you mean svg"));
}

#[test]
fn points_in_and_points_out() {
    let folder = Folder::new();
    folder.ok("fill points.csv --size 3x3 -o out.csv");
    let text = folder.text("out.csv");
    let rows: Vec<Vec<&str>> =
        text.lines().skip(1).filter(|l| !l.starts_with('#')).map(|l| l.split(',').collect()).collect();
    assert!((600..1200).contains(&rows.len()), "{}", rows.len());
    assert!(rows.iter().all(|r| ["a", "b"].contains(&r[2])));
    assert!(rows.iter().all(|r| r[..2].iter().all(|v| (0.0..=3.0).contains(&v.parse::<f64>().unwrap()))));
    folder.ok("fill points.csv --size 2x2 -o out.svg");
    assert!(folder.text("out.svg").contains("<circle"));
}

#[test]
fn a_file_can_be_a_whole_job() {
    let folder = Folder::new();
    let leaves = common::leaves();
    let elements = leaves.lines().filter(|l| l.contains("class=")).collect::<Vec<_>>().join("\n");
    let layer =
        |label: &str, body: &str| format!("<g inkscape:groupmode=\"layer\" inkscape:label=\"{label}\">{body}</g>\n");
    let body = layer("Exemplar", &format!("<rect width=\"80\" height=\"80\" fill=\"#fff\"/>{elements}"))
        + &layer("Domain", "<circle cx=\"200\" cy=\"80\" r=\"70\"/>")
        + &layer("Avoid", "<rect x=\"190\" y=\"70\" width=\"20\" height=\"20\"/>");
    folder.write("job.svg", common::svg("300", "160", "0 0 300 160", &body));
    let value = json(&folder, "fill job.svg --border cross");
    assert!(count(&value) > 15);
    for p in value["placements"].as_array().unwrap() {
        let (x, y) = (p["centre"][0].as_f64().unwrap() - 200.0, p["centre"][1].as_f64().unwrap() - 80.0);
        assert!(x.hypot(y) <= 70.5 && !(x.abs() < 10.0 && y.abs() < 10.0), "{x} {y}");
    }
    let value = json(&folder, "fill job.svg --size 100x100");
    assert_eq!(value["page"]["size"], serde_json::json!([100.0, 100.0]));
}

#[test]
fn a_time_limit_is_told() {
    let folder = Folder::new();
    // Too short for any machine: there is nothing to be written.
    let message = folder.fails(4, "fill points.csv --size 8x8 --time-limit 0.000001s -o a.csv");
    assert!(message.contains("the time was up"), "{message}");
    assert!(!folder.names().contains(&"a.csv".to_owned()));
    // Too short again, with something to show: points without any order, whose neighbourhoods never agree.
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / (1_u64 << 24) as f64
    };
    let dots: String = (0..400).map(|_| format!("{},{}\n", random(), random())).collect();
    folder.write("dots.csv", format!("x,y\n{dots}"));
    let line = "fill dots.csv --size 12x12 --iterations 1000 --time-limit 6s -o a.csv";
    let output = folder.ok(line);
    assert!(stderr(&output).contains("stopped early (time limit)"), "{}", stderr(&output));
    assert!(folder.text("a.csv").lines().count() > 2);
}

#[test]
fn inspect_says_what_was_understood() {
    let folder = Folder::new();
    let text = stdout(&folder.ok("inspect leaves.svg"));
    assert!(
        text.contains("elements: 16") && text.contains("class leaf: 8 elements") && text.contains("class berry"),
        "{text}"
    );
    let value: Value = serde_json::from_slice(&folder.ok("inspect leaves.svg --json -o a.svg").stdout).unwrap();
    assert_eq!(value["elements"], 16);
    assert_eq!(value["classes"][0]["name"], "leaf");
    assert!((value["spacing"].as_f64().unwrap() - 20.0).abs() < 0.1);
    // The elements, and a cell of the repeat.
    assert_eq!(folder.text("a.svg").matches("<title>").count(), 17);
    folder.ok("inspect points.csv -o a.png");
    assert!(pixels(&folder.read("a.png")).0 > 50);
    assert!(stdout(&folder.ok("inspect leaves.svg -o -")).starts_with("<svg"));
}

#[test]
fn completions_and_manual_are_written() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        assert!(stdout(&folder.ok(&format!("completions {shell}"))).contains("inspect"), "{shell}");
    }
    assert!(stdout(&folder.ok("man")).contains(".TH arabesque"));
    assert!(stdout(&folder.ok("man fill")).contains("variations"));
    assert!(folder.fails(2, "man fil").contains("did you mean fill"));
}

#[test]
fn the_long_help_lists_every_parameter() {
    let folder = Folder::new();
    let help = stdout(&folder.ok("fill --help"));
    for word in ["matching", "search", "initialisation", "existence", "ma2011", "--time-limit"] {
        assert!(help.contains(word), "{word}");
    }
    assert!(stdout(&folder.ok("--version")).starts_with("arabesque "));
}
