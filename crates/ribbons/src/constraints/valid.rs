//! Which positions a piece may take [Zhou 2013 §1.3, §2 `findValidPositions`].

use std::ops::Range;

use arabesque_core::Vector;

use crate::{
    exemplar::bits::{Bits, ones},
    exemplar::strip::Strip,
    geometry::cage::Form,
};

/// Top left corner of a piece in the strip: in the middle of column `x`, at the upper side of row `y`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Position {
    pub(crate) x: u16,
    pub(crate) y: i16,
}

impl Position {
    /// Column and row.
    pub(crate) fn place(self) -> (i64, i64) {
        (self.x.into(), self.y.into())
    }
}

/// Offset of a pixel from a [`Position`].
pub(crate) type Offset = (i32, i32);

/// What is asked of a piece beside its form.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Demands {
    /// Columns that its left edge may lie in.
    pub(crate) columns: Vec<Range<usize>>,
    /// Rows that its top left corner may lie in, when they are limited.
    pub(crate) rows: Option<Range<i64>>,
    /// Pixels on which no ink may fall, in rising order.
    pub(crate) forbidden: Vec<Offset>,
    /// Whether the left edge may be empty: the beginning of a curve that is drawn with its end.
    pub(crate) loose_left: bool,
    /// The same of the right edge.
    pub(crate) loose_right: bool,
}

/// How strictly positions are judged: each grade forgives more than the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Grade {
    /// All rules hold.
    Whole,
    /// Ink may fall on forbidden pixels, where it is not drawn.
    Forbidden,
    /// The pattern may be cut by the border of the ribbon.
    Cut,
    /// Whatever lies in the exemplar.
    Any,
}

impl Grade {
    pub(crate) const ALL: [Self; 4] = [Self::Whole, Self::Forbidden, Self::Cut, Self::Any];
}

/// The pixels that one rule looks at.
struct Lines {
    touch: Vec<Offset>,
    left: Vec<Offset>,
    right: Vec<Offset>,
}

/// Valid positions of a piece of form `form`, in rising order of x, then y.
pub(crate) fn positions(strip: &Strip, form: &Form, demands: &Demands, grade: Grade) -> Vec<Position> {
    let Some(lines) = lines(form) else { return Vec::new() };
    let rows = form.rows() as i64;
    let all = -rows..strip.height as i64;
    let heights = demands.rows.as_ref().map_or(all.clone(), |r| r.start.max(all.start)..r.end.min(all.end));
    let room = room(strip, form, &demands.columns);
    let mut found = Vec::new();
    let mut line = vec![0; strip.ink.words()];
    for y in heights {
        line.copy_from_slice(&room);
        if grade < Grade::Any && !demands.loose_left {
            keep(&mut line, &any(&strip.ink, &lines.left, y));
        }
        if grade < Grade::Any && !demands.loose_right {
            keep(&mut line, &any(&strip.ink, &lines.right, y));
        }
        if grade < Grade::Cut {
            remove(&mut line, &any(&strip.ink, &lines.touch, y));
        }
        if grade < Grade::Forbidden && line.iter().any(|&w| w != 0) {
            remove(&mut line, &any(&strip.trace, &demands.forbidden, y));
        }
        found.extend(ones(&line).map(|x| Position { x: x as u16, y: y as i16 }));
    }
    found.sort_unstable();
    found
}

/// Where any of `offsets` meets a pixel of `ink`, for all x of the row `y`.
fn any(ink: &Bits, offsets: &[Offset], y: i64) -> Vec<u64> {
    let mut line = vec![0; ink.words()];
    for &(dx, dy) in offsets {
        ink.add_row(y + i64::from(dy), i64::from(dx), &mut line);
    }
    line
}

fn keep(line: &mut [u64], other: &[u64]) {
    line.iter_mut().zip(other).for_each(|(a, b)| *a &= b);
}

fn remove(line: &mut [u64], other: &[u64]) {
    line.iter_mut().zip(other).for_each(|(a, b)| *a &= !b);
}

/// The columns of the left edge for which the whole piece lies in one exemplar.
fn room(strip: &Strip, form: &Form, columns: &[Range<usize>]) -> Vec<u64> {
    let bounds = form.bounds();
    let (least, most) = (bounds.min[0].floor() as i64, bounds.max[0].ceil() as i64);
    let mut line = vec![0; strip.ink.words()];
    for x in columns.iter().cloned().flatten().filter(|&x| x < strip.width) {
        let span = &strip.spans[strip.owner(x)];
        if x as i64 + least >= span.start as i64 && x as i64 + most < span.end as i64 {
            line[x / 64] |= 1 << (x % 64);
        }
    }
    line
}

