//! Points of the output, and rigid elements that hold some of them together.

use arabesque_core::{Similarity, Vector};

use crate::exemplar::{bodies::LOOSE, channels::Weights, pattern::Pattern};

/// A rigid element of the output: an element of the exemplar where it was put.
#[derive(Clone, Debug)]
pub(crate) struct Placed<const D: usize> {
    /// Index of the element in the exemplar.
    pub(crate) source: usize,
    /// From the exemplar to the output.
    pub(crate) pose: Similarity<D>,
    /// Its first point; the others follow in the order of the exemplar's.
    pub(crate) first: usize,
    /// How many points it has.
    pub(crate) count: usize,
}

/// The points of the output.
#[derive(Clone, Debug, Default)]
pub(crate) struct Output<const D: usize> {
    /// Where they are.
    pub(crate) places: Vec<Vector<D>>,
    /// Their weights, with directions as they are in the output.
    pub(crate) weights: Vec<Weights>,
    /// For each point its rigid element, or [`LOOSE`].
    pub(crate) body_of: Vec<u32>,
    /// Rigid elements.
    pub(crate) bodies: Vec<Placed<D>>,
    /// How many of the first points stay as they are.
    pub(crate) kept: usize,
}

impl<const D: usize> Output<D> {
    /// Adds a point of no rigid element.
    pub(crate) fn add(&mut self, place: Vector<D>, weights: Weights) {
        self.places.push(place);
        self.weights.push(weights);
        self.body_of.push(LOOSE);
    }

    /// Adds an element of the exemplar.
    pub(crate) fn add_body(&mut self, pattern: &Pattern<D>, source: usize, pose: Similarity<D>) {
        let body = &pattern.bodies[source];
        let (first, count) = (self.places.len(), body.members.len());
        for &i in &body.members {
            self.places.push(pose.apply(pattern.points.positions[i]));
            self.weights.push(pattern.channels.turned(&pattern.weights[i], &pose.rotation));
            self.body_of.push(self.bodies.len() as u32);
        }
        self.bodies.push(Placed { source, pose, first, count });
    }

    /// Puts a rigid element somewhere else.
    pub(crate) fn set_pose(&mut self, pattern: &Pattern<D>, b: usize, pose: Similarity<D>) {
        let placed = &mut self.bodies[b];
        placed.pose = pose;
        for (n, &i) in pattern.bodies[placed.source].members.iter().enumerate() {
            self.places[placed.first + n] = pose.apply(pattern.points.positions[i]);
            self.weights[placed.first + n] = pattern.channels.turned(&pattern.weights[i], &pose.rotation);
        }
    }

    /// Whether point `i` stays as it is.
    pub(crate) fn is_kept(&self, i: usize) -> bool {
        i < self.kept
    }

    /// The output without the points and elements for which `keep` says no; an element goes as its first point does.
    pub(crate) fn filtered(&self, pattern: &Pattern<D>, keep: impl Fn(usize) -> bool) -> Self {
        let mut output = Self { kept: 0, ..Self::default() };
        let mut kept = 0;
        let mut i = 0;
        while i < self.places.len() {
            let stays = self.is_kept(i) || keep(i);
            let body = self.body_of[i];
            let count = self.bodies.get(body as usize).map_or(1, |b| b.count);
            if stays {
                match self.bodies.get(body as usize) {
                    Some(b) => output.add_body(pattern, b.source, b.pose),
                    None => output.add(self.places[i], self.weights[i]),
                }
                kept += if self.is_kept(i) { count } else { 0 };
            }
            i += count;
        }
        output.kept = kept;
        output
    }
}
