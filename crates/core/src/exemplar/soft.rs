//! Elements that bend.

use crate::space::Vector;

/// How the samples of an element hold together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Build {
    /// Along a centre line, one after the other: it bends anywhere and keeps its length.
    Strand,
    /// All through its volume: it gives way and comes back to its shape.
    Bag,
    /// It does not bend at all.
    Rigid,
}

/// An element as samples that move by themselves [Ma 2011 §3.1], in coordinates of the exemplar.
#[derive(Clone, Debug, PartialEq)]
pub struct Soft<const D: usize> {
    /// How they hold together.
    pub build: Build,
    /// Places that stand for it, at least one; of a strand from one end to the other, at even steps.
    pub samples: Vec<Vector<D>>,
    /// How thick it is around each.
    pub radii: Vec<f64>,
}

impl<const D: usize> Soft<D> {
    /// The place that tells whether it lies in a domain: the middle of a strand, and the mean of the samples of anything else.
    pub fn middle(&self, samples: &[Vector<D>]) -> Vector<D> {
        let n = samples.len();
        match (self.build, n) {
            (_, 0) => Vector::ZERO,
            (Build::Strand, _) => (samples[(n - 1) / 2] + samples[n / 2]) * 0.5,
            _ => samples.iter().fold(Vector::ZERO, |sum, p| sum + *p) * (1.0 / n as f64),
        }
    }
}
