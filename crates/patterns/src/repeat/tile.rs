//! Which tiles suit a repeat: those whose sides are translations of it.

use arabesque_core::Vector;

use crate::repeat::{
    description::{Extent, Repeat},
    lattice::{Lattice, Node},
};

/// Nodes are looked for so many vectors away.
const FAR: i64 = 64;

/// A vector lies along an axis when it leaves it by less than this share of its length, or, drawn by hand, by less than so
/// many times the jitter in terms of the shorter vector: no better is it known.
const ALONG: (f64, f64) = (2e-4, 0.3);

/// Most cells along stripes in a tile.
const MOST_CELLS: f64 = 1e5;

/// How a tile fits a repeat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileFit {
    /// The sides of the tile, as combinations of the vectors of the repeat.
    pub(crate) sides: [Node; 2],
    /// The vectors as they are when the sides fit.
    pub(crate) lattice: Lattice,
    /// Largest relative change of a length that this takes: 0 where the tile suits as it is.
    pub stretch: f64,
}

/// What the repeat is mapped with before it is compared with a tile: a turn and a scale.
pub(crate) type Linear<'a> = &'a dyn Fn(Vector<2>) -> Vector<2>;

impl Repeat {
    /// Width and height of the smallest rectangle along the axes that tiles the plane with this repeat; `None` where no
    /// multiple of its vectors, within reason, lies along both axes.
    pub fn smallest_tile(&self) -> Option<[f64; 2]> {
        self.tile_within(self.slack())
    }

    /// The smallest rectangle along the axes of which the sides are vectors that leave them by at most `slack`.
    pub(crate) fn tile_within(&self, slack: f64) -> Option<[f64; 2]> {
        if let Extent::Stripes(along) = self.extent {
            return stripes_tile(along, self.period_of_stripes());
        }
        let side = |axis| along_axis(&self.lattice, axis, slack).map(|node| self.lattice.at(node)[axis].abs());
        Some([side(0)?, side(1)?])
    }

    /// How far a vector may lie off an axis, as a share of its length.
    fn slack(&self) -> f64 {
        let shorter = self.lattice.shorter();
        ALONG.0.max(ALONG.1 * self.jitter / shorter)
    }

    /// Distance after which stripes repeat.
    fn period_of_stripes(&self) -> f64 {
        let Extent::Stripes(along) = self.extent else { return 0.0 };
        let across = self.lattice.vectors.map(|v| v.cross(along).abs());
        across.into_iter().fold(0.0, f64::max)
    }

    /// How a tile of this size, larger than nothing, fits the repeat after `map`.
    pub(crate) fn fit(&self, size: Vector<2>, map: Linear<'_>) -> Option<TileFit> {
        let lattice = self.lattice.map(map);
        let edges = [Vector::xy(size[0], 0.0), Vector::xy(0.0, size[1])];
        if let Extent::Stripes(along) = self.extent {
            let along = map(along).unit_or_zero();
            let across = lattice.vectors.map(|v| v.cross(along).abs()).into_iter().fold(0.0, f64::max);
            let length = lattice.vectors.map(|v| v.dot(along).abs()).into_iter().fold(0.0, f64::max);
            return fit_stripes(along, across, length, edges);
        }
        let on_axis = |axis: usize| {
            let node = along_axis(&lattice, axis, self.slack())?;
            let step = lattice.at(node)[axis];
            let count = (size[axis] / step.abs()).round() * step.signum();
            // A tile that is shorter than this may still come near to another vector.
            (count != 0.0).then(|| node.map(|n| n * count as i64))
        };
        let nearest = |axis: usize| lattice.nearest(edges[axis]).0;
        let sides = [0, 1].map(|axis| on_axis(axis).unwrap_or_else(|| nearest(axis)));
        fitted(&lattice, sides, edges)
    }
}

/// The lattice of which the sides are exactly the edges, where they are independent.
fn fitted(lattice: &Lattice, sides: [Node; 2], edges: [Vector<2>; 2]) -> Option<TileFit> {
    let [[a, b], [c, d]] = sides.map(|side| side.map(|n| n as f64));
    let measure = a * d - b * c;
    if measure == 0.0 {
        return None;
    }
    let vectors = [(edges[0] * d - edges[1] * b) * (1.0 / measure), (edges[1] * a - edges[0] * c) * (1.0 / measure)];
    let stretch = strain(lattice.vectors, vectors);
    Some(TileFit { sides, lattice: Lattice { vectors }, stretch })
}

/// Stripes go on along themselves as far as is wanted: only what lies across the edges must fit. Along them, cells of at most the
/// `length` that the exemplar has them in follow one another, so that none leaves a gap.
fn fit_stripes(along: Vector<2>, across: f64, length: f64, edges: [Vector<2>; 2]) -> Option<TileFit> {
    let normal = Vector::xy(-along[1], along[0]);
    let counts = edges.map(|edge| (edge.dot(normal) / across).round());
    let [x, y] = counts;
    let (a, rest) = match (x != 0.0, y != 0.0) {
        (true, _) => (edges[0] * (1.0 / x), edges[1] - edges[0] * (y / x)),
        (false, true) => (edges[1] * (1.0 / y), edges[0]),
        (false, false) => return None,
    };
    let cells = (rest.norm() / length - 1e-6).ceil().clamp(1.0, MOST_CELLS);
    let vectors = [a, rest * (1.0 / cells)];
    let n = cells as i64;
    let sides = if x != 0.0 { [[x as i64, 0], [y as i64, n]] } else { [[0, n], [y as i64, 0]] };
    let along_now = vectors[1].unit_or_zero();
    let across_now = vectors[0].cross(along_now).abs();
    let turned = along_now.cross(along).abs();
    let stretch = (across_now / across - 1.0).abs().max(turned);
    Some(TileFit { sides, lattice: Lattice { vectors }, stretch })
}

