//! Straight lines that an irregular pattern has bent, made straight again.
//!
//! Where all that the exemplar draws are straight lines in a few directions, so should all be that is made of it: streets,
//! joints of planks, fences. The lines of a result are taken apart into runs of one direction, runs that go on in one another are
//! put on one line, and corners and ends are moved to where lines meet.

use arabesque_core::{
    Budget, DisjointSets, Domain, Drawn, Exemplar, GridIndex, Path, Request, Result, Vector, corners, segment, straight,
};

use crate::regular::grid::constant;

/// Directions that differ by less than this, as a sine, are one.
const PARALLEL: f64 = 0.02;
/// Directions at most, and the share of all lines that they have to hold.
const FEW: (usize, f64) = (6, 0.97);
/// Directions that are told apart, the first ones met: lines in more of them run in too many anyhow.
const KNOWN: usize = 64;
/// Lines to judge by, at least.
const LINES: usize = 6;

// All as shares of the mean distance between lines:
/// How far lines may bend without being thought to turn.
const WOBBLE: f64 = 0.12;
/// Runs between two of one direction that are shorter than this are bends of them, and shorter than this share of the short runs of
/// the exemplar: one in so many is shorter.
const JOG: f64 = 0.45;
const SHORT: (usize, f64) = (10, 0.6);
/// How near an end lies to the line that it ends on, or goes on as.
const JOINT: f64 = 0.2;
/// How far a corner may be moved.
const MOVE: f64 = 0.8;

/// Work for each point and each pair of runs that are compared, and for a point or run that is only looked at.
const WORK: u64 = 60;
const EACH: u64 = 10;

/// The directions of an exemplar of straight lines.
#[derive(Clone, Debug)]
pub(crate) struct Straight {
    /// Unit vectors, no two of them along one another.
    directions: Vec<Vector<2>>,
    /// Mean distance between lines.
    apart: f64,
    /// Runs between two others that are shorter than this are bends of them.
    jog: f64,
}

/// A stretch of a line in one direction.
#[derive(Clone, Debug)]
struct Run {
    direction: usize,
    /// Mean distance from the origin along the normal, and the length that it is the mean over.
    offset: f64,
    length: f64,
    /// Its ends before it was straightened.
    ends: [Vector<2>; 2],
}

impl Straight {
    /// Finds the directions; `None` where lines bend or run in too many.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn of(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Self>> {
        if exemplar.curves.len() < LINES {
            return Ok(None);
        }
        let mut found: Vec<(Vector<2>, f64)> = Vec::new();
        let (mut total, mut lengths) = (0.0, Vec::new());
        for curve in &exemplar.curves {
            budget.spend(WORK * curve.path.cubics.len() as u64)?;
            let Some(corners) = corners(&curve.path) else { return Ok(None) };
            for pair in corners.windows(2) {
                let step = pair[1] - pair[0];
                let unit = step.unit_or_zero();
                total += step.norm();
                lengths.push(step.norm());
                match found.iter().position(|(known, _)| known.unit_or_zero().cross(unit).abs() < PARALLEL) {
                    // Along the one that is known, not against it.
                    Some(k) => {
                        let step = if found[k].0.dot(step) < 0.0 { -step } else { step };
                        found[k] = (found[k].0 + step, found[k].1 + step.norm());
                    }
                    None if found.len() < KNOWN => found.push((step, step.norm())),
                    None => {}
                }
            }
        }
        found.sort_by(|a, b| b.1.total_cmp(&a.1));
        found.truncate(FEW.0);
        let held: f64 = found.iter().map(|(_, length)| length).sum();
        let apart = exemplar.view().measure() / total.max(f64::MIN_POSITIVE);
        lengths.sort_by(f64::total_cmp);
        let short = lengths.get(lengths.len() / SHORT.0).map_or(0.0, |length| SHORT.1 * length);
        let directions: Vec<_> = found.iter().map(|(sum, _)| sum.unit_or_zero()).collect();
        let jog = short.min(JOG * apart);
        let is_straight = total > 0.0 && directions.len() > 1 && held >= FEW.1 * total;
        Ok(is_straight.then_some(Self { directions, apart, jog }))
    }

    /// The strokes of a result made straight; where they go around a tile, are bent by fields or join what stays, as they are.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn straightened(&self, curves: Vec<Drawn<2>>, request: &Request<2>) -> Result<Vec<Drawn<2>>> {
        let Some((turn, _, spacing)) = constant(&request.fields) else { return Ok(curves) };
        let is_plain = request.frozen_curves.is_empty() && request.known.is_none();
        if !is_plain || matches!(request.domain, Domain::Torus(_)) {
            return Ok(curves);
        }
        let directions = self.directions.iter().map(|d| turn.apply(*d)).collect();
        let (apart, jog) = (self.apart * spacing, self.jog * spacing);
        let work = Straightening { directions, apart, jog, domain: &request.domain };
        work.of(curves, &request.budget.stage("straightening lines"))
    }
}

