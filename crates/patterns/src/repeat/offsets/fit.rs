//! Vectors fitted to the places at which marks lie, by least squares.

use arabesque_core::Vector;

/// Fitted vectors, and how well they fit.
pub(crate) struct Fit {
    pub(crate) vectors: [Vector<2>; 2],
    pub(crate) jitter: f64,
    pub(crate) share: f64,
    /// Marks that were found from another.
    pub(crate) pairs: usize,
}

/// Normal equations of the vectors, over groups of marks each of which has an unknown origin.
#[derive(Default)]
pub(crate) struct Sums {
    /// Products of node coordinates.
    nodes: [[f64; 2]; 2],
    /// Products of node coordinates and places.
    places: [[f64; 2]; 2],
    /// Squares of places.
    squares: f64,
    count: f64,
}

impl Sums {
    pub(crate) fn add(&mut self, group: &[([i64; 2], Vector<2>)]) {
        let count = group.len() as f64;
        let mean = |k: usize| group.iter().map(|(n, _)| n[k] as f64).sum::<f64>() / count;
        let (m, origin) = ([mean(0), mean(1)], group[0].1);
        let centre = group.iter().fold(Vector::ZERO, |sum, (_, p)| sum + (*p - origin)) * (1.0 / count);
        for (n, p) in group {
            let (n, p) = ([n[0] as f64 - m[0], n[1] as f64 - m[1]], *p - origin - centre);
            for r in 0..2 {
                for c in 0..2 {
                    self.nodes[r][c] += n[r] * n[c];
                    self.places[r][c] += n[r] * p[c];
                }
            }
            self.squares += p.norm2();
            self.count += 1.0;
        }
    }

    pub(crate) fn vectors(&self) -> Option<[Vector<2>; 2]> {
        let [[a, b], [c, d]] = self.nodes;
        let measure = a * d - b * c;
        let solved = |r: [f64; 2]| -> Vector<2> {
            let of = |k: usize| (r[0] * self.places[0][k] + r[1] * self.places[1][k]) / measure;
            Vector::xy(of(0), of(1))
        };
        (measure > 1e-9 * (a + d).powi(2)).then(|| [solved([d, -b]), solved([-c, a])])
    }

    /// Root mean square distance from where the vectors have the marks.
    pub(crate) fn jitter(&self, vectors: &[Vector<2>; 2]) -> f64 {
        let mut sum = self.squares;
        for r in 0..2 {
            let place = Vector::xy(self.places[r][0], self.places[r][1]);
            sum -= 2.0 * vectors[r].dot(place);
            sum += (0..2).map(|c| vectors[r].dot(vectors[c]) * self.nodes[r][c]).sum::<f64>();
        }
        (sum.max(0.0) / self.count.max(1.0)).sqrt()
    }
}
