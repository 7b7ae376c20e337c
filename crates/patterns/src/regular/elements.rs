//! Elements on a lattice: one at every place of every cell that shows in the output.

use std::collections::{BTreeMap, BTreeSet};

use arabesque_core::{
    Exemplar, Outline, Placement, Progress, Request, Result, Shape, Similarity, Snapshot, Vector, Watch,
};

use crate::{
    ending::heard,
    regular::{
        admit::{Admission, outline_of},
        choice::Cells,
        grid::Grid,
    },
    repeat::{
        Anchor,
        lattice::Node,
        marks::place_of,
        orbits::{Instance, Orbit},
    },
};

/// Something that stays has a place in the lattice when it is no farther from it than this share of the shorter vector.
const KEPT: f64 = 0.2;

/// Work for comparing two offsets; offsets that are compared with one another at most.
const COMPARE: u64 = 20;
const AGREEING: usize = 400;

/// Cells between two steps of progress.
const STEP: usize = 2048;

/// Elements of the exemplar at the places of a lattice.
pub(crate) struct Elements<'a> {
    pub(crate) exemplar: &'a Exemplar<2>,
    pub(crate) anchor: Anchor,
    pub(crate) orbits: &'a [Orbit],
    pub(crate) cells: &'a Cells,
}

/// What stays at which places: orbit and node, and its number.
type Taken = BTreeMap<(usize, Node), usize>;

/// What is made so far when a run is cut short, or all of it.
pub(crate) struct Placed {
    pub(crate) placements: Vec<Placement<2>>,
    pub(crate) ended: Result<()>,
}

