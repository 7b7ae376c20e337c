//! Elements with a volume.

#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use std::sync::Arc;

use arabesque_core::{
    Border, Bounds, Budget, Class, Domain, Element, Exemplar, Grid, Outcome, Outline, Request, Role, Similarity, Solid,
    Stage, Stream, Unobserved, Vector,
};
use arabesque_patterns::{Params, Prepared, Switch};

const RADIUS: f64 = 0.45;

/// A ball whose distances are known.
fn ball() -> Solid<3> {
    let bounds = Bounds::new(Vector::splat(-RADIUS), Vector::splat(RADIUS));
    let around = bounds.grown(0.3);
    let mut distance = Grid { bounds: around, nodes: [21; 3], values: vec![0.0; 21 * 21 * 21] };
    distance.values = (0..distance.values.len()).map(|n| RADIUS - distance.node(n).norm()).collect();
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let point = |k: u32| {
        let y = 1.0 - (f64::from(k) + 0.5) / 32.0;
        let (sin, cos) = (golden * f64::from(k)).sin_cos();
        let across = (1.0 - y * y).max(0.0).sqrt();
        Vector([across * cos, y, across * sin]) * RADIUS
    };
    Solid::new(distance, bounds, (0..64).map(point).collect(), Vector::ZERO)
}

/// A loose lattice of balls that do not touch.
fn exemplar() -> Exemplar<3> {
    let solid = Arc::new(ball());
    let mut stream = Stream::new(4, Stage::TEST, 0);
    let mut element = |k: u32| {
        let place = [k % 5, k / 5 % 5, k / 25].map(|n| f64::from(n) + 0.5 + stream.range(-0.04, 0.04));
        let pose = Similarity::shift(Vector(place));
        Element {
            class: 0,
            centre: Vector(place),
            pose,
            outline: Outline { rings: vec![solid.points.iter().map(|p| pose.apply(*p)).collect()] },
            colour: [0.0; 3],
            lean: [Vector::ZERO; 3],
            role: Role::Source,
        }
    };
    let elements: Vec<_> = (0..125).map(&mut element).collect();
    let window = Bounds::new(Vector::ZERO, Vector::splat(5.0));
    let mut exemplar = Exemplar::new("t", elements, vec![Class { name: "ball".into() }], window).unwrap();
    exemplar.solids = vec![solid; exemplar.elements.len()];
    exemplar
}

fn filled(seed: u64, border: Border) -> Outcome<3> {
    let prepared = Prepared::new(exemplar(), &Params::default(), &Budget::default()).unwrap();
    let mut request = Request::new(Domain::Box(Bounds::new(Vector::ZERO, Vector([7.3, 6.1, 6.6]))));
    (request.seed, request.border) = (seed, border);
    prepared.run(&request, &mut Unobserved).unwrap()
}

#[test]
fn depths_in_a_ball_are_told_between_the_nodes() {
    let ball = ball();
    for p in [[0.1, 0.2, -0.1], [0.3, -0.2, 0.15], [0.0, 0.5, 0.1]] {
        let p = Vector(p);
        assert!((ball.depth(p) - (RADIUS - p.norm())).abs() < 0.02, "{p:?}");
        assert!(ball.outwards(p).dot(p.unit_or_zero()) > 0.98, "{p:?}");
    }
    assert_eq!(ball.depth(Vector::splat(3.0)), f64::NEG_INFINITY);
    assert!((ball.inradius() - RADIUS).abs() < 0.01 && (ball.radius() - RADIUS).abs() < 1e-9);
}

