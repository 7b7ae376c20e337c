//! How the triangles of a mesh hang together.

use arabesque_core::{Budget, Result, TriangleMesh, Vector};
use rayon::prelude::*;

/// What stands for no triangle.
pub(crate) const NONE: u32 = u32::MAX;

/// A mesh with vertices at equal places made one: files of some kinds give each triangle corners of its own, others split vertices where
/// colours or textures change, and neither is a border of the surface.
#[derive(Clone, Debug)]
pub(crate) struct Topology {
    /// Places of the vertices.
    pub(crate) points: Vec<Vector<3>>,
    /// For each vertex of the mesh as given its number here.
    pub(crate) welded: Vec<u32>,
    /// The corners of each triangle.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// For edge `k` of each triangle, from corner `k` to the next one, the triangle beyond it: [`NONE`] at a border, and where more than two meet.
    pub(crate) across: Vec<[u32; 3]>,
}

/// The triangles along one edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    /// Its vertices, the smaller number first.
    pub(crate) ends: (u32, u32),
    /// Triangle times 3, plus which of its edges.
    pub(crate) at: u32,
    /// Whether the triangle goes from the smaller number to the larger.
    pub(crate) is_forward: bool,
}

impl Topology {
    /// The topology of a mesh that was checked.
    pub(crate) fn new(mesh: &TriangleMesh, budget: &Budget) -> Result<Self> {
        budget.spend(mesh.triangles.len() as u64 * 300 + mesh.positions.len() as u64 * 200)?;
        let (points, welded) = weld(&mesh.positions);
        let triangles: Vec<_> = mesh.triangles.par_iter().map(|t| t.map(|v| welded[v as usize])).collect();
        let mut topology = Self { points, welded, across: vec![[NONE; 3]; triangles.len()], triangles };
        let sides = topology.sides();
        for pair in sides.chunk_by(|a, b| a.ends == b.ends) {
            if let [a, b] = pair {
                topology.across[a.at as usize / 3][a.at as usize % 3] = b.at / 3;
                topology.across[b.at as usize / 3][b.at as usize % 3] = a.at / 3;
            }
        }
        Ok(topology)
    }

    /// The sides of all triangles, those along one edge next to one another. A triangle with two corners in one place has none.
    pub(crate) fn sides(&self) -> Vec<Side> {
        let of = |(t, corners): (usize, &[u32; 3])| {
            let [a, b, c] = *corners;
            let is_whole = a != b && b != c && c != a;
            let side = |k: usize, from: u32, to: u32| Side {
                ends: (from.min(to), from.max(to)),
                at: (3 * t + k) as u32,
                is_forward: from < to,
            };
            if is_whole { vec![side(0, a, b), side(1, b, c), side(2, c, a)] } else { Vec::new() }
        };
        let mut sides: Vec<Side> = self.triangles.iter().enumerate().flat_map(of).collect();
        sides.par_sort_unstable_by_key(|side| (side.ends, side.at));
        sides
    }

    /// The corners of a triangle.
    pub(crate) fn corners(&self, triangle: u32) -> [Vector<3>; 3] {
        self.triangles[triangle as usize].map(|v| self.points[v as usize])
    }

    /// Area of the triangle times two, along its normal.
    pub(crate) fn double_area(&self, triangle: u32) -> Vector<3> {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }
}

/// Vertices at equal places made one: the places, and for each vertex the number of its own. Places keep the order in which they come first.
fn weld(positions: &[Vector<3>]) -> (Vec<Vector<3>>, Vec<u32>) {
    // Adding zero makes one of the two zeros.
    let key = |v: u32| positions[v as usize].0.map(|c| (c + 0.0).to_bits());
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.par_sort_unstable_by_key(|&v| (key(v), v));
    let mut first = vec![0_u32; positions.len()];
    for same in order.chunk_by(|&a, &b| key(a) == key(b)) {
        same.iter().for_each(|&v| first[v as usize] = same[0]);
    }
    let (mut points, mut welded) = (Vec::with_capacity(positions.len()), vec![0_u32; positions.len()]);
    for v in 0..positions.len() {
        let own = first[v] as usize;
        if own == v {
            welded[v] = points.len() as u32;
            points.push(positions[v]);
        } else {
            // The first one has a smaller number and is there already.
            welded[v] = welded[own];
        }
    }
    (points, welded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_soup_of_triangles_becomes_one_surface() {
        let at = |x: f64, y: f64| Vector([x, y, 0.0]);
        let positions = vec![at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 0.0), at(1.0, 1.0), at(-0.0, 1.0)];
        let mesh = TriangleMesh { positions, triangles: vec![[0, 1, 2], [3, 4, 5]], ..TriangleMesh::default() };
        let topology = Topology::new(&mesh, &Budget::default()).unwrap();
        assert_eq!((topology.points.len(), topology.welded.clone()), (4, vec![0, 1, 2, 1, 3, 2]));
        assert_eq!(topology.across, [[NONE, 1, NONE], [NONE, NONE, 0]]);
    }

    #[test]
    fn where_three_triangles_meet_none_is_beyond() {
        let positions = (0..5).map(|k| Vector([f64::from(k), f64::from(k * k), f64::from(k % 2)])).collect();
        let triangles = vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]];
        let mesh = TriangleMesh { positions, triangles, ..TriangleMesh::default() };
        let topology = Topology::new(&mesh, &Budget::default()).unwrap();
        assert!(topology.across.iter().flatten().all(|&t| t == NONE));
        assert_eq!(topology.sides().len(), 9);
    }
}
