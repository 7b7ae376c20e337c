//! One outline, prepared for the question whether it meets another.

use arabesque_core::{Bounds, Budget, Meter, Outline, Result, Similarity, Vector, segment};

use crate::finish::clearance::edges::{Edge, EdgeBands};

/// Coordinates closer than this share of the figures' extent may touch or cross; only the area of the overlap decides.
const CONTACT: f64 = 1e-11;

/// Nanoseconds for a corner that is moved or sorted, and for two edges that are compared.
const PRICE: (u64, u64) = (10, 5);

/// The same for a corner of two outlines whose common part is found.
const OVERLAY: u64 = 300;

/// Of outlines with more pairs of edges than this, crossings are counted before their common part is found: if they cross all over, it
/// has as many corners as there are pairs.
const MANY_PAIRS: usize = 1 << 20;

/// The ink of an element with what is looked up about it.
#[derive(Clone, Debug)]
pub(crate) struct Figure {
    outline: Outline<2>,
    edges: EdgeBands,
    hull: Vec<Vector<2>>,
    bounds: Bounds<2>,
    /// Centre of the element; the radius is measured from it.
    pub(crate) centre: Vector<2>,
    /// Distance from the centre to the farthest ink.
    pub(crate) radius: f64,
    /// Area of the ink.
    pub(crate) area: f64,
}

/// How the inks of two figures meet, before any area is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Meeting {
    /// They share nothing.
    Apart,
    /// They come so close that only the area can tell.
    Touching,
    /// They share area.
    Overlapping,
}

impl Figure {
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(outline: Outline<2>, centre: Vector<2>, budget: &Budget) -> Result<Self> {
        let corners: usize = outline.rings.iter().map(Vec::len).sum();
        budget.spend(30 * PRICE.0 * corners as u64)?;
        let radius = outline.radius(centre);
        let (edges, hull) = (EdgeBands::new(&outline, budget)?, convex_hull(outline.points()));
        Ok(Self { edges, hull, bounds: outline.bounds(), area: outline.area(), centre, radius, outline })
    }

    /// Whether there is no ink at all: a point.
    pub(crate) fn is_empty(&self) -> bool {
        self.outline.rings.is_empty()
    }

    /// The ink.
    pub(crate) fn outline(&self) -> &Outline<2> {
        &self.outline
    }

    /// Whether there is ink at `p`.
    pub(crate) fn covers(&self, p: Vector<2>) -> bool {
        self.edges.covers(p)
    }

    /// Distance of `p` from the ink: 0 on it.
    pub(crate) fn distance(&self, p: Vector<2>) -> f64 {
        if self.covers(p) {
            return 0.0;
        }
        self.outline.edges().map(|edge| segment::distance(edge, p)).fold(f64::INFINITY, f64::min)
    }

    /// The edges after `place`.
    pub(crate) fn placed_edges(&self, place: &Similarity<2>) -> impl Iterator<Item = Edge> {
        self.outline.rings.iter().flat_map(move |ring| {
            let last = ring.last().map(|&p| place.apply(p));
            ring.iter().scan(last, move |before, &p| {
                let p = place.apply(p);
                before.replace(p).map(|a| (a, p))
            })
        })
    }

    /// Smallest box around the figure after `place`.
    pub(crate) fn placed_bounds(&self, place: &Similarity<2>) -> Bounds<2> {
        Bounds::around(self.hull.iter().map(|&p| place.apply(p)))
    }

    /// How much work the outline makes: the larger of two figures should be asked about the other.
    pub(crate) fn complexity(&self) -> usize {
        self.edges.len()
    }

    /// Whether the two inks certainly share area, where `place` carries the other figure into this one's coordinates.
    /// `None` when they only come so close that their common area must decide.
    pub(crate) fn meets(&self, other: &Self, place: &Similarity<2>, meter: &mut Meter<'_>) -> Result<Option<bool>> {
        Ok(match self.meeting(other, place, meter)? {
            Meeting::Apart => Some(false),
            Meeting::Touching => None,
            Meeting::Overlapping => Some(true),
        })
    }

