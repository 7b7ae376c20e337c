//! Orbits: the places in a cell of the lattice where elements lie, and which elements of the exemplar lie there.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Budget, Exemplar, Result, Role, Vector};

use crate::{
    exemplar::library::farthest,
    repeat::{
        description::Repeat,
        lattice::{Lattice, Node},
        looks::{self, looks},
        marks::place_of,
        unknown::{drawn, may_be_cut, touches},
    },
};

/// Elements belong to one orbit when they are off by less than this share of the shorter vector, and by less than so
/// many times the jitter.
const TOLERANCE: (f64, f64) = (0.02, 4.0);

/// A place of which fewer than this share of the nodes in the frame are taken is an exception, not a place.
const TAKEN: f64 = 0.5;

/// So many times more nodes than elements are not looked at one by one.
const FAR_MORE: f64 = 100.0;

/// Work for each element and orbit that are compared.
const COMPARE: u64 = 15;

/// Most orbits: with more of them, a cell holds so much that there is nothing regular about it.
const MOST: usize = 20_000;

/// An element of the exemplar at a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instance {
    pub(crate) element: u32,
    pub(crate) node: Node,
    /// From where the lattice has it to where it is.
    pub(crate) residual: Vector<2>,
}

/// A place in the cell.
#[derive(Clone, Debug)]
pub(crate) struct Orbit {
    /// Where it is at the node at the origin.
    pub(crate) base: Vector<2>,
    pub(crate) instances: Vec<Instance>,
}

/// The orbits of an exemplar, and the elements that lie on none.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn orbits(exemplar: &Exemplar<2>, repeat: &Repeat, budget: &Budget) -> Result<(Vec<Orbit>, Vec<u32>)> {
    let lattice = &repeat.lattice;
    let shorter = lattice.shorter();
    let tolerance = (TOLERANCE.0 * shorter).max(TOLERANCE.1 * repeat.jitter).min(0.45 * shorter);
    let mut groups: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
    for (e, element) in (0..).zip(&exemplar.elements) {
        if element.role == Role::Source && element.outline.radius(element.centre) <= farthest(&exemplar.window) {
            groups.entry(element.class).or_default().push(e);
        }
    }
    // Common classes first: an exception among them takes one of their nodes, and no orbit of its own.
    let mut groups: Vec<_> = groups.into_iter().collect();
    groups.sort_by_key(|(class, members)| (std::cmp::Reverse(members.len()), *class));
    let exact = looks(exemplar, looks::ALIKE, budget)?.unwrap_or_else(|| (0..exemplar.elements.len() as u32).collect());
    let cut = may_be_cut(exemplar, &exact);
    let touches = |e: u32| touches(&exemplar.elements[e as usize].outline.bounds(), &exemplar.window);
    let gather = |known: &[(Vector<2>, usize)]| -> Result<Found<'_>> {
        let mut found = Found::new((lattice, tolerance), known, budget);
        let place = |e: u32| place_of(&exemplar.elements[e as usize], repeat.anchor);
        for (class, members) in &groups {
            for &e in members.iter().filter(|&&e| !touches(e)) {
                found.add(e, *class, place(e), false)?;
            }
        }
        // What touches the frame may be cut there: it may take a node of others, but says nothing by itself, unless one that
        // looks like it is whole.
        let mut whole = Vec::new();
        for (class, members) in &groups {
            for &e in members.iter().filter(|&&e| touches(e)) {
                if !found.add(e, *class, place(e), true)? && !cut[e as usize] {
                    whole.push((e, *class));
                }
            }
        }
        for (e, class) in whole {
            found.add(e, class, place(e), false)?;
        }
        Ok(found)
    };
    let mut found = gather(&[])?;
    let is_by_hand = TOLERANCE.1 * repeat.jitter > TOLERANCE.0 * shorter;
    if is_by_hand || found.is_mixed {
        // By hand, the first element at a place lies as far off as any other. And where different ones lie at one place, the
        // first of the second kind came before that was known.
        let first: Vec<Vector<2>> = found.orbits.iter().map(|(orbit, ..)| orbit.base).collect();
        let known = found.settled(exemplar).0.into_iter();
        let known = known.map(|(k, orbit, class)| (if is_by_hand { orbit.base } else { first[k] }, class));
        found = gather(&known.collect::<Vec<_>>())?;
    }
    let (mut orbits, others) = found.settled(exemplar);
    orbits.sort_by_key(|(_, orbit, _)| orbit.instances.first().map(|i| i.element));
    Ok((orbits.into_iter().map(|(_, orbit, _)| orbit).collect(), others))
}

struct Found<'a> {
    lattice: &'a Lattice,
    tolerance: f64,
    /// Orbits with the class that began each, and the nodes that are taken.
    orbits: Vec<(Orbit, usize, BTreeMap<Node, u32>)>,
    /// Orbits by the square of the cell that their base lies in.
    cells: BTreeMap<(i64, i64), Vec<usize>>,
    /// Whether something took a node of an orbit that another class began.
    is_mixed: bool,
    budget: &'a Budget,
}

