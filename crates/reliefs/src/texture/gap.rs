//! The gap in a scan: where nothing lies over more of the plane than anywhere else. Also what a scan leaves bare of its box: the corners of one that
//! does not lie straight in it, or that is round.

use arabesque_core::{Bounds, Budget, Error, Result, Vector};

use crate::distance::distances;

/// Side of a cell, in spacings.
const CELL: f64 = 1.0;
/// How much wider than the others a gap is.
const WIDER: f64 = 1.5;
/// What is bare of a box is at least so wide, as a share of its shorter side: what is less is beside the texture proper anyway.
const BARE: f64 = 0.02;
/// Share of the empty places that are usual.
const USUAL: f64 = 0.9;
/// Cells at most, and for each point.
const MOST: f64 = 16e6;
const EACH: f64 = 16.0;

/// The plane in cells, and which of them hold points.
struct Cells {
    cell: f64,
    width: usize,
    height: usize,
    is_there: Vec<bool>,
}

impl Cells {
    fn new(points: &[Vector<3>], all: &Bounds<3>, spacing: f64, budget: &Budget) -> Result<Self> {
        let [across, down, _] = all.size().0;
        // Where a few points lie far from all others the cells are larger.
        let most = MOST.min(EACH * points.len() as f64);
        let cell = (CELL * spacing).max((across * down / most).sqrt()).max(across.max(down) / most);
        let (width, height) = ((across / cell) as usize + 1, (down / cell) as usize + 1);
        budget.spend((width * height * 60 + points.len() * 10) as u64)?;
        let mut is_there = vec![false; width * height];
        for p in points {
            let [x, y] = [0, 1].map(|k| ((p[k] - all.min[k]) / cell) as usize);
            is_there[y.min(height - 1) * width + x.min(width - 1)] = true;
        }
        Ok(Self { cell, width, height, is_there })
    }

    /// How far each cell is from the nearest of these, in cells; beyond the box all are.
    fn far(&self, from: &[bool]) -> Vec<f64> {
        distances(from, (self.width, self.height), true)
    }

    /// The cells within the convex hull of those that hold a point.
    fn hull(&self) -> Vec<bool> {
        let Self { width, height, is_there, .. } = self;
        let ends = |x: usize| {
            let holds = |y: &usize| is_there[y * width + x];
            Some(((0..*height).find(holds)? as f64, (0..*height).rfind(holds)? as f64))
        };
        let columns: Vec<(f64, f64, f64)> =
            (0..*width).filter_map(|x| ends(x).map(|(a, b)| (x as f64, a, b))).collect();
        let low = lower_hull(columns.iter().map(|c| [c.0, c.1]));
        let high = lower_hull(columns.iter().map(|c| [c.0, -c.2]));
        let mut is_within = vec![false; width * height];
        for x in 0..*width {
            let (Some(from), Some(to)) = (at(&low, x as f64), at(&high, x as f64)) else { continue };
            let (from, to) = (from.floor().max(0.0) as usize, (-to).ceil() as usize);
            (from..=to.min(height - 1)).for_each(|y| is_within[y * width + x] = true);
        }
        is_within
    }

    /// How far the middle of a wide one of the empty places is that are usual, and that of the widest, from these distances.
    fn usual_and_widest(&self, far: &[f64]) -> (f64, f64) {
        let (width, height) = (self.width, self.height);
        let mut tops: Vec<f64> = Vec::new();
        let at = |x: usize, y: usize| far[y * width + x];
        for y in 1..height.saturating_sub(1) {
            for x in 1..width.saturating_sub(1) {
                let own = at(x, y);
                if own > 0.0 && (0..9).all(|k| at(x + k % 3 - 1, y + k / 3 - 1) <= own) {
                    tops.push(own);
                }
            }
        }
        tops.sort_by(f64::total_cmp);
        let usual = tops.get((tops.len() as f64 * USUAL) as usize).copied().unwrap_or(1.0);
        // With few empty places the widest is usual only if another one is as wide.
        let usual = if tops.len() < 10 { 1.5 } else { usual.max(1.5) };
        (usual, tops.last().copied().unwrap_or(0.0))
    }
}

/// The lower side of the convex hull of points in the order of x.
fn lower_hull(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut hull: Vec<[f64; 2]> = Vec::new();
    for p in points {
        while let [.., a, b] = hull[..] {
            if (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0.0 {
                break;
            }
            hull.pop();
        }
        hull.push(p);
    }
    hull
}

/// The height of a line of points in the order of x, between its ends.
fn at(line: &[[f64; 2]], x: f64) -> Option<f64> {
    let k = line.partition_point(|p| p[0] < x);
    let b = line.get(k)?;
    if k == 0 || b[0] == x {
        return (b[0] == x).then_some(b[1]);
    }
    let a = line[k - 1];
    Some(a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]))
}

