//! Sets that grow together.

/// Disjoint sets of the numbers from 0, each named by its smallest member.
#[derive(Clone, Debug)]
pub struct DisjointSets(Vec<usize>);

impl DisjointSets {
    /// `count` sets of one member each.
    pub fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    /// The smallest member of the set of `i`.
    pub fn of(&mut self, i: usize) -> usize {
        let mut root = i;
        while self.0[root] != root {
            root = self.0[root];
        }
        let mut at = i;
        while self.0[at] != root {
            at = std::mem::replace(&mut self.0[at], root);
        }
        root
    }

    /// Makes the sets of `i` and `j` one.
    pub fn join(&mut self, i: usize, j: usize) {
        let (i, j) = (self.of(i), self.of(j));
        self.0[i.max(j)] = i.min(j);
    }

    /// The members of each set, both in rising order.
    pub fn groups(mut self) -> Vec<Vec<usize>> {
        let mut groups = vec![Vec::new(); self.0.len()];
        for i in 0..self.0.len() {
            let root = self.of(i);
            groups[root].push(i);
        }
        groups.retain(|g| !g.is_empty());
        groups
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_order_of_joining_does_not_matter(mut joints in prop::collection::vec((0..12_usize, 0..12_usize), 0..20)) {
            let groups = |joints: &[(usize, usize)]| {
                let mut sets = DisjointSets::new(12);
                joints.iter().for_each(|&(i, j)| sets.join(i, j));
                sets.groups()
            };
            let forwards = groups(&joints);
            prop_assert!(joints.iter().all(|(i, j)| forwards.iter().any(|g| g.contains(i) && g.contains(j))));
            prop_assert_eq!(forwards.iter().map(Vec::len).sum::<usize>(), 12);
            joints.reverse();
            prop_assert_eq!(groups(&joints), forwards);
        }
    }

    #[test]
    fn a_set_is_named_by_its_smallest_member() {
        let mut sets = DisjointSets::new(6);
        sets.join(5, 3);
        sets.join(4, 5);
        assert_eq!((sets.of(4), sets.of(5), sets.of(0)), (3, 3, 0));
        assert_eq!(sets.groups(), [vec![0], vec![1], vec![2], vec![3, 4, 5]]);
    }
}
