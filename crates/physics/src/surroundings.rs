//! What is around the elements and does not move.

use arabesque_core::{Bounds, Error, Result, TriangleMesh, Vector};

/// The half of space behind a plane, which elements do not enter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// A place on the plane.
    pub place: Vector<3>,
    /// Towards the elements.
    pub normal: Vector<3>,
}

/// On which side of a surface the elements are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Each on whichever side it is: sheets, open bowls.
    Either,
    /// In a closed mesh: a container. What is outside is pushed in.
    Inside,
    /// Where the normals point: the ground, or an obstacle. What is behind is pushed out.
    Outside,
}

/// A surface that elements do not pass.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Its triangles.
    pub mesh: TriangleMesh,
    /// Where the elements are.
    pub side: Side,
}

/// Floors, walls and containers.
#[derive(Clone, Debug, Default)]
pub struct Surroundings {
    /// Planes, each with everything on one side.
    pub walls: Vec<Wall>,
    /// Surfaces that elements do not pass.
    pub surfaces: Vec<Surface>,
    /// A box that the middles of elements stay in, where they may reach over its sides.
    pub middles: Option<Bounds<3>>,
}

impl Surroundings {
    /// A floor at this height.
    #[must_use]
    pub fn floor(mut self, axis: usize, height: f64) -> Self {
        let along = |length: f64| Vector(std::array::from_fn(|k| if k == axis { length } else { 0.0 }));
        self.walls.push(Wall { place: along(height), normal: along(1.0) });
        self
    }

    /// The six sides of a box that elements stay in.
    #[must_use]
    pub fn inside_box(mut self, bounds: &Bounds<3>) -> Self {
        for axis in 0..3 {
            let mut normal = Vector::ZERO;
            normal[axis] = 1.0;
            self.walls.push(Wall { place: bounds.min, normal });
            self.walls.push(Wall { place: bounds.max, normal: -normal });
        }
        self
    }

    pub(crate) fn check(&self) -> Result<()> {
        for (k, wall) in self.walls.iter().enumerate() {
            if !wall.place.is_finite() || !wall.normal.is_finite() || wall.normal.norm() < 1e-12 {
                let place = format!("wall {}", k + 1);
                return Err(Error::input(place, "its plane has no place or direction", "give it finite numbers"));
            }
        }
        for (k, Surface { mesh, .. }) in self.surfaces.iter().enumerate() {
            let name = format!("surface {}", k + 1);
            mesh.check(&name)?;
            if mesh.triangles.is_empty() || mesh.positions.iter().any(|p| !p.is_finite()) {
                return Err(Error::input(
                    name,
                    "the mesh has no triangles, or coordinates that are not numbers",
                    "mend it",
                ));
            }
        }
        if self.middles.is_some_and(|b| !(b.min.is_finite() && b.max.is_finite())) {
            return Err(Error::input("the box for middles", "its corners are not numbers", "give it finite numbers"));
        }
        Ok(())
    }
}