/// The cells of a gap.
#[derive(Clone, Debug)]
pub(crate) struct Gap {
    origin: [f64; 2],
    cell: f64,
    width: usize,
    height: usize,
    /// Sides of the box, in cells.
    size: [f64; 2],
    is_gap: Vec<bool>,
    /// Cells of the gap below and left of each corner.
    sums: Vec<u32>,
    /// The smallest box around the gap.
    pub(crate) bounds: [[f64; 2]; 2],
}

impl Gap {
    /// Looks for gaps that are wider than what is usual between the points.
    pub(crate) fn find(points: &[Vector<3>], all: &Bounds<3>, spacing: f64, budget: &Budget) -> Result<Self> {
        let cells = Cells::new(points, all, spacing, budget)?;
        let far = cells.far(&cells.is_there);
        let (usual, widest) = cells.usual_and_widest(&far);
        if widest < WIDER * usual + 1.0 {
            let problem = format!(
                "no gap: the widest empty place is {:.4} wide, and a gap is wider than {:.4} here",
                2.0 * widest * cells.cell,
                2.0 * (WIDER * usual + 1.0) * cells.cell
            );
            return Err(Error::input("the texture", problem, "leave fill_hole out, or give a scan with a gap"));
        }
        Self::of(&cells, (&far, WIDER * usual), all, budget)
    }

    /// What of its box lies outside the convex hull of the points, if that is more than a border: a texture may be as open as it likes within.
    pub(crate) fn bare(points: &[Vector<3>], all: &Bounds<3>, spacing: f64, budget: &Budget) -> Result<Option<Self>> {
        let cells = Cells::new(points, all, spacing, budget)?;
        let far = cells.far(&cells.hull());
        let widest = far.iter().copied().fold(0.0, f64::max);
        let least = BARE * cells.width.min(cells.height) as f64;
        Ok(if widest < least.max(2.0) { None } else { Some(Self::of(&cells, (&far, 0.0), all, budget)?) })
    }

