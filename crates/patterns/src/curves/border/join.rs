//! Strokes that come back from the border as their neighbours.
//!
//! What the border leaves of a closed stroke is closed along it. Of the others, going round a ring, each end is joined
//! to the next of its style, unless that closes a loop; of several places to begin at the one is taken that leaves the
//! fewest ends and makes the shortest runs. Only neighbours are joined, so that no run crosses a stroke. A loop would
//! be a stroke that the exemplar has none of, cut off from all others.

use arabesque_core::{Budget, Cubic, Drawn, Meter, Path, Result};

use crate::curves::border::{
    fit::{Passage, arc},
    rings::{ClippedStroke, OffsetRings},
};

/// Runs along the border are no longer than this many of the usual gaps between ends.
const MAX_GAP: f64 = 4.0;

/// What an end that is joined to nothing costs, in usual gaps.
const ALONE: f64 = 4.0;

/// Places on a ring at which joining is tried to begin.
const BEGINNINGS: usize = 32;

/// Turns take at most this share of a stroke from either of its ends.
const SHARE: f64 = 0.4;

/// Nanoseconds for a stroke that is given another group.
const GROUP: u64 = 1;

/// An end of a stroke on a ring.
#[derive(Clone, Copy, Debug)]
struct End {
    stroke: usize,
    /// 0: its start, 1: its end.
    end: usize,
    arc: f64,
}

/// Two neighbours on a ring, the second after the first.
#[derive(Clone, Copy, Debug)]
struct Joint {
    ring: usize,
    ends: [End; 2],
    gap: f64,
}

/// The ends on a ring in order, each with the gap behind it and whether it is joined already.
type Round = Vec<(End, f64, bool)>;

/// Joins the ends of strokes along the rings.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn join(clipped: Vec<ClippedStroke>, rings: &OffsetRings, budget: &Budget) -> Result<Vec<Drawn<2>>> {
    let mut meter = budget.meter();
    let mut groups: Vec<usize> = (0..clipped.len()).collect();
    let mut joints = Vec::new();
    for ring in 0..rings.all.len() {
        joints.extend(joints_on(ring, &clipped, rings, &mut groups, &mut meter)?);
    }
    Ok(StrokeJoiner::new(&clipped, &joints, rings).strokes())
}

/// The joints on a ring; strokes that become one get into one group.
fn joints_on(
    ring: usize,
    clipped: &[ClippedStroke],
    rings: &OffsetRings,
    groups: &mut Vec<usize>,
    meter: &mut Meter<'_>,
) -> Result<Vec<Joint>> {
    meter.spend(10 * GROUP * clipped.len() as u64)?;
    let place = |(stroke, end): (usize, usize)| {
        let place = clipped[stroke].reaches[end].filter(|p| p.ring == ring)?;
        Some(End { stroke, end, arc: place.arc })
    };
    let ends = (0..clipped.len()).flat_map(|t| [(t, 0), (t, 1)]);
    let mut ends: Vec<End> = ends.filter_map(place).collect();
    ends.sort_by(|a, b| a.arc.total_cmp(&b.arc).then((a.stroke, a.end).cmp(&(b.stroke, b.end))));
    let length = rings.all[ring].length();
    let n = ends.len();
    let gap = |k: usize| (ends[(k + 1) % n].arc - ends[k].arc).rem_euclid(length);
    let mut round: Round = (0..n).map(|k| (ends[k], gap(k), false)).collect();
    let mut gaps: Vec<f64> = round.iter().map(|r| r.1).collect();
    gaps.sort_by(f64::total_cmp);
    let Some(&usual) = gaps.get(n / 2).filter(|_| n > 1) else { return Ok(Vec::new()) };
    let usual = usual.max(2.0 * rings.radius);
    let mut joints = close(ring, &mut round, clipped);
    joints.extend(best_round(ring, &round, usual, clipped, groups, meter)?);
    Ok(joints)
}

/// Closes what is left of closed strokes where nothing else lies between its ends.
fn close(ring: usize, round: &mut Round, clipped: &[ClippedStroke]) -> Vec<Joint> {
    let n = round.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| round[a].1.total_cmp(&round[b].1).then(a.cmp(&b)));
    let mut joints = Vec::new();
    for k in order {
        let ((a, gap, used), (b, ..)) = (round[k], round[(k + 1) % n]);
        let is_own = a.stroke == b.stroke && a.end != b.end && clipped[a.stroke].is_closed;
        // A way around the border that is longer than the stroke would close it on the wrong side.
        if is_own && !used && gap < clipped[a.stroke].measured.length() {
            (round[k].2, round[(k + 1) % n].2) = (true, true);
            joints.push(Joint { ring, ends: [a, b], gap });
        }
    }
    joints
}

