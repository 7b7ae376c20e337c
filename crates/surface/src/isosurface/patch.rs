//! Triangles while a surface is made.

use arabesque_core::{TriangleMesh, Vector};

/// A vertex with what is known of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vertex {
    pub(crate) at: Vector<3>,
    pub(crate) normal: [f32; 3],
    /// How far beyond the border of the points: at 1 an open surface ends.
    pub(crate) beyond: f32,
    pub(crate) colour: [f32; 3],
}

impl Vertex {
    /// The vertex at a share of the way to another.
    pub(crate) fn towards(&self, other: &Self, share: f64) -> Self {
        let s = share as f32;
        let mix = |a: [f32; 3], b: [f32; 3]| std::array::from_fn(|k| a[k] + (b[k] - a[k]) * s);
        Self {
            at: self.at + (other.at - self.at) * share,
            normal: mix(self.normal, other.normal),
            beyond: self.beyond + (other.beyond - self.beyond) * s,
            colour: mix(self.colour, other.colour),
        }
    }

    /// The mean of several vertices.
    pub(crate) fn mean<'a>(vertices: impl Iterator<Item = &'a Self> + Clone) -> Option<Self> {
        // Each weighs one over how many there were so far.
        vertices
            .enumerate()
            .fold(None, |mean: Option<Self>, (k, v)| Some(mean.map_or(*v, |m| m.towards(v, 1.0 / (k as f64 + 1.0)))))
    }
}

/// Vertices and triangles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Patch {
    pub(crate) vertices: Vec<Vertex>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Patch {
    /// The patch without vertices that no triangle has.
    pub(crate) fn compact(self) -> Self {
        let mut number = vec![u32::MAX; self.vertices.len()];
        self.triangles.iter().flatten().for_each(|&v| number[v as usize] = 0);
        let mut vertices = Vec::with_capacity(self.vertices.len());
        for (v, vertex) in self.vertices.into_iter().enumerate() {
            if number[v] == 0 {
                number[v] = vertices.len() as u32;
                vertices.push(vertex);
            }
        }
        let triangles = self.triangles.into_iter().map(|t| t.map(|v| number[v as usize])).collect();
        Self { vertices, triangles }
    }

    /// Adds the patch to a mesh; colours go along where the mesh has some.
    pub(crate) fn append_to(self, mesh: &mut TriangleMesh) {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(self.vertices.iter().map(|v| v.at));
        let normals = mesh.normals.get_or_insert_with(Vec::new);
        normals.extend(self.vertices.iter().map(|v| Vector(v.normal.map(f64::from)).unit_or_zero()));
        if let Some(colours) = &mut mesh.colours {
            colours.extend(self.vertices.iter().map(|v| v.colour.map(|c| f64::from(c).clamp(0.0, 1.0))));
        }
        mesh.triangles.extend(self.triangles.iter().map(|t| t.map(|v| v + first)));
    }
}
