//! Requests in the plane: every file is read, every unit resolved.

use arabesque_core::{Border, Error, Outline, Request as EngineRequest, Result};
use arabesque_io::svg::{Page, Placed};
use arabesque_patterns::repeat::Repeat;

use crate::{
    method::RunContext,
    plane::{
        exemplar::PlaneExemplar,
        fields::FieldSources,
        picture::check_picture,
        place::{Place, check_cell, check_room},
        redo::check_border,
        surroundings,
    },
    recipe::{Fill, Input, Job, Redo},
};

/// A request in the plane, with every file read and every unit resolved.
#[derive(Debug)]
pub(crate) struct PlaneRequest {
    pub(crate) engine: EngineRequest<2>,
    pub(crate) page: Page,
    /// Outline of the domain where it is a shape.
    pub(crate) shape: Option<Outline<2>>,
    pub(crate) kept: Option<Placed>,
}

impl PlaneExemplar {
    /// Reads the files of the request, which are embedded in the job of `context`.
    pub(crate) fn resolve(&self, context: &mut RunContext<'_>, repeat: Option<&Repeat>) -> Result<PlaneRequest> {
        let mut job = std::mem::replace(&mut context.job, Job::Fill(Fill::default()));
        let resolved = self.resolve_job(&mut job, context, repeat);
        context.job = job;
        resolved
    }

    fn resolve_job(
        &self,
        job: &mut Job,
        context: &mut RunContext<'_>,
        repeat: Option<&Repeat>,
    ) -> Result<PlaneRequest> {
        let files = context.files;
        let repeats = repeat.is_some();
        let place = match (&self.region, &mut *job) {
            (Some(region), _) => region.place.clone(),
            (None, Job::Fill(fill)) => Place::of(fill, &self.drawing, self.units(), files)?,
            (None, _) => return Err(Error::parameter("request", job.name(), "a request to fill")),
        };
        // Fields make the cell another one.
        let is_plain = matches!(&*job, Job::Fill(f) if f.orient.is_none() && f.scale.is_none() && f.density.is_none());
        check_cell(repeat.filter(|_| is_plain), &place.domain)?;
        let fits = repeats && self.region.is_some();
        check_room(self.exemplar(), &place.domain, fits, files.budget())
            .map_err(|error| self.in_region(error, context))?;
        check_picture(context.output(), &place.page, files.budget())?;
        let surroundings = Surroundings::of(job)?;
        if self.region.is_some() {
            check_border(surroundings.border)?;
        }
        let mut request = EngineRequest::new(place.domain);
        request.seed = context.seed;
        request.budget = files.budget().clone();
        request.known = self.region.is_some().then_some(self.drawing.page.view);
        request.border = surroundings.border.unwrap_or_else(|| self.usual_border(repeats));
        request.fields = surroundings.fields.read(&self.drawing, &request.domain.bounds(), files)?;
        let avoid = surroundings.avoid;
        request.obstacles = surroundings::avoided(avoid, &self.drawing, self.units(), &request.domain, files)?;
        let mut kept = None;
        if let Some(input) = surroundings.keep {
            let mut placed = surroundings::kept(input, &self.drawing, self.units(), files)?;
            context.warnings.append(&mut placed.warnings);
            let elsewhere = surroundings::kept_elsewhere(&placed, input, &self.drawing.exemplar, &request.domain);
            context.warnings.extend(elsewhere);
            kept = Some(placed);
        }
        if let Some(placed) = kept.as_ref().or(self.region.as_ref().map(|region| &region.rest.placed)) {
            request.frozen.clone_from(&placed.placements);
            request.frozen_curves.clone_from(&placed.curves);
            // What the edges of the page cut is no element, and in nobody's way: the repeat has it there.
            if kept.is_some() || !repeats {
                request.obstacles.extend(placed.obstacles.iter().cloned());
            }
        }
        Ok(PlaneRequest { engine: request, page: place.page, shape: place.shape, kept })
    }

    /// In a region that is filled again elements count by their centres, as those do that it replaces.
    /// What repeats is continued up to the border, where that counts for strokes alone.
    fn usual_border(&self, repeats: bool) -> Border {
        let counts_centres = self.region.is_some() && (repeats || self.exemplar().curves.is_empty());
        if counts_centres { Border::Cross } else { Border::Clip }
    }

    /// The same error with the name of the region that is filled again, where one is.
    fn in_region(&self, error: Error, context: &RunContext<'_>) -> Error {
        match (error, &self.region) {
            (Error::NoResult { problem, advice }, Some(region)) => {
                Error::no_result(format!("{}: region {}: {problem}", context.exemplar_name(), region.name), advice)
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
            Job::Redo(Redo { border, orient, scale, density, avoid, .. }) => {
                Ok(Self { border: *border, fields: FieldSources { orient, scale, density }, avoid, keep: None })
            }
            Job::Space(_) | Job::Ribbon(_) | Job::Surface(_) | Job::Structures(_) | Job::Relief(_) => {
                Err(Error::parameter("request", job.name(), "a request for a part of the plane"))
            }
        }
    }
}
