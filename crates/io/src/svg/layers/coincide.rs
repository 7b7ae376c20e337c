//! Strokes of several paints on one line that is split differently in each: all are cut where one of them begins or ends,
//! so that pieces on the same geometry are there in every paint.

use arabesque_core::{Bounds, Budget, Domain, GridIndex, Measured, Path, Result, Vector, segment};

/// A line in one paint.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    pub(crate) path: Path<2>,
    /// Number of the paint.
    pub(crate) paint: usize,
    /// What it is, or is a piece of.
    pub(crate) origin: usize,
}

/// Places along a run of two lines at which they are compared.
const PLACES: usize = 16;

/// Two lines run along each other when they do so for this many times the distance that counts as none.
const SHORTEST: f64 = 40.0;

/// Work for each look at the ends near a chord, and for each place compared with each point.
const PRICE: (u64, u64) = (40, 4);

/// The end of an open line.
struct End {
    line: usize,
    at_start: bool,
    place: Vector<2>,
}

/// The lines, cut where lines of another paint that run along them begin or end. Those nearer to each other than `near`
/// are one.
///
/// # Errors
/// As [`Budget::spend`].
pub(crate) fn cut_alike(lines: Vec<Line>, near: f64, budget: &Budget) -> Result<Vec<Line>> {
    if lines.windows(2).all(|w| w[0].paint == w[1].paint) {
        return Ok(lines);
    }
    let measured: Vec<_> = lines.iter().map(|l| Measured::new(l.path.clone(), 0.2 * near)).collect();
    let ends: Vec<End> = (0..lines.len()).flat_map(|line| ends(line, &measured[line])).collect();
    if ends.is_empty() {
        return Ok(lines);
    }
    let places: Vec<_> = ends.iter().map(|e| e.place).collect();
    let around = Bounds::around(places.iter().copied());
    let cell = (around.size().norm() / (places.len() as f64).sqrt()).max(4.0 * near);
    let index = GridIndex::new(&places, cell, &Domain::Box(around));
    let mut out = Vec::with_capacity(lines.len());
    for (k, line) in lines.into_iter().enumerate() {
        let mut cuts = Vec::new();
        for (end, arc) in ends_on(&measured[k], &index, near, cell, budget)? {
            let end = &ends[end];
            let other = &measured[end.line];
            let inside = measured[k].is_closed() || (arc > 2.0 * near && arc < measured[k].length() - 2.0 * near);
            if end.line != k && inside && runs_along(&measured[k], arc, other, end.at_start, near, budget)? {
                cuts.push(arc);
            }
        }
        // The other lines are not looked at again: which paints there are is not known any more.
        out.extend(pieces(&measured[k], cuts, near).into_iter().map(|path| Line { path, ..line.clone() }));
    }
    Ok(out)
}

fn ends(line: usize, measured: &Measured<2>) -> Vec<End> {
    let points = measured.points();
    let (Some(&first), Some(&last), false) = (points.first(), points.last(), measured.is_closed()) else {
        return Vec::new();
    };
    vec![End { line, at_start: true, place: first }, End { line, at_start: false, place: last }]
}

/// The ends that lie on a line, with their arc lengths on it.
fn ends_on(
    line: &Measured<2>,
    index: &GridIndex<2>,
    near: f64,
    cell: f64,
    budget: &Budget,
) -> Result<Vec<(usize, f64)>> {
    let mut found: Vec<(usize, f64)> = Vec::new();
    let mut meter = budget.meter();
    for (k, w) in line.points().windows(2).enumerate() {
        let (chord, length) = ((w[0], w[1]), (w[1] - w[0]).norm());
        let steps = (length / cell).ceil().max(1.0) as usize;
        for step in 0..steps {
            let middle = w[0] + (w[1] - w[0]) * ((step as f64 + 0.5) / steps as f64);
            let looked = index.within(middle, 0.5 * length / steps as f64 + near, |end, offset| {
                let share = segment::nearest_share(chord, middle + offset);
                if segment::distance(chord, middle + offset) <= near && found.iter().all(|f| f.0 != end) {
                    found.push((end, line.arc_of(k) + share * length));
                }
            });
            meter.spend(PRICE.0 * (1 + looked))?;
        }
    }
    Ok(found)
}

