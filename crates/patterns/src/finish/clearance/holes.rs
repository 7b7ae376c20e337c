//! Holes that mending would leave: what was taken out or moved away goes back where nothing else has taken its place and
//! the exemplar has no hole so wide.

use arabesque_core::{Budget, Domain, Meter, Result, Similarity, Vector};

use crate::finish::clearance::{
    arrangement::{Arrangement, PlacedFigure},
    limits::ExemplarClearance,
    repair::Repair,
};

/// How much wider than in the exemplar a hole is before it is one, in mean spacings.
const WIDER: f64 = 0.06;

/// How far from any ink places are told apart, in mean spacings.
const FARTHEST: f64 = 2.0;

/// Places in the exemplar at which its holes are measured: so many to a mean spacing, and at most so many a side.
const PLACES: (f64, usize) = (3.0, 48);

/// An element that lies with more than this share of itself on others goes without leaving a hole.
const COVERED: f64 = 0.5;

/// Corners of an outline at which the place of an element is looked at.
const CORNERS: usize = 8;

impl ExemplarClearance {
    /// How far the widest hole of the exemplar reaches from any ink.
    fn widest_hole(&self, budget: &Budget) -> Result<f64> {
        let domain = Domain::Box(self.window);
        let bodies = (0..self.figures.len()).map(|i| self.body(i, Similarity::identity())).collect();
        let arrangement = Arrangement::new(&domain, budget.clone(), &self.figures, Vec::new(), bodies);
        let size = self.window.size();
        // Beyond the frame nothing is known: what is near it may be near ink outside.
        let margin = Vector::xy((0.5 * self.spacing).min(0.25 * size[0]), (0.5 * self.spacing).min(0.25 * size[1]));
        let count = |k: usize| ((PLACES.0 * size[k] / self.spacing) as usize).clamp(4, PLACES.1);
        let mut meter = budget.meter();
        let mut widest = 0.0_f64;
        for (x, y) in (0..count(1)).flat_map(|y| (0..count(0)).map(move |x| (x, y))) {
            let share = Vector::xy((x as f64 + 0.5) / count(0) as f64, (y as f64 + 0.5) / count(1) as f64);
            let p = self.window.min + margin + share.zip(size - margin * 2.0, |s, l| s * l);
            widest = widest.max(arrangement.distance_to_ink(p, FARTHEST * self.spacing, 0.0, &|_| true, &mut meter)?);
        }
        Ok(widest)
    }
}

