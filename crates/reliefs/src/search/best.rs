//! The places of the texture whose patches fit best [Duranleau 2008 §5.1].
//!
//! `sum (N - T)^2` over the overlap is `sum N^2 - 2 sum N T + sum T^2`: the middle is a cross-correlation, and so is the last with the overlap as a
//! mask. Transforms give all places at once; what comes out near the best is summed again node by node, so that both ways answer with the same
//! places and the same numbers.

use arabesque_core::{Budget, Result};
use rayon::prelude::*;

use crate::{
    params::Search,
    search::fft::{Complex, Fft},
    search::field::{ABREAST, Field, Overlap},
};

/// Differences by transforms or in 32 bits are off by less than this share of what is summed.
const SLACK: f64 = 1e-4;

/// A place in the texture, with how much it differs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Candidate {
    /// Column and row of its corner.
    pub(crate) place: [u32; 2],
    pub(crate) difference: f64,
}

/// A field prepared for searches.
#[derive(Debug)]
pub(crate) struct Searcher {
    fft: Fft,
    /// Two planes each, one as the real and one as the imaginary part.
    spectra: Vec<Vec<Complex>>,
    /// Of the squares of all planes together.
    squares: Vec<Complex>,
}

impl Searcher {
    /// Whether transforms take less work than going through all places.
    pub(crate) fn is_faster(field: &Field, places: usize, nodes: usize) -> bool {
        let fft = Fft::new(field.width, field.height);
        let transforms = (field.planes.len() / 2 + 2) as u64 * fft.work();
        transforms < (places * nodes * field.planes.len()) as u64 / 6
    }

    pub(crate) fn new(field: &Field, budget: &Budget) -> Result<Self> {
        let fft = Fft::new(field.width, field.height);
        let pairs: Vec<&[Vec<f32>]> = field.planes.chunks(2).collect();
        budget.spend(fft.work() * (pairs.len() as u64 + 1))?;
        let lay = |value: &dyn Fn(usize) -> Complex| {
            let mut grid = vec![Complex::default(); fft.len()];
            for k in 0..field.width * field.height {
                grid[k / field.width * fft.width + k % field.width] = value(k);
            }
            fft.transform(&mut grid, false);
            grid
        };
        let number = |plane: Option<&Vec<f32>>, k: usize| plane.map_or(0.0, |p| f64::from(p[k]));
        let spectra = pairs
            .par_iter()
            .map(|pair| lay(&|k| Complex::new(number(pair.first(), k), number(pair.get(1), k))))
            .collect();
        let square = |k: usize| field.planes.iter().map(|p| f64::from(p[k]) * f64::from(p[k])).sum();
        let squares = lay(&|k| Complex::new(square(k), 0.0));
        Ok(Self { fft, spectra, squares })
    }

    /// Differences at all places, about.
    fn differences(&self, overlap: &Overlap, places: &[[u32; 2]], budget: &Budget) -> Result<Vec<f64>> {
        let fft = &self.fft;
        budget.spend(fft.work() * (self.spectra.len() as u64 + 2))?;
        let lay = |value: &dyn Fn(usize) -> Complex| {
            let mut grid = vec![Complex::default(); fft.len()];
            for (k, [x, y]) in overlap.nodes.iter().enumerate() {
                grid[*y as usize * fft.width + *x as usize] = value(k);
            }
            fft.transform(&mut grid, false);
            grid
        };
        let number = |plane: Option<&Vec<f32>>, k: usize| plane.map_or(0.0, |p| f64::from(p[k]));
        // With two planes as one complex number, the real part of `conj(N) T` is the sum of the products of both.
        let products: Vec<Vec<Complex>> = overlap
            .planes
            .par_chunks(2)
            .zip(&self.spectra)
            .map(|(pair, spectrum)| {
                let mut grid = lay(&|k| Complex::new(number(pair.first(), k), number(pair.get(1), k)));
                grid.iter_mut().zip(spectrum).for_each(|(n, t)| *n = n.conjugate().times(*t));
                grid
            })
            .collect();
        let mut sum = lay(&|_| Complex::new(1.0, 0.0));
        sum.iter_mut().zip(&self.squares).for_each(|(m, s)| *m = m.conjugate().times(*s));
        for product in &products {
            for (s, p) in sum.iter_mut().zip(product) {
                *s = Complex::new(s.re - 2.0 * p.re, s.im - 2.0 * p.im);
            }
        }
        fft.transform(&mut sum, true);
        let own: f64 = overlap.planes.iter().flatten().map(|v| f64::from(*v) * f64::from(*v)).sum();
        let size = fft.len() as f64;
        Ok(places.iter().map(|[x, y]| own + sum[*y as usize * fft.width + *x as usize].re / size).collect())
    }
}

