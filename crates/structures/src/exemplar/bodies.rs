//! Rigid elements of the exemplar.

use std::collections::BTreeMap;

use arabesque_core::{PointSet, Vector};

/// A rigid element: its points and their middle.
#[derive(Clone, Debug)]
pub(crate) struct Body<const D: usize> {
    /// Its number in the exemplar.
    pub(crate) number: i32,
    /// Its points.
    pub(crate) members: Vec<usize>,
    /// The mean of their places.
    pub(crate) centre: Vector<D>,
}

/// No rigid element.
pub(crate) const LOOSE: u32 = u32::MAX;

/// The rigid elements by rising number, and for each point the index of its own, or [`LOOSE`].
pub(crate) fn bodies<const D: usize>(points: &PointSet<D>) -> (Vec<Body<D>>, Vec<u32>) {
    let mut of = vec![LOOSE; points.len()];
    let Some(elements) = &points.elements else { return (Vec::new(), of) };
    let mut members: BTreeMap<i32, Vec<usize>> = BTreeMap::new();
    for (i, &number) in elements.iter().enumerate().filter(|(_, n)| **n >= 0) {
        members.entry(number).or_default().push(i);
    }
    let mut bodies = Vec::with_capacity(members.len());
    for (number, members) in members {
        members.iter().for_each(|&i| of[i] = bodies.len() as u32);
        let sum = members.iter().fold(Vector::ZERO, |sum, &i| sum + points.positions[i]);
        let centre = sum * (1.0 / members.len() as f64);
        bodies.push(Body { number, members, centre });
    }
    (bodies, of)
}
