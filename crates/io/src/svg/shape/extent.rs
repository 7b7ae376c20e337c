//! Boxes around nodes, and how their parts are spread; cheap, without flattening.

use std::rc::Rc;

use arabesque_core::{Bounds, Budget, DisjointSets, Result, Vector};
use kurbo::Affine;

use crate::svg::{
    parse::{
        geometry::Painted,
        scene::{Content, Node},
        style::Property as P,
    },
    shape::{adjacency::meeting, stroke::growth},
};

/// Box around the control points of what can be seen of a node, strokes included; `parent` leads from its parent to the
/// root.
pub(crate) fn bounds(node: &Node, parent: Affine) -> Bounds<2> {
    let world = parent * node.transform;
    match &node.content {
        Content::Group(children) => children.iter().fold(Bounds::EMPTY, |all, child| all.union(&bounds(child, world))),
        Content::Shape(geometry) => {
            let strokes = node.style.strokes();
            if !strokes && !node.style.fills() && geometry.paint == Painted::Style {
                return Bounds::EMPTY;
            }
            let r = (world * geometry.path.clone()).control_box();
            let margin = if strokes { 0.5 * growth(world) * node.style.number(P::StrokeWidth) } else { 0.0 };
            Bounds::new(Vector::xy(r.x0, r.y0), Vector::xy(r.x1, r.y1)).grown(margin)
        }
    }
}

/// Box around the control points of a node, whether it can be seen or not.
pub(crate) fn outline_bounds(node: &Node, parent: Affine) -> Bounds<2> {
    let world = parent * node.transform;
    match &node.content {
        Content::Group(children) => {
            children.iter().fold(Bounds::EMPTY, |all, child| all.union(&outline_bounds(child, world)))
        }
        Content::Shape(geometry) => {
            let r = (world * geometry.path.clone()).control_box();
            Bounds::new(Vector::xy(r.x0, r.y0), Vector::xy(r.x1, r.y1))
        }
    }
}

/// The longer side of a box.
pub(crate) fn longer(b: &Bounds<2>) -> f64 {
    b.size()[0].max(b.size()[1])
}

/// The boxes fall into this many sets whose gaps are wider than `share` of the smaller neighbour.
///
/// # Errors
/// As [`Budget::spend`].
pub(crate) fn clusters(boxes: &[Bounds<2>], share: f64, budget: &Budget) -> Result<usize> {
    let gap = |a: &Bounds<2>, b: &Bounds<2>| {
        let d = (0..2).map(|k| (a.min[k] - b.max[k]).max(b.min[k] - a.max[k]).max(0.0));
        d.map(|v| v * v).sum::<f64>().sqrt()
    };
    let mut sets = DisjointSets::new(boxes.len());
    meeting(
        boxes,
        |i| share * longer(&boxes[i]),
        budget,
        |i, j| {
            if gap(&boxes[i], &boxes[j]) <= share * longer(&boxes[i]).min(longer(&boxes[j])) {
                sets.join(i, j);
            }
            true
        },
    )?;
    Ok(sets.groups().into_iter().filter(|g| g.iter().any(|&i| !boxes[i].is_empty())).count())
}

/// The only shape inside a node.
pub(crate) struct SoleShape<'n> {
    pub(crate) leaf: &'n Rc<Node>,
    /// From the parent of the shape to the root.
    pub(crate) parent: Affine,
}

/// The shape that a node is, or the only one inside it; `parent` leads from the parent of the node to the root.
pub(crate) fn sole_shape(node: &Rc<Node>, parent: Affine) -> Option<SoleShape<'_>> {
    let (mut at, mut transform) = (node, parent);
    loop {
        match &at.content {
            Content::Shape(_) => return Some(SoleShape { leaf: at, parent: transform }),
            Content::Group(children) => {
                let [child] = children.as_slice() else { return None };
                if child.meta.mark.is_some() {
                    return None;
                }
                transform *= at.transform;
                at = child;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn close_boxes_are_one_cluster() {
        let at = |x: f64, side: f64| Bounds::new(Vector::xy(x, 0.0), Vector::xy(x + side, side));
        assert_eq!(clusters(&[at(0.0, 10.0), at(12.0, 10.0), at(24.0, 10.0)], 0.3, &Budget::default()).unwrap(), 1);
        assert_eq!(clusters(&[at(0.0, 10.0), at(14.0, 10.0)], 0.3, &Budget::default()).unwrap(), 2);
        assert_eq!(clusters(&[at(0.0, 10.0), at(12.0, 1.0)], 0.3, &Budget::default()).unwrap(), 2);
        assert_eq!(clusters(&[], 0.3, &Budget::default()).unwrap(), 0);
    }
}
