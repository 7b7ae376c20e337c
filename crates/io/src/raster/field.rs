//! Pictures as fields: gray as a number, hue as a direction.

use arabesque_core::{Bounds, Budget, Error, Grid, Matrix, OrientationField, Result, ScalarField, Vector};
use png::{BitDepth, ColorType};

use crate::raster::rows::Rows;

/// Fields are smooth; larger pictures are averaged down to this many nodes along the longer side.
const MAX_NODES: usize = 512;
/// Colours less saturated than this have no hue worth following.
const MIN_CHROMA: f64 = 0.05;
/// Gray values that differ less than this are one.
const SAME_GRAY: f32 = 1e-3;

/// A PNG picture that stands for a field: gray or colour, with or without palette and alpha, up to 16 bits per channel. Transparent parts
/// show white. It is averaged row by row while it is read, so that its size costs time alone.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    name: &'a str,
    bytes: &'a [u8],
    budget: &'a Budget,
}

impl<'a> Picture<'a> {
    /// The picture in the file `name`.
    pub fn new(name: &'a str, bytes: &'a [u8], budget: &'a Budget) -> Self {
        Self { name, bytes, budget }
    }

    /// Brightness as a number over `bounds`: black is `range[0]`, white is `range[1]`, linear in between.
    ///
    /// # Errors
    /// [`Error::Input`] when the file is something else or broken, [`Error::Limit`] beyond [`arabesque_core::Limits::pixels`] or when the
    /// work or the memory is used up.
    pub fn scalar_field(&self, bounds: Bounds<2>, range: [f64; 2]) -> Result<ScalarField<2>> {
        let luminance = |c: [f32; 3]| f64::from(0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]);
        let rows = Rows::open(self.name, self.bytes, self.budget)?;
        let mut means = Means::of(&rows);
        let (kind, depth) = (rows.kind, rows.depth);
        rows.each(|y, row| {
            for (x, colour) in colours(row, kind, depth).enumerate() {
                means.add(x, y, [luminance(colour), 0.0]);
            }
            Ok(())
        })?;
        let (bounds, nodes) = (means.bounds(bounds), means.nodes);
        let values = means.values().map(|v| range[0] + (range[1] - range[0]) * v[0]).collect();
        Ok(ScalarField::Grid(Grid { bounds, nodes, values }))
    }

    /// Hue as a direction over `bounds`: red is 0 degrees, yellow 60, green 120, and so on; in a gray picture black is
    /// 0 and white 360. Gray parts of a coloured picture have no direction of their own and follow their surroundings
    /// where these are averaged.
    ///
    /// # Errors
    /// As [`Picture::scalar_field`], and [`Error::Input`] when the picture is of one gray value, which says nothing about direction.
    pub fn orientation_field(&self, bounds: Bounds<2>) -> Result<OrientationField<2>> {
        let rows = Rows::open(self.name, self.bytes, self.budget)?;
        // As a coloured picture, and as a gray one as long as no colour was seen.
        let (mut hues, mut grays) = (Means::of(&rows), Means::of(&rows));
        let (mut coloured, mut first, mut even) = (false, None, true);
        let (kind, depth) = (rows.kind, rows.depth);
        rows.each(|y, row| {
            for (x, colour) in colours(row, kind, depth).enumerate() {
                let has_hue = chroma(colour) > MIN_CHROMA;
                coloured |= has_hue;
                even &= (colour[0] - *first.get_or_insert(colour[0])).abs() < SAME_GRAY;
                hues.add(x, y, if has_hue { unit(hue(colour)) } else { [0.0, 0.0] });
                if !coloured {
                    grays.add(x, y, unit(f64::from(colour[0])));
                }
            }
            Ok(())
        })?;
        if !coloured && even {
            let problem = "one gray value all over, where hue or gray was expected to give the direction";
            return Err(Error::input(self.name, problem, "give the direction in degrees instead, or paint a picture"));
        }
        let means = if coloured { hues } else { grays };
        let (bounds, nodes) = (means.bounds(bounds), means.nodes);
        let values = means.values().map(|v| Matrix::rotation(v[1].atan2(v[0]))).collect();
        Ok(OrientationField::Grid(Grid { bounds, nodes, values }))
    }
}

/// Means over the pixels of each node. Nodes are pixel centres: half a node inside the bounds.
struct Means {
    /// Pixels along a side of a node.
    step: usize,
    nodes: [usize; 2],
    sums: Vec<([f64; 2], f64)>,
}

