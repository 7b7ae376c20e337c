//! The place of a patch, and how a bent patch is blended with what is there [Duranleau 2008 §5.3].

use arabesque_core::{Budget, Result, Vector};
use arabesque_surface::OrientedPoints;
use rayon::prelude::*;

use crate::{
    params::ReliefParams,
    patch::{mask::Mask, notes::Notes, usage::Usage},
    sample::Sample,
    texture::{pieces::is_within, understand::Texture},
};

/// Surfaces that are farther apart, in spacings, do not have the same edges.
const ALIKE: f64 = 1.5;
/// How far the points of a pair of a high sheet may be apart, as a share of its height.
const RISE: f64 = 0.35;
const UP: Vector<3> = Vector([0.0, 0.0, 1.0]);

/// What is known of the place of a patch.
pub(crate) struct Site<'a> {
    pub(crate) texture: &'a Texture,
    pub(crate) params: &'a ReliefParams,
    pub(crate) mask: Mask,
    /// The result around.
    pub(crate) samples: Vec<Sample>,
    /// Places of the texture that would go on from patches around, in cells.
    pub(crate) shunned: Vec<[f64; 2]>,
    /// A place, in cells, from which what repeats strictly goes on as it does around; none where it does not matter.
    pub(crate) goes_on: Option<[f64; 2]>,
    /// What was used of the texture so far, and by the patches nearby.
    pub(crate) usage: &'a Usage,
    pub(crate) nearby: Vec<[u32; 2]>,
    pub(crate) budget: &'a Budget,
}

/// What is there already, as a surface.
pub(super) struct Around {
    pub(super) points: OrientedPoints,
    pub(super) samples: Vec<Sample>,
    /// Targets of pairs.
    pub(super) targets: Vec<Sample>,
    pub(super) overlapped: Vec<u32>,
}

