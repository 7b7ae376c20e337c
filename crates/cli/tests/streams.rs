//! What goes to standard output and standard error, and what is read from standard input.

mod common;

use std::{
    io::{Read, Write},
    process::Stdio,
};

use common::{Folder, stderr, stdout};

#[test]
fn dash_is_standard_output_and_nothing_else_goes_there() {
    let folder = Folder::new();
    let piped = folder.ok("fill leaves.svg --size 80x80 -o - -v");
    folder.ok("fill leaves.svg --size 80x80 -o a.svg");
    assert_eq!(piped.stdout, folder.read("a.svg"));
    assert!(stderr(&piped).contains("exemplar: 16 elements"));
    let piped = folder.ok("fill leaves.svg --size 80x80 --format png -o -");
    assert!(piped.stdout.starts_with(b"\x89PNG"));
}

#[test]
fn a_file_leaves_standard_output_empty() {
    let folder = Folder::new();
    let output = folder.ok("fill leaves.svg --size 80x80 -o a.svg");
    assert_eq!(stdout(&output), "");
    assert!(stderr(&output).contains("a.svg"));
    let output = folder.ok("fill leaves.svg --size 80x80 -o a.svg --quiet");
    assert_eq!(stderr(&output), "");
}

#[test]
fn no_bar_and_no_colour_without_a_terminal() {
    let folder = Folder::new();
    let output = folder.ok("fill leaves.svg --size 80x80 -o a.svg -v");
    assert!(!output.stderr.contains(&0x1b) && !output.stderr.contains(&b'\r'));
    let message = folder.fails(3, "fill missing.svg --size 80x80 -o a2.svg");
    assert!(message.starts_with("arabesque: error: ") && message.matches('\n').count() == 1, "{message:?}");
}

#[test]
fn dash_is_standard_input() {
    let folder = Folder::new();
    let mut child =
        folder.command("fill - --size 80x80 -o a.svg").stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(common::leaves().as_bytes()).unwrap();
    assert!(child.wait().unwrap().success());
    // What came from standard input cannot be read again: it travels in the result.
    folder.ok("run a.svg -o b.svg");
    assert_eq!(folder.read("a.svg"), folder.read("b.svg"));
}

#[test]
fn a_shape_may_come_from_standard_input() {
    let folder = Folder::new();
    let mut child = folder
        .command("fill leaves.svg --domain - -o a.svg")
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(common::ring().as_bytes()).unwrap();
    assert!(child.wait().unwrap().success());
    folder.ok("run a.svg -o b.svg");
    assert_eq!(folder.read("a.svg"), folder.read("b.svg"));
}

#[test]
fn the_summary_is_one_json_object() {
    let folder = Folder::new();
    let output = folder.ok("fill leaves.svg --size 80x80 -o a.svg --json --quiet");
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let made = &value["outputs"][0];
    assert_eq!(made["path"], "a.svg");
    assert_eq!(made["format"], "svg");
    assert_eq!(made["stopped"], "finished");
    let classes = made["classes"].as_object().unwrap();
    let sum: u64 = classes.values().map(|v| v.as_u64().unwrap()).sum();
    assert_eq!(Some(sum), made["elements"].as_u64());
    let output = folder.run("fill missing.svg --size 80x80 -o a.svg --json");
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["error"]["code"], 3);
    assert_eq!(output.status.code(), Some(3));
}

#[test]
fn a_reader_that_goes_away_before_the_end_is_told() {
    let folder = Folder::new();
    let mut child = folder
        .command("fill leaves.svg --size 400x400 --iterations 0 --set repeat=off -o -")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut first = [0; 16];
    child.stdout.take().unwrap().read_exact(&mut first).unwrap();
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1), "{said}");
    // The write fails, or whoever keeps watch has seen it before.
    let ways = ["standard output: the reader has gone away", "standard output: whoever reads it went away"];
    assert!(ways.iter().any(|way| said.contains(way)), "{said}");
}
