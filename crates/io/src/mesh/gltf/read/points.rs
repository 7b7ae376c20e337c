//! Points of several nodes and primitives as one set.

use arabesque_core::{PointSet, Vector};

use super::nodes::Affine;
use crate::mesh::colour::srgb;

/// The points in their place; their colours as screens have them.
pub(super) fn in_place(points: &PointSet<3>, place: &Affine) -> PointSet<3> {
    let scale = place.determinant().abs().cbrt();
    let radii = points.radii.as_ref().map(|radii| radii.iter().map(|r| r * scale).collect());
    let turned = |n: &Vector<3>| place.linear.apply(*n).unit_or_zero();
    PointSet {
        positions: points.positions.iter().map(|p| place.apply(*p)).collect(),
        normals: points.normals.as_ref().map(|normals| normals.iter().map(turned).collect()),
        colours: points.colours.as_ref().map(|colours| colours.iter().map(|c| c.map(srgb)).collect()),
        // A transform may leave nothing of a radius.
        radii: radii.filter(|radii: &Vec<f64>| radii.iter().all(|r| *r > 0.0 && r.is_finite())),
        groups: points.groups.clone(),
        elements: points.elements.clone(),
        classes: points.classes.clone(),
    }
}

/// Adds more points, and leaves out the attributes that not all of them have. Whether none had to be.
pub(super) fn append(all: &mut PointSet<3>, more: PointSet<3>) -> bool {
    fn joined<T>(all: &mut Option<Vec<T>>, more: Option<Vec<T>>) -> bool {
        match (all.as_mut(), more) {
            (Some(all), Some(more)) => {
                all.extend(more);
                true
            }
            (None, None) => true,
            _ => {
                *all = None;
                false
            }
        }
    }
    if more.is_empty() {
        return true;
    }
    if all.is_empty() {
        *all = more;
        return true;
    }
    all.positions.extend(more.positions);
    let complete = [
        joined(&mut all.normals, more.normals),
        joined(&mut all.colours, more.colours),
        joined(&mut all.radii, more.radii),
        joined(&mut all.groups, more.groups),
        joined(&mut all.elements, more.elements),
        joined(&mut all.classes, more.classes),
    ];
    !complete.contains(&false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_that_not_all_points_have_are_left_out() {
        let mut all = PointSet::default();
        let one = || PointSet { radii: Some(vec![2.0]), groups: Some(vec![7]), ..PointSet::at(vec![Vector([1.0; 3])]) };
        assert!(append(&mut all, one()) && append(&mut all, PointSet::default()) && append(&mut all, one()));
        assert_eq!((all.len(), all.radii.as_deref()), (2, Some(&[2.0, 2.0][..])));
        assert!(!append(&mut all, PointSet { groups: None, ..one() }));
        assert_eq!((all.len(), all.groups, all.radii.map(|r| r.len())), (3, None, Some(3)));
    }
}
