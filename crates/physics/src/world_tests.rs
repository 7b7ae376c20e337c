//! Tiny scenes.

use std::sync::Arc;

use arabesque_core::{Bounds, Limits, Similarity, TriangleMesh};

use super::*;
use crate::{
    shape::{Collider, Shape},
    surroundings::{Side, Surface},
};

const DOWN: Vector<3> = Vector([0.0, -1.0, 0.0]);

fn brick(size: [f64; 3]) -> TriangleMesh {
    let positions = (0..8).map(|k| Vector([0, 1, 2].map(|a| size[a] * f64::from(k >> a & 1)))).collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    TriangleMesh { positions, triangles, ..TriangleMesh::default() }
}

fn body(shape: &Arc<Shape>, place: [f64; 3]) -> Body {
    Body { shape: Arc::clone(shape), pose: Similarity::shift(Vector(place)), frozen: false, gravity: None }
}

fn world(surroundings: Surroundings, gravity: Vector<3>, bodies: Vec<Body>) -> World {
    let mut world = World::new(surroundings, gravity, &PhysicsParams::default()).unwrap();
    world.place(bodies).unwrap();
    world
}

fn stack() -> World {
    let shape = Arc::new(Shape::new(&brick([2.0, 0.5, 1.0]), "brick", &Budget::default()).unwrap());
    assert_eq!(shape.collider(), Collider::Cuboid);
    let bodies = (0..4).map(|k| body(&shape, [0.0, 0.2 + 0.7 * f64::from(k), 0.0])).collect();
    world(Surroundings::default().floor(1, 0.0), DOWN, bodies)
}

#[test]
fn bricks_with_gaps_come_to_lie_on_the_floor_and_on_one_another() {
    let mut world = stack();
    let run = world.settle(&Budget::default()).unwrap();
    assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    for (k, body) in world.bodies().iter().enumerate() {
        let height = body.pose.apply(body.shape.centre())[1];
        assert!((height - (0.25 + 0.5 * k as f64)).abs() < 0.03, "{k}: {height}");
    }
    assert!(run.after.deepest < 0.02, "{:?}", run.after);
}

#[test]
fn the_same_bodies_give_the_same_bytes_in_any_pool() {
    let poses = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut world = stack();
            world.settle(&Budget::default()).unwrap();
            world.bodies().iter().map(|b| b.pose).collect::<Vec<_>>()
        })
    };
    assert_eq!(poses(1), poses(2));
    assert_eq!(poses(1), poses(3));
}

#[test]
fn overlapping_bodies_are_pushed_apart_a_little_and_frozen_ones_stay() {
    let shape = Arc::new(Shape::new(&brick([1.0; 3]), "cube", &Budget::default()).unwrap());
    let mut bodies = vec![body(&shape, [0.1, 0.2, 0.3]), body(&shape, [0.9, 0.2, 0.3])];
    bodies[0].frozen = true;
    bodies[1].pose.scale = 1.2;
    let before = bodies.clone();
    let mut world = world(Surroundings::default(), Vector::ZERO, bodies);
    for _ in 0..10 {
        let run = world.substeps(5, &Budget::default()).unwrap();
        assert!(run.after.total <= run.before.total);
    }
    assert_eq!(world.bodies()[0].pose, before[0].pose);
    let moved = world.bodies()[1].pose.translation[0] - before[1].pose.translation[0];
    assert!((0.15..0.3).contains(&moved), "{moved}");
    assert_eq!(world.bodies()[1].pose.scale, 1.2);
}

#[test]
fn bodies_at_one_place_stay_bounded_and_those_that_fall_for_ever_are_put_back() {
    let shape = Arc::new(Shape::new(&brick([1.0; 3]), "cube", &Budget::default()).unwrap());
    let mut at_one = world(Surroundings::default(), Vector::ZERO, vec![body(&shape, [0.0; 3]); 5]);
    at_one.substeps(5, &Budget::default()).unwrap();
    assert!(at_one.bodies().iter().all(|b| b.pose.translation.norm() < 1.0));
    let mut falling = world(Surroundings::default(), DOWN, vec![body(&shape, [0.0; 3])]);
    falling.setting.params.steps = 4000;
    let run = falling.settle(&Budget::default()).unwrap();
    assert!(run.warnings.iter().any(|w| w.message.contains("left the scene")), "{:?}", run.warnings);
    assert_eq!(falling.bodies()[0].pose, Similarity::identity());
}

