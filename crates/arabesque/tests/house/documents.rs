//! What is cited, where links lead, what the documentation shows.

use std::{collections::BTreeSet, fs};

use super::{files, read, root};

/// Largest picture of the documentation, in bytes.
const PICTURE_BYTES: u64 = 150_000;

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
    for path in files(&root(), &[".rs", ".md"]).iter().filter(|p| !p.to_string_lossy().contains("tests/house/")) {
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
