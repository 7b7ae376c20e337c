//! Where an element may be put, given the domain and what happens at its border.

use std::sync::Arc;

use arabesque_core::{
    Border, Bounds, Budget, Domain, Exemplar, FillRule, GridIndex, Ground, Matrix, Measured, Numbered, Outline,
    Placement, Region, Request, Result, ScalarField, Similarity, Vector,
};

use crate::{dimension::Dimension, exemplar::library::Library, obstacles::obstacles};

/// An element that stands on the ground may be moved there from a place that is off by this share of its reach.
const OFF_GROUND: f64 = 0.5;
/// One that does not may begin below it by this share of its reach, and is then lifted.
const BELOW_GROUND: f64 = 0.25;

/// The domain together with its border rule.
pub(crate) struct Extent<'a, const D: usize> {
    request: &'a Request<D>,
    exemplar: &'a Exemplar<D>,
    radius: &'a Numbered<f64>,
    base: u32,
    /// The ink that is in the way.
    obstacles: Option<Arc<dyn Region<D>>>,
    /// Places along the frozen strokes.
    drawn: Option<GridIndex<D>>,
    /// How far outside the domain centres may lie.
    pub(crate) margin: f64,
    /// Largest factor by which gaps between elements are wider than in the exemplar.
    pub(crate) largest_spacing_scale: f64,
    /// Smallest such factor.
    pub(crate) smallest_spacing_scale: f64,
}

impl<'a, const D: usize> Extent<'a, D> {
    /// `base`: first pseudo element, see [`crate::exemplar::level::Level::base`].
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(
        request: &'a Request<D>,
        exemplar: &'a Exemplar<D>,
        library: &'a Library<D>,
        base: u32,
    ) -> Result<Self>
    where
        Vector<D>: Dimension<D>,
    {
        let radius = &library.radius;
        let largest = |field: &ScalarField<D>| field.range().1;
        let scale = largest(&request.fields.scale);
        let reach = library.reach * scale;
        let dense = request.fields.density.range().1.powf(-1.0 / D as f64);
        let smallest_spacing_scale = request.fields.scale.range().0 * dense;
        let strokes = radius.iter().skip(base as usize).copied().fold(0.0, f64::max) * scale;
        let margin = if request.border == Border::Clip { reach } else { strokes };
        Ok(Self {
            request,
            exemplar,
            radius,
            obstacles: blocked(request)?,
            drawn: drawn(request, strokes)?,
            margin,
            base,
            largest_spacing_scale: Self::largest_spacing_scale(request),
            smallest_spacing_scale,
        })
    }

