//! Strokes that come back from the border as their neighbours.
//!
//! What the border leaves of a closed stroke is closed along it. Of the others, going round a ring, each end is joined to the next of its style, unless that closes a loop; of several places to begin at the one is
//! taken that leaves the fewest ends and makes the shortest runs. Only neighbours are joined, so that no run crosses a stroke.

use arabesque_core::{Cubic, Drawn, Path, Vector};

use crate::curves::border::{
    fit::{arc, unit},
    hem::{Rings, Thread},
};

/// Runs along the border are no longer than this many of the usual gaps between ends.
const LONGEST: f64 = 4.0;

/// What an end that is joined to nothing costs, in usual gaps.
const ALONE: f64 = 4.0;

/// Places on a ring at which joining is tried to begin.
const BEGINNINGS: usize = 32;

/// Turns take at most this share of a stroke from either of its ends.
const SHARE: f64 = 0.4;

/// An end of a stroke on a ring.
#[derive(Clone, Copy, Debug)]
struct Tip {
    thread: usize,
    /// 0: its start, 1: its end.
    end: usize,
    arc: f64,
}

/// Two neighbours on a ring, the second after the first.
#[derive(Clone, Copy, Debug)]
struct Joint {
    ring: usize,
    tips: [Tip; 2],
    gap: f64,
}

/// The tips on a ring in order, each with the gap behind it and whether it is joined already.
type Round = Vec<(Tip, f64, bool)>;

/// Joins the ends of strokes along the rings.
pub(crate) fn join(threads: Vec<Thread>, rings: &Rings) -> Vec<Drawn<2>> {
    let mut groups: Vec<usize> = (0..threads.len()).collect();
    let mut joints = Vec::new();
    for ring in 0..rings.all.len() {
        joints.extend(joints_on(ring, &threads, rings, &mut groups));
    }
    Knitting::new(&threads, &joints, rings).strokes()
}

/// The joints on a ring; threads that become one stroke get into one group.
fn joints_on(ring: usize, threads: &[Thread], rings: &Rings, groups: &mut Vec<usize>) -> Vec<Joint> {
    let place = |(thread, end): (usize, usize)| {
        let place = threads[thread].reaches[end].filter(|p| p.ring == ring)?;
        Some(Tip { thread, end, arc: place.arc })
    };
    let ends = (0..threads.len()).flat_map(|t| [(t, 0), (t, 1)]);
    let mut tips: Vec<Tip> = ends.filter_map(place).collect();
    tips.sort_by(|a, b| a.arc.total_cmp(&b.arc).then((a.thread, a.end).cmp(&(b.thread, b.end))));
    let length = rings.all[ring].length();
    let n = tips.len();
    let gap = |k: usize| (tips[(k + 1) % n].arc - tips[k].arc).rem_euclid(length);
    let mut round: Round = (0..n).map(|k| (tips[k], gap(k), false)).collect();
    let mut gaps: Vec<f64> = round.iter().map(|r| r.1).collect();
    gaps.sort_by(f64::total_cmp);
    let Some(&usual) = gaps.get(n / 2).filter(|_| n > 1) else { return Vec::new() };
    let usual = usual.max(2.0 * rings.radius);
    let mut joints = close(ring, &mut round, threads);
    joints.extend(best_round(ring, (&round, usual), threads, groups));
    joints
}

/// Closes what is left of closed strokes where nothing else lies between its ends.
fn close(ring: usize, round: &mut Round, threads: &[Thread]) -> Vec<Joint> {
    let n = round.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| round[a].1.total_cmp(&round[b].1).then(a.cmp(&b)));
    let mut joints = Vec::new();
    for k in order {
        let ((a, gap, used), (b, ..)) = (round[k], round[(k + 1) % n]);
        let is_own = a.thread == b.thread && a.end != b.end && threads[a.thread].is_closed;
        // A way around the border that is longer than the stroke would close it on the wrong side.
        if is_own && !used && gap < threads[a.thread].measured.length() {
            (round[k].2, round[(k + 1) % n].2) = (true, true);
            joints.push(Joint { ring, tips: [a, b], gap });
        }
    }
    joints
}

