//! Vertices at one place as one.

use std::collections::HashMap;

use arabesque_core::{TriangleMesh, Vector};

/// The mesh with one vertex for those of exactly the same coordinates and colour, and without the triangles that this leaves without
/// area. Files that keep sharp edges or seams of textures list the vertices there several times, which tears the mesh.
///
/// Where such vertices differ in their normals, the mesh has none.
pub fn welded(mesh: TriangleMesh) -> TriangleMesh {
    let mut numbers: HashMap<[u64; 6], u32> = HashMap::new();
    let mut kept = Vec::new();
    let mut number_of = Vec::with_capacity(mesh.positions.len());
    let mut smooth = true;
    for (v, position) in mesh.positions.iter().enumerate() {
        let colour = mesh.colours.as_ref().map_or([0.0; 3], |colours| colours[v]);
        let [[x, y, z], [r, g, b]] = [position.0, colour];
        // Adding zero makes one of the two zeros.
        let key = [x, y, z, r, g, b].map(|c| (c + 0.0).to_bits());
        let number = *numbers.entry(key).or_insert(kept.len() as u32);
        if number as usize == kept.len() {
            kept.push(v);
        } else if let Some(normals) = &mesh.normals {
            smooth &= (normals[v] - normals[kept[number as usize]]).norm() < 1e-6;
        }
        number_of.push(number);
    }
    if kept.len() == mesh.positions.len() {
        return mesh;
    }
    let mut parts = mesh.parts;
    let mut triangles = Vec::with_capacity(mesh.triangles.len());
    let mut count_before = Vec::with_capacity(mesh.triangles.len() + 1);
    for corners in &mesh.triangles {
        count_before.push(triangles.len());
        let [a, b, c] = corners.map(|v| number_of[v as usize]);
        if a != b && b != c && c != a {
            triangles.push([a, b, c]);
        }
    }
    count_before.push(triangles.len());
    for part in &mut parts {
        part.triangles = count_before[part.triangles.start]..count_before[part.triangles.end];
    }
    parts.retain(|part| !part.triangles.is_empty());
    let vectors = |list: Vec<Vector<3>>| kept.iter().map(|&v| list[v]).collect();
    TriangleMesh {
        normals: mesh.normals.filter(|_| smooth).map(vectors),
        colours: mesh.colours.map(|colours| kept.iter().map(|&v| colours[v]).collect()),
        positions: vectors(mesh.positions),
        triangles,
        parts,
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::MeshPart;

    use super::*;

    #[test]
    fn torn_edges_close_and_slivers_go() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-0.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mesh = TriangleMesh {
            positions: corners.map(|[x, y]| Vector([x, y, 0.0])).to_vec(),
            triangles: vec![[0, 3, 1], [0, 1, 2], [3, 4, 5]],
            normals: Some(vec![Vector([0.0, 0.0, 1.0]); 6]),
            parts: vec![
                MeshPart { name: "sliver".into(), triangles: 0..1 },
                MeshPart { name: "a".into(), triangles: 1..3 },
            ],
            ..TriangleMesh::default()
        };
        let mut sharp = mesh.clone();
        sharp.normals.as_mut().unwrap()[4] = Vector([1.0, 0.0, 0.0]);
        let mesh = welded(mesh);
        assert_eq!((mesh.positions.len(), &mesh.triangles), (4, &vec![[0, 1, 2], [0, 2, 3]]));
        assert_eq!(mesh.parts, [MeshPart { name: "a".into(), triangles: 0..2 }]);
        assert!(mesh.check("a").is_ok() && mesh.normals.is_some());
        assert!(welded(sharp).normals.is_none());
    }

    #[test]
    fn vertices_of_different_colours_stay_apart() {
        let mesh = TriangleMesh {
            positions: vec![Vector([0.0; 3]); 2],
            colours: Some(vec![[0.0; 3], [1.0, 0.0, 0.0]]),
            ..TriangleMesh::default()
        };
        assert_eq!(welded(mesh.clone()), mesh);
    }
}