/// The joints on a ring from the best of several places to begin.
fn best_round(
    ring: usize,
    round: &Round,
    usual: f64,
    clipped: &[ClippedStroke],
    groups: &mut Vec<usize>,
    meter: &mut Meter<'_>,
) -> Result<Vec<Joint>> {
    let n = round.len();
    let mut best: Option<(f64, Vec<Joint>, Vec<usize>)> = None;
    let beginnings = (0..n.min(BEGINNINGS)).map(|k| k * n / n.min(BEGINNINGS));
    for first in beginnings.flat_map(|k| [k, k + 1]) {
        meter.spend(GROUP * ((2 + n / 2) * groups.len()) as u64)?;
        let mut tried = groups.clone();
        let turned: Round = (0..n).map(|i| round[(first + i) % n]).collect();
        let found = join_around(ring, &turned, MAX_GAP * usual, clipped, &mut tried);
        let alone = (n - 2 * found.len()) as f64;
        let cost = found.iter().map(|j| j.gap).sum::<f64>() + ALONE * usual * alone;
        if best.as_ref().is_none_or(|b| cost < b.0 - 1e-9) {
            best = Some((cost, found, tried));
        }
    }
    Ok(best.map_or(Vec::new(), |(_, found, tried)| {
        *groups = tried;
        found
    }))
}

/// Joins each end to the next where that may be.
fn join_around(
    ring: usize,
    round: &Round,
    longest: f64,
    clipped: &[ClippedStroke],
    groups: &mut [usize],
) -> Vec<Joint> {
    let n = round.len();
    let mut used: Vec<bool> = round.iter().map(|r| r.2).collect();
    let mut joints = Vec::new();
    for k in 0..n {
        let ((a, gap, _), (b, ..)) = (round[k], round[(k + 1) % n]);
        let (from, to) = (groups[a.stroke], groups[b.stroke]);
        let is_free = !used[k] && !used[(k + 1) % n];
        if is_free && gap <= longest && from != to && clipped[a.stroke].style == clipped[b.stroke].style {
            groups.iter_mut().filter(|g| **g == to).for_each(|g| *g = from);
            joints.push(Joint { ring, ends: [a, b], gap });
            (used[k], used[(k + 1) % n]) = (true, true);
        }
    }
    joints
}

/// One of the two ends that a joint joins.
#[derive(Clone, Copy, Debug, PartialEq)]
struct JointSide {
    joint: usize,
    /// Which of [`Joint::ends`].
    side: usize,
}

/// Strokes and their joints, to be put together.
struct StrokeJoiner<'a> {
    clipped: &'a [ClippedStroke],
    joints: &'a [Joint],
    rings: &'a OffsetRings,
    /// The joint at each end of each stroke.
    joined: Vec<[Option<JointSide>; 2]>,
}

impl<'a> StrokeJoiner<'a> {
    fn new(clipped: &'a [ClippedStroke], joints: &'a [Joint], rings: &'a OffsetRings) -> Self {
        let mut joined = vec![[None; 2]; clipped.len()];
        for (joint, Joint { ends, .. }) in joints.iter().enumerate() {
            for (side, end) in ends.iter().enumerate() {
                joined[end.stroke][end.end] = Some(JointSide { joint, side });
            }
        }
        Self { clipped, joints, rings, joined }
    }

    /// Every stroke once. Except those that are joined to themselves, each has a free end.
    fn strokes(&self) -> Vec<Drawn<2>> {
        let mut seen = vec![false; self.clipped.len()];
        let mut strokes = Vec::new();
        for t in 0..self.clipped.len() {
            if let [Some(a), Some(b)] = self.joined[t]
                && a.joint == b.joint
            {
                strokes.push(self.closed(t, b));
                continue;
            }
            let Some(first) = (0..2).find(|&end| self.joined[t][end].is_none()).filter(|_| !seen[t]) else { continue };
            strokes.push(self.stroke(t, first, &mut seen));
        }
        strokes
    }

    /// A stroke that is joined to itself. `end`: of the joint, the side that is its end.
    fn closed(&self, stroke: usize, end: JointSide) -> Drawn<2> {
        let mut cubics = self.body(stroke, 0).cubics;
        cubics.extend(self.turn(end));
        if let Some(&[start, ..]) = cubics.first()
            && let Some(last) = cubics.last_mut()
        {
            last[3] = start;
        }
        Drawn { path: Path { cubics, closed: true }, ..self.clipped[stroke].drawn.clone() }
    }

    /// The stroke that begins with a free end.
    fn stroke(&self, first: usize, start: usize, seen: &mut [bool]) -> Drawn<2> {
        let drawn = &self.clipped[first].drawn;
        if self.joined[first] == [None; 2] {
            seen[first] = true;
            return drawn.clone();
        }
        let (mut stroke, mut from) = (first, start);
        let mut cubics = Vec::new();
        loop {
            seen[stroke] = true;
            cubics.extend(self.body(stroke, from).cubics);
            let Some(side) = self.joined[stroke][1 - from] else { break };
            cubics.extend(self.turn(side));
            let next = self.joints[side.joint].ends[1 - side.side];
            (stroke, from) = (next.stroke, next.end);
            if seen[stroke] {
                break;
            }
        }
        Drawn { path: Path { cubics, closed: false }, ..drawn.clone() }
    }