    /// What is continued.
    pub(crate) fn exemplar(&self) -> &'a Exemplar<D> {
        self.exemplar
    }

    /// What is asked for.
    pub(crate) fn request(&self) -> &'a Request<D> {
        self.request
    }

    /// Largest factor by which gaps are wider than in the exemplar.
    pub(crate) fn largest_spacing_scale(request: &Request<D>) -> f64 {
        request.fields.scale.range().1 * request.fields.density.range().0.powf(-1.0 / D as f64)
    }

    /// The rule of the border for element `i`. Strokes reach over the border in any case, so that they can be cut
    /// there.
    fn border(&self, i: u32) -> Border {
        if i >= self.base { Border::Clip } else { self.request.border }
    }

    /// The rule of the border for elements.
    pub(crate) fn rule(&self) -> Border {
        self.request.border
    }

    /// Whether the domain has no border.
    pub(crate) fn is_endless(&self) -> bool {
        self.request.domain.period().is_some()
    }

    /// Whether something is in the way anywhere.
    pub(crate) fn has_obstacles(&self) -> bool {
        self.obstacles.is_some()
    }

    /// The style of an exemplar curve, and whether it is closed.
    pub(crate) fn style(&self, curve: usize) -> (usize, bool) {
        let curve = &self.exemplar.curves[curve];
        (curve.style, curve.path.closed)
    }

    /// What can be filled, as polygons: the domain without what is in the way. `None` where it has no border, and in
    /// space.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn outline(&self, budget: &Budget) -> Result<Option<Outline<2>>>
    where
        Vector<D>: Dimension<D>,
    {
        let Some(request) = Vector::plane_request(self.request) else { return Ok(None) };
        let Some(whole) = request.domain.outline() else { return Ok(None) };
        let rings: Vec<_> = request.obstacles.iter().flat_map(|o| o.rings.iter().cloned()).collect();
        whole.try_difference(&Outline::try_union(&rings, FillRule::NonZero, budget)?, budget).map(Some)
    }

    /// Distance to the border, negative outside.
    pub(crate) fn depth(&self, p: Vector<D>) -> f64 {
        self.request.domain.signed_distance(p)
    }

    /// Distance to the border and to what is in the way, negative beyond the one and within the other.
    pub(crate) fn room(&self, p: Vector<D>) -> f64 {
        let depth = self.request.domain.signed_distance(p);
        self.obstacles.as_ref().map_or(depth, |o| depth.min(-o.signed_distance(p)))
    }

    /// Whether exemplar element `i` may lie with its centre at `p`, by the domain and its border rule alone.
    pub(crate) fn admits(&self, i: u32, p: Vector<D>) -> bool {
        let reach = self.radius[i] * self.request.fields.scale.at(p);
        let distance = self.request.domain.signed_distance(p);
        if self.is_blocked(p, 0.7 * reach) {
            return false;
        }
        if let Some((height, ground)) = self.stands(i, p)
            && (ground.height(p) - height).abs() > OFF_GROUND * reach
        {
            return false;
        }
        if let Some(ground) = self.lies_over(i)
            && ground.height(p) < reach
            && self.outline_at(i, p).points().any(|q| ground.height(q) < -BELOW_GROUND * reach)
        {
            return false;
        }
        match self.border(i) {
            Border::Cross => distance >= 0.0,
            Border::Clip if distance >= 0.0 => true,
            Border::Clip if i >= self.base && self.is_known(p) => false,
            Border::Clip => {
                !self.is_drawn(p, reach)
                    && distance >= -reach
                    && self.outline_at(i, p).points().any(|q| self.request.domain.contains(q))
            }
            Border::Inside | Border::Turn if distance >= reach => true,
            Border::Inside | Border::Turn => {
                distance >= 0.0 && self.outline_at(i, p).points().all(|q| self.request.domain.contains(q))
            }
        }
    }

    /// The height at which element `i` stands, where it stands on the ground and there is one.
    fn stands(&self, i: u32, p: Vector<D>) -> Option<(f64, &dyn Ground<D>)> {
        let ground = self.request.ground.as_deref()?;
        let height = self.exemplar.heights.get(i as usize).copied().flatten()?;
        Some((height * self.request.fields.scale.at(p), ground))
    }

    /// The ground below element `i`, where there is one on which others stand.
    pub(crate) fn lies_over(&self, i: u32) -> Option<&dyn Ground<D>> {
        let ground = self.request.ground.as_deref()?;
        let height = self.exemplar.heights.get(i as usize)?;
        height.is_none().then_some(ground)
    }

    /// Where element `i` is when it is put at `p`: on the ground if it stands there.
    pub(crate) fn grounded(&self, i: u32, p: Vector<D>) -> Vector<D> {
        self.stands(i, p).map_or(p, |(height, ground)| ground.at_height(p, height))
    }

    /// Whether everything at a place outside the domain stays as it is.
    pub(crate) fn is_known(&self, p: Vector<D>) -> bool {
        self.request.known.is_some_and(|known| known.contains(p))
    }

    /// Whether a frozen stroke lies within `reach` of `p`.
    fn is_drawn(&self, p: Vector<D>, reach: f64) -> bool {
        let mut near = false;
        if let Some(drawn) = &self.drawn {
            drawn.within(p, reach, |_, _| near = true);
        }
        near
    }

    /// Whether an obstacle lies within `reach` of `p`: a rough test, the clearance check is exact.
    pub(crate) fn is_blocked(&self, p: Vector<D>, reach: f64) -> bool {
        self.obstacles.as_ref().is_some_and(|o| o.signed_distance(p) > -reach)
    }

    /// Whether anything at all may have its centre at `p`: a quick test that ignores what would lie there.
    pub(crate) fn may_hold(&self, p: Vector<D>) -> bool {
        self.request.domain.signed_distance(p) >= -self.margin && !self.is_blocked(p, 0.0)
    }

    /// The shortest way for element `i` at `p` to where its centre may lie; zero where it already does.
    pub(crate) fn way_back(&self, i: u32, p: Vector<D>) -> Vector<D> {
        let domain = &self.request.domain;
        let reach = self.radius[i] * self.request.fields.scale.at(p);
        let allowed = match self.border(i) {
            Border::Cross | Border::Inside | Border::Turn => 0.0,
            Border::Clip if i >= self.base && self.is_known(p) => 0.0,
            Border::Clip => -reach,
        };
        let distance = domain.signed_distance(p);
        if distance >= allowed {
            return Vector::ZERO;
        }
        let back = domain.offset(p, domain.nearest_inside(p));
        back * ((allowed - distance) / back.norm().max(f64::MIN_POSITIVE))
    }

    /// Whether a finished element shows in the domain at all, or for [`Border::Cross`] has its centre in it. Elements
    /// that should lie wholly inside are the business of the clearance check; without an outline their centre decides.
    pub(crate) fn may_show(&self, placement: &Placement<D>) -> bool {
        let element = &self.exemplar.elements[placement.source];
        let p = placement.transform.apply(element.centre);
        let distance = self.request.domain.signed_distance(p);
        if distance >= 0.0 || self.request.border != Border::Clip {
            return distance >= 0.0;
        }
        let ink = element.outline.transformed(&placement.transform);
        ink.points().any(|q| self.request.domain.contains(q))
    }

    /// Whether a finished element keeps to the rule of the border, corner by corner: a quick test for elements that the
    /// clearance check did not look at.
    pub(crate) fn keeps_rule(&self, placement: &Placement<D>) -> bool {
        let element = &self.exemplar.elements[placement.source];
        let domain = &self.request.domain;
        let depth = domain.signed_distance(placement.transform.apply(element.centre));
        match self.request.border {
            Border::Cross | Border::Clip => true,
            Border::Inside | Border::Turn => {
                let is_deep = depth >= self.radius[placement.source as u32] * placement.transform.scale;
                let ink = || element.outline.transformed(&placement.transform);
                (is_deep && placement.control.is_empty())
                    || (depth >= 0.0 && ink().points().all(|q| domain.contains(q)))
            }
        }
    }

    /// The outline of element `i` with its centre at `p`.
    fn outline_at(&self, i: u32, p: Vector<D>) -> Outline<D> {
        let element = &self.exemplar.elements[i as usize];
        element.outline.transformed(&self.placement(i, p))
    }

    /// How element `i` lies with its centre at `p`.
    pub(crate) fn placement(&self, i: u32, p: Vector<D>) -> Similarity<D> {
        self.turned(i, p, &Matrix::identity())
    }

    /// How element `i` lies with its centre at `p` and an extra turn.
    pub(crate) fn turned(&self, i: u32, p: Vector<D>, turn: &Matrix<D>) -> Similarity<D> {
        let frame = self.request.fields.frame(p);
        let rotation = frame.rotation.compose(turn);
        Similarity::about(self.exemplar.elements[i as usize].centre, p, rotation, frame.element_scale)
    }
}

