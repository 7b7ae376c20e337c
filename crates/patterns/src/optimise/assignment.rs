//! Pairing of the samples of two neighbourhoods at the least total cost.
//!
//! Shortest augmenting paths with the start of [Jonker 1987 §4]: rows take their cheapest column, rows that lost bid
//! for another one (augmenting row reduction), and only what is left is settled by shortest paths. Column prices start
//! at zero and only fall on columns that are taken, so that the start also holds for more columns than rows.
//!
//! Each row may stay alone at a cost of its own, the outlier cost [Tu 2020 §4.2.3]. That is a column which no other row
//! can use: a row that once prefers it never leaves it, so these columns need neither price nor storage. A pair that
//! costs as much as staying alone cannot be part of a better pairing and is dropped on entry; what remains is a short
//! list per row.
//!
//! All buffers are kept between calls.

#[cfg(any(test, feature = "bench-stages"))]
use arabesque_core::Budget;
use arabesque_core::{Meter, Numbered, Result};

/// A number or none, in four bytes: `Option<u32>` takes eight, and these lists are filled and read for every pairing of
/// two neighbourhoods, the innermost loop of the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct MaybeNumber(u32);

impl Default for MaybeNumber {
    fn default() -> Self {
        Self::NONE
    }
}

impl MaybeNumber {
    const NONE: Self = Self(u32::MAX);

    #[inline]
    fn get(self) -> Option<u32> {
        (self != Self::NONE).then_some(self.0)
    }
}

impl From<u32> for MaybeNumber {
    #[inline]
    fn from(number: u32) -> Self {
        Self(number)
    }
}

/// Entries of a row that are compared in one go when a full cost matrix is read.
#[cfg(any(test, feature = "bench-stages"))]
const LANES: usize = 16;

/// Nanoseconds for a pair or a column that a step looks at.
const STEP: u64 = 2;

/// Solver with its buffers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Assignment {
    columns: usize,
    /// Usable pairs of row `i`: slots `starts[i]..starts[i + 1]`; the last entry is the number of slots.
    starts: Numbered<u32>,
    /// Column and cost of each slot.
    pairs: Numbered<(u32, f32)>,
    /// Outlier cost of each row: what it costs to stay alone.
    outlier: Numbered<f32>,
    /// Slot of the cheapest pair of each row.
    cheapest: Numbered<MaybeNumber>,
    /// Sum over rows of the cheaper of cheapest pair and outlier cost.
    bound: f32,
    /// Outlier cost of the open row.
    gate: f32,
    /// Cost of its cheapest pair so far, if cheaper than that, and its slot.
    least: (f32, MaybeNumber),
    /// Slot by which each row is paired.
    slot_of: Numbered<MaybeNumber>,
    /// Column of that slot.
    column_of: Numbered<MaybeNumber>,
    /// Row that holds each column.
    row_of: Numbered<MaybeNumber>,
    /// Dual value of each column, never positive, zero while the column is free.
    price: Numbered<f32>,
    /// Rows that still wait for a decision.
    waiting: Vec<u32>,
    search: PathSearch,
}

/// Shortest path tree over columns.
#[derive(Clone, Debug, Default)]
struct PathSearch {
    /// Shortest known distance of each column: infinite before it is reached, minus infinite once it is settled.
    distance: Numbered<f32>,
    /// Slot through which each column was reached, and the row of the slot.
    reached_by: Numbered<(u32, u32)>,
    /// Columns reached so far, the settled ones first.
    reached: Vec<u32>,
    /// Final distances of the settled columns.
    settled: Vec<f32>,
    /// Best end among rows that could become outliers.
    leave: Option<(f32, u32)>,
}

/// What came of a row's bid for a column.
enum Bid {
    /// The row has found its place.
    Placed,
    /// The row took the column of another row.
    Displaced(u32),
    /// Bidding cannot decide: two options are equally good, or there is no second one.
    Tied,
}

/// Where an augmenting path ends.
enum End {
    /// At a free column.
    Column(u32),
    /// At a row that becomes an outlier.
    Row(u32),
}

impl Assignment {
    /// Pairs every row with a column of its own at the least total cost, which is returned.
    /// `cost` is finite and row-major; `rows <= columns`.
    #[cfg(any(test, feature = "bench-stages"))]
    pub(crate) fn solve(&mut self, rows: usize, columns: usize, cost: &[f32]) -> f32 {
        debug_assert!(rows <= columns && cost.len() >= rows * columns);
        self.begin(columns);
        for i in 0..rows {
            self.enter_row(&cost[i * columns..(i + 1) * columns], f32::INFINITY);
        }
        self.settle(&mut Budget::default().meter()).unwrap_or(f32::NAN)
    }

