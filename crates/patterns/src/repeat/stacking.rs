//! Which elements lie on which: a translation that takes every element to one like it, but what lies below to what lies
//! above, does not take the drawing to itself.

use arabesque_core::{Bounds, Budget, Exemplar, Result, Role, Vector};

use crate::repeat::marks::Marks;

/// Pairs that are looked at, the nearest to the middle of the frame.
const MOST: usize = 400;

/// Elements with more of them than this are not looked through for pairs.
const ELEMENTS: usize = 6000;

/// Overlaps below this share of the smaller element do not show which lies on top.
const VISIBLE: f64 = 0.01;

/// Fewest pairs that tell something, and the share of them that must lie the same way round.
const AGREE: (usize, f64) = (4, 0.95);

/// Work for two boxes, for a pair of outlines, and for looking up a partner.
const WORK: (u64, u64, u64) = (3, 500, 60);

/// Pairs of elements that overlap, the lower one first.
#[derive(Clone, Debug)]
pub(crate) struct Stacking {
    pairs: Vec<[usize; 2]>,
}

impl Stacking {
    /// The overlaps of an exemplar; `None` where there are too few to tell anything.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Self>> {
        let mut boxes: Vec<(usize, Bounds<2>)> =
            exemplar.elements.iter().map(|e| e.outline.bounds()).enumerate().filter(|(_, b)| !b.is_empty()).collect();
        boxes.retain(|(i, _)| exemplar.elements[*i].role == Role::Source);
        if boxes.len() > ELEMENTS {
            return Ok(None);
        }
        boxes.sort_by(|a, b| a.1.min[0].total_cmp(&b.1.min[0]).then(a.0.cmp(&b.0)));
        let centre = exemplar.window.centre();
        let mut near: Vec<(f64, [usize; 2])> = Vec::new();
        let mut meter = budget.meter();
        for (k, (i, a)) in boxes.iter().enumerate() {
            for (j, b) in boxes[k + 1..].iter().take_while(|(_, b)| b.min[0] < a.max[0]) {
                meter.spend(WORK.0)?;
                let common = Bounds::new(a.min.zip(b.min, f64::max), a.max.zip(b.max, f64::min));
                let smaller = a.measure().min(b.measure());
                if !common.is_empty() && common.measure() > VISIBLE * smaller {
                    near.push(((common.centre() - centre).norm2(), [*i.min(j), *i.max(j)]));
                }
            }
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut pairs = Vec::new();
        for (_, [i, j]) in near.into_iter().take(MOST) {
            budget.spend(WORK.1)?;
            let (a, b) = (&exemplar.elements[i].outline, &exemplar.elements[j].outline);
            if a.try_intersection(b, budget)?.area() > VISIBLE * a.area().min(b.area()) {
                pairs.push([i, j]);
            }
        }
        Ok((pairs.len() >= AGREE.0).then_some(Self { pairs }))
    }

    /// Whether a translation takes what lies on top to what lies on top.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn supports(&self, marks: &Marks, by: Vector<2>, tolerance: f64, budget: &Budget) -> Result<bool> {
        let (mut seen, mut agree) = (0_usize, 0_usize);
        for pair in &self.pairs {
            budget.spend(WORK.2)?;
            // The marks of elements come first, in their order.
            let there = pair.map(|e| marks.all.get(e).and_then(|m| marks.find(m.place + by, m.kind, tolerance).0));
            if let [Some(low), Some(high)] = there {
                seen += 1;
                agree += usize::from(low < high);
            }
        }
        Ok(seen < AGREE.0 || agree as f64 >= AGREE.1 * seen as f64)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use arabesque_core::{Class, Element, Outline, Similarity};

    use super::*;
    use crate::repeat::find;

    /// Squares of 14 in rows of steps of 10, row over row, each row drawn from the right or from the left.
    fn rows(from_left: impl Fn(i32) -> bool) -> Exemplar<2> {
        let mut elements = Vec::new();
        for row in 0..8 {
            for k in 0..8 {
                let column = if from_left(row) { k } else { 7 - k };
                let corner = Vector::xy(1.0 + 10.0 * f64::from(column), 1.0 + 10.0 * f64::from(row));
                let ring = [(0.0, 0.0), (14.0, 0.0), (14.0, 14.0), (0.0, 14.0)].map(|(x, y)| corner + Vector::xy(x, y));
                let outline = Outline { rings: vec![ring.to_vec()] };
                let centre = outline.centroid().unwrap();
                let (pose, colour, lean) = (Similarity::shift(centre), [0.0; 3], [Vector::ZERO; 3]);
                elements.push(Element { class: 0, centre, pose, outline, colour, lean, role: Role::Source });
            }
        }
        let window = Bounds::new(Vector::ZERO, Vector::xy(86.0, 86.0));
        Exemplar::new("t", elements, vec![Class { name: "scale".into() }], window).unwrap()
    }

    fn cell(exemplar: &Exemplar<2>) -> f64 {
        find(exemplar, &Budget::default()).unwrap().unwrap().lattice.cell().round()
    }

    #[test]
    fn rows_that_are_painted_from_both_sides_in_turn_repeat_after_two() {
        assert_eq!(cell(&rows(|_| true)), 100.0);
        assert_eq!(cell(&rows(|row| row % 2 == 0)), 200.0);
    }
}
