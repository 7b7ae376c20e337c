//! Regular piles: crates, cans and balls at the places of a lattice of space. They are continued exactly.

use std::collections::BTreeMap;

use arabesque_core::{
    Border, Bounds, Buckets, Budget, Domain, Error, Exemplar, Outcome, Placement, Request as EngineRequest, Result,
    ScalarField, Similarity, Stage, StopReason, Stream, Vector,
};

const SOURCES: Stage = Stage::new(463);

/// Fewest elements that show a lattice.
const FEWEST: usize = 8;
/// Elements may be off their places by this share of the shortest vector.
const OFF: f64 = 0.05;
/// Share of the elements that a vector of the lattice has to take to others, of those that it leaves in the pile.
const HITS: f64 = 0.97;
/// Share of the elements that it has to leave in the pile, so that it is shown often enough.
const SHOWN: f64 = 0.2;
/// Vectors that are tried, the shortest first.
const TRIED: usize = 80;
/// Most places in a cell.
const PLACES: usize = 64;
/// Vectors span space when their cell is this share of the box of their lengths.
const SPANS: f64 = 0.1;
/// Work for an element that is looked for, and for a place that is filled.
const LOOK: u64 = 120;
const PLACE: u64 = 600;

/// A place of the cell: where it is at the node at the origin, and the elements that show it.
type Place = (Vector<3>, Vec<usize>);

/// A pile on a lattice.
#[derive(Clone, Debug)]
pub(super) struct Pile {
    vectors: [Vector<3>; 3],
    /// What lies in a cell.
    places: Vec<Place>,
}

