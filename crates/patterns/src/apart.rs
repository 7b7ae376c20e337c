//! Layers that say nothing of one another: a lattice of stars over speckles.
//!
//! A repeat is looked for in all that is drawn; what lies strewn over or under things that repeat would hide theirs. So where the
//! whole has none, parts of it are looked at: its strokes, and classes of elements.

use std::{collections::BTreeMap, sync::Arc};

use arabesque_core::{Budget, Domain, Exemplar, GridIndex, Result, Role, Vector};

use crate::{
    regular::Regular,
    repeat::{Explains, Extent},
};

/// Elements that repeat, at least, and strokes.
const LEAST: (usize, usize) = (9, 4);
/// Share of what a repeat takes to others of its kind, at least.
const SHARE: f64 = 0.9;
/// Things on a lattice are evenly apart: this share of them is as far from the nearest one as the median, up to that share of it. Looking for a
/// repeat costs a hundred times as much.
const EVEN: (f64, f64) = (0.75, 0.12);
/// Classes that are looked at, and those that are left out one after the other.
const CLASSES: usize = 12;
const WITHOUT: usize = 4;
/// Elements of the rest that may lie on what repeats where both keep clear of one another, as a share.
const MEET: f64 = 0.03;
/// How much of an element lies on another that is on it.
const ON: f64 = 0.02;
/// Mean of the phases in a lattice from which on things keep to it; of few things, this over the root of their number.
const KEEPS: (f64, f64) = (0.25, 2.5);
/// Share of the page in which half of what is strewn is not found, by its distance from a layer.
const AROUND: f64 = 0.25;
/// Work for a centre that is looked at.
const LOOK: u64 = 8;

/// A part of an exemplar that repeats by itself.
pub(crate) struct Layer {
    /// Whether each element, and each curve, is in it.
    pub(crate) elements: Vec<bool>,
    pub(crate) curves: Vec<bool>,
    pub(crate) regular: Arc<Regular>,
    /// Whether the rest keeps clear of it.
    pub(crate) is_clear: bool,
}

/// A part of an exemplar.
pub(crate) fn part<const D: usize>(exemplar: &Exemplar<D>, elements: &[bool], curves: &[bool]) -> Exemplar<D> {
    let mut part = exemplar.clone();
    let (mut e, mut c) = (elements.iter(), curves.iter());
    part.elements.retain(|_| e.next().copied().unwrap_or(false));
    part.curves.retain(|_| c.next().copied().unwrap_or(false));
    part
}

/// The part of an exemplar that repeats where all of it does not; `None` where none does.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn regular_layer(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Layer>> {
    if !exemplar.areas.is_empty() || exemplar.hole.is_some() || exemplar.period.is_some() {
        return Ok(None);
    }
    let classes = classes(exemplar);
    let of = |wanted: &[usize]| exemplar.elements.iter().map(|e| wanted.contains(&e.class)).collect::<Vec<bool>>();
    let (no_curves, all_curves) = (vec![false; exemplar.curves.len()], vec![true; exemplar.curves.len()]);
    let no_elements = vec![false; exemplar.elements.len()];
    let mut tried: Vec<(Vec<bool>, Vec<bool>)> = Vec::new();
    if exemplar.curves.len() >= LEAST.1 && !exemplar.elements.is_empty() {
        tried.push((no_elements, all_curves.clone()));
    }
    let mut repeating = Vec::new();
    if classes.len() > 1 {
        // Strokes that do not repeat run around the elements that do: they say a lot of one another.
        let alone = if exemplar.curves.is_empty() { CLASSES } else { 0 };
        for &(class, _) in classes.iter().filter(|(_, count)| *count >= LEAST.0).take(alone) {
            if found(exemplar, &of(&[class]), &no_curves, budget)?.is_some() {
                repeating.push(class);
            }
        }
        for count in (1..=repeating.len()).rev() {
            tried.push((of(&repeating[..count]), no_curves.clone()));
        }
        for &(left, _) in classes.iter().take(WITHOUT) {
            let others: Vec<usize> = classes.iter().map(|c| c.0).filter(|class| *class != left).collect();
            tried.push((of(&others), all_curves.clone()));
        }
    }
    for (elements, curves) in tried {
        let is_all = elements.iter().chain(&curves).all(|kept| *kept);
        let Some(regular) = (if is_all { None } else { found(exemplar, &elements, &curves, budget)? }) else {
            continue;
        };
        if !is_strewn(exemplar, &elements, regular.repeat.lattice.vectors, budget)? {
            continue;
        }
        let is_clear = is_clear(exemplar, &elements, budget)?;
        return Ok(Some(Layer { elements, curves, regular, is_clear }));
    }
    Ok(None)
}

