//! From one level to the next: the strokes of the coarser one, sampled more densely [Tu 2020 §4.3.5].

use arabesque_core::{Matrix, Meter, Numbered, Result, Vector};

use crate::{
    curves::draw::{chains::Chain, shape},
    exemplar::graph::net::{Net, Piece},
    output::{
        draft::{Draft, Frozen, Item},
        state::State,
    },
};

/// Nanoseconds for a new sample.
const SAMPLE: u64 = 3000;

/// Nanoseconds for a kept sample that an old one is compared with.
const KEPT: u64 = 4;

/// The elements of `state` and samples along `chains` at the spacing of the `finer` net, whose first pseudo element is
/// `base`.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn resample<const D: usize>(
    state: &State<'_, D>,
    chains: &[Chain],
    finer: &Net<D>,
    base: u32,
    frozen: Draft<D>,
) -> Result<Draft<D>> {
    let budget = state.budget.stage("sampling strokes anew");
    let mut meter = budget.meter();
    let strokes = frozen.items.iter().enumerate().filter(|(_, (item, _))| item.frozen == Some(Frozen::Stroke));
    let drawn = strokes.map(|(n, (item, _))| (n as u32, item.position)).collect();
    let draft = with_elements(state, frozen);
    let mut made = Resampled { state, finer, base, draft, drawn, known: Numbered::filled(None, state.samples().len()) };
    if let Some(net) = &state.level.net {
        chains.iter().try_for_each(|chain| made.follow(net, chain, &mut meter))?;
    }
    Ok(made.draft)
}

/// What is frozen, and the other items that are no curve samples.
fn with_elements<const D: usize>(state: &State<'_, D>, mut frozen: Draft<D>) -> Draft<D> {
    let free = state.items().iter().filter(|i| i.alive && i.item.source < state.level.base && i.item.frozen.is_none());
    frozen.items.extend(free.map(|i| (i.item, i.turn)));
    frozen
}

struct Resampled<'a, const D: usize> {
    state: &'a State<'a, D>,
    finer: &'a Net<D>,
    base: u32,
    draft: Draft<D>,
    /// Items of frozen strokes, with their places.
    drawn: Vec<(u32, Vector<D>)>,
    /// New item of each old sample that is kept.
    known: Numbered<Option<u32>>,
}

