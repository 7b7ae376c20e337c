//! Patch copy: the first layout of the output [Tu 2020 §4.3.2].
//!
//! Sites cover the domain like tiles, nearest to the seed site first. At each site every exemplar patch is tried that puts one of its
//! elements onto an element that is already there, so that the patch is in register with its surroundings. Its disagreement with them is
//! the share of unmatched elements on both sides: output elements that the patch would not have there, and patch elements missing in the
//! part that is already covered. The best patch fills what is still open.
//!
//! Sites that do not see one another are worked on at the same time; the result does not depend on how many threads do it.

use std::ops::ControlFlow;

use arabesque_core::{Frame, Request, Stage, Stream, Vector};
use rayon::prelude::*;

use crate::{
    border::Extent,
    exemplar::library::Library,
    layout::coverage::{Cell, Coverage},
    output::{canvas::Canvas, draft::Item},
    toolbox::{buckets::Buckets, numbered::Numbered},
};

/// What the layout tells while it works: the state, and the share that is done.
pub(crate) type Watch<'a, const D: usize> = &'a mut dyn FnMut(&[Item<D>], f64) -> ControlFlow<()>;

/// Amplitude of the random part of the cost: patches this close in cost are equally good.
const NOISE: f64 = 0.02;

/// Share of the closest distance of their classes that a new element keeps to what is there already.
const ROOM: f64 = 0.6;

/// Share of its own nearest-neighbour distance that it keeps as well where a neighbouring patch has already been.
const ROOM_COVERED: f64 = 0.75;

/// Cost of an element of which the exemplar does not tell whether it could be there: beyond its frame.
const UNSEEN: f64 = 0.35;

/// Cost of a patch whose centre lies at the frame of the exemplar, against one from its middle.
const RIM: f64 = 0.3;

/// Curve samples of one class that are tried at an anchor; of more, as many of the most similar ones.
const MEMBERS: usize = 80;

/// Candidates where there is nothing to register on.
const FREE_CANDIDATES: usize = 24;

/// Knobs of the layout.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GrowParams {
    /// Radius of a patch, exemplar units.
    pub(crate) patch: f64,
    /// Radius of the surroundings that a patch must agree with, exemplar units.
    pub(crate) context: f64,
    /// Cost of a patch that goes on copying where its neighbour stopped, per share of such elements.
    pub(crate) repeat: f64,
    /// Cost of a patch whose elements are used more often than others.
    pub(crate) balance: f64,
    /// Output elements that patches are registered on, for each site.
    pub(crate) anchors: usize,
    /// First curve sample, see [`crate::exemplar::level::Level::base`].
    pub(crate) base: u32,
}

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
    library: &'a Library<D>,
    request: &'a Request<D>,
    extent: &'a Extent<'a, D>,
    params: GrowParams,
    /// Times each exemplar element was used.
    usage: Numbered<u32>,
}

impl<'a, const D: usize> Grower<'a, D> {
    pub(crate) fn new(
        library: &'a Library<D>,
        request: &'a Request<D>,
        extent: &'a Extent<'a, D>,
        params: GrowParams,
    ) -> Self {
        Self { library, request, extent, params, usage: Numbered::filled(0, library.len()) }
    }

    /// Fills every open cell of `coverage` with elements on `canvas`.
    /// Tells `watch` after each round, and stops when it says so.
    pub(crate) fn fill(
        &mut self,
        canvas: &mut Canvas<D>,
        coverage: &mut Coverage<D>,
        watch: Watch<'_, D>,
    ) -> ControlFlow<()> {
        let start = self.start(canvas);
        let kept: Vec<_> = canvas.items.iter().filter(|item| item.frozen.is_some()).map(|item| item.position).collect();
        let rounds = self.rounds(coverage, start, &kept);
        let all = rounds.iter().map(Vec::len).sum::<usize>().max(1) as f64;
        let mut done = 0;
        for (round, sites) in rounds.into_iter().enumerate() {
            let patches: Vec<_> = sites
                .par_iter()
                .enumerate()
                .map(|(n, &site)| {
                    let item = ((round as u64) << 32) | n as u64;
                    self.best_patch(
                        site,
                        canvas,
                        coverage,
                        &mut Stream::new(self.request.seed, Stage::Initialise, item),
                    )
                })
                .collect();
            patches.into_iter().flatten().for_each(|patch| self.paste(&patch, canvas, coverage));
            done += sites.len();
            watch(&canvas.items, done as f64 / all)?;
        }
        ControlFlow::Continue(())
    }

