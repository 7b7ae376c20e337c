//! The pixels of a PNG file: filtered row by row and compressed, with the budget asked between rows.
//!
//! The encoder of the `png` crate takes a picture as a whole, or row by row in parts of its own choosing. What is written here has the
//! same bytes as its pictures that are written as a whole, and needs neither the picture nor a copy of it.

use std::io::{self, Write};

use arabesque_core::{Budget, Error, Held, Result};
use flate2::{Compression, write::ZlibEncoder};

/// Bytes of a pixel, which filters look back by.
const PIXEL: usize = 4;
/// Work of filtering and compressing one pixel.
const COMPRESSING: u64 = 40;
/// Least by which the compressed bytes grow.
const GROWTH: usize = 1 << 16;

/// Filters by their numbers in the format, in the order in which they are tried. Of equally good ones the last is taken.
const FILTERS: [u8; 4] = [UP, SUB, AVERAGE, PAETH];
const SUB: u8 = 1;
const UP: u8 = 2;
const AVERAGE: u8 = 3;
const PAETH: u8 = 4;

/// Of the three bytes the one that is nearest to what a plane through them gives [PNG, "Paeth"].
fn nearest(left: u8, above: u8, corner: u8) -> u8 {
    let [a, b, c] = [left, above, corner].map(i16::from);
    let [pa, pb, pc] = [(b - c).abs(), (a - c).abs(), (a + b - 2 * c).abs()];
    if pa <= pb && pa <= pc {
        left
    } else if pb <= pc {
        above
    } else {
        corner
    }
}

/// Takes rows of straight RGBA, and gives the compressed bytes of the picture.
pub(super) struct Filtered<'a> {
    budget: &'a Budget,
    zlib: ZlibEncoder<Growing<'a>>,
    /// The row before, and room for two ways to filter a row, each behind the number of its filter.
    before: Vec<u8>,
    best: Vec<u8>,
    tried: Vec<u8>,
    _held: Held,
}

impl<'a> Filtered<'a> {
    pub(super) fn new(width: usize, budget: &'a Budget) -> Result<Self> {
        let bytes = width.saturating_mul(PIXEL);
        let held = budget.hold("rows of the picture", bytes.saturating_mul(3))?;
        let file = Growing { bytes: Vec::new(), held: Vec::new(), budget };
        let zlib = ZlibEncoder::new(file, Compression::default());
        let (before, best) = (vec![0; bytes], vec![0; bytes + 1]);
        Ok(Self { budget, zlib, before, tried: best.clone(), best, _held: held })
    }

    pub(super) fn row(&mut self, row: &[[u8; 4]]) -> Result<()> {
        self.budget.spend(COMPRESSING * row.len() as u64)?;
        let row = row.as_flattened();
        let mut least = u64::MAX;
        for number in FILTERS {
            self.tried[0] = number;
            let (before, out) = (&self.before[..], &mut self.tried[1..]);
            match number {
                SUB => filter(|left, _, _| left, row, before, out),
                UP => filter(|_, above, _| above, row, before, out),
                AVERAGE => filter(|left, above, _| (left & above) + ((left ^ above) >> 1), row, before, out),
                _ => filter(nearest, row, before, out),
            }
            let size: u64 = self.tried[1..].iter().map(|&b| u64::from((b as i8).unsigned_abs())).sum();
            if size <= least {
                least = size;
                std::mem::swap(&mut self.best, &mut self.tried);
                if size == 0 {
                    break;
                }
            }
        }
        self.before.copy_from_slice(row);
        self.zlib.write_all(&self.best).map_err(|e| refused(&e))
    }

    /// The bytes, when all rows were taken, and their memory.
    pub(super) fn finish(self) -> Result<(Vec<u8>, Vec<Held>)> {
        let file = self.zlib.finish().map_err(|e| refused(&e))?;
        Ok((file.bytes, file.held))
    }
}

/// What a filter leaves of a row: `predict` tells a byte from the one to the left, the one above, and the one above that.
fn filter(predict: impl Fn(u8, u8, u8) -> u8, row: &[u8], before: &[u8], out: &mut [u8]) {
    for k in 0..PIXEL.min(row.len()) {
        out[k] = row[k].wrapping_sub(predict(0, before[k], 0));
    }
    let sides = row.iter().zip(before.iter().zip(before.iter().skip(PIXEL)));
    for ((out, byte), (left, (corner, above))) in out.iter_mut().zip(row).skip(PIXEL).zip(sides) {
        *out = byte.wrapping_sub(predict(*left, *above, *corner));
    }
}

/// Bytes while they come, their memory held.
struct Growing<'a> {
    bytes: Vec<u8>,
    held: Vec<Held>,
    budget: &'a Budget,
}

impl Write for Growing<'_> {
    fn write(&mut self, data: &[u8]) -> io::Result<usize> {
        if self.bytes.capacity() - self.bytes.len() < data.len() {
            let more = (self.bytes.len() / 4).max(data.len()).max(GROWTH);
            self.held.push(self.budget.hold("bytes of the picture", more).map_err(io::Error::other)?);
            self.bytes.try_reserve_exact(more).map_err(io::Error::other)?;
        }
        self.bytes.extend_from_slice(data);
        Ok(data.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Why the encoder stopped: what the budget said, or something of its own.
pub(super) fn refused(error: &io::Error) -> Error {
    match error.get_ref().and_then(|inner| inner.downcast_ref::<Error>()) {
        Some(Error::Limit { what, found, limit, advice }) => {
            Error::Limit { what: what.clone(), found: found.clone(), limit: limit.clone(), advice: advice.clone() }
        }
        _ => Error::input("writing the picture", error.to_string(), "write it as SVG instead"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_those_of_a_picture_that_is_written_as_a_whole() {
        let noise = |k: usize| (k.wrapping_mul(2_654_435_761) >> 7) as u8;
        let smooth = |k: usize| (k / 3) as u8;
        let flat = |_: usize| 7;
        for (width, height) in [(1, 1), (1, 9), (7, 3), (40, 30), (333, 21)] {
            for (k, of) in [&noise as &dyn Fn(usize) -> u8, &smooth, &flat].into_iter().enumerate() {
                let pixels: Vec<[u8; 4]> = (0..width * height)
                    .map(|p| std::array::from_fn(|c| if p % 11 < 8 { of(4 * p + c) } else { 0 }))
                    .collect();
                let mut whole = Vec::new();
                let mut encoder = png::Encoder::new(&mut whole, width as u32, height as u32);
                encoder.set_color(png::ColorType::Rgba);
                encoder.write_header().unwrap().write_image_data(pixels.as_flattened()).unwrap();
                let budget = Budget::default();
                let mut filtered = Filtered::new(width, &budget).unwrap();
                pixels.chunks(width).for_each(|row| filtered.row(row).unwrap());
                let bytes = filtered.finish().unwrap().0;
                // Signature, header and the head of the first chunk come before, two checksums and the end after.
                assert_eq!(whole[41..whole.len() - 16], bytes, "{width} x {height}, {k}");
            }
        }
    }
}
