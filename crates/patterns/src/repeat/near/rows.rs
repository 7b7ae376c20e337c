//! The repeat of elements that keep to rows.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Exemplar, Result, Vector};

use crate::repeat::{
    description::{Explains, Extent, Repeat},
    lattice::{Lattice, Node},
    looks::{ALIKE, ALIKE_BY_HAND, looks, shapes},
    marks::{Anchor, place_of},
    near::{
        kinds::{self, Sublattice},
        nodes::Nodes,
        places::Places,
        spectrum,
    },
    offsets::fit::Sums,
};

/// Fewest elements of which the places tell.
const LEAST: usize = 16;

/// Fewest things of a look that tell where those of it lie, in the mean.
const FEW: usize = 3;

/// What a near-regular exemplar repeats by, and the elements that are not of the kind that they should be.
#[derive(Clone, Debug)]
pub(crate) struct Near {
    pub(crate) repeat: Repeat,
    pub(crate) odd: Vec<usize>,
    /// Whether what looks alike comes again, and not only what is of one class, or the places.
    pub(crate) by_looks: bool,
}

/// The lattice that has one element in each cell, or that of their kinds.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn near(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Near>> {
    let Some((nodes, anchor)) = rows(exemplar, budget)? else { return Ok(None) };
    let rows = Rows { exemplar, nodes, anchor };
    let classes: Vec<u32> = exemplar.elements.iter().map(|e| e.class as u32).collect();
    let strictly = looks(exemplar, ALIKE, budget)?;
    let by_hand = looks(exemplar, ALIKE_BY_HAND, budget)?;
    let mut of_some: Option<Sublattice> = None;
    for (kinds, by_looks) in [(strictly.as_ref(), true), (by_hand.as_ref(), true), (Some(&classes), false)] {
        let Some(kinds) = kinds else { continue };
        let sublattice = kinds::sublattice(&rows.nodes, kinds, budget)?;
        if sublattice.says_all() {
            let Some(repeat) = rows.of_kinds(&sublattice) else { continue };
            return Ok(Some(Near { repeat, odd: sublattice.odd, by_looks }));
        }
        if !sublattice.is_of_all() {
            of_some = Some(sublattice);
        }
    }
    // Planks laid two ways in any colours: what lies where is said but for the paint.
    if let Some(sublattice) = rows.of_shapes(of_some.as_ref(), budget)? {
        of_some = Some(sublattice);
    }
    // What lies where is said in part: that there are crosses between suns, but not which suns.
    if let Some(repeat) = of_some.and_then(|sublattice| rows.of_kinds(&sublattice)) {
        let repeat = Repeat { explains: Explains::Places, share: rows.nodes.taken, ..repeat };
        return Ok(Some(Near { repeat, odd: Vec::new(), by_looks: false }));
    }
    let repeat = rows.of_places(strictly.as_deref());
    Ok(Some(Near { repeat, odd: Vec::new(), by_looks: false }))
}

/// Elements at nodes.
struct Rows<'a> {
    exemplar: &'a Exemplar<2>,
    nodes: Nodes,
    anchor: Anchor,
}

