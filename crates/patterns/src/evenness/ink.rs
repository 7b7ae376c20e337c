//! The ink of the exemplar's elements, ready to be asked how far a place is from it, and how far two elements are apart.

use std::sync::Arc;

use arabesque_core::{Budget, Exemplar, Held, Matrix, Numbered, Outline, Result, Vector, ring};
use rayon::prelude::*;

use crate::{
    dimension::Dimension,
    evenness::distance_map::{self, DistanceMap},
    exemplar::library::Library,
};

/// Cells of a map of distances in a mean spacing.
const CELLS: f64 = 10.0;

/// Most cells in all maps together: of more, each is larger.
const MOST_CELLS: usize = 1 << 24;

/// Most points along the rim of one element.
const RIM: usize = 160;

/// Nanoseconds for a cell of a map, and for one and an edge.
const CELL: u64 = 60;

/// The ink of one element, about its centre, in exemplar directions and units.
#[derive(Clone, Debug)]
struct Ink<const D: usize> {
    /// Distances around it; `None` for a ball.
    map: Option<DistanceMap>,
    /// Places along its rim; the centre alone for a ball.
    rim: Vec<Vector<D>>,
    /// Distance from the centre to the farthest ink.
    radius: f64,
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
    inks: Numbered<Ink<D>>,
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
            let Some(outline) = outline else { return Ok(Ink { map: None, rim: vec![Vector::ZERO], radius }) };
            let [width, height] = distance_map::cells(outline, step, reach);
            budget.spend(CELL * (width * height + outline.edges().count() * 4) as u64)?;
            let rim = rim(outline, step).into_iter().map(lifted).collect();
            Ok(Ink { map: Some(DistanceMap::new(outline, step, reach)), rim, radius })
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
            Some(map) => map.at(flat(pose.rotation.transpose().apply(offset) * (1.0 / pose.scale))) * pose.scale,
        }
    }

    /// Distance between the inks of two elements, the second with its centre at `offset` from the first's; negative by
    /// about how deep they lie in each other. Beyond `enough`, any number larger than that.
    pub(crate) fn gap(&self, a: &Pose<D>, b: &Pose<D>, offset: Vector<D>, enough: f64) -> f64 {
        let apart = offset.norm() - self.radius(a) - self.radius(b);
        if apart > enough {
            return apart;
        }
        let way = |from: &Pose<D>, to: &Pose<D>, shift: Vector<D>| {
            let ink = &self.inks[from.source];
            let thick = if ink.map.is_none() { ink.radius * from.scale } else { 0.0 };
            let places = ink.rim.iter().map(|&p| from.rotation.apply(p) * from.scale + shift);
            places.map(|p| self.distance(to, p)).fold(f64::INFINITY, f64::min) - thick
        };
        way(a, b, -offset).min(way(b, a, offset))
    }
}

/// The outline of an element of the plane about its centre; `None` where it has none.
fn centred(plane: &Exemplar<2>, e: usize) -> Option<Outline<2>> {
    let element = plane.elements.get(e).filter(|e| e.outline.rings.iter().any(|ring| ring.len() > 2))?;
    let about = |ring: &Vec<Vector<2>>| ring.iter().map(|&p| p - element.centre).collect();
    Some(Outline { rings: element.outline.rings.iter().map(about).collect() })
}

/// Places along the rim of an outline, about `step` apart; farther apart where it is long.
fn rim(outline: &Outline<2>, step: f64) -> Vec<Vector<2>> {
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
    places
}

fn flat<const D: usize>(v: Vector<D>) -> Vector<2> {
    Vector::xy(v[0], v[1])
}

fn lifted<const D: usize>(v: Vector<2>) -> Vector<D> {
    Vector(std::array::from_fn(|k| if k < 2 { v[k] } else { 0.0 }))
}
