//! Which way a drawing runs on a mesh where nobody says.

use std::sync::Arc;

use arabesque_core::{Bounds, Budget, Result, Vector};
use arabesque_surface::{Bend, DirectionField, Directions, MeshIndex};

use crate::space::{
    layer::Layer,
    shell::{Lying, Shell},
};

/// A lattice that breaks in less than this share of the places in which the usual one breaks is better.
const BETTER: f64 = 0.85;

/// A direction along a mesh, and the degrees by which the pattern is turned from it.
type Way = (Directions, f64);

/// The layer in which the lattice of a drawing breaks least, where nobody says which way it runs: level, along the longest side, or as the
/// mesh bends.
pub(super) fn suiting(
    index: &Arc<MeshIndex>,
    lying: Lying,
    (layer, up, scale): (&Layer, usize, f64),
    budget: &Budget,
) -> Result<Shell> {
    let mut best: Option<(f64, Shell)> = None;
    for (directions, more) in ways(&index.bounds(), up) {
        let field = DirectionField::new(index, &directions, budget)?;
        let shell = Shell::new(index, field, Lying { turned: lying.turned + more, ..lying });
        let broken = layer.broken(&shell, scale, budget)?;
        // What is named first is usual, and stays unless another one is clearly better.
        if best.as_ref().is_none_or(|(least, _)| broken < BETTER * least - 1e-3) {
            best = Some((broken, shell));
        }
    }
    match best {
        Some((_, shell)) => Ok(shell),
        None => Ok(Shell::new(index, DirectionField::new(index, &Directions::Curvature(Bend::Least), budget)?, lying)),
    }
}

/// Which way a pattern may run, the usual way first.
fn ways(bounds: &Bounds<3>, up: usize) -> [Way; 4] {
    let size = bounds.size();
    let longest = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
    let axis = |k: usize| Directions::Constant(Vector(std::array::from_fn(|r| if r == k { 1.0 } else { 0.0 })));
    [
        (axis(up), -90.0),
        (axis(longest), 0.0),
        (Directions::Curvature(Bend::Least), 0.0),
        (Directions::Curvature(Bend::Most), 0.0),
    ]
}
