//! Where the lines meet and end, from the directions in which they run there.

use arabesque_core::{Bounds, Vector, segment};

use super::{
    border::OutlineBorder,
    graph::Graph,
    stations::{Station, Track},
};

/// Stations that a line near a node is laid through, by their distance from the node in widths.
const NEAR: [f64; 2] = [0.5, 2.2];

/// A straight line: a point and a direction of length one.
pub(super) type Straight = (Vector<2>, Vector<2>);

/// The straight line through points, in the direction from the first to the last; `None` for fewer than two.
pub(super) fn through(points: &[Vector<2>]) -> Option<Straight> {
    let (first, last) = (points.first()?, points.last()?);
    let mean = points.iter().fold(Vector::ZERO, |sum, &p| sum + p) * (1.0 / points.len() as f64);
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for &p in points {
        let d = p - mean;
        xx += d[0] * d[0];
        xy += d[0] * d[1];
        yy += d[1] * d[1];
    }
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    let way = Vector::xy(angle.cos(), angle.sin());
    let chord = *last - *first;
    (points.len() > 1 && chord.norm2() > 0.0).then(|| (mean, if way.dot(chord) < 0.0 { -way } else { way }))
}

/// The point nearest to all lines, held a little by `guess`.
fn meeting_point(lines: &[Straight], guess: Vector<2>) -> Vector<2> {
    const HOLD: f64 = 0.02;
    let (mut xx, mut xy, mut yy, mut rx, mut ry) = (HOLD, 0.0, HOLD, HOLD * guess[0], HOLD * guess[1]);
    for (p, d) in lines {
        let normal = Vector::xy(-d[1], d[0]);
        let offset = normal.dot(*p);
        xx += normal[0] * normal[0];
        xy += normal[0] * normal[1];
        yy += normal[1] * normal[1];
        rx += normal[0] * offset;
        ry += normal[1] * offset;
    }
    let determinant = xx * yy - xy * xy;
    Vector::xy((yy * rx - xy * ry) / determinant, (xx * ry - xy * rx) / determinant)
}

/// Where two lines cross; `None` for nearly parallel ones.
pub(super) fn crossing(a: Straight, b: Straight) -> Option<Vector<2>> {
    let [along, _] = segment::lines_cross(a, b).filter(|_| a.1.cross(b.1).abs() > 1e-3)?;
    Some(a.0 + a.1 * along)
}

/// The sound stations of a track near one of its ends, away from the end.
fn approach(track: &Track, from_end: bool, node: Vector<2>, width: f64) -> Vec<Vector<2>> {
    let near = |s: &&Station| s.is_sound && (NEAR[0]..NEAR[1]).contains(&((s.at - node).norm() / width));
    let half = track.stations.len().div_ceil(2).max(3);
    if from_end {
        track.stations.iter().rev().take(half).filter(near).map(|s| s.at).collect()
    } else {
        track.stations.iter().take(half).filter(near).map(|s| s.at).collect()
    }
}

/// Moves every node to where its lines meet, and free ends to half a width before the tip; the stations near them
/// follow.
pub(super) fn settle(
    graph: &mut Graph,
    tracks: &mut [Track],
    border: &OutlineBorder,
    width: f64,
    frame: Option<&Bounds<2>>,
) {
    for (node, lines) in graph.incidence().into_iter().enumerate() {
        let old = graph.nodes[node];
        let approaches: Vec<Straight> =
            lines.iter().filter_map(|&(k, ends)| through(&approach(&tracks[k], ends, old, width))).collect();
        let new = match (&lines[..], &approaches[..]) {
            ([_], [line]) => tip(*line, border, width, frame).unwrap_or(old),
            ([_, _, ..], [_, _, ..]) => meeting_point(&approaches, old),
            _ => old,
        };
        let far = if lines.len() == 1 { 2.0 } else { 1.0 };
        if new.is_finite() && (new - old).norm() < far * width {
            graph.nodes[node] = new;
        }
        for &(k, ends) in &lines {
            trim(&mut tracks[k], ends, graph.nodes[node], width);
        }
    }
}

/// The end of a stroke with a round cap that reaches as far as the outline does; at the frame the stroke runs through.
fn tip(line: Straight, border: &OutlineBorder, width: f64, frame: Option<&Bounds<2>>) -> Option<Vector<2>> {
    let (from, outward) = (line.0, -line.1);
    let reach = border.reach(from, outward, 4.0 * width)?;
    let end = from + outward * reach;
    if frame.is_some_and(|f| f.signed_distance(end).abs() < 0.1 * width) {
        return Some(end);
    }
    (reach > 0.5 * width).then(|| from + outward * (reach - 0.5 * width))
}

/// Puts the end of a track at its node, and leaves out the stations that are nearer than half a width to it or beyond
/// it.
fn trim(track: &mut Track, from_end: bool, node: Vector<2>, width: f64) {
    if from_end {
        track.stations.reverse();
    }
    if track.stations.len() > 2 {
        let half = track.stations.len() / 2;
        let near = |s: &Station| (s.at - node).norm() < 0.5 * width || !s.is_sound && (s.at - node).norm() < width;
        let from = (1..half.max(1)).find(|&k| !near(&track.stations[k])).unwrap_or(half.max(1));
        track.stations.drain(1..from);
    }
    if let Some(first) = track.stations.first_mut() {
        *first = Station { at: node, width, is_sound: true };
    }
    if from_end {
        track.stations.reverse();
    }
}
