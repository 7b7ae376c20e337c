//! Pages with one thing wrong, and what becomes of them.

#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use std::sync::Arc;

use arabesque_core::{
    Border, Bounds, Budget, Class, Domain, Element, Exemplar, Matrix, Numbered, Outline, Request, Role, Similarity,
    Stage, Stream, Vector,
};
use proptest::prelude::*;

use crate::{
    border::Extent,
    dimension::Dimension,
    evenness::{
        Evenness, counts,
        ink::{Inks, Pose},
        page::{Body, Measures, NOBODY, Page},
        strokes::Strokes,
        work::{Moves, Work},
    },
    exemplar::level_exemplar::{LevelExemplar, level_exemplars},
    optimise::targets::class_targets,
    output::{
        draft::{Draft, Frozen, Item},
        state::State,
    },
    params::{Deform, Params, Switch},
};

/// A square about a place.
fn square(class: usize, (x, y): (f64, f64), side: f64) -> Element<2> {
    let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
    let centre = Vector::xy(x, y);
    Element {
        class,
        centre,
        pose: Similarity::shift(centre),
        outline: Outline { rings: vec![corners.map(|(u, v)| centre + Vector::xy(u, v) * side).to_vec()] },
        colour: [0.5; 3],
        lean: [Vector::ZERO; 3],
        role: Role::Source,
    }
}

fn drawing(elements: Vec<Element<2>>, side: f64) -> Arc<Exemplar<2>> {
    let window = Bounds::new(Vector::ZERO, Vector::splat(side));
    let classes = elements.iter().map(|e| e.class).max().map_or(1, |most| most + 1);
    let classes = (0..classes).map(|c| Class { name: format!("{c}") }).collect();
    Arc::new(Exemplar::new("t", elements, classes, window).unwrap())
}

/// Places of a grid of `count` a side that are each a little off.
fn grid(count: u32, seed: u64) -> Vec<(f64, f64)> {
    let mut random = Stream::new(seed, Stage::TEST, 0);
    let mut off = || random.range(-0.6, 0.6);
    let cells = (0..count * count).map(|k| (f64::from(k % count), f64::from(k / count)));
    cells.map(|(x, y)| (10.0 * x + 5.0 + off(), 10.0 * y + 5.0 + off())).collect()
}

pub(super) fn squares() -> Arc<Exemplar<2>> {
    drawing(grid(12, 1).into_iter().map(|p| square(0, p, 4.0)).collect(), 120.0)
}

pub(super) fn sampled<const D: usize>(exemplar: &Arc<Exemplar<D>>) -> LevelExemplar<D> {
    let params = Params { levels: 1, ..Params::default() };
    level_exemplars(exemplar, None, &params, &Budget::default()).unwrap().remove(0)
}

fn item<const D: usize>(source: u32, position: Vector<D>) -> Item<D> {
    Item { source, position, frozen: None }
}

/// Looks at what is told.
type Look<'a, const D: usize> = &'a mut dyn FnMut(&[(Item<D>, Matrix<D>)]);

