//! How deep things are in one another.

use rapier3d::prelude::{ColliderSet, NarrowPhase};

/// Contacts between elements, and between them and what is around them, as their colliders touch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures {
    /// Pairs that are in one another by more than a hundredth of an element's size.
    pub overlaps: usize,
    /// Deepest penetration, in units of the scene.
    pub deepest: f64,
    /// Sum of the penetrations of all pairs, in units of the scene.
    pub total: f64,
}

impl Figures {
    /// Figures of what the solver last saw, in which `length` is one unit.
    pub(crate) fn of(narrow: &NarrowPhase, colliders: &ColliderSet, length: f64) -> Self {
        let mut figures = Self::default();
        for pair in narrow.contact_pairs() {
            debug_assert!(colliders.contains(pair.collider1));
            let depth = -pair.find_deepest_contact().map_or(0.0, |(_, contact)| f64::from(contact.dist));
            if depth > 0.0 {
                figures.overlaps += usize::from(depth > 0.01);
                figures.deepest = figures.deepest.max(depth * length);
                figures.total += depth * length;
            }
        }
        figures
    }
}
