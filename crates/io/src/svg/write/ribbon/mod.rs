//! Writing ribbons as SVG: pictures that stand once in `<defs>` and are shown through clips, or vector shapes.

pub(crate) mod areas;

use std::fmt::Write as _;

use arabesque_core::{Budget, Decimals, Result, Vector};

use crate::{
    svg::{
        drawing::Page,
        namespace::NAMESPACE,
        write::document::{DECLARATION, PREFIXES, Root, length_decimals, recipe_element},
    },
    text::xml::escape,
};

/// How far cells reach under their neighbours so that no gap shows between them, in pixels of the picture as shown.
const OVERLAP: f64 = 0.4;
/// A corner is never moved by more than this many times the overlap.
const MITRE: f64 = 3.0;

/// Work and bytes of the text of one cell: its clip, and its picture seen through that.
const CELL: u64 = 4_000;
const CELL_BYTES: usize = 400;

/// A polygon through which a picture is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Which picture.
    pub source: usize,
    /// The polygon, in user units.
    pub ring: Vec<Vector<2>>,
    /// From pixels of the picture to user units, as SVG's `matrix()` has it.
    pub matrix: [f64; 6],
}

/// What a ribbon looks like.
#[derive(Clone, Debug, PartialEq)]
pub enum Look {
    /// Cells of pictures.
    Cells(Vec<Cell>),
    /// Markup in user units.
    Markup(String),
}

/// A picture that is embedded.
#[derive(Clone, Debug, PartialEq)]
pub struct Embedded {
    /// Width and height, in pixels.
    pub size: [usize; 2],
    /// The bytes of a PNG file in base 64.
    pub data: String,
}

/// Everything that one SVG file of ribbons is made of.
#[derive(Clone, Debug)]
pub struct RibbonSheet<'a> {
    /// Page of the result.
    pub page: Page,
    /// The pictures that cells refer to.
    pub pictures: &'a [Embedded],
    /// The ribbons, each with its name.
    pub ribbons: &'a [(String, Look)],
    /// The recipe, as TOML.
    pub recipe: Option<&'a str>,
    /// What writing may use up.
    pub budget: &'a Budget,
}

/// Writes ribbons, one group each in one layer.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work or the memory is used up, [`arabesque_core::Error::Stopped`] when somebody asked to
/// stop.
pub fn write_ribbons(sheet: &RibbonSheet<'_>) -> Result<String> {
    let cells = sheet.ribbons.iter().map(|(_, look)| if let Look::Cells(cells) = look { cells.len() } else { 0 });
    let markup = sheet.ribbons.iter().map(|(_, look)| if let Look::Markup(text) = look { text.len() } else { 0 });
    let pictures: usize = sheet.pictures.iter().map(|p| p.data.len()).sum();
    let text = cells.sum::<usize>().saturating_mul(CELL_BYTES) + markup.sum::<usize>() + pictures;
    // The text doubles its room as it grows.
    let _held = sheet.budget.hold("the text of the ribbons", 2 * text)?;
    let size = sheet.page.view.size();
    let decimals = Decimals::for_extent(size[0].max(size[1]));
    let mut out = root(sheet, decimals);
    if let Some(recipe) = sheet.recipe {
        let declared = format!(" xmlns:arabesque=\"{NAMESPACE}\"");
        let _ = writeln!(out, "  <metadata>{}</metadata>", recipe_element(recipe, &declared));
    }
    definitions(&mut out, sheet, decimals)?;
    out.push_str("  <g inkscape:groupmode=\"layer\" inkscape:label=\"Arabesque output\">\n");
    let mut number = 0;
    for (name, look) in sheet.ribbons {
        let _ = writeln!(out, "    <g inkscape:label=\"{}\">", escape(name));
        match look {
            Look::Markup(markup) => out.push_str(markup),
            Look::Cells(cells) => {
                for cell in cells {
                    sheet.budget.spend(CELL)?;
                    push_cell(&mut out, number, cell, decimals);
                    number += 1;
                }
            }
        }
        out.push_str("    </g>\n");
    }
    out.push_str("  </g>\n</svg>\n");
    Ok(out)
}