impl Pile {
    /// The lattice of a scene, if there is one on which all elements lie.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    pub(super) fn of(exemplar: &Exemplar<3>, budget: &Budget) -> Result<Option<Self>> {
        let classes: Vec<usize> = exemplar.elements.iter().map(|e| named(exemplar, e.class)).collect();
        let budget = budget.stage("looking for a lattice");
        if let Some(pile) = Self::with(exemplar, &classes, &budget)? {
            return Ok(Some(pile));
        }
        // What lies at the places may differ at random.
        Self::with(exemplar, &vec![0; classes.len()], &budget)
    }

    fn with(exemplar: &Exemplar<3>, kinds: &[usize], budget: &Budget) -> Result<Option<Self>> {
        let centres: Vec<_> = exemplar.elements.iter().map(|e| e.centre).collect();
        if centres.len() < FEWEST {
            return Ok(None);
        }
        let Some(vectors) = vectors(&centres, kinds, budget)? else { return Ok(None) };
        let Some(places) = places(&centres, kinds, &vectors, budget)? else { return Ok(None) };
        Ok(Some(Self { vectors, places }))
    }

    /// Fills a domain; `None` where fields or kept elements ask for more than a lattice.
    ///
    /// # Errors
    /// [`Error::NoResult`] when nothing fits, [`Error::Limit`] for more places than there may be.
    pub(super) fn fill(
        &self,
        (exemplar, floor): (&Exemplar<3>, Option<f64>),
        request: &EngineRequest<3>,
    ) -> Result<Option<Outcome<3>>> {
        let fields = &request.fields;
        let (ScalarField::Constant(scale), ScalarField::Constant(density)) = (&fields.scale, &fields.density) else {
            return Ok(None);
        };
        // What lies nearer than in the pile would overlap.
        if *density != 1.0
            || fields.orientation.is_some()
            || !request.frozen.is_empty()
            || matches!(request.domain, Domain::Torus(_))
        {
            return Ok(None);
        }
        let scale = *scale;
        let bounds = request.domain.bounds();
        let mut from = exemplar.window.min;
        let up = exemplar.up;
        if let Some(floor) = floor.filter(|_| request.ground.is_some()) {
            from[up] = floor;
        }
        let to_output = |p: Vector<3>| (p - from) * scale + bounds.min;
        let fits = |source: usize, transform: &Similarity<3>, centre: Vector<3>| match request.border {
            Border::Inside | Border::Turn => {
                request.domain.contains(centre)
                    && exemplar.elements[source].outline.points().all(|p| request.domain.contains(transform.apply(p)))
            }
            Border::Cross | Border::Clip => request.domain.contains(centre),
        };
        let budget = request.budget.stage("filling a lattice");
        let mut random = Stream::new(request.seed, SOURCES, 0);
        let mut placements = Vec::new();
        let mut meter = budget.meter();
        for (base, shown) in &self.places {
            for node in self.nodes(*base, &bounds, (from, scale), &budget)? {
                meter.spend(PLACE)?;
                let source = shown[random.below(shown.len())];
                let centre = to_output(node);
                // Places off the floor stay on the lattice, the floor's own lie at their height.
                let own = exemplar.elements[source].centre;
                let transform = Similarity { scale, ..Similarity::shift(centre - own * scale) };
                if fits(source, &transform, centre) {
                    placements.push(Placement { source, transform, control: Vec::new(), frozen: None });
                }
            }
        }
        budget.within(
            "elements of the result",
            placements.len(),
            ("output-elements", budget.limits().output_elements),
        )?;
        if placements.is_empty() {
            return Err(Error::no_result("no place of the lattice lies in the domain", "make it larger"));
        }
        let (sequence, curves, areas, energy, warnings) = Default::default();
        let stopped = StopReason::Finished;
        Ok(Some(Outcome { placements, sequence, curves, areas, energy, warnings, stopped }))
    }

    /// Where a place of the cell comes again, in the coordinates of the exemplar, all over a box of the output.
    fn nodes(
        &self,
        base: Vector<3>,
        bounds: &Bounds<3>,
        (from, scale): (Vector<3>, f64),
        budget: &Budget,
    ) -> Result<Vec<Vector<3>>> {
        let size = bounds.size() * (1.0 / scale);
        let corners = (0..8_u8).map(|k| Vector([0, 1, 2].map(|a| if k >> a & 1 == 1 { size[a] } else { 0.0 })));
        let (mut low, mut high) = ([i64::MAX; 3], [i64::MIN; 3]);
        for corner in corners {
            let c = coordinates(corner + from - base, &self.vectors);
            for k in 0..3 {
                low[k] = low[k].min(c[k].floor() as i64);
                high[k] = high[k].max(c[k].ceil() as i64);
            }
        }
        let count = (0..3).map(|k| (high[k] - low[k] + 1) as usize).fold(1_usize, usize::saturating_mul);
        budget.within("places of the lattice", count, ("nodes", budget.limits().nodes))?;
        let [u, v, w] = self.vectors;
        let at = |[i, j, k]: [i64; 3]| base + u * i as f64 + v * j as f64 + w * k as f64;
        let mut found = Vec::new();
        for i in low[0]..=high[0] {
            budget.check()?;
            for j in low[1]..=high[1] {
                for k in low[2]..=high[2] {
                    let p = at([i, j, k]);
                    let inside = (0..3).all(|a| p[a] - from[a] >= 0.0 && p[a] - from[a] <= size[a]);
                    if inside {
                        found.push(p);
                    }
                }
            }
        }
        Ok(found)
    }
}

/// The first class of the same name: those on a floor are classes of their own.
fn named(exemplar: &Exemplar<3>, class: usize) -> usize {
    exemplar.classes.iter().position(|c| c.name == exemplar.classes[class].name).unwrap_or(class)
}

/// The shortest three vectors that take the pile to itself.
fn vectors(centres: &[Vector<3>], kinds: &[usize], budget: &Budget) -> Result<Option<[Vector<3>; 3]>> {
    let bounds = Bounds::around(centres.iter().copied());
    let middle = bounds.centre();
    let first = (0..centres.len())
        .fold(0, |best, k| if (centres[k] - middle).norm2() < (centres[best] - middle).norm2() { k } else { best });
    let others = (0..centres.len()).filter(|&k| k != first && kinds[k] == kinds[first]);
    let mut ways: Vec<Vector<3>> = others.map(|k| centres[k] - centres[first]).collect();
    ways.sort_by(|a, b| a.norm2().total_cmp(&b.norm2()));
    ways.truncate(TRIED);
    let Some(shortest) = ways.first().map(|way| way.norm()).filter(|length| *length > 0.0) else { return Ok(None) };
    let look = Look::new(centres, kinds, OFF * shortest);
    let mut found: Vec<Vector<3>> = Vec::new();
    for way in ways {
        let spans = match found.as_slice() {
            [] => true,
            [u] => u.cross(way).norm() > SPANS * u.norm() * way.norm(),
            [u, v] => u.cross(*v).dot(way).abs() > SPANS * u.norm() * v.norm() * way.norm(),
            _ => break,
        };
        if spans && let Some(exact) = look.takes(way, &bounds, budget)? {
            found.push(exact);
        }
    }
    Ok(<[Vector<3>; 3]>::try_from(found).ok())
}