    /// Pairs rows with columns, or leaves row `i` alone at `outlier[i]`, at the least total cost, which is returned.
    /// `cost` is row-major; an infinite cost marks a pair that must not be. There may be fewer columns than rows.
    #[cfg(any(test, feature = "bench-stages"))]
    pub(crate) fn solve_with_outliers(&mut self, rows: usize, columns: usize, cost: &[f32], outlier: &[f32]) -> f32 {
        debug_assert!(cost.len() >= rows * columns && outlier.len() >= rows);
        self.begin(columns);
        for (i, &alone) in outlier.iter().enumerate().take(rows) {
            self.enter_row(&cost[i * columns..(i + 1) * columns], alone);
        }
        self.settle(&mut Budget::default().meter()).unwrap_or(f32::NAN)
    }

    /// Enters a full matrix and [settles it greedily](Self::settle_greedily). `cost` is row-major.
    #[cfg(any(test, feature = "bench-stages"))]
    pub(crate) fn greedy(&mut self, rows: usize, columns: usize, cost: &[f32]) -> f32 {
        self.begin(columns);
        for i in 0..rows {
            self.enter_row(&cost[i * columns..(i + 1) * columns], f32::INFINITY);
        }
        self.settle_greedily(&mut Budget::default().meter()).unwrap_or(f32::NAN)
    }

    /// Partner of each row: a column, or `None` where the row stays alone, an outlier.
    pub(crate) fn column_of(&self) -> impl Iterator<Item = Option<u32>> {
        self.column_of.iter().map(|column| column.get())
    }

    /// Starts a problem whose pairs come one by one: for each row a [`Assignment::begin_row`], any number of
    /// [`Assignment::pair`]s and an [`Assignment::end_row`]; then [`Assignment::settle`] or
    /// [`Assignment::settle_greedily`].
    pub(crate) fn begin(&mut self, columns: usize) {
        self.columns = columns;
        self.pairs.clear();
        self.outlier.clear();
        self.cheapest.clear();
        self.starts.clear();
        self.starts.push(0);
        self.bound = 0.0;
    }

    /// Opens a row. `outlier` is its cost of staying alone; infinite where it must have a partner.
    pub(crate) fn begin_row(&mut self, outlier: f32) {
        self.outlier.push(outlier);
        self.gate = outlier;
        self.least = (outlier, MaybeNumber::NONE);
    }

    /// Offers a partner to the open row; each column at most once per row.
    #[inline]
    pub(crate) fn pair(&mut self, column: u32, cost: f32) {
        if cost < self.gate {
            if cost < self.least.0 {
                self.least = (cost, MaybeNumber(self.pairs.len() as u32));
            }
            self.pairs.push((column, cost));
        }
    }

    /// Closes the open row. Returns a lower bound of what [`Assignment::settle`] will return, from the rows entered so
    /// far.
    pub(crate) fn end_row(&mut self) -> f32 {
        let (best, slot) = self.least;
        self.bound += best;
        self.cheapest.push(slot);
        self.starts.push(self.pairs.len() as u32);
        self.bound
    }

