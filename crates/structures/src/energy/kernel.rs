//! The Gaussians and the window of one level, in the form in which they are computed.
//!
//! With a window `exp(-|x|^2 / delta^2)` along the directions in which the exemplar repeats, a pair of points at `u` and `v` from the
//! middle of the window contributes, up to a constant,
//!
//! `exp(-|u - v|^2 / (2 sigma^2)) exp(-|c|^2 / R^2)`, with `c = (u + v) / 2` and `R^2 = delta^2 + sigma^2 / 2`.
//!
//! Completing the square once more, the sum over all points `v` of the exemplar is one value of a field that knows nothing of `u` and of
//! the window: `exp(-l |u|^2) E(m + (1 - k) u)`, where `E` is a sum of Gaussians of width `g` with `1 / g^2 = 1 / (2 sigma^2) + 1 / (4 R^2)`,
//! `k = g^2 / (2 R^2)` and `l = 1 / R^2 - g^2 / (4 R^4)`. So a match costs one look-up for each point in the window.

use super::exp::exp;
use crate::params::Window;

/// Where a Gaussian window ends, in units of `R`: what is beyond weighs about two per cent.
const REACH: f64 = 1.95;
/// Where the Gaussians of pairs end, in units of `sigma`.
const PAIRS: f64 = 3.1;

/// Constants of one level. Across the directions in which the exemplar repeats the window has no end.
#[derive(Clone, Debug)]
pub(crate) struct Kernel<const D: usize> {
    /// Width of the Gaussians that stand for points.
    pub(crate) sigma: f64,
    /// Size of the window.
    pub(crate) delta: f64,
    /// `1 / R^2` for each coordinate, 0 across.
    pub(crate) window: [f64; D],
    /// `l` for each coordinate.
    pub(crate) outer: [f64; D],
    /// `1 - k` for each coordinate.
    pub(crate) inward: [f64; D],
    /// `1 / g^2` for each coordinate.
    pub(crate) field: [f64; D],
    shape: Window,
}

impl<const D: usize> Kernel<D> {
    /// The kernel for a window of size `delta` along the coordinates of `base`.
    pub(crate) fn new(sigma: f64, delta: f64, base: [bool; D], shape: Window) -> Self {
        let r2 = delta * delta + 0.5 * sigma * sigma;
        let along = |k: usize| base[k] && shape == Window::Gaussian;
        let pair = 0.5 / (sigma * sigma);
        let g2 = |k: usize| if along(k) { 1.0 / (pair + 0.25 / r2) } else { 1.0 / pair };
        Self {
            sigma,
            delta,
            window: std::array::from_fn(|k| if base[k] { 1.0 / r2 } else { 0.0 }),
            outer: std::array::from_fn(|k| if along(k) { 1.0 / r2 - g2(k) / (4.0 * r2 * r2) } else { 0.0 }),
            inward: std::array::from_fn(|k| if along(k) { 1.0 - g2(k) / (2.0 * r2) } else { 1.0 }),
            field: std::array::from_fn(|k| 1.0 / g2(k)),
            shape,
        }
    }

    /// How far from its middle a window reaches along the directions in which the exemplar repeats.
    pub(crate) fn reach(&self) -> f64 {
        match self.shape {
            Window::Gaussian => REACH * (self.delta * self.delta + 0.5 * self.sigma * self.sigma).sqrt(),
            Window::Box => self.delta,
        }
    }

    /// Integral of the weight of pairs over a window along so many directions.
    pub(crate) fn volume(&self, repeats: usize) -> f64 {
        let n = repeats as i32;
        match self.shape {
            // What is cut off at the reach: 1 - erf in one direction, and so on.
            Window::Gaussian => {
                let share = [1.0, 0.994, 0.978, 0.944][repeats.min(3)];
                share
                    * (std::f64::consts::PI * (self.delta * self.delta + 0.5 * self.sigma * self.sigma)).sqrt().powi(n)
            }
            Window::Box => (2.0 * self.delta).powi(n),
        }
    }

    /// How far points are from each other at most that make a pair.
    pub(crate) fn pairs(&self) -> f64 {
        PAIRS * self.sigma
    }

    /// Weight of the pairs of a point at `u`, and of its look-up in the field; zero beyond the window.
    pub(crate) fn weights(&self, u: &[f64; D]) -> (f64, f64) {
        match self.shape {
            Window::Gaussian => {
                let (mut pair, mut outer) = (0.0, 0.0);
                for k in 0..D {
                    pair += self.window[k] * u[k] * u[k];
                    outer += self.outer[k] * u[k] * u[k];
                }
                if pair > REACH * REACH {
                    (0.0, 0.0)
                } else {
                    (f64::from(exp(-pair as f32)), f64::from(exp(-outer as f32)))
                }
            }
            Window::Box => {
                let inside = (0..D).all(|k| self.window[k] == 0.0 || u[k].abs() <= self.delta);
                if inside { (1.0, 1.0) } else { (0.0, 0.0) }
            }
        }
    }
}
