//! A site of the layout with what is around it: which exemplar patch agrees best with that, and what the patch adds
//! [Tu 2020 §4.3.2].
//!
//! [Ma 2011 §4.1] copies patches at random, [Tu 2020 §4.3.2] those that are most similar to what is there where they
//! overlap. Beyond that, a patch is only tried where it puts one of its elements onto one that is there, so that both
//! are in step: disorder starts at the seams, and iterations that see no farther than a neighbourhood do not bring two
//! parts into step again.

use arabesque_core::{Exemplar, Frame, Meter, Numbered, Request, Result, Stream, Vector};

use crate::{
    border::Extent,
    exemplar::{level::fall_off, library::Library},
    layout::coverage::{Cell, Coverage},
    output::canvas::Canvas,
};

/// Share of the closest distance of their classes that a new element keeps to what is there already.
const ROOM: f64 = 0.6;

/// Share of its own nearest-neighbour distance that it keeps as well where a neighbouring patch has already been.
const ROOM_COVERED: f64 = 0.75;

/// Cost of an element of which the exemplar does not tell whether it could be there: beyond its frame.
const UNSEEN: f64 = 0.35;

/// Cost of a patch whose centre lies at the frame of the exemplar, against one from its middle.
const RIM: f64 = 0.3;

/// Curve samples of one class that are tried at an anchor; of more, as many of the most similar ones.
const MEMBERS: usize = 80;

/// Elements of one class that are tried at an anchor, at most; of more, an even selection.
const ELEMENTS: usize = 128;

/// Nanoseconds to compare with an element of a short list.
const COMPARISON: u64 = 1;

/// By how much rounding may make two ways of adding the same costs differ, at most.
pub(crate) const SLACK: f64 = 1e-9;

/// One in so many of the elements around, the nearest, tells what a patch costs at least.
const NEAREST: usize = 3;

/// Candidates where there is nothing to register on.
const FREE_CANDIDATES: usize = 24;

/// How patches are chosen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GrowParams {
    /// Radius of a patch, exemplar units.
    pub(crate) patch: f64,
    /// Radius of the surroundings that a patch must agree with, exemplar units.
    pub(crate) context: f64,
    /// Cost of a patch that goes on copying where its neighbour stopped, per share of such elements.
    pub(crate) repeat: f64,
    /// Cost of a patch whose elements are used more often than others.
    pub(crate) balance: f64,
    /// Output elements that patches are registered on, for each site.
    pub(crate) anchors: usize,
    /// First curve sample, see [`crate::exemplar::level::Level::base`].
    pub(crate) base: u32,
}

/// What patches are cut from.
pub(crate) struct PatchSource<'a, const D: usize> {
    pub(crate) library: &'a Library<D>,
    pub(crate) extent: &'a Extent<'a, D>,
    pub(crate) params: GrowParams,
    /// Times each exemplar element was used.
    pub(crate) usage: Numbered<u32>,
    /// The sum of these.
    pub(crate) used: u64,
    /// Where a heap lies on the ground.
    pub(crate) levels: Option<Levels>,
}

/// A heap on the ground: what is near it comes from as near the ground of the exemplar, as [Ma 2011 §4.4] has it for borders.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Levels {
    /// The axis along which heights are.
    up: usize,
    /// Where the ground of the exemplar is.
    floor: f64,
    /// Up to this height places are told apart by it, exemplar units.
    pub(crate) reach: f64,
    /// By how much heights may differ.
    off: f64,
    /// Height of the window of the exemplar over its ground.
    top: f64,
}

impl Levels {
    /// `None` without a ground, and where all stand on it, so that there is only one height.
    pub(crate) fn new<const D: usize>(
        exemplar: &Exemplar<D>,
        request: &Request<D>,
        (patch, spacing): (f64, f64),
    ) -> Option<Self> {
        request.ground.as_ref()?;
        if exemplar.heights.iter().all(Option::is_some) {
            return None;
        }
        let up = exemplar.up.min(D - 1);
        let mut standing = exemplar.elements.iter().zip(&exemplar.heights);
        let floor = standing.find_map(|(e, height)| Some(e.centre[up] - (*height)?))?;
        let top = exemplar.window.max[up] - floor;
        Some(Self { up, floor, reach: patch.min(SHOWN * top), off: LEVEL * spacing, top })
    }

    /// Whether a place of the exemplar may come to lie at a height.
    fn suits<const D: usize>(&self, place: Vector<D>, height: f64) -> bool {
        let own = place[self.up] - self.floor;
        if height < self.reach { (own - height).abs() <= self.off } else { own >= self.reach }
    }

