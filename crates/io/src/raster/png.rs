//! PNG: pictures of results, with their resolution and their recipe.

use std::io;

use arabesque_core::{Budget, Image, Result};

use crate::{
    raster::{
        drawn::Drawn,
        filtered::{Filtered, refused},
        size::{Picture, checked_size, shrunk},
    },
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
pub(super) const RECIPE_KEYWORD: &str = "arabesque recipe";

/// Most bytes of a recipe that was compressed.
const RECIPE: usize = 64 << 20;
/// Most bytes of one chunk, by the format.
const CHUNK: usize = (u32::MAX >> 1) as usize;
/// Bytes of a file beside its pixels and its recipe, roughly.
const HEADER: usize = 256;

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
/// [`arabesque_core::Error::Limit`] when it would have more than [`arabesque_core::Limits::pixels`] pixels, [`arabesque_core::Error::Input`] when the text cannot be
/// drawn.
pub fn write_png(job: &RenderJob<'_>, budget: &Budget) -> Result<Vec<u8>> {
    write_within(job, usize::MAX, budget).map(|picture| picture.bytes)
}

/// As [`write_png`], but with `most` pixels, in the same proportion, where it would have more.
///
/// # Errors
/// As [`write_png`].
pub fn write_within(job: &RenderJob<'_>, most: usize, budget: &Budget) -> Result<Picture> {
    let drawn = Drawn::read("drawing the result", job.svg, budget)?;
    let page = drawn.page();
    let scale = match job.resolution {
        Resolution::PerInch(dpi) => [dpi / PIXELS_PER_INCH; 2],
        Resolution::PerUnit(n) => [n * job.units[0] / page[0], n * job.units[1] / page[1]],
    };
    // A clamp keeps NaN, which the limit below then refuses.
    let wanted = [0, 1].map(|k: usize| (page[k] * scale[k]).round().clamp(1.0, f64::MAX));
    let size = shrunk(wanted, most);
    let advice = "ask for fewer pixels, or write SVG";
    let pixels = checked_size("size of the picture", size, budget, advice)?.map(|n| n as usize);
    let per_metre = size[0] / page[0] * PIXELS_PER_INCH * INCHES_PER_METRE;
    let bytes = write_rows(pixels, per_metre, job.recipe, budget, |write| drawn.rows(size, |_, row| write(row)))?;
    Ok(Picture { bytes, size: pixels, wanted: wanted.map(|n| n as usize) })
}

/// Draws an SVG text as PNG, `scale` pixels per user unit of a page of `units`, without what lies where `hidden` holds; errors call the
/// text `name`.
///
/// # Errors
/// As [`write_png`].
pub fn write_drawing(
    (name, text): (&str, &str),
    (units, scale): ([f64; 2], f64),
    hidden: &dyn Fn(usize, usize) -> bool,
    (per_metre, recipe): (f64, Option<&str>),
    budget: &Budget,
) -> Result<Vec<u8>> {
    let size = units.map(|u| (u * scale).round().max(1.0));
    let advice = "make the page of the drawing less long and narrow";
    let pixels = checked_size(&format!("{name}: size as a picture"), size, budget, advice)?.map(|n| n as usize);
    let drawn = Drawn::read(name, text, budget)?;
    let mut shown = Vec::new();
    write_rows(pixels, per_metre, recipe, budget, |write| {
        drawn.rows(size, |y, row| {
            shown.clear();
            shown.extend(row.iter().enumerate().map(|(x, pixel)| if hidden(x, y) { [0; 4] } else { *pixel }));
            write(&shown)
        })
    })
}

/// Writes a picture with straight alpha as PNG.
///
/// # Errors
/// [`arabesque_core::Error::Input`] when the encoder refuses it, [`arabesque_core::Error::Limit`] when the work or the memory is used up.
pub fn write_image(image: &Image, per_metre: f64, recipe: Option<&str>, budget: &Budget) -> Result<Vec<u8>> {
    write_rows([image.width, image.height], per_metre, recipe, budget, |write| {
        image.pixels.chunks(image.width.max(1)).try_for_each(write)
    })
}

/// Writes the rows that `rows` hands over as PNG: RGBA with straight alpha, from the top.
///
/// # Errors
/// As [`write_image`], and those of `rows`.
pub fn write_rows(
    size: [usize; 2],
    per_metre: f64,
    recipe: Option<&str>,
    budget: &Budget,
    rows: impl FnOnce(&mut dyn FnMut(&[[u8; 4]]) -> Result<()>) -> Result<()>,
) -> Result<Vec<u8>> {
    let refuse = |e: png::EncodingError| refused(&e.into());
    let [width, height] = size.map(|n| n as u32);
    let mut filtered = Filtered::new(size[0], budget)?;
    rows(&mut |row| filtered.row(row))?;
    let (pixels, _held) = filtered.finish()?;
    let room = pixels.len() + recipe.map_or(0, str::len) + HEADER;
    let (mut file, _file) = budget.list("bytes of the picture", room)?;
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let density = per_metre.round().clamp(1.0, f64::from(u32::MAX)) as u32;
    encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: density, yppu: density, unit: png::Unit::Meter }));
    if let Some(recipe) = recipe {
        encoder.add_itxt_chunk(RECIPE_KEYWORD.into(), recipe.into()).map_err(refuse)?;
    }
    let mut writer = encoder.write_header().map_err(refuse)?;
    pixels.chunks(CHUNK).try_for_each(|part| writer.write_chunk(png::chunk::IDAT, part)).map_err(refuse)?;
    writer.finish().map_err(refuse)?;
    Ok(file)
}

/// The recipe in a picture that [`write_png`] wrote.
pub fn recipe_of(bytes: &[u8]) -> Option<String> {
    let mut decoder = png::Decoder::new(io::Cursor::new(bytes));
    decoder.set_ignore_iccp_chunk(true);
    let reader = decoder.read_info().ok()?;
    let mut chunk = reader.info().utf8_text.iter().find(|c| c.keyword == RECIPE_KEYWORD)?.clone();
    // Ours are not compressed; what is, may not be larger than a text could be.
    chunk.decompress_text_with_limit(RECIPE).ok()?;
    chunk.get_text().ok()
}

/// Whether the bytes start as a PNG file does.
pub fn is_png(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x89PNG\r\n\x1a\n")
}

#[cfg(test)]
mod tests {
    use arabesque_core::Error;

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
    fn pictures_are_coarser_where_they_would_have_too_many_pixels() {
        let job = |most| {
            let resolution = Resolution::PerUnit(30.0);
            let job = RenderJob { svg: SQUARE, units: [20.0, 10.0], resolution, recipe: Some("a = 1") };
            write_within(&job, most, &Budget::default()).unwrap()
        };
        let coarse = job(20_000);
        assert_eq!((coarse.size, coarse.wanted, size(&coarse.bytes)), ([200, 100], [600, 300], (200, 100)));
        assert_eq!(recipe_of(&coarse.bytes).unwrap(), "a = 1");
        assert_eq!(job(200_000).size, [600, 300]);
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
