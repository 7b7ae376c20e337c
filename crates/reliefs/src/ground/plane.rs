//! Patches side by side in the plane, row by row [Duranleau 2008 fig. 1]; in a tile the last ones meet the first.

use arabesque_core::{Bounds, Budget, Error, Result, Stage, Stream, Vector};
use rayon::prelude::*;

use crate::{
    ground::canvas::Canvas,
    ground::store::Store,
    params::ReliefParams,
    patch::mask::Mask,
    patch::{blend::Site, notes::Notes, site::Laid, usage::Usage},
    sample::Sample,
    texture::{repeat::Repeat, understand::Texture},
};

const PATCHES: Stage = Stage::new(501);
/// Patches that are made at once at most: it must not depend on the number of threads.
const BATCH: usize = 16;

/// How many more patches are tried where a tile closes.
const CLOSING: usize = 4;
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
    /// Those for the last patches of a tile, which have to meet the first.
    closing: ReliefParams,
    size: [f64; 2],
    is_tile: bool,
    rows: [Row; 2],
    /// How what repeats strictly does so here: as in the texture, but for what a tile takes to close.
    repeat: Option<Repeat>,
    store: Store,
    /// For each patch the place in the texture that it is from, once it is laid.
    laid: Vec<Option<[u32; 2]>>,
    /// The order in which patches are laid, and how many are.
    order: Vec<u32>,
    next: usize,
    usage: Usage,
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
        // At the rim of the first and last patches there is nothing to blend with: so much is cut off.
        let (patch, rim) = (texture.patch_side(), (texture.overlap + 1) as f64 * cell);
        let step = (texture.patch - texture.overlap) as f64 * cell;
        let row = |length: f64| {
            if is_tile {
                let count = (length / step).ceil().max(1.0);
                Row { first: 0.0, step: length / count, count: count as usize }
            } else {
                let count = ((length + 2.0 * rim - patch) / step).ceil().max(0.0) + 1.0;
                Row { first: -rim, step, count: count as usize }
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
            closing: ReliefParams { tolerance: 0.0, tries: params.tries.saturating_mul(CLOSING), ..params.clone() },
            size,
            is_tile,
            rows,
            repeat: repeat_in(texture, is_tile.then_some(size)),
            store: Store::new(0.25 * patch),
            laid: vec![None; count],
            order: along_diagonals(rows[0].count, count),
            next: 0,
            usage: Usage::new((texture.field.width, texture.field.height), texture.patch),
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

    /// A place in the texture from which a patch with its corner here goes on as the first patch does.
    fn goes_on(&self, corner: [f64; 2]) -> Option<[f64; 2]> {
        let (here, texture) = (self.repeat?, self.texture.repetition.repeat?);
        let (first, place) = (self.corner(self.order[0] as usize), self.laid[self.order[0] as usize]?);
        let way = here.of(&texture, [0, 1].map(|k| (corner[k] - first[k]) / self.texture.lattice.cell));
        Some([0, 1].map(|k| f64::from(place[k]) + way[k]))
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

/// The lattice of what repeats strictly, in the plane or in a tile of this size; none where the tile does not suit it.
fn repeat_in(texture: &Texture, tile: Option<[f64; 2]>) -> Option<Repeat> {
    let repeat = texture.repetition.repeat?;
    match tile {
        Some(size) => repeat.closing(size.map(|s| s / texture.lattice.cell)),
        None => Some(repeat),
    }
}

/// Patches by the diagonals of the rows: those of a diagonal see all that they would see in rows, and do not see one another.
fn along_diagonals(across: usize, count: usize) -> Vec<u32> {
    let mut order: Vec<u32> = (0..count as u32).collect();
    order.sort_by_key(|&k| (k as usize % across + 2 * (k as usize / across), k));
    order
}

/// A patch that was made, and what it takes the place of.
struct Made {
    k: usize,
    bounds: Bounds<3>,
    mask: Mask,
    laid: Laid,
}

impl PlaneCanvas<'_> {
    /// How far from a patch something may be that it sees.
    fn seen(&self) -> f64 {
        let texture = self.texture;
        let border = texture.border as f64 * texture.lattice.cell;
        let far = texture.lattice.reach.max(self.params.reach * texture.patch_side());
        border.max(far) + texture.radius + texture.pieces.reach + 4.0 * texture.spacing
    }

    /// The patches that are laid next: some of one diagonal that neither see nor touch one another, wherever the plane repeats.
    fn batch(&self) -> Vec<usize> {
        // One sees what the other changes, its border and the pieces that reach beyond it.
        let texture = self.texture;
        let changed = texture.border as f64 * texture.lattice.cell + texture.pieces.reach;
        let reach = texture.patch_side() + self.seen().max(changed) + changed;
        let diagonal = |k: usize| k % self.rows[0].count + 2 * (k / self.rows[0].count);
        let mut batch: Vec<usize> = Vec::new();
        for &k in self.order[self.next..].iter().take(BATCH) {
            let k = k as usize;
            let is_clear = |&other: &usize| {
                let (a, b) = (self.corner(k), self.corner(other));
                (0..2).any(|axis| {
                    let d = (a[axis] - b[axis]).abs();
                    let d = if self.is_tile { d.min(self.size[axis] - d) } else { d };
                    d > reach
                })
            };
            let goes_on = batch.first().is_none_or(|&first| diagonal(first) == diagonal(k));
            if !goes_on || !batch.iter().all(is_clear) {
                break;
            }
            batch.push(k);
        }
        batch
    }

    /// Makes a patch; `None` where the texture has no place for it.
    fn make(&self, k: usize) -> Result<Option<Made>> {
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
        let more = self.seen();
        let origin = Vector([corner[0], corner[1], 0.0]);
        let bounds =
            Bounds::new(origin - Vector([more, more, f64::MAX]), origin + Vector([side + more, side + more, f64::MAX]));
        let mut samples = Vec::new();
        for shift in self.shifts() {
            let shifted = Bounds::new(bounds.min - shift, bounds.max - shift);
            self.store.within(&shifted, |s| samples.push(Sample { at: s.at + shift - origin, ..*s }));
        }
        self.budget.spend(samples.len() as u64 * 40)?;
        let nearby = around.iter().map(|(_, place)| *place).collect();
        let (usage, budget) = (&self.usage, &self.budget);
        let is_last =
            k % self.rows[0].count + 1 == self.rows[0].count || k / self.rows[0].count + 1 == self.rows[1].count;
        let params = if self.is_tile && is_last { &self.closing } else { self.params };
        let site =
            Site { texture, params, mask, samples, shunned, goes_on: self.goes_on(corner), usage, nearby, budget };
        let laid = site.lay(&mut Stream::new(self.seed, PATCHES, k as u64))?;
        Ok(laid.map(|laid| Made { k, bounds, mask: site.mask, laid }))
    }

    /// Puts a patch in its place.
    fn paste(&mut self, made: Made) -> Notes {
        let Made { k, bounds, mask, laid } = made;
        let corner = self.corner(k);
        let origin = Vector([corner[0], corner[1], 0.0]);
        let seam = 1.6 * self.texture.spacing;
        let has_overlap = mask.has_overlap();
        for shift in self.shifts() {
            let shifted = Bounds::new(bounds.min - shift, bounds.max - shift);
            self.store.remove(&shifted, |s| {
                let p = s.at + shift - origin;
                s.is_at_seam |= has_overlap && mask.is_at_seam(p, seam);
                mask.replaces(&Sample { at: p, ..*s })
            });
        }
        for s in laid.samples {
            let mut at = s.at + origin;
            if self.is_tile {
                (at[0], at[1]) = (at[0].rem_euclid(self.size[0]), at[1].rem_euclid(self.size[1]));
            }
            self.store.insert(Sample { at, ..s });
        }
        self.laid[k] = Some(laid.place);
        self.usage.add(laid.place);
        laid.notes
    }
}

impl Canvas for PlaneCanvas<'_> {
    fn step(&mut self) -> Result<Option<Notes>> {
        let batch = self.batch();
        let made: Result<Vec<Option<Made>>> = batch.par_iter().map(|&k| self.make(k)).collect();
        let mut notes = Notes::default();
        self.next += batch.len();
        made?.into_iter().flatten().for_each(|made| notes.add(self.paste(made)));
        // Where the texture has no place for a patch it has none for the others.
        Ok((notes.patches > 0).then_some(notes))
    }

    fn steps(&self) -> usize {
        self.laid.len()
    }

    fn count(&self) -> usize {
        self.store.len()
    }

    fn samples(&self) -> Vec<Sample> {
        self.cut(self.store.all().copied())
    }

    fn into_samples(mut self: Box<Self>) -> Vec<Sample> {
        let all = std::mem::replace(&mut self.store, Store::new(1.0)).into_all();
        self.cut(all)
    }

    fn period(&self) -> Option<[f64; 2]> {
        self.is_tile.then_some(self.size)
    }

    fn extent(&self) -> Option<[f64; 2]> {
        (!self.is_tile).then_some(self.size)
    }
}

impl PlaneCanvas<'_> {
    /// What lies within the extent.
    fn cut(&self, all: impl Iterator<Item = Sample>) -> Vec<Sample> {
        // Loose pieces are not cut at the border.
        let inside = |s: &Sample| {
            let at = if self.is_tile { s.at } else { s.middle() };
            (0..2).all(|k| (0.0..=self.size[k]).contains(&at[k]))
        };
        let mut samples: Vec<Sample> = all.filter(inside).collect();
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_patch_comes_after_those_that_it_sees_in_rows() {
        let (across, count) = (5, 35);
        let order = along_diagonals(across, count);
        let when: Vec<usize> = (0..count as u32).map(|k| order.iter().position(|&o| o == k).unwrap()).collect();
        for k in 0..count {
            let (i, j) = (k % across, k / across);
            let before = [
                (i > 0).then(|| k - 1),
                (j > 0).then(|| k - across),
                (j > 0 && i + 1 < across).then(|| k + 1 - across),
            ];
            assert!(before.into_iter().flatten().all(|other| when[other] < when[k]), "{k}");
        }
    }
}
