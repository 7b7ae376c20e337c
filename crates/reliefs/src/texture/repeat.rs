//! The two shifts that carry a strictly repeating texture into itself: those of the autocorrelation, made exact on the field itself.
//!
//! The shifts of the coarse autocorrelation are good to a column or so. Two short ones span a lattice; its farther points say where to look on the field,
//! and what is found there makes the two more exact, doubling the distance each time.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Result};

use crate::search::field::Field;

/// Sine of the angle between the two shifts at least.
const ASKEW: f64 = 0.25;
/// Shifts of which pairs are tried, at most.
const SHIFTS: usize = 8;
/// Nodes of the field that are compared at most.
const NODES: usize = 1500;
/// Rounds in which the lattice is made exact, and steps that a shift goes downhill at most.
const ROUNDS: u32 = 5;
const STEPS: usize = 12;
/// Multiples of the shifts that are looked at, and how many of those, the longest, make the lattice exact.
const REACH: i32 = 8;
const LONGEST: usize = 24;
/// Share of what differs without any likeness from which on a shift does not carry the field into itself.
const ALIKE: f64 = 0.65;
/// How far beside the lattice the field is most like itself at most, in cells.
const OFF: f64 = 0.8;
/// A lattice at which the field differs by no more than this share beyond the best is as good.
const PART: f64 = 0.12;
/// Shortest shift, in cells.
const SHORTEST: f64 = 3.0;
/// Share of the shifts of the lattice at which the field has to be like itself.
const MOST: f64 = 0.8;
/// Shifts of the lattice at which it has to be at least: of fewer nothing follows.
const LEAST: usize = 5;
/// Parts of the cell in which places are looked for, along each shift.
const WAYS: usize = 8;
/// How much tiles may stretch or shear what repeats.
const STRETCH: f64 = 0.04;

/// The lattice of a texture, in cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Repeat {
    /// The two shifts; the first is no longer than the second.
    pub(crate) shifts: [[f64; 2]; 2],
}

fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn combined([a, b]: [[f64; 2]; 2], [m, n]: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|k| m * a[k] + n * b[k])
}

impl Repeat {
    /// Looks for the lattice that these shifts, good to `slack` cells, belong to, those that are surest first; `None` where they belong to none.
    pub(super) fn find(field: &Field, shifts: &[[f64; 2]], slack: f64, budget: &Budget) -> Result<Option<Self>> {
        let mut probe = Probe::new(field);
        let steps = (slack.ceil() as usize + 2).max(3);
        let sure = &shifts[..shifts.len().min(SHIFTS)];
        let pairs = (1..sure.len()).flat_map(|j| (0..j).map(move |i| [sure[i], sure[j]]));
        let is_askew = |[a, b]: &[[f64; 2]; 2]| cross(*a, *b).abs() > ASKEW * length(*a) * length(*b);
        let mut found = Vec::new();
        for pair in pairs.filter(is_askew) {
            let mut lattice = Self { shifts: pair }.reduced();
            for round in 0..ROUNDS {
                let multiples = lattice.multiples(&probe, f64::from(1_u32 << round));
                let steps = if round == 0 { steps } else { 2 };
                let Some(next) = lattice.refined(&mut probe, &multiples, steps, budget)? else { break };
                lattice = next.reduced();
            }
            let longest = lattice.longest(&probe);
            lattice = lattice.refined(&mut probe, &longest, 2, budget)?.unwrap_or(lattice).reduced();
            found.extend(lattice.explains(&mut probe, budget)?.map(|differs| (differs, lattice)));
        }
        // Of those that are as good as the best the one with the smallest cell.
        let least = found.iter().map(|f| f.0).fold(f64::INFINITY, f64::min);
        found.retain(|f| f.0 <= least + PART * probe.unlike);
        let smallest = found.into_iter().map(|f| f.1).min_by(|a, b| a.cell().total_cmp(&b.cell()));
        smallest.map(|lattice| lattice.divided(&mut probe, least, budget)).transpose()
    }

