//! What of the place of a patch is there already, and how much of it counts where.
//!
//! Cells are *kept* where the result stays as it is, *overlapped* where it is there and is replaced, and *free* where nothing is. What is
//! pasted is wholly the result's at the kept cells and wholly the patch's at the free ones [Duranleau 2008 fig. 3 c].

use arabesque_core::Vector;

use crate::{distance::distances, patch::cut::sides, sample::Sample};

/// Where a patch ceases to be bent, as a share of its side, from the overlap on: beyond, it is as it is in the texture.
const FADE: f64 = 0.3;

/// How far on each side of a cut colours are blended, in cells.
const FRINGE: f64 = 1.0;

/// Cells around the place of a patch, whose corner is the origin.
#[derive(Clone, Debug)]
pub(crate) struct Mask {
    cell: f64,
    /// Cells of the border on each side.
    margin: usize,
    /// Cells along a side, borders included.
    side: usize,
    kinds: Vec<Kind>,
    /// Share of the result in what is pasted, at the middle of each cell.
    shares: Vec<f64>,
    /// How much of its bend a patch keeps, at the middle of each cell.
    bends: Vec<f64>,
    /// Distance of each cell from those that are kept, from those that are pasted, and from those that overlap, in cells.
    from_kept: Vec<f64>,
    from_pasted: Vec<f64>,
    from_overlap: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Kept,
    Overlap,
    Free,
}

impl Mask {
    /// The mask of a patch of `patch` cells a side with `border` around, of which `is_filled` holds where the result is there already, by the middle of
    /// the cell. Overlapped are cells at most `overlap` from free ones.
    pub(crate) fn new(
        cell: f64,
        (patch, overlap, border): (usize, usize, usize),
        is_filled: impl Fn(f64, f64) -> bool,
    ) -> Self {
        let margin = border.max(1);
        let side = patch + 2 * margin;
        let filled: Vec<bool> = (0..side * side)
            .map(|k| {
                let at = [k % side, k / side].map(|i| (i as f64 - margin as f64 + 0.5) * cell);
                is_filled(at[0], at[1])
            })
            .collect();
        let inner = |k: usize| [k % side, k / side].iter().all(|i| (margin..margin + patch).contains(i));
        let cells = |counts: &dyn Fn(usize) -> bool| -> Vec<f64> {
            let is_marked: Vec<bool> = (0..side * side).map(counts).collect();
            distances(&is_marked, (side, side), false)
        };
        let from_free = cells(&|k| !filled[k]);
        let kind = |k: usize| match (filled[k], inner(k) && from_free[k] <= overlap as f64 + 0.01) {
            (false, _) => Kind::Free,
            (true, true) => Kind::Overlap,
            (true, false) => Kind::Kept,
        };
        let kinds: Vec<Kind> = (0..side * side).map(kind).collect();
        let from_kept = cells(&|k| kinds[k] == Kind::Kept);
        let from_pasted = cells(&|k| kinds[k] != Kind::Kept);
        let from_overlap = cells(&|k| kinds[k] == Kind::Overlap);
        let fade = FADE * patch as f64;
        let bend = |k: usize| {
            let x = 1.0 - ((from_overlap[k] - 1.0) / fade).clamp(0.0, 1.0);
            if kinds[k] == Kind::Free { x * x * (3.0 - 2.0 * x) } else { 1.0 }
        };
        let share = |k: usize| match kinds[k] {
            Kind::Kept => 1.0,
            Kind::Free => 0.0,
            Kind::Overlap if from_kept[k].is_infinite() => 0.0,
            Kind::Overlap => {
                // The outermost cells are wholly the result's, so that there is no step to what is kept.
                let x = (from_free[k] - 1.0) / (from_free[k] + from_kept[k] - 2.0).max(1.0);
                let x = x.clamp(0.0, 1.0);
                x * x * (3.0 - 2.0 * x)
            }
        };
        let shares = (0..side * side).map(share).collect();
        let bends = (0..side * side).map(bend).collect();
        Self { cell, margin, side, kinds, shares, bends, from_kept, from_pasted, from_overlap }
    }

