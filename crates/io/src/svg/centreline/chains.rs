//! Tracks chained through the nodes where one runs on straight into another.

use arabesque_core::{
    Vector,
    pairing::{Wish, pair_up},
};

use super::{
    graph::Graph,
    stations::{Station, Track},
};

/// Largest turn at a node at which two tracks are one stroke, in radians.
const STRAIGHT_ON: f64 = 0.45;
/// Distance from the node at which the direction is taken, in widths.
const LEVER: f64 = 1.5;

/// Chains of tracks, long strokes through the junctions; closed chains do not repeat their first station.
pub(super) fn chained(graph: &Graph, tracks: &[Track], width: f64) -> Vec<(Vec<Station>, bool)> {
    let partner = partners(graph, tracks, width);
    let mut used = vec![false; tracks.len()];
    let mut chains = Vec::new();
    for (k, track) in tracks.iter().enumerate() {
        if track.nodes.is_none() {
            chains.push((track.stations.clone(), true));
            used[k] = true;
        }
    }
    // Strokes with ends first; what is left goes around.
    for around in [false, true] {
        for start in 0..2 * tracks.len() {
            if !used[start / 2] && (around || partner[start].is_none()) {
                chains.push(walk(tracks, &partner, &mut used, start));
            }
        }
    }
    chains
}

/// For every end of a track (twice its index, one more for the last station) the end that continues it.
fn partners(graph: &Graph, tracks: &[Track], width: f64) -> Vec<Option<usize>> {
    let mut partner = vec![None; 2 * tracks.len()];
    for lines in graph.incidence() {
        let ends: Vec<usize> = lines.iter().map(|&(k, ends)| 2 * k + usize::from(ends)).collect();
        let ways: Vec<Vector<2>> = ends.iter().map(|&e| outward(&tracks[e / 2], e % 2 == 1, width)).collect();
        let mut wishes = Vec::new();
        for i in 0..ends.len() {
            for j in 0..i {
                let turn = (-ways[i]).angle_to(ways[j]).abs();
                if turn < STRAIGHT_ON {
                    wishes.push(Wish { cost: turn, a: i, b: j });
                }
            }
        }
        pair_up(wishes, ends.len(), |i, j| {
            let (i, j) = (ends[i], ends[j]);
            (partner[i], partner[j]) = (Some(j), Some(i));
            true
        });
    }
    partner
}

/// Direction from an end of a track into it.
fn outward(track: &Track, from_end: bool, width: f64) -> Vector<2> {
    let n = track.stations.len();
    if n < 2 {
        return Vector::xy(0.0, 0.0);
    }
    let at = |k: usize| track.stations[if from_end { n - 1 - k } else { k }].at;
    let far = (1..n).find(|&k| (at(k) - at(0)).norm() >= LEVER * width).unwrap_or(n - 1);
    let d = at(far) - at(0);
    d.unit_or_zero()
}

fn walk(tracks: &[Track], partner: &[Option<usize>], used: &mut [bool], start: usize) -> (Vec<Station>, bool) {
    let mut chain: Vec<Station> = Vec::new();
    let mut entry = start;
    loop {
        let track = &tracks[entry / 2];
        used[entry / 2] = true;
        let skip = usize::from(!chain.is_empty());
        if entry.is_multiple_of(2) {
            chain.extend(track.stations.iter().skip(skip));
        } else {
            chain.extend(track.stations.iter().rev().skip(skip));
        }
        match partner[entry ^ 1] {
            Some(next) if next == start => {
                chain.pop();
                return (chain, true);
            }
            Some(next) if !used[next / 2] => entry = next,
            _ => return (chain, false),
        }
    }
}
