//! Which elements keep their angle: those of classes that are drawn at one angle, or at a few.
//!
//! Shape matching turns an element of several samples into where these went. In a class that lies at any angle that is as good as another
//! of them; trees that all stand upright must not lean.

use arabesque_core::{Budget, Exemplar, Matrix, Numbered, Result};

/// Angles that differ by less (radians) are one.
const SAME: f64 = 0.035;
/// Share of its class at the angle of an element from which on it keeps that.
const SHARE: f64 = 0.2;
/// Members of a class that tell, at least, and those that are looked at.
const LEAST: usize = 3;
const LOOKED_AT: usize = 128;
/// Work for comparing two angles.
const COMPARE: u64 = 8;

/// For each element, whether it keeps its angle.
///
/// # Errors
/// As [`Budget::spend`].
pub(crate) fn upright<const D: usize>(
    exemplar: &Exemplar<D>,
    members: &Numbered<Vec<u32>>,
    budget: &Budget,
) -> Result<Numbered<bool>> {
    let mut upright = vec![false; exemplar.elements.len()];
    let rotation = |e: u32| exemplar.seen_pose(e as usize).rotation;
    for members in members.iter().filter(|members| members.len() >= LEAST) {
        let looked_at: Vec<Matrix<D>> =
            members.iter().step_by(members.len().div_ceil(LOOKED_AT)).map(|&e| rotation(e)).collect();
        budget.spend(COMPARE * (looked_at.len() * members.len()) as u64)?;
        let least = (SHARE * looked_at.len() as f64).max(2.0);
        for &e in members {
            let own = rotation(e);
            let same = looked_at.iter().filter(|other| is_same(&own, other)).count();
            upright[e as usize] = same as f64 >= least;
        }
    }
    Ok(upright.into_iter().collect())
}

/// A turn by an angle moves the unit vectors of a plane by its chord each.
fn is_same<const D: usize>(a: &Matrix<D>, b: &Matrix<D>) -> bool {
    let off: f64 = (0..D).flat_map(|r| (0..D).map(move |c| (a.0[r][c] - b.0[r][c]).powi(2))).sum();
    off <= 2.0 * SAME * SAME
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Bounds, Class, Element, Outline, Role, Similarity, Vector};

    use super::*;

    fn found(angles: &[f64]) -> Vec<bool> {
        let element = |&angle: &f64| Element {
            class: 0,
            centre: Vector::ZERO,
            pose: Similarity { rotation: Matrix::rotation(angle), ..Similarity::shift(Vector::ZERO) },
            outline: Outline { rings: Vec::new() },
            colour: [0.0; 3],
            lean: [Vector::ZERO; 3],
            role: Role::Source,
        };
        let window = Bounds::new(Vector::xy(-1.0, -1.0), Vector::xy(1.0, 1.0));
        let elements = angles.iter().map(element).collect();
        let exemplar = Exemplar::new("t", elements, vec![Class { name: "a".into() }], window).unwrap();
        let members: Numbered<Vec<u32>> = std::iter::once((0..angles.len() as u32).collect()).collect();
        upright(&exemplar, &members, &Budget::default()).unwrap().iter().copied().collect()
    }

    #[test]
    fn what_stands_upright_or_upside_down_keeps_its_angle() {
        assert_eq!(found(&[0.0; 5]), [true; 5]);
        assert_eq!(found(&[0.0, std::f64::consts::PI, 0.0, std::f64::consts::PI, 0.01, 0.0]), [true; 6]);
    }

    #[test]
    fn what_lies_at_any_angle_does_not() {
        let angles: Vec<f64> = (0..24).map(|k| 0.26 * f64::from(k)).collect();
        assert_eq!(found(&angles), [false; 24]);
        assert_eq!(found(&[0.0, 0.0]), [false; 2], "two tell nothing");
    }
}