    /// The common part of the two inks, in this figure's coordinates; `None` when it has no area.
    pub(crate) fn overlap(
        &self,
        other: &Self,
        place: &Similarity<2>,
        budget: &Budget,
        meter: &mut Meter<'_>,
    ) -> Result<Option<Outline<2>>> {
        if self.meeting(other, place, meter)? == Meeting::Apart {
            return Ok(None);
        }
        let (mine, others) = (self.corners(), other.corners());
        meter.spend(OVERLAY * (mine + others) as u64)?;
        let moved = other.outline.transformed(place);
        let common = match mine.saturating_mul(others) > MANY_PAIRS {
            true => self.outline.try_intersection(&moved, budget)?,
            false => self.outline.intersection(&moved),
        };
        Ok((!common.rings.is_empty()).then_some(common))
    }

    fn corners(&self) -> usize {
        self.outline.rings.iter().map(Vec::len).sum()
    }

    /// Smallest distance between two inks that do not overlap, at most `reach`.
    pub(crate) fn gap(&self, other: &Self, place: &Similarity<2>, reach: f64, meter: &mut Meter<'_>) -> Result<f64> {
        meter.spend(PRICE.0 * other.corners() as u64)?;
        let near = self.bounds.grown(reach);
        let mut least = reach * reach;
        for edge in other.placed_edges(place).filter(|edge| touches(&near, edge)) {
            let (low, high) = (edge.0[1].min(edge.1[1]) - reach, edge.0[1].max(edge.1[1]) + reach);
            let mine = self.edges.between(low, high);
            meter.spend(PRICE.1 * mine.len() as u64)?;
            let beside = Bounds::around([edge.0, edge.1]).grown(reach);
            // Where two edges do not cross, an end of one of them is nearest to the other.
            for &mine in mine.iter().filter(|mine| touches(&beside, mine)) {
                let ends = [(edge, mine.0), (edge, mine.1), (mine, edge.0), (mine, edge.1)];
                least = ends.iter().map(|&(e, p)| (segment::nearest(e, p) - p).norm2()).fold(least, f64::min);
            }
        }
        Ok(least.sqrt())
    }

    fn meeting(&self, other: &Self, place: &Similarity<2>, meter: &mut Meter<'_>) -> Result<Meeting> {
        meter.spend(PRICE.0 * (self.hull.len() + other.hull.len()) as u64)?;
        let hull: Vec<_> = other.hull.iter().map(|&p| place.apply(p)).collect();
        let bounds = Bounds::around(hull.iter().copied());
        if !self.bounds.intersects(&bounds) || separated(&self.hull, &hull, place.apply(other.centre) - self.centre) {
            return Ok(Meeting::Apart);
        }
        let eps = CONTACT * (self.bounds.size().norm2() + bounds.size().norm2());
        let mut meeting = Meeting::Apart;
        meter.spend(PRICE.0 * other.corners() as u64)?;
        for edge in other.placed_edges(place).filter(|edge| touches(&self.bounds, edge)) {
            let near = self.edges.between(edge.0[1].min(edge.1[1]), edge.0[1].max(edge.1[1]));
            meter.spend(PRICE.1 * near.len() as u64)?;
            for mine in near {
                match crossing(edge, *mine, eps) {
                    Meeting::Overlapping => return Ok(Meeting::Overlapping),
                    Meeting::Touching => meeting = Meeting::Touching,
                    Meeting::Apart => {}
                }
            }
        }
        if meeting == Meeting::Apart && self.contains_or_is_contained(other, place) {
            return Ok(Meeting::Overlapping);
        }
        Ok(meeting)
    }

    /// Whether one figure holds a ring of the other; settles everything where no edges meet.
    fn contains_or_is_contained(&self, other: &Self, place: &Similarity<2>) -> bool {
        let starts = |figure: &Self| figure.outline.rings.iter().filter_map(|ring| ring.first().copied()).collect();
        let (mine, others): (Vec<_>, Vec<_>) = (starts(self), starts(other));
        let back = place.inverse();
        others.iter().any(|&p| self.edges.covers(place.apply(p)))
            || mine.iter().any(|&p| other.edges.covers(back.apply(p)))
    }
}

/// Whether the projections on `axis` do not overlap.
fn separated(a: &[Vector<2>], b: &[Vector<2>], axis: Vector<2>) -> bool {
    let (low_a, high_a) = extent(a, axis);
    let (low_b, high_b) = extent(b, axis);
    high_a < low_b || high_b < low_a
}

/// Smallest and largest coordinate along `axis`, in multiples of its length.
pub(crate) fn extent(points: &[Vector<2>], axis: Vector<2>) -> (f64, f64) {
    points.iter().map(|p| p.dot(axis)).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
}

