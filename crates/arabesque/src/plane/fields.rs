//! Fields of the plane: how the pattern is turned, scaled and thinned.

use arabesque_core::{Bounds, Error, Fields, Matrix, OrientationField, Result, ScalarField};
use arabesque_io::{
    file,
    raster::field::Picture,
    svg::{self, Drawing},
};

use crate::{
    plane::place::options,
    recipe::{FieldSource, Input},
    resources::Files,
};

/// Nodes along the longer side of a direction field that comes from strokes.
const STROKE_NODES: usize = 128;
/// Values of black and white in a picture of scale.
const SCALE_RANGE: [f64; 2] = [0.5, 2.0];
/// Values of black and white in a picture of density.
const DENSITY_RANGE: [f64; 2] = [0.2, 1.0];
/// Smallest and largest factor that a field may hold.
const FACTORS: [f64; 2] = [0.01, 100.0];

/// Where the fields of a job in the plane come from; their files are embedded once they are read.
pub(crate) struct FieldSources<'a> {
    pub(crate) orient: &'a mut Option<FieldSource>,
    pub(crate) scale: &'a mut Option<FieldSource>,
    pub(crate) density: &'a mut Option<FieldSource>,
}

impl FieldSources<'_> {
    /// The fields over `bounds`; where no direction is given, the layer Flow of the exemplar has it.
    pub(crate) fn read(self, drawing: &Drawing, bounds: &Bounds<2>, files: &Files) -> Result<Fields<2>> {
        let orientation = match self.orient {
            Some(FieldSource::Constant(degrees)) if degrees.is_finite() => {
                Some(OrientationField::Constant(Matrix::rotation(degrees.to_radians())))
            }
            Some(FieldSource::Constant(degrees)) => {
                return Err(Error::parameter("orient", degrees, "a finite number of degrees"));
            }
            Some(FieldSource::File(source)) => {
                files.embed(&mut source.file)?;
                Some(orientation(&source.file, bounds, files)?)
            }
            None if drawing.job.flow.is_empty() => None,
            None => OrientationField::from_strokes(&drawing.job.flow, *bounds, STROKE_NODES),
        };
        let scale = factor("scale", self.scale.as_mut(), bounds, SCALE_RANGE, files)?;
        let density = factor("density", self.density.as_mut(), bounds, DENSITY_RANGE, files)?;
        Ok(Fields { orientation, scale, density })
    }
}

/// The directions of a picture or of strokes over `bounds`.
pub(crate) fn orientation(input: &Input, bounds: &Bounds<2>, files: &Files) -> Result<OrientationField<2>> {
    let bytes = files.read(input)?;
    let is_text = bytes.trim_ascii_start().starts_with(b"<") || bytes.starts_with(&[0xEF, 0xBB, 0xBF, b'<']);
    if !is_text && !file::is_packed(&bytes) {
        return Picture::new(input.name(), &bytes, files.budget()).orientation_field(*bounds);
    }
    let strokes = svg::read_flow(&file::decode_text(input.name(), &bytes, files.budget())?, &options(input, files))?;
    OrientationField::from_strokes(&strokes, *bounds, STROKE_NODES).ok_or_else(|| {
        Error::input(input.name(), "no stroke crosses the domain", "draw strokes over the domain, in its coordinates")
    })
}

/// The field of a factor, whose picture is embedded.
pub(crate) fn factor(
    name: &str,
    source: Option<&mut FieldSource>,
    bounds: &Bounds<2>,
    range: [f64; 2],
    files: &Files,
) -> Result<ScalarField<2>> {
    match source {
        Some(FieldSource::File(field)) => {
            let range = field.range.unwrap_or(range);
            if !range.iter().all(|v| is_allowed(*v)) {
                return Err(Error::parameter(name, format!("{}..{}", range[0], range[1]), expected()));
            }
            let bytes = files.embed(&mut field.file)?;
            Picture::new(field.file.name(), &bytes, files.budget()).scalar_field(*bounds, range)
        }
        other => constant_factor(name, other.as_deref()),
    }
}

fn is_allowed(factor: f64) -> bool {
    (FACTORS[0]..=FACTORS[1]).contains(&factor)
}

fn expected() -> String {
    format!("a factor between {} and {}, or a PNG picture", FACTORS[0], FACTORS[1])
}

/// The field of a factor that is the same everywhere, 1 by default.
pub(crate) fn constant_factor<const D: usize>(name: &str, source: Option<&FieldSource>) -> Result<ScalarField<D>> {
    match source {
        None => Ok(ScalarField::Constant(1.0)),
        Some(FieldSource::Constant(v)) if is_allowed(*v) => Ok(ScalarField::Constant(*v)),
        Some(FieldSource::Constant(v)) if D == 2 => Err(Error::parameter(name, v, expected())),
        Some(FieldSource::Constant(v)) => {
            Err(Error::parameter(name, v, format!("a factor between {} and {}", FACTORS[0], FACTORS[1])))
        }
        Some(FieldSource::File(_)) => {
            Err(Error::Unsupported { what: format!("{name} from a picture, in space"), advice: "give a number".into() })
        }
    }
}
