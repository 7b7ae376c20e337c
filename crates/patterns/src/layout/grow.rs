//! Patch copy: the first layout of the output [Tu 2020 §4.3.2].
//!
//! Sites cover the domain like tiles, nearest to the seed site first. At each site every exemplar patch is tried that
//! puts one of its elements onto an element that is already there, so that the patch is in register with its
//! surroundings. Its disagreement with them is the share of unmatched elements on both sides: output elements that the
//! patch would not have there, and patch elements missing in the part that is already covered. The best patch fills
//! what is still open.
//!
//! Sites that do not see one another are worked on at the same time; the result does not depend on how many threads do
//! it.

use arabesque_core::{Buckets, Budget, Meter, Numbered, Request, Result, Stream, Vector};
use rayon::prelude::*;

use crate::{
    border::Extent,
    exemplar::library::Library,
    layout::{
        coverage::{Cell, Coverage},
        patch_site::{GrowParams, Levels, PatchSite, PatchSource, SLACK},
    },
    output::{canvas::Canvas, draft::Item},
    streams,
};

/// What the layout tells while it works: the state, and the share that is done. An error ends it.
pub(crate) type Watch<'a, const D: usize> = &'a mut dyn FnMut(&[Item<D>], f64) -> Result<()>;

/// Nanoseconds to find the distance of two places.
const DISTANCE: u64 = 6;

/// Amplitude of the random part of the cost: patches this close in cost are equally good.
const NOISE: f64 = 0.02;

/// Height of the lowest sites over the ground, as a share of the distance between sites.
const LOWEST: f64 = 0.5;

/// Candidates that are priced at a time, at first and then.
const FIRST_GROUP: usize = 8;
const GROUP: usize = 32;

/// Candidates that one thread rates, and prices, by itself.
const ALONE: (usize, usize) = (64, 16);

/// A patch that was chosen for a site.
#[derive(Clone, Debug)]
struct Patch<const D: usize> {
    site: Vector<D>,
    /// Exemplar point that lands on the site.
    centre: Vector<D>,
    /// Elements to add, with their places.
    elements: Vec<(u32, Vector<D>)>,
}

/// Lays out the open part of `canvas`.
pub(crate) struct Grower<'a, const D: usize> {
    request: &'a Request<D>,
    budget: Budget,
    source: PatchSource<'a, D>,
}

impl<'a, const D: usize> Grower<'a, D> {
    pub(crate) fn new(
        library: &'a Library<D>,
        request: &'a Request<D>,
        extent: &'a Extent<'a, D>,
        params: GrowParams,
    ) -> Self {
        let levels = Levels::new(extent.exemplar(), request, (params.patch, library.spacing));
        let usage = Numbered::filled(0, library.len());
        Self {
            request,
            budget: request.budget.stage("laying out"),
            source: PatchSource { library, extent, params, usage, used: 0, levels },
        }
    }

    /// Fills every open cell of `coverage` with elements on `canvas`.
    /// Tells `watch` after each round.
    ///
    /// # Errors
    /// What the watch gives, and when the budget is used up or somebody asks to stop; then the canvas holds what was laid
    /// out before the round that was cut short.
    pub(crate) fn fill(
        &mut self,
        canvas: &mut Canvas<D>,
        coverage: &mut Coverage<D>,
        watch: Watch<'_, D>,
    ) -> Result<()> {
        let start = self.start(canvas);
        let kept: Vec<_> = canvas.items.iter().filter(|item| item.frozen.is_some()).map(|item| item.position).collect();
        let rounds = self.rounds(coverage, start, &kept)?;
        let all = rounds.iter().map(Vec::len).sum::<usize>().max(1) as f64;
        let mut done = 0;
        for (round, sites) in rounds.into_iter().enumerate() {
            let stream = |n: u64| Stream::new(self.request.seed, streams::INITIALISE, ((round as u64) << 32) | n);
            let mut patches: Vec<_> = sites
                .par_iter()
                .enumerate()
                .map(|(n, &site)| self.best_patch(site, canvas, coverage, &mut stream(n as u64)))
                .collect::<Result<_>>()?;
            let is_empty = canvas.items.is_empty() && patches.iter().flatten().all(|patch| patch.elements.is_empty());
            // Emptiness goes well with emptiness: a page that begins with nothing may stay so.
            if let (0, true, Some((&site, patch))) = (round, is_empty, sites.iter().zip(&mut patches).next()) {
                *patch = self.patch_with_something(site, canvas, coverage, &mut stream(0))?;
            }
            // What the last of them paid is heard here.
            self.budget.spend(0)?;
            patches.into_iter().flatten().try_for_each(|patch| self.paste(&patch, canvas, coverage))?;
            done += sites.len();
            watch(&canvas.items, done as f64 / all)?;
        }
        Ok(())
    }

