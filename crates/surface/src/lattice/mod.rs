//! A lattice of the plane laid on a surface: rows of bricks around a dome.
//!
//! Points are scattered over the surface, each with the two axes of the pattern there. Every point gets the place of the pattern that lies
//! on it, as a phase: a vector up to those of the lattice. Along a link between neighbours the phase should change by the way from
//! one to the other, seen in their axes [Jakob 2015; Knoppel 2015]. Phases spread from one point over the whole surface, and are then
//! evened out. Where the surface bends or the axes turn so that no lattice can follow, it breaks, in as few places as that needs.

mod cell;
mod phases;
mod places;

use arabesque_core::{Budget, Domain, GridIndex, Result, Vector};

use crate::{
    mesh::{Closest, MeshIndex},
    spread::scatter,
};
use cell::Cell;
use phases::phases;
pub use places::LatticePlace;

/// Points lie apart by this share of the shorter vector.
const SPACING: f64 = 0.3;
/// Neighbours lie within so many spacings; normals that differ by more than this cosine are of another side.
const REACH: f64 = 2.0;
const SAME_SIDE: f64 = 0.3;
/// Axes that differ by more than this cosine meet in a seam.
const SAME_WAY: f64 = 0.5;

/// Phases that are off by this share of a cell break the lattice.
const BROKEN: f64 = 0.3;

/// The two axes of a pattern at a point of a surface, of length 1.
pub type Axes = [Vector<3>; 2];

/// Ways along which phases are compared.
#[derive(Clone, Copy, Debug)]
struct Link {
    to: u32,
    /// From the one to the other, in the axes of the pattern.
    way: Vector<2>,
}

/// A lattice on a surface.
#[derive(Debug)]
pub struct SurfaceLattice {
    points: Vec<Vector<3>>,
    axes: Vec<Axes>,
    links: Vec<Vec<Link>>,
    /// The place of the pattern that lies on each point.
    phases: Vec<Vector<2>>,
    cell: Cell,
    spacing: f64,
    height: f64,
}

impl SurfaceLattice {
    /// Lays a lattice of these two vectors on a mesh. `axes` tells how the pattern lies at a point; distances are those at `height`
    /// over the mesh. Where the pattern has rows that can slip along one another, they run along `rows`: then rows stay whole where the mesh
    /// bends, and slip. The seed chooses where the lattice begins.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Parameter`] for vectors that are parallel; as [`scatter`].
    pub fn new(
        index: &MeshIndex,
        axes: &dyn Fn(&Closest) -> Axes,
        (vectors, rows): ([Vector<2>; 2], Option<Vector<2>>),
        height: f64,
        (seed, budget): (u64, &Budget),
    ) -> Result<Self> {
        let cell = Cell::new(vectors, rows)?;
        let spacing = SPACING * cell.shorter;
        let found = scatter(index, spacing, seed, budget)?;
        budget.spend(2000 * found.len() as u64)?;
        let points: Vec<_> = found.iter().map(|at| at.point + at.normal * height).collect();
        let normals: Vec<_> = found.iter().map(|at| at.normal).collect();
        let axes: Vec<_> = found.iter().map(axes).collect();
        let links = links((&points, &normals, &axes), REACH * spacing, budget)?;
        let phases = phases(&links, &cell, seed, budget)?;
        Ok(Self { points, axes, links, phases, cell, spacing, height })
    }

    /// The share of the surface on which the lattice does not go on as it should: 0 on a flat mesh, 1 where nothing fits.
    pub fn broken(&self) -> f64 {
        let usual = self.links.iter().map(Vec::len).max().unwrap_or(0).max(1) as f64;
        let of_point = |(i, own): (usize, &Vec<Link>)| {
            let off = |link: &Link| {
                let way = self.phases[link.to as usize] - link.way - self.phases[i];
                (self.cell.misfit(way, link.way) / BROKEN).min(1.0).powi(2)
            };
            let (sum, count) = own.iter().fold((0.0, 0.0), |(sum, count), link| (sum + off(link), count + 1.0));
            // Where axes turn over there are no links at all.
            (sum + (0.25 * usual - count).max(0.0)) / count.max(0.25 * usual)
        };
        self.links.iter().enumerate().map(of_point).sum::<f64>() / self.links.len().max(1) as f64
    }
}

/// The neighbours of each point.
fn links(
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
                own.push(Link { to: j as u32, way: way((p, axes[i]), (points[j], axes[j])) });
            }
        });
        meter.spend(100 + 10 * looked)?;
        own.sort_by_key(|link| link.to);
        all.push(own);
    }
    Ok(all)
}

/// From one point to another in the axes of the pattern, as long as it is in space.
fn way((p, own): (Vector<3>, Axes), (q, its): (Vector<3>, Axes)) -> Vector<2> {
    let apart = q - p;
    let seen = Vector([0, 1].map(|k| 0.5 * (apart.dot(own[k]) + apart.dot(its[k]))));
    seen.unit_or_zero() * apart.norm()
}