/// The pixels along the edges of a piece. What lies beyond a fold must be as empty as the border.
fn lines(form: &Form) -> Option<Lines> {
    let [(l0, l1), (r0, r1)] = form.unfolded()?;
    let down = form.foot;
    let mut touch = Vec::new();
    if form.foot.cross(form.top) <= 0.0 {
        touch.extend(pixels(Vector::ZERO, form.top, 0.25));
    }
    if form.foot.cross(form.bottom) <= 0.0 {
        touch.extend(pixels(down, form.bottom, -0.25));
    }
    let right = |share: f64| form.top + (form.bottom - form.top) * share;
    for (from, to) in [(0.0, l0), (l1, 1.0)].into_iter().filter(|s| s.1 > s.0) {
        touch.extend(pixels(down * from, down * to, 0.0));
    }
    for (from, to) in [(0.0, r0), (r1, 1.0)].into_iter().filter(|s| s.1 > s.0) {
        touch.extend(pixels(right(from), right(to), 0.0));
    }
    let mut left = pixels(down * l0, down * l1, 0.0);
    let mut right = pixels(right(r0), right(r1), 0.0);
    for offsets in [&mut touch, &mut left, &mut right] {
        offsets.sort_unstable();
        offsets.dedup();
    }
    Some(Lines { touch, left, right })
}

/// The pixels along a line that is moved down by `lower`, two to a pixel's length.
fn pixels(from: Vector<2>, to: Vector<2>, lower: f64) -> Vec<Offset> {
    let n = ((to - from).norm() * 2.0).ceil().max(1.0);
    let at = |k: f64| from + (to - from) * (k / n) + Vector::xy(0.5, lower);
    (0..n as usize).map(|k| at(k as f64 + 0.5)).map(|p| (p[0].floor() as i32, p[1].floor() as i32)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exemplar::strip::StripExemplar;
    use arabesque_core::Image;

    /// A bar of ink in rows 8 to 11 of 20, 40 columns.
    fn bar() -> Strip {
        let mut image = Image::transparent(40, 20);
        for (k, pixel) in image.pixels.iter_mut().enumerate() {
            if (8..12).contains(&(k / 40)) {
                *pixel = [200, 10, 10, 255];
            }
        }
        Strip::new(&[StripExemplar::new(image)], 1)
    }

    fn rectangle(width: f64, height: f64) -> Form {
        Form::new(height, Vector::xy(width, 0.0), Vector::xy(width, height))
    }

    fn everywhere() -> Demands {
        Demands { columns: std::iter::once(0..40).collect(), ..Demands::default() }
    }

    #[test]
    fn the_pattern_passes_through_both_edges_and_touches_neither_border() {
        let found = positions(&bar(), &rectangle(10.0, 10.0), &everywhere(), Grade::Whole);
        let rows: Vec<i16> = found.iter().filter(|p| p.x == 0).map(|p| p.y).collect();
        assert_eq!(rows, [3, 4, 5, 6, 7]);
        assert_eq!(found.iter().map(|p| p.x).max(), Some(29));
        assert_eq!(found.len(), 5 * 30);
    }

    #[test]
    fn forbidden_pixels_stay_free() {
        let mut demands = everywhere();
        // With the two pixels around ink, rows 6 to 13 are taken.
        demands.forbidden = (0..10).map(|x| (x, 2)).collect();
        let found = positions(&bar(), &rectangle(10.0, 10.0), &demands, Grade::Whole);
        assert!(found.len() == 30 && found.iter().all(|p| p.y == 3));
        assert_eq!(positions(&bar(), &rectangle(10.0, 10.0), &demands, Grade::Forbidden).len(), 150);
    }

    #[test]
    fn a_ribbon_narrower_than_the_pattern_has_no_valid_position() {
        assert!(positions(&bar(), &rectangle(10.0, 3.0), &everywhere(), Grade::Whole).is_empty());
        assert!(!positions(&bar(), &rectangle(10.0, 3.0), &everywhere(), Grade::Cut).is_empty());
    }
}
