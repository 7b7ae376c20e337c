//! Where the pattern must not be: regions to avoid, folds of the ribbon and overlaps [Zhou 2013 §3.1].

use std::sync::Arc;

use arabesque_core::{Bounds, Budget, Held, Meter, Result, Vector};
use rayon::prelude::*;

use crate::{constraints::valid::Offset, geometry::cage::Cage};

/// Depth in pixels from which a point counts as inside another piece: neighbours share their edges.
const INSIDE: f64 = 0.5;

/// Work of one pixel of a piece, of comparing it with one other piece, of one blocked point, and of one box among others.
const PIXEL: u64 = 60;
const RIVAL: u64 = 8;
const POINT: u64 = 60;
const BOX: u64 = 2;

/// Pieces by whose work that of all is foreseen, where there are more.
const TRIED: usize = 16;

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

    /// Shows points in the blocked cells of `around` to `visit`, at most `spacing` apart, until it answers that it has seen enough.
    ///
    /// # Errors
    /// Those of `meter` and of `visit`.
    pub(crate) fn points(
        &self,
        around: Bounds<2>,
        spacing: f64,
        meter: &mut Meter<'_>,
        mut visit: impl FnMut(Vector<2>) -> Result<bool>,
    ) -> Result<()> {
        let cell = self.cell();
        let range = |k: usize, n: usize| {
            let from = ((around.min[k] - self.bounds.min[k]) / cell[k]).floor().clamp(0.0, n as f64) as usize;
            from..((around.max[k] - self.bounds.min[k]) / cell[k]).ceil().clamp(0.0, n as f64) as usize
        };
        let columns = range(0, self.width);
        let parts = cell.map(|c| (c / spacing).ceil().max(1.0));
        let at = |k: usize, n: usize, part: usize| {
            self.bounds.min[k] + cell[k] * (n as f64 + (part as f64 + 0.5) / parts[k])
        };
        for y in range(1, self.height) {
            meter.spend(columns.len() as u64 + 1)?;
            for x in columns.clone().filter(|&x| self.blocked[y * self.width + x]) {
                for j in 0..parts[1] as usize {
                    for i in 0..parts[0] as usize {
                        meter.spend(POINT)?;
                        if visit(Vector::xy(at(0, x, i), at(1, y, j)))? {
                            return Ok(());
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

/// The pixels that must stay free, for each piece of each cage.
#[derive(Debug)]
pub(crate) struct Forbidden {
    pub(crate) cages: Vec<Vec<Arc<Vec<Offset>>>>,
    /// The memory of the offsets.
    _held: Vec<Option<Held>>,
}

/// The pixels of one piece, while they are found.
struct Offsets<'a> {
    list: Vec<Offset>,
    /// The memory of as many as the list has room for.
    held: Option<Held>,
    budget: &'a Budget,
}

impl Offsets<'_> {
    fn push(&mut self, offset: Offset) -> Result<()> {
        if self.list.len() == self.list.capacity() {
            // The same pixel may be found again and again.
            self.tidy();
            if 2 * self.list.len() >= self.list.capacity() {
                let room = (2 * self.list.len()).max(64);
                self.held = None;
                self.held = Some(self.budget.hold("pixels to avoid", room * size_of::<Offset>())?);
                self.list.reserve_exact(room - self.list.len());
            }
        }
        self.list.push(offset);
        Ok(())
    }

    fn tidy(&mut self) {
        self.list.sort_unstable();
        self.list.dedup();
    }
}

impl Forbidden {
    /// Nothing.
    pub(crate) fn none<const D: usize>(cages: &[Cage<D>]) -> Self {
        let nothing = Arc::new(Vec::new());
        let cages = cages.iter().map(|cage| vec![Arc::clone(&nothing); cage.len()]).collect();
        Self { cages, _held: Vec::new() }
    }

    /// What `mask` and other pieces leave free. Pieces longer than `longest` pixels have no position anyway, and are not looked at. `foreseen`
    /// is told the work that this will take, about.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Limit`] when the work or the memory is used up, [`arabesque_core::Error::Stopped`].
    pub(crate) fn of(
        cages: &[Cage<2>],
        mask: Option<&Mask>,
        longest: f64,
        budget: &Budget,
        foreseen: &mut dyn FnMut(f64),
    ) -> Result<Self> {
        let search = Search::new(cages, mask, longest, budget);
        foreseen(search.foreseen()?);
        let found = (0..search.all.len()).into_par_iter().map(|id| search.offsets(id)).collect::<Result<Vec<_>>>()?;
        budget.spend(0)?;
        let (offsets, held): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        let mut rest = offsets.into_iter().map(Arc::new);
        let cages = cages.iter().map(|cage| rest.by_ref().take(cage.len()).collect()).collect();
        Ok(Self { cages, _held: held })
    }
}

/// The search for the pixels of all pieces that must stay free.
struct Search<'a> {
    cages: &'a [Cage<2>],
    mask: Option<&'a Mask>,
    longest: f64,
    all: Vec<PieceId>,
    bounds: Vec<Bounds<2>>,
    near: Near,
    budget: &'a Budget,
}

impl<'a> Search<'a> {
    fn new(cages: &'a [Cage<2>], mask: Option<&'a Mask>, longest: f64, budget: &'a Budget) -> Self {
        let all: Vec<PieceId> =
            cages.iter().enumerate().flat_map(|(c, cage)| (0..cage.len()).map(move |k| (c, k))).collect();
        let bounds: Vec<Bounds<2>> = all.iter().map(|&(c, k)| cages[c].bounds(k)).collect();
        Self { cages, mask, longest, near: Near::new(&bounds), all, bounds, budget }
    }

    /// The work of all pieces, by that of a few of them, which is done twice; 0 where these would be a good part of all.
    fn foreseen(&self) -> Result<f64> {
        if self.all.len() < 8 * TRIED {
            return Ok(0.0);
        }
        let step = self.all.len().div_ceil(TRIED).max(1);
        let before = self.budget.work();
        let tried = (0..self.all.len()).step_by(step);
        let share = self.all.len() as f64 / tried.len().max(1) as f64;
        for id in tried {
            self.offsets(id)?;
        }
        Ok((self.budget.work() - before) as f64 * share)
    }

    /// Those of one piece, with their memory.
    fn offsets(&self, id: usize) -> Result<(Vec<Offset>, Option<Held>)> {
        let (c, k) = self.all[id];
        if self.cages[c].forms[k].bounds().size()[0] > self.longest {
            return Ok((Vec::new(), None));
        }
        let rivals: Vec<PieceId> =
            self.near.of(id, &self.bounds, self.budget)?.into_iter().map(|j| self.all[j]).collect();
        let mut offsets = Offsets { list: Vec::new(), held: None, budget: self.budget };
        overlaps(self.cages, self.all[id], &rivals, &mut offsets)?;
        if let Some(mask) = self.mask {
            blocked(&self.cages[c], k, mask, &mut offsets)?;
        }
        offsets.tidy();
        Ok((offsets.list, offsets.held))
    }
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
    fn of(&self, id: usize, bounds: &[Bounds<2>], budget: &Budget) -> Result<Vec<usize>> {
        let own = &bounds[id];
        let from = self.order.partition_point(|&k| bounds[k].min[0] < own.min[0] - self.widest);
        let end = self.order.partition_point(|&k| bounds[k].min[0] <= own.max[0]).max(from);
        budget.spend(BOX * (end - from) as u64)?;
        let near = self.order[from..end].iter().copied();
        let mut near: Vec<usize> = near.filter(|&k| k != id && bounds[k].intersects(own)).collect();
        near.sort_unstable();
        Ok(near)
    }
}

/// A piece by the numbers of its cage and within that; ordered by both.
type PieceId = (usize, usize);

/// Pixels of a piece that lie in another piece as well, and nearer to the curve there: each place of an overlap belongs to one piece.
fn overlaps(cages: &[Cage<2>], id: PieceId, rivals: &[PieceId], offsets: &mut Offsets<'_>) -> Result<()> {
    let (c, k) = id;
    let (cage, form) = (&cages[c], &cages[c].forms[k]);
    let bounds = form.bounds();
    let budget = offsets.budget;
    let mut meter = budget.meter();
    // Whoever took a pixel takes its neighbour as a rule, and is asked first.
    let mut last = 0;
    for y in bounds.min[1].floor() as i32..=bounds.max[1].ceil() as i32 {
        for x in bounds.min[0].floor() as i32..=bounds.max[0].ceil() as i32 {
            meter.spend(PIXEL)?;
            let q = Vector::xy(f64::from(x), f64::from(y) + 0.5);
            if form.depth(q) <= 0.0 {
                continue;
            }
            let p = cage.canvas(k, q);
            let own = (cage.distance(k, p), id);
            let takes = |&n: &usize| {
                let (d, j) = rivals[n];
                let rival = &cages[d];
                nearer((rival.distance(j, p), (d, j)), own) && rival.forms[j].depth(rival.local(j, p)) > INSIDE
            };
            let mut asked = 0;
            let taker = (last..rivals.len()).chain(0..last).inspect(|_| asked += 1).find(takes);
            meter.spend(RIVAL * asked)?;
            if let Some(taker) = taker {
                last = taker;
                offsets.push((x, y))?;
            }
        }
    }
    Ok(())
}

fn nearer(a: (f64, PieceId), b: (f64, PieceId)) -> bool {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).is_lt()
}

/// Adds the pixels of a piece on which the mask lies.
fn blocked(cage: &Cage<2>, k: usize, mask: &Mask, offsets: &mut Offsets<'_>) -> Result<()> {
    let around = cage.bounds(k).grown(2.0 * cage.scale);
    let budget = offsets.budget;
    mask.points(around, cage.scale, &mut budget.meter(), |p| {
        let q = cage.local(k, p);
        if cage.forms[k].depth(q) > -1.5 {
            offsets.push(((q[0] + 0.5).floor() as i32, q[1].floor() as i32))?;
        }
        Ok(false)
    })
}
