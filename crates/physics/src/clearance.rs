//! How near elements come to one another where they lie in a heap: files often leave a gap between what touches.

use arabesque_core::{Bounds, Budget, Error, Result};
use rapier3d::parry::{bounding_volume::BoundingVolume, query};

use crate::{setting::Body, units::Units};

/// Work of a look at the box of another body, and of a pair that is compared.
const PER_LOOK: u64 = 20;
const PER_PAIR: u64 = 4_000;
/// What is nearer than this share of its size touches, with a gap.
const NEAR: f64 = 0.12;
/// The least share of all elements that touch another in a heap.
const HEAP: f64 = 0.6;
/// What lies on others touches so many: the narrowest gap alone is narrower than most.
const CONTACTS: usize = 4;
/// No more pairs are looked at for one element.
const MOST: usize = 256;

/// The usual gap between an element and those nearest to it that it touches, as a share of its size ([`crate::Shape::size`]): between 0 and
/// 0.12. It is 0 where elements are in one another; `None` where most of them touch none, so that they are no heap.
///
/// # Errors
/// [`Error::Input`] where they lie too far apart to be computed with, and those of the budget.
pub fn clearance(bodies: &[Body], budget: &Budget) -> Result<Option<f64>> {
    let sizes: Vec<f64> = bodies.iter().map(|b| b.shape.size() * b.pose.scale).collect();
    let mut sorted = sizes.clone();
    sorted.sort_by(f64::total_cmp);
    let Some(&unit) = sorted.get(sorted.len() / 2).filter(|unit| **unit > 0.0) else { return Ok(None) };
    let places: Vec<_> = bodies.iter().map(|b| b.pose.apply(b.shape.centre())).collect();
    let units = Units::new(&Bounds::around(places.iter().copied()), unit)?;
    let mut seen = Vec::with_capacity(bodies.len());
    for (k, body) in bodies.iter().enumerate() {
        let Some(shape) = body.shape.scaled(body.pose.scale / units.length()) else {
            let problem = "its scale is too small or too large beside the others";
            return Err(Error::input(format!("element {}", k + 1), problem, "make the elements more alike in size"));
        };
        let pose = units.pose(&body.pose, body.shape.centre());
        let around = shape.compute_aabb(&pose);
        seen.push((shape, pose, around));
    }
    let mut order: Vec<usize> = (0..bodies.len()).collect();
    order.sort_by(|&a, &b| seen[a].2.mins.x.total_cmp(&seen[b].2.mins.x));
    let mut nearest = vec![[f64::INFINITY; CONTACTS]; bodies.len()];
    for (at, &a) in order.iter().enumerate() {
        let reach = (NEAR * sizes[a].max(unit) / unit) as f32;
        let mut looked = 0;
        for &b in &order[at + 1..] {
            if seen[b].2.mins.x > seen[a].2.maxs.x + reach || looked == MOST {
                break;
            }
            budget.spend(PER_LOOK)?;
            if !seen[a].2.loosened(reach).intersects(&seen[b].2) {
                continue;
            }
            looked += 1;
            budget.spend(PER_PAIR)?;
            let ((one, p, _), (other, q, _)) = (&seen[a], &seen[b]);
            // Shapes that the library cannot compare touch nothing here.
            if let Ok(Some(contact)) = query::contact(p, &**one, q, &**other, reach) {
                let gap = f64::from(contact.dist) * unit;
                note(&mut nearest[a], gap / sizes[a]);
                note(&mut nearest[b], gap / sizes[b]);
            }
        }
    }
    let mut gaps: Vec<f64> = nearest.iter().filter_map(usual).collect();
    if (gaps.len() as f64) < HEAP * bodies.len() as f64 {
        return Ok(None);
    }
    gaps.sort_by(f64::total_cmp);
    Ok(gaps.get(gaps.len() / 2).map(|gap| gap.max(0.0)))
}

/// Puts a gap among the narrowest.
fn note(narrowest: &mut [f64; CONTACTS], gap: f64) {
    let mut gap = gap;
    for known in narrowest {
        if gap < *known {
            std::mem::swap(known, &mut gap);
        }
    }
}

/// The mean of those gaps at which things touch; nothing where they touch nothing.
fn usual(narrowest: &[f64; CONTACTS]) -> Option<f64> {
    let touching = || narrowest.iter().filter(|gap| **gap <= NEAR);
    let sum: f64 = touching().map(|gap| gap.max(0.0)).sum();
    Some(touching().count()).filter(|count| *count > 0).map(|count| sum / count as f64)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use arabesque_core::{Similarity, TriangleMesh, Vector};

    use super::*;
    use crate::shape::Shape;

    fn row(apart: f64) -> Vec<Body> {
        let corner = |k: usize| Vector(std::array::from_fn(|a| if k >> a & 1 == 1 { 0.5 } else { -0.5 }));
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let mesh = TriangleMesh {
            positions: (0..8).map(corner).collect(),
            triangles: faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect(),
            ..TriangleMesh::default()
        };
        let shape = Arc::new(Shape::new(&mesh, "t", &Budget::default()).unwrap());
        let at = |k: u32| Similarity::shift(Vector([apart * f64::from(k), 0.0, 0.0]));
        (0..5).map(|k| Body { shape: Arc::clone(&shape), pose: at(k), frozen: false, gravity: None }).collect()
    }

    #[test]
    fn the_gap_of_a_row_is_measured_and_what_stands_apart_has_none() {
        let size = (6.0 / std::f64::consts::PI).cbrt();
        let of = |apart| clearance(&row(apart), &Budget::default()).unwrap();
        assert!((of(1.05).unwrap() - 0.05 / size).abs() < 1e-3, "{:?}", of(1.05));
        assert_eq!([of(1.5), of(0.9)], [None, Some(0.0)]);
        assert_eq!(clearance(&[], &Budget::default()).unwrap(), None);
    }

    #[test]
    fn all_gaps_of_what_touches_count_and_not_the_narrowest_alone() {
        let mut bodies = row(1.0);
        let places = [0.0, 1.02, 2.08, 3.1, 4.16];
        bodies.iter_mut().zip(places).for_each(|(body, x)| body.pose = Similarity::shift(Vector([x, 0.0, 0.0])));
        let size = (6.0 / std::f64::consts::PI).cbrt();
        let gap = clearance(&bodies, &Budget::default()).unwrap().unwrap();
        assert!((gap - 0.04 / size).abs() < 1e-3, "{gap}");
    }
}
