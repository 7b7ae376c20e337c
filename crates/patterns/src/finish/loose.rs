//! Loose ends of lines that the exemplar does not have: contour lines end nowhere but at the frame.
//!
//! Ends that face one another are joined where nothing lies between them.

use arabesque_core::{
    Border, Bounds, Budget, Domain, Drawn, Exemplar, GridIndex, Path, Request, Result, Vector, cubic_at,
};

use crate::regular::grid::constant;

// As shares of the mean distance between lines:
/// How near to another line an end is on it, and how near to the border at it.
const ON: f64 = 0.12;
/// How far ends may be from one another to be joined.
const GAP: f64 = 2.6;
/// How far what joins them keeps from other lines.
const CLEAR: f64 = 0.3;
/// Steps in which lines are looked at.
const STEP: f64 = 0.1;

/// Cosine from which on an end faces a place.
const FACING: f64 = -0.1;
/// Loose ends above what is expected, as a factor, and beyond that, that are left alone.
const SLACK: (f64, f64) = (1.2, 1.0);
/// Places that a line that joins two others is looked at.
const LOOKS: usize = 16;
/// Work for each place of a line, and for each that is looked at.
const WORK: u64 = 60;

/// Loose ends of an exemplar.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LooseEnds {
    /// Number in a unit of area.
    density: f64,
    /// Mean distance between lines.
    apart: f64,
}

impl LooseEnds {
    /// Counts them; `None` for an exemplar without lines.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn of(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Self>> {
        let lines: Vec<Drawn<2>> = (0..exemplar.curves.len())
            .map(|source| Drawn { path: exemplar.curves[source].path.clone(), source, scale: 1.0, frozen: None })
            .collect();
        let domain = Domain::Box(exemplar.window);
        let length: f64 = lines.iter().map(|line| length_in(&line.path, &exemplar.window)).sum();
        if length <= 0.0 || exemplar.hole.is_some() {
            return Ok(None);
        }
        let area = exemplar.window.measure();
        let apart = area / length;
        let ends = Page { exemplar, domain: &domain, apart }.loose(&lines, budget)?;
        Ok(Some(Self { density: ends.len() as f64 / area, apart }))
    }

    /// Joins loose ends until there are no more of them than in the exemplar, or none that can be joined.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn mended(
        &self,
        curves: Vec<Drawn<2>>,
        exemplar: &Exemplar<2>,
        request: &Request<2>,
    ) -> Result<Vec<Drawn<2>>> {
        let Some((_, _, spacing)) = constant(&request.fields) else { return Ok(curves) };
        let is_plain = request.frozen_curves.is_empty() && request.known.is_none() && request.obstacles.is_empty();
        if !is_plain || request.border == Border::Turn {
            return Ok(curves);
        }
        let budget = &request.budget.stage("joining loose ends");
        let page = Page { exemplar, domain: &request.domain, apart: self.apart * spacing };
        let expected = SLACK.0 * self.density / (spacing * spacing) * request.domain.measure() + SLACK.1;
        let loose = page.loose(&curves, budget)?;
        if loose.len() as f64 <= expected {
            return Ok(curves);
        }
        let most = (loose.len() as f64 - expected) / 2.0;
        page.joined(curves, &loose, most.ceil() as usize, budget)
    }
}

/// An end of a line that is on nothing.
#[derive(Clone, Copy, Debug)]
struct End {
    line: usize,
    /// 0 for the start, 1 for the end.
    side: usize,
    at: Vector<2>,
    /// The way in which the line would go on.
    way: Vector<2>,
}

/// A line that would join two ends.
struct Joint {
    cost: f64,
    ends: [usize; 2],
    cubic: [Vector<2>; 4],
}

/// Where lines are looked at.
struct Page<'a> {
    exemplar: &'a Exemplar<2>,
    domain: &'a Domain<2>,
    apart: f64,
}

