//! What an exemplar repeats by, for people and machines.

use arabesque_core::{Budget, Exemplar, Matrix, Result, Vector};
use arabesque_io::svg::{Drawing, RepeatCell, with_cell};
use arabesque_patterns::{
    Known,
    repeat::{Explains, Extent, symmetry},
};
use serde::Serialize;

/// Digits of the lengths that are told.
const DIGITS: i32 = 6;

/// What an exemplar repeats by.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RepeatReport {
    /// `plane`, `frieze` (in one direction) or `stripes` (along which nothing changes).
    pub extent: &'static str,
    /// The two shortest translations, in user units; of a frieze the second is the height of its frame, of stripes it
    /// lies along them.
    pub vectors: [[f64; 2]; 2],
    /// Of a frieze or stripes, the one by which it repeats.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<[f64; 2]>,
    /// Area of the cell between them.
    pub cell: f64,
    /// Wallpaper or frieze group, such as `p4m`.
    pub symmetry: &'static str,
    /// What the group has beside translations, in words.
    pub symmetry_means: &'static str,
    /// `everything`, or `places`: where elements are, but not which ones.
    pub explains: &'static str,
    /// Share of what can be recognised that the translations take to others of its kind, in [0, 1].
    pub share: f64,
    /// Root mean square distance of elements from where the repeat has them, in user units.
    pub jitter: f64,
    /// Width and height of the smallest seamless tile, in user units; `None` where no vectors lie along the axes.
    pub smallest_tile: Option<[f64; 2]>,
    /// Width and height of the tile that `--tile auto` makes.
    pub suggested_tile: Option<[f64; 2]>,
}

impl RepeatReport {
    /// The repeat of an exemplar; `None` where it is treated as irregular.
    pub(super) fn of(exemplar: &Exemplar<2>, known: Known, budget: &Budget) -> Result<Option<Self>> {
        // What can be neither repeated nor read is told by a run, not here.
        let found = known.or_find(exemplar, budget)?;
        let Some(repeat) = found.as_ref().map(|found| found.repeat()) else { return Ok(None) };
        let group = symmetry(exemplar, repeat, budget)?;
        let extent = match repeat.extent {
            Extent::Plane => "plane",
            Extent::Frieze => "frieze",
            Extent::Stripes(_) => "stripes",
        };
        let longer = repeat.lattice.vectors.map(|v| v.norm()).into_iter().fold(f64::MIN_POSITIVE, f64::max);
        let rounded = |length: f64| rounded(length, longer);
        let tile = repeat.seamless_tile(exemplar.window.size(), &Matrix::identity(), 1.0);
        Ok(Some(Self {
            extent,
            vectors: repeat.lattice.vectors.map(|v| v.0.map(rounded)),
            step: repeat.step(&exemplar.window).map(|v| v.0.map(rounded)),
            cell: rounded(repeat.lattice.cell()),
            symmetry: group.name(),
            symmetry_means: group.meaning(),
            explains: if repeat.explains == Explains::Places { "places" } else { "everything" },
            share: repeat.share,
            jitter: rounded(repeat.jitter),
            smallest_tile: repeat.smallest_tile().map(|sides| sides.map(rounded)),
            suggested_tile: tile.map(|sides| sides.map(rounded)),
        }))
    }

    /// The same in words, a few lines.
    pub fn lines(&self) -> Vec<String> {
        let vector = |[x, y]: [f64; 2]| format!("({x}, {y})");
        let [a, b] = self.vectors.map(vector);
        let vectors = match self.step.map(vector) {
            Some(step) if self.extent == "frieze" => format!("repeats as a frieze by {step}"),
            Some(step) => format!("repeats as stripes by {step}"),
            None => format!("repeats by {a} and {b}"),
        };
        let share = (100.0 * self.share).round();
        let explained = match self.explains {
            "places" => format!("{share} % of the places, with what lies there at random"),
            _ => format!("{share} % of what can be recognised"),
        };
        let tile = |sides: Option<[f64; 2]>| sides.map(|[w, h]| format!("{w}x{h}"));
        let mut lines = vec![
            format!("{vectors}; cell {}", self.cell),
            format!("symmetry {}: {}", self.symmetry, self.symmetry_means),
            format!("the repeat explains {explained}; jitter {}", self.jitter),
        ];
        lines.push(match (tile(self.smallest_tile), tile(self.suggested_tile)) {
            (Some(least), Some(suggested)) if least != suggested => {
                format!("smallest seamless tile {least}; --tile auto makes {suggested}")
            }
            (Some(least), _) => format!("smallest seamless tile {least}"),
            (None, _) => "no seamless tile: the repeat does not lie along the axes".into(),
        });
        lines
    }

    /// A picture of the exemplar with a cell over it.
    pub(super) fn drawn_over(&self, picture: String, drawing: &Drawing) -> String {
        let cell = RepeatCell::in_the_middle(self.vectors.map(Vector), &drawing.exemplar.window);
        with_cell(picture, &drawing.page, &cell)
    }
}

/// A length with as many digits as tell it beside another; what is left of nothing by the arithmetic is nothing.
fn rounded(length: f64, beside: f64) -> f64 {
    let digits = DIGITS - 1 - beside.max(length.abs()).log10().floor() as i32;
    let unit = 10_f64.powi(digits);
    if unit.is_finite() && unit > 0.0 { (length * unit).round() / unit + 0.0 } else { length }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_of_nothing_is_nothing() {
        assert_eq!(rounded(9.4e-8, 20.0), 0.0);
        assert_eq!(rounded(-1.5e-7, 20.0).to_string(), "0");
        assert_eq!(rounded(17.320_41, 30.0), 17.3204);
        assert_eq!(rounded(0.001_960_57, 20.0), 0.002);
        assert_eq!(rounded(0.0, 0.5), 0.0);
    }
}
