//! Where the elements of an exemplar lie.

use arabesque_core::{Bounds, Element, Exemplar, Role, Vector};

use crate::repeat::{
    marks::{Anchor, place_of},
    unknown::touches,
};

/// So many mean distances around all places belong to them.
const AROUND: f64 = 0.7;

/// Where the elements of an exemplar lie.
#[derive(Clone, Debug)]
pub(crate) struct Places {
    /// Places of whole elements, and which these are.
    pub(crate) whole: Vec<(Vector<2>, usize)>,
    /// Places of those that may be cut.
    pub(crate) cut: Vec<Vector<2>>,
    /// Mean distance of neighbours.
    pub(crate) unit: f64,
}

impl Places {
    pub(crate) fn of(exemplar: &Exemplar<2>, anchor: Anchor) -> Self {
        let (mut whole, mut cut) = (Vec::new(), Vec::new());
        for (k, element) in exemplar.elements.iter().enumerate() {
            let place = place_of(element, anchor);
            if is_cut(element, &exemplar.window) {
                cut.push(place);
            } else {
                whole.push((place, k));
            }
        }
        let all = || whole.iter().map(|(p, _)| *p).chain(cut.iter().copied());
        let extent = Bounds::around(all());
        let size = if extent.is_empty() { Vector::ZERO } else { extent.size() };
        let count = all().count().max(1) as f64;
        // Something around the outermost places belongs to them.
        let mut unit = 0.0;
        for _ in 0..8 {
            unit = ((size[0] + AROUND * unit) * (size[1] + AROUND * unit) / count).sqrt();
        }
        Self { whole, cut, unit }
    }
}

fn is_cut(element: &Element<2>, window: &Bounds<2>) -> bool {
    element.role == Role::Context || touches(&element.outline.bounds(), window)
}