/// Places along lines: line and number of steps from its start, and in all.
struct Places {
    index: GridIndex<2>,
    of: Vec<(usize, usize)>,
    counts: Vec<usize>,
}

impl Page<'_> {
    fn places(&self, lines: &[Drawn<2>], budget: &Budget) -> Result<Places> {
        let (mut places, mut of, mut counts) = (Vec::new(), Vec::new(), Vec::new());
        for (n, line) in lines.iter().enumerate() {
            let points = along(&line.path, STEP * self.apart);
            budget.spend(WORK * points.len() as u64)?;
            of.extend((0..points.len()).map(|k| (n, k)));
            counts.push(points.len());
            places.extend(points);
        }
        Ok(Places { index: GridIndex::new(&places, CLEAR * self.apart, self.domain), of, counts })
    }

    /// The ends of lines that are neither at the border nor on another line.
    fn loose(&self, lines: &[Drawn<2>], budget: &Budget) -> Result<Vec<End>> {
        let places = self.places(lines, budget)?;
        let mut found = Vec::new();
        for (n, line) in lines.iter().enumerate().filter(|(_, line)| !line.path.closed) {
            let half = 0.5 * self.exemplar.curves[line.source].width * line.scale;
            let on = (ON * self.apart).max(half);
            let points = along(&line.path, STEP * self.apart);
            let Some(last) = points.len().checked_sub(1).filter(|last| *last > 0) else { continue };
            for (side, at, before) in
                [(0, points[0], points[last.min(3)]), (1, points[last], points[last - last.min(3)])]
            {
                if self.domain.signed_distance(at) < on + STEP * self.apart {
                    continue;
                }
                let mut is_on = false;
                let near = (2.0 * on / (STEP * self.apart)).ceil() as usize + 1;
                budget.spend(
                    WORK * places.index.within(at, on, |k, _| {
                        let (other, step) = places.of[k];
                        let own = if side == 0 { step <= near } else { step + near > last };
                        is_on |= other != n || !own;
                    }),
                )?;
                if !is_on {
                    found.push(End { line: n, side, at, way: (at - before).unit_or_zero() });
                }
            }
        }
        Ok(found)
    }

    /// The lines with up to so many pairs of their loose ends joined, those that fit best first.
    fn joined(&self, lines: Vec<Drawn<2>>, ends: &[End], most: usize, budget: &Budget) -> Result<Vec<Drawn<2>>> {
        let places = self.places(&lines, budget)?;
        let points: Vec<Vector<2>> = ends.iter().map(|end| end.at).collect();
        let index = GridIndex::new(&points, GAP * self.apart, self.domain);
        let mut joints: Vec<Joint> = Vec::new();
        for (a, end) in ends.iter().enumerate() {
            let mut near = Vec::new();
            budget.spend(WORK * index.within(end.at, GAP * self.apart, |b, offset| near.push((b, offset))))?;
            for (b, offset) in near.into_iter().filter(|(b, _)| *b > a) {
                let style = |end: &End| self.exemplar.curves[lines[end.line].source].style;
                let is_far = |offset: Vector<2>| (end.at + offset - ends[b].at).norm() > 1e-6 * self.apart;
                if style(end) != style(&ends[b]) || is_far(offset) {
                    continue;
                }
                if let Some(joint) = self.joint([a, b], ends, &places, budget)? {
                    joints.push(joint);
                }
            }
        }
        joints.sort_by(|a, b| a.cost.total_cmp(&b.cost).then(a.ends.cmp(&b.ends)));
        let mut is_free = vec![true; ends.len()];
        let mut taken: Vec<Joint> = Vec::new();
        for joint in joints {
            budget.spend(1 + taken.len() as u64)?;
            let crosses = |other: &Joint| self.is_near(&joint.cubic, &other.cubic);
            if taken.len() < most && joint.ends.iter().all(|&e| is_free[e]) && !taken.iter().any(crosses) {
                joint.ends.iter().for_each(|&e| is_free[e] = false);
                taken.push(joint);
            }
        }
        chained(lines, ends, &taken, budget)
    }

    /// What would join two ends, where they face one another and nothing lies between.
    fn joint(&self, pair: [usize; 2], ends: &[End], places: &Places, budget: &Budget) -> Result<Option<Joint>> {
        let [a, b] = pair.map(|e| ends[e]);
        let between = b.at - a.at;
        let distance = between.norm();
        let facing = [a.way.dot(between), -b.way.dot(between)].map(|x| x / distance.max(f64::MIN_POSITIVE));
        let is_turning = a.line == b.line && distance * 3.0 > STEP * self.apart * places.counts[a.line] as f64;
        if facing.iter().any(|x| *x < FACING) || is_turning {
            return Ok(None);
        }
        let cubic = [a.at, a.at + a.way * (distance / 3.0), b.at + b.way * (distance / 3.0), b.at];
        let skipped = (1.5 * CLEAR / STEP) as usize + 1;
        for k in 0..=LOOKS {
            let p = cubic_at(&cubic, k as f64 / LOOKS as f64);
            let mut is_clear = true;
            budget.spend(
                WORK * places.index.within(p, CLEAR * self.apart, |place, _| {
                    let (line, step) = places.of[place];
                    let is_own = |end: &End| {
                        let last = places.counts[line] - 1;
                        line == end.line && if end.side == 0 { step <= skipped } else { step + skipped >= last }
                    };
                    is_clear &= is_own(&a) || is_own(&b);
                }),
            )?;
            if !is_clear {
                return Ok(None);
            }
        }
        let cost = distance * (3.0 - facing[0] - facing[1]);
        Ok(Some(Joint { cost, ends: pair, cubic }))
    }

    /// Whether two lines that join others come near one another.
    fn is_near(&self, a: &[Vector<2>; 4], b: &[Vector<2>; 4]) -> bool {
        let boxes = [a, b].map(|c| Bounds::around(c.iter().copied()).grown(CLEAR * self.apart));
        if !boxes[0].intersects(&boxes[1]) {
            return false;
        }
        let at = |c: &[Vector<2>; 4], k: usize| cubic_at(c, k as f64 / LOOKS as f64);
        let near = |p: Vector<2>| (0..=LOOKS).any(|k| (at(b, k) - p).norm() < CLEAR * self.apart);
        (0..=LOOKS).any(|k| near(at(a, k)))
    }
}

