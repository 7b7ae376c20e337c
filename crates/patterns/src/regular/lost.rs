//! What the frame has cut of an exemplar that repeats, and the repeat does not show: something large that is whole nowhere, or part of
//! an area elsewhere.

use arabesque_core::{Bounds, Budget, Element, Exemplar, Result, Role, Vector};

use crate::{
    regular::{areas::CellArea, joints::Cell},
    repeat::{
        Repeat,
        marks::place_of,
        orbits::{Instance, Orbit},
    },
};

/// Places that are looked at in something that is cut, along each side of the box around it.
const PLACES: usize = 10;

/// Share of these that the repeat may leave empty: rounding, and an unsteady hand.
const EMPTY: f64 = 0.15;

/// Colours are one that differ by less than this in each channel.
const ALIKE: f64 = 0.02;

/// Elements of an orbit that are looked at: they lie alike.
const FIRST: usize = 4;

/// Work for an edge that is looked at, and for an orbit.
const LOOK: (u64, u64) = (2, 20);

/// The elements that the frame cuts and of which the repeat shows nothing, or a part: neither elements at the places of the `orbits` nor
/// the areas of the `cell`, painted alike, cover them.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn lost(
    exemplar: &Exemplar<2>,
    repeat: &Repeat,
    (orbits, cell): (&[Orbit], Option<&Cell>),
    budget: &Budget,
) -> Result<Vec<usize>> {
    let shown = Shown { exemplar, repeat, orbits, cell };
    let mut lost = Vec::new();
    for (e, element) in exemplar.elements.iter().enumerate().filter(|(_, e)| e.role == Role::Context) {
        let places = shown.places_in(element, budget)?;
        let (mut empty, mut cover) = (0, Cover::Nothing);
        for &place in &places {
            cover = shown.cover(place, &element.colour, cover, budget)?;
            empty += usize::from(cover == Cover::Nothing);
            if empty as f64 > EMPTY * places.len() as f64 {
                lost.push(e);
                break;
            }
        }
    }
    Ok(lost)
}

/// What the repeat shows at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cover {
    Nothing,
    Area,
    Orbit(usize),
}

fn is_alike(a: &[f64; 3], b: &[f64; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < ALIKE)
}

struct Shown<'a> {
    exemplar: &'a Exemplar<2>,
    repeat: &'a Repeat,
    orbits: &'a [Orbit],
    cell: Option<&'a Cell>,
}

