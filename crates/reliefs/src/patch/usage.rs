//! What of the texture was used, so that all of it is used alike and nothing is seen twice nearby.

/// How much more it counts that a part was used nearby than that it was used somewhere.
const NEARBY: f64 = 2.0;

/// How often each part of the texture was laid.
#[derive(Clone, Debug, Default)]
pub(crate) struct Usage {
    /// Side of a part, in cells of the field.
    part: usize,
    /// Parts along the side of a patch.
    parts: usize,
    width: usize,
    counts: Vec<f64>,
    laid: usize,
}

impl Usage {
    /// Nothing of a field of so many cells is used, of which patches are squares.
    pub(crate) fn new((width, height): (usize, usize), patch: usize) -> Self {
        let part = (patch / 5).max(1);
        let parts = patch.div_ceil(part);
        let [width, height] = [width, height].map(|n| n / part + parts + 1);
        Self { part, parts, width, counts: vec![0.0; width * height], laid: 0 }
    }

    /// The parts that a patch covers.
    fn covered(&self, [x, y]: [u32; 2]) -> impl Iterator<Item = usize> + '_ {
        let [x, y] = [x, y].map(|v| v as usize / self.part.max(1));
        (0..self.parts * self.parts).map(move |k| (y + k / self.parts) * self.width + x + k % self.parts)
    }

    /// A patch is laid from here.
    pub(crate) fn add(&mut self, place: [u32; 2]) {
        let covered: Vec<usize> = self.covered(place).collect();
        for k in covered {
            if let Some(count) = self.counts.get_mut(k) {
                *count += 1.0;
            }
        }
        self.laid += 1;
    }

    /// How much was used of what a patch would show: the share of all patches that show a part of it, and how much of it the patches show
    /// that lie `nearby`.
    pub(crate) fn of(&self, place: [u32; 2], nearby: &[[u32; 2]]) -> f64 {
        let own: f64 = self.covered(place).filter_map(|k| self.counts.get(k)).sum();
        let own = own / (self.parts * self.parts * self.laid).max(1) as f64;
        let side = (self.parts * self.part) as f64;
        let shared = |other: &[u32; 2]| {
            let along = |k: usize| (1.0 - f64::from(place[k].abs_diff(other[k])) / side).max(0.0);
            (along(0) * along(1)).powi(2)
        };
        own + NEARBY * nearby.iter().map(shared).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_used_counts_and_more_so_nearby() {
        let mut usage = Usage::new((100, 80), 20);
        (0..3).for_each(|_| usage.add([10, 10]));
        usage.add([70, 50]);
        assert!(usage.of([10, 10], &[]) > usage.of([70, 50], &[]));
        assert!(usage.of([70, 50], &[]) > usage.of([40, 40], &[]) && usage.of([40, 40], &[]) == 0.0);
        assert!(usage.of([70, 50], &[[72, 50]]) > usage.of([10, 10], &[[72, 50]]));
    }
}
