//! What is drawn at a node of squared paper: steps to the nodes around it, and a thing that lies on it.

use crate::repeat::lattice::Node;

/// The eight ways from a node to the nodes around it; the opposite of way `k` is `k + 4` modulo 8.
pub(crate) const WAYS: [Node; 8] = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1]];

/// For the slanted ways, in their order, where the step that crosses it begins: the way to that node, and the way from there.
pub(crate) const CROSSED: [(usize, usize); 4] = [(0, 3), (4, 1), (4, 7), (0, 5)];

/// The opposite way.
pub(crate) fn opposite(way: usize) -> usize {
    (way + 4) % 8
}

/// The node one step on.
pub(crate) fn beside(node: Node, way: usize) -> Node {
    [node[0] + WAYS[way][0], node[1] + WAYS[way][1]]
}

/// The steps and the thing at a node, as far as they are decided. Numbers count from 1, 0 is nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Star {
    /// Curve of the exemplar as which each step is drawn; `None` while that is open.
    pub(crate) steps: [Option<u32>; 8],
    /// Element of the exemplar that lies on the node; `None` while that is open.
    pub(crate) thing: Option<u32>,
}

/// A star as it looks: a byte for each step, the style of its curve, and the class of the thing; and which of them are decided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Look {
    pub(crate) steps: u64,
    pub(crate) thing: u32,
    /// All bits of the bytes that are decided.
    known: u64,
    is_thing_known: bool,
}

/// What a thing counts in terms of steps.
const THING: u32 = 2;

impl Look {
    /// Of a star, given the style of each curve and the class of each element.
    pub(crate) fn of(star: &Star, styles: &[u8], classes: &[u32]) -> Self {
        let mut look = Self::default();
        for (way, step) in star.steps.iter().enumerate() {
            let Some(curve) = *step else { continue };
            let style = if curve == 0 { 0 } else { styles[curve as usize - 1] };
            look.steps |= u64::from(style) << (8 * way);
            look.known |= 0xFF << (8 * way);
        }
        if let Some(element) = star.thing {
            look.thing = if element == 0 { 0 } else { classes[element as usize - 1] };
            look.is_thing_known = true;
        }
        look
    }

    /// In how many steps and things another star, which is decided, differs from what is decided of this one.
    pub(crate) fn differs(&self, other: &Self) -> u32 {
        let different = (self.steps ^ other.steps) & self.known;
        let bytes = (0..8).filter(|way| (different >> (8 * way)) & 0xFF != 0).count() as u32;
        bytes + if self.is_thing_known && self.thing != other.thing { THING } else { 0 }
    }

    /// In how many steps another star differs from what is decided of the steps of this one.
    pub(crate) fn steps_differ(&self, other: &Self) -> bool {
        (self.steps ^ other.steps) & self.known != 0
    }

    /// Whether nothing is decided.
    pub(crate) fn is_open(&self) -> bool {
        self.known == 0 && !self.is_thing_known
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_decided_is_compared() {
        let (styles, classes) = ([1_u8, 1, 2], [7_u32]);
        let mut open = Star::default();
        open.steps[0] = Some(1);
        let mut whole = Star { steps: [Some(0); 8], thing: Some(1) };
        whole.steps[0] = Some(2);
        let look = |star: &Star| Look::of(star, &styles, &classes);
        assert_eq!(look(&open).differs(&look(&whole)), 0, "another curve of the same style");
        whole.steps[0] = Some(3);
        assert_eq!(look(&open).differs(&look(&whole)), 1);
        open.thing = Some(0);
        assert_eq!(look(&open).differs(&look(&whole)), 1 + THING);
        assert!(look(&Star::default()).is_open());
        assert_eq!(beside([3, 3], opposite(1)), [2, 2]);
    }
}
