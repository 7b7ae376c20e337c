//! Points to paths: straight runs as one segment, the rest as few smooth cubics.

use arabesque_core::{Cubic, Path, Vector, arc_lengths, cubic_at, polyline_length, straight};

/// Largest deviation of a fitted cubic, in widths.
const DEVIATION: f64 = 0.04;
/// Largest deviation of a straight run inside a bent stroke, in widths; and its least length.
const STRAIGHT: (f64, f64) = (0.02, 4.0);
/// Turn between two straight runs below which they are rather one wide bend, in radians.
const SAME_BEND: f64 = 0.15;
/// Rounds of fitting and improving the parameters.
const ROUNDS: usize = 6;

/// The path through points whose corners are marked; a closed one does not repeat its first point. Fewer than two
/// points have no path.
pub(super) fn fitted(points: &[(Vector<2>, bool)], closed: bool, width: f64) -> Path<2> {
    if points.len() < 2 {
        return Path { cubics: Vec::new(), closed };
    }
    let mut points = points.to_vec();
    if closed {
        let start = points.iter().position(|p| p.1).unwrap_or_else(|| most_bent(&points));
        points.rotate_left(start);
        points.extend(points.first().copied());
    }
    let smooth_seam = closed && points.first().is_some_and(|p| !p.1);
    let line: Vec<Vector<2>> = points.iter().map(|p| p.0).collect();
    let n = line.len();
    let seam = (smooth_seam && n > 3).then(|| (line[1] - line[n - 2]).unit_or_zero());
    let mut cuts: Vec<usize> = (1..n.saturating_sub(1)).filter(|&k| points[k].1).collect();
    cuts.insert(0, 0);
    cuts.push(n.saturating_sub(1));
    let mut cubics = Vec::new();
    for w in cuts.windows(2) {
        let ways = [seam.filter(|_| w[0] == 0), seam.filter(|_| w[1] == n - 1)];
        cubics.extend(stretch(&line[w[0]..=w[1]], ways, width));
    }
    Path { cubics, closed }
}

/// Where a closed line without corners bends most: there its seam hurts no straight run.
fn most_bent(points: &[(Vector<2>, bool)]) -> usize {
    let n = points.len();
    let bend = |k: usize| {
        let (a, b) = (points[k].0 - points[(k + n - 1) % n].0, points[(k + 1) % n].0 - points[k].0);
        a.angle_to(b).abs()
    };
    (0..n).max_by(|&a, &b| bend(a).total_cmp(&bend(b)).then(b.cmp(&a))).unwrap_or(0)
}

/// A stretch without corners, with given directions at its ends where they are known.
fn stretch(line: &[Vector<2>], ways: [Option<Vector<2>>; 2], width: f64) -> Vec<Cubic<2>> {
    let (Some(&first), Some(&last)) = (line.first(), line.last()) else { return Vec::new() };
    if line.len() < 2 || (last - first).norm() <= 1e-9 * width && line.len() < 4 {
        return Vec::new();
    }
    if is_straight(line, 0.5 * DEVIATION * width) {
        return vec![straight(first, last)];
    }
    let mut cubics = Vec::new();
    let runs = runs(line, width);
    let (mut from, mut way) = (0, ways[0]);
    for (a, b) in runs {
        let along = (line[b] - line[a]).unit_or_zero();
        if a > from {
            cubics.extend(smooth(&line[from..=a], [way, Some(along)], width));
        }
        cubics.push(straight(line[a], line[b]));
        (from, way) = (b, Some(along));
    }
    if from + 1 < line.len() {
        cubics.extend(smooth(&line[from..], [way, ways[1]], width));
    }
    cubics
}

/// Straight runs: first and last index of each.
fn runs(line: &[Vector<2>], width: f64) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    let mut from = 0;
    while let Some(least) = (from + 2..line.len()).find(|&k| (line[k] - line[from]).norm() >= STRAIGHT.1 * width) {
        let fits = |to: usize| is_straight(&line[from..=to], STRAIGHT.0 * width);
        if !fits(least) {
            from += 1;
            continue;
        }
        // The end is looked for in growing, then in shrinking steps.
        let (mut to, mut step) = (least, 1);
        while to + step < line.len() && fits(to + step) {
            to += step;
            step *= 2;
        }
        while step > 0 {
            if to + step < line.len() && fits(to + step) {
                to += step;
            }
            step /= 2;
        }
        found.push((from, to));
        from = to;
    }
    let bent = |k: usize| {
        let way = |k: usize| (line[found[k].1] - line[found[k].0]).unit_or_zero();
        let same = |i: usize, j: usize| found[j].0 - found[i].1 <= 2 && way(i).dot(way(j)) > SAME_BEND.cos();
        (k > 0 && same(k - 1, k)) || (k + 1 < found.len() && same(k, k + 1))
    };
    (0..found.len()).filter(|&k| !bent(k)).map(|k| found[k]).collect()
}

/// Whether the points run from the first to the last within `tolerance` of the line between them, not beyond it.
fn is_straight(line: &[Vector<2>], tolerance: f64) -> bool {
    let (Some(&a), Some(&b)) = (line.first(), line.last()) else { return true };
    let (way, length) = ((b - a).unit_or_zero(), (b - a).norm());
    line.iter().all(|&p| {
        let along = way.dot(p - a).clamp(0.0, length);
        (a + way * along - p).norm() <= tolerance
    })
}

