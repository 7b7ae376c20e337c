//! Values on a regular grid.

use crate::space::{Bounds, Vector, cell_place};

/// Values on the nodes of a regular grid, first coordinate fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid<const D: usize, T> {
    /// The box whose corners are the outermost nodes.
    pub bounds: Bounds<D>,
    /// Nodes along each coordinate, each at least 1.
    pub nodes: [usize; D],
    /// One value a node: `values.len()` is the product of `nodes`.
    pub values: Vec<T>,
}

impl<const D: usize, T: Copy> Grid<D, T> {
    /// Calls `visit(weight, value)` for the corners of the cell around `p`, which is first moved into the box. The weights sum to 1.
    pub fn interpolate(&self, p: Vector<D>, mut visit: impl FnMut(f64, T)) {
        let size = self.bounds.size();
        let mut low = [0; D];
        let mut part = [0.0; D];
        for k in 0..D {
            let cells = self.nodes[k] - 1;
            let u = ((p[k] - self.bounds.min[k]) / size[k].max(f64::MIN_POSITIVE)).clamp(0.0, 1.0) * cells as f64;
            low[k] = (u as usize).min(cells.saturating_sub(1));
            part[k] = if cells == 0 { 0.0 } else { u - low[k] as f64 };
        }
        for corner in 0..1_usize << D {
            let (mut weight, mut index, mut stride) = (1.0, 0, 1);
            for k in 0..D {
                let upper = (corner >> k) & 1;
                weight *= if upper == 1 { part[k] } else { 1.0 - part[k] };
                index += (low[k] + upper).min(self.nodes[k] - 1) * stride;
                stride *= self.nodes[k];
            }
            if weight > 0.0 {
                visit(weight, self.values[index]);
            }
        }
    }

    /// Position of node `index`.
    pub fn node(&self, index: usize) -> Vector<D> {
        let (place, size) = (cell_place(index, &self.nodes), self.bounds.size());
        Vector(std::array::from_fn(|k| {
            let cells = (self.nodes[k] - 1).max(1) as f64;
            self.bounds.min[k] + size[k] * place[k] as f64 / cells
        }))
    }
}