    /// The cell under a place; `None` beyond the border.
    fn under(&self, p: Vector<3>) -> Option<usize> {
        let at = [0, 1].map(|k| p[k] / self.cell + self.margin as f64);
        let is_in = at.iter().all(|v| (0.0..self.side as f64).contains(v));
        is_in.then(|| at[1] as usize * self.side + at[0] as usize)
    }

    /// Whether the patch is pasted here.
    pub(crate) fn is_pasted(&self, p: Vector<3>) -> bool {
        self.under(p).is_some_and(|k| self.kinds[k] != Kind::Kept)
    }

    /// Whether a loose piece with its middle here is the patch's.
    pub(crate) fn takes(&self, middle: Vector<3>) -> bool {
        self.is_pasted(middle) && self.share(middle) < 0.5
    }

    /// Whether a point of the result goes when the patch is pasted: loose pieces as a whole.
    pub(crate) fn replaces(&self, sample: &Sample) -> bool {
        if sample.piece == 0 { self.is_pasted(sample.at) } else { self.takes(sample.middle()) }
    }

    /// Whether the result is there and is replaced here.
    pub(crate) fn is_overlap(&self, p: Vector<3>) -> bool {
        self.under(p).is_some_and(|k| self.kinds[k] == Kind::Overlap)
    }

    /// Whether nothing is here yet.
    pub(crate) fn is_free(&self, p: Vector<3>) -> bool {
        self.under(p).is_some_and(|k| self.kinds[k] == Kind::Free)
    }

    /// Whether a seam runs within `reach` of here.
    pub(crate) fn is_at_seam(&self, p: Vector<3>, reach: f64) -> bool {
        let Some(k) = self.under(p) else { return false };
        let far = if self.kinds[k] == Kind::Kept { self.from_pasted[k] } else { self.from_kept[k] };
        (far - 0.5) * self.cell <= reach
    }

    /// Whether anything is compared.
    pub(crate) fn has_overlap(&self) -> bool {
        self.kinds.contains(&Kind::Overlap)
    }

    /// Whether anything is left to fill in the patch itself.
    pub(crate) fn has_room(&self) -> bool {
        let inner = self.margin..self.side - self.margin;
        (0..self.kinds.len()).any(|k| {
            self.kinds[k] == Kind::Free && inner.contains(&(k % self.side)) && inner.contains(&(k / self.side))
        })
    }

    /// The overlapped cells, as steps from the corner of the patch.
    pub(crate) fn overlapped(&self) -> Vec<[u32; 2]> {
        let cells = (0..self.kinds.len()).filter(|&k| self.kinds[k] == Kind::Overlap);
        cells.map(|k| [k % self.side, k / self.side].map(|i| (i - self.margin) as u32)).collect()
    }

    /// Whether a point of the texture that lies here can come to lie where the patch is pasted, if it moves by no more than `reach`.
    pub(crate) fn may_be_pasted(&self, p: Vector<3>, reach: f64) -> bool {
        let last = self.side as f64 - 0.5;
        let at = [0, 1].map(|k| p[k] / self.cell + self.margin as f64);
        let inside = at.map(|v| v.clamp(0.5, last));
        let k = inside[1] as usize * self.side + inside[0] as usize;
        let beyond = (at[0] - inside[0]).abs().max((at[1] - inside[1]).abs()) - 0.5;
        // Where nothing is bent nothing moves in.
        let reach = if self.bends[k] > 0.0 { reach / self.cell } else { 1.0 };
        beyond.max(self.from_pasted[k] - 1.0) <= reach
    }

    /// Whether an overlapped cell lies within `reach`.
    pub(crate) fn is_near_overlap(&self, p: Vector<3>, reach: f64) -> bool {
        let at = [0, 1].map(|k| p[k] / self.cell + self.margin as f64);
        let inside = at.map(|v| v.clamp(0.5, self.side as f64 - 0.5));
        let k = inside[1] as usize * self.side + inside[0] as usize;
        let beyond = (at[0] - inside[0]).abs().max((at[1] - inside[1]).abs());
        (self.from_overlap[k] - 1.0).max(beyond) * self.cell <= reach
    }