impl Repair<'_> {
    /// Puts back what left a hole, as it was in `before`. Returns how many were put back.
    pub(crate) fn fill_holes(&mut self, before: &[PlacedFigure]) -> Result<usize> {
        let changed: Vec<usize> = (0..before.len()).filter(|&i| self.is_changed(i, &before[i])).collect();
        if changed.is_empty() {
            return Ok(0);
        }
        let budget = self.arrangement.budget.clone();
        let widest = self.limits.widest_hole(&budget)? + WIDER * self.limits.spacing;
        let mut meter = budget.meter();
        let mut restored = 0;
        for i in changed {
            if self.leaves_hole(&before[i], widest, &mut meter)? && self.may_return(i, &before[i], &mut meter)? {
                self.alive[i] = true;
                self.arrangement.bodies[i] = before[i].clone();
                restored += 1;
            }
        }
        Ok(restored)
    }

    fn is_changed(&self, i: usize, before: &PlacedFigure) -> bool {
        let now = &self.arrangement.bodies[i];
        !before.fixed && (!self.alive[i] || now.centre != before.centre || now.figure != before.figure)
    }

    /// Whether a place that was covered by a body is farther from any ink than `widest`, times its scale.
    fn leaves_hole(&self, before: &PlacedFigure, widest: f64, meter: &mut Meter<'_>) -> Result<bool> {
        let figure = self.arrangement.figure(before.figure);
        let step = (figure.outline().points().count() / CORNERS).max(1);
        let inner = figure.outline().points().step_by(step).map(|p| figure.centre + (p - figure.centre) * 0.5);
        let places: Vec<Vector<2>> =
            std::iter::once(figure.centre).chain(inner).filter(|p| figure.covers(*p)).collect();
        let reach = FARTHEST * self.limits.spacing * before.place.scale;
        for p in places {
            let p = before.place.apply(p);
            let counts = |j: usize| self.alive[j];
            if self.arrangement.distance_to_ink(p, reach, self.slack, &counts, meter)? > widest * before.place.scale {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Whether a body may be where it was: it keeps the rule of the border, lies neither on itself nor on what is in the
    /// way, and not for the most part on others.
    fn may_return(&self, i: usize, before: &PlacedFigure, meter: &mut Meter<'_>) -> Result<bool> {
        if !self.admits(before, meter)? || self.arrangement.overlap_area(before, before, true, meter)? > 0.0 {
            return Ok(false);
        }
        let mut covered = 0.0;
        for j in self.arrangement.neighbours(i, self.slack, meter)?.into_iter().filter(|&j| self.alive[j]) {
            let other = &self.arrangement.bodies[j];
            let area = self.arrangement.overlap_area(before, other, false, meter)?;
            let excess = (area - self.limits.allowed_area(before, other)).max(0.0);
            if other.fixed && excess > 0.0 {
                return Ok(false);
            }
            covered += excess;
        }
        Ok(covered <= COVERED * before.area)
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Bounds, Class, Element, Exemplar, Outline, Placement, Request, Role};

    use crate::finish::clearance::{measure, repair, summary::Summary};

    use super::*;

    fn exemplar(places: impl Iterator<Item = (f64, f64)>, corners: &[(f64, f64)]) -> Exemplar<2> {
        let element = |(x, y): (f64, f64)| {
            let centre = Vector::xy(x, y);
            let ring = corners.iter().map(|&(u, v)| centre + Vector::xy(u, v)).collect();
            Element {
                class: 0,
                centre,
                pose: Similarity::identity(),
                outline: Outline { rings: vec![ring] },
                colour: [0.0; 3],
                lean: [Vector::ZERO; 3],
                role: Role::Source,
            }
        };
        let window = Bounds::new(Vector::ZERO, Vector::splat(20.0));
        Exemplar::new("t", places.map(element).collect(), vec![Class { name: "a".into() }], window).unwrap()
    }

    const SQUARE: [(f64, f64); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];

    fn grid(columns: u32, rows: u32) -> impl Iterator<Item = (f64, f64)> {
        (0..rows).flat_map(move |y| (0..columns).map(move |x| (f64::from(2 * x) + 1.0, f64::from(2 * y) + 1.0)))
    }

    fn is_black((x, y): (f64, f64)) -> bool {
        ((x + y) / 2.0).round() % 2.0 == 0.0
    }

    /// What becomes of copies of the first element at some places.
    fn mended(e: &Exemplar<2>, places: impl Iterator<Item = (f64, f64)>) -> (usize, Summary) {
        let put = |(x, y): (f64, f64)| Placement {
            source: 0,
            transform: Similarity::shift(Vector::xy(x, y) - e.elements[0].centre),
            control: Vec::new(),
            frozen: None,
        };
        let mut placements: Vec<Placement<2>> = places.map(put).collect();
        let clearance = measure(e, &Budget::default()).unwrap();
        let request = Request::new(Domain::Box(Bounds::new(Vector::ZERO, Vector::splat(40.0))));
        let summary = repair(clearance.as_ref(), &request, &mut placements, &Budget::default()).unwrap();
        (placements.len(), summary)
    }

    #[test]
    fn what_touches_in_the_exemplar_may_touch() {
        let shaken = |(x, y): (f64, f64)| (x + 0.01 * (7.0 * x + y).sin(), y + 0.01 * (3.0 * y + x).cos());
        let tiles = exemplar(grid(10, 10), &SQUARE);
        assert_eq!(mended(&tiles, grid(20, 20).map(shaken)), (400, Summary::default()));
        let chess = exemplar(grid(10, 10).filter(|&p| is_black(p)), &SQUARE);
        assert_eq!(mended(&chess, grid(20, 20).filter(|&p| is_black(p)).map(shaken)), (200, Summary::default()));
    }

    #[test]
    fn rows_that_overlap_as_in_the_exemplar_stay_whole() {
        let half: Vec<(f64, f64)> = (0..=12).map(|k| (f64::from(k) / 12.0 * std::f64::consts::PI).sin_cos()).collect();
        let half: Vec<_> = half.iter().map(|&(s, c)| (1.2 * c, 1.2 * s)).collect();
        let rows =
            |n: u32| grid(n, n).map(|(x, y)| (x + if ((y / 2.0) as u32).is_multiple_of(2) { 0.0 } else { 1.0 }, y));
        let scales = exemplar(rows(10), &half);
        let shaken = |(x, y): (f64, f64)| (x + 0.01 * (7.0 * x + y).sin(), y + 0.01 * (3.0 * y + x).cos());
        assert_eq!(mended(&scales, rows(19).map(shaken)).0, 361);
    }

    #[test]
    fn nothing_goes_where_it_would_leave_a_hole() {
        let tiles = exemplar(grid(10, 10), &SQUARE);
        // A tile that is wider than its place by a fifth cannot be pushed anywhere.
        let slipped = |(k, (x, y)): (usize, (f64, f64))| if k == 210 { (x + 0.4, y) } else { (x, y) };
        let (left, summary) = mended(&tiles, grid(20, 20).enumerate().map(slipped));
        assert_eq!((left, summary.removed), (400, 0), "{summary:?}");
        // A second tile in the same place leaves none.
        assert_eq!(mended(&tiles, grid(20, 20).chain([(21.0, 21.0)])).0, 400);
    }
}