    /// Area of a cell.
    fn cell(&self) -> f64 {
        cross(self.shifts[0], self.shifts[1]).abs()
    }

    /// The same lattice by its shortest shifts.
    fn reduced(self) -> Self {
        let [mut a, mut b] = self.shifts;
        loop {
            if length(a) > length(b) {
                std::mem::swap(&mut a, &mut b);
            }
            let times = ((a[0] * b[0] + a[1] * b[1]) / length(a).powi(2)).round();
            let shorter = combined([b, a], [1.0, -times]);
            if times == 0.0 || !times.is_finite() || length(shorter) >= 0.999 * length(b) {
                break;
            }
            b = shorter;
        }
        // The first leads to the right, the second downwards from it.
        let a = if a[0] < 0.0 || a[0] == 0.0 && a[1] < 0.0 { a.map(|v| -v) } else { a };
        let b = if cross(a, b) < 0.0 { b.map(|v| -v) } else { b };
        Self { shifts: [a, b] }
    }

    /// Multiples of the shifts that are `far` apart at most, as far as the field reaches.
    fn multiples(&self, probe: &Probe, far: f64) -> Vec<[f64; 2]> {
        let all = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0], [2.0, 1.0], [1.0, 2.0]];
        let within = |m: &[f64; 2]| probe.knows(combined(self.shifts, *m));
        all.map(|m| m.map(|v| v * far)).into_iter().filter(within).collect()
    }

    /// The longest of all multiples, as far as the field reaches.
    fn longest(&self, probe: &Probe) -> Vec<[f64; 2]> {
        let all = (0..=REACH).flat_map(|n| (-REACH..=REACH).map(move |m| [f64::from(m), f64::from(n)]));
        let mut known: Vec<_> =
            all.filter(|m| (m[1] > 0.0 || m[0] > 0.0) && probe.knows(combined(self.shifts, *m))).collect();
        known.sort_by(|a, b| length(combined(self.shifts, *b)).total_cmp(&length(combined(self.shifts, *a))));
        known.truncate(LONGEST);
        known
    }

    /// The lattice that best agrees with what the field has at multiples of the shifts; `None` where they lead beyond the field.
    fn refined(
        &self,
        probe: &mut Probe,
        multiples: &[[f64; 2]],
        steps: usize,
        budget: &Budget,
    ) -> Result<Option<Self>> {
        // Least squares for both shifts: `sum m m^T S = sum m s^T`, over those shifts at which the field is like itself.
        let (mut mm, mut ms, mut good) = ([[0.0; 2]; 2], [[0.0; 2]; 2], 0);
        for m in multiples {
            let (found, difference) = probe.least(combined(self.shifts, *m), steps, budget)?;
            if difference > ALIKE * probe.unlike {
                continue;
            }
            good += 1;
            for i in 0..2 {
                for j in 0..2 {
                    mm[i][j] += m[i] * m[j];
                    ms[i][j] += m[i] * found[j];
                }
            }
        }
        if good < 3 {
            return Ok(None);
        }
        let det = mm[0][0] * mm[1][1] - mm[0][1] * mm[1][0];
        let row = |i: usize, j: usize| mm[1 - i][1 - i] * ms[i][j] - mm[i][1 - i] * ms[1 - i][j];
        let shifts = [0, 1].map(|i| [0, 1].map(|j| row(i, j) / det));
        let found = Self { shifts };
        let is_sound = shifts.iter().all(|s| length(*s).is_finite() && length(*s) > 1.0) && found.cell() > 1.0;
        Ok(is_sound.then_some(found))
    }

    /// How much the field differs from itself at the shifts of the lattice, if most of them carry it into itself.
    fn explains(&self, probe: &mut Probe, budget: &Budget) -> Result<Option<f64>> {
        let (mut all, mut good) = (Vec::new(), 0);
        for far in [1.0, 2.0, 3.0] {
            for m in self.multiples(probe, far) {
                let wanted = combined(self.shifts, m);
                let (shift, difference) = (probe.least(wanted, 3, budget)?.0, probe.between(wanted, budget)?);
                let off = length([shift[0] - wanted[0], shift[1] - wanted[1]]);
                good += usize::from(difference <= ALIKE * probe.unlike && off <= OFF);
                all.push(difference);
            }
        }
        all.sort_by(f64::total_cmp);
        Ok((good >= LEAST && good as f64 >= MOST * all.len() as f64).then(|| all[all.len() / 2]))
    }

    /// The lattice by parts of its shifts where those carry the field into itself as well.
    fn divided(self, probe: &mut Probe, differs: f64, budget: &Budget) -> Result<Self> {
        let mut found = self;
        let parts: [[f64; 2]; 7] = [
            [0.5, 0.0],
            [0.0, 0.5],
            [0.5, 0.5],
            [1.0 / 3.0, 0.0],
            [0.0, 1.0 / 3.0],
            [1.0 / 3.0; 2],
            [1.0 / 3.0, -1.0 / 3.0],
        ];
        'again: loop {
            for part in parts {
                let wanted = combined(found.shifts, part);
                if length(wanted) < SHORTEST {
                    continue;
                }
                let difference = probe.between(wanted, budget)?;
                let [a, b] = found.shifts;
                let finer = Self { shifts: [wanted, if part[0] == 0.0 { a } else { b }] }.reduced();
                let most = differs + PART * probe.unlike;
                if difference <= most && finer.explains(probe, budget)?.is_some_and(|d| d <= most) {
                    found = finer;
                    continue 'again;
                }
            }
            return Ok(found);
        }
    }

    /// By how many of each shift a way is made up.
    fn coordinates(&self, way: [f64; 2]) -> [f64; 2] {
        let [a, b] = self.shifts;
        let det = cross(a, b);
        [cross(way, b) / det, cross(a, way) / det]
    }

    /// Whether among these places there is one for every way in which something may go on.
    pub(crate) fn is_covered(&self, places: &[[u32; 2]]) -> bool {
        let mut is_met = [false; WAYS * WAYS];
        for place in places {
            let [u, v] = self.coordinates(place.map(f64::from)).map(|t| ((t - t.floor()) * WAYS as f64) as usize);
            is_met[v.min(WAYS - 1) * WAYS + u.min(WAYS - 1)] = true;
        }
        is_met.iter().all(|met| *met)
    }

    /// How far a way leads beside the nearest that carries the texture into itself.
    pub(crate) fn beside(&self, way: [f64; 2]) -> [f64; 2] {
        let whole = self.coordinates(way).map(f64::round);
        let nearest = |[m, n]: [f64; 2]| {
            let to = combined(self.shifts, [whole[0] + m, whole[1] + n]);
            [way[0] - to[0], way[1] - to[1]]
        };
        let around = (0..9).map(|k| nearest([f64::from(k % 3) - 1.0, f64::from(k / 3) - 1.0]));
        around.min_by(|a, b| length(*a).total_cmp(&length(*b))).unwrap_or(way)
    }

    /// Where in a plane of this lattice something is that is `way` from its origin in one of the texture's.
    pub(crate) fn of(&self, texture: &Self, way: [f64; 2]) -> [f64; 2] {
        combined(texture.shifts, self.coordinates(way))
    }

    /// The lattice, stretched a little so that a tile of this size closes; `None` where that takes more than a little.
    pub(crate) fn closing(&self, size: [f64; 2]) -> Option<Self> {
        let sides = [[size[0], 0.0], [0.0, size[1]]];
        let whole = sides.map(|side| self.coordinates(side).map(f64::round));
        let off = |k: usize| {
            let to = combined(self.shifts, whole[k]);
            length([to[0] - sides[k][0], to[1] - sides[k][1]])
        };
        // `W = M S`, with a side of the tile in each row of W: `S = M^-1 W`.
        let det = cross(whole[0], whole[1]);
        let suits = (0..2).all(|k| off(k) <= STRETCH * size[k]) && det.abs() > 0.5;
        let row = |i: usize| {
            let of = |k: usize| if i == 0 { whole[1 - k][1] } else { whole[1 - k][0] };
            let sign = |k: usize| if i == k { 1.0 } else { -1.0 };
            [0, 1].map(|k| sign(k) * of(k) * size[k] / det)
        };
        suits.then(|| Self { shifts: [row(0), row(1)] })
    }

    /// The lengths nearest to `length`, below and above it, after which the texture comes again along x or y.
    pub(crate) fn lengths(&self, axis: usize, wanted: f64) -> [Option<f64>; 2] {
        let most = (2.0 * wanted / length(self.shifts[0])).ceil().min(400.0) as i64;
        let mut near = [None, None];
        for (m, n) in (-most..=most).flat_map(|m| (-most..=most).map(move |n| (m, n))) {
            let to = combined(self.shifts, [m as f64, n as f64]);
            let (along, off) = (to[axis], to[1 - axis].abs());
            if along <= 0.0 || off > 0.5 * STRETCH * along {
                continue;
            }
            let side = usize::from(along > wanted);
            let is_nearer = |old: f64| (along - wanted).abs() < (old - wanted).abs();
            if near[side].is_none_or(is_nearer) {
                near[side] = Some(along);
            }
        }
        near
    }
}

