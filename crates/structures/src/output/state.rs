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

    /// Adds point `i` of another output, or the whole element that begins with it, as it is there. Returns how many points that is.
    pub(crate) fn take(&mut self, pattern: &Pattern<D>, from: &Self, i: usize) -> usize {
        match from.bodies.get(from.body_of[i] as usize) {
            Some(b) => {
                self.add_body(pattern, b.source, b.pose);
                b.count
            }
            None => {
                self.add(from.places[i], from.weights[i]);
                1
            }
        }
    }

    /// The first points of all loose points and elements.
    pub(crate) fn heads(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.places.len()).filter(|&i| self.bodies.get(self.body_of[i] as usize).is_none_or(|b| b.first == i))
    }

    /// The points that go with point `i`: those of its element, or itself.
    pub(crate) fn members(&self, i: usize) -> std::ops::Range<usize> {
        match self.bodies.get(self.body_of[i] as usize) {
            Some(b) => b.first..b.first + b.count,
            None => i..i + 1,
        }
    }

    /// The output without the points and elements for which `keep` says no; an element goes as its first point does.
    pub(crate) fn filtered(&self, pattern: &Pattern<D>, keep: impl Fn(usize) -> bool) -> Self {
        let mut output = Self::default();
        for i in self.heads() {
            if self.is_kept(i) || keep(i) {
                let count = output.take(pattern, self, i);
                output.kept += if self.is_kept(i) { count } else { 0 };
            }
        }
        output
    }
}
