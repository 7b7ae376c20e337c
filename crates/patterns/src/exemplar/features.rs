//! What tells two elements of one class apart: outline and colour, as a vector of lengths.
//!
//! The attribute `q` of a sample [Ma 2011 §3.2] is this vector. Its distance is in the exemplar's units, so that it
//! adds to position differences without a weight of its own for every exemplar: the outline part is the root mean
//! square difference of the two support functions, the colour part is the colour difference times the spacing.

use arabesque_core::{Element, Vector};

/// Directions in which the support function of an outline is sampled, over a full turn.
const DIRECTIONS: usize = 12;

/// Entries of a feature vector: outline, then colour.
const LENGTH: usize = DIRECTIONS + 3;

/// A direction of length 1: around the plane, or to the corners of an icosahedron.
fn direction<const D: usize>(k: usize) -> Vector<D> {
    let mut direction = Vector::ZERO;
    if D < 3 {
        let turn = k as f64 / DIRECTIONS as f64 * std::f64::consts::TAU;
        (direction[0], direction[1]) = (turn.cos(), turn.sin());
        return direction;
    }
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let signs = [1.0, -1.0];
    let (short, long) = (signs[k & 1], signs[k >> 1 & 1] * golden);
    let first = k / 4;
    (direction[first], direction[(first + 1) % 3]) = (short, long);
    direction.unit_or_zero()
}

/// Attributes of one element, in exemplar directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Feature([f32; LENGTH]);

impl Feature {
    /// Describes an element. `colour_unit` is the length that a full colour difference counts as.
    pub(crate) fn of<const D: usize>(element: &Element<D>, colour_unit: f64) -> Self {
        let mut values = [0.0; LENGTH];
        let scale = 1.0 / (DIRECTIONS as f64).sqrt();
        for (k, value) in values[..DIRECTIONS].iter_mut().enumerate() {
            let direction = direction::<D>(k);
            let reach = element.outline.points().map(|p| (p - element.centre).dot(direction)).fold(0.0, f64::max);
            *value = (reach * scale) as f32;
        }
        for (value, channel) in values[DIRECTIONS..].iter_mut().zip(element.colour) {
            *value = (channel * colour_unit) as f32;
        }
        Self(values)
    }

    /// Equal for features that are the same.
    pub(crate) fn key(&self) -> [u32; LENGTH] {
        self.0.map(f32::to_bits)
    }

    /// Squared distance, in squared units of the exemplar.
    pub(crate) fn distance2(&self, other: &Self) -> f32 {
        self.0.iter().zip(&other.0).map(|(a, b)| (a - b) * (a - b)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arabesque_core::{Outline, Role, Similarity};

    fn square(side: f64, turn: f64) -> Element<2> {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let place = Similarity::about(Vector::ZERO, Vector::ZERO, arabesque_core::Matrix::rotation(turn), side / 2.0);
        let ring = corners.map(|(x, y)| place.apply(Vector::xy(x, y))).to_vec();
        Element {
            class: 0,
            centre: Vector::ZERO,
            pose: Similarity::identity(),
            outline: Outline { rings: vec![ring] },
            colour: [0.0; 3],
            lean: [Vector::ZERO; 3],
            role: Role::Source,
        }
    }

    #[test]
    fn a_square_turned_by_a_right_angle_is_the_same() {
        let a = Feature::of(&square(2.0, 0.0), 1.0);
        let b = Feature::of(&square(2.0, std::f64::consts::FRAC_PI_2), 1.0);
        assert!(a.distance2(&b) < 1e-9);
    }

    #[test]
    fn size_and_turn_make_a_difference() {
        let a = Feature::of(&square(2.0, 0.0), 1.0);
        assert!(a.distance2(&Feature::of(&square(4.0, 0.0), 1.0)) > 1.0);
        assert!(a.distance2(&Feature::of(&square(2.0, 0.7), 1.0)) > 0.01);
    }
}
