//! Pieces as facets: polygons through which the picture of the exemplar is seen under an affine map each.

use arabesque_core::{Bounds, Budget, Image, Result, Vector};

use crate::{
    pieces::piece::Piece,
    pieces::rungs::{Rung, rungs},
};

/// A facet of four corners is shown as one when its fourth corner is no farther off than this, in exemplar pixels.
const FLAT: f64 = 0.4;
/// How far around a facet ink counts, in exemplar pixels.
const MARGIN: f64 = 2.0;
/// A facet is shown with its own map when that stretches no more than this many times as much as the rigid one.
const STRETCH: f64 = 3.0;

/// Work of looking at one pixel for ink, and of one facet.
const PIXEL: u64 = 1;
const FACET: u64 = 300;

/// A polygon through which the picture of an exemplar is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Facet {
    /// Which exemplar.
    pub source: usize,
    /// The polygon, in user units.
    pub ring: Vec<Vector<2>>,
    /// From pixels of the exemplar to user units: a point (x, y) to (ax + cy + e, bx + dy + f), the numbers in order from a to f.
    pub matrix: [f64; 6],
}

/// The facets of a piece of an exemplar with this `image` in which there is anything to see.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work is used up, [`arabesque_core::Error::Stopped`] when somebody asked to stop.
pub fn facets(piece: &Piece<2>, image: &Image, budget: &Budget) -> Result<Vec<Facet>> {
    let rigid = rigid(piece);
    let mut all = Vec::new();
    for pair in rungs(piece, image.height as f64).windows(2) {
        budget.spend(FACET)?;
        if has_ink(image, pair.iter().flat_map(|rung| rung.texture), budget)? {
            all.extend(between(piece.patch.source, &rigid, &pair[0], &pair[1]));
        }
    }
    Ok(all)
}

