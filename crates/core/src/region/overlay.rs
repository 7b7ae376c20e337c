//! Boolean operations on outlines, and growing them: what they will cost is drawn on a budget before they are begun.

use i_overlay::{
    core::{fill_rule::FillRule as Rule, overlay::ShapeType, overlay_rule::OverlayRule},
    float::{overlay::FloatOverlay, simplify::SimplifyShape, single::SingleFloatOverlay},
    i_float::adapter::FloatPointAdapter,
    mesh::{
        float::outline::offset::OutlineOffset,
        float::style::{LineJoin, OutlineStyle},
    },
};

use crate::{
    budget::Budget,
    error::Result,
    region::{
        FillRule, Outline, Ring,
        crossings::{foresee, in_range},
        local, ring,
        segment::Segment,
    },
    space::{Bounds, Vector},
};

/// Rounded corners are polygons with an edge for every so many radians.
const ROUND: f64 = 0.1;

/// Boxes that differ in size by more than this have no common grid that is fine enough for the smaller one.
const ONE_GRID: f64 = 65_536.0;

/// Rings that are united at once where all of them are too many.
const AT_ONCE: usize = 16;

impl Outline<2> {
    /// The area covered by `rings` under `rule`, as disjoint polygons without self-crossings.
    ///
    /// Coordinates are rounded to a grid of 2^30 lines over all rings: what is smaller than that vanishes.
    ///
    /// # Errors
    /// [`Error::Limit`](crate::Error::Limit) when there are too many corners or crossings, or when the work or memory for them is used
    /// up; [`Error::Input`](crate::Error::Input) when a coordinate is no sensible number.
    pub fn try_union(rings: &[Ring<2>], rule: FillRule, budget: &Budget) -> Result<Self> {
        let foreseen = foresee(&all_edges(rings), budget);
        // Convex rings that turn alike do not cancel each other, so they can be united in parts.
        let can_part = || rule == FillRule::NonZero && rings.len() > AT_ONCE && turn_alike(rings);
        match foreseen {
            Err(crate::Error::Limit { .. }) if can_part() => in_parts(rings, budget),
            foreseen => foreseen.map(|()| Self::union(rings, rule)),
        }
    }

    /// The part that both outlines cover.
    ///
    /// # Errors
    /// As [`Outline::try_union`].
    pub fn try_intersection(&self, other: &Self, budget: &Budget) -> Result<Self> {
        let (a, b) = (self.bounds(), other.bounds());
        let common = Bounds::new(a.min.zip(b.min, f64::max), a.max.zip(b.max, f64::min));
        if common.is_empty() {
            return Ok(Self::default());
        }
        self.local_overlay(other, [Some(common), Some(common)], OverlayRule::Intersect, budget)
    }

    /// The part of this outline that `other` does not cover.
    ///
    /// # Errors
    /// As [`Outline::try_union`].
    pub fn try_difference(&self, other: &Self, budget: &Budget) -> Result<Self> {
        self.local_overlay(other, [None, Some(self.bounds())], OverlayRule::Difference, budget)
    }

    /// Everything within `distance` of the outline, corners rounded; with a negative `distance` everything at least so far inside.
    ///
    /// # Errors
    /// As [`Outline::try_union`].
    pub fn try_grown(&self, distance: f64, budget: &Budget) -> Result<Self> {
        if self.rings.is_empty() || distance == 0.0 {
            return Ok(self.clone());
        }
        in_range(std::iter::once(Vector::splat(distance)), budget)?;
        let mut moved = Vec::new();
        self.rings.iter().for_each(|ring| push_moved(ring, distance, &mut moved));
        foresee(&moved, budget)?;
        Ok(self.grown(distance))
    }

    /// As [`Outline::try_union`], for outlines of bounded size: nothing is counted, and nothing refused.
    pub fn union(rings: &[Ring<2>], rule: FillRule) -> Self {
        let rule = match rule {
            FillRule::NonZero => Rule::NonZero,
            FillRule::EvenOdd => Rule::EvenOdd,
        };
        from_shapes(to_arrays(rings).simplify_shape(rule))
    }

    /// As [`Outline::try_intersection`], for outlines of bounded size: nothing is counted, and nothing refused.
    pub fn intersection(&self, other: &Self) -> Self {
        self.overlay(other, OverlayRule::Intersect)
    }

