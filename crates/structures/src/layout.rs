//! The sites of a run, and the window that its frames allow.

use arabesque_core::{Budget, Domain, Error, Result, Vector};

use crate::{
    energy::links::{Lists, SiteIndex, neighbours},
    prepared::Prepared,
    territory::{
        plan::{SitePlan, Territory},
        site::Site,
    },
};

/// Neighbours are sites within so many steps.
const AROUND: f64 = 1.25;
/// What lies half a window from a site may be so far from where a neighbour sees it, in spacings.
const OFF: f64 = 0.7;
/// Smallest window where frames turn, in spacings.
const SMALLEST: f64 = 3.0;
/// Share of the sites around which the frames turn less than the window is made for.
const MOST: f64 = 0.8;

/// The sites of a run.
pub(crate) struct Layout<const D: usize> {
    pub(crate) plan: SitePlan<D>,
    /// Size of the window at first.
    pub(crate) window: f64,
    pub(crate) sites: Vec<Site<D>>,
    pub(crate) index: SiteIndex<D>,
    /// For each site those next to it.
    pub(crate) around: Lists,
    pub(crate) domain: Domain<D>,
}

impl<const D: usize> Layout<D> {
    /// Sites all over `territory`. Where its frames turn so fast that neighbouring windows would disagree, windows are smaller.
    pub(crate) fn new(prepared: &Prepared<D>, territory: &dyn Territory<D>, budget: &Budget) -> Result<Self> {
        let first = Self::with(prepared, territory, prepared.window, budget)?;
        let spacing = prepared.pattern.spacing;
        // A window of half width t sees its border off by turn * t^2 / 2.
        let allowed = (2.0 * OFF * spacing / first.turning().max(1e-12)).sqrt().max(SMALLEST * spacing);
        if allowed > 0.95 * prepared.window { Ok(first) } else { Self::with(prepared, territory, allowed, budget) }
    }

    fn with(prepared: &Prepared<D>, territory: &dyn Territory<D>, window: f64, budget: &Budget) -> Result<Self> {
        Self::of(prepared.plan_for(window), territory, window, budget)
    }

    /// The same room with sites this far apart, for windows of that size.
    pub(crate) fn spaced(&self, step: f64, territory: &dyn Territory<D>, budget: &Budget) -> Result<Self> {
        Self::of(SitePlan { step, ..self.plan }, territory, self.window, budget)
    }

    fn of(plan: SitePlan<D>, territory: &dyn Territory<D>, window: f64, budget: &Budget) -> Result<Self> {
        let sites = territory.sites(&plan, budget)?;
        if sites.is_empty() {
            return Err(Error::no_result(
                "the domain is too small for the structure",
                "make the domain larger, or the scale smaller",
            ));
        }
        Self::over(plan, window, sites, territory.surroundings(), budget)
    }

    /// These sites, which are there.
    pub(crate) fn over(
        plan: SitePlan<D>,
        window: f64,
        sites: Vec<Site<D>>,
        domain: Domain<D>,
        budget: &Budget,
    ) -> Result<Self> {
        let index = SiteIndex::new(&sites, plan.step, &domain);
        let places: Vec<_> = sites.iter().map(|s| s.place).collect();
        let largest = sites.iter().map(|s| s.scale).fold(0.0, f64::max);
        let around = neighbours(&places, AROUND * plan.step * largest, &domain, budget)?;
        Ok(Self { plan, window, sites, index, around, domain })
    }

    /// Matches for the sites here that go on from those of another layout; the pattern repeats along `base`.
    pub(crate) fn carried(&self, from: &Self, matches: &[Vector<D>], base: [bool; D]) -> Vec<Vector<D>> {
        let largest = from.sites.iter().map(|s| s.scale).fold(0.0, f64::max);
        let reach = 2.0 * (self.plan.step + from.plan.step) * largest;
        self.sites
            .iter()
            .map(|site| {
                let nearest = from.index.nearest(site.place, reach).unwrap_or(0);
                let step = from.sites[nearest].seen(self.domain.offset(from.sites[nearest].place, site.place));
                let m = matches[nearest];
                Vector(std::array::from_fn(|k| m[k] + if base[k] { step[k] } else { 0.0 }))
            })
            .collect()
    }

    /// How fast frames turn from site to site, in radians for each unit of the exemplar: more than that only around a few.
    fn turning(&self) -> f64 {
        let mut turning: Vec<f64> = (0..self.sites.len())
            .map(|q| {
                let site = &self.sites[q];
                let of = |&other: &u32| {
                    let other = &self.sites[other as usize];
                    let (mut off, mut far) = (0.0, 0.0);
                    for (a, b) in site.rotation.0.iter().flatten().zip(other.rotation.0.iter().flatten()) {
                        off += (a - b) * (a - b);
                    }
                    far += self.domain.offset(site.place, other.place).norm() / site.scale;
                    (0.5 * off).sqrt() / far.max(1e-12)
                };
                self.around.of(q).iter().map(of).fold(0.0, f64::max)
            })
            .collect();
        turning.sort_by(f64::total_cmp);
        turning[((turning.len() - 1) as f64 * MOST) as usize]
    }

    /// How many points the exemplar has for the room of the sites.
    pub(crate) fn expected(&self, prepared: &Prepared<D>) -> f64 {
        let pattern = &prepared.pattern;
        let room = self.sites.iter().map(|s| s.weight).sum::<f64>() * self.plan.step.powi(pattern.repeats() as i32);
        room / pattern.measure() * pattern.points.len() as f64
    }
}
