//! What is known of a neighbourhood near the border of the exemplar: nothing beyond it.

use arabesque_core::Bounds;

use crate::energy::kernel::Kernel;

/// Between these distances from the border, in units of `sigma`, what is seen passes from unknown to known: nearer to it, points beyond
/// are missing in the field.
const RIM: (f64, f64) = (0.3, 1.3);

/// The part of space that the exemplar shows.
#[derive(Clone, Debug)]
pub(crate) struct Known<const D: usize> {
    low: [f32; D],
    high: [f32; D],
    base: [bool; D],
    rim: f32,
    per_rim: f32,
    /// For each coordinate along the base, known shares of windows from the middle of the rim at the border inwards.
    share: Vec<f64>,
    share_step: f64,
}

impl<const D: usize> Known<D> {
    /// Of an exemplar that fills `bounds` along the coordinates of `base`.
    pub(crate) fn new(bounds: &Bounds<D>, base: [bool; D], kernel: &Kernel<D>) -> Self {
        let (rim, width) = (RIM.0 * kernel.sigma, (RIM.1 - RIM.0) * kernel.sigma);
        let steps = 256;
        let reach = kernel.reach() + RIM.1 * kernel.sigma;
        let share_step = reach / steps as f64;
        let window: f64 = (0..D).find(|&k| base[k]).map_or(0.0, |k| kernel.window[k]);
        let mut share = Vec::with_capacity(steps + 1);
        // What a window at distance t from the border sees, by sums.
        for at in 0..=steps {
            let t = at as f64 * share_step;
            let (mut seen, mut all) = (0.0, 0.0);
            for k in -200..=200 {
                let x = f64::from(k) / 200.0 * kernel.reach();
                let w = (-window * x * x).exp();
                all += w;
                seen += w * smooth((t + x - rim) / width);
            }
            share.push(seen / all);
        }
        Self {
            low: std::array::from_fn(|k| bounds.min[k] as f32),
            high: std::array::from_fn(|k| bounds.max[k] as f32),
            base,
            rim: rim as f32,
            per_rim: (1.0 / width) as f32,
            share,
            share_step,
        }
    }

    /// How far what is at `y` is known, in [0, 1].
    #[inline]
    pub(crate) fn at(&self, y: &[f32; D]) -> f32 {
        let mut known = 1.0;
        for k in 0..D {
            if self.base[k] {
                let t = ((y[k] - self.low[k]).min(self.high[k] - y[k]) - self.rim) * self.per_rim;
                if t < 1.0 {
                    if t <= 0.0 {
                        return 0.0;
                    }
                    known *= t * t * (3.0 - 2.0 * t);
                }
            }
        }
        known
    }

    /// Share of the window around `m` that is known.
    pub(crate) fn share(&self, m: &[f64; D]) -> f64 {
        let mut share = 1.0;
        for k in 0..D {
            if self.base[k] {
                let lost = [m[k] - f64::from(self.low[k]), f64::from(self.high[k]) - m[k]].map(|t| 1.0 - self.one(t));
                share *= (1.0 - lost[0] - lost[1]).max(0.0);
            }
        }
        share
    }

    fn one(&self, t: f64) -> f64 {
        if t <= 0.0 {
            return 0.0;
        }
        let at = t / self.share_step;
        let low = at as usize;
        match self.share.get(low + 1) {
            Some(next) => self.share[low] + (next - self.share[low]) * (at - low as f64),
            None => 1.0,
        }
    }
}

fn smooth(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
