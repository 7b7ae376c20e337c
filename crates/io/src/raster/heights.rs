//! Height fields: gray pictures whose brightness is a height, with 16 bits where the file has them.

use arabesque_core::{Budget, Error, Held, Result};
use png::{BitDepth, ColorType};

use crate::raster::{filtered::refused, png::RECIPE_KEYWORD, rows::Rows};

/// Work units of a pixel that is written.
const WRITING: u64 = 40;

/// Heights row by row from the top, each from 0 for black to 1 for white.
#[derive(Debug)]
pub struct Heights {
    /// Pixels along a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` heights.
    pub values: Vec<f32>,
    _held: Held,
}

/// Reads a height field: gray with 8 or 16 bits, or the brightness of a picture in colours.
///
/// # Errors
/// [`Error::Input`] for what is no PNG picture, is broken, or is transparent somewhere; [`Error::Limit`] beyond the limits.
pub fn read_heights(name: &str, bytes: &[u8], budget: &Budget) -> Result<Heights> {
    let rows = Rows::open(name, bytes, budget)?;
    let (width, height, kind, depth) = (rows.width, rows.height, rows.kind, rows.depth);
    let (mut values, held) = budget.list::<f32>(&format!("{name}: the height field"), width.saturating_mul(height))?;
    let has_alpha = matches!(kind, ColorType::GrayscaleAlpha | ColorType::Rgba);
    let colours = kind.samples() - usize::from(has_alpha);
    let size = if depth == BitDepth::Sixteen { 2 } else { 1 };
    let number = |bytes: &[u8]| match *bytes {
        [high, low] => f32::from(u16::from_be_bytes([high, low])) / 65535.0,
        [one] => f32::from(one) / 255.0,
        _ => 0.0,
    };
    rows.each(|y, row| {
        for (x, pixel) in row.chunks_exact(kind.samples() * size).enumerate() {
            let mut channels = pixel.chunks_exact(size).map(number);
            let value = match colours {
                1 => channels.next().unwrap_or_default(),
                _ => [0.2126, 0.7152, 0.0722].into_iter().map(|w: f32| w * channels.next().unwrap_or_default()).sum(),
            };
            if has_alpha && channels.next().is_some_and(|alpha| alpha < 1.0) {
                let problem = format!("pixel {x}, {y} is transparent: a height field has a height everywhere");
                return Err(Error::input(name, problem, "save the picture without transparency"));
            }
            values.push(value);
        }
        Ok(())
    })?;
    Ok(Heights { width, height, values, _held: held })
}

/// Writes heights from 0 to 1, row by row from the top, as a gray PNG picture with 16 bits.
///
/// # Errors
/// [`Error::Input`] when the encoder refuses it, [`Error::Limit`] when the work or the memory is used up.
pub fn write_heights(
    [width, height]: [usize; 2],
    values: &[f32],
    recipe: Option<&str>,
    budget: &Budget,
) -> Result<Vec<u8>> {
    let refuse = |e: png::EncodingError| refused(&e.into());
    let (mut data, _data) = budget.list::<u8>("the height field", values.len() * 2)?;
    budget.spend(values.len() as u64 * WRITING)?;
    data.extend(values.iter().flat_map(|v| ((v.clamp(0.0, 1.0) * 65535.0).round() as u16).to_be_bytes()));
    let room = data.len() + recipe.map_or(0, str::len) + 4096;
    let (mut file, _file) = budget.list("bytes of the picture", room)?;
    let mut encoder = png::Encoder::new(&mut file, width as u32, height as u32);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Sixteen);
    if let Some(recipe) = recipe {
        encoder.add_itxt_chunk(RECIPE_KEYWORD.into(), recipe.into()).map_err(refuse)?;
    }
    let mut writer = encoder.write_header().map_err(refuse)?;
    writer.write_image_data(&data).map_err(refuse)?;
    writer.finish().map_err(refuse)?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_kept_with_16_bits_and_the_recipe() {
        let values: Vec<f32> = (0..12).map(|k| k as f32 / 11.0).collect();
        let bytes = write_heights([4, 3], &values, Some("seed = 1\n"), &Budget::default()).unwrap();
        let again = read_heights("h.png", &bytes, &Budget::default()).unwrap();
        assert_eq!((again.width, again.height), (4, 3));
        assert!(again.values.iter().zip(&values).all(|(a, b)| (a - b).abs() < 1e-5));
        assert_eq!(crate::raster::png::recipe_of(&bytes).as_deref(), Some("seed = 1\n"));
    }

    #[test]
    fn what_is_transparent_has_no_height() {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 2, 1);
        encoder.set_color(ColorType::GrayscaleAlpha);
        encoder.write_header().unwrap().write_image_data(&[9, 255, 9, 3]).unwrap();
        let message = read_heights("h.png", &bytes, &Budget::default()).unwrap_err().to_string();
        assert!(message.contains("pixel 1, 0"), "{message}");
        assert!(read_heights("h.png", b"GIF89a", &Budget::default()).unwrap_err().to_string().contains("GIF"));
    }
}
