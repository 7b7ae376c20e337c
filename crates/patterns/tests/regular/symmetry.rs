//! All seventeen groups are named, and patterns of each are continued.

use arabesque_core::{Area, Bounds, Budget, Class, Contents, Domain, Exemplar, Outline, Request, Vector};
use arabesque_patterns::repeat::{Symmetry, symmetry};

use crate::{
    drawing::{Pattern, rectangle, xy},
    groups::{self, NAMES},
    measure::{TOLERANCE, assert_same, centres, expected, hausdorff, page, prepared, run},
};

/// Frames of odd sizes, in periods, their corners anywhere.
fn frame(pattern: &Pattern, k: usize) -> Bounds<2> {
    let periods = [[2.6, 2.3], [3.3, 1.9], [4.3, 2.7], [1.9, 3.1], [2.2, 4.1]][k % 5];
    let side = pattern.vectors.map(|v| v.norm());
    let corner = xy(0.37 * side[0], -0.53 * side[1]);
    Bounds::new(corner, corner + xy(periods[0] * side[0], periods[1] * side[1]))
}

fn check(name: &str, pattern: &Pattern, k: usize) {
    let window = frame(pattern, k);
    let exemplar = pattern.exemplar(window);
    let prepared = prepared(&exemplar, name);
    let repeat = prepared.repeat().unwrap();
    let cell = pattern.vectors[0].cross(pattern.vectors[1]).abs() / if name.starts_with('c') { 2.0 } else { 1.0 };
    assert!((repeat.lattice.cell() / cell - 1.0).abs() < 0.01, "{name}: {} for {cell}", repeat.lattice.cell());
    let found = symmetry(&exemplar, repeat, &Budget::default()).unwrap();
    assert!(matches!(found, Symmetry::Plane(_)) && found.name() == name, "{name}: taken for {found}");
    let spacing = pattern.shorter();
    let page = page(9.3 * spacing, 7.6 * spacing);
    let by = page.min - window.min;
    for seed in 0..2 {
        let outcome = run(&prepared, &Request { seed, ..Request::new(Domain::Box(page)) });
        if !pattern.motifs.is_empty() {
            let inside = |p: Vector<2>| page.contains(p);
            let found = centres(&exemplar, &outcome);
            assert_same(&found, &expected(pattern, by, &page), TOLERANCE * 0.3 * spacing, inside, name);
        } else {
            let off = hausdorff(pattern, &exemplar, &outcome, by, &page);
            assert!(off <= TOLERANCE * spacing, "{name}: strokes {:.4} of a period off", off / spacing);
        }
    }
}

#[test]
fn groups_of_elements() {
    for (k, name) in NAMES.into_iter().enumerate() {
        let scale = [1.0, 500.0, 0.5, 37.0][k % 4];
        check(name, &groups::of_elements(name).scaled(scale), k);
    }
}

#[test]
fn groups_of_strokes() {
    for (k, name) in NAMES.into_iter().enumerate() {
        let scale = [12.0, 0.5, 500.0][k % 3];
        check(name, &groups::of_strokes(name).scaled(scale), k + 2);
    }
}

#[test]
fn groups_of_elements_and_strokes_together() {
    for (k, name) in NAMES.into_iter().enumerate() {
        let pattern = groups::of_both(name).scaled([37.0, 1.0][k % 2]);
        assert_eq!(named(&pattern.exemplar(frame(&pattern, k + 1))), name);
    }
}

#[test]
fn groups_of_areas() {
    for (k, name) in NAMES.into_iter().enumerate() {
        let pattern = groups::of_elements(name).scaled([1.0, 80.0][k % 2]);
        assert_eq!(named(&of_areas(&pattern, frame(&pattern, k + 3))), name);
    }
}

