//! Which points lie on one sheet of surface, and which only near one another.
//!
//! Where two strands of yarn touch, points of both are mixed, and no function that is positive outside of one and of the other can be told from the nearest of them. So points are linked
//! first as a surface links them, and each sheet becomes a surface of its own.

use arabesque_core::{DisjointSets, Vector};

use super::neighbours::Neighbours;

/// Least cosine between the normals of two points that are linked: across sharp edges they are, the two sides of a touch are not.
const TURN: f64 = -0.3;
/// Least cosine of those that are linked without a closer look, and everywhere where the surface is hollow between them, as it is where two strands touch.
const PLAIN: f64 = 0.3;
/// How much the normals may lean towards one another there.
const HOLLOW: f64 = 0.5;
/// A point that far above the plane of another is beyond an edge between them, in spacings.
const BEYOND: f64 = 0.2;
/// How steeply one point may lie above the other, against the mean of their normals: a share of the way between them.
const RISE: f64 = 0.5;
/// Sheets of fewer points belong to the one they are nearest to.
const LEAST: usize = 24;

/// The points of each sheet, in rising order.
pub(crate) fn sheets(points: &[Vector<3>], normals: &[Vector<3>], neighbours: &Neighbours) -> Vec<Vec<usize>> {
    let mut sets = DisjointSets::new(points.len());
    // Whether the sheet of `i` goes on above that of `j`, as it does where strands pass through one another and at no edge.
    let passes = |i: usize, j: usize| {
        let own = neighbours.of(i).iter().map(|&k| k as usize).filter(|&k| normals[k].dot(normals[i]) > 0.5);
        own.into_iter().any(|k| (points[k] - points[j]).dot(normals[j]) > BEYOND * neighbours.spacing[j])
    };
    for i in 0..points.len() {
        for &j in neighbours.of(i) {
            let j = j as usize;
            let way = points[j] - points[i];
            let (middle, length) = ((normals[i] + normals[j]).unit_or_zero(), way.norm());
            let (turn, opening) = (normals[i].dot(normals[j]), (normals[j] - normals[i]).dot(way));
            let is_linked = middle.dot(way).abs() <= RISE * length
                && if turn > PLAIN {
                    opening > -HOLLOW * length
                } else {
                    turn > TURN && opening > 0.0 && !passes(i, j) && !passes(j, i)
                };
            if is_linked {
                sets.join(i, j);
            }
        }
    }
    for small in sets.clone().groups().iter().filter(|sheet| sheet.len() < LEAST) {
        // A set may have grown by another small one meanwhile.
        let own = sets.of(small[0]);
        let mut nearest: Option<(f64, usize)> = None;
        for &i in small {
            let other = neighbours.of(i).iter().map(|&j| j as usize).find(|&j| sets.of(j) != own);
            let Some(other) = other else { continue };
            let d2 = (points[other] - points[i]).norm2();
            if nearest.is_none_or(|(least, _)| d2 < least) {
                nearest = Some((d2, other));
            }
        }
        if let Some((_, other)) = nearest {
            sets.join(own, other);
        }
    }
    sets.groups()
}
