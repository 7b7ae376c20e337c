//! The ink of the exemplar's elements, ready to be asked how far a place is from it, and how far two elements are apart.

use std::sync::Arc;

use arabesque_core::{Bounds, Budget, Exemplar, Held, Matrix, Numbered, Outline, Result, Vector, ring};
use rayon::prelude::*;

use crate::{
    dimension::Dimension,
    evenness::distance_map::{self, DistanceMap},
    exemplar::library::Library,
};

/// Cells of a map of distances in a mean spacing.
const CELLS: f64 = 16.0;

/// Most cells in all maps together: of more, each is larger.
const MOST_CELLS: usize = 1 << 24;

/// Most points along the rim of one element.
const RIM: usize = 160;

/// Most places in a piece of a rim.
const PIECE: usize = 10;

/// Nanoseconds for a cell of a map, and for one and an edge.
const CELL: u64 = 60;

/// The ink of one element, about its centre, in exemplar directions and units.
#[derive(Clone, Debug)]
struct Ink {
    /// Distances around it; `None` for a ball.
    map: Option<DistanceMap>,
    /// Places along its rim, in pieces; none for a ball.
    rim: Vec<Piece>,
    /// How far these are apart.
    step: f64,
    /// Distance from the centre to the farthest ink.
    radius: f64,
}

/// A part of a rim, in the circle around it.
#[derive(Clone, Debug)]
struct Piece {
    centre: [f64; 2],
    radius: f64,
    places: Vec<[f64; 2]>,
}

/// From the coordinates of one element of the plane to those of another.
#[derive(Clone, Copy, Debug)]
struct Change {
    matrix: [[f64; 2]; 2],
    shift: [f64; 2],
}

impl Change {
    #[inline]
    fn apply(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([a, b], [c, d]) = (self.matrix[0], self.matrix[1]);
        [a * x + b * y + self.shift[0], c * x + d * y + self.shift[1]]
    }
}

/// An element as it lies, ready to be asked for many distances.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<'a> {
    /// `None` for a ball.
    map: Option<&'a DistanceMap>,
    /// From directions of the page to its own.
    matrix: [[f64; 2]; 2],
    scale: f64,
    radius: f64,
}

impl Placed<'_> {
    /// Distance of the ink from a place at `offset` from the centre, negative on the ink.
    #[inline]
    pub(crate) fn distance<const D: usize>(&self, offset: Vector<D>) -> f64 {
        let Some(map) = self.map else { return offset.norm() - self.radius };
        let ([a, b], [c, d], x, y) = (self.matrix[0], self.matrix[1], offset.0[0], offset.0[1]);
        map.at([a * x + b * y, c * x + d * y]) * self.scale
    }
}

/// How an element lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose<const D: usize> {
    pub(crate) source: u32,
    pub(crate) centre: Vector<D>,
    /// From exemplar directions to those of the page.
    pub(crate) rotation: Matrix<D>,
    pub(crate) scale: f64,
}

/// The ink of all elements.
#[derive(Clone, Debug)]
pub(crate) struct Inks<const D: usize> {
    inks: Numbered<Ink>,
    _held: Arc<Held>,
}