/// What becomes of items on a square page; calls `look` whenever something is told.
fn evened<const D: usize>(exemplar: &Arc<Exemplar<D>>, items: &[Item<D>], side: f64, look: Look<'_, D>) -> Vec<Item<D>>
where
    Vector<D>: Dimension<D>,
{
    evened_by(&Params::default(), exemplar, items, side, look)
}

/// The same with some moves alone.
fn evened_by<const D: usize>(
    params: &Params,
    exemplar: &Arc<Exemplar<D>>,
    items: &[Item<D>],
    side: f64,
    look: Look<'_, D>,
) -> Vec<Item<D>>
where
    Vector<D>: Dimension<D>,
{
    let sampled = sampled(exemplar);
    let page = Domain::Box(Bounds::new(Vector::ZERO, Vector::splat(side)));
    let request = Request { border: Border::Cross, ..Request::new(page) };
    let extent = Extent::new(&request, &sampled.exemplar, &sampled.library, sampled.level.base).unwrap();
    let targets = class_targets(&sampled.library, &request, &extent, sampled.level.base).unwrap();
    let draft = Draft { items: items.iter().map(|&i| (i, Matrix::identity())).collect(), links: Vec::new() };
    let mut state = State::new(&sampled, &request, &extent, Deform::Rigid, &draft);
    let count = exemplar.elements.len();
    let evenness = Evenness::new(exemplar, &sampled.library, None, count, &Budget::default()).unwrap().unwrap();
    let tell = &mut |items: &Vec<(Item<D>, Matrix<D>)>| {
        look(items);
        Ok(())
    };
    let (done, ended) = evenness.even_out(&state, &targets, params, tell).unwrap();
    ended.unwrap();
    done.write_back(&mut state);
    state.items().iter().filter(|live| live.alive).map(|live| live.item).collect()
}

fn evened_squares(items: &[Item<2>]) -> Vec<Item<2>> {
    evened(&squares(), items, 200.0, &mut |_| {})
}

fn page_of_squares() -> Vec<Item<2>> {
    grid(20, 2).into_iter().zip((0..144).cycle()).map(|((x, y), source)| item(source, Vector::xy(x, y))).collect()
}

/// Smallest distance of the centres of two items.
fn closest(items: &[Item<2>]) -> f64 {
    let pairs = items.iter().enumerate().flat_map(|(k, a)| items[..k].iter().map(move |b| (a.position, b.position)));
    pairs.map(|(a, b)| (a - b).norm()).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_hole_made_in_a_grid_is_filled() {
    let mut items = page_of_squares();
    let gone = items.remove(209).position;
    let after = evened_squares(&items);
    assert_eq!(after.len(), 400);
    assert!(after.iter().any(|i| (i.position - gone).norm() < 3.0), "nothing at {gone:?}");
    assert!(closest(&after) > 7.0, "{}", closest(&after));
}

#[test]
fn what_is_as_in_the_exemplar_stays() {
    let exemplar = squares();
    let items: Vec<_> = (0..).zip(&exemplar.elements).map(|(k, e)| item(k, e.centre)).collect();
    let after = evened(&exemplar, &items, 120.0, &mut |_| {});
    assert_eq!(after.len(), items.len());
    let stayed = items.iter().zip(&after).filter(|(a, b)| a == b).count();
    assert!(stayed >= 135, "{stayed} of 144");
    assert!(items.iter().zip(&after).all(|(a, b)| (a.position - b.position).norm() < 1.0));
}

#[test]
fn a_clump_is_thinned() {
    let mut items = page_of_squares();
    items.extend([(105.0, 105.0), (100.0, 110.0)].map(|(x, y)| item(7, Vector::xy(x, y))));
    let after = evened_squares(&items);
    assert!((399..=401).contains(&after.len()), "{}", after.len());
    assert!(closest(&after) > 6.5, "{}", closest(&after));
}

/// Columns of one large square and of two small ones above each other, in rows: `columns` times as many.
fn stones(columns: u32) -> Vec<(f64, f64, bool)> {
    let cells = (0..columns * 3 * columns / 2).map(|k| (f64::from(k % columns), f64::from(k / columns)));
    let stones = cells.flat_map(|(x, y)| {
        [(10.0, 10.0, true), (24.0, 5.0, false), (24.0, 15.0, false)].map(|s| (28.0 * x + s.0, 20.0 * y + s.1, s.2))
    });
    stones.collect()
}

#[test]
fn a_large_and_a_small_stone_swap_into_their_rooms() {
    let drawn = stones(6).into_iter().map(|(x, y, large)| square(0, (x, y), if large { 16.0 } else { 4.0 }));
    let exemplar = drawing(drawn.filter(|e| e.centre[1] < 168.0).collect(), 168.0);
    let is_large = |source: u32| exemplar.elements[source as usize].outline.area() > 50.0;
    let on_page = stones(8).into_iter().filter(|s| s.1 < 224.0);
    let mut items: Vec<_> = on_page.map(|(x, y, large)| item(u32::from(!large), Vector::xy(x, y))).collect();
    // Two neighbours in the middle of the page.
    let (wide, narrow) = (99, 100);
    (items[wide].source, items[narrow].source) = (items[narrow].source, items[wide].source);
    assert!(!is_large(items[wide].source) && is_large(items[narrow].source));
    let places = [items[wide].position, items[narrow].position];
    let off = Switch::Off;
    let exchange = Params { even_shift: off, even_fill: off, even_thin: off, ..Params::default() };
    let after = evened_by(&exchange, &exemplar, &items, 224.0, &mut |_| {});
    let nearest = |p: Vector<2>| {
        after.iter().min_by(|a, b| (a.position - p).norm().total_cmp(&(b.position - p).norm())).unwrap().source
    };
    let found = places.map(|p| is_large(nearest(p)));
    assert_eq!(found, [true, false]);
}

#[test]
fn what_is_frozen_never_moves() {
    let mut items = page_of_squares();
    items.remove(209);
    for (n, k) in (0..).zip((0..items.len()).step_by(3)) {
        items[k].frozen = Some(Frozen::Element(n));
    }
    // Two of them lie on each other.
    let first = items[60];
    items.push(Item { position: first.position + Vector::xy(1.0, 0.5), ..first });
    let frozen = |items: &[Item<2>]| items.iter().filter(|i| i.frozen.is_some()).copied().collect::<Vec<_>>();
    assert_eq!(frozen(&evened_squares(&items)), frozen(&items));
}

#[test]
fn dots_in_clusters_stay_clustered() {
    let mut random = Stream::new(9, Stage::TEST, 0);
    let mut cluster = |(x, y): (f64, f64)| {
        let mut off = || random.range(-1.0, 1.0);
        (0..5)
            .map(|k| (f64::from(k) * 1.26).sin_cos())
            .map(|(s, c)| (x + 3.5 * c + off(), y + 3.5 * s + off()))
            .collect()
    };
    let mut dots = |count: u32, step: f64| -> Vec<(f64, f64)> {
        let centres = (0..count * count).map(|k| (f64::from(k % count), f64::from(k / count)));
        centres.flat_map(|(x, y)| -> Vec<_> { cluster((step * (x + 0.5), step * (y + 0.5))) }).collect()
    };
    let exemplar = drawing(dots(6, 25.0).into_iter().map(|p| square(0, p, 1.2)).collect(), 150.0);
    let items: Vec<_> =
        dots(10, 25.0).into_iter().zip(0..).map(|((x, y), k)| item(k % 180, Vector::xy(x, y))).collect();
    let after = evened(&exemplar, &items, 250.0, &mut |_| {});
    let middle = |i: &&Item<2>| {
        [0, 1].iter().all(|&k| (i.position[k] / 25.0).fract() > 0.2 && (i.position[k] / 25.0).fract() < 0.8)
    };
    let kept = after.iter().filter(middle).count();
    assert!(kept as f64 > 0.97 * after.len() as f64 && after.len() > 485, "{kept} of {}", after.len());
}

/// Price of a whole page.
fn price<const D: usize>(exemplar: &Arc<Exemplar<D>>, items: &[Item<D>], side: f64) -> f64
where
    Vector<D>: Dimension<D>,
{
    let sampled = sampled(exemplar);
    let page = Domain::Box(Bounds::new(Vector::ZERO, Vector::splat(side)));
    let request = Request { border: Border::Cross, ..Request::new(page) };
    let extent = Extent::new(&request, &sampled.exemplar, &sampled.library, sampled.level.base).unwrap();
    let evenness = Evenness::new(exemplar, &sampled.library, None, exemplar.elements.len(), &Budget::default());
    let evenness = evenness.unwrap().unwrap();
    let draft = Draft { items: items.iter().map(|&i| (i, Matrix::identity())).collect(), links: Vec::new() };
    let state = State::new(&sampled, &request, &extent, Deform::Rigid, &draft);
    let (work, moves) = (Numbered::filled(0.0, sampled.library.classes()), Moves::new(&Params::default()));
    let bodies: Vec<_> = state.items().numbers().map(|i| evenness.body(&state, i)).collect();
    let budget = Budget::default();
    let shares = evenness.shares(&state, &bodies, moves, &budget).unwrap();
    let page = evenness.page(&state, bodies, &budget).unwrap();
    let known = (&evenness.natural, &*sampled.library);
    Work::new((page, shares), known, (&extent, budget.clone()), (counts(&state), work), moves)
        .total(&mut budget.meter())
        .unwrap()
}

fn dots_in_space() -> Arc<Exemplar<3>> {
    let mut random = Stream::new(3, Stage::TEST, 0);
    let mut off = || random.range(-1.5, 1.5);
    let cells = (0..343).map(|k: i32| [k % 7, k / 7 % 7, k / 49].map(f64::from));
    let points: Vec<_> = cells.map(|cell| Vector(cell.map(|c| 10.0 * c + 5.0 + off()))).collect();
    Arc::new(Exemplar::from_points("t", &points, &[0; 343], &["dot".into()]).unwrap())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4, ..ProptestConfig::default() })]

    #[test]
    fn the_price_of_a_page_never_rises(seed in 0_u64..1000) {
        let mut random = Stream::new(seed, Stage::TEST, 1);
        let items: Vec<_> = (0..140)
            .map(|k| item(k, Vector::xy(random.range(0.0, 120.0), random.range(0.0, 120.0))))
            .collect();
        let mut last = price(&squares(), &items, 120.0);
        let mut rose = Vec::new();
        let mut look = |items: &[(Item<2>, Matrix<2>)]| {
            let now = price(&squares(), &items.iter().map(|i| i.0).collect::<Vec<_>>(), 120.0);
            if now > last + 1e-6 {
                rose.push((last, now));
            }
            last = now;
        };
        let before = price(&squares(), &items, 120.0);
        let after = evened(&squares(), &items, 120.0, &mut look);
        let after = price(&squares(), &after, 120.0);
        prop_assert!(rose.is_empty(), "{rose:?}");
        prop_assert!(after < 0.3 * before, "{before} to {after}");
    }

    #[test]
    fn dots_in_space_are_evened_out(seed in 0_u64..1000) {
        let exemplar = dots_in_space();
        let mut random = Stream::new(seed, Stage::TEST, 1);
        let mut place = || Vector(std::array::from_fn(|_| random.range(0.0, 50.0)));
        let items: Vec<Item<3>> = (0..125).map(|k| item(k, place())).collect();
        let before = price(&exemplar, &items, 50.0);
        let after = evened(&exemplar, &items, 50.0, &mut |_| {});
        prop_assert!((125..=178).contains(&after.len()), "{}", after.len());
        prop_assert!(price(&exemplar, &after, 50.0) < 0.3 * before);
    }

    #[test]
    fn a_page_that_has_changed_is_like_one_made_anew(seed in 0_u64..1000) {
        let (exemplar, budget) = (squares(), Budget::default());
        let sampled = sampled(&exemplar);
        let domain = Bounds::new(Vector::ZERO, Vector::splat(80.0));
        let domain = if seed.is_multiple_of(2) { Domain::Box(domain) } else { Domain::Torus(domain) };
        let request = Request::new(domain);
        let extent = Extent::new(&request, &sampled.exemplar, &sampled.library, sampled.level.base).unwrap();
        let evenness = Evenness::new(&exemplar, &sampled.library, None, 144, &budget).unwrap().unwrap();
        let measures = Measures { spacing: 10.0, tolerated: 4.0, reach: 9.0 };
        let none = Strokes::of_exemplar(None, &sampled.library);
        let fresh = |bodies: Vec<Body<2>>| Page::new(&extent, &evenness.inks, bodies, measures, none.clone(), &budget).unwrap();
        let mut page = fresh(Vec::new());
        let mut random = Stream::new(seed, Stage::TEST, 2);
        let mut meter = budget.meter();
        for _ in 0..120 {
            let place = Vector::xy(random.range(0.0, 80.0), random.range(0.0, 80.0));
            let pose = page.pose(random.below(144) as u32, place, &Matrix::identity());
            let living: Vec<u32> = (0..page.bodies.len() as u32).filter(|&b| page.body(b).alive).collect();
            match (random.below(4), living.as_slice()) {
                (0, [_, ..]) => page.remove(living[random.below(living.len())], &mut meter).unwrap(),
                (1 | 2, [_, ..]) => page.change(living[random.below(living.len())], pose, &mut meter).unwrap(),
                _ => _ = page.add(pose, &mut meter).unwrap(),
            }
        }
        let anew = fresh(page.bodies.clone());
        for (a, b) in page.cells.iter().zip(&anew.cells) {
            prop_assert!((a.distance[0] - b.distance[0]).abs() < 1e-4 && (a.distance[1] - b.distance[1]).abs() < 1e-4);
        }
    }
}