    /// Solves the problem that was entered. Returns the least total cost: infinite when a row that must have a partner
    /// gets none.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn settle(&mut self, meter: &mut Meter<'_>) -> Result<f32> {
        self.reset();
        for row in 0..self.outlier.len() as u32 {
            match self.cheapest[row].get() {
                None => {}
                Some(slot) if self.is_free(self.column(slot)) => self.take(row, slot),
                Some(_) => self.waiting.push(row),
            }
        }
        if self.waiting.is_empty() {
            return Ok(self.bound);
        }
        self.bid_all(meter)?;
        if !self.waiting.is_empty() {
            self.search.reset(self.columns);
            while let Some(row) = self.waiting.pop() {
                self.augment(row, meter)?;
            }
        }
        Ok(self.total())
    }

    /// Settles the problem that was entered by pairing the nearest pair first, then the nearest of the rest, and so on
    /// [Ma 2011 §3.2]. Returns the sum over the pairs; rows left over are outliers and not counted.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn settle_greedily(&mut self, meter: &mut Meter<'_>) -> Result<f32> {
        self.reset();
        let mut total = 0.0;
        while let Some((row, slot)) = self.nearest_open_pair() {
            // Rows whose cheapest column is gone look through theirs again.
            meter.spend(STEP * (self.outlier.len() + self.pairs.len() / 4) as u64)?;
            self.take(row, slot);
            total += self.pairs[slot].1;
        }
        Ok(total)
    }

    /// Enters a full row, skipping stretches without a usable pair.
    #[cfg(any(test, feature = "bench-stages"))]
    fn enter_row(&mut self, row: &[f32], outlier: f32) {
        self.begin_row(outlier);
        let (chunks, rest) = row.as_chunks::<LANES>();
        for (k, chunk) in chunks.iter().enumerate() {
            if chunk.iter().fold(false, |any, &c| any | (c < outlier)) {
                self.enter_entries(k * LANES, chunk);
            }
        }
        self.enter_entries(chunks.len() * LANES, rest);
        self.end_row();
    }

    #[cfg(any(test, feature = "bench-stages"))]
    fn enter_entries(&mut self, first: usize, entries: &[f32]) {
        for (k, &cost) in entries.iter().enumerate() {
            self.pair((first + k) as u32, cost);
        }
    }

    fn reset(&mut self) {
        let rows = self.outlier.len();
        self.slot_of.refill(MaybeNumber::NONE, rows);
        self.column_of.refill(MaybeNumber::NONE, rows);
        self.row_of.refill(MaybeNumber::NONE, self.columns);
        self.price.refill(0.0, self.columns);
        self.waiting.clear();
    }

    fn column(&self, slot: u32) -> u32 {
        self.pairs[slot].0
    }

    fn is_free(&self, column: u32) -> bool {
        self.row_of[column] == MaybeNumber::NONE
    }

    fn slots(&self, row: u32) -> std::ops::Range<usize> {
        self.starts[row] as usize..self.starts[row + 1] as usize
    }

    fn take(&mut self, row: u32, slot: u32) {
        let column = self.column(slot);
        self.slot_of[row] = slot.into();
        self.column_of[row] = column.into();
        self.row_of[column] = row.into();
    }

    fn leave(&mut self, row: u32) {
        self.slot_of[row] = MaybeNumber::NONE;
        self.column_of[row] = MaybeNumber::NONE;
    }

    fn total(&self) -> f32 {
        let cost = |(slot, &outlier): (&MaybeNumber, &f32)| slot.get().map_or(outlier, |slot| self.pairs[slot].1);
        self.slot_of.iter().zip(&self.outlier).map(cost).sum()
    }

    /// Lets waiting rows outbid each other; those that bidding cannot place wait on.
    fn bid_all(&mut self, meter: &mut Meter<'_>) -> Result<()> {
        // Bidding wars between nearly equal rows are cut short: a path search settles them in one go.
        let mut bids = 4 * self.waiting.len() + 16;
        let mut kept = 0;
        for k in 0..self.waiting.len() {
            if let Some(row) = self.bid_from(self.waiting[k], &mut bids, meter)? {
                self.waiting[kept] = row;
                kept += 1;
            }
        }
        self.waiting.truncate(kept);
        Ok(())
    }

    /// Bids for `row`, then for the row that it displaced, and so on. Returns the row that is left without a place.
    fn bid_from(&mut self, mut row: u32, bids: &mut usize, meter: &mut Meter<'_>) -> Result<Option<u32>> {
        while *bids > 0 {
            *bids -= 1;
            meter.spend(STEP * (1 + self.slots(row).len() as u64))?;
            match self.bid(row) {
                Bid::Placed => return Ok(None),
                Bid::Displaced(other) => row = other,
                Bid::Tied => return Ok(Some(row)),
            }
        }
        Ok(Some(row))
    }

    fn bid(&mut self, row: u32) -> Bid {
        let (mut best, mut second, mut slot) = (self.outlier[row], f32::INFINITY, None);
        for k in self.slots(row) {
            let (column, cost) = self.pairs[k];
            let reduced = cost - self.price[column];
            if reduced < best {
                (best, second, slot) = (reduced, best, Some(k as u32));
            } else if reduced < second {
                second = reduced;
            }
        }
        // Prices only fall, so no column will ever become better than staying alone.
        let Some(slot) = slot else { return Bid::Placed };
        let column = self.column(slot);
        let other = self.row_of[column].get();
        let margin = second - best;
        if other.is_some() && (margin <= 0.0 || !margin.is_finite()) {
            return Bid::Tied;
        }
        if margin.is_finite() {
            self.price[column] -= margin;
        }
        self.take(row, slot);
        let Some(other) = other else { return Bid::Placed };
        self.leave(other);
        Bid::Displaced(other)
    }

    /// Places `start` by a shortest augmenting path: along it rows change to other columns, and at its end a column is
    /// taken that was free or a row becomes an outlier.
    fn augment(&mut self, start: u32, meter: &mut Meter<'_>) -> Result<()> {
        let (mut row, mut shift) = (start, 0.0);
        let (end, length) = loop {
            let open = self.search.reached.len() - self.search.settled.len();
            if let Err(stopped) = meter.spend(STEP * (1 + self.slots(row).len() + open) as u64) {
                // The next problem starts with an empty tree.
                self.search.clear();
                return Err(stopped);
            }
            self.relax(row, shift);
            let nearest = self.search.nearest_open();
            if let Some((length, row)) = self.search.leave
                && nearest.is_none_or(|(_, d)| length <= d)
            {
                break (End::Row(row), length);
            }
            let Some((k, length)) = nearest else {
                // No column left for a row that must have one: it stays without.
                self.search.clear();
                return Ok(());
            };
            let column = self.search.reached[k];
            let (Some(holder), Some(slot)) = (self.row_of[column].get(), self.slot_holding(column)) else {
                break (End::Column(column), length);
            };
            row = holder;
            self.search.settle(k);
            shift = length - (self.pairs[slot].1 - self.price[column]);
        };
        for (&column, &distance) in self.search.reached.iter().zip(&self.search.settled) {
            self.price[column] += distance - length;
        }
        self.flip(start, end);
        self.search.clear();
        Ok(())
    }

    /// Slot by which the row that holds a column is paired with it.
    fn slot_holding(&self, column: u32) -> Option<u32> {
        self.row_of[column].get().and_then(|row| self.slot_of[row].get())
    }

    /// Reaches the columns of `row`, which is itself reached at reduced distance `shift`.
    fn relax(&mut self, row: u32, shift: f32) {
        let alone = self.outlier[row] + shift;
        if alone.is_finite() && self.search.leave.is_none_or(|(d, _)| alone < d) {
            self.search.leave = Some((alone, row));
        }
        for k in self.slots(row) {
            let (column, cost) = self.pairs[k];
            self.search.reach(column, cost - self.price[column] + shift, (k as u32, row));
        }
    }

    fn flip(&mut self, start: u32, end: End) {
        let mut column = match end {
            End::Column(column) => Some(column),
            End::Row(row) => {
                let column = self.column_of[row].get().filter(|_| row != start);
                self.leave(row);
                column
            }
        };
        while let Some(reached) = column {
            let (slot, row) = self.search.reached_by[reached];
            column = self.column_of[row].get().filter(|_| row != start);
            self.take(row, slot);
        }
    }

    /// The cheapest pair whose row and column are both still free: row and slot.
    fn nearest_open_pair(&mut self) -> Option<(u32, u32)> {
        let mut best: Option<(u32, u32, f32)> = None;
        for row in 0..self.outlier.len() as u32 {
            if self.slot_of[row] != MaybeNumber::NONE {
                continue;
            }
            self.refresh_cheapest(row);
            if let Some(slot) = self.cheapest[row].get()
                && best.is_none_or(|(.., cost)| self.pairs[slot].1 < cost)
            {
                best = Some((row, slot, self.pairs[slot].1));
            }
        }
        best.map(|(row, slot, _)| (row, slot))
    }

    /// Makes `cheapest` point to a free column again.
    fn refresh_cheapest(&mut self, row: u32) {
        if self.cheapest[row].get().is_none_or(|slot| self.is_free(self.column(slot))) {
            return;
        }
        let (mut best, mut slot) = (f32::INFINITY, MaybeNumber::NONE);
        for k in self.slots(row) {
            let (column, cost) = self.pairs[k];
            if cost < best && self.is_free(column) {
                (best, slot) = (cost, MaybeNumber(k as u32));
            }
        }
        self.cheapest[row] = slot;
    }
}