impl<const D: usize> Inks<D>
where
    Vector<D>: Dimension<D>,
{
    /// Prepares the first `count` elements of an exemplar for distances of up to `reach`.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(
        exemplar: &Exemplar<D>,
        library: &Library<D>,
        count: usize,
        reach: f64,
        budget: &Budget,
    ) -> Result<Self> {
        let plane = Vector::plane_exemplar(exemplar);
        let outlines: Vec<Option<Outline<2>>> = (0..count).map(|e| plane.and_then(|plane| centred(plane, e))).collect();
        let mut step = library.spacing / CELLS;
        let cells = |step: f64| -> usize {
            let each = |o: &Option<Outline<2>>| o.as_ref().map_or([0, 0], |o| distance_map::cells(o, step, reach));
            outlines.iter().map(each).fold(0, |sum: usize, [w, h]| sum.saturating_add(w.saturating_mul(h)))
        };
        while cells(step) > MOST_CELLS {
            step *= 1.5;
        }
        let held = Arc::new(budget.hold("distances around outlines", cells(step) * size_of::<f32>())?);
        let ink = |(e, outline): (usize, &Option<Outline<2>>)| {
            let radius = library.radius[e];
            let Some(outline) = outline else { return Ok(Ink { map: None, rim: Vec::new(), step, radius }) };
            let [width, height] = distance_map::cells(outline, step, reach);
            budget.spend(CELL * (width * height + outline.edges().count() * 4) as u64)?;
            let (places, apart) = rim(outline, step);
            Ok(Ink { map: Some(DistanceMap::new(outline, step, reach)), rim: pieces(places), step: apart, radius })
        };
        let inks: Vec<_> = outlines.par_iter().enumerate().map(ink).collect::<Result<_>>()?;
        Ok(Self { inks: inks.into(), _held: held })
    }
}

impl<const D: usize> Inks<D> {
    /// Number of elements.
    pub(crate) fn len(&self) -> usize {
        self.inks.len()
    }

    /// Distance from the centre of an element, as it lies, to its farthest ink.
    pub(crate) fn radius(&self, pose: &Pose<D>) -> f64 {
        self.inks[pose.source].radius * pose.scale
    }

    /// Distance of the ink of an element from a place at `offset` from its centre, negative on the ink.
    #[inline]
    pub(crate) fn distance(&self, pose: &Pose<D>, offset: Vector<D>) -> f64 {
        let ink = &self.inks[pose.source];
        match &ink.map {
            None => offset.norm() - ink.radius * pose.scale,
            Some(map) => map.at(own(pose, offset)) * pose.scale,
        }
    }

    /// An element in a pose, to be asked for many distances.
    pub(crate) fn placed(&self, pose: &Pose<D>) -> Placed<'_> {
        let (ink, scale) = (&self.inks[pose.source], pose.scale);
        let entry = |r: usize, c: usize| if D == 2 { pose.rotation.0[c][r] / scale } else { 0.0 };
        let matrix = [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]];
        Placed { map: ink.map.as_ref(), matrix, scale, radius: ink.radius * scale }
    }

    /// Distance between the inks of two elements, the second with its centre at `offset` from the first's; negative by
    /// about how deep they lie in each other. Beyond `enough`, any number larger than that.
    pub(crate) fn gap(&self, a: &Pose<D>, b: &Pose<D>, offset: Vector<D>, enough: f64) -> f64 {
        let (small, large) = (self.radius(a), self.radius(b));
        if small > large {
            return self.gap(b, a, -offset, enough);
        }
        let least = self.apart(a, b, offset, enough);
        if least > enough {
            return least;
        }
        let (from, to) = (&self.inks[a.source], &self.inks[b.source]);
        let Some(map) = &to.map else { return self.distance(a, offset) - large };
        let Some(own) = &from.map else { return self.distance(b, -offset) - small };
        let nearest = nearest_of(&from.rim, a.scale, (map, change(a, b, offset), b.scale), (f64::INFINITY, enough));
        if nearest > from.step * a.scale {
            return nearest;
        }
        // Where they meet, a tip may lie deep in the other element whose rim sees little of it.
        nearest_of(&to.rim, b.scale, (own, change(b, a, -offset), a.scale), (nearest, enough))
    }

    /// How far two elements are apart at least, as [`Inks::gap`] would have it: soon said, and no more than needed to be beyond `enough`.
    pub(crate) fn apart(&self, a: &Pose<D>, b: &Pose<D>, offset: Vector<D>, enough: f64) -> f64 {
        let radii = [self.radius(a), self.radius(b)];
        let circles = offset.norm() - radii[0] - radii[1];
        if circles > enough {
            return circles;
        }
        // The middle of one says much of how far all of it is from the other.
        let beside = |map: &DistanceMap, place, scale: f64, radius: f64| map.at_least(place) * scale - radius;
        let (one, two) = (&self.inks[a.source].map, &self.inks[b.source].map);
        let mut least = circles;
        if let Some(map) = two {
            least = least.max(beside(map, own(b, -offset), b.scale, radii[0]));
        }
        if let Some(map) = one.as_ref().filter(|_| least <= enough) {
            least = least.max(beside(map, own(a, offset), a.scale, radii[1]));
        }
        least
    }
}