    /// As [`Outline::try_difference`], for outlines of bounded size: nothing is counted, and nothing refused.
    pub fn difference(&self, other: &Self) -> Self {
        self.overlay(other, OverlayRule::Difference)
    }

    /// As [`Outline::try_grown`], for outlines of bounded size: nothing is counted, and nothing refused.
    pub fn grown(&self, distance: f64) -> Self {
        if self.rings.is_empty() || distance == 0.0 {
            return self.clone();
        }
        let style = OutlineStyle::new(distance).line_join(LineJoin::Round(ROUND));
        from_shapes(to_arrays(&self.rings).outline(&style))
    }

    /// Whether the two outlines share area; for outlines of bounded size, as [`Outline::intersection`].
    pub fn overlaps(&self, other: &Self) -> bool {
        self.bounds().intersects(&other.bounds()) && !self.intersection(other).rings.is_empty()
    }

    /// An outline that covers the same of a box, by the even-odd rule; what goes on outside is told with few corners.
    #[must_use]
    pub fn near(&self, bounds: &Bounds<2>) -> Self {
        Self { rings: local::reduced(&self.rings, bounds) }
    }

    /// What an operation gives where one of the two is empty.
    fn trivial(&self, other: &Self, rule: OverlayRule) -> Option<Self> {
        if self.rings.is_empty() {
            return Some(Self::default());
        }
        let left = || if rule == OverlayRule::Difference { self.clone() } else { Self::default() };
        other.rings.is_empty().then(left)
    }

    fn overlay(&self, other: &Self, rule: OverlayRule) -> Self {
        self.trivial(other, rule).unwrap_or_else(|| {
            from_shapes(to_arrays(&self.rings).overlay(&to_arrays(&other.rings), rule, Rule::EvenOdd))
        })
    }

    /// An operation in which of each outline only what lies in a box matters.
    ///
    /// The grid that coordinates are rounded to is that of the whole outlines, so that the result is the same as theirs; unless the box
    /// is so small that nothing would be left of it.
    fn local_overlay(
        &self,
        other: &Self,
        boxes: [Option<Bounds<2>>; 2],
        rule: OverlayRule,
        budget: &Budget,
    ) -> Result<Self> {
        if let Some(known) = self.trivial(other, rule) {
            return Ok(known);
        }
        let both = [self, other];
        let corners = both.iter().flat_map(|outline| &outline.rings).map(Vec::len).sum::<usize>();
        budget.within("corners of outlines", corners, ("outline-nodes", budget.limits().outline_nodes))?;
        budget.spend(PER_CORNER * corners as u64)?;
        let whole = self.bounds().union(&other.bounds());
        let longer = |b: &Bounds<2>| b.size()[0].max(b.size()[1]);
        let is_small = |b: &Bounds<2>| longer(&whole) > ONE_GRID * longer(b);
        let by_itself = boxes.iter().flatten().all(|b| !b.is_empty() && is_small(b));
        let parts = [0, 1].map(|k| match &boxes[k] {
            None => both[k].rings.clone(),
            Some(b) if by_itself => local::cut(&both[k].rings, &b.grown(longer(b))),
            Some(b) => local::reduced(&both[k].rings, b),
        });
        let edges: Vec<_> = parts.iter().flat_map(|rings| all_edges(rings)).collect();
        foresee(&edges, budget)?;
        let [subject, clip] = parts.map(|rings| to_arrays(&rings));
        if by_itself {
            return Ok(from_shapes(subject.overlay(&clip, rule, Rule::EvenOdd)));
        }
        in_range([whole.min, whole.max].into_iter(), budget)?;
        let corners = [whole.min.0, whole.max.0];
        let grid = FloatPointAdapter::<[f64; 2], i32>::with_iter_conservative(corners.iter());
        let overlay = FloatOverlay::with_adapter(grid, edges.len());
        let overlay = overlay.unsafe_add_source(&subject, ShapeType::Subject);
        Ok(from_shapes(overlay.unsafe_add_source(&clip, ShapeType::Clip).overlay(rule, Rule::EvenOdd)))
    }
}

/// Work for each corner that is looked at for whether it matters.
const PER_CORNER: u64 = 4;