/// The joints on a ring from the best of several places to begin.
fn best_round(ring: usize, (round, usual): (&Round, f64), threads: &[Thread], groups: &mut Vec<usize>) -> Vec<Joint> {
    let n = round.len();
    let mut best: Option<(f64, Vec<Joint>, Vec<usize>)> = None;
    let beginnings = (0..n.min(BEGINNINGS)).map(|k| k * n / n.min(BEGINNINGS));
    for first in beginnings.flat_map(|k| [k, k + 1]) {
        let mut tried = groups.clone();
        let turned: Round = (0..n).map(|i| round[(first + i) % n]).collect();
        let found = go_round(ring, (&turned, LONGEST * usual), threads, &mut tried);
        let alone = (n - 2 * found.len()) as f64;
        let cost = found.iter().map(|j| j.gap).sum::<f64>() + ALONE * usual * alone;
        if best.as_ref().is_none_or(|b| cost < b.0 - 1e-9) {
            best = Some((cost, found, tried));
        }
    }
    best.map_or(Vec::new(), |(_, found, tried)| {
        *groups = tried;
        found
    })
}

/// Joins each tip to the next where that may be.
fn go_round(ring: usize, (round, longest): (&Round, f64), threads: &[Thread], groups: &mut [usize]) -> Vec<Joint> {
    let n = round.len();
    let mut used: Vec<bool> = round.iter().map(|r| r.2).collect();
    let mut joints = Vec::new();
    for k in 0..n {
        let ((a, gap, _), (b, ..)) = (round[k], round[(k + 1) % n]);
        let (from, to) = (groups[a.thread], groups[b.thread]);
        let is_free = !used[k] && !used[(k + 1) % n];
        if is_free && gap <= longest && from != to && threads[a.thread].style == threads[b.thread].style {
            groups.iter_mut().filter(|g| **g == to).for_each(|g| *g = from);
            joints.push(Joint { ring, tips: [a, b], gap });
            (used[k], used[(k + 1) % n]) = (true, true);
        }
    }
    joints
}

/// Strokes and their joints, to be put together.
struct Knitting<'a> {
    threads: &'a [Thread],
    joints: &'a [Joint],
    rings: &'a Rings,
    /// The joint at each end of each thread, and the tip of the joint it is.
    joined: Vec<[Option<(usize, usize)>; 2]>,
}

impl<'a> Knitting<'a> {
    fn new(threads: &'a [Thread], joints: &'a [Joint], rings: &'a Rings) -> Self {
        let mut joined = vec![[None; 2]; threads.len()];
        for (number, joint) in joints.iter().enumerate() {
            for (side, tip) in joint.tips.iter().enumerate() {
                joined[tip.thread][tip.end] = Some((number, side));
            }
        }
        Self { threads, joints, rings, joined }
    }

    /// Every stroke once. But for those that are joined to themselves each has a free end.
    fn strokes(&self) -> Vec<Drawn<2>> {
        let mut seen = vec![false; self.threads.len()];
        let mut strokes = Vec::new();
        for t in 0..self.threads.len() {
            if let [Some((a, side)), Some((b, _))] = self.joined[t]
                && a == b
            {
                strokes.push(self.closed(t, (a, 1 - side)));
                continue;
            }
            let Some(first) = (0..2).find(|&end| self.joined[t][end].is_none()).filter(|_| !seen[t]) else { continue };
            strokes.push(self.stroke((t, first), &mut seen));
        }
        strokes
    }

    /// A stroke that is joined to itself. `side`: of the joint, the tip that is its end.
    fn closed(&self, thread: usize, (joint, side): (usize, usize)) -> Drawn<2> {
        let mut cubics = self.body(thread, 0).cubics;
        cubics.extend(self.turn(joint, side));
        if let Some(&[start, ..]) = cubics.first()
            && let Some(last) = cubics.last_mut()
        {
            last[3] = start;
        }
        Drawn { path: Path { cubics, closed: true }, ..self.threads[thread].drawn.clone() }
    }

