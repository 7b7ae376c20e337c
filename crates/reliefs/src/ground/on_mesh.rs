//! Patches on a mesh: each is laid in a chart around its middle, in which what is there already lies flat.

use std::collections::BTreeSet;

use arabesque_core::{Budget, Error, Result, Stage, Stream, Vector};
use arabesque_surface::{DirectionField, MeshIndex};
use rayon::prelude::*;

use crate::{
    ground::canvas::Canvas,
    ground::chart::{Chart, Samples},
    ground::store::Store,
    params::ReliefParams,
    patch::mask::Mask,
    patch::{blend::Site, notes::Notes, usage::Usage},
    sample::Sample,
    texture::understand::Texture,
};

const PATCHES: Stage = Stage::new(503);
/// How far from a patch others are nearby, in sides.
const NEARBY: f64 = 2.2;
/// Samples along a cell of the field.
const SAMPLES: f64 = 1.0;

/// The shell of a mesh, as far as it is covered.
pub(crate) struct MeshCanvas<'a> {
    texture: &'a Texture,
    params: &'a ReliefParams,
    mesh: &'a MeshIndex,
    directions: &'a DirectionField,
    scale: f64,
    /// The height of the texture that lies on the mesh.
    base: f64,
    samples: Samples,
    /// Distance of each sample from what is covered, in the frame of the mesh; 0 for what is.
    from_covered: Vec<f64>,
    /// In which order samples were reached: patches stay together.
    store: Store,
    /// Where patches lie, and what they are of.
    laid: Vec<(Vector<3>, [u32; 2])>,
    usage: Usage,
    seed: u64,
    budget: Budget,
}

impl<'a> MeshCanvas<'a> {
    pub(crate) fn new(
        (texture, params): (&'a Texture, &'a ReliefParams),
        (mesh, directions, scale): (&'a MeshIndex, &'a DirectionField, f64),
        seed: u64,
        budget: &Budget,
    ) -> Result<Self> {
        let cell = texture.lattice.cell * scale;
        let samples = Samples::new(mesh, SAMPLES * cell, budget)?;
        if samples.spacing > 0.2 * texture.patch_side() * scale {
            let expected = "a scale at which the mesh has fewer patches, or a smaller mesh";
            return Err(Error::parameter("scale", scale, expected));
        }
        let heights = [texture.bounds.min[2], texture.bounds.max[2]];
        Ok(Self {
            texture,
            params,
            mesh,
            directions,
            scale,
            base: 0.5 * (heights[0] + heights[1]),
            from_covered: vec![f64::INFINITY; samples.feet.len()],
            samples,
            store: Store::new(0.25 * texture.patch_side() * scale),
            laid: Vec::new(),
            usage: Usage::new((texture.field.width, texture.field.height), texture.patch),
            seed,
            budget: budget.clone(),
        })
    }

    /// The sample around which the next patch lies: so far from what is covered that the patch overlaps it, and near the first one.
    fn next(&self) -> Option<u32> {
        let side = self.texture.patch_side() * self.scale;
        let wanted = 0.5 * side - self.texture.overlap as f64 * self.texture.lattice.cell * self.scale;
        if self.laid.is_empty() {
            return Some(0);
        }
        let first = self.samples.feet[0].point;
        let mut best: Option<((bool, f64), u32)> = None;
        for (i, &far) in self.from_covered.iter().enumerate() {
            if far <= 0.0 {
                continue;
            }
            let is_good = far.is_finite() && far <= wanted && far > 0.7 * wanted;
            // Of good places the nearest to the first; of others that which is farthest within reach.
            let rank = if is_good {
                (false, (self.samples.feet[i].point - first).norm())
            } else if far <= wanted {
                (true, -far)
            } else {
                (true, far)
            };
            if best.is_none_or(|(least, _)| rank < least) {
                best = Some((rank, i as u32));
            }
        }
        best.map(|(_, i)| i)
    }

    /// Marks what a patch covers, and brings distances up to date.
    fn cover(&mut self, covered: &[u32]) -> Result<()> {
        let mut queue: BTreeSet<(u64, u32)> = BTreeSet::new();
        for &i in covered {
            self.from_covered[i as usize] = 0.0;
            queue.insert((0, i));
        }
        let mut meter = self.budget.meter();
        while let Some((bits, i)) = queue.pop_first() {
            let far = f64::from_bits(bits);
            if far > self.from_covered[i as usize] {
                continue;
            }
            meter.spend(1200)?;
            let here = self.samples.feet[i as usize].point;
            for &j in &self.samples.beside[i as usize] {
                let next = far + (self.samples.feet[j as usize].point - here).norm();
                if next < self.from_covered[j as usize] {
                    self.from_covered[j as usize] = next;
                    queue.insert((next.to_bits(), j));
                }
            }
        }
        Ok(())
    }
}

