//! JSON: placements and strokes with their sources, and how the run went.

use arabesque_core::{Bounds, Decimals, Drawn, EnergyPoint, Exemplar, Measured, Outcome, Placement, StopReason};
use serde::Serialize;

use crate::{
    json::warning::{WarningRecord, warning_records},
    text::path_data::path_data,
};

/// What the file says beside the placements.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a, const D: usize> {
    /// The box that is shown.
    pub view: Bounds<D>,
    /// Unit of lengths on paper, and how many of it one user unit is; `None` for points, which have none.
    pub unit: Option<(&'a str, f64)>,
    /// The recipe, as TOML.
    pub recipe: Option<&'a str>,
}

#[derive(Serialize)]
struct File<'a> {
    generator: &'static str,
    version: &'static str,
    page: PageRecord<'a>,
    classes: Vec<&'a str>,
    placements: Vec<PlacementRecord<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    styles: Vec<&'a str>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    curves: Vec<CurveRecord<'a>>,
    energy: Vec<EnergyRecord>,
    warnings: Vec<WarningRecord<'a>>,
    stopped: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    recipe: Option<&'a str>,
}

#[derive(Serialize)]
struct PageRecord<'a> {
    min: Vec<f64>,
    size: Vec<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    unit_per_user: Option<f64>,
}

#[derive(Serialize)]
struct PlacementRecord<'a> {
    source: usize,
    class: &'a str,
    centre: Vec<f64>,
    transform: Vec<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    control: Vec<[Vec<f64>; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    kept: Option<usize>,
}

#[derive(Serialize)]
struct CurveRecord<'a> {
    source: usize,
    style: &'a str,
    d: String,
    closed: bool,
    width: f64,
    scale: f64,
    length: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    kept: Option<usize>,
}

#[derive(Serialize)]
struct EnergyRecord {
    level: usize,
    iteration: usize,
    energy: f64,
    elements: usize,
}

/// Writes an outcome as one JSON object.
///
/// `d` is SVG path data, in space with three numbers per point; `width` is that of the stroke as it is drawn, `length`
/// that of its line. `transform` is column by column, the shift last: `[a, b, c, d, e, f]` in the plane, as SVG's
/// `matrix()` has it.
///
/// # Errors
/// [`arabesque_core::Error::Input`] when a number cannot be written, which no outcome should hold.
pub fn write_json<const D: usize>(
    exemplar: &Exemplar<D>,
    outcome: &Outcome<D>,
    frame: &Frame<'_, D>,
) -> arabesque_core::Result<String> {
    let size = frame.view.size();
    let decimals = Decimals::for_extent(size.0.into_iter().fold(0.0, f64::max));
    let file = File {
        generator: "arabesque",
        version: env!("CARGO_PKG_VERSION"),
        page: PageRecord {
            min: frame.view.min.0.to_vec(),
            size: size.0.to_vec(),
            unit: frame.unit.map(|(name, _)| name),
            unit_per_user: frame.unit.map(|(_, per_user)| per_user),
        },
        classes: exemplar.classes.iter().map(|c| c.name.as_str()).collect(),
        placements: outcome.placements.iter().map(|p| placement(exemplar, p, decimals)).collect(),
        styles: exemplar.styles.iter().map(|s| s.name.as_str()).collect(),
        curves: outcome.curves.iter().map(|c| curve(exemplar, c, decimals)).collect(),
        energy: outcome.energy.iter().map(energy).collect(),
        warnings: warning_records(&outcome.warnings),
        stopped: match outcome.stopped {
            StopReason::Finished => "finished",
            StopReason::Stopped => "early",
            StopReason::Limit => "limit",
        },
        recipe: frame.recipe,
    };
    let text = serde_json::to_string_pretty(&file)
        .map_err(|e| arabesque_core::Error::input("result", e.to_string(), "report this together with the exemplar"))?;
    Ok(text + "\n")
}

fn placement<'a, const D: usize>(
    exemplar: &'a Exemplar<D>,
    p: &Placement<D>,
    decimals: Decimals,
) -> PlacementRecord<'a> {
    let element = &exemplar.elements[p.source];
    let fine = decimals.plus(3);
    let rounded = |v: [f64; D]| v.map(|c| fine.round(c)).to_vec();
    let (rotation, scale) = (p.transform.rotation.0, p.transform.scale);
    let columns = (0..D).flat_map(|c| (0..D).map(move |r| rotation[r][c] * scale));
    PlacementRecord {
        source: p.source,
        class: &exemplar.classes[element.class].name,
        centre: rounded(p.transform.apply(element.centre).0),
        transform: columns.chain(p.transform.translation.0).map(|v| fine.round(v)).collect(),
        control: p.control.iter().map(|(a, b)| [rounded(a.0), rounded(b.0)]).collect(),
        kept: p.frozen,
    }
}

fn curve<'a, const D: usize>(exemplar: &'a Exemplar<D>, drawn: &Drawn<D>, decimals: Decimals) -> CurveRecord<'a> {
    let source = &exemplar.curves[drawn.source];
    CurveRecord {
        source: drawn.source,
        style: &exemplar.styles[source.style].name,
        d: path_data(&drawn.path, decimals),
        closed: drawn.path.closed,
        width: decimals.plus(3).round(source.width * drawn.scale),
        scale: decimals.plus(3).round(drawn.scale),
        length: decimals.round(Measured::new(drawn.path.clone(), decimals.step()).length()),
        kept: drawn.frozen,
    }
}

fn energy(point: &EnergyPoint) -> EnergyRecord {
    EnergyRecord { level: point.level, iteration: point.iteration, energy: point.energy, elements: point.elements }
}

/// The recipe in a file that [`write_json`] wrote.
pub fn recipe_of(text: &str) -> Option<String> {
    let value: serde_json::Value = serde_json::from_str(text).ok()?;
    Some(value.get("recipe")?.as_str()?.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use arabesque_core::{Matrix, Similarity, Vector};

    #[test]
    fn a_placement_says_source_class_and_matrix() {
        let points = [Vector::xy(1.0, 0.0), Vector::xy(3.0, 1.0)];
        let exemplar = Exemplar::from_points("t", &points, &[0, 1], &["dot".into(), "leaf".into()]).unwrap();
        let quarter = Matrix([[0.0, -1.0], [1.0, 0.0]]);
        let transform = Similarity { rotation: quarter, scale: 2.0, translation: Vector::xy(5.0, 6.0) };
        let outcome = Outcome {
            curves: Vec::new(),
            areas: Vec::new(),
            sequence: Vec::new(),
            placements: vec![Placement { source: 1, transform, control: Vec::new(), frozen: None }],
            energy: vec![EnergyPoint { level: 0, iteration: 1, energy: 0.5, elements: 1 }],
            warnings: Vec::new(),
            stopped: StopReason::Finished,
        };
        let view = Bounds::new(Vector::ZERO, Vector::xy(10.0, 10.0));
        let text = write_json(&exemplar, &outcome, &Frame { view, unit: None, recipe: Some("seed = 3\n") }).unwrap();
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(value["placements"][0]["class"], "leaf");
        assert_eq!(value["placements"][0]["transform"], serde_json::json!([0.0, 2.0, -2.0, 0.0, 5.0, 6.0]));
        assert_eq!(value["placements"][0]["centre"], serde_json::json!([3.0, 12.0]));
        assert_eq!(value["energy"][0]["energy"], 0.5);
        assert_eq!(recipe_of(&text).unwrap(), "seed = 3\n");
    }
}