/// The union of rings that do not cancel each other, by halves: where they lie on top of each other, most borders vanish early.
fn in_parts(rings: &[Ring<2>], budget: &Budget) -> Result<Outline<2>> {
    if rings.len() <= AT_ONCE {
        foresee(&all_edges(rings), budget)?;
        return Ok(Outline::union(rings, FillRule::NonZero));
    }
    let (left, right) = rings.split_at(rings.len() / 2);
    let [mut left, right] = [in_parts(left, budget)?, in_parts(right, budget)?];
    left.rings.extend(right.rings);
    foresee(&all_edges(&left.rings), budget)?;
    Ok(Outline::union(&left.rings, FillRule::NonZero))
}

/// Whether all rings are convex and turn the same way.
fn turn_alike(rings: &[Ring<2>]) -> bool {
    let first = rings.first().map_or(0.0, |r| ring::area(r).signum());
    rings.iter().all(|r| ring::is_convex(r) && ring::area(r).signum() == first)
}

/// The edges of a ring moved by `distance` away from what the outline covers, those that follow each other connected.
fn push_moved(ring: &[Vector<2>], distance: f64, moved: &mut Vec<Segment<2>>) {
    let aside = |(a, b): Segment<2>| {
        let way = b - a;
        let off = Vector::xy(way[1], -way[0]) * (distance / way.norm());
        (a + off, b + off)
    };
    let mut edges = ring::edges(ring).filter(|(a, b)| a != b).map(aside);
    let Some(first) = edges.next() else { return };
    let mut last = first;
    moved.push(first);
    for edge in edges {
        push_corner(last, edge, distance, moved);
        moved.push(edge);
        last = edge;
    }
    push_corner(last, first, distance, moved);
}

/// The corner between two edges that were moved, with as many edges as rounding takes.
fn push_corner(before: Segment<2>, after: Segment<2>, distance: f64, moved: &mut Vec<Segment<2>>) {
    let turn = (before.1 - before.0).angle_to(after.1 - after.0);
    let round = turn * distance > 0.0;
    let steps = if round { (turn.abs() / ROUND).ceil().max(1.0) as usize } else { 1 };
    let (from, way) = (before.1, after.0 - before.1);
    let at = |k: usize| if k == steps { after.0 } else { from + way * (k as f64 / steps as f64) };
    moved.extend((0..steps).map(|k| (at(k), at(k + 1))));
}

fn all_edges(rings: &[Ring<2>]) -> Vec<Segment<2>> {
    rings.iter().flat_map(|r| ring::edges(r)).collect()
}

fn from_shapes(shapes: Vec<Vec<Vec<[f64; 2]>>>) -> Outline<2> {
    let rings = shapes.into_iter().flatten().map(|ring| ring.into_iter().map(Vector).collect()).collect();
    Outline { rings }
}