impl Shown<'_> {
    /// Places in an element that the frame shows.
    fn places_in(&self, element: &Element<2>, budget: &Budget) -> Result<Vec<Vector<2>>> {
        let (extent, window) = (element.outline.bounds(), self.exemplar.window);
        let seen = Bounds::new(extent.min.zip(window.min, f64::max), extent.max.zip(window.max, f64::min));
        if seen.is_empty() {
            return Ok(Vec::new());
        }
        budget.spend(LOOK.0 * (PLACES * PLACES * element.outline.points().count()) as u64)?;
        let share = |k: usize| (k as f64 + 0.5) / PLACES as f64;
        let at =
            |k: usize| seen.min + Vector::xy(share(k % PLACES) * seen.size()[0], share(k / PLACES) * seen.size()[1]);
        Ok((0..PLACES * PLACES).map(at).filter(|&p| element.outline.contains(p)).collect())
    }

    /// What covers a place in this colour; what covered the `last` one is looked at first.
    fn cover(&self, place: Vector<2>, colour: &[f64; 3], last: Cover, budget: &Budget) -> Result<Cover> {
        if let Cover::Orbit(o) = last
            && self.is_of(place, o, colour, budget)?
        {
            return Ok(last);
        }
        let areas = self.cell.map_or(&[][..], |cell| &cell.areas);
        for area in areas.iter().filter(|area| is_alike(&self.exemplar.areas[area.source].colour, colour)) {
            if self.lies_in_area(place, area, budget)? {
                return Ok(Cover::Area);
            }
        }
        for o in 0..self.orbits.len() {
            if self.is_of(place, o, colour, budget)? {
                return Ok(Cover::Orbit(o));
            }
        }
        Ok(Cover::Nothing)
    }

    /// Whether an element of this colour of an orbit covers a place.
    fn is_of(&self, place: Vector<2>, orbit: usize, colour: &[f64; 3], budget: &Budget) -> Result<bool> {
        budget.spend(LOOK.1)?;
        let orbit = &self.orbits[orbit];
        for instance in orbit.instances.iter().take(FIRST) {
            let element = &self.exemplar.elements[instance.element as usize];
            if is_alike(&element.colour, colour) && self.lies_in(place, orbit, instance, budget)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn lies_in_area(&self, place: Vector<2>, area: &CellArea, budget: &Budget) -> Result<bool> {
        let extent = Bounds::around(area.rings.iter().flatten().copied());
        self.any_node(place, &extent, |place| {
            budget.spend(LOOK.0 * area.rings.iter().map(Vec::len).sum::<usize>() as u64)?;
            Ok(area.contains(place))
        })
    }

    /// Whether a place lies in the element of an instance at any node.
    fn lies_in(&self, place: Vector<2>, orbit: &Orbit, instance: &Instance, budget: &Budget) -> Result<bool> {
        let element = &self.exemplar.elements[instance.element as usize];
        let moved = place - orbit.base + place_of(element, self.repeat.anchor);
        self.any_node(moved, &element.outline.bounds(), |place| {
            budget.spend(LOOK.0 * element.outline.points().count() as u64)?;
            Ok(element.outline.contains(place))
        })
    }

    /// Whether something holds of a place moved to any node that takes it into a box.
    fn any_node(
        &self,
        place: Vector<2>,
        extent: &Bounds<2>,
        holds: impl Fn(Vector<2>) -> Result<bool>,
    ) -> Result<bool> {
        if extent.is_empty() {
            return Ok(false);
        }
        let [rows, columns] = self.repeat.lattice.nodes_in(place, extent);
        for i in rows {
            for j in columns.clone() {
                let moved = place + self.repeat.lattice.at([i, j]);
                if extent.contains(moved) && holds(moved)? {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use arabesque_core::{Class, Outline, Similarity};

    use crate::regular::Regular;

    use super::*;

    fn square(x: f64, y: f64, side: f64, role: Role) -> Element<2> {
        let corners = [(x, y), (x + side, y), (x + side, y + side), (x, y + side)];
        let outline = Outline { rings: vec![corners.iter().map(|&(x, y)| Vector::xy(x, y)).collect()] };
        let centre = outline.centroid().unwrap();
        let (colour, lean) = ([0.0; 3], [Vector::ZERO; 3]);
        Element { class: 0, centre, pose: Similarity::shift(centre), outline, colour, lean, role }
    }

    /// How many of the elements that the frame cuts are lost, beside squares at all corners of a lattice.
    fn lost_of(cut: Vec<Element<2>>) -> usize {
        let at = |k: u32| square(8.0 + 20.0 * f64::from(k % 5), 8.0 + 20.0 * f64::from(k / 5), 8.0, Role::Source);
        let elements = (0..25).map(at).chain(cut).collect();
        let window = Bounds::new(Vector::ZERO, Vector::xy(112.0, 112.0));
        let exemplar = Exemplar::new("t", elements, vec![Class { name: "a".into() }], window).unwrap();
        Regular::new(&exemplar, &Budget::default()).unwrap().unwrap().lost()
    }

    #[test]
    fn what_the_frame_cuts_is_lost_unless_the_repeat_shows_it_whole() {
        assert_eq!(lost_of(vec![square(108.0, 28.0, 8.0, Role::Context)]), 0, "at its place");
        assert_eq!(lost_of(vec![square(-12.0, 28.0, 8.0, Role::Context)]), 0, "beyond the frame");
        assert_eq!(lost_of(vec![square(98.0, 28.0, 8.0, Role::Context)]), 1, "between its places");
        let mut red = square(8.0, 108.0, 8.0, Role::Context);
        red.colour = [1.0, 0.0, 0.0];
        assert_eq!(lost_of(vec![square(8.0, 98.0, 17.0, Role::Context), red]), 2, "larger, or of another colour");
    }
}
