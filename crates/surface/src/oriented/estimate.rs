//! Normals and spacing of points that come without.

use arabesque_core::{Budget, Error, Result, Vector};

use crate::cloud::{Neighbours, estimated};

/// Neighbours from which a normal is told.
const NEIGHBOURS: usize = 12;

/// Normals that were estimated.
#[derive(Clone, Debug)]
pub struct EstimatedNormals {
    /// Of length 1; each part of the points is turned outwards, and open sheets upwards.
    pub normals: Vec<Vector<3>>,
    /// Numbers of the points that lie alone.
    pub outliers: Vec<usize>,
    /// Parts of the points that hang together.
    pub parts: usize,
}

/// Normals from the places of points, at least four, all of them numbers.
///
/// # Errors
/// [`Error::NoResult`] for points along one line; [`Error::Limit`] when the work is used up.
pub fn estimated_normals(points: &[Vector<3>], budget: &Budget) -> Result<EstimatedNormals> {
    let neighbours = Neighbours::new(points, NEIGHBOURS, budget)?;
    let found = estimated(points, &neighbours, budget)?;
    if found.are_in_line {
        return Err(Error::no_result("all points lie along lines: there is no surface", "give points of a surface"));
    }
    Ok(EstimatedNormals { normals: found.normals, outliers: found.outliers, parts: found.parts })
}

/// Mean distance of a point to its neighbours on a surface: the side of the square that it stands for, of the point in the middle of some thousand
/// that are spread over the list. There is at least one point.
///
/// # Errors
/// [`Error::Limit`] when the work is used up.
pub fn spacing_of(points: &[Vector<3>], budget: &Budget) -> Result<f64> {
    Neighbours::usual_spacing(points, 6, budget)
}
