//! Which cells of a canvas belong to a region, from outlines and from pictures.

use arabesque_core::{Bounds, Budget, Held, Outline, Result, Vector};
use resvg::tiny_skia;

use crate::raster::{image::straight_pixels, rows::Rows};

/// Alpha from which a pixel of a picture counts as opaque.
const OPAQUE: u8 = 128;
/// Brightness, of 255, below which a pixel counts as dark.
const DARK: f64 = 127.5;
/// Work of looking at one cell.
const CELL: u64 = 2;
/// Work of following one side of an outline through one row.
const SIDE_ROW: u64 = 40;

/// Cells over a canvas, each in the region or not.
#[derive(Debug)]
pub struct MaskRaster {
    /// What the cells cover.
    pub bounds: Bounds<2>,
    /// Cells along a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` cells, row by row from the top.
    pub cells: Vec<bool>,
    /// The memory of the cells.
    pub held: Held,
}

impl MaskRaster {
    /// No cell in the region.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Limit`] when the memory is used up.
    pub fn empty(bounds: Bounds<2>, width: usize, height: usize, budget: &Budget) -> Result<Self> {
        let (mut cells, held) = budget.list("cells of what is to be avoided", width.saturating_mul(height))?;
        cells.resize(width * height, false);
        Ok(Self { bounds, width, height, cells, held })
    }

    /// Adds every cell that `outline` touches.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Limit`] when the work or the memory is used up.
    pub fn add_outline(&mut self, outline: &Outline<2>, budget: &Budget) -> Result<()> {
        let size = self.bounds.size();
        let scale = [self.width as f64 / size[0], self.height as f64 / size[1]];
        let _held =
            budget.hold("the shape of what is to be avoided", self.cells.len() + 64 * outline.points().count())?;
        // A side costs as much as it crosses rows of the canvas.
        let crossed = |ring: &Vec<Vector<2>>| -> f64 {
            let row =
                |k: usize| ((ring[k % ring.len()][1] - self.bounds.min[1]) * scale[1]).clamp(0.0, self.height as f64);
            (0..ring.len()).map(|k| 1.0 + (row(k + 1) - row(k)).abs()).sum()
        };
        let rows: f64 = outline.rings.iter().map(crossed).sum();
        budget.spend((rows as u64).saturating_mul(SIDE_ROW) + CELL * self.cells.len() as u64)?;
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
        let (Some(path), Some(mut mask)) = (builder.finish(), mask) else { return Ok(()) };
        mask.fill_path(&path, tiny_skia::FillRule::EvenOdd, true, tiny_skia::Transform::identity());
        for (cell, coverage) in self.cells.iter_mut().zip(mask.data()) {
            *cell |= *coverage > 0;
        }
        Ok(())
    }

    /// Adds every cell on which a pixel lies that is opaque (alpha at least 128) and darker than half, where the PNG picture in `bytes`
    /// is stretched over the canvas. The picture is read row by row.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Input`] naming `name` when `bytes` is something else or broken, [`arabesque_core::Error::Limit`] beyond
    /// [`arabesque_core::Limits::pixels`] or when the work or the memory is used up.
    pub fn add_picture(&mut self, name: &str, bytes: &[u8], budget: &Budget) -> Result<()> {
        let rows = Rows::open(name, bytes, budget)?;
        let (pixels, kind, depth) = ([rows.width, rows.height], rows.kind, rows.depth);
        let (mut dark, _dark) = budget.list(name, pixels[0])?;
        let (mut hit, _hit) = budget.list(name, self.width)?;
        let mut first = 0;
        rows.each(|r, row| {
            dark.clear();
            dark.extend(straight_pixels(row, kind, depth).map(is_dark));
            hit.clear();
            hit.extend((0..self.width).map(|x| under(x, self.width, pixels[0]).any(|c| dark[c])));
            while first < self.height && under(first, self.height, pixels[1]).end <= r {
                first += 1;
            }
            for y in (first..self.height).take_while(|&y| under(y, self.height, pixels[1]).start <= r) {
                budget.spend(CELL * self.width as u64)?;
                let cells = &mut self.cells[y * self.width..][..self.width];
                cells.iter_mut().zip(&hit).for_each(|(cell, hit)| *cell |= hit);
            }
            Ok(())
        })
    }

