//! One patch [Duranleau 2008 §4, §5]: what fits is found in the texture, bent onto what is there, blended with it.
//!
//! All is in the frame of the patch: its corner is the origin, its sides are x and y. Who lays patches brings what is there into this frame and
//! takes the new points out of it.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Result, Stream, Vector};
use arabesque_surface::{OrientedPoints, clusters};
use rayon::prelude::*;

use crate::{
    patch::pairing::{Pair, Pairing},
    patch::spline::{Spline, carried, determinant},
    patch::warp::Warp,
    patch::{
        blend::{Around, Site},
        notes::Notes,
    },
    sample::Sample,
    search::best::{Candidate, best},
    search::field::Overlap,
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
/// Share of a target's surface that bends at most, from which its cluster is split.
const FLAT: f64 = 0.06;
/// Columns of nodes that are compared at most.
const ENOUGH: usize = 160;
/// Places that are looked at for each that is tried: many of them lie side by side.
const LEAST: usize = 16;
/// Places, apart from one another, that are chosen from at most.
const DISTINCT: usize = 32;
/// What was not seen counts so much, so that chance has a say.
const SEEN: f64 = 0.05;
/// How far beside where a strict repeat wants it a patch may be from, in cells.
const BESIDE: f64 = 1.0;
/// How far pairs listen to one another, as a share of the patch.
const LISTENING: f64 = 0.15;

/// The numbers of every second node, again and again, while there are more than enough: by turns as on a chessboard, and in every second row and column.
fn thinned(nodes: &[[u32; 2]]) -> Vec<usize> {
    let mut some: Vec<usize> = (0..nodes.len()).collect();
    let mut step = 1;
    while some.len() > ENOUGH {
        some.retain(|&k| (nodes[k][0] / step + nodes[k][1] / step).is_multiple_of(2));
        if some.len() > ENOUGH {
            step *= 2;
            some.retain(|&k| nodes[k].iter().all(|v| v.is_multiple_of(step)));
        }
    }
    some
}

/// A map of which a share counts, with the columns of its Jacobian matrix: `x + share (W(x) - x)`.
fn faded(
    x: Vector<3>,
    (image, columns): (Vector<3>, [Vector<3>; 3]),
    share: f64,
    slope: [f64; 2],
) -> (Vector<3>, [Vector<3>; 3]) {
    let shift = image - x;
    let column = |k: usize| {
        let mut axis = Vector::ZERO;
        axis[k] = 1.0;
        axis + (columns[k] - axis) * share + shift * slope.get(k).copied().unwrap_or(0.0)
    };
    (x + shift * share, std::array::from_fn(column))
}

/// A patch, ready to be pasted.
#[derive(Debug)]
pub(crate) struct Laid {
    pub(crate) samples: Vec<Sample>,
    /// Where in the texture it comes from.
    pub(crate) place: [u32; 2],
    pub(crate) notes: Notes,
}

impl Site<'_> {
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
        let (some, lattice) = (thinned(&nodes), &self.texture.lattice);
        let compared = some.iter().map(|&k| nodes[k]).collect();
        let mut overlap = Overlap::new(&around.points, lattice, compared, self.budget)?;
        let paints = self.paints(&around, nodes)?;
        overlap.planes.extend(paints.iter().flat_map(|paints| paints.only(&some).planes));
        let candidates = self.candidates(&overlap, random)?;
        let mut best: Option<Laid> = None;
        for (n, candidate) in candidates.iter().enumerate() {
            let mut laid = self.fitted(candidate.place, &around, paints.as_ref())?;
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

    /// The colours of what is there already, where colours matter.
    fn paints(&self, around: &Around, nodes: Vec<[u32; 2]>) -> Result<Option<Overlap>> {
        let tint = self.texture.field.tint;
        if tint <= 0.0 {
            return Ok(None);
        }
        let colour = |i: usize| around.samples[i].colour;
        Overlap::colours(&around.points, colour, (&self.texture.lattice, tint), nodes, self.budget).map(Some)
    }

    /// What is there already, prepared: no more of it than projections and rays from the overlap may meet.
    fn around(&self) -> Result<Around> {
        let texture = self.texture;
        let far = texture.lattice.reach.max(self.reach()) + texture.radius;
        let is_near = |s: &&Sample| self.mask.is_near_overlap(s.at, far);
        let samples: Vec<Sample> = self.samples.iter().filter(is_near).copied().collect();
        let positions: Vec<_> = samples.iter().map(|s| s.at).collect();
        let normals = samples.iter().map(|s| s.normal).collect();
        let overlapped: Vec<u32> =
            (0..positions.len() as u32).filter(|&i| self.mask.is_overlap(positions[i as usize])).collect();
        let most = (overlapped.len() / self.params.pairs).max(3);
        let some = clusters(&positions, overlapped.clone(), (most / 3, most), FLAT, self.budget)?;
        let target = |cluster: &Vec<u32>| {
            let sum = cluster.iter().fold(Vector::ZERO, |sum, &i| sum + positions[i as usize]);
            let mean = sum * (1.0 / cluster.len() as f64);
            let far = |i: u32| (positions[i as usize] - mean).norm2();
            let nearest = cluster.iter().copied().min_by(|&a, &b| far(a).total_cmp(&far(b)).then(a.cmp(&b)));
            nearest.map(|i| samples[i as usize])
        };
        let targets = some.iter().filter_map(target).collect();
        let points = OrientedPoints::new(positions, normals, texture.radius, self.budget)?;
        Ok(Around { points, samples, targets, overlapped })
    }

    /// Places to try, in the order in which they are tried: of the best the one that was seen least, then the others from the best on.
    fn candidates(&self, overlap: &Overlap, random: &mut Stream) -> Result<Vec<Candidate>> {
        let texture = self.texture;
        let apart = self.params.apart * texture.patch as f64;
        let is_shunned = |place: &[u32; 2]| {
            self.shunned.iter().any(|s| {
                let d = [0, 1].map(|k| f64::from(place[k]) - s[k]);
                d[0] * d[0] + d[1] * d[1] < apart * apart
            })
        };
        let goes_on = |place: &[u32; 2]| self.beside(*place).iter().fold(0.0_f64, |l, v| l.hypot(*v)) <= BESIDE;
        let mut places: Vec<_> = texture.places.iter().filter(|p| goes_on(p) && !is_shunned(p)).copied().collect();
        if places.is_empty() {
            places = texture.places.iter().filter(|p| goes_on(p)).copied().collect();
        }
        if places.is_empty() {
            places.clone_from(&texture.places);
        }
        // What repeats strictly goes on in one way only, however little of that an overlap shows; where places are held to it and may lie side by
        // side, as in a gap, all that are left do.
        let is_held = self.params.apart == 0.0 && self.goes_on.is_some() && texture.repetition.repeat.is_some();
        let latitude = if is_held { 1.0 } else { texture.repetition.latitude() };
        let floor = latitude * FLOOR * (overlap.nodes.len() * texture.field.planes.len()) as f64;
        let tolerance = latitude * self.params.tolerance;
        let found = best(
            &texture.field,
            texture.searcher.as_ref(),
            overlap,
            &places,
            (tolerance, floor, LEAST * self.params.tries),
            (self.params.search, self.budget),
        )?;
        // Beside those that were tried others are hardly better.
        let near = (0.1 * texture.patch as f64).max(1.5);
        let mut distinct: Vec<Candidate> = Vec::new();
        for candidate in &found {
            let is_near = |c: &Candidate| {
                let d = [0, 1].map(|k| f64::from(c.place[k]) - f64::from(candidate.place[k]));
                d[0] * d[0] + d[1] * d[1] < near * near
            };
            if distinct.len() < DISTINCT && !distinct.iter().any(is_near) {
                distinct.push(*candidate);
            }
        }
        // Of those that are good enough the one of which least was seen so far.
        let most = (1.0 + tolerance) * found[0].difference.max(floor);
        let within = distinct.partition_point(|c| c.difference <= most).max(1);
        let seen = |c: &Candidate| self.usage.of(c.place, &self.nearby) + SEEN;
        let mut least = (f64::INFINITY, 0);
        for (k, candidate) in distinct[..within].iter().enumerate() {
            let rank = seen(candidate) * random.range(0.5, 1.5);
            least = if rank < least.0 { (rank, k) } else { least };
        }
        let first = distinct.remove(least.1);
        distinct.insert(0, first);
        distinct.truncate(self.params.tries);
        Ok(distinct)
    }

    /// How far a place lies beside the nearest from which what repeats strictly goes on as it does around, in cells.
    fn beside(&self, place: [u32; 2]) -> [f64; 2] {
        let (Some(repeat), Some(at)) = (self.texture.repetition.repeat, self.goes_on) else { return [0.0; 2] };
        repeat.beside([0, 1].map(|k| f64::from(place[k]) - at[k]))
    }

    /// The points of the texture for a patch, and as far around as they may move.
    fn source(&self, place: [u32; 2]) -> Vec<Sample> {
        let texture = self.texture;
        // Places are told in cells; what repeats strictly is laid where it belongs between them.
        let [x, y] = self.beside(place).map(|v| if v.abs() <= BESIDE { v * texture.lattice.cell } else { 0.0 });
        let corner = texture.corner(place) - Vector([x, y, 0.0]);
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
        let reach = self.reach();
        let is_wanted = |i: &usize| {
            let is_piece = texture.pieces.of.get(*i).is_some_and(|p| *p > 0);
            is_piece || self.mask.may_be_pasted(texture.points.positions()[*i] - corner, reach)
        };
        // They come as they lie together, which is what all that follows is fastest with.
        numbers.retain(is_wanted);
        let moved = |&i: &usize| {
            let sample = texture.sample(i);
            Sample { at: sample.at - corner, ..sample }
        };
        numbers.par_iter().with_min_len(1024).map(moved).collect()
    }

    /// The patch of a place, bent and blended.
    fn fitted(&self, place: [u32; 2], around: &Around, paints: Option<&Overlap>) -> Result<Laid> {
        let source = self.source(place);
        let mut notes = Notes { patches: 1, overlapped: around.overlapped.len(), ..Notes::default() };
        let bent = self.bent(&source, around, &mut notes)?;
        let bent = bent.unwrap_or_else(|| {
            notes.unbent = 1;
            source
        });
        let cut = paints.map(|paints| self.mask.cut(&paints.differences(&self.texture.field, place)));
        let samples = self.blended(bent, (around, cut.as_deref()), &mut notes)?;
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
        let pairing = Pairing { params: self.params, reach: self.reach_of_pairs(), listening };
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
            if let Some(bent) = self.warped(source, &spline)? {
                return Ok(Some(bent));
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

    /// The points, bent by a spline; `None` where it folds.
    fn warped(&self, source: &[Sample], spline: &Spline) -> Result<Option<Vec<Sample>>> {
        let positions: Vec<_> = source.iter().map(|s| s.at).filter(|at| self.mask.bend(*at).0 > 0.0).collect();
        let warp = Warp::new(spline, &positions, self.texture.patch_side(), self.budget)?;
        // Loose pieces are moved, not bent.
        let mut shifts: BTreeMap<u32, Vector<3>> = BTreeMap::new();
        for s in source.iter().filter(|s| s.piece > 0) {
            shifts.entry(s.piece).or_insert_with(|| {
                let middle = s.middle();
                let shift = (spline.apply(middle).0 - middle) * self.mask.bend(middle).0;
                Vector([shift[0], shift[1], 0.0])
            });
        }
        let bend = |s: &Sample| {
            if s.piece > 0 {
                let shift = shifts.get(&s.piece).copied().unwrap_or(Vector::ZERO);
                return Some(Sample { at: s.at + shift, ..*s });
            }
            let (share, slope) = self.mask.bend(s.at);
            if share <= 0.0 {
                return Some(*s);
            }
            let (at, columns) = faded(s.at, warp.apply(s.at), share, slope);
            let is_sound = (FOLDED.0..FOLDED.1).contains(&determinant(columns)) || !self.mask.is_pasted(at);
            is_sound.then(|| Sample { at, normal: carried(s.normal, columns), ..*s })
        };
        Ok(source.par_iter().with_min_len(256).map(bend).collect())
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_are_thinned_evenly_and_some_are_left() {
        let nodes: Vec<[u32; 2]> = (0..60 * 60).map(|k| [k % 60, k / 60]).filter(|[x, y]| *x < 8 || *y < 8).collect();
        let thin: Vec<_> = thinned(&nodes).into_iter().map(|k| nodes[k]).collect();
        assert!(thin.len() <= ENOUGH && 3 * thin.len() > ENOUGH, "{}", thin.len());
        let far = |n: &[u32; 2]| thin.iter().map(|t| n[0].abs_diff(t[0]) + n[1].abs_diff(t[1])).min().unwrap();
        assert!(nodes.iter().all(|n| far(n) <= 4), "{:?}", nodes.iter().map(far).max());
        assert!(thinned(&nodes[..ENOUGH]).into_iter().eq(0..ENOUGH));
    }
}