/// The lines with these joints between them.
fn chained(lines: Vec<Drawn<2>>, ends: &[End], joints: &[Joint], budget: &Budget) -> Result<Vec<Drawn<2>>> {
    let mut lines: Vec<Option<Drawn<2>>> = lines.into_iter().map(Some).collect();
    // Where the start and the end of each line have come to lie, and whose they are.
    let mut home: Vec<[(usize, usize); 2]> = (0..lines.len()).map(|n| [(n, 0), (n, 1)]).collect();
    let mut owner = home.clone();
    for joint in joints {
        let [(i, side), (j, other)] = joint.ends.map(|e| home[ends[e].line][ends[e].side]);
        let Some(mut first) = lines[i].take() else { continue };
        budget.spend(WORK * (1 + first.path.cubics.len()) as u64)?;
        if side == 0 {
            first.path = first.path.reversed();
        }
        if i == j {
            first.path.cubics.push(joint.cubic);
            first.path.closed = true;
            lines[i] = Some(first);
            continue;
        }
        let Some(second) = lines[j].take() else {
            lines[i] = Some(first);
            continue;
        };
        let rest = if other == 0 { second.path } else { second.path.reversed() };
        first.path.cubics.push(joint.cubic);
        first.path.cubics.extend(rest.cubics);
        owner[i] = [owner[i][1 - side], owner[j][1 - other]];
        for (side, (line, end)) in owner[i].into_iter().enumerate() {
            home[line][end] = (i, side);
        }
        lines[i] = Some(first);
    }
    Ok(lines.into_iter().flatten().collect())
}

