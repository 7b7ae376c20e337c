//! The plane: pages, shapes and tiles, and regions of a drawing that are filled again.

mod exemplar;
mod fields;
mod made;
mod picture;
mod place;
mod redo;
mod request;
mod surroundings;
mod tile;

pub(crate) use fields::{constant_factor, factor as factor_field, orientation as orientation_field};
pub(crate) use made::{drawn, snapshot, unfinished};
pub(crate) use place::options;

use std::sync::Arc;

use arabesque_core::{Error, OrientationField, Request, Result, ScalarField, Watch};
use arabesque_io::svg::LargeFills;
use arabesque_patterns::{Known, Params, Prepared as Engine, Repeats};

use crate::{
    artwork::Artwork,
    exemplar::{LoadedExemplar, points_as_drawing, understood},
    inspect::UnderstoodReport,
    method::{Preparation, Ready, RunContext, Show},
    recipe::{Fill, Reading, Redo},
};
use exemplar::PlaneExemplar;
use made::PlaneMade;

/// An exemplar of the plane, analysed.
#[derive(Debug)]
pub(crate) struct Plane {
    exemplar: Arc<PlaneExemplar>,
    engine: Engine<2>,
}

/// Reads an exemplar to fill a part of the plane.
pub(crate) fn prepare(fill: &Fill, preparation: &mut Preparation<'_>) -> Result<Plane> {
    let input = &preparation.exemplar;
    // What is wrong with the parameters is told before what is wrong in a file.
    let params = fill.params.engine_params()?;
    let bytes = preparation.files.read(input)?;
    let reading = Reading { method: fill.method, exemplar_tile: fill.exemplar_tile, large_fills: large_fills(&params) };
    let loaded = LoadedExemplar::read(input, &bytes, reading, preparation.files.budget())?;
    let (drawing, points, known) = match loaded {
        LoadedExemplar::Drawing(drawing, known) => (*drawing, None, known),
        LoadedExemplar::Points(exemplar) => (points_as_drawing(&exemplar), Some(Arc::new(exemplar)), Known::Unasked),
        LoadedExemplar::Space(..) => {
            return Err(Error::input(
                input.name(),
                "an exemplar in space, where one of the plane was expected",
                "give the box to fill with --box, such as --box 10x10x10",
            ));
        }
    };
    preparation.exemplar = input.embedding(&bytes);
    Plane::new(PlaneExemplar { drawing, points, region: None }, &params, known, preparation)
}

/// What large fills are taken for.
fn large_fills(params: &Params) -> LargeFills {
    if params.repeat == Repeats::Off { LargeFills::Lines } else { LargeFills::Areas }
}

/// Reads a drawing to fill a region of it again.
pub(crate) fn prepare_region(redo: &Redo, preparation: &mut Preparation<'_>) -> Result<Plane> {
    let params = redo.params.engine_params()?;
    let exemplar = redo::read(redo, large_fills(&params), preparation)?;
    Plane::new(exemplar, &params, Known::Unasked, preparation)
}

impl Plane {
    /// Analyses the exemplar.
    fn new(
        mut exemplar: PlaneExemplar,
        params: &Params,
        known: Known,
        preparation: &mut Preparation<'_>,
    ) -> Result<Self> {
        preparation.warnings.append(&mut exemplar.drawing.warnings);
        preparation.files.budget().allow_exemplar(exemplar.exemplar().elements.len());
        let engine = Engine::knowing(Arc::clone(exemplar.exemplar()), params, known, preparation.files.budget())
            .map_err(|error| in_exemplar(error, preparation.exemplar.name()))?;
        Ok(Self { exemplar: Arc::new(exemplar), engine })
    }
}

impl Plane {
    /// Refuses fields that vary where a gradient paints areas: it runs straight.
    fn refuse_bent_gradients(&self, request: &Request<2>) -> Result<()> {
        let fields = &request.fields;
        let varies = matches!(fields.orientation, Some(OrientationField::Grid(_)))
            || [&fields.scale, &fields.density].iter().any(|field| matches!(field, ScalarField::Grid(_)));
        let has_gradients = self.exemplar.drawing.fills.iter().any(|fill| fill.paint.contains("url("));
        if !(varies && has_gradients) {
            return Ok(());
        }
        Err(Error::Unsupported {
            what: "bending bands with gradients by a field".into(),
            advice: "turn and scale them evenly, as by --orient 30, or paint them in plain colours".into(),
        })
    }
}

impl Ready for Plane {
    fn understood(&self) -> String {
        let drawing = &self.exemplar.drawing;
        let reasons = UnderstoodReport::of(drawing).into_iter().map(|known| format!("\n  {known}"));
        understood(&drawing.exemplar) + &reasons.collect::<String>()
    }

    fn run(self: Arc<Self>, mut context: RunContext<'_>, watch: &mut dyn Watch<Artwork>) -> Result<Artwork> {
        self.settle_tile(&mut context)?;
        let request = Arc::new(self.exemplar.resolve(&mut context, self.engine.repeat())?);
        self.refuse_bent_gradients(&request.engine)?;
        let origin = context.origin();
        let make = |snapshot| PlaneMade::of_snapshot(&self.exemplar, &request, snapshot);
        let mut show = Show { watch, origin: &origin, make };
        let mut outcome = self.engine.run(&request.engine, &mut show)?;
        outcome.warnings.splice(0..0, context.warnings);
        Ok(Artwork::new(origin, PlaneMade::new(&self.exemplar, request, outcome)))
    }
}

/// The same error with the name of the file where it speaks of the exemplar.
pub(crate) fn in_exemplar(error: Error, name: &str) -> Error {
    match error {
        Error::Input { problem, advice, .. } => Error::input(name, problem, advice),
        Error::Limit { what, found, limit, advice } => {
            Error::Limit { what: format!("{name}: {what}"), found, limit, advice }
        }
        other => other,
    }
}