/// The pictures, and the clips of all cells, numbered through all ribbons.
fn definitions(out: &mut String, sheet: &RibbonSheet<'_>, decimals: Decimals) -> Result<()> {
    out.push_str("  <defs>\n");
    for (k, picture) in sheet.pictures.iter().enumerate() {
        let [width, height] = picture.size;
        let _ = writeln!(
            out,
            "    <image id=\"exemplar-{k}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
             xlink:href=\"data:image/png;base64,{}\"/>",
            picture.data
        );
    }
    let cells = sheet.ribbons.iter().flat_map(|(_, look)| match look {
        Look::Cells(cells) => cells.as_slice(),
        Look::Markup(_) => &[],
    });
    for (k, cell) in cells.enumerate() {
        sheet.budget.spend(CELL)?;
        let [a, b, c, d, ..] = cell.matrix;
        let data = ring_text(&grown(&cell.ring, OVERLAP * (a * d - b * c).abs().sqrt()), decimals);
        let _ = writeln!(out, "    <clipPath id=\"cell-{k}\"><path d=\"{data}\"/></clipPath>");
    }
    out.push_str("  </defs>\n");
    Ok(())
}

/// A cell as its picture seen through its clip.
fn push_cell(out: &mut String, number: usize, cell: &Cell, decimals: Decimals) {
    let (source, matrix) = (cell.source, matrix_text(&cell.matrix, decimals));
    let _ = writeln!(
        out,
        "      <g clip-path=\"url(#cell-{number})\"><use xlink:href=\"#exemplar-{source}\" transform=\"{matrix}\"/></g>"
    );
}

fn root(sheet: &RibbonSheet<'_>, decimals: Decimals) -> String {
    let root = Root {
        page: sheet.page,
        decimals,
        lengths: length_decimals(&sheet.page),
        prefixes: &PREFIXES[..2],
        attributes: " version=\"1.1\"",
    };
    format!("{DECLARATION}{}", root.start_tag())
}

fn matrix_text([a, b, c, d, e, f]: &[f64; 6], decimals: Decimals) -> String {
    let linear = [a, b, c, d].map(|v| decimals.plus(3).format(*v)).join(" ");
    format!("matrix({linear} {} {})", decimals.plus(1).format(*e), decimals.plus(1).format(*f))
}

fn ring_text(ring: &[Vector<2>], d: Decimals) -> String {
    let points: Vec<String> = ring.iter().map(|p| format!("{} {}", d.format(p[0]), d.format(p[1]))).collect();
    format!("M{}Z", points.join("L"))
}

/// A convex polygon with every side moved outwards by `distance`.
fn grown(ring: &[Vector<2>], distance: f64) -> Vec<Vector<2>> {
    let n = ring.len();
    let twice_area: f64 = (0..n).map(|k| ring[k].cross(ring[(k + 1) % n])).sum();
    let normal = |k: usize| {
        let along = ring[(k + 1) % n] - ring[k];
        let length = along.norm();
        let outwards = Vector::xy(along[1], -along[0]) * twice_area.signum();
        if length > 1e-9 { outwards * (1.0 / length) } else { Vector::ZERO }
    };
    (0..n)
        .map(|k| {
            let (a, b) = (normal((k + n - 1) % n), normal(k));
            let sum = a + b;
            let spread = (1.0 + a.dot(b)).max(1e-9);
            let step = sum * (distance / spread);
            let length = step.norm();
            let most = MITRE * distance;
            ring[k] + if length > most { step * (most / length) } else { step }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use arabesque_core::Bounds;

    use super::*;
    use crate::{svg::write::document::recipe_of, text::unit::Unit};

    #[test]
    fn sides_move_outwards_whatever_the_direction() {
        let mut square: Vec<_> =
            [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(|(x, y)| Vector::xy(x, y)).to_vec();
        for _ in 0..2 {
            let bounds = Bounds::around(grown(&square, 0.5));
            assert!((bounds.size() - Vector::splat(11.0)).norm() < 1e-9 && (bounds.min[0] + 0.5).abs() < 1e-9);
            square.reverse();
        }
    }

    #[test]
    fn a_picture_stands_once_and_is_shown_often() {
        let ring = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)].map(|(x, y)| Vector::xy(x, y)).to_vec();
        let cell = Cell { source: 0, ring, matrix: [1.0, 0.0, 0.0, 1.0, 5.0, 6.0] };
        let page = Page { view: Bounds::new(Vector::ZERO, Vector::xy(30.0, 20.0)), unit: Unit::Mm, unit_per_user: 1.0 };
        let text = write_ribbons(&RibbonSheet {
            page,
            pictures: &[Embedded { size: [2, 2], data: "AAAA".into() }],
            ribbons: &[("c.svg: path \"p\"".into(), Look::Cells(vec![cell.clone(), cell]))],
            recipe: Some("seed = 1 # <&>\n"),
            budget: &Budget::default(),
        })
        .unwrap();
        assert_eq!((text.matches("AAAA").count(), text.matches("<use").count()), (1, 2));
        assert!(text.contains("width=\"30mm\"") && text.contains("viewBox=\"0 0 30 20\""));
        assert_eq!(recipe_of(&text).unwrap(), "seed = 1 # <&>\n");
    }
}
