//! JSON: the pieces of ribbons with their texture coordinates.

use arabesque_core::{Budget, Decimals, Patch, Result, Warning};
use serde::Serialize;

use crate::json::warning::{WarningRecord, warning_records};

/// Bytes of one piece and of one number of its shift, as records and as text.
const PIECE: usize = 1_600;
const NUMBER: usize = 80;
/// Work of one byte.
const BYTE: u64 = 4;

/// One ribbon.
#[derive(Clone, Debug)]
pub struct RibbonLine<'a, const D: usize> {
    /// What it lies along.
    pub name: &'a str,
    /// Whether the last piece is followed by the first.
    pub closed: bool,
    /// Cost, in 8-bit colour steps.
    pub cost: f64,
    /// What each piece shows, and how far down the right edge it takes its colours from, in exemplar pixels.
    pub pieces: Vec<(Patch<D>, &'a [f32])>,
}

/// Everything that one file says.
#[derive(Clone, Debug)]
pub struct Document<'a, const D: usize> {
    /// Name, width and height of each exemplar.
    pub exemplars: Vec<(&'a str, [usize; 2])>,
    /// The ribbons.
    pub ribbons: Vec<RibbonLine<'a, D>>,
    /// Least corner and size of the canvas.
    pub page: Option<[[f64; 2]; 2]>,
    /// Largest side of what is shown, which sets the number of digits.
    pub extent: f64,
    /// What the user should know.
    pub warnings: &'a [Warning],
    /// The recipe, as TOML.
    pub recipe: Option<&'a str>,
    /// What writing may use up.
    pub budget: &'a Budget,
}

#[derive(Serialize)]
struct File<'a> {
    generator: &'static str,
    version: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    page: Option<PageRecord>,
    exemplars: Vec<ExemplarRecord<'a>>,
    ribbons: Vec<RibbonRecord<'a>>,
    warnings: Vec<WarningRecord<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    recipe: Option<&'a str>,
}

#[derive(Serialize)]
struct PageRecord {
    min: [f64; 2],
    size: [f64; 2],
}

#[derive(Serialize)]
struct ExemplarRecord<'a> {
    path: &'a str,
    width: usize,
    height: usize,
}

#[derive(Serialize)]
struct RibbonRecord<'a> {
    along: &'a str,
    closed: bool,
    cost: f64,
    pieces: Vec<PieceRecord>,
}

#[derive(Serialize)]
struct PieceRecord {
    source: usize,
    corners: [Vec<f64>; 4],
    texture: [[f64; 2]; 4],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    shift: Vec<f32>,
}

/// Writes ribbons as one JSON object. Corners go top left, top right, bottom right, bottom left; `texture` has the same
/// corners in pixels of the exemplar.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work or the memory is used up, and [`arabesque_core::Error::Input`] when a number cannot be written, which no ribbon should hold.
pub fn write_ribbons<const D: usize>(document: &Document<'_, D>) -> Result<String> {
    let pieces = document.ribbons.iter().flat_map(|line| &line.pieces);
    let bytes = pieces.map(|(_, shift)| PIECE + NUMBER * shift.len()).sum::<usize>();
    document.budget.spend(BYTE * bytes as u64)?;
    let _held = document.budget.hold("the text of the pieces", bytes)?;
    let decimals = Decimals::for_extent(document.extent);
    let file = File {
        generator: "arabesque",
        version: env!("CARGO_PKG_VERSION"),
        page: document.page.map(|[min, size]| PageRecord { min, size }),
        exemplars: document
            .exemplars
            .iter()
            .map(|&(path, [width, height])| ExemplarRecord { path, width, height })
            .collect(),
        ribbons: document.ribbons.iter().map(|line| ribbon(line, decimals)).collect(),
        warnings: warning_records(document.warnings),
        recipe: document.recipe,
    };
    serde_json::to_string_pretty(&file)
        .map(|text| text + "\n")
        .map_err(|e| arabesque_core::Error::input("writing JSON", e.to_string(), "write the ribbon in another format"))
}

fn ribbon<'a, const D: usize>(line: &RibbonLine<'a, D>, decimals: Decimals) -> RibbonRecord<'a> {
    let fine = Decimals::for_extent(1e3);
    let pieces = line.pieces.iter().map(|(patch, shift)| PieceRecord {
        source: patch.source,
        corners: patch.corners.map(|p| p.0.iter().map(|v| decimals.round(*v)).collect()),
        texture: patch.texture.map(|p| p.0.map(|v| fine.round(v))),
        shift: shift.to_vec(),
    });
    RibbonRecord { along: line.name, closed: line.closed, cost: fine.round(line.cost), pieces: pieces.collect() }
}

#[cfg(test)]
mod tests {
    use arabesque_core::Vector;

    use super::*;

    #[test]
    fn a_piece_has_corners_and_texture_coordinates() {
        let texture = [(0.0, 0.0), (4.0, 0.5), (4.0, 8.0), (0.0, 8.0)].map(|(x, y)| Vector::xy(x, y));
        let patch = Patch { source: 1, corners: texture.map(|p| Vector([p[0], p[1], 2.0])), texture };
        let line =
            RibbonLine { name: "c.obj: line 3", closed: true, cost: 12.5, pieces: vec![(patch, &[0.5, 1.0][..])] };
        let text = write_ribbons(&Document {
            exemplars: vec![("a.png", [60, 20])],
            ribbons: vec![line],
            page: None,
            extent: 10.0,
            warnings: &[],
            recipe: Some("seed = 1\n"),
            budget: &Budget::default(),
        })
        .unwrap();
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        let piece = &value["ribbons"][0]["pieces"][0];
        assert_eq!(piece["corners"][1], serde_json::json!([4.0, 0.5, 2.0]));
        assert_eq!(piece["shift"], serde_json::json!([0.5, 1.0]));
        assert_eq!((&value["ribbons"][0]["closed"], &value["exemplars"][0]["width"]), (&true.into(), &60.into()));
        assert_eq!(crate::json::fill::recipe_of(&text).unwrap(), "seed = 1\n");
    }
}
