//! Loose pieces of a texture: pebbles, petals. What hangs together and is smaller than a patch is laid whole or not at all, so that no seam cuts it.

use arabesque_core::{Bounds, Budget, DisjointSets, Result, Vector};
use arabesque_surface::OrientedPoints;

/// Points so many spacings apart hang together, where they face alike.
const LINK: f64 = 2.2;
/// Cosines of the angles between normals from which on points beside one another are of two pieces: in a valley, and elsewhere.
const VALLEY: f64 = 0.5;
const RIDGE: f64 = 0.2;
/// Largest piece, as a share of a patch.
const LARGEST: f64 = 0.6;
/// Share of the points that lie in pieces of a loose texture.
const MOST: f64 = 0.7;

/// How deep what is within a piece lies below its surface, and how far away that is looked for, in spacings.
const DEEP: f64 = 0.4;
const NEAR: f64 = 4.0;
/// Share of a piece that may lie within others in any case, and how much more than in the texture.
const PASSING: f64 = 0.02;
const MORE: f64 = 1.3;

/// Whether a place lies below the surface of those points that count.
pub(crate) fn is_within(points: &OrientedPoints, at: Vector<3>, spacing: f64, counts: impl Fn(usize) -> bool) -> bool {
    let near = points.nearest(at, NEAR * spacing, counts);
    near.is_some_and(|(j, _)| (at - points.positions()[j]).dot(points.normals()[j]) < -DEEP * spacing)
}

/// The loose pieces of a texture, numbered from 1.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pieces {
    /// For each point the piece that it belongs to; 0 for what hangs together with the rest. Empty where the texture is not loose.
    pub(crate) of: Vec<u32>,
    /// The points of each piece, with the middle of its box.
    pub(crate) members: Vec<Piece>,
    /// Half the size of the largest.
    pub(crate) reach: f64,
    /// Share of a piece that may lie within others.
    pub(crate) passing: f64,
}

/// A loose piece.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub(crate) points: Vec<u32>,
    pub(crate) middle: [f64; 2],
    /// Whether it reaches the border of the texture, where a part of it may be missing.
    pub(crate) is_cut: bool,
}

impl Pieces {
    /// Looks for pieces; there are none where most of the texture hangs together.
    pub(crate) fn find(points: &OrientedPoints, spacing: f64, patch: f64, budget: &Budget) -> Result<Self> {
        let (positions, normals) = (points.positions(), points.normals());
        let mut sets = DisjointSets::new(positions.len());
        let mut meter = budget.meter();
        for i in 0..positions.len() {
            meter.spend(900)?;
            points.around(positions[i], LINK * spacing, |j, _| {
                let turn = normals[j].dot(normals[i]);
                // Two pieces that touch meet in a valley: their normals lean to one another.
                let leans = (normals[j] - normals[i]).dot(positions[j] - positions[i]) < 0.0;
                if j > i && turn > if leans { VALLEY } else { RIDGE } {
                    sets.join(i, j);
                }
            });
        }
        let all = Bounds::around(positions.iter().copied());
        let (mut found, mut loose) = (Self { of: vec![0; positions.len()], ..Self::default() }, 0);
        for group in sets.groups() {
            let bounds = Bounds::around(group.iter().map(|&i| positions[i]));
            let size = bounds.size()[0].max(bounds.size()[1]);
            if size > LARGEST * patch {
                continue;
            }
            loose += group.len();
            let near = |k: usize| bounds.min[k] < all.min[k] + spacing || bounds.max[k] > all.max[k] - spacing;
            let middle = bounds.centre();
            let number = found.members.len() as u32 + 1;
            group.iter().for_each(|&i| found.of[i] = number);
            found.reach = found.reach.max(0.5 * size);
            let is_cut = near(0) || near(1) || group.len() < 8;
            let points = group.iter().map(|&i| i as u32).collect();
            found.members.push(Piece { points, middle: [middle[0], middle[1]], is_cut });
        }
        if (loose as f64) < MOST * positions.len() as f64 {
            return Ok(Self::default());
        }
        found.passing = PASSING.max(MORE * found.most_within(points, spacing, budget)?);
        Ok(found)
    }