    /// Where the layout begins: at what is there already, else in the middle.
    fn start(&self, canvas: &Canvas<D>) -> Vector<D> {
        canvas.items.first().map_or_else(|| self.request.domain.bounds().centre(), |item| item.position)
    }

    /// Sites in rounds: those of one round are too far apart to see one another.
    fn rounds(&self, coverage: &Coverage<D>, start: Vector<D>, kept: &[Vector<D>]) -> Vec<Vec<Vector<D>>> {
        let patch = self.params.patch * self.smallest_scale();
        let mut sites = Numbered::from(site_order(coverage, start, patch));
        if !kept.is_empty() {
            // Ring by ring around what is kept, so that a gap in it closes from all sides.
            let far = |site: &Vector<D>| {
                let squares = kept.iter().map(|p| self.request.domain.offset(*site, *p).norm2());
                (squares.fold(f64::INFINITY, f64::min).sqrt() / patch) as u32
            };
            sites.sort_by_cached_key(far);
        }
        let reach = (self.params.patch + self.params.context) * self.largest_scale();
        let mut earlier = Buckets::new(&self.request.domain, self.extent.margin, reach);
        let mut round_of: Numbered<usize> = Numbered::new();
        let mut rounds: Vec<Vec<Vector<D>>> = Vec::new();
        for (i, &site) in sites.iter().enumerate() {
            let mut round = 0;
            earlier.near(site, reach, |j| {
                if self.request.domain.offset(site, sites[j]).norm() <= reach {
                    round = round.max(round_of[j] + 1);
                }
            });
            earlier.insert(i as u32, site);
            round_of.push(round);
            if rounds.len() == round {
                rounds.push(Vec::new());
            }
            rounds[round].push(site);
        }
        rounds
    }

    fn smallest_scale(&self) -> f64 {
        self.extent.smallest_spacing_scale
    }

    fn largest_scale(&self) -> f64 {
        self.extent.largest_spacing_scale
    }

    fn best_patch(
        &self,
        site: Vector<D>,
        canvas: &Canvas<D>,
        coverage: &Coverage<D>,
        random: &mut Stream,
    ) -> Option<Patch<D>> {
        let frame = self.request.fields.frame(site);
        let (open, _) = coverage.open_within(site, self.params.patch * frame.spacing_scale);
        if open == 0 {
            return None;
        }
        let view = View::new(self, site, frame, canvas, coverage);
        let candidates: Vec<_> =
            view.candidates(self.params.anchors, random).into_iter().map(|c| (c, NOISE * random.unit())).collect();
        // Also in parallel within a site: at seams and in holes there are few sites at a time.
        let costs: Vec<f64> = candidates.par_iter().with_min_len(16).map(|(c, noise)| view.cost(*c) + noise).collect();
        let best = (0..costs.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b]))?;
        let centre = candidates[best].0;
        let centre = view.registered(centre);
        Some(Patch { site, centre, elements: view.additions(centre) })
    }

    fn paste(&mut self, patch: &Patch<D>, canvas: &mut Canvas<D>, coverage: &mut Coverage<D>) {
        let frame = self.request.fields.frame(patch.site);
        for &(element, position) in &patch.elements {
            canvas.push(Item { source: element, position, frozen: None });
            self.usage[element] += 1;
        }
        let radius = self.params.patch * frame.spacing_scale;
        let view = self.library.view;
        coverage.cover(patch.site, radius, |offset| view.contains(patch.centre + frame.to_exemplar(offset)));
        // The cell of the site itself is always done, so that a patch from the rim of the exemplar makes progress too.
        coverage.cover(patch.site, 0.3 * radius, |_| true);
    }
}

/// Sites for patches of `radius`: a grid over the open cells, from `start` outwards.
fn site_order<const D: usize>(coverage: &Coverage<D>, start: Vector<D>, radius: f64) -> Vec<Vector<D>> {
    // Balls of this radius on a square or cubic grid of this step leave no gap.
    let step = 2.0 * radius / (D as f64).sqrt() * 0.95;
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

/// What is around one site.
struct View<'a, const D: usize> {
    grower: &'a Grower<'a, D>,
    site: Vector<D>,
    frame: Frame<D>,
    coverage: &'a Coverage<D>,
    /// Elements around: source, offset from the site in exemplar directions, weight; nearest first.
    around: Vec<(u32, Vector<D>, f64)>,
}