/// Direction at the start of a line, from the parabola through its first points about a width apart.
fn start_way(line: &[Vector<2>], width: f64) -> Vector<2> {
    let far = |d: f64| line.iter().position(|p| (*p - line[0]).norm() >= d).unwrap_or(line.len() - 1);
    let (i, j) = (far(0.7 * width), far(1.4 * width));
    let (u, v) = (line[i] - line[0], line[j] - line[0]);
    let (s, t) = (u.norm(), v.norm());
    if j <= i || s <= 0.0 || t <= s {
        return v.unit_or_zero();
    }
    (u * (t / s) - v * (s / t)).unit_or_zero()
}

/// Fits cubics to a smooth line by least squares, and splits where one will not do.
fn smooth(line: &[Vector<2>], ways: [Option<Vector<2>>; 2], width: f64) -> Vec<Cubic<2>> {
    let n = line.len();
    if n < 2 {
        return Vec::new();
    }
    let start = ways[0].unwrap_or_else(|| start_way(line, width));
    let end = ways[1].unwrap_or_else(|| -start_way(&line.iter().rev().copied().collect::<Vec<_>>(), width));
    if n == 2 {
        let third = (line[1] - line[0]).norm() / 3.0;
        return vec![[line[0], line[0] + start * third, line[1] - end * third, line[1]]];
    }
    let (cubic, off, worst) = best_cubic(line, start, end);
    if off <= DEVIATION * width {
        return vec![cubic];
    }
    // Never at the very ends, so that halving bounds the depth.
    let split = worst.clamp((n / 8).max(1), n - 1 - (n / 8).max(1));
    let way = (line[split + 1] - line[split - 1]).unit_or_zero();
    let mut cubics = smooth(&line[..=split], [Some(start), Some(way)], width);
    cubics.extend(smooth(&line[split..], [Some(way), Some(end)], width));
    cubics
}

/// The cubic with given end directions nearest to the points, its deviation, and the point where that is largest.
fn best_cubic(line: &[Vector<2>], start: Vector<2>, end: Vector<2>) -> (Cubic<2>, f64, usize) {
    let mut parameters = chord_lengths(line);
    let mut best = (straight(line[0], line[line.len() - 1]), f64::INFINITY, line.len() / 2);
    for _ in 0..ROUNDS {
        let cubic = least_squares(line, &parameters, start, end);
        let (off, worst) = deviation(line, &parameters, &cubic);
        if off < best.1 {
            best = (cubic, off, worst);
        }
        for (t, &p) in parameters.iter_mut().zip(line) {
            *t = improved(&cubic, p, *t);
        }
    }
    best
}

fn chord_lengths(line: &[Vector<2>]) -> Vec<f64> {
    let sums = arc_lengths(line);
    let total = sums.last().copied().unwrap_or(0.0).max(f64::MIN_POSITIVE);
    sums.into_iter().map(|s| s / total).collect()
}

fn deviation(line: &[Vector<2>], parameters: &[f64], cubic: &Cubic<2>) -> (f64, usize) {
    let offs = parameters.iter().zip(line).map(|(&t, &p)| (cubic_at(cubic, t) - p).norm());
    offs.enumerate().fold((0.0, line.len() / 2), |best, (k, off)| if off > best.0 { (off, k) } else { best })
}

/// One step of Newton's method towards the parameter of the foot of `p`.
fn improved(c: &Cubic<2>, p: Vector<2>, t: f64) -> f64 {
    let u = 1.0 - t;
    let d = cubic_at(c, t) - p;
    let first = ((c[1] - c[0]) * (u * u) + (c[2] - c[1]) * (2.0 * u * t) + (c[3] - c[2]) * (t * t)) * 3.0;
    let second = ((c[2] - c[1] * 2.0 + c[0]) * u + (c[3] - c[2] * 2.0 + c[1]) * t) * 6.0;
    let slope = first.norm2() + d.dot(second);
    if slope.abs() < 1e-12 { t } else { (t - d.dot(first) / slope).clamp(0.0, 1.0) }
}

/// Handle lengths along the given directions by least squares; a third of the chord where they come out useless.
fn least_squares(line: &[Vector<2>], parameters: &[f64], start: Vector<2>, end: Vector<2>) -> Cubic<2> {
    let (a, b) = (line[0], line[line.len() - 1]);
    let (mut c00, mut c01, mut c11, mut x0, mut x1) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (&t, &p) in parameters.iter().zip(line) {
        let u = 1.0 - t;
        let (b0, b1, b2, b3) = (u * u * u, 3.0 * u * u * t, 3.0 * u * t * t, t * t * t);
        let (s, e) = (start * b1, -end * b2);
        let rest = p - (a * (b0 + b1) + b * (b2 + b3));
        c00 += s.dot(s);
        c01 += s.dot(e);
        c11 += e.dot(e);
        x0 += s.dot(rest);
        x1 += e.dot(rest);
    }
    let length = polyline_length(line);
    let determinant = c00 * c11 - c01 * c01;
    let (mut i, mut j) = ((x0 * c11 - x1 * c01) / determinant, (c00 * x1 - c01 * x0) / determinant);
    let useful = |h: f64| h.is_finite() && h > 1e-3 * length && h < 2.0 * length;
    if !useful(i) || !useful(j) {
        (i, j) = (length / 3.0, length / 3.0);
    }
    [a, a + start * i, b - end * j, b]
}