    /// The place over or under one of the exemplar that suits a height.
    fn suited<const D: usize>(&self, mut place: Vector<D>, height: f64) -> Vector<D> {
        if height < self.reach {
            place[self.up] = self.floor + height;
        } else if !self.suits(place, height) {
            // Spread over what is higher.
            let share = (place[self.up] - self.floor).max(0.0) / self.reach;
            place[self.up] = self.floor + self.reach + share.min(1.0) * (self.top - self.reach).max(0.0);
        }
        place
    }
}

/// Of the height of the exemplar, the share near the ground that may be told apart.
const SHOWN: f64 = 0.4;

/// By how many spacings a place may lie higher or lower than in the exemplar.
const LEVEL: f64 = 0.3;

/// What is around one site.
pub(crate) struct PatchSite<'a, const D: usize> {
    source: &'a PatchSource<'a, D>,
    site: Vector<D>,
    frame: Frame<D>,
    coverage: &'a Coverage<D>,
    /// Elements around, nearest first.
    around: Vec<Around<D>>,
    /// The sum of their weights.
    weights: f64,
    /// Height of the site over the ground, where that matters, exemplar units.
    height: Option<(Levels, f64)>,
}

/// An element near a site.
#[derive(Clone, Copy, Debug)]
struct Around<const D: usize> {
    /// Exemplar element that is drawn there.
    element: u32,
    /// From the site, in exemplar directions.
    offset: Vector<D>,
    /// Weight by distance.
    weight: f64,
}

impl<'a, const D: usize> PatchSite<'a, D> {
    /// What is around a site, and how much was looked at for that.
    pub(crate) fn new(
        source: &'a PatchSource<'a, D>,
        site: Vector<D>,
        frame: Frame<D>,
        canvas: &Canvas<D>,
        coverage: &'a Coverage<D>,
    ) -> (Self, u64) {
        let context = source.params.context;
        let mut around = Vec::new();
        let looked = canvas.within(site, context * frame.spacing_scale, |i, offset| {
            let offset = frame.to_exemplar(offset);
            around.push(Around { element: canvas.items[i].source, offset, weight: fall_off(offset, context) });
        });
        around.sort_by(|a, b| a.offset.norm2().total_cmp(&b.offset.norm2()));
        let weights = around.iter().map(|a| a.weight).fold(1e-9, |sum, weight| sum + weight);
        let height = source.levels.zip(source.extent.request().ground.as_ref());
        let height = height.map(|(levels, ground)| (levels, ground.height(site) / frame.element_scale));
        (Self { source, site, frame, coverage, around, weights, height }, looked)
    }

    /// Exemplar points that could land on the site.
    pub(crate) fn candidates(&self, anchors: usize, random: &mut Stream) -> Vec<Vector<D>> {
        let library = self.source.library;
        let base = self.source.params.base;
        let mut centres = Vec::new();
        for Around { element, offset, .. } in self.anchors(anchors) {
            let members = library.members(library.class[element]);
            let usable = |i: &u32| {
                let centre = library.centre[*i] - offset;
                library.view.contains(centre) && self.height.is_none_or(|(levels, height)| levels.suits(centre, height))
            };
            if element < base || members.len() <= MEMBERS {
                let tried = members.iter().step_by(members.len().div_ceil(ELEMENTS).max(1));
                centres.extend(tried.filter(|i| usable(i)).map(|&i| library.centre[i] - offset));
            } else {
                let usable = members.iter().copied().filter(usable).collect();
                let alike = self.most_alike(usable, element, random);
                centres.extend(alike.into_iter().map(|i| library.centre[i] - offset));
            }
        }
        let wanted = if anchors == 0 { 1 } else { FREE_CANDIDATES };
        while centres.len() < wanted {
            let place = library.any_place(random);
            centres.push(self.height.map_or(place, |(levels, height)| levels.suited(place, height)));
        }
        centres
    }

    /// What the patches are registered on: the nearest elements; for strokes also the nearest of the rarest kind, which
    /// tell most.
    fn anchors(&self, count: usize) -> Vec<Around<D>> {
        let library = self.source.library;
        let mut anchors: Vec<_> = self.around.iter().take(count).copied().collect();
        let strokes = self.around.iter().filter(|a| a.element >= self.source.params.base);
        let size = |element: u32| library.members(library.class[element]).len();
        if let (Some(rarest), true) = (strokes.min_by_key(|a| size(a.element)), count > 0) {
            anchors.push(*rarest);
        }
        anchors
    }

    /// Of very many elements, some of those that are most like `element`.
    fn most_alike(&self, mut members: Vec<u32>, element: u32, random: &mut Stream) -> Vec<u32> {
        let differences = &self.source.library.differences;
        members.sort_by_cached_key(|&i| differences.of(i, element).to_bits());
        members.truncate((members.len() / 4).max(MEMBERS));
        while members.len() > MEMBERS {
            members.swap_remove(random.below(members.len()));
        }
        members
    }

