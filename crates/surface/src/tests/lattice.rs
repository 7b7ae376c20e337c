//! Lattices on meshes of known shape.

use arabesque_core::{Budget, TriangleMesh, Vector};

use super::shapes::{ball, grid};
use crate::{Axes, Closest, DirectionField, Directions, LatticePlace, MeshIndex, RowSite, SurfaceLattice};

const SIDE: f64 = 0.2;

fn index(mesh: &TriangleMesh) -> MeshIndex {
    MeshIndex::new(mesh, "a.obj", &Budget::default()).unwrap()
}

/// Places of a lattice of which the rows run along `direction`.
fn places(index: &MeshIndex, direction: Vector<3>, vectors: [Vector<2>; 2], seed: u64) -> Vec<LatticePlace> {
    let budget = Budget::default();
    let field = DirectionField::new(index, &Directions::Constant(direction), &budget).unwrap();
    let axes = |at: &Closest| -> Axes {
        let frame = field.frame(index, at);
        [frame.tangent, frame.bitangent()]
    };
    let lattice = SurfaceLattice::new(index, &axes, (vectors, None), 0.0, (seed, &budget)).unwrap();
    lattice.places(index, Vector::ZERO, &budget).unwrap()
}

fn square() -> [Vector<2>; 2] {
    [Vector::xy(SIDE, 0.0), Vector::xy(0.0, SIDE)]
}

/// Distance of each place from the nearest other.
fn gaps(places: &[LatticePlace]) -> Vec<f64> {
    let nearest = |a: &LatticePlace| {
        let apart = places.iter().map(|b| (b.at.point - a.at.point).norm()).filter(|d| *d > 0.0);
        apart.fold(f64::INFINITY, f64::min)
    };
    places.iter().map(nearest).collect()
}

#[test]
fn on_a_flat_mesh_it_is_the_lattice_itself() {
    let flat = index(&grid(3, 3, [false; 2], |a, b| Vector([3.0 * a, 2.0 * b, 0.0])));
    for seed in 0..3 {
        let found = places(&flat, Vector([1.0, 0.0, 0.0]), square(), seed);
        assert!((135..=176).contains(&found.len()), "15 to 16 times 9 to 11, not {}", found.len());
        let first = found[0].at.point;
        for place in &found {
            let nodes = (place.at.point - first).0.map(|v| v / SIDE);
            assert!(nodes.iter().all(|n| (n - n.round()).abs() < 1e-3), "{nodes:?}");
        }
    }
}

#[test]
fn rows_close_up_around_a_pipe_that_suits_them() {
    let around = 30.0 * SIDE / std::f64::consts::TAU;
    let pipe = index(&grid(240, 40, [true, false], |a, b| {
        let a = a * std::f64::consts::TAU;
        Vector([around * a.cos(), around * a.sin(), 3.0 * b])
    }));
    let sheared = [Vector::xy(SIDE, 0.0), Vector::xy(0.5 * SIDE, SIDE)];
    for vectors in [square(), sheared] {
        let found = places(&pipe, Vector([0.0, 0.0, 1.0]), vectors, 1);
        assert!((420..=480).contains(&found.len()), "about 450, not {}", found.len());
        assert!(gaps(&found).iter().all(|gap| *gap > 0.97 * SIDE && *gap < 1.03 * SIDE));
    }
}

#[test]
fn around_a_ball_it_breaks_and_leaves_neither_heaps_nor_holes() {
    let ball = index(&ball(48, Vector::ZERO, 1.0));
    for seed in 0..3 {
        let found = places(&ball, Vector([0.0, 0.0, 1.0]), square(), seed);
        let expected = ball.area() / (SIDE * SIDE);
        let share = found.len() as f64 / expected;
        assert!((0.9..1.1).contains(&share), "{share}");
        let gaps = gaps(&found);
        let regular = gaps.iter().filter(|gap| (**gap / SIDE - 1.0).abs() < 0.1).count();
        assert!(gaps.iter().all(|gap| *gap > 0.5 * SIDE && *gap < 1.6 * SIDE));
        assert!(regular as f64 > 0.7 * found.len() as f64, "{regular} of {}", found.len());
    }
}

#[test]
fn parallel_vectors_are_no_lattice() {
    let flat = index(&grid(3, 3, [false; 2], |a, b| Vector([a, b, 0.0])));
    let axes = |_: &Closest| [Vector([1.0, 0.0, 0.0]), Vector([0.0, 1.0, 0.0])];
    let vectors = [Vector::xy(0.1, 0.0), Vector::xy(0.2, 0.0)];
    let error = SurfaceLattice::new(&flat, &axes, (vectors, None), 0.0, (0, &Budget::default())).unwrap_err();
    assert!(error.to_string().contains("not parallel"));
}

