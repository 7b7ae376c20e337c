//! Reads every SVG file under a folder as an exemplar and counts what comes of it: `survey FOLDER [auto|elements]`.
//! With a single file instead of a folder it prints what was understood; `survey FILE METHOD OUT.svg` also draws it
//! again from the fragments, for comparison with the original.
#![allow(clippy::print_stdout, reason = "the survey is a report for people")]

use std::{
    collections::BTreeMap,
    error::Error,
    fs,
    panic::{AssertUnwindSafe, catch_unwind},
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use arabesque_core::Role;
use arabesque_io::svg::{Drawing, Method, ReadOptions, read_exemplar};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let path = PathBuf::from(arguments.first().ok_or("usage: survey FOLDER [auto|elements]")?);
    let method = if arguments.get(1).is_some_and(|m| m == "elements") { Method::Elements } else { Method::Auto };
    if path.is_file() {
        let options = ReadOptions { method, ..ReadOptions::new(path.display().to_string()) };
        let drawing = read_exemplar(&fs::read_to_string(&path)?, &options)?;
        describe(&drawing);
        if let Some(out) = arguments.get(2) {
            fs::write(out, redrawn(&drawing))?;
        }
        return Ok(());
    }
    survey(&path, method)
}

/// What became of the files.
#[derive(Default)]
struct Counts {
    read: usize,
    elements: usize,
    failures: BTreeMap<String, Vec<String>>,
    slowest: Vec<(Duration, String)>,
}

fn survey(folder: &Path, method: Method) -> Result<(), Box<dyn Error>> {
    let mut files = Vec::new();
    gather(folder, &mut files)?;
    files.sort();
    let mut counts = Counts::default();
    for file in &files {
        one(file, method, &mut counts);
    }
    counts.slowest.sort();
    counts.slowest.reverse();
    println!("{} files, {} read, {} elements", files.len(), counts.read, counts.elements);
    for (kind, files) in &counts.failures {
        println!(
            "{:6}  {kind}; for example {}",
            files.len(),
            files.iter().take(4).cloned().collect::<Vec<_>>().join(", ")
        );
    }
    for (time, name) in counts.slowest.iter().take(10) {
        println!("{:8.3} s  {name}", time.as_secs_f64());
    }
    Ok(())
}

fn gather(folder: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            gather(&path, files)?;
        } else if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("svg")) {
            files.push(path);
        }
    }
    Ok(())
}

fn one(file: &Path, method: Method, counts: &mut Counts) {
    let name = file.display().to_string();
    let Ok(bytes) = fs::read(file) else {
        counts.failures.entry("unreadable file".into()).or_default().push(name);
        return;
    };
    let Ok(text) = String::from_utf8(bytes) else {
        counts.failures.entry("not UTF-8".into()).or_default().push(name);
        return;
    };
    let options = ReadOptions { method, ..ReadOptions::new("") };
    let start = Instant::now();
    let outcome = catch_unwind(AssertUnwindSafe(|| read_exemplar(&text, &options)));
    counts.slowest.push((start.elapsed(), name.clone()));
    match outcome {
        Ok(Ok(drawing)) => {
            counts.read += 1;
            counts.elements += drawing.exemplar.elements.len();
        }
        Ok(Err(error)) => counts.failures.entry(kind(&error.to_string())).or_default().push(name),
        Err(_) => counts.failures.entry("PANIC".into()).or_default().push(name),
    }
}

/// A message without what differs from file to file.
fn kind(message: &str) -> String {
    let mut quoted = false;
    let mut kind = String::new();
    for c in message.chars().take(240) {
        match c {
            '"' => quoted = !quoted,
            _ if quoted => {}
            '0'..='9' if kind.ends_with('0') => {}
            '0'..='9' => kind.push('0'),
            c => kind.push(c),
        }
    }
    kind.chars().take(200).collect()
}

/// The drawing put together again from its fragments.
fn redrawn(drawing: &Drawing) -> String {
    let (min, size) = (drawing.page.view.min, drawing.page.view.size());
    let scale = drawing.page.unit_per_user * drawing.page.unit.pixels();
    let fragments: String = drawing.fragments.iter().map(|f| f.markup.as_str()).collect();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" viewBox=\"{} {} {} \
         {}\"><defs>{}</defs>{}{fragments}</svg>",
        size[0] * scale,
        size[1] * scale,
        min[0],
        min[1],
        size[0],
        size[1],
        drawing.definitions,
        drawing.background.as_deref().unwrap_or_default()
    )
}

fn describe(drawing: &Drawing) {
    let e = &drawing.exemplar;
    println!("window {:?}, page {:?}", e.window, drawing.page);
    for (k, class) in e.classes.iter().enumerate() {
        let members: Vec<_> = e.elements.iter().filter(|e| e.class == k).collect();
        let whole = members.iter().filter(|e| e.role == Role::Source).count();
        let points: usize = members.iter().map(|e| e.outline.points().count()).sum();
        println!(
            "  {:20} {:5}, {whole} whole, {} outline points each",
            class.name,
            members.len(),
            points / members.len().max(1)
        );
    }
    let markup: usize = drawing.fragments.iter().map(|f| f.markup.len()).sum();
    println!("  {} elements, {markup} bytes of markup, {} of definitions", e.elements.len(), drawing.definitions.len());
    println!("  background {:?}", drawing.background.as_deref().map(|b| b.chars().take(120).collect::<String>()));
    println!("  spacing {:.3}", e.spacing());
    for warning in &drawing.warnings {
        println!("  {}; {}", warning.message, warning.advice);
    }
}
