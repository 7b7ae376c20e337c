//! `arabesque edit`: elements of results, and all that are in places like theirs.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

#[path = "../common/mod.rs"]
mod common;

use common::{Folder, example};

/// The lines of a result that hold elements.
fn elements(text: &str) -> Vec<&str> {
    text.lines().filter(|line| line.starts_with("<use ")).collect()
}

fn json(folder: &Folder, call: &str) -> serde_json::Value {
    serde_json::from_slice(&folder.ok(call).stdout).unwrap()
}

fn refused(folder: &Folder, call: &str, code: i32, expected: &str) {
    let message = folder.fails(code, call);
    assert!(message.contains(expected), "{call}: {message}");
}

/// Numbers of the elements that a call changes.
fn changed(folder: &Folder, call: &str) -> Vec<u64> {
    let told = json(folder, &format!("{call} --json"));
    told["changed"].as_array().unwrap().iter().map(|change| change["id"].as_u64().unwrap()).collect()
}

#[test]
fn one_element_moves_and_the_rest_stays_to_the_last_bit() {
    let folder = Folder::new();
    folder.ok("fill leaves.svg --size 120x120 -o a.svg");
    folder.ok("edit a.svg --item 5 --move 1.5,-0.25 --turn 30 --scale 1.25 -o b.svg");
    let (a, b) = (folder.text("a.svg"), folder.text("b.svg"));
    let differ: Vec<_> = elements(&a).into_iter().zip(elements(&b)).filter(|(a, b)| a != b).collect();
    assert!(differ.len() == 1 && differ[0].0.contains("id=\"arabesque-5\""), "{differ:?}");
    folder.ok("edit b.svg --item arabesque-5 --scale 0.8 -o c.svg");
    folder.ok("edit c.svg --item 5 --turn -30 -o d.svg");
    folder.ok("edit d.svg --item 5 --move -1.5,0.25 -o e.svg");
    assert_eq!(elements(&folder.text("e.svg")), elements(&a));
    folder.ok("run e.svg -o f.svg --threads 1");
    assert!(folder.text("e.svg") == folder.text("f.svg"));
}

#[test]
fn an_edit_spreads_to_all_equal_places_and_none_else() {
    let folder = Folder::new();
    folder.ok("fill leaves.svg --size 160x120 -o a.svg");
    let listed = json(&folder, "edit a.svg --list --json");
    let of_class = |class: &str| -> Vec<u64> {
        let items = listed["items"].as_array().unwrap().iter().filter(|item| item["class"] == class);
        let mut ids: Vec<u64> = items.map(|item| item["id"].as_u64().unwrap()).collect();
        ids.sort_unstable();
        ids
    };
    let mut ids = changed(&folder, "edit a.svg --at 70,50 --set fill=#00f --propagate -o b.svg");
    ids.sort_unstable();
    let [leaves, berries] = [of_class("leaf"), of_class("berry")];
    assert!(ids == leaves || ids == berries, "{ids:?}");
    folder.ok("run b.svg -o c.svg");
    assert!(folder.text("b.svg") == folder.text("c.svg"));
    // A picture of the edited result is the same however it is made.
    folder.ok("run b.svg -o c.png");
    folder.ok("edit a.svg --at 70,50 --set fill=#00f --propagate -o b.png");
    assert!(folder.read("b.png") == folder.read("c.png"));
}

#[test]
fn elements_are_inserted_and_deleted_everywhere() {
    let folder = Folder::new();
    folder.ok("fill points.csv --size 2x2 -o a.svg");
    let all = json(&folder, "edit a.svg --list --json")["elements"].as_u64().unwrap();
    let new = changed(&folder, "edit a.svg --insert a@0.95,0.95 --propagate -o b.svg");
    assert!(new.len() > 100 && new.iter().all(|id| *id >= all), "{new:?}");
    folder.ok("run b.svg -o c.svg");
    assert!(folder.text("b.svg") == folder.text("c.svg"));
    // What was inserted is in equal places itself, and goes as it came.
    let gone = changed(&folder, &format!("edit b.svg --item {} --delete --propagate -o d.svg", new[0]));
    assert_eq!(gone, new);
    assert_eq!(elements(&folder.text("d.svg")), elements(&folder.text("a.svg")));
    let summary = json(&folder, "run b.svg -o e.csv --json");
    assert_eq!(summary["outputs"][0]["elements"].as_u64().unwrap(), all + new.len() as u64);
    assert_eq!(folder.text("e.csv").lines().filter(|l| !l.starts_with('#')).count() as u64, 1 + all + new.len() as u64);
}

