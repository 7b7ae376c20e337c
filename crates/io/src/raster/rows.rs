//! PNG pictures row by row: only interlaced ones are ever held as a whole.

use std::io::Cursor;

use arabesque_core::{Budget, Error, Held, Result};
use png::{BitDepth, ColorType, DecodingError, InterlaceInfo, Transformations};

use crate::{
    file::called,
    raster::{palette, png::is_png},
};

/// Work of decoding one byte of a row and of looking at it.
const BYTE: u64 = 4;
/// Rows of the size of the longest that the decoder and its reader hold at one time.
const HELD_ROWS: usize = 4;
/// Most bytes of a chunk that is not image data, which the decoder holds as a whole.
const CHUNK: usize = 64 << 20;

/// A picture whose header was read and found to be within the limits.
pub(crate) struct Rows<'a> {
    name: &'a str,
    budget: &'a Budget,
    reader: png::Reader<Cursor<&'a [u8]>>,
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Channels of a pixel: palettes are expanded, a transparent colour is alpha.
    pub(crate) kind: ColorType,
    /// 8 or 16 bits.
    pub(crate) depth: BitDepth,
    _held: Held,
}

/// Width and height, as the header of a PNG picture has them.
///
/// # Errors
/// [`Error::Input`] when `bytes` is something else, or has no such header.
pub fn picture_size(name: &str, bytes: &[u8]) -> Result<[usize; 2]> {
    check_kind(name, bytes)?;
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    let info = decoder.read_header_info().map_err(|e| broken(name, &e))?;
    Ok([info.width as usize, info.height as usize])
}

impl<'a> Rows<'a> {
    /// Reads what stands before the pixels.
    ///
    /// # Errors
    /// [`Error::Input`] when `bytes` is something else or broken, [`Error::Limit`] beyond [`arabesque_core::Limits::pixels`], or when
    /// its rows are too long for the memory.
    pub(crate) fn open(name: &'a str, bytes: &'a [u8], budget: &'a Budget) -> Result<Self> {
        let [width, height] = picture_size(name, bytes)?;
        if width.saturating_mul(height) > budget.limits().pixels {
            return Err(Error::Limit {
                what: format!("{name}: size of the picture"),
                found: format!("{width} x {height} pixels"),
                limit: format!("{} pixels", budget.limits().pixels),
                advice: format!(
                    "scale the picture down; a few hundred pixels are enough; or raise the limit with --limit pixels={}",
                    width.saturating_mul(height)
                ),
            });
        }
        // Before the palette and the transparent colour are known: four channels of 16 bits at most.
        let row = width.saturating_mul(8);
        let room = row.saturating_mul(HELD_ROWS).saturating_add(bytes.len().min(CHUNK));
        let held = budget.hold(&format!("{name}: rows of the picture"), room)?;
        let limits = png::Limits { bytes: row.saturating_add(CHUNK) };
        let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
        decoder.set_transformations(Transformations::EXPAND);
        // Nobody asks for them, and compressed ones may be as large as they like.
        decoder.set_ignore_text_chunk(true);
        decoder.set_ignore_iccp_chunk(true);
        let reader = decoder.read_info().map_err(|e| broken(name, &e))?;
        if !palette::is_sound(reader.info()) {
            let problem = "broken PNG: its palette is not a list of colours of three bytes each";
            return Err(Error::input(name, problem, "save the picture again"));
        }
        let (kind, depth) = reader.output_color_type();
        Ok(Self { name, budget, reader, width, height, kind, depth, _held: held })
    }

    /// Bytes of a pixel.
    fn pixel(&self) -> usize {
        self.kind.samples() * if self.depth == BitDepth::Sixteen { 2 } else { 1 }
    }

    /// Shows the bytes of each row to `visit`, from the top, with its number.
    ///
    /// # Errors
    /// [`Error::Input`] when the picture is broken or ends too early, [`Error::Limit`] when the work is used up, and those of `visit`.
    pub(crate) fn each(mut self, mut visit: impl FnMut(usize, &[u8]) -> Result<()>) -> Result<()> {
        let work = ((self.width * self.pixel()) as u64).saturating_mul(BYTE);
        self.budget.foresee(work.saturating_mul(self.height as u64))?;
        if self.reader.info().interlaced {
            return self.each_of_whole(work, visit);
        }
        for y in 0..self.height {
            self.budget.spend(work)?;
            let row = self.reader.next_row().map_err(|e| broken(self.name, &e))?;
            visit(y, row.ok_or_else(|| short(self.name))?.data())?;
        }
        // The checksum of what was read comes after the last row.
        self.reader.next_row().map_err(|e| broken(self.name, &e)).map(|_| ())
    }

    /// The same of an interlaced picture, whose rows are complete when all of it was read.
    fn each_of_whole(mut self, work: u64, mut visit: impl FnMut(usize, &[u8]) -> Result<()>) -> Result<()> {
        let (stride, bits) = (self.width * self.pixel(), (8 * self.pixel()) as u8);
        let what = format!("{}: an interlaced picture, which is held as a whole", self.name);
        let (mut whole, _held) = self.budget.list::<u8>(&what, stride.saturating_mul(self.height))?;
        whole.resize(stride * self.height, 0);
        while let Some(row) = self.reader.next_interlaced_row().map_err(|e| broken(self.name, &e))? {
            self.budget.spend(work)?;
            let InterlaceInfo::Adam7(place) = row.interlace() else { return Err(short(self.name)) };
            png::expand_interlaced_row(&mut whole, stride, row.data(), place, bits);
        }
        whole.chunks_exact(stride).enumerate().try_for_each(|(y, row)| visit(y, row))
    }
}

