//! Plane regions bounded by polygons.

use crate::{
    region::{
        FillRule, Outline, Region, Ring,
        segment::{self, Segment},
    },
    space::{Bounds, Vector},
};

/// One or several shapes with holes, ready for distance queries.
///
/// Edges lie in the cells of a uniform grid; a query walks the rings of cells around it until no nearer edge can come.
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
}

impl Shape {
    /// The region that `rings` enclose under `rule`, or `None` when they enclose no area.
    pub fn new(rings: &[Ring<2>], rule: FillRule) -> Option<Self> {
        Self::from_outline(Outline::union(rings, rule))
    }

    /// The region covered by an outline, or `None` when it has no area.
    pub fn from_outline(outline: Outline<2>) -> Option<Self> {
        let bounds = outline.bounds();
        let area = outline.area();
        if bounds.is_empty() || area <= 1e-12 * bounds.size().norm2() {
            return None;
        }
        let edges: Vec<_> = outline.edges().collect();
        let cells = edges.len().clamp(64, 65_536) as f64;
        let cell = (bounds.measure() / cells).sqrt().max(bounds.size()[0].max(bounds.size()[1]) / 1024.0);
        let columns = (bounds.size()[0] / cell) as usize + 1;
        let rows = (bounds.size()[1] / cell) as usize + 1;
        let mut shape = Self {
            outline,
            bounds,
            area,
            edges,
            cell,
            columns,
            rows,
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
    pub fn without(&self, other: &Self) -> Option<Self> {
        Self::from_outline(self.outline.difference(&other.outline))
    }

    /// The part of the shape that also lies in `other`, or `None` when nothing is left.
    pub fn within(&self, other: &Self) -> Option<Self> {
        Self::from_outline(self.outline.intersection(&other.outline))
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

    fn index_edges(&mut self) {
        let mut lists = vec![Vec::new(); self.columns * self.rows];
        for (k, &(a, b)) in self.edges.iter().enumerate() {
            // A box per edge is coarse for long diagonals, but edges of flattened outlines are short.
            let (c0, r0) = self.column_row(a.zip(b, f64::min));
            let (c1, r1) = self.column_row(a.zip(b, f64::max));
            for r in r0..=r1 {
                for c in c0..=c1 {
                    lists[r * self.columns + c].push(k as u32);
                }
            }
        }
        self.starts = std::iter::once(0)
            .chain(lists.iter().scan(0, |sum, list| {
                *sum += list.len();
                Some(*sum)
            }))
            .collect();
        self.members = lists.concat();
    }

    fn mark_centres(&mut self) {
        let mut inside = vec![false; self.columns * self.rows];
        for r in 0..self.rows {
            let y = self.bounds.min[1] + (r as f64 + 0.5) * self.cell;
            let mut crossings: Vec<f64> =
                self.edges.iter().filter_map(|&edge| segment::crossing_at_height(edge, y)).collect();
            crossings.sort_by(f64::total_cmp);
            for c in 0..self.columns {
                let x = self.bounds.min[0] + (c as f64 + 0.5) * self.cell;
                inside[r * self.columns + c] = crossings.partition_point(|&v| v <= x) % 2 == 1;
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
        let outside = (p - self.bounds.clamp(p)).norm();
        let (mut best, mut best2) = (self.edges[0].0, f64::INFINITY);
        for reach in 0..self.columns.max(self.rows) {
            // Every edge not looked at yet is farther than `reach - 1` cells from the clamped point.
            let sure = ((reach as f64 - 1.0) * self.cell - outside).max(0.0);
            if best2 <= sure * sure {
                break;
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
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Stage, Stream};

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
        assert!((all.without(&half).unwrap().measure() - 8.0).abs() < 1e-6);
        assert!((all.within(&half).unwrap().measure() - 8.0).abs() < 1e-6);
        assert!(half.without(&half).is_none());
    }
}