#[test]
fn a_part_of_a_page_is_as_it_is_on_the_whole() {
    let (exemplar, budget) = (squares(), Budget::default());
    let sampled = sampled(&exemplar);
    let domain = Bounds::new(Vector::ZERO, Vector::splat(120.0));
    for domain in [Domain::Box(domain), Domain::Torus(domain)] {
        let request = Request::new(domain);
        let extent = Extent::new(&request, &sampled.exemplar, &sampled.library, sampled.level.base).unwrap();
        let evenness = Evenness::new(&exemplar, &sampled.library, None, 144, &budget).unwrap().unwrap();
        let measures = Measures { spacing: 10.0, tolerated: 4.0, reach: 9.0 };
        let none = Strokes::of_exemplar(None, &sampled.library);
        let mut page = Page::new(&extent, &evenness.inks, Vec::new(), measures, none, &budget).unwrap();
        let mut meter = budget.meter();
        for ((x, y), source) in grid(12, 5).into_iter().zip(0..) {
            page.add(page.pose(source, Vector::xy(x, y), &Matrix::identity()), &mut meter).unwrap();
        }
        // Elements that went leave their numbers behind.
        (0..40).step_by(7).for_each(|b| page.remove(b, &mut meter).unwrap());
        for p in [Vector::xy(60.0, 60.0), Vector::xy(5.0, 118.0)] {
            let (part, numbers) = page.part_around(p, 30.0, &mut vec![NOBODY; 200]);
            let (mut places, mut k) = (Vec::new(), 0);
            page.lattice.around(p, 30.0, |c, _| {
                let (cell, here) = (&page.cells[c], &part.cells[k]);
                let near = here.near.map(|b| numbers.get(b as usize).copied().unwrap_or(b));
                assert_eq!((near, here.distance, here.still), (cell.near, cell.distance, cell.still));
                assert_eq!(part.lattice.centre(k), page.lattice.centre(c));
                places.push(c);
                k += 1;
            });
            let beside =
                part.neighbours(p, 12.0, u32::MAX).into_iter().map(|b| numbers[b as usize]).collect::<Vec<_>>();
            assert_eq!(beside, page.neighbours(p, 12.0, u32::MAX));
            // What is changed in it far from its rim is what would be changed on the whole.
            let (mut part, (mut whole, all)) = (part, page.part_around(p, 1e4, &mut vec![NOBODY; 200]));
            let b = part.neighbours(p, 4.0, u32::MAX)[0];
            let pose = part.pose(7, p + Vector::xy(1.0, -2.0), &Matrix::identity());
            part.change(b, pose, &mut meter).unwrap();
            let there = all.binary_search(&numbers[b as usize]).unwrap() as u32;
            whole.change(there, pose, &mut meter).unwrap();
            let mut far = Vec::new();
            whole.lattice.around(p, 30.0, |c, _| far.push(whole.cells[c].distance));
            assert_eq!(part.cells.iter().map(|cell| cell.distance).collect::<Vec<_>>(), far);
        }
    }
}

