//! A lattice of the plane.

use arabesque_core::Vector;

/// Two vectors count as parallel when the sine of their angle is below this.
const PARALLEL: f64 = 0.02;

/// All integer combinations of two vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// The two vectors, the shortest that span it.
    pub vectors: [Vector<2>; 2],
}

/// A node of a lattice, as a combination of its vectors.
pub(crate) type Node = [i64; 2];

impl Lattice {
    /// The lattice of two independent vectors, reduced; `None` where they are parallel or not finite.
    pub fn new(a: Vector<2>, b: Vector<2>) -> Option<Self> {
        let sound = a.is_finite() && b.is_finite() && !are_parallel(a, b);
        sound.then(|| Self { vectors: reduced(a, b) })
    }

    /// Area of a cell.
    pub fn cell(&self) -> f64 {
        self.vectors[0].cross(self.vectors[1]).abs()
    }

    /// Length of the shorter vector.
    pub(crate) fn shorter(&self) -> f64 {
        self.vectors[0].norm().min(self.vectors[1].norm())
    }

    /// The coordinates of a vector in terms of the two.
    pub fn coordinates(&self, v: Vector<2>) -> Vector<2> {
        let [a, b] = self.vectors;
        let measure = a.cross(b);
        Vector::xy(v.cross(b) / measure, a.cross(v) / measure)
    }

    /// The vector with these coordinates.
    pub fn vector(&self, coordinates: Vector<2>) -> Vector<2> {
        self.vectors[0] * coordinates[0] + self.vectors[1] * coordinates[1]
    }

    /// The vector to a node.
    pub(crate) fn at(&self, node: Node) -> Vector<2> {
        self.vectors[0] * node[0] as f64 + self.vectors[1] * node[1] as f64
    }

    /// The node nearest to a vector in terms of the coordinates, and what is left.
    pub(crate) fn nearest(&self, v: Vector<2>) -> (Node, Vector<2>) {
        let coordinates = self.coordinates(v);
        let node = coordinates.0.map(|c| c.round() as i64);
        (node, v - self.at(node))
    }

    /// The part of a vector that lies in the cell at the origin: coordinates in [0, 1).
    pub(crate) fn folded(&self, v: Vector<2>) -> Vector<2> {
        let inside = self.coordinates(v).map(|c| c - c.floor());
        self.vector(inside)
    }

    /// The same lattice with both vectors changed by `map`.
    pub(crate) fn map(&self, map: impl Fn(Vector<2>) -> Vector<2>) -> Self {
        Self { vectors: self.vectors.map(map) }
    }

    /// The nodes of which a vector to them, from `origin`, may lie in a box: a range for each coordinate.
    pub(crate) fn nodes_in(
        &self,
        origin: Vector<2>,
        bounds: &arabesque_core::Bounds<2>,
    ) -> [std::ops::RangeInclusive<i64>; 2] {
        let corners = [
            bounds.min,
            Vector::xy(bounds.max[0], bounds.min[1]),
            bounds.max,
            Vector::xy(bounds.min[0], bounds.max[1]),
        ];
        let coordinates = corners.map(|corner| self.coordinates(corner - origin));
        std::array::from_fn(|k| {
            let low = coordinates.iter().map(|c| c[k]).fold(f64::INFINITY, f64::min);
            let high = coordinates.iter().map(|c| c[k]).fold(f64::NEG_INFINITY, f64::max);
            (low.floor() as i64)..=(high.ceil() as i64)
        })
    }
}

/// Whether two vectors span no area worth the name.
pub(crate) fn are_parallel(a: Vector<2>, b: Vector<2>) -> bool {
    a.cross(b).abs() <= PARALLEL * a.norm() * b.norm()
}

/// The shortest vectors of a lattice [Lagrange, Gauss], the first pointing right, or down where it is upright; the
/// second to its left.
fn reduced(mut a: Vector<2>, mut b: Vector<2>) -> [Vector<2>; 2] {
    for _ in 0..64 {
        if b.norm2() < a.norm2() {
            std::mem::swap(&mut a, &mut b);
        }
        let steps = (a.dot(b) / a.norm2()).round();
        if steps == 0.0 {
            break;
        }
        b -= a * steps;
    }
    let points_right = |v: Vector<2>| v[0] > 1e-9 * v.norm() || (v[0].abs() <= 1e-9 * v.norm() && v[1] > 0.0);
    // Of two that are equally long, the one that lies flatter is named first.
    if b.norm() < a.norm() * (1.0 + 1e-9) && b[1].abs() < a[1].abs() {
        std::mem::swap(&mut a, &mut b);
    }
    let a = if points_right(a) { a } else { -a };
    let b = if a.cross(b) > 0.0 { b } else { -b };
    [a, b]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use super::*;

    #[test]
    fn long_vectors_of_a_square_lattice_are_reduced_to_its_sides() {
        let lattice = Lattice::new(Vector::xy(30.0, 10.0), Vector::xy(10.0, 0.0)).unwrap();
        assert_eq!(lattice.vectors, [Vector::xy(10.0, 0.0), Vector::xy(0.0, 10.0)]);
        assert_eq!(lattice.cell(), 100.0);
        assert!(Lattice::new(Vector::xy(1.0, 0.0), Vector::xy(2.0, 0.01)).is_none());
    }

    #[test]
    fn what_is_folded_differs_by_a_node() {
        let lattice = Lattice::new(Vector::xy(7.0, 1.0), Vector::xy(-2.0, 5.0)).unwrap();
        let v = Vector::xy(123.4, -56.7);
        let (node, rest) = lattice.nearest(v);
        assert!((lattice.at(node) + rest - v).norm() < 1e-9 && rest.norm() < 8.0);
        let folded = lattice.folded(v);
        let (_, apart) = lattice.nearest(v - folded);
        assert!(apart.norm() < 1e-9);
    }
}
