//! Lattices on whose nodes straight lines begin, end and turn, as on squared paper.

use crate::{
    curve::{Cubic, Path},
    space::{Bounds, Vector},
};

/// How far a control point may lie from the chord of a straight segment, as a share of its length.
const STRAIGHT: f64 = 1e-3;
/// Directions that differ by less than this, as a sine, are one.
const PARALLEL: f64 = 4e-3;
/// How far a node may lie from its place, as a share of the distance between lines of the paper.
const OFF: f64 = 0.04;
/// Coordinates nearer to one another than this share of the window are one.
const SAME: f64 = 2e-3;
/// The smallest gap between coordinates may be so many steps wide.
const GAPS: usize = 4;
/// Lines of the paper in each direction: at least, and at most across the window.
const LINES: (usize, f64) = (4, 120.0);
/// Share of the vertices that have to lie on nodes.
const ON_NODES: f64 = 0.995;
/// Steps of a straight run, in the mean, at most: longer ones do not say that there are nodes on them.
const RUN: f64 = 8.0;
/// Directions that are tried.
const TRIED: usize = 3;

/// A lattice that straight lines keep to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ruling {
    /// One of its nodes.
    pub origin: Vector<2>,
    /// From a node to the next along the lines of the paper, at a right angle to one another.
    pub vectors: [Vector<2>; 2],
}

/// The corners of a path that is straight between them, the first again at the end where it is closed; `None` for one that
/// bends.
pub fn corners(path: &Path<2>) -> Option<Vec<Vector<2>>> {
    let mut corners = vec![path.start()?];
    for cubic in &path.cubics {
        if !is_straight(cubic) {
            return None;
        }
        if (cubic[3] - corners[corners.len() - 1]).norm() > 0.0 {
            corners.push(cubic[3]);
        }
    }
    (corners.len() > 1).then_some(corners)
}

fn is_straight(cubic: &Cubic<2>) -> bool {
    let chord = cubic[3] - cubic[0];
    let off = |p: Vector<2>| (p - cubic[0]).cross(chord).abs();
    let along = |p: Vector<2>| (p - cubic[0]).dot(chord);
    let (length2, inside) = (chord.norm2(), -STRAIGHT..=1.0 + STRAIGHT);
    [cubic[1], cubic[2]].iter().all(|&p| off(p) <= STRAIGHT * length2 && inside.contains(&(along(p) / length2)))
        || (length2 == 0.0 && cubic.iter().all(|p| *p == cubic[0]))
}

/// The coarsest lattice on whose nodes all lines have their corners and ends, those at the sides of the window or beyond left
/// aside, and whose steps to one of the eight nodes around they follow. `None` where there is none, or where lines run far between
/// corners, so that its nodes mean nothing.
pub fn ruling(lines: &[Vec<Vector<2>>], window: &Bounds<2>) -> Option<Ruling> {
    let side = window.size()[0].max(window.size()[1]);
    let inside = window.grown(-SAME * side);
    let nodes: Vec<Vector<2>> = lines.iter().flatten().copied().filter(|&p| inside.contains(p)).collect();
    let found = directions(lines).into_iter().filter_map(|axis| along(axis, &nodes, side));
    let kept = found.filter(|ruling| lines.iter().all(|line| ruling.is_followed(line, &inside)));
    let best = kept.max_by(|a, b| a.cell().total_cmp(&b.cell()))?;
    (best.mean_run(lines) <= RUN).then_some(best)
}

/// Directions of lines, and those half way between, as unit vectors of the first quadrant, those along which most is drawn first.
fn directions(lines: &[Vec<Vector<2>>]) -> Vec<Vector<2>> {
    let mut found: Vec<(Vector<2>, f64)> = Vec::new();
    for step in lines.iter().flat_map(|line| line.windows(2)).map(|pair| pair[1] - pair[0]) {
        let unit = quadrant(step.unit_or_zero());
        match found.iter().position(|(known, _)| is_along(*known, unit)) {
            Some(k) => found[k].1 += step.norm(),
            None if found.len() < 4 * TRIED => found.push((unit, step.norm())),
            None => {}
        }
    }
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    let tried = found.into_iter().take(TRIED).flat_map(|(unit, _)| {
        let turned = Vector::xy(unit[0] - unit[1], unit[0] + unit[1]).unit_or_zero();
        [unit, quadrant(turned)]
    });
    let mut all: Vec<Vector<2>> = Vec::new();
    for unit in tried {
        if !all.iter().any(|&known| is_along(known, unit)) {
            all.push(unit);
        }
    }
    all
}

