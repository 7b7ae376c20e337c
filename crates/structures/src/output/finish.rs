//! From the optimised points to what is given back: cut at the border, with attributes, parts and elements numbered.

use arabesque_core::{Error, PointSet, Result, Vector};
use rayon::prelude::*;

use super::state::Output;
use crate::{
    energy::level::{Level, Matches, Near},
    exemplar::{bodies::LOOSE, pattern::Pattern},
    request::PlacedElement,
};

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

/// A site that sees a point, how much it does, and the nearest point of the exemplar there.
pub(super) type Seen = (u32, f64, usize);

/// For point `i` each site that sees it, in their order.
pub(super) fn seen<const D: usize>(
    level: &Level<'_, D>,
    output: &Output<D>,
    near: &Near,
    matches: &Matches<D>,
    i: usize,
) -> Vec<Seen> {
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
