//! Fast Fourier transforms of grids with sides that are powers of two.

use std::f64::consts::TAU;

/// A complex number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Complex {
    pub(crate) re: f64,
    pub(crate) im: f64,
}

impl Complex {
    pub(crate) const fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    fn plus(self, other: Self) -> Self {
        Self::new(self.re + other.re, self.im + other.im)
    }

    fn minus(self, other: Self) -> Self {
        Self::new(self.re - other.re, self.im - other.im)
    }

    pub(crate) fn times(self, other: Self) -> Self {
        Self::new(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)
    }

    pub(crate) fn conjugate(self) -> Self {
        Self::new(self.re, -self.im)
    }
}

/// Transforms of grids of one size.
#[derive(Clone, Debug)]
pub(crate) struct Fft {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Roots of unity for the longer side.
    roots: Vec<Complex>,
}

impl Fft {
    /// For grids of at least this size.
    pub(crate) fn new(width: usize, height: usize) -> Self {
        let (width, height) = (width.next_power_of_two(), height.next_power_of_two());
        let n = width.max(height);
        let root = |k: usize| {
            let (sin, cos) = (-TAU * k as f64 / n as f64).sin_cos();
            Complex::new(cos, sin)
        };
        Self { width, height, roots: (0..n / 2 + 1).map(root).collect() }
    }

    pub(crate) fn len(&self) -> usize {
        self.width * self.height
    }

    /// Work units of a transform.
    pub(crate) fn work(&self) -> u64 {
        self.len() as u64 * u64::from(self.len().ilog2() + 1) * 2
    }

    /// Transforms a grid, row after row; backwards without dividing by its size.
    pub(crate) fn transform(&self, grid: &mut [Complex], is_backward: bool) {
        grid.chunks_exact_mut(self.width).for_each(|row| self.line(row, is_backward));
        let mut column = vec![Complex::default(); self.height];
        for x in 0..self.width {
            for (y, value) in column.iter_mut().enumerate() {
                *value = grid[y * self.width + x];
            }
            self.line(&mut column, is_backward);
            for (y, value) in column.iter().enumerate() {
                grid[y * self.width + x] = *value;
            }
        }
    }

    fn line(&self, line: &mut [Complex], is_backward: bool) {
        let n = line.len();
        let bits = n.trailing_zeros();
        for i in 0..n {
            let j = if bits == 0 { 0 } else { i.reverse_bits() >> (usize::BITS - bits) };
            if i < j {
                line.swap(i, j);
            }
        }
        let full = 2 * (self.roots.len() - 1).max(1);
        let mut half = 1;
        while half < n {
            let step = full / (2 * half);
            for start in (0..n).step_by(2 * half) {
                for k in 0..half {
                    let root = self.roots[k * step];
                    let root = if is_backward { root.conjugate() } else { root };
                    let (a, b) = (line[start + k], line[start + k + half].times(root));
                    line[start + k] = a.plus(b);
                    line[start + k + half] = a.minus(b);
                }
            }
            half *= 2;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transform_is_the_sum_it_stands_for_and_goes_back() {
        let fft = Fft::new(7, 3);
        assert_eq!((fft.width, fft.height), (8, 4));
        let grid: Vec<_> = (0..32).map(|k| Complex::new(f64::from(k * k % 11), f64::from(k % 5) - 2.0)).collect();
        let mut there = grid.clone();
        fft.transform(&mut there, false);
        for (u, v) in [(0, 0), (3, 1), (7, 3)] {
            let mut sum = Complex::default();
            for (k, value) in grid.iter().enumerate() {
                let angle = -TAU * ((k % 8 * u) as f64 / 8.0 + (k / 8 * v) as f64 / 4.0);
                sum = sum.plus(value.times(Complex::new(angle.cos(), angle.sin())));
            }
            let got = there[v * 8 + u];
            assert!((got.re - sum.re).abs() < 1e-9 && (got.im - sum.im).abs() < 1e-9, "{got:?} {sum:?}");
        }
        fft.transform(&mut there, true);
        assert!(
            there
                .iter()
                .zip(&grid)
                .all(|(a, b)| (a.re / 32.0 - b.re).abs() < 1e-12 && (a.im / 32.0 - b.im).abs() < 1e-12)
        );
    }
}