    /// Where the layout begins: at what is there already, else in the middle, of a heap as near to the ground as sites are to one another.
    fn start(&self, canvas: &Canvas<D>) -> Vector<D> {
        let middle = self.request.domain.bounds().centre();
        let middle = match (&self.source.levels, &self.request.ground) {
            (Some(_), Some(ground)) => {
                let step = site_step::<D>(self.source.params.patch * self.smallest_scale());
                let low = ground.at_height(middle, LOWEST * step);
                if self.request.domain.contains(low) { low } else { middle }
            }
            _ => middle,
        };
        canvas.items.first().map_or(middle, |item| item.position)
    }

    /// Sites in rounds: those of one round are too far apart to see one another.
    fn rounds(&self, coverage: &Coverage<D>, start: Vector<D>, kept: &[Vector<D>]) -> Result<Vec<Vec<Vector<D>>>> {
        let mut meter = self.budget.meter();
        let patch = self.source.params.patch * self.smallest_scale();
        let mut sites = Numbered::from(site_order(coverage, start, patch));
        if !kept.is_empty() {
            // Ring by ring around what is frozen, so that a gap in it closes from all sides.
            let far = |site: &Vector<D>| {
                let squares = kept.iter().map(|p| self.request.domain.offset(*site, *p).norm2());
                (squares.fold(f64::INFINITY, f64::min).sqrt() / patch) as u32
            };
            let mut rings = Vec::with_capacity(sites.len());
            for site in &sites {
                meter.spend(DISTANCE * kept.len() as u64)?;
                rings.push((far(site), *site));
            }
            rings.sort_by_key(|r| r.0);
            sites = rings.into_iter().map(|r| r.1).collect();
        }
        let reach = (self.source.params.patch + self.source.params.context) * self.largest_scale();
        let mut earlier = Buckets::new(&self.request.domain, self.source.extent.margin, reach);
        let mut round_of: Numbered<usize> = Numbered::new();
        let mut rounds: Vec<Vec<Vector<D>>> = Vec::new();
        for (i, &site) in sites.iter().enumerate() {
            let mut round = 0;
            let looked = earlier.near(site, reach, |j| {
                if self.request.domain.offset(site, sites[j]).norm() <= reach {
                    round = round.max(round_of[j] + 1);
                }
            });
            meter.spend(DISTANCE * looked)?;
            earlier.insert(i as u32, site);
            round_of.push(round);
            if rounds.len() == round {
                rounds.push(Vec::new());
            }
            rounds[round].push(site);
        }
        Ok(rounds)
    }

    fn smallest_scale(&self) -> f64 {
        self.source.extent.smallest_spacing_scale
    }

    fn largest_scale(&self) -> f64 {
        self.source.extent.largest_spacing_scale
    }

    fn best_patch(
        &self,
        site: Vector<D>,
        canvas: &Canvas<D>,
        coverage: &Coverage<D>,
        random: &mut Stream,
    ) -> Result<Option<Patch<D>>> {
        let frame = self.request.fields.frame(site);
        let mut meter = self.budget.meter();
        if !coverage.is_open_within(site, self.source.params.patch * frame.spacing_scale, &mut meter)? {
            return Ok(None);
        }
        let here = self.here(site, canvas, coverage, &mut meter)?;
        let candidates: Vec<_> = here
            .candidates(self.source.params.anchors, random)
            .into_iter()
            .map(|c| (c, NOISE * random.unit()))
            .collect();
        let Some(centre) = self.cheapest(&here, &candidates)? else { return Ok(None) };
        let centre = here.registered(centre, &mut meter)?;
        Ok(Some(Patch { site, centre, elements: here.additions(centre, &mut meter)? }))
    }

    /// A patch around an element, for a page that is empty.
    fn patch_with_something(
        &self,
        site: Vector<D>,
        canvas: &Canvas<D>,
        coverage: &Coverage<D>,
        random: &mut Stream,
    ) -> Result<Option<Patch<D>>> {
        let library = self.source.library;
        let usable: Vec<u32> = (0..library.len() as u32).filter(|&i| library.copyable[i]).collect();
        if usable.is_empty() {
            return Ok(None);
        }
        let mut meter = self.budget.meter();
        meter.spend(library.len() as u64)?;
        let centre = library.centre[usable[random.below(usable.len())]];
        let here = self.here(site, canvas, coverage, &mut meter)?;
        Ok(Some(Patch { site, centre, elements: here.additions(centre, &mut meter)? }))
    }

