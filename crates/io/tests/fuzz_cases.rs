//! Files that once broke the reader: each is read in every way, and what comes out is well formed.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{fs, path::PathBuf};

use arabesque_io::svg::{
    Drawing, Method, ReadOptions, read_areas, read_exemplar, read_flow, read_lines, read_placed, read_shape,
};

fn cases() -> Vec<(String, String)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/cases");
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let read = |p: &PathBuf| (p.file_name().unwrap().to_string_lossy().into_owned(), fs::read_to_string(p).unwrap());
    files.iter().map(read).collect()
}

fn assert_references_lead_somewhere(name: &str, drawing: &Drawing) {
    let body: String = drawing.fragments.iter().map(|f| f.markup.as_str()).collect();
    let text = format!("<svg xmlns='http://www.w3.org/2000/svg'><defs>{}</defs>{body}</svg>", drawing.definitions);
    let document = roxmltree::Document::parse(&text).unwrap_or_else(|e| panic!("{name}: {e}"));
    let ids: Vec<_> = document.descendants().filter_map(|n| n.attribute("id")).collect();
    assert!((1..ids.len()).all(|k| !ids[..k].contains(&ids[k])), "{name}: an id occurs twice: {text}");
    for value in document.descendants().flat_map(|n| n.attributes().map(|a| a.value())) {
        if let Some(id) = value.strip_prefix("url(#") {
            assert!(ids.contains(&id.trim_end_matches(')')), "{name}: {value}");
        }
    }
}

#[test]
fn files_that_once_broke_the_reader_no_longer_do() {
    let exemplar = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'><circle cx='4' cy='4' r='1'/></svg>";
    let exemplar = read_exemplar(exemplar, &ReadOptions::new("exemplar.svg")).unwrap();
    let cases = cases();
    assert!(!cases.is_empty());
    for (name, text) in &cases {
        for method in [Method::Auto, Method::Elements] {
            let options = ReadOptions { method, ..ReadOptions::new(name.as_str()) };
            match read_exemplar(text, &options) {
                Ok(drawing) => assert_references_lead_somewhere(name, &drawing),
                Err(error) => assert!(error.to_string().starts_with(name.as_str()), "{error}"),
            }
            let _ = read_shape(text, None, &options);
            let _ = read_flow(text, &options);
            let _ = read_lines(text, None, &options);
            let _ = read_areas(text, &options);
            let _ = read_placed(text, &exemplar, &options);
        }
    }
}
