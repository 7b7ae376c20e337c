//! Points of which no surface can be made, and limits.

use std::ops::ControlFlow;

use arabesque_core::{
    Budget, Error, Limits, PointSet, Progress, StopReason, Stopper, TriangleMesh, Unobserved, Vector, Watch,
};

use crate::{SurfaceParams, reconstruct};

/// Points of a sphere by the golden angle.
fn ball(count: u32) -> PointSet<3> {
    let at = |k: u32| {
        let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(count);
        let (r, a) = ((1.0 - z * z).sqrt(), 2.399_963 * f64::from(k));
        Vector([r * a.cos(), r * a.sin(), z])
    };
    let mut points = PointSet::at((0..count).map(at).collect());
    points.normals = Some(points.positions.clone());
    points
}

fn refused(points: &PointSet<3>, set: &[(&str, &str)]) -> String {
    let mut params = SurfaceParams::default();
    set.iter().for_each(|(name, value)| params.set(name, value).unwrap());
    reconstruct(points, &params, None, &Budget::default(), &mut Unobserved).unwrap_err().to_string()
}

#[test]
fn what_is_no_surface_is_refused() {
    assert!(refused(&ball(6), &[]).contains("6 points, expected at least 10"));
    assert!(refused(&PointSet::default(), &[]).contains("0 points"));
    let mut far = ball(20);
    far.positions[4] = Vector([f64::NAN, 0.0, 0.0]);
    assert!(refused(&far, &[]).contains("point 5"));
    let line = PointSet::at((0..40).map(|k| Vector([f64::from(k), 2.0 * f64::from(k), 0.0])).collect());
    assert!(refused(&line, &[]).contains("along lines"));
    let heap = PointSet::at(vec![Vector([1.0, 2.0, 3.0]); 40]);
    assert!(refused(&heap, &[]).contains("in one place"));
    let mut bare = ball(40);
    bare.normals = None;
    assert!(refused(&bare, &[("normals", "given")]).contains("without normals"));
    assert!(refused(&bare, &[("method", "metaballs")]).contains("points with radii"));
    bare.radii = Some(vec![0.0; 40]);
    assert!(refused(&bare, &[]).contains("point 1 has no radius"));
    bare.radii = Some(vec![0.1; 3]);
    assert!(refused(&bare, &[]).contains("3 radii for 40 points"));
    assert!(refused(&ball(40), &[("cell", "0.1"), ("cells", "20")]).contains("not both"));
}

#[test]
fn a_large_heap_is_known_as_one_at_once() {
    let heap = PointSet::at(vec![Vector([1.0, 2.0, 3.0]); 20_000]);
    let budget = Budget::default();
    let error = reconstruct(&heap, &SurfaceParams::default(), None, &budget, &mut Unobserved).unwrap_err();
    assert!(error.to_string().contains("in one place"), "{error}");
    assert!(budget.work() < 1000 * 20_000, "{}", budget.work());
}

#[test]
fn all_in_one_plane_is_a_sheet() {
    let mut flat = PointSet::at((0..400).map(|k| Vector([f64::from(k % 20), f64::from(k / 20), 0.0])).collect());
    let found = reconstruct(&flat, &SurfaceParams::default(), None, &Budget::default(), &mut Unobserved).unwrap();
    assert!(found.mesh.positions.iter().all(|p| p[2].abs() < 1e-6));
    assert!(found.mesh.normals.unwrap().iter().all(|n| n[2] > 0.999), "upwards");
    flat.normals = Some(vec![Vector([0.0, 0.0, -1.0]); 400]);
    let found = reconstruct(&flat, &SurfaceParams::default(), None, &Budget::default(), &mut Unobserved).unwrap();
    assert!(found.mesh.normals.unwrap().iter().all(|n| n[2] < -0.999), "as they say");
}

#[test]
fn parts_of_few_points_are_told() {
    let mut points = ball(300);
    points.groups = Some((0..300).map(|k| if k < 2 { 9 } else { 1 }).collect());
    let found = reconstruct(&points, &SurfaceParams::default(), None, &Budget::default(), &mut Unobserved).unwrap();
    assert!(found.warnings[0].message.contains("too few points for a surface: group 9"), "{:?}", found.warnings);
}

#[test]
fn small_cells_are_bounded_by_the_limits() {
    let few = |limits: Limits, cell: &str| {
        let mut params = SurfaceParams::default();
        params.set("cell", cell).unwrap();
        reconstruct(&ball(500), &params, None, &Budget::new(limits), &mut Unobserved).unwrap_err()
    };
    let memory = few(Limits { memory: 1 << 20, ..Limits::default() }, "0.01");
    assert!(matches!(memory, Error::Limit { .. }) && memory.to_string().contains("--limit memory="), "{memory}");
    let work = few(Limits::default(), "0.0001");
    assert!(matches!(work, Error::Limit { .. }), "{work}");
    let tiny = few(Limits::default(), "0.00000001");
    let says =
        ["cells of 1e-8 over points that lie", "remove points that lie far from all others, or set cell to more than"];
    assert!(matches!(tiny, Error::Limit { .. }) && says.iter().all(|s| tiny.to_string().contains(s)), "{tiny}");
}

/// Ends after so many parts.
struct After(usize);

impl Watch<TriangleMesh> for After {
    fn step(&mut self, progress: &Progress, preview: &dyn Fn() -> TriangleMesh) -> ControlFlow<()> {
        assert!(preview().parts.len() == progress.done && progress.total == 3);
        if progress.done >= self.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn whoever_stops_gets_what_there_is() {
    let mut points = ball(300);
    points.groups = Some((0..300).map(|k| k / 100).collect());
    let run =
        |after| reconstruct(&points, &SurfaceParams::default(), None, &Budget::default(), &mut After(after)).unwrap();
    assert_eq!((run(2).mesh.parts.len(), run(2).stopped), (2, StopReason::Stopped));
    assert_eq!((run(3).mesh.parts.len(), run(3).stopped), (3, StopReason::Finished));
}

#[test]
fn a_request_to_stop_is_heard_in_every_stage() {
    let points = ball(400);
    let checks = {
        let stopper = Stopper::at_check(u64::MAX);
        let budget = Budget::with_stopper(Limits::default(), stopper.clone());
        reconstruct(&points, &SurfaceParams::default(), None, &budget, &mut Unobserved).unwrap();
        stopper.checks()
    };
    assert!(checks > 20, "only {checks} checks");
    for part in 0..10 {
        let budget = Budget::stopping_at(Limits::default(), 1 + checks * part / 10);
        let ended = reconstruct(&points, &SurfaceParams::default(), None, &budget, &mut Unobserved);
        assert!(matches!(ended, Err(Error::Stopped { .. })), "check {part}");
    }
}