#[test]
fn flat_meshes_and_broken_poses_are_refused_and_a_stop_is_heard() {
    let error = Shape::new(&brick([1.0, 0.0, 1.0]), "leaf", &Budget::default()).unwrap_err().to_string();
    assert!(error.contains("leaf") && error.contains("flat"), "{error}");
    let mut world = stack();
    let mut bodies = world.bodies().to_vec();
    bodies[2].pose.translation[0] = f64::NAN;
    assert!(world.place(bodies).unwrap_err().to_string().contains("element 3"));
    let run = world.settle(&Budget::stopping_at(Limits::default(), 3)).unwrap();
    assert_eq!((run.steps, run.stopped), (2, StopReason::Stopped));
}

#[test]
fn bodies_in_a_bowl_stay_in_it() {
    let shape = Arc::new(Shape::new(&brick([0.5; 3]), "cube", &Budget::default()).unwrap());
    let bodies = (0..8).map(|k| body(&shape, [f64::from(k % 2) * 0.7, 0.5 + 0.6 * f64::from(k / 2), 0.2])).collect();
    // A dish: the rim is a square of side 6 at height 3, the bottom one of side 2 at height 0.
    let ring = |half: f64, y: f64| [[-half, y, -half], [half, y, -half], [half, y, half], [-half, y, half]].map(Vector);
    let mut positions = ring(1.0, 0.0).to_vec();
    positions.extend(ring(3.0, 3.0));
    let sides = (0..4_u32).flat_map(|k| [[k, (k + 1) % 4, k + 4], [(k + 1) % 4, (k + 1) % 4 + 4, k + 4]]);
    let triangles = sides.chain([[0, 2, 1], [0, 3, 2]]).collect();
    let dish = TriangleMesh { positions, triangles, ..TriangleMesh::default() };
    let surroundings =
        Surroundings { surfaces: vec![Surface { mesh: dish, side: Side::Either }], ..Surroundings::default() };
    let mut world = world(surroundings, DOWN, bodies);
    world.settle(&Budget::default()).unwrap();
    for body in world.bodies() {
        let [x, y, z] = body.pose.apply(body.shape.centre()).0;
        assert!(y > 0.1 && y < 3.0 && x.abs().max(z.abs()) < 1.0 + y, "{x} {y} {z}");
    }
}

#[test]
fn a_thousand_bodies_pile_up_in_a_box_without_running_into_one_another() {
    let shape = Arc::new(Shape::new(&brick([1.0, 0.8, 0.6]), "brick", &Budget::default()).unwrap());
    let at = |k: usize| [k % 10, k / 100, k / 10 % 10].map(|n| n as f64 * 0.95);
    let bodies = (0..1000).map(|k| body(&shape, at(k))).collect();
    let bounds = Bounds::new(Vector([-0.1, 0.0, -0.1]), Vector([11.0, 40.0, 11.0]));
    let mut world = world(Surroundings::default().inside_box(&bounds), DOWN, bodies);
    let first = world.substeps(5, &Budget::default()).unwrap();
    (0..9).for_each(|_| drop(world.substeps(5, &Budget::default()).unwrap()));
    let last = world.settle(&Budget::default()).unwrap();
    assert!(last.after.total < 0.3 * first.before.total, "{:?} {:?}", first.before, last.after);
    assert!(last.after.deepest < 0.1, "{:?}", last.after);
}

#[test]
fn what_is_outside_a_container_or_inside_an_obstacle_is_pushed_to_where_it_belongs() {
    let shape = Arc::new(Shape::new(&brick([0.4; 3]), "cube", &Budget::default()).unwrap());
    for is_inside_out in [false, true] {
        for (side, place) in [(Side::Inside, [4.2, 2.0, 2.0]), (Side::Outside, [3.6, 2.0, 2.0])] {
            let mut mesh = brick([4.0; 3]);
            if is_inside_out {
                mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
            }
            let surroundings = Surroundings { surfaces: vec![Surface { mesh, side }], ..Surroundings::default() };
            let mut world = world(surroundings, Vector::ZERO, vec![body(&shape, place)]);
            let run = world.settle(&Budget::default()).unwrap();
            let x = world.bodies()[0].pose.apply(shape.centre())[0];
            assert!(
                if side == Side::Inside { (3.5..3.9).contains(&x) } else { (4.1..4.5).contains(&x) },
                "{side:?} {x}"
            );
            assert!(run.after.deepest < 0.02, "{:?}", run.after);
        }
    }
    let mut open = brick([4.0; 3]);
    open.triangles.truncate(11);
    let surroundings =
        Surroundings { surfaces: vec![Surface { mesh: open, side: Side::Inside }], ..Surroundings::default() };
    let error = world(surroundings, Vector::ZERO, vec![body(&shape, [1.0; 3])]).settle(&Budget::default());
    assert!(error.unwrap_err().to_string().contains("container with holes"));
}

