//! What a ribbon is made of, and how a piece shows its part of the exemplar.

use arabesque_core::{Patch, Vector};

/// A piece of a ribbon: a quadrilateral that shows a part of an exemplar, its right side bent to meet the next piece.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece<const D: usize> {
    /// Where it lies and what it shows.
    pub patch: Patch<D>,
    /// For evenly spaced places down the right edge, how far down the edge the colour is taken from, in exemplar pixels. Empty for none.
    pub shift: Vec<f32>,
}

/// The pieces along one curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Ribbon<const D: usize> {
    /// The pieces in order.
    pub pieces: Vec<Piece<D>>,
    /// Whether the last piece is followed by the first.
    pub closed: bool,
    /// Ω [Zhou 2013 §1.3] and what re-use and variety add to it, in 8-bit colour steps.
    pub cost: f64,
}

impl<const D: usize> Piece<D> {
    /// Where in the exemplar the colour at `q` is taken from; both in exemplar pixels, `q` as if nothing were bent [Zhou 2013 §3.2].
    pub fn bent(&self, q: Vector<2>) -> Vector<2> {
        if self.shift.is_empty() {
            return q;
        }
        let [tl, tr, br, bl] = self.patch.texture;
        let (left, edge) = (bl - tl, br - tr);
        let share = ((q - tl).dot(left) / left.norm2()).clamp(0.0, 1.0);
        let along = (tr - tl) * (1.0 - share) + (br - bl) * share;
        let (before, after) = (along.cross(left), along.cross(edge));
        if before < 1e-9 || after < 1e-9 {
            return q;
        }
        let rest = ((tr - q).cross(edge) / after).max(0.0);
        let done = ((q - tl).cross(left) / before).max(0.0);
        let weight = (done / (done + rest).max(1e-9)).clamp(0.0, 1.0);
        let at = (q + along * rest - tr).dot(edge) / edge.norm2();
        q + edge * (weight * self.shift_at(at) / edge.norm())
    }

    /// Where the colour at `q` of the exemplar is shown: the inverse of [`Piece::bent`].
    pub fn unbent(&self, q: Vector<2>) -> Vector<2> {
        (0..6).fold(q, |p, _| p + (q - self.bent(p)))
    }

    /// The shift at a share of the right edge.
    fn shift_at(&self, share: f64) -> f64 {
        let at = (share * self.shift.len() as f64 - 0.5).clamp(0.0, self.shift.len() as f64 - 1.0);
        let (low, part) = (at.floor() as usize, at.fract());
        let high = (low + 1).min(self.shift.len() - 1);
        f64::from(self.shift[low]) * (1.0 - part) + f64::from(self.shift[high]) * part
    }
}

impl Piece<2> {
    /// User units per exemplar pixel.
    pub fn scale(&self) -> f64 {
        let (canvas, texture) = (&self.patch.corners, &self.patch.texture);
        (canvas[3] - canvas[0]).norm() / (texture[3] - texture[0]).norm()
    }

    /// Axes of the exemplar on the canvas: along and down, one exemplar pixel long.
    fn axes(&self) -> (Vector<2>, Vector<2>) {
        let (canvas, texture) = (&self.patch.corners, &self.patch.texture);
        let (edge, foot) = (canvas[3] - canvas[0], texture[3] - texture[0]);
        let along = Vector::xy(edge.dot(foot), foot.cross(edge)) * (1.0 / foot.norm2());
        (along, Vector::xy(-along[1], along[0]))
    }

    /// The place in the exemplar that lies at `p` of the canvas, as if nothing were bent.
    pub fn to_exemplar(&self, p: Vector<2>) -> Vector<2> {
        let (along, down) = self.axes();
        let q = (p - self.patch.corners[0]) * (1.0 / down.norm2());
        self.patch.texture[0] + Vector::xy(q.dot(along), q.dot(down))
    }

    /// The inverse of [`Piece::to_exemplar`].
    pub fn to_canvas(&self, q: Vector<2>) -> Vector<2> {
        let ((along, down), q) = (self.axes(), q - self.patch.texture[0]);
        self.patch.corners[0] + along * q[0] + down * q[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(shift: f32) -> Piece<2> {
        let texture = [(10.0, 0.0), (20.0, 1.0), (18.0, 19.0), (10.0, 20.0)].map(|(x, y)| Vector::xy(x, y));
        let corners = texture.map(|p| Vector::xy(100.0 - 2.0 * p[1], 2.0 * p[0]));
        Piece { patch: Patch { source: 0, corners, texture }, shift: vec![shift; 20] }
    }

    #[test]
    fn the_canvas_is_mapped_to_the_exemplar_and_back() {
        let piece = piece(0.0);
        let p = Vector::xy(80.0, 25.0);
        let q = piece.to_exemplar(p);
        assert!((q - Vector::xy(12.5, 10.0)).norm() < 1e-9, "{q:?}");
        assert!((piece.to_canvas(q) - p).norm() < 1e-9);
        assert!((piece.scale() - 2.0).abs() < 1e-9);
    }

    #[test]
    fn bending_grows_from_the_left_edge_to_the_right_one() {
        let piece = piece(2.0);
        let shift = |x: f64| (piece.bent(Vector::xy(x, 10.0)) - Vector::xy(x, 10.0)).norm();
        assert!(shift(10.0) < 1e-9 && (shift(14.5) - 1.0).abs() < 0.05 && (shift(19.0) - 2.0).abs() < 0.05);
        let q = Vector::xy(16.0, 8.0);
        assert!((piece.bent(piece.unbent(q)) - q).norm() < 1e-3);
    }
}
