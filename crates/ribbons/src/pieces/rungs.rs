//! Pieces of ribbons cut so finely that straight-sided cells show how they are bent.

use arabesque_core::Vector;

use crate::piece::Piece;

/// How far a cell may be from the true bending, in exemplar pixels.
const TOLERANCE: f64 = 0.4;
/// Most that the shift may change from the top to the bottom of a cell, in exemplar pixels.
const SLOPE: f64 = 2.0;

/// The two ends of a line across a piece, on its left and on its right edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rung<const D: usize> {
    /// In the output.
    pub ends: [Vector<D>; 2],
    /// What is shown there, in exemplar pixels.
    pub texture: [Vector<2>; 2],
}

/// Lines across a piece from top to bottom, such that what lies between two of them is shown almost as between the corners. Only what
/// lies in the `height` rows of the picture is covered, for there is nothing above and below; no lines where that is nothing.
pub fn rungs<const D: usize>(piece: &Piece<D>, height: f64) -> Vec<Rung<D>> {
    let [tl, tr, br, bl] = piece.patch.texture;
    let [left, right] = [inside(tl, bl, height), inside(tr, br, height)];
    let ([Some(left), Some(right)], [a, b, c, d]) = ([left, right], piece.patch.corners) else { return Vec::new() };
    let at = |p: [f64; 2], share: f64| p[0] + (p[1] - p[0]) * share;
    let shift = |share: f64| {
        let q = tr + (br - tr) * at(right, share);
        (piece.bent(q) - q).dot(br - tr) / (br - tr).norm()
    };
    stations(piece.shift.len(), shift)
        .into_iter()
        .map(|share| {
            let (l, r) = (at(left, share), at(right, share));
            let q = tr + (br - tr) * r;
            Rung { ends: [a + (d - a) * l, b + (c - b) * r], texture: [tl + (bl - tl) * l, piece.bent(q)] }
        })
        .collect()
}

/// The shares of the line from `a` to `b` between which it lies in the picture.
fn inside(a: Vector<2>, b: Vector<2>, height: f64) -> Option<[f64; 2]> {
    let rise = b[1] - a[1];
    if rise <= 1e-9 {
        return Some([0.0, 1.0]);
    }
    let share = |y: f64| ((y - a[1]) / rise).clamp(0.0, 1.0);
    let (from, to) = (share(0.0), share(height));
    (to - from > 1e-9).then_some([from, to])
}

/// Shares from 0 to 1 between which `shift` is almost linear and changes little.
fn stations(samples: usize, shift: impl Fn(f64) -> f64) -> Vec<f64> {
    if samples == 0 {
        return vec![0.0, 1.0];
    }
    let n = samples.max(2);
    let known: Vec<f64> = (0..=n).map(|k| shift(k as f64 / n as f64)).collect();
    let mut kept = vec![0, n];
    split(&known, 0, n, &mut kept);
    kept.sort_unstable();
    kept.into_iter().map(|k| k as f64 / n as f64).collect()
}

/// Adds to `kept` where the values between `from` and `to` must be split to be almost linear.
fn split(known: &[f64], from: usize, to: usize, kept: &mut Vec<usize>) {
    if to - from < 2 {
        return;
    }
    let line = |k: usize| known[from] + (known[to] - known[from]) * (k - from) as f64 / (to - from) as f64;
    let worst = (from + 1..to).map(|k| ((known[k] - line(k)).abs(), k)).max_by(|a, b| a.0.total_cmp(&b.0));
    let steep = (known[to] - known[from]).abs() > SLOPE;
    let middle = match worst {
        Some((off, k)) if off > TOLERANCE => k,
        _ if steep => usize::midpoint(from, to),
        _ => return,
    };
    kept.push(middle);
    split(known, from, middle, kept);
    split(known, middle, to, kept);
}

#[cfg(test)]
mod tests {
    use arabesque_core::Patch;

    use super::*;

    fn piece(shift: Vec<f32>) -> Piece<2> {
        let texture = [(10.0, -5.0), (20.0, -5.0), (20.0, 15.0), (10.0, 15.0)].map(|(x, y)| Vector::xy(x, y));
        Piece { patch: Patch { source: 0, corners: texture.map(|p| p * 2.0), texture }, shift }
    }

    #[test]
    fn a_rigid_piece_is_cut_to_the_picture_alone() {
        let rungs = rungs(&piece(Vec::new()), 12.0);
        assert_eq!(rungs.len(), 2);
        assert_eq!(rungs[0].texture, [Vector::xy(10.0, 0.0), Vector::xy(20.0, 0.0)]);
        assert_eq!(rungs[1].ends, [Vector::xy(20.0, 24.0), Vector::xy(40.0, 24.0)]);
        let mut above = piece(Vec::new());
        above.patch.texture = above.patch.texture.map(|p| p - Vector::xy(0.0, 40.0));
        assert!(super::rungs(&above, 12.0).is_empty());
    }

    #[test]
    fn a_bent_piece_has_rungs_where_the_shift_turns() {
        let shift: Vec<f32> = (0..20).map(|k| if k < 10 { 0.0 } else { 3.0 }).collect();
        let bent = piece(shift);
        let rungs = rungs(&bent, 12.0);
        assert!((4..14).contains(&rungs.len()), "{}", rungs.len());
        let shifts: Vec<f64> = rungs.iter().map(|r| r.texture[1][1] - 0.5 * r.ends[1][1]).collect();
        assert!(shifts.windows(2).all(|w| w[1] - w[0] < SLOPE + 0.6), "{shifts:?}");
        assert!(shifts[0].abs() < 1e-6 && (shifts[shifts.len() - 1] - 3.0).abs() < 1e-6, "{shifts:?}");
        assert!(rungs.iter().all(|r| (r.texture[0] * 2.0 - r.ends[0]).norm() < 1e-9));
    }
}
