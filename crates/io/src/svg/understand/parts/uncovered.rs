//! Stacks: fills painted over one another, each closed beyond the page, such as waves down to the bottom of the sea, or below
//! the next ones, such as rows of scallops. What is seen of each is the band between its edge and that of the next.

use std::rc::Rc;

use arabesque_core::{Bounds, Outline, Result, Vector};

use crate::svg::{
    shape::painted_area::Painter,
    understand::{
        item::{Item, Kind},
        parts::hidden::is_opaque,
    },
};

/// Fewest fills of a stack.
const FEWEST: usize = 3;

/// Share of a fill that lies over the one before it in a stack, and of all of them for which that holds.
const OVER: (f64, f64) = (0.2, 0.8);

/// Share of the frame above the first fill of a stack that may be left out of the frame, and below which it is nothing.
const BARE: (f64, f64) = (0.5, 1e-5);

/// Work for each item below a stack.
const ITEM: u64 = 500;

/// Notes what hides the fills of a stack, and the strokes among them. Returns the frame without what lies beyond the first
/// of them, where the pattern is not seen to go on.
///
/// # Errors
/// As [`Outline::try_union`].
pub(crate) fn uncover(items: &mut [Item], painter: &Painter<'_, '_>, frame: &Bounds<2>) -> Result<Bounds<2>> {
    let budget = painter.source.budget;
    let page = rectangle(frame);
    let mut areas: Vec<(usize, Outline<2>)> = Vec::new();
    for (i, item) in items.iter().enumerate().filter(|(_, item)| item.kind == Kind::Area && is_opaque(item)) {
        areas.push((i, item.fine_outline(painter)?));
    }
    if areas.len() < FEWEST {
        return Ok(*frame);
    }
    let (mut nested, mut pairs) = (0_usize, 0_usize);
    for pair in areas.windows(2) {
        let upper = pair[1].1.try_intersection(&page, budget)?;
        let (common, whole) = (upper.try_intersection(&pair[0].1, budget)?.area(), upper.area());
        if whole > 0.0 {
            pairs += 1;
            nested += usize::from(common >= OVER.0 * whole);
        }
    }
    if pairs + 1 < FEWEST || (nested as f64) < OVER.1 * pairs as f64 {
        return Ok(*frame);
    }
    let mut over = Outline::default();
    let mut hidden: Option<Rc<Outline<2>>> = None;
    for (i, item) in items.iter_mut().enumerate().rev() {
        budget.spend(ITEM)?;
        if matches!(item.kind, Kind::Area | Kind::Curve)
            && let Some(hidden) = &hidden
        {
            let whole = if item.kind == Kind::Area { item.fine_outline(painter)? } else { item.outline.clone() };
            item.outline = whole.try_difference(hidden, budget)?;
            item.hidden = Some(Rc::clone(hidden));
        }
        if let Some((_, outline)) = areas.pop_if(|(which, _)| *which == i) {
            let rings: Vec<_> = over.rings.iter().chain(&outline.rings).cloned().collect();
            over = Outline::try_union(&rings, arabesque_core::FillRule::NonZero, budget)?;
            hidden = Some(Rc::new(over.clone()));
        }
    }
    let bare = page.try_difference(&over, budget)?;
    let has_elements = items.iter().any(|item| matches!(item.kind, Kind::Element | Kind::Large));
    Ok(if has_elements { *frame } else { without(frame, &bare) })
}

/// A frame without what lies bare along one of its sides.
fn without(frame: &Bounds<2>, bare: &Outline<2>) -> Bounds<2> {
    if bare.area() <= BARE.1 * frame.measure() {
        return *frame;
    }
    let (extent, size) = (bare.bounds(), frame.size());
    for k in 0..2 {
        let near = BARE.1 * size[k];
        let (at_low, at_high) = (extent.min[k] <= frame.min[k] + near, extent.max[k] >= frame.max[k] - near);
        let (mut low, mut high) = (*frame, *frame);
        low.min[k] = extent.max[k];
        high.max[k] = extent.min[k];
        if at_low && !at_high && low.size()[k] >= (1.0 - BARE.0) * size[k] {
            return low;
        }
        if at_high && !at_low && high.size()[k] >= (1.0 - BARE.0) * size[k] {
            return high;
        }
    }
    *frame
}

fn rectangle(b: &Bounds<2>) -> Outline<2> {
    let (a, c) = (b.min, b.max);
    Outline { rings: vec![vec![a, Vector::xy(c[0], a[1]), c, Vector::xy(a[0], c[1])]] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page() -> Bounds<2> {
        Bounds::new(Vector::ZERO, Vector::xy(100.0, 80.0))
    }

    fn bare(min: (f64, f64), max: (f64, f64)) -> Outline<2> {
        rectangle(&Bounds::new(Vector::xy(min.0, min.1), Vector::xy(max.0, max.1)))
    }

    #[test]
    fn the_frame_begins_where_all_of_it_is_covered() {
        let below = without(&page(), &bare((0.0, 0.0), (100.0, 12.0)));
        assert_eq!((below.min, below.max), (Vector::xy(0.0, 12.0), Vector::xy(100.0, 80.0)));
        let left = without(&page(), &bare((90.0, 0.0), (100.0, 80.0)));
        assert_eq!((left.min, left.max), (Vector::ZERO, Vector::xy(90.0, 80.0)));
    }

    #[test]
    fn a_bare_middle_or_most_of_the_page_stays() {
        assert_eq!(without(&page(), &bare((20.0, 20.0), (40.0, 40.0))), page());
        assert_eq!(without(&page(), &bare((0.0, 0.0), (100.0, 60.0))), page());
        assert_eq!(without(&page(), &Outline::default()), page());
    }
}
