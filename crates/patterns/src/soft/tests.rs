use std::sync::Arc;

use arabesque_core::{
    Border, Bounds, Budget, Build, Class, Domain, Element, Error, Exemplar, Limits, Matrix, Outcome, Outline,
    Placement, Region, Request, Role, Similarity, Soft, Unobserved, Vector, polyline_length,
};

use super::{bodies::nearest, wall::middles};
use crate::{Params, Prepared};

const RADIUS: f64 = 0.1;
const SAMPLES: usize = 12;

/// Waves side by side in layers, every second one from the other end.
fn strands() -> Exemplar<3> {
    let strand = |n: u32| {
        let (row, column) = (f64::from(n % 7), f64::from(n / 7));
        let at = |k: usize| {
            let x = 3.0 * k as f64 / (SAMPLES - 1) as f64;
            let phase = 0.9 * f64::from(n);
            Vector([
                x + 0.7 * (n % 3) as f64,
                0.35 * row + 0.06 * (2.0 * x + phase).sin(),
                0.35 * column + 0.06 * (2.0 * x + phase).cos(),
            ])
        };
        let mut samples: Vec<_> = (0..SAMPLES).map(at).collect();
        if n % 2 == 1 {
            samples.reverse();
        }
        samples
    };
    exemplar((0..49).map(|n| (Build::Strand, strand(n), RADIUS)).collect())
}

fn exemplar(list: Vec<(Build, Vec<Vector<3>>, f64)>) -> Exemplar<3> {
    let softs: Vec<_> = list
        .into_iter()
        .map(|(build, samples, r)| Arc::new(Soft { build, radii: vec![r; samples.len()], samples }))
        .collect();
    let element = |soft: &Arc<Soft<3>>| Element {
        class: usize::from(soft.build == Build::Rigid),
        centre: soft.middle(&soft.samples),
        pose: Similarity::identity(),
        outline: Outline::default(),
        colour: [0.0; 3],
        lean: [Vector::ZERO; 3],
        role: Role::Source,
    };
    let classes = ["strand", "ball"].map(|name| Class { name: name.into() }).to_vec();
    let window = Bounds::new(Vector([1.0, -0.2, -0.2]), Vector([3.7, 2.3, 2.3]));
    let mut exemplar = Exemplar::new("t", softs.iter().map(element).collect(), classes, window).unwrap();
    exemplar.softs = softs;
    exemplar
}

fn request(min: [f64; 3], side: f64) -> Request<3> {
    let min = Vector(min);
    let mut request = Request::new(Domain::Box(Bounds::new(min, min + Vector::splat(side))));
    request.border = Border::Cross;
    request
}

fn run(exemplar: &Exemplar<3>, request: &Request<3>) -> Outcome<3> {
    let prepared = Prepared::new(exemplar.clone(), &Params::default(), &Budget::default()).unwrap();
    prepared.run(request, &mut Unobserved).unwrap()
}

fn source_of(exemplar: &Exemplar<3>, placement: &Placement<3>) -> Vec<Vector<3>> {
    exemplar.softs[placement.source].samples.clone()
}

fn line(placement: &Placement<3>) -> Vec<Vector<3>> {
    placement.control.iter().map(|(_, to)| *to).collect()
}

/// Smallest distance of the lines of two different elements.
fn closest(placements: &[Placement<3>]) -> f64 {
    let lines: Vec<_> = placements.iter().map(line).collect();
    let mut least = f64::INFINITY;
    for (n, a) in lines.iter().enumerate() {
        for (s, t) in lines[n + 1..].iter().flat_map(|b| b.windows(2)).flat_map(|t| a.windows(2).map(move |s| (s, t))) {
            let (s, t) = ([s[0], s[1]], [t[0], t[1]]);
            let [x, y] = nearest(s, t);
            least = least.min((s[0] + (s[1] - s[0]) * x - t[0] - (t[1] - t[0]) * y).norm());
        }
    }
    least
}

#[test]
fn strands_fill_a_box_keep_their_length_and_do_not_touch() {
    let exemplar = strands();
    for seed in 0..3 {
        let request = Request { seed, ..request([0.0; 3], 3.0) };
        let outcome = run(&exemplar, &request);
        let expected = 49.0 / exemplar.window.measure() * 27.0;
        let count = outcome.placements.len() as f64;
        assert!((count / expected - 1.0).abs() < 0.15, "seed {seed}: {count} of {expected}");
        for placement in &outcome.placements {
            let own = &exemplar.softs[placement.source].samples;
            let to = line(placement);
            assert!((polyline_length(&to) / polyline_length(own) - 1.0).abs() < 0.02);
            assert!(request.domain.contains((to[5] + to[6]) * 0.5));
        }
        let apart = closest(&outcome.placements);
        assert!(apart > 1.8 * RADIUS, "seed {seed}: {apart}");
    }
}

