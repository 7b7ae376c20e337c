//! On a surface: the pattern lies on the triangles of a mesh, its base along them and its height along their normals.

use std::{collections::VecDeque, sync::Arc};

use arabesque_core::{Bounds, Budget, Domain, Error, Matrix, Result, ScalarField, Vector};
use arabesque_surface::{DirectionField, MeshIndex, scatter};

use super::{
    plan::{SitePlan, Territory},
    site::Site,
};
use crate::energy::links::neighbours;

/// Sites are drawn nearer to each other than they are in a grid of the same number.
const CLOSER: f64 = 0.85;
/// Stream of the places of sites.
const PLACES: u64 = 47;
/// What is on a surface leaves its point there along the normal, but for this share of the height, and this share of a step.
const SLANT: (f64, f64) = (0.6, 0.1);

/// The surroundings of a surface, open or closed.
#[derive(Clone, Debug)]
pub struct Shell {
    index: Arc<MeshIndex>,
    directions: Arc<DirectionField>,
    scale: ScalarField<3>,
    /// How far the pattern is turned from the directions, about the normals, in radians.
    turn: f64,
}

impl Shell {
    /// On the mesh of `index`, with the first direction of the pattern along `directions`, in sizes of `scale`.
    pub fn new(index: Arc<MeshIndex>, directions: Arc<DirectionField>, scale: ScalarField<3>) -> Self {
        Self { index, directions, scale, turn: 0.0 }
    }

    /// The same with the pattern turned by so many radians from the directions, counter-clockwise as seen from outside.
    pub fn turned(self, turn: f64) -> Self {
        Self { turn, ..self }
    }

    /// Turns frames half around where they are against those of their neighbours: a field of lines knows no forwards.
    fn agree(&self, sites: &mut [Site<3>], first: usize, step: f64, budget: &Budget) -> Result<()> {
        let places: Vec<_> = sites.iter().map(|s| s.place).collect();
        let around = neighbours(&places, 1.8 * step, &Domain::Box(self.index.bounds()), budget)?;
        let column = |s: &Site<3>, c: usize| Vector([s.rotation.0[0][c], s.rotation.0[1][c], s.rotation.0[2][c]]);
        let second = (first + 1) % 3;
        let mut seen = vec![false; sites.len()];
        for start in 0..sites.len() {
            if std::mem::replace(&mut seen[start], true) {
                continue;
            }
            let mut queue = VecDeque::from([start]);
            while let Some(q) = queue.pop_front() {
                for &next in around.of(q) {
                    let next = next as usize;
                    let upright = column(&sites[q], (first + 2) % 3).dot(column(&sites[next], (first + 2) % 3));
                    if seen[next] || upright < 0.0 {
                        continue;
                    }
                    seen[next] = true;
                    if column(&sites[q], first).dot(column(&sites[next], first)) < 0.0 {
                        let rotation = &mut sites[next].rotation;
                        for row in &mut rotation.0 {
                            (row[first], row[second]) = (-row[first], -row[second]);
                        }
                    }
                    queue.push_back(next);
                }
            }
        }
        Ok(())
    }
}

impl Territory<3> for Shell {
    fn sites(&self, plan: &SitePlan<3>, budget: &Budget) -> Result<Vec<Site<3>>> {
        let Some(across) = (0..3).find(|&k| !plan.base[k]).filter(|_| plan.base.iter().filter(|b| **b).count() == 2)
        else {
            return Err(Error::Unsupported {
                what: "a structure on a surface that repeats along other than two directions".into(),
                advice: "give an exemplar that is a sheet, say repeats=2, or use --inside or --along".into(),
            });
        };
        let (smallest, _) = self.scale.range();
        if !(smallest > 0.0 && smallest.is_finite()) {
            return Err(Error::parameter("scale", smallest, "a positive number everywhere"));
        }
        // In cyclic order, so that right-handed stays right-handed.
        let first = (across + 1) % 3;
        let places = scatter(&self.index, CLOSER * plan.step * smallest, PLACES, budget)?;
        let share = self.index.area() / places.len().max(1) as f64;
        let (sin, cos) = self.turn.sin_cos();
        let site = |at: &arabesque_surface::Closest| {
            let frame = self.directions.frame(&self.index, at);
            let (along, beside) = (frame.tangent, frame.bitangent());
            let columns = [along * cos + beside * sin, beside * cos - along * sin, frame.normal];
            let mut rotation = Matrix::zero();
            for (k, column) in columns.iter().enumerate() {
                (0..3).for_each(|r| rotation.0[r][(first + k) % 3] = column[r]);
            }
            let scale = self.scale.at(at.point);
            // The pattern's base passes through the surface.
            let weight = share / (plan.step * scale).powi(2);
            Site { place: at.point, rotation, scale, weight }
        };
        let mut sites: Vec<Site<3>> = places.iter().map(site).collect();
        self.agree(&mut sites, first, plan.step * smallest, budget)?;
        Ok(sites)
    }

    fn contains(&self, p: Vector<3>, plan: &SitePlan<3>) -> bool {
        let at = self.index.closest(p);
        let offset = p - at.point;
        let height = offset.dot(at.normal);
        let beside = (offset - at.normal * height).norm();
        beside <= SLANT.0 * height.abs() + SLANT.1 * plan.step * self.scale.at(at.point)
    }

    fn surroundings(&self) -> Domain<3> {
        Domain::Box(self.index.bounds())
    }

    fn measure(&self, _: usize) -> f64 {
        self.index.area()
    }

    fn bounds(&self) -> Bounds<3> {
        self.index.bounds()
    }
}
