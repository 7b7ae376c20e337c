//! What a session of strokes promises.

use std::{f64::consts::TAU, ops::ControlFlow, sync::Arc};

use arabesque_core::{Budget, Limits, PointSet, Progress, StopReason, Unobserved, Vector, Watch};

use super::{session::Brush, stroke::Stroke};
use crate::{Prepared, StructureParams};

fn brush<const D: usize>(points: PointSet<D>) -> Brush<D> {
    let prepared = Prepared::new(Arc::new(points), &StructureParams::default(), &Budget::default()).unwrap();
    Brush::new(Arc::new(prepared), 4)
}

/// A screw about x, 1 long.
fn screw() -> PointSet<3> {
    let at = |k: u32| (f64::from(k) + 0.5) / 150.0;
    let place = |x: f64| Vector([x, 0.06 * (6.0 * TAU * x).cos(), 0.06 * (6.0 * TAU * x).sin()]);
    PointSet::at((0..150).map(|k| place(at(k))).collect())
}

fn lattice() -> PointSet<2> {
    PointSet::at((0..144).map(|k| Vector::xy(f64::from(k % 12), f64::from(k / 12))).collect())
}

fn paint<const D: usize>(brush: &mut Brush<D>, path: &[[f64; D]], radius: f64) -> PointSet<D> {
    let stroke = Stroke::new(path.iter().map(|p| Vector(*p)).collect(), radius);
    let told = brush.stroke(&stroke, &Budget::default(), &mut Unobserved).unwrap();
    assert_eq!(told.stopped, StopReason::Finished);
    brush.outcome(&Budget::default()).unwrap().points
}

/// The points for which `holds` says yes, to the bit and in an order of their own.
fn bits<const D: usize>(points: &PointSet<D>, holds: impl Fn(&Vector<D>) -> bool) -> Vec<[u64; D]> {
    let mut bits: Vec<_> = points.positions.iter().filter(|p| holds(p)).map(|p| p.0.map(f64::to_bits)).collect();
    bits.sort_unstable();
    bits
}

#[test]
fn what_is_out_of_reach_stays_to_the_last_bit() {
    let mut brush = brush(screw());
    let first = paint(&mut brush, &[[0.0, 0.0, 0.0], [3.0, 0.0, 0.0]], 0.1);
    assert!((380..520).contains(&first.len()), "{}", first.len());
    let second = paint(&mut brush, &[[3.0, 0.0, 0.0], [3.5, 0.4, 0.0]], 0.1);
    let far = |p: &Vector<3>| p[0] < 1.8;
    assert!(bits(&first, far).len() > 200 && bits(&first, far) == bits(&second, far));
    let added = second.len() as f64 - first.len() as f64;
    assert!((0.5..1.6).contains(&(added / (150.0 * 0.64))), "{added}");
    // Where they meet the strands go on: no gap of more than a few spacings along the axis.
    let mut along: Vec<f64> = second.positions.iter().map(|p| p[0]).filter(|x| *x > 2.5 && *x < 3.3).collect();
    along.sort_by(f64::total_cmp);
    assert!(along.windows(2).all(|w| w[1] - w[0] < 0.05), "{along:?}");
}

#[test]
fn undo_brings_back_every_bit_and_the_same_strokes_the_same_points() {
    let mut one = brush(lattice());
    let first = paint(&mut one, &[[0.0, 0.0], [14.0, 2.0]], 4.0);
    let second = paint(&mut one, &[[10.0, 6.0]], 5.0);
    assert!(second.len() > first.len() + 20 && one.strokes() == 2);
    assert!(one.undo());
    assert_eq!(one.outcome(&Budget::default()).unwrap().points, first);
    assert_eq!(paint(&mut one, &[[10.0, 6.0]], 5.0), second);
    let mut other = brush(lattice());
    paint(&mut other, &[[0.0, 0.0], [14.0, 2.0]], 4.0);
    assert_eq!(paint(&mut other, &[[10.0, 6.0]], 5.0), second);
    assert!(one.undo() && one.undo() && !one.undo());
    assert!(one.outcome(&Budget::default()).unwrap().points.is_empty());
}