/// Elements by place.
struct Look<'a> {
    centres: &'a [Vector<3>],
    kinds: &'a [usize],
    off: f64,
    near: Buckets<3>,
}

impl<'a> Look<'a> {
    fn new(centres: &'a [Vector<3>], kinds: &'a [usize], off: f64) -> Self {
        let bounds = Bounds::around(centres.iter().copied());
        let mut near = Buckets::new(&Domain::Box(bounds), 4.0 * off, 4.0 * off);
        (0..).zip(centres).for_each(|(k, p)| near.insert(k, *p));
        Self { centres, kinds, off, near }
    }

    /// The vector by which elements are moved to others of their kind, in the mean, if it takes the pile to itself.
    fn takes(&self, way: Vector<3>, bounds: &Bounds<3>, budget: &Budget) -> Result<Option<Vector<3>>> {
        budget.spend(LOOK * self.centres.len() as u64)?;
        let inside = bounds.grown(self.off);
        let (mut sum, mut hits, mut left) = (Vector::ZERO, 0.0, 0.0);
        for (k, &p) in self.centres.iter().enumerate() {
            let to = p + way;
            if !inside.contains(to) {
                continue;
            }
            left += 1.0;
            let mut best: Option<(f64, usize)> = None;
            self.near.near(to, self.off, |j| {
                let far = (self.centres[j as usize] - to).norm();
                if self.kinds[j as usize] == self.kinds[k] && far <= self.off && best.is_none_or(|(b, _)| far < b) {
                    best = Some((far, j as usize));
                }
            });
            if let Some((_, j)) = best {
                hits += 1.0;
                sum += self.centres[j] - p;
            }
        }
        let is_shown = left >= SHOWN * self.centres.len() as f64 && hits >= HITS * left;
        Ok(is_shown.then(|| sum * (1.0 / hits)))
    }
}

/// The places of the cell, and the elements at each; `None` where there are too many, or some are mostly empty.
fn places(
    centres: &[Vector<3>],
    kinds: &[usize],
    vectors: &[Vector<3>; 3],
    budget: &Budget,
) -> Result<Option<Vec<Place>>> {
    let shortest = vectors.iter().map(|v| v.norm()).fold(f64::INFINITY, f64::min);
    let mut groups: BTreeMap<usize, Vec<(Vector<3>, Vec<usize>, Vector<3>)>> = BTreeMap::new();
    let mut number = 0;
    for (k, &p) in centres.iter().enumerate() {
        let own = groups.entry(kinds[k]).or_default();
        budget.spend(20 * (1 + own.len()) as u64)?;
        let found = own.iter_mut().find_map(|(base, members, sum)| {
            let apart = coordinates(p - *base, vectors).map(|c| c - c.round());
            let rest = vectors[0] * apart[0] + vectors[1] * apart[1] + vectors[2] * apart[2];
            (rest.norm() <= 2.0 * OFF * shortest).then_some((members, sum, rest))
        });
        match found {
            Some((members, sum, rest)) => {
                members.push(k);
                *sum += rest;
            }
            None => {
                own.push((p, vec![k], Vector::ZERO));
                number += 1;
            }
        }
        if number > PLACES {
            return Ok(None);
        }
    }
    let most = groups.values().flatten().map(|(_, members, _)| members.len()).max().unwrap_or(0);
    let all: Vec<_> = groups.into_values().flatten().collect();
    if all.iter().any(|(_, members, _)| 3 * members.len() < most) {
        return Ok(None);
    }
    let mean = |(base, members, sum): (Vector<3>, Vec<usize>, Vector<3>)| {
        let middle = base + sum * (1.0 / members.len() as f64);
        (middle, members)
    };
    Ok(Some(all.into_iter().map(mean).collect()))
}