fn touches(window: &Bounds<2>, (a, b): &Edge) -> bool {
    (0..2).all(|k| a[k].min(b[k]) <= window.max[k] && a[k].max(b[k]) >= window.min[k])
}

/// How two edges meet; cross products below `eps` count as contact.
fn crossing((a, b): Edge, (c, d): Edge, eps: f64) -> Meeting {
    let boxes_apart = (0..2).any(|k| a[k].min(b[k]) > c[k].max(d[k]) || a[k].max(b[k]) < c[k].min(d[k]));
    if boxes_apart {
        return Meeting::Apart;
    }
    let sides = |from: Vector<2>, to: Vector<2>, p: Vector<2>, q: Vector<2>| {
        let along = to - from;
        (along.cross(p - from), along.cross(q - from))
    };
    let same_side = |(s, t): (f64, f64)| (s > eps && t > eps) || (s < -eps && t < -eps);
    let (ab, cd) = (sides(a, b, c, d), sides(c, d, a, b));
    if same_side(ab) || same_side(cd) {
        return Meeting::Apart;
    }
    let clear = |(s, t): (f64, f64)| s.abs() > eps && t.abs() > eps;
    if clear(ab) && clear(cd) { Meeting::Overlapping } else { Meeting::Touching }
}

/// Corners of the convex hull, by the monotone chain of their order from left to right.
fn convex_hull(points: impl Iterator<Item = Vector<2>>) -> Vec<Vector<2>> {
    let mut sorted: Vec<_> = points.collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let mut hull = half_hull(sorted.iter().copied());
    hull.extend(half_hull(sorted.iter().rev().copied()));
    hull
}

/// One side of the hull, from the first point up to but not including the last.
fn half_hull(points: impl Iterator<Item = Vector<2>>) -> Vec<Vector<2>> {
    let mut chain: Vec<Vector<2>> = Vec::new();
    for p in points {
        while let [.., a, b] = chain[..]
            && (b - a).cross(p - b) <= 0.0
        {
            chain.pop();
        }
        chain.push(p);
    }
    chain.pop();
    chain
}

#[cfg(test)]
mod tests {
    use super::*;
    use arabesque_core::{FillRule, Matrix};

    fn meets(a: &Figure, b: &Figure, place: &Similarity<2>) -> Option<bool> {
        a.meets(b, place, &mut Budget::default().meter()).unwrap()
    }

    fn square(x: f64, y: f64, side: f64) -> Vec<Vector<2>> {
        vec![Vector::xy(x, y), Vector::xy(x + side, y), Vector::xy(x + side, y + side), Vector::xy(x, y + side)]
    }

    fn figure(rings: &[Vec<Vector<2>>]) -> Figure {
        let outline = Outline::union(rings, FillRule::EvenOdd);
        let centre = outline.centroid().unwrap();
        Figure::new(outline, centre, &Budget::default()).unwrap()
    }

    fn area(a: &Figure, b: &Figure, shift: Vector<2>) -> f64 {
        let budget = Budget::default();
        let common = a.overlap(b, &Similarity::shift(shift), &budget, &mut budget.meter()).unwrap();
        common.map_or(0.0, |common| common.area())
    }

    #[test]
    fn crossing_squares_overlap_and_distant_ones_do_not() {
        let s = figure(&[square(0.0, 0.0, 2.0)]);
        assert!((area(&s, &s, Vector::xy(1.5, 1.0)) - 0.5).abs() < 1e-6);
        assert_eq!(meets(&s, &s, &Similarity::shift(Vector::xy(1.5, 1.0))), Some(true));
        assert_eq!(meets(&s, &s, &Similarity::shift(Vector::xy(3.0, 1.0))), Some(false));
    }

    #[test]
    fn squares_side_by_side_touch_without_area() {
        let s = figure(&[square(0.0, 0.0, 2.0)]);
        let place = Similarity::shift(Vector::xy(2.0, 0.0));
        assert_eq!(meets(&s, &s, &place), None);
        assert!(area(&s, &s, place.translation) < 1e-6);
    }

    #[test]
    fn aligned_squares_overlap_although_no_edges_cross() {
        let s = figure(&[square(0.0, 0.0, 2.0)]);
        assert!((area(&s, &s, Vector::xy(1.0, 0.0)) - 2.0).abs() < 1e-6);
        assert!((area(&s, &s, Vector::ZERO) - 4.0).abs() < 1e-6);
    }