/// Whether elements may lie on a lattice, by the distances to their nearest; those of an exemplar of few may.
fn is_even(exemplar: &Exemplar<2>, elements: &[bool], budget: &Budget) -> Result<bool> {
    let part = exemplar.elements.iter().zip(elements).filter(|(_, kept)| **kept);
    let centres: Vec<Vector<2>> = part.map(|(element, _)| element.centre).collect();
    if centres.len() < LEAST.0 {
        return Ok(true);
    }
    let reach = 3.0 * (exemplar.window.measure() / centres.len() as f64).sqrt();
    let index = GridIndex::new(&centres, reach, &Domain::Box(exemplar.window));
    let mut distances = Vec::with_capacity(centres.len());
    let mut meter = budget.meter();
    for (k, &centre) in centres.iter().enumerate() {
        let (nearest, looked) = index.nearest_counted(centre, reach, Some(k));
        meter.spend(LOOK * (1 + looked))?;
        distances.extend(nearest.map(|(_, distance)| distance));
    }
    distances.sort_by(f64::total_cmp);
    let Some(&median) = distances.get(distances.len() / 2) else { return Ok(false) };
    let alike = distances.iter().filter(|d| (*d - median).abs() <= EVEN.1 * median).count();
    Ok(alike as f64 >= EVEN.0 * centres.len() as f64)
}

/// Whether elements outside of a layer lie anywhere in the cells of its lattice: what keeps to places there belongs to it, however much it
/// was jittered.
fn is_strewn(exemplar: &Exemplar<2>, in_layer: &[bool], vectors: [Vector<2>; 2], budget: &Budget) -> Result<bool> {
    let all = || exemplar.elements.iter().zip(in_layer);
    let layer: Vec<Vector<2>> = all().filter(|(_, kept)| **kept).map(|(element, _)| element.centre).collect();
    let rest: Vec<_> = all().filter(|(_, kept)| !**kept).map(|(element, _)| (element.class, element.centre)).collect();
    if !is_anywhere(&rest.iter().map(|(_, p)| *p).collect::<Vec<_>>(), vectors) {
        return Ok(false);
    }
    // What is farther from the layer than a cell is wide is far, however far it is.
    let reach = vectors[0].norm() + vectors[1].norm();
    let index = GridIndex::new(&layer, reach, &Domain::Box(exemplar.window));
    let (mut of_class, mut meter) = (BTreeMap::<usize, (Vec<Vector<2>>, Vec<f64>)>::new(), budget.meter());
    for (class, p) in rest {
        let (nearest, looked) = index.nearest_counted(p, reach, None);
        meter.spend(LOOK * (1 + looked))?;
        let (places, far) = of_class.entry(class).or_default();
        places.push(p);
        far.push(nearest.map_or(reach, |(_, distance)| distance));
    }
    // How much of the page is nearer to one of them.
    let unit = std::f64::consts::PI * layer.len() as f64 / exemplar.window.measure();
    let is_free = |(places, far): (Vec<Vector<2>>, Vec<f64>)| {
        let shares = far.into_iter().map(|d| unit * d * d).collect();
        is_anywhere(&places, vectors) && !is_around(shares)
    };
    Ok(of_class.into_values().filter(|(places, _)| places.len() >= LEAST.0).all(is_free))
}

