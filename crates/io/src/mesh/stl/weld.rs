//! Corners of triangles as vertices of a mesh: those of exactly the same coordinates are one.

use std::collections::HashMap;

use arabesque_core::{Budget, PointSet, Result, Vector, Warning};

use crate::geometry::{Cloud, Geometry, Polygons};

/// Work of one corner.
const PER_CORNER: u64 = 150;
/// Bytes of a vertex in the list and in the table.
const VERTEX_BYTES: usize = 96;

/// Triangles while they come together.
pub(super) struct Welded<'a> {
    budget: &'a Budget,
    positions: Vec<Vector<3>>,
    numbers: HashMap<[u64; 3], u32>,
    polygons: Polygons,
    /// Triangles whose corners run clockwise around the normal that the file gives.
    turned: usize,
}

impl<'a> Welded<'a> {
    pub(super) fn new(budget: &'a Budget) -> Self {
        Self { budget, positions: Vec::new(), numbers: HashMap::new(), polygons: Polygons::default(), turned: 0 }
    }

    /// Number of triangles so far.
    pub(super) fn len(&self) -> usize {
        self.polygons.len()
    }

    /// The triangles from here on belong to a part.
    pub(super) fn begin_part(&mut self, name: &str) {
        self.polygons.begin_part(name);
    }

    /// Adds a triangle with the normal that the file gives it, and the number that messages call it by.
    pub(super) fn push(&mut self, number: usize, normal: Vector<3>, corners: [Vector<3>; 3]) -> Result<()> {
        self.budget.spend(3 * PER_CORNER)?;
        let [a, b, c] = corners;
        if (b - a).cross(c - a).dot(normal) < 0.0 {
            self.turned += 1;
        }
        let corners = corners.map(|corner| self.vertex(corner));
        self.polygons.push(number, corners);
        Ok(())
    }

    fn vertex(&mut self, corner: Vector<3>) -> u32 {
        // Adding zero makes one of the two zeros.
        let key = corner.0.map(|c| (c + 0.0).to_bits());
        let next = self.positions.len() as u32;
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            self.positions.push(corner);
        }
        number
    }

    /// The mesh; `noun` is what the numbers of triangles count.
    pub(super) fn finish(self, (name, noun): (&str, &str), mut warnings: Vec<Warning>) -> Result<Geometry> {
        let _held = self.budget.hold("vertices of the mesh", self.positions.len().saturating_mul(VERTEX_BYTES))?;
        let cut = self.polygons.triangles((name, noun), &self.positions, self.budget)?;
        if self.turned > 0 {
            let message =
                format!("{name}: the normals of {} triangles point against the order of their corners", self.turned);
            warnings.push(Warning::new(
                message,
                "the order counts; turn the triangles where they come from if they are wrong",
            ));
        }
        warnings.extend(cut.warnings);
        // One part is the whole.
        let parts = if cut.parts.len() > 1 { cut.parts } else { Vec::new() };
        let points = Cloud::Space(PointSet::at(self.positions));
        Ok(Geometry { triangles: cut.triangles, parts, warnings, ..Geometry::of_points(points) })
    }
}
