//! From the optimised points to what is given back: cut at the border, with attributes, parts and elements numbered.

use arabesque_core::{Budget, DisjointSets, Error, PointSet, Result, Vector};
use rayon::prelude::*;

use super::state::Output;
use crate::{
    each::each,
    energy::{
        level::{Level, Matches, Near},
        links::neighbours,
    },
    exemplar::{bodies::LOOSE, pattern::Pattern},
    request::PlacedElement,
};

/// Work for each site that a point is seen by.
const SEEN: u64 = 60;

/// Points of one part are no farther apart than this, in spacings.
const PART: f64 = 2.2;

/// Share of the votes by which neighbours must be of one part: a part holds together at many places, and one false link joins two.
const SURE: f64 = 0.6;

/// For each point the point of the exemplar it stands for: the nearest to where most of its windows see it.
pub(crate) fn sources<const D: usize>(
    level: &Level<'_, D>,
    output: &Output<D>,
    near: &Near,
    matches: &Matches<D>,
) -> Vec<usize> {
    (0..output.places.len())
        .into_par_iter()
        .with_min_len(64)
        .map(|i| {
            if let Some(body) = output.bodies.get(output.body_of[i] as usize) {
                return level.pattern.bodies[body.source].members[i - body.first];
            }
            let seen = seen(level, output, near, matches, i);
            seen.iter().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |s| s.2)
        })
        .collect()
}

/// For point `i` each site that sees it, with how much, and the nearest point of the exemplar there.
fn seen<const D: usize>(
    level: &Level<'_, D>,
    output: &Output<D>,
    near: &Near,
    matches: &Matches<D>,
    i: usize,
) -> Vec<(u32, f64, usize)> {
    let pattern = level.pattern;
    let mut all = Vec::new();
    for &q in near.windows.of(i) {
        let site = &level.sites[q as usize];
        let u = site.seen(level.domain.offset(site.place, output.places[i]));
        let y = Vector(std::array::from_fn(|k| matches.places[q as usize][k] + u[k]));
        let weight = level.tables.kernel.weight(&u);
        let back = site.rotation.transpose();
        let own = level.pattern.channels.turned(&output.weights[i], &back);
        let mut best: Option<(f64, usize)> = None;
        pattern.index.within(y, 2.0 * pattern.spacing, |j, r| {
            let unlike: f64 = own.iter().zip(&pattern.weights[j]).map(|(a, b)| f64::from((a - b) * (a - b))).sum();
            let far = r.norm2() / (pattern.spacing * pattern.spacing) + unlike;
            if pattern.body_of[j] == LOOSE && best.is_none_or(|b| far < b.0) {
                best = Some((far, j));
            }
        });
        if let Some((far, j)) = best {
            all.push((q, weight / (0.2 + far), j));
        }
    }
    all
}

/// The parts of the exemplar: points near each other that have one number.
fn parts_of_exemplar<const D: usize>(pattern: &Pattern<D>, groups: &[i32]) -> Vec<usize> {
    let mut sets = DisjointSets::new(groups.len());
    for (i, &p) in pattern.points.positions.iter().enumerate() {
        pattern.index.within(p, PART * pattern.spacing, |j, _| {
            if groups[i] == groups[j] {
                sets.join(i, j);
            }
        });
    }
    (0..groups.len()).map(|i| sets.of(i)).collect()
}

/// Numbers of the parts of the output. Neighbours are of one part when most windows see them as of one part of the exemplar.
pub(crate) fn groups<const D: usize>(
    level: &Level<'_, D>,
    output: &Output<D>,
    near: &Near,
    matches: &Matches<D>,
    budget: &Budget,
) -> Result<Option<Vec<i32>>> {
    let pattern = level.pattern;
    let Some(own) = &pattern.points.groups else { return Ok(None) };
    let parts = parts_of_exemplar(pattern, own);
    let n = output.places.len();
    let cost = |i: usize| near.windows.of(i).len() as u64 * SEEN;
    let seen = each(n, budget, cost, |i| seen(level, output, near, matches, i))?;
    let mut sets = DisjointSets::new(n);
    let scale = |i: usize| {
        let sites = near.windows.of(i);
        sites.iter().map(|&q| level.sites[q as usize].scale).sum::<f64>() / sites.len().max(1) as f64
    };
    let scales: Vec<f64> = (0..n).map(scale).collect();
    let largest = scales.iter().copied().fold(0.0, f64::max);
    let around = neighbours(&output.places, PART * pattern.spacing * largest, level.domain, budget)?;
    for i in 0..n {
        for &j in around.of(i) {
            let j = j as usize;
            let far = level.domain.offset(output.places[i], output.places[j]).norm();
            if j < i || far > PART * pattern.spacing * scales[i] {
                continue;
            }
            let (mut votes, mut all, mut b) = (0.0, 0.0, seen[j].iter().peekable());
            for (q, weight, source) in &seen[i] {
                while b.next_if(|s| s.0 < *q).is_some() {}
                if let Some((_, other, theirs)) = b.next_if(|s| s.0 == *q) {
                    all += weight * other;
                    votes += weight * other * if parts[*source] == parts[*theirs] { 1.0 } else { -1.0 };
                }
            }
            if votes > SURE * all && all > 0.0 {
                sets.join(i, j);
            }
        }
    }
    let mut number = std::collections::HashMap::new();
    let mut numbered = |i: usize| {
        let next = number.len() as i32;
        *number.entry(sets.of(i)).or_insert(next)
    };
    Ok(Some((0..n).map(&mut numbered).collect()))
}

