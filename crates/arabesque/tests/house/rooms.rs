//! Which crate may know which, and what stays in one room.

use std::{path::Path, process::Command};

use serde_json::Value;

use super::{files, read, root};

/// Every crate of the house with the crates of the house that it may use.
const WALLS: &[(&str, &[&str])] = &[
    ("arabesque-core", &[]),
    ("arabesque-surface", &["arabesque-core"]),
    ("arabesque-patterns", &["arabesque-core"]),
    ("arabesque-structures", &["arabesque-core", "arabesque-surface"]),
    ("arabesque-ribbons", &["arabesque-core"]),
    ("arabesque-reliefs", &["arabesque-core", "arabesque-surface"]),
    ("arabesque-measure", &["arabesque-core"]),
    ("arabesque-physics", &["arabesque-core"]),
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
            "arabesque-physics",
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
    ("parry3d", "arabesque-physics"),
    ("png", "arabesque-io"),
    ("pyo3", "arabesque-python"),
    ("rand_chacha", "arabesque-core"),
    ("rapier3d", "arabesque-physics"),
    ("resvg", "arabesque-io"),
    ("roxmltree", "arabesque-io"),
    ("signal-hook", "arabesque-cli"),
    ("tokio", "arabesque-studio"),
    ("usvg", "arabesque-io"),
];

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
fn every_crate_inherits_the_lints_and_unsafe_stands_in_two_files() {
    let table = |path: &Path| read(path).parse::<toml::Table>().unwrap();
    let workspace = table(&root().join("Cargo.toml"));
    assert_eq!(workspace["workspace"]["lints"]["rust"]["unsafe_code"].as_str(), Some("deny"));
    for package in packages() {
        let manifest = package["manifest_path"].as_str().unwrap();
        let inherits = table(Path::new(manifest)).get("lints").and_then(|l| l.get("workspace")?.as_bool());
        assert_eq!(inherits, Some(true), "{manifest}: expected [lints] workspace = true");
    }
    let allowed = files(&root().join("crates"), &["rs"]).into_iter().filter(|file| read(file).contains("unsafe_code"));
    let allowed: Vec<_> = allowed.filter(|file| !file.ends_with("house/rooms.rs")).collect();
    let named = ["closed.rs", "memory.rs"].map(|name| root().join("crates/cli/src/process").join(name));
    assert_eq!(allowed, named, "unsafe code stands in two files");
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
