//! The edges of an outline in horizontal bands, so that a look-up meets few of them.

use std::sync::Arc;

use arabesque_core::{Budget, Held, Outline, Result, Segment, Vector, ring};

/// An edge of an outline.
pub(crate) type Edge = Segment<2>;

/// Edges for each band; as many bands as this times fewer than edges, so that a band holds a handful.
const EDGES_PER_BAND: usize = 2;

/// Most bands, and most entries in all of them: bounds memory where every edge is as high as the outline.
const MAX_BANDS: (usize, usize) = (512, 1 << 22);

/// Edges sorted into bands of equal height.
#[derive(Clone, Debug)]
pub(crate) struct EdgeBands {
    low: f64,
    bands_per_unit: f64,
    /// Edges of band `b`: `edges[starts[b]..starts[b + 1]]`; an edge lies in every band that it touches.
    starts: Vec<usize>,
    edges: Vec<Edge>,
    _held: Arc<Held>,
}

impl EdgeBands {
    /// # Errors
    /// When there is not so much memory.
    pub(crate) fn new(outline: &Outline<2>, budget: &Budget) -> Result<Self> {
        let bounds = outline.bounds();
        let count = outline.edges().count();
        let height = if count == 0 { 0.0 } else { bounds.size()[1] };
        let mut bands = (count / EDGES_PER_BAND).clamp(1, MAX_BANDS.0);
        let climbs: f64 = outline.edges().map(|(a, b)| (b[1] - a[1]).abs()).sum();
        while bands > 1 && height > 0.0 && climbs / height * bands as f64 > MAX_BANDS.1 as f64 {
            bands /= 2;
        }
        let bands_per_unit = if height > 0.0 { bands as f64 / height } else { 0.0 };
        // Each edge lies in a band more than it climbs over.
        let entries = (climbs * bands_per_unit) as usize + 2 * count;
        let held = Arc::new(budget.hold("edges of outlines", entries * size_of::<Edge>())?);
        let (low, starts) = (bounds.min[1], vec![0; bands + 1]);
        let mut sorted = Self { low, bands_per_unit, starts, edges: Vec::new(), _held: held };
        let mut members = vec![Vec::new(); bands];
        for edge in outline.edges() {
            let (low, high) = sorted.range(edge.0[1].min(edge.1[1]), edge.0[1].max(edge.1[1]));
            members[low..=high].iter_mut().for_each(|band| band.push(edge));
        }
        for (b, band) in members.iter().enumerate() {
            sorted.starts[b + 1] = sorted.starts[b] + band.len();
        }
        sorted.edges = members.concat();
        Ok(sorted)
    }

    fn range(&self, low: f64, high: f64) -> (usize, usize) {
        let last = self.starts.len() - 2;
        let band = |y: f64| (((y - self.low) * self.bands_per_unit).max(0.0) as usize).min(last);
        (band(low), band(high))
    }

    /// Edges that may lie between two heights; some come more than once.
    pub(crate) fn between(&self, low: f64, high: f64) -> &[Edge] {
        let (low, high) = self.range(low, high);
        &self.edges[self.starts[low]..self.starts[high + 1]]
    }

    /// Whether `p` is covered: an odd number of edges to its right.
    pub(crate) fn covers(&self, p: Vector<2>) -> bool {
        let (band, _) = self.range(p[1], p[1]);
        ring::covers(self.edges[self.starts[band]..self.starts[band + 1]].iter().copied(), p)
    }

    /// Number of entries, a measure of the work of a look-up.
    pub(crate) fn len(&self) -> usize {
        self.edges.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arabesque_core::{FillRule, Stage, Stream};

    fn star(points: usize, radius: f64) -> Vec<Vector<2>> {
        let corner = |k: usize| {
            let turn = k as f64 / points as f64 * std::f64::consts::TAU;
            let r = if k.is_multiple_of(2) { radius } else { 0.4 * radius };
            Vector::xy(r * turn.cos(), r * turn.sin())
        };
        (0..points).map(corner).collect()
    }

    #[test]
    fn bands_cover_what_the_outline_covers() {
        let outline = Outline::union(&[star(70, 10.0), star(12, 3.0)], FillRule::EvenOdd);
        let bands = EdgeBands::new(&outline, &Budget::default()).unwrap();
        let mut stream = Stream::new(2, Stage::TEST, 0);
        for _ in 0..2000 {
            let p = Vector::xy(stream.range(-11.0, 11.0), stream.range(-11.0, 11.0));
            assert_eq!(bands.covers(p), outline.contains(p), "{p:?}");
        }
    }

    #[test]
    fn every_edge_between_two_heights_is_found() {
        let outline = Outline { rings: vec![star(40, 10.0)] };
        let bands = EdgeBands::new(&outline, &Budget::default()).unwrap();
        for (low, high) in [(-20.0, -12.0), (-3.0, -2.5), (0.0, 7.0), (9.0, 30.0)] {
            let found = bands.between(low, high);
            let wanted = outline.edges().filter(|(a, b)| a[1].min(b[1]) <= high && a[1].max(b[1]) >= low);
            assert!(wanted.into_iter().all(|edge| found.contains(&edge)));
        }
    }

    #[test]
    fn an_outline_without_rings_has_no_edges() {
        let bands = EdgeBands::new(&Outline::default(), &Budget::default()).unwrap();
        assert!(bands.between(-1.0, 1.0).is_empty());
        assert!(!bands.covers(Vector::ZERO));
    }
}
