//! Tiles that a repeat suggests by itself, as it is or turned and scaled.

use arabesque_core::{Matrix, Vector};

use crate::repeat::description::{Explains, Extent, Repeat};

/// Elements that lie off by more than this share of the shorter vector were put there by hand.
const BY_HAND: f64 = 0.004;

/// How far a vector may lie off an axis in a tile that suits nearly, least first, as a share of its length.
const NEARLY: [f64; 6] = [0.001, 0.0025, 0.005, 0.01, 0.02, 0.04];

/// A tile that takes more stretching than this suits no more.
const MOST_STRETCH: f64 = 0.05;

/// A tile that a repeat fills when it is stretched a little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearTile {
    /// Width and height.
    pub size: [f64; 2],
    /// Largest relative change of a length.
    pub stretch: f64,
}

impl Repeat {
    /// The tile to make of an exemplar whose frame has the size `shown`, the pattern turned by `turn` and scaled by
    /// `scale`: the smallest that is exactly periodic, or, where what lies at the places varies, a multiple of it about
    /// as large as the exemplar, for the smallest would show one thing again and again. `None` where no vectors of the
    /// repeat lie along the axes.
    pub fn seamless_tile(&self, shown: Vector<2>, turn: &Matrix<2>, scale: f64) -> Option<[f64; 2]> {
        let least = self.turned(turn, scale).smallest_tile()?;
        let shorter = self.lattice.shorter();
        if self.explains == Explains::Everything && self.jitter <= BY_HAND * shorter {
            return Some(least);
        }
        let reach = |k: usize| scale * (turn.0[k][0].abs() * shown[0] + turn.0[k][1].abs() * shown[1]);
        Some([0, 1].map(|k| least[k] * (reach(k) / least[k]).round().max(1.0)))
    }

    /// The smallest tile that suits with little stretching, for a repeat that has no tile of its own.
    pub fn near_tile(&self, turn: &Matrix<2>, scale: f64) -> Option<NearTile> {
        let turned = self.turned(turn, scale);
        NEARLY.into_iter().find_map(|slack| {
            let size = turned.tile_within(slack)?;
            let fit = turned.fit(Vector(size), &|v| v).filter(|fit| fit.stretch <= MOST_STRETCH)?;
            Some(NearTile { size, stretch: fit.stretch })
        })
    }

    /// The repeat of the turned and scaled pattern.
    fn turned(&self, turn: &Matrix<2>, scale: f64) -> Self {
        let extent = match self.extent {
            Extent::Stripes(along) => Extent::Stripes(turn.apply(along)),
            Extent::Plane | Extent::Frieze => self.extent,
        };
        let lattice = self.lattice.map(|v| turn.apply(v) * scale);
        Self { lattice, extent, jitter: self.jitter * scale, ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use super::*;
    use crate::repeat::{lattice::Lattice, marks::Anchor};

    fn bricks() -> Repeat {
        let lattice = Lattice::new(Vector::xy(40.0, 0.0), Vector::xy(20.0, 12.0)).unwrap();
        let (explains, extent, anchor) = (Explains::Everything, Extent::Plane, Anchor::Centre);
        Repeat { lattice, explains, extent, anchor, jitter: 0.0, share: 1.0 }
    }

    #[test]
    fn a_quarter_turn_swaps_the_sides_and_a_scale_stretches_them() {
        let (shown, upright) = (Vector::xy(130.0, 90.0), Matrix::identity());
        assert_eq!(bricks().seamless_tile(shown, &upright, 1.0), Some([40.0, 24.0]));
        let turned = bricks().seamless_tile(shown, &Matrix::rotation(std::f64::consts::FRAC_PI_2), 0.5).unwrap();
        assert!((turned[0] - 12.0).abs() < 1e-9 && (turned[1] - 20.0).abs() < 1e-9, "{turned:?}");
        assert_eq!(bricks().seamless_tile(shown, &Matrix::rotation(0.3), 1.0), None);
        let near = bricks().near_tile(&Matrix::rotation(0.3), 1.0).unwrap();
        assert!(near.stretch <= MOST_STRETCH && near.size[0] > 12.0, "{near:?}");
    }

    #[test]
    fn an_oblique_lattice_nearly_suits_a_larger_tile() {
        let lattice = Lattice::new(Vector::xy(17.0, 3.1), Vector::xy(5.3, 15.0)).unwrap();
        let oblique = Repeat { lattice, ..bricks() };
        assert_eq!(oblique.smallest_tile(), None);
        let near = oblique.near_tile(&Matrix::identity(), 1.0).unwrap();
        assert!(near.stretch < 0.01 && near.size[0] > 100.0, "{near:?}");
    }

    #[test]
    fn what_varies_from_place_to_place_takes_a_tile_as_large_as_the_exemplar() {
        let (shown, upright) = (Vector::xy(130.0, 90.0), Matrix::identity());
        let places = Repeat { explains: Explains::Places, ..bricks() };
        assert_eq!(places.seamless_tile(shown, &upright, 1.0), Some([120.0, 96.0]));
        let by_hand = Repeat { jitter: 0.5, ..bricks() };
        assert_eq!(by_hand.seamless_tile(shown, &upright, 2.0), Some([240.0, 192.0]));
    }
}
