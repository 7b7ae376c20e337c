//! Figures at places, and the question which of them overlap.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Domain, GridIndex, Meter, Outline, Result, Similarity, Vector};
use rayon::prelude::*;

use crate::finish::clearance::figure::Figure;

/// Nanoseconds for two bodies that are near each other.
const NEAR: u64 = 20;

/// A figure at its place.
#[derive(Clone, Debug)]
pub(crate) struct PlacedFigure {
    /// Index of the figure.
    pub(crate) figure: usize,
    /// Class of the element; `None` for an obstacle.
    pub(crate) class: Option<usize>,
    /// From figure coordinates to the arrangement.
    pub(crate) place: Similarity<2>,
    /// Centre in the arrangement.
    pub(crate) centre: Vector<2>,
    /// Distance from the centre to the farthest ink.
    pub(crate) radius: f64,
    /// Area of the ink.
    pub(crate) area: f64,
    /// Whether it must stay as it is.
    pub(crate) fixed: bool,
}

impl PlacedFigure {
    pub(crate) fn new(index: usize, figure: &Figure, place: Similarity<2>) -> Self {
        Self {
            figure: index,
            class: None,
            place,
            centre: place.apply(figure.centre),
            radius: figure.radius * place.scale,
            area: figure.area * place.scale * place.scale,
            fixed: false,
        }
    }

    /// The body shifted so that its centre is at `centre`.
    pub(crate) fn moved_to(&self, centre: Vector<2>) -> Self {
        let place = Similarity { translation: self.place.translation + (centre - self.centre), ..self.place };
        Self { place, centre, ..self.clone() }
    }
}

/// Two bodies that share area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Overlap {
    /// The lower index.
    pub(crate) a: usize,
    /// The higher index; equal to `a` for an element that reaches around a torus into itself.
    pub(crate) b: usize,
    /// Common area.
    pub(crate) area: f64,
}

/// Bodies of similar size.
#[derive(Clone, Debug)]
struct Layer {
    members: Vec<usize>,
    largest: f64,
    grid: GridIndex<2>,
}

/// Bodies in a domain, indexed by the place they had at the start.
#[derive(Clone, Debug)]
pub(crate) struct Arrangement<'a> {
    domain: &'a Domain<2>,
    pub(crate) budget: Budget,
    shared: &'a [Figure],
    own: Vec<Figure>,
    pub(crate) bodies: Vec<PlacedFigure>,
    layers: Vec<Layer>,
    layer_of: Vec<usize>,
    /// Centre of each body in the index.
    origin: Vec<Vector<2>>,
}

impl<'a> Arrangement<'a> {
    /// `shared` figures have the indices from 0, `own` ones follow. What is asked draws on the budget.
    pub(crate) fn new(
        domain: &'a Domain<2>,
        budget: Budget,
        shared: &'a [Figure],
        own: Vec<Figure>,
        bodies: Vec<PlacedFigure>,
    ) -> Self {
        let origin = bodies.iter().map(|b| b.centre).collect();
        let mut arrangement =
            Self { domain, budget, shared, own, layer_of: vec![0; bodies.len()], bodies, layers: Vec::new(), origin };
        arrangement.build_layers();
        arrangement
    }

    /// Sorts the bodies by size, a power of two per layer: a query for small bodies then never widens for the sake of
    /// large ones.
    fn build_layers(&mut self) {
        let mut by_size = BTreeMap::<i32, Vec<usize>>::new();
        for (i, body) in self.bodies.iter().enumerate().filter(|(_, body)| body.radius > 0.0) {
            by_size.entry(body.radius.log2().floor() as i32).or_default().push(i);
        }
        for members in by_size.into_values() {
            let points: Vec<_> = members.iter().map(|&i| self.origin[i]).collect();
            let largest = members.iter().map(|&i| self.bodies[i].radius).fold(0.0, f64::max);
            members.iter().for_each(|&i| self.layer_of[i] = self.layers.len());
            self.layers.push(Layer { grid: GridIndex::new(&points, 2.0 * largest, self.domain), members, largest });
        }
    }