impl<'a> Found<'a> {
    /// Without elements, at `known` places, each with the class that began it.
    fn new((lattice, tolerance): (&'a Lattice, f64), known: &[(Vector<2>, usize)], budget: &'a Budget) -> Self {
        let mut found =
            Self { lattice, tolerance, orbits: Vec::new(), cells: BTreeMap::new(), is_mixed: false, budget };
        for (base, class) in known {
            found.begin(lattice.folded(*base), *class);
        }
        found
    }

    fn begin(&mut self, base: Vector<2>, class: usize) {
        let key = self.key(base);
        self.cells.entry(key).or_default().push(self.orbits.len());
        self.orbits.push((Orbit { base, instances: Vec::new() }, class, BTreeMap::new()));
    }

    fn key(&self, p: Vector<2>) -> (i64, i64) {
        let side = 2.0 * self.tolerance;
        ((p[0] / side).floor() as i64, (p[1] / side).floor() as i64)
    }

    /// Adds an element at a node of an orbit, where one is free, else as the first one of an orbit of its own: not, where it
    /// `may_be_cut`. Tells whether it was added.
    fn add(&mut self, element: u32, class: usize, place: Vector<2>, may_be_cut: bool) -> Result<bool> {
        let folded = self.lattice.folded(place);
        let mut best: Option<(bool, f64, usize)> = None;
        let mut looked = 0;
        // At the sides of the cell, the same place lies on the other side too.
        for step in [[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, -1], [1, -1], [-1, 1]] {
            let p = folded + self.lattice.at(step);
            let (x, y) = self.key(p);
            for key in (-1..=1).flat_map(|i| (-1..=1).map(move |j| (x + i, y + j))) {
                for &o in self.cells.get(&key).map_or(&[][..], Vec::as_slice) {
                    looked += 1;
                    let (orbit, first, taken) = &self.orbits[o];
                    let apart = (orbit.base - p).norm();
                    let (node, _) = self.lattice.nearest(place - orbit.base);
                    if apart > self.tolerance || taken.contains_key(&node) {
                        continue;
                    }
                    if may_be_cut && *first != class {
                        continue;
                    }
                    let rank = (*first != class, apart, o);
                    if best.is_none_or(|b| (rank.0, rank.1) < (b.0, b.1)) {
                        best = Some(rank);
                    }
                }
            }
        }
        self.budget.spend(COMPARE * (looked + 20))?;
        let number = match best {
            Some((is_other, _, o)) => {
                self.is_mixed |= is_other;
                o
            }
            None if may_be_cut => return Ok(false),
            None => {
                self.begin(folded, class);
                self.budget.within("places in one cell of the repeat", self.orbits.len(), ("elements", MOST))?;
                self.orbits.len() - 1
            }
        };
        let (orbit, _, taken) = &mut self.orbits[number];
        let (node, residual) = self.lattice.nearest(place - orbit.base);
        taken.insert(node, element);
        orbit.instances.push(Instance { element, node, residual });
        Ok(true)
    }

    /// The orbits that hold, moved to the middle of their elements, with their numbers and classes, and the elements of the others.
    fn settled(self, exemplar: &Exemplar<2>) -> (Vec<(usize, Orbit, usize)>, Vec<u32>) {
        let (lattice, window) = (*self.lattice, drawn(exemplar).unwrap_or(exemplar.window));
        let (mut kept, mut others) = (Vec::new(), Vec::new());
        let met = self.orbits.into_iter().enumerate().filter(|(_, (orbit, ..))| !orbit.instances.is_empty());
        for (number, (mut orbit, class, taken)) in met {
            let count = orbit.instances.len() as f64;
            let mean = orbit.instances.iter().fold(Vector::ZERO, |sum, i| sum + i.residual) * (1.0 / count);
            orbit.base += mean;
            orbit.instances.iter_mut().for_each(|i| i.residual -= mean);
            let expected = expected_nodes(exemplar, &lattice, &orbit, &window);
            let is_taken = expected.is_some_and(|expected| {
                let met = expected.iter().filter(|node| taken.contains_key(*node)).count();
                met as f64 >= TAKEN * expected.len() as f64
            });
            if is_taken {
                orbit.instances.sort_by_key(|i| i.element);
                kept.push((number, orbit, class));
            } else {
                others.extend(orbit.instances.iter().map(|i| i.element));
            }
        }
        others.sort_unstable();
        (kept, others)
    }
}

/// The nodes at which an element of the orbit would lie wholly in the frame.
fn expected_nodes(exemplar: &Exemplar<2>, lattice: &Lattice, orbit: &Orbit, window: &Bounds<2>) -> Option<Vec<Node>> {
    let first = orbit.instances.first()?;
    let outline = &exemplar.elements[first.element as usize].outline;
    let here = orbit.base + lattice.at(first.node) + first.residual;
    let extent = if outline.rings.is_empty() { Bounds::new(here, here) } else { outline.bounds() };
    let (low, high) = (here - extent.min, extent.max - here);
    let room = Bounds::new(window.min + low, window.max - high).grown(1e-6 * window.size().norm());
    let [rows, columns] = lattice.nodes_in(orbit.base, &room);
    let count = (rows.end() - rows.start() + 1) as f64 * (columns.end() - columns.start() + 1) as f64;
    // Where so many more are missing than are there, the rest of the frame is empty.
    if count > FAR_MORE * orbit.instances.len() as f64 {
        return None;
    }
    let nodes = rows.flat_map(|i| columns.clone().map(move |j| [i, j]));
    let is_hidden = |p: Vector<2>| {
        let there = Bounds::new(p - low, p + high);
        exemplar.hole.is_some_and(|hole| hole.intersects(&there))
    };
    let places = nodes.map(|node| (node, orbit.base + lattice.at(node)));
    Some(places.filter(|&(_, p)| room.contains(p) && !is_hidden(p)).map(|(node, _)| node).collect())
}