impl<'a, const D: usize> View<'a, D> {
    fn new(
        grower: &'a Grower<'a, D>,
        site: Vector<D>,
        frame: Frame<D>,
        canvas: &Canvas<D>,
        coverage: &'a Coverage<D>,
    ) -> Self {
        let context = grower.params.context;
        let mut around = Vec::new();
        canvas.within(site, context * frame.spacing_scale, |i, offset| {
            let offset = frame.to_exemplar(offset);
            around.push((canvas.items[i].source, offset, fall_off(offset, context)));
        });
        around.sort_by(|a, b| a.1.norm2().total_cmp(&b.1.norm2()));
        Self { grower, site, frame, coverage, around }
    }

    /// Exemplar points that could land on the site.
    fn candidates(&self, anchors: usize, random: &mut Stream) -> Vec<Vector<D>> {
        let library = self.grower.library;
        let base = self.grower.params.base;
        let mut centres = Vec::new();
        for (source, offset) in self.anchors(anchors) {
            let members = library.members(library.class[source]);
            let usable = |i: &u32| library.view.contains(library.centre[*i] - offset);
            if source < base || members.len() <= MEMBERS {
                centres.extend(members.iter().filter(|i| usable(i)).map(|&i| library.centre[i] - offset));
            } else {
                let usable = members.iter().copied().filter(usable).collect();
                let alike = self.most_alike(usable, source, random);
                centres.extend(alike.into_iter().map(|i| library.centre[i] - offset));
            }
        }
        let wanted = if anchors == 0 { 1 } else { FREE_CANDIDATES };
        while centres.len() < wanted {
            centres.push(library.any_place(random));
        }
        centres
    }

    /// What the patches are registered on: the nearest elements; for strokes also the nearest of the rarest kind, which tell most.
    fn anchors(&self, count: usize) -> Vec<(u32, Vector<D>)> {
        let library = self.grower.library;
        let nearest = self.around.iter().take(count);
        let mut anchors: Vec<_> = nearest.map(|&(source, offset, _)| (source, offset)).collect();
        let strokes = self.around.iter().filter(|(source, ..)| *source >= self.grower.params.base);
        let size = |source: u32| library.members(library.class[source]).len();
        if let (Some(rarest), true) = (strokes.min_by_key(|(source, ..)| size(*source)), count > 0) {
            anchors.push((rarest.0, rarest.1));
        }
        anchors
    }

    /// Of very many elements, some of those that are most like `source`.
    fn most_alike(&self, mut members: Vec<u32>, source: u32, random: &mut Stream) -> Vec<u32> {
        let feature = &self.grower.library.feature;
        members.sort_by_cached_key(|&i| feature[i].distance2(&feature[source]).to_bits());
        members.truncate((members.len() / 4).max(MEMBERS));
        while members.len() > MEMBERS {
            members.swap_remove(random.below(members.len()));
        }
        members
    }

    /// Disagreement of the patch around exemplar point `centre` with what is there.
    fn cost(&self, centre: Vector<D>) -> f64 {
        let (library, params) = (self.grower.library, self.grower.params);
        let mut taken: Vec<u32> = Vec::with_capacity(self.around.len());
        let (mut cost, mut weights, mut repeated) = (0.0, 1e-9, 0.0);
        for &(source, offset, weight) in &self.around {
            weights += weight;
            let p = centre + offset;
            if !library.view.contains(p) {
                cost += UNSEEN * weight;
                continue;
            }
            let class = library.class[source];
            let alike = library.alike(class, p, &library.feature[source]);
            match alike.into_iter().flatten().find(|(i, _)| !taken.contains(i)) {
                Some((i, c)) => {
                    taken.push(i);
                    cost += weight * f64::from(c) / library.outlier[class].powi(2);
                    repeated += weight * f64::from(u8::from(i == source));
                }
                None => cost += weight,
            }
        }
        let (missing, missing_weights, usage) = self.missing(centre, &taken);
        let total = weights + missing_weights;
        let known = library.view.signed_distance(centre).min(params.patch) / params.patch;
        (cost + missing) / total + params.repeat * repeated / weights + params.balance * usage + RIM * (1.0 - known)
    }

