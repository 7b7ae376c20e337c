//! Results, and the files they are written as.

use arabesque_core::{Drawn, Error, Limits, Observer, Outcome, Result, StopReason, Warning};
use arabesque_io::{
    csv, json,
    png::{Plate, Resolution, write_png},
    svg::{Sheet, Style, Written, simplified, write_svg},
};

use crate::{Format, OutputOptions, Prepared, Recipe, size::unit_name, spacing::spacing};

/// The result of one run.
#[derive(Clone, Debug)]
pub struct Artwork<'a> {
    prepared: &'a Prepared,
    /// Placements, strokes, energy trace, warnings, and why the run ended.
    pub outcome: Outcome<2>,
    /// Seed of the run.
    pub seed: u64,
}

/// A file, complete.
#[derive(Clone, Debug)]
pub struct Encoded {
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// What could not be written as asked.
    pub warnings: Vec<Warning>,
}

impl Prepared {
    /// Runs with the given seed. Any number of runs may be made from one preparation.
    ///
    /// # Errors
    /// [`Error::NoResult`] when nothing can be placed, [`Error::Limit`] when a limit is reached.
    pub fn run(&self, seed: u64, observer: &mut dyn Observer<2>) -> Result<Artwork<'_>> {
        let mut request = self.request.clone();
        request.seed = seed;
        let mut outcome = self.engine.run(&request, observer)?;
        let is_empty = outcome.placements.is_empty() && outcome.curves.is_empty();
        if is_empty && outcome.stopped == StopReason::Observer {
            return Err(Error::no_result("stopped before anything was placed", "give it more time"));
        }
        if is_empty {
            return Err(Error::no_result(
                "nothing fits the domain under the given constraints",
                "make the domain larger or the avoided shapes smaller, or let elements cross the border with --border cross or clip",
            ));
        }
        self.simplify(&mut outcome.curves);
        outcome.warnings.splice(0..0, self.warnings.iter().cloned());
        Ok(Artwork { prepared: self, outcome, seed })
    }

    /// Leaves strokes with as few nodes as their width and spacing allow; what the user drew stays as it is.
    fn simplify(&self, curves: &mut [Drawn<2>]) {
        let exemplar = &self.drawing.exemplar;
        let spacing = spacing(exemplar);
        for drawn in curves.iter_mut().filter(|d| d.frozen.is_none()) {
            let width = exemplar.curves[drawn.source].width * drawn.scale;
            drawn.path = simplified(&drawn.path, (NODE_SPACING * spacing).max(NODE_WIDTH * width));
        }
    }
}

/// How far a simplified stroke may lie from the true one, in mean spacings.
const NODE_SPACING: f64 = 0.001;
/// The same in stroke widths.
const NODE_WIDTH: f64 = 0.02;

impl Artwork<'_> {
    /// The name of the class of each placement, in drawing order.
    pub fn classes(&self) -> impl Iterator<Item = &str> {
        let exemplar = &self.prepared.drawing.exemplar;
        self.outcome.placements.iter().map(|p| exemplar.classes[exemplar.elements[p.source].class].name.as_str())
    }

    /// The name of the style of each stroke, in drawing order.
    pub fn styles(&self) -> impl Iterator<Item = &str> {
        let exemplar = &self.prepared.drawing.exemplar;
        self.outcome.curves.iter().map(|c| exemplar.styles[exemplar.curves[c.source].style].name.as_str())
    }

    /// The recipe of this very result, as its file carries it.
    ///
    /// # Errors
    /// As [`Recipe::to_toml`].
    pub fn recipe(&self, output: &OutputOptions) -> Result<String> {
        // A recipe that stands alone leaves the format open: running it makes a result, not the recipe again.
        let format = output.format.filter(|f| *f != Format::Toml);
        let output = OutputOptions { path: None, format, ..output.clone() };
        let version = env!("CARGO_PKG_VERSION").to_owned();
        Recipe { seed: self.seed, arabesque: version, output, ..self.prepared.recipe.clone() }.to_toml()
    }

    /// The file in the format that `output` asks for; SVG where it does not say.
    ///
    /// # Errors
    /// [`Error::Limit`] for a picture with too many pixels, [`Error::Input`] when markup of the exemplar cannot be taken apart.
    pub fn encode(&self, output: &OutputOptions) -> Result<Encoded> {
        let format = output.format.unwrap_or(Format::Svg);
        let recipe = self.recipe(&OutputOptions { format: Some(format), ..output.clone() })?;
        let carried = (!output.bare).then_some(recipe.as_str());
        let exemplar = &self.prepared.drawing.exemplar;
        let size = self.prepared.page.view.size();
        let plain = |text: String| Encoded { bytes: text.into_bytes(), warnings: Vec::new() };
        match format {
            Format::Svg => {
                let written = self.svg(output, carried)?;
                Ok(Encoded { bytes: written.text.into_bytes(), warnings: written.warnings })
            }
            Format::Png => {
                let written = self.svg(&OutputOptions { expand: false, ..output.clone() }, None)?;
                let plate =
                    Plate { svg: &written.text, units: size.0, resolution: resolution(output)?, recipe: carried };
                Ok(Encoded { bytes: write_png(&plate, &Limits::default())?, warnings: written.warnings })
            }
            Format::Json => {
                let page = &self.prepared.page;
                let unit = (!self.prepared.is_points).then_some((unit_name(page.unit), page.unit_per_user));
                let frame = json::Frame { view: page.view, unit, recipe: carried };
                json::write_json(exemplar, &self.outcome, &frame).map(plain)
            }
            Format::Csv => {
                let text = csv::write_points(exemplar, &self.outcome.placements, size[0].max(size[1]), carried);
                Ok(Encoded { bytes: text.into_bytes(), warnings: self.left_out()? })
            }
            Format::Toml => Ok(plain(recipe)),
            Format::Obj | Format::Glb => Err(Error::Unsupported {
                what: format!("a drawing of the plane as {}", format.name()),
                advice: "write svg, png, json or csv; obj holds curves in space (--box), glb ribbons".into(),
            }),
        }
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

    fn svg(&self, output: &OutputOptions, recipe: Option<&str>) -> Result<Written> {
        let prepared = self.prepared;
        let placements = &self.outcome.placements;
        let bend = |k: usize, p| arabesque_core::warp(&placements[k].control, p);
        write_svg(&Sheet {
            drawing: &prepared.drawing,
            placements,
            curves: &self.outcome.curves,
            kept: prepared.kept.as_ref(),
            host: prepared.rest.as_ref(),
            page: prepared.page,
            domain: &prepared.request.domain,
            shape: prepared.shape.as_ref(),
            border: prepared.request.border,
            bend: Some(&bend),
            style: if output.expand { Style::Expanded } else { Style::Linked },
            recipe,
        })
    }
}

fn resolution(output: &OutputOptions) -> Result<Resolution> {
    let (name, value, resolution) = match (output.dpi, output.pixels_per_unit) {
        (None, None) => return Ok(Resolution::default()),
        (Some(_), Some(_)) => {
            return Err(Error::parameter("dpi", "given with pixels-per-unit", "only one of the two"));
        }
        (Some(dpi), None) => ("dpi", dpi, Resolution::PerInch(dpi)),
        (None, Some(n)) => ("pixels-per-unit", n, Resolution::PerUnit(n)),
    };
    if value.is_finite() && value > 0.0 {
        Ok(resolution)
    } else {
        Err(Error::parameter(name, value, "a positive number"))
    }
}