#[test]
fn what_hangs_in_the_air_floats_until_it_has_fallen() {
    let mut world = stack();
    let first = world.substeps(1, &Budget::default()).unwrap();
    assert_eq!((first.before.floating, first.after.floating), (4, 4));
    let last = world.settle(&Budget::default()).unwrap();
    assert_eq!(last.after.floating, 0);
}

#[test]
fn middles_stay_in_their_box_and_lie_on_its_bottom() {
    let shape = Arc::new(Shape::new(&brick([1.0; 3]), "cube", &Budget::default()).unwrap());
    let bodies = (0..3).map(|k| body(&shape, [0.3, 1.5 * f64::from(k), 0.3])).collect();
    let middles = Some(Bounds::new(Vector::ZERO, Vector([3.0; 3])));
    let mut world = world(Surroundings { middles, ..Surroundings::default() }, DOWN, bodies);
    let run = world.settle(&Budget::default()).unwrap();
    let heights: Vec<_> = world.bodies().iter().map(|b| b.pose.apply(shape.centre())[1]).collect();
    assert!(heights.iter().zip(0..).all(|(y, k)| (y - f64::from(k)).abs() < 0.05), "{heights:?}");
    assert_eq!(run.after.floating, 0);
}

#[test]
fn each_body_may_fall_its_own_way_and_turns_no_farther_than_it_may() {
    let long = Arc::new(Shape::new(&brick([4.0, 0.5, 0.5]), "beam", &Budget::default()).unwrap());
    let mut bodies = vec![body(&long, [0.0; 3]), body(&long, [0.0, 9.0, 0.0]), body(&long, [1.9, 0.4, 0.0])];
    bodies[1].gravity = Some(Vector([0.0, 0.0, 1.0]));
    bodies[2].pose.rotation = arabesque_core::Matrix([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]]);
    let mut world = world(Surroundings::default(), Vector::ZERO, bodies.clone());
    world.setting.params.turn = 1.0;
    world.setting.params.reach = 10.0;
    world.substeps(60, &Budget::default()).unwrap();
    assert!(world.bodies()[1].pose.translation[2] > 0.5);
    for (now, then) in world.bodies().iter().zip(&bodies) {
        let [a, b] = [now, then].map(|b| b.pose.rotation.apply(Vector([1.0, 0.0, 0.0])));
        let angle = a.dot(b).clamp(-1.0, 1.0).acos().to_degrees();
        assert!(angle < 1.05, "{angle}");
    }
}

/// A prism of `sides` around y, from the floor upwards; a cone where its top is no wider than nothing.
fn prism(sides: u32, radius: f64, height: f64, top: f64) -> TriangleMesh {
    let ring = |y: f64, r: f64| {
        (0..sides).map(move |k| {
            let (sin, cos) = (f64::from(k) / f64::from(sides) * std::f64::consts::TAU).sin_cos();
            Vector([r * cos, y, r * sin])
        })
    };
    let positions = ring(0.0, radius).chain(ring(height, top)).collect();
    let side = |k: u32| {
        let next = (k + 1) % sides;
        [[k, k + sides, next], [next, k + sides, next + sides]]
    };
    let caps = (1..sides - 1).flat_map(|k| [[0, k, k + 1], [sides, sides + k + 1, sides + k]]);
    let triangles = (0..sides).flat_map(side).chain(caps).collect();
    TriangleMesh { positions, triangles, ..TriangleMesh::default() }
}

#[test]
fn cans_cones_and_coins_stand_where_they_stand() {
    for (sides, height, top) in
        [(7, 1.5, 0.4), (8, 1.5, 0.4), (12, 1.5, 0.4), (16, 1.5, 0.1), (24, 1.5, 0.4), (16, 0.2, 0.4), (48, 0.1, 0.4)]
    {
        let mesh = prism(sides, 0.4, height, top);
        let shape = Arc::new(Shape::new(&mesh, "can", &Budget::default()).unwrap());
        let bodies = vec![body(&shape, [0.0, 0.0, 0.0]), body(&shape, [1.0, 0.02, 0.3])];
        let mut world = world(Surroundings::default().floor(1, 0.0), DOWN, bodies);
        world.settle(&Budget::default()).unwrap();
        for body in world.bodies() {
            let up = body.pose.rotation.apply(Vector([0.0, 1.0, 0.0]))[1];
            let low = mesh.positions.iter().map(|p| body.pose.apply(*p)[1]).fold(f64::INFINITY, f64::min);
            assert!(up > 0.998, "{sides} sides, {height} high: leans {up}");
            assert!(low.abs() < 0.015, "{sides} sides, {height} high: stands at {low}");
        }
    }
}
