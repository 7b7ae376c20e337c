//! A tree of boxes over edges: the nearest one in a few steps, however long, thin or far away the shape.

use crate::{
    region::segment::{self, Segment},
    space::{Bounds, Vector},
};

/// Edges in a leaf, at most.
const LEAF: usize = 4;

/// A complete binary tree; the children of node `n` are `2 n + 1` and `2 n + 2`.
#[derive(Clone, Debug)]
pub(super) struct EdgeTree {
    /// Box around the edges of each node.
    boxes: Vec<Bounds<2>>,
    /// Edges in the order of the leaves, each with its number.
    edges: Vec<(Segment<2>, u32)>,
    /// Levels below the root.
    depth: u32,
}

impl EdgeTree {
    /// Sorts the edges into the tree, half of them on either side at each node. Takes n log n steps.
    pub(super) fn new(edges: &[Segment<2>]) -> Self {
        let leaves = edges.len().div_ceil(LEAF).next_power_of_two();
        let empty = Bounds::around([]);
        let mut tree = Self {
            boxes: vec![empty; 2 * leaves - 1],
            edges: edges.iter().zip(0..).map(|(&edge, k)| (edge, k)).collect(),
            depth: leaves.trailing_zeros(),
        };
        for n in 0..tree.boxes.len() {
            let (first, end) = tree.range(n);
            let part = &mut tree.edges[first..end];
            let around = Bounds::around(part.iter().flat_map(|&((a, b), _)| [a, b]));
            tree.boxes[n] = around;
            if 2 * n + 1 < tree.boxes.len() && part.len() > 1 {
                let size = around.size();
                let axis = usize::from(size[1] > size[0]);
                let middle = tree.range(2 * n + 1).1 - first;
                let part = &mut tree.edges[first..end];
                let key = |&((a, b), k): &(Segment<2>, u32)| (a[axis] + b[axis], k);
                if middle < part.len() {
                    part.select_nth_unstable_by(middle, |p, q| {
                        let (p, q) = (key(p), key(q));
                        p.0.total_cmp(&q.0).then(p.1.cmp(&q.1))
                    });
                }
            }
        }
        tree
    }

    /// The edges below node `n`: where they begin and end.
    fn range(&self, n: usize) -> (usize, usize) {
        let level = (n + 1).ilog2();
        let across = n + 1 - (1 << level);
        let at = |k: usize| (k * self.edges.len()) >> level;
        (at(across), at(across + 1))
    }

    /// The place on an edge that is nearest to `p` and nearer than the root of `best2`, with the square of its distance. Of edges that
    /// are equally near, the one with the lowest number counts. The work grows with the logarithm of the number of edges.
    pub(super) fn nearest(&self, p: Vector<2>, best2: f64) -> Option<(Vector<2>, f64)> {
        let mut best: (Option<Vector<2>>, f64, u32) = (None, best2, u32::MAX);
        // Nodes still to be seen, with the squares of their distances; at most one for each level and its sibling.
        let mut waiting = [(0_usize, 0.0_f64); 64];
        let mut count = 1;
        waiting[0] = (0, self.distance2(0, p));
        while count > 0 {
            count -= 1;
            let (n, distance2) = waiting[count];
            if distance2 > best.1 {
                continue;
            }
            if (n + 1).ilog2() == self.depth {
                self.look(n, p, &mut best);
                continue;
            }
            let (near, far) = ([2 * n + 1, 2 * n + 2].map(|m| (m, self.distance2(m, p)))).into();
            let (near, far): ((usize, f64), (usize, f64)) = if far.1 < near.1 { (far, near) } else { (near, far) };
            for child in [far, near] {
                if child.1 <= best.1 {
                    waiting[count] = child;
                    count += 1;
                }
            }
        }
        best.0.map(|place| (place, best.1))
    }

    fn look(&self, n: usize, p: Vector<2>, best: &mut (Option<Vector<2>>, f64, u32)) {
        let (first, end) = self.range(n);
        for &(edge, k) in &self.edges[first..end] {
            let q = segment::nearest(edge, p);
            let d2 = (q - p).norm2();
            if d2 < best.1 || (d2 == best.1 && best.0.is_some() && k < best.2) {
                *best = (Some(q), d2, k);
            }
        }
    }

    /// Square of the distance from the box of a node; infinite for one without edges.
    fn distance2(&self, n: usize, p: Vector<2>) -> f64 {
        let around = &self.boxes[n];
        if around.is_empty() { f64::INFINITY } else { (around.clamp(p) - p).norm2() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Stage, Stream};

    #[test]
    fn the_nearest_edge_is_the_one_that_looking_at_all_of_them_finds() {
        let mut s = Stream::new(5, Stage::TEST, 0);
        for count in [1, 2, 3, 5, 17, 64, 333] {
            let reach = if count % 2 == 0 { 1.0 } else { 300.0 };
            let edges: Vec<Segment<2>> = (0..count)
                .map(|_| {
                    let a = Vector::xy(s.range(-50.0, 50.0), s.range(-1.0, 1.0));
                    (a, a + Vector::xy(s.range(-reach, reach), s.range(-1.0, 1.0)))
                })
                .collect();
            let tree = EdgeTree::new(&edges);
            for _ in 0..200 {
                let p = Vector::xy(s.range(-200.0, 200.0), s.range(-30.0, 30.0));
                let want = edges.iter().map(|&e| (segment::nearest(e, p) - p).norm2()).fold(f64::INFINITY, f64::min);
                let got = tree.nearest(p, f64::INFINITY).unwrap();
                assert_eq!(got.1, want);
                assert_eq!((got.0 - p).norm2(), want);
                assert!(tree.nearest(p, want).is_none() && tree.nearest(p, want * 1.001).is_some_and(|g| g.1 == want));
            }
        }
    }
}
