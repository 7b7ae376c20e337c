//! The graph of all strokes: ends that meet, ends that meet a stroke on its way, strokes that cross.

use std::collections::BTreeSet;

use arabesque_core::{Bounds, Budget, DisjointSets, Domain, GridIndex, Result, Vector, arc_lengths, segment};
use rayon::prelude::*;

use crate::scene::Scene;

/// Longest piece of a stroke, in spacings.
const PIECE: f64 = 0.4;
/// What ends may lie apart and still meet: share of the spacing, and of the width of the strokes.
const MEET: (f64, f64) = (0.02, 0.6);
/// Steps in which bends are looked at, in spacings.
const STEP: f64 = 0.2;
/// Work for each pair of pieces.
const PAIR: u64 = 20;
/// Turn at a node of a stroke from which on it is a kink, in radians.
const KINK: f64 = 0.6;

/// A straight piece of a stroke.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece<const D: usize> {
    pub(crate) line: usize,
    pub(crate) ends: (Vector<D>, Vector<D>),
    /// Distance of its start along the stroke.
    from: f64,
}

impl<const D: usize> Piece<D> {
    pub(crate) fn middle(&self) -> Vector<D> {
        (self.ends.0 + self.ends.1) * 0.5
    }

    pub(crate) fn length(&self) -> f64 {
        (self.ends.1 - self.ends.0).norm()
    }
}

/// A place where strokes end or meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node<const D: usize> {
    pub(crate) at: Vector<D>,
    /// Strokes that leave it: 1 at a loose end.
    pub(crate) degree: usize,
}

/// The strokes of a scene as a graph.
#[derive(Clone, Debug, Default)]
pub(crate) struct Graph<const D: usize> {
    pub(crate) pieces: Vec<Piece<D>>,
    /// Loose ends and junctions, nothing where one stroke goes on as another.
    pub(crate) nodes: Vec<Node<D>>,
    /// Places at which a stroke turns sharply away from any junction.
    pub(crate) kinks: Vec<Vector<D>>,
    /// Places in equal steps along all strokes, with the turn there in radians for each spacing.
    pub(crate) bends: Vec<(Vector<D>, f64)>,
}

/// Something that happens to a stroke at a place: it ends there, or goes through.
#[derive(Clone, Copy, Debug)]
struct Event<const D: usize> {
    at: Vector<D>,
    line: usize,
    is_end: bool,
}

impl<const D: usize> Graph<D> {
    /// The graph of the strokes of a scene.
    pub(crate) fn of(scene: &Scene<'_, D>, budget: &Budget) -> Result<Self> {
        let (pieces, kinks) = pieces(scene);
        let bends = scene.lines.iter().flat_map(|line| bends(&line.points, scene.spacing)).collect();
        if pieces.is_empty() {
            return Ok(Self::default());
        }
        let widest = scene.lines.iter().map(|l| l.width).fold(0.0, f64::max);
        let meet = |width: f64| (MEET.0 * scene.spacing).max(MEET.1 * width);
        let middles: Vec<Vector<D>> = pieces.iter().map(Piece::middle).collect();
        let around = Domain::Box(Bounds::around(middles.iter().copied()));
        let index = GridIndex::new(&middles, PIECE * scene.spacing, &around);
        let mut events = ends(scene);
        let met = |&event: &Event<D>| -> Result<Vec<Event<D>>> {
            let own = scene.lines[event.line].width;
            let radius = 0.5 * PIECE * scene.spacing + meet(widest.max(own));
            budget.spend(PAIR * index.load(event.at, radius))?;
            let mut nearest: Vec<(usize, f64)> = Vec::new();
            index.within(event.at, radius, |k, _| {
                let piece = &pieces[k];
                let is_own = piece.line == event.line
                    && ((piece.ends.0 - event.at).norm().min((piece.ends.1 - event.at).norm()) < 3.0 * meet(own));
                let distance = segment::distance(piece.ends, event.at);
                if !is_own && distance <= meet(own.max(scene.lines[piece.line].width)) {
                    nearest.push((piece.line, distance));
                }
            });
            nearest.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
            nearest.dedup_by_key(|(line, _)| *line);
            Ok(nearest.into_iter().map(|(line, _)| Event { at: event.at, line, is_end: false }).collect())
        };
        let touched: Vec<Vec<Event<D>>> = events.par_iter().map(met).collect::<Result<_>>()?;
        events.extend(touched.into_iter().flatten());
        if D == 2 {
            events.extend(crossings(&pieces, &index, scene, budget)?);
        }
        let nodes = nodes(&events, meet(widest), budget)?;
        let near = |p: &Vector<D>| !nodes.iter().any(|n| n.degree > 2 && (n.at - *p).norm() < 2.0 * meet(widest));
        let kinks = if nodes.len() * kinks.len() < 1 << 24 { kinks.into_iter().filter(near).collect() } else { kinks };
        Ok(Self { pieces, nodes, kinks, bends })
    }
}

