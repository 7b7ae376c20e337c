//! Attributes as weights of the Gaussians [Roveri 2015 §4.1, §4.4].
//!
//! Every point has mass 1; directions, colours, radii, classes and whether it belongs to a rigid element are further channels, weighted so that
//! none outweighs the place itself.

use arabesque_core::{Matrix, PointSet, Vector};

use crate::params::StructureParams;

/// Most channels there are: mass, three of a direction, rigid or not, radius, three of a colour, and three for classes, or more where some of
/// the others are not there.
pub(crate) const LANES: usize = 12;
/// Channels are handled so many at a time.
pub(crate) const BLOCK: usize = 4;
/// Weight of belonging to a rigid element.
const RIGID: f64 = 1.0;
/// How much of the mass of a point another one of a different class does not see.
const APART: f64 = 0.7;

/// The weights of one point's Gaussian.
pub(crate) type Weights = [f32; LANES];

/// Which channel holds what.
#[derive(Clone, Debug, Default)]
pub(crate) struct Channels {
    /// First of the channels of a direction, and its weight.
    normal: Option<(usize, f64)>,
    rigid: Option<usize>,
    /// Channel, mean and weight over mean.
    radius: Option<(usize, f64, f64)>,
    /// First channel, means, weight.
    colour: Option<(usize, [f64; 3], f64)>,
    /// First channel, and what stands for each class.
    class: Option<(usize, Vec<Code>)>,
    count: usize,
}

/// A class of points and its weights.
#[derive(Clone, Debug)]
struct Code {
    class: i32,
    weights: Vec<f32>,
}

/// Corners of a regular simplex, one for each class: any two of them are alike, so that no class is nearer to another than the rest.
fn codes(classes: &[i32]) -> Vec<Code> {
    let scale = (APART * classes.len() as f64).sqrt();
    let weight = |k: usize, axis: usize| {
        let along = axis as f64 + 1.0;
        let at = if k <= axis {
            1.0
        } else if k == axis + 1 {
            -along
        } else {
            0.0
        };
        (scale * at / (along * (along + 1.0)).sqrt()) as f32
    };
    let code = |(k, &class): (usize, &i32)| Code {
        class,
        weights: (1..classes.len()).map(|axis| weight(k, axis - 1)).collect(),
    };
    classes.iter().enumerate().map(code).collect()
}

impl Channels {
    /// The channels for the attributes that `points` have.
    pub(crate) fn new<const D: usize>(points: &PointSet<D>, params: &StructureParams) -> Self {
        let mut channels = Self { count: 1, ..Self::default() };
        let mut take = |n: usize| {
            channels.count += n;
            channels.count - n
        };
        let n = points.len().max(1) as f64;
        let normal = (points.normals.is_some() && params.normals > 0.0).then(|| (take(D), params.normals));
        let mixed = |e: &Vec<i32>| e.iter().any(|&v| v >= 0) && e.iter().any(|&v| v < 0);
        let rigid = points.elements.as_ref().is_some_and(mixed).then(|| take(1));
        let radius = points.radii.as_ref().filter(|_| params.radii > 0.0).map(|radii| {
            let mean = radii.iter().sum::<f64>() / n;
            (take(1), mean, params.radii / mean.max(f64::MIN_POSITIVE))
        });
        let colour = points.colours.as_ref().filter(|_| params.colours > 0.0).map(|colours| {
            let mean = std::array::from_fn(|k| colours.iter().map(|c| c[k]).sum::<f64>() / n);
            (take(3), mean, 2.0 * params.colours)
        });
        let mut classes = points.classes.clone().unwrap_or_default();
        classes.sort_unstable();
        classes.dedup();
        // More of them than there is room for go with the points of the exemplar that others stand for.
        let fits = classes.len() > 1 && channels.count + classes.len() - 1 <= LANES;
        let class = fits.then(|| (channels.count, codes(&classes)));
        channels.count += class.as_ref().map_or(0, |c| c.1.len() - 1);
        Self { normal, rigid, radius, colour, class, ..channels }
    }

    /// Number of blocks of channels.
    pub(crate) fn blocks(&self) -> usize {
        self.count.div_ceil(BLOCK)
    }

    /// The weights of point `i`.
    pub(crate) fn of<const D: usize>(&self, points: &PointSet<D>, i: usize) -> Weights {
        let mut weights = [0.0; LANES];
        weights[0] = 1.0;
        if let (Some((at, w)), Some(normals)) = (self.normal, &points.normals) {
            (0..D).for_each(|k| weights[at + k] = (w * normals[i][k]) as f32);
        }
        if let (Some(at), Some(elements)) = (self.rigid, &points.elements) {
            weights[at] = if elements[i] >= 0 { RIGID as f32 } else { 0.0 };
        }
        if let (Some((at, mean, w)), Some(radii)) = (self.radius, &points.radii) {
            weights[at] = (w * (radii[i] - mean)) as f32;
        }
        if let (Some((at, mean, w)), Some(colours)) = (self.colour, &points.colours) {
            (0..3).for_each(|k| weights[at + k] = (w * (colours[i][k] - mean[k])) as f32);
        }
        if let (Some((at, codes)), Some(classes)) = (&self.class, &points.classes)
            && let Some(code) = codes.iter().find(|c| c.class == classes[i])
        {
            weights[*at..*at + code.weights.len()].copy_from_slice(&code.weights);
        }
        weights
    }

    /// Whether there are classes in the weights.
    pub(crate) fn has_classes(&self) -> bool {
        self.class.is_some()
    }

