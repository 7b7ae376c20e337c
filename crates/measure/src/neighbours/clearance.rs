//! The clear space between two elements, from outline to outline.

use arabesque_core::{Budget, Domain, GridIndex, Result, Vector, ring, segment};
use rayon::prelude::*;

use crate::scene::{Body, Scene};

/// Work for each pair of corners of two outlines.
const CORNERS: u64 = 3;

/// How far neighbours are looked for, beyond the radii, in spacings.
pub(crate) const REACH: f64 = 2.0;

/// Two elements that are near to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Near {
    pub(crate) other: usize,
    /// Clear space between the outlines; 0 where they touch or cross.
    pub(crate) clearance: f64,
    pub(crate) is_overlap: bool,
}

/// Of every element those near to it, by number: each pair is there twice.
pub(crate) fn neighbours<const D: usize>(scene: &Scene<'_, D>, budget: &Budget) -> Result<Vec<Vec<Near>>> {
    let bodies = &scene.bodies;
    let centres: Vec<Vector<D>> = bodies.iter().map(|b| b.centre).collect();
    let largest = bodies.iter().map(|b| b.radius).fold(0.0, f64::max);
    let reach = REACH * scene.spacing;
    let around = Domain::Box(scene.domain.bounds().grown(reach + largest));
    let index = GridIndex::new(&centres, (0.5 * reach).max(1e-9), &around);
    let of = |i: usize| -> Result<Vec<Near>> {
        let mut meter = budget.meter();
        let mut candidates = Vec::new();
        let radius = bodies[i].radius + largest + reach;
        meter.spend(index.load(centres[i], radius))?;
        index.within(centres[i], radius, |j, offset| {
            if j > i && offset.norm() <= bodies[i].radius + bodies[j].radius + reach {
                candidates.push(j);
            }
        });
        candidates.sort_unstable();
        let mut near = Vec::new();
        for j in candidates {
            let gap = box_gap(&bodies[i], &bodies[j]);
            if gap > reach {
                continue;
            }
            let corners = |b: &Body<D>| b.outline.points().count() as u64 + 1;
            meter.spend(CORNERS * corners(&bodies[i]) * corners(&bodies[j]))?;
            let (clearance, is_overlap) = clearance(&bodies[i], &bodies[j]);
            if clearance <= reach {
                near.push(Near { other: j, clearance, is_overlap });
            }
        }
        Ok(near)
    };
    let forward: Vec<Vec<Near>> = (0..bodies.len()).into_par_iter().map(of).collect::<Result<_>>()?;
    budget.spend(0)?;
    let mut all = forward.clone();
    for (i, near) in forward.iter().enumerate() {
        for n in near {
            all[n.other].push(Near { other: i, ..*n });
        }
    }
    Ok(all)
}

/// Distance between the boxes around two elements.
fn box_gap<const D: usize>(a: &Body<D>, b: &Body<D>) -> f64 {
    let apart = |k: usize| (a.bounds.min[k] - b.bounds.max[k]).max(b.bounds.min[k] - a.bounds.max[k]).max(0.0);
    (0..D).map(|k| apart(k).powi(2)).sum::<f64>().sqrt()
}

/// Clear space between two elements, and whether they lie on top of each other.
fn clearance<const D: usize>(a: &Body<D>, b: &Body<D>) -> (f64, bool) {
    if a.outline.rings.is_empty() && b.outline.rings.is_empty() {
        return ((a.centre - b.centre).norm(), false);
    }
    let edges = |body: &Body<D>| -> Vec<(Vector<D>, Vector<D>)> {
        let of_rings = body.outline.rings.iter().flat_map(|r| (0..r.len()).map(|k| (r[k], r[(k + 1) % r.len()])));
        let edges: Vec<_> = of_rings.collect();
        if edges.is_empty() { vec![(body.centre, body.centre)] } else { edges }
    };
    let (one, two) = (edges(a), edges(b));
    let mut least = f64::INFINITY;
    let mut crosses = false;
    for &e in &one {
        for &f in &two {
            // What lies farther apart than the best so far by its boxes is not looked at.
            if (0..D).any(|k| {
                e.0[k].min(e.1[k]) - f.0[k].max(f.1[k]) > least || f.0[k].min(f.1[k]) - e.0[k].max(e.1[k]) > least
            }) {
                continue;
            }
            crosses = crosses || segment::crosses(on_plane(e), on_plane(f));
            let near = segment::distance(e, f.0).min(segment::distance(f, e.0));
            least = least.min(near);
        }
    }
    let covers = |edges: &[(Vector<D>, Vector<D>)], p: Vector<D>| {
        edges.len() > 2 && ring::covers(edges.iter().map(|&e| on_plane(e)), Vector::xy(p[0], p[1]))
    };
    if crosses || covers(&one, two[0].0) || covers(&two, one[0].0) { (0.0, true) } else { (least, false) }
}

/// A segment of the plane as one of the plane. What has an outline lies in it.
fn on_plane<const D: usize>((a, b): (Vector<D>, Vector<D>)) -> (Vector<2>, Vector<2>) {
    (Vector::xy(a[0], a[1]), Vector::xy(b[0], b[1]))
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Bounds, Outline};

    use super::*;

    fn square(x: f64, side: f64) -> Body<2> {
        let corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(a, b)| Vector::xy(x + a, b));
        let outline = Outline { rings: vec![corners.to_vec()] };
        let bounds: Bounds<2> = outline.bounds();
        Body {
            class: 0,
            centre: bounds.centre(),
            radius: outline.radius(bounds.centre()),
            bounds,
            outline,
            is_whole: true,
        }
    }

    #[test]
    fn the_space_between_squares_is_measured_from_side_to_side() {
        assert_eq!(clearance(&square(0.0, 2.0), &square(5.0, 2.0)), (3.0, false));
        assert_eq!(clearance(&square(0.0, 2.0), &square(1.0, 2.0)), (0.0, true));
        assert_eq!(clearance(&square(0.0, 9.0), &square(3.0, 2.0)), (0.0, true));
        assert_eq!(box_gap(&square(0.0, 2.0), &square(5.0, 2.0)), 3.0);
    }

    #[test]
    fn points_are_apart_by_their_distance() {
        let point = |x: f64| Body {
            class: 0,
            centre: Vector([x, 0.0, 0.0]),
            outline: Outline::default(),
            bounds: Bounds::around([Vector([x, 0.0, 0.0])]),
            radius: 0.0,
            is_whole: true,
        };
        assert_eq!(clearance(&point(0.0), &point(1.5)), (1.5, false));
    }
}