#[test]
fn places_far_apart_come_out_the_same_on_any_number_of_threads() {
    let mut items = page_of_squares();
    // Holes and clumps all over the page.
    for k in (0..10).rev() {
        let moved = items.remove(37 * k + 8);
        items.push(Item { position: items[29 * k].position + Vector::xy(1.5, 1.0), ..moved });
    }
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| evened_squares(&items))
    };
    let one = on(1);
    assert!(closest(&one) > 6.0, "{}", closest(&one));
    for threads in [2, 5] {
        assert_eq!(on(threads), one, "{threads} threads");
    }
}

/// A square, a bar that is much longer than it is wide, and small squares around.
fn square_and_bar() -> Arc<Exemplar<2>> {
    let mut bar = square(1, (40.0, 20.0), 1.0);
    let corners = [(-6.0, -0.2), (6.0, -0.2), (6.0, 0.2), (-6.0, 0.2)];
    bar.outline.rings = vec![corners.map(|(x, y)| Vector::xy(40.0 + x, 20.0 + y)).to_vec()];
    let mut elements = vec![square(0, (20.0, 20.0), 6.0), bar];
    elements.extend(grid(16, 3).into_iter().map(|(x, y)| square(2, (0.375 * x, 0.375 * y), 1.0)));
    drawing(elements, 60.0)
}

