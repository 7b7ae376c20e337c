//! Which elements look alike without being turned: what a translation could take to one another.

use arabesque_core::{Budget, Element, Exemplar, Outline, Result, Vector};

/// Directions in which the extent of an outline is measured.
const DIRECTIONS: usize = 16;

/// Numbers that describe a look: extents, moments of area, colour, and which way that leans.
const NUMBERS: usize = DIRECTIONS + 4 + 3 + 6;

/// Looks differ by less than this in each number, lengths in terms of the radius of the element.
pub(crate) const ALIKE: f64 = 0.06;
/// The same of what is drawn by hand, for sizes and extents.
pub(crate) const ALIKE_BY_HAND: f64 = 0.16;

/// Weight of the ways in which colours lean.
const LEAN: f64 = 6.0;

/// With more looks than this, what repeats is not how the elements look.
const MOST: usize = 512;

/// Work for each corner of an outline, and for two looks that are compared.
const WORK: (u64, u64) = (40, 5);

/// What an element looks like as it lies.
#[derive(Clone, Debug)]
struct Look {
    class: usize,
    radius: f64,
    numbers: [f64; NUMBERS],
}

/// Number of the look of each element, where looks are one that differ by less than `alike`; no numbers at all where there are too
/// many looks.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn looks(exemplar: &Exemplar<2>, alike: f64, budget: &Budget) -> Result<Option<Vec<u32>>> {
    numbered(exemplar, alike, Look::of, budget)
}

/// Number of the shape of each element as it lies, whatever it is painted in; otherwise as [`looks`].
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn shapes(exemplar: &Exemplar<2>, alike: f64, budget: &Budget) -> Result<Option<Vec<u32>>> {
    numbered(exemplar, alike, Look::of_shape, budget)
}

/// Number of what `look` sees of each element.
fn numbered(
    exemplar: &Exemplar<2>,
    alike: f64,
    look: fn(&Element<2>) -> Look,
    budget: &Budget,
) -> Result<Option<Vec<u32>>> {
    let mut known: Vec<Look> = Vec::new();
    let mut of = Vec::with_capacity(exemplar.elements.len());
    for element in &exemplar.elements {
        budget.spend(WORK.0 * element.outline.points().count() as u64)?;
        let look = look(element);
        // The latest looks first: rows of one kind are common. With very many looks, nothing repeats.
        budget.spend(WORK.1 * known.len() as u64)?;
        let number = known.iter().rposition(|other| look.is_like(other, alike));
        of.push(number.unwrap_or(known.len()) as u32);
        if number.is_none() {
            known.push(look);
        }
        if known.len() > MOST {
            return Ok(None);
        }
    }
    Ok(Some(of))
}

impl Look {
    fn of(element: &Element<2>) -> Self {
        let (outline, centre) = (&element.outline, element.centre);
        let radius = outline.radius(centre);
        let mut numbers = [0.0; NUMBERS];
        if radius > 0.0 {
            for (k, number) in numbers.iter_mut().take(DIRECTIONS).enumerate() {
                let (sin, cos) = (std::f64::consts::TAU * k as f64 / DIRECTIONS as f64).sin_cos();
                let along = outline.points().map(|p| (p - centre).dot(Vector::xy(cos, sin)));
                *number = along.fold(f64::NEG_INFINITY, f64::max) / radius;
            }
            numbers[DIRECTIONS..DIRECTIONS + 4].copy_from_slice(&moments(outline, centre, radius));
        }
        numbers[DIRECTIONS + 4..DIRECTIONS + 7].copy_from_slice(&element.colour);
        for (k, lean) in element.lean.iter().enumerate().filter(|_| radius > 0.0) {
            let at = DIRECTIONS + 7 + 2 * k;
            (numbers[at], numbers[at + 1]) = (LEAN * lean[0] / radius, LEAN * lean[1] / radius);
        }
        Self { class: element.class, radius, numbers }
    }

    /// What of its look is not paint. How a class is drawn is no part of that: what differs in colour alone is of two classes.
    fn of_shape(element: &Element<2>) -> Self {
        let mut look = Self { class: 0, ..Self::of(element) };
        look.numbers[DIRECTIONS + 4..].fill(0.0);
        look
    }

