#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use arabesque_core::{
    Bounds, Budget, Class, Domain, Element, Exemplar, Outline, Request, Role, Similarity, Stage, Stream, Unobserved,
    Vector,
};

use super::Boards;

/// A rectangle as an element.
fn board(low: Vector<2>, size: Vector<2>, turn: impl Fn(Vector<2>) -> Vector<2>, class: usize) -> Element<2> {
    let corners = [Vector::ZERO, Vector::xy(size[0], 0.0), size, Vector::xy(0.0, size[1])].map(|c| turn(low + c));
    let outline = Outline { rings: vec![corners.to_vec()] };
    let centre = outline.centroid().unwrap();
    let pose = Similarity::shift(centre);
    Element { class, centre, pose, outline, colour: [0.5; 3], lean: [Vector::ZERO; 3], role: Role::Source }
}

/// Rows of boards of any length over a page of 200, with these heights, gaps as told.
fn rows(heights: [f64; 2], gap: f64, turn: impl Fn(Vector<2>) -> Vector<2>) -> Exemplar<2> {
    let mut stream = Stream::new(7, Stage::TEST, 0);
    let (mut elements, mut y, mut k) = (Vec::new(), 0.0, 0);
    while y < 200.0 {
        let mut x = -stream.range(0.0, 30.0);
        while x < 200.0 {
            let length = stream.range(30.0, 80.0);
            let class = stream.below(2);
            elements.push(board(Vector::xy(x, y), Vector::xy(length, heights[k % 2]), &turn, class));
            x += length + gap;
        }
        y += heights[k % 2] + gap;
        k += 1;
    }
    let classes = ["a", "b"].map(|name| Class { name: name.into() }).to_vec();
    Exemplar::new("t", elements, classes, page(200.0)).unwrap()
}

fn page(side: f64) -> Bounds<2> {
    Bounds::new(Vector::ZERO, Vector::xy(side, side))
}

/// Share of a page that boards cover, and how much of them lies on others, as a share of the page.
fn covered(boards: &Boards, exemplar: &Exemplar<2>, side: f64, seed: u64) -> (f64, f64) {
    let request = Request { seed, ..Request::new(Domain::Box(page(side))) };
    let made = boards.fill(exemplar, &request, &mut Unobserved).unwrap().unwrap();
    let frame = vec![Vector::ZERO, Vector::xy(side, 0.0), Vector::xy(side, side), Vector::xy(0.0, side)];
    let frame = Outline { rings: vec![frame] };
    let seen = |p: &arabesque_core::Placement<2>| {
        exemplar.elements[p.source]
            .outline
            .transformed(&p.transform)
            .try_intersection(&frame, &Budget::default())
            .unwrap()
    };
    let all: Vec<Outline<2>> = made.placements.iter().map(seen).collect();
    let sum: f64 = all.iter().map(Outline::area).sum();
    let rings: Vec<_> = all.into_iter().flat_map(|outline| outline.rings).collect();
    let union = Outline::try_union(&rings, arabesque_core::FillRule::NonZero, &Budget::default()).unwrap().area();
    (union / side.powi(2), (sum - union) / side.powi(2))
}

#[test]
fn boards_cover_the_page_once_whatever_the_seed() {
    for heights in [[20.0, 20.0], [14.0, 26.0]] {
        let exemplar = rows(heights, 0.0, |p| p);
        let boards = Boards::new(&exemplar, &Budget::default()).unwrap().unwrap();
        for seed in 0..4 {
            let (share, twice) = covered(&boards, &exemplar, 330.0, seed);
            assert!(share > 0.9999 && twice < 1e-4, "{heights:?}, {seed}: {share}, {twice}");
        }
    }
}

#[test]
fn gaps_between_boards_stay_as_they_are_in_upright_rows_too() {
    let exemplar = rows([20.0, 20.0], 2.0, |p| Vector::xy(p[1], p[0]));
    let boards = Boards::new(&exemplar, &Budget::default()).unwrap().unwrap();
    let gaps = boards.courses.gaps;
    assert!((gaps[0] - 2.0).abs() < 1e-9 && (gaps[1] - 2.0).abs() < 1e-9, "{gaps:?}");
    let (share, twice) = covered(&boards, &exemplar, 300.0, 1);
    assert!((0.84..0.93).contains(&share) && twice < 1e-6, "{share}, {twice}");
}

#[test]
fn things_that_lie_in_no_rows_are_no_boards() {
    let mut exemplar = rows([20.0, 20.0], 0.0, |p| p);
    let mut stream = Stream::new(8, Stage::TEST, 0);
    for element in &mut exemplar.elements {
        let by = Vector::xy(stream.range(-9.0, 9.0), stream.range(-9.0, 9.0));
        element.centre += by;
        element.outline.rings[0].iter_mut().for_each(|p| *p += by);
    }
    assert!(Boards::new(&exemplar, &Budget::default()).unwrap().is_none());
}