/// The field, compared with itself at a part of its nodes.
struct Probe<'a> {
    field: &'a Field,
    stride: usize,
    known: BTreeMap<[i64; 2], f64>,
    /// What differs without any likeness: twice the variance.
    unlike: f64,
}

impl<'a> Probe<'a> {
    fn new(field: &'a Field) -> Self {
        let known: Vec<usize> = (0..field.width * field.height).filter(|k| field.is_known(*k)).collect();
        let count = known.len().max(1);
        let variance = |plane: &Vec<f32>| {
            let (sum, squares) = known.iter().fold((0.0, 0.0), |(sum, squares), k| {
                let v = f64::from(plane[*k]);
                (sum + v, squares + v * v)
            });
            (squares / count as f64 - (sum / count as f64).powi(2)).max(0.0)
        };
        let stride = ((count as f64 / NODES as f64).sqrt().round() as usize).max(1);
        Self { field, stride, known: BTreeMap::new(), unlike: 2.0 * field.planes.iter().map(variance).sum::<f64>() }
    }

    /// Whether enough of the field has a counterpart at a shift.
    fn knows(&self, shift: [f64; 2]) -> bool {
        let size = [self.field.width as f64, self.field.height as f64];
        (0..2).all(|k| shift[k].abs() + 2.0 < 0.7 * size[k])
    }

