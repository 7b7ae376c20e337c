//! Borders, holes, things in the way and things that stay do not move the lattice.

use arabesque_core::{
    Border, Bounds, Domain, FillRule, Matrix, OrientationField, Outline, Placement, Region, Request, ScalarField,
    Shape, Similarity, Vector,
};

use crate::{
    drawing::{Pattern, polygon, rectangle, xy},
    elements::{bricks, chess, frame},
    measure::{TOLERANCE, assert_same, centres, expected, page, prepared, run},
};

fn outline(ring: Vec<Vector<2>>) -> Outline<2> {
    Outline { rings: vec![ring] }
}

/// Distance of a place from the border of a domain, at which nothing is in doubt for bricks of 36 x 12.
const CLEAR: f64 = 20.0;

struct Wall {
    pattern: Pattern,
    window: Bounds<2>,
}

fn wall() -> Wall {
    let pattern = bricks().scaled(20.0);
    let window = frame(&pattern, 4);
    Wall { pattern, window }
}

#[test]
fn every_border_keeps_the_lattice() {
    let Wall { pattern, window } = wall();
    let exemplar = pattern.exemplar(window);
    let prepared = prepared(&exemplar, "bricks");
    let page = page(310.0, 190.0);
    let wanted = expected(&pattern, page.min - window.min, &page.grown(40.0));
    for border in [Border::Clip, Border::Inside, Border::Cross] {
        for seed in 0..5 {
            let request = Request { border, seed, ..Request::new(Domain::Box(page)) };
            let found = centres(&exemplar, &run(&prepared, &request));
            let inner = |p: Vector<2>| page.signed_distance(p) > CLEAR;
            let name = format!("{border:?}, seed {seed}");
            assert_same(&found, &wanted, TOLERANCE * 20.0, inner, &name);
            let half = xy(18.0, 6.0);
            let is_whole = |p: Vector<2>| page.grown(1e-6).contains(p - half) && page.grown(1e-6).contains(p + half);
            match border {
                Border::Inside => assert_same(
                    &found,
                    &wanted,
                    0.4,
                    |p| is_whole(p) || page.contains(p) && found.iter().any(|f| f.0 == p),
                    &name,
                ),
                Border::Cross => assert_same(&found, &wanted, 0.4, |p| page.contains(p), &name),
                Border::Clip | Border::Turn => {}
            }
            if border == Border::Inside {
                assert!(found.iter().all(|(p, _)| is_whole(*p)), "{name}");
            }
        }
    }
}

#[test]
fn a_shape_with_a_hole_and_things_in_the_way_leave_the_rest_as_it_is() {
    let Wall { pattern, window } = wall();
    let exemplar = pattern.exemplar(window);
    let prepared = prepared(&exemplar, "bricks");
    let centre = xy(160.0, 130.0);
    let rings = [polygon(centre, 150.0, 80, 0.0), polygon(centre, 60.0, 60, 0.0)];
    let ring = Shape::new(&rings, FillRule::EvenOdd).unwrap();
    let block = rectangle(xy(60.0, 30.0), xy(110.0, 90.0));
    let block_area = outline(block.clone());
    let mut request = Request::new(Domain::Region(std::sync::Arc::new(ring.clone())));
    request.obstacles = vec![block_area.clone()];
    let block = Shape::new(&[block], FillRule::NonZero).unwrap();
    let wanted = expected(&pattern, Vector::ZERO, &request.domain.bounds());
    for border in [Border::Clip, Border::Inside, Border::Cross] {
        let request = Request { border, ..request.clone() };
        let outcome = run(&prepared, &request);
        let clear = |p: Vector<2>| ring.signed_distance(p) > CLEAR && block.signed_distance(p) < -CLEAR;
        assert_same(&centres(&exemplar, &outcome), &wanted, TOLERANCE * 20.0, clear, &format!("{border:?}"));
        for p in &outcome.placements {
            let shape = exemplar.elements[p.source].outline.transformed(&p.transform);
            assert!(shape.intersection(&block_area).area() < 1e-3, "something lies in the way");
        }
    }
}

#[test]
fn what_stays_is_joined_and_keeps_its_place() {
    let Wall { pattern, window } = wall();
    let exemplar = pattern.exemplar(window);
    let prepared = prepared(&exemplar, "bricks");
    let page = page(310.0, 190.0);
    // Four bricks of the wall, moved by no translation of the lattice.
    let moved = xy(7.3, -4.1);
    let source = exemplar.elements.iter().position(|e| e.role == arabesque_core::Role::Source).unwrap();
    let at = exemplar.elements[source].centre + (page.min - window.min) + moved;
    let kept: Vec<Vector<2>> = [[1, 2], [2, 2], [1, 3], [3, 1]]
        .map(|node| at + pattern.at(node))
        .into_iter()
        .filter(|p| page.contains(*p))
        .collect();
    assert!(kept.len() >= 3);
    let mut request = Request::new(Domain::Box(page));
    let placement = |p: &Vector<2>| {
        let pivot = exemplar.elements[source].centre;
        let transform = Similarity::about(pivot, *p, Matrix::identity(), 1.0);
        Placement { source, transform, control: Vec::new(), frozen: None }
    };
    request.frozen = kept.iter().map(placement).collect();
    let outcome = run(&prepared, &request);
    for (n, p) in kept.iter().enumerate() {
        let stays = outcome.placements.iter().find(|placed| placed.frozen == Some(n)).unwrap();
        assert!((stays.transform.apply(exemplar.elements[source].centre) - *p).norm() < 1e-9);
    }
    let wanted = expected(&pattern, page.min - window.min + moved, &page);
    let inner = |p: Vector<2>| page.contains(p);
    assert_same(&centres(&exemplar, &outcome), &wanted, TOLERANCE * 20.0, inner, "kept");
}

#[test]
fn a_constant_turn_and_scale_turn_and_scale_the_lattice() {
    let pattern = chess().scaled(10.0);
    let window = frame(&pattern, 0);
    let exemplar = pattern.exemplar(window);
    let prepared = prepared(&exemplar, "chess");
    let page = page(230.0, 170.0);
    let turn = Matrix::rotation(0.35);
    for (scale, density) in [(1.0, 1.0), (1.7, 1.0), (0.6, 1.0), (1.0, 0.5)] {
        let mut request = Request::new(Domain::Box(page));
        request.fields.orientation = Some(OrientationField::Constant(turn));
        request.fields.scale = ScalarField::Constant(scale);
        request.fields.density = ScalarField::Constant(density);
        let outcome = run(&prepared, &request);
        let spacing = scale * f64::powf(density, -0.5);
        let found = centres(&exemplar, &outcome);
        // All places differ from the first one of their colour by whole steps.
        let step = |v: Vector<2>| {
            let back = turn.transpose().apply(v) * (1.0 / (10.0 * spacing));
            ((back[0] + back[1]) * 0.5, (back[0] - back[1]) * 0.5)
        };
        for class in 0..2 {
            let of_class: Vec<_> = found.iter().filter(|(_, c)| *c == class).map(|(p, _)| *p).collect();
            let expected = page.measure() / (200.0 * spacing * spacing);
            let inside = of_class.iter().filter(|p| page.contains(**p)).count() as f64;
            assert!((inside / expected - 1.0).abs() < 0.12, "{inside} for {expected}");
            for p in &of_class {
                let (i, j) = step(*p - of_class[0]);
                let off = (i - i.round()).abs().max((j - j.round()).abs());
                assert!(off < TOLERANCE, "scale {scale}, density {density}: {off} of a cell off");
            }
        }
    }
}
