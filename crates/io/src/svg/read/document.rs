//! The parsed file that all readers look at: its drawing, the layers that play a part in a job, and items by id.

use std::rc::Rc;

use arabesque_core::{Error, Result, Vector};
use kurbo::Affine;

use crate::{
    svg::{
        drawing::Page,
        parse::{
            length::{self, Viewport},
            meta::Part,
            scene::{self, Node},
            source::Source,
        },
    },
    text::suggest::nearest,
};

/// The drawing and its page, `None` where the file states no size.
pub(crate) fn root(source: &Source<'_>) -> Result<(Rc<Node>, Option<Page>)> {
    let page = length::page(source)?;
    let size = page.map_or(Vector::xy(100.0, 100.0), |p| p.view.size());
    let root = scene::build(source, Viewport { width: size[0], height: size[1] })?;
    Ok((Rc::new(root), page))
}

/// The nodes that play a part in the job, with the transforms from their parents to the root.
pub(crate) fn parts(root: &Rc<Node>, part: Part) -> Vec<(Affine, Rc<Node>)> {
    fn walk(node: &Rc<Node>, parent: Affine, part: Part, found: &mut Vec<(Affine, Rc<Node>)>) {
        if node.meta.part == Some(part) {
            found.push((parent, Rc::clone(node)));
            return;
        }
        let world = parent * node.transform;
        node.children().iter().for_each(|child| walk(child, world, part, found));
    }
    let mut found = Vec::new();
    walk(root, Affine::IDENTITY, part, &mut found);
    found
}

/// The node with an id or a label, and the transform from its parent to the root.
pub(crate) fn by_id(source: &Source<'_>, root: &Rc<Node>, id: &str) -> Result<(Affine, Rc<Node>)> {
    fn walk(node: &Rc<Node>, parent: Affine, id: &str, known: &mut Vec<String>) -> Option<(Affine, Rc<Node>)> {
        if node.meta.id.as_deref() == Some(id) || node.meta.label.as_deref() == Some(id) {
            return Some((parent, Rc::clone(node)));
        }
        known.extend(node.meta.id.iter().chain(&node.meta.label).cloned());
        let world = parent * node.transform;
        node.children().iter().find_map(|child| walk(child, world, id, known))
    }
    let mut known = Vec::new();
    walk(root, Affine::IDENTITY, id, &mut known).ok_or_else(|| {
        let advice = match (nearest(id, known.iter().map(String::as_str)), known.is_empty()) {
            (Some(near), _) => format!("did you mean \"{near}\"?"),
            (None, true) => "give the shape an id".to_owned(),
            (None, false) => format!("use one of its ids, such as {}", known[..known.len().min(8)].join(", ")),
        };
        Error::input(source.name, format!("nothing visible has the id \"{id}\""), advice)
    })
}
