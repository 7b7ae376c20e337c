//! What must be true of what the readers and writers give.

use std::collections::BTreeSet;

use arabesque_io::svg::{Drawing, Fragment, simplified};

/// Checks that a drawing is whole: finite, in ranges, paths without gaps, and markup that stands for itself.
pub fn drawing(drawing: &Drawing) {
    let exemplar = &drawing.exemplar;
    assert_eq!(exemplar.elements.len(), drawing.fragments.len());
    assert_eq!(exemplar.curves.len(), drawing.strokes.len());
    for curve in &exemplar.curves {
        assert!(curve.style < exemplar.styles.len() && curve.width.is_finite());
        assert!(!curve.path.is_empty() && curve.path.cubics.iter().flatten().all(|p| p.is_finite()));
        let joined = curve.path.cubics.windows(2).all(|w| w[0][3] == w[1][0]);
        assert!(joined && (!curve.path.closed || curve.path.start() == curve.path.end()), "a path has gaps");
        assert!(simplified(&curve.path, 0.01).cubics.iter().flatten().all(|p| p.is_finite()));
    }
    for element in &exemplar.elements {
        assert!(element.class < exemplar.classes.len());
        assert!(element.outline.points().all(|p| p.is_finite()), "an outline is not finite");
        assert!(element.pose.scale.is_finite() && element.pose.scale > 0.0, "a pose has no scale");
        assert!(element.colour.iter().all(|c| (0.0..=1.0).contains(c)), "a colour is out of range");
    }
    fragments(&drawing.definitions, drawing.fragments.iter(), drawing.background.as_deref());
}

/// Checks pieces of markup together with the definitions that they refer to.
pub fn fragments<'a>(definitions: &str, fragments: impl Iterator<Item = &'a Fragment>, background: Option<&str>) {
    let body: String = fragments.map(|f| f.markup.as_str()).chain(background).collect();
    markup(&format!("<svg xmlns=\"http://www.w3.org/2000/svg\"><defs>{definitions}</defs>{body}</svg>"));
}

/// Checks that a file is well formed, has no id twice, and refers only to what is there.
pub fn markup(text: &str) {
    let document =
        roxmltree::Document::parse(text).unwrap_or_else(|e| panic!("markup is not well formed: {e}: {text}"));
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