    /// What the patch around exemplar point `centre` costs at least, by the nearest elements alone. `taken` is room to work in.
    pub(crate) fn bound(&self, centre: Vector<D>, taken: &mut Vec<u32>, meter: &mut Meter<'_>) -> Result<f64> {
        let near = self.around.get(..self.around.len().div_ceil(NEAREST)).unwrap_or_default();
        let disagreement = self.disagreement(centre, near, f64::INFINITY, taken, meter)?;
        Ok(self.least(centre, &disagreement))
    }

    /// Disagreement of the patch around exemplar point `centre` with what is there, or infinity once it is sure to exceed `limit`.
    /// `taken` is room to work in.
    pub(crate) fn cost(
        &self,
        centre: Vector<D>,
        limit: f64,
        taken: &mut Vec<u32>,
        meter: &mut Meter<'_>,
    ) -> Result<f64> {
        let params = self.source.params;
        let disagreement = self.disagreement(centre, &self.around, limit, taken, meter)?;
        if self.least(centre, &disagreement) > limit + SLACK {
            return Ok(f64::INFINITY);
        }
        let Disagreement { cost, repeated } = disagreement;
        let Missing { cost: missing, weights: missing_weights, usage } = self.missing(centre, taken, meter)?;
        let total = self.weights + missing_weights;
        let copied = params.repeat * repeated / self.weights;
        Ok((cost + missing) / total + copied + params.balance * usage + self.rim(centre))
    }

    /// Cost of a centre near the frame of the exemplar.
    fn rim(&self, centre: Vector<D>) -> f64 {
        let patch = self.source.params.patch;
        RIM * (1.0 - self.source.library.view.signed_distance(centre).min(patch) / patch)
    }

    /// What a patch costs at least that disagrees so far: what is missing adds as much to what is charged as to all that could be, so
    /// that the share does not fall below this, or below 1.
    fn least(&self, centre: Vector<D>, disagreement: &Disagreement) -> f64 {
        let copied = self.source.params.repeat * disagreement.repeated / self.weights;
        (disagreement.cost / self.weights).min(1.0) + copied + self.rim(centre)
    }

    /// How far the patch around `centre` disagrees with elements of those `around`, as far as it takes to exceed `limit`; `taken` are
    /// then the elements of the patch that were found there.
    fn disagreement(
        &self,
        centre: Vector<D>,
        around: &[Around<D>],
        limit: f64,
        taken: &mut Vec<u32>,
        meter: &mut Meter<'_>,
    ) -> Result<Disagreement> {
        let library = self.source.library;
        // Beyond this share of the weights it is too much.
        let most = (limit + SLACK - self.rim(centre)) * self.weights;
        let most = if most > self.weights { f64::INFINITY } else { most };
        taken.clear();
        let (mut cost, mut repeated) = (0.0, 0.0);
        for &Around { element, offset, weight } in around {
            if cost > most {
                break;
            }
            let p = centre + offset;
            if !library.view.contains(p) {
                cost += UNSEEN * weight;
                continue;
            }
            let class = library.class[element];
            let alike = library.alike(element, p, meter)?;
            meter.spend(COMPARISON * taken.len() as u64)?;
            match alike.into_iter().flatten().find(|(i, _)| !taken.contains(i)) {
                Some((i, c)) => {
                    taken.push(i);
                    cost += weight * f64::from(c) / library.outlier[class].powi(2);
                    repeated += weight * f64::from(u8::from(i == element));
                }
                None => cost += weight,
            }
        }
        Ok(Disagreement { cost, repeated })
    }

    /// What the patch has that is not there, except the elements `taken`.
    fn missing(&self, centre: Vector<D>, taken: &[u32], meter: &mut Meter<'_>) -> Result<Missing> {
        let (library, params) = (self.source.library, self.source.params);
        let (mut missing, mut weights) = (0.0, 0.0);
        let (mut used, mut fresh) = (0.0, 0.0);
        let mut met = 0;
        let price = library.within(centre, params.context, |i, offset| {
            met += 1;
            if taken.contains(&i) {
                return;
            }
            let weight = fall_off(offset, params.context);
            match self.coverage.at(self.site + self.frame.to_output(offset)) {
                Cell::Covered => {
                    missing += weight;
                    weights += weight;
                }
                Cell::Open => {
                    used += f64::from(self.source.usage[i]);
                    fresh += 1.0;
                }
                Cell::Outside => {}
            }
        });
        meter.spend(price + met * (10 + COMPARISON * taken.len() as u64))?;
        let mean = self.source.used as f64 / library.len() as f64;
        let usage = if fresh > 0.0 { (used / fresh) / (mean + 1.0) } else { 0.0 };
        Ok(Missing { cost: missing, weights, usage })
    }

