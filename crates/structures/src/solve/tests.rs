//! No step raises the error.

use std::{f64::consts::TAU, sync::Arc};

use arabesque_core::{Bounds, Budget, Domain, Fields, Matrix, PointSet, Similarity, Vector};

use super::{
    apart::Crowd,
    attributes::attributes,
    matching::{Round, anywhere, matching, room},
    merging::merge,
    newton::System,
    part::Part,
    round::round,
    sampling::control,
};
use crate::{
    Flat, Prepared, StructureParams,
    energy::{
        exact::Scene,
        kernel::Kernel,
        level::{Level, Matches, Near, Tables},
    },
    exemplar::pattern::Pattern,
    layout::Layout,
    output::state::Output,
    params::Window,
    start::{gaps::fill, noise::noise},
};

fn wave() -> PointSet<2> {
    let at = |k: usize| k as f64 / 100.0;
    let positions = (0..100).map(|k| Vector::xy(at(k), 0.05 * (at(k) * 5.0 * TAU).sin())).collect();
    let slope = |k: usize| 0.25 * TAU * (at(k) * 5.0 * TAU).cos();
    let normals = (0..100).map(|k| Vector::xy(-slope(k), 1.0).unit()).collect();
    let radii = (0..100).map(|k| 1.0 + (at(k) * 5.0 * TAU).cos() * 0.3).collect();
    PointSet { normals: Some(normals), radii: Some(radii), ..PointSet::at(positions) }
}

/// A level over all sites of a layout.
fn level_over<'a, const D: usize>(
    pattern: &'a Pattern<D>,
    tables: &'a Tables<D>,
    layout: &'a Layout<D>,
) -> Level<'a, D> {
    Level {
        pattern,
        tables,
        sites: &layout.sites,
        open: layout.sites.len(),
        index: &layout.index,
        domain: &layout.domain,
        shifts: &[],
        usual: 30.0,
    }
}

