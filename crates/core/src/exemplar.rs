//! The small example, already simplified.

use crate::{Bounds, Error, Outline, Result, Similarity, Vector};

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

/// Elements that count as the same kind of thing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Class {
    /// Name for people: from the file where it has one, else made up (`class 3`).
    pub name: String,
}

/// A set of elements in a window.
///
/// Promises: at least one element with [`Role::Source`]; every coordinate finite; every class index valid.
#[derive(Clone, Debug, PartialEq)]
pub struct Exemplar<const D: usize> {
    /// The elements, in drawing order.
    pub elements: Vec<Element<D>>,
    /// The classes.
    pub classes: Vec<Class>,
    /// The frame: inside it every element is known, outside it nothing is, but for elements that reach in.
    pub window: Bounds<D>,
}

impl<const D: usize> Exemplar<D> {
    /// Checks the promises.
    ///
    /// # Errors
    /// [`Error::Input`] with `place` when a promise is broken.
    pub fn new(place: &str, elements: Vec<Element<D>>, classes: Vec<Class>, window: Bounds<D>) -> Result<Self> {
        let fail = |problem: &str, advice: &str| Err(Error::input(place, problem, advice));
        if elements.is_empty() {
            return fail("no element found", "draw a few shapes or groups that should be repeated");
        }
        if elements.iter().all(|e| e.role == Role::Context) {
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
        Ok(Self { elements, classes, window })
    }

    /// An exemplar of points: `class_of[i]` is the class of `points[i]`, named by `names`.
    /// The window is the bounding box grown by half the mean spacing.
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

    /// Mean distance scale: (measure of the window / number of elements in it)^(1/D).
    pub fn spacing(&self) -> f64 {
        let inside = self.elements.iter().filter(|e| self.window.contains(e.centre)).count().max(1);
        (self.window.measure() / inside as f64).powf(1.0 / D as f64)
    }
}

fn window_around<const D: usize>(points: &[Vector<D>]) -> Bounds<D> {
    let tight = Bounds::around(points.iter().copied());
    let extent = tight.size().map(|s| s.max(1e-9));
    let spacing = (extent.0.iter().product::<f64>() / points.len().max(1) as f64).powf(1.0 / D as f64);
    let margin = extent.map(|s| (0.5 * spacing).min(0.5 * s));
    Bounds::new(tight.min - margin, tight.max + margin)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert!((e.spacing() - 1.0).abs() < 0.02);
    }
}