/// Differences at all places in rows, in 32 bits: along a row of the texture the places are next to one another.
fn in_rows(field: &Field, overlap: &Overlap, places: &[[u32; 2]], budget: &Budget) -> Result<Vec<f64>> {
    budget.spend((places.len() * overlap.nodes.len() * field.planes.len()) as u64 / 6)?;
    let rows: Vec<&[[u32; 2]]> = places.chunk_by(|a, b| a[1] == b[1]).collect();
    let steps = steps(field, overlap);
    let of = |row: &&[[u32; 2]]| -> Vec<f64> {
        let (first, last) = (row[0][0] as usize, row[row.len() - 1][0] as usize);
        let mut sums = vec![0.0_f32; (last - first + 1).next_multiple_of(ABREAST)];
        for (k, sums) in sums.chunks_exact_mut(ABREAST).enumerate() {
            let start = row[0][1] as usize * field.width + first + k * ABREAST;
            let mut some = [0.0_f32; ABREAST];
            for (plane, numbers) in field.planes.iter().zip(&overlap.planes) {
                for (step, number) in steps.iter().zip(numbers) {
                    // The last ones of a row may look beyond it: they are no places.
                    let Some(values) = plane[start + step..].first_chunk::<ABREAST>() else { continue };
                    some = std::array::from_fn(|k| some[k] + (values[k] - number) * (values[k] - number));
                }
            }
            sums.copy_from_slice(&some);
        }
        row.iter().map(|[x, _]| f64::from(sums[*x as usize - first])).collect()
    };
    Ok(rows.par_iter().flat_map_iter(of).collect())
}

/// How far the nodes of an overlap are from a place, in numbers of a plane.
fn steps(field: &Field, overlap: &Overlap) -> Vec<usize> {
    overlap.nodes.iter().map(|[x, y]| *y as usize * field.width + *x as usize).collect()
}

/// The difference at one place.
fn exact(field: &Field, overlap: &Overlap, steps: &[usize], [x, y]: [u32; 2]) -> f64 {
    let start = y as usize * field.width + x as usize;
    let squares = field.planes.iter().zip(&overlap.planes).map(|(plane, numbers)| {
        let from = &plane[start..];
        let square = |(step, number): (&usize, &f32)| (f64::from(from[*step]) - f64::from(*number)).powi(2);
        steps.iter().zip(numbers).map(square).sum::<f64>()
    });
    squares.sum()
}

