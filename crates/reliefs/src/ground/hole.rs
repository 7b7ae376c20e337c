//! Patches in the gap of a scan: as in the plane, with the scan around as what is there already.

use arabesque_core::{Bounds, Budget, Error, Result, Stage, Stream, Vector};

use crate::{
    ground::canvas::Canvas,
    ground::store::Store,
    params::ReliefParams,
    patch::mask::Mask,
    patch::{blend::Site, notes::Notes, usage::Usage},
    sample::Sample,
    texture::gap::Gap,
    texture::understand::Texture,
};

const PATCHES: Stage = Stage::new(502);

/// A patch that is laid: its corner, and where it is from.
type Laid = ([f64; 2], [u32; 2]);

/// A scan whose gap is filled.
pub(crate) struct HoleCanvas<'a> {
    texture: &'a Texture,
    params: &'a ReliefParams,
    gap: &'a Gap,
    corners: Vec<[f64; 2]>,
    laid: Vec<Laid>,
    next: usize,
    store: Store,
    seed: u64,
    budget: Budget,
}

impl<'a> HoleCanvas<'a> {
    pub(crate) fn new((texture, params): (&'a Texture, &'a ReliefParams), seed: u64, budget: &Budget) -> Result<Self> {
        let Some(gap) = &texture.gap else {
            return Err(Error::parameter("request", "a gap to be filled", "a texture that was prepared with its gap"));
        };
        let cell = texture.lattice.cell;
        let (side, step) = (texture.patch_side(), (texture.patch - texture.overlap) as f64 * cell);
        // The patches stand around the middle of the gap, and reach beyond it by an overlap.
        let axis = |k: usize| {
            let (low, high) = (gap.bounds[0][k], gap.bounds[1][k]);
            let wanted = high - low + 2.0 * texture.overlap as f64 * cell;
            let count = ((wanted - side) / step).ceil().max(0.0) + 1.0;
            let first = 0.5 * (low + high) - 0.5 * ((count - 1.0) * step + side);
            (0..count as usize).map(move |i| first + i as f64 * step)
        };
        budget.spend(texture.points.len() as u64 * 100)?;
        let mut store = Store::new(0.25 * side);
        (0..texture.points.len()).for_each(|i| store.insert(texture.sample(i)));
        let corners = axis(1).flat_map(|y| axis(0).map(move |x| [x, y])).collect();
        Ok(Self { texture, params, gap, corners, laid: Vec::new(), next: 0, store, seed, budget: budget.clone() })
    }

    fn lay(&mut self, k: usize) -> Result<Option<Notes>> {
        let texture = self.texture;
        let (corner, side, cell) = (self.corners[k], texture.patch_side(), texture.lattice.cell);
        let near = |(c, _): &&Laid| (0..2).all(|k| (c[k] - corner[k]).abs() < 2.0 * side);
        let around: Vec<Laid> = self.laid.iter().filter(near).copied().collect();
        let is_filled = |x: f64, y: f64| {
            let (x, y) = (x + corner[0], y + corner[1]);
            let is_in = |(c, _): &Laid| x >= c[0] && y >= c[1] && x < c[0] + side && y < c[1] + side;
            !self.gap.contains(x, y) || around.iter().any(is_in)
        };
        let mask = Mask::new(cell, (texture.patch, texture.overlap, texture.border), is_filled);
        if !mask.has_room() {
            return Ok(Some(Notes::default()));
        }
        let near = |(c, _): &&Laid| (0..2).all(|k| (c[k] - corner[k]).abs() < side);
        let shunned = around
            .iter()
            .filter(near)
            .map(|(c, place)| [0, 1].map(|k| f64::from(place[k]) + (corner[k] - c[k]) / cell))
            .collect();
        let more =
            (texture.border as f64 * cell).max(self.params.reach * side) + texture.radius + 2.0 * texture.pieces.reach;
        let origin = Vector([corner[0], corner[1], 0.0]);
        let far = Vector([more, more, f64::MAX]);
        let bounds = Bounds::new(origin - far, origin + far + Vector([side, side, 0.0]));
        let mut samples = Vec::new();
        self.store.within(&bounds, |s| samples.push(Sample { at: s.at - origin, ..*s }));
        self.budget.spend(samples.len() as u64 * 40)?;
        let (usage, nearby, budget) = (&Usage::default(), Vec::new(), &self.budget);
        // The scan is where it is: what closes its gap goes on from there.
        let goes_on = Some([0, 1].map(|k| (corner[k] - texture.origin[k]) / cell));
        let site = Site { texture, params: self.params, mask, samples, shunned, goes_on, usage, nearby, budget };
        let Some(laid) = site.lay(&mut Stream::new(self.seed, PATCHES, k as u64))? else { return Ok(None) };
        let seam = 1.6 * texture.spacing;
        self.store.remove(&bounds, |s| {
            let p = s.at - origin;
            s.is_at_seam |= site.mask.is_at_seam(p, seam);
            site.mask.replaces(&Sample { at: p, ..*s })
        });
        // A gap ends where the scan does.
        let placed = laid.samples.iter().map(|s| Sample { at: s.at + origin, ..*s });
        placed.filter(|s| self.gap.is_framed(s.at[0], s.at[1])).for_each(|s| self.store.insert(s));
        self.laid.push((corner, laid.place));
        Ok(Some(laid.notes))
    }
}

impl Canvas for HoleCanvas<'_> {
    fn step(&mut self) -> Result<Option<Notes>> {
        if self.next >= self.corners.len() {
            return Ok(None);
        }
        let notes = self.lay(self.next)?;
        self.next += 1;
        Ok(notes)
    }

    fn steps(&self) -> usize {
        self.corners.len()
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
}
