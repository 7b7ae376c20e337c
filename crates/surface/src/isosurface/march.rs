//! Marching cubes over the blocks of a field [Lorensen 1987].

use arabesque_core::{Budget, Result, Vector};
use rayon::prelude::*;

use super::{
    cases::{CASES, MIDDLES, edge_axis, edge_start, face_corners},
    patch::{Patch, Vertex},
};
use crate::implicit::{BLOCK, Field, Node, SIDE};

/// Vertices stay so far from the ends of their edge, so that no triangle is without area.
const MARGIN: f64 = 0.02;
/// Work for each node: of its edges, and of its triangles.
const NODE: u64 = 15;
/// An edge without a vertex.
const NONE: u16 = u16::MAX;
/// Marks a vertex in the middle of a loop until it has its number.
const MIDDLE: u32 = 1 << 31;

/// A field with the blocks around each block.
struct Cells<'a> {
    field: &'a Field,
    /// For each block the eight blocks that its cells reach into, itself first.
    around: Vec<[Option<u32>; 8]>,
}

/// The vertices on the edges that start at the nodes of a block.
struct Edges {
    vertices: Vec<Vertex>,
    /// For each node and axis the number of its vertex, or none.
    numbers: Vec<u16>,
}

/// The triangles of a block, and the vertices in the middle of its loops.
type Made = (Vec<[u32; 3]>, Vec<Vertex>);

/// The surface where a field is zero; triangles face where it is positive.
pub(crate) fn march(field: &Field, budget: &Budget) -> Result<Patch> {
    let count = field.blocks.len();
    let held = budget.hold("the surface", count * 3 * BLOCK * 2)?;
    let around = |b: usize| {
        let place = field.blocks.place(b);
        std::array::from_fn(|k| {
            field.blocks.at(std::array::from_fn(|axis| place[axis] + (k as u64 >> axis & 1))).map(|b| b as u32)
        })
    };
    let cells = Cells { field, around: (0..count).into_par_iter().map(around).collect() };
    let edges: Result<Vec<Edges>> = (0..count)
        .into_par_iter()
        .map(|b| {
            budget.spend(BLOCK as u64 * NODE)?;
            Ok(cells.edges(b))
        })
        .collect();
    let edges = edges?;
    let mut firsts = Vec::with_capacity(count);
    let mut vertices = Vec::with_capacity(edges.iter().map(|e| e.vertices.len()).sum());
    for block in &edges {
        firsts.push(vertices.len() as u32);
        vertices.extend_from_slice(&block.vertices);
    }
    let made: Result<Vec<Made>> = (0..count)
        .into_par_iter()
        .map(|b| {
            budget.spend(BLOCK as u64 * NODE)?;
            Ok(cells.triangles(b, &edges, &firsts, &vertices))
        })
        .collect();
    let made = made?;
    drop(edges);
    drop(held);
    let mut triangles = Vec::with_capacity(made.iter().map(|m| m.0.len()).sum());
    for (own, middles) in made {
        let first = vertices.len() as u32;
        triangles.extend(own.iter().map(|t| t.map(|v| if v & MIDDLE == 0 { v } else { first + (v & !MIDDLE) })));
        vertices.extend(middles);
    }
    budget.spend(triangles.len() as u64 * 20)?;
    Ok(Patch { vertices, triangles }.compact())
}

