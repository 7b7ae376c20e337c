//! What is counted of patches.

/// What was counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Notes {
    /// Patches.
    pub(crate) patches: usize,
    /// Splines that would have folded, and were made again with fewer pairs.
    pub(crate) folds: usize,
    /// Candidates that were passed over for the next.
    pub(crate) passed: usize,
    /// Patches that were laid without being bent.
    pub(crate) unbent: usize,
    /// Points that were blended along a ray, by projection, and not at all.
    pub(crate) by_ray: usize,
    pub(crate) by_projection: usize,
    pub(crate) unmatched: usize,
    /// Points of the result in overlaps that nothing goes on from.
    pub(crate) cracks: usize,
    /// Points in overlaps.
    pub(crate) overlapped: usize,
}

impl Notes {
    pub(crate) fn add(&mut self, other: Self) {
        self.patches += other.patches;
        self.folds += other.folds;
        self.passed += other.passed;
        self.unbent += other.unbent;
        self.by_ray += other.by_ray;
        self.by_projection += other.by_projection;
        self.unmatched += other.unmatched;
        self.cracks += other.cracks;
        self.overlapped += other.overlapped;
    }

    /// Share of the overlap that does not go on.
    pub(super) fn torn(&self) -> f64 {
        (self.cracks + self.unmatched) as f64 / self.overlapped.max(1) as f64
    }
}
