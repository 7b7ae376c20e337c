//! Which points lie on one sheet of surface, and which only near one another.
//!
//! Where two strands of yarn touch, points of both are mixed, and no function that is positive outside of one and of the other can be told from the nearest of them. So points are linked
//! first as a surface links them, and each sheet becomes a surface of its own.

use arabesque_core::{DisjointSets, Vector};

use super::neighbours::Neighbours;

/// Least cosine between the normals of two points that are linked: sharp edges are, the two sides of a touch are not.
const TURN: f64 = -0.3;
/// How steeply one point may lie above the other, against the mean of their normals: a share of the way between them.
const RISE: f64 = 0.5;
/// Sheets of fewer points belong to the one they are nearest to.
const LEAST: usize = 24;

/// The points of each sheet, in rising order.
pub(crate) fn sheets(points: &[Vector<3>], normals: &[Vector<3>], neighbours: &Neighbours) -> Vec<Vec<usize>> {
    let mut sets = DisjointSets::new(points.len());
    for i in 0..points.len() {
        for &j in neighbours.of(i) {
            let j = j as usize;
            if are_linked(points[j] - points[i], normals[i], normals[j]) {
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

/// Whether a surface may lead from a point to another by a way that is as long as the straight one, about.
fn are_linked(way: Vector<3>, from: Vector<3>, to: Vector<3>) -> bool {
    let middle = (from + to).unit_or_zero();
    from.dot(to) > TURN && middle.dot(way).abs() <= RISE * way.norm()
}