/// Whether half of some places are as far from the nearest of a layer as few would be by chance: for each, how much of the page is nearer.
fn is_around(mut shares: Vec<f64>) -> bool {
    shares.sort_by(f64::total_cmp);
    let open = (1.0 - shares.first().copied().unwrap_or(0.0)).max(0.1);
    let half = shares.len() / 2;
    let least = shares.windows(half + 1).map(|held| held[half] - held[0]).fold(f64::INFINITY, f64::min);
    least < open * AROUND.min(0.5 - 1.0 / (shares.len() as f64).sqrt())
}

/// Whether places lie anywhere in the cells of a lattice.
fn is_anywhere(places: &[Vector<2>], [a, b]: [Vector<2>; 2]) -> bool {
    let (count, cell) = (places.len().max(1) as f64, a.cross(b));
    let most = KEEPS.0.max(KEEPS.1 / count.sqrt());
    [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0]].into_iter().all(|[i, j]| {
        let turns = places.iter().map(|p| (i * p.cross(b) + j * a.cross(*p)) / cell * std::f64::consts::TAU);
        let sum = turns.fold(Vector::<2>::ZERO, |sum, turn| sum + Vector::xy(turn.cos(), turn.sin()));
        sum.norm() < most * count
    })
}

/// Classes with the number of whole elements in each, those with most first.
fn classes(exemplar: &Exemplar<2>) -> Vec<(usize, usize)> {
    let mut counts = vec![0; exemplar.classes.len()];
    exemplar.elements.iter().filter(|e| e.role == Role::Source).for_each(|e| counts[e.class] += 1);
    let mut classes: Vec<(usize, usize)> = counts.into_iter().enumerate().filter(|(_, count)| *count > 0).collect();
    classes.sort_by_key(|(class, count)| (std::cmp::Reverse(*count), *class));
    classes
}

/// How a part repeats, where it does so in two directions and all over.
fn found(exemplar: &Exemplar<2>, elements: &[bool], curves: &[bool], budget: &Budget) -> Result<Option<Arc<Regular>>> {
    if !is_even(exemplar, elements, budget)? {
        return Ok(None);
    }
    let part = part(exemplar, elements, curves);
    let whole = part.elements.iter().filter(|e| e.role == Role::Source).count();
    if whole < LEAST.0 && part.curves.len() < LEAST.1 {
        return Ok(None);
    }
    let regular = Regular::new(&part, budget)?;
    let repeats = |regular: &Regular| {
        let repeat = &regular.repeat;
        repeat.extent == Extent::Plane && repeat.explains == Explains::Everything && repeat.share >= SHARE
    };
    Ok(regular.filter(repeats).map(Arc::new))
}

