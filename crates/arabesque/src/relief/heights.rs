//! Height fields, as textures and as results.

use arabesque_core::{Bounds, Budget, Error, PointSet, Result, Vector};
use arabesque_io::raster::{
    heights::{read_heights, write_heights},
    rows::picture_size,
};
use arabesque_reliefs::Axes;
use arabesque_surface::OrientedPoints;
use rayon::prelude::*;

/// Height of white over black, as a share of the shorter side, where nobody says.
const HEIGHT: f64 = 0.1;
/// Work units of a pixel.
const PIXEL: u64 = 3000;

/// A height field as points: one for each pixel, one unit apart; y points up.
pub(super) fn points(name: &str, bytes: &[u8], height: Option<f64>, budget: &Budget) -> Result<PointSet<3>> {
    let count = picture_size(name, bytes)?.iter().fold(1, |n: usize, side| n.saturating_mul(*side));
    budget.within(&format!("{name}: pixels of a height field"), count, ("nodes", budget.limits().nodes))?;
    let heights = read_heights(name, bytes, budget)?;
    let (w, h) = (heights.width, heights.height);
    let _held = budget.hold(name, count * 48)?;
    budget.spend(count as u64 * 30)?;
    let scale = height.unwrap_or(HEIGHT * w.min(h) as f64);
    let at = |x: usize, y: usize| f64::from(heights.values[(h - 1 - y) * w + x]) * scale;
    // One-sided at the borders.
    let slope = |low: f64, high: f64, steps: usize| if steps == 0 { 0.0 } else { (high - low) / steps as f64 };
    let normal = |k: usize| {
        let (x, y) = (k % w, k / w);
        let (x0, x1, y0, y1) = (x.saturating_sub(1), (x + 1).min(w - 1), y.saturating_sub(1), (y + 1).min(h - 1));
        Vector([-slope(at(x0, y), at(x1, y), x1 - x0), -slope(at(x, y0), at(x, y1), y1 - y0), 1.0]).unit()
    };
    if heights.values.iter().all(|v| *v == heights.values[0]) {
        return Err(Error::input(name, "all heights are equal", "give a height field with a relief"));
    }
    Ok(PointSet {
        positions: (0..count).map(|k| Vector([(k % w) as f64, (k / w) as f64, at(k % w, k / w)])).collect(),
        normals: Some((0..count).map(normal).collect()),
        ..PointSet::default()
    })
}

/// How a result is seen as a height field.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub(super) axes: Axes,
    /// Width and depth, from the origin, where they are known; the box of the points otherwise.
    pub(super) extent: Option<[f64; 2]>,
    /// Whether the right border goes on at the left one.
    pub(super) is_tile: bool,
    /// Side of a pixel.
    pub(super) pixel: f64,
    /// Distance of neighbouring points.
    pub(super) spacing: f64,
}

/// Writes the heights of points: the highest surface over each pixel, black for the lowest and white for the highest.
pub(super) fn encode(points: &PointSet<3>, grid: &Grid, recipe: Option<&str>, budget: &Budget) -> Result<Vec<u8>> {
    let mut positions: Vec<_> = points.positions.iter().map(|&p| grid.axes.lie(p)).collect();
    let mut normals: Vec<_> = points.normals.iter().flatten().map(|&n| grid.axes.lie(n)).collect();
    normals.resize(positions.len(), Vector([0.0, 0.0, 1.0]));
    let all = Bounds::around(positions.iter().copied());
    let (corner, size) = match grid.extent {
        Some(size) => ([0.0, 0.0], size),
        None => ([all.min[0], all.min[1]], [all.size()[0], all.size()[1]]),
    };
    let pixels = size.map(|s| (s / grid.pixel).round().max(1.0));
    let limit = budget.limits().pixels;
    budget.within_expected("pixels of the height field", pixels[0] * pixels[1], ("pixels", limit))?;
    if grid.is_tile {
        let margin = 4.0 * grid.spacing;
        for i in 0..positions.len() {
            for k in (0..9).filter(|k| *k != 4) {
                let shift = Vector([f64::from(k % 3 - 1) * size[0], f64::from(k / 3 - 1) * size[1], 0.0]);
                let p = positions[i] + shift;
                if (0..2).all(|k| p[k] > -margin && p[k] < size[k] + margin) {
                    positions.push(p);
                    normals.push(normals[i]);
                }
            }
        }
    }
    let [width, height] = pixels.map(|n| n as usize);
    let (low, high) = (all.min[2], all.max[2]);
    let range = (high - low).max(f64::MIN_POSITIVE);
    let surface = OrientedPoints::new(positions, normals, 2.5 * grid.spacing, budget)?;
    let row = |j: usize| -> Result<Vec<f32>> {
        budget.spend(PIXEL * width as u64)?;
        let y = corner[1] + (height - 1 - j) as f64 * size[1] / height as f64 + 0.5 * size[1] / height as f64;
        let of = |i: usize| {
            let x = corner[0] + (i as f64 + 0.5) * size[0] / width as f64;
            ((highest(&surface, [x, y], (low, high), grid.spacing).unwrap_or(low) - low) / range) as f32
        };
        Ok((0..width).map(of).collect())
    };
    let rows: Result<Vec<Vec<f32>>> = (0..height).into_par_iter().map(row).collect();
    write_heights([width, height], &rows?.concat(), recipe, budget)
}

/// The height of the highest surface over a place.
fn highest(surface: &OrientedPoints, [x, y]: [f64; 2], (low, high): (f64, f64), spacing: f64) -> Option<f64> {
    let column = |reach: f64| {
        let corner = |sign: f64, z: f64| Vector([x + sign * reach, y + sign * reach, z]);
        Bounds::new(corner(-1.0, low - spacing), corner(1.0, high + spacing))
    };
    let mut top: Option<f64> = None;
    for reach in [1.0, 1.8] {
        surface.inside(&column(reach * spacing), |i| {
            let (p, n) = (surface.positions()[i], surface.normals()[i]);
            if n[2] > 0.1 {
                top = Some(top.map_or(p[2], |t| t.max(p[2])));
            }
        });
        if top.is_some() {
            break;
        }
    }
    let top = top?;
    let start = Vector([x, y, top]);
    let hit = surface.hit(start, Vector([0.0, 0.0, 1.0]), 3.0 * spacing);
    Some(hit.map_or(top, |foot| foot.point[2].clamp(low, high)))
}
