//! One patch [Duranleau 2008 §4, §5]: what fits is found in the texture, bent onto what is there, blended with it.
//!
//! All is in the frame of the patch: its corner is the origin, its sides are x and y. Who lays patches brings what is there into this frame and
//! takes the new points out of it.

use arabesque_core::{Bounds, Budget, Result, Stream, Vector};
use arabesque_surface::{OrientedPoints, clusters};
use rayon::prelude::*;

use crate::{
    field::Overlap,
    mask::Mask,
    pairing::{Pair, Pairing},
    params::ReliefParams,
    sample::Sample,
    search::{Candidate, best},
    spline::{Spline, carried, determinant},
    texture::Texture,
};

/// Volumes that are squeezed to less than the first share, or blown up to more than the second, are folds.
const FOLDED: (f64, f64) = (0.15, 8.0);
/// Times that the worst pairs are left out before a patch is given up.
const MENDINGS: usize = 4;
/// Share of pairs that is left out each time.
const WORST: f64 = 0.15;
/// Share of the overlap that may be without a counterpart in a patch that is taken at once.
const TORN: f64 = 0.01;
/// Mean difference at a node, as a share of the most there can be, that counts as none.
const FLOOR: f64 = 2e-3;
/// Share of a loose piece that may lie within others.
const PASSING: f64 = 0.02;
/// Share of a target's surface that bends at most, from which its cluster is split.
const FLAT: f64 = 0.06;
/// How far pairs listen to one another, as a share of the patch.
const LISTENING: f64 = 0.15;

/// What is known of the place of a patch.
pub(crate) struct Site<'a> {
    pub(crate) texture: &'a Texture,
    pub(crate) params: &'a ReliefParams,
    pub(crate) mask: Mask,
    /// The result around.
    pub(crate) samples: Vec<Sample>,
    /// Places of the texture that would go on from patches around, in cells.
    pub(crate) shunned: Vec<[f64; 2]>,
    pub(crate) budget: &'a Budget,
}

/// A patch, ready to be pasted.
#[derive(Debug)]
pub(crate) struct Laid {
    pub(crate) samples: Vec<Sample>,
    /// Where in the texture it comes from.
    pub(crate) place: [u32; 2],
    pub(crate) notes: Notes,
}

/// What was counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Notes {
    /// Patches.
    pub(crate) patches: usize,
    /// Splines that would have folded, and were made again with fewer pairs.
    pub(crate) folds: usize,
    /// Candidates that were passed over for the next.
    pub(crate) passed: usize,
    /// Patches that were laid without being bent.
    pub(crate) unbent: usize,
    /// Points that were blended along a ray, by projection, and not at all.
    pub(crate) by_ray: usize,
    pub(crate) by_projection: usize,
    pub(crate) unmatched: usize,
    /// Points of the result in overlaps that nothing goes on from.
    pub(crate) cracks: usize,
    /// Points in overlaps.
    pub(crate) overlapped: usize,
}

impl Notes {
    pub(crate) fn add(&mut self, other: Self) {
        self.patches += other.patches;
        self.folds += other.folds;
        self.passed += other.passed;
        self.unbent += other.unbent;
        self.by_ray += other.by_ray;
        self.by_projection += other.by_projection;
        self.unmatched += other.unmatched;
        self.cracks += other.cracks;
        self.overlapped += other.overlapped;
    }

    /// Share of the overlap that does not go on.
    fn torn(&self) -> f64 {
        (self.cracks + self.unmatched) as f64 / self.overlapped.max(1) as f64
    }
}

/// What is there already, as a surface.
struct Around {
    points: OrientedPoints,
    /// Targets of pairs.
    targets: Vec<Sample>,
    overlapped: Vec<u32>,
}

