//! All places whose neighbourhood is like that of one.

use arabesque_core::{Bounds, Budget, Domain, Error, GridIndex, Matrix, Result, Vector};
use rayon::prelude::*;

use super::{
    compare::{Neighbour, compare},
    edge::Edge,
    scale::{Scale, scale},
};

/// Most neighbours of one place; where there are more, the neighbourhood is smaller.
const MOST: usize = 48;
/// How much of a neighbourhood must be within the pattern for it to be compared.
const KNOWN: f64 = 0.3;
/// Radius of a usual neighbourhood, in mean spacings: neighbours are matched up to a mean spacing there, and less far in smaller ones.
const USUAL: f64 = 1.8;
/// Units of work for a pair of neighbours.
const PER_PAIR: u64 = 20;

/// A place in a pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot<const D: usize> {
    /// Where it is.
    pub centre: Vector<D>,
    /// How its element is turned.
    pub rotation: Matrix<D>,
    /// How large its element is.
    pub scale: f64,
    /// What its element is: only like is matched with like.
    pub class: usize,
}

/// In which frame two neighbourhoods are alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turned {
    /// Each in that of its element: the one is turned and scaled against the other as their elements are.
    WithElement,
    /// Both in that of the page.
    WithPage,
}

/// A place that is like another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alike {
    /// Index of the spot.
    pub spot: usize,
    /// In which frame.
    pub turned: Turned,
    /// Root of the mean square of what is between matched neighbours, in mean spacings.
    pub distance: f64,
}

/// The places of a pattern.
#[derive(Debug)]
pub struct Places<const D: usize> {
    spots: Vec<Spot<D>>,
    index: GridIndex<D>,
    page: Option<Bounds<D>>,
    scale: Scale,
    /// How far around a place is looked for where the pattern ends.
    reach: f64,
}

impl<const D: usize> Places<D> {
    /// The places of a pattern that fills `domain`, a page or a tile; `radius` of neighbourhoods in mean spacings, by default between the
    /// second and the third ring of neighbours.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a radius that is not positive, [`Error::Limit`] when the work is used up.
    pub fn new(spots: Vec<Spot<D>>, domain: &Domain<D>, radius: Option<f64>, budget: &Budget) -> Result<Self> {
        let points: Vec<_> = spots.iter().map(|spot| spot.centre).collect();
        let bounds = Bounds::around(points.iter().copied());
        let measure: f64 = bounds.size().0.iter().filter(|s| **s > 0.0).product();
        let sides = bounds.size().0.iter().filter(|s| **s > 0.0).count().max(1);
        let guess = (measure / points.len().max(1) as f64).powf(1.0 / sides as f64);
        let guess = if guess > 0.0 && guess.is_finite() { guess } else { 1.0 };
        budget.spend(100 * points.len() as u64)?;
        let index = GridIndex::new(&points, guess, domain);
        let mut scale = scale(&points, &index, guess, budget)?;
        let reach = scale.radius;
        if let Some(radius) = radius {
            if !(radius > 0.0 && radius.is_finite()) {
                return Err(Error::parameter("radius", radius, "a positive number of mean spacings"));
            }
            scale.radius = radius * scale.spacing;
        }
        let page = if domain.period().is_some() { None } else { Some(domain.bounds().union(&bounds)) };
        Ok(Self { spots, index, page, scale, reach })
    }

    /// Mean spacing of the places, in the units of the page.
    pub fn spacing(&self) -> f64 {
        self.scale.spacing
    }

    /// All places of the class of `spot` whose neighbourhood is no farther from that of `spot` than `threshold`, in mean spacings, in the
    /// order of their indices; the place itself among them.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a threshold that is negative or no number, [`Error::Limit`] when the work is used up.
    pub fn alike(&self, spot: usize, threshold: f64, budget: &Budget) -> Result<Vec<Alike>> {
        if !(threshold >= 0.0 && threshold.is_finite()) {
            return Err(Error::parameter("propagate", threshold, "a number of mean spacings from 0"));
        }
        let Some(&anchor) = self.spots.get(spot) else { return Ok(Vec::new()) };
        let (own, is_whole) = self.compared(spot, threshold, budget)?;
        let mut found: Vec<Alike> = own.iter().map(|(alike, _)| *alike).collect();
        if is_whole {
            return Ok(found);
        }
        // A place at the edge knows half of its neighbourhood, and cannot be compared with one at the opposite edge: the one that is most
        // like it and knows more speaks for it.
        let others = own.iter().filter(|(alike, _)| alike.spot != spot);
        let best = others.max_by(|a, b| a.1.cmp(&b.1).then(b.0.distance.total_cmp(&a.0.distance)));
        let Some((speaker, _)) = best else { return Ok(found) };
        let (more, _) = self.compared(speaker.spot, threshold, budget)?;
        let is_same = is_turned_alike(&anchor, &self.spots[speaker.spot]);
        let mut is_known = vec![false; self.spots.len()];
        found.iter().for_each(|alike| is_known[alike.spot] = true);
        let new = more.into_iter().map(|(alike, _)| alike).filter(|alike| !is_known[alike.spot]);
        found.extend(new.filter(|alike| is_same || alike.turned == speaker.turned));
        found.sort_by_key(|alike| alike.spot);
        Ok(found)
    }

