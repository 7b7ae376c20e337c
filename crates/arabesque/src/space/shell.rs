//! A layer on a mesh.

use std::sync::Arc;

use arabesque_core::{Bounds, Budget, Grid, Ground, Matrix, Region, Result, Rotations, Vector};
use arabesque_surface::{Closest, DirectionField, MeshIndex};

/// Nodes of the grid of distances along the longest side of the box around a layer.
const NODES: f64 = 48.0;

/// A layer on a mesh: what lies between two heights over it.
#[derive(Debug)]
pub(super) struct Shell {
    pub(super) index: Arc<MeshIndex>,
    field: DirectionField,
    /// Radians by which the pattern is turned about the normal.
    turned: f64,
    heights: [f64; 2],
    /// Where elements may reach, where they have to lie in the layer wholly.
    reach: [f64; 2],
    /// The axis of the exemplar that runs along the normal, and what lies on the mesh along it.
    across: usize,
    pub(super) under: f64,
    /// Distances from the mesh on a grid with cells of this size: most places in the box around a layer are far from it.
    far: Option<(Grid<3, f64>, f64)>,
}

/// How the exemplar lies over a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lying {
    /// Degrees by which the pattern is turned about the normal.
    pub(super) turned: f64,
    pub(super) heights: [f64; 2],
    pub(super) reach: [f64; 2],
    pub(super) across: usize,
    pub(super) under: f64,
}

impl Shell {
    pub(super) fn new(index: &Arc<MeshIndex>, field: DirectionField, lying: Lying) -> Self {
        let Lying { turned, heights, reach, across, under } = lying;
        let index = Arc::clone(index);
        Self { index, field, turned: turned.to_radians(), heights, reach, across, under, far: None }
    }

    /// The same, knowing which places are far from the mesh.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(super) fn with_distances(mut self, budget: &Budget) -> Result<Self> {
        let inner = self.bounds();
        let cell = inner.size().0.into_iter().fold(0.0, f64::max) / NODES;
        let bounds = inner.grown(cell);
        let nodes = bounds.size().0.map(|side| (side / cell).ceil() as usize + 1);
        let mut distances = Grid { bounds, nodes, values: vec![0.0; nodes.iter().product()] };
        let places: Vec<_> = (0..distances.values.len()).map(|n| distances.node(n)).collect();
        distances.values = self.index.closest_all(&places, budget)?.into_iter().map(|c| c.distance).collect();
        self.far = Some((distances, cell));
        Ok(self)
    }

    /// How far outside of the layer a place is at least that is far from it.
    fn beyond(&self, p: Vector<3>) -> Option<f64> {
        let (distances, cell) = self.far.as_ref()?;
        if !distances.bounds.contains(p) {
            return None;
        }
        let mut distance = 0.0;
        distances.interpolate(p, |weight, value| distance += weight * value);
        // Distances differ by no more than places do, and a place by less than a cell from the nodes around it, in the mean of them.
        let beyond = distance - cell - self.reach[0].abs().max(self.reach[1].abs());
        (beyond > 0.0).then_some(beyond)
    }

    /// The rotation of the exemplar at a point of the mesh.
    pub(super) fn rotation(&self, at: &Closest) -> Matrix<3> {
        let frame = self.field.frame(&self.index, at);
        let (sin, cos) = self.turned.sin_cos();
        let (first, normal) = (frame.tangent * cos + frame.bitangent() * sin, frame.normal);
        let columns = match self.across {
            0 => [normal, normal.cross(first), -first],
            1 => [first, normal, first.cross(normal)],
            _ => [first, normal.cross(first), normal],
        };
        Matrix(std::array::from_fn(|r| columns.map(|c| c[r])))
    }
}

impl Shell {
    /// The height over the mesh, and the distance to where the layer ends sideways, at the edge of an open mesh.
    fn foot(&self, p: Vector<3>) -> (f64, Closest) {
        let foot = self.index.closest(p);
        (self.index.height(&foot, p), foot)
    }
}

impl Region<3> for Shell {
    fn bounds(&self) -> Bounds<3> {
        self.index.bounds().grown(self.reach[0].abs().max(self.reach[1].abs()))
    }

    fn measure(&self) -> f64 {
        self.index.area() * (self.heights[1] - self.heights[0])
    }

    fn signed_distance(&self, p: Vector<3>) -> f64 {
        if let Some(beyond) = self.beyond(p) {
            return -beyond;
        }
        let (height, foot) = self.foot(p);
        // Beyond the edge of an open mesh the way to the foot leaves the normal.
        let away = p - foot.point;
        let beside = (away.norm2() - height * height).max(0.0).sqrt();
        let within = (height - self.reach[0]).min(self.reach[1] - height);
        if beside > 1e-6 * (1.0 + away.norm()) { within.min(-beside) } else { within }
    }

    fn nearest_boundary(&self, p: Vector<3>) -> Vector<3> {
        let (height, foot) = self.foot(p);
        let [low, high] = self.reach;
        let to = if height - low < high - height { low } else { high };
        foot.point + foot.normal * to
    }
}

impl Ground<3> for Shell {
    fn height(&self, p: Vector<3>) -> f64 {
        Self::foot(self, p).0
    }

    fn at_height(&self, p: Vector<3>, height: f64) -> Vector<3> {
        let foot = self.index.closest(p);
        foot.point + foot.normal * height
    }
}

impl Rotations<3> for Shell {
    fn at(&self, p: Vector<3>) -> Matrix<3> {
        self.rotation(&self.index.closest(p))
    }
}
