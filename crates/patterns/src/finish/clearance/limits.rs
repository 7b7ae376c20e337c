//! How much the elements of the exemplar overlap: what the output may do as well.

use std::{collections::BTreeMap, sync::Arc};

use arabesque_core::{Bounds, Budget, Domain, Exemplar, Held, Outline, Placement, Result, Role, Similarity, Warp};

use crate::finish::clearance::{
    arrangement::{Arrangement, Overlap, PlacedFigure},
    figure::Figure,
};

/// Overlaps below this share of the smaller element are rounding.
pub(crate) const NEGLIGIBLE: f64 = 1e-6;

/// Share of the smaller element by which elements may overlap whose classes touch in the exemplar, and share of what
/// classes that overlap do there by which they may overlap more: rounding, and an unsteady hand.
const UNSTEADY: (f64, f64) = (0.02, 0.05);

/// Elements nearer than this touch, in mean spacings.
const TOUCHING: f64 = 1e-3;

/// Elements of two classes that overlap by more than this share of the smaller one lie on top of each other on purpose.
const LAYERED: f64 = 0.5;

/// Gaps are measured between so many pairs of a pair of classes, those with the nearest circles.
const MEASURED_PAIRS: usize = 64;

/// Widest gap that is asked for when two elements are pushed apart, in mean spacings.
const WIDEST_GAP: f64 = 0.02;

/// Bytes of a corner of an outline and of its hull; edges are held where they are sorted.
const CORNER: usize = 48;

/// The same for an outline, however few corners it has.
const FIGURE: usize = 400;

/// Two classes, the lower index first.
type ClassPair = (usize, usize);

/// What the exemplar shows of two classes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Allowance {
    /// Largest common area, as a share of the smaller element.
    share: f64,
    /// Smallest distance between elements that do not overlap, at most [`WIDEST_GAP`].
    gap: Option<f64>,
    /// Whether elements touch without overlapping by more than rounding.
    touches: bool,
}

impl Allowance {
    /// Largest common area that two elements may have, as a share of the smaller one.
    fn largest(&self) -> f64 {
        let touching = if self.touches { UNSTEADY.0 } else { 0.0 };
        ((1.0 + UNSTEADY.1) * self.share).max(touching)
    }
}

/// Outlines of the exemplar's elements, and how they lie to each other.
#[derive(Clone, Debug)]
pub(crate) struct ExemplarClearance {
    /// One figure per element.
    pub(crate) figures: Vec<Figure>,
    /// The class of each.
    pub(crate) class: Vec<usize>,
    /// All pairs of elements that share area.
    pub(crate) overlaps: Vec<Overlap>,
    /// Elements that may be copied, by class, largest first.
    sources: Vec<Vec<usize>>,
    /// Mean element spacing.
    pub(crate) spacing: f64,
    allowed: BTreeMap<ClassPair, Allowance>,
    /// Common area as a share of all ink, classes that are layered on purpose, or only touch, left out.
    ratio: f64,
    /// The frame of the exemplar.
    pub(crate) window: Bounds<2>,
    _held: Arc<Held>,
}

impl ExemplarClearance {
    /// The same with other classes for some elements: pairs of an element and its class, which is none of those that there
    /// were.
    pub(crate) fn classed(&self, classes: Vec<(usize, usize)>) -> Self {
        let first_free = self.class.iter().max().map_or(0, |class| class + 1);
        let mut all = self.clone();
        for (element, class) in classes {
            all.class[element] = first_free + class;
        }
        all
    }