    /// Whether the region has no cell, or all.
    pub fn uniform(&self) -> Option<bool> {
        let first = self.cells.first().copied()?;
        self.cells.iter().all(|c| *c == first).then_some(first)
    }
}

/// Pixels that lie on cell `k` of `cells`, of `pixels` in all.
fn under(k: usize, cells: usize, pixels: usize) -> std::ops::Range<usize> {
    let from = k * pixels / cells;
    from..((k + 1) * pixels).div_ceil(cells).max(from + 1).min(pixels)
}

fn is_dark([r, g, b, a]: [u8; 4]) -> bool {
    a >= OPAQUE && 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b) < DARK
}

#[cfg(test)]
mod tests {
    use super::*;

    fn region() -> MaskRaster {
        let bounds = Bounds::new(Vector::xy(10.0, 10.0), Vector::xy(14.0, 12.0));
        MaskRaster::empty(bounds, 4, 2, &Budget::default()).unwrap()
    }

    fn add(region: &mut MaskRaster, [width, height]: [u32; 2], pixels: &[[u8; 4]]) {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.write_header().unwrap().write_image_data(pixels.as_flattened()).unwrap();
        region.add_picture("p.png", &bytes, &Budget::default()).unwrap();
    }

    #[test]
    fn a_shape_takes_every_cell_that_it_touches() {
        let mut region = region();
        assert_eq!(region.uniform(), Some(false));
        let corners = [(11.6, 10.2), (12.4, 10.2), (12.4, 10.8), (11.6, 10.8)];
        let outline = Outline { rings: vec![corners.map(|(x, y)| Vector::xy(x, y)).to_vec()] };
        region.add_outline(&outline, &Budget::default()).unwrap();
        assert_eq!(region.cells, [false, true, true, false, false, false, false, false]);
    }

    #[test]
    fn dark_opaque_pixels_are_avoided() {
        let mut region = region();
        add(&mut region, [2, 1], &[[0, 0, 0, 100], [120, 120, 120, 255]]);
        assert_eq!(region.cells, [false, false, true, true, false, false, true, true]);
        add(&mut region, [3, 3], &[[0, 0, 0, 255]; 9]);
        assert_eq!(region.uniform(), Some(true));
    }

    #[test]
    fn rows_of_pictures_fall_on_the_cells_that_they_touch() {
        // Row 2 of 5 lies on both rows of cells, column 6 of 9 on the last two.
        let mut region = region();
        let mut pixels = [[255; 4]; 45];
        pixels[2 * 9 + 6] = [0, 0, 0, 255];
        add(&mut region, [9, 5], &pixels);
        assert_eq!(region.cells, [false, false, true, true, false, false, true, true]);
    }

    #[test]
    fn memory_and_work_are_counted() {
        let bounds = Bounds::new(Vector::ZERO, Vector::xy(4000.0, 4000.0));
        let small = Budget::new(arabesque_core::Limits { memory: 1 << 20, ..Default::default() });
        assert!(MaskRaster::empty(bounds, 4000, 4000, &small).is_err());
        let mut region = MaskRaster::empty(bounds, 4000, 4000, &Budget::default()).unwrap();
        let comb = (0..20_000).map(|k| Vector::xy(f64::from(k) / 5.0, if k % 2 == 0 { 0.0 } else { 4000.0 })).collect();
        let idle = Budget::new(arabesque_core::Limits { work: 1000, ..Default::default() });
        assert!(region.add_outline(&Outline { rings: vec![comb] }, &idle).is_err());
        assert_eq!(region.uniform(), Some(false));
    }
}
