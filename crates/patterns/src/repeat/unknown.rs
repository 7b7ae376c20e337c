//! Where an exemplar does not show what it would.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Element, Exemplar, Role, Vector};

/// What is this near to the frame touches it, as a share of its diagonal.
const TOUCH: f64 = 1e-4;

/// Cells of the raster along each side.
const CELLS: usize = 512;

/// Whether a box touches a side of the frame from inside, or reaches just over it.
pub(crate) fn touches(extent: &Bounds<2>, window: &Bounds<2>) -> bool {
    touched(extent, window) != [false; 2]
}

/// The same for the sides across each axis.
fn touched(extent: &Bounds<2>, window: &Bounds<2>) -> [bool; 2] {
    let near = TOUCH * window.size().norm();
    let is_at = |a: f64, b: f64| (a - b).abs() <= near;
    [0, 1].map(|k| is_at(extent.min[k], window.min[k]) || is_at(extent.max[k], window.max[k]))
}

/// Which elements the frame may have cut: those that touch a side of it, unless one of the same look lies away from the sides across
/// that axis. `looks`: a number for each element.
pub(crate) fn may_be_cut(exemplar: &Exemplar<2>, looks: &[u32]) -> Vec<bool> {
    let sides = |e: &Element<2>| touched(&e.outline.bounds(), &exemplar.window);
    let mut is_whole: BTreeMap<u32, [bool; 2]> = BTreeMap::new();
    for (element, look) in exemplar.elements.iter().zip(looks).filter(|(e, _)| e.role == Role::Source) {
        let (is_whole, touched) = (is_whole.entry(*look).or_default(), sides(element));
        (0..2).for_each(|k| is_whole[k] |= !touched[k]);
    }
    let may_be = |(element, look): (&Element<2>, &u32)| {
        let (touched, is_whole) = (sides(element), is_whole.get(look).copied().unwrap_or_default());
        element.role == Role::Context || (0..2).any(|k| touched[k] && !is_whole[k])
    };
    exemplar.elements.iter().zip(looks).map(may_be).collect()
}

/// The box around everything, where nothing reaches the frame: what lies beyond it is a margin. `None` where something does.
pub(crate) fn drawn(exemplar: &Exemplar<2>) -> Option<Bounds<2>> {
    let reaches = |e: &Element<2>| e.role == Role::Context || touches(&e.outline.bounds(), &exemplar.window);
    if exemplar.elements.iter().any(reaches) {
        return None;
    }
    let extents = exemplar
        .elements
        .iter()
        .map(|e| if e.outline.rings.is_empty() { Bounds::around([e.centre]) } else { e.outline.bounds() });
    Some(Bounds::around(extents.flat_map(|b| [b.min, b.max]))).filter(|b| !b.is_empty())
}

/// The boxes around elements that the frame has cut, which may be lines elsewhere, and the hole, as a raster over the
/// frame: however many there are, a place is looked up at once.
#[derive(Clone, Debug)]
pub(crate) struct Unknown {
    window: Bounds<2>,
    hole: Option<Bounds<2>>,
    is_cut: Vec<bool>,
}

impl Unknown {
    pub(crate) fn of(exemplar: &Exemplar<2>) -> Self {
        let window = exemplar.window;
        let near = TOUCH * window.size().norm();
        let boxes = exemplar.elements.iter().map(|e| (e.role, e.outline.bounds()));
        let cut = |(role, b): &(Role, Bounds<2>)| *role == Role::Context || touches(b, &window);
        // Where boxes begin and end along each axis; summed up, how many of them lie over a cell.
        let wide = CELLS + 1;
        let mut count = vec![0_i64; wide * wide];
        let mut unknown = Self { window, hole: exemplar.hole, is_cut: Vec::new() };
        let hidden = boxes.filter(cut).map(|(_, b)| b).chain(exemplar.hole);
        for b in hidden.filter(|b| !b.is_empty() && b.intersects(&window)) {
            let (low, high) = (unknown.cell(b.min - Vector::splat(near)), unknown.cell(b.max + Vector::splat(near)));
            count[low[1] * wide + low[0]] += 1;
            count[low[1] * wide + high[0] + 1] -= 1;
            count[(high[1] + 1) * wide + low[0]] -= 1;
            count[(high[1] + 1) * wide + high[0] + 1] += 1;
        }
        for k in 0..wide * wide {
            let (x, y) = (k % wide, k / wide);
            let at = |x: usize, y: usize| count[y * wide + x];
            let left = if x > 0 { at(x - 1, y) } else { 0 };
            let above = if y > 0 { at(x, y - 1) } else { 0 };
            let both = if x > 0 && y > 0 { at(x - 1, y - 1) } else { 0 };
            count[k] += left + above - both;
        }
        unknown.is_cut = count.into_iter().map(|n| n > 0).collect();
        unknown
    }