/// The least of `nearest` and the distances of a rim from the ink of a map, where they are no larger than `enough`.
fn nearest_of(
    rim: &[Piece],
    scale: f64,
    (map, change, map_scale): (&DistanceMap, Change, f64),
    (mut nearest, enough): (f64, f64),
) -> f64 {
    for piece in rim {
        let radius = piece.radius * scale;
        let least = map.at(change.apply(piece.centre)) * map_scale - radius;
        if least >= nearest || least > enough {
            nearest = nearest.min(least.max(enough) + radius);
            continue;
        }
        for &place in &piece.places {
            nearest = nearest.min(map.at(change.apply(place)) * map_scale);
        }
    }
    nearest
}

/// An offset from the centre of an element of the plane in the coordinates of the element.
#[inline]
fn own<const D: usize>(pose: &Pose<D>, offset: Vector<D>) -> [f64; 2] {
    let (r, s) = (&pose.rotation.0, 1.0 / pose.scale);
    let (x, y) = (offset.0[0] * s, offset.0[1] * s);
    [r[0][0] * x + r[1][0] * y, r[0][1] * x + r[1][1] * y]
}

/// From the coordinates of `a` to those of `b`, which has its centre at `offset` from `a`'s.
fn change<const D: usize>(a: &Pose<D>, b: &Pose<D>, offset: Vector<D>) -> Change {
    let (p, q, scale) = (&a.rotation.0, &b.rotation.0, a.scale / b.scale);
    let entry = |r: usize, c: usize| (q[0][r] * p[0][c] + q[1][r] * p[1][c]) * scale;
    Change { matrix: [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]], shift: own(b, -offset) }
}

/// The outline of an element of the plane about its centre; `None` where it has none.
fn centred(plane: &Exemplar<2>, e: usize) -> Option<Outline<2>> {
    let element = plane.elements.get(e).filter(|e| e.outline.rings.iter().any(|ring| ring.len() > 2))?;
    let about = |ring: &Vec<Vector<2>>| ring.iter().map(|&p| p - element.centre).collect();
    Some(Outline { rings: element.outline.rings.iter().map(about).collect() })
}

/// Places along the rim of an outline, about `step` apart; farther apart where it is long. And how far.
fn rim(outline: &Outline<2>, step: f64) -> (Vec<Vector<2>>, f64) {
    let length: f64 = outline.edges().map(|(a, b)| (b - a).norm()).sum();
    let step = step.max(length / RIM as f64);
    let mut places = Vec::new();
    for ring in &outline.rings {
        let mut until = 0.0;
        for (a, b) in ring::edges(ring) {
            let side = (b - a).norm();
            while until < side {
                places.push(a + (b - a) * (until / side));
                until += step;
            }
            until -= side;
        }
    }
    (places, step)
}

/// Places in groups that lie close together.
fn pieces(mut places: Vec<Vector<2>>) -> Vec<Piece> {
    let mut done = Vec::new();
    let mut open = vec![(0, places.len())];
    while let Some((first, end)) = open.pop() {
        let group = &mut places[first..end];
        let bounds = Bounds::around(group.iter().copied());
        if group.len() > PIECE {
            let (size, middle) = (bounds.size(), group.len() / 2);
            let k = usize::from(size[1] > size[0]);
            group.sort_by(|a, b| a[k].total_cmp(&b[k]));
            open.extend([(first, first + middle), (first + middle, end)]);
        } else if !group.is_empty() {
            let centre = bounds.centre();
            let radius = group.iter().map(|&p| (p - centre).norm()).fold(0.0, f64::max);
            done.push(Piece { centre: centre.0, radius, places: group.iter().map(|p| p.0).collect() });
        }
    }
    done
}
