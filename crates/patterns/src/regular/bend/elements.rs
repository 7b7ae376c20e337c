//! Elements on a bent lattice: undistorted, each turned and scaled as the lattice is where it lies.

use std::collections::BTreeMap;

use arabesque_core::{
    Bounds, Domain, GridIndex, Outline, Placement, Progress, Request, Result, Shape, Similarity, Snapshot, Vector,
    Watch,
};

use crate::{
    ending::heard,
    regular::{
        admit::{Admission, outline_of},
        bend::{
            chart::{Chart, Spot},
            charts::Charts,
        },
        elements::{Elements, Placed},
    },
    repeat::{
        lattice::{Lattice, Node},
        marks::place_of,
        orbits::Instance,
    },
};

/// Strokes wider than this share of the shorter vector are bands, whose ink shows beyond the border that cuts their middle.
pub(crate) const BAND: f64 = 0.05;

/// Elements of two charts are not nearer to each other than this share of what such elements are in the exemplar.
const APART: f64 = 0.6;

/// The same of elements beside the chart that they belong to, which fill the gaps between charts; these lie no farther
/// beyond its border than that share of the shorter vector.
const BESIDE: (f64, f64) = (0.85, 0.6);

/// Places of one cell of which every two are compared, at most.
const COMPARED: usize = 64;

/// Cells for which memory is asked for at once.
const HOLD: usize = 256;

/// Work for a place that is looked for.
const FIND: u64 = 1500;

/// Where a pattern is bent.
pub(crate) struct Bending<'a> {
    pub(crate) charts: &'a Charts,
    pub(crate) lattice: &'a Lattice,
    pub(crate) request: &'a Request<2>,
    pub(crate) obstacles: Option<&'a Shape>,
}

/// Elements that lie already, with the orbits that they are of.
struct Laid {
    /// How near to them others may lie, as a share of how near they lie in the exemplar.
    share: f64,
    orbits: Vec<usize>,
    index: GridIndex<2>,
}

