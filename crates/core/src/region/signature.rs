//! The shape of an outline in short, and the best similarity between two of them.
//!
//! A signature holds the farthest painted area in 64 directions around the centre, and points along the border. Two
//! outlines are aligned by the turns for which the directions agree best; how well they then agree is the root mean
//! square distance between their borders.

use std::f64::consts::TAU;

use crate::{
    region::Outline,
    space::{Matrix, Similarity, Vector},
};

/// Directions of the radial profile.
const DIRECTIONS: usize = 64;
/// Points along the border.
const POINTS: usize = 48;
/// Turns that are compared in full.
const TURNS: usize = 5;
/// Relative spread of the profile below which an outline is round: no turn can be told from another.
const ROUND: f64 = 0.02;

/// Distances that are reckoned at a time.
const LANES: usize = 8;

/// The shape of an outline in short.
#[derive(Clone, Debug)]
pub struct Signature {
    centre: Vector<2>,
    /// Root mean square of the profile, in user units.
    pub size: f64,
    /// Covered area, in square user units.
    area: f64,
    /// Covered share of the disc with that radius.
    fullness: f64,
    /// Whether no turn can be told from another.
    pub is_round: bool,
    /// Farthest painted area by direction, in sizes; 0 where there is none.
    profile: [f64; DIRECTIONS],
    /// Points along the border at equal steps, relative to the centre, in sizes.
    points: Vec<Vector<2>>,
}

/// How one outline lies on another.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// Root mean square distance between the borders, in sizes.
    pub distance: f64,
    /// From the coordinates of the first to those of the second.
    pub pose: Similarity<2>,
}

impl Signature {
    /// The signature of an outline; `None` when it has no extent.
    pub fn new(outline: &Outline<2>) -> Option<Self> {
        let centre = outline.centroid()?;
        let profile = radial_profile(outline, centre);
        let mean_square = profile.iter().map(|r| r * r).sum::<f64>() / DIRECTIONS as f64;
        let size = mean_square.sqrt();
        if !(size.is_finite() && size > 0.0) {
            return None;
        }
        let profile = profile.map(|r| r / size);
        let spread = profile.iter().map(|r| (r - 1.0).abs()).fold(0.0, f64::max);
        let area = outline.area();
        let fullness = area / (0.5 * TAU * mean_square);
        let points = border_points(outline).into_iter().map(|p| (p - centre) * (1.0 / size)).collect();
        Some(Self { centre, size, area, fullness, is_round: spread < ROUND, profile, points })
    }

    /// The best similarity from this outline to `other`.
    pub fn fit(&self, other: &Self) -> Fit {
        let scale = (other.area / self.area).sqrt();
        let scale = if scale.is_finite() && scale > 0.0 { scale } else { other.size / self.size };
        let pose = |turn: f64| Similarity::about(self.centre, other.centre, Matrix::rotation(turn), scale);
        if self.is_round && other.is_round {
            return Fit { distance: (self.fullness - other.fullness).abs(), pose: pose(0.0) };
        }
        let turns = self.turns(other).into_iter().map(|turn| (self.border_distance(other, turn), turn));
        let turns: Vec<(f64, f64)> = turns.collect();
        let best = turns.iter().map(|(d, _)| *d).fold(f64::INFINITY, f64::min);
        // Among turns that are about as good, the smallest: symmetric shapes do not turn for no reason.
        let alike = turns.iter().filter(|(d, _)| *d <= 1.1 * best + 0.005);
        let turn = alike.map(|(_, turn)| *turn).min_by(|a, b| a.abs().total_cmp(&b.abs()).then(a.total_cmp(b)));
        Fit { distance: best, pose: pose(turn.unwrap_or(0.0)) }
    }

    /// Whether the sizes are within a factor of two and the outlines are about equally full.
    pub fn may_match(&self, other: &Self) -> bool {
        self.has_size_of(other) && (self.fullness - other.fullness).abs() < 0.2 * self.fullness.max(other.fullness)
    }

    /// Whether the sizes are within a factor of two.
    pub fn has_size_of(&self, other: &Self) -> bool {
        (0.5..=2.0).contains(&(other.size / self.size))
    }

    /// The turns that make the profiles agree best, in radians within half a turn.
    fn turns(&self, other: &Self) -> Vec<f64> {
        let difference = |shift: usize| -> f64 {
            (0..DIRECTIONS).map(|k| (self.profile[k] - other.profile[(k + shift) % DIRECTIONS]).powi(2)).sum()
        };
        let all: [f64; DIRECTIONS] = std::array::from_fn(difference);
        let at = |k: usize| all[k % DIRECTIONS];
        let mut lowest: Vec<usize> =
            (0..DIRECTIONS).filter(|&k| at(k) <= at(k + 1) && at(k) <= at(k + DIRECTIONS - 1)).collect();
        lowest.sort_by(|&a, &b| at(a).total_cmp(&at(b)).then(a.cmp(&b)));
        lowest.truncate(TURNS);
        let refined = |k: usize| {
            let (left, here, right) = (at(k + DIRECTIONS - 1), at(k), at(k + 1));
            let curve = left - 2.0 * here + right;
            let part = if curve > 0.0 { (0.5 * (left - right) / curve).clamp(-0.5, 0.5) } else { 0.0 };
            let turn = (k as f64 + part) / DIRECTIONS as f64 * TAU;
            if turn > 0.5 * TAU { turn - TAU } else { turn }
        };
        lowest.into_iter().map(refined).collect()
    }