impl Site<'_> {
    /// How far points may move.
    pub(super) fn reach(&self) -> f64 {
        self.params.reach * self.texture.patch_side()
    }

    /// The same for the points of a pair: high sheets go up and down to meet.
    pub(super) fn reach_of_pairs(&self) -> f64 {
        let height = self.texture.bounds.max[2] - self.texture.bounds.min[2];
        if self.texture.is_high { self.reach().max(RISE * height) } else { self.reach() }
    }

    /// Moves points in the overlap towards what is there, along their normals if that leads to it, and keeps those that are pasted.
    /// `cut` is the share of the result in the colours, by cells, where that is not the same.
    pub(super) fn blended(
        &self,
        bent: Vec<Sample>,
        (around, cut): (&Around, Option<&[f64]>),
        notes: &mut Notes,
    ) -> Result<Vec<Sample>> {
        let texture = self.texture;
        let near: Vec<&Sample> =
            bent.iter().filter(|s| s.piece == 0 && self.mask.is_near_overlap(s.at, texture.radius)).collect();
        let positions = near.iter().map(|s| s.at).collect();
        let normals = near.iter().map(|s| s.normal).collect();
        let own = OrientedPoints::new(positions, normals, texture.radius, self.budget)?;
        let blend = |s: &Sample| -> Result<Option<(Sample, u8)>> {
            if s.piece > 0 {
                return Ok(self.mask.takes(s.middle()).then_some((*s, 0)));
            }
            // What lies beside may be moved in.
            let is_at_seam = self.mask.is_at_seam(s.at, 1.6 * texture.spacing);
            if !self.mask.is_pasted(s.at) && !is_at_seam {
                return Ok(None);
            }
            let sample = Sample { is_at_seam, ..*s };
            let share = self.mask.share(s.at);
            let paint = cut.map_or(share, |cut| self.mask.share_by(cut, s.at));
            if share <= 0.0 && paint <= 0.0 {
                return Ok(Some((sample, 0)));
            }
            self.budget.spend(9000)?;
            Ok(Some(self.moved(sample, [share, paint], (around, &own))))
        };
        // What bends and blends lies between what was there: nothing comes to lie higher or lower than in the texture.
        let (low, high) = (texture.bounds.min[2], texture.bounds.max[2]);
        let blended: Result<Vec<Option<(Sample, u8)>>> = bent.par_iter().with_min_len(64).map(blend).collect();
        let mut samples = Vec::with_capacity(bent.len());
        for (mut sample, how) in blended?.into_iter().flatten().filter(|(s, _)| self.mask.replaces(s)) {
            sample.at[2] = sample.at[2].clamp(low, high);
            match how {
                1 => notes.by_ray += 1,
                2 => notes.by_projection += 1,
                3 => notes.unmatched += usize::from(self.mask.share(sample.at) > 0.5),
                _ => {}
            }
            samples.push(sample);
        }
        Ok(samples)
    }

    /// A point moved by a share of what leads from the surface of the patch to that of what is there; and how: 1 along its normal, 2 by
    /// projection, 3 not at all. Both surfaces are as smooth, so that edges stay where both have them.
    fn moved(
        &self,
        mut sample: Sample,
        [share, paint]: [f64; 2],
        (around, own): (&Around, &OrientedPoints),
    ) -> (Sample, u8) {
        let reach = (0.6 * self.reach()).max(3.0 * self.texture.spacing);
        let (at, normal) = (sample.at, sample.normal);
        let height = self.texture.bounds.max[2] - self.texture.bounds.min[2];
        // Of a high sheet there is one surface only, above or below.
        let (way, reach) = if self.texture.is_high { (UP, reach.max(height)) } else { (normal, reach) };
        let hit = around.points.hit(at, way, reach);
        let how = if hit.is_some() { 1 } else { 2 };
        let Some(foot) = hit.or_else(|| around.points.project(at, reach, Some(normal))) else { return (sample, 3) };
        let (mut from, mut facing) = own.beside(at, way).unwrap_or((at, normal));
        // Where the surfaces are far apart, they are not alike: the point goes all the way.
        let alike = (1.0 - (foot.point - from).norm() / (ALIKE * self.texture.spacing)).max(0.0);
        (from, facing) = (at + (from - at) * alike, normal + (facing - normal) * alike);
        let other = &around.samples[foot.nearest];
        sample.at = at + (foot.point - from) * share;
        let turned = normal + (foot.normal - facing) * share;
        sample.normal = turned.unit_if_longer(1e-9).unwrap_or(normal);
        let mix = |a: f32, b: f32, share: f64| a + (b - a) * share as f32;
        sample.variation = mix(sample.variation, other.variation, share);
        sample.colour = std::array::from_fn(|k| mix(sample.colour[k], other.colour[k], paint));
        (sample, how)
    }

    /// Leaves out loose pieces that would pass through those that stay.
    pub(super) fn apart(&self, samples: Vec<Sample>, notes: &mut Notes) -> Result<Vec<Sample>> {
        if self.texture.pieces.is_empty() {
            return Ok(samples);
        }
        let staying: Vec<&Sample> = self.samples.iter().filter(|s| s.piece > 0 && !self.mask.replaces(s)).collect();
        let positions = staying.iter().map(|s| s.at).collect();
        let normals = staying.iter().map(|s| s.normal).collect();
        let points = OrientedPoints::new(positions, normals, self.texture.radius, self.budget)?;
        self.budget.spend(samples.len() as u64 * 800)?;
        let is_inside = |s: &Sample| is_within(&points, s.at, self.texture.spacing, |_| true);
        let mut inside = std::collections::BTreeMap::<u32, (usize, usize)>::new();
        for s in samples.iter().filter(|s| s.piece > 0) {
            let count = inside.entry(s.piece).or_default();
            *count = (count.0 + usize::from(is_inside(s)), count.1 + 1);
        }
        let collides = |s: &Sample| {
            inside.get(&s.piece).is_some_and(|(n, all)| *n as f64 > self.texture.pieces.passing * *all as f64)
        };
        let (out, kept): (Vec<Sample>, Vec<Sample>) = samples.into_iter().partition(collides);
        notes.unmatched += out.len();
        Ok(kept)
    }

    /// Points of the result near what is kept that nothing in the patch goes on from.
    pub(super) fn cracks(&self, samples: &[Sample], around: &Around) -> Result<usize> {
        let reach = 2.2 * self.texture.spacing;
        let near: Vec<&Sample> = samples.iter().filter(|s| self.mask.is_near_overlap(s.at, reach)).collect();
        let positions = near.iter().map(|s| s.at).collect();
        let normals = near.iter().map(|s| s.normal).collect();
        let points = OrientedPoints::new(positions, normals, self.texture.radius, self.budget)?;
        self.budget.spend(around.overlapped.len() as u64 * 400)?;
        let is_lost = |i: &&u32| {
            let sample = &around.samples[**i as usize];
            sample.piece == 0
                && self.mask.share(sample.at) > 0.6
                && points.nearest(sample.at, reach, |j| points.normals()[j].dot(sample.normal) > 0.3).is_none()
        };
        Ok(around.overlapped.par_iter().with_min_len(128).filter(is_lost).count())
    }
}
