//! Which element of the exemplar every element of the result is: broken ones, and turned, mirrored and scaled ones.
//!
//! A result says of its elements what they are copies of, or it does not: then colour and outline tell. An outline is compared with those of
//! the exemplar's that are about as large. What is natural of a class is how its own members differ, each from the nearest of the others.

use arabesque_core::{Budget, Exemplar, Matrix, Outline, Result, Role, Signature, Vector};
use rayon::prelude::*;

use crate::{quantiles::quantile, scene::flat};

/// Largest difference of mean colours of one thing.
const COLOUR: f64 = 0.2;
/// Outlines of the exemplar that one of the result is compared with.
const CANDIDATES: usize = 8;
/// Work for comparing two outlines, and for looking at one.
const FIT: u64 = 12_000;
const LOOK: u64 = 6;
/// Shapes that differ by less are copies: none can be more alike.
const COPY: f64 = 1e-6;
/// Members of a class that are asked how they differ from the others, at most.
const ASKED: usize = 1000;
/// Outlines differ by hand by so much at least, in their sizes.
const WOBBLE: f64 = 0.06;
/// Beyond this distance an outline is no copy of another at all.
const ALIEN: f64 = 0.5;
/// Turn, in radians, and logarithm of a size that are natural at least.
const TURN: f64 = 0.14;
const SIZE: f64 = 0.1;
/// Turns that leave a shape as it is are looked for up to this order.
const ORDERS: usize = 8;

/// What an element of the result is.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Match {
    /// Class of the exemplar; `None` for what is like nothing in it.
    pub(crate) class: Option<usize>,
    /// Element of the exemplar that it is most like.
    pub(crate) source: Option<usize>,
    /// How far each property is beyond what is natural for the class: up to 1 is natural.
    pub(crate) broken: f64,
    pub(crate) turned: f64,
    pub(crate) scaled: f64,
    pub(crate) is_mirrored: bool,
}

/// A shape that can be compared.
struct Known {
    index: usize,
    class: usize,
    colour: [f64; 3],
    signature: Signature,
    mirrored: Option<Signature>,
    /// Turn relative to the first of the class.
    turn: f64,
}

/// What is natural of a class.
#[derive(Clone, Debug)]
struct Nature {
    distance: f64,
    turn: f64,
    size: f64,
    /// Turns of its members, and logarithms of their sizes.
    turns: Vec<f64>,
    sizes: Vec<f64>,
    /// Turns by this angle leave it as it is; 0 for what is round.
    symmetry: f64,
}

/// The shapes of an exemplar.
pub(crate) struct Shapes {
    known: Vec<Known>,
    natures: Vec<Nature>,
    /// The known ones by size and number, from small to large, and from large to small.
    rising: Vec<usize>,
    falling: Vec<usize>,
}

fn mirror(outline: &Outline<2>) -> Outline<2> {
    let flipped = |ring: &Vec<Vector<2>>| ring.iter().rev().map(|p| Vector::xy(-p[0], p[1])).collect();
    Outline { rings: outline.rings.iter().map(flipped).collect() }
}

