//! Areas that lie over one another in turn, such as a stack of waves in two colours: no order of layers paints them, but
//! what is seen of each does not depend on one.

use arabesque_core::{Area, Budget, Outline, Result};

/// Areas overlap when they have more than this share of the smaller one in common.
const OVERLAP: f64 = 1e-3;

/// Work for two areas that are compared.
const PAIR: u64 = 20;

/// Takes from each area what others above it hide, where areas of two styles cover one another both ways.
///
/// # Errors
/// As [`Outline::try_union`].
pub(crate) fn keep_visible(areas: &mut [Area<2>], is_opaque: &dyn Fn(usize) -> bool, budget: &Budget) -> Result<()> {
    let mut above: Vec<(usize, usize)> = Vec::new();
    budget.spend(PAIR * (areas.len() as u64).pow(2))?;
    for (i, low) in areas.iter().enumerate() {
        for (j, high) in areas.iter().enumerate().skip(i + 1) {
            if low.style == high.style || !low.outline.bounds().intersects(&high.outline.bounds()) {
                continue;
            }
            let common = low.outline.try_intersection(&high.outline, budget)?.area();
            if common > OVERLAP * low.outline.area().min(high.outline.area()) {
                above.push((i, j));
            }
        }
    }
    let styles = |&(i, j): &(usize, usize)| (areas[i].style, areas[j].style);
    let both_ways = above.iter().map(styles).any(|(a, b)| above.iter().map(styles).any(|pair| pair == (b, a)));
    if !both_ways {
        return Ok(());
    }
    let whole: Vec<Outline<2>> = areas.iter().map(|area| area.outline.clone()).collect();
    for (i, area) in areas.iter_mut().enumerate() {
        for (j, over) in whole.iter().enumerate().skip(i + 1).filter(|(j, _)| is_opaque(*j)) {
            if over.bounds().intersects(&area.outline.bounds()) {
                budget.check()?;
                area.outline = area.outline.try_difference(over, budget)?;
            }
            debug_assert!(j > i, "only what comes later lies above");
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use arabesque_core::Vector;

    use super::*;

    /// A band over the whole width from `top` down to the bottom of a page of 10 by 10.
    fn down_from(top: f64, style: usize) -> Area<2> {
        let corners = [(0.0, top), (10.0, top), (10.0, 10.0), (0.0, 10.0)];
        let ring = corners.iter().map(|&(x, y)| Vector::xy(x, y)).collect();
        Area { outline: Outline { rings: vec![ring] }, style, colour: [0.0; 3] }
    }

    #[test]
    fn of_a_stack_in_two_colours_each_keeps_what_is_seen_of_it() {
        let mut areas: Vec<_> = (0..5).map(|k| down_from(2.0 * k as f64, k % 2)).collect();
        keep_visible(&mut areas, &|_| true, &Budget::default()).unwrap();
        for area in &areas {
            assert!((area.outline.area() - 20.0).abs() < 1e-3, "{}", area.outline.area());
        }
    }

    #[test]
    fn layers_and_what_shows_through_stay_whole() {
        let mut layers = vec![down_from(0.0, 0), down_from(5.0, 1)];
        keep_visible(&mut layers, &|_| true, &Budget::default()).unwrap();
        assert_eq!(layers[0].outline.area(), 100.0);
        let mut clear: Vec<_> = (0..3).map(|k| down_from(2.0 * k as f64, k % 2)).collect();
        keep_visible(&mut clear, &|_| false, &Budget::default()).unwrap();
        assert_eq!(clear[0].outline.area(), 100.0);
    }
}