    /// Column and row of a place; of one beyond the frame, of the nearest cell.
    fn cell(&self, place: Vector<2>) -> [usize; 2] {
        let size = self.window.size();
        [0, 1]
            .map(|k| ((place[k] - self.window.min[k]) / size[k] * CELLS as f64).clamp(0.0, CELLS as f64 - 1.0) as usize)
    }

    /// Whether a place lies in the hole, where what there is is no example.
    pub(crate) fn is_in_hole(&self, place: Vector<2>) -> bool {
        self.hole.is_some_and(|hole| hole.contains(place))
    }

    /// Whether something with this box around it may be missing because of the hole.
    pub(crate) fn hides(&self, extent: &Bounds<2>) -> bool {
        self.hole.is_some_and(|hole| hole.intersects(extent))
    }

    /// Whether a place in the frame lies in one of the boxes, or in the same cell of the raster as one.
    pub(crate) fn contains(&self, place: Vector<2>) -> bool {
        let [x, y] = self.cell(place);
        self.is_cut[y * (CELLS + 1) + x]
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use arabesque_core::{Class, Outline, Similarity};

    use super::*;

    /// Elements with boxes at these places, of a side of 10, in a frame of 100.
    fn squares(places: &[(f64, f64)]) -> Exemplar<2> {
        let of = |&(x, y): &(f64, f64)| {
            let ring = [(x, y), (x + 10.0, y), (x + 10.0, y + 10.0), (x, y + 10.0)].map(|(x, y)| Vector::xy(x, y));
            let outline = Outline { rings: vec![ring.to_vec()] };
            let (centre, lean, role) = (Vector::xy(x + 5.0, y + 5.0), [Vector::ZERO; 3], Role::Source);
            Element { class: 0, centre, pose: Similarity::shift(centre), outline, colour: [0.0; 3], lean, role }
        };
        let window = Bounds::new(Vector::ZERO, Vector::xy(100.0, 100.0));
        let elements = places.iter().map(of).collect();
        Exemplar::new("t", elements, vec![Class { name: "a".into() }], window).unwrap()
    }

    #[test]
    fn what_looks_like_something_away_from_the_frame_is_not_cut() {
        let places = [(0.0, 40.0), (40.0, 0.0), (90.0, 90.0), (50.0, 50.0)];
        assert_eq!(may_be_cut(&squares(&places), &[0, 0, 1, 2]), [false, false, true, false], "one at either side");
        assert_eq!(may_be_cut(&squares(&places), &[0, 1, 2, 2]), [true, true, false, false]);
        assert_eq!(may_be_cut(&squares(&[(0.0, 0.0), (0.0, 60.0)]), &[0, 0]), [true, true], "halves at one side");
    }

    #[test]
    fn only_what_lies_in_boxes_of_cut_elements_is_unknown() {
        let of = |min: (f64, f64), max: (f64, f64), role| {
            let ring = [(min.0, min.1), (max.0, min.1), (max.0, max.1), (min.0, max.1)].map(|(x, y)| Vector::xy(x, y));
            let outline = Outline { rings: vec![ring.to_vec()] };
            let centre = outline.centroid().unwrap();
            let pose = Similarity::shift(centre);
            Element { class: 0, centre, pose, outline, colour: [0.0; 3], lean: [Vector::ZERO; 3], role }
        };
        let elements = vec![
            of((0.0, 10.0), (20.0, 30.0), Role::Context),
            of((15.0, 15.0), (40.0, 35.0), Role::Context),
            of((60.0, 60.0), (70.0, 70.0), Role::Source),
            of((90.0, 50.0), (100.0, 55.0), Role::Source),
        ];
        let window = Bounds::new(Vector::ZERO, Vector::xy(100.0, 100.0));
        let exemplar = Exemplar::new("t", elements, vec![Class { name: "a".into() }], window).unwrap();
        let unknown = Unknown::of(&exemplar);
        for (x, y, expected) in [
            (10.0, 20.0, true),
            (18.0, 20.0, true),
            (30.0, 30.0, true),
            (10.0, 34.0, false),
            (50.0, 20.0, false),
            (65.0, 65.0, false),
            (95.0, 52.0, true),
        ] {
            assert_eq!(unknown.contains(Vector::xy(x, y)), expected, "{x} {y}");
        }
    }
}
