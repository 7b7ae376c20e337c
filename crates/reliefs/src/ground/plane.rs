//! Patches side by side in the plane, row by row [Duranleau 2008 fig. 1]; in a tile the last ones meet the first.

use arabesque_core::{Bounds, Budget, Error, Result, Stage, Stream, Vector};

use crate::{
    ground::canvas::Canvas,
    ground::store::Store,
    params::ReliefParams,
    patch::mask::Mask,
    patch::{blend::Site, notes::Notes, site::Laid},
    sample::Sample,
    texture::understand::Texture,
};

const PATCHES: Stage = Stage::new(501);

/// Patches at most.
const MOST: f64 = 4e6;

/// One axis of the plane.
#[derive(Clone, Copy, Debug)]
struct Row {
    first: f64,
    step: f64,
    count: usize,
}

/// The plane, as far as it is covered.
pub(crate) struct PlaneCanvas<'a> {
    texture: &'a Texture,
    params: &'a ReliefParams,
    size: [f64; 2],
    is_tile: bool,
    rows: [Row; 2],
    store: Store,
    /// For each patch the place in the texture that it is from, once it is laid.
    laid: Vec<Option<[u32; 2]>>,
    next: usize,
    seed: u64,
    budget: Budget,
}

impl<'a> PlaneCanvas<'a> {
    pub(crate) fn new(
        (texture, params): (&'a Texture, &'a ReliefParams),
        size: [f64; 2],
        is_tile: bool,
        seed: u64,
        budget: &Budget,
    ) -> Result<Self> {
        let cell = texture.lattice.cell;
        let (patch, border) = (texture.patch_side(), texture.border as f64 * cell);
        let step = (texture.patch - texture.overlap) as f64 * cell;
        let row = |length: f64| {
            if is_tile {
                let count = (length / step).ceil().max(1.0);
                Row { first: 0.0, step: length / count, count: count as usize }
            } else {
                let count = ((length + 2.0 * border - patch) / step).ceil().max(0.0) + 1.0;
                Row { first: -border, step, count: count as usize }
            }
        };
        if let Some(k) = (0..2).find(|&k| !(size[k].is_finite() && size[k] > 0.0)) {
            return Err(Error::parameter("extent", size[k], "a positive width and depth"));
        }
        if size.iter().any(|s| s / step > MOST) || size.iter().map(|s| s / step).product::<f64>() > MOST {
            let shown = format!("{}x{}", size[0], size[1]);
            return Err(Error::parameter("extent", shown, format!("at most {MOST:e} patches of {patch:.4}")));
        }
        let least = patch + step;
        if is_tile && size.iter().any(|s| *s < least) {
            let shown = format!("{}x{}", size[0], size[1]);
            return Err(Error::parameter(
                "extent",
                shown,
                format!(
                    "a tile of at least {least:.4} each way, or a smaller patch: two patches have to lie side by side"
                ),
            ));
        }
        let rows = size.map(row);
        let count = rows[0].count * rows[1].count;
        Ok(Self {
            texture,
            params,
            size,
            is_tile,
            rows,
            store: Store::new(0.25 * patch),
            laid: vec![None; count],
            next: 0,
            seed,
            budget: budget.clone(),
        })
    }

    fn corner(&self, k: usize) -> [f64; 2] {
        let [across, down] = self.rows;
        [across.first + (k % across.count) as f64 * across.step, down.first + (k / across.count) as f64 * down.step]
    }

    /// Shifts under which the plane repeats.
    fn shifts(&self) -> Vec<Vector<3>> {
        if !self.is_tile {
            return vec![Vector::ZERO];
        }
        let of = |dy: f64| [-1.0, 0.0, 1.0].map(|dx: f64| Vector([dx * self.size[0], dy * self.size[1], 0.0]));
        [-1.0, 0.0, 1.0].into_iter().flat_map(of).collect()
    }

