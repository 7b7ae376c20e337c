//! The inside of a closed mesh.

use arabesque_core::{Bounds, Budget, Grid, Region, Result, Vector};
use arabesque_surface::{MeshIndex, MeshReport};

/// Nodes of the grid of distances along the longest side of a mesh.
const NODES: f64 = 48.0;
/// Nearer to the surface than so many cells the distance is worked out exactly.
const EXACT: f64 = 1.0;

/// The inside of a closed mesh.
#[derive(Debug)]
pub(super) struct Inside {
    index: MeshIndex,
    volume: f64,
    /// 1 where normals lead out, -1 where they lead in; `None` where they do not tell.
    sense: Option<f64>,
    /// Distances on a grid, positive inside.
    distances: Grid<3, f64>,
    cell: f64,
}

impl Inside {
    /// How many questions are asked of a mesh in a box.
    pub(super) fn questions(around: &Bounds<3>) -> f64 {
        grid(around).1.values.len() as f64
    }

    pub(super) fn new(index: MeshIndex, report: &MeshReport, budget: &Budget) -> Result<Self> {
        let (cell, mut distances) = grid(&index.bounds());
        let places: Vec<_> = (0..distances.values.len()).map(|n| distances.node(n)).collect();
        let is_sound = report.is_closed() && report.crossings_counted && !report.crossings.any();
        let sense = is_sound.then_some(if report.is_inverted() { -1.0 } else { 1.0 });
        distances.values = match sense {
            Some(sense) => {
                let closest = index.closest_all(&places, budget)?;
                closest.iter().zip(&places).map(|(closest, &p)| -sense * index.height(closest, p)).collect()
            }
            None => index.signed_distances(&places, budget)?,
        };
        Ok(Self { index, volume: report.volume.abs(), sense, distances, cell })
    }
}

/// A grid around a box, and the side of its cells.
fn grid(around: &Bounds<3>) -> (f64, Grid<3, f64>) {
    let cell = around.size().0.into_iter().fold(0.0, f64::max) / NODES;
    let bounds = around.grown(2.0 * cell);
    let nodes = bounds.size().0.map(|side| (side / cell).ceil() as usize + 1);
    (cell, Grid { bounds, nodes, values: vec![0.0; nodes.iter().product()] })
}

impl Region<3> for Inside {
    fn bounds(&self) -> Bounds<3> {
        self.index.bounds()
    }

    fn measure(&self) -> f64 {
        self.volume
    }

    fn signed_distance(&self, p: Vector<3>) -> f64 {
        if self.distances.bounds.contains(p) {
            let mut distance = 0.0;
            self.distances.interpolate(p, |weight, value| distance += weight * value);
            if distance.abs() > EXACT * self.cell {
                return distance;
            }
        }
        match self.sense {
            Some(sense) => -sense * self.index.height(&self.index.closest(p), p),
            None => self.index.signed_distance(p),
        }
    }

    fn nearest_boundary(&self, p: Vector<3>) -> Vector<3> {
        self.index.closest(p).point
    }
}
