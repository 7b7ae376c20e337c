//! Tiny scenes with a known answer, and one large random one.

use std::sync::Arc;

use arabesque_core::{
    Border, Bounds, Class, Domain, Element, Exemplar, FillRule, Outline, Placement, Request, Role, Shape, Similarity,
    Stage, Stream, Vector,
};

use super::*;

fn square(side: f64) -> Outline<2> {
    let h = 0.5 * side;
    Outline { rings: vec![vec![Vector::xy(-h, -h), Vector::xy(h, -h), Vector::xy(h, h), Vector::xy(-h, h)]] }
}

fn element(class: usize, x: f64, y: f64, outline: &Outline<2>) -> Element<2> {
    let centre = Vector::xy(x, y);
    Element {
        class,
        centre,
        pose: Similarity::identity(),
        outline: outline.transformed(&Similarity::shift(centre)),
        colour: [0.0; 3],
        lean: [Vector::ZERO; 3],
        role: Role::Source,
    }
}

fn exemplar(elements: Vec<Element<2>>) -> Exemplar<2> {
    let classes = elements.iter().map(|e| e.class).max().unwrap() + 1;
    let classes = (0..classes).map(|c| Class { name: format!("class {c}") }).collect();
    Exemplar::new("test", elements, classes, page(20.0)).unwrap()
}

fn page(side: f64) -> Bounds<2> {
    Bounds::new(Vector::ZERO, Vector::splat(side))
}

/// Squares of side 2 at a distance of 5: element 0 stands for all.
fn apart() -> Exemplar<2> {
    let places = (0..16).map(|k| (f64::from(k % 4), f64::from(k / 4)));
    exemplar(places.map(|(x, y)| element(0, 2.5 + 5.0 * x, 2.5 + 5.0 * y, &square(2.0))).collect())
}

/// A placement of exemplar element `source` with its centre at (x, y).
fn put(exemplar: &Exemplar<2>, source: usize, x: f64, y: f64) -> Placement<2> {
    let transform = Similarity::shift(Vector::xy(x, y) - exemplar.elements[source].centre);
    Placement { source, transform, control: Vec::new(), frozen: None }
}

fn centre(exemplar: &Exemplar<2>, placement: &Placement<2>) -> Vector<2> {
    placement.transform.apply(exemplar.elements[placement.source].centre)
}

fn mend(exemplar: &Exemplar<2>, request: &Request<2>, placements: &[Placement<2>]) -> (Vec<Placement<2>>, Summary) {
    let mut placements = placements.to_vec();
    let clearance = measure(exemplar, &Budget::default()).unwrap();
    let summary = repair(clearance.as_ref(), request, &mut placements, &Budget::default()).unwrap();
    (placements, summary)
}

fn on_page(side: f64) -> Request<2> {
    Request::new(Domain::Box(page(side)))
}

fn ratio(exemplar: &Exemplar<2>, placements: &[Placement<2>], request: &Request<2>) -> f64 {
    overlap_ratio(exemplar, placements, &request.domain, &Budget::default()).unwrap()
}

#[test]
fn two_overlapping_squares_are_pushed_apart_and_no_farther_than_needed() {
    let e = apart();
    let placements = [put(&e, 0, 5.0, 5.0), put(&e, 0, 6.6, 5.0)];
    let (mended, summary) = mend(&e, &on_page(20.0), &placements);
    assert_eq!(summary, Summary { pairs: 1, moved: 2, ..Summary::default() });
    assert_eq!(ratio(&e, &mended, &on_page(20.0)), 0.0);
    let (a, b) = (centre(&e, &mended[0]), centre(&e, &mended[1]));
    assert!((a - Vector::xy(4.8, 5.0)).norm() < 0.06 && (b - Vector::xy(6.8, 5.0)).norm() < 0.06, "{a:?} {b:?}");
}

#[test]
fn a_clean_scene_stays_to_the_last_bit() {
    let e = apart();
    let placements = [put(&e, 0, 5.0, 5.0), put(&e, 3, 7.5, 5.0)];
    let (mended, summary) = mend(&e, &on_page(20.0), &placements);
    assert_eq!(mended, placements);
    assert_eq!(summary, Summary::default());
}