    /// A stroke without what its turns take, from one of its ends to the other.
    fn body(&self, stroke: usize, from: usize) -> Path<2> {
        let measured = &self.clipped[stroke].measured;
        let cut = |end: usize| self.joined[stroke][end].map_or(0.0, |side| self.radius(side.joint, stroke));
        let (a, b) = (cut(0), measured.length() - cut(1));
        let (a, b) = if from == 0 { (a, b) } else { (b, a) };
        let mut path = measured.part(a, b);
        if let Some(first) = path.cubics.first_mut() {
            first[0] = measured.point(a);
        }
        path
    }

    /// How much of a stroke a turn takes.
    fn radius(&self, joint: usize, stroke: usize) -> f64 {
        self.radius_on_ring(joint).min(SHARE * self.clipped[stroke].measured.length())
    }

    fn radius_on_ring(&self, joint: usize) -> f64 {
        self.rings.radius.min(0.5 * self.joints[joint].gap)
    }

    /// From the end of one stroke to the beginning of the next, `side` being where it comes from.
    fn turn(&self, JointSide { joint: number, side }: JointSide) -> Vec<Cubic<2>> {
        let joint = &self.joints[number];
        let radius = self.radius_on_ring(number);
        let (from, to) = (joint.ends[0].arc + radius, joint.ends[0].arc + joint.gap - radius);
        let ring = joint.ring;
        let on_ring = |arc: f64| Passage {
            place: self.rings.all[ring].point(arc.rem_euclid(self.rings.all[ring].length())),
            way: self.rings.way(ring, arc),
        };
        let [a, b] = joint.ends.map(|end| self.leave(number, end));
        let mut cubics = vec![arc(a, on_ring(from))];
        if to - from > 1e-6 * self.rings.radius {
            cubics.extend(self.rings.run(ring, from, to));
        }
        cubics.push(arc(on_ring(to), Passage { way: b.way * -1.0, ..b }));
        for k in 1..cubics.len() {
            cubics[k][0] = cubics[k - 1][3];
        }
        if side == 1 {
            cubics = Path { cubics, closed: false }.reversed().cubics;
        }
        cubics
    }

    /// Where a turn leaves a stroke, and the direction towards the border there.
    fn leave(&self, joint: usize, end: End) -> Passage {
        let measured = &self.clipped[end.stroke].measured;
        let (cut, length) = (self.radius(joint, end.stroke), measured.length());
        let step = 1e-3 * length;
        let at = |back: f64| measured.point(if end.end == 0 { back } else { length - back });
        Passage { place: at(cut), way: (at((cut - step).max(0.0)) - at(cut + step)).unit_or_zero() }
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Measured, Outline, Vector};

    use super::*;
    use crate::curves::border::border_turn::{BorderTurn, Ending};

