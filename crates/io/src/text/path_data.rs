//! Paths of cubics as SVG path data, with few characters.

use arabesque_core::{Cubic, Decimals, Path, Vector, segment};

/// Path data of a path: straight segments as `L`, those in one line merged, all others as `C`, a closed path with `Z`.
///
/// In space every point has three numbers.
pub fn path_data<const D: usize>(path: &Path<D>, decimals: Decimals) -> String {
    let Some(start) = path.start() else { return String::new() };
    let mut data = String::from("M");
    push(&mut data, &[start], decimals);
    let segments = merged(path, decimals.step());
    let last = segments.len().saturating_sub(1);
    for (k, segment) in segments.iter().enumerate() {
        match segment {
            // The closing line is drawn by `Z`.
            Segment::Line(_) if path.closed && k == last => {}
            Segment::Line(end) => {
                data.push('L');
                push(&mut data, &[*end], decimals);
            }
            Segment::Curve(c) => {
                data.push('C');
                push(&mut data, &c[1..], decimals);
            }
        }
    }
    if path.closed {
        data.push('Z');
    }
    data
}

enum Segment<const D: usize> {
    /// To its end.
    Line(Vector<D>),
    Curve(Cubic<D>),
}

/// Points that are merged into one line at most: each is looked at again for every further one.
const MERGED: usize = 64;

/// The segments of a path, lines in one direction merged where no point between is farther than `tolerance` from the
/// whole.
fn merged<const D: usize>(path: &Path<D>, tolerance: f64) -> Vec<Segment<D>> {
    let mut segments = Vec::new();
    // Where the last line starts, and the points on it.
    let mut line: Option<(Vector<D>, Vec<Vector<D>>)> = None;
    for c in &path.cubics {
        if !is_straight(c, tolerance) {
            line = None;
            segments.push(Segment::Curve(*c));
            continue;
        }
        match &mut line {
            Some((start, between))
                if between.len() < MERGED
                    && between.iter().all(|p| segment::distance((*start, c[3]), *p) <= tolerance) =>
            {
                between.push(c[3]);
                if let Some(Segment::Line(end)) = segments.last_mut() {
                    *end = c[3];
                }
            }
            _ => {
                line = Some((c[0], vec![c[3]]));
                segments.push(Segment::Line(c[3]));
            }
        }
    }
    segments
}

/// Whether a cubic runs along its chord within `tolerance`, forwards only.
pub(crate) fn is_straight<const D: usize>(c: &Cubic<D>, tolerance: f64) -> bool {
    c[1..3].iter().all(|&p| segment::distance((c[0], c[3]), p) <= tolerance)
}

fn push<const D: usize>(data: &mut String, points: &[Vector<D>], decimals: Decimals) {
    for (k, value) in points.iter().flat_map(|p| p.0).enumerate() {
        let start = data.len();
        decimals.push(data, value);
        if k > 0 && !data[start..].starts_with('-') {
            data.insert(start, ' ');
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn data(points: &[(f64, f64)], closed: bool) -> String {
        let points: Vec<_> = points.iter().map(|&(x, y)| Vector::xy(x, y)).collect();
        path_data(&Path { closed, ..Path::polyline(&points) }, Decimals::for_extent(1000.0))
    }

    #[test]
    fn lines_in_one_direction_are_one() {
        assert_eq!(data(&[(0.0, 0.0), (1.0, 0.0), (5.0, 0.0), (5.0, -2.5)], false), "M0 0L5 0L5-2.5");
        assert_eq!(data(&[(0.0, 0.0), (5.0, 0.0), (2.0, 0.0)], false), "M0 0L5 0L2 0", "there and back");
    }

    #[test]
    fn closed_paths_end_with_z_alone() {
        assert_eq!(data(&[(0.0, 0.0), (5.0, 0.0), (5.0, 4.0), (0.0, 0.0)], true), "M0 0L5 0L5 4Z");
    }

    #[test]
    fn bent_segments_keep_their_handles() {
        let c = [(0.0, 0.0), (1.0, 2.0), (3.0, 2.0), (4.0, 0.123_46)].map(|(x, y)| Vector::xy(x, y));
        let path = Path { cubics: vec![c], closed: false };
        assert_eq!(path_data(&path, Decimals::for_extent(1000.0)), "M0 0C1 2 3 2 4 0.123");
        assert_eq!(path_data(&Path::<2>::default(), Decimals::for_extent(1.0)), "");
    }

    #[test]
    fn paths_in_space_have_three_numbers_a_point() {
        let path = Path::polyline(&[Vector([0.0, 1.0, 2.0]), Vector([3.0, 4.0, 5.0])]);
        assert_eq!(path_data(&path, Decimals::for_extent(10.0)), "M0 1 2L3 4 5");
    }
}