/// Straightening of the strokes of one result.
struct Straightening<'a> {
    directions: Vec<Vector<2>>,
    apart: f64,
    jog: f64,
    domain: &'a Domain<2>,
}

impl Straightening<'_> {
    fn of(&self, curves: Vec<Drawn<2>>, budget: &Budget) -> Result<Vec<Drawn<2>>> {
        let mut all: Vec<Vec<Run>> = Vec::with_capacity(curves.len());
        for drawn in &curves {
            let points = drawn.path.flatten(0.02 * self.apart);
            budget.spend(WORK * points.len() as u64 * (1 + self.directions.len() as u64))?;
            all.push(self.runs(&points, budget)?);
        }
        let offsets = self.lined_up(&all, budget)?;
        let index = Index::new(&all, JOINT.max(1e-9) * self.apart, self.domain);
        let mut made = Vec::with_capacity(curves.len());
        let mut first = 0;
        for (drawn, runs) in curves.into_iter().zip(&all) {
            let points = self.corners(runs, first, (&offsets, &index, &all), drawn.path.closed, budget)?;
            first += runs.len();
            let cubics: Vec<_> = points.windows(2).map(|p| straight(p[0], p[1])).filter(|c| c[0] != c[3]).collect();
            if cubics.is_empty() {
                continue;
            }
            made.push(Drawn { path: Path { cubics, closed: drawn.path.closed }, ..drawn });
        }
        Ok(made)
    }

    fn normal(&self, direction: usize) -> Vector<2> {
        let d = self.directions[direction];
        Vector::xy(-d[1], d[0])
    }

    /// The runs of a line.
    fn runs(&self, points: &[Vector<2>], budget: &Budget) -> Result<Vec<Run>> {
        let mut runs: Vec<Run> = Vec::new();
        for pair in simplified(points, WOBBLE * self.apart, budget)?.windows(2) {
            let run = self.run(pair[0], pair[1]);
            match runs.last_mut() {
                Some(last) if last.direction == run.direction => *last = joined(last, &run),
                _ => runs.push(run),
            }
        }
        // Jogs first that are shortest.
        while runs.len() > 1 {
            budget.spend(EACH * runs.len() as u64)?;
            let extent = |run: &Run| (run.ends[1] - run.ends[0]).norm();
            let is_jog = |k: &usize| {
                let inner = *k > 0 && *k + 1 < runs.len();
                let most = if inner && runs[*k - 1].direction != runs[*k + 1].direction { 0.5 } else { 1.0 };
                extent(&runs[*k]) < most * self.jog
            };
            let shortest =
                (0..runs.len()).filter(is_jog).min_by(|a, b| extent(&runs[*a]).total_cmp(&extent(&runs[*b])));
            let Some(k) = shortest else { break };
            let gone = runs.remove(k);
            match k {
                0 => runs[0].ends[0] = gone.ends[0],
                _ if k == runs.len() => runs[k - 1].ends[1] = gone.ends[1],
                _ => {
                    let middle = (gone.ends[0] + gone.ends[1]) * 0.5;
                    (runs[k - 1].ends[1], runs[k].ends[0]) = (middle, middle);
                    if runs[k - 1].direction == runs[k].direction {
                        let next = runs.remove(k);
                        runs[k - 1] = joined(&runs[k - 1], &next);
                    }
                }
            }
        }
        Ok(runs)
    }

    fn run(&self, a: Vector<2>, b: Vector<2>) -> Run {
        let step = b - a;
        let along = |k: &usize| step.dot(self.directions[*k]).abs();
        let direction = (0..self.directions.len()).max_by(|x, y| along(x).total_cmp(&along(y))).unwrap_or(0);
        let offset = ((a + b) * 0.5).dot(self.normal(direction));
        Run { direction, offset, length: along(&direction), ends: [a, b] }
    }

    /// The offset of each run once those that go on in one another lie on one line.
    fn lined_up(&self, all: &[Vec<Run>], budget: &Budget) -> Result<Vec<f64>> {
        let runs: Vec<&Run> = all.iter().flatten().collect();
        let ends: Vec<Vector<2>> = runs.iter().flat_map(|run| run.ends).collect();
        let reach = JOINT * self.apart;
        let index = GridIndex::new(&ends, reach.max(1e-9), self.domain);
        let mut sets = DisjointSets::new(runs.len());
        for (e, &end) in ends.iter().enumerate() {
            let mut near = Vec::new();
            budget.spend(WORK * index.within(end, reach, |k, _| near.push(k)))?;
            for other in near {
                if other / 2 != e / 2 && runs[other / 2].direction == runs[e / 2].direction {
                    sets.join(e / 2, other / 2);
                }
            }
        }
        let mut offsets = vec![0.0; runs.len()];
        for group in sets.groups() {
            let length: f64 = group.iter().map(|&r| runs[r].length).sum::<f64>().max(f64::MIN_POSITIVE);
            let mean = group.iter().map(|&r| runs[r].length * runs[r].offset).sum::<f64>() / length;
            group.iter().for_each(|&r| offsets[r] = mean);
        }
        Ok(offsets)
    }

    /// The corners of a line, given the number of its first run.
    fn corners(
        &self,
        runs: &[Run],
        first: usize,
        (offsets, index, all): (&[f64], &Index, &[Vec<Run>]),
        closed: bool,
        budget: &Budget,
    ) -> Result<Vec<Vector<2>>> {
        let place = |k: usize, p: Vector<2>| {
            let normal = self.normal(runs[k].direction);
            p + normal * (offsets[first + k] - p.dot(normal))
        };
        let mut points = Vec::with_capacity(runs.len() + 1);
        let Some(last) = runs.len().checked_sub(1) else { return Ok(points) };
        let is_ring = closed && last > 0 && runs[0].direction != runs[last].direction;
        let meet = |k: usize, l: usize, near: Vector<2>| {
            let lines = [(runs[k].direction, offsets[first + k]), (runs[l].direction, offsets[first + l])];
            self.meet(lines, near).map_or_else(|| [place(k, near), place(l, near)], |met| [met; 2])
        };
        let end = |k: usize, p: Vector<2>| -> Result<Vector<2>> {
            let mut best: Option<(f64, Vector<2>)> = None;
            budget.spend(
                WORK * index.near(p, |r| {
                    let run = index.run(all, r);
                    if r == first + k
                        || run.direction == runs[k].direction
                        || segment::distance((run.ends[0], run.ends[1]), p) > JOINT * self.apart
                    {
                        return;
                    }
                    let lines = [(runs[k].direction, offsets[first + k]), (run.direction, offsets[r])];
                    if let Some(met) = self.meet(lines, p) {
                        let moved = (met - p).norm();
                        if best.is_none_or(|b| moved < b.0) {
                            best = Some((moved, met));
                        }
                    }
                }),
            )?;
            Ok(best.map_or_else(|| self.to_border(place(k, p), p), |b| b.1))
        };
        points.push(if is_ring { meet(last, 0, runs[0].ends[0])[1] } else { end(0, runs[0].ends[0])? });
        for (k, run) in runs[..last].iter().enumerate() {
            points.extend(meet(k, k + 1, run.ends[1]));
        }
        if is_ring {
            points.extend([meet(last, 0, runs[0].ends[0])[0], points[0]]);
        } else if closed {
            points.push(points[0]);
        } else {
            points.push(end(last, runs[last].ends[1])?);
        }
        Ok(points)
    }

    /// Where two lines meet, unless that is far from a place.
    fn meet(&self, [a, b]: [(usize, f64); 2], near: Vector<2>) -> Option<Vector<2>> {
        let [m, n] = [self.normal(a.0), self.normal(b.0)];
        let det = m.cross(n);
        if det.abs() < PARALLEL {
            return None;
        }
        let met = Vector::xy(a.1 * n[1] - b.1 * m[1], b.1 * m[0] - a.1 * n[0]) * (1.0 / det);
        ((met - near).norm() <= MOVE * self.apart).then_some(met)
    }

    /// An end that was moved away from the border, moved beyond it.
    fn to_border(&self, moved: Vector<2>, from: Vector<2>) -> Vector<2> {
        let by = (moved - from).norm();
        let was_at_border = self.domain.signed_distance(from).abs() < WOBBLE * self.apart;
        if !was_at_border || self.domain.signed_distance(moved) <= 0.0 || by == 0.0 {
            return moved;
        }
        let out = self.directions.iter().flat_map(|d| [*d, -*d]).map(|d| moved + d * (2.0 * by));
        out.filter(|p| self.domain.signed_distance(*p) <= 0.0 && (*p - from).dot(moved - from).abs() <= 1.01 * by * by)
            .min_by(|a, b| (*a - from).norm().total_cmp(&(*b - from).norm()))
            .unwrap_or(moved)
    }
}

