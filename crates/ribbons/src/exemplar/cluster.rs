//! Columns in boxes of similar ones, so that a whole box can be ruled out at once.

use arabesque_core::{Budget, Meter, Result};

use crate::exemplar::columns::{BLOCKS, CHANNELS, SUMMARY, Summary};

/// Work of taking one column into account for one box.
const MEMBER: u64 = 30;

/// A box of columns in the space of summaries.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    low: [f32; SUMMARY],
    high: [f32; SUMMARY],
    /// Smallest cost of the paths that end in it.
    pub(crate) cost: f64,
    /// Its columns: a range of [`Tree::order`].
    pub(crate) members: std::ops::Range<usize>,
    /// The two boxes inside it.
    pub(crate) halves: Option<[usize; 2]>,
}

impl Node {
    /// A lower bound on the cost between any column of the one and any of the other.
    pub(crate) fn gap(&self, other: &Self) -> f32 {
        let mut sum = 0.0;
        for block in 0..BLOCKS {
            let gap: [f32; CHANNELS] = std::array::from_fn(|k| {
                let k = CHANNELS * block + k;
                (self.low[k] - other.high[k]).max(other.low[k] - self.high[k]).max(0.0)
            });
            sum += (gap[0] * gap[0] + gap[1] * gap[1] + gap[2] * gap[2]).sqrt() + gap[3] + gap[4] + gap[5];
        }
        sum
    }
}

/// A hierarchy of boxes.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    /// Columns, box by box.
    pub(crate) order: Vec<u32>,
    /// The boxes; the first holds all.
    pub(crate) nodes: Vec<Node>,
}

impl Tree {
    /// Halves the columns along their widest number, or by the costs of the paths to them, until a box holds at most `most`.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Limit`] when the work is used up, [`arabesque_core::Error::Stopped`].
    pub(crate) fn new(summaries: &[Summary], costs: Option<&[f64]>, most: usize, budget: &Budget) -> Result<Self> {
        let order = (0..summaries.len() as u32).collect();
        let mut tree = Self { order, nodes: Vec::new() };
        if !summaries.is_empty() {
            tree.split((summaries, costs), 0..summaries.len(), most, &mut budget.meter())?;
        }
        Ok(tree)
    }

    /// The boxes that are not split.
    pub(crate) fn leaves(&self) -> impl Iterator<Item = &Node> {
        self.nodes.iter().filter(|n| n.halves.is_none())
    }

    fn split(
        &mut self,
        (summaries, costs): (&[Summary], Option<&[f64]>),
        range: std::ops::Range<usize>,
        most: usize,
        meter: &mut Meter<'_>,
    ) -> Result<usize> {
        meter.spend(MEMBER * range.len() as u64)?;
        let members = &mut self.order[range.clone()];
        let (mut low, mut high) = ([f32::INFINITY; SUMMARY], [f32::NEG_INFINITY; SUMMARY]);
        let (mut cost, mut most_cost) = (f64::INFINITY, f64::NEG_INFINITY);
        for &m in members.iter() {
            let summary = &summaries[m as usize].sums;
            for k in 0..SUMMARY {
                low[k] = low[k].min(summary[k]);
                high[k] = high[k].max(summary[k]);
            }
            let own = costs.map_or(0.0, |c| c[m as usize]);
            (cost, most_cost) = (cost.min(own), most_cost.max(own));
        }
        let widest = (0..SUMMARY).fold(0, |w, k| if high[k] - low[k] > high[w] - low[w] { k } else { w });
        let place = self.nodes.len();
        self.nodes.push(Node { low, high, cost, members: range.clone(), halves: None });
        if range.len() > most {
            let half = (range.len() / 2).next_multiple_of(most);
            // What a path costs so far counts like one more number.
            let by_cost = most_cost - cost > f64::from(high[widest] - low[widest]);
            let key = |m: &u32| match costs {
                Some(costs) if by_cost => costs[*m as usize] as f32,
                _ => summaries[*m as usize].sums[widest],
            };
            members.select_nth_unstable_by(half - 1, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
            let first = self.split((summaries, costs), range.start..range.start + half, most, meter)?;
            let second = self.split((summaries, costs), range.start + half..range.end, most, meter)?;
            self.nodes[place].halves = Some([first, second]);
        }
        Ok(place)
    }
}
