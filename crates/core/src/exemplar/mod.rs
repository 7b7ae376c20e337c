//! The small example, already simplified.

mod soft;
mod solid;
mod view;
mod window;

pub use soft::{Build, Soft};
pub use solid::Solid;
pub use view::View;
pub use window::{PointLattice, point_lattice};

use std::sync::Arc;

use crate::{
    curve::Path,
    error::{Error, Result},
    region::Outline,
    space::{Bounds, Similarity, Spread, Vector},
};
use window::window_around;

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
    /// The ink. In space points spread over the surface, in one ring, in no order.
    pub outline: Outline<D>,
    /// Mean colour of the ink, sRGB in [0, 1].
    pub colour: [f64; 3],
    /// Which way each channel of the colour leans: the mean, over the ink, of its difference from the mean colour times the vector
    /// from the centre. Zero for ink of one colour; it tells how something lies whose outline does not.
    pub lean: [Vector<D>; 3],
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

/// A filled area that runs through the frame: a band of varying width, a net with broad meshes. It goes on beyond the frame as the
/// pattern repeats, and may be cut anywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Area<const D: usize> {
    /// What is filled.
    pub outline: Outline<D>,
    /// Index into [`Exemplar::styles`].
    pub style: usize,
    /// Mean colour of the fill, sRGB in [0, 1].
    pub colour: [f64; 3],
}

/// Elements that count as the same kind of thing, or curves and areas painted alike.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Class {
    /// Name for people: from the file where it has one, else made up (`class 3`).
    pub name: String,
}

/// A set of elements, curves and areas in a window.
///
/// Promises: at least one element with [`Role::Source`], one curve or one area; every coordinate finite; every class and style index valid.
#[derive(Clone, Debug, PartialEq)]
pub struct Exemplar<const D: usize> {
    /// The elements, in drawing order.
    pub elements: Vec<Element<D>>,
    /// The classes.
    pub classes: Vec<Class>,
    /// The curves, in drawing order.
    pub curves: Vec<Curve<D>>,
    /// The areas that run through the window, in drawing order.
    pub areas: Vec<Area<D>>,
    /// Ways in which curves and areas are painted.
    pub styles: Vec<Class>,
    /// The frame: inside it every element is known, outside it nothing is, except elements that reach in.
    pub window: Bounds<D>,
    /// A part of the window of which nothing is known.
    pub hole: Option<Bounds<D>>,
    /// Where the exemplar is known to repeat exactly: two vectors by which all of it can be moved onto itself, as far as it is shown.
    /// `None` where the file does not say so; it may repeat all the same.
    pub period: Option<[Vector<D>; 2]>,
    /// The volumes of the elements, one for each, in the coordinates from which its pose leads; empty where they have none.
    pub solids: Vec<Arc<Solid<D>>>,
    /// Poses that are the same to look at as those of the elements, one for each, each as like that of the first of its class as a symmetry
    /// of the solid allows; empty where nobody looked for symmetries.
    pub seen: Vec<Similarity<D>>,
    /// The samples of the elements, one for each, where any of them bends; else empty.
    pub softs: Vec<Arc<Soft<D>>>,
    /// For each element that stands on the ground, the height of its centre over it, which it keeps; such elements are classes of their
    /// own. Empty where there is no ground.
    pub heights: Vec<Option<f64>>,
    /// The axis along which heights are: 1, y, unless somebody says otherwise.
    pub up: usize,
}

/// What an exemplar holds, not yet checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Contents<const D: usize> {
    /// The elements, in drawing order.
    pub elements: Vec<Element<D>>,
    /// The classes that they refer to.
    pub classes: Vec<Class>,
    /// The curves, in drawing order.
    pub curves: Vec<Curve<D>>,
    /// The areas, in drawing order.
    pub areas: Vec<Area<D>>,
    /// The styles that curves and areas refer to.
    pub styles: Vec<Class>,
}

impl<const D: usize> Default for Contents<D> {
    fn default() -> Self {
        let (elements, classes) = (Vec::new(), Vec::new());
        Self { elements, classes, curves: Vec::new(), areas: Vec::new(), styles: Vec::new() }
    }
}

impl<const D: usize> Exemplar<D> {
    /// An exemplar of elements alone.
    ///
    /// # Errors
    /// As [`Exemplar::with_curves`].
    pub fn new(place: &str, elements: Vec<Element<D>>, classes: Vec<Class>, window: Bounds<D>) -> Result<Self> {
        Self::with_curves(place, Contents { elements, classes, ..Contents::default() }, window)
    }