/// Calls `check` with a level over noise, with random matches.
fn noisy(check: impl FnOnce(&Level<'_, 2>, &Layout<2>, Output<2>, Matches<2>)) {
    let budget = Budget::default();
    let prepared = Prepared::new(Arc::new(wave()), &StructureParams::default(), &budget).unwrap();
    let domain = Domain::Box(Bounds::new(Vector::ZERO, Vector::xy(1.5, 0.0)));
    let layout = Layout::new(&prepared, &Flat::new(domain, Fields::default()), &budget).unwrap();
    let pattern = &*prepared.pattern;
    let kernel = Kernel::new(prepared.sigma, prepared.window, pattern.base, Window::Gaussian);
    let tables = Tables::new(pattern, kernel, &prepared.fields, &budget).unwrap();
    let level = level_over(pattern, &tables, &layout);
    let output = noise(&level, Output::default(), layout.plan.step, 5);
    let room = room(&level);
    let mut stream = arabesque_core::Stream::new(3, arabesque_core::Stage::TEST, 0);
    let first = (0..layout.sites.len()).map(|_| anywhere(&room, &mut stream)).collect();
    let matches = Matches::new(&level, first);
    check(&level, &layout, output, matches);
}

fn energy(level: &Level<'_, 2>, output: &Output<2>, near: &Near, matches: &Matches<2>) -> f64 {
    let pulls = level.pulls(output, near, matches, &Budget::default()).unwrap();
    level.energy(output, near, &pulls, matches, &Budget::default()).unwrap()
}

#[test]
fn no_step_raises_the_error() {
    noisy(|level, layout, mut output, mut matches| {
        let budget = Budget::default();
        for number in 0..4 {
            let near = level.near(&output, &budget).unwrap();
            let before = energy(level, &output, &near, &matches);
            let round = Round { seed: 1, number, tries: 3 };
            let matched = matching(level, &output, &near, &matches, &layout.around, (round, &budget)).unwrap();
            assert!(matched.energy.1 <= matched.energy.0);
            matches = matched.matches;
            let after = energy(level, &output, &near, &matches);
            let close = |a: f64, b: f64| (a - b).abs() < 1e-3 * (1.0 + a.abs());
            assert!(after <= before && close(before, matched.energy.0), "{before} {after} {:?}", matched.energy);
            let mut pulls = level.pulls(&output, &near, &matches, &budget).unwrap();
            let moved = merge(level, &mut output, &near, &matches, (&mut pulls, after), &budget).unwrap();
            assert!(moved.energy <= after && close(moved.energy, energy(level, &output, &near, &matches)));
            attributes(level, &mut output, &near, &matches, (&mut pulls, &budget)).unwrap();
            let directed = energy(level, &output, &near, &matches);
            assert!(directed <= moved.energy + 1e-3 * moved.energy.abs(), "{directed} {}", moved.energy);
            let near = level.near(&output, &budget).unwrap();
            let pulls = level.pulls(&output, &near, &matches, &budget).unwrap();
            let before = level.energy(&output, &near, &pulls, &matches, &budget).unwrap();
            control(level, &mut output, &near, &matches, &pulls, &budget).unwrap();
            let near = level.near(&output, &budget).unwrap();
            let controlled = energy(level, &output, &near, &matches);
            // What is added is weighed with the windows around it alone, which is off by a little.
            assert!(controlled <= before + 3e-3 * before.abs(), "{controlled} {before}");
        }
    });
}

#[test]
fn what_is_out_of_reach_of_open_sites_stays_to_the_last_bit() {
    noisy(|level, layout, output, matches| {
        let budget = Budget::default();
        let open: Vec<bool> = level.sites.iter().map(|s| s.place[0] < 0.2).collect();
        let around = (&layout.around, layout.plan.step);
        let part = Part::new(level, around, &output, &matches.places, &open, &budget).unwrap();
        assert!(part.open < part.numbers.len() && part.numbers.len() < level.sites.len());
        let inner = part.level(level);
        let (mut own, mut found) = (part.output.clone(), Matches::new(&inner, part.places.clone()));
        let draw = Round { seed: 1, number: 0, tries: 3 };
        let turn = round(&inner, &part.around, (&mut own, &mut found), (draw, 3), &budget).unwrap();
        assert!(turn.energy.1 < turn.energy.0 && !turn.rematched.is_empty() && !turn.stirred.is_empty());
        let (mut whole, mut places) = (output.clone(), matches.places.clone());
        part.back(level, (&own, &found), (&mut whole, &mut places));
        let reach = 0.2 + level.tables.reach.radius();
        let far = |o: &Output<2>| -> Vec<_> { o.places.iter().copied().filter(|p| p[0] > reach).collect() };
        assert_eq!(far(&output), far(&whole));
        assert!(far(&output).len() > 50 && whole.places != output.places);
        for (q, open) in open.iter().enumerate().filter(|(_, open)| !**open) {
            assert!(!open && places[q] == matches.places[q]);
        }
    });
}

#[test]
fn slopes_are_those_of_finite_differences() {
    noisy(|level, _, output, matches| {
        let budget = Budget::default();
        let near = level.near(&output, &budget).unwrap();
        let pulls = level.pulls(&output, &near, &matches, &budget).unwrap();
        let crowd = Crowd::new(level, &output, &pulls, &budget).unwrap();
        let slopes = System::new(level, &output, &near, (&pulls, &crowd), &budget).unwrap().slopes;
        let size = slopes.iter().map(|s| s.norm()).fold(0.0, f64::max);
        let h = 0.02 * level.pattern.spacing;
        let (mut off, mut count) = (0.0, 0.0);
        for i in (0..output.places.len()).step_by(7) {
            for k in 0..2 {
                let at = |h: f64| {
                    let mut moved = output.clone();
                    moved.places[i][k] += h;
                    energy(level, &moved, &near, &matches)
                };
                off += ((at(h) - at(-h)) / (2.0 * h) - slopes[i][k]).abs();
                count += 1.0;
            }
        }
        // The table of the field is read with errors of about one per cent.
        assert!(off / count < 0.02 * size, "{} of {size}", off / count);
    });
}

#[test]
fn a_look_up_is_the_sum_over_all_pairs() {
    let points = wave();
    let budget = Budget::default();
    let prepared = Prepared::new(Arc::new(points.clone()), &StructureParams::default(), &budget).unwrap();
    let pattern = &*prepared.pattern;
    let mut scene = Scene {
        x: Vec::new(),
        a: Vec::new(),
        e: points.positions,
        b: Vec::new(),
        q: Vector::ZERO,
        m: Vector::xy(0.5, 0.0),
        rotation: Matrix::identity(),
        scale: 1.0,
        sigma: prepared.sigma,
        delta: 0.1,
    };
    scene.b = pattern.weights.iter().map(|w| w.iter().map(|&v| f64::from(v)).collect()).collect();
    let kernel = Kernel::new(scene.sigma, scene.delta, [true, true], Window::Gaussian);
    let tables = Tables::new(pattern, kernel, &prepared.fields, &budget).unwrap();
    let constant = scene.w(Vector::ZERO, Vector::ZERO);
    for u in [Vector::xy(0.0, 0.0), Vector::xy(0.03, 0.05), Vector::xy(-0.11, 0.02), Vector::xy(0.14, -0.04)] {
        let weights = pattern.weights[3];
        let own: Vec<f64> = weights.iter().map(|&v| f64::from(v)).collect();
        let exact: f64 = (0..scene.e.len())
            .map(|j| {
                let v = scene.e[j] - scene.m;
                let alike = own.iter().zip(&scene.b[j]).map(|(a, b)| a * b).sum::<f64>();
                // The window at the point of the output instead of at the middle of the pair.
                alike * scene.w(u, v) / scene.w((u + v) * 0.5, (u + v) * 0.5) * scene.w(u, u) / constant
            })
            .sum();
        let y = std::array::from_fn(|k| (scene.m[k] + u[k]) as f32);
        let found = tables.kernel.weight(&u.0) * f64::from(tables.field.project(&y, &weights));
        assert!((found - exact).abs() < 0.02, "{found} for {exact} at {u:?}");
    }
}

#[test]
fn a_turned_and_scaled_output_is_the_same_problem() {
    noisy(|level, _, output, matches| {
        let budget = Budget::default();
        let near = level.near(&output, &budget).unwrap();
        let before = energy(level, &output, &near, &matches);
        let motion = Similarity::about(Vector::ZERO, Vector::xy(3.0, -2.0), Matrix::rotation(0.8), 1.7);
        let sites: Vec<_> = level
            .sites
            .iter()
            .map(|s| crate::Site {
                place: motion.apply(s.place),
                rotation: motion.rotation.compose(&s.rotation),
                scale: 1.7,
                ..*s
            })
            .collect();
        let mut moved = output.clone();
        for i in 0..moved.places.len() {
            moved.places[i] = motion.apply(output.places[i]);
            moved.weights[i] = level.pattern.channels.turned(&output.weights[i], &motion.rotation);
        }
        let turned = Level { sites: &sites, ..*level };
        let after = energy(&turned, &moved, &near, &matches);
        assert!((after - before).abs() < 1e-3 * before.abs(), "{after} {before}");
    });
}

/// A plane of points 1 apart, and sixteen triangles on it, 1 above and 4 apart.
fn studded() -> PointSet<3> {
    let (mut positions, mut elements) = (Vec::new(), Vec::new());
    for k in 0..256 {
        positions.push(Vector([f64::from(k % 16), f64::from(k / 16), 0.0]));
        elements.push(-1);
    }
    for k in 0..16 {
        for corner in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] {
            positions.push(Vector([
                f64::from(4 * (k % 4)) + 1.0 + corner[0],
                f64::from(k - k % 4) + 1.0 + corner[1],
                1.0,
            ]));
            elements.push(k);
        }
    }
    PointSet { elements: Some(elements), ..PointSet::at(positions) }
}

