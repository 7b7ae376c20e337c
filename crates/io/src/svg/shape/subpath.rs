//! Single subpaths: whether they are closed, and their lines as cubics.

use arabesque_core::{Path, Vector, straight};
use kurbo::{BezPath, PathEl, PathSeg};

use crate::svg::shape::flatten::control_box;

/// Whether a subpath ends where it starts.
pub(crate) fn is_closed(elements: &[kurbo::PathEl]) -> bool {
    if matches!(elements.last(), Some(kurbo::PathEl::ClosePath)) {
        return true;
    }
    let ends = (elements.first().and_then(|e| e.end_point()), elements.last().and_then(|e| e.end_point()));
    elements.len() > 2 && matches!(ends, (Some(a), Some(b)) if a.distance(b) < 1e-9)
}

/// Whether a shape's subpaths all end where they start.
pub(crate) fn is_all_closed(path: &BezPath) -> bool {
    path.subpaths().all(|elements: &[PathEl]| is_closed(elements))
}

/// Whether a path leads nowhere: SVG draws its caps alone.
pub(crate) fn has_no_length(path: &BezPath) -> bool {
    let extent = control_box(path.elements());
    path.elements().len() > 1 && extent.width() <= 0.0 && extent.height() <= 0.0
}

/// A subpath as cubics; segments no longer than `least` are left out.
pub(crate) fn line(path: &BezPath, closed: bool, least: f64) -> Path<2> {
    let at = |p: kurbo::Point| Vector::xy(p.x, p.y);
    let mut cubics = Vec::new();
    for segment in path.segments() {
        let cubic = match segment {
            PathSeg::Line(l) => straight(at(l.p0), at(l.p1)),
            other => {
                let c = other.to_cubic();
                [c.p0, c.p1, c.p2, c.p3].map(at)
            }
        };
        if (1..4).any(|k| (cubic[k] - cubic[0]).norm() > least) {
            cubics.push(cubic);
        }
    }
    join_ends(&mut cubics, closed, least);
    Path { closed: closed && !cubics.is_empty(), cubics }
}

/// Lets each cubic start exactly where the one before ends, and the first where the last ends on a closed path.
fn join_ends(cubics: &mut Vec<[Vector<2>; 4]>, closed: bool, least: f64) {
    for k in 1..cubics.len() {
        cubics[k][0] = cubics[k - 1][3];
    }
    let (Some(first), Some(last)) = (cubics.first().map(|c| c[0]), cubics.last().map(|c| c[3])) else { return };
    if !closed || first == last {
        return;
    }
    if (first - last).norm() > least.max(1e-9) {
        cubics.push(straight(last, first));
    } else if let Some(end) = cubics.last_mut() {
        end[3] = first;
    }
}
