//! Points of a regular grid in a volume or a shell, found block by block: what is far from the surface is told for a whole block at once.

use arabesque_core::{Bounds, Budget, Error, Result, Vector};
use rayon::prelude::*;

use crate::mesh::MeshIndex;

/// Points along the side of a block.
const SIDE: usize = 8;
/// Work units of a question to a mesh.
const ASK: u64 = 3000;

/// The points of a grid of `spacing` inside of a closed mesh, and outside of it up to `margin`. Point for point in rows along x, block by block.
///
/// # Errors
/// [`Error::Parameter`] for a spacing that is not positive; [`Error::Limit`] for more points than the limits of `candidates` or `work` allow.
pub fn inside_grid(index: &MeshIndex, spacing: f64, margin: f64, budget: &Budget) -> Result<Vec<Vector<3>>> {
    let grid = Grid::new(index.bounds().grown(margin.max(0.0)), spacing, budget)?;
    grid.collect(
        budget,
        |centre, radius| {
            let distance = index.closest(centre).distance;
            let is_inside = index.is_inside(centre);
            match (is_inside, distance > radius) {
                (true, true) => Side::All,
                (false, _) if distance > radius + margin => Side::None,
                _ => Side::Some,
            }
        },
        |p| index.is_inside(p) || margin > 0.0 && index.closest_within(p, margin).is_some(),
    )
}

/// The points of a grid of `spacing` that are at most `below` under the surface of a mesh and at most `above` over it, open or closed.
///
/// # Errors
/// As [`inside_grid`].
pub fn shell_grid(index: &MeshIndex, spacing: f64, below: f64, above: f64, budget: &Budget) -> Result<Vec<Vector<3>>> {
    let reach = below.max(above).max(0.0);
    let grid = Grid::new(index.bounds().grown(reach), spacing, budget)?;
    grid.collect(
        budget,
        |centre, radius| if index.closest_within(centre, radius + reach).is_none() { Side::None } else { Side::Some },
        |p| index.closest_within(p, reach).is_some_and(|near| (-below..=above).contains(&index.height(&near, p))),
    )
}

/// Which points of a block count.
enum Side {
    All,
    None,
    Some,
}

struct Grid {
    origin: Vector<3>,
    spacing: f64,
    blocks: [usize; 3],
}

impl Grid {
    /// A grid over a box, its points as far from one border as from the other.
    fn new(bounds: Bounds<3>, spacing: f64, budget: &Budget) -> Result<Self> {
        if !(spacing.is_finite() && spacing > 0.0) {
            return Err(Error::parameter("spacing", spacing, "a positive number"));
        }
        let points = bounds.size().0.map(|side| (side / spacing).floor() + 1.0);
        let blocks = points.map(|n| (n / SIDE as f64).ceil());
        let limit = budget.limits().candidates;
        budget.within_expected("points of a grid: blocks", blocks.iter().product::<f64>(), ("candidates", limit))?;
        let slack = Vector(std::array::from_fn(|k| bounds.size()[k] - (points[k] - 1.0) * spacing));
        Ok(Self { origin: bounds.min + slack * 0.5, spacing, blocks: blocks.map(|n| n as usize) })
    }

    fn collect(
        &self,
        budget: &Budget,
        block: impl Fn(Vector<3>, f64) -> Side + Sync,
        counts: impl Fn(Vector<3>) -> bool + Sync,
    ) -> Result<Vec<Vector<3>>> {
        let of_block = |b: usize| -> Result<Vec<Vector<3>>> {
            let [nx, ny, _] = self.blocks;
            let first = [b % nx, b / nx % ny, b / (nx * ny)].map(|i| i * SIDE);
            let half = 0.5 * (SIDE - 1) as f64;
            let centre = self.origin + Vector(first.map(|i| i as f64 + half)) * self.spacing;
            budget.spend(ASK)?;
            let side = block(centre, half * self.spacing * 3.0_f64.sqrt() * (1.0 + 1e-9));
            if matches!(side, Side::None) {
                return Ok(Vec::new());
            }
            let (mut points, mut meter) = (Vec::new(), budget.meter());
            for k in 0..SIDE * SIDE * SIDE {
                let step = [k % SIDE, k / SIDE % SIDE, k / (SIDE * SIDE)];
                let p =
                    self.origin + Vector(std::array::from_fn(|axis| (first[axis] + step[axis]) as f64)) * self.spacing;
                if matches!(side, Side::All) {
                    points.push(p);
                } else {
                    meter.spend(ASK)?;
                    points.extend(counts(p).then_some(p));
                }
            }
            Ok(points)
        };
        let blocks: Result<Vec<_>> = (0..self.blocks.iter().product()).into_par_iter().map(of_block).collect();
        let blocks = blocks?;
        budget.spend(0)?;
        let points: Vec<_> = blocks.into_iter().flatten().collect();
        budget.within("points of a grid, in fours", points.len() / 4, ("candidates", budget.limits().candidates))?;
        Ok(points)
    }
}
