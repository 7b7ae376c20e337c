//! The commands of README.md and docs/gallery.md, run as they stand.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, its helpers too")]

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

const CARGO_RUN: &str = "cargo run --release -- ";
const PROGRAM: &str = "arabesque ";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// An empty folder with a copy of `examples/`.
fn workshop(name: &str) -> PathBuf {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    if dir.exists() {
        fs::remove_dir_all(&dir).unwrap();
    }
    fs::create_dir_all(dir.join("examples")).unwrap();
    for entry in fs::read_dir(root().join("examples")).unwrap() {
        let from = entry.unwrap().path();
        fs::copy(&from, dir.join("examples").join(from.file_name().unwrap())).unwrap();
    }
    dir
}

/// The arguments of every call of the program in the code blocks of a Markdown text. A backslash continues a line.
fn calls(text: &str) -> Vec<Vec<String>> {
    let mut calls = Vec::new();
    let mut in_block = false;
    let joined = text.replace("\\\n", " ");
    for line in joined.lines() {
        if line.starts_with("```") {
            in_block = !in_block;
        }
        let line = line.trim();
        let arguments = line.strip_prefix(CARGO_RUN).or_else(|| line.strip_prefix(PROGRAM));
        if let (true, Some(arguments)) = (in_block, arguments) {
            assert!(!arguments.contains(['|', '>', '$', '&', '"', '\'']), "{line}: only plain words can be checked");
            calls.push(arguments.split_whitespace().map(str::to_owned).collect());
        }
    }
    calls
}

/// The files that a call with these arguments leaves behind.
fn outputs(arguments: &[String]) -> Vec<String> {
    let after = |name: &str| arguments.iter().position(|a| a == name).and_then(|k| arguments.get(k + 1));
    let Some(out) = after("-o").filter(|out| *out != "-") else { return Vec::new() };
    let Some(count) = after("--variations").map(|n| n.parse::<usize>().unwrap()) else { return vec![out.clone()] };
    let (stem, ending) = out.rsplit_once('.').unwrap();
    (1..=count).map(|k| format!("{stem}-{k}.{ending}")).collect()
}

/// Runs every call of a document in one folder, and returns how many there were.
fn run_document(name: &str) -> usize {
    let dir = workshop(&name.replace('/', "-"));
    let calls = calls(&fs::read_to_string(root().join(name)).unwrap());
    for arguments in &calls {
        let line = arguments.join(" ");
        let result = Command::new(env!("CARGO_BIN_EXE_arabesque")).args(arguments).current_dir(&dir).output().unwrap();
        assert!(result.status.success(), "{name}: arabesque {line}\n{}", String::from_utf8_lossy(&result.stderr));
        for out in outputs(arguments) {
            let size = fs::metadata(dir.join(&out)).map_or(0, |m| m.len());
            assert!(size > 0, "{name}: arabesque {line}\nleft no {out}");
            if let [command, result, ..] = arguments.as_slice()
                && command == "run"
            {
                let same = fs::read(dir.join(result)).unwrap() == fs::read(dir.join(&out)).unwrap();
                assert!(same, "{name}: arabesque {line}\n{out} is not {result} again");
            }
        }
    }
    calls.len()
}

#[test]
fn the_commands_of_the_readme_work() {
    assert!(run_document("README.md") >= 5);
}

#[test]
fn the_commands_of_the_gallery_work() {
    assert!(run_document("docs/gallery.md") >= 6);
}

#[test]
fn the_recipe_of_the_documentation_works() {
    let dir = workshop("formats");
    let text = fs::read_to_string(root().join("docs/formats.md")).unwrap();
    let (_, after) = text.split_once("```toml\n").unwrap();
    fs::write(dir.join("recipe.toml"), after.split_once("```").unwrap().0).unwrap();
    let arguments = ["run", "recipe.toml", "-o", "out.svg"];
    let result = Command::new(env!("CARGO_BIN_EXE_arabesque")).args(arguments).current_dir(&dir).output().unwrap();
    assert!(result.status.success(), "{}", String::from_utf8_lossy(&result.stderr));
    assert!(fs::metadata(dir.join("out.svg")).unwrap().len() > 0);
}

#[test]
fn calls_are_found_in_code_blocks_only() {
    let text =
        "arabesque prose\n```sh\ncargo run --release -- fill a.svg \\\n    -o b.svg --variations 2\ncargo test\n```\n";
    let found = calls(text);
    assert_eq!(found, [["fill", "a.svg", "-o", "b.svg", "--variations", "2"]]);
    assert_eq!(outputs(&found[0]), ["b-1.svg", "b-2.svg"]);
}
