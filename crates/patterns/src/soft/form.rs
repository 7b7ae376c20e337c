//! What the elements of an exemplar are to those who lay them out and move them: samples, pieces between them, and links that hold them
//! together.

use std::sync::Arc;

use arabesque_core::{Build, Exemplar, Soft, Vector};

/// How far apart along a strand samples are linked, and how much of what is missing to the length of the link is made up at once. The
/// longer ones keep its bends.
const STRAND: [(usize, f64); 4] = [(1, 1.0), (2, 0.4), (4, 0.25), (8, 0.15)];
/// The same for the samples of bags, near and far, and of what does not bend.
const BAG: (f64, f64) = (0.6, 0.15);
const RIGID: f64 = 1.0;
/// Samples of a bag nearer than so many of its shortest links are near.
const NEAR: f64 = 1.8;
/// A sample is linked to no more others than this.
const MOST: usize = 26;

/// Two samples that keep their distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) a: u32,
    pub(super) b: u32,
    pub(super) length: f64,
    /// What share of the difference is made up at once.
    pub(super) share: f64,
}

/// An element of the exemplar.
#[derive(Clone, Debug)]
pub(super) struct Form<const D: usize> {
    pub(super) soft: Arc<Soft<D>>,
    pub(super) class: usize,
    pub(super) links: Vec<Link>,
    /// Samples between which there is something of it: two that follow one another on a strand, else one twice.
    pub(super) pieces: Vec<[u32; 2]>,
    /// Distance from its middle to its farthest place.
    pub(super) reach: f64,
    /// Thickest sample, and longest piece.
    pub(super) thickest: f64,
    pub(super) longest: f64,
    pub(super) copyable: bool,
}

impl<const D: usize> Form<D> {
    fn new(soft: &Arc<Soft<D>>, class: usize, copyable: bool) -> Self {
        let samples = &soft.samples;
        let n = samples.len();
        let pieces: Vec<[u32; 2]> = match soft.build {
            Build::Strand if n > 1 => (1..n as u32).map(|k| [k - 1, k]).collect(),
            _ => (0..n as u32).map(|k| [k, k]).collect(),
        };
        let links = match soft.build {
            Build::Strand => strand_links(samples),
            Build::Bag => bag_links(samples),
            Build::Rigid => all_links(samples, &|_| RIGID),
        };
        let middle = soft.middle(samples);
        let reach = samples.iter().zip(&soft.radii).map(|(p, r)| (*p - middle).norm() + r).fold(0.0, f64::max);
        let thickest = soft.radii.iter().copied().fold(0.0, f64::max);
        let longest =
            pieces.iter().map(|p| (samples[p[0] as usize] - samples[p[1] as usize]).norm()).fold(0.0, f64::max);
        Self { soft: Arc::clone(soft), class, links, pieces, reach, thickest, longest, copyable }
    }

    /// Whether its samples are places of a line.
    pub(super) fn is_line(&self) -> bool {
        self.soft.build == Build::Strand && self.soft.samples.len() > 1
    }

    pub(super) fn len(&self) -> usize {
        self.soft.samples.len()
    }
}

/// The elements of an exemplar.
pub(super) fn forms<const D: usize>(exemplar: &Exemplar<D>) -> Vec<Form<D>> {
    let copyable = |role| role == arabesque_core::Role::Source;
    exemplar.elements.iter().zip(&exemplar.softs).map(|(e, s)| Form::new(s, e.class, copyable(e.role))).collect()
}

fn link<const D: usize>(samples: &[Vector<D>], a: usize, b: usize, share: f64) -> Link {
    Link { a: a as u32, b: b as u32, length: (samples[a] - samples[b]).norm(), share }
}

fn strand_links<const D: usize>(samples: &[Vector<D>]) -> Vec<Link> {
    let along = |(step, share): (usize, f64)| (step..samples.len()).map(move |k| link(samples, k - step, k, share));
    STRAND.into_iter().rev().flat_map(along).collect()
}

fn bag_links<const D: usize>(samples: &[Vector<D>]) -> Vec<Link> {
    let all = all_links(samples, &|_| BAG.1);
    let shortest = all.iter().map(|l| l.length).fold(f64::INFINITY, f64::min);
    let share = |l: &Link| if l.length <= NEAR * shortest { BAG.0 } else { BAG.1 };
    all.iter().map(|l| Link { share: share(l), ..*l }).collect()
}

fn all_links<const D: usize>(samples: &[Vector<D>], share: &dyn Fn(f64) -> f64) -> Vec<Link> {
    let mut links = Vec::new();
    for a in 0..samples.len() {
        for b in a + 1..samples.len().min(a + 1 + MOST) {
            let plain = link(samples, a, b, 0.0);
            links.push(Link { share: share(plain.length), ..plain });
        }
    }
    links
}