#[test]
fn three_in_a_row_make_room_for_each_other() {
    let e = apart();
    let placements = [put(&e, 0, 5.0, 5.0), put(&e, 0, 6.5, 5.0), put(&e, 0, 8.0, 5.0)];
    let (mended, summary) = mend(&e, &on_page(20.0), &placements);
    assert_eq!((mended.len(), summary.removed, summary.pairs), (3, 0, 2));
    assert_eq!(ratio(&e, &mended, &on_page(20.0)), 0.0);
    for (before, after) in placements.iter().zip(&mended) {
        assert!((centre(&e, before) - centre(&e, after)).norm() < 0.25 * 5.0);
    }
}

#[test]
fn a_frozen_square_stays_to_the_last_bit() {
    let e = apart();
    let frozen = Placement { frozen: Some(0), ..put(&e, 0, 5.0, 5.0) };
    let placements = [put(&e, 0, 6.6, 5.0), frozen.clone()];
    let (mended, summary) = mend(&e, &on_page(20.0), &placements);
    assert_eq!(mended[1], frozen);
    assert_eq!(summary.moved, 1);
    assert_eq!(ratio(&e, &mended, &on_page(20.0)), 0.0);
}

#[test]
fn two_frozen_squares_may_overlap() {
    let e = apart();
    let frozen = |x| Placement { frozen: Some(0), ..put(&e, 0, x, 5.0) };
    let placements = [frozen(5.0), frozen(6.0)];
    assert_eq!(mend(&e, &on_page(20.0), &placements), (placements.to_vec(), Summary::default()));
}

#[test]
fn a_pair_across_the_edge_of_a_tile_is_found() {
    let e = apart();
    let tile = Request::new(Domain::Torus(page(20.0)));
    let placements = [put(&e, 0, 0.4, 5.0), put(&e, 0, 18.8, 5.0)];
    let common = ratio(&e, &placements, &tile);
    assert!((common - 0.4 * 2.0 / 8.0).abs() < 1e-6, "{common}");
    assert_eq!(ratio(&e, &placements, &on_page(20.0)), 0.0);
    let (mended, summary) = mend(&e, &tile, &placements);
    assert_eq!((summary.pairs, summary.moved), (1, 2));
    assert_eq!(ratio(&e, &mended, &tile), 0.0);
}

#[test]
fn an_element_that_reaches_around_a_small_tile_into_itself_is_left_out() {
    let long = Outline {
        rings: vec![vec![Vector::xy(-3.0, -0.2), Vector::xy(3.0, -0.2), Vector::xy(3.0, 0.2), Vector::xy(-3.0, 0.2)]],
    };
    let e = exemplar(vec![element(0, 5.0, 5.0, &long), element(0, 12.0, 15.0, &long)]);
    let tile = Request::new(Domain::Torus(page(5.0)));
    let (mended, summary) = mend(&e, &tile, &[put(&e, 0, 2.0, 2.0)]);
    assert_eq!((mended.len(), summary.pairs, summary.removed), (0, 1, 1));
}

/// Two pairs of squares that overlap by a tenth, and nothing else.
fn overlapping() -> Exemplar<2> {
    let at = [(3.0, 3.0), (4.8, 3.0), (13.0, 13.0), (14.8, 13.0)];
    exemplar(at.iter().map(|&(x, y)| element(0, x, y, &square(2.0))).collect())
}

#[test]
fn a_pair_may_overlap_as_much_as_in_the_exemplar() {
    let e = overlapping();
    let placements = [put(&e, 0, 5.0, 5.0), put(&e, 1, 6.8, 5.0)];
    assert_eq!(mend(&e, &on_page(20.0), &placements), (placements.to_vec(), Summary::default()));
    let placements = [put(&e, 0, 5.0, 5.0), put(&e, 1, 6.5, 5.0)];
    let (mended, summary) = mend(&e, &on_page(20.0), &placements);
    assert_eq!(summary.pairs, 1);
    let left = ratio(&e, &mended, &on_page(20.0));
    assert!(left <= 0.0525 + 1e-6 && left > 0.03, "pushed just as far as needed: {left}");
}

