//! Balls that stand for a solid.

use arabesque_core::{Budget, Result, Vector};

use crate::{
    mesh::MeshIndex,
    spread::{inside_grid, scatter},
};

/// Nodes of a grid of candidates along the longest side.
const ALONG: f64 = 18.0;
/// Middles lie no less deep than this share of the deepest place.
const DEEP: f64 = 0.35;
/// Depth counts so much beside distance where the next ball goes.
const INNER: f64 = 0.5;
/// Another ball is worth it that lies no nearer to the others than this share of the depth of the deepest place.
const APART: f64 = 0.55;
/// Places of the surface to which balls reach, and how much larger they are for that than what fits inside, at most.
const PLACES: f64 = 500.0;
const LARGER: f64 = 1.6;
/// Work of a candidate for a ball.
const LOOK: u64 = 6;

/// Up to `most` balls spread through the inside of a mesh, each as large as its part of the surface is away; one in the middle of what
/// encloses nothing.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub fn balls(index: &MeshIndex, most: usize, budget: &Budget) -> Result<Vec<(Vector<3>, f64)>> {
    let bounds = index.bounds();
    let longest = bounds.size().0.into_iter().fold(0.0, f64::max);
    let places = inside_grid(index, longest / ALONG, 0.0, budget)?;
    let depths = index.signed_distances(&places, budget)?;
    let deepest = depths.iter().copied().fold(0.0, f64::max);
    if places.is_empty() || deepest <= 0.0 {
        return Ok(vec![(bounds.centre(), 0.25 * bounds.size().norm())]);
    }
    let candidates: Vec<(Vector<3>, f64)> =
        places.into_iter().zip(depths).filter(|(_, depth)| *depth >= DEEP * deepest).collect();
    let mut room = vec![f64::INFINITY; candidates.len()];
    let mut chosen: Vec<(Vector<3>, f64)> = Vec::new();
    while chosen.len() < most.max(1) {
        budget.spend(LOOK * candidates.len() as u64)?;
        let worth = |n: usize| room[n].min(longest) + INNER * candidates[n].1;
        let best = (0..candidates.len()).fold(0, |best, n| if worth(n) > worth(best) { n } else { best });
        if room[best] < APART * deepest {
            break;
        }
        let (p, depth) = candidates[best];
        chosen.push((p, depth));
        room.iter_mut().zip(&candidates).for_each(|(room, (q, _))| *room = room.min((*q - p).norm()));
    }
    grown(index, &mut chosen, budget)?;
    Ok(chosen)
}

/// Makes balls reach to the parts of the surface that are nearest to each.
fn grown(index: &MeshIndex, balls: &mut [(Vector<3>, f64)], budget: &Budget) -> Result<()> {
    let mut reached = vec![(0.0, 0.0); balls.len()];
    for found in scatter(index, (index.area() / PLACES).sqrt(), 0, budget)? {
        budget.spend(LOOK * balls.len() as u64)?;
        let gap = |n: usize| (found.point - balls[n].0).norm() - balls[n].1;
        let nearest = (0..balls.len()).fold(0, |best, n| if gap(n) < gap(best) { n } else { best });
        reached[nearest].0 += (found.point - balls[nearest].0).norm();
        reached[nearest].1 += 1.0;
    }
    for ((_, radius), (sum, count)) in balls.iter_mut().zip(reached) {
        if count > 0.0 {
            *radius = (sum / count).clamp(*radius, LARGER * *radius);
        }
    }
    Ok(())
}
