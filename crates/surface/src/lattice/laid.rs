//! Laying a lattice on a surface.

use arabesque_core::{Budget, Result, Vector};

use super::{
    cell::Cell,
    links::{Axes, Link, REACH, links},
    phases::phases,
};
use crate::{
    mesh::{Closest, MeshIndex},
    spread::scatter,
};

/// Points lie apart by this share of the shorter vector.
const SPACING: f64 = 0.3;

/// Phases that are off by this share of a cell break the lattice.
const BROKEN: f64 = 0.3;

/// A lattice on a surface.
#[derive(Debug)]
pub struct SurfaceLattice {
    pub(super) points: Vec<Vector<3>>,
    pub(super) axes: Vec<Axes>,
    pub(super) links: Vec<Vec<Link>>,
    /// The place of the pattern that lies on each point.
    pub(super) phases: Vec<Vector<2>>,
    pub(super) cell: Cell,
    pub(super) spacing: f64,
    pub(super) height: f64,
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
        lattice: ([Vector<2>; 2], Option<Vector<2>>),
        height: f64,
        (seed, budget): (u64, &Budget),
    ) -> Result<Self> {
        Self::laid(index, axes, lattice, height, (seed, false, budget))
    }

    /// How much a lattice breaks that is laid so: see [`SurfaceLattice::broken`]. It takes a tenth of laying it.
    ///
    /// # Errors
    /// As [`SurfaceLattice::new`].
    pub fn tried(
        index: &MeshIndex,
        axes: &dyn Fn(&Closest) -> Axes,
        lattice: ([Vector<2>; 2], Option<Vector<2>>),
        height: f64,
        budget: &Budget,
    ) -> Result<f64> {
        Ok(Self::laid(index, axes, lattice, height, (0, true, budget))?.broken())
    }

    fn laid(
        index: &MeshIndex,
        axes: &dyn Fn(&Closest) -> Axes,
        (vectors, rows): ([Vector<2>; 2], Option<Vector<2>>),
        height: f64,
        (seed, is_trial, budget): (u64, bool, &Budget),
    ) -> Result<Self> {
        let cell = Cell::new(vectors, rows)?;
        let spacing = SPACING * cell.shorter;
        let found = scatter(index, spacing, seed, budget)?;
        budget.spend(2000 * found.len() as u64)?;
        let points: Vec<_> = found.iter().map(|at| at.point + at.normal * height).collect();
        let normals: Vec<_> = found.iter().map(|at| at.normal).collect();
        let axes: Vec<_> = found.iter().map(axes).collect();
        let links = links((&points, &normals, &axes), REACH * spacing, budget)?;
        let phases = phases(&links, &cell, (seed, is_trial), budget)?;
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
