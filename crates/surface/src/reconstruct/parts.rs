//! What becomes a surface of its own.

use std::collections::BTreeMap;

use arabesque_core::PointSet;

use crate::params::Parts;

/// The name of a part, and the order of parts: groups first, then elements, each by number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Name {
    /// There is but one part.
    All,
    Group(i32),
    Element(i32),
}

impl Name {
    /// What the mesh calls the part.
    pub(super) fn text(self) -> String {
        match self {
            Self::All => "points".into(),
            Self::Group(number) => format!("group {number}"),
            Self::Element(number) => format!("element {number}"),
        }
    }
}

/// The numbers of the points of each part, in rising order.
pub(super) fn parts(points: &PointSet<3>, parts: Parts) -> BTreeMap<Name, Vec<usize>> {
    let name = |i: usize| {
        let element = points.elements.as_ref().map(|e| e[i]).filter(|&e| e != PointSet::<3>::CONTINUOUS);
        let group = points.groups.as_ref().map(|g| g[i]);
        match (parts, element, group) {
            (Parts::Groups, Some(element), _) => Name::Element(element),
            (Parts::Groups, None, Some(group)) => Name::Group(group),
            _ => Name::All,
        }
    };
    let mut found: BTreeMap<Name, Vec<usize>> = BTreeMap::new();
    (0..points.len()).for_each(|i| found.entry(name(i)).or_default().push(i));
    found
}