/// Whether anything can be seen in the box around `corners`, and a little beyond.
fn has_ink(image: &Image, corners: impl IntoIterator<Item = Vector<2>>, budget: &Budget) -> Result<bool> {
    let bounds = Bounds::around(corners).grown(MARGIN);
    let range = |k: usize, n: usize| {
        let clamp = |v: f64| v.clamp(0.0, n as f64) as usize;
        clamp(bounds.min[k].floor())..clamp(bounds.max[k].ceil())
    };
    let columns = range(0, image.width);
    for y in range(1, image.height) {
        budget.spend(PIXEL * columns.len() as u64)?;
        if columns.clone().any(|x| image.pixel(x, y)[3] > 0) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// What lies between two lines across a piece: one facet where that is flat enough, else two triangles. `rigid` is the map of the piece
/// as if it were not bent.
fn between(source: usize, rigid: &[f64; 6], upper: &Rung<2>, lower: &Rung<2>) -> Vec<Facet> {
    let [a, b] = [0, 1].map(|k| (upper.texture[k], upper.ends[k]));
    let [d, c] = [0, 1].map(|k| (lower.texture[k], lower.ends[k]));
    let facet = |corners: &[(Vector<2>, Vector<2>)], matrix: [f64; 6]| Facet {
        source,
        ring: corners.iter().map(|corner| corner.1).collect(),
        matrix,
    };
    if let Some(matrix) = affine([a, c, d]).filter(|m| is_even(m, rigid))
        && (apply(&matrix, b.0) - b.1).norm() <= FLAT * size(rigid)
    {
        return vec![facet(&[a, b, c, d], matrix)];
    }
    let map = |corners| affine(corners).filter(|m| is_even(m, rigid)).unwrap_or_else(|| moved(rigid, corners));
    [[a, b, c], [a, c, d]].into_iter().map(|corners| facet(&corners, map(corners))).collect()
}

/// User units per pixel of the picture.
fn size(matrix: &[f64; 6]) -> f64 {
    (matrix[0] * matrix[3] - matrix[1] * matrix[2]).abs().sqrt()
}

/// Whether a map stretches not much more than the rigid one: a row that is pulled over many shows nothing but itself.
fn is_even(matrix: &[f64; 6], rigid: &[f64; 6]) -> bool {
    let most = STRETCH * size(rigid);
    let turned = matrix[0] * matrix[3] - matrix[1] * matrix[2];
    turned > 0.0 && matrix[0].hypot(matrix[1]) <= most && matrix[2].hypot(matrix[3]) <= most
}

/// The rigid map moved such that the middle of three corners is shown where it belongs.
fn moved(rigid: &[f64; 6], corners: [(Vector<2>, Vector<2>); 3]) -> [f64; 6] {
    let middle = |k: fn(&(Vector<2>, Vector<2>)) -> Vector<2>| {
        corners.iter().fold(Vector::ZERO, |sum, corner| sum + k(corner)) * (1.0 / 3.0)
    };
    let off = middle(|c| c.1) - apply(rigid, middle(|c| c.0));
    let [a, b, c, d, e, f] = *rigid;
    [a, b, c, d, e + off[0], f + off[1]]
}

/// The map of a piece as if it were not bent.
fn rigid(piece: &Piece<2>) -> [f64; 6] {
    let [x, y, o] = [Vector::xy(1.0, 0.0), Vector::xy(0.0, 1.0), Vector::ZERO].map(|q| piece.to_canvas(q));
    let (x, y) = (x - o, y - o);
    [x[0], x[1], y[0], y[1], o[0], o[1]]
}

/// The affine map that takes three points of the picture to three of the canvas, as [`Facet::matrix`] has it.
fn affine([p, q, r]: [(Vector<2>, Vector<2>); 3]) -> Option<[f64; 6]> {
    let (u, v) = (q.0 - p.0, r.0 - p.0);
    let (s, t) = (q.1 - p.1, r.1 - p.1);
    let area = u.cross(v);
    if area.abs() < 1e-6 {
        return None;
    }
    let column = |along: [f64; 2]| (s * along[0] + t * along[1]) * (1.0 / area);
    let (x, y) = (column([v[1], -u[1]]), column([-v[0], u[0]]));
    let shift = p.1 - x * p.0[0] - y * p.0[1];
    Some([x[0], x[1], y[0], y[1], shift[0], shift[1]])
}

fn apply([a, b, c, d, e, f]: &[f64; 6], p: Vector<2>) -> Vector<2> {
    Vector::xy(a * p[0] + c * p[1] + e, b * p[0] + d * p[1] + f)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_points_make_a_map() {
        let to = |p: Vector<2>| Vector::xy(3.0 + 2.0 * p[0] - p[1], 5.0 + p[0] + 4.0 * p[1]);
        let points = [(1.0, 1.0), (7.0, 2.0), (3.0, 9.0)].map(|(x, y)| Vector::xy(x, y));
        let matrix = affine(points.map(|p| (p, to(p)))).unwrap();
        let q = Vector::xy(-4.0, 11.0);
        assert!((apply(&matrix, q) - to(q)).norm() < 1e-9);
        assert!(affine([points[0], points[0], points[1]].map(|p| (p, p))).is_none());
    }

    #[test]
    fn what_is_empty_is_left_out() {
        let mut image = Image::transparent(20, 20);
        let corners = [(3.0, 3.0), (8.0, 6.0)].map(|(x, y)| Vector::xy(x, y));
        image.pixels[15 * 20 + 15] = [1, 2, 3, 4];
        assert!(!has_ink(&image, corners, &Budget::default()).unwrap());
        image.pixels[5 * 20 + 5] = [1, 2, 3, 4];
        assert!(has_ink(&image, corners, &Budget::default()).unwrap());
    }

    #[test]
    fn bent_facets_are_two_triangles_and_flat_ones_one() {
        let v = |x: f64, y: f64| Vector::xy(x, y);
        let rung = |y: f64, shift: f64| Rung { ends: [v(0.0, y), v(9.0, y)], texture: [v(0.0, y), v(9.0, y + shift)] };
        let still = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        assert_eq!(between(0, &still, &rung(0.0, 1.0), &rung(4.0, 1.0)).len(), 1);
        assert_eq!(between(0, &still, &rung(0.0, 0.0), &rung(4.0, 1.0)).len(), 2);
        // Four rows that all show one: nothing is stretched without end.
        for facet in between(0, &still, &rung(0.0, 4.0), &rung(4.0, 0.0)) {
            assert!(facet.matrix[2].hypot(facet.matrix[3]) <= STRETCH, "{facet:?}");
        }
    }
}
