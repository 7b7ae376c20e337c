//! Where the output may lie.

use std::sync::Arc;

use crate::{
    region::Outline,
    space::{Bounds, Vector, periodic},
};

/// A set of points with a boundary.
pub trait Region<const D: usize>: Send + Sync + std::fmt::Debug {
    /// Smallest box around the region.
    fn bounds(&self) -> Bounds<D>;
    /// Area or volume.
    fn measure(&self) -> f64;
    /// Distance to the boundary: positive inside, negative outside.
    fn signed_distance(&self, p: Vector<D>) -> f64;
    /// The boundary point nearest to `p`.
    fn nearest_boundary(&self, p: Vector<D>) -> Vector<D>;
    /// The boundary as polygons, where the region is one of the plane. Default: `None`.
    fn outline(&self) -> Option<&Outline<D>> {
        None
    }
}

/// What elements stand on: a floor, or a mesh.
pub trait Ground<const D: usize>: Send + Sync + std::fmt::Debug {
    /// Height of a place over it.
    fn height(&self, p: Vector<D>) -> f64;
    /// The place over or under `p` at this height.
    fn at_height(&self, p: Vector<D>, height: f64) -> Vector<D>;
}

/// Where the output may lie.
#[derive(Clone, Debug)]
pub enum Domain<const D: usize> {
    /// An axis-aligned box: a page.
    Box(Bounds<D>),
    /// A box whose opposite sides are glued: a seamless tile.
    Torus(Bounds<D>),
    /// Any other region: a shape with holes, several shapes, a solid.
    Region(Arc<dyn Region<D>>),
}

impl<const D: usize> Domain<D> {
    /// Smallest box around the domain.
    pub fn bounds(&self) -> Bounds<D> {
        match self {
            Self::Box(b) | Self::Torus(b) => *b,
            Self::Region(r) => r.bounds(),
        }
    }

    /// Area or volume.
    pub fn measure(&self) -> f64 {
        match self {
            Self::Box(b) | Self::Torus(b) => b.measure(),
            Self::Region(r) => r.measure(),
        }
    }

    /// Distance to the boundary: positive inside, negative outside; infinite on a torus, which has none.
    pub fn signed_distance(&self, p: Vector<D>) -> f64 {
        match self {
            Self::Box(b) => b.signed_distance(p),
            Self::Torus(_) => f64::INFINITY,
            Self::Region(r) => r.signed_distance(p),
        }
    }

    /// Whether `p` lies in the domain.
    pub fn contains(&self, p: Vector<D>) -> bool {
        self.signed_distance(p) >= 0.0
    }

    /// The nearest point of the domain to `p`: `p` itself inside.
    pub fn nearest_inside(&self, p: Vector<D>) -> Vector<D> {
        match self {
            Self::Box(b) => b.clamp(p),
            Self::Torus(_) => p,
            Self::Region(r) if r.signed_distance(p) >= 0.0 => p,
            Self::Region(r) => r.nearest_boundary(p),
        }
    }

    /// The period of each coordinate on a torus.
    #[inline]
    pub fn period(&self) -> Option<Vector<D>> {
        match self {
            Self::Torus(b) => Some(b.size()),
            Self::Box(_) | Self::Region(_) => None,
        }
    }

    /// `to - from` by the shortest way, around the back on a torus.
    #[inline]
    pub fn offset(&self, from: Vector<D>, to: Vector<D>) -> Vector<D> {
        periodic::offset(from, to, self.period())
    }

    /// The border as polygons: `None` on a torus, which has none, and in space.
    pub fn outline(&self) -> Option<Outline<D>> {
        match self {
            Self::Box(b) if D == 2 => {
                let corners = [(0, 0), (1, 0), (1, 1), (0, 1)];
                let side = |k: usize, far: usize| if far == 1 { b.max[k] } else { b.min[k] };
                let corner =
                    |(x, y): (usize, usize)| Vector(std::array::from_fn(|k| side(k, if k == 0 { x } else { y })));
                Some(Outline { rings: vec![corners.map(corner).to_vec()] })
            }
            Self::Region(r) => r.outline().cloned(),
            Self::Box(_) | Self::Torus(_) => None,
        }
    }

    /// The representative of `p` inside the box of a torus; `p` itself elsewhere.
    #[inline]
    pub fn wrap(&self, p: Vector<D>) -> Vector<D> {
        match self {
            Self::Torus(b) => {
                let size = b.size();
                Vector(std::array::from_fn(|k| b.min[k] + (p[k] - b.min[k]).rem_euclid(size[k])))
            }
            Self::Box(_) | Self::Region(_) => p,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_torus_measures_around_the_back() {
        let d = Domain::Torus(Bounds::new(Vector::xy(0.0, 0.0), Vector::xy(10.0, 10.0)));
        assert_eq!(d.offset(Vector::xy(9.5, 1.0), Vector::xy(0.5, 1.0)), Vector::xy(1.0, 0.0));
        assert_eq!(d.wrap(Vector::xy(-1.0, 12.0)), Vector::xy(9.0, 2.0));
    }

    #[test]
    fn a_box_pulls_points_back_to_its_side() {
        let d = Domain::Box(Bounds::new(Vector::xy(0.0, 0.0), Vector::xy(4.0, 2.0)));
        assert_eq!(d.nearest_inside(Vector::xy(5.0, 1.0)), Vector::xy(4.0, 1.0));
        assert!((d.signed_distance(Vector::xy(7.0, 6.0)) + 5.0).abs() < 1e-12);
        assert_eq!(d.signed_distance(Vector::xy(1.0, 1.0)), 1.0);
    }

    fn plane() -> impl Strategy<Value = Vector<2>> {
        (-1e3..1e3, -1e3..1e3).prop_map(|(x, y)| Vector::xy(x, y))
    }

    proptest! {
        #[test]
        fn a_torus_knows_no_inside(a in plane(), b in plane(), w in 0.5..50.0, h in 0.5..50.0, i in -5..5, j in -5..5) {
            let size = Vector::xy(w, h);
            let d = Domain::Torus(Bounds::new(Vector::xy(-1.0, 2.0), Vector::xy(-1.0, 2.0) + size));
            let there = d.offset(a, b);
            // The same way back, never longer than half around, and the same for every copy of the points.
            prop_assert!((there + d.offset(b, a)).zip(size, |s, l| (s / l).round() * l - s).norm() < 1e-9);
            prop_assert!(there[0].abs() <= 0.5 * w + 1e-9 && there[1].abs() <= 0.5 * h + 1e-9);
            let copy = b + Vector::xy(w * f64::from(i), h * f64::from(j));
            prop_assert!(d.offset(b, copy).norm() < 1e-9 && d.offset(d.wrap(copy), b).norm() < 1e-9);
            prop_assert!(d.bounds().contains(d.wrap(a)));
            prop_assert!(d.offset(d.wrap(d.wrap(a)), a).norm() < 1e-9);
        }
    }
}