/// Whether elements of one part lie on none of the other.
fn is_clear(exemplar: &Exemplar<2>, in_layer: &[bool], budget: &Budget) -> Result<bool> {
    let boxes: Vec<_> = exemplar.elements.iter().map(|e| e.outline.bounds()).collect();
    let (layer, rest): (Vec<usize>, Vec<usize>) = (0..boxes.len()).partition(|&e| in_layer[e]);
    let centre = |e: usize| exemplar.elements[e].centre;
    let radius = |e: usize| exemplar.elements[e].outline.radius(centre(e));
    let centres: Vec<Vector<2>> = layer.iter().map(|&l| centre(l)).collect();
    let widest = layer.iter().map(|&l| radius(l)).fold(0.0, f64::max);
    let index = GridIndex::new(&centres, widest.max(1e-9), &Domain::Box(exemplar.window));
    let (mut met, mut meter) = (0, budget.meter());
    for &r in &rest {
        let outline = &exemplar.elements[r].outline;
        let mut near = Vec::new();
        let looked = index.within(centre(r), radius(r) + widest, |k, _| near.push(layer[k]));
        meter.spend(LOOK * (1 + looked))?;
        near.sort_unstable();
        for l in near.into_iter().filter(|&l| boxes[l].intersects(&boxes[r])) {
            let common = outline.try_intersection(&exemplar.elements[l].outline, budget)?.area();
            if common > ON * outline.area() {
                met += 1;
                break;
            }
        }
    }
    Ok(met as f64 <= MEET * rest.len() as f64)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use arabesque_core::{Bounds, Class, Element, Outline, Similarity, Stage, Stream, Vector};

    use super::*;

    fn square(at: Vector<2>, half: f64, class: usize) -> Element<2> {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let ring = corners.iter().map(|&(x, y)| at + Vector::xy(x, y) * half).collect();
        let (outline, pose) = (Outline { rings: vec![ring] }, Similarity::shift(at));
        let (colour, lean, role) = ([0.0; 3], [Vector::ZERO; 3], Role::Source);
        Element { class, centre: at, pose, outline, colour, lean, role }
    }

    /// Squares on a lattice, or strewn, among small ones that are strewn and keep clear of them.
    fn drawing(on_lattice: bool) -> Exemplar<2> {
        let mut stream = Stream::new(4, Stage::TEST, 0);
        let mut free = |least: f64| Vector::xy(stream.range(least, 200.0 - least), stream.range(least, 200.0 - least));
        let node = |k: i32| Vector::xy(20.0 + 40.0 * f64::from(k % 5), 20.0 + 40.0 * f64::from(k / 5));
        let mut elements: Vec<_> =
            (0..25).map(|k| square(if on_lattice { node(k) } else { free(8.0) }, 6.0, 0)).collect();
        while elements.len() < 120 {
            let p = free(3.0);
            if elements.iter().all(|e| (e.centre - p).norm() > if e.class == 0 { 12.0 } else { 5.0 }) {
                elements.push(square(p, 1.0, 1));
            }
        }
        let classes = ["large", "small"].map(|name| Class { name: name.into() }).to_vec();
        Exemplar::new("t", elements, classes, Bounds::new(Vector::ZERO, Vector::xy(200.0, 200.0))).unwrap()
    }

    #[test]
    fn a_lattice_among_things_that_are_strewn_is_a_layer_of_its_own() {
        let exemplar = drawing(true);
        assert!(Regular::new(&exemplar, &Budget::default()).unwrap().is_none(), "all of it does not repeat");
        let layer = regular_layer(&exemplar, &Budget::default()).unwrap().unwrap();
        assert!(layer.is_clear);
        assert!(exemplar.elements.iter().zip(&layer.elements).all(|(e, is_in)| (e.class == 0) == *is_in));
        let sides = layer.regular.repeat.lattice.vectors.map(Vector::norm);
        assert!(sides.iter().all(|side| (side - 40.0).abs() < 0.1), "{sides:?}");
    }

    #[test]
    fn things_that_keep_to_places_of_the_cells_belong_to_the_lattice() {
        let mut exemplar = drawing(true);
        exemplar.elements.truncate(25);
        let mut stream = Stream::new(5, Stage::TEST, 0);
        for k in 0..25 {
            let off = Vector::xy(stream.range(12.0, 28.0), stream.range(12.0, 28.0));
            exemplar.elements.push(square(exemplar.elements[k].centre + off, 1.0, 1));
        }
        assert!(regular_layer(&exemplar, &Budget::default()).unwrap().is_none());
    }

    #[test]
    fn things_around_those_of_a_lattice_belong_to_them() {
        let mut exemplar = drawing(true);
        exemplar.elements.truncate(25);
        let mut stream = Stream::new(6, Stage::TEST, 0);
        for k in 0..25 {
            let (hub, turn) = (exemplar.elements[k].centre, stream.range(0.0, 1.0));
            for n in 0..6 {
                let angle = std::f64::consts::TAU * (turn + f64::from(n)) / 6.0;
                exemplar.elements.push(square(hub + Vector::xy(angle.cos(), angle.sin()) * 14.0, 1.0, 1));
            }
        }
        assert!(regular_layer(&exemplar, &Budget::default()).unwrap().is_none());
    }

    #[test]
    fn things_that_are_all_strewn_have_no_layer_that_repeats() {
        assert!(regular_layer(&drawing(false), &Budget::default()).unwrap().is_none());
    }
}