impl Elements<'_> {
    /// Places elements on `grid`; what stays comes first.
    pub(crate) fn place(
        &self,
        grid: &Grid,
        request: &Request<2>,
        obstacles: Option<&Shape>,
        watch: &mut dyn Watch<Snapshot<2>>,
    ) -> Result<Placed> {
        let mut placements: Vec<_> = kept(request);
        let (taken, others) = self.taken(grid, request)?;
        let admission = Admission::new(request, obstacles, others).with_slack(KEPT * grid.lattice.shorter());
        let nodes = self.nodes(grid, request)?;
        let number: BTreeMap<Node, usize> = nodes.iter().enumerate().map(|(k, &n)| (n, k)).collect();
        let beside = |node: Node| number.get(&grid.wrap(node)).copied();
        let budget = request.budget.stage("laying out");
        let each = size_of::<Vec<u32>>() + self.orbits.len() * size_of::<u32>();
        let _held = budget.hold("cells of the repeat", nodes.len() * each)?;
        let chosen = self.cells.choose(&nodes, &beside, request.seed, &budget)?;
        for (k, (&node, cell)) in nodes.iter().zip(&chosen).enumerate() {
            for (o, (orbit, &instance)) in self.orbits.iter().zip(cell).enumerate() {
                if taken.contains_key(&(o, node)) {
                    continue;
                }
                let placement = self.placement(grid, request, orbit, &orbit.instances[instance as usize], node);
                let outline = outline_of(&placement, self.exemplar);
                let p = placement.transform.apply(self.exemplar.elements[placement.source].centre);
                match admission.admits(&outline, p, &budget) {
                    Ok(true) => placements.push(placement),
                    Ok(false) => {}
                    Err(error) => return Ok(Placed { placements, ended: Err(error) }),
                }
            }
            if (k + 1).is_multiple_of(STEP) || k + 1 == nodes.len() {
                let progress = progress(k + 1, nodes.len(), placements.len());
                let preview = || Snapshot { placements: placements.clone(), ..Snapshot::default() };
                if let Err(error) = heard(watch.step(&progress, &preview), &progress) {
                    return Ok(Placed { placements, ended: Err(error) });
                }
            }
        }
        Ok(Placed { placements, ended: Ok(()) })
    }

    /// The nodes of a tile, or all whose elements may show.
    fn nodes(&self, grid: &Grid, request: &Request<2>) -> Result<Vec<Node>> {
        let sources = self.orbits.iter().flat_map(|orbit| &orbit.instances);
        let elements = sources.map(|instance| &self.exemplar.elements[instance.element as usize]);
        let radius = elements.map(|e| e.outline.radius(e.centre)).fold(0.0, f64::max);
        grid.nodes(Vector::ZERO, &request.domain.bounds().grown(radius * grid.element_scale), &request.budget)
    }

    fn placement(
        &self,
        grid: &Grid,
        request: &Request<2>,
        orbit: &Orbit,
        instance: &Instance,
        node: Node,
    ) -> Placement<2> {
        let element = &self.exemplar.elements[instance.element as usize];
        let at = request.domain.wrap(grid.place(orbit.base, node) + grid.vector(instance.residual));
        let pivot = place_of(element, self.anchor);
        let transform = Similarity::about(pivot, at, grid.rotation, grid.element_scale);
        Placement { source: instance.element as usize, transform, control: Vec::new(), frozen: None }
    }

    /// The places that what stays has in the lattice, and the outlines of what has none.
    fn taken(&self, grid: &Grid, request: &Request<2>) -> Result<(Taken, Vec<Outline<2>>)> {
        let shorter = grid.lattice.shorter();
        let (mut taken, mut others) = (BTreeMap::new(), Vec::new());
        let of_class = self.orbits_of_class();
        for (n, frozen) in request.frozen.iter().enumerate() {
            let orbits = &of_class[self.exemplar.elements[frozen.source].class];
            request.budget.spend(COMPARE * (1 + orbits.len()) as u64)?;
            let p = frozen.transform.apply(place_of(&self.exemplar.elements[frozen.source], self.anchor));
            let near = |o: usize| {
                let base = grid.place(self.orbits[o].base, [0, 0]);
                let (node, rest) = grid.lattice.nearest(p - base);
                (rest.norm() <= KEPT * shorter).then_some((rest.norm(), o, node))
            };
            let best = orbits.iter().filter_map(|&o| near(o)).min_by(|a, b| a.0.total_cmp(&b.0));
            match best {
                Some((_, o, node)) => {
                    taken.insert((o, grid.wrap(node)), n);
                }
                None => others.push(outline_of(frozen, self.exemplar)),
            }
        }
        Ok((taken, others))
    }

    /// The orbits at which elements of each class lie.
    fn orbits_of_class(&self) -> Vec<BTreeSet<usize>> {
        let mut orbits = vec![BTreeSet::new(); self.exemplar.classes.len()];
        for (o, orbit) in self.orbits.iter().enumerate() {
            for instance in &orbit.instances {
                orbits[self.exemplar.elements[instance.element as usize].class].insert(o);
            }
        }
        orbits
    }

    /// Moves the lattice so that it goes through what stays, where most of that agrees on how.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn join_kept(&self, grid: &mut Grid, request: &Request<2>) -> Result<()> {
        let shorter = grid.lattice.shorter();
        let mut offsets: Vec<Vector<2>> = Vec::new();
        let of_class = self.orbits_of_class();
        for frozen in &request.frozen {
            let element = &self.exemplar.elements[frozen.source];
            let p = frozen.transform.apply(place_of(element, self.anchor));
            let orbits = &of_class[element.class];
            request.budget.spend(COMPARE * (1 + orbits.len()) as u64)?;
            let off = |&o: &usize| grid.lattice.nearest(p - grid.place(self.orbits[o].base, [0, 0])).1;
            offsets.extend(orbits.iter().map(off));
        }
        // The offset that the most others agree with; with very many, some of them will do.
        let stride = offsets.len().div_ceil(AGREEING).max(1);
        request.budget.spend(COMPARE * (offsets.len().min(AGREEING) as u64).pow(2))?;
        let agreeing = |a: Vector<2>| -> Vec<Vector<2>> {
            let rest = |b: &Vector<2>| grid.lattice.nearest(*b - a).1;
            offsets.iter().step_by(stride).map(rest).filter(|r| r.norm() <= 0.1 * shorter).collect()
        };
        // Of several that fit as well, the one that moves least: things that look alike fit one another's places.
        let mut best: Option<(usize, Vector<2>)> = None;
        for &a in offsets.iter().step_by(stride) {
            let count = agreeing(a).len();
            let is_better = |&(most, b): &(usize, Vector<2>)| count > most || (count == most && a.norm() < b.norm());
            if best.as_ref().is_none_or(is_better) {
                best = Some((count, a));
            }
        }
        if let Some((_, a)) = best {
            let rests = agreeing(a);
            let mean = rests.iter().fold(Vector::ZERO, |sum, r| sum + *r) * (1.0 / rests.len() as f64);
            grid.move_by(a + mean);
        }
        Ok(())
    }
}

/// What the user placed, as it is.
pub(crate) fn kept(request: &Request<2>) -> Vec<Placement<2>> {
    let one = |(n, placement): (usize, &Placement<2>)| Placement { frozen: Some(n), ..placement.clone() };
    request.frozen.iter().enumerate().map(one).collect()
}

fn progress(done: usize, total: usize, count: usize) -> Progress {
    let fraction = done as f64 / total.max(1) as f64;
    Progress { stage: "continuing the repeat".into(), done, total, fraction, energy: None, count }
}