    /// `centre` moved so that matched elements coincide as well as they can.
    pub(crate) fn registered(&self, centre: Vector<D>, meter: &mut Meter<'_>) -> Result<Vector<D>> {
        let library = self.source.library;
        let (mut shift, mut weights) = (Vector::ZERO, 1e-9);
        for &Around { element, offset, weight } in &self.around {
            if let Some((i, _)) = library.alike(element, centre + offset, meter)?[0] {
                shift += (library.centre[i] - centre - offset) * weight;
                weights += weight;
            }
        }
        let centre = centre + shift * (1.0 / weights);
        Ok(match self.height {
            Some((levels, height)) if height < levels.reach => levels.suited(centre, height),
            _ => centre,
        })
    }

    /// Patch elements for the open part, with their places.
    pub(crate) fn additions(&self, centre: Vector<D>, meter: &mut Meter<'_>) -> Result<Vec<(u32, Vector<D>)>> {
        let (library, params) = (self.source.library, self.source.params);
        let mut taken = Vec::new();
        for &Around { element, offset, .. } in &self.around {
            let alike = library.alike(element, centre + offset, meter)?;
            meter.spend(COMPARISON * taken.len() as u64)?;
            taken.extend(alike.into_iter().flatten().map(|(i, _)| i).find(|i| !taken.contains(i)));
        }
        let mut near = Vec::new();
        let price = library.within(centre, params.patch, |i, offset| near.push((i, offset)));
        meter.spend(price + near.len() as u64 * (10 + COMPARISON * taken.len() as u64))?;
        let mut found = Vec::new();
        for (i, offset) in near {
            let p = self.site + self.frame.to_output(offset);
            let wanted = library.copyable[i] && !taken.contains(&i);
            if wanted && self.has_room(i, p, offset, meter)? && self.source.extent.admits(i, p) {
                found.push((i, p));
            }
        }
        found.sort_by_key(|&(i, _)| i);
        Ok(found)
    }

    /// Whether exemplar element `i` belongs to the open part at `p`: into an open cell unless it would sit on
    /// something, and into a covered cell at the seam, where registration may have moved it across, only if there is a
    /// gap of its own size.
    fn has_room(&self, i: u32, p: Vector<D>, offset: Vector<D>, meter: &mut Meter<'_>) -> Result<bool> {
        meter.spend(5 * self.around.len() as u64)?;
        let library = self.source.library;
        let class = library.class[i];
        let clear = |other: &Around<D>| {
            (other.offset - offset).norm() >= ROOM * library.closest(class, library.class[other.element])
        };
        if !self.around.iter().all(clear) {
            return Ok(false);
        }
        Ok(match self.coverage.at(p) {
            Cell::Open => true,
            Cell::Covered => {
                let own = library.nearest[i];
                let gap = self
                    .around
                    .iter()
                    .map(|other| (other.offset - offset).norm2())
                    .fold(f64::INFINITY, f64::min)
                    .sqrt();
                let reach = 0.5 * own * self.frame.spacing_scale;
                gap >= ROOM_COVERED * own && self.coverage.is_open_within(p, reach, meter)?
            }
            Cell::Outside => false,
        })
    }
}

/// What is there and not in a patch.
struct Disagreement {
    /// Weight of it.
    cost: f64,
    /// Weight of what the patch would go on copying.
    repeated: f64,
}

/// Elements of a patch without a counterpart in its surroundings.
struct Missing {
    /// Weight of those that should be there already.
    cost: f64,
    /// Weight of all that should be there.
    weights: f64,
    /// How often the others, which would be new, were used, relative to the mean.
    usage: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_near_the_ground_comes_from_as_near_the_ground() {
        let levels = Levels { up: 1, floor: -2.0, reach: 1.0, off: 0.3, top: 4.0 };
        let at = |y: f64| Vector([5.0, y, 7.0]);
        assert!(levels.suits(at(-1.5), 0.4) && !levels.suits(at(-1.5), 0.9) && !levels.suits(at(1.0), 0.4));
        assert!(levels.suits(at(0.5), 9.0) && !levels.suits(at(-1.5), 9.0));
        assert_eq!(levels.suited(at(1.0), 0.4), at(-1.6));
        for y in [-2.0, -1.5, -1.1, 1.9] {
            let high = levels.suited(at(y), 9.0);
            assert!(levels.suits(high, 9.0) && high[1] <= 2.0, "{high:?}");
        }
    }
}
