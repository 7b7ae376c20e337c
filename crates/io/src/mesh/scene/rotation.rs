//! Rotations as quaternions, as files have them.

use arabesque_core::Matrix;

/// A rotation as a quaternion x, y, z, w of length 1 with w not negative.
pub fn quaternion(rotation: &Matrix<3>) -> [f64; 4] {
    let m = &rotation.0;
    // Four times the squares of the parts: the largest is found first, since it is divided by.
    let squares = [
        1.0 + m[0][0] - m[1][1] - m[2][2],
        1.0 - m[0][0] + m[1][1] - m[2][2],
        1.0 - m[0][0] - m[1][1] + m[2][2],
        1.0 + m[0][0] + m[1][1] + m[2][2],
    ];
    let largest = (0..4).max_by(|a, b| squares[*a].total_cmp(&squares[*b])).unwrap_or(3);
    let twice = squares[largest].max(f64::MIN_POSITIVE).sqrt();
    let products = match largest {
        0 => [squares[0], m[1][0] + m[0][1], m[0][2] + m[2][0], m[2][1] - m[1][2]],
        1 => [m[1][0] + m[0][1], squares[1], m[2][1] + m[1][2], m[0][2] - m[2][0]],
        2 => [m[0][2] + m[2][0], m[2][1] + m[1][2], squares[2], m[1][0] - m[0][1]],
        _ => [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1], squares[3]],
    };
    let sign = if products[3] < 0.0 { -0.5 } else { 0.5 };
    products.map(|v| sign * v / twice)
}

/// The rotation of a quaternion x, y, z, w of any length; the identity for one without, and for what is no number.
pub fn matrix_of(quaternion: [f64; 4]) -> Matrix<3> {
    let most = quaternion.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    if !(most > 0.0 && quaternion.iter().all(|v| v.is_finite())) {
        return Matrix::identity();
    }
    let scaled = quaternion.map(|v| v / most);
    let length = scaled.iter().map(|v| v * v).sum::<f64>().sqrt();
    let [x, y, z, w] = scaled.map(|v| v / length);
    Matrix([
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_undoes_the_other_whatever_part_is_largest() {
        for q in [[0.8, 0.0, 0.6, 0.0], [0.1, 0.9, -0.3, 0.2], [-0.2, 0.1, 0.9, 0.3], [0.1, 0.2, 0.3, 0.9]] {
            let back = quaternion(&matrix_of(q));
            let length = q.iter().map(|v| v * v).sum::<f64>().sqrt();
            let sign = if q[3] < 0.0 { -1.0 } else { 1.0 };
            assert!((0..4).all(|k| (back[k] - sign * q[k] / length).abs() < 1e-9), "{q:?}: {back:?}");
        }
        assert_eq!(matrix_of([0.0; 4]), Matrix::identity());
        assert_eq!(matrix_of([f64::NAN, 0.0, 0.0, 1.0]), Matrix::identity());
    }
}