impl<const D: usize> Resampled<'_, D> {
    fn follow(&mut self, net: &Net<D>, chain: &Chain, meter: &mut Meter<'_>) -> Result<()> {
        meter.spend(chain.samples.len() as u64 * (SAMPLE + KEPT * self.drawn.len() as u64))?;
        let n = chain.samples.len();
        let count = chain.pieces.len();
        let mut keys: Vec<usize> = (0..n).filter(|&k| self.is_key(net, chain, k)).collect();
        if keys.is_empty() {
            keys.push(0);
        }
        let stretches: Vec<(usize, usize)> = if chain.is_closed {
            let around = keys.first().map(|k| k + count);
            let ends: Vec<usize> = keys.iter().copied().chain(around).collect();
            ends.windows(2).map(|w| (w[0], w[1])).collect()
        } else {
            keys.windows(2).map(|w| (w[0], w[1])).collect()
        };
        for (from, to) in stretches {
            self.stretch(net, chain, from..to, meter)?;
        }
        Ok(())
    }

    /// Whether a sample of the chain is kept as it is: ends, junctions and knots of the exemplar.
    fn is_key(&self, net: &Net<D>, chain: &Chain, k: usize) -> bool {
        let s = chain.samples[k];
        let is_end = !chain.is_closed && (k == 0 || k + 1 == chain.samples.len());
        let is_knot = self.state.node(s).is_some_and(|e| net.nodes[e].knot.is_some());
        is_end || self.state.degree(s) != 2 || is_knot
    }

    /// Samples the edges `range` of a chain evenly.
    fn stretch(
        &mut self,
        net: &Net<D>,
        chain: &Chain,
        range: std::ops::Range<usize>,
        meter: &mut Meter<'_>,
    ) -> Result<()> {
        let at = |k: usize| chain.samples[k % chain.samples.len()];
        let lengths: Vec<f64> = range.clone().map(|k| self.state.offset(at(k), at(k + 1)).norm()).collect();
        let total: f64 = lengths.iter().sum();
        let (first, last) = (at(range.start), at(range.end));
        let scale = self.state.request.fields.frame(self.state.sample(first).position).spacing_scale;
        let least = if first == last { 3 } else { 1 };
        let n = ((total / (self.finer.spacing * scale)).round() as usize).max(least);
        let mut previous = self.key(net, first);
        let (mut edge, mut before) = (0, 0.0);
        for k in 1..n {
            meter.spend(SAMPLE)?;
            let wanted = total * k as f64 / n as f64;
            while edge + 1 < lengths.len() && before + lengths[edge] < wanted {
                before += lengths[edge];
                edge += 1;
            }
            let share = ((wanted - before) / lengths[edge].max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            let number = range.start + edge;
            let item =
                self.between(net, [at(number), at(number + 1)], chain.pieces[number % chain.pieces.len()], share);
            let Some(item) = item else { continue };
            let next = self.draft.items.len() as u32;
            self.draft.items.push((item, Matrix::identity()));
            self.draft.links.push((previous, next));
            previous = next;
        }
        let end = self.key(net, last);
        self.draft.links.push((previous, end));
        Ok(())
    }

    /// The new item of an old sample.
    fn key(&mut self, net: &Net<D>, s: u32) -> u32 {
        if let Some(known) = self.known[s] {
            return known;
        }
        let number = self.frozen(s).unwrap_or_else(|| {
            let node = self.state.node(s).and_then(|e| self.same(net, e)).unwrap_or(0);
            let position = self.state.sample(s).position;
            self.draft.items.push((Item { source: self.base + node, position, frozen: None }, Matrix::identity()));
            self.draft.items.len() as u32 - 1
        });
        self.known[s] = Some(number);
        number
    }

    /// The new item of a frozen sample: the nearest one of the frozen strokes.
    fn frozen(&self, s: u32) -> Option<u32> {
        let p = self.state.sample(s).position;
        let nearest = self.drawn.iter().filter(|_| self.state.is_frozen(s));
        nearest.min_by(|a, b| (a.1 - p).norm2().total_cmp(&(b.1 - p).norm2())).map(|d| d.0)
    }

    /// The node of the finer net where the given one of the coarser net is.
    fn same(&self, net: &Net<D>, node: u32) -> Option<u32> {
        if (node as usize) < net.skeleton.knots.len() {
            return Some(node);
        }
        let arm = net.nodes[node].arms.first()?;
        self.nearest(arm.piece.line, arm.piece.from)
    }

    fn nearest(&self, line: u32, arc: f64) -> Option<u32> {
        let measured = &self.finer.skeleton.lines[line].measured;
        self.finer.nearest(line, measured.wrap(arc), measured.length(), measured.is_closed())
    }

    /// A new item at a share of the way along an edge.
    fn between(&self, net: &Net<D>, [a, b]: [u32; 2], piece: Option<Piece>, share: f64) -> Option<Item<D>> {
        let start = self.state.sample(a).position;
        let end = start + self.state.offset(a, b);
        let Some(piece) = piece else {
            let node = self.state.node(a).and_then(|e| self.same(net, e))?;
            return Some(Item { source: self.base + node, position: start + (end - start) * share, frozen: None });
        };
        let source = self.nearest(piece.line, piece.from + (piece.to - piece.from) * share)?;
        let part = shape::bent(self.state, net, piece, [true; 2], [start, end]);
        let path = arabesque_core::Path { cubics: part, closed: false };
        let measured = arabesque_core::Measured::new(path, 0.05 * net.spacing);
        let position: Vector<D> = measured.point(share * measured.length());
        Some(Item { source: self.base + source, position, frozen: None })
    }
}
