//! Sharp edges made round: a shell of some height around a mesh can bend no more sharply than it is high.
//!
//! Beside sharp edges every place of the surface goes to the mean of what is around it, as far as the rounding reaches: flat parts stay, edges
//! are rounded, outer and inner ones alike.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Budget, Result, TriangleMesh, Vector};
use rayon::prelude::*;

use super::{
    index::{MeshIndex, vertex_normals},
    refine::Triangles,
    topology::{NONE, Topology},
};
use crate::{oriented::OrientedPoints, tree::Tree};

/// Cosine of the angle between the normals of two triangles from which their edge is sharp: 40 degrees.
const SHARP: f64 = 0.766;
/// Length of edges beside sharp ones, as a share of the reach.
const FINE: f64 = 0.3;
/// Side of the cells in which triangles count as one, as a share of the reach.
const CELL: f64 = 0.15;
/// How far the mean reaches for a radius of 1: a right angle is rounded by about that radius.
const REACH: f64 = 1.4;
/// Work units of a mass that a mean is made of.
const MASS: u64 = 40;

/// Work units of a place that is asked how far it is from edges.
const PLACE: u64 = 400;

/// The ends of an edge.
type Ends = [Vector<3>; 2];

/// Segments that are asked how far they are.
struct Segments {
    ends: Vec<Ends>,
    tree: Tree,
}

impl Segments {
    fn new(ends: Vec<Ends>, budget: &Budget) -> Result<Option<Self>> {
        if ends.is_empty() {
            return Ok(None);
        }
        let boxes: Vec<_> = ends.iter().map(|ends| Bounds::around(ends.iter().copied())).collect();
        Ok(Some(Self { tree: Tree::new(&boxes, budget)?, ends }))
    }

    /// How far the nearest one is, at most `reach`.
    fn distance(&self, p: Vector<3>, reach: f64) -> f64 {
        let of = |k: u32| {
            let [a, b] = self.ends[k as usize];
            let way = b - a;
            let t = ((p - a).dot(way) / way.norm2().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            Some((a + way * t - p).norm2())
        };
        self.tree.nearest(p, reach * reach, of).0.map_or(reach, |(_, d2)| d2.sqrt())
    }
}

impl MeshIndex {
    /// The mesh with its sharp edges, where triangles meet at more than 40 degrees, rounded by about `radius`; `None` where there are none. What is
    /// farther from sharp edges than three times the radius stays, and so do open borders.
    ///
    /// # Errors
    /// Over the limits of `nodes`, `memory` or `work`, and when somebody asks to stop.
    pub fn with_round_edges(&self, radius: f64, budget: &Budget) -> Result<Option<Self>> {
        let budget = &budget.stage("rounding the edges of a mesh");
        let reach = REACH * radius;
        let (sharp, open) = edges(&self.topology, budget)?;
        let Some(sharp) = Segments::new(sharp, budget)? else { return Ok(None) };
        let open = Segments::new(open, budget)?;
        let mut mesh = Triangles { points: self.topology.points.clone(), corners: self.topology.triangles.clone() };
        let fine = FINE * reach;
        mesh.refine(budget, |a, b| {
            let half = 0.5 * (b - a).norm();
            2.0 * half > fine && sharp.distance((a + b) * 0.5, 3.0 * reach + half) < 3.0 * reach + half
        })?;
        let masses = Masses::new(&mesh, &sharp, reach, budget)?;
        let normals = vertex_normals(&mesh.points, &mesh.corners);
        let share = |p: Vector<3>| {
            let beside = 2.0 - sharp.distance(p, 2.0 * reach) / reach;
            let border = open.as_ref().map_or(1.0, |open| open.distance(p, reach) / reach);
            smooth(beside) * smooth(border)
        };
        let moved = |v: usize| -> Result<Vector<3>> {
            budget.spend(PLACE)?;
            let p = mesh.points[v];
            let share = share(p);
            if share <= 0.0 {
                return Ok(p);
            }
            let mean = masses.mean(p, normals[v], reach, budget)?;
            Ok(mean.map_or(p, |mean| p + (mean - p) * share))
        };
        let positions: Result<Vec<_>> = (0..mesh.points.len()).into_par_iter().map(moved).collect();
        let positions = positions?;
        budget.spend(0)?;
        let round = TriangleMesh { positions, triangles: mesh.corners, ..TriangleMesh::default() };
        Self::new(&round, self.name(), budget).map(Some)
    }
}

/// 0 below 0, 1 above 1, smooth between.
fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// The ends of sharp edges, and of those with a triangle on one side only.
fn edges(topology: &Topology, budget: &Budget) -> Result<(Vec<Ends>, Vec<Ends>)> {
    budget.spend(topology.triangles.len() as u64 * 60)?;
    let (mut sharp, mut open) = (Vec::new(), Vec::new());
    for (t, across) in topology.across.iter().enumerate() {
        let normal = topology.double_area(t as u32).unit_or_zero();
        let corners = topology.corners(t as u32);
        for (k, &other) in across.iter().enumerate() {
            let ends = [corners[k], corners[(k + 1) % 3]];
            let is_flat = |n: Vector<3>| n.norm2() < 0.5;
            if other == NONE {
                open.push(ends);
            } else if (t as u32) < other {
                let beyond = topology.double_area(other).unit_or_zero();
                // Triangles without area have no direction.
                if !is_flat(normal) && !is_flat(beyond) && normal.dot(beyond) < SHARP {
                    sharp.push(ends);
                }
            }
        }
    }
    Ok((sharp, open))
}

/// What is beside sharp edges: triangles that lie together and face one way count as one mass.
struct Masses {
    points: OrientedPoints,
    areas: Vec<f64>,
}

impl Masses {
    fn new(mesh: &Triangles, sharp: &Segments, reach: f64, budget: &Budget) -> Result<Self> {
        let mut cells: BTreeMap<([i64; 3], usize), (Vector<3>, Vector<3>, f64)> = BTreeMap::new();
        let mut meter = budget.meter();
        for corners in &mesh.corners {
            meter.spend(PLACE)?;
            let [a, b, c] = corners.map(|v| mesh.points[v as usize]);
            let (middle, across) = ((a + b + c) * (1.0 / 3.0), (b - a).cross(c - a) * 0.5);
            let area = across.norm();
            if area <= 0.0 || sharp.distance(middle, 3.5 * reach) >= 3.5 * reach {
                continue;
            }
            let key = (middle.0.map(|v| (v / (CELL * reach)).floor() as i64), facing(across));
            let mass = cells.entry(key).or_insert((Vector::ZERO, Vector::ZERO, 0.0));
            *mass = (mass.0 + middle * area, mass.1 + across, mass.2 + area);
        }
        let positions = cells.values().map(|(sum, _, area)| *sum * (1.0 / area)).collect();
        let normals = cells.values().map(|(_, across, _)| across.unit_or_zero()).collect();
        let areas = cells.values().map(|(_, _, area)| *area).collect();
        Ok(Self { points: OrientedPoints::new(positions, normals, reach, budget)?, areas })
    }

