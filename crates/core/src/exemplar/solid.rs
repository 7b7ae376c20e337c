//! Elements with a volume.

use crate::{
    field::Grid,
    space::{Bounds, Vector},
};

/// A solid thing, in coordinates of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid<const D: usize> {
    /// Distance to its surface, positive inside, on a grid that reaches beyond it.
    pub distance: Grid<D, f64>,
    /// The box around it.
    pub bounds: Bounds<D>,
    /// Places spread over its surface.
    pub points: Vec<Vector<D>>,
    /// Centre of its volume.
    pub centre: Vector<D>,
    /// Distance of its farthest place from its centre, and radius of the largest ball in it.
    radii: [f64; 2],
}

impl<const D: usize> Solid<D> {
    /// A solid with these distances, positive inside; `bounds` is the box around it, `points` are spread over its surface.
    pub fn new(distance: Grid<D, f64>, bounds: Bounds<D>, points: Vec<Vector<D>>, centre: Vector<D>) -> Self {
        let reach = points.iter().map(|p| (*p - centre).norm()).fold(0.0, f64::max);
        let inner = distance.values.iter().copied().fold(0.0, f64::max);
        Self { distance, bounds, points, centre, radii: [reach, inner] }
    }

    /// How deep `p` lies in it: negative outside, where it is about the distance; minus infinity beyond the grid.
    pub fn depth(&self, p: Vector<D>) -> f64 {
        if !self.distance.bounds.contains(p) {
            return f64::NEG_INFINITY;
        }
        self.between(p)
    }

    /// The distance at a place, between the nodes of the grid.
    fn between(&self, p: Vector<D>) -> f64 {
        let grid = &self.distance;
        let (mut index, mut stride) = (0, 1);
        let (mut part, mut strides) = ([0.0; D], [0; D]);
        for k in 0..D {
            let cells = grid.nodes[k] - 1;
            let side = (grid.bounds.max[k] - grid.bounds.min[k]).max(f64::MIN_POSITIVE);
            let u = ((p[k] - grid.bounds.min[k]) / side * cells as f64).clamp(0.0, cells as f64);
            let low = (u as usize).min(cells.saturating_sub(1));
            (part[k], strides[k]) = (u - low as f64, if cells == 0 { 0 } else { stride });
            index += low * stride;
            stride *= grid.nodes[k];
        }
        let mut sum = 0.0;
        for corner in 0..1_usize << D {
            let (mut weight, mut at) = (1.0, index);
            for k in 0..D {
                let is_upper = (corner >> k) & 1 == 1;
                weight *= if is_upper { part[k] } else { 1.0 - part[k] };
                at += if is_upper { strides[k] } else { 0 };
            }
            sum += weight * grid.values[at];
        }
        sum
    }

    /// The way out at `p`, of length 1; zero where there is none.
    pub fn outwards(&self, p: Vector<D>) -> Vector<D> {
        let size = self.distance.bounds.size();
        let mut way = Vector::ZERO;
        for k in 0..D {
            let step = 0.5 * size[k] / (self.distance.nodes[k].max(2) - 1) as f64;
            let at = |sign: f64| {
                let mut q = p;
                q[k] += sign * step;
                self.between(q)
            };
            way[k] = (at(-1.0) - at(1.0)) / (2.0 * step);
        }
        way.unit_or_zero()
    }

    /// Distance of its farthest place from its centre.
    pub fn radius(&self) -> f64 {
        self.radii[0]
    }

    /// Radius of the largest ball in it.
    pub fn inradius(&self) -> f64 {
        self.radii[1]
    }
}