/// Largest relative change of a length by the map that takes one pair of vectors to the other.
fn strain(from: [Vector<2>; 2], to: [Vector<2>; 2]) -> f64 {
    let measure = from[0].cross(from[1]);
    let image = |v: Vector<2>| {
        let (s, t) = (v.cross(from[1]) / measure, from[0].cross(v) / measure);
        to[0] * s + to[1] * t
    };
    let (u, v) = (image(Vector::xy(1.0, 0.0)), image(Vector::xy(0.0, 1.0)));
    // Singular values of the map with these columns.
    let (sum, product) = (u.norm2() + v.norm2(), u.cross(v).abs());
    let apart = (sum * sum - 4.0 * product * product).max(0.0).sqrt();
    let [large, small] = [0.5 * (sum + apart), 0.5 * (sum - apart)].map(|s| s.max(0.0).sqrt());
    (large - 1.0).abs().max((1.0 - small).abs())
}

/// The shortest vector of a lattice along an axis, as nearly as `slack`.
fn along_axis(lattice: &Lattice, axis: usize, slack: f64) -> Option<Node> {
    let mut best: Option<(f64, Node)> = None;
    for i in -FAR..=FAR {
        for j in 0..=FAR {
            let v = lattice.at([i, j]);
            let length = v.norm();
            let shorter = best.is_none_or(|(least, _)| length < least * (1.0 - 1e-9));
            // Far away, a direction is known no better than the vectors are.
            if length > 0.0 && v[1 - axis].abs() <= slack * length && shorter {
                best = Some((length, [i, j]));
            }
        }
    }
    let (_, node) = best?;
    Some(if lattice.at(node)[axis] < 0.0 { node.map(|n| -n) } else { node })
}

fn stripes_tile(along: Vector<2>, across: f64) -> Option<[f64; 2]> {
    // Along an axis that stripes follow, any length will do.
    let step = |axis: usize| {
        let slope = along[1 - axis].abs();
        if slope < 1e-9 { across } else { across / slope }
    };
    (across > 0.0).then(|| [step(0), step(1)])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use super::*;
    use crate::repeat::{description::Explains, marks::Anchor};

    fn repeat(a: (f64, f64), b: (f64, f64), extent: Extent) -> Repeat {
        let lattice = Lattice::new(Vector::xy(a.0, a.1), Vector::xy(b.0, b.1)).unwrap();
        Repeat { lattice, explains: Explains::Everything, extent, anchor: Anchor::Centre, jitter: 0.0, share: 1.0 }
    }

    #[test]
    fn bricks_in_bond_take_two_rows() {
        let bricks = repeat((40.0, 0.0), (20.0, 12.0), Extent::Plane);
        assert_eq!(bricks.smallest_tile(), Some([40.0, 24.0]));
        let fit = bricks.fit(Vector::xy(120.0, 48.0), &|v| v).unwrap();
        assert!(fit.stretch < 1e-12);
        let fit = bricks.fit(Vector::xy(126.0, 48.0), &|v| v).unwrap();
        assert!((fit.stretch - 0.05).abs() < 1e-9, "{}", fit.stretch);
        assert!((fit.lattice.at(fit.sides[0]) - Vector::xy(126.0, 0.0)).norm() < 1e-9);
        assert!((fit.lattice.at(fit.sides[1]) - Vector::xy(0.0, 48.0)).norm() < 1e-9);
    }

    #[test]
    fn an_oblique_lattice_has_no_tile_along_the_axes() {
        let oblique = repeat((10.0, 1.234_567), (3.3, 8.191_919), Extent::Plane);
        assert_eq!(oblique.smallest_tile(), None);
        let large = oblique.fit(Vector::xy(400.0, 400.0), &|v| v).unwrap();
        assert!(large.stretch < 0.03, "{}", large.stretch);
    }

    #[test]
    fn stripes_fit_tiles_across_themselves() {
        let along = Vector::xy(0.0, 1.0);
        let upright = repeat((20.0, 0.0), (0.0, 20.0), Extent::Stripes(along));
        assert_eq!(upright.smallest_tile(), Some([20.0, 20.0]));
        let fit = upright.fit(Vector::xy(60.0, 77.0), &|v| v).unwrap();
        assert!(fit.stretch < 1e-12);
        let side = std::f64::consts::FRAC_1_SQRT_2;
        let slanted = repeat((10.0 * side, 10.0 * side), (-5.0, 5.0), Extent::Stripes(Vector::xy(-side, side)));
        let tile = slanted.smallest_tile().unwrap();
        assert!((tile[0] - 10.0 / side).abs() < 1e-9 && (tile[1] - 10.0 / side).abs() < 1e-9);
        let fit = slanted.fit(Vector::xy(2.0 * tile[0], 3.0 * tile[1]), &|v| v).unwrap();
        assert!(fit.stretch < 1e-9);
        for (side, edge) in fit.sides.iter().zip([Vector::xy(2.0 * tile[0], 0.0), Vector::xy(0.0, 3.0 * tile[1])]) {
            assert!((fit.lattice.at(*side) - edge).norm() < 1e-9);
        }
    }
}