    /// The mean of what is around `p` and does not face away from its normal.
    fn mean(&self, p: Vector<3>, normal: Vector<3>, reach: f64, budget: &Budget) -> Result<Option<Vector<3>>> {
        let (mut sum, mut all, mut count) = (Vector::ZERO, 0.0, 0);
        self.points.around(p, reach, |i, d2| {
            count += 1;
            if self.points.normals()[i].dot(normal) > -0.1 {
                let w = (1.0 - d2 / (reach * reach)).max(0.0).powi(2) * self.areas[i];
                sum += self.points.positions()[i] * w;
                all += w;
            }
        });
        budget.spend(count * MASS)?;
        Ok((all > 0.0).then(|| sum * (1.0 / all)))
    }
}

/// Which of the six axes a direction is nearest to.
fn facing(v: Vector<3>) -> usize {
    let axis = (0..3).fold(0, |best, k| if v[k].abs() > v[best].abs() { k } else { best });
    2 * axis + usize::from(v[axis] < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshReport;

    /// A box whose corners are at -1 and 1, but for its depth.
    fn block(depth: f64) -> TriangleMesh {
        let at = |k: u32| Vector([0, 1, 2].map(|i| if k >> i & 1 == 1 { 1.0 } else { -1.0 }));
        let positions = (0..8).map(|k| Vector([at(k)[0], at(k)[1], at(k)[2] * depth])).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        TriangleMesh { positions, triangles, ..TriangleMesh::default() }
    }

    #[test]
    fn a_cube_gets_round_edges_and_keeps_its_faces() {
        let budget = Budget::default();
        let cube = MeshIndex::new(&block(1.0), "cube", &budget).unwrap();
        let round = cube.with_round_edges(0.15, &budget).unwrap().unwrap();
        assert!(MeshReport::new(&round, &budget).unwrap().is_closed());
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let mut middle = Vector([0.3, -0.2, 0.1]);
                middle[axis] = side;
                let closest = round.closest(middle);
                assert!(closest.distance < 1e-9, "{closest:?}");
                let mut normal = Vector::ZERO;
                normal[axis] = side;
                assert!((closest.normal - normal).norm() < 1e-6, "{closest:?}");
            }
        }
        // The tip of a right angle that is rounded by r lies .41 r within.
        let tip = round.closest(Vector([1.0, 1.0, 0.0])).distance;
        assert!((0.04..0.09).contains(&tip), "{tip}");
        let sharpest = |index: &MeshIndex| {
            let of = |(t, across): (usize, &[u32; 3])| {
                let own = index.topology.double_area(t as u32).unit_or_zero();
                let least = |o: &u32| own.dot(index.topology.double_area(*o).unit_or_zero());
                across.iter().map(least).fold(1.0, f64::min)
            };
            index.topology.across.iter().enumerate().map(of).fold(1.0, f64::min)
        };
        assert!(sharpest(&cube) < 0.01 && sharpest(&round) > 0.3, "{}", sharpest(&round));
    }

    #[test]
    fn thin_plates_stay_thick_and_smooth_meshes_as_they_are() {
        let budget = Budget::default();
        let plate = MeshIndex::new(&block(0.05), "plate", &budget).unwrap();
        let round = plate.with_round_edges(0.15, &budget).unwrap().unwrap();
        assert!(round.closest(Vector([0.0, 0.0, 0.05])).distance < 1e-9);
        assert!(round.closest(Vector([0.9, 0.9, 0.0])).distance > 0.02, "its sides do not meet");
        let mut flat = block(1.0);
        flat.triangles.truncate(2);
        let sheet = MeshIndex::new(&flat, "sheet", &budget).unwrap();
        assert!(sheet.with_round_edges(0.15, &budget).unwrap().is_none());
    }
}
