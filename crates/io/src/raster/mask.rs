//! Which cells of a canvas belong to a region, from outlines and from pictures.

use arabesque_core::{Bounds, Image, Outline};
use resvg::tiny_skia;

/// Alpha from which a pixel of a picture counts as opaque.
const OPAQUE: u8 = 128;
/// Brightness, of 255, below which a pixel counts as dark.
const DARK: f64 = 127.5;

/// Cells over a canvas, each in the region or not.
#[derive(Clone, Debug, PartialEq)]
pub struct MaskRaster {
    /// What the cells cover.
    pub bounds: Bounds<2>,
    /// Cells along a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` cells, row by row from the top.
    pub cells: Vec<bool>,
}

impl MaskRaster {
    /// No cell in the region.
    pub fn empty(bounds: Bounds<2>, width: usize, height: usize) -> Self {
        Self { bounds, width, height, cells: vec![false; width * height] }
    }

    /// Adds every cell that `outline` touches.
    pub fn add_outline(&mut self, outline: &Outline<2>) {
        let size = self.bounds.size();
        let scale = [self.width as f64 / size[0], self.height as f64 / size[1]];
        let mut builder = tiny_skia::PathBuilder::new();
        for ring in &outline.rings {
            for (k, p) in ring.iter().enumerate() {
                let q = *p - self.bounds.min;
                let (x, y) = ((q[0] * scale[0]) as f32, (q[1] * scale[1]) as f32);
                if k == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
            }
            builder.close();
        }
        let mask = tiny_skia::Mask::new(self.width as u32, self.height as u32);
        let (Some(path), Some(mut mask)) = (builder.finish(), mask) else { return };
        mask.fill_path(&path, tiny_skia::FillRule::EvenOdd, true, tiny_skia::Transform::identity());
        for (cell, coverage) in self.cells.iter_mut().zip(mask.data()) {
            *cell |= *coverage > 0;
        }
    }

    /// Adds every cell on which a pixel lies that is opaque (alpha at least 128) and darker than half, where `image` is
    /// stretched over the canvas.
    pub fn add_picture(&mut self, image: &Image) {
        let dark: Vec<bool> = image.pixels.iter().map(|&p| is_dark(p)).collect();
        // Pixels that lie on cell `k` of `cells`, of `pixels` in all.
        let under = |k: usize, cells: usize, pixels: usize| {
            let from = k * pixels / cells;
            from..((k + 1) * pixels).div_ceil(cells).max(from + 1).min(pixels)
        };
        for y in 0..self.height {
            let rows = under(y, self.height, image.height);
            for x in 0..self.width {
                let mut columns = under(x, self.width, image.width);
                let hit = columns.any(|c| rows.clone().any(|r| dark[r * image.width + c]));
                self.cells[y * self.width + x] |= hit;
            }
        }
    }

    /// Whether the region has no cell, or all.
    pub fn uniform(&self) -> Option<bool> {
        let first = self.cells.first().copied()?;
        self.cells.iter().all(|c| *c == first).then_some(first)
    }
}

fn is_dark([r, g, b, a]: [u8; 4]) -> bool {
    a >= OPAQUE && 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b) < DARK
}

#[cfg(test)]
mod tests {
    use arabesque_core::Vector;

    use super::*;

    fn region() -> MaskRaster {
        MaskRaster::empty(Bounds::new(Vector::xy(10.0, 10.0), Vector::xy(14.0, 12.0)), 4, 2)
    }

    #[test]
    fn a_shape_takes_every_cell_that_it_touches() {
        let mut region = region();
        assert_eq!(region.uniform(), Some(false));
        let corners = [(11.6, 10.2), (12.4, 10.2), (12.4, 10.8), (11.6, 10.8)];
        region.add_outline(&Outline { rings: vec![corners.map(|(x, y)| Vector::xy(x, y)).to_vec()] });
        assert_eq!(region.cells, [false, true, true, false, false, false, false, false]);
    }

    #[test]
    fn dark_opaque_pixels_are_avoided() {
        let mut region = region();
        let image = Image { width: 2, height: 1, pixels: vec![[0, 0, 0, 100], [120, 120, 120, 255]] };
        region.add_picture(&image);
        assert_eq!(region.cells, [false, false, true, true, false, false, true, true]);
        region.add_picture(&Image { width: 3, height: 3, pixels: vec![[0, 0, 0, 255]; 9] });
        assert_eq!(region.uniform(), Some(true));
    }
}