impl Means {
    fn of(rows: &Rows<'_>) -> Self {
        let step = rows.width.max(rows.height).div_ceil(MAX_NODES).max(1);
        let nodes = [rows.width.div_ceil(step), rows.height.div_ceil(step)];
        Self { step, nodes, sums: vec![([0.0, 0.0], 0.0); nodes[0] * nodes[1]] }
    }

    fn add(&mut self, x: usize, y: usize, value: [f64; 2]) {
        let (sum, n) = &mut self.sums[y / self.step * self.nodes[0] + x / self.step];
        sum[0] += value[0];
        sum[1] += value[1];
        *n += 1.0;
    }

    fn values(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.sums.iter().map(|(sum, n)| [sum[0] / n, sum[1] / n])
    }

    fn bounds(&self, whole: Bounds<2>) -> Bounds<2> {
        let [columns, rows] = self.nodes;
        let half = Vector::xy(0.5 / columns as f64, 0.5 / rows as f64).zip(whole.size(), |h, s| h * s);
        Bounds::new(whole.min + half, whole.max - half)
    }
}

/// The unit vector at an angle in turns.
fn unit(turns: f64) -> [f64; 2] {
    let (s, c) = (turns * std::f64::consts::TAU).sin_cos();
    [c, s]
}

/// The colours of a row over white, sRGB in [0, 1].
fn colours(row: &[u8], kind: ColorType, depth: BitDepth) -> impl Iterator<Item = [f32; 3]> + '_ {
    let sixteen = depth == BitDepth::Sixteen;
    let (channels, wide) = (kind.samples(), if sixteen { 2 } else { 1 });
    let sample = move |pixel: &[u8], k: usize| match (sixteen, &pixel[k * wide..]) {
        (true, [high, low, ..]) => f32::from(u16::from_be_bytes([*high, *low])) / 65535.0,
        (_, bytes) => f32::from(bytes[0]) / 255.0,
    };
    let over_white = |v: f32, alpha: f32| v * alpha + 1.0 - alpha;
    row.chunks_exact(channels * wide).map(move |pixel| {
        let at = |k: usize| sample(pixel, k);
        match channels {
            1 => [at(0); 3],
            2 => [over_white(at(0), at(1)); 3],
            3 => [at(0), at(1), at(2)],
            _ => [0, 1, 2].map(|k| over_white(at(k), at(3))),
        }
    })
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

    fn scalar(bytes: &[u8]) -> Result<ScalarField<2>> {
        Picture::new("p.png", bytes, &Budget::default()).scalar_field(unit_box(), [0.5, 2.0])
    }

    fn orientation(bytes: &[u8]) -> Result<OrientationField<2>> {
        Picture::new("p.png", bytes, &Budget::default()).orientation_field(unit_box())
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
            let field = scalar(&bytes).unwrap();
            assert!((field.at(Vector::xy(0.2, 0.5)) - 0.5).abs() < 1e-6);
            assert!((field.at(Vector::xy(1.0, 0.5)) - 1.25).abs() < 1e-6);
            assert!((field.at(Vector::xy(1.9, 0.5)) - 2.0).abs() < 1e-6);
        }
    }

    #[test]
    fn hue_is_direction() {
        let bytes = encode(2, png::ColorType::Rgb, png::BitDepth::Eight, &[255, 0, 0, 0, 255, 0]);
        let field = orientation(&bytes).unwrap();
        assert!(field.at(Vector::xy(0.1, 0.5)).angle().abs() < 1e-6);
        assert!((field.at(Vector::xy(1.9, 0.5)).angle().to_degrees() - 120.0).abs() < 1e-6);
    }

    #[test]
    fn other_kinds_are_named() {
        let message = |bytes: &[u8]| scalar(bytes).unwrap_err().to_string();
        assert!(message(&[0xFF, 0xD8, 0xFF]).contains("a JPEG picture, where a PNG"));
        assert!(message(b"<svg/>").contains("an SVG"));
        assert!(message(b"").contains("an empty file"));
        let whole = encode(2, png::ColorType::Grayscale, png::BitDepth::Eight, &[0, 255]);
        assert!(message(&whole[..40]).contains("broken PNG"));
        let flat = encode(2, png::ColorType::Grayscale, png::BitDepth::Eight, &[7, 7]);
        assert!(orientation(&flat).unwrap_err().to_string().contains("p.png: one gray value"));
    }
}
