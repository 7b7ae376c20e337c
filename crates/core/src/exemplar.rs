//! The small example, already simplified.

use crate::{Bounds, Domain, Error, GridIndex, Outline, Path, Result, Similarity, Vector};

/// What an element of the exemplar may be used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// May be copied into the output.
    Source,
    /// Cut at the frame of the exemplar: it shows where something is, but is never copied.
    Context,
}

/// One whole thing that is never broken: a leaf, a cherry pair with its stalk, a dot.
#[derive(Clone, Debug, PartialEq)]
pub struct Element<const D: usize> {
    /// Index into [`Exemplar::classes`].
    pub class: usize,
    /// Centre of area of the outline; the position of a point.
    pub centre: Vector<D>,
    /// From the coordinates of the first element of the class to those of this one, as well as a similarity can.
    pub pose: Similarity<D>,
    /// The ink.
    pub outline: Outline<D>,
    /// Mean colour of the ink, sRGB in [0, 1].
    pub colour: [f64; 3],
    /// Whether it may be copied.
    pub role: Role,
}

/// One stroke of a continuous pattern: it may be cut anywhere, joined to others, and go on for ever.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve<const D: usize> {
    /// The line that the stroke follows.
    pub path: Path<D>,
    /// Index into [`Exemplar::styles`].
    pub style: usize,
    /// Width of the stroke.
    pub width: f64,
    /// Colour of the stroke, sRGB in [0, 1].
    pub colour: [f64; 3],
}

/// Elements that count as the same kind of thing, or curves painted alike.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Class {
    /// Name for people: from the file where it has one, else made up (`class 3`).
    pub name: String,
}

/// A set of elements and curves in a window.
///
/// Promises: at least one element with [`Role::Source`] or one curve; every coordinate finite; every class and style index valid.
#[derive(Clone, Debug, PartialEq)]
pub struct Exemplar<const D: usize> {
    /// The elements, in drawing order.
    pub elements: Vec<Element<D>>,
    /// The classes.
    pub classes: Vec<Class>,
    /// The curves, in drawing order.
    pub curves: Vec<Curve<D>>,
    /// Ways in which curves are painted.
    pub styles: Vec<Class>,
    /// The frame: inside it every element is known, outside it nothing is, but for elements that reach in.
    pub window: Bounds<D>,
    /// A part of the window of which nothing is known.
    pub hole: Option<Bounds<D>>,
}

/// What an exemplar shows: everything in a box, but for a hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View<const D: usize> {
    /// The box.
    pub window: Bounds<D>,
    /// The hole in it.
    pub hole: Option<Bounds<D>>,
}

impl<const D: usize> From<Bounds<D>> for View<D> {
    /// The whole box.
    fn from(window: Bounds<D>) -> Self {
        Self { window, hole: None }
    }
}

impl<const D: usize> View<D> {
    /// Whether a place is shown.
    pub fn contains(&self, p: Vector<D>) -> bool {
        self.window.contains(p) && !self.hole.is_some_and(|hole| hole.contains(p))
    }

    /// Distance to the border of what is shown: positive inside, negative outside.
    pub fn signed_distance(&self, p: Vector<D>) -> f64 {
        self.window.signed_distance(p).min(self.from_hole(p))
    }

    /// Distance to the hole; infinite without one.
    pub fn from_hole(&self, p: Vector<D>) -> f64 {
        self.hole.map_or(f64::INFINITY, |hole| -hole.signed_distance(p))
    }

    /// How far across it can be seen at least: the shorter side of the box, or of the widest of the strips beside the hole.
    pub fn side(&self) -> f64 {
        let across = |b: &Bounds<D>| b.size().0.into_iter().fold(f64::INFINITY, f64::min);
        let Some(hole) = self.hole else { return across(&self.window) };
        let strips = (0..D).flat_map(|k| {
            let (mut before, mut after) = (self.window, self.window);
            before.max[k] = before.max[k].min(hole.min[k]);
            after.min[k] = after.min[k].max(hole.max[k]);
            [before, after]
        });
        strips.map(|strip| across(&strip)).fold(0.0, f64::max)
    }

    /// Area or volume of what is shown.
    pub fn measure(&self) -> f64 {
        let common = |hole: Bounds<D>| {
            Bounds::new(hole.min.zip(self.window.min, f64::max), hole.max.zip(self.window.max, f64::min))
        };
        let lost = self.hole.map(common).filter(|hole| !hole.is_empty()).map_or(0.0, |hole| hole.measure());
        self.window.measure() - lost
    }
}

