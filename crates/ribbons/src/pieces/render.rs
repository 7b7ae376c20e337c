//! Ribbons as pixels.

use arabesque_core::{Bounds, Budget, Image, Result, Vector};
use rayon::prelude::*;

use crate::{
    constraints::mask::Mask,
    exemplar::strip::{StripExemplar, sample},
    geometry::cage::side,
    pieces::piece::{Piece, Ribbon},
};

/// Half of the width, in exemplar pixels, over which a piece passes into the next.
const FEATHER: f64 = 1.0;
/// Most samples along each side of an output pixel.
const MAX_SAMPLES: f64 = 8.0;

/// Pixels that are drawn in one parallel step.
const STEP: usize = 1 << 15;
/// Pixels along a row for which pieces are looked for together.
const RUN: usize = 64;
/// Work of asking one piece for its colour at one sample, and of looking whether it reaches a pixel.
const COLOUR: u64 = 80;
const LOOK: u64 = 2;

/// The part of the plane that a picture shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Canvas {
    /// Its top left corner, in user units.
    pub origin: Vector<2>,
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Pixels per user unit.
    pub pixels_per_unit: f64,
}

/// A piece with what the loop over pixels needs.
struct Painter<'a> {
    piece: &'a Piece<2>,
    image: &'a Image,
    /// Number of the ribbon and of the piece in it.
    place: (usize, usize),
    /// Whether the left or the right edge is an end of the curve.
    ends: [bool; 2],
    /// Columns and rows of pixels that it may reach.
    reach: [(f64, f64); 2],
}

/// Premultiplied colour, in [0, 255].
type Colour = [f32; 4];

/// Draws ribbons on a transparent canvas, later ones over earlier ones. Ink on `mask` is left out.
///
/// # Errors
/// As [`render_rows`].
pub fn render(
    ribbons: &[Ribbon<2>],
    exemplars: &[StripExemplar],
    mask: Option<&Mask>,
    canvas: &Canvas,
    budget: &Budget,
) -> Result<Image> {
    let Canvas { width, height, .. } = *canvas;
    let (mut pixels, _held) = budget.list("pixels of the picture", width.saturating_mul(height))?;
    render_rows((ribbons, exemplars), mask, canvas, budget, &mut |row| {
        pixels.extend_from_slice(row);
        Ok(())
    })?;
    Ok(Image { width, height, pixels })
}

/// The same, row by row: shows each to `visit`, from the top.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work or the memory is used up, [`arabesque_core::Error::Stopped`] when somebody asked to
/// stop, and those of `visit`.
pub fn render_rows(
    (ribbons, exemplars): (&[Ribbon<2>], &[StripExemplar]),
    mask: Option<&Mask>,
    canvas: &Canvas,
    budget: &Budget,
    visit: &mut dyn FnMut(&[[u8; 4]]) -> Result<()>,
) -> Result<()> {
    let count = ribbons.iter().map(|ribbon| ribbon.pieces.len()).sum::<usize>();
    let _held = budget.hold("pieces of the picture", count * size_of::<Painter<'_>>())?;
    let painters: Vec<Painter<'_>> = ribbons
        .iter()
        .enumerate()
        .flat_map(|(r, ribbon)| (0..ribbon.pieces.len()).map(move |k| (r, ribbon, k)))
        .map(|(r, ribbon, k)| Painter::new((r, k), ribbon, &exemplars[ribbon.pieces[k].patch.source].image, canvas))
        .collect();
    // From the top, so that those that reach a row are found in passing.
    let mut waiting: Vec<usize> = (0..painters.len()).collect();
    waiting.sort_by(|&a, &b| painters[b].reach[1].0.total_cmp(&painters[a].reach[1].0));
    let mut near: Vec<usize> = Vec::new();
    let rows = (STEP / canvas.width.max(1)).clamp(1, RUN);
    for top in (0..canvas.height).step_by(rows) {
        let bottom = (top + rows).min(canvas.height);
        near.retain(|&k| painters[k].reach[1].1 >= top as f64);
        while let Some(k) = waiting.pop_if(|k| painters[*k].reach[1].0 < bottom as f64) {
            near.push(k);
        }
        near.sort_unstable();
        budget.spend(LOOK * near.len() as u64)?;
        let scene = Scene { ribbons, mask, canvas, budget };
        let row = |y: usize| {
            let here: Vec<&Painter<'_>> = near.iter().map(|&k| &painters[k]).filter(|p| p.covers(1, y)).collect();
            scene.row(&here, y)
        };
        let drawn = (top..bottom).into_par_iter().map(row).collect::<Result<Vec<_>>>()?;
        drawn.iter().try_for_each(|row| visit(row))?;
    }
    Ok(())
}

/// What all pixels have in common.
struct Scene<'a> {
    ribbons: &'a [Ribbon<2>],
    mask: Option<&'a Mask>,
    canvas: &'a Canvas,
    budget: &'a Budget,
}