/// How well places lie on level rows so far apart, from 0 to 1; those near the poles are left out.
fn on_rows(found: &[LatticePlace], radius: f64, row: f64) -> f64 {
    let latitudes: Vec<f64> =
        found.iter().map(|p| (p.at.point[2] / p.at.point.norm()).asin()).filter(|l| l.abs() < 1.1).collect();
    let turn = latitudes.iter().fold(Vector::ZERO, |sum, l| {
        let phase = l * radius / row * std::f64::consts::TAU;
        sum + Vector::xy(phase.cos(), phase.sin())
    });
    turn.norm() / latitudes.len() as f64
}

#[test]
fn rows_of_a_ball_stay_level_and_slip() {
    let budget = Budget::default();
    // Coarse triangles whose normals are smooth, and things that lie some way over them, are no matter.
    for (parts, height, seed) in [(48, 0.0, 1), (24, 0.05, 0), (12, 0.04, 2), (12, 0.04, 3), (16, 0.04, 4)] {
        let ball = index(&ball(parts, Vector::ZERO, 1.0));
        let field = DirectionField::new(&ball, &Directions::Constant(Vector([0.0, 0.0, 1.0])), &budget).unwrap();
        let axes = |at: &Closest| -> Axes {
            let frame = field.frame(&ball, at);
            [-frame.bitangent(), frame.tangent]
        };
        let row = 0.1;
        let lying = ([Vector::xy(1.45 * row, row), Vector::xy(-1.45 * row, row)], Some(Vector::xy(1.0, 0.0)));
        let lattice = SurfaceLattice::new(&ball, &axes, lying, height, (seed, &budget)).unwrap();
        assert!(lattice.broken() < 0.1, "{parts} parts: {}", lattice.broken());
        let found = lattice.places(&ball, Vector::ZERO, &budget).unwrap();
        let order = on_rows(&found, 1.0 + height, row);
        assert!(order > 0.9, "{parts} parts, seed {seed}: places lie on rows by {order}");
        let share = found.len() as f64 * 2.9 * row * row / (ball.area() * (1.0 + height).powi(2));
        assert!((0.9..1.1).contains(&share), "{parts} parts: {share}");
    }
}

#[test]
fn rows_of_a_ball_have_whole_numbers_of_things_evenly_apart() {
    let budget = Budget::default();
    let ball = index(&ball(48, Vector::ZERO, 1.0));
    let field = DirectionField::new(&ball, &Directions::Constant(Vector([0.0, 0.0, 1.0])), &budget).unwrap();
    let axes = |at: &Closest| -> Axes {
        let frame = field.frame(&ball, at);
        [-frame.bitangent(), frame.tangent]
    };
    let (row, brick) = (0.1, 0.29);
    let lying = ([Vector::xy(0.5 * brick, row), Vector::xy(-0.5 * brick, row)], Some(Vector::xy(1.0, 0.0)));
    let lattice = SurfaceLattice::new(&ball, &axes, lying, 0.0, (1, &budget)).unwrap();
    let places = lattice.places(&ball, Vector::ZERO, &budget).unwrap();
    let site = |(item, place): (usize, &LatticePlace)| RowSite { at: place.at, offset: Vector::ZERO, item };
    let sites: Vec<_> = places.iter().enumerate().map(site).collect();
    let fair = |sites: &[RowSite]| {
        let gaps: Vec<f64> = sites
            .iter()
            .filter(|site| site.at.point[2].abs() < 0.85)
            .map(|site| {
                let p = site.at.point;
                let near = sites.iter().filter(|q| (q.at.point - p).norm() < 4.0 * brick);
                let in_row = near.filter(|q| (q.at.point[2].asin() - p[2].asin()).abs() < 0.3 * row);
                let after = in_row.map(|q| around(p).dot(q.at.point - p)).filter(|along| *along > 1e-6);
                after.fold(f64::INFINITY, f64::min) / brick
            })
            .collect();
        gaps.iter().filter(|gap| (0.9..1.2).contains(*gap)).count() as f64 / gaps.len() as f64
    };
    let before = fair(&sites);
    let evened = lattice.even_rows(&ball, &axes, sites, &budget).unwrap();
    assert!(before < 0.8, "as the lattice breaks: {before}");
    assert!(fair(&evened) > 0.9, "{}", fair(&evened));
}

/// The direction around the z axis.
fn around(p: Vector<3>) -> Vector<3> {
    Vector([-p[1], p[0], 0.0]).unit()
}