    /// Measures the exemplar. `None` when no element has an outline: points never overlap.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Self>> {
        let budget = budget.stage("measuring overlaps of the exemplar");
        let corners: usize =
            exemplar.elements.iter().map(|e| e.outline.rings.iter().map(Vec::len).sum::<usize>()).sum();
        let bytes = corners.saturating_mul(CORNER) + exemplar.elements.len() * FIGURE;
        let held = Arc::new(budget.hold("outlines", bytes)?);
        let figure = |e: &arabesque_core::Element<2>| Figure::new(e.outline.clone(), e.centre, &budget);
        let figures: Vec<_> = exemplar.elements.iter().map(figure).collect::<Result<_>>()?;
        if figures.iter().all(Figure::is_empty) {
            return Ok(None);
        }
        let class = exemplar.elements.iter().map(|e| e.class).collect();
        let sources = sources(exemplar, &figures);
        let spacing = exemplar.spacing();
        let allowed = BTreeMap::new();
        let mut clearance = Self {
            figures,
            class,
            overlaps: Vec::new(),
            sources,
            spacing,
            allowed,
            ratio: 0.0,
            window: exemplar.window,
            _held: held,
        };
        clearance.measure(&Domain::Box(exemplar.window), &budget)?;
        Ok(Some(clearance))
    }

    fn measure(&mut self, window: &Domain<2>, budget: &Budget) -> Result<()> {
        let bodies = (0..self.figures.len()).map(|i| self.body(i, Similarity::identity())).collect();
        let arrangement = Arrangement::new(window, budget.clone(), &self.figures, Vec::new(), bodies);
        let overlaps = arrangement.overlaps()?;
        let mut allowed = BTreeMap::<ClassPair, Allowance>::new();
        for overlap in &overlaps {
            let share = overlap.area / smaller_area(&arrangement, overlap);
            let entry = allowed.entry(pair(self.class[overlap.a], self.class[overlap.b])).or_default();
            entry.share = entry.share.max(share);
            entry.touches |= share <= NEGLIGIBLE;
        }
        for (classes, gap) in smallest_gaps(&arrangement, &overlaps, WIDEST_GAP * self.spacing)? {
            let entry = allowed.entry(classes).or_default();
            entry.gap = Some(gap);
            entry.touches |= gap <= TOUCHING * self.spacing;
        }
        self.allowed = allowed;
        let all = self.unlayered_area(&arrangement, &overlaps) / ink(&arrangement).max(f64::MIN_POSITIVE);
        self.ratio = all.max(self.inner_ratio(&arrangement, &overlaps));
        self.overlaps = overlaps;
        Ok(())
    }

    /// Common area as a share of the ink of elements all of whose neighbours are known: those at the frame have fewer.
    fn inner_ratio(&self, arrangement: &Arrangement<'_>, overlaps: &[Overlap]) -> f64 {
        let bodies = &arrangement.bodies;
        let is_inner = |i: usize| self.window.signed_distance(bodies[i].centre) >= 2.0 * bodies[i].radius;
        let ink: f64 = (0..bodies.len()).filter(|&i| is_inner(i)).map(|i| bodies[i].area).sum();
        let halves = |o: &Overlap| f64::from(u8::from(is_inner(o.a)) + u8::from(is_inner(o.b)));
        let counts = |o: &&Overlap| !self.is_free(&bodies[o.a], &bodies[o.b]);
        let common: f64 = overlaps.iter().filter(counts).map(|o| 0.5 * halves(o) * o.area).sum();
        if ink > 0.0 { common / ink } else { 0.0 }
    }

    /// PlacedFigure of exemplar element `source` under `place`.
    pub(crate) fn body(&self, source: usize, place: Similarity<2>) -> PlacedFigure {
        PlacedFigure { class: Some(self.class[source]), ..PlacedFigure::new(source, &self.figures[source], place) }
    }

    /// Bodies of placements, with figures of their own for the bent ones.
    pub(crate) fn bodies(
        &self,
        placements: &[Placement<2>],
        budget: &Budget,
    ) -> Result<(Vec<Figure>, Vec<PlacedFigure>)> {
        let mut own = Vec::new();
        let mut bodies = Vec::with_capacity(placements.len());
        for placement in placements {
            let body = self.body(placement.source, placement.transform);
            let fixed = placement.frozen.is_some();
            if placement.control.is_empty() {
                bodies.push(PlacedFigure { fixed, ..body });
                continue;
            }
            let figure = bent(&self.figures[placement.source], placement, budget)?;
            let bent = PlacedFigure::new(self.figures.len() + own.len(), &figure, Similarity::identity());
            own.push(figure);
            bodies.push(PlacedFigure { class: body.class, fixed, ..bent });
        }
        Ok((own, bodies))
    }

    /// Elements of the class of `source` that may be copied and are smaller than it, largest first.
    pub(crate) fn smaller_sources(&self, source: usize) -> impl Iterator<Item = usize> {
        let own = &self.figures[source];
        let fits = move |&&other: &&usize| {
            let figure = &self.figures[other];
            figure.area < own.area && figure.radius <= own.radius && other != source
        };
        self.sources[self.class[source]].iter().filter(fits).copied()
    }

    /// Largest common area that two bodies may have.
    pub(crate) fn allowed_area(&self, a: &PlacedFigure, b: &PlacedFigure) -> f64 {
        let share = self.allowance(a, b).map_or(0.0, Allowance::largest);
        share.max(NEGLIGIBLE) * (1.0 + NEGLIGIBLE) * a.area.min(b.area)
    }

    /// Whether any overlap at all is too much for two bodies.
    pub(crate) fn must_be_apart(&self, a: &PlacedFigure, b: &PlacedFigure) -> bool {
        self.allowance(a, b).is_none_or(|allowance| allowance.largest() <= NEGLIGIBLE)
    }

    /// Whether how much two bodies overlap is not counted: their classes lie on top of each other on purpose, or touch
    /// and nothing more.
    fn is_free(&self, a: &PlacedFigure, b: &PlacedFigure) -> bool {
        let touch = |allowance: &Allowance| allowance.touches && allowance.share <= NEGLIGIBLE;
        self.allowance(a, b).is_some_and(|allowance| allowance.share > LAYERED || touch(allowance))
    }

    /// Distance to leave between two bodies that are pushed apart, for elements of exemplar size: as close as the
    /// exemplar has any, none for bodies that may overlap.
    pub(crate) fn gap(&self, a: &PlacedFigure, b: &PlacedFigure) -> f64 {
        let widest = WIDEST_GAP * self.spacing;
        match self.allowance(a, b) {
            Some(allowance) if allowance.largest() > NEGLIGIBLE => 0.0,
            Some(allowance) => allowance.gap.unwrap_or(widest),
            None => widest,
        }
    }

    fn allowance(&self, a: &PlacedFigure, b: &PlacedFigure) -> Option<&Allowance> {
        self.allowed.get(&pair(a.class?, b.class?))
    }

    fn unlayered_area(&self, arrangement: &Arrangement, overlaps: &[Overlap]) -> f64 {
        let counts = |o: &&Overlap| !self.is_free(&arrangement.bodies[o.a], &arrangement.bodies[o.b]);
        overlaps.iter().filter(counts).fold(0.0, |sum, o| sum + o.area)
    }

    /// Pairs that have to go, largest first, so that the common area of the rest is no larger a share of the ink than
    /// in the exemplar: pairs that are allowed one by one can still be too many.
    pub(crate) fn surplus(&self, arrangement: &Arrangement, allowed: &[Overlap]) -> Vec<(usize, usize)> {
        let budget = self.ratio * (1.0 + UNSTEADY.1) * ink(arrangement);
        let mut sum = self.unlayered_area(arrangement, allowed);
        let is_candidate = |o: &&Overlap| {
            let (a, b) = (&arrangement.bodies[o.a], &arrangement.bodies[o.b]);
            !(self.is_free(a, b) || a.fixed && b.fixed) && o.a != o.b && o.area > NEGLIGIBLE * a.area.min(b.area)
        };
        let mut candidates: Vec<_> = allowed.iter().filter(is_candidate).collect();
        candidates.sort_by(|x, y| y.area.total_cmp(&x.area).then((x.a, x.b).cmp(&(y.a, y.b))));
        let mut surplus = Vec::new();
        for overlap in candidates {
            if sum <= budget * (1.0 + NEGLIGIBLE) {
                break;
            }
            sum -= overlap.area;
            surplus.push((overlap.a, overlap.b));
        }
        surplus
    }
}