/// Runs by where they lie.
struct Index {
    /// Places along runs, and the runs.
    grid: GridIndex<2>,
    runs: Vec<usize>,
    /// For each run the line and its number there.
    homes: Vec<(usize, usize)>,
    reach: f64,
}

impl Index {
    fn new(all: &[Vec<Run>], reach: f64, domain: &Domain<2>) -> Self {
        let homes: Vec<(usize, usize)> =
            all.iter().enumerate().flat_map(|(line, runs)| (0..runs.len()).map(move |k| (line, k))).collect();
        let (mut places, mut runs) = (Vec::new(), Vec::new());
        for (r, &(line, k)) in homes.iter().enumerate() {
            let [a, b] = all[line][k].ends;
            let steps = ((b - a).norm() / reach).ceil().clamp(1.0, 1e5) as usize;
            places.extend((0..=steps).map(|s| a + (b - a) * (s as f64 / steps as f64)));
            runs.resize(places.len(), r);
        }
        Self { grid: GridIndex::new(&places, reach, domain), runs, homes, reach }
    }

    fn run<'r>(&self, all: &'r [Vec<Run>], r: usize) -> &'r Run {
        let (line, k) = self.homes[r];
        &all[line][k]
    }

    /// Calls `found` with runs near a place, and returns how much was looked at.
    fn near(&self, p: Vector<2>, mut found: impl FnMut(usize)) -> u64 {
        self.grid.within(p, 1.6 * self.reach, |place, _| found(self.runs[place]))
    }
}

