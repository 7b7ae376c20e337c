//! What is drawn.

use arabesque_core::{PointSet, Similarity, TriangleMesh, Vector};

use super::palette::{CLAY, of_number};

/// A thing in a picture.
#[derive(Clone, Copy, Debug)]
pub enum Item<'a> {
    /// A mesh, by its own colours or else like clay.
    Mesh(&'a TriangleMesh),
    /// A mesh in many places, each coloured by its number where the mesh has no colours.
    Placed(&'a TriangleMesh, &'a [Similarity<3>]),
    /// Points: as balls of their radii where they have some, as pieces of a surface where they have normals, else as small balls; by
    /// their colours, or else by their groups, or else by their elements.
    Points(&'a PointSet<3>),
    /// Points in the plane, as at height 0.
    Plane(&'a PointSet<2>),
}

/// Points as they are drawn.
pub(super) struct Cloud<'a> {
    pub(super) positions: Vec<Vector<3>>,
    pub(super) normals: Option<&'a [Vector<3>]>,
    pub(super) radii: Option<&'a [f64]>,
    pub(super) colours: Vec<[u8; 3]>,
}

impl<'a> Cloud<'a> {
    pub(super) fn of_space(points: &'a PointSet<3>) -> Self {
        Self {
            positions: points.positions.clone(),
            normals: points.normals.as_deref().filter(|n| n.len() == points.len()),
            radii: points.radii.as_deref().filter(|r| r.len() == points.len()),
            colours: colours_of(points),
        }
    }

    pub(super) fn of_plane(points: &'a PointSet<2>) -> Self {
        Self {
            positions: points.positions.iter().map(|p| Vector([p[0], p[1], 0.0])).collect(),
            normals: None,
            radii: points.radii.as_deref().filter(|r| r.len() == points.len()),
            colours: colours_of(points),
        }
    }
}

/// The colour of every point.
fn colours_of<const D: usize>(points: &PointSet<D>) -> Vec<[u8; 3]> {
    if let Some(colours) = points.colours.as_ref().filter(|c| c.len() == points.len()) {
        return colours.iter().map(|c| bytes(*c)).collect();
    }
    let differ = |list: &Option<Vec<i32>>| list.as_ref().is_some_and(|list| list.windows(2).any(|w| w[0] != w[1]));
    let labels = [&points.groups, &points.elements, &points.classes].into_iter().find(|list| differ(list));
    let continuous = PointSet::<D>::CONTINUOUS;
    let colour = |label: i32| if label == continuous { CLAY } else { of_number(label) };
    match labels.and_then(Option::as_ref).filter(|list| list.len() == points.len()) {
        Some(labels) => labels.iter().map(|label| colour(*label)).collect(),
        None => vec![CLAY; points.len()],
    }
}

/// Shares of a colour as bytes.
pub(super) fn bytes(colour: [f64; 3]) -> [u8; 3] {
    colour.map(|share| (share.clamp(0.0, 1.0) * 255.0).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_before_groups_and_groups_before_elements() {
        let mut points = PointSet::<2>::at(vec![Vector::ZERO; 2]);
        assert_eq!(colours_of(&points), [CLAY; 2]);
        points.elements = Some(vec![-1, 4]);
        assert_eq!(colours_of(&points), [CLAY, of_number(4)]);
        points.groups = Some(vec![3, 3]);
        assert_eq!(colours_of(&points), [CLAY, of_number(4)], "one group says nothing");
        points.groups = Some(vec![3, 1]);
        assert_eq!(colours_of(&points), [of_number(3), of_number(1)]);
        points.colours = Some(vec![[1.0, 0.0, 0.2]; 2]);
        assert_eq!(colours_of(&points), [[255, 0, 51]; 2]);
    }
}