    /// The places like one, with how many neighbours each has; and whether that one knows all of its neighbourhood.
    fn compared(&self, spot: usize, threshold: f64, budget: &Budget) -> Result<(Vec<(Alike, usize)>, bool)> {
        let anchor = self.spots[spot];
        let around = Around::new(self, anchor, budget)?;
        let candidates: Vec<usize> = (0..self.spots.len()).filter(|&n| self.spots[n].class == anchor.class).collect();
        let one = |&candidate: &usize| -> Result<Option<(Alike, Compared)>> {
            let found = |turned, compared: Compared| {
                let distance = compared.distance;
                (distance <= threshold).then_some((Alike { spot: candidate, turned, distance }, compared))
            };
            if candidate == spot {
                return Ok(found(Turned::WithElement, Compared { distance: 0.0, neighbours: 0, is_whole: true }));
            }
            let own = found(Turned::WithElement, around.compared(candidate, Turned::WithElement, budget)?);
            if own.is_some() || is_turned_alike(&anchor, &self.spots[candidate]) {
                return Ok(own);
            }
            Ok(found(Turned::WithPage, around.compared(candidate, Turned::WithPage, budget)?))
        };
        let all: Result<Vec<_>> = candidates.par_iter().map(one).collect();
        let all: Vec<_> = all?.into_iter().flatten().collect();
        let is_whole = all.iter().all(|(_, compared)| compared.is_whole);
        Ok((all.into_iter().map(|(alike, compared)| (alike, compared.neighbours)).collect(), is_whole))
    }
}

/// Whether the frames of two elements are the same.
fn is_turned_alike<const D: usize>(a: &Spot<D>, b: &Spot<D>) -> bool {
    let is_near = |x: f64, y: f64| (x - y).abs() < 1e-9;
    is_near(a.scale, b.scale) && (0..D).all(|r| (0..D).all(|c| is_near(a.rotation.0[r][c], b.rotation.0[r][c])))
}

/// A neighbourhood that others are compared with.
struct Around<'a, const D: usize> {
    places: &'a Places<D>,
    anchor: Spot<D>,
    own: Vec<Neighbour<D>>,
    /// How far it reaches, and up to which distance neighbours are matched.
    radius: f64,
    most: f64,
}

/// Another neighbourhood beside one.
struct Compared {
    /// Infinite where too little of the other is known.
    distance: f64,
    /// How many neighbours the other has.
    neighbours: usize,
    /// Whether the one knows all that the other has.
    is_whole: bool,
}

/// Nothing alike.
const UNLIKE: Compared = Compared { distance: f64::INFINITY, neighbours: 0, is_whole: true };

impl<'a, const D: usize> Around<'a, D> {
    fn new(places: &'a Places<D>, anchor: Spot<D>, budget: &Budget) -> Result<Self> {
        let Scale { spacing, mut radius } = places.scale;
        let most = spacing.min(radius / USUAL);
        let mut own = Vec::new();
        let cost = places.index.within(anchor.centre, radius + most, |n, offset| {
            own.push(Neighbour { offset, class: places.spots[n].class });
        });
        budget.spend(cost)?;
        own.sort_by(|a, b| a.offset.norm2().total_cmp(&b.offset.norm2()));
        // The first is the centre itself.
        own.drain(..1.min(own.len()));
        if let Some(beyond) = own.get(MOST).filter(|beyond| beyond.offset.norm() < radius) {
            radius = 0.999 * beyond.offset.norm();
        }
        own.retain(|neighbour| neighbour.offset.norm() <= radius + most);
        Ok(Self { places, anchor, own, radius, most })
    }

    /// The neighbourhood of another place beside this one.
    fn compared(&self, candidate: usize, turned: Turned, budget: &Budget) -> Result<Compared> {
        let other = self.places.spots[candidate];
        // From the frame of the candidate to that of the anchor.
        let (rotation, ratio) = match turned {
            Turned::WithPage => (Matrix::identity(), 1.0),
            Turned::WithElement => {
                (self.anchor.rotation.compose(&other.rotation.transpose()), self.anchor.scale / other.scale)
            }
        };
        if !(ratio > 0.0 && ratio.is_finite()) {
            return Ok(UNLIKE);
        }
        let reach = (self.radius + self.most) / ratio;
        let load = self.places.index.load(other.centre, reach);
        budget.spend(PER_PAIR.saturating_mul(load))?;
        let mut theirs = Vec::new();
        self.places.index.within(other.centre, reach, |n, offset| {
            if n != candidate {
                let offset = rotation.apply(offset) * ratio;
                theirs.push(Neighbour { offset, class: self.places.spots[n].class });
            }
        });
        // So many more that it cannot be alike.
        if theirs.len() > 4 * (self.own.len() + MOST) {
            return Ok(UNLIKE);
        }
        budget.spend(PER_PAIR * (theirs.len() * self.own.len()) as u64)?;
        let rest = compare([&self.own, &theirs], self.radius, self.most);
        // What is missing beyond the edge of the pattern is not known to be missing.
        let edge = Edge { index: &self.places.index, page: self.places.page, radius: self.places.reach };
        let mut lost = 0;
        for offset in &rest.only[0] {
            let there = other.centre + rotation.transpose().apply(*offset) * (1.0 / ratio);
            lost += usize::from(!edge.is_beyond(there, budget)?);
        }
        let mut is_whole = true;
        for offset in &rest.only[1] {
            let is_beyond = edge.is_beyond(self.anchor.centre + *offset, budget)?;
            lost += usize::from(!is_beyond);
            is_whole &= !is_beyond;
        }
        let known = rest.matched + lost;
        let all = rest.matched + rest.only.iter().map(Vec::len).sum::<usize>();
        if (known as f64) < KNOWN * all as f64 {
            return Ok(UNLIKE);
        }
        let squares = rest.squares + lost as f64 * self.most * self.most;
        let distance = if known == 0 { 0.0 } else { (squares / known as f64).sqrt() / self.places.scale.spacing };
        let neighbours = theirs.iter().filter(|neighbour| neighbour.offset.norm() <= self.radius).count();
        Ok(Compared { distance, neighbours, is_whole })
    }
}
