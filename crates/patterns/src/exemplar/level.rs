//! The exemplar at one level of the hierarchy: its samples and their neighbourhoods, flattened for the search.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use arabesque_core::{Budget, Domain, GridIndex, Held, Numbered, Result, Vector};

use crate::exemplar::{
    graph::net::{Net, Star},
    library::Library,
    samples::ElementSamples,
};

/// A neighbour of an exemplar sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near<const D: usize> {
    /// From the centre to the neighbour.
    pub(crate) offset: [f32; D],
    /// The neighbour.
    pub(crate) sample: u32,
    /// Its weight by distance; 0 beyond the radius: there only to be matched.
    pub(crate) weight: f32,
    /// Where its element stands among those that it is compared with.
    pub(crate) column: u32,
}

/// Price of an edge without a counterpart, in squared sampling distances. The paper has 1, which makes every sample
/// with an edge too few or too many an outlier; half of that lets it be matched and told to gain or lose the edge.
const SINGLE: f64 = 0.5;

/// Bytes of a sample besides its neighbours.
const SAMPLE: usize = 256;

/// Neighbours that are compared in one step.
const LANES: usize = 8;

/// Samples whose similar ones may be looked for at the same time.
const SEARCHED: usize = 64;

/// Most entries of the table of runs, and entries a sample that are always allowed.
const TABLE: (usize, usize) = (1 << 20, 16);

/// A run of neighbours with the same key.
#[derive(Clone, Copy, Debug)]
struct Run {
    key: u32,
    start: u32,
    end: u32,
}

/// How far neighbourhoods reach.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    /// Radius of those of the output.
    pub(crate) radius: f64,
    /// By how much those of the exemplar are larger, so that samples near the rim find a partner.
    pub(crate) slack: f64,
}

/// Exemplar samples at one level.
#[derive(Clone, Debug)]
pub(crate) struct Level<const D: usize> {
    /// Radius of an output neighbourhood, exemplar units.
    pub(crate) radius: f64,
    /// Offsets of the samples of each element from its centre.
    pub(crate) parts: Numbered<Vec<Vector<D>>>,
    /// Position of each sample.
    pub(crate) position: Numbered<Vector<D>>,
    /// Element of each sample.
    pub(crate) element: Numbered<u32>,
    /// Which sample of its element each one is.
    pub(crate) part: Numbered<u32>,
    /// First sample of each element.
    pub(crate) first: Numbered<u32>,
    /// (class, part) of each sample as one number: only equal keys match [Tu 2020 eq. 4].
    pub(crate) key: Numbered<u32>,
    /// Samples of each key.
    pub(crate) of_key: Numbered<Vec<u32>>,
    /// Squared outlier distance of each key.
    pub(crate) outlier2: Numbered<f32>,
    starts: Numbered<u32>,
    near: Vec<Near<D>>,
    /// The offsets of these once more, each coordinate by itself, so that several are compared in one step; and a few more, as many as
    /// are compared in one.
    across: [Vec<f32>; D],
    run_starts: Numbered<u32>,
    runs: Vec<Run>,
    /// Where the neighbours of each sample and key are, as numbers into those of the sample; empty where it would be too large.
    table: Vec<[u32; 2]>,
    /// Most similar samples of each sample, best first [Ma 2011 §4.2]; found when they are first asked for.
    alike: Numbered<OnceLock<Vec<u32>>>,
    /// Held while the similar samples of a sample are looked for, so that nobody else does the same work.
    searched: Arc<[Mutex<()>]>,
    held: Arc<Vec<Held>>,
    /// The sample graph of the curves, where there are any.
    pub(crate) net: Option<Arc<Net<D>>>,
    /// First pseudo element: those before it are true elements, each of the others is a node of the net.
    pub(crate) base: u32,
    /// Edge set of each sample; empty for samples of elements, and for all where edges take no part in the comparison.
    pub(crate) stars: Numbered<Star<D>>,
    /// Cost of an edge without a counterpart [Tu 2020 eq. 5].
    pub(crate) single2: f32,
}

impl<const D: usize> Level<D> {
    /// Samples the exemplar at `detail` (see [`ElementSamples::at_detail`]).
    ///
    /// # Errors
    /// When the budget is used up: with very many samples in each neighbourhood.
    pub(crate) fn new(
        library: &Library<D>,
        samples: &ElementSamples<D>,
        detail: f64,
        ball: Ball,
        budget: &Budget,
    ) -> Result<Self> {
        let mut level = Self::sampled(library, samples, detail, ball.radius, budget)?;
        level.flatten(library, ball.slack, budget)?;
        Ok(level)
    }