    /// The patches around a place that are laid, with where they are as seen from there.
    fn laid_around(&self, corner: [f64; 2]) -> Vec<([f64; 2], [u32; 2])> {
        let reach = 2.0 * self.texture.patch_side();
        let range = |k: usize| {
            let row = self.rows[k];
            let low = ((corner[k] - reach - row.first) / row.step).ceil();
            let high = ((corner[k] + reach - row.first) / row.step).floor();
            let (low, high) = if self.is_tile { (low, high) } else { (low.max(0.0), high.min(row.count as f64 - 1.0)) };
            low as i64..=high as i64
        };
        let mut around = Vec::new();
        for j in range(1) {
            for i in range(0) {
                let [across, down] = self.rows;
                let (ci, cj) = (i.rem_euclid(across.count as i64) as usize, j.rem_euclid(down.count as i64) as usize);
                if let Some(place) = self.laid[cj * across.count + ci] {
                    around.push(([across.first + i as f64 * across.step, down.first + j as f64 * down.step], place));
                }
            }
        }
        around
    }
}

impl Canvas for PlaneCanvas<'_> {
    fn step(&mut self) -> Result<Option<Notes>> {
        if self.next >= self.laid.len() {
            return Ok(None);
        }
        let k = self.next;
        let texture = self.texture;
        let (corner, side, cell) = (self.corner(k), texture.patch_side(), texture.lattice.cell);
        let around = self.laid_around(corner);
        let is_filled = |x: f64, y: f64| {
            let (x, y) = (x + corner[0], y + corner[1]);
            let eps = 1e-6 * cell;
            around
                .iter()
                .any(|([px, py], _)| x > px - eps && x < px + side + eps && y > py - eps && y < py + side + eps)
        };
        let mask = Mask::new(cell, (texture.patch, texture.overlap, texture.border), is_filled);
        let near = |c: &[f64; 2]| (0..2).all(|k| (c[k] - corner[k]).abs() < side);
        let shunned = around
            .iter()
            .filter(|(c, _)| near(c))
            .map(|(c, place)| [0, 1].map(|k| f64::from(place[k]) + (corner[k] - c[k]) / cell))
            .collect();
        let more =
            (texture.border as f64 * cell).max(self.params.reach * side) + texture.radius + 2.0 * texture.pieces.reach;
        let origin = Vector([corner[0], corner[1], 0.0]);
        let bounds =
            Bounds::new(origin - Vector([more, more, f64::MAX]), origin + Vector([side + more, side + more, f64::MAX]));
        let mut samples = Vec::new();
        for shift in self.shifts() {
            let shifted = Bounds::new(bounds.min - shift, bounds.max - shift);
            self.store.within(&shifted, |s| samples.push(Sample { at: s.at + shift - origin, ..*s }));
        }
        self.budget.spend(samples.len() as u64 * 40)?;
        let site = Site { texture, params: self.params, mask, samples, shunned, budget: &self.budget };
        let Some(Laid { samples, place, notes }) = site.lay(&mut Stream::new(self.seed, PATCHES, k as u64))? else {
            return Ok(None);
        };
        let seam = 1.6 * texture.spacing;
        for shift in self.shifts() {
            let shifted = Bounds::new(bounds.min - shift, bounds.max - shift);
            self.store.remove(&shifted, |s| {
                let p = s.at + shift - origin;
                s.is_at_seam |= site.mask.has_overlap() && site.mask.is_at_seam(p, seam);
                site.mask.replaces(&Sample { at: p, ..*s })
            });
        }
        for s in samples {
            let mut at = s.at + origin;
            if self.is_tile {
                (at[0], at[1]) = (at[0].rem_euclid(self.size[0]), at[1].rem_euclid(self.size[1]));
            }
            self.store.insert(Sample { at, ..s });
        }
        self.laid[k] = Some(place);
        self.next += 1;
        Ok(Some(notes))
    }

    fn steps(&self) -> usize {
        self.laid.len()
    }

    fn count(&self) -> usize {
        self.store.len()
    }

    fn samples(&self) -> Vec<Sample> {
        // Loose pieces are not cut at the border.
        let inside = |s: &&Sample| {
            let at = if self.is_tile { s.at } else { s.middle() };
            (0..2).all(|k| (0.0..=self.size[k]).contains(&at[k]))
        };
        let mut samples: Vec<Sample> = self.store.all().filter(inside).copied().collect();
        for s in &mut samples {
            // What lies at the far border of a tile lies at the near one.
            for k in 0..2 {
                if self.is_tile && s.at[k] >= self.size[k] {
                    s.at[k] = 0.0;
                }
            }
        }
        samples
    }

    fn period(&self) -> Option<[f64; 2]> {
        self.is_tile.then_some(self.size)
    }
}
