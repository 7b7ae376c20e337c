//! Heights of which the lines of an exemplar are the levels.

use std::collections::VecDeque;

use arabesque_core::{Bounds, Budget, Domain, Exemplar, GridIndex, Path, Result, Vector};

/// Places for the distance of lines, and along the shorter side of the frame, at least and at most.
const PLACES: (f64, f64, f64) = (6.0, 40.0, 220.0);
/// Share of the places next to one another between which one line runs that have to be one level apart.
const SOUND: f64 = 0.98;
/// How far around a place lines are looked for, in mean distances.
const REACH: f64 = 4.0;
/// How near to the next level heights come where there is no such line.
const PEAK: f64 = 0.8;
/// Levels at least.
const LEVELS: u32 = 3;
/// Work for each place, and for each segment of a line.
const WORK: (u64, u64) = (60, 40);

/// Heights on a grid over the frame; lines are where they are a half more than a whole number.
pub(crate) struct Heights {
    pub(crate) size: [usize; 2],
    pub(crate) step: f64,
    pub(crate) values: Vec<f32>,
}

/// Lines between places that are next to one another: where the first, or the only one, crosses, and how many do.
#[derive(Clone, Copy, Default)]
struct Between {
    count: u8,
    at: f64,
}

/// Places of a grid and the lines between them.
struct Survey {
    size: [usize; 2],
    step: f64,
    corner: Vector<2>,
    /// To the next place along x, and along y.
    between: [Vec<Between>; 2],
}

impl Heights {
    /// The heights of an exemplar whose lines, and `rings` beside them, lie `apart` in the mean; `None` where its lines are no levels.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn of(exemplar: &Exemplar<2>, rings: &[Path<2>], apart: f64, budget: &Budget) -> Result<Option<Self>> {
        let survey = Survey::new(exemplar, rings, apart, budget)?;
        let far = survey.depths(0, budget)?;
        // From one end of what the lines part, heights rise to the other.
        let end = (0..far.len()).max_by_key(|&n| far[n]).unwrap_or(0);
        let depth = survey.depths(end, budget)?;
        if depth.iter().max().is_none_or(|most| *most < LEVELS) || !survey.is_sound(&depth) {
            return Ok(None);
        }
        let values = survey.heights(&depth, apart, budget)?;
        Ok(Some(Self { size: survey.size, step: survey.step, values }))
    }
}

impl Survey {
    fn new(exemplar: &Exemplar<2>, rings: &[Path<2>], apart: f64, budget: &Budget) -> Result<Self> {
        let sides = exemplar.window.size();
        let shorter = sides[0].min(sides[1]);
        let step = (apart / PLACES.0).clamp(shorter / PLACES.2, shorter / PLACES.1);
        let size = [0, 1].map(|k| (sides[k] / step).floor() as usize + 1);
        let count = size[0] * size[1];
        budget.spend(WORK.0 * count as u64)?;
        let between = [vec![Between::default(); count], vec![Between::default(); count]];
        let mut survey = Self { size, step, corner: exemplar.window.min, between };
        for path in exemplar.curves.iter().map(|curve| &curve.path).chain(rings) {
            let points = path.flatten(0.1 * step);
            budget.spend(WORK.1 * points.len() as u64)?;
            for pair in points.windows(2) {
                survey.cross([pair[0], pair[1]].map(|p| (p - survey.corner) * (1.0 / step)));
            }
        }
        Ok(survey)
    }

    /// Notes where a segment, in steps of the grid, crosses between places.
    fn cross(&mut self, [a, b]: [Vector<2>; 2]) {
        for k in 0..2 {
            // Rows of the grid along `k` lie at whole numbers of the other coordinate.
            let o = 1 - k;
            let (low, high) = (a[o].min(b[o]), a[o].max(b[o]));
            // A segment that ends on a row crosses it once together with the next.
            let mut row = low.ceil().max(0.0);
            while row < high && row < self.size[o] as f64 {
                let t = (row - a[o]) / (b[o] - a[o]);
                let x = a[k] + t * (b[k] - a[k]);
                let first = x.floor();
                if first >= 0.0 && first + 1.0 < self.size[k] as f64 {
                    let (i, j) = (first as usize, row as usize);
                    let n = if k == 0 { j * self.size[0] + i } else { i * self.size[0] + j };
                    let between = &mut self.between[k][n];
                    *between = Between { count: between.count.saturating_add(1), at: x };
                }
                row += 1.0;
            }
        }
    }