#[test]
fn more_overlapping_pairs_than_the_exemplar_has_are_too_many() {
    let e = overlapping();
    // Chains of three: each pair is as in the exemplar, but there are more pairs for the ink.
    let mut placements = Vec::new();
    for row in 0..3 {
        placements.extend((0..3).map(|k| put(&e, 0, 5.0 + 1.8 * f64::from(k), 4.0 + 5.0 * f64::from(row))));
    }
    let request = on_page(20.0);
    assert!(ratio(&e, &placements, &request) > 0.06);
    let (mended, summary) = mend(&e, &request, &placements);
    assert_eq!((mended.len(), summary.removed), (9, 0));
    assert!(ratio(&e, &mended, &request) <= 0.0525 + 1e-6);
}

#[test]
fn a_dot_that_belongs_on_a_leaf_may_lie_on_it_but_not_on_a_dot() {
    let leaf = element(0, 5.0, 5.0, &square(4.0));
    let e = exemplar(vec![leaf, element(1, 5.0, 5.5, &square(1.0)), element(1, 12.0, 12.0, &square(1.0))]);
    let placements = [put(&e, 0, 10.0, 10.0), put(&e, 1, 10.0, 9.0)];
    assert_eq!(mend(&e, &on_page(20.0), &placements).1, Summary::default());
    let placements = [put(&e, 1, 10.0, 10.0), put(&e, 1, 10.2, 10.0)];
    assert_eq!(mend(&e, &on_page(20.0), &placements).1.pairs, 1);
}

#[test]
fn a_dot_inside_a_leaf_is_found_where_the_exemplar_shows_none() {
    let e = exemplar(vec![element(0, 5.0, 5.0, &square(4.0)), element(1, 12.0, 12.0, &square(1.0))]);
    let placements = [put(&e, 0, 10.0, 10.0), put(&e, 1, 11.0, 10.2)];
    let (mended, summary) = mend(&e, &on_page(20.0), &placements);
    assert_eq!((mended.len(), summary.pairs, summary.removed), (2, 1, 0));
    assert_eq!(ratio(&e, &mended, &on_page(20.0)), 0.0);
}

#[test]
fn a_crowd_loses_as_few_as_it_must() {
    let e = apart();
    // Nine squares of side 2 on a page of side 5: four fit.
    let request = Request { border: Border::Inside, ..on_page(5.0) };
    let placements: Vec<_> =
        (0..9).map(|k| put(&e, 0, 1.2 + 1.3 * f64::from(k % 3), 1.2 + 1.3 * f64::from(k / 3))).collect();
    let (mended, summary) = mend(&e, &request, &placements);
    assert_eq!(mended.len() + summary.removed, 9);
    assert_eq!(mended.len(), 4);
    assert_eq!(ratio(&e, &mended, &request), 0.0);
    assert!(summary.warning(10).unwrap().message.contains("5 left out"));
}

#[test]
fn a_smaller_one_of_the_class_takes_the_place_where_the_large_one_does_not_fit() {
    let mut elements = apart().elements;
    elements.push(element(0, 5.0, 5.0, &square(0.5)));
    let e = exemplar(elements);
    // A frozen frame of four squares leaves a gap of side 1 in the middle.
    let frozen = |x, y| Placement { frozen: Some(0), ..put(&e, 0, x, y) };
    let wide: Vec<_> =
        [(8.5, 8.5), (10.5, 8.5), (12.5, 8.5), (8.5, 10.5), (8.5, 12.5), (10.5, 12.5), (12.5, 12.5), (12.5, 10.5)]
            .iter()
            .map(|&(x, y)| frozen(x, y))
            .collect();
    let mut placements = wide.clone();
    for (x, y) in [
        (6.4, 6.4),
        (6.4, 8.4),
        (6.4, 10.4),
        (6.4, 12.4),
        (6.4, 14.6),
        (8.4, 6.4),
        (10.4, 6.4),
        (12.4, 6.4),
        (14.6, 6.4),
    ] {
        placements.push(frozen(x, y));
    }
    for (x, y) in [(14.6, 8.4), (14.6, 10.4), (14.6, 12.4), (14.6, 14.6), (8.4, 14.6), (10.4, 14.6), (12.4, 14.6)] {
        placements.push(frozen(x, y));
    }
    let hole = put(&e, 0, 10.5, 10.2);
    placements[1] = frozen(10.5, 8.4);
    placements.push(hole);
    let (mended, summary) = mend(&e, &on_page(20.0), &placements);
    assert_eq!(
        (summary.exchanged, summary.removed, mended.len()),
        (0, 0, placements.len()),
        "fits exactly after a small shift"
    );
    // One more square in the hole: only the small one has room left beside it.
    placements.push(Placement { frozen: Some(0), ..put(&e, 0, 10.5, 10.9) });
    let (mended, summary) = mend(&e, &on_page(20.0), &placements);
    assert_eq!(summary.exchanged + summary.removed, 1);
    assert!(mended.iter().all(|p| p.frozen.is_some() || p.source == 16));
}

