//! Places that are alike in small patterns.

use arabesque_core::{Bounds, Budget, Domain, Matrix, Vector};

use super::{Places, Spot, Turned};

fn spot(x: f64, y: f64) -> Spot<2> {
    Spot { centre: Vector::xy(x, y), rotation: Matrix::identity(), scale: 1.0, class: 0 }
}

fn grid(n: usize) -> Vec<Spot<2>> {
    (0..n * n).map(|k| spot((k % n) as f64 + 0.5, (k / n) as f64 + 0.5)).collect()
}

fn page(size: f64) -> Domain<2> {
    Domain::Box(Bounds::new(Vector::ZERO, Vector::splat(size)))
}

fn alike(spots: &[Spot<2>], domain: &Domain<2>, spot: usize, threshold: f64) -> Vec<usize> {
    let places = Places::new(spots.to_vec(), domain, None, &Budget::default()).unwrap();
    places.alike(spot, threshold, &Budget::default()).unwrap().into_iter().map(|alike| alike.spot).collect()
}

#[test]
fn all_places_of_a_lattice_are_alike_at_its_edge_too() {
    let spots = grid(9);
    for from in [40, 0, 4, 80] {
        assert_eq!(alike(&spots, &page(9.0), from, 0.1).len(), 81, "{from}");
    }
    let places = Places::new(spots, &page(9.0), None, &Budget::default()).unwrap();
    assert!((places.spacing() - 1.0).abs() < 1e-9);
}

#[test]
fn fields_of_two_colours_are_told_apart() {
    let mut spots = grid(8);
    for (k, spot) in spots.iter_mut().enumerate() {
        spot.class = (k % 8 + k / 8) % 2;
    }
    let same: Vec<_> = (0..64).filter(|k| (k % 8 + k / 8) % 2 == 1).collect();
    assert_eq!(alike(&spots, &page(8.0), 1, 0.1), same);
}

#[test]
fn places_of_one_class_differ_by_what_is_around_them() {
    // Rows of pairs: a dot has its partner on the left or on the right.
    let spots: Vec<_> =
        (0..80).map(|k| spot((k % 10 / 2) as f64 * 3.0 + (k % 2) as f64, (k / 10) as f64 * 2.0)).collect();
    let found = alike(&spots, &page(20.0), 44, 0.1);
    assert!(found.iter().all(|n| n % 2 == 0), "{found:?}");
    assert_eq!(found.len(), 40);
}

#[test]
fn the_neighbours_of_a_hole_are_like_no_other() {
    let mut spots = grid(11);
    spots.remove(60);
    let found = alike(&spots, &page(11.0), 12, 0.1);
    let near = |n: &usize| (spots[*n].centre - Vector::xy(5.5, 5.5)).norm() < 1.9;
    assert!(!found.iter().any(near), "{found:?}");
    assert_eq!(found.len(), 112);
}

#[test]
fn turned_neighbourhoods_are_alike_in_their_own_frames() {
    // A lopsided cluster, many times, each turned in another way, far from one another.
    let mut spots = Vec::new();
    for k in 0..25 {
        let turn = Matrix::rotation(f64::from(k) * 1.1);
        let at = Vector::xy(f64::from(k % 5) * 20.0, f64::from(k / 5) * 20.0);
        for (class, [x, y]) in [[0.0, 0.0], [1.0, 0.0], [0.2, 1.3], [-0.7, -0.8]].into_iter().enumerate() {
            spots.push(Spot { centre: at + turn.apply(Vector::xy(x, y)), rotation: turn, scale: 1.0, class });
        }
    }
    let radius = |spots: &[Spot<2>]| {
        let spacing = Places::new(spots.to_vec(), &page(80.0), None, &Budget::default()).unwrap().spacing();
        Some(2.0 / spacing)
    };
    let places = Places::new(spots.clone(), &page(80.0), radius(&spots), &Budget::default()).unwrap();
    let found = places.alike(48, 0.05, &Budget::default()).unwrap();
    assert_eq!(found.len(), 25);
    assert!(found.iter().all(|a| a.spot % 4 == 0 && a.turned == Turned::WithElement));
    // In the frame of the page they differ.
    spots.iter_mut().for_each(|spot| spot.rotation = Matrix::identity());
    let places = Places::new(spots.clone(), &page(80.0), radius(&spots), &Budget::default()).unwrap();
    assert_eq!(places.alike(48, 0.02, &Budget::default()).unwrap().len(), 1);
}

#[test]
fn dice_that_lie_turned_in_a_grid_are_alike_on_the_page() {
    let mut spots = grid(7);
    for (k, spot) in spots.iter_mut().enumerate() {
        spot.rotation = Matrix::rotation(k as f64 * 0.7);
    }
    let places = Places::new(spots, &page(7.0), None, &Budget::default()).unwrap();
    let found = places.alike(24, 0.1, &Budget::default()).unwrap();
    assert_eq!(found.len(), 49);
    assert_eq!(found[25].turned, Turned::WithPage);
}

#[test]
fn a_tile_goes_on_across_its_edges() {
    let mut spots = grid(6);
    spots[7].class = 1;
    let tile = Domain::Torus(Bounds::new(Vector::ZERO, Vector::splat(6.0)));
    assert_eq!(alike(&spots, &tile, 28, 0.1).len(), 27);
}

#[test]
fn heaps_and_single_places_are_no_trouble() {
    assert_eq!(alike(&[spot(1.0, 1.0)], &page(2.0), 0, 0.1), [0]);
    let heap = vec![spot(1.0, 1.0); 500];
    assert_eq!(alike(&heap, &page(2.0), 0, 0.1).len(), 500);
    let places = Places::new(heap, &page(2.0), None, &Budget::default()).unwrap();
    assert!(
        places.alike(0, f64::NAN, &Budget::default()).is_err() && places.alike(0, -1.0, &Budget::default()).is_err()
    );
    assert!(Places::new(grid(2), &page(2.0), Some(0.0), &Budget::default()).is_err());
}

#[test]
fn space_has_neighbourhoods_too() {
    let spots: Vec<Spot<3>> = (0..343)
        .map(|k| {
            let centre = Vector([k % 7, k / 7 % 7, k / 49].map(f64::from));
            Spot { centre, rotation: Matrix::identity(), scale: 1.0, class: 0 }
        })
        .collect();
    let frame = Domain::Box(Bounds::new(Vector::splat(-0.5), Vector::splat(6.5)));
    let places = Places::new(spots, &frame, None, &Budget::default()).unwrap();
    assert_eq!(places.alike(171, 0.1, &Budget::default()).unwrap().len(), 343);
}