/// Whether two directions are the same but for right angles.
fn is_along(a: Vector<2>, b: Vector<2>) -> bool {
    a.cross(b).abs() < PARALLEL || a.dot(b).abs() < PARALLEL
}

/// The same direction but for right angles, pointing right and not down.
fn quadrant(unit: Vector<2>) -> Vector<2> {
    let mut unit = unit;
    for _ in 0..3 {
        if unit[0] > 0.0 && unit[1] >= 0.0 {
            break;
        }
        unit = Vector::xy(-unit[1], unit[0]);
    }
    unit
}

/// The lattice along an axis and across it.
fn along(axis: Vector<2>, nodes: &[Vector<2>], side: f64) -> Option<Ruling> {
    let axes = [axis, Vector::xy(-axis[1], axis[0])];
    let mut origin = Vector::ZERO;
    let mut vectors = [Vector::ZERO; 2];
    for k in 0..2 {
        let coordinates = nodes.iter().map(|p| p.dot(axes[k])).collect();
        let (start, step) = steps(coordinates, side)?;
        origin += axes[k] * start;
        vectors[k] = axes[k] * step;
    }
    Some(Ruling { origin, vectors })
}

/// The first of evenly spaced numbers near which all of these lie, and their distance.
fn steps(mut all: Vec<f64>, side: f64) -> Option<(f64, f64)> {
    all.sort_by(f64::total_cmp);
    let mut distinct: Vec<(f64, f64)> = Vec::new();
    for &x in &all {
        match distinct.last_mut() {
            Some((sum, count)) if x - *sum / *count < SAME * side => (*sum, *count) = (*sum + x, *count + 1.0),
            _ => distinct.push((x, 1.0)),
        }
    }
    let places: Vec<f64> = distinct.iter().map(|(sum, count)| sum / count).collect();
    if places.len() < LINES.0 {
        return None;
    }
    let least = places.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let fits = (1..=GAPS).map(|k| least / k as f64).filter(|step| side / step <= LINES.1);
    fits.filter_map(|step| fitted(&places, &all, step)).max_by(|a, b| a.1.total_cmp(&b.1))
}

/// A start and a step near this one by least squares, where nearly all numbers lie near a multiple.
fn fitted(places: &[f64], all: &[f64], mut step: f64) -> Option<(f64, f64)> {
    let mut start = places[0];
    // A step is known the better, the farther places are reached by it.
    for reach in [6.0, 30.0, f64::INFINITY] {
        let near: Vec<(f64, f64)> =
            places.iter().map(|x| (((x - start) / step).round(), *x)).filter(|(n, _)| *n <= reach).collect();
        let count = near.len() as f64;
        let mean = |f: &dyn Fn(&(f64, f64)) -> f64| near.iter().map(f).sum::<f64>() / count;
        let (n, x) = (mean(&|p| p.0), mean(&|p| p.1));
        let spread = mean(&|p| (p.0 - n).powi(2));
        if spread > 0.0 {
            step = mean(&|p| (p.0 - n) * (p.1 - x)) / spread;
            start = x - step * n;
        }
    }
    let off = |x: &&f64| {
        let steps = (**x - start) / step;
        (steps - steps.round()).abs() > OFF
    };
    let odd = all.iter().filter(off).count();
    (step > 0.0 && odd as f64 <= (1.0 - ON_NODES) * all.len() as f64).then_some((start, step))
}

impl Ruling {
    fn cell(&self) -> f64 {
        self.vectors[0].norm() * self.vectors[1].norm()
    }

    /// Coordinates of a place, in steps from the origin.
    pub fn coordinates(&self, p: Vector<2>) -> Vector<2> {
        let part = |v: Vector<2>| (p - self.origin).dot(v) / v.norm2();
        Vector::xy(part(self.vectors[0]), part(self.vectors[1]))
    }

    /// The place of a node.
    pub fn at(&self, node: [i64; 2]) -> Vector<2> {
        self.origin + self.vectors[0] * node[0] as f64 + self.vectors[1] * node[1] as f64
    }

    /// Whether a line runs from node to node along, across or halfway between, wherever it lies in the box.
    fn is_followed(&self, line: &[Vector<2>], inside: &Bounds<2>) -> bool {
        line.windows(2).all(|pair| {
            let [a, b] = [self.coordinates(pair[0]), self.coordinates(pair[1])];
            let on_node = |c: Vector<2>| (0..2).all(|k| (c[k] - c[k].round()).abs() <= 2.0 * OFF);
            let d = b - a;
            let steep = d[0].abs().min(d[1].abs());
            let is_step = steep <= 2.0 * OFF || (d[0].abs() - d[1].abs()).abs() <= 2.0 * OFF;
            let is_there = |p: Vector<2>, c: Vector<2>| !inside.contains(p) || on_node(c);
            is_step && is_there(pair[0], a) && is_there(pair[1], b)
        })
    }

