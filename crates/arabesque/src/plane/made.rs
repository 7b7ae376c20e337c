//! Elements and strokes of the plane as files.

use std::sync::Arc;

use arabesque_core::{
    Budget, Drawn, EnergyPoint, Error, Exemplar, Outcome, Path, Result, Snapshot, StopReason, Warning,
};
use arabesque_io::{
    json,
    raster::png::{RenderJob, write_within},
    svg::{Sheet as SvgSheet, Style, Written, simplified, write_svg},
    table::csv,
};

use rayon::prelude::*;

use crate::{
    artwork::{Encoded, Geometry, Made, PlacedPoint, Sheet, Summary, draft, points},
    plane::{exemplar::PlaneExemplar, picture::resolution, place::Units, request::PlaneRequest},
    recipe::Format,
    spacing::spacing,
};

/// How far a simplified stroke may lie from the true one, in mean spacings.
const NODE_SPACING: f64 = 0.001;
/// The same in stroke widths.
const NODE_WIDTH: f64 = 0.02;
/// Work units for each segment of a stroke that is simplified.
const PER_SEGMENT: u64 = 10_000;

/// Elements and strokes in a part of the plane.
#[derive(Debug)]
pub(crate) struct PlaneMade {
    exemplar: Arc<PlaneExemplar>,
    request: Arc<PlaneRequest>,
    outcome: Outcome<2>,
}

impl PlaneMade {
    /// What a run ended with.
    pub(crate) fn new(exemplar: &Arc<PlaneExemplar>, request: Arc<PlaneRequest>, mut outcome: Outcome<2>) -> Self {
        // Whoever asked to stop waits: strokes have as many nodes then as they were drawn with.
        if outcome.stopped != StopReason::Stopped {
            simplify(&exemplar.drawing.exemplar, &mut outcome.curves, &request.engine.budget);
        }
        Self { exemplar: Arc::clone(exemplar), request, outcome }
    }

    /// What a run has so far.
    pub(crate) fn of_snapshot(
        exemplar: &Arc<PlaneExemplar>,
        request: &Arc<PlaneRequest>,
        snapshot: Snapshot<2>,
    ) -> Self {
        let outcome = unfinished(snapshot);
        Self { exemplar: Arc::clone(exemplar), request: Arc::clone(request), outcome }
    }

    /// What a file of points cannot hold.
    fn left_out(&self) -> Result<Vec<Warning>> {
        let count = self.outcome.curves.len();
        if count == 0 {
            return Ok(Vec::new());
        }
        let what = format!("{count} curves as a file of points");
        let advice = "write SVG or JSON, which hold curves";
        if self.outcome.placements.is_empty() {
            return Err(Error::Unsupported { what, advice: advice.into() });
        }
        Ok(vec![Warning::new(format!("{what} cannot be written: left out"), advice)])
    }

    fn svg(&self, style: Style, recipe: Option<&str>, budget: &Budget) -> Result<Written> {
        let placements = &self.outcome.placements;
        let bend = |k: usize, p| arabesque_core::warp(&placements[k].control, p);
        write_svg(&SvgSheet {
            drawing: &self.exemplar.drawing,
            placements,
            sequence: &self.outcome.sequence,
            curves: &self.outcome.curves,
            areas: &self.outcome.areas,
            kept: self.request.kept.as_ref(),
            host: self.exemplar.region.as_ref().map(|region| &region.rest),
            page: self.request.page,
            domain: &self.request.engine.domain,
            shape: self.request.shape.as_ref(),
            border: self.request.engine.border,
            bend: Some(&bend),
            style,
            recipe,
            budget,
        })
    }
}

/// A snapshot as the outcome of a run that is not over.
pub(crate) fn unfinished<const D: usize>(snapshot: Snapshot<D>) -> Outcome<D> {
    Outcome {
        placements: snapshot.placements,
        sequence: Vec::new(),
        curves: snapshot.curves,
        areas: snapshot.areas,
        energy: Vec::new(),
        warnings: Vec::new(),
        stopped: StopReason::Stopped,
    }
}

