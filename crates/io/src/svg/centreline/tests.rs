use arabesque_core::{FillRule, Vector};

use super::*;

fn centrelines(outline: &Outline<2>, frame: Option<&Bounds<2>>) -> Option<Centrelines> {
    super::centrelines(outline, frame, &Budget::default()).unwrap()
}

fn bar(a: (f64, f64), b: (f64, f64), width: f64) -> Vec<Vector<2>> {
    let (a, b) = (Vector::xy(a.0, a.1), Vector::xy(b.0, b.1));
    let d = b - a;
    let side = Vector::xy(-d[1], d[0]) * (0.5 * width / d.norm());
    vec![a + side, a - side, b - side, b + side]
}

fn disc(centre: (f64, f64), radius: f64, n: usize) -> Vec<Vector<2>> {
    let at = |k: usize| std::f64::consts::TAU * k as f64 / n as f64;
    (0..n).map(|k| Vector::xy(centre.0 + radius * at(k).cos(), centre.1 + radius * at(k).sin())).collect()
}

fn union(rings: &[Vec<Vector<2>>]) -> Outline<2> {
    Outline::try_union(rings, FillRule::NonZero, &Budget::default()).unwrap()
}

fn has_end(path: &Path<2>, x: f64, y: f64) -> bool {
    [path.start(), path.end()].iter().flatten().any(|p| (*p - Vector::xy(x, y)).norm() < 0.05)
}

#[test]
fn a_plus_sign_is_two_straight_strokes() {
    let plus = union(&[bar((0.0, 10.0), (20.0, 10.0), 2.0), bar((10.0, 0.0), (10.0, 20.0), 2.0)]);
    let found = centrelines(&plus, None).unwrap();
    assert!((found.width - 2.0).abs() < 1e-6 && found.spread < 1e-6);
    assert_eq!(found.paths.len(), 2);
    assert!(found.paths.iter().all(|p| p.cubics.len() == 1 && !p.closed));
    // Butt ends stay where they are: half a width beyond the end of a stroke with round caps.
    for (x, y) in [(1.0, 10.0), (19.0, 10.0), (10.0, 1.0), (10.0, 19.0)] {
        assert!(found.paths.iter().any(|p| has_end(p, x, y)), "{x} {y}: {:?}", found.paths);
    }
}

#[test]
fn strokes_run_up_to_the_frame() {
    let found = centrelines(
        &union(&[bar((0.0, 5.0), (30.0, 5.0), 1.0)]),
        Some(&Bounds::new(Vector::ZERO, Vector::xy(20.0, 10.0))),
    );
    assert!(has_end(&found.unwrap().paths[0], 0.0, 5.0));
}

#[test]
fn a_ring_is_one_closed_round_path() {
    let rings = [disc((5.0, 5.0), 10.5, 200), disc((5.0, 5.0), 9.5, 200)];
    let ring = Outline::try_union(&rings, FillRule::EvenOdd, &Budget::default()).unwrap();
    let found = centrelines(&ring, None).unwrap();
    assert_eq!(found.paths.len(), 1);
    let path = &found.paths[0];
    assert!(path.closed && path.cubics.len() <= 12, "{}", path.cubics.len());
    assert!(path.flatten(0.01).iter().all(|p| ((*p - Vector::xy(5.0, 5.0)).norm() - 10.0).abs() < 0.05));
}

#[test]
fn hexagon_cells_meet_at_their_corners() {
    let mut bars = Vec::new();
    let mut corners = Vec::new();
    for (cx, cy) in [(0.0, 0.0), (17.320_508, 0.0), (8.660_254, 15.0)] {
        let at = |k: usize| (30.0 + 60.0 * k as f64).to_radians();
        let corner = |k: usize| (cx + 10.0 * at(k).cos(), cy + 10.0 * at(k).sin());
        for k in 0..6 {
            bars.push(bar(corner(k), corner(k + 1), 1.0));
            bars.push(disc(corner(k), 0.5, 24));
            corners.push(corner(k));
        }
    }
    let found = centrelines(&union(&bars), None).unwrap();
    assert!((found.width - 1.0).abs() < 0.01);
    let nodes: Vec<_> = found.paths.iter().flat_map(|p| p.cubics.iter().flat_map(|c| [c[0], c[3]])).collect();
    for (x, y) in corners {
        assert!(nodes.iter().any(|p| (*p - Vector::xy(x, y)).norm() < 0.12), "no node at {x} {y}");
    }
    assert!(found.paths.iter().flat_map(|p| &p.cubics).all(|c| {
        let chord = c[3] - c[0];
        chord.cross(c[1] - c[0]).abs() < 1e-6 * chord.norm2()
    }));
}