fn to_arrays(rings: &[Ring<2>]) -> Vec<Vec<[f64; 2]>> {
    rings.iter().map(|ring| ring.iter().map(|p| p.0).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::Limits;

    fn square(x: f64, y: f64, side: f64) -> Ring<2> {
        vec![Vector::xy(x, y), Vector::xy(x + side, y), Vector::xy(x + side, y + side), Vector::xy(x, y + side)]
    }

    #[test]
    fn union_of_two_overlapping_squares_counts_the_overlap_once() {
        let u = Outline::union(&[square(0.0, 0.0, 2.0), square(1.0, 0.0, 2.0)], FillRule::NonZero);
        assert!((u.area() - 6.0).abs() < 1e-6);
    }

    #[test]
    fn a_hole_is_not_inside() {
        let frame = Outline::union(&[square(0.0, 0.0, 4.0), square(1.0, 1.0, 2.0)], FillRule::EvenOdd);
        assert!((frame.area() - 12.0).abs() < 1e-6);
        assert!(frame.contains(Vector::xy(0.5, 0.5)));
        assert!(!frame.contains(Vector::xy(2.0, 2.0)));
        assert!((frame.centroid().unwrap() - Vector::xy(2.0, 2.0)).norm() < 1e-6);
    }

    #[test]
    fn touching_squares_do_not_overlap() {
        let a = Outline { rings: vec![square(0.0, 0.0, 1.0)] };
        let b = Outline { rings: vec![square(1.0, 0.0, 1.0)] };
        let c = Outline { rings: vec![square(0.9, 0.0, 1.0)] };
        assert!(!a.overlaps(&b));
        assert!(a.overlaps(&c));
        assert!((a.intersection(&c).area() - 0.1).abs() < 1e-6);
    }

    fn star(points: usize, radius: f64, centre: Vector<2>) -> Outline<2> {
        let corner = |k: usize| {
            let turn = k as f64 / points as f64 * std::f64::consts::TAU;
            centre + Vector::xy(turn.cos(), turn.sin()) * if k.is_multiple_of(2) { radius } else { 0.4 * radius }
        };
        Outline { rings: vec![(0..points).map(corner).collect()] }
    }

    #[test]
    fn what_lies_far_away_changes_nothing_and_costs_little() {
        let large = star(900, 100.0, Vector::xy(3.0, 7.0));
        for k in 0..40 {
            let turn = f64::from(k) * 0.37;
            let small = star(12, 3.0, Vector::xy(3.0, 7.0) + Vector::xy(turn.cos(), turn.sin()) * (40.0 + turn));
            let budget = Budget::default();
            assert_eq!(small.try_intersection(&large, &budget).unwrap(), small.intersection(&large));
            assert_eq!(small.try_difference(&large, &budget).unwrap(), small.difference(&large));
            assert_eq!(large.try_intersection(&small, &budget).unwrap(), large.intersection(&small));
            assert!(budget.work() < 6_000_000, "{}", budget.work());
        }
    }

    #[test]
    fn unions_and_offsets_are_the_same_with_a_budget() {
        let budget = Budget::default();
        let rings = [star(30, 9.0, Vector::ZERO), star(50, 4.0, Vector::xy(3.0, 1.0))].map(|o| o.rings).concat();
        for rule in [FillRule::NonZero, FillRule::EvenOdd] {
            assert_eq!(Outline::try_union(&rings, rule, &budget).unwrap(), Outline::union(&rings, rule));
        }
        let outline = Outline { rings };
        for distance in [0.0, 0.5, -0.5, 8.0] {
            assert_eq!(outline.try_grown(distance, &budget).unwrap(), outline.grown(distance));
        }
    }

    #[test]
    fn a_small_thing_is_cut_by_a_huge_one() {
        let tiny = Outline { rings: vec![square(-1e-3, 4e-3, 2e-3)] };
        let huge = Outline { rings: vec![square(0.0, -1e9, 1e9)] };
        let budget = Budget::default();
        assert!(tiny.try_intersection(&huge, &budget).unwrap().rings.is_empty(), "it ends below");
        let half = Outline { rings: vec![square(0.0, -5e8, 1e9)] };
        assert!((tiny.try_intersection(&half, &budget).unwrap().area() - 2e-6).abs() < 1e-9);
        assert!((half.try_intersection(&tiny, &budget).unwrap().area() - 2e-6).abs() < 1e-9);
        assert!((tiny.try_difference(&half, &budget).unwrap().area() - 2e-6).abs() < 1e-9);
    }

    #[test]
    fn many_rings_on_top_of_each_other_are_united_in_parts() {
        let budget = Budget::new(Limits { crossings: 1000, ..Limits::default() });
        let pile: Vec<_> =
            (0..400).map(|k| square(f64::from(k * 7 % 400) * 0.1, f64::from(k * 11 % 400) * 0.1, 50.0)).collect();
        let union = Outline::try_union(&pile, FillRule::NonZero, &budget).unwrap();
        assert!((union.area() - Outline::union(&pile, FillRule::NonZero).area()).abs() < 1e-3);
        let error = Outline::try_union(&pile, FillRule::EvenOdd, &budget).unwrap_err().to_string();
        assert!(error.contains("--limit crossings="), "{error}");
        let mut other_way = pile;
        other_way[7].reverse();
        assert!(Outline::try_union(&other_way, FillRule::NonZero, &budget).is_err(), "rings may cancel each other");
    }

    #[test]
    fn growing_by_more_than_everything_is_foreseen() {
        let budget = Budget::new(Limits { crossings: 5000, ..Limits::default() });
        let flower = star(3000, 10.0, Vector::ZERO);
        assert!(flower.try_grown(3.0, &budget).is_err());
        assert!(flower.try_grown(f64::NAN, &budget).is_err() && flower.try_grown(1e30, &budget).is_err());
    }
}
