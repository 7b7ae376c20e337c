//! Textured strips: ribbons in space as triangles that show parts of pictures.

/// A strip of triangles over one picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Strip {
    /// Corners, in user units.
    pub positions: Vec<[f64; 3]>,
    /// Where in the picture each corner lies: from 0 at the left to 1 at the right, and from 0 at the top to 1 at the
    /// bottom.
    pub texture: Vec<[f64; 2]>,
    /// Corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Strip {
    /// Adds the quadrilateral between two lines across the strip, each with its left and its right end, as two
    /// triangles.
    pub fn push(&mut self, upper: [([f64; 3], [f64; 2]); 2], lower: [([f64; 3], [f64; 2]); 2]) {
        let first = self.positions.len() as u32;
        for (position, texture) in upper.into_iter().chain(lower) {
            self.positions.push(position);
            self.texture.push(texture.map(|t| t.clamp(0.0, 1.0)));
        }
        self.triangles.extend([[first, first + 2, first + 1], [first + 1, first + 2, first + 3]]);
    }
}

/// A picture and the strip that shows it.
#[derive(Clone, Debug)]
pub struct Part {
    /// Name of the picture.
    pub name: String,
    /// The picture, as the bytes of a PNG file.
    pub picture: Vec<u8>,
    /// The triangles.
    pub strip: Strip,
}