    /// A site with what is around it.
    fn here<'s>(
        &'s self,
        site: Vector<D>,
        canvas: &Canvas<D>,
        coverage: &'s Coverage<D>,
        meter: &mut Meter<'_>,
    ) -> Result<PatchSite<'s, D>> {
        let frame = self.request.fields.frame(site);
        let (here, looked) = PatchSite::new(&self.source, site, frame, canvas, coverage);
        meter.spend(DISTANCE * looked)?;
        Ok(here)
    }

    /// The first of the candidates that cost least, noise included. All are rated by the elements nearest to them, and then priced the
    /// most promising first, until none of the others can cost less.
    fn cheapest(&self, here: &PatchSite<'_, D>, candidates: &[(Vector<D>, f64)]) -> Result<Option<Vector<D>>> {
        // Also in parallel within a site: at seams and in holes there are few sites at a time.
        let least = |taken: &mut Vec<u32>, (k, (centre, noise)): (usize, &(Vector<D>, f64))| {
            Ok((here.bound(*centre, taken, &mut self.budget.meter())? + noise, k))
        };
        let rated = candidates.par_iter().enumerate().with_min_len(ALONE.0).map_init(Vec::new, least);
        let mut rated: Vec<(f64, usize)> = rated.collect::<Result<_>>()?;
        rated.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut best = (f64::INFINITY, None);
        let (mut first, mut group) = (0, FIRST_GROUP);
        while let Some(tried) = rated.get(first..).and_then(|rest| rest.get(..group.min(rest.len()))) {
            if tried.first().is_none_or(|(least, _)| *least > best.0 + SLACK) {
                break;
            }
            let cost = |taken: &mut Vec<u32>, (_, k): &(f64, usize)| {
                let (centre, noise) = candidates[*k];
                Ok((here.cost(centre, best.0 - noise, taken, &mut self.budget.meter())? + noise, *k))
            };
            let costs = tried.par_iter().with_min_len(ALONE.1).map_init(Vec::new, cost);
            for (cost, k) in costs.collect::<Result<Vec<_>>>()? {
                if best.1.is_none_or(|known| (cost, k) < (best.0, known)) {
                    best = (cost, Some(k));
                }
            }
            (first, group) = (first + tried.len(), GROUP);
        }
        Ok(best.1.map(|k| candidates[k].0))
    }

    fn paste(&mut self, patch: &Patch<D>, canvas: &mut Canvas<D>, coverage: &mut Coverage<D>) -> Result<()> {
        let budget = self.budget.clone();
        let mut meter = budget.meter();
        let frame = self.request.fields.frame(patch.site);
        for &(element, position) in &patch.elements {
            canvas.push(Item { source: element, position, frozen: None });
            self.source.usage[element] += 1;
            self.source.used += 1;
        }
        let radius = self.source.params.patch * frame.spacing_scale;
        let view = self.source.library.view;
        let is_known = |offset| view.contains(patch.centre + frame.to_exemplar(offset));
        coverage.cover(patch.site, radius, is_known, &mut meter)?;
        // The cell of the site itself is always done, so that a patch from the rim of the exemplar makes progress too.
        coverage.cover(patch.site, 0.3 * radius, |_| true, &mut meter)
    }
}

/// Balls of this radius on a square or cubic grid of this step leave no gap.
fn site_step<const D: usize>(radius: f64) -> f64 {
    2.0 * radius / (D as f64).sqrt() * 0.95
}

/// Sites for patches of `radius`: a grid over the open cells, from `start` outwards.
fn site_order<const D: usize>(coverage: &Coverage<D>, start: Vector<D>, radius: f64) -> Vec<Vector<D>> {
    let step = site_step::<D>(radius);
    let mut open: Vec<Vector<D>> = coverage.open().map(|c| coverage.centre(c)).collect();
    if open.is_empty() {
        return open;
    }
    let origin = start;
    let key = |p: &Vector<D>| -> [i64; D] { std::array::from_fn(|k| ((p[k] - origin[k]) / step).round() as i64) };
    open.sort_by_cached_key(key);
    open.dedup_by_key(|p| key(p));
    // The node of the grid, unless it lies outside: then the open cell that stands for it.
    let mut sites: Vec<Vector<D>> = open
        .into_iter()
        .map(|p| {
            let node = Vector(std::array::from_fn(|k| origin[k] + key(&p)[k] as f64 * step));
            if coverage.at(node) == Cell::Outside { p } else { node }
        })
        .collect();
    sites.sort_by(|a, b| (*a - start).norm2().total_cmp(&(*b - start).norm2()));
    sites
}