    /// The share of a piece that lies within others in the texture, at most.
    fn most_within(&self, points: &OrientedPoints, spacing: f64, budget: &Budget) -> Result<f64> {
        let mut meter = budget.meter();
        let mut most = 0.0_f64;
        for (k, piece) in self.members.iter().enumerate().filter(|(_, piece)| !piece.is_cut) {
            meter.spend(piece.points.len() as u64 * 800)?;
            let is_other = |j: usize| self.of[j] != 0 && self.of[j] != k as u32 + 1;
            let within = |i: &&u32| is_within(points, points.positions()[**i as usize], spacing, is_other);
            most = most.max(piece.points.iter().filter(within).count() as f64 / piece.points.len() as f64);
        }
        Ok(most)
    }

    /// Whether the texture is loose.
    pub(crate) fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// The piece of a point, and where the point lies from the middle of it.
    pub(crate) fn piece(&self, i: usize, at: Vector<3>) -> (u32, [f32; 2]) {
        match self.of.get(i) {
            None | Some(0) => (0, [0.0; 2]),
            Some(&number) => {
                let middle = self.members[number as usize - 1].middle;
                (number, [0, 1].map(|k| (at[k] - middle[k]) as f32))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Balls of radius 1 at these places, and one sheet below all.
    fn balls(places: &[[f64; 2]], has_ground: bool) -> OrientedPoints {
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        for [x, y] in places {
            for k in 0..200 {
                let z = 1.0 - (2.0 * f64::from(k) + 1.0) / 200.0;
                let (angle, r) = (2.4 * f64::from(k), (1.0 - z * z).sqrt());
                let n = Vector([r * angle.cos(), r * angle.sin(), z]);
                positions.push(n + Vector([*x, *y, 1.2]));
                normals.push(n);
            }
        }
        if has_ground {
            for k in 0..6400 {
                positions.push(Vector([0.25 * f64::from(k % 80) - 2.0, 0.25 * f64::from(k / 80) - 2.0, -0.2]));
                normals.push(Vector([0.0, 0.0, 1.0]));
            }
        }
        OrientedPoints::new(positions, normals, 0.6, &Budget::default()).unwrap()
    }

    #[test]
    fn what_hangs_together_and_is_small_is_a_piece() {
        let places = [[0.0, 0.0], [4.0, 0.0], [2.01, 2.0], [0.0, 4.0], [4.0, 4.0]];
        let found = Pieces::find(&balls(&places, false), 0.25, 5.0, &Budget::default()).unwrap();
        assert_eq!(found.members.len(), 5);
        let middle = found.members.iter().find(|p| !p.is_cut).unwrap();
        assert!((middle.middle[0] - 2.01).abs() < 0.1, "{:?}", middle.middle);
        assert!(found.members.iter().filter(|p| p.is_cut).count() == 4 && (found.reach - 1.0).abs() < 0.1);
    }

    #[test]
    fn pieces_may_pass_through_one_another_as_they_do_in_the_texture() {
        let grid = |step: f64| -> Vec<[f64; 2]> {
            (0..16).map(|k| [step * f64::from(k % 4), step * f64::from(k / 4)]).collect()
        };
        let passing =
            |step: f64| Pieces::find(&balls(&grid(step), false), 0.25, 5.0, &Budget::default()).unwrap().passing;
        assert_eq!(passing(2.4), PASSING);
        assert!((0.03..0.4).contains(&passing(1.8)), "{}", passing(1.8));
    }

    #[test]
    fn what_lies_on_a_ground_or_is_large_is_no_piece() {
        let places = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]];
        assert!(Pieces::find(&balls(&places, true), 0.25, 5.0, &Budget::default()).unwrap().is_empty());
        assert!(Pieces::find(&balls(&places, false), 0.25, 2.0, &Budget::default()).unwrap().is_empty());
    }
}
