//! Surfaces of points, and questions to meshes, at sizes that are published for other programs.
//!
//! `cargo bench -p arabesque-surface`: MeshLab takes 2.8 s and 149 MB for robust moving least squares through 30 000 points.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]
#![allow(missing_docs, reason = "the macros of divan make items without any")]

use std::f64::consts::TAU;

use arabesque_core::{Budget, PointSet, Stage, Stream, TriangleMesh, Unobserved, Vector};
use arabesque_surface::{Bend, DirectionField, Directions, MeshIndex, SurfaceParams, reconstruct, scatter};

fn main() {
    divan::main();
}

/// A torus with waves on it.
fn torus(u: u32, v: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for j in 0..v {
        for i in 0..u {
            let (a, b) = (f64::from(i) / f64::from(u) * TAU, f64::from(j) / f64::from(v) * TAU);
            let small = 0.35 + 0.03 * (9.0 * a).sin() * (5.0 * b).cos();
            let r = 1.0 + small * b.cos();
            mesh.positions.push(Vector([r * a.cos(), r * a.sin(), small * b.sin()]));
            let at = |i: u32, j: u32| (j % v) * u + i % u;
            let [p, q, r, s] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            mesh.triangles.extend([[p, q, r], [p, r, s]]);
        }
    }
    mesh
}

fn index() -> MeshIndex {
    MeshIndex::new(&torus(240, 120), "torus", &Budget::default()).unwrap()
}

/// About 30 000 points with normals.
fn points() -> PointSet<3> {
    let found = scatter(&index(), 0.0183, 1, &Budget::default()).unwrap();
    let mut points = PointSet::at(found.iter().map(|p| p.point).collect());
    points.normals = Some(found.iter().map(|p| p.normal).collect());
    points
}

fn params(method: &str) -> SurfaceParams {
    let mut params = SurfaceParams::default();
    params.set("method", method).unwrap();
    params
}

#[divan::bench]
fn rimls_30_000_points(bencher: divan::Bencher<'_, '_>) {
    let (points, params) = (points(), params("rimls"));
    bencher.bench(|| reconstruct(&points, &params, None, &Budget::default(), &mut Unobserved).unwrap());
}

#[divan::bench]
fn rimls_30_000_points_without_normals(bencher: divan::Bencher<'_, '_>) {
    let (mut points, params) = (points(), params("rimls"));
    points.normals = None;
    bencher.bench(|| reconstruct(&points, &params, None, &Budget::default(), &mut Unobserved).unwrap());
}

#[divan::bench]
fn metaballs_3_000_points(bencher: divan::Bencher<'_, '_>) {
    let params = params("metaballs");
    let found = scatter(&index(), 0.06, 1, &Budget::default()).unwrap();
    let mut points = PointSet::at(found.iter().map(|p| p.point).collect());
    points.radii = Some(vec![0.05; points.len()]);
    bencher.bench(|| reconstruct(&points, &params, None, &Budget::default(), &mut Unobserved).unwrap());
}

#[divan::bench]
fn signed_distances_of_100_000_places(bencher: divan::Bencher<'_, '_>) {
    let index = index();
    let mut random = Stream::new(1, Stage::TEST, 0);
    let places: Vec<_> = (0..100_000).map(|_| Vector(std::array::from_fn(|_| random.range(-1.5, 1.5)))).collect();
    bencher.bench(|| index.signed_distances(&places, &Budget::default()).unwrap());
}

#[divan::bench]
fn index_of_57_600_triangles(bencher: divan::Bencher<'_, '_>) {
    let mesh = torus(240, 120);
    bencher.bench(|| MeshIndex::new(&mesh, "torus", &Budget::default()).unwrap());
}

#[divan::bench]
fn directions_of_curvature(bencher: divan::Bencher<'_, '_>) {
    let index = index();
    bencher.bench(|| DirectionField::new(&index, &Directions::Curvature(Bend::Least), &Budget::default()).unwrap());
}
