//! The output while it is optimised: items, their samples, and what each sample was matched with.

use std::sync::Arc;

use arabesque_core::{Budget, Domain, GridIndex, Held, Matrix, Numbered, Request, Result, Similarity, Vector};

use crate::{
    border::Extent,
    exemplar::{graph::net::Star, level::Level, level_exemplar::LevelExemplar, library::Library, samples::pose_of},
    output::draft::{Draft, Item},
    params::Deform,
};

/// Bytes for a neighbour of a sample: in its match, and while positions are assigned.
const NEIGHBOUR: u64 = 90;

/// Neighbours among the samples that a look-up meets: a disc in the square around it.
const SHARE: f64 = 0.5;

/// What the search found for one output sample.
#[derive(Clone, Debug)]
pub(crate) struct Match {
    /// Exemplar sample with the most similar neighbourhood.
    pub(crate) input: u32,
    /// Cost of the pairing, squared exemplar units.
    pub(crate) cost: f32,
    /// Cost if every neighbour were an outlier: what `cost` is measured against.
    pub(crate) scale: f32,
    /// (output sample, exemplar sample) of the neighbours that found a partner.
    pub(crate) pairs: Vec<(u32, u32)>,
    /// Output samples of the neighbourhood, with or without partner.
    pub(crate) members: Vec<u32>,
    /// Exemplar samples that should be there and are not.
    pub(crate) missing: Vec<u32>,
    /// Whether it was matched with another one before, or with none.
    pub(crate) is_new: bool,
}

impl Match {
    /// Cost relative to a neighbourhood of outliers: 0 for a perfect copy, about 1 for no likeness.
    pub(crate) fn energy(&self) -> f64 {
        f64::from(self.cost / self.scale.max(f32::MIN_POSITIVE))
    }
}

/// One output sample.
#[derive(Clone, Debug)]
pub(crate) struct Sample<const D: usize> {
    /// Its item.
    pub(crate) item: u32,
    /// Which sample of its item it is.
    pub(crate) part: u32,
    /// See [`Level::key`].
    pub(crate) key: u32,
    pub(crate) position: Vector<D>,
    /// Position when its neighbours last took notice.
    pub(crate) announced: Vector<D>,
    /// Whether its neighbours must take notice.
    pub(crate) dirty: bool,
    pub(crate) matched: Option<Match>,
}

/// An output element while it is optimised.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LiveItem<const D: usize> {
    pub(crate) item: Item<D>,
    /// Rotation relative to its source, on top of the local frame.
    pub(crate) turn: Matrix<D>,
    pub(crate) alive: bool,
    /// Samples `first..first + count`.
    pub(crate) first: u32,
    pub(crate) count: u32,
}

/// The output at one level.
#[derive(Clone)]
pub(crate) struct State<'a, const D: usize> {
    pub(crate) library: &'a Library<D>,
    pub(crate) level: &'a Level<D>,
    pub(crate) request: &'a Request<D>,
    /// What the work on this state draws on: the account of the request, or a fresh one for what is drawn after it has
    /// ended.
    pub(crate) budget: Budget,
    pub(crate) extent: &'a Extent<'a, D>,
    /// Whether samples may leave the shape of their element.
    pub(crate) deform: Deform,
    items: Numbered<LiveItem<D>>,
    samples: Numbered<Sample<D>>,
    /// The samples that each curve sample is joined to; empty for samples of elements.
    links: Numbered<Vec<u32>>,
    /// Directions in which strokes leave each curve sample, unit vectors in output coordinates.
    tangents: Numbered<Vec<Vector<D>>>,
    /// Living samples, parallel to the points of `index`.
    living: Vec<u32>,
    index: GridIndex<D>,
    /// Memory of the neighbourhoods.
    held: Option<Arc<Held>>,
}

impl<'a, const D: usize> State<'a, D> {
    pub(crate) fn new(
        sampled: &'a LevelExemplar<D>,
        request: &'a Request<D>,
        extent: &'a Extent<'a, D>,
        deform: Deform,
        draft: &Draft<D>,
    ) -> Self {
        let mut state = Self {
            library: &sampled.library,
            level: &sampled.level,
            request,
            budget: request.budget.clone(),
            extent,
            deform,
            items: Numbered::new(),
            samples: Numbered::new(),
            links: Numbered::new(),
            tangents: Numbered::new(),
            living: Vec::new(),
            index: GridIndex::new(&[], 1.0, &request.domain),
            held: None,
        };
        draft.items.iter().for_each(|&(item, turn)| _ = state.push(item, turn));
        for &(a, b) in &draft.links {
            let [a, b] = [a, b].map(|i| state.items[i].first);
            if a != b && !state.are_linked(a, b) {
                state.link(a, b);
            }
        }
        state.reindex();
        state
    }