    fn is_like(&self, other: &Self, alike: f64) -> bool {
        let within = |k: usize| if k < DIRECTIONS { alike } else { ALIKE };
        self.class == other.class
            && (self.radius - other.radius).abs() <= alike * self.radius.max(other.radius)
            && self.numbers.iter().zip(&other.numbers).enumerate().all(|(k, (a, b))| (a - b).abs() <= within(k))
    }
}

/// Area and second moments of an outline, each on a scale where a disc has about one.
fn moments(outline: &Outline<2>, centre: Vector<2>, radius: f64) -> [f64; 4] {
    let (mut area, mut second) = (0.0, [0.0; 3]);
    for (p, q) in outline.edges() {
        let (p, q) = ((p - centre) * (1.0 / radius), (q - centre) * (1.0 / radius));
        let cross = p.cross(q);
        area += 0.5 * cross;
        let mixed = |a: usize, b: usize| (2.0 * (p[a] * p[b] + q[a] * q[b]) + p[a] * q[b] + p[b] * q[a]) * cross / 24.0;
        second[0] += mixed(0, 0);
        second[1] += mixed(1, 1);
        second[2] += mixed(0, 1);
    }
    let sign = if area < 0.0 { -1.0 } else { 1.0 };
    [area.abs() / 3.0, second[0] * sign, second[1] * sign, 2.0 * second[2] * sign]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use arabesque_core::{Bounds, Class, Role, Similarity};

    use super::*;

    /// Two quarter arcs about opposite corners of a cell, as thin bands, turned a quarter or not.
    fn arcs(at: Vector<2>, turned: bool) -> Element<2> {
        let band = |corner: Vector<2>, start: f64| -> Vec<Vector<2>> {
            let arc = |radius: f64, k: u32| {
                let (s, c) = (start + f64::from(k) * 0.1 * std::f64::consts::FRAC_PI_2).sin_cos();
                corner + Vector::xy(c, s) * radius
            };
            (0..=10).map(|k| arc(6.0, k)).chain((0..=10).rev().map(|k| arc(4.0, k))).collect()
        };
        let pi = std::f64::consts::PI;
        let rings = if turned {
            vec![band(at + Vector::xy(10.0, 0.0), 0.5 * pi), band(at + Vector::xy(0.0, 10.0), 1.5 * pi)]
        } else {
            vec![band(at, 0.0), band(at + Vector::xy(10.0, 10.0), pi)]
        };
        let outline = Outline { rings };
        let centre = outline.centroid().unwrap();
        let pose = Similarity::shift(centre);
        Element { class: 0, centre, pose, outline, colour: [0.0; 3], lean: [Vector::ZERO; 3], role: Role::Source }
    }

    #[test]
    fn what_is_turned_looks_different_and_what_is_shifted_does_not() {
        let elements = vec![
            arcs(Vector::ZERO, false),
            arcs(Vector::xy(10.0, 0.0), true),
            arcs(Vector::xy(0.0, 10.0), false),
            arcs(Vector::xy(10.0, 10.0), true),
        ];
        let window = Bounds::new(Vector::ZERO, Vector::xy(20.0, 20.0));
        let exemplar = Exemplar::new("t", elements, vec![Class { name: "arcs".into() }], window).unwrap();
        let of = looks(&exemplar, ALIKE, &Budget::default()).unwrap().unwrap();
        assert_eq!(of, vec![0, 1, 0, 1]);
    }

    #[test]
    fn a_shape_is_known_in_any_paint() {
        let painted = |k: usize| Element {
            class: k,
            colour: [0.3 * k as f64; 3],
            ..arcs(Vector::xy(10.0 * k as f64, 0.0), k == 2)
        };
        let elements = (0..3).map(painted).collect();
        let classes = ["red", "blue", "green"].map(|name| Class { name: name.into() }).to_vec();
        let window = Bounds::new(Vector::ZERO, Vector::xy(30.0, 10.0));
        let exemplar = Exemplar::new("t", elements, classes, window).unwrap();
        let budget = Budget::default();
        assert_eq!(looks(&exemplar, ALIKE, &budget).unwrap().unwrap(), vec![0, 1, 2]);
        assert_eq!(shapes(&exemplar, ALIKE, &budget).unwrap().unwrap(), vec![0, 0, 1]);
    }
}
