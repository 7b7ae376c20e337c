//! Which positions a piece may take [Zhou 2013 §1.3, §2 `findValidPositions`].

use std::{ops::Range, sync::Arc};

use arabesque_core::{Budget, Meter, Result, Vector};

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

/// Offsets that are looked at before their work is counted.
const OFFSETS: usize = 64;

/// What is asked of a piece beside its form.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Demands {
    /// Columns that its left edge may lie in.
    pub(crate) columns: Vec<Range<usize>>,
    /// Rows that its top left corner may lie in, when they are limited.
    pub(crate) rows: Option<Range<i64>>,
    /// Pixels on which no ink may fall, in rising order.
    pub(crate) forbidden: Arc<Vec<Offset>>,
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

/// A piece for which positions are looked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Site<'a> {
    pub(crate) strip: &'a Strip,
    pub(crate) form: &'a Form,
    pub(crate) demands: &'a Demands,
    pub(crate) budget: &'a Budget,
}

impl Site<'_> {
    /// Valid positions, in rising order of x, then y.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Limit`] when there are too many, or the work is used up; [`arabesque_core::Error::Stopped`].
    pub(crate) fn positions(&self, grade: Grade) -> Result<Vec<Position>> {
        let (mut found, most) = (Vec::new(), self.budget.limits().candidates);
        self.each_row(self.demands.rows.as_ref(), grade, |y, line| {
            found.extend(ones(line).map(|x| Position { x: x as u16, y: y as i16 }));
            self.budget.within("places in the exemplar for one piece", found.len(), ("candidates", most))?;
            Ok(true)
        })?;
        found.sort_unstable();
        Ok(found)
    }

    /// Whether there is a valid position with the top left corner in `rows`.
    ///
    /// # Errors
    /// As [`Site::positions`].
    pub(crate) fn has_any(&self, rows: Option<&Range<i64>>, grade: Grade) -> Result<bool> {
        let mut any = false;
        self.each_row(rows, grade, |_, line| {
            any = line.iter().any(|&word| word != 0);
            Ok(!any)
        })?;
        Ok(any)
    }

    /// Shows the valid columns of each row to `visit`, which answers whether to go on.
    fn each_row(
        &self,
        rows: Option<&Range<i64>>,
        grade: Grade,
        mut visit: impl FnMut(i64, &[u64]) -> Result<bool>,
    ) -> Result<()> {
        let Self { strip, form, demands, budget } = *self;
        let mut meter = budget.meter();
        let room = room(strip, form, &demands.columns);
        // Without room the edges may be of any length, and need not be looked at.
        if room.iter().all(|&word| word == 0) {
            return Ok(());
        }
        let Some(lines) = lines(form) else { return Ok(()) };
        let all = -(form.rows() as i64)..strip.height as i64;
        let heights = rows.map_or(all.clone(), |r| r.start.max(all.start)..r.end.min(all.end));
        let mut line = vec![0; strip.ink.words()];
        for y in heights {
            line.copy_from_slice(&room);
            if grade < Grade::Any && !demands.loose_left {
                keep(&mut line, &any(&strip.ink, &lines.left, y, &mut meter)?);
            }
            if grade < Grade::Any && !demands.loose_right {
                keep(&mut line, &any(&strip.ink, &lines.right, y, &mut meter)?);
            }
            if grade < Grade::Cut {
                remove(&mut line, &any(&strip.ink, &lines.touch, y, &mut meter)?);
            }
            if grade < Grade::Forbidden && line.iter().any(|&w| w != 0) {
                remove(&mut line, &any(&strip.trace, &demands.forbidden, y, &mut meter)?);
            }
            if !visit(y, &line)? {
                break;
            }
        }
        Ok(())
    }
}

/// Where any of `offsets` meets a pixel of `ink`, for all x of the row `y`.
fn any(ink: &Bits, offsets: &[Offset], y: i64, meter: &mut Meter<'_>) -> Result<Vec<u64>> {
    let mut line = vec![0; ink.words()];
    for part in offsets.chunks(OFFSETS) {
        meter.spend((part.len() * (ink.words() + 1)) as u64)?;
        for &(dx, dy) in part {
            ink.add_row(y + i64::from(dy), i64::from(dx), &mut line);
        }
    }
    Ok(line)
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
        let (left, right) = ((x as i64).saturating_add(least), (x as i64).saturating_add(most));
        if left >= span.start as i64 && right < span.end as i64 {
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
    use arabesque_core::{Image, Limits};

    /// A bar of ink in rows 8 to 11 of 20, 40 columns.
    fn bar() -> Strip {
        let mut image = Image::transparent(40, 20);
        for (k, pixel) in image.pixels.iter_mut().enumerate() {
            if (8..12).contains(&(k / 40)) {
                *pixel = [200, 10, 10, 255];
            }
        }
        Strip::new(&[StripExemplar::new(image)], 1, &Budget::default()).unwrap()
    }

    fn positions(strip: &Strip, form: &Form, demands: &Demands, grade: Grade) -> Vec<Position> {
        let site = Site { strip, form, demands, budget: &Budget::default() };
        let found = site.positions(grade).unwrap();
        assert_eq!(site.has_any(demands.rows.as_ref(), grade).unwrap(), !found.is_empty());
        found
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
        demands.forbidden = Arc::new((0..10).map(|x| (x, 2)).collect());
        let found = positions(&bar(), &rectangle(10.0, 10.0), &demands, Grade::Whole);
        assert!(found.len() == 30 && found.iter().all(|p| p.y == 3));
        assert_eq!(positions(&bar(), &rectangle(10.0, 10.0), &demands, Grade::Forbidden).len(), 150);
    }

    #[test]
    fn a_ribbon_narrower_than_the_pattern_has_no_valid_position() {
        assert!(positions(&bar(), &rectangle(10.0, 3.0), &everywhere(), Grade::Whole).is_empty());
        assert!(!positions(&bar(), &rectangle(10.0, 3.0), &everywhere(), Grade::Cut).is_empty());
    }

    #[test]
    fn places_and_work_are_counted() {
        let (strip, form, demands) = (bar(), rectangle(10.0, 10.0), everywhere());
        let find =
            |budget: &Budget| Site { strip: &strip, form: &form, demands: &demands, budget }.positions(Grade::Whole);
        let few = Budget::new(Limits { candidates: 100, ..Limits::default() });
        assert!(find(&few).unwrap_err().to_string().contains("--limit candidates="));
        // A piece of any length without room is looked at no further.
        let endless = Form::new(10.0, Vector::xy(1e15, 0.0), Vector::xy(1e15, 10.0));
        assert!(positions(&strip, &endless, &demands, Grade::Any).is_empty());
    }
}