    /// Adds an item with its samples, and returns the number of its first sample; [`State::reindex`] makes it visible.
    pub(crate) fn push(&mut self, item: Item<D>, turn: Matrix<D>) -> u32 {
        let parts = &self.level.parts[item.source];
        let first_sample = self.level.first[item.source];
        let first = self.samples.len() as u32;
        let stays = item.frozen.is_some();
        let position = if stays { item.position } else { self.extent.grounded(item.source, item.position) };
        let item = Item { position: self.request.domain.wrap(position), ..item };
        let number = self.items.push(LiveItem { item, turn, alive: true, first, count: parts.len() as u32 });
        for part in 0..parts.len() as u32 {
            let position = self.part_position(number, part);
            self.samples.push(Sample {
                item: number,
                part,
                key: self.level.key[first_sample + part],
                position,
                announced: position,
                dirty: true,
                matched: None,
            });
            self.links.push(Vec::new());
            self.tangents.push(Vec::new());
        }
        first
    }

    /// From the source of item `i`, about its centre, to the output.
    pub(crate) fn pose(&self, i: u32) -> Similarity<D> {
        let live = self.item(i);
        let frame = self.request.fields.frame(live.item.position);
        let rotation = frame.rotation.compose(&live.turn);
        Similarity::about(Vector::ZERO, live.item.position, rotation, frame.element_scale)
    }

    fn part_position(&self, item: u32, part: u32) -> Vector<D> {
        let parts = &self.level.parts[self.items[item].item.source];
        self.pose(item).apply(parts[part as usize])
    }

    /// Makes the index fit the samples.
    pub(crate) fn reindex(&mut self) {
        self.living = self.samples.numbers().filter(|&s| self.is_alive(s)).collect();
        let points: Vec<_> = self.living.iter().map(|&s| self.samples[s].position).collect();
        let radius = self.level.radius * self.extent.largest_spacing_scale;
        self.index = GridIndex::new(&points, 0.5 * radius, &self.request.domain);
    }

    /// Number of living items.
    pub(crate) fn count(&self) -> usize {
        self.items.iter().filter(|i| i.alive).count()
    }

    /// Mean energy of the living samples that were matched.
    pub(crate) fn energy(&self) -> f64 {
        let matched = self.living.iter().filter_map(|&s| self.samples[s].matched.as_ref());
        let (n, sum) = matched.fold((0.0, 0.0), |(n, sum), m| (n + 1.0, sum + m.energy()));
        if n > 0.0 { sum / n } else { 0.0 }
    }

    /// The items.
    pub(crate) fn items(&self) -> &Numbered<LiveItem<D>> {
        &self.items
    }

    pub(crate) fn item(&self, i: u32) -> &LiveItem<D> {
        &self.items[i]
    }

    /// The item of a sample.
    pub(crate) fn item_of(&self, s: u32) -> &LiveItem<D> {
        &self.items[self.samples[s].item]
    }

    /// The samples, the dead ones included.
    pub(crate) fn samples(&self) -> &Numbered<Sample<D>> {
        &self.samples
    }

    #[inline]
    pub(crate) fn sample(&self, s: u32) -> &Sample<D> {
        &self.samples[s]
    }

    /// The living samples.
    pub(crate) fn living(&self) -> &[u32] {
        &self.living
    }

    /// Calls `visit(sample, offset)` for the living samples within `radius` of `p`. Returns how many were looked at.
    #[inline]
    pub(crate) fn within(&self, p: Vector<D>, radius: f64, mut visit: impl FnMut(u32, Vector<D>)) -> u64 {
        self.index.within(p, radius, |slot, offset| visit(self.living[slot], offset))
    }

    /// The same state, for work that draws on another account.
    pub(crate) fn on(&self, budget: Budget) -> Self {
        Self { budget, ..self.clone() }
    }

    /// Holds the memory that the neighbourhoods of the samples will take, once for each state.
    ///
    /// # Errors
    /// When there is not so much: then nothing was searched yet.
    pub(crate) fn hold_neighbourhoods(&mut self) -> Result<()> {
        if self.held.is_some() {
            return Ok(());
        }
        let load = |&s: &u32| {
            let position = self.samples[s].position;
            self.index.load(position, self.level.radius * self.request.fields.frame(position).spacing_scale)
        };
        let met: u64 = self.living.iter().map(load).sum();
        self.budget.spend(self.living.len() as u64 * 100)?;
        let bytes = (met as f64 * SHARE) as u64 * NEIGHBOUR;
        self.held = Some(Arc::new(self.budget.hold("neighbourhoods of the samples", bytes as usize)?));
        Ok(())
    }