/// What is given back of an output: the points for which `inside` says yes, elements as their middle does.
pub(crate) struct Finished<const D: usize> {
    pub(crate) points: PointSet<D>,
    pub(crate) sources: Vec<Option<usize>>,
    pub(crate) elements: Vec<PlacedElement<D>>,
}

/// Cuts and numbers. `groups` and `sources` have one entry for each point of the output.
pub(crate) fn finish<const D: usize>(
    pattern: &Pattern<D>,
    output: &Output<D>,
    sources: &[usize],
    groups: Option<&[i32]>,
    inside: impl Fn(Vector<D>) -> bool,
) -> Finished<D> {
    let mut chosen: Vec<usize> = Vec::new();
    let mut elements = Vec::new();
    let mut numbers: Vec<i32> = Vec::new();
    let mut i = 0;
    while i < output.places.len() {
        let body = output.bodies.get(output.body_of[i] as usize);
        let count = body.map_or(1, |b| b.count);
        let middle = (i..i + count).fold(Vector::ZERO, |s, k| s + output.places[k]) * (1.0 / count as f64);
        if output.is_kept(i) || inside(middle) {
            if let Some(b) = body {
                let points = chosen.len()..chosen.len() + count;
                elements.push(PlacedElement { element: pattern.bodies[b.source].number, pose: b.pose, points });
            }
            let number = if body.is_some() { elements.len() as i32 - 1 } else { PointSet::<D>::CONTINUOUS };
            chosen.extend(i..i + count);
            numbers.extend(std::iter::repeat_n(number, count));
        }
        i += count;
    }
    let channels = &pattern.channels;
    let exemplar = &pattern.points;
    let place = |&i: &usize| output.places[i];
    let direction = |&i: &usize| channels.direction(&output.weights[i]).unwrap_or(Vector::ZERO);
    let normals = exemplar.normals.as_ref().map(|own| match channels.normal() {
        Some(_) => chosen.iter().map(direction).collect(),
        None => chosen.iter().map(|&i| own[sources[i]]).collect(),
    });
    let colours = exemplar.colours.as_ref().map(|own| {
        let of = |&i: &usize| match (output.body_of[i], channels.colour(&output.weights[i])) {
            (LOOSE, Some(colour)) => colour,
            _ => own[sources[i]],
        };
        chosen.iter().map(of).collect()
    });
    let radii = exemplar.radii.as_ref().map(|own| {
        let (least, most) = own.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), &r| (a.min(r), b.max(r)));
        let of = |&i: &usize| channels.radius(&output.weights[i]).map_or(own[sources[i]], |r| r.clamp(least, most));
        chosen.iter().map(of).collect()
    });
    let points = PointSet {
        positions: chosen.iter().map(place).collect(),
        normals,
        colours,
        radii,
        classes: exemplar.classes.as_ref().map(|own| {
            chosen.iter().map(|&i| channels.class(&output.weights[i]).unwrap_or_else(|| own[sources[i]])).collect()
        }),
        groups: groups.map(|g| chosen.iter().map(|&i| g[i]).collect()),
        elements: exemplar.elements.is_some().then_some(numbers),
    };
    let sources = chosen.iter().map(|&i| (!output.is_kept(i)).then(|| sources[i])).collect();
    Finished { points, sources, elements }
}

/// The kept points as an output begins with them.
pub(crate) fn kept<const D: usize>(pattern: &Pattern<D>, kept: &PointSet<D>) -> Result<Output<D>> {
    kept.check("the points to keep")?;
    if kept.positions.iter().any(|p| !p.is_finite()) {
        return Err(Error::input("the points to keep", "a coordinate is not a finite number", "leave the point out"));
    }
    let mut output = Output::default();
    for i in 0..kept.len() {
        output.add(kept.positions[i], pattern.channels.of(kept, i));
    }
    output.kept = kept.len();
    Ok(output)
}