#[test]
fn every_run_gives_the_same_and_a_domain_elsewhere_as_much() {
    let exemplar = strands();
    let here = run(&exemplar, &request([0.0; 3], 2.0));
    assert_eq!(here.placements, run(&exemplar, &request([0.0; 3], 2.0)).placements);
    let there = run(&exemplar, &request([64.0, -32.0, 16.0], 2.0)).placements.len() as f64;
    assert!((there / here.placements.len() as f64 - 1.0).abs() < 0.2, "{there}");
}

/// A ball as a region.
#[derive(Debug)]
struct Ball(f64);

impl Region<3> for Ball {
    fn bounds(&self) -> Bounds<3> {
        Bounds::new(Vector::splat(-self.0), Vector::splat(self.0))
    }

    fn measure(&self) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * self.0.powi(3)
    }

    fn signed_distance(&self, p: Vector<3>) -> f64 {
        self.0 - p.norm()
    }

    fn nearest_boundary(&self, p: Vector<3>) -> Vector<3> {
        p.unit_or_zero() * self.0
    }
}

#[test]
fn in_a_ball_strands_go_along_the_wall_and_lie_inside() {
    let mut request = Request::new(Domain::Region(Arc::new(Ball(2.0))));
    request.border = Border::Inside;
    let outcome = run(&strands(), &request);
    assert!(outcome.placements.len() > 20, "{}", outcome.placements.len());
    for placement in &outcome.placements {
        // The smooth line through the samples, and a skin of six sides around it.
        let to = line(placement);
        assert!(to.iter().copied().chain(middles(&to)).all(|p| p.norm() <= 2.0 - 1.09 * RADIUS));
        let own = polyline_length(&source_of(&strands(), placement));
        assert!((polyline_length(&to) / own - 1.0).abs() < 1e-6);
    }
}

#[test]
fn a_field_turns_strands() {
    let mut request = request([0.0; 3], 3.0);
    let turn = Matrix([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]);
    request.fields.orientation = Some(arabesque_core::OrientationField::Constant(turn));
    let outcome = run(&strands(), &request);
    for placement in &outcome.placements {
        let line = line(placement);
        let way = (line[SAMPLES - 1] - line[0]).unit();
        assert!(way[2].abs() > 0.9, "{way:?}");
    }
}

#[test]
fn what_is_kept_stays_and_keeps_others_away() {
    let exemplar = strands();
    let mut request = request([0.0; 3], 2.0);
    let shift = Vector([-1.0, 1.0, 1.0]);
    let kept = Placement { source: 3, transform: Similarity::shift(shift), control: Vec::new(), frozen: None };
    request.frozen = vec![kept.clone()];
    let outcome = run(&exemplar, &request);
    let frozen: Vec<_> = outcome.placements.iter().filter(|p| p.frozen.is_some()).collect();
    assert_eq!(frozen.len(), 1);
    assert_eq!(frozen[0].transform, kept.transform);
}

#[test]
fn what_does_not_bend_keeps_its_shape_beside_what_does() {
    let ball = |n: u32| {
        let middle = Vector([1.2 + f64::from(n), 1.0, 0.5 + 0.3 * f64::from(n)]);
        (Build::Rigid, vec![middle, middle + Vector([0.2, 0.0, 0.0])], 0.2)
    };
    let mut list: Vec<_> = strands().softs.iter().map(|s| (s.build, s.samples.clone(), RADIUS)).step_by(2).collect();
    list.extend((0..3).map(ball));
    let outcome = run(&exemplar(list.clone()), &request([0.0; 3], 3.0));
    let rigid: Vec<_> = outcome.placements.iter().filter(|p| list[p.source].0 == Build::Rigid).collect();
    assert!(!rigid.is_empty());
    for placement in rigid {
        let to = line(placement);
        assert!(((to[1] - to[0]).norm() - 0.2).abs() < 1e-9);
    }
}

#[test]
fn work_without_end_is_stopped() {
    let budget = Budget::new(Limits { work: 1, work_per_element: 0, ..Limits::default() });
    let exemplar = strands();
    let prepared = Prepared::new(exemplar, &Params::default(), &Budget::default()).unwrap();
    let request = Request { budget, ..request([0.0; 3], 20.0) };
    match prepared.run(&request, &mut Unobserved) {
        Ok(outcome) => assert_eq!(outcome.stopped, arabesque_core::StopReason::Limit),
        Err(error) => assert!(matches!(error, Error::Limit { .. }), "{error}"),
    }
}
