//! The surface that points with normals stand for [Adamson 2004]: `n(x) . (x - a(x)) = 0`, with `a` the weighted mean of the points around `x` and
//! `n` that of their normals.
//!
//! Departure: points whose normals face away from those of the nearest one do not count, so that both sides of a thin sheet or wire are
//! surfaces of their own.

use arabesque_core::{Bounds, Budget, Held, Result, Vector};
use rayon::prelude::*;

use super::{grid::Grid, variation};

/// Steps of a projection at most.
const STEPS: usize = 4;
/// A projection that moves less than this share of the radius has arrived.
const ARRIVED: f64 = 1e-3;

/// Points with normals, prepared for questions about their surface.
#[derive(Debug)]
pub struct OrientedPoints {
    positions: Vec<Vector<3>>,
    normals: Vec<Vector<3>>,
    /// Radius in which points count.
    radius: f64,
    grid: Grid,
    /// Positions and normals, cell by cell, so that what lies together is read together.
    packed: Vec<(Vector<3>, Vector<3>)>,
    _held: Held,
}

/// A place on the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Where it is.
    pub point: Vector<3>,
    /// The normal there, of length 1.
    pub normal: Vector<3>,
    /// The number of a point beside it.
    pub nearest: usize,
}

impl OrientedPoints {
    /// Points with their normals, as many of one as of the other; `radius` is how far a point counts: two to three spacings.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Limit`] when memory or work are used up.
    pub fn new(positions: Vec<Vector<3>>, normals: Vec<Vector<3>>, radius: f64, budget: &Budget) -> Result<Self> {
        let held = budget.hold("points of a surface", positions.len() * 130)?;
        budget.spend(positions.len() as u64 * 30)?;
        let grid = Grid::new(&positions, 0.75 * radius);
        let packed = grid.order().iter().map(|&i| (positions[i as usize], normals[i as usize])).collect();
        Ok(Self { positions, normals, radius, grid, packed, _held: held })
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Where the points are.
    pub fn positions(&self) -> &[Vector<3>] {
        &self.positions
    }

    /// Their normals.
    pub fn normals(&self) -> &[Vector<3>] {
        &self.normals
    }

    /// The nearest point that is no farther than `reach` and fits, with its squared distance.
    pub fn nearest(&self, p: Vector<3>, reach: f64, fits: impl Fn(usize) -> bool) -> Option<(usize, f64)> {
        let order = self.grid.order();
        let distance2 = |k: usize| fits(order[k] as usize).then(|| (self.packed[k].0 - p).norm2());
        self.grid.nearest(p, reach, distance2).map(|(k, d2)| (order[k] as usize, d2))
    }

    /// Calls `visit` for all points within `reach` of `p`.
    pub fn around(&self, p: Vector<3>, reach: f64, mut visit: impl FnMut(usize, f64)) {
        let order = self.grid.order();
        self.grid.runs(&Bounds::new(p, p).grown(reach), |run| {
            for (&i, (at, _)) in order[run.clone()].iter().zip(&self.packed[run]) {
                let d2 = (*at - p).norm2();
                if d2 <= reach * reach {
                    visit(i as usize, d2);
                }
            }
        });
    }

    /// Calls `visit` for all points in a box.
    pub fn inside(&self, bounds: &Bounds<3>, mut visit: impl FnMut(usize)) {
        let order = self.grid.order();
        self.grid.runs(bounds, |run| {
            for (&i, (at, _)) in order[run.clone()].iter().zip(&self.packed[run]) {
                if bounds.contains(*at) {
                    visit(i as usize);
                }
            }
        });
    }

    /// Weighted mean of the points around `x` whose normals face as `side` does, and of their normals.
    fn mean(&self, x: Vector<3>, side: Vector<3>) -> Option<(Vector<3>, Vector<3>)> {
        let (mut a, mut n, mut sum) = (Vector::ZERO, Vector::ZERO, 0.0);
        let (r2, inverse) = (self.radius * self.radius, 1.0 / (self.radius * self.radius));
        self.grid.runs(&Bounds::new(x, x).grown(self.radius), |run| {
            for (at, normal) in &self.packed[run] {
                let d2 = (*at - x).norm2();
                if d2 <= r2 && normal.dot(side) > 0.0 {
                    let w = 1.0 - d2 * inverse;
                    let w = w * w * w;
                    a += *at * w;
                    n += *normal * w;
                    sum += w;
                }
            }
        });
        if sum < 1e-9 {
            return None;
        }
        Some((a * (1.0 / sum), n.unit_if_longer(1e-9 * sum)?))
    }

    /// Where the surface that faces as `way` does is met from a place beside it, along `way`, with its normal: one step of [`Self::hit`], for places
    /// that lie on the surface but for what its smoothness leaves out.
    pub fn beside(&self, x: Vector<3>, way: Vector<3>) -> Option<(Vector<3>, Vector<3>)> {
        let (a, n) = self.mean(x, way)?;
        let slope = n.dot(way);
        (slope > 0.1).then(|| (x + way * (n.dot(a - x) / slope), n))
    }

    /// Projects `x` onto the surface, if it is no farther than `reach`: along the mean normal, again and again until it stays. Only points that
    /// face as `side` does count, where that is given.
    pub fn project(&self, x: Vector<3>, reach: f64, side: Option<Vector<3>>) -> Option<Foot> {
        let order = self.grid.order();
        let distance2 = |k: usize| {
            let (at, normal) = self.packed[k];
            side.is_none_or(|s| normal.dot(s) > 0.0).then(|| (at - x).norm2())
        };
        let (nearest, d2) = self.grid.nearest(x, reach, distance2).map(|(k, d2)| (order[k] as usize, d2))?;
        let facing = self.normals[nearest];
        // From far away the first step leads from the nearest point.
        let mut y = if d2 > 0.25 * self.radius * self.radius { self.positions[nearest] } else { x };
        let mut normal = facing;
        for _ in 0..STEPS {
            let Some((a, n)) = self.mean(y, facing) else { break };
            let step = n.dot(y - a);
            y -= n * step;
            normal = n;
            if step.abs() < ARRIVED * self.radius {
                break;
            }
        }
        if (y - self.positions[nearest]).norm() > 1.5 * self.radius {
            (y, normal) = (self.positions[nearest], facing);
        }
        Some(Foot { point: y, normal, nearest })
    }

    /// Where the nearer of two rays from `x`, along `way` and against it, meets the surface on the side that faces as `way` does, if that is no
    /// farther than `reach`: a limited form of the intersection with rays [Adamson 2003].
    pub fn hit(&self, x: Vector<3>, way: Vector<3>, reach: f64) -> Option<Foot> {
        let nearest = self.ahead(x, way, (0.6 * self.radius).min(reach)).or_else(|| self.ahead(x, way, reach))?;
        let facing = self.normals[nearest];
        let mut t = (self.positions[nearest] - x).dot(way);
        let mut normal = facing;
        for _ in 0..STEPS {
            let (a, n) = self.mean(x + way * t, facing)?;
            let slope = n.dot(way);
            if slope < 0.1 {
                return None;
            }
            let next = n.dot(a - x) / slope;
            let moved = (next - t).abs();
            (t, normal) = (next, n);
            if moved < ARRIVED * self.radius {
                break;
            }
        }
        (t.abs() <= 1.2 * reach).then_some(Foot { point: x + way * t, normal, nearest })
    }

    /// The point nearest to both rays from `x`, no farther along them than `reach`.
    fn ahead(&self, x: Vector<3>, way: Vector<3>, reach: f64) -> Option<usize> {
        let across = 0.6 * self.radius;
        let ends = way * reach;
        let bounds = Bounds::around([x - ends, x + ends]).grown(across);
        let order = self.grid.order();
        let mut best: Option<(f64, u32)> = None;
        self.grid.runs(&bounds, |run| {
            for (&i, (at, normal)) in order[run.clone()].iter().zip(&self.packed[run]) {
                let d = *at - x;
                let along = d.dot(way);
                let aside2 = d.norm2() - along * along;
                if along.abs() > reach || aside2 > across * across || normal.dot(way) < 0.2 {
                    continue;
                }
                // A little more for what lies aside, so that the surface straight ahead wins.
                let far = along.abs() + aside2.max(0.0).sqrt();
                if best.is_none_or(|b| (far, i) < b) {
                    best = Some((far, i));
                }
            }
        });
        best.map(|(_, i)| i as usize)
    }

    /// How far the surface around each point is from a plane, as [`Self::variation`] has it.
    pub fn variations(&self) -> Vec<f32> {
        let order = self.grid.order();
        // What lies together is worked out together.
        let found: Vec<f32> = order.par_iter().with_min_len(256).map(|&i| self.variation(i as usize) as f32).collect();
        let mut variations = vec![0.0; order.len()];
        order.iter().zip(found).for_each(|(&i, v)| variations[i as usize] = v);
        variations
    }

    /// How far the surface around a point is from a plane: 0 on planes, a third at most [Pauly 2002].
    pub fn variation(&self, i: usize) -> f64 {
        let (at, facing) = (self.positions[i], self.normals[i]);
        let mut near = Vec::with_capacity(32);
        self.around(at, self.radius, |j, _| {
            if self.normals[j].dot(facing) > -0.2 {
                near.push(self.positions[j]);
            }
        });
        variation::variation(&near)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// A sphere of radius 1 around the origin.
    fn sphere(n: usize) -> OrientedPoints {
        let at = |k: usize| {
            let z = 1.0 - (2.0 * k as f64 + 1.0) / n as f64;
            let (angle, r) = (PI * (3.0 - 5.0_f64.sqrt()) * k as f64, (1.0 - z * z).sqrt());
            Vector([r * angle.cos(), r * angle.sin(), z])
        };
        let points: Vec<_> = (0..n).map(at).collect();
        OrientedPoints::new(points.clone(), points, 0.2, &Budget::default()).unwrap()
    }

    fn plane(height: f64) -> OrientedPoints {
        let at = |k: usize| Vector([(k % 40) as f64 * 0.1, (k / 40) as f64 * 0.1, height]);
        let points: Vec<_> = (0..1600).map(at).collect();
        OrientedPoints::new(points, vec![Vector([0.0, 0.0, 1.0]); 1600], 0.25, &Budget::default()).unwrap()
    }

    #[test]
    fn places_near_a_sphere_land_on_it() {
        let sphere = sphere(4000);
        for x in [Vector([1.2, 0.1, 0.3]), Vector([0.0, 0.7, 0.5]), Vector([-0.4, -0.9, 0.4])] {
            let foot = sphere.project(x, 1.0, None).unwrap();
            assert!((foot.point.norm() - 1.0).abs() < 0.01, "{foot:?}");
            assert!(foot.normal.dot(x.unit()) > 0.97, "{foot:?}");
            let (beside, normal) = sphere.beside(x.unit() * 1.02, x.unit()).unwrap();
            assert!((beside - x.unit()).norm() < 0.01 && normal.dot(x.unit()) > 0.99, "{beside:?}");
            let hit = sphere.hit(x, x.unit(), 0.5).unwrap();
            assert!((hit.point - x.unit()).norm() < 0.01, "{hit:?}");
        }
    }

    #[test]
    fn on_a_plane_projection_and_ray_are_exact() {
        let plane = plane(2.0);
        let x = Vector([1.83, 2.17, 2.4]);
        let foot = plane.project(x, 1.0, None).unwrap();
        assert!((foot.point - Vector([1.83, 2.17, 2.0])).norm() < 0.06, "{foot:?}");
        assert!((foot.point[2] - 2.0).abs() < 1e-12);
        let way = Vector([0.3, 0.0, 1.0]).unit();
        let hit = plane.hit(x, way, 1.0).unwrap();
        assert!((hit.point - (x - way * (0.4 / way[2]))).norm() < 1e-9, "{hit:?}");
        assert!(plane.hit(x, way, 0.3).is_none() && plane.project(x, 0.3, None).is_none());
    }

    #[test]
    fn sides_of_a_thin_sheet_are_told_apart() {
        let (a, b) = (plane(0.0), plane(0.05));
        let both = OrientedPoints::new(
            [a.positions(), b.positions()].concat(),
            [vec![Vector([0.0, 0.0, -1.0]); 1600], b.normals().to_vec()].concat(),
            0.25,
            &Budget::default(),
        )
        .unwrap();
        let x = Vector([1.83, 2.17, 0.02]);
        for (side, height) in [(1.0, 0.05), (-1.0, 0.0)] {
            let foot = both.project(x, 1.0, Some(Vector([0.0, 0.0, side]))).unwrap();
            assert!((foot.point[2] - height).abs() < 1e-9, "{foot:?}");
        }
    }

    #[test]
    fn planes_do_not_vary_and_spheres_do() {
        assert!(plane(1.0).variation(820) < 1e-12);
        let v = sphere(4000).variation(2000);
        assert!(v > 1e-4 && v < 0.05, "{v}");
    }

    #[test]
    fn the_nearest_point_is_that_of_an_exhaustive_search() {
        let sphere = sphere(500);
        for k in 0..200_u32 {
            let x =
                Vector([f64::from(k % 7) * 0.4 - 1.2, f64::from(k % 11) * 0.25 - 1.2, f64::from(k % 5) * 0.5 - 1.0]);
            let d2 = |i: usize| (sphere.positions()[i] - x).norm2();
            let best = (0..500).min_by(|&a, &b| d2(a).total_cmp(&d2(b)).then(a.cmp(&b))).unwrap();
            assert_eq!(sphere.nearest(x, 5.0, |_| true), Some((best, d2(best))));
            assert_eq!(sphere.nearest(x, 0.99 * d2(best).sqrt(), |_| true), None);
        }
    }
}
