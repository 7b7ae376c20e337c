//! Normals of points that have none: the plane through the neighbours of each point, turned to one side along a spanning tree over those that
//! differ least [Hoppe 1992].

use arabesque_core::{Budget, DisjointSets, Result, Vector};
use rayon::prelude::*;

use super::{eigen::eigen, neighbours::Neighbours};

/// Points with fewer than so many others in their part are outliers.
const LEAST: usize = 8;
/// A point whose neighbours are so many times as far as those of most is an outlier.
const LONELY: f64 = 4.0;

/// Normals that were estimated.
#[derive(Clone, Debug)]
pub(crate) struct Estimated {
    /// Of length 1, outwards.
    pub(crate) normals: Vec<Vector<3>>,
    /// Parts of the points that hang together.
    pub(crate) parts: usize,
    /// Points that lie alone.
    pub(crate) outliers: Vec<usize>,
    /// Whether all points lie along a line, or in one place.
    pub(crate) are_in_line: bool,
}

/// Normals from the places of the points.
pub(crate) fn estimated(points: &[Vector<3>], neighbours: &Neighbours, budget: &Budget) -> Result<Estimated> {
    budget.spend(points.len() as u64 * 600)?;
    let planes: Vec<(Vector<3>, f64)> =
        (0..points.len()).into_par_iter().map(|i| plane(points, neighbours, i)).collect();
    let are_in_line = planes.iter().filter(|(_, flat)| *flat < 1e-6).count() * 10 > points.len() * 9;
    let mut normals: Vec<_> = planes.into_iter().map(|(normal, _)| normal).collect();
    let parts = turned(points, &mut normals, neighbours, budget)?;
    let lonely = LONELY * neighbours.median_spacing();
    let mut outliers: Vec<usize> = parts.iter().filter(|part| part.len() < LEAST).flatten().copied().collect();
    outliers.extend((0..points.len()).filter(|&i| neighbours.spacing[i] > lonely));
    outliers.sort_unstable();
    outliers.dedup();
    Ok(Estimated { normals, parts: parts.iter().filter(|part| part.len() >= LEAST).count(), outliers, are_in_line })
}

/// The normal of the plane through a point's neighbours, and how far the neighbours spread across the line along which they spread most.
fn plane(points: &[Vector<3>], neighbours: &Neighbours, i: usize) -> (Vector<3>, f64) {
    let around = || neighbours.of(i).iter().map(|&j| points[j as usize] - points[i]).chain([Vector::ZERO]);
    let count = neighbours.of(i).len() as f64 + 1.0;
    let centre = around().fold(Vector::ZERO, |a, b| a + b) * (1.0 / count);
    let mut m = [0.0; 6];
    for d in around().map(|d| d - centre) {
        let [x, y, z] = d.0;
        m = [m[0] + x * x, m[1] + x * y, m[2] + x * z, m[3] + y * y, m[4] + y * z, m[5] + z * z];
    }
    let [least, middle, most] = eigen(m);
    (least.1, middle.0 / most.0.max(f64::MIN_POSITIVE))
}

/// Turns normals to one side along a spanning tree, and each part outwards; answers the parts.
pub(crate) fn turned(
    points: &[Vector<3>],
    normals: &mut [Vector<3>],
    neighbours: &Neighbours,
    budget: &Budget,
) -> Result<Vec<Vec<usize>>> {
    let mut edges: Vec<(f64, u32, u32)> = Vec::new();
    for i in 0..points.len() {
        for &j in neighbours.of(i) {
            let j = j as usize;
            // Neighbours see each other from both sides; pairs that only one of them knows count too.
            if j != i && (i < j || !neighbours.of(j).contains(&(i as u32))) {
                edges.push((cost(points, normals, i, j), i.min(j) as u32, i.max(j) as u32));
            }
        }
    }
    budget.spend(edges.len() as u64 * 150)?;
    edges.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut sets = DisjointSets::new(points.len());
    let mut tree: Vec<Vec<u32>> = vec![Vec::new(); points.len()];
    for &(_, i, j) in &edges {
        if sets.of(i as usize) != sets.of(j as usize) {
            sets.join(i as usize, j as usize);
            tree[i as usize].push(j);
            tree[j as usize].push(i);
        }
    }
    let parts = sets.groups();
    for part in &parts {
        let mut stack = vec![(part[0], part[0])];
        while let Some((i, from)) = stack.pop() {
            for &j in &tree[i] {
                let j = j as usize;
                if j == from {
                    continue;
                }
                if normals[i].dot(mirrored(points[j] - points[i], normals[j])) < 0.0 {
                    normals[j] = -normals[j];
                }
                stack.push((j, i));
            }
        }
        outwards(points, normals, part);
    }
    Ok(parts)
}