    /// Steps from corner to corner, in the mean.
    fn mean_run(&self, lines: &[Vec<Vector<2>>]) -> f64 {
        let runs = lines.iter().flat_map(|line| line.windows(2));
        let steps = |pair: &[Vector<2>]| {
            let d = self.coordinates(pair[1]) - self.coordinates(pair[0]);
            d[0].abs().max(d[1].abs())
        };
        let (sum, count) = runs.fold((0.0, 0.0), |(sum, count), pair| (sum + steps(pair), count + 1.0));
        sum / f64::max(count, 1.0)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use super::*;
    use crate::random::{Stage, Stream};

    fn walls(at: impl Fn(f64, f64) -> Vector<2>) -> Vec<Vec<Vector<2>>> {
        let mut stream = Stream::new(1, Stage::TEST, 0);
        let cells = (0..100).map(|k| (f64::from(k % 10), f64::from(k / 10)));
        cells
            .map(|(x, y)| {
                let (dx, dy) = if stream.unit() < 0.5 { (1.0, 0.0) } else { (0.0, 1.0) };
                vec![at(x, y), at(x + dx, y + dy)]
            })
            .collect()
    }

    fn window(side: f64) -> Bounds<2> {
        Bounds::new(Vector::xy(-0.2 * side, -0.2 * side), Vector::xy(side, side))
    }

    #[test]
    fn walls_on_squared_paper_show_its_lines() {
        let found = ruling(&walls(|x, y| Vector::xy(3.0 + 8.0 * x, 1.0 + 8.0 * y)), &window(100.0)).unwrap();
        assert!((found.vectors[0].norm() - 8.0).abs() < 1e-9 && (found.vectors[1].norm() - 8.0).abs() < 1e-9);
        let c = found.coordinates(Vector::xy(3.0, 1.0));
        assert!((c[0] - c[0].round()).abs() < 1e-9 && (c[1] - c[1].round()).abs() < 1e-9);
    }

    #[test]
    fn turned_paper_and_paper_of_oblong_cells_are_found() {
        let (s, c) = 0.4_f64.sin_cos();
        let turned = walls(|x, y| Vector::xy(c * 8.0 * x - s * 5.0 * y, s * 8.0 * x + c * 5.0 * y));
        let found = ruling(&turned, &window(150.0)).unwrap();
        let mut sides = found.vectors.map(Vector::norm);
        sides.sort_by(f64::total_cmp);
        assert!((sides[0] - 5.0).abs() < 1e-9 && (sides[1] - 8.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn diagonals_from_corner_to_corner_lie_on_the_upright_lattice() {
        let mut stream = Stream::new(2, Stage::TEST, 0);
        let cells = (0..64).map(|k| (20.0 * f64::from(k % 8), 20.0 * f64::from(k / 8)));
        let lines: Vec<_> = cells
            .map(|(x, y)| {
                let up = stream.unit() < 0.5;
                let (a, b) = if up { (y, y + 20.0) } else { (y + 20.0, y) };
                vec![Vector::xy(x, a), Vector::xy(x + 20.0, b)]
            })
            .collect();
        let found = ruling(&lines, &window(165.0)).unwrap();
        assert!((found.cell() - 400.0).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn lines_at_any_distance_and_lines_that_bend_show_none() {
        let mut stream = Stream::new(3, Stage::TEST, 0);
        let strewn: Vec<_> = (0..60)
            .map(|_| {
                let p = Vector::xy(stream.range(0.0, 90.0), stream.range(0.0, 90.0));
                vec![p, p + Vector::xy(7.0, 0.0)]
            })
            .collect();
        assert!(ruling(&strewn, &window(100.0)).is_none());
        let arc = [Vector::xy(0.0, 0.0), Vector::xy(0.0, 5.0), Vector::xy(5.0, 10.0), Vector::xy(10.0, 10.0)];
        assert!(corners(&Path { cubics: vec![arc], closed: false }).is_none());
        let line = [Vector::xy(0.0, 0.0), Vector::xy(9.0, 3.0)];
        assert_eq!(corners(&Path::polyline(&line)).unwrap(), line.to_vec());
    }
}
