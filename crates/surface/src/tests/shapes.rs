//! Meshes and point sets of known shape.

use std::f64::consts::{PI, TAU};

use arabesque_core::{TriangleMesh, Vector};

/// A grid of `u` by `v` quads over the unit square, mapped by `place`; closed along a coordinate where `wraps` says so.
pub(crate) fn grid(u: u32, v: u32, wraps: [bool; 2], place: impl Fn(f64, f64) -> Vector<3>) -> TriangleMesh {
    let count = [u + u32::from(!wraps[0]), v + u32::from(!wraps[1])];
    let mut mesh = TriangleMesh::default();
    for j in 0..count[1] {
        for i in 0..count[0] {
            mesh.positions.push(place(f64::from(i) / f64::from(u), f64::from(j) / f64::from(v)));
        }
    }
    let number = |i: u32, j: u32| (j % count[1]) * count[0] + i % count[0];
    for j in 0..v {
        for i in 0..u {
            let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// A torus around the z axis.
pub(crate) fn torus(u: u32, v: u32, large: f64, small: f64) -> TriangleMesh {
    grid(u, v, [true, true], |a, b| {
        let (a, b) = (a * TAU, b * TAU);
        let r = large + small * b.cos();
        Vector([r * a.cos(), r * a.sin(), small * b.sin()])
    })
}

/// A ball around a centre; its poles are made of triangles without area that are left out.
pub(crate) fn ball(n: u32, centre: Vector<3>, radius: f64) -> TriangleMesh {
    let mut mesh = grid(2 * n, n, [true, false], |a, b| {
        let (a, b) = (a * TAU, (b - 0.5) * PI);
        let r = if (b.abs() - 0.5 * PI).abs() < 1e-9 { 0.0 } else { b.cos() };
        centre + Vector([r * a.cos(), r * a.sin(), b.sin()]) * radius
    });
    mesh.triangles.retain(|t| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        (b - a).cross(c - a).norm() > 1e-12
    });
    mesh
}

/// A box from corner to corner, faces outwards.
pub(crate) fn cuboid(min: Vector<3>, max: Vector<3>) -> TriangleMesh {
    let corner = |k: u32| Vector(std::array::from_fn(|axis| if k >> axis & 1 == 1 { max[axis] } else { min[axis] }));
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriangleMesh { positions: (0..8).map(corner).collect(), triangles, ..TriangleMesh::default() }
}

/// Two meshes as one.
pub(crate) fn together(a: &TriangleMesh, b: &TriangleMesh) -> TriangleMesh {
    let mut both = a.clone();
    let offset = a.positions.len() as u32;
    both.positions.extend(&b.positions);
    both.triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + offset)));
    both
}

/// The mesh turned inside out.
pub(crate) fn turned(mesh: &TriangleMesh) -> TriangleMesh {
    let mut turned = mesh.clone();
    turned.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    turned
}
