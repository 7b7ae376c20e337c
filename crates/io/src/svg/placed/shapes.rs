//! What definitions and groups of a result look like: read from a small file that holds these alone.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Outline, Result, Vector};
use kurbo::Affine;

use crate::svg::{
    options::ReadOptions,
    read::document::{Document, Opened},
    shape::{extent::bounds, painted_area::Painter},
};

/// A thing that is drawn.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    /// What it covers, in its own coordinates; of what is drawn in place the box around it.
    pub(super) outline: Outline<2>,
    pub(super) centre: Vector<2>,
    /// How far it reaches from there.
    pub(super) reach: f64,
}

/// The shapes with these ids that are drawn in `text`, each a child of its root; those for which `is_exact` says so to the edge, the
/// others as boxes.
pub(super) fn shapes(
    text: &str,
    options: &ReadOptions,
    is_exact: impl Fn(&str) -> bool,
) -> Result<BTreeMap<String, Shape>> {
    Document::with(text, options, |document| {
        let Opened { source, root, .. } = document.open()?;
        let painter = Painter::new(&source);
        let mut found = BTreeMap::new();
        for node in root.children() {
            let Some(id) = &node.meta.id else { continue };
            let outline = if is_exact(id) {
                painter.painted(node, Affine::IDENTITY)?.outline(source.budget)?
            } else {
                boxed(&bounds(node, Affine::IDENTITY))
            };
            let centre = outline.centroid().unwrap_or(Vector::ZERO);
            let reach = outline.radius(centre);
            found.insert(id.clone(), Shape { outline, centre, reach });
        }
        Ok(found)
    })
}

fn boxed(b: &Bounds<2>) -> Outline<2> {
    if b.is_empty() {
        return Outline::default();
    }
    let (low, high) = (b.min, b.max);
    Outline { rings: vec![vec![low, Vector::xy(high[0], low[1]), high, Vector::xy(low[0], high[1])]] }
}
