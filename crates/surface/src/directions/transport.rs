//! Tangent planes at the vertices, directions in them as complex numbers, and the smoothest ones that agree with what is known.
//!
//! A direction at angle `a` from the first axis of a vertex is `exp(i n a)`: with `n` = 1 for arrows, with `n` = 2 for lines, which are the
//! same when turned by half a turn. Along an edge a number is turned by the angle between the axes of its two ends, so that numbers of different
//! vertices can be compared [Knoppel 2013]. Where a field must vanish, the numbers are small around that place and say so.

use arabesque_core::{Budget, Result, Vector};

use crate::mesh::MeshIndex;

/// Work units of one edge in one step of the solver.
const EDGE: u64 = 4;
/// Most steps of the solver, and the residual that will do, relative to the start.
const STEPS: usize = 3000;
const RESIDUAL: f64 = 1e-6;

/// A complex number: real and imaginary part.
pub(super) type Complex = [f64; 2];

/// Product of two complex numbers.
pub(super) fn times(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// The number of length 1 at an angle.
pub(super) fn turn(angle: f64) -> Complex {
    let (sin, cos) = angle.sin_cos();
    [cos, sin]
}

/// Two axes of length 1 that span the plane across `normal`.
pub(super) fn axes(normal: Vector<3>) -> [Vector<3>; 2] {
    let least = (0..3).fold(0, |least, k| if normal[k].abs() < normal[least].abs() { k } else { least });
    let mut other = Vector::ZERO;
    other[least] = 1.0;
    let first = (other - normal * normal.dot(other)).unit_or_zero();
    [first, normal.cross(first)]
}

/// A vector across `from`, turned as `from` is turned into `to` by the shortest way.
pub(super) fn carried(v: Vector<3>, from: Vector<3>, to: Vector<3>) -> Vector<3> {
    let sum = 1.0 + from.dot(to);
    if sum < 1e-6 {
        return v - to * to.dot(v);
    }
    v - (from + to) * (to.dot(v) / sum)
}

/// The tangent planes of a mesh and the edges between them.
#[derive(Debug)]
pub(super) struct Planes {
    pub(super) normals: Vec<Vector<3>>,
    pub(super) axes: Vec<[Vector<3>; 2]>,
    /// A third of the area of the triangles around each vertex.
    pub(super) areas: Vec<f64>,
    /// Edges of vertex `v`: `starts[v]..starts[v + 1]`.
    starts: Vec<u32>,
    edges: Vec<Edge>,
    /// Length of the edges in the mean.
    pub(super) edge_length: f64,
}

#[derive(Clone, Copy, Debug)]
struct Edge {
    to: u32,
    weight: f64,
    /// Angle at this vertex of the first axis of the other.
    angle: f64,
}

/// What is known of the direction at a vertex.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Known {
    /// The direction, as a number of length 1.
    pub(super) direction: Complex,
    /// How much it weighs against the smoothness along one edge.
    pub(super) weight: f64,
}

impl Planes {
    pub(super) fn new(index: &MeshIndex, budget: &Budget) -> Result<Self> {
        let topology = &index.topology;
        budget.spend(topology.triangles.len() as u64 * 600)?;
        let count = topology.points.len();
        let axes: Vec<_> = index.normals.iter().map(|&n| axes(n)).collect();
        let mut areas = vec![0.0; count];
        for (t, corners) in topology.triangles.iter().enumerate() {
            let third = topology.double_area(t as u32).norm() / 6.0;
            corners.iter().for_each(|&v| areas[v as usize] += third);
        }
        let mut pairs = Vec::new();
        let (mut length, sides) = (0.0, topology.sides());
        for along in sides.chunk_by(|a, b| a.ends == b.ends) {
            let (a, b) = along[0].ends;
            let cotangents: f64 = along.iter().map(|side| cotangent(index, side.at)).sum();
            length += (topology.points[a as usize] - topology.points[b as usize]).norm();
            pairs.push((a, b, (0.5 * cotangents).clamp(0.05, 5.0)));
        }
        let edge_length = length / pairs.len().max(1) as f64;
        let mut starts = vec![0_u32; count + 1];
        pairs.iter().flat_map(|&(a, b, _)| [a, b]).for_each(|v| starts[v as usize + 1] += 1);
        (0..count).for_each(|v| starts[v + 1] += starts[v]);
        let mut next = starts.clone();
        let mut edges = vec![Edge { to: 0, weight: 0.0, angle: 0.0 }; 2 * pairs.len()];
        for &(a, b, weight) in &pairs {
            for (at, to) in [(a, b), (b, a)] {
                let (i, j) = (at as usize, to as usize);
                let axis = carried(axes[j][0], index.normals[j], index.normals[i]);
                let angle = axis.dot(axes[i][1]).atan2(axis.dot(axes[i][0]));
                edges[next[i] as usize] = Edge { to, weight, angle };
                next[i] += 1;
            }
        }
        Ok(Self { normals: index.normals.clone(), axes, areas, starts, edges, edge_length })
    }

