//! Patches of the exemplar from anywhere in it, side by side [Ma 2011; Roveri 2015 fig. 4].

use std::collections::BTreeMap;

use arabesque_core::{Similarity, Stage, Stream, Vector};

use crate::{
    energy::level::Level,
    exemplar::bodies::LOOSE,
    output::state::Output,
    solve::matching::{anywhere, room},
};

const PLACES: Stage = Stage::new(44);

/// Patches of about `size`: all sites in a cell of that size show what surrounds one place of the exemplar. And their matches.
pub(crate) fn patches<const D: usize>(
    level: &Level<'_, D>,
    mut output: Output<D>,
    (step, size): (f64, f64),
    seed: u64,
) -> (Output<D>, Vec<Vector<D>>) {
    let pattern = level.pattern;
    let room = room(level);
    let mut anchors: BTreeMap<[i64; D], usize> = BTreeMap::new();
    let mut matches = Vec::with_capacity(level.sites.len());
    for (q, site) in level.sites.iter().enumerate() {
        let cell = site.place.0.map(|x| (x / (size * site.scale)).floor() as i64);
        let anchor = *anchors.entry(cell).or_insert(q);
        let start = anywhere(&room, &mut Stream::new(seed, PLACES, anchor as u64));
        let from = &level.sites[anchor];
        let step = from.seen(level.domain.offset(from.place, site.place));
        let m = Vector(std::array::from_fn(|k| start[k] + if pattern.base[k] { step[k] } else { 0.0 }));
        matches.push(room.clamp(m));
    }
    for (q, site) in level.sites.iter().enumerate() {
        let m = matches[q];
        let radius = (step * step * pattern.repeats() as f64 + 1.1 * pattern.thickness * pattern.thickness).sqrt();
        let mut new = Vec::new();
        pattern.index.within(m, radius, |j, _| new.push(j));
        for j in new {
            let body = pattern.bodies.get(pattern.body_of[j] as usize);
            let middle = body.map_or(pattern.points.positions[j], |b| b.centre);
            let offset = middle - m;
            let foot = Vector(std::array::from_fn(|k| if pattern.base[k] { offset[k] } else { 0.0 }));
            if level.index.nearest(site.place + site.shown(foot), 1.6 * step * site.scale) != Some(q) {
                continue;
            }
            match body {
                Some(b) if b.members[0] != j => {}
                Some(_) => {
                    let pose = Similarity::about(m, site.place, site.rotation, site.scale);
                    output.add_body(pattern, pattern.body_of[j] as usize, pose);
                }
                None => {
                    debug_assert_eq!(pattern.body_of[j], LOOSE);
                    let weights = pattern.channels.turned(&pattern.weights[j], &site.rotation);
                    output.add(level.domain.wrap(site.place + site.shown(offset)), weights);
                }
            }
        }
    }
    (output, matches)
}
