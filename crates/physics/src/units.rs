//! From the numbers of the house to those of the solver and back.
//!
//! The solver computes in f32 and is tuned to things about one unit long. So it sees everything relative to one place and in one unit, and
//! what comes back is the difference that it made, added to the poses that it was given: what it did not move stays to the last bit.

use arabesque_core::{Bounds, Error, Matrix, Result, Similarity, Vector};
use rapier3d::math::{Pose, Rotation, Vector as Vec3};

/// Farthest place, in units, that f32 tells from its neighbours finely enough.
const FARTHEST: f64 = 20_000.0;

/// The origin and the unit of what the solver sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Units {
    origin: Vector<3>,
    length: f64,
}

impl Units {
    /// Units for everything within `bounds`, in which a thing of size `length` is one long.
    pub(crate) fn new(bounds: &Bounds<3>, length: f64) -> Result<Self> {
        let reach = 0.5 * bounds.size().norm() / length;
        if reach.is_finite() && reach <= FARTHEST {
            return Ok(Self { origin: bounds.centre(), length });
        }
        let problem =
            format!("the scene reaches {reach:.0} sizes of an element from its middle, expected at most {FARTHEST:.0}");
        Err(Error::input("the scene", problem, "take away what lies far off, or do with fewer elements"))
    }

    /// Length of one unit.
    pub(crate) fn length(&self) -> f64 {
        self.length
    }

    pub(crate) fn place(&self, p: Vector<3>) -> Vec3 {
        vec3((p - self.origin) * (1.0 / self.length))
    }

    /// Where a body lies whose own origin is `centre` in the coordinates of its mesh.
    pub(crate) fn pose(&self, pose: &Similarity<3>, centre: Vector<3>) -> Pose {
        Pose::from_parts(self.place(pose.apply(centre)), rotation(&pose.rotation))
    }

    /// The pose `given`, changed as the solver changed `before` to `after`.
    pub(crate) fn pose_back(
        &self,
        given: &Similarity<3>,
        centre: Vector<3>,
        (before, after): (&Pose, &Pose),
    ) -> Similarity<3> {
        if before == after {
            return *given;
        }
        let shift = vector(after.translation - before.translation) * self.length;
        let target = given.apply(centre) + shift;
        let turn = if before.rotation == after.rotation {
            given.rotation
        } else {
            let [a, b] = [after, before].map(|pose| matrix(pose.rotation));
            a.compose(&b.transpose()).compose(&given.rotation)
        };
        Similarity::about(centre, target, turn, given.scale)
    }
}

pub(crate) fn vec3(v: Vector<3>) -> Vec3 {
    let [x, y, z] = v.0.map(|x| x as f32);
    Vec3::new(x, y, z)
}

pub(crate) fn vector(v: Vec3) -> Vector<3> {
    Vector([v.x, v.y, v.z].map(f64::from))
}

/// The quaternion of a rotation.
fn rotation(m: &Matrix<3>) -> Rotation {
    let m = m.0;
    let trace = m[0][0] + m[1][1] + m[2][2];
    let q = if trace > 0.0 {
        [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1], 1.0 + trace]
    } else {
        let largest = (1..3).fold(0, |best, k| if m[k][k] > m[best][best] { k } else { best });
        let (i, j, k) = (largest, (largest + 1) % 3, (largest + 2) % 3);
        let mut q = [0.0; 4];
        q[i] = 1.0 + m[i][i] - m[j][j] - m[k][k];
        q[j] = m[j][i] + m[i][j];
        q[k] = m[k][i] + m[i][k];
        q[3] = m[k][j] - m[j][k];
        q
    };
    let norm = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z, w] = q.map(|x| (x / norm) as f32);
    Rotation::from_xyzw(x, y, z, w)
}

/// The rotation of a quaternion, exact to f64 whatever its length.
pub(crate) fn matrix(q: Rotation) -> Matrix<3> {
    let [x, y, z, w] = [q.x, q.y, q.z, q.w].map(f64::from);
    let s = 2.0 / (x * x + y * y + z * z + w * w);
    Matrix([
        [1.0 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
        [s * (x * y + z * w), 1.0 - s * (x * x + z * z), s * (y * z - x * w)],
        [s * (x * z - y * w), s * (y * z + x * w), 1.0 - s * (x * x + y * y)],
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turns() -> Vec<Matrix<3>> {
        let cycle = Matrix([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let flip = |k: usize| {
            let mut m = Matrix([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]);
            m.0[k][k] = 1.0;
            m
        };
        let (s, c) = 2.9_f64.sin_cos();
        let oblique = Matrix([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).compose(&cycle);
        vec![Matrix::identity(), cycle, flip(0), flip(1), flip(2), oblique, oblique.compose(&flip(1))]
    }

    #[test]
    fn rotations_come_back() {
        for turn in turns() {
            let back = matrix(rotation(&turn));
            let off = (0..9).map(|k| (back.0[k / 3][k % 3] - turn.0[k / 3][k % 3]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-6, "{turn:?}: {back:?}");
        }
    }

    #[test]
    fn what_is_not_moved_stays_and_what_is_moved_moves_by_as_much() {
        let units = Units::new(&Bounds::around([Vector([10.0, 20.0, 30.0]), Vector([14.0, 24.0, 34.0])]), 0.5).unwrap();
        let centre = Vector([0.1, 0.2, 0.3]);
        let given = Similarity { rotation: turns()[5], scale: 1.7, translation: Vector([12.3, 21.7, 33.3]) };
        let before = units.pose(&given, centre);
        assert_eq!(units.pose_back(&given, centre, (&before, &before)), given);
        let after = Pose::from_parts(before.translation + Vec3::new(1.0, 0.0, 0.0), before.rotation);
        let moved = units.pose_back(&given, centre, (&before, &after));
        let step = moved.apply(centre) - given.apply(centre);
        assert!((step - Vector([0.5, 0.0, 0.0])).norm() < 1e-6, "{step:?}");
        assert_eq!(moved.rotation, given.rotation);
    }

    #[test]
    fn scenes_that_reach_too_far_are_refused() {
        let bounds = Bounds::around([Vector::ZERO, Vector([1e9, 0.0, 0.0])]);
        assert!(Units::new(&bounds, 1.0).unwrap_err().to_string().contains("take away"));
        assert!(Units::new(&bounds, 1e5).is_ok());
    }
}