    /// The stroke that begins with a free end.
    fn stroke(&self, (first, start): (usize, usize), seen: &mut [bool]) -> Drawn<2> {
        let drawn = &self.threads[first].drawn;
        if self.joined[first] == [None; 2] {
            seen[first] = true;
            return drawn.clone();
        }
        let (mut thread, mut from) = (first, start);
        let mut cubics = Vec::new();
        loop {
            seen[thread] = true;
            cubics.extend(self.body(thread, from).cubics);
            let Some((joint, side)) = self.joined[thread][1 - from] else { break };
            cubics.extend(self.turn(joint, side));
            let next = self.joints[joint].tips[1 - side];
            (thread, from) = (next.thread, next.end);
            if seen[thread] {
                break;
            }
        }
        Drawn { path: Path { cubics, closed: false }, ..drawn.clone() }
    }

    /// A thread without what its turns take, from one of its ends to the other.
    fn body(&self, thread: usize, from: usize) -> Path<2> {
        let measured = &self.threads[thread].measured;
        let cut = |end: usize| self.joined[thread][end].map_or(0.0, |(joint, _)| self.radius(joint, thread));
        let (a, b) = (cut(0), measured.length() - cut(1));
        let (a, b) = if from == 0 { (a, b) } else { (b, a) };
        let mut path = measured.part(a, b);
        if let Some(first) = path.cubics.first_mut() {
            first[0] = measured.point(a);
        }
        path
    }

    /// How much of a thread a turn takes.
    fn radius(&self, joint: usize, thread: usize) -> f64 {
        self.radius_on_ring(joint).min(SHARE * self.threads[thread].measured.length())
    }

    fn radius_on_ring(&self, joint: usize) -> f64 {
        self.rings.radius.min(0.5 * self.joints[joint].gap)
    }

    /// From the end of one thread to the beginning of the next, `side` being the one it comes from.
    fn turn(&self, number: usize, side: usize) -> Vec<Cubic<2>> {
        let joint = &self.joints[number];
        let radius = self.radius_on_ring(number);
        let (from, to) = (joint.tips[0].arc + radius, joint.tips[0].arc + joint.gap - radius);
        let ring = joint.ring;
        let at = |arc: f64| self.rings.all[ring].point(arc.rem_euclid(self.rings.all[ring].length()));
        let [a, b] = joint.tips.map(|tip| self.leave(number, tip));
        let mut cubics = vec![arc(a, (at(from), self.rings.way(ring, from)))];
        if to - from > 1e-6 * self.rings.radius {
            cubics.extend(self.rings.run(ring, from, to));
        }
        cubics.push(arc((at(to), self.rings.way(ring, to)), (b.0, b.1 * -1.0)));
        for k in 1..cubics.len() {
            cubics[k][0] = cubics[k - 1][3];
        }
        if side == 1 {
            cubics = Path { cubics, closed: false }.reversed().cubics;
        }
        cubics
    }

    /// Where a turn leaves a thread, and the direction towards the border there.
    fn leave(&self, joint: usize, tip: Tip) -> (Vector<2>, Vector<2>) {
        let measured = &self.threads[tip.thread].measured;
        let (cut, length) = (self.radius(joint, tip.thread), measured.length());
        let step = 1e-3 * length;
        let at = |back: f64| measured.point(if tip.end == 0 { back } else { length - back });
        (at(cut), unit(at((cut - step).max(0.0)) - at(cut + step)))
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Measured, Outline};

