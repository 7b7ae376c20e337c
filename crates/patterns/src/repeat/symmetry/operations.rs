//! Asking for the operations that a group is known by.

use std::f64::consts::TAU;

use arabesque_core::{Budget, Exemplar, Matrix, Result, Vector};

use crate::repeat::{
    description::{Extent, Repeat},
    lattice::{Lattice, are_parallel},
    lines::Lines,
    symmetry::{
        content::Content,
        groups::{FriezeGroup, Mirror, PlaneGroup, Symmetry},
    },
};

/// A lattice is taken to itself when its vectors land this near to nodes: as a share of the shorter one, and in terms
/// of the jitter.
const ON_NODE: (f64, f64) = (0.012, 0.5);

/// A glide by less than this share of the shortest translation along it is none.
const NO_GLIDE: f64 = 0.2;

/// Nodes this far away are looked at for vectors along an axis.
const FAR: i64 = 6;

/// The torus of a frieze is so many heights of its frame high, so that what lies at its edges does not meet.
const APART: f64 = 3.0;

/// How far a stripe may lie off, as a share of the distance after which they repeat.
const STRIPE: f64 = 0.01;

/// The symmetry of an exemplar with a repeat. Where only places repeat, it is that of the places.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub fn symmetry(exemplar: &Exemplar<2>, repeat: &Repeat, budget: &Budget) -> Result<Symmetry> {
    let budget = &budget.stage("looking for symmetries");
    match repeat.extent {
        Extent::Plane => plane(exemplar, repeat, budget).map(Symmetry::Plane),
        Extent::Frieze => frieze(exemplar, repeat, budget).map(Symmetry::Frieze),
        Extent::Stripes(along) => {
            let lines = Lines::new(exemplar, budget)?;
            Ok(Symmetry::Stripes { mirrored: are_mirrored(&lines, along, repeat, budget)? })
        }
    }
}

fn plane(exemplar: &Exemplar<2>, repeat: &Repeat, budget: &Budget) -> Result<PlaneGroup> {
    let lattice = repeat.lattice;
    let content = Content::new(exemplar, repeat, lattice, budget)?;
    if content.is_empty() {
        return Ok(PlaneGroup::P1);
    }
    let shorter = lattice.shorter();
    let slack = ON_NODE.0 * shorter + ON_NODE.1 * repeat.jitter;
    let keeps = |m: &Matrix<2>| lattice.vectors.iter().all(|v| lattice.nearest(m.apply(*v)).1.norm() <= slack);
    let mut order = 1;
    for n in [6, 4, 3, 2] {
        let turn = Matrix::rotation(TAU / f64::from(n));
        if keeps(&turn) && content.operation(&turn, budget)?.is_some() {
            order = n;
            break;
        }
    }
    let mut mirrors = Vec::new();
    for axis in axes(&lattice) {
        let flip = reflection(axis);
        if !keeps(&flip) {
            continue;
        }
        let Some(operation) = content.operation(&flip, budget)? else { continue };
        let (along, shortest) = translations_along(&lattice, axis);
        let off = operation.shift.dot(axis) / shortest;
        let is_along_shortest = along.is_some_and(|length| length < 1.05 * shorter);
        let is_centred = along.is_some_and(|length| length > 1.5 * shortest);
        mirrors.push(Mirror { is_mirror: (off - off.round()).abs() < NO_GLIDE, is_centred, is_along_shortest });
    }
    Ok(PlaneGroup::of(order, &mirrors))
}

/// The directions in which a lattice may have mirrors.
fn axes(lattice: &Lattice) -> Vec<Vector<2>> {
    let [a, b] = lattice.vectors;
    let mut axes: Vec<Vector<2>> = Vec::new();
    for v in [a, b, a + b, a - b].into_iter().flat_map(|v| [v, Vector::xy(-v[1], v[0])]) {
        if axes.iter().all(|known| !are_parallel(*known, v)) {
            axes.push(v.unit_or_zero());
        }
    }
    axes
}

/// The reflection in a line through the origin with this unit vector along it.
fn reflection(axis: Vector<2>) -> Matrix<2> {
    let (cos, sin) = (axis[0] * axis[0] - axis[1] * axis[1], 2.0 * axis[0] * axis[1]);
    Matrix([[cos, sin], [sin, -cos]])
}

/// Length of the shortest vector of a lattice along an axis, and shortest of what its vectors measure along it.
fn translations_along(lattice: &Lattice, axis: Vector<2>) -> (Option<f64>, f64) {
    let nodes = (-FAR..=FAR).flat_map(|i| (0..=FAR).map(move |j| [i, j])).filter(|node| *node != [0, 0]);
    let vectors: Vec<Vector<2>> = nodes.map(|node| lattice.at(node)).collect();
    let along = vectors.iter().filter(|v| are_parallel(**v, axis)).map(|v| v.norm()).fold(f64::INFINITY, f64::min);
    let floor = 0.1 * lattice.vectors[0].norm().min(lattice.vectors[1].norm());
    let measures = vectors.iter().map(|v| v.dot(axis).abs()).filter(|m| *m > floor);
    (along.is_finite().then_some(along), measures.fold(f64::INFINITY, f64::min))
}

fn frieze(exemplar: &Exemplar<2>, repeat: &Repeat, budget: &Budget) -> Result<FriezeGroup> {
    let window = &exemplar.window;
    let Some(step) = repeat.step(window) else { return Ok(FriezeGroup::P1) };
    let way = step.unit_or_zero();
    let across = Vector::xy(-way[1], way[0]);
    let wide = across * (APART * window.size().norm());
    let content = Content::new(exemplar, repeat, Lattice { vectors: [step, wide] }, budget)?;
    if content.is_empty() {
        return Ok(FriezeGroup::P1);
    }
    let turns = content.operation(&Matrix::rotation(TAU / 2.0), budget)?.is_some();
    let mirrors_across = content.operation(&reflection(across), budget)?.is_some();
    let along = content.operation(&reflection(way), budget)?.map(|operation| {
        let off = operation.shift.dot(way) / step.norm();
        (off - off.round()).abs() < NO_GLIDE
    });
    Ok(FriezeGroup::of(turns, mirrors_across, along))
}

/// Whether stripes are their own mirror image.
fn are_mirrored(lines: &Lines, along: Vector<2>, repeat: &Repeat, budget: &Budget) -> Result<bool> {
    let normal = Vector::xy(-along[1], along[0]);
    let period = repeat.lattice.vectors.map(|v| v.dot(normal).abs()).into_iter().fold(0.0, f64::max);
    let apart = |x: f64| {
        let share = x / period;
        (share - share.round()).abs()
    };
    let mut stripes: Vec<(f64, usize)> = Vec::new();
    for ((a, _), style) in &lines.stretches {
        let place = a.dot(normal);
        budget.spend(4 * (stripes.len() as u64 + 1))?;
        if stripes.iter().all(|(other, s)| s != style || apart(place - other) > STRIPE) {
            stripes.push((place, *style));
        }
    }
    let Some(&(first, style)) = stripes.first() else { return Ok(true) };
    budget.spend(4 * (stripes.len() as u64).pow(2))?;
    let mirrors = |sum: f64| {
        let partner = |place: f64, style: usize| {
            stripes.iter().any(|&(other, s)| s == style && apart(sum - place - other) <= 2.0 * STRIPE)
        };
        stripes.iter().all(|&(place, style)| partner(place, style))
    };
    Ok(stripes.iter().filter(|(_, s)| *s == style).any(|&(other, _)| mirrors(first + other)))
}