    fn square(side: f64) -> Outline<2> {
        let corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)];
        Outline { rings: vec![corners.map(|(x, y)| Vector::xy(x, y)).to_vec()] }
    }

    fn line(points: &[(f64, f64)], source: usize) -> Drawn<2> {
        let points: Vec<_> = points.iter().map(|&(x, y)| Vector::xy(x, y)).collect();
        Drawn { path: Path::polyline(&points), source, scale: 1.0, frozen: None }
    }

    fn rows(n: usize) -> Vec<Drawn<2>> {
        (0..n).map(|k| 10.0 * k as f64 + 5.0).map(|y| line(&[(-20.0, y), (120.0, y)], 0)).collect()
    }

    /// Every stroke lies inside, its ink and all.
    fn assert_inside(strokes: &[Drawn<2>], outline: &Outline<2>) {
        let room = arabesque_core::Shape::from_outline(outline.clone()).unwrap();
        for drawn in strokes {
            for p in drawn.path.flatten(1e-3) {
                let depth = arabesque_core::Region::signed_distance(&room, p);
                assert!(depth >= 0.5, "{p:?} is {depth} inside");
            }
        }
    }

    fn free_ends(strokes: &[Drawn<2>]) -> usize {
        2 * strokes.iter().filter(|d| !d.path.closed).count()
    }

    #[test]
    fn parallel_lines_are_one_serpentine() {
        let border = BorderTurn::test(square(100.0), &[false], Ending::IntoNeighbour);
        let strokes = border.finish(rows(10)).unwrap();
        assert_eq!(strokes.len(), 1);
        assert_inside(&strokes, &square(100.0));
        let length = Measured::new(strokes[0].path.clone(), 1e-3).length();
        // Ten lines and nine turns, whose rounded corners are shortcuts.
        assert!((1020.0..1090.0).contains(&length), "{length}");
        for w in strokes[0].path.cubics.windows(2) {
            let (come, go) = ((w[0][3] - w[0][2]).unit_or_zero(), (w[1][1] - w[1][0]).unit_or_zero());
            assert!(w[0][3] == w[1][0] && come.dot(go) > 0.99, "a corner at {:?}", w[1][0]);
        }
    }

    #[test]
    fn an_odd_number_of_lines_is_one_serpentine_as_well() {
        let border = BorderTurn::test(square(90.0), &[false], Ending::IntoNeighbour);
        assert_eq!(border.finish(rows(9)).unwrap().len(), 1);
    }

    #[test]
    fn lines_that_are_painted_otherwise_are_not_joined() {
        let border = BorderTurn::test(square(100.0), &[false, false], Ending::IntoNeighbour);
        let mut lines = rows(10);
        lines[4].source = 1;
        let strokes = border.finish(lines).unwrap();
        assert_eq!(strokes.iter().filter(|d| d.source == 1).count(), 1);
        assert_eq!(strokes.len(), 3);
    }

    #[test]
    fn a_grid_has_a_stroke_along_the_border() {
        let border = BorderTurn::test(square(100.0), &[false], Ending::BorderStroke);
        let columns = (0..10).map(|k| 10.0 * f64::from(k) + 5.0).map(|x| line(&[(x, -20.0), (x, 120.0)], 0));
        let strokes = border.finish(rows(10).into_iter().chain(columns).collect()).unwrap();
        assert_eq!((strokes.len(), free_ends(&strokes)), (21, 40));
        assert_inside(&strokes, &square(100.0));
        let border = Measured::new(strokes[20].path.clone(), 1e-3);
        let around = border.length();
        assert!(strokes[20].path.closed && (380.0..396.0).contains(&around), "{around}");
        // Lines end on the border.
        for drawn in &strokes[..20] {
            for end in [drawn.path.start(), drawn.path.end()].into_iter().flatten() {
                let gap = border.points().windows(2).map(|w| to_segment(end, w)).fold(f64::INFINITY, f64::min);
                assert!(gap < 0.15, "{end:?} is {gap} from the border");
            }
        }
    }

    fn to_segment(p: Vector<2>, w: &[Vector<2>]) -> f64 {
        let along = w[1] - w[0];
        let t = ((p - w[0]).dot(along) / along.norm2().max(1e-300)).clamp(0.0, 1.0);
        (w[0] + along * t - p).norm()
    }

    #[test]
    fn a_hole_has_a_stroke_along_its_border_too() {
        let hole = square(20.0).rings[0].iter().map(|p| *p + Vector::xy(40.0, 40.0)).rev().collect();
        let room = Outline { rings: vec![square(100.0).rings[0].clone(), hole] };
        let strokes = BorderTurn::test(room.clone(), &[false], Ending::BorderStroke).finish(rows(10)).unwrap();
        assert_eq!(strokes.iter().filter(|d| d.path.closed).count(), 2);
        assert_inside(&strokes, &room);
        // Two rows are cut in two.
        assert_eq!(strokes.len(), 12 + 2);
    }

    #[test]
    fn a_closed_stroke_is_closed_along_the_border() {
        let border = BorderTurn::test(square(100.0), &[true], Ending::IntoNeighbour);
        let cell = line(&[(-10.0, 40.0), (20.0, 40.0), (20.0, 60.0), (-10.0, 60.0), (-10.0, 40.0)], 0);
        let cell = Drawn { path: Path { closed: true, ..cell.path }, ..cell };
        let strokes = border.finish(vec![cell]).unwrap();
        assert!(strokes.len() == 1 && strokes[0].path.closed);
        assert_inside(&strokes, &square(100.0));
        let size = strokes[0].path.bounds().size();
        assert!((size[0] - 19.4).abs() < 0.2 && (size[1] - 20.0).abs() < 0.1, "{size:?}");
    }

    #[test]
    fn scraps_at_the_border_are_dropped() {
        let border = BorderTurn::test(square(100.0), &[false], Ending::IntoNeighbour);
        let strokes =
            border.finish(vec![line(&[(10.0, 0.9), (90.0, 0.9)], 0), line(&[(-5.0, 1.0), (1.2, 1.0)], 0)]).unwrap();
        assert_eq!(strokes, vec![]);
    }

    #[test]
    fn where_there_is_no_room_nothing_is_drawn() {
        let border = BorderTurn::test(square(1.5), &[false], Ending::BorderStroke);
        assert_eq!(border.finish(vec![line(&[(0.0, 0.7), (1.5, 0.7)], 0)]).unwrap(), vec![]);
    }
}