    fn sampled(
        library: &Library<D>,
        samples: &ElementSamples<D>,
        detail: f64,
        radius: f64,
        budget: &Budget,
    ) -> Result<Self> {
        let count = samples.count();
        let held = budget.hold("samples of the exemplar", count.saturating_mul(SAMPLE))?;
        budget.spend(count as u64 * SAMPLE as u64)?;
        let parts: Numbered<_> = (0..library.len()).map(|e| samples.at_detail(e, detail)).collect();
        let most = parts.iter().map(Vec::len).max().unwrap_or(1);
        let keys = library.classes() * most;
        let mut level = Self {
            radius,
            position: Numbered::new(),
            element: Numbered::new(),
            part: Numbered::new(),
            first: Numbered::new(),
            key: Numbered::new(),
            of_key: Numbered::filled(Vec::new(), keys),
            outlier2: (0..keys).map(|k| (library.outlier[k / most] as f32).powi(2)).collect(),
            starts: Numbered::filled(0, 1),
            near: Vec::new(),
            across: std::array::from_fn(|_| Vec::new()),
            run_starts: Numbered::filled(0, 1),
            runs: Vec::new(),
            table: Vec::new(),
            alike: Numbered::new(),
            searched: (0..SEARCHED).map(|_| Mutex::new(())).collect(),
            held: Arc::new(vec![held]),
            net: None,
            base: library.len() as u32,
            stars: Numbered::new(),
            single2: 0.0,
            parts,
        };
        for e in 0..library.len() {
            level.first.push(level.position.len() as u32);
            let ids = samples.ids(e, &level.parts[e]);
            for (j, &offset) in level.parts[e].iter().enumerate() {
                let key = library.class[e] * most as u32 + ids[j];
                level.of_key[key].push(level.position.len() as u32);
                level.key.push(key);
                level.element.push(e as u32);
                level.part.push(j as u32);
                level.position.push(library.centre[e] + offset);
            }
        }
        level.stars = Numbered::filled(Star::EMPTY, level.position.len());
        level.alike = Numbered::filled(OnceLock::new(), level.position.len());
        Ok(level)
    }

    fn flatten(&mut self, library: &Library<D>, slack: f64, budget: &Budget) -> Result<()> {
        let plane = &Domain::Box(library.view.window);
        let mut meter = budget.meter();
        let reach = self.radius + slack;
        let index = GridIndex::new(&self.position, reach, plane);
        // Counted first, and then held exactly: of large exemplars these lists are most of the memory.
        let mut count = 0_usize;
        for &position in &self.position {
            meter.spend(3 * index.within(position, reach, |_, _| count += 1))?;
        }
        let size = size_of::<Near<D>>() + D * size_of::<f32>();
        let mut held = vec![budget.hold("neighbourhoods of the exemplar", count.saturating_mul(size))?];
        self.near.reserve_exact(count);
        self.across.iter_mut().for_each(|across| across.reserve_exact(count + LANES));
        for i in 0..self.position.len() {
            let mut found = Vec::new();
            let looked = index.within(self.position[i], reach, |j, offset| {
                if j != i {
                    let weight = if offset.norm() <= self.radius { fall_off(offset, self.radius) as f32 } else { 0.0 };
                    let offset = offset.0.map(|v| v as f32);
                    let column = library.differences.column(self.element[j]);
                    found.push((self.key[j], Near { offset, sample: j as u32, weight, column }));
                }
            });
            meter.spend(3 * looked + 40 * found.len() as u64)?;
            // From left to right: then most of a run is left out by its first coordinate.
            found.sort_by(|(key, a), (other, b)| {
                key.cmp(other).then(a.offset[0].total_cmp(&b.offset[0])).then(a.sample.cmp(&b.sample))
            });
            self.push_runs(&found);
        }
        self.across.iter_mut().for_each(|across| across.extend([f32::INFINITY; LANES]));
        held.extend(self.tabulate(budget)?);
        held.extend(Arc::into_inner(std::mem::take(&mut self.held)).unwrap_or_default());
        self.held = Arc::new(held);
        Ok(())
    }

    fn push_runs(&mut self, found: &[(u32, Near<D>)]) {
        for group in found.chunk_by(|a, b| a.0 == b.0) {
            let start = self.near.len() as u32;
            self.near.extend(group.iter().map(|(_, near)| *near));
            for (k, across) in self.across.iter_mut().enumerate() {
                across.extend(group.iter().map(|(_, near)| near.offset[k]));
            }
            self.runs.push(Run { key: group[0].0, start, end: self.near.len() as u32 });
        }
        self.starts.push(self.near.len() as u32);
        self.run_starts.push(self.runs.len() as u32);
    }

    /// Notes where the neighbours of each key are, unless there are too many keys. Returns the memory for that.
    fn tabulate(&mut self, budget: &Budget) -> Result<Option<Held>> {
        let (count, keys) = (self.position.len(), self.of_key.len());
        if count * keys > TABLE.0 && keys > TABLE.1 {
            return Ok(None);
        }
        let held = budget.hold("neighbourhoods of the exemplar", count * keys * size_of::<[u32; 2]>())?;
        budget.spend((count * keys) as u64)?;
        let mut table = vec![[0; 2]; count * keys];
        for i in 0..count as u32 {
            for run in &self.runs[range(&self.run_starts, i)] {
                let base = self.starts[i];
                table[i as usize * keys + run.key as usize] = [run.start - base, run.end - base];
            }
        }
        self.table = table;
        Ok(Some(held))
    }