    #[test]
    fn a_dot_in_a_leaf_overlaps_and_a_dot_in_a_hole_does_not() {
        let leaf = figure(&[square(0.0, 0.0, 10.0)]);
        let ring = figure(&[square(0.0, 0.0, 10.0), square(2.0, 2.0, 6.0)]);
        let dot = figure(&[square(4.0, 4.0, 1.0)]);
        assert!((area(&leaf, &dot, Vector::ZERO) - 1.0).abs() < 1e-6);
        assert!((area(&dot, &leaf, Vector::ZERO) - 1.0).abs() < 1e-6);
        assert_eq!(meets(&ring, &dot, &Similarity::identity()), Some(false));
        assert_eq!(meets(&dot, &ring, &Similarity::identity()), Some(false));
    }

    #[test]
    fn gap_between_squares() {
        let s = figure(&[square(0.0, 0.0, 2.0)]);
        let gap = |reach: f64| {
            s.gap(&s, &Similarity::shift(Vector::xy(5.0, 6.0)), reach, &mut Budget::default().meter()).unwrap()
        };
        assert!((gap(9.0) - 5.0).abs() < 1e-9);
        assert_eq!(gap(4.0), 4.0, "no nearer than that");
    }

    #[test]
    fn the_gap_between_outlines_is_that_of_their_nearest_corners_and_edges() {
        let wavy = |n: u32| -> Vec<Vector<2>> {
            let at = |k: u32| {
                let turn = f64::from(k) / f64::from(n) * std::f64::consts::TAU;
                Vector::xy(turn.cos(), turn.sin()) * (5.0 + (3.0 * turn).sin() + 0.3 * (17.0 * turn).cos())
            };
            (0..n).map(at).collect()
        };
        let (a, b) = (figure(&[wavy(300)]), figure(&[wavy(170)]));
        for k in 0..20 {
            let turn = 0.3 * f64::from(k);
            let place =
                Similarity::about(Vector::ZERO, Vector::xy(turn.cos(), turn.sin()) * 13.5, Matrix::rotation(turn), 1.0);
            let moved = b.outline.transformed(&place);
            let one_way = |points: &Outline<2>, edges: &Outline<2>| {
                let all = points.points().flat_map(|p| edges.edges().map(move |e| segment::distance(e, p)));
                all.fold(f64::INFINITY, f64::min)
            };
            let expected = one_way(&a.outline, &moved).min(one_way(&moved, &a.outline));
            for reach in [0.5, 3.0, 20.0] {
                let gap = a.gap(&b, &place, reach, &mut Budget::default().meter()).unwrap();
                assert!((gap - expected.min(reach)).abs() < 1e-9, "{k} {reach}: {gap} {expected}");
            }
        }
    }

    #[test]
    fn combs_that_cross_all_over_are_refused_before_their_common_part_is_found() {
        let comb = |n: usize| -> Vec<Vector<2>> {
            let teeth = (0..n).map(|k| Vector::xy(k as f64, if k.is_multiple_of(2) { 0.0 } else { 2000.0 }));
            teeth.chain([Vector::xy(n as f64, -1.0), Vector::xy(0.0, -1.0)]).collect()
        };
        let upright =
            Figure::new(Outline { rings: vec![comb(1500)] }, Vector::xy(750.0, 750.0), &Budget::default()).unwrap();
        let turned = comb(1500).into_iter().map(|p| Vector::xy(p[1], p[0])).collect();
        let turned =
            Figure::new(Outline { rings: vec![turned] }, Vector::xy(750.0, 750.0), &Budget::default()).unwrap();
        let budget = Budget::default();
        let refused = upright.overlap(&turned, &Similarity::identity(), &budget, &mut budget.meter());
        assert!(refused.unwrap_err().to_string().contains("--limit crossings="));
    }

    #[test]
    fn hull_of_a_star_drops_its_inner_corners() {
        let star: Vec<_> = (0..10)
            .map(|k| (f64::from(k) * std::f64::consts::PI / 5.0, if k % 2 == 0 { 2.0 } else { 0.7 }))
            .map(|(a, r)| Vector::xy(r * a.cos(), r * a.sin()))
            .collect();
        assert_eq!(convex_hull(star.into_iter()).len(), 5);
    }
}