    /// Mean squared difference at a shift of whole cells.
    fn difference(&mut self, shift: [f64; 2], budget: &Budget) -> Result<f64> {
        let (width, height) = (self.field.width as i64, self.field.height as i64);
        let [x, y] = shift.map(|v| v as i64);
        if let Some(difference) = self.known.get(&[x, y]) {
            return Ok(*difference);
        }
        let nodes = |low: i64, high: i64| (low.max(0)..high).step_by(self.stride);
        let (mut sum, mut count) = (0.0, 0_u64);
        for j in nodes(-y, height.min(height - y)) {
            for i in nodes(-x, width.min(width - x)) {
                let (a, b) = ((j * width + i) as usize, ((j + y) * width + i + x) as usize);
                if !(self.field.is_known(a) && self.field.is_known(b)) {
                    continue;
                }
                sum += self.field.planes.iter().map(|p| f64::from((p[a] - p[b]) * (p[a] - p[b]))).sum::<f64>();
                count += 1;
            }
        }
        budget.spend(count * self.field.planes.len() as u64)?;
        let difference = if count == 0 { f64::INFINITY } else { sum / count as f64 };
        self.known.insert([x, y], difference);
        Ok(difference)
    }

    /// Mean squared difference at any shift: the numbers between the nodes are mixed of those around.
    fn between(&self, shift: [f64; 2], budget: &Budget) -> Result<f64> {
        let (width, height) = (self.field.width as i64, self.field.height as i64);
        let [x, y] = shift.map(|v| v.floor() as i64);
        let [u, v] = shift.map(|v| (v - v.floor()) as f32);
        let nodes = |low: i64, high: i64| (low.max(0)..high).step_by(self.stride);
        let (mut sum, mut count) = (0.0, 0_u64);
        for j in nodes(-y, height.min(height - y - 1)) {
            for i in nodes(-x, width.min(width - x - 1)) {
                let (a, b) = ((j * width + i) as usize, ((j + y) * width + i + x) as usize);
                let w = width as usize;
                if ![a, b, b + 1, b + w, b + w + 1].iter().all(|k| self.field.is_known(*k)) {
                    continue;
                }
                let square = |p: &Vec<f32>| {
                    let mixed =
                        (p[b] * (1.0 - u) + p[b + 1] * u) * (1.0 - v) + (p[b + w] * (1.0 - u) + p[b + w + 1] * u) * v;
                    f64::from((p[a] - mixed) * (p[a] - mixed))
                };
                sum += self.field.planes.iter().map(square).sum::<f64>();
                count += 1;
            }
        }
        budget.spend(count * self.field.planes.len() as u64 * 4)?;
        Ok(if count == 0 { f64::INFINITY } else { sum / count as f64 })
    }