impl Bending<'_> {
    /// The nodes of a lattice whose cells, with a corner at `origin` in the exemplar, may lie in a chart.
    ///
    /// # Errors
    /// When there are more than may be asked about.
    pub(crate) fn nodes(&self, chart: &Chart, origin: Vector<2>) -> Result<Vec<Node>> {
        let budget = &self.request.budget;
        let extent = chart.extent().grown(BESIDE.1 * self.lattice.shorter());
        let [rows, columns] = self.lattice.nodes_in(origin, &extent);
        let count = (rows.end() - rows.start() + 3) as f64 * (columns.end() - columns.start() + 3) as f64;
        budget.within_expected("cells of the repeat", count, ("output-elements", budget.limits().output_elements))?;
        budget.spend((20.0 * count) as u64)?;
        let rows = rows.start() - 1..=rows.end() + 1;
        let all = (columns.start() - 1..=columns.end() + 1).flat_map(|j| rows.clone().map(move |i| [i, j]));
        let [a, b] = self.lattice.vectors;
        let near = |node: &Node| {
            let corner = origin + self.lattice.at(*node);
            Bounds::around([corner, corner + a, corner + b, corner + a + b]).intersects(&extent)
        };
        Ok(all.filter(near).collect())
    }

    /// Places elements, chart by chart.
    pub(crate) fn place(&self, elements: &Elements<'_>, watch: &mut dyn Watch<Snapshot<2>>) -> Result<Placed> {
        let admission = Admission::new(self.request, self.obstacles, Vec::<Outline<2>>::new());
        let apart = self.apart(elements);
        let (mut placements, mut laid) = (Vec::new(), Vec::new());
        let charts = &self.charts.all;
        // Once for what lies in the charts, and once for the gaps that are left between several.
        let count = if charts.len() > 1 && !apart.is_empty() { 2 * charts.len() } else { charts.len() };
        for k in 0..count {
            let fills_gaps = k >= charts.len();
            let share = if fills_gaps { BESIDE.0 } else { APART };
            let before = Laid::new(&laid, &self.request.domain.bounds(), share);
            let has_room = |spot: &Spot, o: usize, p: Vector<2>| before.admits(&apart, spot, o, p);
            let done = self.chart(elements, (k % charts.len(), fills_gaps), &admission, &has_room);
            let ended = done.map(|(placed, of)| {
                placements.extend(placed);
                laid.extend(of);
            });
            let progress = Progress {
                stage: "continuing the repeat".into(),
                done: k + 1,
                total: count,
                fraction: (k + 1) as f64 / count as f64,
                energy: None,
                count: placements.len(),
            };
            let preview = || Snapshot { placements: placements.clone(), ..Snapshot::default() };
            let ended = ended.and_then(|()| heard(watch.step(&progress, &preview), &progress));
            if let Err(error) = ended {
                return Ok(Placed { placements, ended: Err(error) });
            }
        }
        Ok(Placed { placements, ended: Ok(()) })
    }

    #[expect(clippy::type_complexity, reason = "placements, and where and of which orbit they are")]
    fn chart(
        &self,
        elements: &Elements<'_>,
        (number, fills_gaps): (usize, bool),
        admission: &Admission<'_>,
        has_room: &dyn Fn(&Spot, usize, Vector<2>) -> bool,
    ) -> Result<(Vec<Placement<2>>, Vec<(Vector<2>, usize)>)> {
        let budget = self.request.budget.stage("laying out");
        let (orbits, chart) = (elements.orbits, &self.charts.all[number]);
        let find = |image: Vector<2>| match chart.find(image) {
            Some(_) if fills_gaps => None,
            None if fills_gaps => chart.find_beyond(image, BESIDE.1 * self.lattice.shorter()),
            found => found,
        };
        let (mut nodes, mut spots, mut held) = (Vec::new(), Vec::new(), Vec::new());
        let each = size_of::<Vec<u32>>() + orbits.len() * (size_of::<u32>() + size_of::<Option<Spot>>());
        for node in self.nodes(chart, Vector::ZERO)? {
            budget.spend(FIND * orbits.len() as u64)?;
            let at = self.lattice.at(node);
            let of: Vec<Option<Spot>> = orbits.iter().map(|orbit| find(orbit.base + at)).collect();
            if of.iter().any(Option::is_some) {
                if nodes.len().is_multiple_of(HOLD) {
                    held.push(budget.hold("cells of the repeat", HOLD * each)?);
                }
                nodes.push(node);
                spots.push(of);
            }
        }
        let number_of: BTreeMap<Node, usize> = nodes.iter().enumerate().map(|(k, &n)| (n, k)).collect();
        let beside = |node: Node| number_of.get(&node).copied();
        let seed = self.request.seed.wrapping_add((number as u64) << 32);
        let chosen = elements.cells.choose(&nodes, &beside, seed, &budget)?;
        let (mut placements, mut laid) = (Vec::new(), Vec::new());
        for (cell, of) in chosen.iter().zip(&spots) {
            for (o, (spot, &instance)) in of.iter().zip(cell).enumerate() {
                let Some(spot) = spot else { continue };
                let placement = self.placement(elements, &orbits[o].instances[instance as usize], spot);
                let p = placement.transform.apply(elements.exemplar.elements[placement.source].centre);
                if has_room(spot, o, spot.at)
                    && admission.admits(&outline_of(&placement, elements.exemplar), p, &budget)?
                {
                    placements.push(placement);
                    laid.push((spot.at, o));
                }
            }
        }
        Ok((placements, laid))
    }

    fn placement(&self, elements: &Elements<'_>, instance: &Instance, spot: &Spot) -> Placement<2> {
        let element = &elements.exemplar.elements[instance.element as usize];
        let at = spot.at + spot.outward.apply(instance.residual);
        let (rotation, growth) = spot.frame();
        let wanted = self.request.fields.frame(spot.at);
        let scale = growth * wanted.element_scale / wanted.spacing_scale;
        let transform = Similarity::about(place_of(element, elements.anchor), at, rotation, scale);
        Placement { source: instance.element as usize, transform, control: Vec::new(), frozen: None }
    }

    /// How near elements of two orbits lie to each other in the exemplar; nothing where there are very many orbits.
    fn apart(&self, elements: &Elements<'_>) -> Vec<Vec<f64>> {
        let orbits = elements.orbits;
        if orbits.len() > COMPARED {
            return Vec::new();
        }
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [i, j])).collect::<Vec<Node>>();
        let least = |a: usize, b: usize| {
            let off = orbits[b].base - orbits[a].base;
            let off = self.lattice.nearest(off).1;
            let steps = around.iter().filter(|step| a != b || **step != [0, 0]);
            steps.map(|&step| (off + self.lattice.at(step)).norm()).fold(f64::INFINITY, f64::min)
        };
        (0..orbits.len()).map(|a| (0..orbits.len()).map(|b| least(a, b)).collect()).collect()
    }
}

impl Laid {
    fn new(laid: &[(Vector<2>, usize)], bounds: &Bounds<2>, share: f64) -> Self {
        let places: Vec<_> = laid.iter().map(|(p, _)| *p).collect();
        let cell = 2.0 * (bounds.measure() / (places.len() as f64 + 1.0)).sqrt();
        let around = Bounds::around(places.iter().copied().chain([bounds.min, bounds.max])).grown(cell);
        Self {
            share,
            orbits: laid.iter().map(|(_, o)| *o).collect(),
            index: GridIndex::new(&places, cell, &Domain::Box(around)),
        }
    }

    /// Whether an element of an orbit has room beside what lies already.
    fn admits(&self, apart: &[Vec<f64>], spot: &Spot, orbit: usize, p: Vector<2>) -> bool {
        let Some(apart) = apart.get(orbit) else { return true };
        let (_, growth) = spot.frame();
        let reach = self.share * growth * apart.iter().copied().fold(0.0, f64::max);
        let mut is_free = true;
        self.index.within(p, reach, |k, offset| {
            is_free = is_free && offset.norm() >= self.share * growth * apart[self.orbits[k]];
        });
        is_free
    }
}
