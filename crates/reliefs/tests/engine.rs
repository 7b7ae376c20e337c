//! Whole runs: what comes out, whatever the ground, and what is refused.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, its helpers too")]

use std::{f64::consts::TAU, ops::ControlFlow, sync::Arc};

use arabesque_core::{
    Bounds, Budget, Error, Limits, PointSet, Progress, Stage, StopReason, Stream, TriangleMesh, Unobserved, Vector,
    Watch,
};
use arabesque_reliefs::{Ground, Plane, Prepared, ReliefOutcome, ReliefParams, ReliefRequest};
use arabesque_surface::{DirectionField, Directions, MeshIndex};
use proptest::prelude::*;

const UP: Vector<3> = Vector([0.0, 0.0, 1.0]);

/// Bumps that differ a little, one apart, over a square of `side`; points a tenth apart where `keeps` holds.
fn bumps(side: f64, keeps: impl Fn(f64, f64) -> bool) -> PointSet<3> {
    let height = |x: f64, y: f64| 0.2 * (TAU * x).sin() * (TAU * y).sin() + 0.03 * (1.3 * x + 0.7 * y).sin();
    let n = (side * 12.0) as usize;
    let mut set = PointSet { normals: Some(Vec::new()), colours: Some(Vec::new()), ..PointSet::default() };
    for k in 0..n * n {
        let jitter = |m: usize| ((k * m % 97) as f64 / 97.0 - 0.5) * 0.03;
        let (x, y) = ((k % n) as f64 / 12.0 + jitter(31), (k / n) as f64 / 12.0 + jitter(57));
        if !keeps(x, y) {
            continue;
        }
        let e = 1e-5;
        let slope =
            [(height(x + e, y) - height(x - e, y)) / (2.0 * e), (height(x, y + e) - height(x, y - e)) / (2.0 * e)];
        set.positions.push(Vector([x, y, height(x, y)]));
        set.normals.as_mut().unwrap().push(Vector([-slope[0], -slope[1], 1.0]).unit());
        set.colours.as_mut().unwrap().push([if height(x, y) > 0.0 { 1.0 } else { 0.0 }, 0.5, 0.0]);
    }
    set
}

fn prepared(points: &PointSet<3>) -> Prepared {
    Prepared::new(points, None, &ReliefParams::default(), &Budget::default()).unwrap()
}

fn run(points: &PointSet<3>, ground: Ground, seed: u64) -> ReliefOutcome {
    let request = ReliefRequest { seed, ..ReliefRequest::new(ground) };
    prepared(points).run(&request, &mut Unobserved).unwrap()
}

/// The largest distance of a place of a rectangle from the nearest point, seen from above.
fn widest_gap(points: &[Vector<3>], low: [f64; 2], high: [f64; 2]) -> f64 {
    let steps = 60;
    let place = |k: usize| {
        [0, 1].map(|a| low[a] + (high[a] - low[a]) * ([k % steps, k / steps][a] as f64 + 0.5) / steps as f64)
    };
    let far = |[x, y]: [f64; 2]| points.iter().map(|p| (p[0] - x).hypot(p[1] - y)).fold(f64::INFINITY, f64::min);
    (0..steps * steps).map(|k| far(place(k))).fold(0.0, f64::max)
}

#[test]
fn the_plane_is_covered_as_densely_as_the_texture_and_on_its_surface() {
    let texture = bumps(5.0, |_, _| true);
    let made = run(&texture, Ground::Plane([8.0, 6.0]), 1);
    let points = &made.points;
    let density = points.len() as f64 / 48.0;
    assert!((density / 144.0 - 1.0).abs() < 0.08, "{density}");
    assert!(
        points
            .positions
            .iter()
            .all(|p| (0.0..=8.0).contains(&p[0]) && (0.0..=6.0).contains(&p[1]) && p[2].abs() < 0.26)
    );
    assert!(widest_gap(&points.positions, [0.0, 0.0], [8.0, 6.0]) < 0.16, "a hole");
    assert!(points.normals.as_ref().unwrap().iter().all(|n| (n.norm() - 1.0).abs() < 1e-9 && n[2] > 0.3));
    let colours = points.colours.as_ref().unwrap();
    let agree = colours.iter().zip(&points.positions).filter(|(c, p)| (c[0] > 0.5) == (p[2] > 0.0)).count();
    assert!(agree as f64 > 0.9 * points.len() as f64, "colours go with their points");
    assert_eq!(made.sources.len(), points.len());
    let s = made.statistics;
    assert!(s.patches > 8 && s.cracks + s.seams < s.overlapped / 50, "{s:?}");
}

