//! Whether an element respects the border of the domain.

use arabesque_core::{Border, Bounds, Domain, Region, Similarity, Vector};

use crate::finish::clearance::{arrangement::PlacedFigure, figure::Figure};

/// Edges are followed along the border of a region down to this share of the element's radius.
const FINEST: f64 = 1e-3;

/// Holes of a region inside an element are looked for in a quadtree of this depth.
const HOLE_DEPTH: u32 = 5;

/// Ink may reach over the border by this share of the element's radius: rounding.
const ROUNDING: f64 = 1e-9;

/// A domain with its border rule.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BorderCheck<'a> {
    pub(crate) domain: &'a Domain<2>,
    pub(crate) border: Border,
}

impl BorderCheck<'_> {
    /// Whether `body`, which shows `figure`, may lie where it is.
    pub(crate) fn admits(&self, body: &PlacedFigure, figure: &Figure) -> bool {
        match self.border {
            Border::Cross => self.domain.contains(body.centre),
            Border::Clip => true,
            Border::Inside | Border::Turn => {
                self.domain.signed_distance(body.centre) >= body.radius || self.holds(body, figure)
            }
        }
    }

    /// About how many places have to be looked at for that.
    pub(crate) fn looks(&self, body: &PlacedFigure, figure: &Figure) -> u64 {
        let is_at_border = || self.domain.signed_distance(body.centre) < body.radius;
        match (self.border, self.domain) {
            (Border::Inside | Border::Turn, Domain::Region(_)) if is_at_border() => 4 * figure.complexity() as u64,
            _ => 0,
        }
    }

    /// Whether the ink lies wholly inside.
    fn holds(&self, body: &PlacedFigure, figure: &Figure) -> bool {
        let slack = ROUNDING * body.radius;
        match self.domain {
            Domain::Torus(_) => true,
            Domain::Box(page) => encloses(&page.grown(slack), &figure.placed_bounds(&body.place)),
            Domain::Region(region) => {
                let finest = (FINEST * body.radius).max(f64::MIN_POSITIVE);
                let cover = Cover { region: region.as_ref(), figure, back: body.place.inverse() };
                figure.placed_edges(&body.place).all(|(a, b)| self.holds_edge(a, b, finest, slack))
                    && cover.avoids_holes(&figure.placed_bounds(&body.place), HOLE_DEPTH)
            }
        }
    }

    /// Whether the edge lies inside: its half length fits into the distance of its middle from the border, or both
    /// halves lie inside.
    fn holds_edge(&self, a: Vector<2>, b: Vector<2>, finest: f64, slack: f64) -> bool {
        let (middle, half) = ((a + b) * 0.5, 0.5 * (b - a).norm());
        let depth = self.domain.signed_distance(middle) + slack;
        if depth >= half {
            return true;
        }
        depth >= 0.0
            && (half <= finest
                || (self.holds_edge(a, middle, finest, slack) && self.holds_edge(middle, b, finest, slack)))
    }
}

/// A figure over a region that holds all of its edges.
struct Cover<'a> {
    region: &'a dyn Region<2>,
    figure: &'a Figure,
    /// From the domain to the figure.
    back: Similarity<2>,
}

impl Cover<'_> {
    /// Whether no border of the region that is seen from `cell` lies under the figure.
    fn avoids_holes(&self, cell: &Bounds<2>, depth: u32) -> bool {
        let middle = cell.centre();
        let border = self.region.nearest_boundary(middle);
        if (border - middle).norm2() >= 0.25 * cell.size().norm2() {
            return self.region.signed_distance(middle) >= 0.0 || !self.covers(middle);
        }
        // A little beyond the border: the figure may touch the border from inside, but never reach over it.
        if self.covers(border + (border - middle) * 1e-6) {
            return false;
        }
        depth == 0 || quarters(cell).iter().all(|quarter| self.avoids_holes(quarter, depth - 1))
    }

    fn covers(&self, p: Vector<2>) -> bool {
        self.figure.covers(self.back.apply(p))
    }
}

fn quarters(cell: &Bounds<2>) -> [Bounds<2>; 4] {
    let (low, middle, high) = (cell.min, cell.centre(), cell.max);
    [
        Bounds::new(low, middle),
        Bounds::new(Vector::xy(middle[0], low[1]), Vector::xy(high[0], middle[1])),
        Bounds::new(Vector::xy(low[0], middle[1]), Vector::xy(middle[0], high[1])),
        Bounds::new(middle, high),
    ]
}

fn encloses(outer: &Bounds<2>, inner: &Bounds<2>) -> bool {
    outer.contains(inner.min) && outer.contains(inner.max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use arabesque_core::{FillRule, Outline, Shape, Similarity};
    use std::sync::Arc;

    fn ring(x: f64, y: f64, side: f64) -> Vec<Vector<2>> {
        vec![Vector::xy(x, y), Vector::xy(x + side, y), Vector::xy(x + side, y + side), Vector::xy(x, y + side)]
    }

    fn admits(domain: &Domain<2>, border: Border, x: f64, y: f64) -> bool {
        let outline = Outline { rings: vec![ring(-1.0, -1.0, 2.0)] };
        let figure = Figure::new(outline, Vector::ZERO, &arabesque_core::Budget::default()).unwrap();
        let body = PlacedFigure::new(0, &figure, Similarity::shift(Vector::xy(x, y)));
        BorderCheck { domain, border }.admits(&body, &figure)
    }

    #[test]
    fn a_square_in_the_corner_of_a_page() {
        let page = Domain::Box(Bounds::new(Vector::ZERO, Vector::splat(10.0)));
        assert!(admits(&page, Border::Inside, 1.0, 9.0));
        assert!(!admits(&page, Border::Inside, 0.9, 5.0));
        assert!(admits(&page, Border::Cross, 0.0, 5.0));
        assert!(!admits(&page, Border::Cross, -0.1, 5.0));
        assert!(admits(&page, Border::Clip, -0.9, 5.0));
    }

    #[test]
    fn an_edge_that_crosses_a_thin_hole_is_noticed_although_its_ends_are_inside() {
        let frame = Shape::new(&[ring(0.0, 0.0, 10.0), ring(4.9, 3.9, 0.2)], FillRule::EvenOdd).unwrap();
        let domain = Domain::Region(Arc::new(frame));
        assert!(!admits(&domain, Border::Inside, 5.0, 5.0));
        assert!(!admits(&domain, Border::Inside, 5.05, 3.0));
        assert!(admits(&domain, Border::Inside, 7.0, 7.0));
        assert!(admits(&domain, Border::Inside, 1.0, 1.0), "flush with the corner");
    }

    #[test]
    fn an_element_over_a_small_hole_is_not_inside() {
        let frame = Shape::new(&[ring(0.0, 0.0, 10.0), ring(4.5, 4.5, 0.1)], FillRule::EvenOdd).unwrap();
        let domain = Domain::Region(Arc::new(frame));
        assert!(!admits(&domain, Border::Inside, 5.0, 5.0));
        assert!(!admits(&domain, Border::Inside, 4.0, 4.0));
        assert!(admits(&domain, Border::Inside, 5.7, 5.0));
    }

    #[test]
    fn a_torus_has_no_border() {
        let tile = Domain::Torus(Bounds::new(Vector::ZERO, Vector::splat(10.0)));
        assert!(admits(&tile, Border::Inside, 0.0, 0.0));
    }
}
