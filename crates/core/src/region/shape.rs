//! Plane regions bounded by polygons.

use crate::{
    budget::Budget,
    error::Result,
    region::{
        FillRule, Outline, Region, Ring,
        crossings::in_range,
        edge_tree::EdgeTree,
        segment::{self, Segment},
    },
    space::{Bounds, Vector},
};

/// Cells of the index, at most.
const MOST_CELLS: usize = 65_536;
/// Places of edges in cells, for each edge and cell: where there would be more, as with many thousands of long edges, cells get larger.
const MOST: usize = 16;
/// How many may be in any case.
const ALLOWED: usize = 10_000_000;

/// Places of so many edges in cells, at most.
fn most_entries(edges: usize) -> usize {
    (MOST * (edges + MOST_CELLS)).max(ALLOWED)
}

/// Work for each edge, and for each cell.
const PER_ENTRY: u64 = 300;

/// Rings of cells that are walked before the tree is asked.
const RINGS: usize = 3;

/// One or several shapes with holes, ready for distance queries.
///
/// Edges lie in the cells of a uniform grid; a query walks the first rings of cells around it, which nearly always tells the nearest
/// edge, and asks a tree of boxes where the border is farther away.
#[derive(Clone, Debug)]
pub struct Shape {
    outline: Outline<2>,
    bounds: Bounds<2>,
    area: f64,
    edges: Vec<Segment<2>>,
    cell: f64,
    columns: usize,
    rows: usize,
    /// Edges of cell `c`: `members[starts[c]..starts[c + 1]]`.
    starts: Vec<usize>,
    members: Vec<u32>,
    /// Whether the centre of cell `c` is inside.
    centre_inside: Vec<bool>,
    /// The same edges, for places far from all of them.
    tree: EdgeTree,
}

impl Shape {
    /// The region that `rings` enclose under `rule`, or `None` when they enclose no area.
    ///
    /// # Errors
    /// As [`Outline::try_union`].
    pub fn try_new(rings: &[Ring<2>], rule: FillRule, budget: &Budget) -> Result<Option<Self>> {
        Self::try_from_outline(Outline::try_union(rings, rule, budget)?, budget)
    }

    /// As [`Shape::try_new`], for outlines of bounded size: nothing is counted, and nothing refused.
    pub fn new(rings: &[Ring<2>], rule: FillRule) -> Option<Self> {
        Self::from_outline(Outline::union(rings, rule))
    }

    /// The region covered by an outline, or `None` when it has no area.
    ///
    /// # Errors
    /// [`Error::Limit`](crate::Error::Limit) when the work or memory for its index is used up,
    /// [`Error::Input`](crate::Error::Input) when a coordinate is no sensible number.
    pub fn try_from_outline(outline: Outline<2>, budget: &Budget) -> Result<Option<Self>> {
        let corners = outline.rings.iter().map(Vec::len).sum::<usize>();
        budget.within("corners of outlines", corners, ("outline-nodes", budget.limits().outline_nodes))?;
        in_range(outline.points(), budget)?;
        // Whether one edge takes much or little of the index, all of them together take no more than this.
        let most = most_entries(corners);
        budget.spend(PER_ENTRY * (corners + MOST_CELLS.min(corners * MOST)) as u64)?;
        drop(budget.hold("outlines", 16 * most.min(corners * MOST_CELLS))?);
        Ok(Self::from_outline(outline))
    }

    /// As [`Shape::try_from_outline`], for outlines of bounded size: nothing is counted, and nothing refused.
    pub fn from_outline(outline: Outline<2>) -> Option<Self> {
        let bounds = outline.bounds();
        let area = outline.area();
        if bounds.is_empty() || area <= 1e-12 * bounds.size().norm2() {
            return None;
        }
        let edges: Vec<_> = outline.edges().collect();
        let cells = edges.len().clamp(64, MOST_CELLS) as f64;
        let mut shape = Self {
            tree: EdgeTree::new(&edges),
            outline,
            bounds,
            area,
            edges,
            cell: (bounds.measure() / cells).sqrt().max(bounds.size()[0].max(bounds.size()[1]) / 1024.0),
            columns: 0,
            rows: 0,
            starts: Vec::new(),
            members: Vec::new(),
            centre_inside: Vec::new(),
        };
        shape.index_edges();
        shape.mark_centres();
        Some(shape)
    }

