//! A part of a drawing as an exemplar of its own.

use std::{collections::BTreeSet, sync::Arc};

use arabesque_core::{Bounds, Class, Contents, Exemplar, Result, Role};

use crate::svg::drawing::{Drawing, Layer};

impl Drawing {
    /// The drawing seen through a smaller window: elements with their centre in it, those that reach in as context
    /// only, and the curves that meet it. Elements with their centre in the `hole` are left out. The page stays.
    ///
    /// # Errors
    /// As [`Exemplar::with_curves`], naming `place`.
    pub fn within(self, window: Bounds<2>, hole: Option<Bounds<2>>, place: &str) -> Result<Self> {
        let Exemplar { elements, classes, curves, mut areas, styles, period, .. } = Arc::unwrap_or_clone(self.exemplar);
        let (mut kept, mut fragments) = (Vec::new(), Vec::new());
        for (mut element, fragment) in elements.into_iter().zip(self.fragments) {
            if hole.is_some_and(|hole| hole.contains(element.centre)) {
                continue;
            }
            if window.contains(element.centre) || element.outline.bounds().intersects(&window) {
                if !window.contains(element.centre) {
                    element.role = Role::Context;
                }
                kept.push(element);
                fragments.push(fragment);
            }
        }
        let meets = |c: &arabesque_core::Curve<2>| {
            c.path
                .flatten(1e-3 * window.size().norm())
                .windows(2)
                .any(|w| Bounds::around([w[0], w[1]]).intersects(&window))
        };
        let (mut curves, strokes): (Vec<_>, Vec<_>) =
            curves.into_iter().zip(self.strokes).filter(|(curve, _)| meets(curve)).unzip();
        let (classes, class_of) = renumbered(classes, kept.iter_mut().map(|e| &mut e.class));
        let of_lines = curves.iter_mut().map(|c| &mut c.style).chain(areas.iter_mut().map(|a| &mut a.style));
        let (styles, style_of) = renumbered(styles, of_lines);
        let layers = self.layers.iter().filter_map(|layer| still_there(layer, &class_of, &style_of)).collect();
        let exemplar = Exemplar {
            hole,
            period,
            ..Exemplar::with_curves(place, Contents { elements: kept, classes, curves, styles, areas }, window)?
        };
        Ok(Self { exemplar: Arc::new(exemplar), fragments, strokes, layers, ..self })
    }
}

/// A layer by the new numbers of classes and styles; `None` where nothing of it is left.
fn still_there(layer: &Layer, class_of: &[Option<usize>], style_of: &[Option<usize>]) -> Option<Layer> {
    match layer {
        Layer::Strokes { style, paint } => {
            let style = style_of.get(*style).copied().flatten()?;
            Some(Layer::Strokes { style, paint: *paint })
        }
        Layer::Elements(classes) => {
            let left: BTreeSet<_> = classes.iter().filter_map(|&c| class_of.get(c).copied().flatten()).collect();
            (!left.is_empty()).then_some(Layer::Elements(left))
        }
    }
}

/// The classes that are still in use, with the indices into them, and the new number of each.
fn renumbered<'i>(
    classes: Vec<Class>,
    indices: impl Iterator<Item = &'i mut usize>,
) -> (Vec<Class>, Vec<Option<usize>>) {
    let mut new_of = vec![None; classes.len()];
    let mut used = Vec::new();
    for index in indices {
        let old = *index;
        *index = *new_of[old].get_or_insert_with(|| {
            used.push(classes[old].clone());
            used.len() - 1
        });
    }
    (used, new_of)
}

#[cfg(test)]
mod tests {
    use arabesque_core::Vector;

    use super::*;
    use crate::svg::{options::ReadOptions, read::exemplar::read_exemplar};

    #[test]
    fn a_corner_of_a_drawing_keeps_what_is_in_it() {
        let text = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>
            <circle cx='80' cy='20' r='5' fill='red'/><circle cx='20' cy='20' r='5'/><circle cx='53' cy='20' r='5'/>
            <path d='M0 90H100' stroke='red'/><path d='M0 30H100' stroke='blue'/></svg>";
        let drawing = read_exemplar(text, &ReadOptions::new("w.svg")).unwrap();
        let part = drawing.within(Bounds::new(Vector::ZERO, Vector::xy(50.0, 50.0)), None, "w.svg").unwrap();
        let roles: Vec<_> = part.exemplar.elements.iter().map(|e| (e.class, e.role)).collect();
        assert_eq!(roles, [(0, Role::Source), (0, Role::Context)]);
        assert_eq!((part.exemplar.classes.len(), part.exemplar.styles.len(), part.strokes.len()), (1, 1, 1));
        assert!(part.strokes[0][0].paint.contains("#0000ff"));
        assert_eq!(part.layers, [Layer::Elements([0].into()), Layer::Strokes { style: 0, paint: 0 }]);
    }
}
