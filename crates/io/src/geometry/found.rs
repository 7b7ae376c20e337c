//! What files of points and meshes hold.

use arabesque_core::{Error, MeshPart, PointSet, Result, TriangleMesh, Vector, Warning};

/// Points of a file, by dimension.
#[derive(Clone, Debug, PartialEq)]
pub enum Cloud {
    /// No `z`.
    Plane(PointSet<2>),
    /// With a `z`.
    Space(PointSet<3>),
}

impl Cloud {
    /// Number of points.
    pub fn len(&self) -> usize {
        match self {
            Self::Plane(points) => points.len(),
            Self::Space(points) => points.len(),
        }
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many normals have no length.
    pub(crate) fn zero_normals(&self) -> usize {
        match self {
            Self::Plane(points) => points.normals.iter().flatten().filter(|n| **n == Vector::ZERO).count(),
            Self::Space(points) => points.normals.iter().flatten().filter(|n| **n == Vector::ZERO).count(),
        }
    }
}

/// Points with attributes and, where the file has faces, the triangles between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// The points, or the vertices of the mesh. Normals have length 1, but for [`Geometry::zero_normals`] of them, which the file
    /// gives as zero.
    pub points: Cloud,
    /// Three numbers of points each; empty where the file holds points alone.
    pub triangles: Vec<[u32; 3]>,
    /// Parts with names, as runs of triangles in their order; empty where the mesh is one thing.
    pub parts: Vec<MeshPart>,
    /// How many points have a normal without a length.
    pub zero_normals: usize,
    /// What was left out, or read otherwise than it stands there.
    pub warnings: Vec<Warning>,
}

impl Geometry {
    /// Points alone.
    pub fn of_points(points: Cloud) -> Self {
        Self { points, triangles: Vec::new(), parts: Vec::new(), zero_normals: 0, warnings: Vec::new() }
    }

    /// Whether there are triangles.
    pub fn is_mesh(&self) -> bool {
        !self.triangles.is_empty()
    }

    /// The mesh; attributes that meshes do not have are left out, and normals where one of them has no length.
    ///
    /// # Errors
    /// [`Error::Input`] naming `name` where there are no triangles, or no `z`.
    pub fn into_mesh(self, name: &str) -> Result<TriangleMesh> {
        if !self.is_mesh() {
            let advice = "give a file of triangles, or make a surface of the points first";
            return Err(Error::input(name, "points without faces, where a mesh was expected", advice));
        }
        let points = self.into_points(name)?;
        let Self { triangles, parts, zero_normals, .. } = points.1;
        let points = points.0;
        let normals = points.normals.filter(|_| zero_normals == 0);
        Ok(TriangleMesh { positions: points.positions, triangles, normals, colours: points.colours, parts })
    }

    /// The points in space, and what is left without them.
    fn into_points(mut self, name: &str) -> Result<(PointSet<3>, Self)> {
        let empty = Cloud::Space(PointSet::at(Vec::new()));
        match std::mem::replace(&mut self.points, empty) {
            Cloud::Space(points) => Ok((points, self)),
            Cloud::Plane(_) => Err(Error::input(
                name,
                "points of two coordinates, where points in space were expected",
                "add a coordinate z, such as 0 everywhere",
            )),
        }
    }
}

impl From<TriangleMesh> for Geometry {
    fn from(mesh: TriangleMesh) -> Self {
        let TriangleMesh { positions, triangles, normals, colours, parts } = mesh;
        let points = Cloud::Space(PointSet { positions, normals, colours, ..PointSet::default() });
        Self { zero_normals: points.zero_normals(), triangles, parts, ..Self::of_points(points) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_alone_and_points_of_the_plane_are_no_mesh() {
        let plane = Geometry::of_points(Cloud::Plane(PointSet::at(vec![Vector::ZERO; 3])));
        let message = plane.clone().into_mesh("a.ply").unwrap_err().to_string();
        assert!(message.starts_with("a.ply: points without faces"), "{message}");
        let faces = Geometry { triangles: vec![[0, 1, 2]], ..plane };
        assert!(faces.into_mesh("a.ply").unwrap_err().to_string().contains("two coordinates"));
    }

    #[test]
    fn a_mesh_with_a_normal_of_no_length_has_none() {
        let mesh = TriangleMesh {
            positions: vec![Vector([0.0; 3]), Vector([1.0, 0.0, 0.0]), Vector([0.0, 1.0, 0.0])],
            triangles: vec![[0, 1, 2]],
            normals: Some(vec![Vector([0.0, 0.0, 1.0]), Vector::ZERO, Vector([0.0, 0.0, 1.0])]),
            ..TriangleMesh::default()
        };
        let geometry = Geometry::from(mesh.clone());
        assert_eq!((geometry.zero_normals, geometry.is_mesh()), (1, true));
        assert_eq!(geometry.into_mesh("a").unwrap(), TriangleMesh { normals: None, ..mesh });
    }
}