fn pair(a: usize, b: usize) -> ClassPair {
    (a.min(b), a.max(b))
}

fn smaller_area(arrangement: &Arrangement, overlap: &Overlap) -> f64 {
    arrangement.bodies[overlap.a].area.min(arrangement.bodies[overlap.b].area).max(f64::MIN_POSITIVE)
}

/// Area of all elements together, overlaps counted twice.
pub(crate) fn ink(arrangement: &Arrangement) -> f64 {
    arrangement.bodies.iter().filter(|body| body.class.is_some()).map(|body| body.area).sum()
}

fn sources(exemplar: &Exemplar<2>, figures: &[Figure]) -> Vec<Vec<usize>> {
    let mut sources = vec![Vec::new(); exemplar.classes.len()];
    for (i, element) in exemplar.elements.iter().enumerate().filter(|(_, e)| e.role == Role::Source) {
        sources[element.class].push(i);
    }
    for members in &mut sources {
        members.sort_by(|&a, &b| figures[b].area.total_cmp(&figures[a].area).then(a.cmp(&b)));
    }
    sources
}

/// The outline of a placement that is bent, in output coordinates.
fn bent(figure: &Figure, placement: &Placement<2>, budget: &Budget) -> Result<Figure> {
    let warp = Warp::new(&placement.control);
    let rings = figure.outline().rings.iter().map(|ring| ring.iter().map(|&p| warp.apply(p)).collect()).collect();
    Figure::new(Outline { rings }, warp.apply(figure.centre), budget)
}

/// Smallest distance between elements of two classes that do not overlap, no larger than `widest`.
fn smallest_gaps(arrangement: &Arrangement, overlaps: &[Overlap], widest: f64) -> Result<BTreeMap<ClassPair, f64>> {
    let mut meter = arrangement.budget.meter();
    let mut near = BTreeMap::<ClassPair, Vec<(f64, usize, usize)>>::new();
    for i in 0..arrangement.bodies.len() {
        for j in arrangement.neighbours(i, 0.5 * widest, &mut meter)?.into_iter().filter(|&j| j > i) {
            let (a, b) = (&arrangement.bodies[i], &arrangement.bodies[j]);
            let between = (a.centre - b.centre).norm() - a.radius - b.radius;
            let apart = overlaps.binary_search_by_key(&(i, j), |o| (o.a, o.b)).is_err();
            if let (Some(x), Some(y), true) = (a.class, b.class, apart && between < widest) {
                near.entry(pair(x, y)).or_default().push((between, i, j));
            }
        }
    }
    let mut smallest = BTreeMap::new();
    for (classes, mut pairs) in near {
        pairs.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        let mut gap = widest;
        for &(_, i, j) in pairs.iter().take(MEASURED_PAIRS) {
            gap = gap.min(arrangement.gap(i, j, gap, &mut meter)?);
        }
        smallest.insert(classes, gap);
    }
    Ok(smallest)
}