    /// The places that are farther away than `least`, with what is as near to them.
    fn of(cells: &Cells, (far, least): (&[f64], f64), all: &Bounds<3>, budget: &Budget) -> Result<Self> {
        let mut gap = Self {
            origin: [all.min[0], all.min[1]],
            cell: cells.cell,
            width: cells.width,
            height: cells.height,
            size: [0, 1].map(|k| all.size()[k] / cells.cell),
            is_gap: vec![false; far.len()],
            sums: Vec::new(),
            bounds: [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]],
        };
        gap.mark(far, least, budget)?;
        Ok(gap)
    }

    /// Marks the empty discs around the places that are farther from all points than `least`.
    fn mark(&mut self, far: &[f64], least: f64, budget: &Budget) -> Result<()> {
        let (width, height) = (self.width as i64, self.height as i64);
        let mut meter = budget.meter();
        for k in 0..far.len() {
            if far[k] <= least {
                continue;
            }
            let (x, y) = ((k % self.width) as i64, (k / self.width) as i64);
            // Where a neighbour's disc holds this one there is nothing new.
            let is_held = [(1, 0), (-1, 0), (0, 1), (0, -1)].iter().any(|(dx, dy)| {
                let (i, j) = (x + dx, y + dy);
                (0..width).contains(&i) && (0..height).contains(&j) && far[(j * width + i) as usize] >= far[k] + 0.99
            });
            if is_held {
                continue;
            }
            let reach = far[k].floor() as i64;
            meter.spend((4 * reach * reach) as u64 + 10)?;
            for j in (y - reach).max(0)..=(y + reach).min(height - 1) {
                for i in (x - reach).max(0)..=(x + reach).min(width - 1) {
                    if (((i - x).pow(2) + (j - y).pow(2)) as f64) < far[k] * far[k] {
                        self.is_gap[(j * width + i) as usize] = true;
                    }
                }
            }
        }
        self.sums = vec![0; (self.width + 1) * (self.height + 1)];
        let row = self.width + 1;
        for y in 0..self.height {
            for x in 0..self.width {
                let own = self.is_gap[y * self.width + x];
                self.sums[(y + 1) * row + x + 1] =
                    self.sums[y * row + x + 1] + self.sums[(y + 1) * row + x] - self.sums[y * row + x] + u32::from(own);
                if own {
                    for (k, i) in [x, y].into_iter().enumerate() {
                        self.bounds[0][k] = self.bounds[0][k].min(self.origin[k] + i as f64 * self.cell);
                        self.bounds[1][k] = self.bounds[1][k].max(self.origin[k] + (i + 1) as f64 * self.cell);
                    }
                }
            }
        }
        Ok(())
    }

    /// Whether a place lies in the gap.
    pub(crate) fn contains(&self, x: f64, y: f64) -> bool {
        let at = [(x - self.origin[0]) / self.cell, (y - self.origin[1]) / self.cell];
        let is_in = at[0] >= 0.0 && at[1] >= 0.0 && at[0] < self.width as f64 && at[1] < self.height as f64;
        is_in && self.is_gap[at[1] as usize * self.width + at[0] as usize]
    }

    /// Whether a place lies within the box of the scan.
    pub(crate) fn is_framed(&self, x: f64, y: f64) -> bool {
        let at = [(x - self.origin[0]) / self.cell, (y - self.origin[1]) / self.cell];
        (0..2).all(|k| at[k] >= 0.0 && at[k] <= self.size[k])
    }

    /// How many cells of the gap a rectangle meets.
    fn count(&self, low: [f64; 2], high: [f64; 2]) -> u32 {
        let limit = [self.width as f64, self.height as f64];
        let [x0, y0] = [0, 1].map(|k| ((low[k] - self.origin[k]) / self.cell).floor().clamp(0.0, limit[k]) as usize);
        let [x1, y1] = [0, 1].map(|k| ((high[k] - self.origin[k]) / self.cell).ceil().clamp(0.0, limit[k]) as usize);
        let row = self.width + 1;
        self.sums[y1 * row + x1] + self.sums[y0 * row + x0] - self.sums[y0 * row + x1] - self.sums[y1 * row + x0]
    }

    /// Whether a rectangle meets the gap.
    pub(crate) fn meets(&self, low: [f64; 2], high: [f64; 2]) -> bool {
        self.count(low, high) > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sheet of points one apart with a round gap of radius 6.
    fn sheet(is_out: impl Fn(f64, f64) -> bool) -> Vec<Vector<3>> {
        let all = (0..2500).map(|k| [f64::from(k % 50), f64::from(k / 50)]);
        all.filter(|[x, y]| !is_out(*x, *y)).map(|[x, y]| Vector([x, y, 0.0])).collect()
    }

    fn find(points: &[Vector<3>]) -> Result<Gap> {
        let all = Bounds::around(points.iter().copied());
        Gap::find(points, &all, 1.0, &Budget::default())
    }

    #[test]
    fn a_gap_is_what_is_wider_than_the_rest() {
        let points = sheet(|x, y| (x - 20.0).hypot(y - 30.0) < 6.0 || (x as u32 % 4 == 1 && y as u32 % 4 == 1));
        let gap = find(&points).unwrap();
        assert!(gap.contains(20.0, 30.0) && gap.contains(24.0, 30.0) && !gap.contains(28.0, 30.0));
        assert!(!gap.contains(5.0, 5.0), "the holes of the texture are none");
        assert!(gap.meets([10.0, 20.0], [21.0, 31.0]) && !gap.meets([30.0, 0.0], [49.0, 49.0]));
        assert!((gap.bounds[0][0] - 14.5).abs() < 1.6 && (gap.bounds[1][1] - 36.5).abs() < 1.6, "{:?}", gap.bounds);
    }

    #[test]
    fn without_a_gap_nothing_is_filled() {
        let whole = find(&sheet(|_, _| false)).unwrap_err().to_string();
        assert!(whole.contains("no gap"), "{whole}");
        assert!(find(&sheet(|x, y| x as u32 % 4 == 1 && y as u32 % 4 == 1)).is_err());
    }

    #[test]
    fn the_corners_of_a_sheet_that_is_turned_or_round_are_bare_and_holes_are_not() {
        let holes = |x: f64, y: f64| x as u32 % 4 == 1 && y as u32 % 4 == 1;
        let bay = |x: f64, y: f64| holes(x, y) || (x - 25.0).hypot(y) < 9.0;
        let bare = |points: &[Vector<3>]| {
            Gap::bare(points, &Bounds::around(points.iter().copied()), 1.0, &Budget::default()).unwrap()
        };
        assert!(bare(&sheet(|_, _| false)).is_none() && bare(&sheet(bay)).is_none());
        let turned = bare(&sheet(|x, y| (x - 24.5).abs() + (y - 24.5).abs() > 24.0 || holes(x, y))).unwrap();
        let round = bare(&sheet(|x, y| (x - 24.5).hypot(y - 24.5) > 24.0)).unwrap();
        for (x, y, is_bare) in [(2.0, 2.0, true), (46.0, 3.0, true), (24.0, 24.0, false), (24.0, 4.0, false)] {
            assert_eq!((turned.contains(x, y), round.contains(x, y)), (is_bare, is_bare), "{x} {y}");
        }
    }
}