    /// The share of the result at a place, as smooth as the cells tell it.
    pub(crate) fn share(&self, p: Vector<3>) -> f64 {
        self.smoothed(&self.shares, p).0
    }

    /// The share of the result at the middle of each cell where it gives way to the patch along a cut, on which the two `differ` least: numbers for
    /// the cells of the overlap, as [`Mask::overlapped`] tells them.
    pub(crate) fn cut(&self, differ: &[f32]) -> Vec<f64> {
        let mut numbers = differ.iter();
        let decide = |kind: &Kind| match kind {
            Kind::Kept => (Some(true), 0.0),
            Kind::Free => (Some(false), 0.0),
            Kind::Overlap => (None, numbers.next().copied().unwrap_or(0.0)),
        };
        let (decided, difference): (Vec<_>, Vec<_>) = self.kinds.iter().map(decide).unzip();
        let is_result = sides(&decided, &difference, self.side);
        let from = |is_marked: &dyn Fn(usize) -> bool| {
            let is_marked: Vec<bool> = (0..self.kinds.len()).map(is_marked).collect();
            distances(&is_marked, (self.side, self.side), false)
        };
        let (to_patch, to_result) = (from(&|k| !is_result[k]), from(&|k| is_result[k]));
        let from_free = from(&|k| self.kinds[k] == Kind::Free);
        let share = |k: usize| {
            let (far, end) = if is_result[k] { (to_patch[k], self.from_kept[k]) } else { (to_result[k], from_free[k]) };
            // The outermost cells are wholly of their side, so that there is no step beyond them.
            let x = 0.5 * ((far - 0.5) / FRINGE.min(far + end - 1.5)).min(1.0);
            let x = if is_result[k] { 0.5 + x } else { 0.5 - x };
            x * x * (3.0 - 2.0 * x)
        };
        let of = |k: usize| match self.kinds[k] {
            Kind::Kept => 1.0,
            Kind::Overlap if self.from_kept[k].is_finite() => share(k),
            _ => 0.0,
        };
        (0..self.kinds.len()).map(of).collect()
    }

    /// The share of the result by `cells` at a place, as smooth as they tell it.
    pub(crate) fn share_by(&self, cells: &[f64], p: Vector<3>) -> f64 {
        self.smoothed(cells, p).0
    }

    /// How much of its bend a patch keeps at a place, and how that grows along x and y.
    pub(crate) fn bend(&self, p: Vector<3>) -> (f64, [f64; 2]) {
        self.smoothed(&self.bends, p)
    }

