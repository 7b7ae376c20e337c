//! Ribbons as pixels.

use arabesque_core::{Bounds, Image, Vector};
use rayon::prelude::*;

use crate::{
    constraints::mask::Mask,
    exemplar::strip::{Strip, StripExemplar},
    geometry::cage::side,
    pieces::piece::{Piece, Ribbon},
};

/// Half of the width, in exemplar pixels, over which a piece passes into the next.
const FEATHER: f64 = 1.0;
/// Most samples along each side of an output pixel.
const MAX_SAMPLES: f64 = 8.0;

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
    strip: &'a Strip,
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
pub fn render(ribbons: &[Ribbon<2>], exemplars: &[StripExemplar], mask: Option<&Mask>, canvas: &Canvas) -> Image {
    let strips: Vec<Strip> = exemplars.iter().map(|e| Strip::new(std::slice::from_ref(e), 1)).collect();
    let painters: Vec<Painter<'_>> = ribbons
        .iter()
        .enumerate()
        .flat_map(|(r, ribbon)| (0..ribbon.pieces.len()).map(move |k| (r, ribbon, k)))
        .map(|(r, ribbon, k)| Painter::new((r, k), ribbon, &strips[ribbon.pieces[k].patch.source], canvas))
        .collect();
    let row = |y: usize| {
        let here: Vec<&Painter<'_>> = painters.iter().filter(|p| p.covers(1, y)).collect();
        (0..canvas.width).map(|x| pixel(&here, ribbons, mask, canvas, x, y)).collect::<Vec<_>>()
    };
    Image {
        width: canvas.width,
        height: canvas.height,
        pixels: (0..canvas.height).into_par_iter().flat_map_iter(row).collect(),
    }
}

impl<'a> Painter<'a> {
    fn new(place: (usize, usize), ribbon: &'a Ribbon<2>, strip: &'a Strip, canvas: &Canvas) -> Self {
        let piece = &ribbon.pieces[place.1];
        let margin = FEATHER * piece.scale() + 1.0 / canvas.pixels_per_unit;
        let bounds = Bounds::around(piece.patch.corners).grown(margin);
        let pixel = |k: usize, c: f64| (c - canvas.origin[k]) * canvas.pixels_per_unit;
        let reach = [0, 1].map(|k| (pixel(k, bounds.min[k]).floor(), pixel(k, bounds.max[k]).ceil()));
        let ends = [!ribbon.closed && place.1 == 0, !ribbon.closed && place.1 + 1 == ribbon.pieces.len()];
        Self { piece, strip, place, ends, reach }
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
        let colour = self.strip.sample(self.piece.bent(q), &(0..self.strip.width));
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

/// Straight RGBA of one output pixel: the mean of enough samples for its size.
fn pixel(
    painters: &[&Painter<'_>],
    ribbons: &[Ribbon<2>],
    mask: Option<&Mask>,
    canvas: &Canvas,
    x: usize,
    y: usize,
) -> [u8; 4] {
    let here: Vec<&Painter<'_>> = painters.iter().copied().filter(|p| p.covers(0, x)).collect();
    let at =
        |dx: f64, dy: f64| canvas.origin + Vector::xy(x as f64 + dx, y as f64 + dy) * (1.0 / canvas.pixels_per_unit);
    if here.is_empty() || mask.is_some_and(|mask| mask.blocks(at(0.5, 0.5))) {
        return [0; 4];
    }
    let finest = here.iter().map(|p| p.piece.scale()).fold(f64::INFINITY, f64::min);
    let n = (1.0 / (canvas.pixels_per_unit * finest)).ceil().clamp(1.0, MAX_SAMPLES);
    let mut sum = [0.0; 4];
    for k in 0..(n * n) as usize {
        let (i, j) = (k % n as usize, k / n as usize);
        let p = at((i as f64 + 0.5) / n, (j as f64 + 0.5) / n);
        let colour = sample(&here, ribbons, p, canvas.pixels_per_unit);
        sum.iter_mut().zip(colour).for_each(|(s, c)| *s += c / (n * n) as f32);
    }
    straight(sum)
}

/// Neighbouring pieces share a place by their weights; all others lie over one another.
fn sample(painters: &[&Painter<'_>], ribbons: &[Ribbon<2>], p: Vector<2>, pixels_per_unit: f64) -> Colour {
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