/// Leaves strokes with as few nodes as their width and spacing allow; what the user drew stays as it is. All stay as they are where
/// there is no time or work left for it.
fn simplify(exemplar: &Exemplar<2>, curves: &mut [Drawn<2>], budget: &Budget) {
    let spacing = spacing(exemplar);
    let fewer = |drawn: &Drawn<2>| -> Result<Option<Path<2>>> {
        if drawn.frozen.is_some() {
            return Ok(None);
        }
        budget.spend(PER_SEGMENT * drawn.path.cubics.len() as u64)?;
        let width = exemplar.curves[drawn.source].width * drawn.scale;
        Ok(Some(simplified(&drawn.path, (NODE_SPACING * spacing).max(NODE_WIDTH * width))))
    };
    let Ok(paths) = curves.par_iter().map(fewer).collect::<Result<Vec<_>>>() else { return };
    for (drawn, path) in curves.iter_mut().zip(paths) {
        if let Some(path) = path {
            drawn.path = path;
        }
    }
}

impl Made for PlaneMade {
    fn encode(&self, sheet: &Sheet<'_>) -> Result<Encoded> {
        let exemplar = &self.exemplar.drawing.exemplar;
        let page = &self.request.page;
        let size = page.view.size();
        match sheet.format {
            Format::Svg => {
                let style = if sheet.output.expand { Style::Expanded } else { Style::Linked };
                let written = self.svg(style, sheet.recipe, sheet.budget)?;
                Ok(Encoded { bytes: written.text.into_bytes(), warnings: written.warnings, companion: None })
            }
            Format::Png => {
                let written = self.svg(Style::Linked, None, sheet.budget)?;
                let mut encoded = drawn(&written.text, size.0, sheet)?;
                encoded.warnings.splice(0..0, written.warnings);
                Ok(encoded)
            }
            Format::Json => {
                let has_unit = self.exemplar.units() == Units::OfPage;
                let unit = has_unit.then_some((page.unit.name(), page.unit_per_user));
                let frame = json::Frame { view: page.view, unit, recipe: sheet.recipe };
                json::write_json(exemplar, &self.outcome, &frame).map(Encoded::plain)
            }
            Format::Csv => {
                let text = csv::write_points(exemplar, &self.outcome.placements, size[0].max(size[1]), sheet.recipe);
                Ok(Encoded { bytes: text.into_bytes(), warnings: self.left_out()?, companion: None })
            }
            Format::Obj | Format::Glb | Format::Gltf | Format::Ply | Format::Usda | Format::Toml => {
                Err(Error::Unsupported {
                    what: format!("a drawing of the plane as {}", sheet.format.name()),
                    advice: "write svg, png, json or csv; obj holds curves in space (--box), glb ribbons".into(),
                })
            }
        }
    }

    fn drawn_from(&self, format: Format) -> Option<Format> {
        (format == Format::Png).then_some(Format::Svg)
    }

    fn encode_edited(&self, edited: &[u8], sheet: &Sheet<'_>) -> Result<Encoded> {
        drawn(&String::from_utf8_lossy(edited), self.request.page.view.size().0, sheet)
    }

    fn summary(&self) -> Summary {
        let tile = self.request.engine.domain.period().map(|sides| sides.0);
        Summary { tile, ..Summary::of(&self.exemplar.drawing.exemplar, &self.outcome) }
    }

    fn geometry(&self) -> Geometry {
        Geometry::Plane(snapshot(&self.outcome))
    }

    fn points(&self) -> Vec<PlacedPoint> {
        points(&self.exemplar.drawing.exemplar, &self.outcome.placements)
    }

    fn warnings(&self) -> &[Warning] {
        &self.outcome.warnings
    }

    fn energy(&self) -> &[EnergyPoint] {
        &self.outcome.energy
    }

    fn stopped(&self) -> StopReason {
        self.outcome.stopped
    }
}

/// A drawing as a picture.
pub(crate) fn drawn(svg: &str, units: [f64; 2], sheet: &Sheet<'_>) -> Result<Encoded> {
    let job = RenderJob { svg, units, resolution: resolution(sheet.output)?, recipe: sheet.recipe };
    Ok(draft::told(write_within(&job, sheet.most_pixels(draft::FLAT), sheet.budget)?))
}

/// The geometry of an outcome.
pub(crate) fn snapshot<const D: usize>(outcome: &Outcome<D>) -> Snapshot<D> {
    let (placements, curves, areas) = (outcome.placements.clone(), outcome.curves.clone(), outcome.areas.clone());
    Snapshot { placements, curves, areas, patches: Vec::new() }
}
