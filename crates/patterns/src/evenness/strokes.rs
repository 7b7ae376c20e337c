//! Ink of strokes: places along them, close enough that the gaps between them do not matter, and half their width.

use std::collections::BTreeMap;

use arabesque_core::{Domain, GridIndex, Numbered, Vector};

use crate::{
    evenness::ink::{Inks, Pose},
    exemplar::{graph::net::Net, library::Library},
    output::state::State,
};

/// Places to an edge between two samples.
const PLACES: u32 = 4;

/// Places along strokes.
#[derive(Clone, Debug)]
pub(crate) struct Strokes<const D: usize> {
    pub(crate) places: Vec<(Vector<D>, f64)>,
    index: GridIndex<D>,
    /// Half the width of the widest.
    widest: f64,
}

impl<const D: usize> Strokes<D> {
    /// Strokes through some places, each with half the width there.
    fn new(places: Vec<(Vector<D>, f64)>, spacing: f64, domain: &Domain<D>) -> Self {
        let points: Vec<_> = places.iter().map(|p| p.0).collect();
        let widest = places.iter().map(|p| p.1).fold(0.0, f64::max);
        Self { index: GridIndex::new(&points, spacing, domain), places, widest }
    }

    /// The strokes of an exemplar.
    pub(crate) fn of_exemplar(net: Option<&Net<D>>, library: &Library<D>) -> Self {
        let mut places = Vec::new();
        if let Some(net) = net {
            let radii = radii(net);
            for (n, node) in net.nodes.iter().enumerate() {
                let radius = radii[n];
                places.push((node.position, radius));
                for arm in node.arms.iter().filter(|arm| arm.to as usize > n) {
                    let offset = net.nodes[arm.to].position - node.position;
                    places.extend(between(node.position, offset).map(|p| (p, radius)));
                }
            }
        }
        Self::new(places, library.spacing, &Domain::Box(library.view.window))
    }

    /// The strokes of a page.
    pub(crate) fn of_page(state: &State<'_, D>) -> Self {
        let mut places = Vec::new();
        let radii = state.level.net.as_deref().map_or_else(Numbered::new, radii);
        for &s in state.living() {
            let Some(&radius) = state.node(s).and_then(|node| radii.get(node as usize)) else { continue };
            let p = state.sample(s).position;
            places.push((p, radius));
            for &o in state.links_of(s).iter().filter(|&&o| o > s) {
                places.extend(between(p, state.offset(s, o)).map(|p| (p, radius)));
            }
        }
        Self::new(places, state.library.spacing, state.domain())
    }

    /// Calls `visit(offset, radius)` for the places that come nearer than `gap` to `p`.
    pub(crate) fn near(&self, p: Vector<D>, gap: f64, mut visit: impl FnMut(Vector<D>, f64)) {
        if !self.places.is_empty() {
            self.index.within(p, gap + self.widest, |n, offset| visit(offset, self.places[n].1));
        }
    }

    /// Clear space between an element and the nearest stroke, at most `enough`.
    pub(crate) fn gap(&self, inks: &Inks<D>, pose: &Pose<D>, enough: f64) -> f64 {
        let mut gap = enough;
        self.near(pose.centre, inks.radius(pose) + enough, |offset, radius| {
            gap = gap.min(inks.distance(pose, offset) - radius);
        });
        gap
    }
}

/// Half the width of the stroke through each node.
fn radii<const D: usize>(net: &Net<D>) -> Numbered<f64> {
    let mut of_curve = BTreeMap::new();
    for line in &net.skeleton.lines {
        of_curve.entry(line.curve).or_insert(0.5 * line.width);
    }
    net.nodes.iter().map(|node| of_curve.get(&node.curve).copied().unwrap_or(0.0)).collect()
}

/// Places between the ends of an edge.
fn between<const D: usize>(p: Vector<D>, offset: Vector<D>) -> impl Iterator<Item = Vector<D>> {
    (1..PLACES).map(move |k| p + offset * (f64::from(k) / f64::from(PLACES)))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use arabesque_core::{Budget, Matrix};

    use super::*;
    use crate::evenness::{
        natural::Natural,
        tests::{sampled, squares},
    };

    /// Lines from side to side at some heights, ten units apart, half a unit to each side.
    fn lines(height: f64) -> Strokes<2> {
        let places =
            (0..12).flat_map(|row| (0..240).map(move |k| (f64::from(k) * 0.5, height + 10.0 * f64::from(row))));
        let places = places.map(|(x, y)| (Vector::xy(x, y), 0.5)).collect();
        Strokes::new(places, 10.0, &Domain::Box(squares().window))
    }

    fn natural(strokes: Strokes<2>) -> Natural {
        let exemplar = squares();
        let library = sampled(&exemplar).library;
        let inks = Inks::new(&exemplar, &library, 144, 10.0, &Budget::default()).unwrap();
        Natural::new(&exemplar, &library, &inks, strokes, &Budget::default()).unwrap().unwrap()
    }

    #[test]
    fn the_gap_is_from_outline_to_the_rim_of_the_stroke() {
        let exemplar = squares();
        let inks = Inks::new(&exemplar, &sampled(&exemplar).library, 144, 10.0, &Budget::default()).unwrap();
        let pose = |y: f64| Pose { source: 0, centre: Vector::xy(60.0, y), rotation: Matrix::identity(), scale: 1.0 };
        let strokes = lines(0.0);
        assert!((strokes.gap(&inks, &pose(35.0), 4.0) - 2.5).abs() < 0.1);
        assert!((strokes.gap(&inks, &pose(33.5), 4.0) - 1.0).abs() < 0.1);
        assert!(strokes.gap(&inks, &pose(31.0), 4.0) < 0.0);
        assert_eq!(strokes.gap(&inks, &pose(35.0), 2.0), 2.0);
    }

    #[test]
    fn what_stands_between_strokes_keeps_clear_of_them() {
        // Squares of 4 that are up to 0.6 off the middle between lines of 1.
        let clear = natural(lines(0.0)).clear(0).unwrap();
        assert!((1.8..2.3).contains(&clear), "{clear}");
    }

    #[test]
    fn what_touches_strokes_is_joined_to_them() {
        assert!(natural(lines(7.2)).clear(0).is_none());
    }
}
