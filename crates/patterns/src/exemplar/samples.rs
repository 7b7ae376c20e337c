//! Samples of elements: which points stand for an element at each level [Ma 2011 §3.1, Tu 2020 §4.1.1].
//!
//! A round element is its centre. A long one gets two to five samples along its principal axis, so that their places
//! carry its orientation and bend. Samples are laid out on the first element of a class and carried to the others by
//! their pose, so that sample `j` means the same spot on every element of the class.

use arabesque_core::{Budget, Element, Exemplar, Outline, Result, Similarity, Solid, Vector};

/// Longest element relative to its width that still counts as round.
const ROUND: f64 = 1.6;

/// Nanoseconds that it takes to find the axis of an outline, for each of its corners.
const CORNER: u64 = 300;

/// The same for an outline, however few corners it has.
const SHAPE: u64 = 80_000;

/// A solid that is turned end over end lies the same where its surface is no farther off than this share of its inner radius, about one of
/// so many axes; and the nanoseconds that it takes to find that out, for each place of its surface.
const OFF: f64 = 0.3;
const ANGLES: usize = 12;
/// Samples are at opposite places where these differ by less than this share of how far they are from the centre.
const TWIN: f64 = 0.2;
const TURN: u64 = 1500;

/// Most samples that the shape alone asks for.
const MAX_SAMPLES: usize = 5;

/// Samples of every element of the exemplar, offsets from the centre of the element in exemplar directions.
#[derive(Clone, Debug)]
pub(crate) struct ElementSamples<const D: usize> {
    /// `offsets[e][j]`: finest samples of element `e`. All elements of a class have the same number.
    offsets: Vec<Vec<Vector<D>>>,
    /// Whether each element is the same end over end.
    is_reversible: Vec<bool>,
}

impl<const D: usize> ElementSamples<D> {
    /// Chooses samples from the shape of each class, or `count` for every class that has an outline.
    pub(crate) fn new(exemplar: &Exemplar<D>, count: Option<usize>, budget: &Budget) -> Result<Self> {
        let mut templates: Vec<Option<Vec<Vector<D>>>> = vec![None; exemplar.classes.len()];
        let mut offsets = Vec::with_capacity(exemplar.elements.len());
        let mut reversible: Vec<Option<bool>> = vec![None; exemplar.classes.len()];
        let mut is_reversible = Vec::with_capacity(exemplar.elements.len());
        for (n, e) in exemplar.elements.iter().enumerate() {
            let seen = exemplar.seen_pose(n);
            if templates[e.class].is_none() {
                let corners: usize = e.outline.rings.iter().map(Vec::len).sum();
                budget.spend(if corners == 0 { 0 } else { SHAPE + CORNER * corners as u64 })?;
            }
            let template = templates[e.class].get_or_insert_with(|| template(e, &seen, count));
            if let Some(solid) = exemplar.solids.get(n)
                && reversible[e.class].is_none()
            {
                budget.spend(TURN * solid.points.len() as u64)?;
                reversible[e.class] = Some(turns_end_over_end(solid, template));
            }
            is_reversible.push(reversible[e.class].unwrap_or(false));
            offsets.push(template.iter().map(|&p| seen.apply(p) - e.centre).collect());
        }
        Ok(Self { offsets, is_reversible })
    }

    /// The same with `count` more elements of a single sample: curve samples.
    pub(crate) fn with_points(&self, count: usize) -> Self {
        let mut offsets = self.offsets.clone();
        offsets.extend(std::iter::repeat_n(vec![Vector::ZERO], count));
        let mut is_reversible = self.is_reversible.clone();
        is_reversible.resize(offsets.len(), false);
        Self { offsets, is_reversible }
    }

    /// Number of samples of all elements at the finest level.
    pub(crate) fn count(&self) -> usize {
        self.offsets.iter().map(Vec::len).sum()
    }

    /// Numbers of the samples of element `e`, given where they are at a level: those that cannot be told from one another have the same.
    pub(crate) fn ids(&self, e: usize, parts: &[Vector<D>]) -> Vec<u32> {
        let size = parts.iter().map(|p| p.norm()).fold(0.0, f64::max);
        let twin = |j: usize| {
            let opposite = |k: &usize| self.is_reversible[e] && (parts[*k] + parts[j]).norm() < TWIN * size;
            (0..j).find(opposite).unwrap_or(j)
        };
        (0..parts.len()).map(|j| twin(j) as u32).collect()
    }

