//! Ribbons as pictures.

use arabesque_core::{Error, Image, Limits, Result, Vector};
use arabesque_io::{image::draw_svg, png, svg::Page};
use arabesque_ribbons::{Canvas, Mask, Ribbon, StripExemplar, render};

use crate::{
    artwork::Sheet,
    recipe::{OutputOptions, pixels_per_user},
};

/// CSS pixels per inch.
const PIXELS_PER_INCH: f64 = 96.0;
const INCHES_PER_METRE: f64 = 1.0 / 0.0254;

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
    fn canvas(self, page: &Page, limits: &Limits) -> Result<Canvas> {
        let [width, height] = self.pixels(page, limits)?;
        Ok(Canvas { origin: page.view.min, width, height, pixels_per_unit: self.0 })
    }

    /// Width and height of the picture of a page.
    ///
    /// # Errors
    /// [`Error::Limit`] beyond [`Limits::pixels`].
    pub(crate) fn pixels(self, page: &Page, limits: &Limits) -> Result<[usize; 2]> {
        // A clamp keeps NaN, which the limit below then refuses.
        let sides = page.view.size().0.map(|side| (side * self.0).round().clamp(1.0, f64::MAX));
        if sides[0] * sides[1] <= limits.pixels as f64 && sides[0].max(sides[1]) <= f64::from(i16::MAX) {
            return Ok(sides.map(|side| side as usize));
        }
        Err(Error::Limit {
            what: "size of the canvas".into(),
            found: format!("{} x {} pixels", sides[0], sides[1]),
            limit: format!("{} pixels, {} a side", limits.pixels, i16::MAX),
            advice: "ask for fewer --pixels-per-unit, or a smaller canvas with --on-canvas".into(),
        })
    }
}

/// Pieces of pictures on their canvas, as PNG.
pub(crate) fn of_pieces(
    ribbons: &[Ribbon<2>],
    exemplars: &[StripExemplar],
    avoid: Option<&Mask>,
    page: &Page,
    sheet: &Sheet<'_>,
) -> Result<Vec<u8>> {
    let scale = resolution_of_canvas(sheet.output, Some(page))?;
    encode(&render(ribbons, exemplars, avoid, &scale.canvas(page, sheet.limits)?), scale, page, sheet)
}

/// Ribbons of drawings, drawn as the vectors of `svg`, as PNG.
pub(crate) fn of_drawing(svg: &str, avoid: Option<&Mask>, page: &Page, sheet: &Sheet<'_>) -> Result<Vec<u8>> {
    let scale = resolution_of_canvas(sheet.output, Some(page))?;
    let canvas = scale.canvas(page, sheet.limits)?;
    let mut image = draw_svg("the ribbon", svg, (page.view.size().0, scale.0), sheet.limits)?;
    avoid.into_iter().for_each(|mask| clear(&mut image, mask, &canvas));
    encode(&image, scale, page, sheet)
}

fn encode(image: &Image, scale: Pixels, page: &Page, sheet: &Sheet<'_>) -> Result<Vec<u8>> {
    let per_metre = scale.0 / pixels_per_user(page) * PIXELS_PER_INCH * INCHES_PER_METRE;
    png::write_image(image, per_metre, sheet.recipe)
}

/// Leaves out ink on what is to be avoided, as pieces of pictures do.
fn clear(image: &mut Image, mask: &Mask, canvas: &Canvas) {
    for (k, pixel) in image.pixels.iter_mut().enumerate() {
        let at = Vector::xy((k % image.width) as f64 + 0.5, (k / image.width) as f64 + 0.5);
        if mask.blocks(canvas.origin + at * (1.0 / canvas.pixels_per_unit)) {
            *pixel = [0; 4];
        }
    }
}
