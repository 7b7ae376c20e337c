//! Folders are not too wide, modules have no circles, and crates that compute touch nothing outside.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use super::{
    files, read, root,
    source::{Named, module_of, named, tokens},
};

/// Folders of the crates that compute and nothing else, and what their sources must not touch.
const PURE: &[&str] = &["core", "surface", "patterns", "structures", "ribbons", "reliefs", "measure", "physics"];
const OUTSIDE: &[&str] = &["fs", "env", "net", "process"];

/// Most source files in one folder.
const MAX_FILES: usize = 15;

/// Every crate of the house by the name of its folder.
fn crates() -> Vec<String> {
    let folders = fs::read_dir(root().join("crates")).unwrap();
    let mut names: Vec<_> = folders.map(|f| f.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// A crate's modules: the paths that each names, and which are files of their own.
struct Modules(BTreeMap<Vec<String>, (Vec<Named>, Vec<String>)>);

impl Modules {
    fn of(src: &Path) -> Self {
        let parsed = files(src, &[".rs"]).into_iter().map(|path| {
            let tokens = tokens(&read(&path));
            (module_of(path.strip_prefix(src).unwrap()), (named(&tokens), tokens))
        });
        Self(parsed.collect())
    }

    /// The module that holds what `path` names when module `from` names it; `None` for other crates.
    fn target(&self, from: &[String], path: &[String], depth: usize) -> Option<Vec<String>> {
        let (mut at, mut rest) = match path.first()?.as_str() {
            "crate" => (Vec::new(), &path[1..]),
            "self" => (from.to_vec(), &path[1..]),
            "super" => (from[..from.len().checked_sub(1)?].to_vec(), &path[1..]),
            first => {
                let child: Vec<_> = from.iter().cloned().chain([first.to_owned()]).collect();
                if !self.0.contains_key(&child) {
                    return None;
                }
                (child, &path[1..])
            }
        };
        while let Some((next, after)) = rest.split_first() {
            if next == "super" {
                at.pop()?;
            } else {
                at.push(next.clone());
                if !self.0.contains_key(&at) {
                    at.pop();
                    break;
                }
            }
            rest = after;
        }
        let (names, _) = self.0.get(&at)?;
        // What a module brings in from elsewhere stands elsewhere.
        let elsewhere = rest.first().filter(|_| depth < 8).and_then(|name| {
            let bringer = names.iter().find(|n| n.alias.as_ref() == Some(name) && n.path != path)?;
            self.target(&at, &bringer.path, depth + 1)
        });
        Some(elsewhere.unwrap_or(at))
    }

    /// The modules that `module` needs: a re-export counts where its name is used as well.
    fn needs(&self, module: &[String]) -> BTreeSet<Vec<String>> {
        let (names, tokens) = &self.0[module];
        let is_used = |n: &&Named| {
            !n.reexported || n.alias.as_ref().is_some_and(|name| tokens.iter().filter(|t| *t == name).count() > 1)
        };
        let targets = names.iter().filter(is_used).filter_map(|n| self.target(module, &n.path, 0));
        targets.filter(|target| target != module).collect()
    }

    /// A circle of modules, if there is one.
    fn circle(&self) -> Option<Vec<Vec<String>>> {
        let mut done = BTreeSet::new();
        self.0.keys().find_map(|start| self.circle_from(start, &mut Vec::new(), &mut done))
    }

    fn circle_from<'a>(
        &'a self,
        module: &'a [String],
        way: &mut Vec<Vec<String>>,
        done: &mut BTreeSet<Vec<String>>,
    ) -> Option<Vec<Vec<String>>> {
        if let Some(k) = way.iter().position(|m| m == module) {
            return Some(way[k..].to_vec());
        }
        if done.contains(module) {
            return None;
        }
        way.push(module.to_vec());
        for next in self.needs(module) {
            let (key, _) = self.0.get_key_value(&next)?;
            if let Some(circle) = self.circle_from(key, way, done) {
                return Some(circle);
            }
        }
        way.pop();
        done.insert(module.to_vec());
        None
    }
}

#[test]
fn modules_have_no_circles() {
    let mut wrong = Vec::new();
    for name in crates() {
        if let Some(circle) = Modules::of(&root().join("crates").join(&name).join("src")).circle() {
            let way: Vec<_> = circle.iter().map(|module| format!("crate::{}", module.join("::"))).collect();
            wrong.push(format!("{name}: {}", way.join(" -> ")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_circle_is_noticed() {
    let parsed = |text: &str| {
        let tokens = tokens(text);
        (named(&tokens), tokens)
    };
    let module = |path: &str| path.split("::").filter(|s| !s.is_empty()).map(str::to_owned).collect::<Vec<_>>();
    let modules = |list: &[(&str, &str)]| Modules(list.iter().map(|(m, text)| (module(m), parsed(text))).collect());
    // `b` needs `a` through what the folder re-exports.
    let circle = [
        ("", "mod f;"),
        ("f", "mod a; mod b; pub use a::A;"),
        ("f::a", "use super::b::B; pub struct A(B);"),
        ("f::b", "use crate::f::A; pub struct B(Option<Box<A>>);"),
    ];
    assert_eq!(modules(&circle).circle().map(|c| c.len()), Some(2));
    let line = [circle[0], circle[1], ("f::a", "pub struct A;"), circle[3]];
    assert_eq!(modules(&line).circle(), None);
    // A re-export alone is a table of contents; used in place it is a need.
    let parent = [("", ""), ("f", "mod a; pub use a::A; pub struct P;"), ("f::a", "use crate::f::P; pub struct A(P);")];
    assert_eq!(modules(&parent).circle(), None);
    let both = [parent[0], ("f", "mod a; pub use a::A; pub struct P(A);"), parent[2]];
    assert_eq!(modules(&both).circle().map(|c| c.len()), Some(2));
}

#[test]
fn no_folder_is_too_wide() {
    let mut counts: BTreeMap<PathBuf, usize> = BTreeMap::new();
    for path in files(&root().join("crates"), &[".rs"]) {
        *counts.entry(path.parent().unwrap().to_owned()).or_default() += 1;
    }
    assert!(counts.len() > 20, "only {} folders were found", counts.len());
    for (folder, count) in counts {
        assert!(count <= MAX_FILES, "{}: {count} files, expected at most {MAX_FILES}", folder.display());
    }
}

#[test]
fn the_computing_crates_touch_nothing_outside() {
    for room in PURE {
        for path in files(&root().join("crates").join(room).join("src"), &[".rs"]) {
            let found = outside(&read(&path));
            assert!(found.is_none(), "{}: {} belongs into io or cli", path.display(), found.unwrap_or_default());
        }
    }
}

/// The first path that leads out of a computing crate.
fn outside(text: &str) -> Option<String> {
    let leads_out =
        |n: &Named| n.path[0] == "std" && n.path.get(1).is_some_and(|m| OUTSIDE.contains(&m.as_str()) || m == "*");
    named(&tokens(text)).into_iter().find(leads_out).map(|n| n.path.join("::"))
}

#[test]
fn grouped_imports_are_seen_through() {
    assert_eq!(outside("use std::{any::Any, fs as files};").as_deref(), Some("std::fs"));
    assert_eq!(
        outside("use std::{collections::{BTreeMap, btree_map}, env::{self, args}};").as_deref(),
        Some("std::env")
    );
    assert_eq!(outside("fn f() { std::process::exit(1) }").as_deref(), Some("std::process::exit"));
    assert_eq!(outside("// std::fs\nuse std::{fmt, io}; const A: &str = \"std::env\";"), None);
}
