//! Pictures as fields: gray as a number, hue as a direction.

use arabesque_core::{Bounds, Budget, Error, Grid, Matrix, OrientationField, Result, ScalarField, Vector};

use crate::raster::png::is_png;

/// Fields are smooth; larger pictures are averaged down to this many nodes along the longer side.
const MAX_NODES: usize = 512;
/// Colours less saturated than this have no hue worth following.
const MIN_CHROMA: f64 = 0.05;

/// A picture, as colours over white.
#[derive(Clone, Debug)]
pub struct Picture {
    width: usize,
    height: usize,
    /// sRGB in [0, 1], row by row from the top.
    pixels: Vec<[f32; 3]>,
}

impl Picture {
    /// Reads a PNG picture: gray or colour, with or without palette and alpha, up to 16 bits per channel. Transparent
    /// parts show white.
    ///
    /// # Errors
    /// [`Error::Input`] when `bytes` is something else or broken, [`Error::Limit`] beyond [`arabesque_core::Limits::pixels`].
    pub fn read(name: &str, bytes: &[u8], budget: &Budget) -> Result<Self> {
        let raw = decode(name, bytes, budget)?;
        let pixels = colours(&raw.samples, raw.kind, raw.depth);
        Ok(Self { width: raw.width, height: raw.height, pixels })
    }

    /// Brightness as a number over `bounds`: black is `range[0]`, white is `range[1]`, linear in between.
    pub fn scalar_field(&self, bounds: Bounds<2>, range: [f64; 2]) -> ScalarField<2> {
        let luminance = |c: [f32; 3]| f64::from(0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]);
        let grid = self.grid(bounds, |c| [luminance(c), 0.0]);
        let values = grid.values.iter().map(|v| range[0] + (range[1] - range[0]) * v[0]).collect();
        ScalarField::Grid(Grid { bounds: grid.bounds, nodes: grid.nodes, values })
    }

    /// Hue as a direction over `bounds`: red is 0 degrees, yellow 60, green 120, and so on; in a gray picture black is
    /// 0 and white 360. Gray parts of a coloured picture have no direction of their own and follow their surroundings
    /// where these are averaged.
    ///
    /// # Errors
    /// [`Error::Input`] naming `place` when the picture is of one gray value, which says nothing about direction.
    pub fn orientation_field(&self, place: &str, bounds: Bounds<2>) -> Result<OrientationField<2>> {
        let coloured = self.pixels.iter().any(|&c| chroma(c) > MIN_CHROMA);
        let first = self.pixels.first().copied().unwrap_or_default();
        if !coloured && self.pixels.iter().all(|&c| (c[0] - first[0]).abs() < 1e-3) {
            let problem = "one gray value all over, where hue or gray was expected to give the direction";
            return Err(Error::input(place, problem, "give the direction in degrees instead, or paint a picture"));
        }
        let unit = |turns: f64| {
            let (s, c) = (turns * std::f64::consts::TAU).sin_cos();
            [c, s]
        };
        let grid = self.grid(bounds, |c| match (coloured, chroma(c) > MIN_CHROMA) {
            (true, true) => unit(hue(c)),
            (true, false) => [0.0, 0.0],
            (false, _) => unit(f64::from(c[0])),
        });
        let values = grid.values.iter().map(|v| Matrix::rotation(v[1].atan2(v[0]))).collect();
        Ok(OrientationField::Grid(Grid { bounds: grid.bounds, nodes: grid.nodes, values }))
    }

    /// Means of `value` over the pixels of each node. Nodes are pixel centres: half a node inside the bounds.
    fn grid(&self, bounds: Bounds<2>, value: impl Fn([f32; 3]) -> [f64; 2]) -> Grid<2, [f64; 2]> {
        let step = self.width.max(self.height).div_ceil(MAX_NODES).max(1);
        let nodes = [self.width.div_ceil(step), self.height.div_ceil(step)];
        let mut sums = vec![([0.0, 0.0], 0.0); nodes[0] * nodes[1]];
        for (k, &colour) in self.pixels.iter().enumerate() {
            let (x, y) = (k % self.width / step, k / self.width / step);
            let (sum, n) = &mut sums[y * nodes[0] + x];
            let v = value(colour);
            sum[0] += v[0];
            sum[1] += v[1];
            *n += 1.0;
        }
        let values = sums.iter().map(|(sum, n)| [sum[0] / n, sum[1] / n]).collect();
        let half = Vector::xy(0.5 / nodes[0] as f64, 0.5 / nodes[1] as f64).zip(bounds.size(), |h, s| h * s);
        Grid { bounds: Bounds::new(bounds.min + half, bounds.max - half), nodes, values }
    }
}

/// Samples as a PNG file has them: palettes and less than 8 bits expanded.
pub(crate) struct Raw {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) samples: Vec<u8>,
    pub(crate) kind: png::ColorType,
    pub(crate) depth: png::BitDepth,
}

