//! The plane: pages, shapes and tiles, and regions of a drawing that are filled again.

use std::sync::Arc;

use arabesque_core::{Border, Error, Exemplar, Outline, Request as EngineRequest, Result, StopReason, Watch};
use arabesque_io::svg::{Drawing, Page, Placed, Rest};
use arabesque_patterns::{Params, Prepared as Engine};

use crate::{
    Artwork, Fill, Format, Input, Job, LoadedExemplar, Parameters,
    artwork::PlaneMade,
    method::{Method, Ready},
    prepare::{
        Preparation, Session, Show,
        fields::FieldSources,
        place::{Place, Units, check_room},
        points_as_drawing, surroundings,
    },
};

/// An exemplar of the plane, analysed.
#[derive(Debug)]
pub(crate) struct Plane {
    /// The exemplar as it is drawn.
    pub(crate) drawing: Drawing,
    /// Whether it has a unit of length: a file of points has none.
    pub(crate) units: Units,
    /// The region of the exemplar's own file that is filled again, and the rest of it, which stays.
    pub(crate) region: Option<RegionOfFile>,
    engine: Engine<2>,
    /// What the engine was given: the drawing's own exemplar, but for points.
    points: Option<Exemplar<2>>,
}

/// A region of the exemplar's own file.
#[derive(Debug)]
pub(crate) struct RegionOfFile {
    /// How messages call it.
    pub(crate) name: String,
    pub(crate) place: Place,
    /// Everything that stays.
    pub(crate) rest: Rest,
}

/// A request in the plane, with every file read and every unit resolved.
#[derive(Debug)]
pub(crate) struct PlaneRequest {
    pub(crate) engine: EngineRequest<2>,
    pub(crate) page: Page,
    /// Outline of the domain where it is a shape.
    pub(crate) shape: Option<Outline<2>>,
    pub(crate) kept: Option<Placed>,
}

impl Parameters {
    /// The parameters of the engine for elements and curves.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown preset or name, or a value out of range.
    pub fn engine_params(&self) -> Result<Params> {
        let mut params = Params::preset(self.preset.as_deref().unwrap_or("default"))?;
        self.set.iter().try_for_each(|(name, value)| params.set(name, value))?;
        Ok(params)
    }
}

impl Method for Fill {
    fn usual_format(&self, _: &Input) -> Format {
        Format::Svg
    }

    fn fixed(&self) -> Job {
        Job::Fill(Self { method: self.method, params: self.params.clone(), ..Self::default() })
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<Arc<dyn Ready>> {
        // What is wrong with the parameters is told before what is wrong in a file.
        let params = self.params.engine_params()?;
        let bytes = preparation.files.read(&preparation.exemplar)?;
        let limits = preparation.files.limits();
        let (drawing, points) = match LoadedExemplar::read(&preparation.exemplar, &bytes, self.method, &limits)? {
            LoadedExemplar::Drawing(drawing) => (*drawing, None),
            LoadedExemplar::Points(exemplar) => (points_as_drawing(&exemplar), Some(exemplar)),
            LoadedExemplar::Space(..) => {
                return Err(Error::input(
                    preparation.exemplar.name(),
                    "an exemplar in space, where one of the plane was expected",
                    "give the box to fill with --box, such as --box 10x10x10",
                ));
            }
        };
        preparation.exemplar = preparation.exemplar.embedding(&bytes);
        Ok(Arc::new(Plane::new(drawing, points, None, &params, preparation)?))
    }
}

impl Plane {
    /// Analyses the exemplar.
    pub(crate) fn new(
        mut drawing: Drawing,
        points: Option<Exemplar<2>>,
        region: Option<RegionOfFile>,
        params: &Params,
        preparation: &mut Preparation<'_>,
    ) -> Result<Self> {
        preparation.warnings.append(&mut drawing.warnings);
        let name = preparation.exemplar.name();
        let engine = Engine::new(points.as_ref().unwrap_or(&drawing.exemplar), params)
            .map_err(|error| in_exemplar(error, name))?;
        let units = if points.is_some() { Units::None } else { Units::OfPage };
        Ok(Self { drawing, units, region, engine, points })
    }

    fn exemplar(&self) -> &Exemplar<2> {
        self.points.as_ref().unwrap_or(&self.drawing.exemplar)
    }

    /// Reads the files of the request, which are embedded in the job of `session`.
    fn resolve(&self, session: &mut Session<'_>) -> Result<PlaneRequest> {
        let mut job = std::mem::replace(&mut session.job, Job::Fill(Fill::default()));
        let resolved = self.resolve_job(&mut job, session);
        session.job = job;
        resolved
    }

