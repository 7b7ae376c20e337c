//! Random streams that do not depend on thread count or loop order.
//!
//! A stream belongs to a (seed, stage, item) triple: whoever works on item `i` of a stage draws from the
//! stream of that item, so the draw is the same whichever thread does the work.

use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

/// What a stream is drawn for; part of its key. Each method declares its own, so that a stage keeps its streams whatever other methods do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stage(u64);

impl Stage {
    /// Everything in tests and benchmarks.
    pub const TEST: Self = Self(99);

    /// The stage with this number among those of a method. Results depend on the number.
    pub const fn new(number: u64) -> Self {
        Self(number)
    }
}

/// One stream of random numbers.
#[derive(Clone, Debug)]
pub struct Stream(ChaCha8Rng);

impl Stream {
    /// The stream of `item` in `stage` of the run with `seed`.
    pub fn new(seed: u64, stage: Stage, item: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ stage.0.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        rng.set_stream(item);
        Self(rng)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// Uniform in [low, high).
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in 0..n; 0 when `n` is 0.
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.0.next_u64()) * n as u128) >> 64) as usize
    }

    /// Shuffles in place, every order equally likely.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for k in (1..items.len()).rev() {
            items.swap(k, self.below(k + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_repeat_and_differ() {
        let draw = |item| Stream::new(7, Stage::TEST, item).unit();
        assert_eq!(draw(3), draw(3));
        assert_ne!(draw(3), draw(4));
    }

    #[test]
    fn below_stays_below() {
        let mut s = Stream::new(0, Stage::TEST, 0);
        assert!((0..1000).all(|_| s.below(5) < 5));
        assert_eq!(s.below(0), 0);
    }
}