/// A normal as it would be carried along an arc through both points: mirrored in the plane across the line between them. On a plane that is the
/// normal itself, on a sharp bend the one of the other side.
fn mirrored(way: Vector<3>, normal: Vector<3>) -> Vector<3> {
    let way = way.unit_or_zero();
    normal - way * (2.0 * way.dot(normal))
}

/// How badly two points tell each other which side is outside: worse the more they turn, and where one lies above the other.
fn cost(points: &[Vector<3>], normals: &[Vector<3>], i: usize, j: usize) -> f64 {
    let way = (points[j] - points[i]).unit_or_zero();
    let above = way.dot(normals[i]).powi(2) + way.dot(normals[j]).powi(2);
    1.0 - normals[i].dot(mirrored(way, normals[j])).abs() + 0.25 * above
}

/// Turns a part so that most of its normals lead away from its middle.
fn outwards(points: &[Vector<3>], normals: &mut [Vector<3>], part: &[usize]) {
    let middle = part.iter().fold(Vector::ZERO, |sum, &i| sum + points[i]) * (1.0 / part.len() as f64);
    let flux: f64 = part.iter().map(|&i| normals[i].dot(points[i] - middle)).sum();
    let reach: f64 = part.iter().map(|&i| (points[i] - middle).norm()).sum();
    // A flat part has no outside: then upwards, or towards larger coordinates.
    let sum = part.iter().fold(Vector::ZERO, |sum, &i| sum + normals[i]);
    let up = [2, 1, 0].iter().map(|&k| sum[k]).find(|c| c.abs() > 0.1 * sum.norm()).unwrap_or(1.0);
    let sign = if flux.abs() > 0.02 * reach { flux } else { up };
    if sign < 0.0 {
        part.iter().for_each(|&i| normals[i] = -normals[i]);
    }
}

/// Share of neighbours on one sheet whose normals lead to opposite sides.
pub(crate) fn contradictions(points: &[Vector<3>], normals: &[Vector<3>], neighbours: &Neighbours) -> f64 {
    let of = |i: usize| {
        let beside = neighbours.of(i).iter().take(6).map(|&j| j as usize).filter(|&j| {
            let way = points[j] - points[i];
            normals[i].dot(way).abs() < 0.25 * way.norm() && normals[j].dot(way).abs() < 0.25 * way.norm()
        });
        beside.fold((0_usize, 0_usize), |(all, against), j| {
            (all + 1, against + usize::from(normals[i].dot(normals[j]) < -0.3))
        })
    };
    let (all, against) = (0..points.len()).map(of).fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    against as f64 / all.max(1) as f64
}

/// Normals of length 1, where those that have no direction follow their neighbours, and how many these are. One without any neighbour that has
/// a direction gets that of its plane.
pub(crate) fn mended(points: &[Vector<3>], normals: &[Vector<3>], neighbours: &Neighbours) -> (Vec<Vector<3>>, usize) {
    let good: Vec<Option<Vector<3>>> =
        normals.iter().map(|n| if n.is_finite() { n.unit_if_longer(1e-6) } else { None }).collect();
    let mend = |i: usize| {
        let sum = neighbours.of(i).iter().filter_map(|&j| good[j as usize]).fold(Vector::ZERO, |a, b| a + b);
        let (own, _) = plane(points, neighbours, i);
        if own.dot(sum) < 0.0 { -own } else { own }
    };
    let missing = good.iter().filter(|n| n.is_none()).count();
    (good.iter().enumerate().map(|(i, n)| n.unwrap_or_else(|| mend(i))).collect(), missing)
}
