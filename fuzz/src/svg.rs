//! Feeds arbitrary text to every way of reading SVG, and checks what comes out: never a panic or a hang, and markup
//! that is well formed, finite, and refers only to definitions that are there.
#![no_main]

use std::{collections::BTreeSet, sync::LazyLock};

use arabesque_core::{Budget, Limits};
use arabesque_io::svg::{
    Drawing, Fragment, Method, ReadOptions, read_areas, read_exemplar, read_flow, read_lines, read_placed, read_shape,
};
use libfuzzer_sys::fuzz_target;

/// An exemplar that kept files are matched to.
static EXEMPLAR: LazyLock<Option<Drawing>> = LazyLock::new(|| {
    let text = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'><circle cx='2' cy='2' r='1'/><path d='M5 5h2l2 3z'/></svg>";
    read_exemplar(text, &ReadOptions::new("exemplar.svg")).ok()
});

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let limits = Limits { nodes: 3000, segments: 3000, depth: 64, elements: 500, ..Limits::default() };
    // One or two ways of reading a run: more runs a second find more.
    let method = [Method::Auto, Method::Elements, Method::Curves][data.len() % 3];
    let options = ReadOptions { method, budget: Budget::new(limits), ..ReadOptions::new("fuzz.svg") };
    if let Ok(drawing) = read_exemplar(text, &options) {
        check(&drawing);
    }
    match (data.len() / 2 % 6, &*EXEMPLAR) {
        (0, _) => drop(read_shape(text, None, &options)),
        (1, _) => drop(read_flow(text, &options)),
        (2, Some(drawing)) => {
            if let Ok(placed) = read_placed(text, drawing, &options) {
                check_markup(&placed.definitions, placed.fragments.iter().chain(&placed.obstacle_fragments), None);
            }
        }
        (3, _) => {
            if let Ok(lines) = read_lines(text, None, &options) {
                assert!(!lines.paths.is_empty());
                assert!(lines.paths.iter().flat_map(|(_, path)| path.cubics.iter().flatten()).all(|p| p.is_finite()));
            }
        }
        (4, _) => {
            if let Ok(taken) = read_areas(text, &options) {
                assert!(taken.areas.iter().all(|a| a.outline.points().all(|p| p.is_finite()) && a.opacity <= 1.0));
            }
        }
        _ => {}
    }
});

fn check(drawing: &Drawing) {
    let exemplar = &drawing.exemplar;
    assert_eq!(exemplar.elements.len(), drawing.fragments.len());
    assert_eq!(exemplar.curves.len(), drawing.strokes.len());
    for curve in &exemplar.curves {
        assert!(curve.style < exemplar.styles.len() && curve.width.is_finite());
        assert!(!curve.path.is_empty() && curve.path.cubics.iter().flatten().all(|p| p.is_finite()));
        let joined = curve.path.cubics.windows(2).all(|w| w[0][3] == w[1][0]);
        assert!(joined && (!curve.path.closed || curve.path.start() == curve.path.end()), "a path has gaps");
        assert!(arabesque_io::svg::simplified(&curve.path, 0.01).cubics.iter().flatten().all(|p| p.is_finite()));
    }
    for element in &exemplar.elements {
        assert!(element.class < exemplar.classes.len());
        assert!(element.outline.points().all(|p| p.is_finite()), "an outline is not finite");
        assert!(element.pose.scale.is_finite() && element.pose.scale > 0.0, "a pose has no scale");
        assert!(element.colour.iter().all(|c| (0.0..=1.0).contains(c)), "a colour is out of range");
    }
    check_markup(&drawing.definitions, drawing.fragments.iter(), drawing.background.as_deref());
}

fn check_markup<'a>(definitions: &str, fragments: impl Iterator<Item = &'a Fragment>, background: Option<&str>) {
    let body: String = fragments.map(|f| f.markup.as_str()).chain(background).collect();
    let text = format!("<svg xmlns=\"http://www.w3.org/2000/svg\"><defs>{definitions}</defs>{body}</svg>");
    let document =
        roxmltree::Document::parse(&text).unwrap_or_else(|e| panic!("markup is not well formed: {e}: {text}"));
    let mut ids = BTreeSet::new();
    for id in document.descendants().filter_map(|n| n.attribute("id")) {
        assert!(ids.insert(id), "an id occurs twice: {text}");
    }
    for attribute in document.descendants().flat_map(|n| n.attributes()) {
        let value = attribute.value();
        let target = value.strip_prefix("url(#").and_then(|v| v.split(')').next());
        let target = target.or_else(|| value.strip_prefix('#').filter(|_| attribute.name() == "href"));
        if let Some(target) = target {
            assert!(ids.contains(target), "{value} leads nowhere: {text}");
        }
    }
}
