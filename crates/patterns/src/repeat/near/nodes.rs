//! Which node of a lattice each place lies at.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Budget, Result, Vector};

use crate::repeat::{
    lattice::{Lattice, Node},
    near::places::Places,
};

/// More jitter than this, in terms of the shorter vector, is no lattice: with steps as long as that to all sides, rows
/// are not seen.
const JITTER: f64 = 0.115;

/// Share of the neighbours of places at which something must lie.
const TAKEN: f64 = 0.82;

/// Share of the places that may lie at a node of others.
const DOUBLE: f64 = 0.03;

/// Places beyond so many times the farthest one so far are fitted next.
const GROWTH: f64 = 1.5;

/// Work for a place that is fitted.
const FIT: u64 = 30;

/// Places at nodes.
#[derive(Clone, Debug)]
pub(crate) struct Nodes {
    pub(crate) lattice: Lattice,
    /// The node of each place, and the element that lies there.
    pub(crate) all: Vec<(Node, usize)>,
    /// Root mean square distance of places from their nodes.
    pub(crate) jitter: f64,
    /// Share of the neighbours of places at which something lies.
    pub(crate) taken: f64,
}

impl Nodes {
    /// The places at the nodes of a lattice, which is fitted to them; `None` where they do not lie there.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(places: &Places, lattice: Lattice, budget: &Budget) -> Result<Option<Self>> {
        let Some((lattice, origin)) = fitted(places, lattice, budget)? else { return Ok(None) };
        let at = |p: Vector<2>| lattice.nearest(p - origin);
        let mut known: BTreeMap<Node, usize> = BTreeMap::new();
        let mut squares = 0.0;
        for (place, element) in &places.whole {
            let (node, rest) = at(*place);
            squares += rest.norm2();
            known.entry(node).or_insert(*element);
        }
        let (count, single) = (places.whole.len() as f64, known.len() as f64);
        let jitter = (squares / count).sqrt();
        if jitter > JITTER * lattice.shorter() || count - single > (DOUBLE * count).max(1.0) {
            return Ok(None);
        }
        let cut: BTreeMap<Node, ()> = places.cut.iter().map(|p| (at(*p).0, ())).collect();
        let all = places.whole.iter().map(|(p, _)| *p).chain(places.cut.iter().copied());
        let extent = Bounds::around(all).grown(0.2 * lattice.shorter());
        let (mut seen, mut taken) = (0_usize, 0_usize);
        for node in known.keys() {
            for step in [[1, 0], [-1, 0], [0, 1], [0, -1]] {
                let there = [node[0] + step[0], node[1] + step[1]];
                if extent.contains(origin + lattice.at(there)) {
                    seen += 1;
                    taken += usize::from(known.contains_key(&there) || cut.contains_key(&there));
                }
            }
        }
        let taken = taken as f64 / seen.max(1) as f64;
        let all = known.into_iter().collect();
        Ok((taken >= TAKEN).then_some(Self { lattice, all, jitter, taken }))
    }
}

/// The lattice and its origin, fitted to the places around the middle and then to more and more of them: the farther away,
/// the less a vector may be off for each place to be told its node.
fn fitted(places: &Places, mut lattice: Lattice, budget: &Budget) -> Result<Option<(Lattice, Vector<2>)>> {
    let count = places.whole.len();
    let middle = places.whole.iter().fold(Vector::ZERO, |sum, (p, _)| sum + *p) * (1.0 / count as f64);
    let mut order: Vec<Vector<2>> = places.whole.iter().map(|(p, _)| *p - middle).collect();
    order.sort_by(|a, b| a.norm2().total_cmp(&b.norm2()).then(a[0].total_cmp(&b[0])).then(a[1].total_cmp(&b[1])));
    let mut origin = order.first().copied().unwrap_or(Vector::ZERO);
    let farthest = order.last().map_or(0.0, |p| p.norm());
    let mut reach = 2.5 * places.unit;
    // Places as far as the spectrum was asked are told well by its vectors, only the origin is not known yet.
    for round in 0.. {
        let seen = &order[..order.partition_point(|p| p.norm() <= reach)];
        budget.spend(FIT * seen.len() as u64)?;
        let Some((next, there)) = fit(seen, &lattice, origin) else {
            if reach > farthest {
                return Ok(None);
            }
            reach *= GROWTH;
            continue;
        };
        origin = there;
        // A few places say where the nodes lie, but not how far apart.
        if round > 1 {
            lattice = next;
        }
        if reach > farthest && round > 4 {
            break;
        }
        reach *= GROWTH;
    }
    Ok(Lattice::new(lattice.vectors[0], lattice.vectors[1]).map(|lattice| (lattice, middle + origin)))
}

/// Vectors and origin that lie nearest to the places at the nodes that these have now.
fn fit(places: &[Vector<2>], lattice: &Lattice, origin: Vector<2>) -> Option<(Lattice, Vector<2>)> {
    let count = places.len() as f64;
    let nodes: Vec<[f64; 2]> = places.iter().map(|p| lattice.nearest(*p - origin).0.map(|n| n as f64)).collect();
    let mean = |k: usize| nodes.iter().map(|n| n[k]).sum::<f64>() / count;
    let (m, centre) = ([mean(0), mean(1)], places.iter().fold(Vector::ZERO, |sum, p| sum + *p) * (1.0 / count));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    let mut sums = [Vector::ZERO; 2];
    for (n, p) in nodes.iter().zip(places) {
        let (x, y, p) = (n[0] - m[0], n[1] - m[1], *p - centre);
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
        sums = [sums[0] + p * x, sums[1] + p * y];
    }
    let measure = xx * yy - xy * xy;
    if measure <= 1e-9 * (xx + yy).powi(2) {
        return None;
    }
    let a = (sums[0] * yy - sums[1] * xy) * (1.0 / measure);
    let b = (sums[1] * xx - sums[0] * xy) * (1.0 / measure);
    Some((Lattice { vectors: [a, b] }, centre - a * m[0] - b * m[1]))
}