    /// The places next to one, with the lines between.
    fn beside(&self, n: usize) -> impl Iterator<Item = (usize, u8)> + '_ {
        let (i, j) = (n % self.size[0], n / self.size[0]);
        let [width, height] = self.size;
        let all = [
            (i + 1 < width).then(|| (n + 1, self.between[0][n].count)),
            (j + 1 < height).then(|| (n + width, self.between[1][n].count)),
            (i > 0).then(|| (n - 1, self.between[0][n - 1].count)),
            (j > 0).then(|| (n - width, self.between[1][n - width].count)),
        ];
        all.into_iter().flatten()
    }

    /// How many lines lie between a place and each other.
    fn depths(&self, from: usize, budget: &Budget) -> Result<Vec<u32>> {
        let mut depth = vec![u32::MAX; self.size[0] * self.size[1]];
        depth[from] = 0;
        let mut now = VecDeque::from([from]);
        let mut later: Vec<VecDeque<usize>> = Vec::new();
        let mut level = 0;
        loop {
            while let Some(n) = now.pop_front() {
                budget.spend(WORK.0 / 10)?;
                if depth[n] != level {
                    continue;
                }
                for (other, count) in self.beside(n) {
                    let there = level + u32::from(count);
                    if there < depth[other] {
                        depth[other] = there;
                        if count == 0 {
                            now.push_back(other);
                        } else {
                            let k = usize::from(count) - 1;
                            later.resize_with(later.len().max(k + 1), VecDeque::new);
                            later[k].push_back(other);
                        }
                    }
                }
            }
            if later.is_empty() {
                return Ok(depth);
            }
            now = later.remove(0);
            level += 1;
        }
    }

    /// Whether lines part what they should: across each there is one level more, or less.
    fn is_sound(&self, depth: &[u32]) -> bool {
        let (mut sound, mut all) = (0, 0);
        for n in 0..depth.len() {
            for (other, _) in self.beside(n).filter(|(other, count)| *other > n && *count == 1) {
                all += 1;
                sound += usize::from(depth[n].abs_diff(depth[other]) == 1);
            }
        }
        sound as f64 >= SOUND * f64::from(all)
    }

    fn heights(&self, depth: &[u32], apart: f64, budget: &Budget) -> Result<Vec<f32>> {
        let place = |n: usize| Vector::xy((n % self.size[0]) as f64, (n / self.size[0]) as f64);
        let (mut places, mut levels) = (Vec::new(), Vec::new());
        for n in 0..depth.len() {
            for (k, step) in [(0, 1), (1, self.size[0])] {
                let between = self.between[k][n];
                if between.count != 1 || depth[n].abs_diff(depth[n + step]) != 1 {
                    continue;
                }
                let mut p = place(n);
                p[k] = between.at;
                places.push(p);
                levels.push(depth[n].min(depth[n + step]));
            }
        }
        let unit = apart / self.step;
        let extent = Vector::xy(self.size[0] as f64, self.size[1] as f64);
        let index = GridIndex::new(&places, unit, &Domain::Box(Bounds::new(Vector::ZERO, extent)));
        let mut values = Vec::with_capacity(depth.len());
        for (n, &level) in depth.iter().enumerate() {
            // The nearest line below and above.
            let mut near = [f64::INFINITY; 2];
            for reach in [0.5, 1.5, REACH] {
                budget.spend(index.within(place(n), reach * unit, |k, offset| {
                    if levels[k] == level {
                        near[1] = near[1].min(offset.norm());
                    } else if levels[k] + 1 == level {
                        near[0] = near[0].min(offset.norm());
                    }
                }))?;
                if near.iter().all(|d| d.is_finite()) {
                    break;
                }
            }
            let rise = |d: f64| PEAK * d / (d + unit);
            let part = match near {
                [low, high] if low.is_finite() && high.is_finite() => low / (low + high).max(1e-9),
                [low, _] if low.is_finite() => rise(low),
                [_, high] if high.is_finite() => 1.0 - rise(high),
                _ => 0.5,
            };
            values.push((f64::from(level) - 0.5 + part) as f32);
        }
        Ok(values)
    }
}
