//! Points on, around and inside of meshes.

use arabesque_core::{Budget, Limits, Vector};

use super::shapes::{ball, grid, torus};
use crate::{MeshIndex, inside_grid, scatter, shell_grid};

#[test]
fn points_on_a_surface_are_apart_and_leave_no_hole() {
    let index = MeshIndex::new(&torus(40, 20, 1.0, 0.4), "a", &Budget::default()).unwrap();
    let points = scatter(&index, 0.1, 3, &Budget::default()).unwrap();
    for (k, a) in points.iter().enumerate() {
        assert!(points[..k].iter().all(|b| (a.point - b.point).norm() >= 0.1));
    }
    let fine = scatter(&index, 0.03, 4, &Budget::default()).unwrap();
    let gaps: Vec<f64> =
        fine.iter().map(|p| points.iter().map(|q| (p.point - q.point).norm()).fold(9.0, f64::min)).collect();
    assert!(gaps.iter().all(|&gap| gap < 0.14), "{:?}", gaps.iter().copied().fold(0.0, f64::max));
    assert!(gaps.iter().filter(|&&gap| gap > 0.1).count() * 100 < gaps.len());
    assert_eq!(points, scatter(&index, 0.1, 3, &Budget::default()).unwrap());
    assert_ne!(points, scatter(&index, 0.1, 4, &Budget::default()).unwrap());
}

#[test]
fn both_sides_of_a_thin_plate_get_their_points() {
    let plate = super::shapes::cuboid(Vector::ZERO, Vector([1.0, 1.0, 0.01]));
    let index = MeshIndex::new(&plate, "a", &Budget::default()).unwrap();
    let points = scatter(&index, 0.1, 0, &Budget::default()).unwrap();
    let above = points.iter().filter(|p| p.point[2] > 0.0099).count();
    assert!(above * 3 > points.len() && above * 3 < 2 * points.len(), "{above} of {}", points.len());
}

#[test]
fn grids_fill_volumes_and_shells() {
    let index = MeshIndex::new(&ball(30, Vector::ZERO, 1.0), "a", &Budget::default()).unwrap();
    let count = |points: &[Vector<3>], spacing: f64| points.len() as f64 * spacing.powi(3);
    let ball_volume = |r: f64| 4.0 / 3.0 * std::f64::consts::PI * r.powi(3);
    let inside = inside_grid(&index, 0.07, 0.0, &Budget::default()).unwrap();
    assert!((count(&inside, 0.07) / ball_volume(1.0) - 1.0).abs() < 0.03);
    assert!(inside.iter().all(|p| p.norm() < 1.0));
    let more = inside_grid(&index, 0.07, 0.2, &Budget::default()).unwrap();
    assert!((count(&more, 0.07) / ball_volume(1.2) - 1.0).abs() < 0.03);
    let shell = shell_grid(&index, 0.07, 0.1, 0.2, &Budget::default()).unwrap();
    assert!((count(&shell, 0.07) / (ball_volume(1.2) - ball_volume(0.9)) - 1.0).abs() < 0.03);
    let sheet = MeshIndex::new(&grid(4, 4, [false; 2], |u, v| Vector([u, v, 0.0])), "a", &Budget::default()).unwrap();
    let above = shell_grid(&sheet, 0.05, 0.0, 0.2, &Budget::default()).unwrap();
    assert!(above.iter().all(|p| p[2] > -1e-9) && above.len() > 400 * 4);
}

#[test]
fn what_would_be_too_many_is_refused() {
    let index = MeshIndex::new(&ball(8, Vector::ZERO, 1.0), "a", &Budget::default()).unwrap();
    let few = Budget::new(Limits { candidates: 1000, ..Limits::default() });
    assert!(scatter(&index, 0.01, 0, &few).unwrap_err().to_string().contains("--limit candidates="));
    assert!(inside_grid(&index, 0.001, 0.0, &few).unwrap_err().to_string().contains("--limit candidates="));
    assert!(scatter(&index, 0.0, 0, &few).unwrap_err().to_string().contains("spacing = 0"));
    assert!(shell_grid(&index, f64::NAN, 0.0, 0.1, &few).is_err());
}
