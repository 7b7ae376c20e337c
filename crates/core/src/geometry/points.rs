//! Points with attributes.

use crate::{
    error::{Error, Result},
    space::{Bounds, Vector},
};

/// Points with attributes, in the plane or in space. Each attribute that is there has one value for each point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointSet<const D: usize> {
    /// Where the points are.
    pub positions: Vec<Vector<D>>,
    /// Directions of length 1, outwards of the surface that the points lie on.
    pub normals: Option<Vec<Vector<D>>>,
    /// Red, green and blue, each in [0, 1].
    pub colours: Option<Vec<[f64; 3]>>,
    /// Positive radii: of balls for metaballs, of thin things for drawing.
    pub radii: Option<Vec<f64>>,
    /// Parts that touch and stay apart all the same: points of one part have one number.
    pub groups: Option<Vec<i32>>,
    /// Rigid elements: points with the same number of 0 or more move as one body; -1 stands for what is no element.
    pub elements: Option<Vec<i32>>,
    /// Kinds of points, as whole numbers: points of one kind have one number.
    pub classes: Option<Vec<i32>>,
}

impl<const D: usize> PointSet<D> {
    /// The element number of a point that belongs to none.
    pub const CONTINUOUS: i32 = -1;

    /// Points without attributes.
    pub fn at(positions: Vec<Vector<D>>) -> Self {
        Self { positions, ..Self::default() }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// The smallest box around the points.
    pub fn bounds(&self) -> Bounds<D> {
        Bounds::around(self.positions.iter().copied())
    }

    /// The points of the given numbers with their attributes, in that order.
    ///
    /// # Panics
    /// When there is no point of such a number.
    pub fn selected(&self, numbers: &[usize]) -> Self {
        fn pick<T: Copy>(values: &[T], numbers: &[usize]) -> Vec<T> {
            numbers.iter().map(|&n| values[n]).collect()
        }
        Self {
            positions: pick(&self.positions, numbers),
            normals: self.normals.as_ref().map(|v| pick(v, numbers)),
            colours: self.colours.as_ref().map(|v| pick(v, numbers)),
            radii: self.radii.as_ref().map(|v| pick(v, numbers)),
            groups: self.groups.as_ref().map(|v| pick(v, numbers)),
            elements: self.elements.as_ref().map(|v| pick(v, numbers)),
            classes: self.classes.as_ref().map(|v| pick(v, numbers)),
        }
    }

    /// Checks that every attribute has one value for each point.
    ///
    /// # Errors
    /// [`Error::Input`] with the name of the first attribute that has not.
    pub fn check(&self, name: &str) -> Result<()> {
        let lengths = [
            ("normals", self.normals.as_ref().map(Vec::len)),
            ("colours", self.colours.as_ref().map(Vec::len)),
            ("radii", self.radii.as_ref().map(Vec::len)),
            ("groups", self.groups.as_ref().map(Vec::len)),
            ("elements", self.elements.as_ref().map(Vec::len)),
            ("classes", self.classes.as_ref().map(Vec::len)),
        ];
        match lengths.into_iter().find(|(_, length)| length.is_some_and(|n| n != self.len())) {
            None => Ok(()),
            Some((attribute, length)) => Err(Error::input(
                name,
                format!("{} {attribute} for {} points", length.unwrap_or_default(), self.len()),
                "give one value for each point, or leave the attribute out",
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_go_with_their_points() {
        let mut points = PointSet::at(vec![Vector::xy(0.0, 0.0), Vector::xy(1.0, 0.0), Vector::xy(4.0, 2.0)]);
        points.groups = Some(vec![7, 8, 9]);
        let some = points.selected(&[2, 0]);
        assert_eq!(some.groups, Some(vec![9, 7]));
        assert_eq!(some.bounds().size(), Vector::xy(4.0, 2.0));
        assert!(some.check("a").is_ok() && some.radii.is_none());
    }

    #[test]
    fn an_attribute_with_too_few_values_is_named() {
        let mut points = PointSet::at(vec![Vector::xy(0.0, 0.0); 2]);
        points.radii = Some(vec![1.0]);
        let message = points.check("a.ply").unwrap_err().to_string();
        assert!(message.contains("1 radii for 2 points"), "{message}");
    }
}