#[test]
fn nothing_stays_on_an_obstacle() {
    let e = apart();
    let wall = Outline {
        rings: vec![vec![Vector::xy(9.5, 0.0), Vector::xy(10.5, 0.0), Vector::xy(10.5, 20.0), Vector::xy(9.5, 20.0)]],
    };
    let request = Request { obstacles: vec![wall], ..on_page(20.0) };
    let (mended, summary) = mend(&e, &request, &[put(&e, 0, 9.0, 5.0), put(&e, 0, 11.0, 12.0)]);
    assert_eq!((summary.pairs, summary.moved, summary.removed), (2, 2, 0));
    assert!(centre(&e, &mended[0])[0] <= 8.5 && centre(&e, &mended[1])[0] >= 11.5);
}

#[test]
fn an_element_that_reaches_out_is_brought_in_or_left_out() {
    let e = apart();
    let round: Vec<_> = (0..90)
        .map(|k| f64::from(k) / 90.0 * std::f64::consts::TAU)
        .map(|a| Vector::xy(10.0 + 8.0 * a.cos(), 10.0 + 8.0 * a.sin()))
        .collect();
    let disc = Domain::Region(Arc::new(Shape::new(&[round], FillRule::NonZero).unwrap()));
    let request = Request { border: Border::Inside, ..Request::new(disc) };
    let (mended, summary) =
        mend(&e, &request, &[put(&e, 0, 17.2, 10.0), put(&e, 0, 10.0, 10.0), put(&e, 0, 30.0, 10.0)]);
    assert_eq!((summary.outside, summary.moved, summary.removed), (2, 1, 1));
    let corner = centre(&e, &mended[0]) + Vector::xy(1.0, 1.0) - Vector::splat(10.0);
    assert!(corner.norm() <= 8.0);
    assert_eq!(mended[1], put(&e, 0, 10.0, 10.0));
}

#[test]
fn a_bent_element_is_checked_as_it_is_drawn() {
    let e = apart();
    let mut bent = put(&e, 0, 5.0, 5.0);
    let c = e.elements[0].centre;
    // Stretched to the right: the right side of the square goes from 6 to 8.
    bent.control = vec![
        (c + Vector::xy(-1.0, -1.0), Vector::xy(4.0, 4.0)),
        (c + Vector::xy(-1.0, 1.0), Vector::xy(4.0, 6.0)),
        (c + Vector::xy(1.0, -1.0), Vector::xy(8.0, 4.0)),
        (c + Vector::xy(1.0, 1.0), Vector::xy(8.0, 6.0)),
    ];
    let placements = [bent, put(&e, 0, 8.0, 5.0)];
    let (mended, summary) = mend(&e, &on_page(20.0), &placements);
    assert_eq!((summary.pairs, summary.moved), (1, 2));
    assert_eq!(ratio(&e, &mended, &on_page(20.0)), 0.0);
    let (before, after) = (&placements[0], &mended[0]);
    let shift = after.control[0].1 - before.control[0].1;
    assert!(shift.norm() > 0.0);
    assert!((after.control[3].1 - before.control[3].1 - shift).norm() < 1e-12);
}

