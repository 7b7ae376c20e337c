//! Pictures as they are: straight RGBA, from PNG or drawn from SVG.

use arabesque_core::{Budget, Image, Result};
use png::{BitDepth, ColorType};

use crate::raster::{drawn::Drawn, rows::Rows, size::checked_size};

/// Whether a picture says anything about transparency.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alpha {
    /// It has an alpha channel, or a transparent colour.
    Given,
    /// Every pixel is opaque by the format.
    Missing,
}

/// Reads a PNG picture: gray, colour or palette, up to 16 bits per channel.
///
/// # Errors
/// [`Error::Input`](arabesque_core::Error::Input) when `bytes` is something else or broken, [`Error::Limit`](arabesque_core::Error::Limit) beyond [`arabesque_core::Limits::pixels`] or when the work
/// or the memory is used up.
pub fn read_image(name: &str, bytes: &[u8], budget: &Budget) -> Result<(Image, Alpha)> {
    let rows = Rows::open(name, bytes, budget)?;
    let alpha = match rows.kind {
        ColorType::Rgba | ColorType::GrayscaleAlpha => Alpha::Given,
        _ => Alpha::Missing,
    };
    let (width, height, kind, depth) = (rows.width, rows.height, rows.kind, rows.depth);
    let (mut pixels, _held) = budget.list(&format!("{name}: pixels of the picture"), width * height)?;
    rows.each(|_, row| {
        pixels.extend(straight_pixels(row, kind, depth));
        Ok(())
    })?;
    Ok((Image { width, height, pixels }, alpha))
}

/// The pixels of a row as RGBA of 8 bits.
pub(crate) fn straight_pixels(row: &[u8], kind: ColorType, depth: BitDepth) -> impl Iterator<Item = [u8; 4]> + '_ {
    let channels = kind.samples();
    // Of two bytes the first is the higher one.
    let wide = if depth == BitDepth::Sixteen { 2 } else { 1 };
    row.chunks_exact(channels * wide).map(move |pixel| {
        let at = |k: usize| pixel[k * wide];
        match channels {
            1 => [at(0), at(0), at(0), 255],
            2 => [at(0), at(0), at(0), at(1)],
            3 => [at(0), at(1), at(2), 255],
            _ => [at(0), at(1), at(2), at(3)],
        }
    })
}

/// Draws an SVG text on a transparent background, `scale` pixels per user unit of its page, whose size in user units is
/// `units`.
///
/// # Errors
/// [`Error::Input`](arabesque_core::Error::Input) naming `name` when the text cannot be drawn, [`Error::Limit`](arabesque_core::Error::Limit) beyond [`arabesque_core::Limits::pixels`] or when the
/// work or the memory is used up.
pub fn draw_svg(name: &str, text: &str, (units, scale): ([f64; 2], f64), budget: &Budget) -> Result<Image> {
    let size = units.map(|u| (u * scale).round().max(1.0));
    let advice = "make the page of the drawing less long and narrow";
    let [width, height] =
        checked_size(&format!("{name}: size as a picture"), size, budget, advice)?.map(|n| n as usize);
    let drawn = Drawn::read(name, text, budget)?;
    let (mut pixels, _held) = budget.list(&format!("{name}: pixels of the picture"), width * height)?;
    drawn.rows(size, |_, row| {
        pixels.extend_from_slice(row);
        Ok(())
    })?;
    Ok(Image { width, height, pixels })
}

#[cfg(test)]
mod tests {
    use arabesque_core::Error;

    use super::*;

    fn encoded(kind: png::ColorType, depth: png::BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
        encoder.set_color(kind);
        encoder.set_depth(depth);
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    #[test]
    fn every_kind_of_pixel_becomes_rgba() {
        use png::{BitDepth as D, ColorType as C};
        for (kind, depth, data, pixel, alpha) in [
            (C::Rgba, D::Eight, &[1, 2, 3, 4][..], [1, 2, 3, 4], Alpha::Given),
            (C::Rgb, D::Eight, &[1, 2, 3], [1, 2, 3, 255], Alpha::Missing),
            (C::GrayscaleAlpha, D::Eight, &[9, 7], [9, 9, 9, 7], Alpha::Given),
            (C::Grayscale, D::One, &[0x80], [255; 4], Alpha::Missing),
            (C::Rgba, D::Sixteen, &[1, 99, 2, 99, 3, 99, 4, 99], [1, 2, 3, 4], Alpha::Given),
        ] {
            let (image, found) = read_image("p.png", &encoded(kind, depth, data), &Budget::default()).unwrap();
            assert_eq!((image.pixels[0], found), (pixel, alpha));
        }
        let error = read_image("p.png", b"GIF89a", &Budget::default()).unwrap_err().to_string();
        assert!(error.contains("p.png: a GIF picture"), "{error}");
    }

    #[test]
    fn drawings_become_pictures() {
        let text =
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 4 2'><rect width='2' height='2' fill='red'/></svg>";
        let image = draw_svg("d.svg", text, ([4.0, 2.0], 3.0), &Budget::default()).unwrap();
        assert_eq!((image.width, image.height), (12, 6));
        assert_eq!((image.pixel(5, 5), image.pixel(6, 5)), ([255, 0, 0, 255], [0; 4]));
        assert!(matches!(draw_svg("d", text, ([1e9, 1e9], 3.0), &Budget::default()), Err(Error::Limit { .. })));
    }
}