/// A vector in terms of three others.
fn coordinates(p: Vector<3>, [u, v, w]: &[Vector<3>; 3]) -> Vector<3> {
    let volume = u.cross(*v).dot(*w);
    Vector([v.cross(*w).dot(p), w.cross(*u).dot(p), u.cross(*v).dot(p)].map(|c| c / volume))
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Class, Element, Outline, Role};

    use super::*;

    fn exemplar(centres: &[(Vector<3>, usize)]) -> Exemplar<3> {
        let element = |(centre, class): &(Vector<3>, usize)| Element {
            class: *class,
            centre: *centre,
            pose: Similarity::shift(*centre),
            outline: Outline { rings: vec![(0..8_u8).map(|k| *centre + corner(k)).collect()] },
            colour: [0.0; 3],
            lean: [Vector::ZERO; 3],
            role: Role::Source,
        };
        let classes = ["salt", "chlorine"].map(|name| Class { name: name.into() }).to_vec();
        Exemplar::unframed("t", centres.iter().map(element).collect(), classes).unwrap()
    }

    fn corner(k: u8) -> Vector<3> {
        Vector([0, 1, 2].map(|a| if k >> a & 1 == 1 { 0.4 } else { -0.4 }))
    }

    fn cubes(sides: [i32; 3], class: impl Fn(i32) -> usize) -> Vec<(Vector<3>, usize)> {
        let all = (0..sides[0]).flat_map(|i| (0..sides[1]).flat_map(move |j| (0..sides[2]).map(move |k| [i, j, k])));
        all.map(|[i, j, k]| (Vector([f64::from(i), 1.2 * f64::from(j), f64::from(k)]), class(i + j + k))).collect()
    }

    fn pile(centres: &[(Vector<3>, usize)]) -> Option<Pile> {
        Pile::of(&exemplar(centres), &Budget::default()).unwrap()
    }

    #[test]
    fn cubes_and_salt_are_lattices_and_heaps_are_none() {
        let plain = pile(&cubes([4, 3, 4], |_| 0)).unwrap();
        assert_eq!(plain.places.len(), 1);
        let salt = pile(&cubes([6, 4, 6], |n| (n % 2) as usize)).unwrap();
        assert_eq!(salt.places.len(), 2);
        let volume = |p: &Pile| p.vectors[0].cross(p.vectors[1]).dot(p.vectors[2]).abs();
        assert!((volume(&plain) - 1.2).abs() < 1e-9 && (volume(&salt) - 2.4).abs() < 1e-9);
        let mut stream = Stream::new(1, Stage::TEST, 0);
        let heap: Vec<_> = (0..80).map(|_| (Vector([0; 3].map(|_| stream.range(0.0, 5.0))), 0)).collect();
        assert!(pile(&heap).is_none());
        let loose: Vec<_> = cubes([4, 4, 4], |_| 0)
            .into_iter()
            .map(|(p, c)| (p + Vector([0; 3].map(|_| stream.range(-0.2, 0.2))), c))
            .collect();
        assert!(pile(&loose).is_none());
    }

    #[test]
    fn a_box_is_filled_without_a_fault() {
        let exemplar = exemplar(&cubes([4, 3, 4], |_| 0));
        let pile = Pile::of(&exemplar, &Budget::default()).unwrap().unwrap();
        let bounds = Bounds::new(Vector([1.0, 2.0, 3.0]), Vector([8.0, 8.0, 8.0]));
        let request = EngineRequest { border: Border::Cross, ..EngineRequest::new(Domain::Box(bounds)) };
        let outcome = pile.fill((&exemplar, None), &request).unwrap().unwrap();
        assert_eq!(outcome.placements.len(), 7 * 5 * 5);
        for placement in &outcome.placements {
            let p = placement.transform.apply(exemplar.elements[placement.source].centre);
            let others = outcome.placements.iter().map(|q| q.transform.apply(exemplar.elements[q.source].centre));
            let nearest = others.map(|q| (q - p).norm()).filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
            assert!((nearest - 1.0).abs() < 1e-9);
        }
        let inside = EngineRequest { border: Border::Inside, ..request };
        let fewer = pile.fill((&exemplar, None), &inside).unwrap().unwrap().placements.len();
        assert!(fewer > 0 && fewer < outcome.placements.len() + 1);
    }
}