/// Two runs of one direction as one.
fn joined(a: &Run, b: &Run) -> Run {
    let length = a.length + b.length;
    let offset = if length > 0.0 { (a.offset * a.length + b.offset * b.length) / length } else { a.offset };
    Run { direction: a.direction, offset, length, ends: [a.ends[0], b.ends[1]] }
}

/// The points without which a line would lie farther than `tolerance` from where it was.
fn simplified(points: &[Vector<2>], tolerance: f64, budget: &Budget) -> Result<Vec<Vector<2>>> {
    let Some(last) = points.len().checked_sub(1).filter(|last| *last > 0) else { return Ok(points.to_vec()) };
    let mut is_kept = vec![false; points.len()];
    (is_kept[0], is_kept[last]) = (true, true);
    // A ring has no chord: its farthest point is kept as well.
    let mut open = vec![(0, last)];
    while let Some((a, b)) = open.pop() {
        budget.spend(EACH * (b - a) as u64)?;
        let off = |k: &usize| segment::distance((points[a], points[b]), points[*k]);
        let farthest = (a + 1..b).max_by(|x, y| off(x).total_cmp(&off(y)));
        if let Some(k) = farthest.filter(|k| off(k) > tolerance) {
            is_kept[k] = true;
            open.extend([(a, k), (k, b)]);
        }
    }
    Ok(points.iter().zip(is_kept).filter(|(_, kept)| *kept).map(|(p, _)| *p).collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use arabesque_core::{Bounds, Class, Contents, Curve};

    use super::*;

    fn page() -> Bounds<2> {
        Bounds::new(Vector::ZERO, Vector::xy(100.0, 100.0))
    }

    /// Streets across and along, 20 apart.
    fn streets() -> Exemplar<2> {
        let at = (0..5).map(|k| 10.0 + 20.0 * f64::from(k));
        let lines = at.flat_map(|s| [[s, 0.0, s, 100.0], [0.0, s, 100.0, s]]);
        let curve = |[a, b, c, d]: [f64; 4]| {
            let path = Path::polyline(&[Vector::xy(a, b), Vector::xy(c, d)]);
            Curve { path, style: 0, width: 1.0, colour: [0.0; 3] }
        };
        let styles = vec![Class { name: "a".into() }];
        let contents = Contents { curves: lines.map(curve).collect(), styles, ..Contents::default() };
        Exemplar::with_curves("t", contents, page()).unwrap()
    }

    fn straightened(lines: &[&[[f64; 2]]]) -> Vec<Vec<Vector<2>>> {
        let drawn = |line: &&[[f64; 2]]| Drawn {
            path: Path::polyline(&line.iter().map(|p| Vector(*p)).collect::<Vec<_>>()),
            source: 0,
            scale: 1.0,
            frozen: None,
        };
        let straight = Straight::of(&streets(), &Budget::default()).unwrap().unwrap();
        let made =
            straight.straightened(lines.iter().map(drawn).collect(), &Request::new(Domain::Box(page()))).unwrap();
        made.iter().map(|drawn| corners(&drawn.path).unwrap()).collect()
    }

    #[test]
    fn a_line_that_wanders_becomes_straight_and_its_corner_right() {
        let made =
            straightened(&[&[[0.0, 50.0], [20.0, 50.6], [40.0, 49.8], [60.0, 50.2], [60.5, 70.0], [59.8, 100.0]]]);
        let line: Vec<_> = made[0].iter().copied().filter(|p| page().contains(*p)).collect();
        assert!(
            line.windows(2).all(|p| {
                let step = p[1] - p[0];
                step[0].abs() < 1e-9 || step[1].abs() < 1e-9
            }),
            "{line:?}"
        );
        assert_eq!(made[0].len(), 3);
    }

    #[test]
    fn a_line_ends_on_the_line_that_it_ended_on_and_goes_on_as_the_one_it_went_on_as() {
        let made = straightened(&[
            &[[0.0, 50.0], [30.0, 50.4], [100.0, 50.1]],
            &[[40.0, 0.0], [40.4, 25.0], [40.2, 50.3]],
            &[[40.2, 50.3], [39.8, 80.0], [40.1, 100.0]],
        ]);
        let (across, above, below) = (made[0][0][1], &made[1], &made[2]);
        assert!((above[above.len() - 1][1] - across).abs() < 1e-9 && (below[0][1] - across).abs() < 1e-9, "{made:?}");
        assert!((above[0][0] - below[0][0]).abs() < 1e-9);
    }

    #[test]
    fn lines_that_bend_or_run_anywhere_have_no_directions() {
        let mut bent = streets();
        bent.curves[0].path.cubics[0][1] += Vector::xy(3.0, 0.0);
        assert!(Straight::of(&bent, &Budget::default()).unwrap().is_none());
        let mut strewn = streets();
        for (k, curve) in (0..).map(f64::from).zip(&mut strewn.curves) {
            curve.path = Path::polyline(&[
                Vector::xy(50.0, 50.0),
                Vector::xy(50.0 + (0.31 * k).cos() * 40.0, 50.0 + (0.31 * k).sin() * 40.0),
            ]);
        }
        assert!(Straight::of(&strewn, &Budget::default()).unwrap().is_none());
    }
}