/// All strokes in short straight pieces, and their kinks.
fn pieces<const D: usize>(scene: &Scene<'_, D>) -> (Vec<Piece<D>>, Vec<Vector<D>>) {
    let (mut pieces, mut kinks) = (Vec::new(), Vec::new());
    for (number, line) in scene.lines.iter().enumerate() {
        let (mut from, mut before) = (0.0, None);
        let turn = |a: Vector<D>, b: Vector<D>| a.cosine(b).clamp(-1.0, 1.0).acos();
        for (k, w) in line.points.windows(2).enumerate() {
            let way = w[1] - w[0];
            let length = way.norm();
            if length <= 0.0 {
                continue;
            }
            let bend = before.map_or(0.0, |b: Vector<D>| turn(b, way));
            if bend > KINK && line.nodes.binary_search(&k).is_ok() {
                kinks.push(w[0]);
            }
            before = Some(way);
            let count = (length / (PIECE * scene.spacing)).ceil().clamp(1.0, 1e5) as usize;
            for j in 0..count {
                let at = |j: usize| w[0] + way * (j as f64 / count as f64);
                pieces.push(Piece { line: number, ends: (at(j), at(j + 1)), from });
                from += length / count as f64;
            }
        }
    }
    (pieces, kinks)
}

/// The turns along a polyline in equal steps, whatever its corners are.
fn bends<const D: usize>(points: &[Vector<D>], spacing: f64) -> Vec<(Vector<D>, f64)> {
    if points.len() < 2 {
        return Vec::new();
    }
    let arcs = arc_lengths(points);
    let length = arcs.last().copied().unwrap_or(0.0);
    let count = (length / (STEP * spacing)).floor().min(1e6) as usize;
    let step = length / count.max(1) as f64;
    let mut k = 0;
    let places: Vec<Vector<D>> = (0..=count)
        .map(|n| {
            let arc = n as f64 * step;
            while k + 2 < arcs.len() && arcs[k + 1] < arc {
                k += 1;
            }
            let share = (arc - arcs[k]) / (arcs[k + 1] - arcs[k]).max(f64::MIN_POSITIVE);
            points[k] + (points[k + 1] - points[k]) * share.clamp(0.0, 1.0)
        })
        .collect();
    let turn = |w: &[Vector<D>]| (w[1] - w[0]).cosine(w[2] - w[1]).clamp(-1.0, 1.0).acos();
    places.windows(3).map(|w| (w[1], turn(w) * spacing / step)).collect()
}

fn ends<const D: usize>(scene: &Scene<'_, D>) -> Vec<Event<D>> {
    let open = scene.lines.iter().enumerate().filter(|(_, line)| !line.is_closed);
    let of = |(line, l): (usize, &crate::scene::Line<D>)| {
        [l.points.first().copied(), l.points.last().copied()].map(|at| at.map(|at| Event { at, line, is_end: true }))
    };
    open.flat_map(of).flatten().collect()
}

/// Places where strokes cross, both of them as going through.
fn crossings<const D: usize>(
    pieces: &[Piece<D>],
    index: &GridIndex<D>,
    scene: &Scene<'_, D>,
    budget: &Budget,
) -> Result<Vec<Event<D>>> {
    let flat = |p: Vector<D>| Vector::xy(p[0], p[1]);
    let reach = PIECE * scene.spacing;
    let of = |i: usize| -> Result<Vec<Event<D>>> {
        let piece = &pieces[i];
        budget.spend(PAIR * (1 + index.load(piece.middle(), reach)))?;
        let mut found = Vec::new();
        index.within(piece.middle(), reach, |j, _| {
            let other = &pieces[j];
            let is_next = other.line == piece.line && (other.from - piece.from).abs() < 2.0 * reach;
            if j <= i || is_next {
                return;
            }
            let (a, b) = ((flat(piece.ends.0), flat(piece.ends.1)), (flat(other.ends.0), flat(other.ends.1)));
            if let Some([t, _]) = segment::crossing(a, b).filter(|_| segment::crosses(a, b)) {
                let at = piece.ends.0 + (piece.ends.1 - piece.ends.0) * t;
                found.push((j, Event { at, line: piece.line, is_end: false }));
                found.push((j, Event { at, line: other.line, is_end: false }));
            }
        });
        found.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.line.cmp(&b.1.line)));
        Ok(found.into_iter().map(|(_, event)| event).collect())
    };
    let found: Vec<Vec<Event<D>>> = (0..pieces.len()).into_par_iter().map(of).collect::<Result<_>>()?;
    budget.spend(0)?;
    Ok(found.into_iter().flatten().collect())
}

