//! What ribbons follow: curves on a page or in space, and what is to be avoided beside them.

use std::sync::Arc;

use arabesque_core::{Bounds, Budget, Error, Held, Path, Result, Warning};
use arabesque_io::{
    file,
    mesh::obj,
    raster::{mask::MaskRaster, png},
    svg::{self, Page, Unit},
};
use arabesque_ribbons::{Mask, RibbonRequest};

use crate::{
    method::RunContext,
    plane::options,
    recipe::{Format, Input, Job, OutputOptions, Ribbon, Size},
    ribbon::picture::resolution_of_canvas,
};

/// What the pattern follows.
#[derive(Clone, Debug)]
pub(crate) enum Track {
    /// Curves on a page.
    Plane {
        request: RibbonRequest<2>,
        page: Page,
        /// The memory of what is to be avoided.
        held: Option<Arc<Held>>,
    },
    /// Curves in space.
    Space { request: RibbonRequest<3> },
}

impl Track {
    /// Reads the files of the request, which are embedded in the job of `context`.
    pub(crate) fn of(context: &mut RunContext<'_>, finer: f64) -> Result<Self> {
        let Job::Ribbon(mut ribbon) = context.job.clone() else {
            return Err(Error::parameter("request", context.job.name(), "a request for a ribbon"));
        };
        let mut track = follow(&mut ribbon, context)?;
        let first = first_piece(&ribbon, finer)?;
        match &mut track {
            Track::Plane { request, page, held } => {
                request.changes.clone_from(&ribbon.changes);
                request.first = first;
                request.seed = context.seed;
                if let Some((mask, memory)) = avoided(&mut ribbon.avoid, page, context)? {
                    (request.avoid, *held) = (Some(mask), Some(Arc::new(memory)));
                }
                context.warnings.extend(off_canvas(request, page));
            }
            Track::Space { request } => {
                if !ribbon.avoid.is_empty() {
                    let advice = "leave it out, or give curves of the plane (SVG)";
                    return Err(Error::Unsupported {
                        what: "avoid with curves in space".into(),
                        advice: advice.into(),
                    });
                }
                request.changes.clone_from(&ribbon.changes);
                request.first = first;
                request.seed = context.seed;
            }
        }
        context.job = Job::Ribbon(ribbon);
        Ok(track)
    }

    /// Refuses, before the work, a picture that could not be drawn after it.
    pub(crate) fn check_picture(&self, output: &OutputOptions, budget: &Budget) -> Result<()> {
        match self {
            Track::Plane { page, .. } if output.format == Some(Format::Png) => {
                resolution_of_canvas(output, Some(page))?.pixels(page, budget).map(drop)
            }
            _ => Ok(()),
        }
    }
}

/// Where the first piece begins, in pixels of the search; `finer` of them are a pixel or unit of the exemplar.
fn first_piece(ribbon: &Ribbon, finer: f64) -> Result<Option<(usize, i64)>> {
    let Some([column, row]) = ribbon.first else { return Ok(None) };
    let [column, row] = [column, row].map(|v| (v as f64 * finer).round() as i64);
    let column = usize::try_from(column)
        .map_err(|_| Error::parameter("first", format!("{column},{row}"), "a column from 0 on, and a row"))?;
    Ok(Some((column, row)))
}

/// Reads the curves, whose file is embedded.
fn follow(ribbon: &mut Ribbon, context: &mut RunContext<'_>) -> Result<Track> {
    let files = context.files;
    let input = &mut ribbon.along;
    let bytes = files.embed(input)?;
    let (name, size): (_, Option<Size>) = (input.name(), ribbon.size);
    if png::is_png(&bytes) {
        let problem = "a picture where curves were expected";
        return Err(Error::input(name, problem, "give an SVG file with a path, or an OBJ file with l elements"));
    }
    let text = file::decode_text(name, &bytes, files.budget())?;
    if is_obj(name, &text) {
        if input.id.is_some() {
            let advice = "leave the id out: all lines of an OBJ file are followed";
            return Err(Error::Unsupported { what: format!("{name}: one line by its id"), advice: advice.into() });
        }
        if size.is_some() {
            let advice = "leave the canvas out";
            return Err(Error::Unsupported { what: "a canvas for curves in space".into(), advice: advice.into() });
        }
        let curves = obj::read_lines(name, &text, files.budget())?;
        return Ok(Track::Space {
            request: RibbonRequest { budget: files.budget().clone(), ..RibbonRequest::new(curves) },
        });
    }
    let lines = svg::read_lines(&text, input.id.as_deref(), &options(input, files))?;
    context.warnings.extend(lines.warnings);
    let own = lines.page.unwrap_or_else(|| page_around(&lines.paths));
    let page = size.map_or(own, |size| size.on(&own).1);
    Ok(Track::Plane {
        request: RibbonRequest { budget: files.budget().clone(), ..RibbonRequest::new(lines.paths) },
        page,
        held: None,
    })
}

/// The cells of the canvas that must stay free, one for each pixel of the canvas. The files are embedded.
fn avoided(inputs: &mut [Input], page: &Page, context: &RunContext<'_>) -> Result<Option<(Mask, Held)>> {
    if inputs.is_empty() {
        return Ok(None);
    }
    let (files, budget) = (context.files, context.budget());
    let [width, height] = resolution_of_canvas(context.output(), Some(page))?.pixels(page, budget)?;
    let mut region = MaskRaster::empty(page.view, width, height, budget)?;
    for input in inputs {
        let bytes = files.embed(input)?;
        if png::is_png(&bytes) {
            region.add_picture(input.name(), &bytes, budget)?;
            continue;
        }
        let text = file::decode_text(input.name(), &bytes, budget)?;
        let shape = svg::read_shape(&text, input.id.as_deref(), &options(input, files))?.0;
        region.add_outline(shape.outline(), budget)?;
    }
    if region.uniform() == Some(true) {
        let advice = "make the avoided regions smaller; of a picture, transparent and light pixels are free";
        return Err(Error::no_result("what is to be avoided covers the whole canvas", advice));
    }
    let MaskRaster { bounds, width, height, cells, held } = region;
    Ok(Some((Mask { bounds, width, height, blocked: cells }, held)))
}

/// Warnings of curves that lie off the canvas.
fn off_canvas(request: &RibbonRequest<2>, page: &Page) -> Vec<Warning> {
    let off = request.curves.iter().filter(|(_, path)| !path.bounds().intersects(&page.view));
    let advice = "move it onto the page, or give another canvas with --on-canvas";
    off.map(|(name, _)| Warning::new(format!("{name} lies off the canvas"), advice)).collect()
}

fn is_obj(name: &str, text: &str) -> bool {
    Format::of_path(name).ok().flatten() == Some(Format::Obj) && !text.trim_start().starts_with('<')
}

/// A page around curves whose file states none.
fn page_around(curves: &[(String, Path<2>)]) -> Page {
    let tight = curves.iter().fold(Bounds::EMPTY, |all, (_, path)| all.union(&path.bounds()));
    let size = tight.size();
    let view = Bounds::new(tight.min, tight.max).grown(0.1 * size[0].max(size[1]).max(1.0));
    let whole = Bounds::new(view.min.map(f64::floor), view.max.map(f64::ceil));
    Page { view: whole, unit: Unit::Px, unit_per_user: 1.0 }
}