impl Cells<'_> {
    /// The node of a block at a place from 0 to the side, which the next block has.
    fn number(&self, block: usize, place: [usize; 3]) -> Option<usize> {
        let over = (0..3).fold(0, |bits, k| bits | usize::from(place[k] == SIDE) << k);
        let [x, y, z] = place.map(|c| c % SIDE);
        self.around[block][over].map(|b| b as usize * BLOCK + x + SIDE * (y + SIDE * z))
    }

    fn node(&self, block: usize, place: [usize; 3]) -> &Node {
        self.number(block, place).map_or(&self.field.elsewhere, |n| &self.field.nodes[n])
    }

    fn edges(&self, block: usize) -> Edges {
        let mut edges = Edges { vertices: Vec::new(), numbers: vec![NONE; 3 * BLOCK] };
        let corner = self.field.blocks.corner(block);
        for n in 0..BLOCK {
            let place = [n % SIDE, n / SIDE % SIDE, n / (SIDE * SIDE)];
            let from = &self.field.nodes[block * BLOCK + n];
            for axis in 0..3 {
                let mut end = place;
                end[axis] += 1;
                let to = self.node(block, end);
                if from.value.is_nan() || to.value.is_nan() || (from.value < 0.0) == (to.value < 0.0) {
                    continue;
                }
                let share = crossing(from, to, axis);
                let mut at = Vector(place.map(|c| c as f64));
                at[axis] += share;
                let colour =
                    |node: Option<usize>| node.and_then(|n| self.field.colours.get(n)).copied().unwrap_or_default();
                let vertex = |node: &Node, number| Vertex {
                    at: corner + at * self.field.blocks.cell,
                    normal: node.gradient,
                    beyond: node.beyond,
                    colour: colour(number),
                };
                let [a, b] = [vertex(from, Some(block * BLOCK + n)), vertex(to, self.number(block, end))];
                edges.numbers[3 * n + axis] = edges.vertices.len() as u16;
                edges.vertices.push(a.towards(&b, share));
            }
        }
        edges
    }

    /// The triangles in the cells that start at the nodes of a block, and the vertices in the middle of loops.
    fn triangles(
        &self,
        block: usize,
        edges: &[Edges],
        firsts: &[u32],
        vertices: &[Vertex],
    ) -> (Vec<[u32; 3]>, Vec<Vertex>) {
        let (mut triangles, mut middles): (Vec<[u32; 3]>, Vec<Vertex>) = (Vec::new(), Vec::new());
        for n in 0..BLOCK {
            let place = [n % SIDE, n / SIDE % SIDE, n / (SIDE * SIDE)];
            let at = |corner: u8| std::array::from_fn(|k| place[k] + usize::from(corner >> k & 1));
            let values: [f32; 8] = std::array::from_fn(|c| self.node(block, at(c as u8)).value);
            let corners = (0..8).fold(0_u8, |bits, c| bits | u8::from(values[c] < 0.0) << c);
            if corners == 0 || corners == u8::MAX || values.iter().any(|v| v.is_nan()) {
                continue;
            }
            let joined = |face: u8| {
                let [a, b, c, d] = face_corners(face).map(|c| values[c as usize]);
                // The saddle between the corners is on the side of those that are inside.
                if a < 0.0 { a * c > b * d } else { b * d > a * c }
            };
            let case = CASES.of(corners, joined);
            // Every edge that is crossed has a vertex.
            let number = |edge: u8| -> Option<u32> {
                let node = self.number(block, at(edge_start(edge)))?;
                let own = edges[node / BLOCK].numbers[3 * (node % BLOCK) + usize::from(edge_axis(edge))];
                (own != NONE).then(|| firsts[node / BLOCK] + u32::from(own))
            };
            let so_far = (triangles.len(), middles.len());
            let vertex = |v: u8| {
                if v < MIDDLES { number(v) } else { Some(MIDDLE | (so_far.1 as u32 + u32::from(v - MIDDLES))) }
            };
            let all: Option<Vec<[u32; 3]>> =
                case.triangles.iter().map(|&[a, b, c]| Some([vertex(a)?, vertex(b)?, vertex(c)?])).collect();
            let Some(all) = all else { continue };
            triangles.extend(all);
            for ring in &case.middles {
                let around: Vec<&Vertex> =
                    ring.iter().filter_map(|&e| number(e)).map(|v| &vertices[v as usize]).collect();
                middles.extend(Vertex::mean(around.into_iter()));
            }
        }
        (triangles, middles)
    }
}

