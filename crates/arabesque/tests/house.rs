//! The rules of the house, checked by machine: which crate may know which, what stays in one room, what is cited,
//! where links lead.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, its helpers too")]

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use serde_json::Value;

/// Every crate of the house with the crates of the house that it may use.
const WALLS: &[(&str, &[&str])] = &[
    ("arabesque-core", &[]),
    ("arabesque-surface", &["arabesque-core"]),
    ("arabesque-patterns", &["arabesque-core"]),
    ("arabesque-structures", &["arabesque-core", "arabesque-surface"]),
    ("arabesque-ribbons", &["arabesque-core"]),
    ("arabesque-reliefs", &["arabesque-core", "arabesque-surface"]),
    ("arabesque-measure", &["arabesque-core"]),
    ("arabesque-io", &["arabesque-core"]),
    (
        "arabesque",
        &[
            "arabesque-core",
            "arabesque-surface",
            "arabesque-patterns",
            "arabesque-structures",
            "arabesque-ribbons",
            "arabesque-reliefs",
            "arabesque-measure",
            "arabesque-io",
        ],
    ),
    ("arabesque-studio", &["arabesque"]),
    ("arabesque-python", &["arabesque"]),
    ("arabesque-cli", &["arabesque", "arabesque-studio"]),
];

/// Heavy third parties, each with the one crate that may use it outside its tests.
const ROOMS: &[(&str, &str)] = &[
    ("anyhow", "arabesque-cli"),
    ("axum", "arabesque-studio"),
    ("clap", "arabesque-cli"),
    ("clap_complete", "arabesque-cli"),
    ("clap_mangen", "arabesque-cli"),
    ("ctrlc", "arabesque-cli"),
    ("gltf", "arabesque-io"),
    ("gltf-json", "arabesque-io"),
    ("image", "arabesque-io"),
    ("indicatif", "arabesque-cli"),
    ("nalgebra", "arabesque-core"),
    ("numpy", "arabesque-python"),
    ("png", "arabesque-io"),
    ("pyo3", "arabesque-python"),
    ("rand_chacha", "arabesque-core"),
    ("resvg", "arabesque-io"),
    ("roxmltree", "arabesque-io"),
    ("tokio", "arabesque-studio"),
    ("usvg", "arabesque-io"),
];

/// Folders of the crates that compute and nothing else, and what their sources must not touch.
const PURE: &[&str] = &["core", "surface", "patterns", "structures", "ribbons", "reliefs", "measure"];
const OUTSIDE: &[&str] = &["std::fs", "std::env", "std::net", "std::process"];