fn apart(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// Difference of two turns, as seen by a shape that a turn by `symmetry` leaves as it is.
fn turn_between(a: f64, b: f64, symmetry: f64) -> f64 {
    let off = (a - b).rem_euclid(symmetry);
    off.min(symmetry - off)
}

/// The smallest turn that leaves a shape as it is; 0 where any does.
fn symmetry(signature: &Signature) -> f64 {
    if signature.is_round {
        return 0.0;
    }
    let full = std::f64::consts::TAU;
    let holds = |n: &usize| signature.border_distance(signature, full / *n as f64) < WOBBLE;
    (2..=ORDERS).rev().find(holds).map_or(full, |n| full / n as f64)
}

/// How far each of some values is from the nearest other one, in any order; nothing for a value alone.
fn gaps(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    let steps: Vec<f64> = values.windows(2).map(|w| w[1] - w[0]).collect();
    let nearest = |k: usize| {
        let before = k.checked_sub(1).map(|k| steps[k]);
        [before, steps.get(k).copied()].into_iter().flatten().reduce(f64::min)
    };
    (0..values.len()).filter_map(nearest).collect()
}

/// The same of turns, which come round at `full`.
fn gaps_around(turns: &[f64], full: f64) -> Vec<f64> {
    let mut sorted: Vec<f64> = turns.iter().map(|turn| turn.rem_euclid(full)).collect();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len();
    let step = |k: usize| (sorted[(k + 1) % count] - sorted[k]).rem_euclid(full);
    let nearest = |k: usize| {
        let off = step(k).min(step((k + count - 1) % count));
        off.min(full - off)
    };
    if count < 2 { Vec::new() } else { (0..count).map(nearest).collect() }
}

/// How far a value is from the nearest of some, which are sorted.
fn nearest_of(sorted: &[f64], value: f64) -> f64 {
    let at = sorted.partition_point(|v| *v < value);
    let around = [at.checked_sub(1).and_then(|k| sorted.get(k)), sorted.get(at)];
    around.into_iter().flatten().map(|v| (v - value).abs()).fold(f64::INFINITY, f64::min)
}

/// The value that nearly all are below.
fn most(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    quantile(&values, 0.95)
}

impl Shapes {
    /// Looks at the elements of an exemplar; nothing is known of points, and of what lies in space.
    pub(crate) fn of<const D: usize>(exemplar: &Exemplar<D>, budget: &Budget) -> Result<Self> {
        let mut known = Vec::new();
        for (index, element) in exemplar.elements.iter().enumerate().filter(|(_, e)| e.role == Role::Source) {
            let Some(outline) = flat(&element.outline) else { continue };
            budget.spend(FIT)?;
            let Some(signature) = Signature::new(&outline) else { continue };
            let mirrored = Signature::new(&mirror(&outline));
            let turn = angle(&element.pose.rotation);
            known.push(Known { index, class: element.class, colour: element.colour, signature, mirrored, turn });
        }
        let size = |k: usize| known[k].signature.size;
        let mut rising: Vec<usize> = (0..known.len()).collect();
        let mut falling = rising.clone();
        rising.sort_by(|&a, &b| size(a).total_cmp(&size(b)).then(a.cmp(&b)));
        falling.sort_by(|&a, &b| size(b).total_cmp(&size(a)).then(a.cmp(&b)));
        let mut shapes = Self { known, natures: Vec::new(), rising, falling };
        let natures = (0..exemplar.classes.len()).into_par_iter().map(|class| shapes.nature(class, budget));
        shapes.natures = natures.collect::<Result<_>>()?;
        Ok(shapes)
    }

    /// How the members of a class differ.
    fn nature(&self, class: usize, budget: &Budget) -> Result<Nature> {
        let members: Vec<usize> = (0..self.known.len()).filter(|&k| self.known[k].class == class).collect();
        let sizes: Vec<f64> = members.iter().map(|&k| self.known[k].signature.size.ln()).collect();
        let turns: Vec<f64> = members.iter().map(|&k| self.known[k].turn).collect();
        let full = std::f64::consts::TAU;
        let symmetry = members.first().map_or(full, |&k| symmetry(&self.known[k].signature));
        let mut distances = Vec::new();
        for &k in members.iter().step_by(members.len().div_ceil(ASKED).max(1)) {
            let own = &self.known[k];
            let nearest =
                self.nearest(&own.signature, &own.colour, |j| j != k && self.known[j].class == class, budget)?;
            distances.extend(nearest.map(|(_, distance)| distance));
        }
        let turn = if symmetry > 0.0 { most(gaps_around(&turns, symmetry)) } else { 0.0 };
        let size = most(gaps(sizes.clone()));
        let ordered = |mut values: Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values
        };
        let turns =
            turns.into_iter().map(|turn| if symmetry > 0.0 { turn.rem_euclid(symmetry) } else { turn }).collect();
        // Of one or two, how they differ is not known.
        let few = if members.len() < 4 { 1.6 } else { 1.0 };
        Ok(Nature {
            distance: (1.3 * most(distances)).max(WOBBLE * few),
            turn: (1.3 * turn).max(TURN * few),
            size: (1.3 * size).max(SIZE * few),
            turns: ordered(turns),
            sizes: ordered(sizes),
            symmetry,
        })
    }

    /// The known shapes that may be the same as one, those of nearly its size first.
    ///
    /// Looked for from its size upwards and downwards, until no other one can be nearer in size and colour than the last that counts.
    fn candidates(
        &self,
        signature: &Signature,
        colour: &[f64; 3],
        may: impl Fn(usize) -> bool,
        budget: &Budget,
    ) -> Result<Vec<usize>> {
        let size = |k: usize| self.known[k].signature.size;
        let from = [
            &self.rising[self.rising.partition_point(|&k| size(k) < signature.size)..],
            &self.falling[self.falling.partition_point(|&k| size(k) >= signature.size)..],
        ];
        let mut best: Vec<(f64, usize)> = Vec::with_capacity(CANDIDATES + 1);
        let mut meter = budget.meter();
        for way in from {
            for &k in way {
                meter.spend(LOOK)?;
                let off = (size(k) / signature.size).ln().abs();
                if best.len() == CANDIDATES && best.last().is_some_and(|last| (off, k) > *last) {
                    break;
                }
                let differs = apart(&self.known[k].colour, colour);
                if differs > COLOUR || !may(k) {
                    continue;
                }
                let place = best.partition_point(|other| *other < (off + differs, k));
                best.insert(place, (off + differs, k));
                best.truncate(CANDIDATES);
            }
        }
        Ok(best.into_iter().map(|(_, k)| k).collect())
    }

    /// The known shape that is most alike, and how far off it is.
    fn nearest(
        &self,
        signature: &Signature,
        colour: &[f64; 3],
        may: impl Fn(usize) -> bool,
        budget: &Budget,
    ) -> Result<Option<(usize, f64)>> {
        let mut best: Option<(usize, f64)> = None;
        for k in self.candidates(signature, colour, may, budget)? {
            budget.spend(FIT)?;
            let distance = self.known[k].signature.fit(signature).distance;
            if best.is_none_or(|(_, least)| distance < least) {
                best = Some((k, distance));
            }
            if distance < COPY {
                break;
            }
        }
        Ok(best)
    }

    /// What an element is that has this outline and colour; `stated` is what it says itself.
    fn matched(
        &self,
        outline: &Outline<2>,
        colour: &[f64; 3],
        stated: Option<usize>,
        budget: &Budget,
    ) -> Result<Match> {
        let unlike = Match { broken: 4.0, ..Match::default() };
        budget.spend(FIT)?;
        let Some(signature) = Signature::new(outline) else { return Ok(unlike) };
        let named = stated.and_then(|index| self.known.binary_search_by_key(&index, |known| known.index).ok());
        let named = named.map(|k| (k, self.known[k].signature.fit(&signature).distance));
        let best = match named.filter(|(k, distance)| *distance <= self.natures[self.known[*k].class].distance) {
            Some(named) => Some(named),
            None => self.nearest(&signature, colour, |_| true, budget)?,
        };
        let Some((k, distance)) = best.filter(|(_, distance)| *distance < ALIEN) else { return Ok(unlike) };
        let known = &self.known[k];
        let nature = &self.natures[known.class];
        let mut found = Match { class: Some(known.class), source: Some(known.index), ..Match::default() };
        found.broken = distance / nature.distance;
        let size = signature.size.ln();
        let off = nearest_of(&nature.sizes, size);
        found.scaled = off / nature.size;
        if found.broken > 1.0 && self.is_mirrored(&signature, colour, budget)? {
            found.is_mirrored = true;
            found.broken = 1.0;
            return Ok(found);
        }
        if nature.symmetry > 0.0 {
            let turn = known.turn + angle(&known.signature.fit(&signature).pose.rotation);
            // Turns come round: the nearest may be the first or the last of them.
            let turn = turn.rem_euclid(nature.symmetry);
            let ends = [nature.turns.first(), nature.turns.last()].into_iter().flatten();
            let off =
                ends.map(|t| turn_between(*t, turn, nature.symmetry)).fold(nearest_of(&nature.turns, turn), f64::min);
            found.turned = off / nature.turn;
        }
        Ok(found)
    }

    /// Whether the mirror image of a known shape fits where the shapes themselves do not.
    fn is_mirrored(&self, signature: &Signature, colour: &[f64; 3], budget: &Budget) -> Result<bool> {
        for k in self.candidates(signature, colour, |_| true, budget)? {
            budget.spend(FIT)?;
            let known = &self.known[k];
            let fit = known.mirrored.as_ref().map(|mirrored| mirrored.fit(signature).distance);
            if fit.is_some_and(|distance| distance <= 0.7 * self.natures[known.class].distance) {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

/// The turn of a rotation of the plane.
fn angle<const D: usize>(rotation: &Matrix<D>) -> f64 {
    if D == 2 { rotation.0[1][0].atan2(rotation.0[0][0]) } else { 0.0 }
}

/// What every element of a result is: of drawings by outline and colour, of points by the name of the class.
pub(crate) fn matches<const D: usize>(
    exemplar: &Exemplar<D>,
    result: &Exemplar<D>,
    sources: &[Option<usize>],
    budget: &Budget,
) -> Result<Vec<Match>> {
    let has_outlines = |e: &Exemplar<D>| D == 2 && e.elements.iter().any(|e| !e.outline.rings.is_empty());
    let by_name: Vec<Option<usize>> =
        result.classes.iter().map(|class| exemplar.classes.iter().position(|own| own.name == class.name)).collect();
    if !has_outlines(exemplar) || !has_outlines(result) {
        // Points of one class are that, whatever it is called.
        let only = (exemplar.classes.len() == 1).then_some(0);
        let of = |class: usize| Match { class: by_name[class].or(only), ..Match::default() };
        return Ok(result.elements.iter().map(|e| of(e.class)).collect());
    }
    let shapes = Shapes::of(exemplar, budget)?;
    let one = |(k, element): (usize, &arabesque_core::Element<D>)| -> Result<Match> {
        let Some(outline) = flat(&element.outline) else { return Ok(Match::default()) };
        let stated = sources.get(k).copied().flatten();
        let mut found = shapes.matched(&outline, &element.colour, stated, budget)?;
        if element.role == Role::Context {
            // Of what is cut only the colour is its own.
            let class = shapes.nearest_colour(&element.colour, stated);
            found = Match { class, source: stated, ..Match::default() };
        }
        Ok(found)
    };
    result.elements.par_iter().enumerate().map(one).collect()
}

impl Shapes {
    /// The class of what it says itself, else of the nearest colour.
    fn nearest_colour(&self, colour: &[f64; 3], stated: Option<usize>) -> Option<usize> {
        let named = self.known.iter().find(|known| Some(known.index) == stated);
        let near = || self.known.iter().min_by(|a, b| apart(&a.colour, colour).total_cmp(&apart(&b.colour, colour)));
        named.or_else(near).map(|known| known.class)
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Bounds, Class, Element, Similarity};

    use super::*;

    /// A flag on a pole: neither round, nor its own mirror image.
    fn flag(at: Vector<2>, turn: f64, scale: f64) -> Outline<2> {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 6.0), (6.0, 4.5), (1.0, 8.0), (1.0, 10.0), (0.0, 10.0)];
        let outline = Outline { rings: vec![corners.map(|(x, y)| Vector::xy(x, y)).to_vec()] };
        outline.transformed(&Similarity::about(Vector::xy(1.5, 5.5), at, Matrix::rotation(turn), scale))
    }

    fn element(outline: Outline<2>) -> Element<2> {
        let centre = outline.centroid().unwrap();
        Element {
            class: 0,
            centre,
            pose: Similarity::identity(),
            outline,
            colour: [0.2; 3],
            lean: [Vector::ZERO; 3],
            role: Role::Source,
        }
    }

    fn exemplar(outlines: Vec<Outline<2>>) -> Exemplar<2> {
        let elements = outlines.into_iter().map(element).collect();
        let window = Bounds::new(Vector::ZERO, Vector::splat(100.0));
        Exemplar::new("t", elements, vec![Class { name: "flag".into() }], window).unwrap()
    }

    fn is(outline: Outline<2>) -> Match {
        let rows = exemplar((0..6).map(|k| flag(Vector::xy(15.0 * f64::from(k) + 8.0, 50.0), 0.0, 1.0)).collect());
        let result = exemplar(vec![outline]);
        matches(&rows, &result, &[None], &Budget::default()).unwrap().remove(0)
    }

    #[test]
    fn a_copy_is_as_it_should_be() {
        let copy = is(flag(Vector::xy(30.0, 30.0), 0.02, 1.02));
        assert!(copy.class == Some(0) && !copy.is_mirrored, "{copy:?}");
        assert!(copy.broken < 1.0 && copy.turned < 1.0 && copy.scaled < 1.0, "{copy:?}");
    }

    #[test]
    fn turned_scaled_mirrored_and_broken_ones_are_told_apart() {
        let turned = is(flag(Vector::xy(30.0, 30.0), 0.9, 1.0));
        assert!(turned.turned > 2.0 && turned.broken < 1.0 && turned.scaled < 1.0, "{turned:?}");
        let scaled = is(flag(Vector::xy(30.0, 30.0), 0.0, 1.5));
        assert!(scaled.scaled > 2.0 && scaled.turned < 1.0 && scaled.broken < 1.0, "{scaled:?}");
        let mirrored = is(mirror(&flag(Vector::xy(-30.0, 30.0), 0.0, 1.0)));
        assert!(mirrored.is_mirrored, "{mirrored:?}");
        let mut torn = flag(Vector::xy(30.0, 30.0), 0.0, 1.0);
        torn.rings[0].retain(|p| p[1] > 30.0);
        assert!(is(torn).broken > 1.0);
    }

    #[test]
    fn round_things_do_not_turn_and_squares_by_a_quarter_only() {
        let ring = |n: u32| {
            let corner = |k: u32| {
                let turn = f64::from(k) / f64::from(n) * std::f64::consts::TAU;
                Vector::xy(turn.cos(), turn.sin()) * 5.0
            };
            Signature::new(&Outline { rings: vec![(0..n).map(corner).collect()] }).unwrap()
        };
        assert_eq!(symmetry(&ring(90)), 0.0);
        assert!((symmetry(&ring(4)) - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
        assert!((turn_between(0.1, 1.5, std::f64::consts::FRAC_PI_2) - 0.170_796).abs() < 1e-3);
    }
}