impl<const D: usize> Exemplar<D> {
    /// An exemplar of elements alone.
    ///
    /// # Errors
    /// As [`Exemplar::with_curves`].
    pub fn new(place: &str, elements: Vec<Element<D>>, classes: Vec<Class>, window: Bounds<D>) -> Result<Self> {
        Self::with_curves(place, (elements, classes), (Vec::new(), Vec::new()), window)
    }

    /// Checks the promises.
    ///
    /// # Errors
    /// [`Error::Input`] with `place` when a promise is broken.
    pub fn with_curves(
        place: &str,
        (elements, classes): (Vec<Element<D>>, Vec<Class>),
        (curves, styles): (Vec<Curve<D>>, Vec<Class>),
        window: Bounds<D>,
    ) -> Result<Self> {
        let fail = |problem: &str, advice: &str| Err(Error::input(place, problem, advice));
        if elements.is_empty() && curves.is_empty() {
            return fail("no element found", "draw a few shapes or groups that should be repeated");
        }
        let broken = |c: &Curve<D>| {
            let bad = c.path.cubics.iter().flatten().any(|p| !p.is_finite());
            bad || c.path.is_empty() || c.style >= styles.len() || !c.width.is_finite()
        };
        if curves.iter().any(broken) {
            return fail("a curve has no length or no style", "remove curves with NaN or infinite coordinates");
        }
        if curves.is_empty() && elements.iter().all(|e| e.role == Role::Context) {
            return fail(
                "every element is cut by the frame",
                "make the frame larger, or leave at least one element whole",
            );
        }
        if elements.iter().any(|e| !e.centre.is_finite() || e.class >= classes.len()) {
            return fail("an element has no position or no class", "remove elements with NaN or infinite coordinates");
        }
        if window.measure() <= 0.0 || !window.min.is_finite() || !window.max.is_finite() {
            return fail("the frame has no area", "give the exemplar a width and a height");
        }
        Ok(Self { elements, classes, curves, styles, window, hole: None })
    }

    /// An exemplar of points: `class_of[i]` is the class of `points[i]`, named by `names`.
    /// The window is the bounding box, grown until its density is that of the interior.
    ///
    /// # Errors
    /// As [`Exemplar::new`].
    pub fn from_points(place: &str, points: &[Vector<D>], class_of: &[usize], names: &[String]) -> Result<Self> {
        let elements = points.iter().zip(class_of).map(|(&p, &class)| Element {
            class,
            centre: p,
            pose: Similarity::shift(p),
            outline: Outline::default(),
            colour: [0.0; 3],
            role: Role::Source,
        });
        let classes = names.iter().map(|name| Class { name: name.clone() }).collect();
        Self::new(place, elements.collect(), classes, window_around(points))
    }

    /// What it shows.
    pub fn view(&self) -> View<D> {
        View { window: self.window, hole: self.hole }
    }

    /// Mean distance scale: (measure of what is shown / number of elements in it)^(1/D).
    pub fn spacing(&self) -> f64 {
        let view = self.view();
        let inside = self.elements.iter().filter(|e| view.contains(e.centre)).count().max(1);
        (view.measure() / inside as f64).powf(1.0 / D as f64)
    }
}

/// Share of the estimated margin that is used: a window that is too large claims emptiness that nobody has seen, and thins the output.
const KEPT_MARGIN: f64 = 0.15;

/// The window that points were probably cut from: their bounding box, moved outwards so far that its density is that of the interior.
///
/// The interior density is one over the mean Voronoi cell of the points whose cell does not reach the bounding box. A lattice gets half
/// its step around it, a random set nearly nothing; half the mean spacing serves when too few cells are whole.
fn window_around<const D: usize>(points: &[Vector<D>]) -> Bounds<D> {
    let tight = Bounds::around(points.iter().copied());
    let extent = tight.size().map(|s| s.max(1e-9));
    let spacing = (extent.0.iter().product::<f64>() / points.len().max(1) as f64).powf(1.0 / D as f64);
    let grown = |margin: f64| {
        Bounds::new(tight.min - extent.map(|s| margin.min(0.5 * s)), tight.max + extent.map(|s| margin.min(0.5 * s)))
    };
    let Some(cell) = interior_cell(points, &tight, spacing) else {
        return grown(0.5 * spacing);
    };
    let wanted = cell * points.len() as f64;
    let (mut low, mut high) = (0.0, 1.5 * spacing);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if grown(middle).measure() < wanted { low = middle } else { high = middle }
    }
    grown(KEPT_MARGIN * low)
}