/// Whether `other` runs along `line` from one of its ends at `arc`, as far as both go.
fn runs_along(
    line: &Measured<2>,
    arc: f64,
    other: &Measured<2>,
    from_start: bool,
    near: f64,
    budget: &Budget,
) -> Result<bool> {
    for forwards in [true, false] {
        let left = match (line.is_closed(), forwards) {
            (true, _) => line.length(),
            (false, true) => line.length() - arc,
            (false, false) => arc,
        };
        let run = left.min(other.length());
        if run < SHORTEST * near {
            continue;
        }
        budget.spend(PRICE.1 * (PLACES * line.points().len()) as u64)?;
        let is_on = |k: usize| {
            let way = run * k as f64 / PLACES as f64;
            let there = other.point(if from_start { way } else { other.length() - way });
            let here = line.point(line.wrap(if forwards { arc + way } else { arc - way }));
            // Lengths differ a little where the nodes do: it may lie before or behind the place, not beside it.
            (there - here).norm() <= near + 2e-3 * way && distance(there, line) <= near
        };
        if (1..=PLACES).all(is_on) {
            return Ok(true);
        }
    }
    Ok(false)
}

fn distance(p: Vector<2>, line: &Measured<2>) -> f64 {
    line.points().windows(2).map(|w| segment::distance((w[0], w[1]), p)).fold(f64::INFINITY, f64::min)
}

/// What is left of a line that is cut at some arc lengths.
fn pieces(line: &Measured<2>, mut cuts: Vec<f64>, near: f64) -> Vec<Path<2>> {
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|a, b| (*a - *b).abs() <= 2.0 * near);
    let length = line.length();
    if line.is_closed() && cuts.len() > 1 && cuts[0] + length - cuts[cuts.len() - 1] <= 2.0 * near {
        cuts.pop();
    }
    let (Some(&first), Some(&last)) = (cuts.first(), cuts.last()) else { return vec![line.path().clone()] };
    let between = cuts.windows(2).map(|w| line.part(w[0], w[1]));
    if line.is_closed() {
        return between.chain([line.part(last, first + length)]).collect();
    }
    std::iter::once(line.part(0.0, first)).chain(between).chain([line.part(last, length)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(paint: usize, points: &[(f64, f64)], closed: bool) -> Line {
        let points: Vec<_> = points.iter().map(|&(x, y)| Vector::xy(x, y)).collect();
        Line { path: Path { closed, ..Path::polyline(&points) }, paint, origin: paint }
    }

    fn counts(lines: Vec<Line>) -> Vec<usize> {
        let cut = cut_alike(lines, 0.01, &Budget::default()).unwrap();
        (0..2).map(|paint| cut.iter().filter(|l| l.paint == paint).count()).collect()
    }

    #[test]
    fn a_line_is_cut_where_the_pieces_of_another_paint_meet() {
        let whole = line(0, &[(0.0, 0.0), (100.0, 0.0)], false);
        let left = line(1, &[(0.0, 0.0), (40.0, 0.0)], false);
        let right = line(1, &[(100.0, 0.0), (40.0, 0.0)], false);
        assert_eq!(counts(vec![whole.clone(), left, right]), [2, 2]);
        let shifted = line(1, &[(30.0, 0.0), (130.0, 0.0)], false);
        assert_eq!(counts(vec![whole, shifted]), [2, 2]);
    }

    #[test]
    fn a_ring_is_cut_where_its_halves_meet() {
        let ring = line(0, &[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0), (0.0, 0.0)], true);
        let half = line(1, &[(10.0, 0.0), (10.0, 10.0), (0.0, 10.0)], false);
        let rest = line(1, &[(10.0, 0.0), (0.0, 0.0), (0.0, 10.0)], false);
        assert_eq!(counts(vec![ring, half, rest]), [2, 2]);
    }

    #[test]
    fn lines_that_only_meet_are_not_cut() {
        let street = line(0, &[(0.0, 0.0), (100.0, 0.0)], false);
        let side = line(1, &[(40.0, 0.0), (40.0, 50.0)], false);
        let merging = line(1, &[(40.0, 0.0), (60.0, 1.0), (100.0, 6.0)], false);
        assert_eq!(counts(vec![street, side, merging]), [1, 2]);
    }

    #[test]
    fn lines_in_one_paint_are_not_cut() {
        let lines = vec![line(0, &[(0.0, 0.0), (100.0, 0.0)], false), line(0, &[(0.0, 0.0), (40.0, 0.0)], false)];
        assert_eq!(counts(lines), [2, 0]);
    }
}