/// Puts together what happens at one place, and counts the strokes that leave it.
fn nodes<const D: usize>(events: &[Event<D>], meet: f64, budget: &Budget) -> Result<Vec<Node<D>>> {
    let places: Vec<Vector<D>> = events.iter().map(|e| e.at).collect();
    let around = Domain::Box(Bounds::around(places.iter().copied()));
    let index = GridIndex::new(&places, meet.max(1e-12), &around);
    let mut sets = DisjointSets::new(events.len());
    let mut meter = budget.meter();
    for (i, &p) in places.iter().enumerate() {
        meter.spend(PAIR * index.load(p, meet))?;
        index.within(p, meet, |j, _| {
            if j > i {
                sets.join(i, j);
            }
        });
    }
    let mut nodes = Vec::new();
    for group in sets.groups() {
        let ends = group.iter().filter(|&&k| events[k].is_end).count();
        let ending: BTreeSet<usize> = group.iter().filter(|&&k| events[k].is_end).map(|&k| events[k].line).collect();
        let passing: BTreeSet<usize> = group
            .iter()
            .filter(|&&k| !events[k].is_end && !ending.contains(&events[k].line))
            .map(|&k| events[k].line)
            .collect();
        let degree = ends + 2 * passing.len();
        let at = group.iter().fold(Vector::ZERO, |sum, &k| sum + places[k]) * (1.0 / group.len() as f64);
        if degree != 2 {
            nodes.push(Node { at, degree });
        }
    }
    Ok(nodes)
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Class, Contents, Curve, Exemplar, Path};

    use super::*;

    fn graph(lines: &[&[(f64, f64)]]) -> Graph<2> {
        let points = |line: &&[(f64, f64)]| line.iter().map(|&(x, y)| Vector::xy(x, y)).collect::<Vec<_>>();
        let curves =
            lines.iter().map(|l| Curve { path: Path::polyline(&points(l)), style: 0, width: 0.2, colour: [0.0; 3] });
        let contents =
            Contents { curves: curves.collect(), styles: vec![Class { name: "s".into() }], ..Contents::default() };
        let window = Bounds::new(Vector::ZERO, Vector::splat(20.0));
        let exemplar = Exemplar::with_curves("t", contents, window).unwrap();
        let budget = Budget::default();
        Graph::of(&Scene::new(&exemplar, Domain::Box(window), 4.0, &budget).unwrap(), &budget).unwrap()
    }

    fn degrees(graph: &Graph<2>) -> Vec<usize> {
        let mut degrees: Vec<usize> = graph.nodes.iter().map(|n| n.degree).collect();
        degrees.sort_unstable();
        degrees
    }

    #[test]
    fn ends_meetings_and_crossings_are_told_apart() {
        // A cross, a T whose bar ends a little short of the stroke, and two strokes that go on as one.
        assert_eq!(degrees(&graph(&[&[(2.0, 5.0), (8.0, 5.0)], &[(5.0, 2.0), (5.0, 8.0)]])), [1, 1, 1, 1, 4]);
        assert_eq!(degrees(&graph(&[&[(2.0, 5.0), (8.0, 5.0)], &[(5.0, 5.05), (5.0, 9.0)]])), [1, 1, 1, 3]);
        assert_eq!(degrees(&graph(&[&[(2.0, 5.0), (8.0, 5.0)], &[(8.0, 5.0), (14.0, 6.0)]])), [1, 1]);
        let star: &[&[(f64, f64)]] = &[&[(5.0, 5.0), (1.0, 5.0)], &[(5.0, 5.0), (9.0, 2.0)], &[(5.0, 5.0), (9.0, 9.0)]];
        assert_eq!(degrees(&graph(star)), [1, 1, 1, 3]);
    }

    #[test]
    fn bends_are_those_of_the_curve_and_not_of_its_corners() {
        let corner = |k: u32, n: u32| {
            let turn = f64::from(k) / f64::from(n) * std::f64::consts::TAU;
            Vector::xy(turn.cos(), turn.sin()) * 5.0
        };
        for n in [90, 400] {
            let circle: Vec<_> = (0..=n).map(|k| corner(k, n)).collect();
            let bends = bends(&circle, 4.0);
            assert!(bends.len() > 30 && bends.iter().all(|(_, bend)| (bend - 0.8).abs() < 0.15), "{bends:?}");
        }
        assert!(bends(&[Vector::xy(0.0, 0.0)], 4.0).is_empty() && bends::<2>(&[], 4.0).is_empty());
    }

    #[test]
    fn a_corner_is_a_kink() {
        let corner = graph(&[&[(2.0, 5.0), (8.0, 5.0), (8.0, 12.0)]]);
        assert_eq!((corner.kinks.clone(), degrees(&corner)), (vec![Vector::xy(8.0, 5.0)], vec![1, 1]));
    }
}
