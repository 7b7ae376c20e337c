//! The elements of an artwork as points.

use arabesque_core::{Exemplar, Placement};

/// Where an element lies, and what it is.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedPoint {
    /// Its centre: two coordinates in the plane, three in space.
    pub position: Vec<f64>,
    /// Name of its class.
    pub class: String,
}

/// The centres of placed elements, in drawing order.
pub(crate) fn points<const D: usize>(exemplar: &Exemplar<D>, placements: &[Placement<D>]) -> Vec<PlacedPoint> {
    let point = |placement: &Placement<D>| {
        let element = &exemplar.elements[placement.source];
        let position = placement.transform.apply(element.centre).0.to_vec();
        PlacedPoint { position, class: exemplar.classes[element.class].name.clone() }
    };
    placements.iter().map(point).collect()
}