/// Largest picture of the documentation, in bytes.
const PICTURE_BYTES: u64 = 150_000;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// The files below `dir` whose names end in one of `endings`, in order, without build output and version control.
fn files(dir: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let Ok(entries) = fs::read_dir(dir) else { return found };
    for entry in entries {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            if !["target", ".git", "out"].contains(&name.as_str()) {
                found.extend(files(&path, endings));
            }
        } else if endings.iter().any(|e| name.ends_with(e)) {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn packages() -> Vec<Value> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

/// What is wrong with the dependencies of `package`, one line each.
fn trespasses(package: &Value) -> Vec<String> {
    let name = package["name"].as_str().unwrap();
    let Some((_, allowed)) = WALLS.iter().find(|(room, _)| *room == name) else {
        return vec![format!("{name} is a crate that the table of walls does not know")];
    };
    let mut wrong = Vec::new();
    for dependency in package["dependencies"].as_array().unwrap() {
        let other = dependency["name"].as_str().unwrap();
        let for_tests = dependency["kind"].as_str() == Some("dev");
        if WALLS.iter().any(|(room, _)| *room == other) && !allowed.contains(&other) {
            wrong.push(format!("{name} -> {other}: not an edge of the house"));
        }
        if let Some((_, room)) = ROOMS.iter().find(|(heavy, _)| *heavy == other)
            && *room != name
            && !for_tests
        {
            wrong.push(format!("{name} -> {other}: stays in {room}"));
        }
    }
    wrong
}

#[test]
fn no_crate_reaches_through_a_wall() {
    let packages = packages();
    assert!(packages.len() >= 5, "the workspace has {} crates", packages.len());
    let wrong: Vec<_> = packages.iter().flat_map(trespasses).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_trespass_is_noticed() {
    let bad = serde_json::json!({"name": "arabesque-patterns", "dependencies": [
        {"name": "arabesque-io", "kind": null}, {"name": "usvg", "kind": null}, {"name": "usvg", "kind": "dev"}]});
    assert_eq!(trespasses(&bad).len(), 2);
    let unknown = serde_json::json!({"name": "arabesque-cellar", "dependencies": []});
    assert_eq!(trespasses(&unknown).len(), 1);
}

#[test]
fn every_crate_inherits_the_lints_and_unsafe_is_forbidden() {
    let table = |path: &Path| read(path).parse::<toml::Table>().unwrap();
    let workspace = table(&root().join("Cargo.toml"));
    assert_eq!(workspace["workspace"]["lints"]["rust"]["unsafe_code"].as_str(), Some("forbid"));
    for package in packages() {
        let manifest = package["manifest_path"].as_str().unwrap();
        let inherits = table(Path::new(manifest)).get("lints").and_then(|l| l.get("workspace")?.as_bool());
        assert_eq!(inherits, Some(true), "{manifest}: expected [lints] workspace = true");
    }
}

#[test]
fn folders_are_named_after_their_crates() {
    for package in packages() {
        let manifest = Path::new(package["manifest_path"].as_str().unwrap());
        let name = package["name"].as_str().unwrap();
        let short = name.strip_prefix("arabesque-").unwrap_or(name);
        assert_eq!(manifest.parent().unwrap().file_name().unwrap().to_str(), Some(short));
    }
}

#[test]
fn the_computing_crates_touch_nothing_outside() {
    for room in PURE {
        for path in files(&root().join("crates").join(room).join("src"), &[".rs"]) {
            let text = read(&path);
            for banned in OUTSIDE {
                assert!(!text.contains(banned), "{}: {banned} belongs into io or cli", path.display());
            }
        }
    }
}

/// The keys of the citations in `text`: `[Ma 2011 §4.2; Tu 2020]` gives `Ma2011` and `Tu2020`.
fn citations(text: &str) -> BTreeSet<String> {
    let mut keys = BTreeSet::new();
    for bracket in text.split('[').skip(1) {
        let Some((inside, _)) = bracket.split_once(']') else { continue };
        keys.extend(inside.split(';').filter_map(citation));
    }
    keys
}

/// The key of one citation: a surname, perhaps others, then a year.
fn citation(part: &str) -> Option<String> {
    let named = |word: &str| word.chars().all(|c| c.is_alphabetic() || "-&.,'".contains(c));
    let mut words = part.split_whitespace();
    let surname = words.next().filter(|w| named(w) && w.starts_with(char::is_uppercase))?;
    let year = words.find(|w| !named(w))?.trim_end_matches([',', ':', '.']);
    let is_year = year.len() == 4 && (year.starts_with("19") || year.starts_with("20"));
    (is_year && year.chars().all(|c| c.is_ascii_digit())).then(|| format!("{}{year}", surname.trim_end_matches(',')))
}

#[test]
fn citations_are_recognised() {
    let found = citations("as in [Ma 2011 §4.2; Tu 2020], [Duranleau and Poulin 2008], not [`Outline`] or [x; 2011]");
    assert_eq!(found.into_iter().collect::<Vec<_>>(), ["Duranleau2008", "Ma2011", "Tu2020"]);
}

#[test]
fn every_citation_has_its_entry() {
    let bibliography = read(&root().join("docs/papers.bib"));
    let entry = |line: &'_ str| Some(line.strip_prefix('@')?.split_once('{')?.1.strip_suffix(',')?.to_owned());
    let keys: Vec<_> = bibliography.lines().filter_map(entry).collect();
    assert_eq!(keys.iter().collect::<BTreeSet<_>>().len(), keys.len(), "docs/papers.bib has a key twice");
    let mut cited = BTreeSet::new();
    for path in files(&root(), &[".rs", ".md"]).iter().filter(|p| !p.ends_with("tests/house.rs")) {
        for key in citations(&read(path)) {
            assert!(keys.contains(&key), "{}: {key} is missing from docs/papers.bib", path.display());
            cited.insert(key);
        }
    }
    assert!(cited.len() >= 3, "only {cited:?} are cited: are citations still recognised?");
}

/// The folder, should `text` name one that exists on one machine only.
fn machine_path(text: &str) -> Option<&'static str> {
    const FOLDERS: &[&str] = &["work/", "root/", "tmp/", "home/"];
    let part_of_a_longer_name = |c: char| c.is_alphanumeric() || "/.<>)}_-*".contains(c);
    FOLDERS.iter().copied().find(|folder| {
        text.match_indices(folder)
            .filter_map(|(at, _)| text[..at].strip_suffix('/'))
            .any(|before| !before.ends_with(part_of_a_longer_name))
    })
}

#[test]
fn machine_paths_are_recognised() {
    assert_eq!(machine_path(&["see /", "tmp/x"].concat()), Some("tmp/"));
    assert_eq!(machine_path("examples/work/x and <root/> and </root/>"), None);
}

#[test]
fn no_file_names_a_machine_path() {
    for path in files(&root(), &[""]) {
        let Ok(text) = fs::read_to_string(&path) else { continue };
        let found = machine_path(&text);
        assert!(found.is_none(), "{}: names a path below /{}", path.display(), found.unwrap_or_default());
    }
}

/// Targets of the links and pictures of a Markdown text, without those on the net and within the page.
fn links(text: &str) -> Vec<&str> {
    let between = |from: &'static str, to: char| text.split(from).skip(1).filter_map(move |rest| rest.split_once(to));
    between("](", ')')
        .chain(between("src=\"", '"'))
        .map(|(target, _)| target.split('#').next().unwrap_or(target))
        .filter(|target| !target.is_empty() && !target.contains("://"))
        .collect()
}

#[test]
fn every_link_leads_somewhere() {
    for path in files(&root(), &[".md"]) {
        for target in links(&read(&path)) {
            let to = path.parent().unwrap().join(target);
            assert!(to.exists(), "{}: the link to {target} leads nowhere", path.display());
        }
    }
}

#[test]
fn the_pictures_of_the_documentation_are_small_and_shown() {
    let texts: String = files(&root(), &[".md"]).iter().map(|p| read(p)).collect();
    for path in files(&root().join("docs/pictures"), &[".png"]) {
        let name = path.file_name().unwrap().to_string_lossy();
        let size = fs::metadata(&path).unwrap().len();
        assert!(size <= PICTURE_BYTES, "{name}: {size} bytes, expected at most {PICTURE_BYTES}");
        assert!(texts.contains(&*name), "{name}: no document shows it");
    }
}

#[test]
fn the_readme_opens_with_a_picture_and_a_command() {
    let readme = read(&root().join("README.md"));
    let line = |start: &str| readme.lines().position(|l| l.starts_with(start)).map_or(usize::MAX, |k| k + 1);
    assert!(line("![") <= 12, "the first picture is at line {}", line("!["));
    assert!(line("cargo run") <= 30, "the first command is at line {}", line("cargo run"));
}

#[test]
fn every_example_is_shown() {
    let texts: String = ["README.md", "docs/gallery.md"].iter().map(|name| read(&root().join(name))).collect();
    for path in files(&root().join("examples"), &[""]) {
        let name = format!("examples/{}", path.file_name().unwrap().to_string_lossy());
        assert!(texts.contains(&name), "{name} is in no command of README.md and docs/gallery.md");
    }
}

#[test]
fn the_rust_of_the_readme_is_an_example_that_compiles() {
    let example = read(&root().join("crates/arabesque/examples/seeds.rs"));
    let (_, code) = example.split_once("\n\n").unwrap();
    assert!(read(&root().join("README.md")).contains(&format!("```rust\n{code}```\n")));
}
