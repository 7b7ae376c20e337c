//! How much a field differs from itself, shifted: all shifts at once by transforms.
//!
//! With a mask `m` of what is known, the sum of `m(x) m(x + s) (v(x) - v(x + s))^2` is made of correlations: those of the mask with the squares, both
//! ways, less twice that of what is known with itself. Planes are gone through two at a time, one as the real and one as the imaginary part: of the
//! product of a spectrum with its conjugate the even half is that of both.

use arabesque_core::{Budget, Result};
use rayon::prelude::*;

use crate::search::{
    fft::{Complex, Fft},
    field::Field,
};

/// Share of the known cells that have a counterpart where a difference is told.
const LEAST: f64 = 0.1;

/// Mean squared differences of a field from itself for shifts up to half of it.
#[derive(Debug)]
pub(super) struct Likeness {
    /// Cells of the field in a column that is compared.
    pub(super) skip: usize,
    /// Largest shifts.
    pub(super) most: [i64; 2],
    /// Shifts with y from 0 on, row by row from `-most` on: those to the other side are the same.
    differences: Vec<f64>,
}

impl Likeness {
    /// Compares at most `columns` columns along the longer side; `None` for a field of too few.
    pub(super) fn new(field: &Field, columns: usize, budget: &Budget) -> Result<Option<Self>> {
        let skip = field.width.max(field.height).div_ceil(columns).max(1);
        let (width, height) = (field.width / skip, field.height / skip);
        if width < 8 || height < 8 {
            return Ok(None);
        }
        let coarse = |value: &(dyn Fn(usize) -> f64 + Sync)| -> Vec<f64> {
            let corner = |k: usize| k / width * skip * field.width + k % width * skip;
            let of =
                |k: usize| (0..skip * skip).map(|i| value(corner(k) + i / skip * field.width + i % skip)).sum::<f64>();
            (0..width * height).map(|k| of(k) / (skip * skip) as f64).collect()
        };
        let known: Vec<f64> = coarse(&|k| f64::from(field.is_known(k))).iter().map(|v| v.floor()).collect();
        let plane = |plane: &Vec<f32>| -> Vec<f64> {
            coarse(&|k| f64::from(plane[k])).iter().zip(&known).map(|(v, known)| v * known).collect()
        };
        let planes: Vec<Vec<f64>> = field.planes.par_iter().map(plane).collect();
        let most = [width as i64 / 2, height as i64 / 2];
        let fft = Fft::new(width + width / 2, height + height / 2);
        budget.spend(fft.work() * (planes.len() as u64 / 2 + 4) + (width * height * planes.len()) as u64)?;
        let lay = |value: &dyn Fn(usize) -> Complex| {
            let mut grid = vec![Complex::default(); fft.len()];
            (0..width * height).for_each(|k| grid[k / width * fft.width + k % width] = value(k));
            fft.transform(&mut grid, false);
            grid
        };
        let power = |pair: &[Vec<f64>]| {
            let grid = lay(&|k| Complex::new(pair[0][k], pair.get(1).map_or(0.0, |plane| plane[k])));
            grid.iter().map(|c| c.re * c.re + c.im * c.im).collect::<Vec<f64>>()
        };
        let powers: Vec<Vec<f64>> = planes.par_chunks(2).map(power).collect();
        let mask = lay(&|k| Complex::new(known[k], 0.0));
        let squares = lay(&|k| Complex::new(planes.iter().map(|p| p[k] * p[k]).sum(), 0.0));
        // Both are even and real, so that one transform back serves the sums and the counts; of the products that is the half that is even.
        let both = |k: usize| {
            let (x, y) = (k % fft.width, k / fft.width);
            let other = (fft.height - y) % fft.height * fft.width + (fft.width - x) % fft.width;
            let product = powers.iter().map(|p| p[k] + p[other]).sum::<f64>() / 2.0;
            let crossed = mask[k].conjugate().times(squares[k]).re;
            Complex::new(2.0 * (crossed - product), mask[k].re * mask[k].re + mask[k].im * mask[k].im)
        };
        let mut sums: Vec<Complex> = (0..fft.len()).map(both).collect();
        fft.transform(&mut sums, true);
        let difference = |[x, y]: [i64; 2]| {
            let sum = sums[y as usize * fft.width + x.rem_euclid(fft.width as i64) as usize];
            // Where hardly anything has a counterpart nothing is told.
            if sum.im < LEAST * sums[0].im { f64::INFINITY } else { (sum.re / sum.im).max(0.0) }
        };
        let all = (0..=most[1]).flat_map(|y| (-most[0]..=most[0]).map(move |x| [x, y]));
        Ok(Some(Self { skip, most, differences: all.map(difference).collect() }))
    }

    /// All shifts; those to the other side are the same.
    pub(super) fn shifts(&self) -> impl Iterator<Item = [i64; 2]> + use<> {
        let [x, y] = self.most;
        (0..=y).flat_map(move |y| (-x..=x).map(move |x| [x, y]))
    }

    /// The difference at a shift; infinite beyond the largest, and where next to nothing has a counterpart.
    pub(super) fn at(&self, [x, y]: [i64; 2]) -> f64 {
        let [x, y] = if y < 0 { [-x, -y] } else { [x, y] };
        let is_known = x.abs() <= self.most[0] && y <= self.most[1];
        let row = 2 * self.most[0] + 1;
        if is_known { self.differences[(y * row + x + self.most[0]) as usize] } else { f64::INFINITY }
    }

    /// The difference that is usual.
    pub(super) fn usual(&self) -> f64 {
        let mut sorted: Vec<f64> = self.differences.iter().copied().filter(|d| d.is_finite()).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied().unwrap_or(1.0).max(f64::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Stage, Stream, Vector};
    use arabesque_surface::OrientedPoints;

    use super::*;
    use crate::search::field::Lattice;

    #[test]
    fn differences_by_transforms_are_those_of_the_sum() {
        let mut random = Stream::new(3, Stage::TEST, 0);
        let points: Vec<_> =
            (0..900).map(|k| Vector([f64::from(k % 30), f64::from(k / 30), random.range(0.0, 2.0)])).collect();
        let budget = Budget::default();
        let points = OrientedPoints::new(points, vec![Vector([0.0, 0.0, 1.0]); 900], 2.5, &budget).unwrap();
        let lattice = Lattice { cell: 1.0, heights: vec![0.0, 1.0, 2.0], reach: 4.0 };
        let field = Field::new(&points, &lattice, [0.0, 0.0], (30, 26), &budget).unwrap();
        let found = Likeness::new(&field, 30, &budget).unwrap().unwrap();
        for [x, y] in [[0, 0], [3, 2], [-7, 5], [15, 13], [-15, 0], [4, -3]] {
            let (mut sum, mut count) = (0.0, 0);
            for (i, j) in (0..30).flat_map(|i| (0..26).map(move |j| (i, j))) {
                let (k, l) = (i + x, j + y);
                if (0..30).contains(&k) && (0..26).contains(&l) {
                    let square = |p: &Vec<f32>| f64::from(p[(j * 30 + i) as usize] - p[(l * 30 + k) as usize]).powi(2);
                    sum += field.planes.iter().map(square).sum::<f64>();
                    count += 1;
                }
            }
            let (got, wanted) = (found.at([x, y]), sum / f64::from(count));
            assert!((got - wanted).abs() < 1e-6 * (1.0 + wanted), "{x} {y}: {got} {wanted}");
        }
        assert!(found.at([16, 0]).is_infinite());
    }
}
