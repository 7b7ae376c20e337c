//! Where the pattern must not be: regions to avoid, folds of the ribbon and overlaps [Zhou 2013 §3.1].

use arabesque_core::{Bounds, Vector};
use rayon::prelude::*;

use crate::{constraints::valid::Offset, geometry::cage::Cage};

/// Depth in pixels from which a point counts as inside another piece: neighbours share their edges.
const INSIDE: f64 = 0.5;

/// Cells over the canvas in which no ink may fall.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    /// Where the cells lie, in user units.
    pub bounds: Bounds<2>,
    /// Cells along a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` cells, row by row from the top: whether ink is forbidden there.
    pub blocked: Vec<bool>,
}

impl Mask {
    /// Width and height of a cell, in user units.
    fn cell(&self) -> Vector<2> {
        let size = self.bounds.size();
        Vector::xy(size[0] / self.width as f64, size[1] / self.height as f64)
    }

    /// Whether ink is forbidden at `p`; nowhere outside the cells.
    pub fn blocks(&self, p: Vector<2>) -> bool {
        let (cell, q) = (self.cell(), p - self.bounds.min);
        let (x, y) = ((q[0] / cell[0]).floor(), (q[1] / cell[1]).floor());
        let inside = x >= 0.0 && y >= 0.0 && x < self.width as f64 && y < self.height as f64;
        inside && self.blocked[y as usize * self.width + x as usize]
    }

    /// Points in the blocked cells of `around`, at most `spacing` apart.
    pub(crate) fn points(&self, around: Bounds<2>, spacing: f64) -> impl Iterator<Item = Vector<2>> + '_ {
        let cell = self.cell();
        let range = |k: usize, n: usize| {
            let from = ((around.min[k] - self.bounds.min[k]) / cell[k]).floor().clamp(0.0, n as f64) as usize;
            from..((around.max[k] - self.bounds.min[k]) / cell[k]).ceil().clamp(0.0, n as f64) as usize
        };
        let columns = range(0, self.width);
        let parts = cell.map(|c| (c / spacing).ceil().max(1.0));
        let cells = range(1, self.height).flat_map(move |y| columns.clone().map(move |x| (x, y)));
        cells.filter(|&(x, y)| self.blocked[y * self.width + x]).flat_map(move |(x, y)| {
            let grid = (0..parts[1] as usize).flat_map(move |j| (0..parts[0] as usize).map(move |i| (i, j)));
            grid.map(move |(i, j)| {
                let at = |k: usize, n: usize, part: usize| {
                    self.bounds.min[k] + cell[k] * (n as f64 + (part as f64 + 0.5) / parts[k])
                };
                Vector::xy(at(0, x, i), at(1, y, j))
            })
        })
    }
}

/// For each piece of each cage the pixels that must stay free.
pub(crate) fn forbidden(cages: &[Cage<2>], mask: Option<&Mask>) -> Vec<Vec<Vec<Offset>>> {
    let all: Vec<PieceId> =
        cages.iter().enumerate().flat_map(|(c, cage)| (0..cage.len()).map(move |k| (c, k))).collect();
    let bounds: Vec<Bounds<2>> = all.iter().map(|&(c, k)| cages[c].bounds(k)).collect();
    let near = Near::new(&bounds);
    let found: Vec<Vec<Offset>> = (0..all.len())
        .into_par_iter()
        .map(|id| {
            let rivals: Vec<PieceId> = near.of(id, &bounds).into_iter().map(|j| all[j]).collect();
            let mut offsets = overlaps(cages, all[id], &rivals);
            offsets.extend(mask.into_iter().flat_map(|mask| blocked(&cages[all[id].0], all[id].1, mask)));
            offsets.sort_unstable();
            offsets.dedup();
            offsets
        })
        .collect();
    let mut rest = found.into_iter();
    cages.iter().map(|cage| rest.by_ref().take(cage.len()).collect()).collect()
}

/// Which boxes meet, by their left sides.
struct Near {
    /// Boxes from left to right.
    order: Vec<usize>,
    /// Largest width of a box.
    widest: f64,
}

impl Near {
    fn new(bounds: &[Bounds<2>]) -> Self {
        let mut order: Vec<usize> = (0..bounds.len()).collect();
        order.sort_by(|&a, &b| bounds[a].min[0].total_cmp(&bounds[b].min[0]).then(a.cmp(&b)));
        Self { order, widest: bounds.iter().map(|b| b.size()[0]).fold(0.0, f64::max) }
    }

    /// The boxes that meet box `id`, in rising order.
    fn of(&self, id: usize, bounds: &[Bounds<2>]) -> Vec<usize> {
        let own = &bounds[id];
        let from = self.order.partition_point(|&k| bounds[k].min[0] < own.min[0] - self.widest);
        let near = self.order[from..].iter().copied().take_while(|&k| bounds[k].min[0] <= own.max[0]);
        let mut near: Vec<usize> = near.filter(|&k| k != id && bounds[k].intersects(own)).collect();
        near.sort_unstable();
        near
    }
}

/// A piece by the numbers of its cage and within that; ordered by both.
type PieceId = (usize, usize);

/// Pixels of a piece that lie in another piece as well, and nearer to the curve there: each place of an overlap belongs to one piece.
fn overlaps(cages: &[Cage<2>], id: PieceId, rivals: &[PieceId]) -> Vec<Offset> {
    let (c, k) = id;
    let (cage, form) = (&cages[c], &cages[c].forms[k]);
    let bounds = form.bounds();
    let mut offsets = Vec::new();
    for y in bounds.min[1].floor() as i32..=bounds.max[1].ceil() as i32 {
        for x in bounds.min[0].floor() as i32..=bounds.max[0].ceil() as i32 {
            let q = Vector::xy(f64::from(x), f64::from(y) + 0.5);
            if form.depth(q) <= 0.0 {
                continue;
            }
            let p = cage.canvas(k, q);
            let own = (cage.distance(k, p), id);
            let taken = rivals.iter().any(|&(d, j)| {
                let rival = &cages[d];
                rival.forms[j].depth(rival.local(j, p)) > INSIDE && nearer((rival.distance(j, p), (d, j)), own)
            });
            if taken {
                offsets.push((x, y));
            }
        }
    }
    offsets
}

fn nearer(a: (f64, PieceId), b: (f64, PieceId)) -> bool {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).is_lt()
}

/// Pixels of a piece on which the mask lies.
fn blocked<'a>(cage: &'a Cage<2>, k: usize, mask: &'a Mask) -> impl Iterator<Item = Offset> + 'a {
    let around = cage.bounds(k).grown(2.0 * cage.scale);
    let local = mask.points(around, cage.scale).map(move |p| cage.local(k, p));
    local.filter(move |q| cage.forms[k].depth(*q) > -1.5).map(|q| ((q[0] + 0.5).floor() as i32, q[1].floor() as i32))
}
