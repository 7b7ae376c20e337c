//! Where the nodes of a lattice lie on a surface.

use arabesque_core::{Budget, Domain, GridIndex, Result, Vector};

use super::{laid::SurfaceLattice, links::Axes};
use crate::mesh::{Closest, MeshIndex};

/// Points tell of a node that is nearer than so many spacings.
const NEAR: f64 = 1.5;
/// Points mean one node when it is off by less than this share of the shorter vector.
const ONE: f64 = 0.25;
/// A node lies beyond the edge of an open mesh when it is off the mesh by this share of the shorter vector, and by this share of its height:
/// normals that are smooth lean on coarse triangles.
const BEYOND: (f64, f64) = (0.04, 0.3);

/// A node of a lattice on a surface.
#[derive(Clone, Copy, Debug)]
pub struct LatticePlace {
    /// The point of the mesh below it.
    pub at: Closest,
    /// How many points tell of it, near ones more.
    pub support: f64,
}

impl SurfaceLattice {
    /// Where the places of the pattern lie that differ from `offset` by a vector of the lattice; nothing beyond the edge of an open mesh.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    pub fn places(&self, index: &MeshIndex, offset: Vector<2>, budget: &Budget) -> Result<Vec<LatticePlace>> {
        let near = NEAR * self.spacing;
        let to_node: Vec<_> = self.phases.iter().map(|phase| self.cell.folded(offset - *phase)).collect();
        let tells = |i: usize| to_node[i].norm() < near;
        let mut groups = Groups::new(self.points.len());
        let mut meter = budget.meter();
        for i in (0..self.points.len()).filter(|&i| tells(i)) {
            meter.spend(10 + 6 * self.links[i].len() as u64)?;
            for link in self.links[i].iter().filter(|link| tells(link.to as usize)) {
                let j = link.to as usize;
                if (to_node[i] - link.way - to_node[j]).norm() < ONE * self.cell.shorter {
                    groups.join(i, j);
                }
            }
        }
        let mut sums = vec![(Vector::<3>::ZERO, 0.0); self.points.len()];
        for i in (0..self.points.len()).filter(|&i| tells(i)) {
            let share = 1.0 - (to_node[i].norm() / near).powi(2);
            let weight = share * share;
            let sum = &mut sums[groups.first(i)];
            sum.0 += (self.points[i] + on(self.axes[i], to_node[i])) * weight;
            sum.1 += weight;
        }
        let mut found = Vec::new();
        for (sum, weight) in sums.into_iter().filter(|(_, weight)| *weight > 0.0) {
            meter.spend(3000)?;
            let wanted = sum * (1.0 / weight);
            let at = index.closest(wanted);
            let away = wanted - at.point;
            let beside = away - at.normal * away.dot(at.normal);
            if beside.norm() <= BEYOND.0 * self.cell.shorter + BEYOND.1 * self.height.abs() {
                found.push(LatticePlace { at, support: weight });
            }
        }
        Ok(self.apart(found))
    }

    /// The places that are told best, where several lie closer than a lattice has them.
    fn apart(&self, mut found: Vec<LatticePlace>) -> Vec<LatticePlace> {
        let points: Vec<_> = found.iter().map(|place| place.at.point).collect();
        let reach = 2.0 * ONE * self.cell.shorter;
        let bounds = arabesque_core::Bounds::around(points.iter().copied());
        let near = GridIndex::new(&points, reach, &Domain::Box(bounds.grown(reach)));
        let mut order: Vec<usize> = (0..found.len()).collect();
        order.sort_by(|&a, &b| found[b].support.total_cmp(&found[a].support).then(a.cmp(&b)));
        let mut is_out = vec![false; found.len()];
        for i in order {
            if !is_out[i] {
                near.within(points[i], reach, |j, _| {
                    is_out[j] |= j != i && found[i].at.normal.dot(found[j].at.normal) > 0.0;
                });
            }
        }
        let mut number = 0..;
        found.retain(|_| number.next().is_some_and(|n: usize| !is_out[n]));
        found
    }
}

/// A vector of the pattern in space.
fn on(axes: Axes, v: Vector<2>) -> Vector<3> {
    axes[0] * v[0] + axes[1] * v[1]
}

/// Groups of numbers, each known by its first.
struct Groups(Vec<u32>);

impl Groups {
    fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    fn first(&mut self, mut i: usize) -> usize {
        while self.0[i] as usize != i {
            self.0[i] = self.0[self.0[i] as usize];
            i = self.0[i] as usize;
        }
        i
    }

    fn join(&mut self, i: usize, j: usize) {
        let (a, b) = (self.first(i), self.first(j));
        self.0[a.max(b)] = a.min(b) as u32;
    }
}