    pub(crate) fn domain(&self) -> &'a Domain<2> {
        self.domain
    }

    /// Figure by index.
    pub(crate) fn figure(&self, index: usize) -> &Figure {
        self.shared.get(index).unwrap_or_else(|| &self.own[index - self.shared.len()])
    }

    /// Where body `i` was when the arrangement was made.
    pub(crate) fn origin(&self, i: usize) -> Vector<2> {
        self.origin[i]
    }

    /// Calls `visit(j)` for every body of some layers that started within `reach` and its own layer's largest radius of
    /// the start of body `i`.
    fn near(&self, i: usize, reach: f64, layers: std::ops::Range<usize>, meter: &mut Meter<'_>) -> Result<Vec<usize>> {
        let mut found = Vec::new();
        for layer in &self.layers[layers] {
            let visit = |slot: usize, _| found.push(layer.members[slot]);
            meter.spend(NEAR * layer.grid.within(self.origin[i], reach + layer.largest, visit))?;
        }
        Ok(found)
    }

    /// Bodies that could meet body `i`, itself left out, when none has moved by more than `slack`; ascending.
    pub(crate) fn neighbours(&self, i: usize, slack: f64, meter: &mut Meter<'_>) -> Result<Vec<usize>> {
        let mut found = self.near(i, self.bodies[i].radius + 2.0 * slack, 0..self.layers.len(), meter)?;
        found.retain(|&j| j != i);
        found.sort_unstable();
        Ok(found)
    }

    /// Every overlap among bodies that have not moved since the arrangement was made, ordered by `a`, then `b`.
    pub(crate) fn overlaps(&self) -> Result<Vec<Overlap>> {
        let of = |i: usize| self.overlaps_of(i, &mut self.budget.meter());
        let all: Vec<Vec<Overlap>> = (0..self.bodies.len()).into_par_iter().map(of).collect::<Result<_>>()?;
        self.budget.spend(0)?;
        let mut all = all.concat();
        all.sort_by_key(|o| (o.a, o.b));
        Ok(all)
    }

    /// Overlaps of body `i` with bodies of its size and an index not lower, and with larger ones.
    fn overlaps_of(&self, i: usize, meter: &mut Meter<'_>) -> Result<Vec<Overlap>> {
        let mut found = Vec::new();
        if self.bodies[i].radius <= 0.0 {
            return Ok(found);
        }
        let layer = self.layer_of[i];
        for j in self.near(i, self.bodies[i].radius, layer..self.layers.len(), meter)? {
            if self.layer_of[j] > layer || j >= i {
                let area = self.overlap_area(&self.bodies[i], &self.bodies[j], i == j, meter)?;
                if area > 0.0 {
                    found.push(Overlap { a: i.min(j), b: i.max(j), area });
                }
            }
        }
        Ok(found)
    }

    /// Common area of two bodies, all images on a torus together; `itself` leaves out the body's own place.
    pub(crate) fn overlap_area(
        &self,
        a: &PlacedFigure,
        b: &PlacedFigure,
        itself: bool,
        meter: &mut Meter<'_>,
    ) -> Result<f64> {
        let mut sum = 0.0;
        for offset in self.images(a, b).filter(|o| !itself || o.norm2() > 0.0) {
            sum += self.overlap_at(a, b, offset, meter)?.map_or(0.0, |common| common.area());
        }
        // An image to the left and one to the right are the same meeting of a body with itself.
        Ok(if itself { 0.5 * sum } else { sum })
    }

    /// Smallest distance between the inks of two bodies of an arrangement that is not a torus, at most `reach`.
    pub(crate) fn gap(&self, i: usize, j: usize, reach: f64, meter: &mut Meter<'_>) -> Result<f64> {
        let (a, b) = (&self.bodies[i], &self.bodies[j]);
        let place = a.place.inverse().after(&b.place);
        Ok(self.figure(a.figure).gap(self.figure(b.figure), &place, reach / a.place.scale, meter)? * a.place.scale)
    }

    /// Distance of `p` from the nearest ink of the bodies that `counts` lets through, none of which has moved by more than
    /// `slack`; at most `reach`.
    pub(crate) fn distance_to_ink(
        &self,
        p: Vector<2>,
        reach: f64,
        slack: f64,
        counts: &dyn Fn(usize) -> bool,
        meter: &mut Meter<'_>,
    ) -> Result<f64> {
        let mut near = Vec::new();
        for layer in &self.layers {
            let visit = |slot: usize, _| near.push(layer.members[slot]);
            meter.spend(NEAR * layer.grid.within(p, reach + layer.largest + slack, visit))?;
        }
        let mut nearest = reach;
        for body in near.into_iter().filter(|&j| counts(j)).map(|j| &self.bodies[j]) {
            let offset = self.domain.offset(p, body.centre);
            if offset.norm() - body.radius >= nearest {
                continue;
            }
            let figure = self.figure(body.figure);
            meter.spend(NEAR * figure.complexity() as u64)?;
            let own = body.place.inverse().apply(body.centre - offset);
            nearest = nearest.min(figure.distance(own) * body.place.scale);
        }
        Ok(nearest)
    }

    /// Whether two bodies share area, however little, or touch so closely that they may.
    pub(crate) fn meet(&self, a: &PlacedFigure, b: &PlacedFigure, meter: &mut Meter<'_>) -> Result<bool> {
        for offset in self.images(a, b) {
            let (first, second, place) = self.arranged(a, b, offset);
            let meets = match first.meets(second, &place, meter)? {
                Some(meets) => meets,
                None => self.overlap_at(a, b, offset, meter)?.is_some(),
            };
            if meets {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Common part of two bodies in arrangement coordinates around `a`, with the offset from `a` to `b`: the largest
    /// over all images.
    pub(crate) fn overlap_region(
        &self,
        a: &PlacedFigure,
        b: &PlacedFigure,
        meter: &mut Meter<'_>,
    ) -> Result<Option<(Outline<2>, Vector<2>)>> {
        let mut largest: Option<(Outline<2>, Vector<2>)> = None;
        for offset in self.images(a, b) {
            let Some(common) = self.overlap_at(a, b, offset, meter)? else { continue };
            if largest.as_ref().is_none_or(|(known, _)| common.area() >= known.area()) {
                largest = Some((common, offset));
            }
        }
        Ok(largest)
    }

    fn overlap_at(
        &self,
        a: &PlacedFigure,
        b: &PlacedFigure,
        offset: Vector<2>,
        meter: &mut Meter<'_>,
    ) -> Result<Option<Outline<2>>> {
        let (first, second, place) = self.arranged(a, b, offset);
        let Some(common) = first.overlap(second, &place, &self.budget, meter)? else { return Ok(None) };
        let back = if std::ptr::eq(first, self.figure(a.figure)) { a.place } else { shifted(b, a.centre + offset) };
        Ok(Some(common.transformed(&back)))
    }

    /// The figure with more edges, the other one, and how that lies in the coordinates of the first; `b` has its centre
    /// `offset` from `a`'s.
    fn arranged(&self, a: &PlacedFigure, b: &PlacedFigure, offset: Vector<2>) -> (&Figure, &Figure, Similarity<2>) {
        let (fa, fb) = (self.figure(a.figure), self.figure(b.figure));
        let b_place = shifted(b, a.centre + offset);
        if fa.complexity() >= fb.complexity() {
            (fa, fb, a.place.inverse().after(&b_place))
        } else {
            (fb, fa, b_place.inverse().after(&a.place))
        }
    }

    /// Offsets from `a` to `b` at which their circles meet: one in the plane, up to nine on a torus.
    fn images(&self, a: &PlacedFigure, b: &PlacedFigure) -> impl Iterator<Item = Vector<2>> + use<> {
        let shortest = self.domain.offset(a.centre, b.centre);
        let period = self.domain.period();
        let reach = a.radius + b.radius;
        let image = move |k: i32| match period {
            Some(l) => Some(shortest + Vector::xy(f64::from(k % 3 - 1) * l[0], f64::from(k / 3 - 1) * l[1])),
            None => (k == 4).then_some(shortest),
        };
        (0..9).filter_map(image).filter(move |offset| offset.norm2() < reach * reach)
    }
}

/// The placement of `body` with its centre at `centre`.
fn shifted(body: &PlacedFigure, centre: Vector<2>) -> Similarity<2> {
    Similarity { translation: body.place.translation + (centre - body.centre), ..body.place }
}