#[test]
fn balls_lie_apart_and_are_as_many_as_there_should_be() {
    for seed in 0..2 {
        let outcome = filled(seed, Border::Cross);
        let centres: Vec<_> = outcome.placements.iter().map(|p| p.transform.apply(centre(p.source))).collect();
        let expected = 7.3 * 6.1 * 6.6;
        let count = centres.len() as f64;
        assert!((0.9 * expected..1.05 * expected).contains(&count), "{count} for {expected:.0}");
        let deepest = centres
            .iter()
            .enumerate()
            .flat_map(|(i, a)| centres[..i].iter().map(move |b| 2.0 * RADIUS - (*a - *b).norm()).collect::<Vec<_>>());
        let deepest = deepest.fold(0.0, f64::max);
        assert!(deepest < 0.15 * RADIUS, "{deepest}");
    }
}

#[test]
fn whole_balls_lie_inside_where_the_border_wants_it() {
    let outcome = filled(1, Border::Inside);
    assert!(outcome.placements.len() > 150, "{}", outcome.placements.len());
    for placement in &outcome.placements {
        let c = placement.transform.apply(centre(placement.source));
        let room = (0..3).map(|k| c[k].min([7.3, 6.1, 6.6][k] - c[k])).fold(f64::INFINITY, f64::min);
        assert!(room > 0.95 * RADIUS, "{room}");
    }
}

/// Balls at random that hardly touch, as many as found a place in 3000 tries.
fn strewn() -> Exemplar<3> {
    let mut exemplar = exemplar();
    let (solid, example) = (exemplar.solids[0].clone(), exemplar.elements[0].clone());
    let mut stream = Stream::new(9, Stage::TEST, 0);
    let mut centres: Vec<Vector<3>> = Vec::new();
    for _ in 0..3000 {
        let p = Vector(std::array::from_fn(|_| stream.range(0.0, 5.0)));
        if centres.iter().all(|c| (*c - p).norm() > 1.98 * RADIUS) {
            centres.push(p);
        }
    }
    let element = |p: &Vector<3>| {
        let pose = Similarity::shift(*p);
        let outline = Outline { rings: vec![solid.points.iter().map(|q| pose.apply(*q)).collect()] };
        Element { centre: *p, pose, outline, ..example.clone() }
    };
    exemplar.elements = centres.iter().map(element).collect();
    exemplar.solids = vec![solid.clone(); exemplar.elements.len()];
    exemplar
}

/// The largest empty balls at random places of the inner part of a box: the radius that one in a hundred exceeds.
fn emptiness(centres: &[Vector<3>], size: f64) -> f64 {
    let mut stream = Stream::new(3, Stage::TEST, 0);
    let room = |p: Vector<3>| centres.iter().map(|c| (*c - p).norm() - RADIUS).fold(f64::INFINITY, f64::min);
    let mut all: Vec<f64> =
        (0..20_000).map(|_| room(Vector(std::array::from_fn(|_| stream.range(1.0, size - 1.0))))).collect();
    all.sort_by(f64::total_cmp);
    all[all.len() * 99 / 100]
}

#[test]
fn voids_that_the_exemplar_does_not_have_are_closed() {
    let exemplar = strewn();
    let own: Vec<_> = exemplar.elements.iter().map(|e| e.centre).collect();
    let made = |even: Switch, seed: u64| {
        let params = Params { even, ..Params::default() };
        let prepared = Prepared::new(exemplar.clone(), &params, &Budget::default()).unwrap();
        let mut request = Request::new(Domain::Box(Bounds::new(Vector::ZERO, Vector::splat(6.5))));
        request.seed = seed;
        let outcome = prepared.run(&request, &mut Unobserved).unwrap();
        let centres: Vec<_> = outcome.placements.iter().map(|p| p.transform.apply(own[p.source])).collect();
        emptiness(&centres, 6.5)
    };
    let natural = emptiness(&own, 5.0);
    for seed in 0..2 {
        let (without, with) = (made(Switch::Off, seed), made(Switch::On, seed));
        assert!(with < without && with < 1.15 * natural, "seed {seed}: {without} without, {with} with, {natural}");
    }
}

/// Where an element lies in the exemplar.
fn centre(source: usize) -> Vector<3> {
    exemplar().elements[source].centre
}