    /// Weight of the patch elements that should be there already and are not, weight of all that should, and mean relative use of the new ones.
    fn missing(&self, centre: Vector<D>, taken: &[u32]) -> (f64, f64, f64) {
        let (library, params) = (self.grower.library, self.grower.params);
        let (mut missing, mut weights) = (0.0, 0.0);
        let (mut used, mut fresh) = (0.0, 0.0);
        library.within(centre, params.context, |i, offset| {
            if taken.contains(&i) {
                return;
            }
            let weight = fall_off(offset, params.context);
            match self.coverage.at(self.site + self.frame.to_output(offset)) {
                Cell::Covered => {
                    missing += weight;
                    weights += weight;
                }
                Cell::Open => {
                    used += f64::from(self.grower.usage[i]);
                    fresh += 1.0;
                }
                Cell::Outside => {}
            }
        });
        let mean = self.grower.usage.iter().map(|&u| f64::from(u)).sum::<f64>() / library.len() as f64;
        let usage = if fresh > 0.0 { (used / fresh) / (mean + 1.0) } else { 0.0 };
        (missing, weights, usage)
    }

    /// `centre` moved so that matched elements coincide as well as they can.
    fn registered(&self, centre: Vector<D>) -> Vector<D> {
        let library = self.grower.library;
        let (mut shift, mut weights) = (Vector::ZERO, 1e-9);
        for &(source, offset, weight) in &self.around {
            let class = library.class[source];
            if let Some((i, _)) = library.alike(class, centre + offset, &library.feature[source])[0] {
                shift += (library.centre[i] - centre - offset) * weight;
                weights += weight;
            }
        }
        centre + shift * (1.0 / weights)
    }

    /// Patch elements for the open part, with their places.
    fn additions(&self, centre: Vector<D>) -> Vec<(u32, Vector<D>)> {
        let (library, params) = (self.grower.library, self.grower.params);
        let mut taken = Vec::new();
        for &(source, offset, _) in &self.around {
            let class = library.class[source];
            let alike = library.alike(class, centre + offset, &library.feature[source]);
            taken.extend(alike.into_iter().flatten().map(|(i, _)| i).find(|i| !taken.contains(i)));
        }
        let mut found = Vec::new();
        library.within(centre, params.patch, |i, offset| {
            let p = self.site + self.frame.to_output(offset);
            let wanted = library.copyable[i] && !taken.contains(&i);
            if wanted && self.has_room(i, p, offset) && self.grower.extent.admits(i, p) {
                found.push((i, p));
            }
        });
        found.sort_by_key(|&(i, _)| i);
        found
    }
}

impl<const D: usize> View<'_, D> {
    /// Whether exemplar element `i` belongs to the open part at `p`: into an open cell unless it would sit on something, and into a
    /// covered cell at the seam, where registration may have moved it across, only if there is a gap of its own size.
    fn has_room(&self, i: u32, p: Vector<D>, offset: Vector<D>) -> bool {
        let library = self.grower.library;
        let class = library.class[i];
        let clear = |&(source, o, _): &(u32, Vector<D>, f64)| {
            (o - offset).norm() >= ROOM * library.closest(class, library.class[source])
        };
        if !self.around.iter().all(clear) {
            return false;
        }
        match self.coverage.at(p) {
            Cell::Open => true,
            Cell::Covered => {
                let own = library.nearest[i];
                let gap =
                    self.around.iter().map(|(_, o, _)| (*o - offset).norm2()).fold(f64::INFINITY, f64::min).sqrt();
                let reach = 0.5 * own * self.frame.spacing_scale;
                gap >= ROOM_COVERED * own && self.coverage.open_within(p, reach).0 > 0
            }
            Cell::Outside => false,
        }
    }
}

/// Weight of an element at `offset` in surroundings of `radius`: 1 in the middle, 0.1 at the rim.
fn fall_off<const D: usize>(offset: Vector<D>, radius: f64) -> f64 {
    let x = (offset.norm2() / (radius * radius)).min(1.0);
    0.1 + 0.9 * (1.0 - x) * (1.0 - x)
}