#[test]
fn tables_json_and_scenes_are_edited_too() {
    let folder = Folder::new();
    let scene = example("scene-bricks.glb");
    folder.ok("fill points.csv --size 2x2 -o a.csv");
    folder.ok("fill points.csv --size 2x2 -o a.json");
    folder.ok(&format!("fill {scene} --box 6x4x3 -o a.glb"));
    folder.ok(&format!("fill {scene} --box 6x4x3 -o a.gltf"));
    for (ending, shift, back) in [
        ("csv", "0.01,0.02", "-0.01,-0.02"),
        ("json", "0.01,0.02", "-0.01,-0.02"),
        ("glb", "0.1,0,0.05", "-0.1,0,-0.05"),
        ("gltf", "0.1,0,0.05", "-0.1,0,-0.05"),
    ] {
        folder.ok(&format!("edit a.{ending} --item 3 --move {shift} --propagate -o b.{ending}"));
        folder.ok(&format!("run b.{ending} -o c.{ending}"));
        assert!(folder.read(&format!("b.{ending}")) == folder.read(&format!("c.{ending}")), "{ending}");
        folder.ok(&format!("edit b.{ending} --item 3 --move {back} --propagate -o d.{ending}"));
        folder.ok(&format!("run d.{ending} -o e.{ending} --no-edits"));
        assert!(folder.read(&format!("a.{ending}")) == folder.read(&format!("e.{ending}")), "{ending}");
    }
    let rows = |name: &str| {
        folder.text(name).lines().take_while(|l| !l.starts_with('#')).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(rows("d.csv"), rows("a.csv"));
    folder.ok("edit a.glb --item 2 --turn 90 --axis 1,0,0 --set fill=#c0392b -o red.glb");
    folder.ok("run red.glb -o red.png");
    refused(&folder, "edit a.csv --item 3 --turn 10 -o b.csv", 3, "turning or scaling points of a table");
}

#[test]
fn bricks_of_all_colours_are_alike_where_only_places_count() {
    let folder = Folder::new();
    let bricks = example("bricks.svg");
    folder.ok(&format!("fill {bricks} --size 300x200 -o a.svg"));
    let call = "edit a.svg --at 150,100 --turn 5 --propagate=0.1 --preview";
    assert_eq!(changed(&folder, call).len(), 1);
    assert!(changed(&folder, &format!("{call} --any-class")).len() > 200);
}

#[test]
fn a_preview_marks_what_would_change_and_leaves_the_rest() {
    let folder = Folder::new();
    folder.ok("fill leaves.svg --size 120x120 -o a.svg");
    let before = folder.text("a.svg");
    let told = String::from_utf8(folder.ok("edit a.svg --item 5 --move 3,0 --preview").stdout).unwrap();
    assert!(told.contains("  5: ") && told.contains(" from ") && told.contains(" to "), "{told}");
    folder.ok("edit a.svg --item 5 --delete --preview -o b.svg");
    let marked = folder.text("b.svg");
    assert!(marked.contains("id=\"arabesque-preview\"") && marked.contains("id=\"arabesque-5\""));
    folder.ok("edit a.svg --item 5 --move 3,0 --preview -o b.png");
    assert_eq!(folder.text("a.svg"), before);
}

#[test]
fn what_cannot_be_done_is_told() {
    let folder = Folder::new();
    folder.ok("fill leaves.svg --size 120x120 -o a.svg");
    folder.ok("fill leaves.svg --size 120x120 -o a.png");
    folder.ok("fill leaves.svg --size 120x120 -o a.toml");
    for (call, code, expected) in [
        ("edit a.svg --item 5 --move 1,1", 2, "give -o OUT, or --preview"),
        ("edit a.svg --item 999 --delete -o b.svg", 2, "the number of one of the"),
        ("edit a.svg --item x --delete -o b.svg", 2, "expected the number of an element"),
        ("edit a.svg --item 5 --class lef -o b.svg", 2, "did you mean leaf"),
        ("edit a.svg --insert lef@1,1 -o b.svg", 2, "did you mean leaf"),
        ("edit a.svg --item 5 --delete --turn 3 -o b.svg", 2, "cannot be used with"),
        ("edit a.svg --item 5 --scale 0 -o b.svg", 2, "a factor from"),
        ("edit a.svg --item 5 --scale nan -o b.svg", 2, "a factor from"),
        ("edit a.svg --item 5 --turn inf -o b.svg", 2, "turn = inf"),
        ("edit a.svg --item 5 --move nan,1 -o b.svg", 2, "two or three numbers"),
        ("edit a.svg --item 5 --move 1,2,3 -o b.svg", 2, "as the result has 2 dimensions"),
        ("edit a.svg --item 5 --delete --propagate=-1 -o b.svg", 2, "mean spacings"),
        ("edit a.svg --item 5 -o b.svg", 2, "no change"),
        ("edit a.svg --turn 5 -o b.svg", 2, "the numbers of the elements"),
        ("edit a.svg --item 5 --set fil=red -o b.svg", 2, "did you mean fill"),
        ("edit a.svg --item 5 --delete -o b.json", 3, "writing an edited svg as json"),
        ("edit a.png --item 5 --delete -o b.png", 3, "does not say where each element is"),
        ("edit a.toml --item 5 --delete -o b.svg", 3, "a recipe, where a result was expected"),
        ("edit leaves.svg --item 5 --delete -o b.svg", 3, "no element that arabesque placed"),
        ("edit missing.svg --item 5 --delete -o b.svg", 3, "no such file"),
    ] {
        refused(&folder, call, code, expected);
    }
}

#[test]
fn edits_of_another_result_are_refused() {
    let folder = Folder::new();
    folder.ok("fill leaves.svg --size 120x120 -o a.svg");
    folder.ok("edit a.svg --item 5 --delete -o b.svg");
    let text = folder.text("b.svg").replace("size = \"120x120\"", "size = \"160x120\"");
    folder.write("c.svg", &text);
    refused(&folder, "run c.svg -o d.svg", 3, "made to another result than this run made");
    folder.ok("run c.svg -o d.svg --no-edits");
    let anyhow: String =
        text.lines().filter(|line| !line.starts_with("of = ")).map(|line| format!("{line}\n")).collect();
    folder.write("c.svg", anyhow);
    folder.ok("run c.svg -o d.svg");
    assert!(!folder.text("d.svg").contains("\"arabesque-5\""));
    let hostile = folder.text("b.svg").replace("items = [5]", "items = [18446744073709551615]");
    folder.write("c.svg", hostile);
    assert_ne!(folder.run("run c.svg -o d.svg").status.code(), Some(0));
}