    /// Removes the edges of samples that are no part of the output any more, after a step that was cut short.
    pub(crate) fn drop_dead_links(&mut self) {
        for s in self.samples.numbers() {
            if self.is_alive(s) {
                let mut links = std::mem::take(&mut self.links[s]);
                links.retain(|&o| self.is_alive(o));
                self.links[s] = links;
            } else {
                self.links[s].clear();
            }
        }
        self.reindex();
    }

    /// The samples that a sample is joined to.
    pub(crate) fn links_of(&self, s: u32) -> &[u32] {
        &self.links[s]
    }

    /// Number of edges of a sample.
    pub(crate) fn degree(&self, s: u32) -> usize {
        self.links[s].len()
    }

    pub(crate) fn are_linked(&self, a: u32, b: u32) -> bool {
        self.links[a].contains(&b)
    }

    /// Whether the user placed both ends of an edge, which then must stay as it is.
    pub(crate) fn is_frozen_edge(&self, a: u32, b: u32) -> bool {
        self.is_frozen(a) && self.is_frozen(b)
    }

    /// Directions in which strokes leave a sample, unit vectors in output coordinates.
    pub(crate) fn tangents_of(&self, s: u32) -> &[Vector<D>] {
        &self.tangents[s]
    }

    /// Replaces the tangents of all samples.
    pub(crate) fn set_tangents(&mut self, tangents: Vec<Vec<Vector<D>>>) {
        self.tangents = tangents.into();
    }

    /// Replaces what the search found for a sample.
    pub(crate) fn set_match(&mut self, s: u32, found: Match) {
        self.samples[s].matched = Some(found);
    }

    /// Makes a sample search again, whether anything around it moves or not.
    pub(crate) fn mark_dirty(&mut self, s: u32) {
        self.samples[s].dirty = true;
    }

    /// Everything has been taken notice of.
    pub(crate) fn clear_dirty(&mut self) {
        self.samples.iter_mut().for_each(|sample| sample.dirty = false);
    }

    /// Puts every sample elsewhere, whatever its item is about.
    pub(crate) fn set_positions(&mut self, position: Numbered<Vector<D>>) {
        self.samples.iter_mut().zip(position).for_each(|(sample, p)| sample.position = p);
    }

    /// Removes an item. The edges of its samples are left to the next assignment of edges.
    pub(crate) fn remove_item(&mut self, i: u32) {
        self.items[i].alive = false;
    }

    /// Moves every item to where its samples went, turned as a whole; frozen items stay.
    pub(crate) fn follow_samples(&mut self, position: &[Vector<D>]) {
        for i in self.items.numbers() {
            let live = self.items[i];
            if !live.alive || live.item.frozen.is_some() {
                continue;
            }
            let range = live.first as usize..(live.first + live.count) as usize;
            let parts = &self.level.parts[live.item.source];
            let frame = self.request.fields.frame(position[range.start]);
            let fallback = frame.rotation.compose(&live.turn);
            let keeps_angle = self.library.upright[live.item.source];
            let pose = pose_of(parts, &position[range.clone()], frame.element_scale, (fallback, keeps_angle));
            let centre = self.extent.grounded(live.item.source, pose.apply(Vector::ZERO));
            let centre = self.request.domain.wrap(centre);
            let item = &mut self.items[i];
            item.item.position = centre;
            item.turn = frame.rotation.transpose().compose(&pose.rotation);
            for s in range {
                self.samples[s].position = match self.deform {
                    Deform::Rigid => self.part_position(i, self.samples[s].part),
                    Deform::AsRigidAsPossible => position[s],
                };
            }
        }
    }

    /// Puts item `i` elsewhere, turned otherwise from the local frame there.
    pub(crate) fn place_item(&mut self, i: u32, position: Vector<D>, turn: Matrix<D>) {
        self.items[i].turn = turn;
        self.move_item(i, position);
    }

    /// Puts item `i` elsewhere, turned as it is from the local frame.
    pub(crate) fn move_item(&mut self, i: u32, position: Vector<D>) {
        let position = self.extent.grounded(self.items[i].item.source, position);
        self.items[i].item.position = self.request.domain.wrap(position);
        let live = self.items[i];
        for s in live.first..live.first + live.count {
            let p = self.part_position(i, self.samples[s].part);
            let sample = &mut self.samples[s];
            (sample.position, sample.dirty) = (p, true);
        }
    }