/// Reads the samples of a PNG picture.
///
/// # Errors
/// As [`Picture::read`].
pub(crate) fn decode(name: &str, bytes: &[u8], budget: &Budget) -> Result<Raw> {
    if !is_png(bytes) {
        let problem = format!("{} where a PNG picture was expected", kind_of(bytes));
        return Err(Error::input(name, problem, "save the picture as PNG"));
    }
    let broken = |e: png::DecodingError| Error::input(name, format!("broken PNG: {e}"), "save the picture again");
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(broken)?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    if width.saturating_mul(height) > budget.limits().pixels {
        return Err(Error::Limit {
            what: format!("{name}: size of the picture"),
            found: format!("{width} x {height} pixels"),
            limit: format!("{} pixels", budget.limits().pixels),
            advice: "scale the picture down; a few hundred pixels are enough".into(),
        });
    }
    let size = reader.output_buffer_size().ok_or_else(|| Error::input(name, "too large", "scale it down"))?;
    let mut buffer = vec![0; size];
    let frame = reader.next_frame(&mut buffer).map_err(broken)?;
    buffer.truncate(frame.buffer_size());
    Ok(Raw { width, height, samples: buffer, kind: frame.color_type, depth: frame.bit_depth })
}

fn kind_of(bytes: &[u8]) -> &'static str {
    match bytes {
        [] => "an empty file",
        [0xFF, 0xD8, ..] => "a JPEG picture",
        [b'G', b'I', b'F', ..] => "a GIF picture",
        [b'R', b'I', b'F', b'F', ..] => "a WebP picture",
        [b'<', ..] => "an SVG or XML file",
        _ => "something else",
    }
}

fn colours(buffer: &[u8], kind: png::ColorType, depth: png::BitDepth) -> Vec<[f32; 3]> {
    let channels = kind.samples();
    let samples: Vec<f32> = if depth == png::BitDepth::Sixteen {
        buffer.chunks_exact(2).map(|b| f32::from(u16::from_be_bytes([b[0], b[1]])) / 65535.0).collect()
    } else {
        buffer.iter().map(|&b| f32::from(b) / 255.0).collect()
    };
    let over_white = |v: f32, alpha: f32| v * alpha + 1.0 - alpha;
    samples
        .chunks_exact(channels)
        .map(|s| match *s {
            [g] => [g; 3],
            [g, a] => [over_white(g, a); 3],
            [r, g, b] => [r, g, b],
            [r, g, b, a, ..] => [r, g, b].map(|v| over_white(v, a)),
            [] => [1.0; 3],
        })
        .collect()
}

fn chroma(c: [f32; 3]) -> f64 {
    f64::from(c[0].max(c[1]).max(c[2]) - c[0].min(c[1]).min(c[2]))
}

/// Hue in turns, in [0, 1).
fn hue(c: [f32; 3]) -> f64 {
    let [r, g, b] = c.map(f64::from);
    let spread = chroma(c).max(f64::MIN_POSITIVE);
    let sixths = if r >= g && r >= b {
        (g - b) / spread
    } else if g >= b {
        2.0 + (b - r) / spread
    } else {
        4.0 + (r - g) / spread
    };
    (sixths / 6.0).rem_euclid(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encode(width: u32, kind: png::ColorType, depth: png::BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, 1);
        encoder.set_color(kind);
        encoder.set_depth(depth);
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Picture> {
        Picture::read("p.png", bytes, &Budget::default())
    }

    fn unit_box() -> Bounds<2> {
        Bounds::new(Vector::ZERO, Vector::xy(2.0, 1.0))
    }

    #[test]
    fn gray_maps_linearly_at_8_and_16_bits() {
        for bytes in [
            encode(2, png::ColorType::Grayscale, png::BitDepth::Eight, &[0, 255]),
            encode(2, png::ColorType::Grayscale, png::BitDepth::Sixteen, &[0, 0, 255, 255]),
            encode(2, png::ColorType::Rgba, png::BitDepth::Eight, &[0, 0, 0, 255, 9, 9, 9, 0]),
        ] {
            let field = read(&bytes).unwrap().scalar_field(unit_box(), [0.5, 2.0]);
            assert!((field.at(Vector::xy(0.2, 0.5)) - 0.5).abs() < 1e-6);
            assert!((field.at(Vector::xy(1.0, 0.5)) - 1.25).abs() < 1e-6);
            assert!((field.at(Vector::xy(1.9, 0.5)) - 2.0).abs() < 1e-6);
        }
    }

    #[test]
    fn hue_is_direction() {
        let bytes = encode(2, png::ColorType::Rgb, png::BitDepth::Eight, &[255, 0, 0, 0, 255, 0]);
        let field = read(&bytes).unwrap().orientation_field("p.png", unit_box()).unwrap();
        assert!(field.at(Vector::xy(0.1, 0.5)).angle().abs() < 1e-6);
        assert!((field.at(Vector::xy(1.9, 0.5)).angle().to_degrees() - 120.0).abs() < 1e-6);
    }

    #[test]
    fn other_kinds_are_named() {
        let message = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
        assert!(message(&[0xFF, 0xD8, 0xFF]).contains("a JPEG picture where a PNG"));
        assert!(message(b"<svg/>").contains("an SVG"));
        assert!(message(b"").contains("an empty file"));
        let whole = encode(2, png::ColorType::Grayscale, png::BitDepth::Eight, &[0, 255]);
        assert!(message(&whole[..40]).contains("broken PNG"));
        let flat = encode(2, png::ColorType::Grayscale, png::BitDepth::Eight, &[7, 7]);
        assert!(read(&flat).unwrap().orientation_field("p.png", unit_box()).is_err());
    }
}