/// Calls `check` with a level over the plane of points and triangles, and the step of its sites.
fn mixed(check: impl FnOnce(&Level<'_, 3>, f64)) {
    let budget = Budget::default();
    let params = StructureParams { window: Some(4.0), ..StructureParams::default() };
    let prepared = Prepared::new(Arc::new(studded()), &params, &budget).unwrap();
    let domain = Domain::Box(Bounds::new(Vector::ZERO, Vector([16.0, 16.0, 1.0])));
    let layout = Layout::new(&prepared, &Flat::new(domain, Fields::default()), &budget).unwrap();
    let pattern = &*prepared.pattern;
    let kernel = Kernel::new(prepared.sigma, prepared.window, pattern.base, Window::Gaussian);
    let tables = Tables::new(pattern, kernel, &prepared.fields, &budget).unwrap();
    let level = level_over(pattern, &tables, &layout);
    check(&level, layout.plan.step);
}

#[test]
fn elements_on_a_base_make_way_for_each_other_along_it() {
    mixed(|level, _| {
        let budget = Budget::default();
        let matches = Matches::new(level, vec![Vector([7.5, 7.5, 0.0]); level.sites.len()]);
        let at = |x: f64| Similarity { translation: Vector([x, 6.0, 0.2]), ..Similarity::identity() };
        let crowd = |x: f64| {
            let mut output = Output::default();
            output.add_body(level.pattern, 0, at(6.0));
            output.add_body(level.pattern, 0, at(x));
            let near = level.near(&output, &budget).unwrap();
            let pulls = level.pulls(&output, &near, &matches, &budget).unwrap();
            (Crowd::new(level, &output, &pulls, &budget).unwrap(), output)
        };
        // The triangles of the exemplar are 3 apart; here the clear space is 0.8.
        let (near, output) = crowd(7.8);
        let mut pushed = Vec::new();
        near.slopes(level, &output, |i, slope, curve| pushed.push((output.body_of[i], slope, curve)));
        assert!(near.energy() > 0.0 && pushed.len() == 2);
        assert!(
            pushed[0].1[0] > 0.0 && pushed[0].1 == -pushed[1].1 && pushed.iter().all(|p| p.1[2] == 0.0 && p.2 > 0.0)
        );
        assert!(near.energy() > crowd(8.3).0.energy());
        assert_eq!(crowd(9.9).0.energy(), 0.0);
    });
}

#[test]
fn bare_places_of_a_base_get_elements_that_stand_on_it_as_high_as_in_the_exemplar() {
    mixed(|level, step| {
        let budget = Budget::default();
        let mut output = Output::default();
        for i in 0..256 {
            let raised = level.pattern.points.positions[i] + Vector([0.0, 0.0, 0.5]);
            output.add(raised, level.pattern.weights[i]);
        }
        fill(level, &mut output, step, 1, &budget).unwrap();
        assert!((8..=30).contains(&output.bodies.len()), "{}", output.bodies.len());
        for i in 256..output.places.len() {
            assert!((output.places[i][2] - 1.5).abs() < 1e-9, "{:?}", output.places[i]);
            let apart =
                |j: usize| output.body_of[j] == output.body_of[i] || (output.places[j] - output.places[i]).norm() > 2.9;
            assert!((256..output.places.len()).all(apart));
        }
    });
}
