//! Directions from a few strokes.

use crate::{
    field::{Grid, OrientationField},
    space::{Bounds, Matrix, Vector},
};

/// A directed stroke that says which way the pattern flows: a polyline in output coordinates.
pub type FlowStroke = Vec<Vector<2>>;

impl OrientationField<2> {
    /// The smoothest field that follows the strokes: directions spread from them over `bounds` by relaxation of the
    /// unit vectors (harmonic in each component, made unit at the end). Along a stroke the x axis of the exemplar points the way it was drawn.
    ///
    /// `nodes` is the number of grid nodes along the longer side, at least 2. Returns `None` when no stroke has a length.
    pub fn from_strokes(strokes: &[FlowStroke], bounds: Bounds<2>, nodes: usize) -> Option<Self> {
        let grid = stroke_grid(bounds, nodes);
        let mut fixed = vec![Vector::<2>::ZERO; grid.values.len()];
        for stroke in strokes {
            splat(stroke, &grid, &mut fixed);
        }
        if fixed.iter().all(|v| v.norm2() == 0.0) {
            return None;
        }
        let direction = relax(&fixed, grid.nodes);
        let values = direction.iter().map(|v| Matrix::rotation(v[1].atan2(v[0]))).collect();
        Some(Self::Grid(Grid { bounds: grid.bounds, nodes: grid.nodes, values }))
    }
}

fn stroke_grid(bounds: Bounds<2>, nodes: usize) -> Grid<2, ()> {
    let size = bounds.size();
    let step = size[0].max(size[1]) / (nodes.max(2) - 1) as f64;
    let count = |s: f64| (s / step).round() as usize + 1;
    let nodes = [count(size[0]).max(2), count(size[1]).max(2)];
    Grid { bounds, nodes, values: vec![(); nodes[0] * nodes[1]] }
}

/// Adds the directions of a stroke to the nearest nodes, at half the node spacing.
fn splat(stroke: &[Vector<2>], grid: &Grid<2, ()>, fixed: &mut [Vector<2>]) {
    let size = grid.bounds.size();
    let step = 0.5 * (size[0] / (grid.nodes[0] - 1) as f64).min(size[1] / (grid.nodes[1] - 1) as f64);
    for pair in stroke.windows(2) {
        let along = pair[1] - pair[0];
        let length = along.norm();
        if length == 0.0 || !length.is_finite() {
            continue;
        }
        let pieces = ((length / step).ceil() as usize).clamp(1, 100_000);
        for k in 0..=pieces {
            let p = pair[0] + along * (k as f64 / pieces as f64);
            if !grid.bounds.contains(p) {
                continue;
            }
            let at = |k: usize| ((p[k] - grid.bounds.min[k]) / size[k] * (grid.nodes[k] - 1) as f64).round() as usize;
            fixed[at(1) * grid.nodes[0] + at(0)] += along * (1.0 / length);
        }
    }
}

/// Solves Laplace's equation for both components with the splatted nodes held, coarse to fine.
fn relax(fixed: &[Vector<2>], nodes: [usize; 2]) -> Vec<Vector<2>> {
    let held: Vec<bool> = fixed.iter().map(|v| v.norm2() > 0.0).collect();
    let count = held.iter().filter(|h| **h).count().max(1) as f64;
    let known = fixed.iter().filter(|v| v.norm2() > 0.0);
    let mean = known.fold(Vector::ZERO, |s, &v| s + v.unit_or_zero()) * (1.0 / count);
    let mut field: Vec<_> = fixed.iter().map(|&v| if v.norm2() > 0.0 { v.unit_or_zero() } else { mean }).collect();
    // Red-black successive over-relaxation: a few hundred sweeps settle grids of a hundred nodes a side.
    let longest = nodes[0].max(nodes[1]) as f64;
    let omega = 2.0 / (1.0 + (std::f64::consts::PI / longest).sin());
    for sweep in 0..(8.0 * longest) as usize {
        let colour = sweep % 2;
        for y in 0..nodes[1] {
            for x in ((y + colour) % 2..nodes[0]).step_by(2) {
                let k = y * nodes[0] + x;
                if !held[k] {
                    field[k] = field[k] * (1.0 - omega) + neighbour_mean(&field, nodes, x, y) * omega;
                }
            }
        }
    }
    field
}

fn neighbour_mean(field: &[Vector<2>], nodes: [usize; 2], x: usize, y: usize) -> Vector<2> {
    let at = |x: usize, y: usize| field[y * nodes[0] + x];
    let left = at(x.saturating_sub(1), y);
    let right = at((x + 1).min(nodes[0] - 1), y);
    let down = at(x, y.saturating_sub(1));
    let up = at(x, (y + 1).min(nodes[1] - 1));
    (left + right + down + up) * 0.25
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_stroke_turns_the_whole_field_its_way() {
        let bounds = Bounds::new(Vector::xy(0.0, 0.0), Vector::xy(100.0, 50.0));
        let stroke = vec![Vector::xy(10.0, 10.0), Vector::xy(60.0, 60.0)];
        let field = OrientationField::from_strokes(&[stroke], bounds, 33).unwrap();
        for p in [Vector::xy(1.0, 49.0), Vector::xy(99.0, 1.0)] {
            assert!((field.at(p).angle() - std::f64::consts::FRAC_PI_4).abs() < 1e-6);
        }
    }

    #[test]
    fn between_two_strokes_the_field_turns_steadily() {
        let bounds = Bounds::new(Vector::xy(0.0, 0.0), Vector::xy(100.0, 100.0));
        let right = vec![Vector::xy(0.0, 0.0), Vector::xy(100.0, 0.0)];
        let slanted = vec![Vector::xy(0.0, 99.0), Vector::xy(1.0, 100.0)];
        let field = OrientationField::from_strokes(&[right, slanted], bounds, 33).unwrap();
        let angle = |y| field.at(Vector::xy(1.0, y)).angle();
        assert!(angle(2.0) < angle(50.0) && angle(50.0) < angle(98.0));
    }
}