#[test]
fn a_turn_that_takes_inside_to_outside_is_none() {
    // Bands between two borders: the first two are taken to the gaps between them by moving or turning, the third by turning alone.
    let window = Bounds::new(xy(0.3, 0.2), xy(50.0, 47.0));
    for (upper, lower, name) in
        [([2.0, 0.0], [2.0, 0.0], "pmg"), ([2.0, 0.0], [-2.0, 0.0], "pmm"), ([2.0, 1.0], [1.0, 0.0], "p1")]
    {
        let border = |y: f64, [one, two]: [f64; 2]| -> Vec<Vector<2>> {
            let at = |k: i64| k as f64 * 0.5 - 5.0;
            let turn = |k: i64| at(k) * std::f64::consts::TAU / 16.0;
            (0..=120).map(|k| xy(at(k), y + one * turn(k).sin() + two * (2.0 * turn(k)).sin())).collect()
        };
        let band = |j: i64| {
            let back = border(j as f64 * 16.0 + 8.0, lower).into_iter().rev();
            border(j as f64 * 16.0, upper).into_iter().chain(back).collect::<Vec<_>>()
        };
        let rings: Vec<_> = (-1..4).map(band).collect();
        assert_eq!(named(&areas(&rings, window)), name, "{upper:?} {lower:?}");
    }
}

/// The name of the group of what repeats.
fn named(exemplar: &Exemplar<2>) -> &'static str {
    let regular = arabesque_patterns::regular(exemplar, &Budget::default()).unwrap().expect("a repeat");
    let repeat = regular.repeat();
    symmetry(exemplar, repeat, &Budget::default()).unwrap().name()
}

/// The elements of a pattern as areas, cut by the frame.
fn of_areas(pattern: &Pattern, window: Bounds<2>) -> Exemplar<2> {
    let rings: Vec<_> = pattern.outlines(&window).into_iter().flat_map(|(outline, _)| outline.rings).collect();
    areas(&rings, window)
}

fn areas(rings: &[Vec<Vector<2>>], window: Bounds<2>) -> Exemplar<2> {
    let frame = Outline { rings: vec![rectangle(window.min, window.max)] };
    let shown = rings.iter().map(|ring| Outline { rings: vec![ring.clone()] }.intersection(&frame));
    let area = |outline: Outline<2>| Area { outline, style: 0, colour: [0.2, 0.4, 0.6] };
    let areas = shown.filter(|outline| outline.area() > 0.0).map(area).collect();
    let styles = vec![Class { name: "fill".into() }];
    Exemplar::with_curves("areas", Contents { areas, styles, ..Contents::default() }, window).unwrap()
}

#[test]
fn stripes_are_told_by_whether_they_read_the_same_from_both_sides() {
    let window = Bounds::new(Vector::ZERO, xy(30.0, 69.0));
    for (gap, name) in [(7.0, "stripes"), (10.0, "mirrored stripes")] {
        let at = |k: usize| 3.0 + 20.0 * (k / 2) as f64 + gap * (k % 2) as f64;
        let lines: Vec<_> = (0..7).map(|k| (vec![xy(0.0, at(k)), xy(30.0, at(k))], k % 2)).collect();
        let exemplar = crate::drawing::exemplar(&[], &lines, window);
        let prepared = prepared(&exemplar, name);
        let found = symmetry(&exemplar, prepared.repeat().unwrap(), &Budget::default()).unwrap();
        assert_eq!(found.name(), name);
    }
}

#[test]
fn places_with_different_things_have_the_symmetry_of_the_places() {
    let window = Bounds::new(Vector::ZERO, xy(80.0, 70.0));
    let dot = |i: i64, j: i64| {
        let ring = crate::drawing::polygon(xy(i as f64 * 10.0 + 5.0, j as f64 * 10.0 + 5.0), 3.0, 20, 0.0);
        (arabesque_core::Outline { rings: vec![ring] }, ((crate::drawing::noise(i, j, 9) + 1.0) * 2.0) as usize)
    };
    let dots: Vec<_> = (0..8).flat_map(|i| (0..7).map(move |j| dot(i, j))).collect();
    let exemplar = crate::drawing::exemplar(&dots, &[], window);
    let prepared = prepared(&exemplar, "colours");
    let found = symmetry(&exemplar, prepared.repeat().unwrap(), &Budget::default()).unwrap();
    assert_eq!(found.name(), "p4m");
}
