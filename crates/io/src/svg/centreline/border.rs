//! Straight looks from a point inside an outline to its border.

use arabesque_core::{Bounds, Outline, Vector};

/// Gaps and overlaps up to this share of the cell side are looked through: seams between abutting pieces.
const SEAM: f64 = 0.06;

/// The edges of an outline in cells.
#[derive(Debug)]
pub(super) struct OutlineBorder {
    bounds: Bounds<2>,
    side: f64,
    columns: usize,
    rows: usize,
    cells: Vec<Vec<u32>>,
    edges: Vec<(Vector<2>, Vector<2>)>,
}

impl OutlineBorder {
    /// Sorts the edges into cells of the given side, about the width of the strokes.
    pub(super) fn new(outline: &Outline<2>, side: f64) -> Self {
        let bounds = outline.bounds();
        let count = |k: usize| ((bounds.size()[k] / side).floor().max(0.0) as usize) + 1;
        let (columns, rows) = (count(0), count(1));
        let mut border =
            Self { bounds, side, columns, rows, cells: vec![Vec::new(); columns * rows], edges: Vec::new() };
        for (a, b) in outline.edges() {
            let id = border.edges.len() as u32;
            border.edges.push((a, b));
            // A long edge is entered piece by piece, so that it does not fill its whole box.
            let pieces = ((b - a).norm() / side).ceil().max(1.0);
            for k in 0..pieces as usize {
                let at = |share: f64| a + (b - a) * (share / pieces);
                border.enter(id, at(k as f64), at(k as f64 + 1.0));
            }
        }
        border
    }

    fn enter(&mut self, id: u32, a: Vector<2>, b: Vector<2>) {
        for cell in self.cells_between(a, b) {
            if self.cells[cell].last() != Some(&id) {
                self.cells[cell].push(id);
            }
        }
    }

    fn cells_between(&self, a: Vector<2>, b: Vector<2>) -> Vec<usize> {
        let index = |v: f64, k: usize, n: usize| (((v - self.bounds.min[k]) / self.side).max(0.0) as usize).min(n - 1);
        let (low, high) = (a.zip(b, f64::min), a.zip(b, f64::max));
        let columns = index(low[0], 0, self.columns)..=index(high[0], 0, self.columns);
        (index(low[1], 1, self.rows)..=index(high[1], 1, self.rows))
            .flat_map(|row| columns.clone().map(move |column| row * self.columns + column))
            .collect()
    }

    /// How far the outline reaches from `p` inside it in direction `way` (of length one); `None` if farther than
    /// `most`.
    pub(super) fn reach(&self, p: Vector<2>, way: Vector<2>, most: f64) -> Option<f64> {
        let mut ids: Vec<u32> = self
            .cells_between(p, p + way * most)
            .into_iter()
            .flat_map(|cell| self.cells[cell].iter().copied())
            .collect();
        ids.sort_unstable();
        ids.dedup();
        let mut hits: Vec<f64> = ids.into_iter().filter_map(|id| self.hit(id, p, way)).collect();
        hits.sort_by(f64::total_cmp);
        let mut hits = hits.into_iter().filter(|d| *d > 0.0 && *d <= most).peekable();
        while let Some(exit) = hits.next() {
            match hits.peek() {
                Some(entry) if entry - exit < SEAM * self.side => {
                    hits.next();
                }
                _ => return Some(exit),
            }
        }
        None
    }

    fn hit(&self, id: u32, p: Vector<2>, way: Vector<2>) -> Option<f64> {
        let (a, b) = self.edges[id as usize];
        let (sa, sb) = (way.cross(a - p), way.cross(b - p));
        if (sa >= 0.0) == (sb >= 0.0) {
            return None;
        }
        Some((a + (b - a) * (sa / (sa - sb)) - p).dot(way))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reach_looks_through_seams_only() {
        let bar = |x: f64, y: f64, w: f64| {
            vec![Vector::xy(x, y), Vector::xy(x + w, y), Vector::xy(x + w, y + 1.0), Vector::xy(x, y + 1.0)]
        };
        let outline = Outline { rings: vec![bar(0.0, 0.0, 2.0), bar(2.01, 0.0, 1.0), bar(3.5, 0.0, 1.0)] };
        let border = OutlineBorder::new(&outline, 1.0);
        let reach = border.reach(Vector::xy(0.5, 0.4), Vector::xy(1.0, 0.0), 5.0);
        assert!((reach.unwrap() - 2.51).abs() < 1e-9);
        assert!(border.reach(Vector::xy(0.5, 0.4), Vector::xy(1.0, 0.0), 1.0).is_none());
        assert!((border.reach(Vector::xy(0.5, 0.4), Vector::xy(0.0, 1.0), 5.0).unwrap() - 0.6).abs() < 1e-9);
    }
}
