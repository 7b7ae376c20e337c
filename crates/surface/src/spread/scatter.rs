//! Points spread evenly over a surface.

use arabesque_core::{Buckets, Budget, Domain, Error, Result, Stage, Stream};
use rayon::prelude::*;

use crate::mesh::{Closest, MeshIndex};

const CANDIDATES: Stage = Stage::new(411);

/// Candidates for each square of the spacing.
const DENSITY: f64 = 9.0;
/// Candidates that share a random stream.
const RUN: usize = 256;

/// Points of the surface, spread at random and evenly: none nearer than `spacing` to another on the same side of the surface, and hardly
/// a place farther than that from all. Candidates by area, thrown one after another [Corsini 2012].
///
/// # Errors
/// [`Error::Parameter`] for a spacing that is not positive, [`Error::Limit`] for more candidates than four times `candidates` or the work allow.
pub fn scatter(index: &MeshIndex, spacing: f64, seed: u64, budget: &Budget) -> Result<Vec<Closest>> {
    if !(spacing.is_finite() && spacing > 0.0) {
        return Err(Error::parameter("spacing", spacing, "a positive number"));
    }
    let count = (DENSITY * index.area() / (spacing * spacing)).ceil().max(16.0);
    let limit = ("candidates", budget.limits().candidates);
    budget.within_expected("places tried for points over a mesh, in fours", 0.25 * count, limit)?;
    let count = count as usize;
    let _held = budget.hold("points on a surface", count * 32)?;
    budget.foresee(count as u64 * 200)?;

    let mut sums = Vec::with_capacity(index.triangles());
    let mut sum = 0.0;
    for t in 0..index.triangles() as u32 {
        sum += index.topology.double_area(t).norm();
        sums.push(sum);
    }
    let draws = |run: usize| -> Vec<[f64; 3]> {
        let mut random = Stream::new(seed, CANDIDATES, 1 + run as u64);
        (0..RUN.min(count - run * RUN)).map(|_| std::array::from_fn(|_| random.unit())).collect()
    };
    let draws: Vec<[f64; 3]> = (0..count.div_ceil(RUN)).into_par_iter().flat_map_iter(draws).collect();
    let candidate = |k: usize| {
        let [stratum, u, share] = draws[k];
        // Strata of equal area along the triangles.
        let at = sum * (k as f64 + stratum) / count as f64;
        let triangle = sums.partition_point(|&s| s <= at).min(sums.len() - 1);
        let root = u.sqrt();
        index.at(triangle, [1.0 - root, root * (1.0 - share), root * share])
    };
    let mut order: Vec<u32> = (0..count as u32).collect();
    Stream::new(seed, CANDIDATES, 0).shuffle(&mut order);
    let mut kept: Vec<Closest> = Vec::new();
    let domain = Domain::Box(index.bounds());
    let mut buckets = Buckets::new(&domain, spacing, spacing);
    let mut meter = budget.meter();
    for k in order {
        let new = candidate(k as usize);
        let mut is_free = true;
        let looked = buckets.near(new.point, spacing, |i| {
            let other: &Closest = &kept[i as usize];
            is_free &= (other.point - new.point).norm2() >= spacing * spacing || other.normal.dot(new.normal) < 0.0;
        });
        meter.spend(100 + 4 * looked)?;
        if is_free {
            buckets.insert(kept.len() as u32, new.point);
            kept.push(new);
        }
    }
    Ok(kept)
}