    /// Where near `start` the field is most like itself, between the cells, and how much it differs there.
    fn least(&mut self, start: [f64; 2], steps: usize, budget: &Budget) -> Result<([f64; 2], f64)> {
        let mut at = start.map(f64::round);
        let mut around = self.around(at, budget)?;
        for _ in 0..steps.min(STEPS) {
            let best = (0..9).min_by(|a, b| around[*a].total_cmp(&around[*b])).unwrap_or(4);
            if around[best] >= around[4] {
                break;
            }
            at = [at[0] + (best % 3) as f64 - 1.0, at[1] + (best / 3) as f64 - 1.0];
            around = self.around(at, budget)?;
        }
        // The lowest point of a parabola through three neighbours, and how much lower than the middle it is.
        let between = |a: f64, b: f64, c: f64| {
            let bend = a + c - 2.0 * b;
            let is_valley = bend.is_finite() && bend > 0.0 && a >= b && c >= b;
            if is_valley { (0.5 * (a - c) / bend, (a - c).powi(2) / (8.0 * bend)) } else { (0.0, 0.0) }
        };
        let (x, y) = (between(around[3], around[4], around[5]), between(around[1], around[4], around[7]));
        Ok(([at[0] + x.0, at[1] + y.0], around[4] - x.1 - y.1))
    }

