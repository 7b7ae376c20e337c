//! A tree of boxes over items that have a box each.

use arabesque_core::{Bounds, Budget, Meter, Result, Vector};

/// Most items of a leaf.
const LEAF: usize = 4;
/// Work for each item of a node that is halved.
const ITEM: u64 = 12;

/// A balanced binary tree of axis-aligned boxes: the items are halved at the median of their centres along the longest side.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(crate) nodes: Vec<Node>,
    /// Numbers of items; each leaf has a run of them.
    pub(crate) order: Vec<u32>,
}

/// A box with the items below it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) bounds: Bounds<3>,
    /// First item of a leaf in the order.
    pub(crate) start: u32,
    /// Items of a leaf; 0 for a node with children. The first child is the next node.
    pub(crate) count: u32,
    /// The second child.
    pub(crate) second: u32,
}

impl Tree {
    /// A tree over the items with these boxes, at least one.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(boxes: &[Bounds<3>], budget: &Budget) -> Result<Self> {
        let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
        let mut nodes = Vec::with_capacity(boxes.len());
        Self::build(&mut nodes, boxes, (&mut order, 0), &mut budget.meter())?;
        Ok(Self { nodes, order })
    }

    /// Appends the subtree of the items in `order`, which starts at `start` of the whole order. Halving keeps the depth logarithmic.
    fn build(
        nodes: &mut Vec<Node>,
        boxes: &[Bounds<3>],
        (order, start): (&mut [u32], usize),
        meter: &mut Meter<'_>,
    ) -> Result<()> {
        meter.spend(order.len() as u64 * ITEM)?;
        let bounds = order.iter().fold(Bounds::EMPTY, |all, &i| all.union(&boxes[i as usize]));
        let at = nodes.len();
        nodes.push(Node { bounds, start: start as u32, count: order.len() as u32, second: 0 });
        if order.len() <= LEAF {
            return Ok(());
        }
        let centres = Bounds::around(order.iter().map(|&i| boxes[i as usize].centre()));
        let size = centres.size();
        let axis = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
        let half = order.len() / 2;
        let key = |i: u32| boxes[i as usize].centre()[axis];
        // Equal centres are told apart by number, so that the tree depends on the boxes alone.
        order.select_nth_unstable_by(half, |&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
        let (low, high) = order.split_at_mut(half);
        Self::build(nodes, boxes, (low, start), meter)?;
        nodes[at].count = 0;
        nodes[at].second = nodes.len() as u32;
        Self::build(nodes, boxes, (high, start + half), meter)
    }

    /// The items of a leaf.
    pub(crate) fn items(&self, node: &Node) -> &[u32] {
        &self.order[node.start as usize..(node.start + node.count) as usize]
    }

    /// Looks for the nearest item to `p`, no farther than the root of `limit`: `distance2` gives the squared distance of an item, or nothing for what does not count.
    /// The answer is the number of the item with its squared distance, and what was looked at on the way.
    pub(crate) fn nearest(
        &self,
        p: Vector<3>,
        limit: f64,
        mut distance2: impl FnMut(u32) -> Option<f64>,
    ) -> (Option<(u32, f64)>, u64) {
        let (mut best, mut found, mut looked) = (limit, None, 0);
        let mut stack = vec![(gap2(&self.nodes[0].bounds, p), 0_u32)];
        while let Some((gap, at)) = stack.pop() {
            if gap > best {
                continue;
            }
            let node = &self.nodes[at as usize];
            looked += 1 + u64::from(node.count);
            if node.count > 0 {
                for &item in self.items(node) {
                    let Some(d2) = distance2(item) else { continue };
                    let nearer = d2 < best || d2 == best && found.is_none_or(|(other, _)| item < other);
                    if nearer {
                        best = d2;
                        found = Some((item, d2));
                    }
                }
                continue;
            }
            let near = [at + 1, node.second].map(|child| (gap2(&self.nodes[child as usize].bounds, p), child));
            let [first, second] = if near[0].0 <= near[1].0 { near } else { [near[1], near[0]] };
            stack.extend([second, first]);
        }
        (found, looked)
    }

    /// The `count` nearest items to `p`, nearest first; fewer where there are fewer. `distance2` gives the squared distance of an item, or nothing for what
    /// does not count. They replace what is in `found`; the answer is what was looked at.
    pub(crate) fn nearest_many(
        &self,
        p: Vector<3>,
        count: usize,
        found: &mut Vec<(f64, u32)>,
        mut distance2: impl FnMut(u32) -> Option<f64>,
    ) -> u64 {
        let (mut looked, mut stack) = (0, vec![(gap2(&self.nodes[0].bounds, p), 0_u32)]);
        found.clear();
        while let Some((gap, at)) = stack.pop() {
            if found.len() == count && found.last().is_none_or(|last| gap > last.0) {
                continue;
            }
            let node = &self.nodes[at as usize];
            looked += 1 + u64::from(node.count);
            if node.count == 0 {
                let near = [at + 1, node.second].map(|child| (gap2(&self.nodes[child as usize].bounds, p), child));
                let [first, second] = if near[0].0 <= near[1].0 { near } else { [near[1], near[0]] };
                stack.extend([second, first]);
                continue;
            }
            for &item in self.items(node) {
                let Some(d2) = distance2(item) else { continue };
                if found.len() == count && found.last().is_some_and(|last| (d2, item) >= *last) {
                    continue;
                }
                let place = found.partition_point(|other| *other < (d2, item));
                found.insert(place, (d2, item));
                found.truncate(count);
            }
        }
        looked
    }

    /// Calls `visit` for every item whose node's box meets `bounds`: at least those whose own boxes do. It may end the walk by answering false.
    /// Returns what was looked at.
    pub(crate) fn meeting(&self, bounds: &Bounds<3>, mut visit: impl FnMut(u32) -> bool) -> u64 {
        let (mut stack, mut looked) = (vec![0_u32], 0);
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at as usize];
            looked += 1 + u64::from(node.count);
            if !node.bounds.intersects(bounds) {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.second, at + 1]);
            } else if !self.items(node).iter().all(|&item| visit(item)) {
                return looked;
            }
        }
        looked
    }
}