    /// The polygons.
    pub fn outline(&self) -> &Outline<2> {
        &self.outline
    }

    /// The shape without the area of `other`, or `None` when nothing is left.
    ///
    /// # Errors
    /// As [`Outline::try_difference`].
    pub fn without(&self, other: &Self, budget: &Budget) -> Result<Option<Self>> {
        Self::try_from_outline(self.outline.try_difference(&other.outline, budget)?, budget)
    }

    /// The part of the shape that also lies in `other`, or `None` when nothing is left.
    ///
    /// # Errors
    /// As [`Outline::try_intersection`].
    pub fn within(&self, other: &Self, budget: &Budget) -> Result<Option<Self>> {
        Self::try_from_outline(self.outline.try_intersection(&other.outline, budget)?, budget)
    }

    /// A rectangle.
    pub fn rectangle(bounds: Bounds<2>) -> Option<Self> {
        let (a, b) = (bounds.min, bounds.max);
        Self::new(&[vec![a, Vector::xy(b[0], a[1]), b, Vector::xy(a[0], b[1])]], FillRule::NonZero)
    }

    fn column_row(&self, p: Vector<2>) -> (usize, usize) {
        let at = |v: f64, n: usize| ((v / self.cell).max(0.0) as usize).min(n - 1);
        (at(p[0] - self.bounds.min[0], self.columns), at(p[1] - self.bounds.min[1], self.rows))
    }

    /// Lays the edges into cells as small as may be, without many cells to an edge.
    fn index_edges(&mut self) {
        let most = most_entries(self.edges.len());
        loop {
            let across = |k: usize| (self.bounds.size()[k] / self.cell) as usize + 1;
            (self.columns, self.rows) = (across(0), across(1));
            // A box per edge is coarse for long diagonals, but edges of flattened outlines are short.
            let in_box = |edge: &Segment<2>| {
                let ((c0, r0), (c1, r1)) = self.box_of(edge);
                (c1 - c0 + 1) * (r1 - r0 + 1)
            };
            let along = |edge: &Segment<2>| {
                let ((c0, r0), (c1, r1)) = self.box_of(edge);
                2 * (c1 - c0 + r1 - r0 + 1)
            };
            let total = |cells: &dyn Fn(&Segment<2>) -> usize| self.edges.iter().map(cells).sum::<usize>();
            let by_box = total(&in_box) <= most;
            if by_box || total(&along) <= most || self.columns.max(self.rows) <= 2 {
                return self.fill_cells(by_box);
            }
            self.cell *= 2.0;
        }
    }

    /// The cells at the corners of the box around an edge.
    fn box_of(&self, &(a, b): &Segment<2>) -> ((usize, usize), (usize, usize)) {
        (self.column_row(a.zip(b, f64::min)), self.column_row(a.zip(b, f64::max)))
    }

    fn fill_cells(&mut self, by_box: bool) {
        let mut counts = vec![0; self.columns * self.rows + 1];
        self.each_cell(by_box, |cell, _| counts[cell + 1] += 1);
        (1..counts.len()).for_each(|c| counts[c] += counts[c - 1]);
        let mut members = vec![0; counts[self.columns * self.rows]];
        let mut next = counts.clone();
        self.each_cell(by_box, |cell, edge| {
            members[next[cell]] = edge;
            next[cell] += 1;
        });
        (self.starts, self.members) = (counts, members);
    }

    /// Calls `visit` with each cell of each edge, edge by edge: all cells of the box around it, or those that it runs through.
    fn each_cell(&self, by_box: bool, mut visit: impl FnMut(usize, u32)) {
        for (k, edge) in self.edges.iter().enumerate() {
            let ((c0, r0), (c1, r1)) = self.box_of(edge);
            for r in r0..=r1 {
                let (from, to) = if by_box { (c0, c1) } else { self.columns_in(edge, r, (c0, c1)) };
                (from..=to).for_each(|c| visit(r * self.columns + c, k as u32));
            }
        }
    }

