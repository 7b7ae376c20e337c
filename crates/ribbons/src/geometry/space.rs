//! Ribbons along curves in space.

use arabesque_core::{Path, Result, Vector, carried};

use crate::geometry::cage::{Cage, CagePlan, Form, Line, Rung};

/// Vectors no longer than this have no direction.
const LEAST: f64 = 1e-12;

impl Cage<3> {
    /// Cuts the ribbon around `path`. It lies flat on the ground as far as the curve allows and turns as little as it can on the way.
    pub(crate) fn in_space(path: &Path<3>, plan: &CagePlan<'_>) -> Result<Self> {
        let line = Line::new(path, plan)?;
        let scale = plan.scale();
        let tangents: Vec<Vector<3>> = (0..=line.pieces).map(|k| line.direction(k)).collect();
        let downs = downs(&tangents, line.closed());
        let rungs: Vec<_> = downs.into_iter().enumerate().map(|(k, down)| line.rung(k, down)).collect();
        let forms = rungs.windows(2).map(|w| unrolled(&w[0], &w[1], scale)).collect();
        Ok(Self { rungs, forms, closed: line.closed(), step: line.step, scale })
    }
}

/// For each tangent the direction across the ribbon, carried along without twist.
fn downs(tangents: &[Vector<3>], closed: bool) -> Vec<Vector<3>> {
    let first = tangents.iter().find(|t| t.norm() > 0.0).copied().unwrap_or(Vector([1.0, 0.0, 0.0]));
    carried(tangents, first_down(first), closed)
}

/// Across the ribbon and level with the ground (z is up); for a curve that begins upright, along x.
fn first_down(tangent: Vector<3>) -> Vector<3> {
    let level = Vector([0.0, 0.0, 1.0]).cross(tangent) * -1.0;
    level.unit_if_longer(LEAST).unwrap_or(Vector([1.0, 0.0, 0.0]))
}

/// The quadrilateral between two edges, laid flat: two triangles that keep the lengths of their sides.
pub(crate) fn unrolled<const D: usize>(a: &Rung<D>, b: &Rung<D>, scale: f64) -> Form {
    let left = (a.bottom - a.top).norm();
    let to = |p: Vector<D>| apex(left, (p - a.top).norm(), (p - a.bottom).norm());
    let (top, bottom) = (to(b.top), to(b.bottom));
    Form::new(left / scale, top * (1.0 / scale), bottom * (1.0 / scale))
}

/// The point right of a vertical edge from the origin down to `left` that is `near` from its top and `far` from its bottom.
fn apex(left: f64, near: f64, far: f64) -> Vector<2> {
    let y = (near * near - far * far + left * left) / (2.0 * left);
    Vector::xy((near * near - y * y).max(0.0).sqrt(), y)
}