/// Squared distance from `p` to a box, 0 inside.
fn gap2(bounds: &Bounds<3>, p: Vector<3>) -> f64 {
    (p - bounds.clamp(p)).norm2()
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Stage, Stream};

    use super::*;

    #[test]
    fn the_nearest_item_is_that_of_an_exhaustive_search() {
        let mut random = Stream::new(1, Stage::TEST, 0);
        let mut point = || Vector(std::array::from_fn(|_| random.range(0.0, 1.0)));
        let points: Vec<_> = (0..300).map(|_| point()).collect();
        let boxes: Vec<_> = points.iter().map(|&p| Bounds::new(p, p)).collect();
        let tree = Tree::new(&boxes, &Budget::default()).unwrap();
        for _ in 0..100 {
            let p = point();
            let d2 = |i: u32| (points[i as usize] - p).norm2();
            let nearest = (0..300).min_by(|&a, &b| d2(a).total_cmp(&d2(b))).unwrap();
            assert_eq!(tree.nearest(p, f64::INFINITY, |i| Some(d2(i))).0, Some((nearest, d2(nearest))));
            assert_eq!(tree.nearest(p, d2(nearest) * 0.9, |i| Some(d2(i))).0, None);
            let mut many = Vec::new();
            tree.nearest_many(p, 7, &mut many, |i| (i % 2 == 0).then(|| d2(i)));
            let mut all: Vec<_> = (0..300).step_by(2).map(|i| (d2(i), i)).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            assert_eq!(many, all[..7]);
            let ball = Bounds::new(p, p).grown(0.2);
            let mut met = Vec::new();
            tree.meeting(&ball, |i| {
                met.push(i);
                true
            });
            assert!((0..300).all(|i| !ball.contains(points[i as usize]) || met.contains(&i)));
        }
    }

    #[test]
    fn items_in_one_place_make_a_tree_of_small_depth() {
        let tree = Tree::new(&vec![Bounds::new(Vector::ZERO, Vector::ZERO); 1000], &Budget::default()).unwrap();
        assert!(tree.nodes.len() < 1000);
        assert_eq!(tree.nearest(Vector([1.0, 0.0, 0.0]), f64::INFINITY, |_| Some(1.0)).0, Some((0, 1.0)));
    }
}