#[test]
fn an_end_that_sticks_in_another_element_is_as_deep_as_it_reaches() {
    let exemplar = square_and_bar();
    let inks = Inks::new(&exemplar, &sampled(&exemplar).library, 2, 20.0, &Budget::default()).unwrap();
    let pose = |source, x: f64| Pose { source, centre: Vector::xy(x, 0.0), rotation: Matrix::identity(), scale: 1.0 };
    let gap = |x: f64, enough: f64| inks.gap(&pose(0, 0.0), &pose(1, x), Vector::xy(x, 0.0), enough);
    for (x, depth) in [(11.0, 2.0), (8.0, -1.0), (7.5, -1.5), (6.5, -2.5)] {
        let found = gap(x, 5.0);
        assert!((found - depth).abs() < 0.5, "{found} at {x}");
        assert_eq!(found, inks.gap(&pose(1, x), &pose(0, 0.0), Vector::xy(-x, 0.0), 5.0));
    }
    assert!(gap(11.0, 1.0) > 1.0);
}

/// Large squares anywhere, each with a small one beside it, in any direction.
fn pairs() -> Arc<Exemplar<2>> {
    let mut random = Stream::new(9, Stage::TEST, 0);
    let mut elements: Vec<Element<2>> = Vec::new();
    for (x, y) in grid(8, 4) {
        let (x, y) = (2.0 * x + random.range(-3.0, 3.0), 2.0 * y + random.range(-3.0, 3.0));
        let angle = random.range(0.0, std::f64::consts::TAU);
        elements.push(square(0, (x, y), 4.0));
        let far = random.range(4.2, 4.8);
        elements.push(square(1, (x + far * angle.cos(), y + far * angle.sin()), 1.0));
    }
    drawing(elements, 160.0)
}

#[test]
fn what_always_stands_beside_another_stays_with_it() {
    let exemplar = pairs();
    let sampled = sampled(&exemplar);
    let evenness = |e: &Arc<Exemplar<2>>, s: &LevelExemplar<2>| {
        Evenness::new(e, &s.library, None, e.elements.len(), &Budget::default()).unwrap().unwrap()
    };
    let natural = evenness(&exemplar, &sampled).natural;
    assert!((0..2).all(|kind| natural.clear(kind).is_none()), "both are bound");
    let alone = squares();
    assert!(evenness(&alone, &self::sampled(&alone)).natural.clear(0).is_some(), "these stand by themselves");
    // Nothing moves, whatever the page looks like.
    let items: Vec<_> = (0..exemplar.elements.len() as u32)
        .map(|e| item(e, exemplar.elements[e as usize].centre + Vector::xy(3.0 * f64::from(e % 3), 0.0)))
        .collect();
    let after = evened(&exemplar, &items, 160.0, &mut |_| ());
    assert!(items.iter().zip(&after).all(|(a, b)| a.source == b.source && a.position == b.position));
}