    use super::*;
    use crate::curves::border::hem::{End, Hem};

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
        let hem = Hem::test(square(100.0), &[false], End::AsNeighbour);
        let strokes = hem.finish(rows(10));
        assert_eq!(strokes.len(), 1);
        assert_inside(&strokes, &square(100.0));
        let length = Measured::new(strokes[0].path.clone(), 1e-3).length();
        // Ten lines and nine turns, whose rounded corners are shortcuts.
        assert!((1020.0..1090.0).contains(&length), "{length}");
        for w in strokes[0].path.cubics.windows(2) {
            let (come, go) = (unit(w[0][3] - w[0][2]), unit(w[1][1] - w[1][0]));
            assert!(w[0][3] == w[1][0] && come.dot(go) > 0.99, "a corner at {:?}", w[1][0]);
        }
    }

    #[test]
    fn an_odd_number_of_lines_is_one_serpentine_as_well() {
        let hem = Hem::test(square(90.0), &[false], End::AsNeighbour);
        assert_eq!(hem.finish(rows(9)).len(), 1);
    }

    #[test]
    fn lines_that_are_painted_otherwise_are_not_joined() {
        let hem = Hem::test(square(100.0), &[false, false], End::AsNeighbour);
        let mut lines = rows(10);
        lines[4].source = 1;
        let strokes = hem.finish(lines);
        assert_eq!(strokes.iter().filter(|d| d.source == 1).count(), 1);
        assert_eq!(strokes.len(), 3);
    }

    #[test]
    fn a_grid_has_a_hem_all_around() {
        let hem = Hem::test(square(100.0), &[false], End::OnRing);
        let columns = (0..10).map(|k| 10.0 * f64::from(k) + 5.0).map(|x| line(&[(x, -20.0), (x, 120.0)], 0));
        let strokes = hem.finish(rows(10).into_iter().chain(columns).collect());
        assert_eq!((strokes.len(), free_ends(&strokes)), (21, 40));
        assert_inside(&strokes, &square(100.0));
        let hem = Measured::new(strokes[20].path.clone(), 1e-3);
        let around = hem.length();
        assert!(strokes[20].path.closed && (380.0..396.0).contains(&around), "{around}");
        // Lines end on the hem.
        for drawn in &strokes[..20] {
            for end in [drawn.path.start(), drawn.path.end()].into_iter().flatten() {
                let gap = hem.points().windows(2).map(|w| to_segment(end, w)).fold(f64::INFINITY, f64::min);
                assert!(gap < 0.15, "{end:?} is {gap} from the hem");
            }
        }
    }

    fn to_segment(p: Vector<2>, w: &[Vector<2>]) -> f64 {
        let along = w[1] - w[0];
        let t = ((p - w[0]).dot(along) / along.norm2().max(1e-300)).clamp(0.0, 1.0);
        (w[0] + along * t - p).norm()
    }

    #[test]
    fn a_hole_has_a_hem_too() {
        let hole = square(20.0).rings[0].iter().map(|p| *p + Vector::xy(40.0, 40.0)).rev().collect();
        let room = Outline { rings: vec![square(100.0).rings[0].clone(), hole] };
        let strokes = Hem::test(room.clone(), &[false], End::OnRing).finish(rows(10));
        assert_eq!(strokes.iter().filter(|d| d.path.closed).count(), 2);
        assert_inside(&strokes, &room);
        // Two rows are cut in two.
        assert_eq!(strokes.len(), 12 + 2);
    }

    #[test]
    fn a_closed_stroke_is_closed_along_the_border() {
        let hem = Hem::test(square(100.0), &[true], End::AsNeighbour);
        let cell = line(&[(-10.0, 40.0), (20.0, 40.0), (20.0, 60.0), (-10.0, 60.0), (-10.0, 40.0)], 0);
        let cell = Drawn { path: Path { closed: true, ..cell.path }, ..cell };
        let strokes = hem.finish(vec![cell]);
        assert!(strokes.len() == 1 && strokes[0].path.closed);
        assert_inside(&strokes, &square(100.0));
        let size = strokes[0].path.bounds().size();
        assert!((size[0] - 19.4).abs() < 0.2 && (size[1] - 20.0).abs() < 0.1, "{size:?}");
    }

    #[test]
    fn scraps_at_the_border_are_dropped() {
        let hem = Hem::test(square(100.0), &[false], End::AsNeighbour);
        let strokes = hem.finish(vec![line(&[(10.0, 0.9), (90.0, 0.9)], 0), line(&[(-5.0, 1.0), (1.2, 1.0)], 0)]);
        assert_eq!(strokes, vec![]);
    }

    #[test]
    fn where_there_is_no_room_nothing_is_drawn() {
        let hem = Hem::test(square(1.5), &[false], End::OnRing);
        assert_eq!(hem.finish(vec![line(&[(0.0, 0.7), (1.5, 0.7)], 0)]), vec![]);
    }
}
