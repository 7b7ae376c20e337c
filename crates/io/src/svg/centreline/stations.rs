//! Places along the lines of a graph, moved to the middle between the borders on both sides.

use arabesque_core::{Bounds, Vector, polyline_length};

use super::{
    border::OutlineBorder,
    graph::{Graph, Line},
};

/// Distance between stations, in widths.
pub(super) const STEP: f64 = 0.25;
/// Times that the stations are moved.
const PASSES: usize = 4;
/// Farthest look to a side, in widths.
const SIGHT: f64 = 3.0;
/// Deviation from the common width up to which the middle between the borders counts, as a share.
const SOUND: f64 = 0.13;
/// Turn within a width and a half from which on a place counts as near a corner, in radians.
const BENT: f64 = 0.5;

/// A place on a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Station {
    pub(super) at: Vector<2>,
    /// Width of the outline across the line, at most [`SIGHT`] widths to each side.
    pub(super) width: f64,
    /// Whether that is the common width: then `at` is the middle.
    pub(super) is_sound: bool,
}

/// A line of the graph as stations; those of an open line begin and end at its nodes.
#[derive(Clone, Debug)]
pub(super) struct Track {
    pub(super) nodes: Option<[usize; 2]>,
    pub(super) stations: Vec<Station>,
}

/// Stations along all lines, and the common width of the strokes.
pub(super) fn centred(
    graph: &Graph,
    border: &OutlineBorder,
    estimate: f64,
    pixel: f64,
    frame: Option<&Bounds<2>>,
) -> (Vec<Track>, f64) {
    let mut tracks: Vec<Track> = graph.lines.iter().map(|line| track(line, estimate, pixel)).collect();
    let mut width = estimate;
    for pass in 0..PASSES {
        for track in &mut tracks {
            track.measure(border, width);
        }
        width = median_width(&tracks, graph, width, frame);
        // Nothing is moved before the width is known, and measured once more after the last move.
        for track in &mut tracks {
            track.judge(width);
            if pass + 1 < PASSES {
                track.measure_and_move(border, width);
            }
        }
    }
    (tracks, width)
}

/// Widths of the stations that neither a node nor a corner nor the frame is near to, in ascending order.
pub(super) fn free_widths(tracks: &[Track], graph: &Graph, width: f64, frame: Option<&Bounds<2>>) -> Vec<f64> {
    let mut widths = Vec::new();
    for clearance in [1.2, 0.7] {
        for track in tracks {
            let ends = track.nodes.map(|nodes| nodes.map(|n| graph.nodes[n]));
            let free = |k: &usize| {
                let at = track.stations[*k].at;
                ends.iter().flatten().all(|node| (at - *node).norm() > clearance * width)
                    && frame.is_none_or(|f| f.signed_distance(at) > 0.75 * width)
                    && track.bend(*k) < BENT
            };
            widths.extend((0..track.stations.len()).filter(free).map(|k| track.stations[k].width));
        }
        if !widths.is_empty() {
            break;
        }
    }
    widths.sort_by(f64::total_cmp);
    widths
}

fn median_width(tracks: &[Track], graph: &Graph, fallback: f64, frame: Option<&Bounds<2>>) -> f64 {
    let widths = free_widths(tracks, graph, fallback, frame);
    widths.get(widths.len() / 2).copied().unwrap_or(fallback)
}

fn track(line: &Line, width: f64, pixel: f64) -> Track {
    let closed = line.nodes.is_none();
    let smooth = smoothed(&line.points, closed, (0.25 * width / pixel).round() as usize);
    let station = |at| Station { at, width: 0.0, is_sound: false };
    Track { nodes: line.nodes, stations: evenly(&smooth, closed, STEP * width).into_iter().map(station).collect() }
}

/// Each point at the mean of those up to `reach` before and after it; ends stay.
fn smoothed(points: &[Vector<2>], closed: bool, reach: usize) -> Vec<Vector<2>> {
    let n = points.len();
    let mean = |k: usize| {
        let r = if closed { reach.min(n / 8) } else { reach.min(k).min(n - 1 - k) };
        let sum = (n + k - r..=n + k + r).fold(Vector::ZERO, |sum, j| sum + points[j % n]);
        sum * (1.0 / (2 * r + 1) as f64)
    };
    (0..n).map(mean).collect()
}

/// Points at about the given distance along a polyline, its ends included; a closed one does not repeat the first.
pub(super) fn evenly(points: &[Vector<2>], closed: bool, step: f64) -> Vec<Vector<2>> {
    let mut line = points.to_vec();
    if closed {
        line.extend(points.first());
    }
    let length = polyline_length(&line);
    let n = (length / step).round().max(2.0) as usize;
    let (mut result, mut passed) = (Vec::with_capacity(n + 1), 0.0);
    for w in line.windows(2) {
        let piece = (w[1] - w[0]).norm();
        while result.len() < n && result.len() as f64 * length / n as f64 <= passed + piece && piece > 0.0 {
            let share = (result.len() as f64 * length / n as f64 - passed) / piece;
            result.push(w[0] + (w[1] - w[0]) * share);
        }
        passed += piece;
    }
    if !closed {
        result.extend(line.last());
    }
    result
}

impl Track {
    /// Direction of the line at a station, of length one.
    fn way(&self, k: usize) -> Vector<2> {
        let n = self.stations.len();
        let (before, after) = match self.nodes {
            None => ((k + n - 1) % n, (k + 1) % n),
            Some(_) => (k.saturating_sub(1), (k + 1).min(n - 1)),
        };
        let d = self.stations[after].at - self.stations[before].at;
        d.unit_or_zero()
    }

    /// Turn of the line between three stations before and three after.
    fn bend(&self, k: usize) -> f64 {
        let n = self.stations.len();
        let (before, after) = match self.nodes {
            None => (self.way((k + n - 3 % n) % n), self.way((k + 3) % n)),
            Some(_) => (self.way(k.saturating_sub(3)), self.way((k + 3).min(n - 1))),
        };
        before.angle_to(after).abs()
    }

    /// Width and offset of the middle at a station.
    fn look(&self, k: usize, border: &OutlineBorder, width: f64) -> (f64, Vector<2>) {
        let way = self.way(k);
        let side = Vector::xy(-way[1], way[0]);
        let at = self.stations[k].at;
        let [left, right] = [side, -side].map(|d| border.reach(at, d, SIGHT * width).unwrap_or(SIGHT * width));
        (left + right, side * (0.5 * (left - right)))
    }

    fn measure(&mut self, border: &OutlineBorder, width: f64) {
        let looks: Vec<_> = (0..self.stations.len()).map(|k| self.look(k, border, width)).collect();
        for (station, (across, _)) in self.stations.iter_mut().zip(looks) {
            station.width = across;
        }
    }

    fn judge(&mut self, width: f64) {
        for station in &mut self.stations {
            station.is_sound = (station.width - width).abs() <= SOUND * width;
        }
    }

    fn measure_and_move(&mut self, border: &OutlineBorder, width: f64) {
        let looks: Vec<_> = (0..self.stations.len()).map(|k| self.look(k, border, width)).collect();
        for (station, (_, offset)) in self.stations.iter_mut().zip(looks) {
            if station.is_sound {
                station.at += offset;
            }
        }
    }
}