/// The best places, best first: all that are within `tolerance` of the best or of `floor`, and at least `least` where there are so many.
/// `places` are in rows.
pub(crate) fn best(
    field: &Field,
    searcher: Option<&Searcher>,
    overlap: &Overlap,
    places: &[[u32; 2]],
    (tolerance, floor, least): (f64, f64, usize),
    (search, budget): (Search, &Budget),
) -> Result<Vec<Candidate>> {
    let by_transforms = match search {
        Search::Fft => true,
        Search::Exhaustive => false,
        Search::Auto => Searcher::is_faster(field, places.len(), overlap.nodes.len()),
    };
    let about = match searcher {
        Some(searcher) if by_transforms => searcher.differences(overlap, places, budget)?,
        _ => in_rows(field, overlap, places, budget)?,
    };
    let mut sorted = about.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let Some(&least_about) = sorted.first() else { return Ok(Vec::new()) };
    // What is off is a share of all that was summed.
    let total = (overlap.nodes.len() * field.planes.len()) as f64;
    let slack = SLACK * total;
    let of_rank = sorted[least.min(sorted.len()) - 1];
    let bound = ((1.0 + tolerance) * (least_about + slack).max(floor)).max(of_rank) + 2.0 * slack;
    let near: Vec<_> = places.iter().zip(&about).filter(|(_, d)| **d <= bound).map(|(place, _)| *place).collect();
    budget.spend((near.len() * overlap.nodes.len() * field.planes.len()) as u64)?;
    let steps = steps(field, overlap);
    let exact = |&place: &[u32; 2]| Candidate { place, difference: exact(field, overlap, &steps, place) };
    let mut candidates: Vec<Candidate> = near.par_iter().map(exact).collect();
    candidates.sort_by(|a, b| a.difference.total_cmp(&b.difference).then(a.place.cmp(&b.place)));
    let most = (1.0 + tolerance) * candidates[0].difference.max(floor);
    let within = candidates.partition_point(|c| c.difference <= most);
    candidates.truncate(within.max(least));
    Ok(candidates)
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Stage, Stream, Vector};
    use arabesque_surface::OrientedPoints;

    use super::*;
    use crate::search::field::Lattice;

    /// The field of a wavy sheet, and that of a part of it.
    fn fields() -> (Field, Overlap, Vec<[u32; 2]>) {
        let mut random = Stream::new(2, Stage::TEST, 0);
        let height = |x: f64, y: f64| 0.4 * (3.0 * x).sin() + 0.3 * (2.0 * y + x * x).cos();
        let points: Vec<_> = (0..3000)
            .map(|_| {
                let (x, y) = (random.range(0.0, 4.0), random.range(0.0, 3.0));
                Vector([x, y, height(x, y)])
            })
            .collect();
        let normals = vec![Vector([0.0, 0.0, 1.0]); 3000];
        let budget = Budget::default();
        let points = OrientedPoints::new(points, normals, 0.25, &budget).unwrap();
        let lattice = Lattice { cell: 0.1, heights: vec![-0.5, 0.0, 0.5], reach: 0.6 };
        let field = Field::new(&points, &lattice, [0.0, 0.0], (40, 30), &budget).unwrap();
        // An overlap in the shape of an L.
        let nodes = (0..100).map(|k| [k % 10, k / 10]).filter(|[x, y]| *x < 3 || *y < 3).collect();
        let moved: Vec<_> = points.positions().iter().map(|&p| p - Vector([1.23, 0.98, 0.02])).collect();
        let moved = OrientedPoints::new(moved, points.normals().to_vec(), 0.25, &budget).unwrap();
        let overlap = Overlap::new(&moved, &lattice, nodes, &budget).unwrap();
        let places = (0..20).flat_map(|y| (0..30).map(move |x| [x, y])).filter(|[x, y]| (x + y) % 7 != 3).collect();
        (field, overlap, places)
    }

    #[test]
    fn transforms_find_exactly_what_an_exhaustive_search_finds() {
        let (field, overlap, places) = fields();
        let budget = Budget::default();
        let searcher = Searcher::new(&field, &budget).unwrap();
        for (tolerance, floor, least) in [(0.2, 0.0, 1), (1.0, 0.0, 9), (0.0, 3.0, 4)] {
            let how = |search, searcher| {
                best(&field, searcher, &overlap, &places, (tolerance, floor, least), (search, &budget)).unwrap()
            };
            let by_transforms = how(Search::Fft, Some(&searcher));
            assert_eq!(by_transforms, how(Search::Exhaustive, None));
            let mut all: Vec<_> = places
                .iter()
                .map(|&place| Candidate { place, difference: exact(&field, &overlap, &steps(&field, &overlap), place) })
                .collect();
            all.sort_by(|a, b| a.difference.total_cmp(&b.difference).then(a.place.cmp(&b.place)));
            assert_eq!(by_transforms[..], all[..by_transforms.len()]);
            let most = (1.0 + tolerance) * all[0].difference.max(floor);
            assert!(by_transforms.len() >= least && all[by_transforms.len()].difference > most);
        }
    }

    #[test]
    fn differences_by_transforms_are_those_of_the_sum() {
        let (field, overlap, places) = fields();
        let budget = Budget::default();
        let about = Searcher::new(&field, &budget).unwrap().differences(&overlap, &places, &budget).unwrap();
        let rows = in_rows(&field, &overlap, &places, &budget).unwrap();
        for ((place, d), r) in places.iter().zip(about).zip(rows) {
            let own = exact(&field, &overlap, &steps(&field, &overlap), *place);
            assert!(
                (d - own).abs() < 1e-8 * (1.0 + own) && (r - own).abs() < 1e-3 * (1.0 + own),
                "{place:?}: {d} {r} {own}"
            );
        }
    }

    #[test]
    fn the_place_that_a_part_is_from_is_the_best() {
        let (field, overlap, places) = fields();
        let found =
            best(&field, None, &overlap, &places, (0.0, 0.0, 1), (Search::Exhaustive, &Budget::default())).unwrap();
        assert!(
            found[0].place == [12, 10] || found[0].place == [12, 9] || found[0].place == [13, 10],
            "{:?}",
            found[0]
        );
    }
}
