//! `--tile auto`, and what `inspect` tells of the repeat.

#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

mod common;

use common::{Folder, stdout};

fn json(folder: &Folder, line: &str) -> serde_json::Value {
    serde_json::from_str(&stdout(&folder.ok(line))).unwrap()
}

#[test]
fn the_size_that_was_used_is_recorded() {
    let folder = Folder::new();
    // Columns of leaves and berries, 20 apart, by turns.
    for (options, size, sides) in
        [("", "40x20", [40.0, 20.0]), ("--orient 90", "20x40", [20.0, 40.0]), ("--scale 0.5", "20x10", [20.0, 10.0])]
    {
        let summary = json(&folder, &format!("fill leaves.svg --tile auto {options} --force --json -o a.svg"));
        assert_eq!(summary["outputs"][0]["tile"], serde_json::json!(sides), "{options}: {summary}");
        assert_eq!(summary["outputs"][0]["elements"], 2);
        assert!(folder.text("a.svg").contains(&format!("tile = \"{size}\"")), "{options}");
        folder.ok("run a.svg --force -o b.svg");
        assert!(folder.read("a.svg") == folder.read("b.svg"), "{options}");
    }
    folder.write("job.toml", "exemplar = \"leaves.svg\"\n[fill]\ntile = \"auto\"\n");
    folder.ok("run job.toml -o c.svg");
    assert!(folder.text("c.svg").contains("tile = \"40x20\""));
    let made = [1, 2, 8].map(|n| {
        folder.ok(&format!("fill leaves.svg --tile auto --threads {n} -o {n}.png"));
        folder.read(&format!("{n}.png"))
    });
    assert!(made[0] == made[1] && made[1] == made[2]);
}

#[test]
fn what_has_no_tile_is_told() {
    let folder = Folder::new();
    for (options, expected) in [
        ("--set repeat=off", "no repeat was found"),
        ("--orient 20", "does not lie along the axes"),
        ("--scale ramp.png", "scale is not the same everywhere"),
    ] {
        let message = folder.fails(2, &format!("fill leaves.svg --tile auto {options} -o a.svg"));
        assert!(message.contains("tile") && message.contains(expected), "{options}: {message}");
    }
    let message = folder.fails(2, "fill leaves.svg --tile automatic -o a.svg");
    assert!(message.contains("automatic") && message.contains("width x height"), "{message}");
}

#[test]
fn inspect_tells_and_draws_the_repeat() {
    let folder = Folder::new();
    let text = stdout(&folder.ok("inspect leaves.svg -o seen.svg"));
    for line in ["repeats by (", "cell 800", "symmetry pmm: mirrors in two directions", "smallest seamless tile 40x20"]
    {
        assert!(text.contains(line), "{line}: {text}");
    }
    assert!(folder.text("seen.svg").contains("cell of the repeat"));
    let report = json(&folder, "inspect leaves.svg --json");
    let repeat = &report["repeat"];
    assert_eq!((repeat["extent"].as_str(), repeat["explains"].as_str()), (Some("plane"), Some("everything")));
    assert_eq!(repeat["cell"], 800.0);
    assert_eq!(repeat["smallest_tile"], serde_json::json!([40.0, 20.0]));
    assert_eq!(repeat["symmetry"], "pmm");
}