    /// The columns in which an edge runs through a row, a little more for rounding.
    fn columns_in(&self, &(a, b): &Segment<2>, row: usize, (first, last): (usize, usize)) -> (usize, usize) {
        let low = self.bounds.min[1] + row as f64 * self.cell;
        let share = |y: f64| if a[1] == b[1] { f64::NAN } else { ((y - a[1]) / (b[1] - a[1])).clamp(0.0, 1.0) };
        let [s, t] = [share(low), share(low + self.cell)];
        if s.is_nan() {
            return (first, last);
        }
        let [x0, x1] = [s, t].map(|s| a[0] + (b[0] - a[0]) * s - self.bounds.min[0]);
        let column = |x: f64| (x / self.cell).clamp(first as f64, last as f64) as usize;
        (column(x0.min(x1) - 0.01 * self.cell), column(x0.max(x1) + 0.01 * self.cell))
    }

    fn mark_centres(&mut self) {
        let mut crossings: Vec<Vec<f64>> = vec![Vec::new(); self.rows];
        for edge in &self.edges {
            let ((_, r0), (_, r1)) = self.box_of(edge);
            for (r, row) in crossings.iter_mut().enumerate().take(r1 + 1).skip(r0) {
                row.extend(segment::crossing_at_height(*edge, self.bounds.min[1] + (r as f64 + 0.5) * self.cell));
            }
        }
        let mut inside = vec![false; self.columns * self.rows];
        for (r, row) in crossings.iter_mut().enumerate() {
            row.sort_by(f64::total_cmp);
            for c in 0..self.columns {
                let x = self.bounds.min[0] + (c as f64 + 0.5) * self.cell;
                inside[r * self.columns + c] = row.partition_point(|&v| v <= x) % 2 == 1;
            }
        }
        self.centre_inside = inside;
    }

    /// Edges of the cells in the box between two corner cells.
    fn edges_in(&self, low: (usize, usize), high: (usize, usize)) -> impl Iterator<Item = usize> + '_ {
        (low.1..=high.1).flat_map(move |r| {
            let row = r * self.columns;
            self.members[self.starts[row + low.0]..self.starts[row + high.0 + 1]].iter().map(|&k| k as usize)
        })
    }

    /// How far a point is from whatever lies `reach` cells from its own or farther.
    fn room(&self, p: Vector<2>, (c, r): (usize, usize), reach: usize) -> f64 {
        if reach == 0 {
            return 0.0;
        }
        let along = |at: usize, n: usize, v: f64| {
            let low = if at < reach { f64::INFINITY } else { v - (at + 1 - reach) as f64 * self.cell };
            let high = if at + reach >= n { f64::INFINITY } else { (at + reach) as f64 * self.cell - v };
            low.min(high)
        };
        let from = p - self.bounds.min;
        // A little less, for rounding.
        along(c, self.columns, from[0]).min(along(r, self.rows, from[1])) - 1e-6 * self.cell
    }

    fn contains(&self, p: Vector<2>) -> bool {
        if !self.bounds.contains(p) {
            return false;
        }
        // Walk from the centre of the cell to `p`: each edge of the cell that is crossed flips the answer.
        let (c, r) = self.column_row(p);
        let centre = self.bounds.min + Vector::xy(c as f64 + 0.5, r as f64 + 0.5) * self.cell;
        let flips = self.edges_in((c, r), (c, r)).filter(|&k| segment::crosses(self.edges[k], (centre, p))).count();
        self.centre_inside[r * self.columns + c] ^ (flips % 2 == 1)
    }
}

impl Region<2> for Shape {
    fn outline(&self) -> Option<&Outline<2>> {
        Some(&self.outline)
    }

    fn bounds(&self) -> Bounds<2> {
        self.bounds
    }

    fn measure(&self) -> f64 {
        self.area
    }

    fn signed_distance(&self, p: Vector<2>) -> f64 {
        let distance = (self.nearest_boundary(p) - p).norm();
        if self.contains(p) { distance } else { -distance }
    }

