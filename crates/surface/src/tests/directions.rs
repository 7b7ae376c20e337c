//! Directions on meshes of known shape.

use arabesque_core::{Budget, TriangleMesh, Vector};

use super::shapes::{ball, cuboid, grid, torus};
use crate::{Bend, DirectionField, Directions, MeshIndex, curvatures, scatter};

fn index(mesh: &TriangleMesh) -> MeshIndex {
    MeshIndex::new(mesh, "a.obj", &Budget::default()).unwrap()
}

fn field(index: &MeshIndex, directions: Directions) -> DirectionField {
    DirectionField::new(index, &directions, &Budget::default()).unwrap()
}

/// The direction around the z axis.
fn around(p: Vector<3>) -> Vector<3> {
    Vector([-p[1], p[0], 0.0]).unit()
}

/// A pipe along z, open at both ends, of a little less than round section so that it has a right-angled mesh.
fn pipe() -> TriangleMesh {
    grid(60, 40, [true, false], |a, b| {
        let a = a * std::f64::consts::TAU;
        Vector([0.5 * a.cos(), 0.5 * a.sin(), 3.0 * b])
    })
}

#[test]
fn curvatures_of_a_torus_are_those_of_its_circles() {
    let index = index(&torus(120, 60, 1.0, 0.4));
    let all = curvatures(&index, &Budget::default()).unwrap();
    for (curvature, &p) in all.iter().zip(&index.topology.points) {
        let outwards = (p[0].hypot(p[1]) - 1.0) / 0.4;
        let across = outwards / (1.0 + 0.4 * outwards);
        assert!(
            (curvature.values[0] - 2.5).abs() < 0.05 && (curvature.values[1] - across).abs() < 0.05,
            "{p:?}: {curvature:?}"
        );
        assert!(curvature.directions[1].dot(around(p)).abs() > 0.999);
    }
}

#[test]
fn patterns_run_along_a_pipe_or_around_it() {
    let index = index(&pipe());
    for (bend, along_z) in [(Bend::Least, 1.0), (Bend::Most, 0.0)] {
        let field = field(&index, Directions::Curvature(bend));
        let frames: Vec<_> =
            scatter(&index, 0.2, 1, &Budget::default()).unwrap().iter().map(|at| field.frame(&index, at)).collect();
        for frame in &frames {
            assert!((frame.tangent[2].abs() - along_z).abs() < 0.02, "{frame:?}");
            assert!(frame.tangent.dot(frame.normal).abs() < 1e-9);
        }
        if bend == Bend::Least {
            assert!(frames.iter().all(|f| f.tangent[2] > 0.9), "all run the same way");
        }
    }
}

#[test]
fn directions_around_a_torus_turn_with_it_and_all_run_one_way() {
    let index = index(&torus(120, 60, 1.0, 0.4));
    let field = field(&index, Directions::Curvature(Bend::Most));
    for at in scatter(&index, 0.2, 0, &Budget::default()).unwrap() {
        let frame = field.frame(&index, &at);
        let middle = Vector([at.point[0], at.point[1], 0.0]).unit();
        let circle = around(at.point).cross(at.point - middle).unit();
        assert!(frame.tangent.dot(circle).abs() > 0.995, "{at:?}");
    }
}

#[test]
fn a_constant_direction_is_kept_where_it_lies_along_the_surface() {
    let index = index(&ball(24, Vector::ZERO, 1.0));
    let field = field(&index, Directions::Constant(Vector([0.0, 0.0, 2.0])));
    for at in scatter(&index, 0.15, 0, &Budget::default()).unwrap() {
        let frame = field.frame(&index, &at);
        assert!((frame.tangent.norm() - 1.0).abs() < 1e-9 && frame.tangent.dot(at.normal).abs() < 1e-9);
        let flat = Vector([0.0, 0.0, 1.0]) - at.normal * at.normal[2];
        assert!(flat.norm() < 0.4 || frame.tangent.cosine(flat) > 0.98, "{at:?}: {frame:?}");
    }
    let refused = DirectionField::new(&index, &Directions::Constant(Vector::ZERO), &Budget::default());
    assert!(refused.unwrap_err().to_string().contains("not all of them 0"));
}

#[test]
fn there_are_frames_where_nothing_bends_or_everything_does() {
    for mesh in [
        ball(16, Vector::ZERO, 1.0),
        grid(9, 9, [false; 2], |u, v| Vector([u, v, 0.0])),
        cuboid(Vector::ZERO, Vector([1.0; 3])),
    ] {
        let index = index(&mesh);
        let field = field(&index, Directions::Curvature(Bend::Most));
        for at in scatter(&index, 0.1, 0, &Budget::default()).unwrap() {
            let frame = field.frame(&index, &at);
            assert!((frame.tangent.norm() - 1.0).abs() < 1e-9 && frame.tangent.is_finite());
            let m = frame.rotation();
            let y = m.apply(Vector([0.0, 1.0, 0.0]));
            assert!((m.apply(Vector([1.0, 0.0, 0.0])).cross(y) - frame.normal).norm() < 1e-9, "right-handed");
        }
    }
}

#[test]
fn strokes_lead_the_directions_between_them() {
    let index = index(&grid(30, 30, [false; 2], |u, v| Vector([u, v, 0.0])));
    let strokes = vec![
        vec![Vector([0.02, 0.1, 0.01]), Vector([0.02, 0.9, 0.0])],
        vec![Vector([0.98, 0.5, 0.0]), Vector([0.9, 0.5, 0.0])],
    ];
    let field = field(&index, Directions::Strokes(strokes));
    assert!(field.warnings().is_empty());
    let at = |x: f64| field.frame(&index, &index.closest(Vector([x, 0.5, 0.0]))).tangent;
    assert!(at(0.02)[1] > 0.99 && at(0.95)[0] < -0.95);
    assert!(at(0.4)[1] > 0.3 && at(0.4)[0] < -0.1, "turns in between: {:?}", at(0.4));
    let error = |strokes| {
        DirectionField::new(&index, &Directions::Strokes(strokes), &Budget::default()).unwrap_err().to_string()
    };
    assert!(error(Vec::new()).contains("at least one line"));
    assert!(error(vec![vec![Vector::ZERO; 3]]).contains("stroke 1: a stroke of no length"));
    let far = Directions::Strokes(vec![vec![Vector([0.0, 0.0, 1.0]), Vector([1.0, 0.0, 1.0])]]);
    assert_eq!(self::field(&index, far).warnings().len(), 1);
}
