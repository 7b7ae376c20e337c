//! The Gaussians and the window of one level, in the form in which they are computed.
//!
//! With a window `w(x) = exp(-|x|^2 / R^2)` along the directions in which the exemplar repeats, a pair of points at `u` and `v` from the middle
//! of the window contributes, up to a constant, `w(c) exp(-|u - v|^2 / (2 sigma^2))` with `c = (u + v) / 2` and `R^2 = delta^2 + sigma^2 / 2`.
//! Here pairs count as far as their points lie in the window: `w(u)` stands for `w(c)`. For a pair within the output or within the exemplar, which
//! is there both ways around, that is the mean over its two points, and an output that is the exemplar has no error still. The sum over all
//! points `v` of the exemplar is then one value of a field that knows nothing of the window, `w(u) E(m + u)`, where `E` is a sum of Gaussians
//! `exp(-|x|^2 / (2 sigma^2))`: a match costs one look-up for each point in the window, and levels share the field.

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
    shape: Window,
}

impl<const D: usize> Kernel<D> {
    /// The kernel for a window of size `delta` along the coordinates of `base`.
    pub(crate) fn new(sigma: f64, delta: f64, base: [bool; D], shape: Window) -> Self {
        let r2 = delta * delta + 0.5 * sigma * sigma;
        Self { sigma, delta, window: std::array::from_fn(|k| if base[k] { 1.0 / r2 } else { 0.0 }), shape }
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

    /// What the Gaussians of the field have in the exponent, times the squared distance.
    pub(crate) fn sharpness(&self) -> f64 {
        0.5 / (self.sigma * self.sigma)
    }

    /// `w(u)`; zero beyond the window.
    #[inline]
    pub(crate) fn weight(&self, u: &[f64; D]) -> f64 {
        match self.shape {
            Window::Gaussian => {
                let far: f64 = (0..D).map(|k| self.window[k] * u[k] * u[k]).sum();
                if far > REACH * REACH { 0.0 } else { f64::from(exp(-far as f32)) }
            }
            Window::Box => {
                let inside = (0..D).all(|k| self.window[k] == 0.0 || u[k].abs() <= self.delta);
                if inside { 1.0 } else { 0.0 }
            }
        }
    }

    /// The slope of [`Kernel::weight`] at `u`, over its value.
    #[inline]
    pub(crate) fn fall(&self, u: &[f64; D]) -> [f64; D] {
        match self.shape {
            Window::Gaussian => std::array::from_fn(|k| -2.0 * self.window[k] * u[k]),
            Window::Box => [0.0; D],
        }
    }
}
