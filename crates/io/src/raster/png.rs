//! PNG: pictures of results, with their resolution and their recipe.

use arabesque_core::{Budget, Error, Image, Result};
use resvg::{tiny_skia, usvg};

use crate::{
    raster::size::checked_size,
    text::unit::{INCHES_PER_METRE, PIXELS_PER_INCH},
};

/// How large a picture is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// Pixels per inch of the page.
    PerInch(f64),
    /// Pixels per user unit of the page.
    PerUnit(f64),
}

impl Default for Resolution {
    fn default() -> Self {
        Self::PerInch(PIXELS_PER_INCH)
    }
}

/// Keyword of the text chunk that holds the recipe.
const RECIPE_KEYWORD: &str = "arabesque recipe";

/// What a picture is made from.
#[derive(Clone, Copy, Debug)]
pub struct RenderJob<'a> {
    /// An SVG text, as [`crate::svg::write_svg`] makes it.
    pub svg: &'a str,
    /// User units of the page along its width and height.
    pub units: [f64; 2],
    /// Size of the picture.
    pub resolution: Resolution,
    /// The recipe, as TOML.
    pub recipe: Option<&'a str>,
}

/// Draws an SVG text as PNG: RGBA with straight alpha, 8 bits per channel.
///
/// Width and height are rounded to whole pixels and the page is stretched to fit them, by less than half a pixel: the
/// picture of a seamless tile is exactly one period.
///
/// # Errors
/// [`Error::Limit`] when it would have more than [`arabesque_core::Limits::pixels`] pixels, [`Error::Input`] when the text cannot be
/// drawn.
pub fn write_png(job: &RenderJob<'_>, budget: &Budget) -> Result<Vec<u8>> {
    let fail = |problem: String| Error::input("drawing the result", problem, "write it as SVG instead");
    let tree = usvg::Tree::from_str(job.svg, &usvg::Options::default()).map_err(|e| fail(e.to_string()))?;
    let page = [f64::from(tree.size().width()), f64::from(tree.size().height())];
    let scale = match job.resolution {
        Resolution::PerInch(dpi) => [dpi / PIXELS_PER_INCH; 2],
        Resolution::PerUnit(n) => [n * job.units[0] / page[0], n * job.units[1] / page[1]],
    };
    // A clamp keeps NaN, which the limit below then refuses.
    let side = |k: usize| (page[k] * scale[k]).round().clamp(1.0, f64::MAX);
    let (width, height) = (side(0), side(1));
    let advice = "ask for fewer pixels, or write SVG";
    let [columns, rows] = checked_size("size of the picture", [width, height], budget, advice)?;
    let mut pixmap = tiny_skia::Pixmap::new(columns, rows).ok_or_else(|| fail("no pixels".into()))?;
    let stretch = tiny_skia::Transform::from_scale((width / page[0]) as f32, (height / page[1]) as f32);
    resvg::render(&tree, stretch, &mut pixmap.as_mut());
    let per_metre = width / page[0] * PIXELS_PER_INCH * INCHES_PER_METRE;
    encode(&straight(&pixmap), per_metre, job.recipe).map_err(|e| fail(e.to_string()))
}

/// Writes a picture with straight alpha as PNG.
///
/// # Errors
/// [`Error::Input`] when the encoder refuses it.
pub fn write_image(image: &Image, per_metre: f64, recipe: Option<&str>) -> Result<Vec<u8>> {
    encode(image, per_metre, recipe)
        .map_err(|e| Error::input("writing the picture", e.to_string(), "write it as SVG instead"))
}

/// The pixels with their alpha divided out.
pub(crate) fn straight(pixmap: &tiny_skia::Pixmap) -> Image {
    let pixels = pixmap
        .pixels()
        .iter()
        .map(|p| {
            let c = p.demultiply();
            [c.red(), c.green(), c.blue(), c.alpha()]
        })
        .collect();
    Image { width: pixmap.width() as usize, height: pixmap.height() as usize, pixels }
}

fn encode(image: &Image, per_metre: f64, recipe: Option<&str>) -> std::result::Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.width as u32, image.height as u32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let density = per_metre.round().clamp(1.0, f64::from(u32::MAX)) as u32;
    encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: density, yppu: density, unit: png::Unit::Meter }));
    if let Some(recipe) = recipe {
        encoder.add_itxt_chunk(RECIPE_KEYWORD.into(), recipe.into())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(image.pixels.as_flattened())?;
    writer.finish()?;
    Ok(bytes)
}

/// The recipe in a picture that [`write_png`] wrote.
pub fn recipe_of(bytes: &[u8]) -> Option<String> {
    let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().ok()?;
    let chunk = reader.info().utf8_text.iter().find(|c| c.keyword == RECIPE_KEYWORD)?;
    chunk.get_text().ok()
}

/// Whether the bytes start as a PNG file does.
pub fn is_png(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x89PNG\r\n\x1a\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"25.4mm\" height=\"12.7mm\" viewBox=\"0 0 \
         20 10\">\
                          <rect width=\"10\" height=\"10\" fill=\"#ff0000\" fill-opacity=\"0.5\"/></svg>";

    fn picture(resolution: Resolution) -> Result<Vec<u8>> {
        let job = RenderJob { svg: SQUARE, units: [20.0, 10.0], resolution, recipe: Some("ümlaut = 1\n") };
        write_png(&job, &Budget::default())
    }

    fn size(bytes: &[u8]) -> (u32, u32) {
        let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        (reader.info().width, reader.info().height)
    }

    #[test]
    fn size_follows_inches_or_units() {
        assert_eq!(size(&picture(Resolution::PerInch(200.0)).unwrap()), (200, 100));
        assert_eq!(size(&picture(Resolution::PerUnit(3.0)).unwrap()), (60, 30));
        assert!(matches!(picture(Resolution::PerUnit(1e6)), Err(Error::Limit { .. })));
        assert!(matches!(picture(Resolution::PerUnit(f64::NAN)), Err(Error::Limit { .. })));
    }

    #[test]
    fn pixels_have_straight_alpha_and_the_file_its_resolution_and_recipe() {
        let bytes = picture(Resolution::PerInch(96.0)).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
        assert_eq!(reader.info().pixel_dims.unwrap().xppu, 3780);
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert_eq!(&pixels[..4], &[255, 0, 0, 128]);
        assert_eq!(recipe_of(&bytes).unwrap(), "ümlaut = 1\n");
        assert!(is_png(&bytes));
    }
}
