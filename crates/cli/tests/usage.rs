//! A wrong command line: exit code 2, and the nearest right one.

mod common;

use common::Folder;

#[test]
fn unknown_names_suggest_the_nearest() {
    let folder = Folder::new();
    for (line, near) in [
        ("fil leaves.svg", "fill"),
        ("fill leaves.svg --sise 80x80 -o a.svg", "--size"),
        ("fill leaves.svg --size 80x80 --border clop -o a.svg", "clip"),
        ("fill leaves.svg --size 80x80 --method element -o a.svg", "elements"),
        ("fill leaves.svg --size 80x80 --set levles=2 -o a.svg", "levels"),
        ("fill leaves.svg --size 80x80 --set search=exhaustiv -o a.svg", "exhaustive"),
        ("fill leaves.svg --size 80x80 --preset ma2012 -o a.svg", "ma2011"),
        ("fill leaves.svg --size 80x80 --format pgn -o a.svg", "png"),
        ("completions bahs", "bash"),
    ] {
        let message = folder.fails(2, line);
        assert!(message.contains(near), "{line}: {message}");
    }
}

#[test]
fn what_is_missing_or_contradicts_itself() {
    let folder = Folder::new();
    for (line, expected) in [
        ("fill leaves.svg --size 80x80", "--output"),
        ("fill leaves.svg -o a.svg", "--size"),
        ("fill --size 80x80 -o a.svg", "EXEMPLAR"),
        ("fill leaves.svg --size 80x80 --tile 80x80 -o a.svg", "--tile"),
        ("fill leaves.svg --size 80x80 --domain ring.svg -o a.svg", "--domain"),
        ("fill leaves.svg --size 80x80 --json -o -", "standard output"),
        ("fill leaves.svg --size 80x80 --variations 2 -o -", "--variations"),
        ("fill leaves.svg --size 80x80 --quiet --verbose -o a.svg", "--verbose"),
        ("fill leaves.svg --size 80x80 --dpi 90 --pixels-per-unit 2 -o a.png", "--pixels-per-unit"),
        ("fill leaves.svg --size 80x80 --set levels -o a.svg", "NAME=VALUE"),
        ("fill points.csv --size 80mmx80mm -o a.csv", "unit"),
        ("inspect leaves.svg -o a.csv", ".svg or .png"),
    ] {
        let message = folder.fails(2, line);
        assert!(message.contains(expected), "{line}: {message}");
    }
}

#[test]
fn a_drawing_is_no_structure() {
    let folder = Folder::new();
    let message = folder.fails(3, "fill leaves.svg --size 80x80 --method structures -o a.ply");
    assert!(message.contains("leaves.svg"), "{message}");
    let message = folder.fails(3, "fill leaves.svg --along leaves.svg -o a.svg");
    assert!(message.contains("along for an exemplar that is no structure of points"), "{message}");
}