#[test]
fn any_number_of_threads_gives_the_same_and_seeds_differ() {
    let texture = bumps(4.0, |_, _| true);
    let on = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&texture, Ground::Plane([6.0, 5.0]), seed).points)
    };
    let one = on(1, 3);
    assert!(on(2, 3) == one && on(8, 3) == one);
    assert!(on(2, 4) != one);
}

#[test]
fn a_tile_goes_on_at_its_borders() {
    let texture = bumps(5.0, |_, _| true);
    let made = run(&texture, Ground::Tile([6.0, 5.0]), 0);
    assert!(made.points.positions.iter().all(|p| (0.0..6.0).contains(&p[0]) && (0.0..5.0).contains(&p[1])));
    let mut twice = made.points.positions.clone();
    for (dx, dy) in [(6.0, 0.0), (0.0, 5.0), (6.0, 5.0)] {
        twice.extend(made.points.positions.iter().map(|&p| p + Vector([dx, dy, 0.0])));
    }
    assert!(widest_gap(&twice, [5.0, 1.0], [7.0, 9.0]) < 0.16 && widest_gap(&twice, [1.0, 4.0], [11.0, 6.0]) < 0.16);
    // Points that are close across the border are close in height too.
    let seam: Vec<_> = twice.iter().filter(|p| (p[0] - 6.0).abs() < 0.2 && p[1] > 0.5 && p[1] < 9.5).collect();
    for a in seam.iter().filter(|p| p[0] < 6.0) {
        for b in seam.iter().filter(|p| p[0] >= 6.0) {
            let apart = (a[0] - b[0]).hypot(a[1] - b[1]);
            assert!(apart > 0.08 || (a[2] - b[2]).abs() < 0.16, "a step of {} over {apart}", a[2] - b[2]);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn whatever_the_extent_it_is_covered_and_nothing_lies_beyond(
        size in [1.6_f64..4.0, 1.6_f64..4.0], seed in 0_u64..1000, is_tile in prop::bool::ANY, overlap in 0.1_f64..0.4,
    ) {
        let texture = bumps(3.5, |_, _| true);
        let params = ReliefParams { patch: Some(0.8), overlap: Some(overlap), ..ReliefParams::default() };
        let engine = Prepared::new(&texture, None, &params, &Budget::default()).unwrap();
        let ground = if is_tile { Ground::Tile(size) } else { Ground::Plane(size) };
        let made = engine.run(&ReliefRequest { seed, ..ReliefRequest::new(ground) }, &mut Unobserved).unwrap();
        let points = &made.points.positions;
        let beyond = points.iter().find(|p| !(0..2).all(|k| (0.0..=size[k]).contains(&p[k])) || p[2].abs() >= 0.35);
        prop_assert!(beyond.is_none(), "{beyond:?}");
        prop_assert!(widest_gap(points, [0.0, 0.0], size) < 0.25, "a hole");
        prop_assert!((points.len() as f64 / (size[0] * size[1]) / 144.0 - 1.0).abs() < 0.18, "{}", points.len());
        prop_assert!(made.sources.iter().all(|&i| i < texture.len()));
    }
}

/// Waves of all directions that are half as high as a patch is wide, over a square of 1.
fn hills() -> PointSet<3> {
    let waves: Vec<[f64; 3]> =
        (0..24).map(f64::from).map(|k: f64| [9.0 * (2.4 * k).cos(), 9.0 * (2.4 * k).sin(), 1.7 * k]).collect();
    let mut set = PointSet { normals: Some(Vec::new()), ..PointSet::default() };
    for k in 0..6400_u32 {
        let (x, y) = (f64::from(k % 80) / 80.0, f64::from(k / 80) / 80.0);
        let (mut z, mut slope) = (0.0, [0.0; 2]);
        for [a, b, c] in &waves {
            let (sin, cos) = (a * x + b * y + c).sin_cos();
            z += 0.025 * cos;
            slope = [slope[0] - 0.025 * a * sin, slope[1] - 0.025 * b * sin];
        }
        set.positions.push(Vector([x, y, z]));
        set.normals.as_mut().unwrap().push(Vector([-slope[0], -slope[1], 1.0]).unit());
    }
    set
}

#[test]
fn high_hills_meet_without_a_step() {
    let texture = hills();
    assert!(texture.bounds().size()[2] > 0.25, "{:?}", texture.bounds());
    let made = run(&texture, Ground::Plane([1.6, 1.6]), 1);
    let s = made.statistics;
    assert!(s.patches > 8 && (s.cracks + s.seams) * 50 < s.overlapped, "{s:?}");
    // No point is far above or below those beside it.
    let points = &made.points.positions;
    for a in points.iter().step_by(23) {
        for b in points {
            let apart = (a[0] - b[0]).hypot(a[1] - b[1]);
            assert!(apart > 0.012 || (a[2] - b[2]).abs() < 0.08, "a step of {} over {apart}", a[2] - b[2]);
        }
    }
}

#[test]
fn a_gap_is_filled_and_the_rest_stays() {
    let in_gap = |x: f64, y: f64| (x - 4.1).hypot(y - 3.4) < 0.8;
    let scan = bumps(8.0, |x, y| !in_gap(x, y));
    let prepared = Prepared::with_gap(&scan, None, &ReliefParams::default(), &Budget::default()).unwrap();
    let made = prepared.run(&ReliefRequest::new(Ground::Hole), &mut Unobserved).unwrap();
    assert!(widest_gap(&made.points.positions, [3.0, 2.4], [5.2, 4.4]) < 0.17, "the gap is open");
    let far = |p: &&Vector<3>| (p[0] - 4.1).hypot(p[1] - 3.4) > 2.2;
    let (before, after) = (scan.positions.iter().filter(far).count(), made.points.positions.iter().filter(far).count());
    assert_eq!(before, after);
    let expected = bumps(8.0, |_, _| true).len();
    assert!((made.points.len() as f64 / expected as f64 - 1.0).abs() < 0.02, "{} {expected}", made.points.len());
    let whole = Prepared::with_gap(&bumps(5.0, |_, _| true), None, &ReliefParams::default(), &Budget::default());
    assert!(whole.unwrap_err().to_string().contains("no gap"));
    let error = prepared_whole_run();
    assert!(error.contains("gap"), "{error}");
}

/// A texture that was prepared without its gap has none to fill.
fn prepared_whole_run() -> String {
    prepared(&bumps(4.0, |_, _| true)).run(&ReliefRequest::new(Ground::Hole), &mut Unobserved).unwrap_err().to_string()
}

/// A ball of radius 4.
fn ball() -> Arc<MeshIndex> {
    let (around, up) = (64, 32);
    let at = |k: usize| {
        let (a, b) = (TAU * (k % around) as f64 / around as f64, TAU * (0.25 - (k / around) as f64 / (2 * up) as f64));
        Vector([a.cos() * b.cos(), a.sin() * b.cos(), b.sin()]) * 4.0
    };
    let mut triangles = Vec::new();
    for j in 0..up {
        for i in 0..around {
            let v = |di: usize, dj: usize| ((j + dj) * around + (i + di) % around) as u32;
            triangles.extend([[v(0, 0), v(0, 1), v(1, 1)], [v(0, 0), v(1, 1), v(1, 0)]]);
        }
    }
    let positions = (0..around * (up + 1)).map(at).collect();
    let mesh = TriangleMesh { positions, triangles, ..TriangleMesh::default() };
    Arc::new(MeshIndex::new(&mesh, "ball", &Budget::default()).unwrap())
}

#[test]
fn a_mesh_is_covered_all_over_within_its_shell() {
    let mesh = ball();
    let field = DirectionField::new(&mesh, &Directions::Constant(UP), &Budget::default()).unwrap();
    let made = run(&bumps(5.0, |_, _| true), Ground::Mesh(Arc::clone(&mesh), Arc::new(field), 1.0), 2);
    let points = &made.points;
    assert!(points.positions.iter().all(|p| (p.norm() - 4.0).abs() < 0.35), "a point leaves the shell");
    let density = points.len() as f64 / mesh.area();
    assert!((density / 144.0 - 1.0).abs() < 0.15, "{density}");
    let normals = points.normals.as_ref().unwrap();
    assert!(points.positions.iter().zip(normals).all(|(p, n)| n.dot(p.unit()) > 0.0));
    for k in 0..400 {
        let z = 1.0 - (2.0 * f64::from(k) + 1.0) / 400.0;
        let (angle, r) = (2.4 * f64::from(k), (1.0 - z * z).sqrt());
        let place = Vector([r * angle.cos(), r * angle.sin(), z]) * 4.0;
        let nearest = points.positions.iter().map(|&p| (p - place).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest < 0.4, "nothing within {nearest} of {place:?}");
    }
}

/// Stops after some steps, and looks at the preview.
struct Impatient(usize);

impl Watch<PointSet<3>> for Impatient {
    fn step(&mut self, _: &Progress, preview: &dyn Fn() -> PointSet<3>) -> ControlFlow<()> {
        assert!(!preview().is_empty());
        self.0 -= 1;
        if self.0 == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn a_stop_gives_the_best_so_far_and_limits_are_kept() {
    let engine = prepared(&bumps(4.0, |_, _| true));
    let request = ReliefRequest::new(Ground::Plane([9.0, 9.0]));
    let made = engine.run(&request, &mut Impatient(3)).unwrap();
    assert!(made.stopped == StopReason::Stopped && made.statistics.patches == 3 && !made.points.is_empty());
    for n in [3, 30, 300] {
        let budget = Budget::stopping_at(Limits::default(), n);
        match engine.run(&ReliefRequest { budget, ..request.clone() }, &mut Unobserved) {
            Ok(made) => assert!(!made.points.is_empty()),
            Err(error) => assert!(matches!(error, Error::Stopped { .. }), "{error}"),
        }
    }
    let small = Budget::new(Limits { output_elements: 1000, ..Limits::default() });
    let error = engine.run(&ReliefRequest { budget: small, ..request }, &mut Unobserved).unwrap_err();
    assert!(matches!(error, Error::Limit { .. }), "{error}");
}

#[test]
fn what_is_no_texture_is_refused_with_what_to_do() {
    let refused = |points: &PointSet<3>, bounds: Option<Bounds<3>>, set: &[(&str, &str)]| {
        let mut params = ReliefParams::default();
        set.iter().for_each(|(name, value)| params.set(name, value).unwrap());
        Prepared::new(points, bounds, &params, &Budget::default()).unwrap_err().to_string()
    };
    let good = bumps(4.0, |_, _| true);
    let with = |change: &dyn Fn(&mut PointSet<3>)| {
        let mut points = good.clone();
        change(&mut points);
        points
    };
    let none = with(&|p| p.normals.as_mut().unwrap()[7] = Vector::ZERO);
    assert!(refused(&none, None, &[]).contains("1 of 2304 normals"), "{}", refused(&none, None, &[]));
    let mixed = with(&|p| p.normals.as_mut().unwrap().iter_mut().step_by(2).for_each(|n| *n = -*n));
    assert!(refused(&mixed, None, &[]).contains("opposite ways"));
    let halves = with(&|p| p.normals.as_mut().unwrap().iter_mut().take(1152).for_each(|n| *n = -*n));
    let told = |points: &PointSet<3>| prepared(points).warnings().iter().any(|w| w.message.contains("opposite ways"));
    assert!(told(&halves) && !told(&good));
    let nan = with(&|p| p.positions[3][1] = f64::NAN);
    assert!(refused(&nan, None, &[]).contains("point 4"));
    assert!(refused(&good.selected(&[0, 1, 2, 3]), None, &[]).contains("4 points"));
    assert!(refused(&good, None, &[("patch", "5")]).contains("patch"));
    assert!(refused(&good, None, &[("plane", "x")]).contains("--plane"));
    let large = Bounds::new(Vector([-1.0, 0.0, 0.0]), Vector([4.0, 4.0, 0.0]));
    assert!(refused(&good, Some(large), &[]).contains("within the points"));
    assert!(refused(&good, None, &[("cell", "0.000001")]).contains("cell"));
    let heap = PointSet::at(vec![Vector([1.0, 1.0, 1.0]); 100]);
    assert!(!refused(&heap, None, &[]).is_empty());
    let line = PointSet::at((0..100).map(|k| Vector([f64::from(k), 0.0, 0.0])).collect());
    assert!(!refused(&line, None, &[]).is_empty());
    let zero = prepared(&good).run(&ReliefRequest::new(Ground::Plane([0.0, 3.0])), &mut Unobserved).unwrap_err();
    assert!(zero.to_string().contains("extent"), "{zero}");
    let narrow = prepared(&good).run(&ReliefRequest::new(Ground::Tile([0.5, 3.0])), &mut Unobserved).unwrap_err();
    assert!(narrow.to_string().contains("a tile of at least"), "{narrow}");
}

#[test]
fn textures_may_stand_and_come_without_normals() {
    let lying = bumps(4.0, |_, _| true);
    let stand = |v: Vector<3>| Vector([v[2], v[0], v[1]]);
    let standing = PointSet {
        positions: lying.positions.iter().map(|&p| stand(p)).collect(),
        normals: lying.normals.as_ref().map(|n| n.iter().map(|&n| stand(n)).collect()),
        ..PointSet::default()
    };
    let engine = prepared(&standing);
    assert_eq!(engine.axes().across_axis(), 0);
    let made = engine.run(&ReliefRequest::new(Ground::Plane([5.0, 4.5])), &mut Unobserved).unwrap();
    let size = made.points.bounds().size();
    assert!(size[0] < 0.6 && (size[1] - 5.0).abs() < 0.2 && (size[2] - 4.5).abs() < 0.2, "{size:?}");
    let raw = PointSet::at(lying.positions.iter().copied().chain([Vector([2.0, 2.0, 0.5])]).collect());
    let engine = prepared(&raw);
    assert!(engine.warnings().iter().any(|w| w.message.contains("lie alone")) || engine.points() == raw.len());
    let made = engine.run(&ReliefRequest::new(Ground::Plane([4.0, 4.0])), &mut Unobserved).unwrap();
    let up = made.points.normals.as_ref().unwrap().iter().filter(|n| n[2] > 0.0).count();
    assert!(up * 100 > made.points.len() * 98, "{up} of {}", made.points.len());
    let params = ReliefParams { plane: Plane::Z, ..ReliefParams::default() };
    assert!(Prepared::new(&lying, None, &params, &Budget::default()).is_ok());
}

#[test]
fn patches_that_are_too_small_for_the_texture_are_told() {
    let warned = |patch: f64| {
        let params = ReliefParams { patch: Some(patch), ..ReliefParams::default() };
        let engine = Prepared::new(&bumps(3.5, |_, _| true), None, &params, &Budget::default()).unwrap();
        engine.warnings().iter().filter(|w| w.message.contains("smaller than this texture can tell apart")).count()
    };
    assert_eq!((warned(1e-6), warned(0.8)), (1, 0));
}

/// How far the scans below lean, in radians.
const LEAN: f64 = 0.4;

/// Turned about x.
fn turned(v: Vector<3>, radians: f64) -> Vector<3> {
    let (sin, cos) = radians.sin_cos();
    Vector([v[0], cos * v[1] - sin * v[2], sin * v[1] + cos * v[2]])
}

#[test]
fn scans_that_lean_lie_askew_or_are_round_are_laid_flat_without_their_corners() {
    let lying = bumps(6.0, |x, y| (x - 3.0).hypot(y - 3.0) < 2.9);
    let leaning = PointSet {
        positions: lying.positions.iter().map(|&p| turned(p, LEAN)).collect(),
        normals: lying.normals.as_ref().map(|n| n.iter().map(|&n| turned(n, LEAN)).collect()),
        ..PointSet::default()
    };
    let engine = prepared(&leaning);
    assert!((engine.axes().lean() - LEAN.to_degrees()).abs() < 1.0, "{}", engine.axes().lean());
    assert!(engine.warnings().iter().any(|w| w.message.contains("laid flat")), "{:?}", engine.warnings());
    let made = engine.run(&ReliefRequest::new(Ground::Plane([8.0, 6.0])), &mut Unobserved).unwrap();
    let gap = widest_gap(&made.points.positions, [0.2, 0.2], [7.8, 5.8]);
    assert!(made.points.bounds().size()[2] < 0.6 && gap < 0.25, "{gap}");
    // As it lies where the plane is named, and then told.
    let params = ReliefParams { plane: Plane::Z, ..ReliefParams::default() };
    let taken = Prepared::new(&leaning, None, &params, &Budget::default()).unwrap();
    assert!(taken.axes().lean() == 0.0 && taken.warnings().iter().any(|w| w.message.contains("leans by")));
}

#[test]
fn the_gap_of_a_scan_that_leans_is_filled_where_it_is() {
    let lying = bumps(6.0, |x, y| (x - 3.0).hypot(y - 3.0) > 0.7);
    let leaning = PointSet::at(lying.positions.iter().map(|&p| turned(p, LEAN)).collect());
    let engine = Prepared::with_gap(&leaning, None, &ReliefParams::default(), &Budget::default()).unwrap();
    let made = engine.run(&ReliefRequest::new(Ground::Hole), &mut Unobserved).unwrap();
    // Across the plane in which it leans.
    let flat: Vec<Vector<3>> = made.points.positions.iter().map(|&p| turned(p, -LEAN)).collect();
    assert!(flat.iter().all(|p| p[2].abs() < 0.35) && widest_gap(&flat, [2.0, 2.0], [4.0, 4.0]) < 0.2);
}

/// A wall of equal bricks in running bond, one long and half as high.
fn wall(keeps: impl Fn(f64, f64) -> bool) -> PointSet<3> {
    let mut random = Stream::new(8, Stage::TEST, 0);
    let mut points = PointSet::default();
    let (side, step) = (8.0, 0.06);
    for k in 0..133 * 133_u32 {
        let jitter = |random: &mut Stream| step * (0.5 + random.range(-0.3, 0.3));
        let (x, y) = (f64::from(k % 133) * step + jitter(&mut random), f64::from(k / 133) * step + jitter(&mut random));
        if x < side && y < side && keeps(x, y) {
            points.positions.push(Vector([x, y, brick(x, y)]));
        }
    }
    points.normals = Some(vec![Vector([0.0, 0.0, 1.0]); points.positions.len()]);
    points
}

/// The height of the wall.
fn brick(x: f64, y: f64) -> f64 {
    let row = (y / 0.5).floor();
    let (u, v) = ((x + 0.5 * row).rem_euclid(1.0), y.rem_euclid(0.5));
    let from_joint = u.min(1.0 - u).min(v).min(0.5 - v);
    0.2 * ((from_joint - 0.05) / 0.05).clamp(0.0, 1.0)
}

#[test]
fn a_gap_in_a_wall_is_closed_in_bond_and_by_the_seed() {
    let in_gap = |x: f64, y: f64| (2.3..5.9).contains(&x) && (2.6..5.1).contains(&y);
    let scan = wall(|x, y| !in_gap(x, y));
    let engine = Prepared::with_gap(&scan, None, &ReliefParams::default(), &Budget::default()).unwrap();
    let [a, b] = engine.repeat().expect("a wall of equal bricks repeats strictly");
    // Rows shift by half a brick: each shift leads to a joint of the same kind.
    for s in [a, b] {
        let rows = (s[1] / 0.5).round();
        let off = (s[0] - 0.5 * rows).rem_euclid(1.0);
        assert!((s[1] - 0.5 * rows).abs() < 0.02 && off.min(1.0 - off) < 0.02, "{a:?} {b:?}");
    }
    let closed = |seed: u64| {
        let made = engine.run(&ReliefRequest { seed, ..ReliefRequest::new(Ground::Hole) }, &mut Unobserved).unwrap();
        let filled: Vec<_> = made.points.positions.into_iter().filter(|p| in_gap(p[0], p[1])).collect();
        let wrong = filled.iter().filter(|p| (p[2] - brick(p[0], p[1])).abs() > 0.08).count();
        assert!(filled.len() > 1800 && (wrong as f64) < 0.04 * filled.len() as f64, "{wrong} of {}", filled.len());
        filled
    };
    assert_ne!(closed(1), closed(2), "the seed has no say");
}

#[test]
fn a_gap_at_the_border_is_closed_as_far_as_the_scan_reaches() {
    let scan = bumps(8.0, |x, y| (x - 0.9).hypot(y - 4.0) > 0.9);
    let all = scan.bounds();
    let engine = Prepared::with_gap(&scan, None, &ReliefParams::default(), &Budget::default()).unwrap();
    let made = engine.run(&ReliefRequest::new(Ground::Hole), &mut Unobserved).unwrap();
    let reach = made.points.bounds();
    // Points are evened out along seams, by less than half a spacing.
    assert!((0..2).all(|k| reach.min[k] > all.min[k] - 0.05 && reach.max[k] < all.max[k] + 0.05), "{reach:?} {all:?}");
    assert!(widest_gap(&made.points.positions, [0.2, 3.2], [1.8, 4.8]) < 0.2, "the gap is open");
}

#[test]
fn tiles_keep_the_bond_or_say_which_would() {
    let engine = Prepared::new(&wall(|_, _| true), None, &ReliefParams::default(), &Budget::default()).unwrap();
    assert_eq!(engine.better_tile([7.0, 9.0]), None);
    let [widths, _] = engine.better_tile([6.5, 9.0]).unwrap();
    let [Some(below), Some(above)] = widths else { panic!("{widths:?}") };
    assert!((below - 6.0).abs() < 0.1 && (above - 7.0).abs() < 0.1, "{below} {above}");
    let made = engine.run(&ReliefRequest::new(Ground::Tile([7.0, 9.0])), &mut Unobserved).unwrap();
    // Wherever the first patch is from, the bond is that of the wall, somewhere.
    let points = &made.points.positions;
    let wrong = |dx: f64, dy: f64| {
        points.iter().filter(|p| (p[2] - brick(p[0] + dx, p[1] + dy)).abs() > 0.08).count() as f64 / points.len() as f64
    };
    let shifts = (0..50).flat_map(|i| (0..50).map(move |j| (0.02 * f64::from(i), 0.02 * f64::from(j))));
    let least = shifts.map(|(dx, dy)| wrong(dx, dy)).fold(1.0, f64::min);
    assert!(least < 0.12, "{least}");
}