fn check_kind(name: &str, bytes: &[u8]) -> Result<()> {
    if is_png(bytes) {
        return Ok(());
    }
    let kind = called(bytes);
    let advice = if kind.contains("picture") { "save the picture as PNG" } else { "give a PNG picture" };
    Err(Error::input(name, format!("{kind}, where a PNG picture was expected"), advice))
}

fn broken(name: &str, error: &DecodingError) -> Error {
    if matches!(error, DecodingError::LimitsExceeded) {
        return Error::Limit {
            what: format!("{name}: a part of the file beside the picture itself"),
            found: format!("more than {CHUNK} bytes"),
            limit: format!("{CHUNK} bytes"),
            advice: "save the picture again, without anything else in the file".into(),
        };
    }
    Error::input(name, format!("broken PNG: {error}"), "save the picture again")
}

fn short(name: &str) -> Error {
    Error::input(name, "broken PNG: fewer rows than its header says", "save the picture again")
}

#[cfg(test)]
mod tests {
    use arabesque_core::Limits;

    use super::*;

    #[test]
    fn a_palette_of_parts_of_colours_is_refused() {
        for (colours, sound) in [(3, true), (14, false), (767, false), (768, true)] {
            let mut bytes = Vec::new();
            let mut encoder = png::Encoder::new(&mut bytes, 2, 1);
            encoder.set_color(ColorType::Indexed);
            encoder.set_palette(vec![7; colours]);
            encoder.write_header().unwrap().write_image_data(&[0, 0]).unwrap();
            let budget = Budget::default();
            let message = Rows::open("t.png", &bytes, &budget).err().map(|e| e.to_string());
            assert_eq!(message.is_none(), sound, "{colours}: {message:?}");
            assert_eq!(palette::is_broken(&bytes), !sound);
        }
    }

    /// A gray picture of `width` x `height` pixels.
    fn gray(width: u32, height: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(ColorType::Grayscale);
        let data: Vec<u8> = (0..width * height).map(|k| (k % 251) as u8).collect();
        encoder.write_header().unwrap().write_image_data(&data).unwrap();
        bytes
    }

    fn rows(bytes: &[u8], budget: &Budget) -> Result<Vec<Vec<u8>>> {
        let mut rows = Vec::new();
        Rows::open("p.png", bytes, budget)?.each(|y, row| {
            assert_eq!(y, rows.len());
            rows.push(row.to_vec());
            Ok(())
        })?;
        Ok(rows)
    }

    #[test]
    fn rows_come_from_the_top_and_little_is_held() {
        let (bytes, budget) = (gray(40, 3000), Budget::new(Limits { memory: 1 << 20, ..Limits::default() }));
        let rows = rows(&bytes, &budget).unwrap();
        assert_eq!((rows.len(), rows[7][3]), (3000, ((7 * 40 + 3) % 251) as u8));
        assert!(budget.work() >= 40 * 3000 * BYTE);
    }

    #[test]
    fn what_is_cut_short_is_an_error_wherever() {
        let bytes = gray(40, 30);
        for end in [8, 20, 33, 60, bytes.len() / 2, bytes.len() - 14] {
            let error = rows(&bytes[..end], &Budget::default()).unwrap_err().to_string();
            assert!(error.contains("p.png: broken PNG"), "{end}: {error}");
        }
    }

    #[test]
    fn numbers_in_the_header_are_checked_before_anything_is_held() {
        let mut bytes = gray(4, 4);
        // The checksum of the header is not looked at before its numbers are.
        for (width, height, word) in [(u32::MAX >> 1, u32::MAX >> 1, "pixels"), (100_000_000, 1, "memory")] {
            bytes[16..20].copy_from_slice(&width.to_be_bytes());
            bytes[20..24].copy_from_slice(&height.to_be_bytes());
            let sum = crc(&bytes[12..29]);
            bytes[29..33].copy_from_slice(&sum.to_be_bytes());
            let error = rows(&bytes, &Budget::default()).unwrap_err();
            assert!(matches!(error, Error::Limit { .. }) && error.to_string().contains(word), "{error}");
        }
    }

    #[test]
    fn work_and_requests_to_stop_are_heard_while_rows_are_read() {
        let bytes = gray(4000, 400);
        let small = Budget::new(Limits { work: 1, ..Limits::default() });
        assert!(matches!(rows(&bytes, &small), Err(Error::Limit { .. })));
        let stopped = Budget::stopping_at(Limits::default(), 30);
        assert!(matches!(rows(&bytes, &stopped), Err(Error::Stopped { .. })));
    }

    fn crc(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(u32::MAX, |sum, &byte| {
            (0..8).fold(sum ^ u32::from(byte), |s, _| if s & 1 == 1 { s >> 1 ^ 0xEDB8_8320 } else { s >> 1 })
        })
    }
}