#[test]
fn the_corner_of_an_angle_stays_sharp() {
    let angle = union(&[bar((0.0, 0.0), (20.5, 0.0), 1.0), bar((20.0, -0.5), (20.0, 15.0), 1.0)]);
    let found = centrelines(&angle, None).unwrap();
    assert_eq!(found.paths.len(), 1);
    assert_eq!(found.paths[0].cubics.len(), 2, "{:?}", found.paths[0]);
    assert!((found.paths[0].cubics[0][3] - Vector::xy(20.0, 0.0)).norm() < 0.02);
}

#[test]
fn blobs_and_wedges_are_no_strokes() {
    assert_eq!(centrelines(&union(&[disc((0.0, 0.0), 5.0, 60)]), None), None);
    let square = bar((0.0, 5.0), (10.0, 5.0), 10.0);
    assert_eq!(centrelines(&union(&[square]), None), None);
    let wedge = vec![Vector::xy(0.0, 0.0), Vector::xy(30.0, -2.0), Vector::xy(30.0, 2.0)];
    assert_eq!(centrelines(&union(&[wedge]), None), None);
    // A line beside a disc that it would leave out.
    assert_eq!(centrelines(&union(&[bar((0.0, 0.0), (60.0, 0.0), 1.0), disc((30.0, 9.0), 3.0, 40)]), None), None);
}

#[test]
fn degenerate_outlines_are_no_strokes() {
    assert_eq!(centrelines(&Outline::default(), None), None);
    let line = vec![Vector::ZERO, Vector::xy(5.0, 0.0), Vector::xy(9.0, 0.0)];
    assert_eq!(centrelines(&Outline { rings: vec![line] }, None), None);
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        let ring = vec![Vector::ZERO, Vector::xy(5.0, 0.0), Vector::xy(0.0, bad)];
        assert_eq!(centrelines(&Outline { rings: vec![ring] }, None), None);
    }
    assert_eq!(centrelines(&Outline { rings: vec![vec![], vec![Vector::ZERO]] }, None), None);
}

#[test]
fn most_corners_of_a_zigzag_are_sharp() {
    for turn in 0..12 {
        let (s, c) = (f64::from(turn) * 7.3).to_radians().sin_cos();
        let at = |x: f64, y: f64| Vector::xy(c * x - s * y, s * x + c * y);
        let upper = (0..7).map(|k| at(8.0 * f64::from(k), 8.0 * f64::from(k % 2)));
        let lower = (0..7).rev().map(|k| at(8.0 * f64::from(k), 8.0 * f64::from(k % 2) + 2.0_f64.sqrt()));
        let found = centrelines(&union(&[upper.chain(lower).collect()]), None).unwrap();
        assert_eq!(found.paths.len(), 1);
        // Up to two of the five corners may come out as short bends.
        let segments = found.paths[0].cubics.len();
        assert!((6..=8).contains(&segments), "turned {turn}: {segments}");
    }
}

#[test]
fn fewer_than_two_points_have_no_path() {
    let point = (Vector::xy(1.0, 1.0), true);
    for closed in [false, true] {
        assert!(super::fit::fitted(&[], closed, 1.0).is_empty());
        assert!(super::fit::fitted(&[point], closed, 1.0).is_empty());
        assert!(!super::fit::fitted(&[point, (Vector::xy(5.0, 1.0), true)], closed, 1.0).is_empty());
    }
}

#[test]
fn half_lines_along_the_frame_are_dropped() {
    let lines = (0..6).flat_map(|k| {
        let at = 20.0 * f64::from(k);
        [bar((0.0, at), (100.0, at), 2.0), bar((at, 0.0), (at, 100.0), 2.0)]
    });
    let frame = Bounds::new(Vector::ZERO, Vector::xy(100.0, 100.0));
    let page = Outline { rings: vec![bar((0.0, 50.0), (100.0, 50.0), 100.0)] };
    let on_page = union(&lines.collect::<Vec<_>>()).try_intersection(&page, &Budget::default()).unwrap();
    let found = centrelines(&on_page, Some(&frame)).unwrap();
    assert!((found.width - 2.0).abs() < 0.05, "{}", found.width);
    assert_eq!(found.paths.len(), 8, "{:?}", found.paths.iter().map(Path::bounds).collect::<Vec<_>>());
    assert!(found.paths.iter().all(|p| (p.bounds().size().norm() - 100.0).abs() < 0.1), "{:?}", found.paths);
}
