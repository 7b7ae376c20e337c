//! Filled areas as SVG paths, their borders with as few nodes as will do.

use std::fmt::Write as _;

use arabesque_core::{Budget, Decimals, Outline, Path, Result, Vector};

use crate::{svg::shape::simplify::simplified, text::path_data::path_data};

/// Work of one corner that is simplified and written, and bytes of it while that is done.
const CORNER: u64 = 2_000;
const BYTES: usize = 256;

/// An area filled with one colour.
#[derive(Clone, Debug)]
pub struct Filled<'a> {
    /// What is covered, in user units.
    pub outline: &'a Outline<2>,
    /// How far the written border may lie from that, in user units.
    pub tolerance: f64,
    /// The colour, as SVG has it.
    pub colour: &'a str,
    /// The opacity, in [0, 1].
    pub opacity: f64,
}

/// One `<path>` a line for each area of which anything can be seen, in the same order.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work or the memory is used up, [`arabesque_core::Error::Stopped`] when somebody asked to
/// stop.
pub fn areas_markup<'a>(
    areas: impl IntoIterator<Item = Filled<'a>>,
    decimals: Decimals,
    budget: &Budget,
) -> Result<String> {
    let mut out = String::new();
    for area in areas {
        let corners = area.outline.points().count();
        budget.spend(CORNER * corners as u64)?;
        let _held = budget.hold("the text of the ribbon", out.len() + corners * BYTES)?;
        let border = |ring: &Vec<Vector<2>>| path_data(&simplified(&closed(ring), area.tolerance), decimals);
        let data: String = area.outline.rings.iter().map(border).collect();
        if data.is_empty() {
            continue;
        }
        let opacity = if area.opacity < 1.0 { format!(" fill-opacity=\"{:.4}\"", area.opacity) } else { String::new() };
        let colour = area.colour;
        let _ = writeln!(out, "      <path fill=\"{colour}\"{opacity} fill-rule=\"evenodd\" d=\"{data}\"/>");
    }
    Ok(out)
}

fn closed(ring: &[Vector<2>]) -> Path<2> {
    let points: Vec<_> = ring.iter().chain(ring.first()).copied().collect();
    Path { closed: true, ..Path::polyline(&points) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_have_few_nodes_and_keep_their_order() {
        let side = |k: i32| f64::from(k);
        let bar: Vec<_> = (0..=60).map(|k| (side(k), 8.0)).chain((0..=60).rev().map(|k| (side(k), 12.0))).collect();
        let outline =
            |ring: &[(f64, f64)]| Outline { rings: vec![ring.iter().map(|&(x, y)| Vector::xy(x, y)).collect()] };
        let (bar, dot) = (outline(&bar), outline(&[(1.0, 1.0), (3.0, 1.0), (3.0, 3.0)]));
        let filled = |outline, colour, opacity| Filled { outline, tolerance: 0.1, colour, opacity };
        let none = Outline::default();
        let areas = [filled(&bar, "#0000ff", 1.0), filled(&none, "green", 1.0), filled(&dot, "red", 0.5)];
        let text = areas_markup(areas, Decimals::for_extent(100.0), &Budget::default()).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        assert!(lines[0].contains("#0000ff") && lines[1].contains("fill=\"red\" fill-opacity=\"0.5000\""), "{text}");
        assert!(lines[0].len() < 140, "{text}");
    }
}
