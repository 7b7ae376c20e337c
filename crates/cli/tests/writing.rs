//! Files are written whole or not at all.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod common;

#[cfg(unix)]
use std::{
    io::{BufRead, BufReader},
    process::{Child, ChildStderr, Stdio},
};

use common::{Folder, stderr};

#[test]
fn a_place_that_cannot_be_written_is_noticed_first() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("folder.svg")).unwrap();
    for out in ["nowhere/a.svg", "folder.svg", "leaves.svg/a.svg"] {
        // The exemplar is missing too: the place is looked at before any file is read.
        let message = folder.fails(1, &format!("fill missing.svg --size 80x80 -o {out}"));
        assert!(message.contains("cannot write the result") && message.contains(out), "{message}");
    }
}

#[test]
fn a_failed_run_leaves_the_old_result() {
    let folder = Folder::new();
    folder.write("out.svg", "precious");
    folder.fails(1, "fill leaves.svg --size 80x80 -o out.svg");
    folder.fails(4, "fill leaves.svg --size 1x1 --force -o out.svg");
    folder.fails(3, "fill ring.csv --size 80x80 --force -o out.svg");
    assert_eq!(folder.text("out.svg"), "precious");
    folder.ok("fill leaves.svg --size 80x80 --force -o out.svg");
    assert!(folder.text("out.svg").starts_with("<?xml"));
    assert!(folder.names().iter().all(|n| !n.ends_with(".part")));
}

#[test]
fn the_exemplar_may_be_replaced_by_its_result_where_that_is_meant() {
    let folder = Folder::new();
    let before = folder.read("leaves.svg");
    folder.ok("fill leaves.svg --size 80x80 -o leaves.svg --force");
    assert!(folder.read("leaves.svg.orig") == before);
    folder.ok("run leaves.svg -o again.svg");
    assert!(folder.read("leaves.svg") == folder.read("again.svg"));
}

#[cfg(unix)]
#[test]
fn links_and_devices_keep_what_they_are() {
    let folder = Folder::new();
    folder.write("real.svg", "old");
    std::os::unix::fs::symlink("real.svg", folder.path("link.svg")).unwrap();
    folder.ok("fill leaves.svg --size 80x80 --force -o link.svg");
    assert!(folder.path("link.svg").is_symlink());
    assert!(folder.text("real.svg").starts_with("<?xml"));
    folder.ok("fill leaves.svg --size 80x80 --format svg -o /dev/null");
}

/// A long run that has understood its exemplar, with what it goes on to say.
#[cfg(unix)]
fn long_run(folder: &Folder, more: &str) -> (Child, BufReader<ChildStderr>) {
    let mut child = folder
        .command(&format!("fill points.csv --size 25x25 --iterations 1000 --set repeat=off -v {more}"))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut told = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains("level 1") {
        line.clear();
        assert!(told.read_line(&mut line).unwrap() > 0, "the run ended before it began");
    }
    (child, told)
}

/// Asks to end, which a program that was started in the background hears too (it does not hear Ctrl-C); to nobody if the program has just ended.
#[cfg(unix)]
fn interrupt(child: &Child) {
    std::process::Command::new("kill").args(["-TERM", &child.id().to_string()]).output().unwrap();
}

#[cfg(unix)]
#[test]
fn a_signal_writes_the_best_so_far() {
    let folder = Folder::new();
    let (child, _told) = long_run(&folder, "-o out.csv --json");
    interrupt(&child);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(143));
    let text = folder.text("out.csv");
    assert!(text.starts_with("x,y,class\n") && text.lines().count() > 2);
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["outputs"][0]["stopped"], "interrupted");
}

#[cfg(unix)]
#[test]
fn a_second_ctrl_c_ends_at_once_without_half_a_file() {
    let folder = Folder::new();
    let before = folder.names();
    let (mut child, _told) = long_run(&folder, "-o out.csv");
    interrupt(&child);
    interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(143));
    let after: Vec<_> = folder.names().into_iter().filter(|n| n != "out.csv").collect();
    assert_eq!(after, before);
}

/// Width and height of a PNG file.
fn pixels(png: &[u8]) -> [u32; 2] {
    [16, 20].map(|at| u32::from_be_bytes(png[at..at + 4].try_into().unwrap()))
}

#[cfg(unix)]
#[test]
fn whoever_asks_to_stop_gets_a_draft_of_the_picture() {
    let folder = Folder::new();
    let (child, mut told) = long_run(&folder, "-o out.png --pixels-per-unit 200");
    interrupt(&child);
    let mut said = String::new();
    std::io::Read::read_to_string(&mut told, &mut said).unwrap();
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(143), "{said}");
    assert!(said.contains("a draft of 632 x 632 pixels, where 5000 x 5000 were wanted"), "{said}");
    assert_eq!(pixels(&folder.read("out.png")), [632, 632]);
    let recipe = b"arabesque recipe";
    assert!(folder.read("out.png").windows(recipe.len()).any(|part| part == recipe));
}

#[test]
fn a_picture_that_is_too_much_work_is_a_draft() {
    let folder = Folder::new();
    let line = "fill points.csv --size 8x8 --pixels-per-unit 700 -o out.png --limit work-per-element=50";
    let said = stderr(&folder.ok(&format!("{line} --limit work=500")));
    assert!(said.contains("a draft of 632 x 632 pixels, where 5600 x 5600 were wanted"), "{said}");
    assert_eq!(pixels(&folder.read("out.png")), [632, 632]);
}