impl Rows<'_> {
    /// The lattice of shapes, where it says where each lies; `None` where all nodes are one place, or another lattice that is
    /// `known` says as much and more.
    fn of_shapes(&self, known: Option<&Sublattice>, budget: &Budget) -> Result<Option<Sublattice>> {
        for alike in [ALIKE, ALIKE_BY_HAND] {
            let Some(shapes) = shapes(self.exemplar, alike, budget)? else { continue };
            let sublattice = kinds::sublattice(&self.nodes, &shapes, budget)?;
            if sublattice.says_all() && !sublattice.is_of_all() {
                return Ok(Some(sublattice).filter(|found| !known.is_some_and(|known| known.is_within(found))));
            }
        }
        Ok(None)
    }

    /// The repeat of kinds, its vectors fitted to each place in its cell by itself: where these lie in the cell is part of the
    /// pattern.
    fn of_kinds(&self, kinds: &Sublattice) -> Option<Repeat> {
        let nodes = &self.nodes;
        let [a, b] = kinds.vectors.map(|v| nodes.lattice.at(v));
        let lattice = Lattice::new(a, b)?;
        let share = (1.0 - kinds.odd.len() as f64 / nodes.all.len() as f64).min(nodes.taken);
        let (explains, extent, anchor) = (Explains::Everything, Extent::Plane, self.anchor);
        let repeat = Repeat { lattice, explains, extent, anchor, jitter: nodes.jitter, share };
        let groups = self.groups(|k| kinds.places[k]);
        Some(match fitted(&groups, &nodes.lattice, nodes.all.len()) {
            Some((fit, jitter)) if !kinds.is_of_all() => {
                let [a, b] = kinds.vectors.map(|v| fit.at(v));
                Repeat { lattice: Lattice::new(a, b)?, jitter, ..repeat }
            }
            _ => repeat,
        })
    }

    /// The repeat of places, its vectors fitted to things of one look each: the middles of different ones lie differently at
    /// their places.
    fn of_places(&self, looks: Option<&[u32]>) -> Repeat {
        let (nodes, anchor) = (&self.nodes, self.anchor);
        let groups = looks.map(|looks| self.groups(|k| i64::from(looks[nodes.all[k].1])));
        let fit = groups.and_then(|groups| fitted(&groups, &nodes.lattice, nodes.all.len()));
        let better = fit.filter(|(_, jitter)| *jitter < 0.7 * nodes.jitter);
        let lattice = better.map_or(nodes.lattice, |(lattice, _)| lattice);
        let (explains, extent) = (Explains::Places, Extent::Plane);
        Repeat { lattice, explains, extent, anchor, jitter: nodes.jitter, share: nodes.taken }
    }

    /// Nodes and places of the elements, in groups by their number among those at nodes.
    fn groups(&self, of: impl Fn(usize) -> i64) -> Vec<Vec<(Node, Vector<2>)>> {
        let mut groups: BTreeMap<i64, Vec<(Node, Vector<2>)>> = BTreeMap::new();
        for (k, &(node, e)) in self.nodes.all.iter().enumerate() {
            groups.entry(of(k)).or_default().push((node, place_of(&self.exemplar.elements[e], self.anchor)));
        }
        groups.into_values().collect()
    }
}

/// The vectors fitted to groups that lie each somewhere else in the cell, and what jitter is left; nothing where there are too
/// few things in a group to tell where that is.
fn fitted(groups: &[Vec<(Node, Vector<2>)>], lattice: &Lattice, count: usize) -> Option<(Lattice, f64)> {
    let mut sums = Sums::default();
    groups.iter().for_each(|group| sums.add(group));
    let vectors = sums.vectors().filter(|_| groups.len() * FEW <= count)?;
    let fit = Lattice { vectors };
    let is_near = |k: usize| (vectors[k] - lattice.vectors[k]).norm() < 0.05 * lattice.shorter();
    (is_near(0) && is_near(1)).then(|| (fit, sums.jitter(&vectors)))
}

/// The nodes at which the elements lie, by their centres or their boxes, whichever lie better.
fn rows(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<(Nodes, Anchor)>> {
    let mut best: Option<(Nodes, Anchor)> = None;
    for anchor in [Anchor::Centre, Anchor::Box] {
        let places = Places::of(exemplar, anchor);
        if places.whole.len() < LEAST {
            continue;
        }
        let Some(lattice) = spectrum::lattice(&places, budget)? else { continue };
        let Some(nodes) = Nodes::new(&places, lattice, budget)? else { continue };
        // Boxes are asked second, and have to be better by more than chance.
        if best.as_ref().is_none_or(|(other, _)| nodes.jitter < 0.8 * other.jitter) {
            best = Some((nodes, anchor));
        }
    }
    Ok(best)
}
