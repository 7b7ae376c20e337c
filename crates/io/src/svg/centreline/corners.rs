//! Corners of a chain of stations: found by the turn between the straight lines before and after.

use arabesque_core::{Vector, arc_lengths, segment};

use super::{
    nodes::{Straight, crossing, through},
    stations::Station,
};

/// Turn from which on there may be a corner, in radians.
const TURN: f64 = 0.6;
/// Stations that the lines before and after are laid through, by their distance in widths.
const WINDOW: [f64; 2] = [0.45, 1.5];
/// Largest radius of a bend that is still a corner, in widths.
const SHARP: f64 = 0.9;

/// A chain with the arc length at each of its stations.
struct MeasuredChain<'a> {
    stations: &'a [Station],
    arcs: Vec<f64>,
    closed: bool,
    /// Common width of the strokes.
    width: f64,
}

/// The points of a chain: its sound stations, and its corners, which are marked.
pub(super) fn with_corners(chain: &[Station], closed: bool, width: f64) -> Vec<(Vector<2>, bool)> {
    let measured = MeasuredChain { stations: chain, arcs: arcs(chain, closed), closed, width };
    let arcs = &measured.arcs;
    let total = arcs.last().copied().unwrap_or(0.0);
    let mut found: Vec<(f64, f64, Vector<2>)> =
        (0..chain.len()).filter_map(|k| measured.corner(k).map(|(turn, p)| (turn, arcs[k], p))).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.total_cmp(&b.1)));
    let apart = |a: f64, b: f64| {
        let d = (a - b).abs();
        if closed { d.min(total - d) } else { d }
    };
    let mut corners: Vec<(f64, Vector<2>)> = Vec::new();
    for (_, arc, p) in found {
        if corners.iter().all(|(other, q)| apart(arc, *other) > WINDOW[1] * width && (*q - p).norm() > 0.5 * width) {
            corners.push((arc, p));
        }
    }
    let near = |arc: f64| corners.iter().any(|(c, _)| apart(arc, *c) < 0.6 * width);
    let mut points: Vec<(f64, Vector<2>, bool)> = (0..chain.len())
        .filter(|&k| (chain[k].is_sound && !near(arcs[k])) || (!closed && (k == 0 || k + 1 == chain.len())))
        .map(|k| (arcs[k], chain[k].at, false))
        .collect();
    points.extend(corners.into_iter().map(|(arc, p)| (arc, p, true)));
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.into_iter().map(|(_, p, is_corner)| (p, is_corner)).collect()
}

/// Arc length at every station, and the whole length of a closed chain last.
fn arcs(chain: &[Station], closed: bool) -> Vec<f64> {
    let closing = chain.first().filter(|_| closed);
    arc_lengths(&chain.iter().chain(closing).map(|station| station.at).collect::<Vec<_>>())
}

impl MeasuredChain<'_> {
    /// Turn and place of the corner at station `k`, where there is one.
    fn corner(&self, k: usize) -> Option<(f64, Vector<2>)> {
        let (chain, width) = (self.stations, self.width);
        let before = self.side(k, -1)?;
        let after = self.side(k, 1)?;
        let (before, after) = ((before.0, -before.1), after);
        let turn = before.1.angle_to(after.1).abs();
        if turn < TURN {
            return None;
        }
        let at = crossing(before, after)?;
        // A bend of radius r leaves its corner by r (1 / cos(turn / 2) - 1).
        let depth = 1.0 / (0.5 * turn).cos().max(0.2) - 1.0;
        let off = self.nearest(k, at);
        let is_here = (at - chain[k].at).norm() < (SHARP * depth + 0.3) * width;
        (is_here && off <= (SHARP * depth + 0.05) * width).then_some((turn, at))
    }

    /// The straight line away from station `k`, backwards for a step of -1 and forwards for 1.
    fn side(&self, k: usize, step: isize) -> Option<Straight> {
        let (chain, arcs, closed, width) = (self.stations, &self.arcs, self.closed, self.width);
        let n = chain.len() as isize;
        let total = if closed { arcs.last().copied()? } else { f64::INFINITY };
        let mut points = Vec::new();
        for j in 1..n {
            let index = k as isize + j * step;
            if !closed && !(0..n).contains(&index) {
                break;
            }
            let index = index.rem_euclid(n) as usize;
            let d = (arcs[index] - arcs[k]).abs();
            let distance = d.min(total - d) / width;
            if distance > WINDOW[1] {
                break;
            }
            if chain[index].is_sound && distance >= WINDOW[0] {
                points.push(chain[index].at);
            }
        }
        through(&points)
    }

    /// Distance of `p` from the chain near station `k`.
    fn nearest(&self, k: usize, p: Vector<2>) -> f64 {
        let (chain, closed) = (self.stations, self.closed);
        let n = chain.len();
        let from = if closed { n + k } else { k }.saturating_sub(5);
        let to = if closed { n + k + 5 } else { (k + 5).min(n - 1) };
        let mut least = f64::INFINITY;
        for j in from..to {
            let (a, b) = (chain[j % n].at, chain[(j + 1) % n].at);
            least = least.min(segment::distance((a, b), p));
        }
        least
    }
}
