//! Triangle meshes.

use std::ops::Range;

use crate::{
    error::{Error, Result},
    space::{Bounds, Vector},
};

/// Triangles that share vertices. Seen from outside, the corners of a triangle come counter-clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// The vertices.
    pub positions: Vec<Vector<3>>,
    /// Three numbers of vertices each.
    pub triangles: Vec<[u32; 3]>,
    /// Directions of length 1 at the vertices, outwards; `None` where nobody said.
    pub normals: Option<Vec<Vector<3>>>,
    /// Red, green and blue at the vertices, each in [0, 1].
    pub colours: Option<Vec<[f64; 3]>>,
    /// Parts with names, as runs of triangles in their order; empty where the mesh is one thing.
    pub parts: Vec<MeshPart>,
}

/// A named part of a mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshPart {
    /// What the file calls it.
    pub name: String,
    /// Its triangles.
    pub triangles: Range<usize>,
}

impl TriangleMesh {
    /// The smallest box around the vertices.
    pub fn bounds(&self) -> Bounds<3> {
        Bounds::around(self.positions.iter().copied())
    }

    /// The three corners of a triangle.
    ///
    /// # Panics
    /// When there is no such triangle.
    pub fn corners(&self, triangle: usize) -> [Vector<3>; 3] {
        self.triangles[triangle].map(|v| self.positions[v as usize])
    }

    /// Area of the triangle times two, along its normal.
    ///
    /// # Panics
    /// When there is no such triangle.
    pub fn double_area(&self, triangle: usize) -> Vector<3> {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// Checks that triangles refer to vertices, attributes have one value for each vertex, and parts lie within the triangles.
    ///
    /// # Errors
    /// [`Error::Input`] with the first thing that is wrong.
    pub fn check(&self, name: &str) -> Result<()> {
        let vertices = self.positions.len();
        let fail =
            |problem: String| Err(Error::input(name, problem, "write the mesh again from the program it came from"));
        if let Some(k) = self.triangles.iter().position(|t| t.iter().any(|&v| v as usize >= vertices)) {
            return fail(format!("triangle {} has a corner that is none of the {vertices} vertices", k + 1));
        }
        let lengths = [self.normals.as_ref().map(Vec::len), self.colours.as_ref().map(Vec::len)];
        if let Some(length) = lengths.into_iter().flatten().find(|&n| n != vertices) {
            return fail(format!("{length} values of an attribute for {vertices} vertices"));
        }
        match self.parts.iter().find(|p| p.triangles.end > self.triangles.len()) {
            None => Ok(()),
            Some(part) => fail(format!("part {} has more triangles than the mesh", part.name)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner() -> TriangleMesh {
        let positions = vec![Vector([0.0; 3]), Vector([2.0, 0.0, 0.0]), Vector([0.0, 1.0, 0.0])];
        TriangleMesh { positions, triangles: vec![[0, 1, 2]], ..TriangleMesh::default() }
    }

    #[test]
    fn counter_clockwise_faces_outwards() {
        assert_eq!(corner().double_area(0), Vector([0.0, 0.0, 2.0]));
        assert_eq!(corner().bounds().size(), Vector([2.0, 1.0, 0.0]));
    }

    #[test]
    fn what_does_not_fit_together_is_told() {
        let mut mesh = corner();
        assert!(mesh.check("a.obj").is_ok());
        mesh.triangles.push([0, 1, 3]);
        assert!(mesh.check("a.obj").unwrap_err().to_string().contains("triangle 2"));
        let mut mesh = corner();
        mesh.parts.push(MeshPart { name: "lid".into(), triangles: 0..2 });
        assert!(mesh.check("a.obj").unwrap_err().to_string().contains("lid"));
        let mut mesh = corner();
        mesh.colours = Some(vec![[0.0; 3]]);
        assert!(mesh.check("a.obj").is_err());
    }
}