impl Scene<'_> {
    /// Row `y`, of the pieces that reach it.
    fn row(&self, painters: &[&Painter<'_>], y: usize) -> Result<Vec<[u8; 4]>> {
        let mut meter = self.budget.meter();
        let mut row = Vec::with_capacity(self.canvas.width);
        for left in (0..self.canvas.width).step_by(RUN) {
            let right = (left + RUN).min(self.canvas.width);
            meter.spend(LOOK * (painters.len() + RUN) as u64)?;
            let reaches = |p: &&Painter<'_>| p.reach[0].0 < right as f64 && p.reach[0].1 >= left as f64;
            let near: Vec<&Painter<'_>> = painters.iter().copied().filter(reaches).collect();
            for x in left..right {
                let here: Vec<&Painter<'_>> = near.iter().copied().filter(|p| p.covers(0, x)).collect();
                let n = here.len() as u64;
                meter.spend(LOOK * near.len() as u64)?;
                row.push(self.pixel(&here, [x, y], &mut |samples| meter.spend(samples * n * (COLOUR + n)))?);
            }
        }
        Ok(row)
    }

    /// Straight RGBA of one output pixel: the mean of enough samples for its size. `pay` counts them.
    fn pixel(
        &self,
        here: &[&Painter<'_>],
        [x, y]: [usize; 2],
        pay: &mut dyn FnMut(u64) -> Result<()>,
    ) -> Result<[u8; 4]> {
        let pixels_per_unit = self.canvas.pixels_per_unit;
        let at =
            |dx: f64, dy: f64| self.canvas.origin + Vector::xy(x as f64 + dx, y as f64 + dy) * (1.0 / pixels_per_unit);
        if here.is_empty() || self.mask.is_some_and(|mask| mask.blocks(at(0.5, 0.5))) {
            return Ok([0; 4]);
        }
        let finest = here.iter().map(|p| p.piece.scale()).fold(f64::INFINITY, f64::min);
        let n = (1.0 / (pixels_per_unit * finest)).ceil().clamp(1.0, MAX_SAMPLES);
        let mut sum = [0.0; 4];
        for j in 0..n as usize {
            pay(n as u64)?;
            for i in 0..n as usize {
                let p = at((i as f64 + 0.5) / n, (j as f64 + 0.5) / n);
                let colour = mixed(here, self.ribbons, p, pixels_per_unit);
                sum.iter_mut().zip(colour).for_each(|(s, c)| *s += c / (n * n) as f32);
            }
        }
        Ok(straight(sum))
    }
}

impl<'a> Painter<'a> {
    fn new(place: (usize, usize), ribbon: &'a Ribbon<2>, image: &'a Image, canvas: &Canvas) -> Self {
        let piece = &ribbon.pieces[place.1];
        let margin = FEATHER * piece.scale() + 1.0 / canvas.pixels_per_unit;
        let bounds = Bounds::around(piece.patch.corners).grown(margin);
        let pixel = |k: usize, c: f64| (c - canvas.origin[k]) * canvas.pixels_per_unit;
        let reach = [0, 1].map(|k| (pixel(k, bounds.min[k]).floor(), pixel(k, bounds.max[k]).ceil()));
        let ends = [!ribbon.closed && place.1 == 0, !ribbon.closed && place.1 + 1 == ribbon.pieces.len()];
        Self { piece, image, place, ends, reach }
    }

    fn covers(&self, axis: usize, at: usize) -> bool {
        (self.reach[axis].0..=self.reach[axis].1).contains(&(at as f64))
    }

    /// What the piece shows at `p`, weighted by how much it has to say there.
    fn colour(&self, p: Vector<2>, pixels_per_unit: f64) -> Option<Colour> {
        let q = self.piece.to_exemplar(p);
        let weight = self.weight(q, pixels_per_unit);
        if weight <= 0.0 {
            return None;
        }
        let colour = sample(self.image, self.piece.bent(q));
        (colour[3] > 0.0).then(|| colour.map(|c| c * weight as f32))
    }

    /// 1 inside; across an edge to a neighbour it falls within the feather, at an end of the curve within a pixel.
    fn weight(&self, q: Vector<2>, pixels_per_unit: f64) -> f64 {
        let [tl, tr, br, bl] = self.piece.patch.texture;
        let (top, bottom) = (side(tl, tr, q), side(br, bl, q));
        let ahead = |p: Vector<2>| (bl - tl).cross(p - tl) <= 0.0;
        if (ahead(tr) && top < 0.0) || (ahead(br) && bottom < 0.0) {
            return 0.0;
        }
        let sharp = 0.5 / (pixels_per_unit * self.piece.scale());
        let [left, right] = [side(bl, tl, q), side(tr, br, q)];
        let [soft_left, soft_right] = self.ends.map(|end| if end { sharp } else { FEATHER });
        ((left / soft_left + 1.0) * 0.5).clamp(0.0, 1.0) * ((right / soft_right + 1.0) * 0.5).clamp(0.0, 1.0)
    }
}

/// Neighbouring pieces share a place by their weights; all others lie over one another.
fn mixed(painters: &[&Painter<'_>], ribbons: &[Ribbon<2>], p: Vector<2>, pixels_per_unit: f64) -> Colour {
    let mut groups: Vec<((usize, usize), Colour)> = Vec::new();
    for painter in painters {
        let Some(colour) = painter.colour(p, pixels_per_unit) else { continue };
        let ribbon = &ribbons[painter.place.0];
        let beside =
            |a: usize, b: usize| a.abs_diff(b) <= 1 || (ribbon.closed && a.abs_diff(b) + 1 == ribbon.pieces.len());
        match groups.iter_mut().find(|(place, _)| place.0 == painter.place.0 && beside(place.1, painter.place.1)) {
            Some((_, sum)) => sum.iter_mut().zip(colour).for_each(|(s, c)| *s += c),
            None => groups.push((painter.place, colour)),
        }
    }
    groups.iter().fold([0.0; 4], |below, (_, above)| over(*above, below))
}

fn over(above: Colour, below: Colour) -> Colour {
    let rest = 1.0 - (above[3] / 255.0).min(1.0);
    std::array::from_fn(|k| above[k] + below[k] * rest)
}

fn straight(colour: Colour) -> [u8; 4] {
    let alpha = colour[3].clamp(0.0, 255.0);
    if alpha < 0.5 {
        return [0; 4];
    }
    let byte = |c: f32| (c * 255.0 / colour[3]).clamp(0.0, 255.0).round() as u8;
    [byte(colour[0]), byte(colour[1]), byte(colour[2]), alpha.round() as u8]
}
