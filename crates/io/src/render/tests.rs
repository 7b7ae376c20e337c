use arabesque_core::{Budget, Error, Limits, PointSet, Similarity, TriangleMesh, Vector};

use super::{Background, Extent, Item, Look, View, draw, write_picture};
use crate::raster::png;

fn square() -> TriangleMesh {
    let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
    TriangleMesh {
        positions: corners.map(|[x, y]| Vector([x, y, 0.0])).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        colours: Some(vec![[1.0, 0.0, 0.0]; 4]),
        ..TriangleMesh::default()
    }
}

fn look(longer: usize) -> Look {
    Look { view: Some(View::TOP), extent: Extent::Longer(longer), ..Look::default() }
}

#[test]
fn a_picture_is_as_wide_as_what_it_shows() {
    let mesh = square();
    let image = draw(&[Item::Mesh(&mesh)], &look(100), &Budget::default()).unwrap();
    assert_eq!((image.width, image.height), (100, 50));
    let [r, g, b, alpha] = image.pixel(50, 25);
    assert!(r > 150 && g < 90 && b < 90 && alpha == 255);
    assert_eq!(image.pixel(0, 0), [255; 4]);
    let exactly = Look { extent: Extent::Exactly([30, 70]), background: Background::Transparent, ..look(1) };
    let image = draw(&[Item::Mesh(&mesh)], &exactly, &Budget::default()).unwrap();
    assert_eq!((image.width, image.height, image.pixel(15, 5)[3], image.pixel(15, 35)[3]), (30, 70, 0, 255));
}

#[test]
fn from_below_the_back_is_seen_and_darker() {
    let mesh = square();
    let view = |elevation| Look { view: Some(View { azimuth: -90.0, elevation }), ..look(60) };
    let red = |elevation| draw(&[Item::Mesh(&mesh)], &view(elevation), &Budget::default()).unwrap().pixel(30, 15)[0];
    assert!(red(90.0) > red(-90.0) + 20);
}

#[test]
fn what_is_nearer_hides_what_is_farther_whatever_it_is() {
    let mesh = square();
    let mut points = PointSet::at(vec![Vector([0.5, 0.5, 1.0]), Vector([1.5, 0.5, -1.0])]);
    points.radii = Some(vec![0.2; 2]);
    points.colours = Some(vec![[0.0, 0.0, 1.0]; 2]);
    let image = draw(&[Item::Points(&points), Item::Mesh(&mesh)], &look(100), &Budget::default()).unwrap();
    let blue = |x: usize| image.pixel(x, 25)[2] > image.pixel(x, 25)[0];
    assert_eq!((blue(27), blue(73)), (true, false));
}

#[test]
fn placed_meshes_have_colours_of_their_own() {
    let mesh = TriangleMesh { colours: None, ..square() };
    let places = [0.0, 3.0].map(|x| Similarity::shift(Vector([x, 0.0, 0.0])));
    let image = draw(&[Item::Placed(&mesh, &places)], &look(100), &Budget::default()).unwrap();
    assert_ne!(image.pixel(20, 12), image.pixel(80, 12));
}

#[test]
fn points_of_the_plane_are_seen_from_above() {
    let points = PointSet::<2>::at(vec![Vector::xy(0.0, 0.0), Vector::xy(4.0, 1.0)]);
    let look = Look { extent: Extent::Exactly([50, 50]), ..Look::default() };
    let image = draw(&[Item::Plane(&points)], &look, &Budget::default()).unwrap();
    let drawn = |from: usize, to: usize| {
        (0..50 * 50).filter(|k| (from..to).contains(&(k / 50))).any(|k| image.pixels[k] != [255; 4])
    };
    assert!(drawn(25, 50) && drawn(0, 25));
}

#[test]
fn odd_things_are_drawn_or_refused() {
    let nothing = TriangleMesh::default();
    let error = draw(&[Item::Mesh(&nothing)], &Look::default(), &Budget::default()).unwrap_err();
    assert!(error.to_string().contains("nothing to draw"), "{error}");
    let lone = PointSet::at(vec![Vector([3.0, 3.0, 3.0])]);
    let image =
        draw(&[Item::Points(&lone)], &Look { extent: Extent::Longer(40), ..Look::default() }, &Budget::default())
            .unwrap();
    assert_ne!(image.pixel(20, 20), [255; 4]);
    let far = PointSet::at(vec![Vector([1e9, 0.0, 0.0]), Vector([1e9, 1e-9, 0.0]), Vector([-1e9, 0.0, 0.0])]);
    assert!(draw(&[Item::Points(&far)], &look(40), &Budget::default()).is_ok());
}

#[test]
fn limits_hold_and_the_recipe_is_found() {
    let mesh = square();
    let bytes = write_picture(&[Item::Mesh(&mesh)], &look(40), Some("seed = 1\n"), &Budget::default()).unwrap();
    assert_eq!(png::recipe_of(&bytes).as_deref(), Some("seed = 1\n"));
    for limits in [
        Limits { pixels: 100, ..Limits::default() },
        Limits { memory: 1000, ..Limits::default() },
        Limits { work: 0, ..Limits::default() },
    ] {
        let drawn = draw(&[Item::Mesh(&mesh)], &look(40), &Budget::new(limits));
        assert!(matches!(drawn, Err(Error::Limit { .. })), "{limits:?}");
    }
    let checks = Budget::stopping_at(Limits::default(), u64::MAX);
    draw(&[Item::Mesh(&mesh)], &look(40), &checks).unwrap();
    for n in (1..=checks.checks()).step_by(7) {
        let drawn = draw(&[Item::Mesh(&mesh)], &look(40), &Budget::stopping_at(Limits::default(), n));
        assert!(matches!(drawn, Err(Error::Stopped { .. })), "{n}");
    }
}

/// A bumpy sheet of many triangles, and points over it.
fn bumpy() -> (TriangleMesh, PointSet<3>) {
    let at =
        |k: u32| Vector([f64::from(k % 90) / 90.0, f64::from(k / 90) / 90.0, 0.1 * f64::from(k * 7919 % 100) / 100.0]);
    let corner = |k: u32| [[k, k + 1, k + 91], [k, k + 91, k + 90]];
    let triangles = (0..89 * 90).filter(|k| k % 90 < 89).flat_map(corner).collect();
    let mesh = TriangleMesh { positions: (0..8100).map(at).collect(), triangles, ..TriangleMesh::default() };
    (mesh, PointSet::at((0..3000).map(|k| at(k * 3 % 8100) + Vector([0.0, 0.0, 0.02])).collect()))
}

#[test]
fn pictures_are_the_same_for_any_number_of_threads() {
    let (mesh, points) = bumpy();
    let places = [0.0, 0.5, 1.2].map(|x| Similarity::shift(Vector([x, 0.3 * x, 0.0])));
    let items = [Item::Placed(&mesh, &places), Item::Points(&points)];
    let drawn = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let budget = Budget::default();
        let look = Look { extent: Extent::Exactly([211, 173]), ..Look::default() };
        let image = pool.install(|| draw(&items, &look, &budget).unwrap());
        (image.pixels, budget.work())
    };
    let one = drawn(1);
    assert!(one.0.iter().any(|p| *p != [255; 4]));
    for threads in [2, 3, 8] {
        assert!(drawn(threads) == one, "{threads} threads");
    }
}