    /// What the cells say of a place, with the slope.
    fn smoothed(&self, cells: &[f64], p: Vector<3>) -> (f64, [f64; 2]) {
        let last = self.side - 1;
        let at = [0, 1].map(|k| (p[k] / self.cell + self.margin as f64 - 0.5).clamp(0.0, last as f64));
        let low = at.map(|v| (v as usize).min(last.saturating_sub(1)));
        let [u, v] = [at[0] - low[0] as f64, at[1] - low[1] as f64];
        let of = |dx: usize, dy: usize| cells[(low[1] + dy).min(last) * self.side + (low[0] + dx).min(last)];
        let [a, b, c, d] = [of(0, 0), of(1, 0), of(0, 1), of(1, 1)];
        let [below, above] = [a * (1.0 - u) + b * u, c * (1.0 - u) + d * u];
        let slope = [((b - a) * (1.0 - v) + (d - c) * v) / self.cell, (above - below) / self.cell];
        (below * (1.0 - v) + above * v, slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A patch of 8 cells with what lies left of 3 filled.
    fn left() -> Mask {
        Mask::new(1.0, (8, 3, 2), |x, _| x < 3.0)
    }

    fn at(x: f64) -> Vector<3> {
        Vector([x, 4.0, 0.0])
    }

    #[test]
    fn what_is_beside_the_patch_is_kept_and_what_is_in_it_replaced() {
        let mask = left();
        assert!(
            !mask.is_pasted(at(-0.5)) && mask.is_overlap(at(0.5)) && mask.is_free(at(5.0)) && mask.is_pasted(at(9.5))
        );
        assert!(!mask.is_pasted(at(11.0)), "beyond the border");
        assert_eq!(mask.overlapped().len(), 24);
        assert!(mask.has_room() && mask.has_overlap());
        let full = Mask::new(1.0, (8, 3, 2), |_, _| true);
        assert!(!full.has_room() && !full.has_overlap());
    }

    #[test]
    fn blending_is_continuous_at_both_ends() {
        let mask = left();
        assert_eq!((mask.share(at(-0.5)), mask.share(at(3.5))), (1.0, 0.0));
        let mut last = 1.0;
        for k in 0..=500 {
            let share = mask.share(at(-0.5 + f64::from(k) * 0.01));
            assert!(share <= last + 1e-12 && last - share < 0.02, "{k}: {last} {share}");
            last = share;
        }
    }

    #[test]
    fn a_patch_is_bent_beside_the_overlap_alone_and_nowhere_by_a_jump() {
        let mask = Mask::new(1.0, (20, 3, 5), |x, _| x < 3.0);
        let of = |x: f64| mask.bend(Vector([x, 10.0, 0.0]));
        assert_eq!((of(-0.5).0, of(1.0).0, of(10.5).0), (1.0, 1.0, 0.0));
        for k in 0..1000 {
            let x = 0.01 * f64::from(k);
            let drop = of(x).0 - of(x + 0.01).0;
            assert!((-1e-12..0.004).contains(&drop), "{x}: {drop}");
        }
    }

    #[test]
    fn a_cut_is_sharp_and_runs_where_colours_are_alike() {
        let mask = Mask::new(1.0, (12, 6, 2), |x, _| x < 6.0);
        let alike = 3;
        let differ: Vec<f32> = mask.overlapped().iter().map(|[x, _]| if *x == alike { 0.0 } else { 1.0 }).collect();
        let cells = mask.cut(&differ);
        let share = |x: f64| mask.share_by(&cells, Vector([x, 6.0, 0.0]));
        assert_eq!((share(-0.5), share(1.5), share(6.5)), (1.0, 1.0, 0.0));
        assert!((0.05..0.95).contains(&share(3.5)) && share(5.0) < 0.1, "{} {}", share(3.5), share(5.0));
    }

    #[test]
    fn only_points_that_can_be_moved_in_may_be_pasted() {
        let mask = Mask::new(1.0, (20, 3, 5), |x, _| x < 3.0);
        let may = |x: f64| mask.may_be_pasted(Vector([x, 10.0, 0.0]), 2.0);
        assert!(may(5.0) && may(0.5) && may(-1.0) && !may(-3.6), "the patch begins at 0");
        assert!(may(24.5) && may(25.5) && !may(27.5), "nothing moves at the far border");
        assert!(
            mask.is_near_overlap(Vector([4.0, 10.0, 0.0]), 2.0) && !mask.is_near_overlap(Vector([8.0, 10.0, 0.0]), 2.0)
        );
    }

    #[test]
    fn what_is_far_from_a_hole_is_kept() {
        let mask = Mask::new(1.0, (12, 2, 2), |x, y| !((5.0..7.0).contains(&x) && (5.0..7.0).contains(&y)));
        assert!(mask.is_pasted(Vector([6.0, 6.0, 0.0])) && mask.is_overlap(Vector([4.5, 6.0, 0.0])));
        assert!(!mask.is_pasted(Vector([1.5, 6.0, 0.0])));
        assert!(mask.is_at_seam(Vector([3.5, 6.0, 0.0]), 1.0) && !mask.is_at_seam(Vector([0.5, 6.0, 0.0]), 1.0));
    }
}
