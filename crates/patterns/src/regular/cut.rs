//! Strokes cut along the sides of the cells of a lattice.

use arabesque_core::{Cubic, Path, Vector, cubic_at, cubic_part};

use crate::repeat::lattice::{Lattice, Node};

/// Cuts of a segment that are nearer to each other, or to its ends, than this share of it are one.
const SAME: f64 = 1e-7;

/// Steps in which a segment is looked through for the sides of cells; halvings that place a cut.
const LOOK: (usize, usize) = (16, 60);

/// A part of a stroke in one cell.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    /// The cell, counted from the origin of the cells.
    pub(crate) cell: Node,
    pub(crate) path: Path<2>,
    /// Whether its start and its end are cuts, not ends of the stroke.
    pub(crate) is_cut: [bool; 2],
}

/// The parts of a path in the cells that it runs through, in its order. Closed paths that leave their cell begin at a
/// cut.
pub(crate) fn pieces(path: &Path<2>, lattice: &Lattice, origin: Vector<2>) -> Vec<Piece> {
    let cell_of = |c: &Cubic<2>| {
        let middle = lattice.coordinates(cubic_at(c, 0.5) - origin);
        middle.0.map(|x| x.floor() as i64)
    };
    let mut parts: Vec<Piece> = Vec::new();
    for cubic in &path.cubics {
        let cuts = cuts(cubic, lattice, origin);
        for span in cuts.windows(2) {
            let part = if cuts.len() == 2 { *cubic } else { cubic_part(cubic, span[0], span[1]) };
            let cell = cell_of(&part);
            match parts.last_mut() {
                Some(last) if last.cell == cell => last.path.cubics.push(part),
                _ => {
                    let path = Path { cubics: vec![part], closed: false };
                    parts.push(Piece { cell, path, is_cut: [true, true] });
                }
            }
        }
    }
    let count = parts.len();
    if !path.closed {
        if let Some(first) = parts.first_mut() {
            first.is_cut[0] = false;
        }
        if let Some(last) = parts.last_mut() {
            last.is_cut[1] = false;
        }
    } else if count == 1 {
        parts[0].path.closed = true;
        parts[0].is_cut = [false, false];
    } else if count > 1 && parts[0].cell == parts[count - 1].cell {
        // The start of the path is no cut: what comes before it belongs to the same piece.
        if let Some(mut last) = parts.pop() {
            last.path.cubics.append(&mut parts[0].path.cubics);
            parts[0].path.cubics = last.path.cubics;
        }
    }
    parts
}

/// The parameters at which a segment passes from cell to cell, with 0 and 1.
fn cuts(cubic: &Cubic<2>, lattice: &Lattice, origin: Vector<2>) -> Vec<f64> {
    let coordinates = cubic.map(|p| lattice.coordinates(p - origin));
    let mut cuts = vec![0.0, 1.0];
    for k in 0..2 {
        let values = coordinates.map(|c| c[k]);
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        if low.floor() == high.floor() {
            continue;
        }
        let at = |t: f64| {
            let u = 1.0 - t;
            values[0] * u * u * u + 3.0 * values[1] * u * u * t + 3.0 * values[2] * u * t * t + values[3] * t * t * t
        };
        // Between its turning points, each coordinate rises or falls all the way.
        let mut stops = turning_points(&values);
        stops.extend((0..=LOOK.0).map(|n| n as f64 / LOOK.0 as f64));
        stops.sort_by(f64::total_cmp);
        for span in stops.windows(2) {
            let (a, b) = (at(span[0]), at(span[1]));
            let (first, last) = (a.min(b).ceil() as i64, a.max(b).floor() as i64);
            for side in first..=last.min(first + 10_000) {
                cuts.push(root(at, span[0], span[1], side as f64));
            }
        }
    }
    cuts.sort_by(f64::total_cmp);
    let mut kept: Vec<f64> = Vec::with_capacity(cuts.len());
    for cut in cuts {
        if kept.last().is_none_or(|last| cut - last > SAME) {
            kept.push(cut);
        }
    }
    if let Some(last) = kept.last_mut() {
        // The end itself, not a cut just before it.
        *last = 1.0;
    }
    kept
}

fn turning_points(v: &[f64; 4]) -> Vec<f64> {
    let (a, b, c) = (v[3] - 3.0 * v[2] + 3.0 * v[1] - v[0], 2.0 * (v[2] - 2.0 * v[1] + v[0]), v[1] - v[0]);
    let mut found = Vec::new();
    if a.abs() > 1e-12 {
        let root = b * b - 4.0 * a * c;
        if root >= 0.0 {
            found.extend([(-b - root.sqrt()) / (2.0 * a), (-b + root.sqrt()) / (2.0 * a)]);
        }
    } else if b.abs() > 1e-12 {
        found.push(-c / b);
    }
    found.retain(|t| (0.0..=1.0).contains(t));
    found
}

/// Where a function that rises or falls between two parameters has a value.
fn root(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64, value: f64) -> f64 {
    let rises = f(high) > f(low);
    for _ in 0..LOOK.1 {
        let middle = 0.5 * (low + high);
        if (f(middle) < value) == rises { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use super::*;

    #[test]
    fn a_line_is_cut_at_every_side() {
        let lattice = Lattice::new(Vector::xy(10.0, 0.0), Vector::xy(0.0, 10.0)).unwrap();
        let path = Path::polyline(&[Vector::xy(-3.0, 5.0), Vector::xy(27.0, 5.0)]);
        let parts = pieces(&path, &lattice, Vector::ZERO);
        let cells: Vec<_> = parts.iter().map(|p| (p.cell, p.is_cut)).collect();
        let cut = |start, end| [start, end];
        let expected = [
            ([-1, 0], cut(false, true)),
            ([0, 0], cut(true, true)),
            ([1, 0], cut(true, true)),
            ([2, 0], cut(true, false)),
        ];
        assert_eq!(cells, expected);
        assert!((parts[1].path.start().unwrap() - Vector::xy(0.0, 5.0)).norm() < 1e-9);
        assert!((parts[1].path.end().unwrap() - Vector::xy(10.0, 5.0)).norm() < 1e-9);
    }

    #[test]
    fn a_circle_over_four_cells_has_four_pieces_and_one_in_a_cell_stays_closed() {
        let lattice = Lattice::new(Vector::xy(10.0, 0.0), Vector::xy(0.0, 10.0)).unwrap();
        let circle = |centre: Vector<2>, radius: f64| {
            let k = 0.552_284_75;
            let arc = |turn: f64| -> Cubic<2> {
                let (s, c) = turn.sin_cos();
                let at = |x: f64, y: f64| centre + Vector::xy(c * x - s * y, s * x + c * y) * radius;
                [at(1.0, 0.0), at(1.0, k), at(k, 1.0), at(0.0, 1.0)]
            };
            let quarter = std::f64::consts::FRAC_PI_2;
            Path { cubics: (0..4).map(|n| arc(0.4 + quarter * f64::from(n))).collect(), closed: true }
        };
        let parts = pieces(&circle(Vector::xy(10.0, 10.0), 3.0), &lattice, Vector::ZERO);
        assert_eq!(parts.len(), 4);
        assert!(parts.iter().all(|p| p.is_cut == [true, true]));
        let inside = pieces(&circle(Vector::xy(5.0, 5.0), 3.0), &lattice, Vector::ZERO);
        assert!(inside.len() == 1 && inside[0].path.closed);
    }
}