    fn resolve_job(&self, job: &mut Job, session: &mut Session<'_>) -> Result<PlaneRequest> {
        let files = session.files();
        let place = match (&self.region, &mut *job) {
            (Some(region), _) => region.place.clone(),
            (None, Job::Fill(fill)) => Place::of(fill, &self.drawing, self.units, files)?,
            (None, _) => return Err(Error::parameter("request", job.name(), "a request to fill")),
        };
        check_room(self.exemplar(), &place.domain, &files.limits()).map_err(|error| self.in_region(error, session))?;
        let surroundings = Surroundings::of(job)?;
        let mut request = EngineRequest::new(place.domain);
        request.seed = session.seed;
        request.limits = files.limits();
        request.known = self.region.is_some().then_some(self.drawing.page.view);
        request.border = surroundings.border.unwrap_or_else(|| self.usual_border());
        request.fields = surroundings.fields.read(&self.drawing, &request.domain.bounds(), files)?;
        let avoid = surroundings.avoid;
        request.obstacles = surroundings::avoided(avoid, &self.drawing, self.units, &request.domain, files)?;
        let mut kept = None;
        if let Some(input) = surroundings.keep {
            let mut placed = surroundings::kept(input, &self.drawing, self.units, files)?;
            session.warnings.append(&mut placed.warnings);
            let elsewhere = surroundings::kept_elsewhere(&placed, input, &self.drawing.exemplar, &request.domain);
            session.warnings.extend(elsewhere);
            kept = Some(placed);
        }
        if let Some(placed) = kept.as_ref().or(self.region.as_ref().map(|region| &region.rest.placed)) {
            request.frozen.clone_from(&placed.placements);
            request.frozen_curves.clone_from(&placed.curves);
            request.obstacles.extend(placed.obstacles.iter().cloned());
        }
        Ok(PlaneRequest { engine: request, page: place.page, shape: place.shape, kept })
    }

    /// In a region that is filled again elements count by their centres, as those do that it replaces.
    fn usual_border(&self) -> Border {
        let counts_centres = self.region.is_some() && self.exemplar().curves.is_empty();
        if counts_centres { Border::Cross } else { Border::Clip }
    }

    /// The same error with the name of the region that is filled again, where one is.
    fn in_region(&self, error: Error, session: &Session<'_>) -> Error {
        match (error, &self.region) {
            (Error::NoResult { problem, advice }, Some(region)) => {
                Error::no_result(format!("{}: region {}: {problem}", session.exemplar_name(), region.name), advice)
            }
            (error, _) => error,
        }
    }
}

/// What a job in the plane says beside its place.
struct Surroundings<'a> {
    border: Option<Border>,
    fields: FieldSources<'a>,
    avoid: &'a mut Vec<Input>,
    keep: Option<&'a mut Input>,
}

impl<'a> Surroundings<'a> {
    fn of(job: &'a mut Job) -> Result<Self> {
        match job {
            Job::Fill(Fill { border, orient, scale, density, avoid, keep, .. }) => Ok(Self {
                border: *border,
                fields: FieldSources { orient, scale, density },
                avoid,
                keep: keep.as_mut(),
            }),
            Job::Redo(crate::Redo { border, orient, scale, density, avoid, .. }) => {
                Ok(Self { border: *border, fields: FieldSources { orient, scale, density }, avoid, keep: None })
            }
            Job::Space(_) | Job::Ribbon(_) => {
                Err(Error::parameter("request", job.name(), "a request for a part of the plane"))
            }
        }
    }
}

impl Ready for Plane {
    fn understood(&self) -> String {
        understood(&self.drawing.exemplar)
    }

    fn run(self: Arc<Self>, mut session: Session<'_>, watch: &mut dyn Watch<Artwork>) -> Result<Artwork> {
        let request = Arc::new(self.resolve(&mut session)?);
        let origin = session.origin();
        let make = |snapshot| PlaneMade::of_snapshot(&self, &request, snapshot);
        let mut show = Show { watch, origin: &origin, make };
        let mut outcome = self.engine.run(&request.engine, &mut show)?;
        if outcome.placements.is_empty() && outcome.curves.is_empty() {
            return Err(match outcome.stopped {
                StopReason::Stopped => Error::no_result("stopped before anything was placed", "give it more time"),
                StopReason::Finished => Error::no_result(
                    "nothing fits the domain under the given constraints",
                    "make the domain larger or the avoided shapes smaller, or let elements cross the border with --border cross or clip",
                ),
            });
        }
        outcome.warnings.splice(0..0, session.warnings);
        Ok(Artwork::new(origin, PlaneMade::new(self, request, outcome)))
    }
}

/// The exemplar of elements and curves, in words.
pub(crate) fn understood<const D: usize>(exemplar: &Exemplar<D>) -> String {
    let (elements, classes) = (exemplar.elements.len(), exemplar.classes.len());
    let (curves, styles) = (exemplar.curves.len(), exemplar.styles.len());
    let of_curves = if curves > 0 { format!(", {curves} curves in {styles} styles") } else { String::new() };
    format!("exemplar: {elements} elements in {classes} classes{of_curves}")
}

/// The same error with the name of the file where it speaks of the exemplar.
fn in_exemplar(error: Error, name: &str) -> Error {
    match error {
        Error::Input { problem, advice, .. } => Error::input(name, problem, advice),
        Error::Limit { what, found, limit, advice } => {
            Error::Limit { what: format!("{name}: {what}"), found, limit, advice }
        }
        other => other,
    }
}
