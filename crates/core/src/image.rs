//! Pictures in memory.

/// A picture of straight RGBA, 8 bits a channel, row by row from the top.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Image {
    /// Pixels along a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` pixels: red, green, blue, alpha; the colours are sRGB and not multiplied by alpha.
    pub pixels: Vec<[u8; 4]>,
}

impl Image {
    /// A picture of fully transparent pixels.
    pub fn transparent(width: usize, height: usize) -> Self {
        Self { width, height, pixels: vec![[0; 4]; width * height] }
    }

    /// The pixel in column `x` of row `y`.
    pub fn pixel(&self, x: usize, y: usize) -> [u8; 4] {
        self.pixels[y * self.width + x]
    }
}
