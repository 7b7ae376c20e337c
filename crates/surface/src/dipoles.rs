//! How often a surface winds around a place: about 1 inside of a closed surface, about 0 outside, and little else where there are small holes.
//!
//! The generalised winding number [Jacobson 2013] is the solid angle of all pieces of the surface over that of the sphere. Pieces that are far
//! away count together as one dipole [Barill 2018].

use std::f64::consts::PI;

use arabesque_core::Vector;

use crate::tree::{Node, Tree};

/// A node's dipole stands for it beyond so many of its radii.
const FAR: f64 = 3.0;

/// The dipoles of a tree, one for each node.
#[derive(Clone, Debug)]
pub(crate) struct Dipoles(Vec<Dipole>);

#[derive(Clone, Copy, Debug)]
struct Dipole {
    centre: Vector<3>,
    /// Sum of the normals, each as long as its piece is large.
    area: Vector<3>,
    /// Squared distance beyond which the dipole will do.
    far2: f64,
}

impl Dipoles {
    /// The dipoles of `tree`; `piece` gives the middle of an item, and its normal, as long as the item is large.
    pub(crate) fn new(tree: &Tree, piece: impl Fn(u32) -> (Vector<3>, Vector<3>)) -> Self {
        // Children come after their parents: sums of area, of area times place and of normals go upwards.
        let mut sums = vec![(0.0, Vector::ZERO, Vector::ZERO); tree.nodes.len()];
        for at in (0..tree.nodes.len()).rev() {
            let node = &tree.nodes[at];
            sums[at] = if node.count > 0 {
                tree.items(node).iter().fold((0.0, Vector::ZERO, Vector::ZERO), |sum, &item| {
                    let (centre, normal) = piece(item);
                    (sum.0 + normal.norm(), sum.1 + centre * normal.norm(), sum.2 + normal)
                })
            } else {
                let (a, b): (&(f64, Vector<3>, Vector<3>), _) = (&sums[at + 1], &sums[node.second as usize]);
                (a.0 + b.0, a.1 + b.1, a.2 + b.2)
            };
        }
        let dipole = |(node, (weight, place, area)): (&Node, (f64, Vector<3>, Vector<3>))| {
            let centre = if weight > 0.0 { place * (1.0 / weight) } else { node.bounds.centre() };
            let corner = (node.bounds.max - centre).zip(centre - node.bounds.min, f64::max);
            Dipole { centre, area, far2: FAR * FAR * corner.norm2() }
        };
        Self(tree.nodes.iter().zip(sums).map(dipole).collect())
    }

    /// The winding number at `p`, and what was looked at. `angle` is the solid angle of an item, for those that are near.
    pub(crate) fn winding(&self, tree: &Tree, p: Vector<3>, angle: impl Fn(u32) -> f64) -> (f64, u64) {
        let (mut sum, mut looked, mut stack) = (0.0, 0, vec![0_u32]);
        while let Some(at) = stack.pop() {
            let (node, dipole) = (&tree.nodes[at as usize], &self.0[at as usize]);
            looked += 1 + u64::from(node.count);
            let offset = dipole.centre - p;
            let d2 = offset.norm2();
            if d2 > dipole.far2 {
                sum += dipole.area.dot(offset) / (d2 * d2.sqrt());
            } else if node.count > 0 {
                sum += tree.items(node).iter().map(|&item| angle(item)).sum::<f64>();
            } else {
                stack.extend([node.second, at + 1]);
            }
        }
        (sum / (4.0 * PI), looked)
    }
}
