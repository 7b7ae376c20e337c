//! Named graphs from lines to samples, to edges, to strokes; and random ones, and edge assignment against brute force.

use std::sync::Arc;

use arabesque_core::{
    Bounds, Budget, Curve, Domain, Drawn, Exemplar, Matrix, Measured, Numbered, Path, Request, Vector,
};
use proptest::prelude::*;

use crate::{
    border::Extent,
    curves::{
        draw::{chains::chains, shape::strokes as draw},
        repair::crossings::EdgeRules,
        votes::{edge_votes::collect_votes, edges},
    },
    exemplar::{
        graph::{
            net::{Net, Node},
            skeleton::{Knot, Skeleton},
        },
        level_exemplar::level_exemplars,
    },
    output::{
        draft::{Draft, Item},
        state::State,
    },
    params::{Deform, Params},
};

const SIDE: f64 = 100.0;

fn window() -> Bounds<2> {
    Bounds::new(Vector::ZERO, Vector::xy(SIDE, SIDE))
}

fn polyline(points: &[(f64, f64)], closed: bool) -> Path<2> {
    let mut points: Vec<_> = points.iter().map(|&(x, y)| Vector::xy(x, y)).collect();
    if closed {
        points.push(points[0]);
    }
    Path { closed, ..Path::polyline(&points) }
}

fn exemplar(paths: &[Path<2>]) -> Exemplar<2> {
    let curve = |path: &Path<2>| Curve { path: path.clone(), style: 0, width: 0.5, colour: [0.0; 3] };
    let styles = vec![arabesque_core::Class { name: "line".into() }];
    let curves = paths.iter().map(curve).collect();
    Exemplar::with_curves(
        "t",
        arabesque_core::Contents { curves, styles, ..arabesque_core::Contents::default() },
        window(),
    )
    .unwrap()
}

/// What came of a sample graph.
struct Rebuilt {
    net: Arc<Net<2>>,
    strokes: Vec<Drawn<2>>,
}