/// Mean measure of the Voronoi cells that do not reach the box, found by sampling; `None` when fewer than nine are whole.
fn interior_cell<const D: usize>(points: &[Vector<D>], tight: &Bounds<D>, spacing: f64) -> Option<f64> {
    let index = GridIndex::new(points, spacing, &Domain::Box(*tight));
    let per_point = if points.len() > 20_000 { 16.0 } else { 128.0 };
    let side = ((points.len() as f64 * per_point).powf(1.0 / D as f64).ceil() as usize).clamp(8, 4096);
    let (mut hits, mut cut) = (vec![0_u32; points.len()], vec![false; points.len()]);
    let size = tight.size();
    for sample in 0..side.pow(D as u32) {
        let (mut rest, mut rim) = (sample, false);
        let p = Vector(std::array::from_fn(|k| {
            let i = rest % side;
            rest /= side;
            rim |= i == 0 || i == side - 1;
            tight.min[k] + size[k] * (i as f64 + 0.5) / side as f64
        }));
        let (nearest, _) = (0..6).find_map(|n| index.nearest(p, spacing * f64::from(1 << n), None))?;
        hits[nearest] += 1;
        cut[nearest] |= rim;
    }
    let whole: Vec<f64> = (0..points.len()).filter(|&i| !cut[i]).map(|i| f64::from(hits[i])).collect();
    let sample_measure = tight.measure() / side.pow(D as u32) as f64;
    (whole.len() >= 9).then(|| whole.iter().sum::<f64>() / whole.len() as f64 * sample_measure)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(min: f64, max: f64) -> Bounds<2> {
        Bounds::new(Vector::xy(min, min), Vector::xy(max, max))
    }

    #[test]
    fn a_hole_is_not_shown() {
        let view = View { window: square(0.0, 100.0), hole: Some(square(40.0, 60.0)) };
        assert!(view.contains(Vector::xy(30.0, 50.0)) && !view.contains(Vector::xy(50.0, 50.0)));
        assert!(!view.contains(Vector::xy(101.0, 50.0)));
        assert_eq!(view.signed_distance(Vector::xy(30.0, 50.0)), 10.0);
        assert_eq!(view.signed_distance(Vector::xy(5.0, 50.0)), 5.0);
        assert!(view.signed_distance(Vector::xy(45.0, 50.0)) < 0.0);
        assert_eq!((view.measure(), view.side()), (9600.0, 40.0));
        let whole = View::from(square(0.0, 100.0));
        assert_eq!((whole.measure(), whole.side(), whole.from_hole(Vector::ZERO)), (1e4, 100.0, f64::INFINITY));
    }

    #[test]
    fn only_what_a_hole_takes_of_the_window_counts() {
        let window = square(0.0, 100.0);
        assert_eq!(View { window, hole: Some(square(90.0, 120.0)) }.measure(), 9900.0);
        assert_eq!(View { window, hole: Some(square(120.0, 130.0)) }.measure(), 1e4);
    }

    #[test]
    fn an_exemplar_of_cut_elements_alone_is_refused() {
        let mut e =
            Exemplar::from_points("t", &[Vector::xy(0.0, 0.0), Vector::xy(1.0, 1.0)], &[0, 0], &["a".into()]).unwrap();
        for element in &mut e.elements {
            element.role = Role::Context;
        }
        let err = Exemplar::new("t", e.elements, e.classes, e.window).unwrap_err();
        assert!(err.to_string().contains("cut by the frame"));
    }

    #[test]
    fn the_window_of_a_grid_gives_back_its_spacing() {
        let points: Vec<_> = (0..100).map(|i| Vector::xy(f64::from(i % 10), f64::from(i / 10))).collect();
        let e = Exemplar::from_points("t", &points, &[0; 100], &["a".into()]).unwrap();
        assert!((e.spacing() - 0.915).abs() < 0.02, "{}", e.spacing());
    }

    #[test]
    fn the_window_of_random_points_is_hardly_larger_than_their_box() {
        let mut random = crate::Stream::new(5, crate::Stage::Test, 0);
        let points: Vec<_> = (0..400).map(|_| Vector::xy(random.unit(), random.unit())).collect();
        let e = Exemplar::from_points("t", &points, &[0; 400], &["a".into()]).unwrap();
        assert!((e.window.measure() - 1.0).abs() < 0.06, "{:?}", e.window);
    }
}
