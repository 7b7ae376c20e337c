//! Whether a finished element may lie where the lattice has it: exact questions about the border of the domain, what is
//! in the way, and what stays.

use arabesque_core::{
    Border, Bounds, Budget, Domain, GridIndex, Outline, Placement, Region, Request, Result, Shape, Vector,
};

/// Shares of an area up to which one outline does not count as reaching into, or over the border of, another.
const TOUCH: f64 = 1e-6;

/// Share of an element that may lie on something that stays and has no place in the lattice.
const OVERLAP: f64 = 0.01;

/// Work for an element that is asked about.
const ASK: u64 = 300;

/// The domain, its border, and what is there already.
pub(crate) struct Admission<'a> {
    request: &'a Request<2>,
    /// The domain as polygons, where it has a border.
    outline: Option<Outline<2>>,
    obstacles: Option<&'a Shape>,
    /// What stays and has no place in the lattice, with the boxes around.
    kept: Vec<(Outline<2>, Bounds<2>)>,
    index: GridIndex<2>,
    /// Largest half diagonal of these boxes.
    reach: f64,
    /// How far beyond the border of a region that is filled again the place of something may lie that was taken out of it.
    slack: f64,
}

impl<'a> Admission<'a> {
    /// `obstacles`: what is in the way; `kept`: outlines that nothing may lie on.
    pub(crate) fn new(request: &'a Request<2>, obstacles: Option<&'a Shape>, kept: Vec<Outline<2>>) -> Self {
        let kept: Vec<_> = kept.into_iter().map(|o| (o.clone(), o.bounds())).filter(|(_, b)| !b.is_empty()).collect();
        let centres: Vec<_> = kept.iter().map(|(_, b)| b.centre()).collect();
        let reach = kept.iter().map(|(_, b)| 0.5 * b.size().norm()).fold(0.0, f64::max);
        Self {
            request,
            outline: request.domain.outline(),
            obstacles,
            index: GridIndex::new(&centres, reach.max(1e-9), &request.domain),
            kept,
            reach,
            slack: 0.0,
        }
    }

    /// The same where nothing stays at the places that are asked about: what was taken out of the region lay up to `slack` from them.
    pub(crate) fn with_slack(self, slack: f64) -> Self {
        Self { slack, ..self }
    }

    /// Whether an element with this outline and its centre at `p` may be part of the output.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn admits(&self, outline: &Outline<2>, p: Vector<2>, budget: &Budget) -> Result<bool> {
        budget.spend(ASK)?;
        let radius = outline.radius(p);
        Ok(self.keeps_border(outline, p, radius, budget)?
            && !self.meets_obstacle(outline, p, radius, budget)?
            && !self.lies_on_kept(outline, p, radius, budget)?)
    }

    fn keeps_border(&self, outline: &Outline<2>, p: Vector<2>, radius: f64, budget: &Budget) -> Result<bool> {
        let depth = self.request.domain.signed_distance(p);
        let border = self.request.border;
        if depth >= radius || self.request.domain.period().is_some() {
            return Ok(true);
        }
        if border == Border::Cross || outline.rings.is_empty() {
            // What was taken out of a region that is filled again lay in it or on its border.
            let slack = self.request.known.map_or(0.0, |known| self.slack.max(1e-9 * known.size().norm()));
            return Ok(depth >= -slack);
        }
        if depth < -radius {
            return Ok(false);
        }
        let Some(domain) = &self.outline else { return Ok(depth >= 0.0) };
        let area = outline.area();
        let inside = || Ok::<_, arabesque_core::Error>(outline.try_intersection(domain, budget)?.area());
        Ok(match border {
            Border::Clip => inside()? > TOUCH * area,
            Border::Inside | Border::Turn | Border::Cross => {
                self.is_within(outline) || inside()? >= (1.0 - TOUCH) * area
            }
        })
    }

    /// Whether a box holds an outline, corner by corner; coordinates that were rounded may lie just on it.
    fn is_within(&self, outline: &Outline<2>) -> bool {
        let Domain::Box(page) = &self.request.domain else { return false };
        let page = page.grown(1e-9 * page.size().norm());
        outline.points().all(|p| page.contains(p))
    }

    fn meets_obstacle(&self, outline: &Outline<2>, p: Vector<2>, radius: f64, budget: &Budget) -> Result<bool> {
        let Some(obstacles) = self.obstacles else { return Ok(false) };
        let depth = obstacles.signed_distance(p);
        if depth < -radius {
            return Ok(false);
        }
        if outline.rings.is_empty() {
            return Ok(depth >= 0.0);
        }
        Ok(outline.try_intersection(obstacles.outline(), budget)?.area() > TOUCH * outline.area())
    }

    fn lies_on_kept(&self, outline: &Outline<2>, p: Vector<2>, radius: f64, budget: &Budget) -> Result<bool> {
        let mut near = Vec::new();
        let looked = self.index.within(p, radius + self.reach, |k, offset| near.push((k, offset)));
        budget.spend(10 * looked)?;
        for (k, offset) in near {
            let (other, extent) = &self.kept[k];
            // Around the back of a tile, the other one lies where it is nearest.
            let shift = p + offset - extent.centre();
            let other = Outline { rings: other.rings.iter().map(|r| r.iter().map(|&q| q + shift).collect()).collect() };
            if outline.try_intersection(&other, budget)?.area() > OVERLAP * outline.area().min(other.area()) {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

/// The outline of a placement in the output.
pub(crate) fn outline_of(placement: &Placement<2>, exemplar: &arabesque_core::Exemplar<2>) -> Outline<2> {
    exemplar.elements[placement.source].outline.transformed(&placement.transform)
}