/// Places along a path in steps no longer than this.
fn along(path: &Path<2>, step: f64) -> Vec<Vector<2>> {
    let corners = path.flatten(0.2 * step);
    let mut points: Vec<Vector<2>> = corners.first().copied().into_iter().collect();
    for pair in corners.windows(2) {
        let count = ((pair[1] - pair[0]).norm() / step).ceil().clamp(1.0, 1e5) as usize;
        points.extend((1..=count).map(|k| pair[0] + (pair[1] - pair[0]) * (k as f64 / count as f64)));
    }
    points
}

/// Length of a path in a box, about.
fn length_in(path: &Path<2>, window: &Bounds<2>) -> f64 {
    let points = path.flatten(1e-3 * window.size().norm());
    points.windows(2).filter(|p| window.contains((p[0] + p[1]) * 0.5)).map(|p| (p[1] - p[0]).norm()).sum()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use arabesque_core::{Class, Contents, Curve};

    use super::*;

    /// Lines across a page of 100, 10 apart.
    fn lines() -> Vec<Path<2>> {
        (0..9)
            .map(|k| 10.0 * f64::from(k) + 10.0)
            .map(|y| Path::polyline(&[Vector::xy(0.0, y), Vector::xy(100.0, y)]))
            .collect()
    }

    fn exemplar() -> Exemplar<2> {
        let curve = |path| Curve { path, style: 0, width: 1.0, colour: [0.0; 3] };
        let curves = lines().into_iter().map(curve).collect();
        let contents = Contents { curves, styles: vec![Class { name: "a".into() }], ..Contents::default() };
        Exemplar::with_curves("t", contents, page()).unwrap()
    }

    fn page() -> Bounds<2> {
        Bounds::new(Vector::ZERO, Vector::xy(100.0, 100.0))
    }

    fn drawn(path: Path<2>) -> Drawn<2> {
        Drawn { path, source: 0, scale: 1.0, frozen: None }
    }

    #[test]
    fn ends_that_face_one_another_are_joined() {
        let exemplar = exemplar();
        let budget = Budget::default();
        let ends = LooseEnds::of(&exemplar, &budget).unwrap().unwrap();
        assert_eq!(ends.density, 0.0);
        let line = |a: [f64; 2], b: [f64; 2]| drawn(Path::polyline(&[Vector(a), Vector(b)]));
        let mut curves: Vec<_> = lines().into_iter().take(7).map(drawn).collect();
        // A gap in a line, and a line that ends.
        curves.extend([
            line([0.0, 80.0], [45.0, 80.0]),
            line([60.0, 82.0], [100.0, 82.0]),
            line([0.0, 90.0], [50.0, 90.0]),
        ]);
        let request = Request::new(Domain::Box(page()));
        let mended = ends.mended(curves, &exemplar, &request).unwrap();
        assert_eq!(mended.len(), 9);
        let joined = &mended[7].path;
        assert!((joined.start().unwrap() - Vector::xy(0.0, 80.0)).norm() < 1e-9 && joined.cubics.len() == 3);
        assert!((joined.end().unwrap() - Vector::xy(100.0, 82.0)).norm() < 1e-9);
    }

    #[test]
    fn an_end_on_another_line_is_not_loose() {
        let exemplar = exemplar();
        let domain = Domain::Box(page());
        let page = Page { exemplar: &exemplar, domain: &domain, apart: 10.0 };
        let tee = drawn(Path::polyline(&[Vector::xy(50.0, 20.0), Vector::xy(50.0, 55.0)]));
        let mut all: Vec<_> = lines().into_iter().map(drawn).collect();
        all.push(tee);
        let found = page.loose(&all, &Budget::default()).unwrap();
        assert!(matches!(found.as_slice(), [End { line: 9, side: 1, .. }]), "{found:?}");
    }
}
