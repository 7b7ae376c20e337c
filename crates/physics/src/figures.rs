//! How deep things are in one another, and what floats.

use rapier3d::{
    math::Vector as Vec3,
    prelude::{ColliderSet, ContactPair, NarrowPhase},
};

/// Gap, in sizes of an element, below which two things touch.
const TOUCHING: f32 = 0.02;
/// Least share of a contact's normal along gravity with which one thing lies on the other: about 80 degrees.
const CARRYING: f32 = 0.17;

/// Contacts between elements, and between them and what is around them, as their colliders touch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures {
    /// Pairs that are in one another by more than a hundredth of an element's size.
    pub overlaps: usize,
    /// Deepest penetration, in units of the scene.
    pub deepest: f64,
    /// Sum of the penetrations of all pairs, in units of the scene.
    pub total: f64,
    /// Elements that no chain of contacts, each on the one below it, leads down from to what is fixed; none without gravity.
    pub floating: usize,
}

/// What is told of a body: where it falls to, and whether it is held by something that is no collider.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hold {
    /// The direction of gravity, of length 1; zero without.
    pub(crate) down: Vec3,
    pub(crate) is_held: bool,
}

impl Figures {
    /// Figures of what the solver last saw, in which `length` is one unit. Colliders carry the number of their body, counted from 1, and 0
    /// where nothing moves them.
    pub(crate) fn of(narrow: &NarrowPhase, colliders: &ColliderSet, length: f64, holds: &[Hold]) -> Self {
        let mut figures = Self::default();
        let number = |handle| colliders.get(handle).map_or(0, |c| c.user_data as usize);
        // By the number of a body: the bodies that lie on it; first those on what is fixed.
        let mut above: Vec<Vec<usize>> = vec![Vec::new(); holds.len() + 1];
        for pair in narrow.contact_pairs() {
            let depth = -pair.find_deepest_contact().map_or(0.0, |(_, contact)| f64::from(contact.dist));
            if depth > 0.0 {
                figures.overlaps += usize::from(depth > 0.01);
                figures.deepest = figures.deepest.max(depth * length);
                figures.total += depth * length;
            }
            let (a, b) = (number(pair.collider1), number(pair.collider2));
            for (upper, lower, sign) in [(b, a, -1.0), (a, b, 1.0)] {
                if upper > 0 && lies_on(pair, holds[upper - 1].down * sign) {
                    above[lower].push(upper);
                }
            }
        }
        let held = holds.iter().enumerate().filter(|(_, h)| h.is_held || h.down == Vec3::ZERO).map(|(k, _)| k + 1);
        above[0].extend(held);
        figures.floating = holds.len() - reached(&above);
        figures
    }
}

/// Whether the normal of a contact, from the first collider to the second, goes along `down` somewhere.
fn lies_on(pair: &ContactPair, down: Vec3) -> bool {
    let carries = |m: &rapier3d::prelude::ContactManifold| m.points.iter().any(|p| p.dist < TOUCHING);
    pair.manifolds().iter().any(|m| m.data.normal.dot(down) > CARRYING && carries(m))
}

/// How many bodies lie, over others or not, on what is fixed.
fn reached(above: &[Vec<usize>]) -> usize {
    let mut is_reached = vec![false; above.len()];
    let mut open = vec![0];
    let mut count = 0;
    while let Some(next) = open.pop() {
        for &upper in &above[next] {
            if !std::mem::replace(&mut is_reached[upper], true) {
                count += 1;
                open.push(upper);
            }
        }
    }
    count
}