    /// Checks the promises.
    ///
    /// # Errors
    /// [`Error::Input`] with `place` when a promise is broken.
    pub fn with_curves(place: &str, contents: Contents<D>, window: Bounds<D>) -> Result<Self> {
        let Contents { elements, classes, curves, areas, styles } = contents;
        let fail = |problem: &str, advice: &str| Err(Error::input(place, problem, advice));
        if elements.is_empty() && curves.is_empty() && areas.is_empty() {
            return fail("no element found", "draw a few shapes or groups that should be repeated");
        }
        let broken = |c: &Curve<D>| {
            let bad = c.path.cubics.iter().flatten().any(|p| !p.is_finite());
            bad || c.path.is_empty() || c.style >= styles.len() || !c.width.is_finite()
        };
        if curves.iter().any(broken) {
            return fail("a curve has no length or no style", "remove curves with NaN or infinite coordinates");
        }
        let bad = |a: &Area<D>| a.outline.points().any(|p| !p.is_finite()) || a.style >= styles.len();
        if areas.iter().any(bad) {
            return fail("an area has no sound outline or no style", "remove areas with NaN or infinite coordinates");
        }
        if curves.is_empty() && areas.is_empty() && elements.iter().all(|e| e.role == Role::Context) {
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
        Ok(Self {
            elements,
            classes,
            curves,
            areas,
            styles,
            window,
            hole: None,
            period: None,
            solids: Vec::new(),
            seen: Vec::new(),
            softs: Vec::new(),
            heights: Vec::new(),
            up: 1,
        })
    }

    /// An exemplar of points: `class_of[i]` is the class of `points[i]`, named by `names`.
    /// The window is the bounding box, grown until its density is that of the interior.
    ///
    /// # Errors
    /// As [`Exemplar::new`].
    pub fn from_points(place: &str, points: &[Vector<D>], class_of: &[usize], names: &[String]) -> Result<Self> {
        let spread = Spread::of(points.iter().copied());
        let is_flat = Bounds::around(points.iter().copied()).size().0.contains(&0.0);
        if points.len() == 1 {
            let advice = "give several, so that the pattern shows distances and directions";
            return Err(Error::input(place, "one point only, expected at least two", advice));
        }
        if !spread.fills::<D>() && (points.len() > D || is_flat) && !points.is_empty() {
            let problem = format!("all {} points lie {}", points.len(), spread.words());
            let advice = if D == 2 { "the plane" } else { "space" };
            return Err(Error::input(place, problem, format!("give points that spread over {advice}")));
        }
        let elements = points.iter().zip(class_of).map(|(&p, &class)| Element {
            class,
            centre: p,
            pose: Similarity::shift(p),
            outline: Outline::default(),
            colour: [0.0; 3],
            lean: [Vector::ZERO; 3],
            role: Role::Source,
        });
        let classes = names.iter().map(|name| Class { name: name.clone() }).collect();
        Self::new(place, elements.collect(), classes, window_around(points))
    }

    /// An exemplar of elements whose frame nobody tells: the bounding box of the centres, grown by half a step around a lattice, else until
    /// its density is that of the interior.
    ///
    /// # Errors
    /// As [`Exemplar::new`].
    pub fn unframed(place: &str, elements: Vec<Element<D>>, classes: Vec<Class>) -> Result<Self> {
        let centres: Vec<_> = elements.iter().map(|e| e.centre).collect();
        let window = match point_lattice(&centres) {
            Some(lattice) => Bounds::around(centres.iter().copied()).grown(0.5 * lattice.step),
            None => window_around(&centres),
        };
        Self::new(place, elements, classes, window)
    }

    /// Pose of an element as it looks: [`Exemplar::seen`] where that is known.
    pub fn seen_pose(&self, element: usize) -> Similarity<D> {
        self.seen.get(element).copied().unwrap_or(self.elements[element].pose)
    }

    /// What it shows.
    pub fn view(&self) -> View<D> {
        View { window: self.window, hole: self.hole }
    }

    /// Mean distance scale: (measure of what is shown / number of elements in it)^(1/D); in space, where that is a single layer, (area of
    /// the layer / number)^(1/2).
    pub fn spacing(&self) -> f64 {
        let view = self.view();
        let inside = self.elements.iter().filter(|e| view.contains(e.centre)).count().max(1);
        let spacing = (view.measure() / inside as f64).powf(1.0 / D as f64);
        let thinnest = self.window.size().0.into_iter().fold(f64::INFINITY, f64::min);
        if D == 3 && thinnest < spacing { (view.measure() / thinnest / inside as f64).sqrt() } else { spacing }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_that_do_not_spread_are_told_how_they_lie() {
        let told = |points: &[Vector<2>]| {
            let class_of = vec![0; points.len()];
            Exemplar::from_points("t", points, &class_of, &["a".into()]).unwrap_err().to_string()
        };
        assert!(told(&[Vector::xy(2.0, 3.0)]).starts_with("t: one point only"));
        assert!(told(&[Vector::xy(2.0, 3.0); 5]).starts_with("t: all 5 points lie at one place"));
        assert!(told(&[Vector::xy(2.0, 3.0), Vector::xy(4.0, 3.0)]).starts_with("t: all 2 points lie on one line"));
        let slanted: Vec<_> = (0..9).map(|k| Vector::xy(f64::from(k), 0.1 * f64::from(k))).collect();
        assert!(told(&slanted).starts_with("t: all 9 points lie on one line"));
        assert!(told(&[]).contains("no element found"));
    }

    #[test]
    fn a_lattice_is_framed_by_half_a_step_and_strewn_points_are_none() {
        let points: Vec<_> = (0..32).map(|k| Vector([k % 4, k / 16, k / 4 % 4].map(|n| 1.5 * f64::from(n)))).collect();
        let lattice = point_lattice(&points).unwrap();
        assert!((lattice.step - 1.5).abs() < 1e-12 && lattice.cell.is_none(), "two layers surround nothing");
        let element = |&p: &Vector<3>| Element {
            class: 0,
            centre: p,
            pose: Similarity::shift(p),
            outline: Outline::default(),
            colour: [0.0; 3],
            lean: [Vector::ZERO; 3],
            role: Role::Source,
        };
        let classes = vec![Class { name: "a".into() }];
        let framed = Exemplar::unframed("t", points.iter().map(element).collect(), classes).unwrap();
        assert!((framed.window.measure() - 32.0 * 1.5_f64.powi(3)).abs() < 1e-9, "{:?}", framed.window);
        let mut stream = crate::random::Stream::new(2, crate::random::Stage::TEST, 0);
        let strewn: Vec<_> = (0..60).map(|_| Vector([0; 3].map(|_| stream.range(0.0, 5.0)))).collect();
        assert_eq!(point_lattice(&strewn), None);
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
}