#[test]
fn a_stroke_has_a_radius_a_scale_and_a_direction() {
    let mut brush = brush(lattice());
    let stroke = Stroke { scale: 0.5, ..Stroke::new(vec![Vector::xy(0.0, 0.0)], 5.0) };
    brush.stroke(&stroke, &Budget::default(), &mut Unobserved).unwrap();
    let found = brush.outcome(&Budget::default()).unwrap().points.positions;
    assert!(found.iter().all(|p| p.norm() <= 5.0));
    let expected = 4.0 * std::f64::consts::PI * 25.0;
    assert!((found.len() as f64 / expected - 1.0).abs() < 0.12, "{} for {expected}", found.len());
    brush.undo();
    let turned = Stroke { direction: Some(Vector::xy(0.6, 0.8)), ..Stroke::new(vec![Vector::ZERO], 6.0) };
    brush.stroke(&turned, &Budget::default(), &mut Unobserved).unwrap();
    let found = brush.outcome(&Budget::default()).unwrap().points.positions;
    let wanted = (0.8_f64).atan2(0.6).to_degrees();
    let (mut near, mut all) = (0, 0);
    for (i, p) in found.iter().enumerate() {
        for d in found[..i].iter().map(|q| *q - *p).filter(|d| (d.norm() - 1.0).abs() < 0.2) {
            let off = (d[1].atan2(d[0]).to_degrees() - wanted).rem_euclid(90.0);
            all += 1;
            near += usize::from(off.min(90.0 - off) < 8.0);
        }
    }
    assert!(all > 100 && near * 10 > all * 9, "{near} of {all}");
}

#[test]
fn painting_over_what_is_there_changes_nothing() {
    let mut brush = brush(lattice());
    let first = paint(&mut brush, &[[0.0, 0.0], [8.0, 0.0]], 4.0);
    let again = Stroke::new(vec![Vector::xy(2.0, 0.0), Vector::xy(6.0, 0.0)], 3.0);
    assert_eq!(brush.stroke(&again, &Budget::default(), &mut Unobserved).unwrap().sites, 0);
    assert_eq!(brush.outcome(&Budget::default()).unwrap().points, first);
}

/// Stops at the first step.
struct Impatient;

impl<P> Watch<P> for Impatient {
    fn step(&mut self, _: &Progress, _: &dyn Fn() -> P) -> ControlFlow<()> {
        ControlFlow::Break(())
    }
}

#[test]
fn a_stopped_stroke_leaves_the_best_so_far_and_a_refused_one_nothing() {
    let mut brush = brush(lattice());
    let stroke = Stroke::new(vec![Vector::ZERO], 6.0);
    let told = brush.stroke(&stroke, &Budget::default(), &mut Impatient).unwrap();
    assert_eq!((told.stopped, told.energy.len()), (StopReason::Stopped, 1));
    let points = brush.outcome(&Budget::default()).unwrap().points;
    assert!(points.len() > 80);
    let tight = Budget::new(Limits { work: 1, work_per_element: 0, ..Limits::default() });
    let far = Stroke::new(vec![Vector::xy(50.0, 0.0)], 6.0);
    assert!(brush.stroke(&far, &tight, &mut Unobserved).is_err());
    assert_eq!((brush.strokes(), brush.outcome(&Budget::default()).unwrap().points), (1, points));
}

#[test]
fn what_is_no_stroke_is_refused() {
    let good = Stroke::new(vec![Vector::ZERO], 3.0);
    let mut flat = brush(lattice());
    for (stroke, expected) in [
        (Stroke { path: Vec::new(), ..good.clone() }, "no point"),
        (Stroke { path: vec![Vector::xy(f64::NAN, 0.0)], ..good.clone() }, "not finite"),
        (Stroke { radius: 0.0, ..good.clone() }, "radius"),
        (Stroke { scale: -1.0, ..good.clone() }, "scale"),
        (Stroke { direction: Some(Vector::ZERO), ..good }, "direction"),
    ] {
        let message = flat.stroke(&stroke, &Budget::default(), &mut Unobserved).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
    let mut rope = brush(screw());
    let dab = Stroke::new(vec![Vector([1.0; 3]); 2], 0.1);
    assert!(rope.stroke(&dab, &Budget::default(), &mut Unobserved).unwrap_err().to_string().contains("no length"));
    let led = Stroke { direction: Some(Vector([1.0; 3])), ..Stroke::new(vec![Vector::ZERO, Vector([1.0; 3])], 0.1) };
    assert!(rope.stroke(&led, &Budget::default(), &mut Unobserved).is_err() && rope.strokes() == 0);
}
