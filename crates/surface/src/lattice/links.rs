//! Neighbours on a surface, and the way from one to the other.

use arabesque_core::{Budget, Domain, GridIndex, Result, Vector};

/// Neighbours lie within so many spacings; normals that differ by more than this cosine are of another side.
pub(super) const REACH: f64 = 2.0;
const SAME_SIDE: f64 = 0.3;

/// Axes that differ by more than this cosine meet in a seam.
const SAME_WAY: f64 = 0.5;

/// A link along which axes turn by this angle in their plane, in radians, is half as trusted.
const TURNED: f64 = 0.1;

/// The two axes of a pattern at a point of a surface, of length 1.
pub type Axes = [Vector<3>; 2];

/// Ways along which phases are compared.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) to: u32,
    /// From the one to the other, in the axes of the pattern.
    pub(super) way: Vector<2>,
    /// How far it can be trusted, from 0 to 1: around a pole, where axes turn quickly, ways mean little.
    pub(super) trust: f64,
}

/// The neighbours of each point.
pub(super) fn links(
    (points, normals, axes): (&[Vector<3>], &[Vector<3>], &[Axes]),
    reach: f64,
    budget: &Budget,
) -> Result<Vec<Vec<Link>>> {
    let bounds = arabesque_core::Bounds::around(points.iter().copied());
    let near = GridIndex::new(points, reach, &Domain::Box(bounds.grown(reach)));
    let mut meter = budget.meter();
    let mut all = Vec::with_capacity(points.len());
    for (i, &p) in points.iter().enumerate() {
        let mut own = Vec::new();
        let looked = near.within(p, reach, |j, _| {
            let same = axes[i][0].dot(axes[j][0]) > SAME_WAY && axes[i][1].dot(axes[j][1]) > SAME_WAY;
            if j != i && same && normals[i].dot(normals[j]) > SAME_SIDE {
                let (to, way) = (j as u32, way((p, axes[i]), (points[j], axes[j])));
                own.push(Link { to, way, trust: 1.0 / (1.0 + (turn(axes[i], axes[j]) / TURNED).powi(2)) });
            }
        });
        meter.spend(100 + 10 * looked)?;
        own.sort_by_key(|link| link.to);
        all.push(own);
    }
    Ok(all)
}

/// By how much axes turn in their plane from one place to another; bending of the surface does not count.
fn turn(own: Axes, its: Axes) -> f64 {
    0.5 * (own[0].dot(its[1]) - own[1].dot(its[0])).abs()
}

/// From one point to another in the axes of the pattern, as long as it is in space.
pub(super) fn way((p, own): (Vector<3>, Axes), (q, its): (Vector<3>, Axes)) -> Vector<2> {
    let apart = q - p;
    let seen = Vector([0, 1].map(|k| 0.5 * (apart.dot(own[k]) + apart.dot(its[k]))));
    seen.unit_or_zero() * apart.norm()
}
