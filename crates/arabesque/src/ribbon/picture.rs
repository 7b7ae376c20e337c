//! Ribbons as pictures.

use arabesque_core::{Budget, Error, Result, Vector};
use arabesque_io::{
    raster::{
        png,
        size::{Picture, checked_size},
    },
    svg::Page,
    text::unit::{INCHES_PER_METRE, PIXELS_PER_INCH},
};
use arabesque_ribbons::{Canvas, Mask, Ribbon, StripExemplar, render_rows};

use crate::{
    artwork::{Encoded, Sheet, draft},
    recipe::{OutputOptions, pixels_per_user},
};

/// Pixels per user unit of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pixels(pub(crate) f64);

/// The resolution that `output` asks for: one pixel per user unit by default.
pub(crate) fn resolution_of_canvas(output: &OutputOptions, page: Option<&Page>) -> Result<Pixels> {
    let (name, value, scale) = match (output.dpi, output.pixels_per_unit) {
        (None, None) => return Ok(Pixels(1.0)),
        (Some(_), Some(_)) => {
            return Err(Error::parameter("dpi", "given with pixels-per-unit", "only one of the two"));
        }
        (Some(dpi), None) => ("dpi", dpi, dpi / PIXELS_PER_INCH * page.map_or(1.0, pixels_per_user)),
        (None, Some(n)) => ("pixels-per-unit", n, n),
    };
    if value.is_finite() && value > 0.0 {
        Ok(Pixels(scale))
    } else {
        Err(Error::parameter(name, value, "a positive number"))
    }
}

impl Pixels {
    /// The picture of a page.
    fn canvas(self, page: &Page, budget: &Budget) -> Result<Canvas> {
        let [width, height] = self.pixels(page, budget)?;
        Ok(Canvas { origin: page.view.min, width, height, pixels_per_unit: self.0 })
    }

    /// Pixels per metre of a picture of a page.
    fn per_metre(self, page: &Page) -> f64 {
        self.0 / pixels_per_user(page) * PIXELS_PER_INCH * INCHES_PER_METRE
    }

    /// Width and height of the picture of a page.
    ///
    /// # Errors
    /// [`Error::Limit`] beyond [`Budget::pixels`].
    pub(crate) fn pixels(self, page: &Page, budget: &Budget) -> Result<[usize; 2]> {
        // A clamp keeps NaN, which the limit below then refuses.
        let sides = page.view.size().0.map(|side| (side * self.0).round().clamp(1.0, f64::MAX));
        let advice = "ask for fewer --pixels-per-unit, or a smaller canvas with --on-canvas";
        Ok(checked_size("size of the canvas", sides, budget, advice)?.map(|side| side as usize))
    }
}

/// The resolution that `sheet` asks for, or what a draft has of it, and width and height as wanted.
fn scale_of(page: &Page, sheet: &Sheet<'_>) -> Result<(Pixels, [usize; 2])> {
    let scale = resolution_of_canvas(sheet.output, Some(page))?;
    let wanted = scale.pixels(page, sheet.budget)?;
    let share = sheet.most_pixels(draft::FLAT) as f64 / wanted.map(|n| n as f64).iter().product::<f64>();
    Ok((Pixels(scale.0 * share.sqrt().min(1.0)), wanted))
}

/// Pieces of pictures on their canvas, as PNG.
pub(crate) fn of_pieces(
    ribbons: &[Ribbon<2>],
    exemplars: &[StripExemplar],
    avoid: Option<&Mask>,
    page: &Page,
    sheet: &Sheet<'_>,
) -> Result<Encoded> {
    let (scale, wanted) = scale_of(page, sheet)?;
    let canvas = scale.canvas(page, sheet.budget)?;
    let size = [canvas.width, canvas.height];
    let bytes = png::write_rows(size, scale.per_metre(page), sheet.recipe, sheet.budget, |write| {
        render_rows((ribbons, exemplars), avoid, &canvas, sheet.budget, write)
    })?;
    Ok(draft::told(Picture { bytes, size, wanted }))
}

/// Ribbons of drawings, drawn as the vectors of `svg`, as PNG. Ink on what is to be avoided is left out, as pieces of pictures do.
pub(crate) fn of_drawing(svg: &str, avoid: Option<&Mask>, page: &Page, sheet: &Sheet<'_>) -> Result<Encoded> {
    let (scale, wanted) = scale_of(page, sheet)?;
    let canvas = scale.canvas(page, sheet.budget)?;
    let hidden = |x: usize, y: usize| {
        let at = Vector::xy(x as f64 + 0.5, y as f64 + 0.5) * (1.0 / canvas.pixels_per_unit);
        avoid.is_some_and(|mask| mask.blocks(canvas.origin + at))
    };
    let drawing = (page.view.size().0, scale.0);
    let note = (scale.per_metre(page), sheet.recipe);
    let bytes = png::write_drawing(("the ribbon", svg), drawing, &hidden, note, sheet.budget)?;
    Ok(draft::told(Picture { bytes, size: [canvas.width, canvas.height], wanted }))
}