    /// The class in `weights`: the one that they are most like.
    pub(crate) fn class(&self, weights: &Weights) -> Option<i32> {
        Some(self.nearest(weights)?.1.class)
    }

    /// The weights with the class that they are most like, instead of something between classes.
    pub(crate) fn classed(&self, mut weights: Weights) -> Weights {
        if let Some((at, code)) = self.nearest(&weights) {
            weights[at..at + code.weights.len()].copy_from_slice(&code.weights);
        }
        weights
    }

    fn nearest(&self, weights: &Weights) -> Option<(usize, &Code)> {
        let (at, codes) = self.class.as_ref()?;
        let likeness = |code: &Code| -> f32 { code.weights.iter().zip(&weights[*at..]).map(|(a, b)| a * b).sum() };
        let best = codes.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b)))?;
        Some((*at, best))
    }

    /// The channels of the class.
    pub(crate) fn classes(&self) -> std::ops::Range<usize> {
        self.class.as_ref().map_or(0..0, |(at, codes)| *at..*at + codes.len() - 1)
    }

    /// The weights with their direction turned.
    #[inline]
    pub(crate) fn turned<const D: usize>(&self, weights: &Weights, by: &Matrix<D>) -> Weights {
        let mut turned = *weights;
        if let Some((at, _)) = self.normal {
            for r in 0..D {
                turned[at + r] = (0..D).map(|c| by.0[r][c] as f32 * weights[at + c]).sum();
            }
        }
        turned
    }

    /// The weights with their direction turned by the inverse of a rotation.
    #[inline]
    pub(crate) fn turned_back<const D: usize>(&self, weights: &Weights, by: &Matrix<D>) -> Weights {
        let mut turned = *weights;
        if let Some((at, _)) = self.normal {
            for r in 0..D {
                turned[at + r] = (0..D).map(|c| by.0[c][r] as f32 * weights[at + c]).sum();
            }
        }
        turned
    }

    /// The channel of the direction, where there is one.
    pub(crate) fn normal(&self) -> Option<usize> {
        self.normal.map(|n| n.0)
    }

    /// The direction in `weights`, of length 1; `None` where there is none.
    pub(crate) fn direction<const D: usize>(&self, weights: &Weights) -> Option<Vector<D>> {
        let (at, _) = self.normal?;
        Vector::<D>(std::array::from_fn(|k| f64::from(weights[at + k]))).unit_if_longer(1e-9)
    }

    /// The weights with this direction.
    pub(crate) fn directed<const D: usize>(&self, mut weights: Weights, direction: Vector<D>) -> Weights {
        if let Some((at, w)) = self.normal {
            (0..D).for_each(|k| weights[at + k] = (w * direction[k]) as f32);
        }
        weights
    }

    /// The radius in `weights`.
    pub(crate) fn radius(&self, weights: &Weights) -> Option<f64> {
        self.radius.map(|(at, mean, w)| mean + f64::from(weights[at]) / w)
    }

    /// The colour in `weights`.
    pub(crate) fn colour(&self, weights: &Weights) -> Option<[f64; 3]> {
        let (at, mean, w) = self.colour?;
        Some(std::array::from_fn(|k| (mean[k] + f64::from(weights[at + k]) / w).clamp(0.0, 1.0)))
    }

    /// The channels of radius and colour.
    pub(crate) fn scalars(&self) -> impl Iterator<Item = usize> {
        let radius = self.radius.map(|r| r.0..r.0 + 1).unwrap_or(0..0);
        radius.chain(self.colour.map(|c| c.0..c.0 + 3).unwrap_or(0..0))
    }
}

/// Inner product of the weights of two Gaussians.
#[inline]
pub(crate) fn inner(a: &Weights, b: &Weights) -> f32 {
    let mut lanes = [0.0_f32; BLOCK];
    for (a, b) in a.chunks_exact(BLOCK).zip(b.chunks_exact(BLOCK)) {
        for k in 0..BLOCK {
            lanes[k] += a[k] * b[k];
        }
    }
    lanes[0] + lanes[1] + (lanes[2] + lanes[3])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_two_classes_are_equally_unlike() {
        for count in 2..=8 {
            let points = PointSet {
                classes: Some((0..count).map(|k| 7 * k - 3).collect()),
                ..PointSet::at(vec![Vector([0.0, 1.0]); count as usize])
            };
            let channels = Channels::new(&points, &StructureParams::default());
            let weights: Vec<Weights> = (0..count as usize).map(|i| channels.of(&points, i)).collect();
            for (i, a) in weights.iter().enumerate() {
                assert_eq!(channels.class(a), Some(7 * i as i32 - 3));
                assert!((inner(a, a) - (1.0 + 0.7 * (count - 1) as f32)).abs() < 1e-5);
                assert!(weights[..i].iter().all(|b| (inner(a, b) - 0.3).abs() < 1e-5));
            }
        }
    }

    #[test]
    fn what_is_between_classes_becomes_the_nearest() {
        let points = PointSet { classes: Some(vec![1, 2, 3]), ..PointSet::at(vec![Vector([0.0, 1.0]); 3]) };
        let channels = Channels::new(&points, &StructureParams::default());
        let [a, b] = [0, 1].map(|i| channels.of(&points, i));
        let between: Weights = std::array::from_fn(|c| 0.6 * a[c] + 0.4 * b[c]);
        assert_eq!(channels.classed(between)[1..], a[1..]);
        assert!(!Channels::new(&PointSet { classes: None, ..points }, &StructureParams::default()).has_classes());
    }
}