    /// A direction in space as a number at vertex `v`, of length 1, with the share of it that lies in the plane there.
    pub(super) fn number(&self, v: usize, direction: Vector<3>, symmetry: u32) -> (Complex, f64) {
        let [x, y] = self.axes[v].map(|axis| axis.dot(direction));
        let share = x.hypot(y) / direction.norm().max(f64::MIN_POSITIVE);
        (turn(f64::from(symmetry) * y.atan2(x)), share)
    }

    /// The direction in space of a number at vertex `v`.
    pub(super) fn direction(&self, v: usize, number: Complex, symmetry: u32) -> Vector<3> {
        let [cos, sin] = turn(number[1].atan2(number[0]) / f64::from(symmetry));
        self.axes[v][0] * cos + self.axes[v][1] * sin
    }

    /// The vertices next to `v`.
    pub(super) fn around(&self, v: usize) -> impl Iterator<Item = usize> + '_ {
        self.row(v).iter().map(|edge| edge.to as usize)
    }

    fn row(&self, v: usize) -> &[Edge] {
        &self.edges[self.starts[v] as usize..self.starts[v + 1] as usize]
    }

    /// The numbers that differ least along the edges and from what is known, by conjugate gradients.
    pub(super) fn smoothest(&self, known: &[Known], symmetry: u32, budget: &Budget) -> Result<Vec<Complex>> {
        let turns: Vec<Complex> = self.edges.iter().map(|edge| turn(f64::from(symmetry) * edge.angle)).collect();
        let diagonal: Vec<f64> = (0..known.len())
            .map(|v| (self.row(v).iter().map(|edge| edge.weight).sum::<f64>() + known[v].weight).max(f64::MIN_POSITIVE))
            .collect();
        let product = |x: &[Complex]| -> Vec<Complex> {
            let row = |v: usize| {
                let from = self.starts[v] as usize;
                self.row(v).iter().enumerate().fold(x[v].map(|c| c * diagonal[v]), |sum, (k, edge)| {
                    let there = times(turns[from + k], x[edge.to as usize]);
                    [sum[0] - edge.weight * there[0], sum[1] - edge.weight * there[1]]
                })
            };
            (0..x.len()).map(row).collect()
        };
        let dot = |a: &[Complex], b: &[Complex]| a.iter().zip(b).map(|(a, b)| a[0] * b[0] + a[1] * b[1]).sum::<f64>();
        let scaled =
            |r: &[Complex]| -> Vec<Complex> { r.iter().zip(&diagonal).map(|(r, d)| r.map(|c| c / d)).collect() };
        let mut x = vec![[0.0; 2]; known.len()];
        let mut r: Vec<Complex> = known.iter().map(|k| k.direction.map(|c| c * k.weight)).collect();
        let mut z = scaled(&r);
        let mut p = z.clone();
        let mut rz = dot(&r, &z);
        let enough = rz * RESIDUAL * RESIDUAL;
        for _ in 0..STEPS {
            if rz <= enough || rz <= 0.0 {
                break;
            }
            budget.spend(EDGE * self.edges.len() as u64 + 20 * known.len() as u64)?;
            let ap = product(&p);
            let step = rz / dot(&p, &ap).max(f64::MIN_POSITIVE);
            for v in 0..x.len() {
                for c in 0..2 {
                    x[v][c] += step * p[v][c];
                    r[v][c] -= step * ap[v][c];
                }
            }
            z = scaled(&r);
            let new = dot(&r, &z);
            p.iter_mut().zip(&z).for_each(|(p, z)| *p = [z[0] + new / rz * p[0], z[1] + new / rz * p[1]]);
            rz = new;
        }
        Ok(x)
    }
}

/// Cotangent of the angle of a triangle opposite to one of its edges.
fn cotangent(index: &MeshIndex, side: u32) -> f64 {
    let corners = index.topology.corners(side / 3);
    let k = side as usize % 3;
    let (u, v) = (corners[k] - corners[(k + 2) % 3], corners[(k + 1) % 3] - corners[(k + 2) % 3]);
    u.dot(v) / u.cross(v).norm().max(f64::MIN_POSITIVE)
}
