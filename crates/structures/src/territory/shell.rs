//! On meshes: bumps, waves, scales and whatever else has a surface below it.

use std::fmt;

use arabesque_core::{Bounds, Budget, Domain, Error, Matrix, Result, Vector};
use arabesque_surface::{Closest, DirectionField, MeshIndex, MeshReport, scatter, shell_grid};

use super::{Site, SitePlan, Territory};

/// Random stream of the sites: they are the same for every seed of a run.
const SITES: u64 = 0;

/// A layer on a mesh, open or closed. The direction of the exemplar that does not repeat is the normal, its first other one is where the
/// field leads; an exemplar that repeats along all three fills the layer as thick as `radius` says, to both sides.
pub struct Shell {
    mesh: MeshIndex,
    field: DirectionField,
    scale: f64,
    radius: f64,
    is_open: bool,
}

impl fmt::Debug for Shell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mesh, scale, radius, is_open, .. } = self;
        f.debug_struct("Shell")
            .field("triangles", &mesh.triangles())
            .field("scale", scale)
            .field("radius", radius)
            .field("is_open", is_open)
            .finish_non_exhaustive()
    }
}

impl Shell {
    /// A layer on the mesh that `report` tells of, along `field`; `scale` is the size of the pattern.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a scale or a radius that is not positive.
    pub fn new(mesh: MeshIndex, report: &MeshReport, field: DirectionField, [scale, radius]: [f64; 2]) -> Result<Self> {
        for (name, value) in [("scale", scale), ("radius", radius)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::parameter(name, value, "a positive number"));
            }
        }
        Ok(Self { mesh, field, scale, radius, is_open: report.open_edges.any() })
    }

    /// The pattern at a point of the mesh: the normal is the coordinate `up` of the exemplar.
    fn rotation(&self, at: &Closest, up: usize) -> Matrix<3> {
        let frame = self.field.frame(&self.mesh, at);
        let columns = [frame.tangent, frame.bitangent(), frame.normal];
        let mut rotation = Matrix::zero();
        for (k, column) in columns.into_iter().enumerate() {
            // In cyclic order, so that right-handed stays right-handed.
            let c = (up + 1 + k) % 3;
            (0..3).for_each(|r| rotation.0[r][c] = column[r]);
        }
        rotation
    }

    /// The coordinate of the exemplar that stands upright, and whether all three repeat.
    fn upright(plan: &SitePlan<3>) -> (usize, bool) {
        match (0..3).rev().find(|&k| !plan.base[k]) {
            Some(k) => (k, false),
            None => (2, true),
        }
    }
}

impl Territory<3> for Shell {
    fn sites(&self, plan: &SitePlan<3>, budget: &Budget) -> Result<Vec<Site<3>>> {
        let (up, is_solid) = Self::upright(plan);
        let (scale, step) = (self.scale, plan.step * self.scale);
        let site = |place: Vector<3>, at: &Closest, weight: f64| Site {
            place,
            rotation: self.rotation(at, up),
            scale,
            weight,
        };
        let mut sites: Vec<Site<3>> = if is_solid {
            let reach = self.radius + plan.margin * scale;
            let places = shell_grid(&self.mesh, step, reach, reach, budget)?;
            let near = self.mesh.closest_all(&places, budget)?;
            places.into_iter().zip(&near).map(|(place, at)| site(place, at, 1.0)).collect()
        } else {
            let found = scatter(&self.mesh, step, SITES, budget)?;
            let weight = self.mesh.area() / (found.len().max(1) as f64 * step * step);
            found.iter().map(|at| site(at.point, at, weight)).collect()
        };
        let bounds = self.mesh.bounds();
        sites.sort_by_cached_key(|site| (along_curve(site.place, &bounds), site.place.0.map(f64::to_bits)));
        Ok(sites)
    }

    fn contains(&self, p: Vector<3>, plan: &SitePlan<3>) -> bool {
        let (_, is_solid) = Self::upright(plan);
        let reach = if is_solid { self.radius } else { 1.5 * plan.thickness * self.scale + plan.step * self.scale };
        let Some(near) = self.mesh.closest_within(p, reach) else { return false };
        // Beside an open border the nearest point is on it, and not below.
        let offset = p - near.point;
        let beside = (offset - near.normal * near.normal.dot(offset)).norm();
        !self.is_open || beside <= 0.25 * plan.step * self.scale
    }

    fn surroundings(&self) -> Domain<3> {
        Domain::Box(self.mesh.bounds().grown(self.radius))
    }

    fn measure(&self, repeats: usize) -> f64 {
        if repeats == 3 { self.mesh.area() * 2.0 * self.radius } else { self.mesh.area() }
    }
}

/// The number of a place along a curve that fills a box, so that neighbours mostly have numbers near each other [Morton 1966].
pub(super) fn along_curve(p: Vector<3>, bounds: &Bounds<3>) -> u64 {
    const BITS: u32 = 16;
    let size = bounds.size().0.into_iter().fold(f64::MIN_POSITIVE, f64::max);
    let cell = |k: usize| ((p[k] - bounds.min[k]) / size * f64::from(1_u32 << BITS)).clamp(0.0, 65_535.0) as u64;
    let cells = [cell(0), cell(1), cell(2)];
    (0..BITS).fold(0, |code, bit| (0..3).fold(code, |code, k| code | (cells[k] >> bit & 1) << (3 * bit + k as u32)))
}
