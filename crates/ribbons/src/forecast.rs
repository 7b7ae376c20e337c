//! How much work all pieces will take, by what the first ones took.

/// Share of the pieces after which the work of all of them is foreseen, from what the second half of these took: the first ones pay for what
/// all of them use.
const TYPICAL: f64 = 0.1;
/// The same in pieces, at least and at most.
const TOLD: [usize; 2] = [4, 64];
/// Work of the pieces after which it is foreseen from fewer.
const SOON: u64 = 4_000_000_000;

/// Work of a piece as a rule, which is all that is known before the first ones.
pub(crate) const USUAL: f64 = 12e6;
/// How many times as much as was foretold, or as many times less, is told anew.
const OTHER: f64 = 3.0;

/// What is known of the pieces of a run.
#[derive(Debug)]
pub(crate) struct Pace {
    total: usize,
    /// Pieces after which the work is foreseen at the latest.
    told: usize,
    /// Work before the first piece.
    start: u64,
    /// A number of pieces, and the work up to there: those before are not counted.
    from: (usize, u64),
    is_told: bool,
}

impl Pace {
    /// That of `total` pieces, after so much work.
    pub(crate) fn new(total: usize, work: u64) -> Self {
        let told = ((TYPICAL * total as f64) as usize).clamp(TOLD[0], TOLD[1]);
        Self { total, told, start: work, from: (0, work), is_told: false }
    }

    /// With `done` pieces and so much work, the work of those that are left; once, when it can be told, where pieces are dearer or cheaper
    /// by far than was foretold.
    pub(crate) fn at(&mut self, done: usize, work: u64) -> Option<f64> {
        if done == 1 || done == self.told / 2 {
            self.from = (done, work);
        }
        let is_soon = done >= TOLD[0] && work.saturating_sub(self.start) > SOON;
        if self.is_told || done <= self.from.0 || (done < self.told && !is_soon) {
            return None;
        }
        self.is_told = true;
        let each = work.saturating_sub(self.from.1) as f64 / (done - self.from.0) as f64;
        let is_as_foretold = (USUAL / OTHER..=USUAL * OTHER).contains(&each);
        (!is_as_foretold).then(|| each * self.total.saturating_sub(done) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pieces after which the work is told, and what is told, where each takes `each` and the first one more.
    fn told(total: usize, each: u64) -> Option<(usize, f64)> {
        let mut pace = Pace::new(total, 100);
        (1..=total).find_map(|done| Some((done, pace.at(done, 100 + 7 * each + done as u64 * each)?)))
    }

    #[test]
    fn the_work_of_all_is_foreseen_from_a_few_and_soon_where_pieces_are_dear() {
        assert_eq!(told(200, 1000), Some((20, 180.0 * 1000.0)));
        assert_eq!(told(2, 1000), None);
        assert_eq!(told(10_000, 1_000_000_000), Some((4, 9996.0 * 1e9)));
    }

    #[test]
    fn what_was_foretold_is_not_told_again() {
        assert_eq!(told(200, USUAL as u64), None);
        assert_eq!(told(200, 2 * USUAL as u64), None);
        assert!(told(200, 5 * USUAL as u64).is_some() && told(200, USUAL as u64 / 5).is_some());
    }

    #[test]
    fn it_is_told_once() {
        let mut pace = Pace::new(100, 0);
        assert_eq!((1..=100).filter(|&done| pace.at(done, done as u64).is_some()).count(), 1);
    }
}