impl Canvas for MeshCanvas<'_> {
    fn step(&mut self) -> Result<Option<Notes>> {
        self.budget.spend(self.samples.feet.len() as u64 * 4)?;
        let Some(start) = self.next() else { return Ok(None) };
        let texture = self.texture;
        let (side, cell, scale) = (texture.patch_side(), texture.lattice.cell, self.scale);
        let half = 0.5 * side;
        let more =
            (texture.border as f64 * cell).max(self.params.reach * side) + texture.radius + 2.0 * texture.pieces.reach;
        let foot = self.samples.feet[start as usize];
        let frame = self.directions.frame(self.mesh, &foot);
        let chart = Chart::new((&self.samples, self.mesh), start, &frame, (half + more) * scale, &self.budget)?;
        let is_filled = |x: f64, y: f64| {
            let at = [(x - half) * scale, (y - half) * scale];
            chart.sample_at(at).is_some_and(|i| self.from_covered[i as usize] <= 0.0)
        };
        let mask = Mask::new(cell, (texture.patch, texture.overlap, texture.border), is_filled);
        let height = (texture.bounds.size()[2] + 2.0 * texture.radius) * scale;
        let bounds = chart.bounds().grown(height);
        let corner = Vector([half, half, self.base]);
        let local = |s: &Sample| {
            let (at, normal) = chart.flattened(s.at, s.normal)?;
            Some(Sample { at: at * (1.0 / scale) + corner, normal, ..*s })
        };
        let mut samples = Vec::new();
        let mut found = Vec::new();
        self.store.within(&bounds, |s| found.push(*s));
        self.budget.spend(found.len() as u64 * 6000)?;
        let is_near = |p: Vector<3>| (0..2).all(|k| p[k] > -more && p[k] < side + more);
        let flat: Vec<Option<Sample>> = found.par_iter().with_min_len(64).map(local).collect();
        samples.extend(flat.iter().flatten().filter(|s| is_near(s.at)).copied());
        let (shunned, goes_on, usage, budget) = (Vec::new(), None, &self.usage, &self.budget);
        let near = |(at, _): &&(Vector<3>, [u32; 2])| (*at - foot.point).norm() < NEARBY * side * scale;
        let nearby = self.laid.iter().filter(near).map(|(_, place)| *place).collect();
        let site = Site { texture, params: self.params, mask, samples, shunned, goes_on, usage, nearby, budget };
        let Some(laid) = site.lay(&mut Stream::new(self.seed, PATCHES, self.laid.len() as u64))? else {
            return Ok(None);
        };
        let seam = 1.6 * texture.spacing;
        // They come in the order in which they were found.
        let mut flat = flat.iter();
        self.store.remove(&bounds, |s| {
            let Some(Some(flat)) = flat.next() else { return false };
            s.is_at_seam |= site.mask.has_overlap() && site.mask.is_at_seam(flat.at, seam);
            site.mask.replaces(flat)
        });
        self.budget.spend(laid.samples.len() as u64 * 6000)?;
        let raised = |s: &Sample| {
            let (at, normal) = chart.raised((s.at - corner) * scale, s.normal)?;
            Some(Sample { at, normal, ..*s })
        };
        let raised: Vec<Option<Sample>> = laid.samples.par_iter().with_min_len(64).map(raised).collect();
        raised.into_iter().flatten().for_each(|s| self.store.insert(s));
        let inside = |at: [f64; 2]| at.iter().all(|v| v.abs() <= half * scale);
        let mut covered: Vec<u32> = chart.laid().filter(|(_, at)| inside(*at)).map(|(i, _)| i).collect();
        // Every patch covers something, so that there is an end.
        covered.push(start);
        drop(chart);
        self.cover(&covered)?;
        self.laid.push((foot.point, laid.place));
        self.usage.add(laid.place);
        Ok(Some(laid.notes))
    }

    fn steps(&self) -> usize {
        let step = (texture_step(self.texture) * self.scale).powi(2);
        (self.mesh.area() / step).ceil() as usize
    }

    fn count(&self) -> usize {
        self.store.len()
    }

    fn samples(&self) -> Vec<Sample> {
        self.store.all().copied().collect()
    }

    fn into_samples(self: Box<Self>) -> Vec<Sample> {
        self.store.into_all().collect()
    }

    fn is_flat(&self) -> bool {
        false
    }

    fn scale(&self) -> f64 {
        self.scale
    }
}

/// How far patches are from one another, about.
fn texture_step(texture: &Texture) -> f64 {
    (texture.patch - texture.overlap) as f64 * texture.lattice.cell
}
