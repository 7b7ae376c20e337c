//! Pictures of the plane: how large they are, known before the work.

use arabesque_core::{Budget, Error, Result};
use arabesque_io::{
    raster::{png::Resolution, size::checked_size},
    svg::Page,
    text::unit::PIXELS_PER_INCH,
};

use crate::recipe::{Format, OutputOptions};

/// Refuses, before the work, a picture that could not be drawn after it.
pub(crate) fn check_picture(output: &OutputOptions, page: &Page, budget: &Budget) -> Result<()> {
    if output.format != Some(Format::Png) {
        return Ok(());
    }
    let units = page.view.size();
    let pixels_per_unit = match resolution(output)? {
        Resolution::PerInch(dpi) => page.unit_per_user * page.unit.pixels() * dpi / PIXELS_PER_INCH,
        Resolution::PerUnit(n) => n,
    };
    let size = units.0.map(|side| (side * pixels_per_unit).round().clamp(1.0, f64::MAX));
    checked_size("size of the picture", size, budget, "ask for fewer pixels, or write SVG").map(drop)
}

/// Pixels of a picture for its page.
pub(crate) fn resolution(output: &OutputOptions) -> Result<Resolution> {
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
