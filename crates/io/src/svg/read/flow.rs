//! Directed strokes that say which way the pattern flows.

use std::rc::Rc;

use arabesque_core::{Error, FlowStroke, Result, polyline_length};
use kurbo::Affine;

use crate::svg::{
    options::ReadOptions,
    parse::{
        meta::Part,
        scene::{Content, Node},
    },
    read::document::{Document, Opened, parts},
    shape::{flatten::flattened, painted_area::Painter, subpath::is_closed},
};

/// Reads directed strokes from a text of which nothing else is read.
///
/// # Errors
/// As for [`Document::with`] and [`Document::flow`].
pub fn read_flow(text: &str, options: &ReadOptions) -> Result<Vec<FlowStroke>> {
    Document::with(text, options, |document| document.flow())
}

impl Document<'_> {
    /// Reads every path of the file, or of its layer "Flow" where it has one, as a directed stroke in the file's user
    /// coordinates.
    ///
    /// # Errors
    /// [`Error::Input`] when the text is not usable SVG or holds no path with a length, [`Error::Limit`] when it is too
    /// large.
    pub fn flow(&self) -> Result<Vec<FlowStroke>> {
        let Opened { source, root, .. } = self.open()?;
        let source = &source;
        let painter = Painter::new(source);
        let layers = parts(&root, Part::Flow);
        let nodes = if layers.is_empty() { vec![(Affine::IDENTITY, root)] } else { layers };
        let strokes = strokes(&painter, &nodes)?;
        if strokes.is_empty() {
            return Err(Error::input(
                source.name,
                "no path found",
                "draw one or more lines that the pattern should follow",
            ));
        }
        Ok(strokes)
    }
}

/// The strokes in some nodes.
pub(crate) fn strokes(painter: &Painter<'_, '_>, nodes: &[(Affine, Rc<Node>)]) -> Result<Vec<FlowStroke>> {
    fn walk(painter: &Painter<'_, '_>, node: &Node, parent: Affine, found: &mut Vec<FlowStroke>) -> Result<()> {
        let world = parent * node.transform;
        if let Content::Shape(geometry) = &node.content {
            painter.check(node, geometry, world)?;
            let path = world * geometry.path.clone();
            for elements in path.subpaths() {
                let mut points = flattened(elements);
                if is_closed(elements) {
                    points.extend(points.first().copied());
                }
                let length = polyline_length(&points);
                if length > painter.source.limits.extent {
                    found.push(points);
                }
            }
        }
        node.children().iter().try_for_each(|child| walk(painter, child, world, found))
    }
    let mut found = Vec::new();
    for (parent, node) in nodes {
        walk(painter, node, *parent, &mut found)?;
    }
    Ok(found)
}