impl PathSearch {
    /// Makes room for a problem. The tree is empty before and after each search.
    fn reset(&mut self, columns: usize) {
        self.distance.refill(f32::INFINITY, columns);
        // Entries are written as their columns are reached.
        self.reached_by.refill((0, 0), columns);
    }

    /// Forgets the tree.
    fn clear(&mut self) {
        for &column in &self.reached {
            self.distance[column] = f32::INFINITY;
        }
        self.reached.clear();
        self.settled.clear();
        self.leave = None;
    }

    fn reach(&mut self, column: u32, distance: f32, by: (u32, u32)) {
        let known = &mut self.distance[column];
        if distance < *known {
            if *known == f32::INFINITY {
                self.reached.push(column);
            }
            *known = distance;
            self.reached_by[column] = by;
        }
    }

    /// The nearest column that is reached but not settled: index into `reached`, and distance.
    fn nearest_open(&self) -> Option<(usize, f32)> {
        let open = self.reached.iter().enumerate().skip(self.settled.len());
        open.map(|(k, &c)| (k, self.distance[c])).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Makes the distance of `reached[k]` final. Rounding must not improve it any more: the tree would get a cycle.
    fn settle(&mut self, k: usize) {
        self.reached.swap(k, self.settled.len());
        let column = self.reached[self.settled.len()];
        self.settled.push(std::mem::replace(&mut self.distance[column], f32::NEG_INFINITY));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pathfinding::{kuhn_munkres::kuhn_munkres_min, matrix::Matrix};
    use proptest::prelude::*;

    /// The column of each row.
    fn pairing(solver: &Assignment) -> Vec<Option<u32>> {
        solver.column_of().collect()
    }

    /// Least cost by the library, outliers as extra columns.
    fn reference(rows: usize, columns: usize, cost: &[f32], outlier: &[f32]) -> i64 {
        const FORBIDDEN: i64 = 1 << 32;
        if rows == 0 {
            return 0;
        }
        let width = columns + outlier.len();
        let entry = |i: usize, j: usize| match j.checked_sub(columns) {
            None if cost[i * columns + j].is_finite() => cost[i * columns + j] as i64,
            Some(k) if k == i && outlier[i].is_finite() => outlier[i] as i64,
            _ => FORBIDDEN,
        };
        let matrix = Matrix::from_fn(rows, width, |(i, j)| entry(i, j));
        kuhn_munkres_min(&matrix).0
    }

    /// Cost of the pairing that the solver reports, which must use each column at most once.
    fn cost_of(solver: &Assignment, columns: usize, cost: &[f32], outlier: &[f32]) -> f32 {
        let mut used = vec![false; columns];
        let mut total = 0.0;
        for (i, j) in solver.column_of().enumerate() {
            let Some(j) = j.map(|j| j as usize) else {
                total += outlier[i];
                continue;
            };
            assert!(!std::mem::replace(&mut used[j], true), "column {j} is used twice");
            total += cost[i * columns + j];
        }
        total
    }

    /// Integers up to `largest` as costs: exact in f32, and full of ties when `largest` is small.
    fn costs(n: usize, largest: u32) -> impl Strategy<Value = Vec<f32>> {
        prop::collection::vec((0..=largest).prop_map(|v| v as f32), n)
    }

    fn square_or_wide() -> impl Strategy<Value = (usize, usize, Vec<f32>)> {
        (0_usize..14, 0_usize..10, prop::sample::select(vec![2_u32, 20, 3000]))
            .prop_flat_map(|(r, extra, largest)| (Just(r), Just(r + extra), costs(r * (r + extra), largest)))
    }

    fn any_shape() -> impl Strategy<Value = (usize, usize, Vec<f32>, Vec<f32>)> {
        (0_usize..14, 0_usize..18, prop::sample::select(vec![3_u32, 20, 3000])).prop_flat_map(|(r, c, largest)| {
            let gated = prop::collection::vec(prop::bool::weighted(0.2), r * c);
            let cost = (costs(r * c, largest), gated).prop_map(|(cost, gated)| {
                cost.iter().zip(gated).map(|(&c, g)| if g { f32::INFINITY } else { c }).collect()
            });
            (Just(r), Just(c), cost, costs(r, largest / 2))
        })
    }

    proptest! {
        #[test]
        fn full_pairings_are_optimal((rows, columns, cost) in square_or_wide()) {
            let mut solver = Assignment::default();
            let total = solver.solve(rows, columns, &cost);
            prop_assert_eq!(total as i64, reference(rows, columns, &cost, &[]));
            prop_assert_eq!(total, cost_of(&solver, columns, &cost, &vec![f32::NAN; rows]));
        }

        #[test]
        fn pairings_with_outliers_are_optimal((rows, columns, cost, outlier) in any_shape()) {
            let mut solver = Assignment::default();
            let total = solver.solve_with_outliers(rows, columns, &cost, &outlier);
            prop_assert_eq!(total as i64, reference(rows, columns, &cost, &outlier));
            prop_assert_eq!(total, cost_of(&solver, columns, &cost, &outlier));
            prop_assert!(solver.bound <= total);
        }

        #[test]
        fn a_used_solver_answers_as_a_new_one(a in any_shape(), b in any_shape()) {
            let mut used = Assignment::default();
            used.solve_with_outliers(a.0, a.1, &a.2, &a.3);
            let mut new = Assignment::default();
            let want = new.solve_with_outliers(b.0, b.1, &b.2, &b.3);
            prop_assert_eq!(used.solve_with_outliers(b.0, b.1, &b.2, &b.3), want);
            prop_assert_eq!(pairing(&used), pairing(&new));
        }

        #[test]
        fn greedy_pairs_the_nearest_first((rows, columns, cost, _) in any_shape()) {
            let mut solver = Assignment::default();
            let total = solver.greedy(rows, columns, &cost);
            let mut order: Vec<_> = (0..rows * columns).filter(|&k| cost[k].is_finite()).collect();
            order.sort_by(|&a, &b| cost[a].total_cmp(&cost[b]).then(a.cmp(&b)));
            let (mut column_of, mut used, mut want) = (vec![None; rows], vec![false; columns], 0.0);
            for k in order {
                let (i, j) = (k / columns, k % columns);
                if column_of[i].is_none() && !used[j] {
                    (column_of[i], used[j]) = (Some(j as u32), true);
                    want += cost[k];
                }
            }
            prop_assert_eq!(pairing(&solver), column_of);
            prop_assert_eq!(total, want);
        }
    }

    #[test]
    fn nothing_to_pair_costs_nothing() {
        let mut solver = Assignment::default();
        assert_eq!(solver.solve(0, 5, &[]), 0.0);
        assert_eq!(solver.solve_with_outliers(0, 0, &[], &[]), 0.0);
        assert!(pairing(&solver).is_empty());
    }

    #[test]
    fn one_row_takes_the_only_column() {
        let mut solver = Assignment::default();
        assert_eq!(solver.solve(1, 1, &[3.0]), 3.0);
        assert_eq!(pairing(&solver), [Some(0)]);
    }

    #[test]
    fn everybody_stays_alone_when_partners_cost_as_much() {
        let mut solver = Assignment::default();
        assert_eq!(solver.solve_with_outliers(2, 2, &[5.0, 5.0, 5.0, 9.0], &[5.0, 5.0]), 10.0);
        assert_eq!(pairing(&solver), [None, None]);
        assert_eq!(solver.solve_with_outliers(2, 0, &[], &[1.0, 2.0]), 3.0);
    }

    #[test]
    fn a_row_gives_way_where_that_is_cheaper_in_all() {
        let mut solver = Assignment::default();
        // Both want column 0; the second has nowhere else to go, the first has column 1.
        let cost = [1.0, 2.0, 0.5, f32::INFINITY];
        assert_eq!(solver.solve_with_outliers(2, 2, &cost, &[4.0, 4.0]), 2.5);
        assert_eq!(pairing(&solver), [Some(1), Some(0)]);
    }

    #[test]
    fn a_row_that_must_be_paired_pushes_the_other_out() {
        let mut solver = Assignment::default();
        let total = solver.solve_with_outliers(2, 1, &[1.0, 3.0], &[2.0, f32::INFINITY]);
        assert_eq!((total, pairing(&solver)), (5.0, vec![None, Some(0)]));
        let total = solver.solve_with_outliers(2, 1, &[1.0, 3.0], &[f32::INFINITY; 2]);
        assert_eq!(total, f32::INFINITY);
    }

    #[test]
    fn a_cost_that_is_not_a_number_is_never_used() {
        let mut solver = Assignment::default();
        assert_eq!(solver.solve_with_outliers(1, 2, &[f32::NAN, 1.0], &[2.0]), 1.0);
        assert_eq!(pairing(&solver), [Some(1)]);
    }
}
