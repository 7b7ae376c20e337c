//! The box that holds one period.

use kurbo::{Affine, Point, Rect, Vec2};

/// How far from an edge something may be that lies on it, as a share of the shorter side: numbers are written with few
/// digits.
const NEAR: f64 = 2e-3;
/// How far apart what goes on over an edge may be on both sides of it, in the same measure.
const APART: f64 = 1e-2;

/// The edges of a cell: left, right, top, bottom.
pub(crate) const SIDES: [usize; 4] = [0, 1, 2, 3];

/// One period, as a box in coordinates of its own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    pub(crate) frame: Rect,
    /// From its coordinates to those of the root.
    pub(crate) to_root: Affine,
}

impl Cell {
    /// Width and height.
    pub(crate) fn size(&self) -> [f64; 2] {
        [self.frame.width(), self.frame.height()]
    }

    /// What is nearer to an edge than this lies on it.
    pub(crate) fn near(&self) -> f64 {
        NEAR * self.frame.width().min(self.frame.height())
    }

    /// What is nearer to one another than this, beyond an edge, is one.
    pub(crate) fn apart(&self) -> f64 {
        APART * self.frame.width().min(self.frame.height())
    }

    /// Where an edge lies, on the axis across it.
    pub(crate) fn level(&self, side: usize) -> f64 {
        [self.frame.x0, self.frame.x1, self.frame.y0, self.frame.y1][side]
    }

    /// Where an edge begins and ends, along it.
    pub(crate) fn range(&self, side: usize) -> [f64; 2] {
        if side < 2 { [self.frame.y0, self.frame.y1] } else { [self.frame.x0, self.frame.x1] }
    }

    /// A place on an edge.
    pub(crate) fn on(&self, side: usize, along: f64) -> Point {
        if side < 2 { Point::new(self.level(side), along) } else { Point::new(along, self.level(side)) }
    }

    /// Whether a place lies on an edge.
    pub(crate) fn is_on(&self, side: usize, at: Point) -> bool {
        (across(side, at) - self.level(side)).abs() <= self.near()
    }

    /// The way that many cells to the right and down.
    pub(crate) fn shift(&self, tile: [i64; 2]) -> Vec2 {
        Vec2::new(tile[0] as f64 * self.frame.width(), tile[1] as f64 * self.frame.height())
    }
}

/// The edge opposite to one.
pub(crate) fn opposite(side: usize) -> usize {
    side ^ 1
}

/// The cell beyond an edge, from the one that it belongs to.
pub(crate) fn beyond(side: usize) -> [i64; 2] {
    [[-1, 0], [1, 0], [0, -1], [0, 1]][side]
}

/// A place along an edge.
pub(crate) fn along(side: usize, at: Point) -> f64 {
    if side < 2 { at.y } else { at.x }
}

/// A place across an edge.
pub(crate) fn across(side: usize, at: Point) -> f64 {
    if side < 2 { at.x } else { at.y }
}

/// How messages call an edge.
pub(crate) fn name(side: usize) -> &'static str {
    ["left", "right", "upper", "lower"][side]
}