    /// Replaces the source of item `i`, which then lies as in the exemplar again.
    pub(crate) fn set_source(&mut self, i: u32, source: u32) {
        let live = &mut self.items[i];
        live.item.source = source;
        live.turn = Matrix::identity();
        let range = live.first..live.first + live.count;
        for s in range {
            let p = self.part_position(i, self.samples[s].part);
            let sample = &mut self.samples[s];
            (sample.position, sample.dirty) = (p, true);
        }
    }

    /// Marks the samples that moved more than `noticeable` since their neighbours last looked. Returns whether any did.
    pub(crate) fn announce_moves(&mut self, noticeable: f64) -> bool {
        let domain = &self.request.domain;
        let mut any = false;
        for sample in &mut self.samples {
            if domain.offset(sample.announced, sample.position).norm() > noticeable {
                sample.announced = sample.position;
                sample.dirty = true;
                any = true;
            }
        }
        any
    }

    /// Source of the item of a sample.
    pub(crate) fn source(&self, s: u32) -> u32 {
        self.item_of(s).item.source
    }

    /// The node of the net that a curve sample was copied from; `None` for a sample of an element.
    pub(crate) fn node(&self, s: u32) -> Option<u32> {
        self.source(s).checked_sub(self.level.base)
    }

    /// Whether a stroke may run from one sample to the other.
    pub(crate) fn share_style(&self, a: u32, b: u32) -> bool {
        match (&self.level.net, self.node(a), self.node(b)) {
            (Some(net), Some(a), Some(b)) => net.nodes[a].shares_style(&net.nodes[b]),
            _ => false,
        }
    }

    /// Whether the user placed the sample.
    pub(crate) fn is_frozen(&self, s: u32) -> bool {
        self.item_of(s).item.frozen.is_some()
    }

    /// Whether the sample is part of the output.
    pub(crate) fn is_alive(&self, s: u32) -> bool {
        self.item_of(s).alive
    }

    /// From one sample to another by the shortest way.
    pub(crate) fn offset(&self, from: u32, to: u32) -> Vector<D> {
        self.request.domain.offset(self.samples[from].position, self.samples[to].position)
    }

    /// Distance of two samples in exemplar units.
    pub(crate) fn reach(&self, a: u32, b: u32) -> f64 {
        self.offset(a, b).norm() / self.request.fields.frame(self.samples[a].position).spacing_scale
    }

    /// The edges of a sample in exemplar directions and units; none where edges take no part in the comparison.
    pub(crate) fn star(&self, s: u32) -> Star<D> {
        let links = &self.links[s];
        if links.is_empty() || self.level.stars[self.level.first[self.source(s)]].len() == 0 {
            return Star::EMPTY;
        }
        let frame = self.request.fields.frame(self.samples[s].position);
        Star::new(links.iter().map(|&o| frame.to_exemplar(self.offset(s, o))))
    }

    /// Width of the strokes of an exemplar curve.
    pub(crate) fn width(&self, curve: u32) -> f64 {
        let lines = self.level.net.as_ref().map_or(&[][..], |net| &net.skeleton.lines);
        lines.iter().find(|line| line.curve == curve).map_or(0.0, |line| line.width)
    }

    /// Removes the item of a sample, and its edges.
    pub(crate) fn kill(&mut self, s: u32) {
        let item = self.samples[s].item;
        self.items[item].alive = false;
        self.unlink_all(s);
    }

    /// Joins two samples by an edge.
    pub(crate) fn link(&mut self, a: u32, b: u32) {
        debug_assert!(a != b && !self.are_linked(a, b), "an edge joins two samples, once");
        self.links[a].push(b);
        self.links[b].push(a);
    }

    /// Removes the edge between two samples.
    pub(crate) fn unlink(&mut self, a: u32, b: u32) {
        self.links[a].retain(|&o| o != b);
        self.links[b].retain(|&o| o != a);
    }

    /// Replaces the edges of a sample, sorted; its neighbours are replaced by whoever calls. Returns whether they
    /// changed.
    pub(crate) fn replace_links(&mut self, s: u32, links: Vec<u32>) -> bool {
        let is_new = links != self.links[s];
        if is_new {
            self.samples[s].dirty = true;
            self.links[s] = links;
        }
        is_new
    }

    /// Removes the edges of a sample; its neighbours must take notice.
    fn unlink_all(&mut self, s: u32) {
        for o in std::mem::take(&mut self.links[s]) {
            self.links[o].retain(|&p| p != s);
            self.samples[o].dirty = true;
        }
    }

    /// The domain of the output.
    pub(crate) fn domain(&self) -> &Domain<D> {
        &self.request.domain
    }
}