    /// How well the outline lies on `other` once it is turned by `turn` and both are of one size about one centre: root mean square
    /// distance between the borders, in sizes.
    pub fn border_distance(&self, other: &Self, turn: f64) -> f64 {
        let rotation = Matrix::rotation(turn);
        let turned: Vec<_> = self.points.iter().map(|&p| rotation.apply(p)).collect();
        (0.5 * (square_gap(&turned, &other.points) + square_gap(&other.points, &turned))).sqrt()
    }
}

/// Mean square distance from the points of `a` to the nearest of `b`.
fn square_gap(a: &[Vector<2>], b: &[Vector<2>]) -> f64 {
    // Side by side, so that several are reckoned with at a time.
    let (xs, ys): (Vec<f64>, Vec<f64>) = b.iter().map(|q| (q[0], q[1])).unzip();
    let nearest = |p: Vector<2>| {
        let mut least = [f64::INFINITY; LANES];
        for (xs, ys) in xs.chunks(LANES).zip(ys.chunks(LANES)) {
            for ((least, x), y) in least.iter_mut().zip(xs).zip(ys) {
                let (dx, dy) = (p[0] - x, p[1] - y);
                let d2 = dx * dx + dy * dy;
                *least = if d2 < *least { d2 } else { *least };
            }
        }
        least.into_iter().fold(f64::INFINITY, f64::min).sqrt()
    };
    // Samples lie half a step apart on average even where the borders agree; that is not a difference.
    let step = b.windows(2).map(|w| (w[1] - w[0]).norm()).fold(f64::INFINITY, f64::min);
    let slack = if step.is_finite() { 0.25 * step } else { 0.0 };
    a.iter().map(|&p| (nearest(p) - slack).max(0.0).powi(2)).sum::<f64>() / a.len().max(1) as f64
}

fn radial_profile(outline: &Outline<2>, centre: Vector<2>) -> [f64; DIRECTIONS] {
    let mut profile = [0.0_f64; DIRECTIONS];
    let per_radian = DIRECTIONS as f64 / TAU;
    for (a, b) in outline.edges() {
        let (a, b) = (a - centre, b - centre);
        let start = a[1].atan2(a[0]) * per_radian;
        let span = a.angle_to(b) * per_radian;
        let (low, high) = if span < 0.0 { (start + span, start) } else { (start, start + span) };
        for k in low.ceil() as i64..=high.floor() as i64 {
            let angle = k as f64 / per_radian;
            let along = b - a;
            let across = Vector::xy(angle.cos(), angle.sin()).cross(along);
            let reach = if across.abs() > 1e-300 { (a.cross(along) / across).abs() } else { a.norm().max(b.norm()) };
            let reach = reach.min(a.norm().max(b.norm()));
            let direction = k.rem_euclid(DIRECTIONS as i64) as usize;
            profile[direction] = profile[direction].max(reach);
        }
    }
    profile
}

/// Points at equal steps along all rings.
fn border_points(outline: &Outline<2>) -> Vec<Vector<2>> {
    let total: f64 = outline.edges().map(|(a, b)| (b - a).norm()).sum();
    let step = total / POINTS as f64;
    let mut points = Vec::with_capacity(POINTS);
    if !(step.is_finite() && step > 0.0) {
        return points;
    }
    let mut ahead = 0.5 * step;
    for (a, b) in outline.edges() {
        let length = (b - a).norm();
        while ahead < length && points.len() < POINTS {
            points.push(a + (b - a) * (ahead / length));
            ahead += step;
        }
        ahead -= length;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(corners: &[(f64, f64)]) -> Outline<2> {
        Outline { rings: vec![corners.iter().map(|&(x, y)| Vector::xy(x, y)).collect()] }
    }

    fn arrow() -> Outline<2> {
        polygon(&[(0.0, 0.0), (6.0, 0.0), (6.0, -2.0), (10.0, 1.0), (6.0, 4.0), (6.0, 2.0), (0.0, 2.0)])
    }

    #[test]
    fn a_turned_and_scaled_copy_is_recognised_with_its_pose() {
        let motion = Similarity::about(Vector::xy(1.0, 1.0), Vector::xy(40.0, -3.0), Matrix::rotation(2.3), 1.4);
        let (a, b) = (Signature::new(&arrow()).unwrap(), Signature::new(&arrow().transformed(&motion)).unwrap());
        assert!(a.may_match(&b));
        let fit = a.fit(&b);
        assert!(fit.distance < 0.02, "{}", fit.distance);
        assert!((fit.pose.rotation.angle() - 2.3).abs() < 0.03, "{}", fit.pose.rotation.angle());
        assert!((fit.pose.scale - 1.4).abs() < 0.01);
        assert!((fit.pose.apply(Vector::xy(10.0, 1.0)) - motion.apply(Vector::xy(10.0, 1.0))).norm() < 0.4);
    }

    #[test]
    fn different_shapes_are_far_apart() {
        let square = polygon(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]);
        let fit = Signature::new(&arrow()).unwrap().fit(&Signature::new(&square).unwrap());
        assert!(fit.distance > 0.1, "{}", fit.distance);
    }

    #[test]
    fn symmetric_shapes_do_not_turn() {
        let ring = |n: u32, radius: f64| {
            let corner = |k: u32| {
                let a = f64::from(k) / f64::from(n) * TAU;
                (radius * a.cos(), radius * a.sin())
            };
            polygon(&(0..n).map(corner).collect::<Vec<_>>())
        };
        for n in [4, 90] {
            let (a, b) = (Signature::new(&ring(n, 3.0)).unwrap(), Signature::new(&ring(n, 5.0)).unwrap());
            assert!(a.fit(&b).pose.rotation.angle().abs() < 1e-6);
            assert!(a.fit(&b).distance < 0.02);
        }
    }
}