/// Places along the frozen strokes, `step` apart.
fn drawn<const D: usize>(request: &Request<D>, step: f64) -> Result<Option<GridIndex<D>>> {
    if request.frozen_curves.is_empty() || step <= 0.0 {
        return Ok(None);
    }
    let budget = request.budget.stage("looking at what is kept");
    let mut places = Vec::new();
    let mut held = Vec::new();
    for drawn in &request.frozen_curves {
        budget.spend(1000 * drawn.path.cubics.len() as u64)?;
        let measured = Measured::new(drawn.path.clone(), 0.1 * step);
        let count = (measured.length() / step).ceil().clamp(1.0, 1e5) as usize;
        held.push(budget.hold("places along kept strokes", 4 * count * size_of::<Vector<D>>())?);
        budget.spend(100 * count as u64)?;
        places.extend((0..=count).map(|k| measured.point(measured.length() * k as f64 / count as f64)));
    }
    let around = Domain::Box(Bounds::around(places.iter().copied()));
    Ok(Some(GridIndex::new(&places, step, &around)))
}

/// What is in the way as a region; in the plane alone, outlines have no meaning in space.
fn blocked<const D: usize>(request: &Request<D>) -> Result<Option<Arc<dyn Region<D>>>>
where
    Vector<D>: Dimension<D>,
{
    let Some(plane) = Vector::plane_request(request) else { return Ok(None) };
    Ok(obstacles(plane)?.and_then(|shape| Vector::from_plane(Arc::new(shape))))
}