impl Site<'_> {
    fn reach(&self) -> f64 {
        self.params.reach * self.texture.patch_side()
    }

    /// Chooses a patch and makes it fit. `None` where the texture has no place for it.
    pub(crate) fn lay(&self, random: &mut Stream) -> Result<Option<Laid>> {
        if self.texture.places.is_empty() {
            return Ok(None);
        }
        let nodes = self.mask.overlapped();
        if nodes.is_empty() || self.samples.is_empty() {
            let place = self.texture.places[random.below(self.texture.places.len())];
            let samples = self.source(place).into_iter().filter(|s| self.mask.replaces(s)).collect();
            return Ok(Some(Laid { samples, place, notes: Notes { patches: 1, ..Notes::default() } }));
        }
        let around = self.around()?;
        let overlap = Overlap::new(&around.points, &self.texture.lattice, nodes, self.budget)?;
        let candidates = self.candidates(&overlap, random)?;
        let mut best: Option<Laid> = None;
        for (n, candidate) in candidates.iter().enumerate() {
            let mut laid = self.fitted(candidate.place, &around)?;
            laid.notes.passed = n;
            let is_good = laid.notes.torn() <= TORN && laid.notes.unbent == 0;
            let folds = laid.notes.folds + best.as_ref().map_or(0, |b| b.notes.folds);
            let rank = |l: &Laid| (l.notes.unbent, l.notes.torn());
            if best.as_ref().is_none_or(|b| rank(&laid) < rank(b)) {
                best = Some(laid);
            }
            if let Some(best) = &mut best {
                (best.notes.folds, best.notes.passed) = (folds, n);
            }
            if is_good {
                break;
            }
        }
        Ok(best)
    }

    /// What is there already, prepared.
    fn around(&self) -> Result<Around> {
        let positions: Vec<_> = self.samples.iter().map(|s| s.at).collect();
        let normals = self.samples.iter().map(|s| s.normal).collect();
        let overlapped: Vec<u32> =
            (0..positions.len() as u32).filter(|&i| self.mask.is_overlap(positions[i as usize])).collect();
        let most = (overlapped.len() / self.params.pairs).max(3);
        let some = clusters(&positions, overlapped.clone(), (most / 3, most), FLAT, self.budget)?;
        let target = |cluster: &Vec<u32>| {
            let sum = cluster.iter().fold(Vector::ZERO, |sum, &i| sum + positions[i as usize]);
            let mean = sum * (1.0 / cluster.len() as f64);
            let far = |i: u32| (positions[i as usize] - mean).norm2();
            let nearest = cluster.iter().copied().min_by(|&a, &b| far(a).total_cmp(&far(b)).then(a.cmp(&b)));
            nearest.map(|i| self.samples[i as usize])
        };
        let targets = some.iter().filter_map(target).collect();
        Ok(Around {
            points: OrientedPoints::new(positions, normals, self.texture.radius, self.budget)?,
            targets,
            overlapped,
        })
    }

    /// Places to try, in the order in which they are tried: one of the best at random, then the others from the best on.
    fn candidates(&self, overlap: &Overlap, random: &mut Stream) -> Result<Vec<Candidate>> {
        let texture = self.texture;
        let apart = self.params.apart * texture.patch as f64;
        let is_shunned = |place: &[u32; 2]| {
            self.shunned.iter().any(|s| {
                let d = [0, 1].map(|k| f64::from(place[k]) - s[k]);
                d[0] * d[0] + d[1] * d[1] < apart * apart
            })
        };
        let mut places: Vec<_> = texture.places.iter().filter(|p| !is_shunned(p)).copied().collect();
        if places.is_empty() {
            places.clone_from(&texture.places);
        }
        let floor = FLOOR * (overlap.nodes.len() * texture.field.planes.len()) as f64;
        let tolerance = self.params.tolerance;
        let found = best(
            &texture.field,
            texture.searcher.as_ref(),
            overlap,
            &places,
            (tolerance, floor, 4 * self.params.tries),
            (self.params.search, self.budget),
        )?;
        let most = (1.0 + tolerance) * found[0].difference.max(floor);
        let within = found.partition_point(|c| c.difference <= most).max(1);
        let mut order = vec![found[random.below(within)]];
        // Beside those that were tried others are hardly better.
        let near = (0.1 * texture.patch as f64).max(1.5);
        for candidate in found {
            let is_near = |c: &Candidate| {
                let d = [0, 1].map(|k| f64::from(c.place[k]) - f64::from(candidate.place[k]));
                d[0] * d[0] + d[1] * d[1] < near * near
            };
            if order.len() < self.params.tries && !order.iter().any(is_near) {
                order.push(candidate);
            }
        }
        Ok(order)
    }

    /// The points of the texture for a patch, and as far around as they may move.
    fn source(&self, place: [u32; 2]) -> Vec<Sample> {
        let texture = self.texture;
        let corner = texture.corner(place);
        let side = texture.patch_side();
        let more = texture.border as f64 * texture.lattice.cell + self.reach();
        let (low, high) = (texture.bounds.min[2], texture.bounds.max[2]);
        let from = Vector([corner[0] - more, corner[1] - more, low]);
        let to = Vector([corner[0] + side + more, corner[1] + side + more, high]);
        let mut numbers = Vec::new();
        let bounds = Bounds::new(from, to);
        texture
            .points
            .inside(&bounds, |i| numbers.extend((texture.pieces.of.get(i).is_none_or(|p| *p == 0)).then_some(i)));
        // Loose pieces come whole.
        let middle = |[x, y]: [f64; 2]| Vector([x, y, 0.5 * (low + high)]);
        let whole = texture.pieces.members.iter().filter(|p| !p.is_cut && bounds.contains(middle(p.middle)));
        whole.for_each(|p| numbers.extend(p.points.iter().map(|&i| i as usize)));
        numbers.sort_unstable();
        let moved = |i: usize| {
            let sample = texture.sample(i);
            Sample { at: sample.at - corner, ..sample }
        };
        numbers.into_iter().map(moved).collect()
    }

    /// The patch of a place, bent and blended.
    fn fitted(&self, place: [u32; 2], around: &Around) -> Result<Laid> {
        let source = self.source(place);
        let mut notes = Notes { patches: 1, overlapped: around.overlapped.len(), ..Notes::default() };
        let bent = self.bent(&source, around, &mut notes)?;
        let bent = bent.unwrap_or_else(|| {
            notes.unbent = 1;
            source
        });
        let samples = self.blended(bent, around, &mut notes)?;
        let samples = self.apart(samples, &mut notes)?;
        notes.cracks = self.cracks(&samples, around)?;
        Ok(Laid { samples, place, notes })
    }

    /// The patch, bent onto what is there; `None` where that cannot be done without folds.
    fn bent(&self, source: &[Sample], around: &Around, notes: &mut Notes) -> Result<Option<Vec<Sample>>> {
        let positions = source.iter().map(|s| s.at).collect();
        let normals = source.iter().map(|s| s.normal).collect();
        let variations: Vec<f32> = source.iter().map(|s| s.variation).collect();
        let points = OrientedPoints::new(positions, normals, self.texture.radius, self.budget)?;
        let listening = LISTENING * self.texture.patch_side();
        let pairing = Pairing { params: self.params, reach: self.reach(), listening };
        let mut pairs = pairing.pairs(&around.targets, &points, &variations, self.budget)?;
        if pairs.len() * 2 < around.targets.len() || pairs.len() < 4 {
            return Ok(None);
        }
        pairs.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        for _ in 0..=MENDINGS {
            let stiffness = self.params.stiffness * self.texture.patch_side();
            let Some(spline) = Spline::new(&self.with_anchors(&pairs), stiffness, self.budget)? else {
                return Ok(None);
            };
            self.budget.spend(spline.work() * source.len() as u64)?;
            let bend = |s: &Sample| {
                let (at, columns) = spline.apply(s.at);
                let volume = determinant(columns);
                let is_sound = (FOLDED.0..FOLDED.1).contains(&volume) || !self.mask.is_pasted(at);
                if s.piece > 0 {
                    // A loose piece is moved, not bent.
                    let shift = spline.apply(s.middle()).0 - s.middle();
                    return (Sample { at: s.at + Vector([shift[0], shift[1], 0.0]), ..*s }, is_sound);
                }
                (Sample { at, normal: carried(s.normal, columns), ..*s }, is_sound)
            };
            let bent: Vec<(Sample, bool)> = source.par_iter().with_min_len(256).map(bend).collect();
            if bent.iter().all(|(_, is_sound)| *is_sound) {
                return Ok(Some(bent.into_iter().map(|(s, _)| s).collect()));
            }
            notes.folds += 1;
            let fewer = ((pairs.len() as f64 * (1.0 - WORST)) as usize).min(pairs.len() - 1);
            if fewer < 4 {
                break;
            }
            pairs.truncate(fewer);
        }
        Ok(None)
    }

    /// The pairs, with points that stay where they are: in the free part of the patch, and above and below some of the pairs, since all pairs
    /// may lie in one plane.
    fn with_anchors(&self, pairs: &[Pair]) -> Vec<(Vector<3>, Vector<3>)> {
        let texture = self.texture;
        let (low, high) = (texture.bounds.min[2], texture.bounds.max[2]);
        let lift = (high - low).max(0.1 * texture.patch_side());
        let (middle, half) = (0.5 * (low + high), lift);
        let mut all: Vec<_> = pairs.iter().map(|p| (p.source, p.target)).collect();
        for (k, pair) in pairs.iter().enumerate().filter(|(k, _)| k % 4 == 0) {
            let up = Vector([0.0, 0.0, if k % 8 == 0 { lift } else { -lift }]);
            all.push((pair.source + up, pair.target + up));
        }
        let border = texture.border as f64 * texture.lattice.cell;
        let side = texture.patch_side();
        let steps = 4;
        let near2 = (0.2 * side).powi(2);
        for k in 0..(steps + 1) * (steps + 1) {
            let at = [k % (steps + 1), k / (steps + 1)]
                .map(|i| (i as f64 / f64::from(steps as u32)) * (side + 1.98 * border) - 0.99 * border);
            let p = Vector([at[0], at[1], middle]);
            let is_near = |pair: &Pair| {
                let d = pair.target - p;
                d[0] * d[0] + d[1] * d[1] < near2
            };
            if self.mask.is_free(p) && !pairs.iter().any(is_near) {
                let up = Vector([0.0, 0.0, half]);
                all.extend([(p + up, p + up), (p - up, p - up)]);
            }
        }
        all
    }

    /// Moves points in the overlap towards what is there, along their normals if that leads to it, and keeps those that are pasted.
    fn blended(&self, bent: Vec<Sample>, around: &Around, notes: &mut Notes) -> Result<Vec<Sample>> {
        let reach = (0.6 * self.reach()).max(3.0 * self.texture.spacing);
        let blend = |s: &Sample| -> Result<Option<(Sample, u8)>> {
            if s.piece > 0 {
                return Ok(self.mask.takes(s.middle()).then_some((*s, 0)));
            }
            // What lies beside may be moved in.
            let is_at_seam = self.mask.is_at_seam(s.at, 1.6 * self.texture.spacing);
            if !self.mask.is_pasted(s.at) && !is_at_seam {
                return Ok(None);
            }
            let mut sample = Sample { is_at_seam, ..*s };
            let share = self.mask.share(s.at);
            if share <= 0.0 {
                return Ok(Some((sample, 0)));
            }
            self.budget.spend(6000)?;
            let hit = around.points.hit(s.at, s.normal, reach);
            let how = if hit.is_some() { 1 } else { 2 };
            let Some(foot) = hit.or_else(|| around.points.project(s.at, reach, Some(s.normal))) else {
                return Ok(Some((sample, 3)));
            };
            let other = &self.samples[foot.nearest];
            sample.at = s.at + (foot.point - s.at) * share;
            let mixed = s.normal * (1.0 - share) + foot.normal * share;
            sample.normal = mixed.unit_if_longer(1e-9).unwrap_or(s.normal);
            let mix = |a: f32, b: f32| a + (b - a) * share as f32;
            sample.variation = mix(s.variation, other.variation);
            sample.colour = std::array::from_fn(|k| mix(s.colour[k], other.colour[k]));
            Ok(Some((sample, how)))
        };
        let blended: Result<Vec<Option<(Sample, u8)>>> = bent.par_iter().with_min_len(64).map(blend).collect();
        let mut samples = Vec::with_capacity(bent.len());
        for (sample, how) in blended?.into_iter().flatten().filter(|(s, _)| self.mask.replaces(s)) {
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

    /// Leaves out loose pieces that would pass through those that stay.
    fn apart(&self, samples: Vec<Sample>, notes: &mut Notes) -> Result<Vec<Sample>> {
        if self.texture.pieces.is_empty() {
            return Ok(samples);
        }
        let staying: Vec<&Sample> = self.samples.iter().filter(|s| s.piece > 0 && !self.mask.replaces(s)).collect();
        let positions = staying.iter().map(|s| s.at).collect();
        let normals = staying.iter().map(|s| s.normal).collect();
        let points = OrientedPoints::new(positions, normals, self.texture.radius, self.budget)?;
        self.budget.spend(samples.len() as u64 * 800)?;
        let spacing = self.texture.spacing;
        let is_inside = |s: &Sample| {
            let near = points.nearest(s.at, 4.0 * spacing, |_| true);
            near.is_some_and(|(j, _)| (s.at - points.positions()[j]).dot(points.normals()[j]) < -0.4 * spacing)
        };
        let mut inside = std::collections::BTreeMap::<u32, (usize, usize)>::new();
        for s in samples.iter().filter(|s| s.piece > 0) {
            let count = inside.entry(s.piece).or_default();
            *count = (count.0 + usize::from(is_inside(s)), count.1 + 1);
        }
        let collides = |s: &Sample| inside.get(&s.piece).is_some_and(|(n, all)| *n as f64 > PASSING * *all as f64);
        let (out, kept): (Vec<Sample>, Vec<Sample>) = samples.into_iter().partition(collides);
        notes.unmatched += out.len();
        Ok(kept)
    }

    /// Points of the result near what is kept that nothing in the patch goes on from.
    fn cracks(&self, samples: &[Sample], around: &Around) -> Result<usize> {
        let positions = samples.iter().map(|s| s.at).collect();
        let normals = samples.iter().map(|s| s.normal).collect();
        let points = OrientedPoints::new(positions, normals, self.texture.radius, self.budget)?;
        let reach = 2.2 * self.texture.spacing;
        self.budget.spend(around.overlapped.len() as u64 * 400)?;
        let is_lost = |i: &&u32| {
            let sample = &self.samples[**i as usize];
            sample.piece == 0
                && self.mask.share(sample.at) > 0.6
                && points.nearest(sample.at, reach, |j| points.normals()[j].dot(sample.normal) > 0.3).is_none()
        };
        Ok(around.overlapped.par_iter().with_min_len(128).filter(is_lost).count())
    }
}
