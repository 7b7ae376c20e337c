//! Filled areas on a lattice: the part of them in one cell, copied to all cells and united again.

use arabesque_core::{
    Border, Bounds, Budget, Covered, Domain, Exemplar, FillRule, Outline, Result, Ring, Shape, Vector, ring,
};

use crate::{
    regular::grid::{Grid, Ground},
    repeat::lattice::{Lattice, Node},
};

/// Cells overlap by this share of the shorter vector, so that no hair line is left between them.
const OVERLAP: f64 = 1e-4;

/// How far areas reach over the sides of a tile, as a share of its shorter side.
const BLEED: f64 = 0.01;

/// Cells that are united at once; what comes of them is united again.
const AT_ONCE: usize = 64;

/// What one cell holds of the areas of one style.
#[derive(Clone, Debug)]
pub(crate) struct CellArea {
    /// The first area of the style, as which it is painted.
    pub(crate) source: usize,
    /// The part in the cell, which is a little larger than the cell.
    pub(crate) rings: Vec<Ring<2>>,
}

impl CellArea {
    /// Whether a place is covered: areas of one style lie apart.
    pub(crate) fn contains(&self, place: Vector<2>) -> bool {
        ring::covers(self.rings.iter().flat_map(|r| ring::edges(r)), place)
    }
}

/// The areas of a cell of the lattice with its corner at `origin`, style by style in drawing order.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn cell_areas(
    exemplar: &Exemplar<2>,
    lattice: &Lattice,
    origin: Vector<2>,
    budget: &Budget,
) -> Result<Vec<CellArea>> {
    let mut made: Vec<CellArea> = Vec::new();
    let cell = Outline { rings: vec![parallelogram(origin, lattice)] };
    for (source, area) in exemplar.areas.iter().enumerate() {
        let part = area.outline.try_intersection(&cell, budget)?;
        match made.iter_mut().find(|m| exemplar.areas[m.source].style == area.style) {
            // Areas of one style that overlap are seen as two where the paint is translucent.
            Some(known) if !overlap(&known.rings, &part, budget)? => known.rings.extend(part.rings),
            _ => made.push(CellArea { source, rings: part.rings }),
        }
    }
    made.retain(|area| !area.rings.is_empty());
    Ok(made)
}

fn overlap(rings: &[Ring<2>], other: &Outline<2>, budget: &Budget) -> Result<bool> {
    // Of the many rings of a style, those far away cover nothing of it.
    let extent = other.bounds();
    let is_near = |ring: &&Ring<2>| Bounds::around(ring.iter().copied()).intersects(&extent);
    let common = Outline { rings: rings.iter().filter(is_near).cloned().collect() }.try_intersection(other, budget)?;
    Ok(common.area() > 1e-3 * other.area())
}

/// The cell, and a little of the cells around it.
fn parallelogram(origin: Vector<2>, lattice: &Lattice) -> Ring<2> {
    let [a, b] = lattice.vectors;
    let shorter = a.norm().min(b.norm());
    let (p, q) = (a.unit_or_zero() * (OVERLAP * shorter), b.unit_or_zero() * (OVERLAP * shorter));
    let corner = origin - p - q;
    let (a, b) = (a + p * 2.0, b + q * 2.0);
    vec![corner, corner + a, corner + a + b, corner + b]
}

/// Adds the areas of the cell, in all cells that are seen, to `made`, cut at the border of the domain.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop; what is made by then is whole.
pub(crate) fn draw(
    areas: &[CellArea],
    origin: Vector<2>,
    ground: &Ground<'_>,
    made: &mut Vec<Covered<2>>,
) -> Result<()> {
    if areas.is_empty() {
        return Ok(());
    }
    let budget = &ground.request.budget.stage("filling areas");
    let cut = Cut::new(ground);
    let nodes = ground.grid.nodes_around(origin, &seen(&ground.request.domain), budget)?;
    for area in areas {
        let whole = united(area, ground.grid, &nodes, budget)?;
        let outline = cut.apply(whole, budget)?;
        if !outline.rings.is_empty() {
            made.push(Covered { outline, source: area.source, paint: ground.grid.map() });
        }
    }
    Ok(())
}

/// The box in which a domain is seen: a tile with a little around it, where it overlaps with those beside it.
fn seen(domain: &Domain<2>) -> Bounds<2> {
    let bounds = domain.bounds();
    let [width, height] = bounds.size().0;
    if domain.period().is_some() { bounds.grown(BLEED * width.min(height)) } else { bounds }
}

/// The copies of a part in all cells, as one.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn united(area: &CellArea, grid: &Grid, nodes: &[Node], budget: &Budget) -> Result<Outline<2>> {
    let copy = |node: Node| area.rings.iter().map(move |ring| ring.iter().map(|&p| grid.place(p, node)).collect());
    let mut parts: Vec<Outline<2>> = Vec::new();
    for cells in nodes.chunks(AT_ONCE) {
        let rings: Vec<Ring<2>> = cells.iter().flat_map(|&node| copy(node)).collect();
        parts.push(Outline::try_union(&rings, FillRule::NonZero, budget)?);
    }
    while parts.len() > 1 {
        let mut fewer = Vec::with_capacity(parts.len().div_ceil(AT_ONCE));
        for group in parts.chunks(AT_ONCE) {
            let rings: Vec<Ring<2>> = group.iter().flat_map(|part| part.rings.iter().cloned()).collect();
            fewer.push(Outline::try_union(&rings, FillRule::NonZero, budget)?);
        }
        parts = fewer;
    }
    Ok(parts.pop().unwrap_or_default())
}

fn rectangle(b: &Bounds<2>) -> Outline<2> {
    Outline { rings: vec![vec![b.min, Vector::xy(b.max[0], b.min[1]), b.max, Vector::xy(b.min[0], b.max[1])]] }
}

/// Cutting areas at the border and at what is in the way.
pub(crate) struct Cut<'a> {
    domain: Option<Outline<2>>,
    obstacles: Option<&'a Shape>,
}

impl<'a> Cut<'a> {
    /// For a domain and its surroundings.
    pub(crate) fn new(ground: &Ground<'a>) -> Self {
        let request = ground.request;
        let crosses = request.border == Border::Cross && request.known.is_none();
        let domain = match &request.domain {
            torus @ Domain::Torus(_) => Some(rectangle(&seen(torus))),
            _ if crosses => None,
            domain => domain.outline(),
        };
        Self { domain, obstacles: ground.obstacles }
    }

    /// What is left of an area.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn apply(&self, outline: Outline<2>, budget: &Budget) -> Result<Outline<2>> {
        let inside = match &self.domain {
            Some(domain) => outline.try_intersection(domain, budget)?,
            None => outline,
        };
        match self.obstacles {
            Some(obstacles) => inside.try_difference(obstacles.outline(), budget),
            None => Ok(inside),
        }
    }
}