    /// Samples of element `e` at a level: the centre alone at `detail` 0, everything at 1, and in between the midpoints
    /// of every second sample and the centre.
    pub(crate) fn at_detail(&self, e: usize, detail: f64) -> Vec<Vector<D>> {
        let full = &self.offsets[e];
        if full.len() == 1 || detail <= 0.0 {
            return vec![Vector::ZERO];
        }
        if detail >= 1.0 {
            return full.clone();
        }
        full.iter().step_by(2).map(|&v| v * 0.5).collect()
    }
}

/// Whether a solid that is long lies the same once it is turned end over end, along its samples.
fn turns_end_over_end<const D: usize>(solid: &Solid<D>, template: &[Vector<D>]) -> bool {
    let [first, .., last] = template else { return false };
    let axis = (*last - *first).unit_or_zero();
    let inner = solid.inradius();
    let lies_within = |across: Vector<D>| {
        solid.points.iter().all(|p| {
            let v = *p - solid.centre;
            // Half a turn about what is across.
            let turned = solid.centre + across * (2.0 * v.dot(across)) - v;
            solid.depth(turned).abs() <= OFF * inner
        })
    };
    let bases = (0..D).map(|k| {
        let mut base = Vector::ZERO;
        base[k] = 1.0;
        (base - axis * axis[k]).unit_or_zero()
    });
    let bases: Vec<Vector<D>> = bases.filter(|base| base.norm2() > 0.5).collect();
    let [a, b, ..] = bases.as_slice() else { return false };
    let other = (*b - *a * b.dot(*a)).unit_or_zero();
    let angles = (0..ANGLES).map(|k| k as f64 / ANGLES as f64 * std::f64::consts::PI);
    angles.into_iter().any(|angle| lies_within(*a * angle.cos() + other * angle.sin()))
}

/// Finest samples of an element, in the coordinates that its pose starts from.
fn template<const D: usize>(element: &Element<D>, pose: &Similarity<D>, count: Option<usize>) -> Vec<Vector<D>> {
    let to_class = pose.inverse();
    let centre = vec![to_class.apply(element.centre)];
    let ink = boundary_points(&element.outline);
    let Some((axis, elongation)) = principal_axis(&ink) else {
        return centre;
    };
    let wanted =
        count.unwrap_or(if elongation < ROUND { 1 } else { (elongation.ceil() as usize).clamp(2, MAX_SAMPLES) });
    if wanted <= 1 {
        return centre;
    }
    slices(&ink, axis, wanted).into_iter().map(|p| to_class.apply(p)).collect()
}

/// Points at even steps along the rings, so that long edges weigh what they are long.
fn boundary_points<const D: usize>(outline: &Outline<D>) -> Vec<Vector<D>> {
    let length: f64 = outline.rings.iter().map(|r| ring_length(r)).sum();
    let step = length / 256.0;
    let mut points = Vec::new();
    for ring in &outline.rings {
        for k in 0..ring.len() {
            let (a, b) = (ring[k], ring[(k + 1) % ring.len()]);
            let pieces = if step > 0.0 { ((b - a).norm() / step).ceil().max(1.0) as usize } else { 1 };
            points.extend((0..pieces.min(1000)).map(|i| a + (b - a) * (i as f64 / pieces as f64)));
        }
    }
    points
}

fn ring_length<const D: usize>(ring: &[Vector<D>]) -> f64 {
    (0..ring.len()).map(|k| (ring[(k + 1) % ring.len()] - ring[k]).norm()).sum()
}

/// Direction of largest extent, and how much longer the points spread along it than across.
fn principal_axis<const D: usize>(points: &[Vector<D>]) -> Option<(Vector<D>, f64)> {
    if points.len() < 3 {
        return None;
    }
    let n = points.len() as f64;
    let mean = points.iter().fold(Vector::ZERO, |s, &p| s + p) * (1.0 / n);
    let variance = |axis: Vector<D>| points.iter().map(|&p| (p - mean).dot(axis).powi(2)).sum::<f64>() / n;
    let total: f64 = points.iter().map(|&p| (p - mean).norm2()).sum::<f64>() / n;
    // Power iteration from the farthest point: at most a few dozen steps for any shape that is long at all.
    let far = points.iter().copied().max_by(|a, b| (*a - mean).norm2().total_cmp(&(*b - mean).norm2()))?;
    let mut axis = far - mean;
    for _ in 0..60 {
        let length = axis.norm();
        if length <= 0.0 {
            return None;
        }
        axis = axis * (1.0 / length);
        axis = points.iter().fold(Vector::ZERO, |s, &p| s + (p - mean) * (p - mean).dot(axis));
    }
    let axis = axis.unit_or_zero();
    let along = variance(axis);
    let across = ((total - along) / (D as f64 - 1.0)).max(1e-12 * along);
    (along > 0.0).then(|| (axis, (along / across).sqrt()))
}