    /// Makes everything from element `base` on the nodes of `net`. Edge sets are compared when `with_edges`.
    pub(crate) fn with_net(mut self, net: Arc<Net<D>>, base: u32, with_edges: bool) -> Self {
        self.base = base;
        self.single2 = (SINGLE * net.spacing * net.spacing) as f32;
        if with_edges {
            for i in 0..self.position.len() as u32 {
                if let Some(node) = self.node_of(i) {
                    self.stars[i] = net.star(node);
                }
            }
        }
        self.net = Some(net);
        self
    }

    /// The node of the net that sample `i` is, `None` for a sample of an element.
    pub(crate) fn node_of(&self, i: u32) -> Option<u32> {
        self.element[i].checked_sub(self.base)
    }

    /// The samples most similar to sample `i`, best first, found by `find` the first time. `find` must always find the
    /// same, and must not wait for other threads.
    ///
    /// # Errors
    /// What `find` gives; then the next one to ask looks again.
    pub(crate) fn alike(&self, i: u32, find: impl FnOnce() -> Result<Vec<u32>>) -> Result<&[u32]> {
        if let Some(known) = self.alike[i].get() {
            return Ok(known);
        }
        let _alone = self.searched[i as usize % SEARCHED].lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = self.alike[i].get() {
            return Ok(known);
        }
        let found = find()?;
        Ok(self.alike[i].get_or_init(|| found))
    }

    /// Neighbours of sample `i`, sorted by key, and those of a key by their first coordinate.
    pub(crate) fn neighbours(&self, i: u32) -> &[Near<D>] {
        &self.near[range(&self.starts, i)]
    }

    /// Calls `visit(n, distance2)` for the neighbours of sample `i` of a key that are nearer to an offset from it than the root of
    /// `most`, by their number in [`Level::neighbours`], ascending. Returns how many were looked at.
    #[inline]
    pub(crate) fn near_offset(
        &self,
        i: u32,
        key: u32,
        offset: [f32; D],
        most: f32,
        mut visit: impl FnMut(usize, f32),
    ) -> usize {
        let of_key = self.neighbours_of_key(i, key);
        let base = self.starts[i] as usize;
        // A little more, so that rounding leaves out none.
        let reach = most.sqrt() * 1.0001;
        let (low, high) = (offset[0] - reach, offset[0] + reach);
        let along = &self.across[0][base..];
        for first in of_key.clone().step_by(LANES) {
            if along[first] > high {
                break;
            }
            if along[of_key.end.min(first + LANES) - 1] < low {
                continue;
            }
            let mut distance2 = [0.0_f32; LANES];
            for (across, &own) in self.across.iter().zip(&offset) {
                let Some(several) = across[base + first..].first_chunk::<LANES>() else { continue };
                for (sum, &x) in distance2.iter_mut().zip(several) {
                    *sum += (own - x) * (own - x);
                }
            }
            if distance2.iter().fold(false, |any, &d2| any | (d2 < most)) {
                // Those of the next key may come along.
                let own = distance2.iter().take(of_key.end - first);
                own.zip(first..).filter(|(d2, _)| **d2 < most).for_each(|(&d2, n)| visit(n, d2));
            }
        }
        of_key.len()
    }

    /// Those of a key, as a range into [`Level::neighbours`].
    #[inline]
    pub(crate) fn neighbours_of_key(&self, i: u32, key: u32) -> std::ops::Range<usize> {
        if let Some(&[start, end]) = self.table.get(i as usize * self.of_key.len() + key as usize) {
            return start as usize..end as usize;
        }
        let base = self.starts[i];
        let runs = &self.runs[range(&self.run_starts, i)];
        match runs.binary_search_by_key(&key, |run| run.key) {
            Ok(k) => (runs[k].start - base) as usize..(runs[k].end - base) as usize,
            Err(_) => 0..0,
        }
    }
}

/// Where the entries of sample `i` lie in a flattened list, given where those of each sample start.
fn range(starts: &Numbered<u32>, i: u32) -> std::ops::Range<usize> {
    starts[i] as usize..starts[i + 1] as usize
}

/// Weight of a neighbour at `offset` in a neighbourhood of `radius`: 1 in the middle, 0.1 at the rim.
pub(crate) fn fall_off<const D: usize>(offset: Vector<D>, radius: f64) -> f64 {
    let x = (offset.norm2() / (radius * radius)).min(1.0);
    0.1 + 0.9 * (1.0 - x) * (1.0 - x)
}
