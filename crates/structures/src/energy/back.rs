//! The last sum of the error density: the exemplar with itself, for a window anywhere along its base.

use arabesque_core::{Bounds, Budget, Lattice, Result, Vector};

use super::{exp::exp, kernel::Kernel};
use crate::exemplar::{channels::inner, known::Known, pattern::Pattern};

/// Cells of the table in one width of the window.
const FINENESS: f64 = 6.0;

/// `sum b_i.b_j W(v_i, v_j)` for matches on a grid along the base; linear in between.
#[derive(Clone, Debug)]
pub(crate) struct Back<const D: usize> {
    origin: [f64; D],
    step: f64,
    counts: [usize; D],
    values: Vec<f64>,
    masses: Vec<f64>,
}

impl<const D: usize> Back<D> {
    /// The table of a level.
    pub(crate) fn new(pattern: &Pattern<D>, kernel: &Kernel<D>, known: &Known<D>, budget: &Budget) -> Result<Self> {
        let base = pattern.base;
        let step = kernel.delta / FINENESS;
        let size = pattern.bounds.size();
        let counts: [usize; D] =
            std::array::from_fn(|k| if base[k] { (size[k] / step).ceil().max(1.0) as usize + 2 } else { 1 });
        let bounds = Bounds::new(
            pattern.bounds.min - Vector::splat(0.5 * step),
            pattern.bounds.min + Vector(std::array::from_fn(|k| (counts[k] as f64 - 0.5) * step)),
        );
        let lattice = Lattice::new(bounds, counts, false);
        let mut values = vec![0.0; lattice.count()];
        let mut masses = values.clone();
        let pair = kernel.sharpness();
        // Every pair goes to the cells around its points.
        let mut meter = budget.meter();
        for (i, &p) in pattern.points.positions.iter().enumerate() {
            let seen = f64::from(known.at(&p.0.map(|x| x as f32)));
            share(&lattice, &counts, base, step, p, |cell, w| masses[cell] += w * seen);
            let (mut cost, mut sum) = (0, 0.0);
            pattern.index.within(p, kernel.pairs(), |j, offset| {
                cost += 20;
                let value = inner(&pattern.weights[i], &pattern.weights[j]) * exp((-pair * offset.norm2()) as f32);
                sum += f64::from(value);
            });
            share(&lattice, &counts, base, step, p, |cell, w| values[cell] += w * seen * sum);
            meter.spend(cost)?;
        }
        blur(&mut values, &counts, base, kernel, step);
        blur(&mut masses, &counts, base, kernel, step);
        Ok(Self { origin: pattern.bounds.min.0, step, counts, values, masses })
    }

    /// The value for a match at `m`, and its slope.
    pub(crate) fn at(&self, m: &[f64; D]) -> (f64, [f64; D]) {
        self.read(&self.values, m)
    }

    /// How many points of the exemplar there are in the window around `m`, each as far as it is in it.
    pub(crate) fn mass(&self, m: &[f64; D]) -> f64 {
        self.read(&self.masses, m).0
    }

    fn read(&self, values: &[f64], m: &[f64; D]) -> (f64, [f64; D]) {
        let mut low = [0; D];
        let mut into = [0.0; D];
        for k in 0..D {
            if self.counts[k] > 1 {
                let at = ((m[k] - self.origin[k]) / self.step).clamp(0.0, self.counts[k] as f64 - 1.001);
                low[k] = at as usize;
                into[k] = at - low[k] as f64;
            }
        }
        let (mut value, mut slope) = (0.0, [0.0; D]);
        'corners: for corner in 0..1_usize << D {
            let (mut index, mut stride) = (0, 1);
            for k in 0..D {
                let far = corner >> k & 1;
                if far == 1 && self.counts[k] == 1 {
                    continue 'corners;
                }
                index += (low[k] + far) * stride;
                stride *= self.counts[k];
            }
            let part = |k: usize| match (self.counts[k], corner >> k & 1) {
                (1, _) => 1.0,
                (_, 1) => into[k],
                _ => 1.0 - into[k],
            };
            let v = values[index];
            value += v * (0..D).map(part).product::<f64>();
            for k in (0..D).filter(|&k| self.counts[k] > 1) {
                let sign = if corner >> k & 1 == 1 { 1.0 } else { -1.0 };
                slope[k] += v * sign / self.step * (0..D).filter(|&l| l != k).map(part).product::<f64>();
            }
        }
        (value, slope)
    }
}

/// Shares of the cells around `p`, linear along each coordinate of the base.
fn share<const D: usize>(
    lattice: &Lattice<D>,
    counts: &[usize; D],
    base: [bool; D],
    step: f64,
    p: Vector<D>,
    mut give: impl FnMut(usize, f64),
) {
    let first = lattice.centre(0);
    let mut low = [0; D];
    let mut into = [0.0; D];
    for k in (0..D).filter(|&k| base[k]) {
        let at = ((p[k] - first[k]) / step).clamp(0.0, counts[k] as f64 - 1.001);
        low[k] = at as usize;
        into[k] = at - low[k] as f64;
    }
    for corner in 0..1_usize << D {
        let (mut index, mut stride, mut weight) = (0, 1, 1.0);
        for k in 0..D {
            let far = corner >> k & 1;
            weight *= match (base[k], far) {
                (false, 0) => 1.0,
                (false, _) => 0.0,
                (true, 1) => into[k],
                (true, _) => 1.0 - into[k],
            };
            index += (low[k] + far * usize::from(base[k])) * stride;
            stride *= counts[k];
        }
        if weight > 0.0 {
            give(index, weight);
        }
    }
}

/// Sums under the window, coordinate by coordinate.
fn blur<const D: usize>(values: &mut [f64], counts: &[usize; D], base: [bool; D], kernel: &Kernel<D>, step: f64) {
    let mut stride = 1;
    for k in 0..D {
        if base[k] {
            let reach = (kernel.reach() / step) as isize;
            let taps: Vec<f64> = (-reach..=reach)
                .map(|t| {
                    let mut u = [0.0; D];
                    u[k] = t as f64 * step;
                    kernel.weight(&u)
                })
                .collect();
            for start in 0..values.len() {
                if start / stride % counts[k] != 0 {
                    continue;
                }
                let line: Vec<f64> = (0..counts[k]).map(|n| values[start + n * stride]).collect();
                for n in 0..counts[k] {
                    let sum = taps.iter().enumerate().filter_map(|(t, tap)| {
                        let from = n as isize + t as isize - reach;
                        line.get(usize::try_from(from).ok()?).map(|v| tap * v)
                    });
                    values[start + n * stride] = sum.sum();
                }
            }
        }
        stride *= counts[k];
    }
}