/// Where between two nodes the field is zero: on the line between the values, moved once towards the zero of the cubic that has their slopes as well.
fn crossing(from: &Node, to: &Node, axis: usize) -> f64 {
    let (a, b) = (f64::from(from.value), f64::from(to.value));
    let (p, q) = (f64::from(from.gradient[axis]), f64::from(to.gradient[axis]));
    let t = a / (a - b);
    // The cubic with these values and slopes, and how it rises, at t.
    let (s, two) = (1.0 - t, t * t);
    let value = a * s * s * (1.0 + 2.0 * t) + b * two * (3.0 - 2.0 * t) + p * t * s * s - q * two * s;
    let slope = 6.0 * t * s * (b - a) + p * s * (1.0 - 3.0 * t) + q * t * (3.0 * t - 2.0);
    let moved = t - value / slope;
    // Where the slopes do not go with the values the line is safer.
    let is_fine = p * (b - a) > 0.0
        && q * (b - a) > 0.0
        && slope * (b - a) > 0.25 * (b - a) * (b - a)
        && (moved - t).abs() < 0.25;
    (if is_fine { moved } else { t }).clamp(MARGIN, 1.0 - MARGIN)
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Stage, Stream};
    use proptest::prelude::*;

    use super::*;
    use crate::{
        implicit::Blocks,
        tests::manifold::{assert_closed, assert_manifold},
    };

    /// A field over a few blocks; beyond them it is positive, or unknown.
    fn field(value: impl Fn(Vector<3>) -> f32 + Sync, elsewhere: f32) -> Field {
        let blocks = Blocks::new(&[Vector([0.0; 3])], &[9.0], 1.0, &Budget::default()).unwrap();
        let node = |value| Node { value, gradient: [0.0; 3], beyond: 0.0 };
        Field::new(blocks, node(elsewhere), false, &Budget::default(), |blocks, b, nodes, _| {
            for (k, n) in nodes.iter_mut().enumerate() {
                let place = [k % SIDE, k / SIDE % SIDE, k / (SIDE * SIDE)].map(|c| c as f64);
                *n = node(value(blocks.corner(b) + Vector(place)));
            }
            Ok(())
        })
        .unwrap()
    }

    #[test]
    fn a_ball_is_round_and_faces_outwards() {
        let patch = march(&field(|p| p.norm() as f32 - 6.0, 9.0), &Budget::default()).unwrap();
        assert_closed(&patch.triangles, patch.vertices.len());
        assert!(patch.vertices.iter().all(|v| (v.at.norm() - 6.0).abs() < 0.05));
        for t in &patch.triangles {
            let [a, b, c] = t.map(|v| patch.vertices[v as usize].at);
            assert!((b - a).cross(c - a).dot(a) > 0.0);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

        /// Noise from node to node has every case of corners and faces, in every neighbourhood.
        #[test]
        fn whatever_the_values_the_surface_is_manifold(seed: u64, is_closed: bool, share in 0.2..0.8_f64) {
            let value = |p: Vector<3>| {
                let item = p.0.iter().fold(0_u64, |h, c| h * 1000 + (c * 4.0 + 400.0) as u64);
                let mut random = Stream::new(seed, Stage::TEST, item);
                let size = random.range(0.01, 1.0) as f32;
                // Outside of the ball that the blocks are for it is positive.
                if p.norm() < 8.5 && random.unit() < share { -size } else { size }
            };
            let mut patch = march(&field(value, if is_closed { 1.0 } else { f32::NAN }), &Budget::default()).unwrap();
            prop_assert!(patch.triangles.len() > 1000);
            if is_closed {
                assert_closed(&patch.triangles, patch.vertices.len());
            } else {
                crate::isosurface::pinches(&mut patch);
                assert_manifold(&patch.triangles, patch.vertices.len());
            }
            for t in &patch.triangles {
                let [a, b, c] = t.map(|v| patch.vertices[v as usize].at);
                prop_assert!((b - a).cross(c - a).norm() > 1e-6, "a triangle without area");
            }
        }
    }
}