#[test]
fn points_and_space_have_nothing_to_check() {
    let points = [Vector([0.0, 0.0, 0.0]), Vector([1.0, 2.0, 3.0])];
    let e = Exemplar::from_points("test", &points, &[0, 0], &["a".into()]).unwrap();
    let clearance = measure(&e, &Budget::default()).unwrap();
    assert!(clearance.is_none());
    let bounds = Bounds::new(Vector::ZERO, Vector::splat(10.0));
    let at = |source| Placement { source, transform: Similarity::identity(), control: Vec::new(), frozen: None };
    let mut placements = vec![at(0), at(0)];
    let summary =
        repair::<3>(clearance.as_ref(), &Request::new(Domain::Box(bounds)), &mut placements, &Budget::default())
            .unwrap();
    assert_eq!((placements.len(), summary), (2, Summary::default()));
}

/// Leaves of 24 corners in two sizes, turned at random, near the nodes of a grid on a tile.
fn crowd(n: usize, spacing: f64) -> (Exemplar<2>, Vec<Placement<2>>, Request<2>) {
    let leaf = |size: f64| {
        let corner = |k: u32| {
            let a = f64::from(k) / 24.0 * std::f64::consts::TAU;
            Vector::xy(size * a.cos(), 0.4 * size * a.sin())
        };
        Outline { rings: vec![(0..24).map(corner).collect()] }
    };
    let e = exemplar(
        (0..16)
            .map(|k| {
                element(k % 2, 2.5 + 5.0 * (k % 4) as f64, 2.5 + 5.0 * (k / 4) as f64, &leaf(1.0 + (k % 2) as f64))
            })
            .collect(),
    );
    let side = spacing * (n as f64).sqrt().ceil();
    let mut stream = Stream::new(9, Stage::TEST, 0);
    let columns = (n as f64).sqrt().ceil() as usize;
    let placements = (0..n).map(|k| {
        let source = stream.below(16);
        let grid = Vector::xy((k % columns) as f64 + 0.5, (k / columns) as f64 + 0.5) * spacing;
        let target = grid + Vector::xy(stream.range(-0.6, 0.6), stream.range(-0.6, 0.6));
        let rotation = arabesque_core::Matrix::rotation(stream.range(-0.3, 0.3));
        let transform = Similarity::about(e.elements[source].centre, target, rotation, 1.0);
        Placement { source, transform, control: Vec::new(), frozen: None }
    });
    let placements = placements.collect();
    (e, placements, Request { border: Border::Cross, ..Request::new(Domain::Torus(page(side))) })
}

#[test]
fn a_large_crowd_comes_out_clean_with_few_losses() {
    let (e, placements, request) = crowd(900, 3.2);
    assert!(ratio(&e, &placements, &request) > 0.01);
    let (mended, summary) = mend(&e, &request, &placements);
    assert!(summary.pairs > 200, "{summary:?}");
    assert!(ratio(&e, &mended, &request) < 1e-6);
    assert!(summary.removed < 9, "{summary:?}");
    assert_eq!(mended.len() + summary.removed, 900);
}

#[test]
fn four_times_too_many_are_thinned_to_what_fits() {
    let (e, placements, request) = crowd(400, 1.6);
    let (mended, summary) = mend(&e, &request, &placements);
    assert!(ratio(&e, &mended, &request) < 1e-6);
    // The tile has room for about as many as there are cells of side 2.5.
    assert!((110..300).contains(&mended.len()), "{summary:?}");
}

#[test]
fn a_leaf_does_not_give_way_to_the_dots_at_its_rim() {
    let leaf = element(0, 5.0, 5.0, &square(4.0));
    let dots = (0..15).map(|k| element(1, 10.0 + f64::from(k % 5), 12.0 + f64::from(k / 5), &square(0.4)));
    let e = exemplar(std::iter::once(leaf).chain(dots).collect());
    let mut placements = vec![put(&e, 0, 10.0, 10.0)];
    placements.extend((0..14).map(|k| put(&e, 1, 8.1 + 0.3 * f64::from(k), 12.05)));
    let (mended, _) = mend(&e, &on_page(20.0), &placements);
    assert!(mended.iter().any(|p| p.source == 0));
    assert_eq!(ratio(&e, &mended, &on_page(20.0)), 0.0);
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    let (e, placements, request) = crowd(300, 3.2);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| mend(&e, &request, &placements))
    };
    assert_eq!(with(1), with(3));
}
