//! A direction at every point of a surface.

use std::collections::BinaryHeap;

use arabesque_core::{Budget, Matrix, Result, Vector, Warning};

use super::{
    sources::Directions,
    transport::{Complex, Planes, axes},
};
use crate::mesh::{Closest, MeshIndex};

/// A frame on a surface: axes of length 1 across one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceFrame {
    /// Along the surface, where the field leads.
    pub tangent: Vector<3>,
    /// Outwards.
    pub normal: Vector<3>,
}

impl SurfaceFrame {
    /// The axis along the surface across the tangent: tangent, bitangent and normal make a right-handed frame.
    pub fn bitangent(&self) -> Vector<3> {
        self.normal.cross(self.tangent)
    }

    /// The rotation that turns x into the tangent, y into the bitangent and z into the normal.
    pub fn rotation(&self) -> Matrix<3> {
        let (t, b, n) = (self.tangent, self.bitangent(), self.normal);
        Matrix(std::array::from_fn(|r| [t[r], b[r], n[r]]))
    }
}

/// Directions at all points of a mesh, smooth but for the few places where no field can be: there, too, is some direction.
#[derive(Debug)]
pub struct DirectionField {
    /// A direction at each vertex of the index, of length 1.
    directions: Vec<Vector<3>>,
    /// How well the direction is determined, from 0 where the field vanishes.
    strengths: Vec<f64>,
    /// Whether opposite directions are the same; then corners of a triangle may disagree.
    are_lines: bool,
    warnings: Vec<Warning>,
}

impl DirectionField {
    /// The directions on the mesh of `index`.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Parameter`] for a direction of no length or no strokes, [`arabesque_core::Error::Input`] for a stroke that is none; as [`Budget::spend`].
    pub fn new(index: &MeshIndex, directions: &Directions, budget: &Budget) -> Result<Self> {
        let planes = Planes::new(index, budget)?;
        let source = directions.source(index, &planes, budget)?;
        let numbers = planes.smoothest(&source.known, source.symmetry, budget)?;
        let one = |(v, number): (usize, &Complex)| {
            let length = number[0].hypot(number[1]);
            if length > 1e-12 { planes.direction(v, *number, source.symmetry) } else { planes.axes[v][0] }
        };
        let mut field = Self {
            directions: numbers.iter().enumerate().map(one).collect(),
            strengths: numbers.iter().map(|n| n[0].hypot(n[1])).collect(),
            are_lines: source.symmetry == 2,
            warnings: source.warnings,
        };
        if field.are_lines {
            field.comb(index, &planes, budget)?;
        }
        Ok(field)
    }

    /// The field of the mesh `from`, on another mesh near it: as it is at the nearest places.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    pub fn carried_over(&self, from: &MeshIndex, to: &MeshIndex, budget: &Budget) -> Result<Self> {
        let points = &to.topology.points;
        let found = from.closest_all(points, budget)?;
        let corners = |c: &Closest| from.topology.triangles[c.triangle].map(|v| self.strengths[v as usize]);
        let strength = |c: &Closest| corners(c).iter().zip(c.barycentric).map(|(s, w)| s * w).sum();
        let direction = |(c, &normal): (&Closest, &Vector<3>)| {
            let there = self.frame(from, c).tangent;
            super::transport::carried(there, c.normal, normal)
        };
        Ok(Self {
            directions: found.iter().zip(&to.normals).map(direction).collect(),
            strengths: found.iter().map(strength).collect(),
            are_lines: self.are_lines,
            warnings: self.warnings.clone(),
        })
    }

    /// What the user should know.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// The frame at a point of the mesh.
    pub fn frame(&self, index: &MeshIndex, at: &Closest) -> SurfaceFrame {
        let corners = index.topology.triangles[at.triangle].map(|v| v as usize);
        let nearest = (0..3).fold(0, |best, k| if at.barycentric[k] > at.barycentric[best] { k } else { best });
        let main = self.directions[corners[nearest]];
        let sum = (0..3).fold(Vector::ZERO, |sum, k| {
            let own = self.directions[corners[k]];
            let sign = if self.are_lines && own.dot(main) < 0.0 { -1.0 } else { 1.0 };
            sum + own * (sign * at.barycentric[k])
        });
        let flat = |v: Vector<3>| (v - at.normal * at.normal.dot(v)).unit_if_longer(1e-6);
        let tangent = flat(sum).or_else(|| flat(main)).unwrap_or_else(|| axes(at.normal)[0]);
        SurfaceFrame { tangent, normal: at.normal }
    }

    /// Lines get a sense that neighbours share, spreading from where they are strongest; where lines turn by half a turn around a
    /// place, a seam is left at which they are opposite.
    fn comb(&mut self, index: &MeshIndex, planes: &Planes, budget: &Budget) -> Result<()> {
        let count = self.directions.len();
        let mut is_set = vec![false; count];
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&a, &b| self.strengths[b].total_cmp(&self.strengths[a]).then(a.cmp(&b)));
        let size = index.bounds().size();
        let mut by_size = [0, 1, 2];
        by_size.sort_by(|&a, &b| size[b].total_cmp(&size[a]));
        let mut meter = budget.meter();
        for start in order {
            if is_set[start] {
                continue;
            }
            // The first one runs towards larger coordinates, along the longest side of the box if it runs there at all.
            let first = self.directions[start];
            let along = by_size.iter().map(|&axis| first[axis]).find(|c| c.abs() > 0.1).unwrap_or(1.0);
            self.directions[start] = first * along.signum();
            is_set[start] = true;
            let mut heap = BinaryHeap::new();
            let push = |heap: &mut BinaryHeap<_>, strengths: &[f64], is_set: &[bool], from: usize| {
                for to in planes.around(from).filter(|&to| !is_set[to]) {
                    // Strengths are not negative, so that their bits are in their order.
                    heap.push((strengths[to].min(strengths[from]).to_bits(), std::cmp::Reverse(to), from));
                }
            };
            push(&mut heap, &self.strengths, &is_set, start);
            while let Some((_, std::cmp::Reverse(to), from)) = heap.pop() {
                meter.spend(60)?;
                if std::mem::replace(&mut is_set[to], true) {
                    continue;
                }
                let carried =
                    super::transport::carried(self.directions[from], planes.normals[from], planes.normals[to]);
                if carried.dot(self.directions[to]) < 0.0 {
                    self.directions[to] = -self.directions[to];
                }
                push(&mut heap, &self.strengths, &is_set, to);
            }
        }
        Ok(())
    }
}