    /// The differences at a shift and its eight neighbours, row by row.
    fn around(&mut self, at: [f64; 2], budget: &Budget) -> Result<[f64; 9]> {
        let mut all = [0.0; 9];
        for (k, value) in all.iter_mut().enumerate() {
            *value = self.difference([at[0] + (k % 3) as f64 - 1.0, at[1] + (k / 3) as f64 - 1.0], budget)?;
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use arabesque_core::{Stage, Stream, Vector};
    use arabesque_surface::OrientedPoints;

    use super::*;
    use crate::search::field::Lattice;

    /// The field of a sheet that repeats by a lattice.
    fn field(shifts: [[f64; 2]; 2], noise: f64) -> Field {
        let mut random = Stream::new(5, Stage::TEST, 0);
        let lattice = Repeat { shifts };
        let points: Vec<_> = (0..10_000)
            .map(|k| {
                let at = [f64::from(k % 100), f64::from(k / 100)];
                let [u, v] = lattice.coordinates(at);
                // Symmetric under nothing but the shifts.
                let height =
                    (TAU * u).sin() + (TAU * v).cos() + 0.7 * (TAU * (u + v)).sin() + 0.5 * (TAU * 2.0 * u).cos();
                Vector([at[0], at[1], height + noise * random.range(-1.0, 1.0)])
            })
            .collect();
        let budget = Budget::default();
        let points = OrientedPoints::new(points, vec![Vector([0.0, 0.0, 1.0]); 10_000], 2.5, &budget).unwrap();
        let lattice = Lattice { cell: 1.0, heights: vec![-2.0, 0.0, 2.0], reach: 6.0 };
        Field::new(&points, &lattice, [0.0, 0.0], (100, 100), &budget).unwrap()
    }

    /// How far the shifts of a lattice lie beside another at most.
    fn off(found: &Repeat, wanted: &Repeat) -> f64 {
        let both = [(found, wanted), (wanted, found)];
        both.iter().flat_map(|(a, b)| a.shifts.map(|s| length(b.beside(s)))).fold(0.0, f64::max)
    }

    #[test]
    fn the_lattice_is_found_exactly_from_shifts_that_are_off() {
        let wanted = Repeat { shifts: [[13.3, 0.0], [5.1, 9.7]] };
        let near = |m: f64, n: f64| combined(wanted.shifts, [m, n]).map(|v| (v / 2.0).round() * 2.0);
        for shifts in [vec![near(1.0, 0.0), near(0.0, 1.0)], vec![near(2.0, 1.0), near(1.0, -1.0), near(0.0, 2.0)]] {
            let found = Repeat::find(&field(wanted.shifts, 0.1), &shifts, 2.0, &Budget::default()).unwrap().unwrap();
            assert!(off(&found, &wanted) < 0.1, "{found:?} {shifts:?}");
        }
    }

    #[test]
    fn what_does_not_repeat_so_has_no_lattice() {
        let real = field([[13.3, 0.0], [5.1, 9.7]], 0.1);
        let far = [[20.0, 3.0], [4.0, 17.0], [9.0, 26.0]];
        assert_eq!(Repeat::find(&real, &far, 0.0, &Budget::default()).unwrap(), None);
        assert_eq!(Repeat::find(&real, &[[13.0, 0.0], [26.0, 0.0]], 1.0, &Budget::default()).unwrap(), None);
        assert_eq!(Repeat::find(&real, &[], 1.0, &Budget::default()).unwrap(), None);
    }

    #[test]
    fn ways_beside_the_lattice_are_told_from_its_nearest_point() {
        let lattice = Repeat { shifts: [[10.0, 0.0], [5.0, 6.0]] };
        for way in [[0.3, -0.4], [5.3, 5.6], [-9.7, -0.4], [15.3, 5.6]] {
            let [x, y] = lattice.beside(way);
            assert!((x - 0.3).abs() < 1e-9 && (y + 0.4).abs() < 1e-9, "{way:?}: {x} {y}");
        }
        assert!((length(lattice.beside([5.0, 0.0])) - 5.0).abs() < 1e-9);
    }

    #[test]
    fn places_over_a_whole_cell_cover_it() {
        let lattice = Repeat { shifts: [[20.0, 0.0], [10.0, 12.0]] };
        let block = |width: u32, height: u32| -> Vec<[u32; 2]> {
            (0..width * height).map(|k| [100 + k % width, 57 + k / width]).collect()
        };
        assert!(lattice.is_covered(&block(20, 12)) && lattice.is_covered(&block(10, 24)));
        assert!(!lattice.is_covered(&block(14, 12)) && !lattice.is_covered(&[]));
    }

    #[test]
    fn tiles_that_nearly_suit_are_closed_and_for_others_better_ones_are_told() {
        let lattice = Repeat { shifts: [[10.0, 0.0], [5.0, 6.0]] };
        let closing = lattice.closing([51.0, 35.5]).unwrap();
        for (side, whole) in [([51.0, 0.0], [5.0, 0.0]), ([0.0, 35.5], [-3.0, 6.0])] {
            let to = combined(closing.shifts, whole);
            assert!((to[0] - side[0]).abs() < 1e-9 && (to[1] - side[1]).abs() < 1e-9, "{side:?}: {to:?}");
        }
        assert_eq!(lattice.closing([55.0, 36.0]), None);
        assert_eq!(lattice.closing([50.0, 42.0]), None, "seven rows shift it by a half");
        assert_eq!(lattice.lengths(0, 55.0), [Some(50.0), Some(60.0)]);
        assert_eq!(lattice.lengths(1, 42.0), [Some(36.0), Some(48.0)]);
    }
}
