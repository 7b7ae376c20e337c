//! Where directions on a surface come from, before they are smoothed.

use arabesque_core::{Budget, Error, Result, Vector, Warning, arc_lengths};

use super::{
    curvature::curvatures,
    transport::{Known, Planes},
};
use crate::mesh::MeshIndex;

/// How far a stroke may be from the surface before it is told, as a share of the surface's diagonal.
const FAR: f64 = 0.1;
/// Over which length directions of curvature are smoothed at least, as a share of the diagonal, and in edges.
const SMOOTHING: (f64, f64) = (0.03, 2.0);
/// A surface that bends so little more one way than the other is round.
const ROUND: f64 = 0.08;
/// What is known everywhere, so that every place has some direction.
const FAINT: f64 = 1e-6;

arabesque_core::choices! {
    /// Which of the two principal directions.
    pub enum Bend {
        /// Along which the surface bends most: around a pipe.
        Most = "most",
        /// Along which it bends least: along a pipe.
        Least = "least",
    }
}

/// Where the directions come from.
#[derive(Clone, Debug, PartialEq)]
pub enum Directions {
    /// From how the surface bends. Where it bends the same way all around, as a plane or a ball does, directions continue from the rest.
    Curvature(Bend),
    /// One direction in space, as it lies along the surface; where it stands upright on it, directions continue from the rest.
    Constant(Vector<3>),
    /// Polylines on or near the surface; between them directions turn as evenly as they can.
    Strokes(Vec<Vec<Vector<3>>>),
}

/// What is known at each vertex, and whether a direction and its opposite are the same.
pub(super) struct Source {
    pub(super) known: Vec<Known>,
    /// 1 for arrows, 2 for lines.
    pub(super) symmetry: u32,
    pub(super) warnings: Vec<Warning>,
}

impl Directions {
    pub(super) fn source(&self, index: &MeshIndex, planes: &Planes, budget: &Budget) -> Result<Source> {
        match self {
            Self::Curvature(bend) => bent(index, planes, *bend, budget),
            Self::Constant(direction) => constant(planes, *direction),
            Self::Strokes(strokes) => drawn(index, planes, strokes, budget),
        }
    }
}

fn bent(index: &MeshIndex, planes: &Planes, bend: Bend, budget: &Budget) -> Result<Source> {
    let diagonal = index.bounds().size().norm();
    let smoothing = (SMOOTHING.0 * diagonal).max(SMOOTHING.1 * planes.edge_length);
    let longest = longest_axis(index);
    let curvatures = curvatures(index, budget)?;
    let known = curvatures.iter().enumerate().map(|(v, curvature)| {
        let [most, least] = curvature.values.map(f64::abs);
        let (strong, weak) = if most >= least { (0, 1) } else { (1, 0) };
        let wanted = curvature.directions[if bend == Bend::Most { strong } else { weak }];
        // How much more it bends one way than the other; flat parts say nothing, nor do round ones, which only their triangles bend.
        let told = (most - least).abs() / (most + least + 1.0 / diagonal);
        let told = ((told - ROUND) / (1.0 - ROUND)).max(0.0);
        let weight = told * planes.areas[v] / (smoothing * smoothing);
        let (direction, _) = planes.number(v, wanted, 2);
        let (fallback, share) = planes.number(v, longest, 2);
        let faint = FAINT * share * share;
        let sum = [0, 1].map(|c| direction[c] * weight + fallback[c] * faint);
        let length = sum[0].hypot(sum[1]).max(f64::MIN_POSITIVE);
        Known { direction: sum.map(|c| c / length), weight: length }
    });
    Ok(Source { known: known.collect(), symmetry: 2, warnings: Vec::new() })
}

fn longest_axis(index: &MeshIndex) -> Vector<3> {
    let size = index.bounds().size();
    let longest = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
    // A little of the others, so that it stands upright nowhere on boxes and balls.
    let mut axis = Vector([0.02, 0.013, 0.007]);
    axis[longest] = 1.0;
    axis
}

fn constant(planes: &Planes, direction: Vector<3>) -> Result<Source> {
    if !direction.is_finite() || direction.norm() <= 0.0 {
        let [x, y, z] = direction.0;
        return Err(Error::parameter("direction", format!("{x},{y},{z}"), "three numbers, not all of them 0"));
    }
    let known = (0..planes.normals.len()).map(|v| {
        let (number, share) = planes.number(v, direction, 1);
        // Where a tenth of it lies along the surface it holds, and it fades below that.
        Known { direction: number, weight: 100.0 * (share * share - 0.01).max(0.0) + FAINT * share }
    });
    Ok(Source { known: known.collect(), symmetry: 1, warnings: Vec::new() })
}

fn drawn(index: &MeshIndex, planes: &Planes, strokes: &[Vec<Vector<3>>], budget: &Budget) -> Result<Source> {
    let mut sums = vec![([0.0; 2], 0.0); planes.normals.len()];
    let mut warnings = Vec::new();
    let diagonal = index.bounds().size().norm();
    for (k, stroke) in strokes.iter().enumerate() {
        let place = format!("stroke {}", k + 1);
        if let Some(p) = stroke.iter().position(|p| !p.is_finite()) {
            return Err(Error::input(
                place,
                format!("point {} has no place", p + 1),
                "give three finite numbers for each point",
            ));
        }
        let length = arc_lengths(stroke).last().copied().unwrap_or(0.0);
        if length <= 0.0 {
            return Err(Error::input(
                place,
                "a stroke of no length, expected a line",
                "draw it longer, or leave it out",
            ));
        }
        let farthest = along(index, planes, stroke, &mut sums, budget)?;
        if farthest > FAR * diagonal {
            warnings.push(Warning::new(
                format!("{place} is up to {farthest:.3} away from the surface, whose diagonal is {diagonal:.3}"),
                "draw strokes for directions on the surface",
            ));
        }
    }
    if strokes.is_empty() {
        return Err(Error::parameter("strokes", "none", "at least one line on the surface"));
    }
    let known = sums.into_iter().map(|(sum, weight)| {
        let length = f64::hypot(sum[0], sum[1]);
        let share = if weight > 0.0 { length / weight } else { 0.0 };
        // Strokes that disagree weigh less.
        Known {
            direction: sum.map(|c| c / length.max(f64::MIN_POSITIVE)),
            weight: 100.0 * share * (weight / planes.edge_length).min(1.0),
        }
    });
    Ok(Source { known: known.collect(), symmetry: 1, warnings })
}

/// Adds the directions of a stroke to the corners of the triangles that it passes; answers how far from the surface it comes.
fn along(
    index: &MeshIndex,
    planes: &Planes,
    stroke: &[Vector<3>],
    sums: &mut [([f64; 2], f64)],
    budget: &Budget,
) -> Result<f64> {
    let (mut farthest, mut meter) = (0.0_f64, budget.meter());
    for ends in stroke.windows(2) {
        let way = ends[1] - ends[0];
        let steps = (way.norm() / (0.5 * planes.edge_length)).ceil().max(1.0);
        let share = way.norm() / steps;
        for step in 0..steps as usize {
            meter.spend(4000)?;
            let near = index.closest(ends[0] + way * ((step as f64 + 0.5) / steps));
            farthest = farthest.max(near.distance);
            for (&v, weight) in index.topology.triangles[near.triangle].iter().zip(near.barycentric) {
                let (number, flat) = planes.number(v as usize, way, 1);
                let sum = &mut sums[v as usize];
                (0..2).for_each(|c| sum.0[c] += number[c] * weight * share * flat);
                sum.1 += weight * share;
            }
        }
    }
    Ok(farthest)
}