/// Means of the points in `count` equal slices across `axis`.
fn slices<const D: usize>(points: &[Vector<D>], axis: Vector<D>, count: usize) -> Vec<Vector<D>> {
    let at = |p: Vector<D>| p.dot(axis);
    let low = points.iter().map(|&p| at(p)).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|&p| at(p)).fold(f64::NEG_INFINITY, f64::max);
    let mut sums = vec![(Vector::ZERO, 0.0); count];
    for &p in points {
        let slice = ((at(p) - low) / (high - low) * count as f64) as usize;
        let entry = &mut sums[slice.min(count - 1)];
        entry.0 += p;
        entry.1 += 1.0;
    }
    sums.into_iter().filter(|(_, n)| *n > 0.0).map(|(sum, n)| sum * (1.0 / n)).collect()
}

/// The similarity about the centre that carries samples `offsets` to `positions`, scale fixed.
pub(crate) fn pose_of<const D: usize>(
    offsets: &[Vector<D>],
    positions: &[Vector<D>],
    scale: f64,
    (fallback, keeps_angle): (arabesque_core::Matrix<D>, bool),
) -> Similarity<D> {
    if offsets.len() == 1 || keeps_angle {
        let middle = |all: &[Vector<D>]| all.iter().fold(Vector::ZERO, |sum, p| sum + *p) * (1.0 / all.len() as f64);
        return Similarity::about(middle(offsets), middle(positions), fallback, scale);
    }
    Similarity::fit(offsets, positions, scale, fallback)
}

#[cfg(test)]
mod tests {
    use super::*;
    use arabesque_core::{Bounds, Class, Role};

    fn exemplar(ring: Vec<Vector<2>>) -> Exemplar<2> {
        let outline = Outline { rings: vec![ring] };
        let centre = outline.centroid().unwrap();
        let element = Element {
            class: 0,
            centre,
            pose: Similarity::shift(centre),
            outline,
            colour: [0.0; 3],
            lean: [Vector::ZERO; 3],
            role: Role::Source,
        };
        let window = Bounds::new(Vector::xy(-10.0, -10.0), Vector::xy(10.0, 10.0));
        Exemplar::new("t", vec![element], vec![Class { name: "a".into() }], window).unwrap()
    }

    fn rectangle(w: f64, h: f64) -> Vec<Vector<2>> {
        vec![Vector::xy(0.0, 0.0), Vector::xy(w, 0.0), Vector::xy(w, h), Vector::xy(0.0, h)]
    }

    #[test]
    fn a_square_is_its_centre() {
        let s = ElementSamples::new(&exemplar(rectangle(2.0, 2.0)), None, &Budget::default()).unwrap();
        assert_eq!(s.at_detail(0, 1.0), vec![Vector::ZERO]);
    }

    #[test]
    fn a_bar_has_samples_along_its_length() {
        let s = ElementSamples::new(&exemplar(rectangle(8.0, 2.0)), None, &Budget::default()).unwrap();
        let fine = s.at_detail(0, 1.0);
        assert!(fine.len() >= 3, "{fine:?}");
        assert!(fine.iter().all(|v| v[1].abs() < 0.2));
        assert!(fine.iter().any(|v| v[0] < -2.5) && fine.iter().any(|v| v[0] > 2.5));
        assert_eq!(s.at_detail(0, 0.0).len(), 1);
        assert!(s.at_detail(0, 0.5).len() < fine.len());
    }

    #[test]
    fn the_count_can_be_asked_for() {
        let s = ElementSamples::new(&exemplar(rectangle(2.0, 2.0)), Some(3), &Budget::default()).unwrap();
        assert_eq!(s.at_detail(0, 1.0).len(), 3);
    }
}