    fn nearest_boundary(&self, p: Vector<2>) -> Vector<2> {
        let (c, r) = self.column_row(p);
        let clamped = self.bounds.clamp(p);
        let outside = (p - clamped).norm();
        let (mut best, mut best2) = (self.edges[0].0, f64::INFINITY);
        for reach in 0..RINGS.min(self.columns.max(self.rows)) {
            // Every edge not looked at yet lies beyond the cells that were looked at.
            let sure = (self.room(clamped, (c, r), reach) - outside).max(0.0);
            if best2 <= sure * sure {
                return best;
            }
            let low = (c.saturating_sub(reach), r.saturating_sub(reach));
            let high = ((c + reach).min(self.columns - 1), (r + reach).min(self.rows - 1));
            for k in self.edges_in(low, high) {
                let q = segment::nearest(self.edges[k], p);
                let d2 = (q - p).norm2();
                if d2 < best2 {
                    (best, best2) = (q, d2);
                }
            }
        }
        self.tree.nearest(p, best2).map_or(best, |(q, _)| q)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        random::{Stage, Stream},
        region::ring,
    };

    fn ring(n: usize, radius: f64) -> Ring<2> {
        (0..n)
            .map(|k| {
                let a = k as f64 / n as f64 * std::f64::consts::TAU;
                Vector::xy(radius * a.cos(), radius * a.sin())
            })
            .collect()
    }

    #[test]
    fn an_annulus_knows_its_inside_and_its_distances() {
        let shape = Shape::new(&[ring(720, 10.0), ring(720, 4.0)], FillRule::EvenOdd).unwrap();
        assert!((shape.measure() - std::f64::consts::PI * 84.0).abs() < 0.1);
        let mut s = Stream::new(1, Stage::TEST, 0);
        for _ in 0..2000 {
            let p = Vector::xy(s.range(-13.0, 13.0), s.range(-13.0, 13.0));
            let r = p.norm();
            let want = (10.0 - r).min(r - 4.0);
            assert!((shape.signed_distance(p) - want).abs() < 0.01, "{p:?}: {} {want}", shape.signed_distance(p));
        }
    }

    #[test]
    fn rings_without_area_are_no_shape() {
        assert!(Shape::new(&[vec![Vector::xy(0.0, 0.0), Vector::xy(5.0, 5.0)]], FillRule::NonZero).is_none());
    }

    #[test]
    fn taking_one_shape_out_of_another() {
        let all = Shape::rectangle(Bounds::new(Vector::xy(0.0, 0.0), Vector::xy(4.0, 4.0))).unwrap();
        let half = Shape::rectangle(Bounds::new(Vector::xy(2.0, -1.0), Vector::xy(9.0, 9.0))).unwrap();
        let budget = Budget::default();
        assert!((all.without(&half, &budget).unwrap().unwrap().measure() - 8.0).abs() < 1e-6);
        assert!((all.within(&half, &budget).unwrap().unwrap().measure() - 8.0).abs() < 1e-6);
        assert!(half.without(&half, &budget).unwrap().is_none());
    }

    #[test]
    fn thousands_of_long_edges_take_a_bounded_index_and_answer_alike() {
        // A comb with long slanting teeth: the box around each is as large as the shape.
        let teeth = 6000;
        let root = |k: usize| Vector::xy(0.02 * k as f64, 0.02 * k as f64);
        let tip = |k: usize| root(k) + Vector::xy(-90.0, 90.0);
        let mut comb: Ring<2> = (0..teeth).map(|k| if k % 2 == 0 { root(k) } else { tip(k) }).collect();
        comb.push(root(teeth) + Vector::xy(1.0, -1.0));
        comb.push(Vector::xy(1.0, -1.0));
        let shape = Shape::from_outline(Outline { rings: vec![comb] }).unwrap();
        assert!(shape.members.len() <= most_entries(shape.edges.len()), "{}", shape.members.len());
        let mut s = Stream::new(1, Stage::TEST, 0);
        for _ in 0..100 {
            let p = Vector::xy(s.range(-95.0, 125.0), s.range(-5.0, 215.0));
            let nearest = shape.edges.iter().map(|&e| segment::distance(e, p)).fold(f64::INFINITY, f64::min);
            let want = if ring::covers(shape.edges.iter().copied(), p) { nearest } else { -nearest };
            assert!((shape.signed_distance(p) - want).abs() < 1e-9, "{p:?}");
        }
    }
}
