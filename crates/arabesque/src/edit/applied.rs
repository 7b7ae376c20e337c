//! Changes made to elements that are in memory.

use std::collections::BTreeMap;

use arabesque_core::{Placement, Vector};
use arabesque_io::placed::{Changes, Replaced};

use super::elements::AnyChanges;
use crate::artwork::{Geometry, PlacedPoint};

/// The centres of elements after changes.
pub(crate) fn to_points(points: Vec<PlacedPoint>, all: &[AnyChanges]) -> Vec<PlacedPoint> {
    fn moved<const D: usize>(point: &PlacedPoint, replaced: &Replaced<D>) -> PlacedPoint {
        let at = Vector(std::array::from_fn(|k| point.position.get(k).copied().unwrap_or(0.0)));
        PlacedPoint { position: replaced.motion.apply(at).0.to_vec(), class: point.class.clone() }
    }
    let mut points = points.into_iter().enumerate().collect();
    for changes in all {
        points = match changes {
            AnyChanges::Plane(changes) => changed(points, changes, moved),
            AnyChanges::Space(changes) => changed(points, changes, moved),
        };
    }
    points.into_iter().map(|(_, point)| point).collect()
}

/// Geometry after changes.
pub(crate) fn to_geometry(geometry: Geometry, all: &[AnyChanges]) -> Geometry {
    let mut geometry = geometry;
    match &mut geometry {
        Geometry::Plane(snapshot) => {
            let plane = all.iter().filter_map(|c| if let AnyChanges::Plane(c) = c { Some(c) } else { None });
            snapshot.placements = to_placements(std::mem::take(&mut snapshot.placements), plane);
        }
        Geometry::Space(snapshot) => {
            let space = all.iter().filter_map(|c| if let AnyChanges::Space(c) = c { Some(c) } else { None });
            snapshot.placements = to_placements(std::mem::take(&mut snapshot.placements), space);
        }
        _ => {}
    }
    geometry
}

fn to_placements<'a, const D: usize>(
    placements: Vec<Placement<D>>,
    all: impl Iterator<Item = &'a Changes<D>>,
) -> Vec<Placement<D>> {
    let moved = |placement: &Placement<D>, replaced: &Replaced<D>| Placement {
        transform: replaced.motion.after(&placement.transform),
        control: placement.control.iter().map(|&(from, to)| (from, replaced.motion.apply(to))).collect(),
        ..placement.clone()
    };
    let start = placements.into_iter().enumerate().collect();
    let end = all.fold(start, |placements, changes| changed(placements, changes, moved));
    end.into_iter().map(|(_, placement)| placement).collect()
}

/// Things by number after changes; `moved` makes a new one of a thing and what replaces it.
fn changed<T: Clone, const D: usize>(
    things: Vec<(usize, T)>,
    changes: &Changes<D>,
    moved: impl Fn(&T, &Replaced<D>) -> T,
) -> Vec<(usize, T)> {
    let index: BTreeMap<usize, usize> = things.iter().enumerate().map(|(n, (id, _))| (*id, n)).collect();
    let new = |replaced: &Replaced<D>| index.get(&replaced.base).map(|&n| moved(&things[n].1, replaced));
    let mut out = Vec::with_capacity(things.len() + changes.inserted.len());
    for (id, thing) in things.iter().filter(|(id, _)| !changes.removed.contains(id)) {
        let replaced = changes.replaced.get(id).and_then(new);
        out.push((*id, replaced.unwrap_or_else(|| thing.clone())));
    }
    out.extend(changes.inserted.iter().filter_map(|(id, replaced)| Some((*id, new(replaced)?))));
    out
}