/// Samples the paths, puts every sample where it is in the exemplar, lets the edges be found, and hands this state on.
fn with_state<R>(paths: &[Path<2>], work: impl FnOnce(State<'_, 2>) -> R) -> R {
    let exemplar = exemplar(paths);
    let params = Params { levels: 1, ..Params::default() };
    let skeleton = Arc::new(Skeleton::new(&exemplar.curves, &exemplar.view(), &Budget::default()).unwrap());
    let sampled = level_exemplars(&std::sync::Arc::new(exemplar.clone()), Some(&skeleton), &params, &Budget::default());
    let sampled = sampled.unwrap().remove(0);
    let request = Request::new(Domain::Box(window().grown(SIDE)));
    let extent = Extent::new(&request, &sampled.exemplar, &sampled.library, sampled.level.base).unwrap();
    let net = sampled.level.net.clone().unwrap();
    let items = (0..net.nodes.len()).map(|n| {
        let item = Item { source: sampled.level.base + n as u32, position: net.nodes[n].position, frozen: None };
        (item, Matrix::identity())
    });
    let draft = Draft { items: items.collect(), links: Vec::new() };
    let mut state = State::new(&sampled, &request, &extent, Deform::Rigid, &draft);
    edges::link_sources(&mut state).unwrap();
    work(state)
}

/// The edges of all samples, sorted.
fn links(state: &State<'_, 2>) -> Numbered<Vec<u32>> {
    let sorted = |s: u32| {
        let mut l = state.links_of(s).to_vec();
        l.sort_unstable();
        l
    };
    state.samples().numbers().map(sorted).collect()
}

/// The edges of all nodes of the exemplar, sorted.
fn arms(net: &Net<2>) -> Vec<Vec<u32>> {
    let of = |node: &Node<2>| {
        let mut to: Vec<u32> = node.arms.iter().map(|arm| arm.to).collect();
        to.sort_unstable();
        to
    };
    net.nodes.iter().map(of).collect()
}

/// The paths again, from their samples.
fn rebuilt(paths: &[Path<2>]) -> Rebuilt {
    with_state(paths, |state| {
        let net = state.level.net.clone().unwrap();
        assert_eq!(links(&state), arms(&net).into());
        let votes = collect_votes(&state).unwrap();
        let chains = chains(&state, &votes, true).unwrap();
        let strokes = draw(&state, &chains).unwrap();
        Rebuilt { net, strokes }
    })
}

impl Rebuilt {
    /// Degrees of the knots of a kind, sorted.
    fn degrees(&self, kind: Knot) -> Vec<usize> {
        let of_kind = |n: &usize| self.net.nodes[*n].knot == Some(kind);
        let mut degrees: Vec<_> =
            (0..self.net.nodes.len()).filter(of_kind).map(|n| self.net.degree(n as u32)).collect();
        degrees.sort_unstable();
        degrees
    }

    fn closed(&self) -> usize {
        self.strokes.iter().filter(|s| s.path.closed).count()
    }
}

fn points(paths: &[Path<2>]) -> Vec<Vector<2>> {
    let dense = |path: &Path<2>| -> Vec<Vector<2>> {
        let measured = Measured::new(path.clone(), 0.01);
        let n = (measured.length() / 0.1).ceil() as usize;
        (0..=n).map(|k| measured.point(measured.length() * k as f64 / n as f64)).collect()
    };
    paths.iter().flat_map(dense).collect()
}

/// Hausdorff distance of two drawings, up to the 0.05 by which points lie apart.
fn hausdorff(a: &[Path<2>], b: &[Path<2>]) -> f64 {
    let (a, b) = (points(a), points(b));
    let one = |a: &[Vector<2>], b: &[Vector<2>]| {
        let nearest = |p: &Vector<2>| b.iter().map(|q| (*p - *q).norm2()).fold(f64::INFINITY, f64::min);
        a.iter().map(nearest).fold(0.0, f64::max).sqrt()
    };
    one(&a, &b).max(one(&b, &a))
}

fn drawn(rebuilt: &Rebuilt) -> Vec<Path<2>> {
    rebuilt.strokes.iter().map(|s| s.path.clone()).collect()
}

/// Rebuilds and compares the shape: what is drawn is the exemplar's own line, so that only rounding and sampling of
/// this test may differ.
fn same_shape(paths: &[Path<2>]) -> Rebuilt {
    let rebuilt = rebuilt(paths);
    let distance = hausdorff(&drawn(&rebuilt), paths);
    assert!(distance < 0.1, "{distance}");
    rebuilt
}

#[test]
fn a_straight_line_is_one_stroke_with_two_ends() {
    let line = same_shape(&[polyline(&[(20.0, 50.0), (80.0, 50.0)], false)]);
    assert_eq!((line.strokes.len(), line.closed()), (1, 0));
    assert_eq!((line.degrees(Knot::End), line.degrees(Knot::Junction)), (vec![1, 1], vec![]));
}

#[test]
fn a_line_from_side_to_side_has_no_ends() {
    let line = same_shape(&[polyline(&[(0.0, 50.0), (100.0, 50.0)], false)]);
    assert_eq!((line.degrees(Knot::End), line.degrees(Knot::Cut)), (vec![], vec![2, 2]));
}

#[test]
fn lines_that_meet_on_the_frame_may_cross_there() {
    // Drawn as two lines, as one line with a corner, and as the corner of a closed one.
    let (a, top, b) = ((30.0, 40.0), (50.0, 0.0), (70.0, 40.0));
    let two = [polyline(&[a, top], false), polyline(&[top, b], false)];
    let one = [polyline(&[a, top, b], false)];
    for paths in [&two[..], &one[..]] {
        let tent = rebuilt(paths);
        assert_eq!((tent.degrees(Knot::Cut), tent.degrees(Knot::End)), (vec![4], vec![1, 1]));
        assert_eq!((tent.degrees(Knot::Corner), tent.degrees(Knot::Junction)), (vec![], vec![]));
    }
    let closed = rebuilt(&[polyline(&[a, top, b], true)]);
    assert_eq!((closed.degrees(Knot::Cut), closed.degrees(Knot::Corner)), (vec![4], vec![2, 2]));
    let inner = rebuilt(&[polyline(&[a, (50.0, 1.0), b], false)]);
    assert_eq!((inner.degrees(Knot::Cut), inner.degrees(Knot::Corner)), (vec![], vec![2]));
}

#[test]
fn a_tee_is_two_strokes_that_meet() {
    let bar = polyline(&[(20.0, 40.0), (80.0, 40.0)], false);
    let tee = same_shape(&[bar, polyline(&[(50.0, 40.0), (50.0, 80.0)], false)]);
    assert_eq!((tee.strokes.len(), tee.closed()), (2, 0));
    assert_eq!((tee.degrees(Knot::End), tee.degrees(Knot::Junction)), (vec![1, 1, 1], vec![3]));
}

#[test]
fn a_cross_is_two_strokes_through_each_other() {
    let bar = polyline(&[(20.0, 40.0), (80.0, 45.0)], false);
    let cross = same_shape(&[bar, polyline(&[(55.0, 20.0), (45.0, 80.0)], false)]);
    assert_eq!((cross.strokes.len(), cross.closed()), (2, 0));
    assert_eq!((cross.degrees(Knot::End), cross.degrees(Knot::Junction)), (vec![1; 4], vec![4]));
}

#[test]
fn a_hexagon_is_one_closed_stroke_with_six_corners() {
    let corner = |k: u32| (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos();
    let corners: Vec<_> = (0..6).map(corner).map(|(s, c)| (50.0 + 30.0 * c, 50.0 + 30.0 * s)).collect();
    let cell = same_shape(&[polyline(&corners, true)]);
    assert_eq!((cell.strokes.len(), cell.closed()), (1, 1));
    assert_eq!(cell.degrees(Knot::Corner), vec![2; 6]);
    assert_eq!((cell.degrees(Knot::End), cell.degrees(Knot::Junction)), (vec![], vec![]));
    for (x, y) in corners {
        let near = |p: &Vector<2>| (*p - Vector::xy(x, y)).norm() < 1e-6;
        assert!(cell.strokes[0].path.cubics.iter().any(|c| near(&c[0])), "no node at the corner {x}, {y}");
    }
}

fn circle(x: f64, y: f64, r: f64) -> Path<2> {
    let k = 0.552_284_75 * r;
    let at = |dx: f64, dy: f64| Vector::xy(x + dx, y + dy);
    let quarter = |a: (f64, f64)| {
        let b = (-a.1, a.0);
        [
            at(r * a.0, r * a.1),
            at(r * a.0 + k * b.0, r * a.1 + k * b.1),
            at(r * b.0 + k * a.0, r * b.1 + k * a.1),
            at(r * b.0, r * b.1),
        ]
    };
    Path { cubics: [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)].map(quarter).to_vec(), closed: true }
}

#[test]
fn a_circle_is_one_closed_stroke_without_corners() {
    let ring = same_shape(&[circle(50.0, 50.0, 30.0)]);
    assert_eq!((ring.strokes.len(), ring.closed()), (1, 1));
    assert!(ring.net.skeleton.knots.is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Rows that wave at random, columns from some of them down (T junctions) or through all (crossings), and loops
    /// between: paths, junctions and ends come back, within 0.02 sampling distances. Each edge is the very piece of
    /// line that was sampled; only the handles at a sample are turned to their mean direction, which on a smooth line
    /// changes little.
    #[test]
    fn random_graphs_come_back(
        waves in prop::collection::vec((-4.0..4.0_f64, -4.0..4.0_f64), 3),
        columns in prop::collection::vec((any::<bool>(), -2.0..2.0_f64), 2),
        radius in 3.0..6.0_f64,
    ) {
        let row = |k: usize, (a, b): (f64, f64)| {
            let y = 22.0 + 25.0 * k as f64;
            let control = [(10.0, 0.0), (35.0, a), (65.0, b), (90.0, 0.0)];
            Path { closed: false, cubics: vec![control.map(|(x, d)| Vector::xy(x, y + d))] }
        };
        let mut paths: Vec<_> = waves.iter().enumerate().map(|(k, w)| row(k, *w)).collect();
        let first = Measured::new(paths[0].clone(), 1e-4);
        for (k, &(through, lean)) in columns.iter().enumerate() {
            let top = first.point(first.length() * (0.3 + 0.4 * k as f64));
            let start = if through { top - Vector::xy(0.0, 12.0) } else { top };
            paths.push(Path::polyline(&[start, Vector::xy(top[0] + lean, 90.0)]));
        }
        paths.push(circle(50.0, 34.0, radius));
        let rebuilt = rebuilt(&paths);
        prop_assert_eq!(rebuilt.strokes.len(), paths.len());
        prop_assert_eq!(rebuilt.closed(), 1);
        let through = columns.iter().filter(|c| c.0).count();
        prop_assert_eq!(rebuilt.degrees(Knot::End).len(), 2 * 3 + 2 + through);
        let tees = columns.len() - through;
        let expected = [vec![3; tees], vec![4; 3 * columns.len() - tees]].concat();
        prop_assert_eq!(rebuilt.degrees(Knot::Junction), expected);
        let distance = hausdorff(&drawn(&rebuilt), &paths);
        prop_assert!(distance < 0.1 + 0.02 * rebuilt.net.spacing, "{} of {}", distance, rebuilt.net.spacing);
    }
}

#[test]
fn edges_side_by_side_become_one_line() {
    // Besides the edges of a line, one from each sample to the second next.
    with_state(&[polyline(&[(5.0, 50.0), (95.0, 50.0)], false)], |mut state| {
        let (net, votes) = (state.level.net.clone().unwrap(), collect_votes(&state).unwrap());
        let known = links(&state);
        for s in known.numbers() {
            for &next in &known[s] {
                for &o in known[next].iter().filter(|&&o| o > s) {
                    state.link(s, o);
                }
            }
        }
        assert_ne!(links(&state), known);
        assert!(EdgeRules::of(&net, &Budget::default()).unwrap().restore(&mut state, &votes).unwrap() > 0);
        assert_eq!(links(&state), known);
    });
}

#[test]
fn of_edges_that_cross_the_longer_one_goes_where_nobody_voted() {
    let lines = [polyline(&[(5.0, 45.0), (95.0, 45.0)], false), polyline(&[(5.0, 50.0), (95.0, 50.0)], false)];
    with_state(&lines, |mut state| {
        let (net, votes) = (state.level.net.clone().unwrap(), collect_votes(&state).unwrap());
        let known = links(&state);
        // From a sample of one line to a sample of the other that is not the opposite one, and the other way round.
        let row = |y: f64| {
            let mut row: Vec<u32> =
                state.living().iter().copied().filter(|&s| (state.sample(s).position[1] - y).abs() < 0.1).collect();
            row.sort_by(|a, b| state.sample(*a).position[0].total_cmp(&state.sample(*b).position[0]));
            row
        };
        let (low, high) = (row(45.0), row(50.0));
        for (a, b) in [(low[3], high[4]), (low[5], high[3])] {
            assert_eq!(
                EdgeRules::of(&net, &Budget::default()).unwrap().allow(&state, a, b),
                (a, b) == (low[3], high[4])
            );
            state.link(a, b);
        }
        assert!(EdgeRules::of(&net, &Budget::default()).unwrap().restore(&mut state, &votes).unwrap() > 0);
        let left = links(&state);
        assert!(left[low[3]].contains(&high[4]) && !left[low[5]].contains(&high[3]));
        assert_eq!(left.iter().map(Vec::len).sum::<usize>(), known.iter().map(Vec::len).sum::<usize>() + 2);
    });
}

#[test]
fn what_the_exemplar_does_is_left_as_it_is() {
    let narrow = [polyline(&[(5.0, 50.0), (95.0, 50.0)], false), polyline(&[(50.0, 50.0), (95.0, 58.0)], false)];
    let cross = [polyline(&[(5.0, 50.0), (95.0, 50.0)], false), polyline(&[(50.0, 5.0), (50.0, 95.0)], false)];
    for paths in [narrow, cross] {
        with_state(&paths, |mut state| {
            let (net, votes) = (state.level.net.clone().unwrap(), collect_votes(&state).unwrap());
            let known = links(&state);
            assert_eq!(EdgeRules::of(&net, &Budget::default()).unwrap().restore(&mut state, &votes).unwrap(), 0);
            assert_eq!(links(&state), known);
        });
    }
}
