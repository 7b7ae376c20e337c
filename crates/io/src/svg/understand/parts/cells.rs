//! Closed outlines that share edges with their neighbours, as the cells of one net: each edge once.
//!
//! All edges of closed curves of one style are cut where corners of others lie on them; of edges that lie on one another,
//! also shifted by rounding, one stays. What is left is chained from junction to junction.

use std::collections::{BTreeMap, BTreeSet};

use arabesque_core::{Bounds, Budget, Cubic, Curve, Path, Result, Vector, cubic_at, cubic_part, straight};

/// How far apart edges may lie that are one, as shares of the stroke width and of the diagonal of the window.
const OFF_WIDTH: f64 = 0.3;
const OFF_WINDOW: f64 = 1.5e-3;
/// The same as a share of the median edge.
const OFF_EDGE: f64 = 0.15;
/// Work for an edge, and for looking at a place.
const EDGE: u64 = 200;
const LOOK: u64 = 20;

/// An edge of a closed outline, between two numbered places.
struct Piece {
    cubic: Cubic<2>,
    ends: [usize; 2],
    /// Which curve it is from.
    home: usize,
}

/// For each curve what is left of it, in the order of the curves: `None` where it stays as it is. `may_share` says which
/// curves of equal style may be cells.
///
/// # Errors
/// As [`Budget::spend`].
pub(crate) fn shared_once(
    curves: &[Curve<2>],
    may_share: impl Fn(usize) -> bool,
    window: &Bounds<2>,
    budget: &Budget,
) -> Result<Vec<Option<Vec<Path<2>>>>> {
    let mut rest: Vec<Option<Vec<Path<2>>>> = vec![None; curves.len()];
    let mut styles: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (k, curve) in curves.iter().enumerate().filter(|(k, curve)| curve.path.closed && may_share(*k)) {
        styles.entry(curve.style).or_default().push(k);
    }
    for members in styles.into_values().filter(|members| members.len() > 1) {
        let edges = members.iter().map(|&k| curves[k].path.cubics.len() as u64).sum::<u64>();
        budget.spend(EDGE * edges)?;
        let near = tolerance(curves, &members, window);
        let mut places = Places::new(near);
        let pieces = pieces(curves, &members, &mut places, budget)?;
        let (kept, sharing) = without_doubles(pieces, near);
        for home in &sharing {
            rest[*home] = Some(Vec::new());
        }
        for (home, path) in chained(kept, &sharing) {
            if let Some(paths) = &mut rest[home] {
                paths.push(path);
            }
        }
    }
    Ok(rest)
}

fn tolerance(curves: &[Curve<2>], members: &[usize], window: &Bounds<2>) -> f64 {
    let mut lengths: Vec<f64> =
        members.iter().flat_map(|&k| curves[k].path.cubics.iter().map(|c| (c[3] - c[0]).norm())).collect();
    lengths.sort_by(f64::total_cmp);
    let median = lengths.get(lengths.len() / 2).copied().unwrap_or(0.0);
    let width = members.first().map_or(0.0, |&k| curves[k].width);
    (OFF_WIDTH * width).min(OFF_WINDOW * window.size().norm()).min(OFF_EDGE * median).max(f64::MIN_POSITIVE)
}

/// Places, each found again by what lies near it.
struct Places {
    near: f64,
    at: Vec<Vector<2>>,
    cells: BTreeMap<[i64; 2], Vec<usize>>,
}

impl Places {
    fn new(near: f64) -> Self {
        Self { near, at: Vec::new(), cells: BTreeMap::new() }
    }

    fn cell(&self, p: Vector<2>) -> [i64; 2] {
        [0, 1].map(|k| (p[k] / (2.0 * self.near)).floor() as i64)
    }

    /// The number of the place at `p`.
    fn number(&mut self, p: Vector<2>) -> usize {
        let [x, y] = self.cell(p);
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x.saturating_add(i), y.saturating_add(j)]));
        let known = around.filter_map(|cell| self.cells.get(&cell)).flatten();
        let distance = |&&k: &&usize| (self.at[k] - p).norm();
        let nearest = known.filter(|k| distance(k) <= self.near);
        if let Some(&k) = nearest.min_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b))) {
            return k;
        }
        self.at.push(p);
        self.cells.entry([x, y]).or_default().push(self.at.len() - 1);
        self.at.len() - 1
    }
}

/// The edges of closed curves, straight ones cut where corners of others lie on them.
fn pieces(curves: &[Curve<2>], members: &[usize], places: &mut Places, budget: &Budget) -> Result<Vec<Piece>> {
    for &k in members {
        for cubic in &curves[k].path.cubics {
            places.number(cubic[0]);
        }
    }
    // Corners from left to right, so that those along an edge are soon found.
    let mut order: Vec<usize> = (0..places.at.len()).collect();
    order.sort_by(|&a, &b| places.at[a][0].total_cmp(&places.at[b][0]));
    let mut pieces = Vec::new();
    for &home in members {
        for &cubic in &curves[home].path.cubics {
            let shares = match is_straight(&cubic) {
                true => corners_along(&cubic, places, &order, budget)?,
                false => Vec::new(),
            };
            let cuts: Vec<f64> = [0.0].into_iter().chain(shares).chain([1.0]).collect();
            for span in cuts.windows(2) {
                let part = if cuts.len() == 2 { cubic } else { cubic_part(&cubic, span[0], span[1]) };
                let ends = [places.number(part[0]), places.number(part[3])];
                let (from, to) = (places.at[ends[0]], places.at[ends[1]]);
                if !is_straight(&part) {
                    pieces.push(Piece { cubic: [from, part[1], part[2], to], ends, home });
                } else if ends[0] != ends[1] {
                    pieces.push(Piece { cubic: straight(from, to), ends, home });
                }
            }
        }
    }
    Ok(pieces)
}

fn is_straight(c: &Cubic<2>) -> bool {
    let way = c[3] - c[0];
    let off = |p: Vector<2>, share: f64| (p - (c[0] + way * share)).norm() <= 1e-6 * way.norm();
    off(c[1], 1.0 / 3.0) && off(c[2], 2.0 / 3.0)
}

/// The shares of a straight edge at which corners lie on it, in rising order.
fn corners_along(cubic: &Cubic<2>, places: &Places, order: &[usize], budget: &Budget) -> Result<Vec<f64>> {
    let (from, way) = (cubic[0], cubic[3] - cubic[0]);
    let (low, high) = (from[0].min(cubic[3][0]) - places.near, from[0].max(cubic[3][0]) + places.near);
    let first = order.partition_point(|&k| places.at[k][0] < low);
    let length = way.norm();
    let mut shares = Vec::new();
    let mut looked = 0;
    for &k in order[first..].iter().take_while(|&&k| places.at[k][0] <= high) {
        looked += 1;
        let to = places.at[k] - from;
        let share = way.dot(to) / (length * length);
        let is_inside = (share * length) > 2.0 * places.near && (1.0 - share) * length > 2.0 * places.near;
        if is_inside && (way.cross(to) / length).abs() <= places.near {
            shares.push(share);
        }
    }
    budget.spend(LOOK * looked)?;
    shares.sort_by(f64::total_cmp);
    Ok(shares)
}

/// The pieces without those that lie on an earlier one, and the curves that share any.
fn without_doubles(pieces: Vec<Piece>, near: f64) -> (Vec<Piece>, BTreeSet<usize>) {
    let mut known: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
    let mut kept: Vec<Piece> = Vec::new();
    let mut sharing = BTreeSet::new();
    for piece in pieces {
        let [a, b] = piece.ends;
        let between = known.entry([a.min(b), a.max(b)]).or_default();
        let middle = cubic_at(&piece.cubic, 0.5);
        let same = between.iter().find(|&&k| (cubic_at(&kept[k].cubic, 0.5) - middle).norm() <= 2.0 * near);
        if let Some(&k) = same {
            if kept[k].home != piece.home {
                sharing.extend([kept[k].home, piece.home]);
            }
            continue;
        }
        between.push(kept.len());
        kept.push(piece);
    }
    (kept, sharing)
}

/// Pieces of the curves that share edges, chained through places where two meet and no more; each with the curve that it
/// starts in.
fn chained(pieces: Vec<Piece>, sharing: &BTreeSet<usize>) -> Vec<(usize, Path<2>)> {
    let pieces: Vec<Piece> = pieces.into_iter().filter(|piece| sharing.contains(&piece.home)).collect();
    let mut at: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (k, piece) in pieces.iter().enumerate() {
        piece.ends.iter().for_each(|&end| at.entry(end).or_default().push(k));
    }
    let mut used = vec![false; pieces.len()];
    let mut paths = Vec::new();
    // Chains start at junctions and ends; what is left are rings.
    let is_through = |place: usize| at.get(&place).is_some_and(|there| there.len() == 2);
    let starts = (0..pieces.len()).flat_map(|k| [(k, false), (k, true)]);
    let from_junctions = starts.filter(|&(k, turned)| !is_through(pieces[k].ends[usize::from(turned)]));
    let all: Vec<(usize, bool)> = from_junctions.chain((0..pieces.len()).map(|k| (k, false))).collect();
    for (first, turned) in all {
        if used[first] {
            continue;
        }
        let (mut k, mut turned, mut cubics) = (first, turned, Vec::new());
        let begin = pieces[k].ends[usize::from(turned)];
        let closed = loop {
            used[k] = true;
            let end = pieces[k].ends[usize::from(!turned)];
            cubics.push(if turned { reversed(&pieces[k].cubic) } else { pieces[k].cubic });
            if end == begin {
                break true;
            }
            let next = at.get(&end).filter(|_| is_through(end)).and_then(|there| there.iter().find(|&&n| !used[n]));
            let Some(&next) = next else { break false };
            turned = pieces[next].ends[1] == end;
            k = next;
        };
        paths.push((pieces[first].home, joined(cubics, closed)));
    }
    paths
}

fn reversed(c: &Cubic<2>) -> Cubic<2> {
    [c[3], c[2], c[1], c[0]]
}

/// A path whose cubics start exactly where those before end.
fn joined(mut cubics: Vec<Cubic<2>>, closed: bool) -> Path<2> {
    let n = cubics.len();
    for k in 1..n + usize::from(closed) {
        let end = cubics[k - 1][3];
        let next = &mut cubics[k % n];
        *next = if is_straight(next) { straight(end, next[3]) } else { [end, next[1], next[2], next[3]] };
    }
    Path { cubics, closed }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(corners: &[(f64, f64)]) -> Curve<2> {
        let points: Vec<_> = corners.iter().map(|&(x, y)| Vector::xy(x, y)).collect();
        let sides = (0..points.len()).map(|k| straight(points[k], points[(k + 1) % points.len()]));
        Curve { path: Path { cubics: sides.collect(), closed: true }, style: 0, width: 1.0, colour: [0.0; 3] }
    }

    fn left(cells: &[Curve<2>]) -> Vec<Option<Vec<Path<2>>>> {
        let window = Bounds::new(Vector::ZERO, Vector::xy(100.0, 100.0));
        shared_once(cells, |_| true, &window, &Budget::default()).unwrap()
    }

    fn length(paths: &[Option<Vec<Path<2>>>]) -> f64 {
        paths.iter().flatten().flatten().flat_map(|p| &p.cubics).map(|c| (c[3] - c[0]).norm()).sum()
    }

    #[test]
    fn a_side_of_two_squares_is_drawn_once_even_when_rounded() {
        let found = left(&[
            cell(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]),
            cell(&[(10.01, 0.0), (20.0, 0.0), (20.0, 10.0), (10.01, 9.99)]),
        ]);
        assert!((length(&found) - 70.0).abs() < 0.1);
        assert_eq!(found.iter().flatten().flatten().count(), 3, "from junction to junction");
    }

    #[test]
    fn bricks_in_bond_share_parts_of_their_sides() {
        let brick = |x: f64, y: f64| cell(&[(x, y), (x + 20.0, y), (x + 20.0, y + 10.0), (x, y + 10.0)]);
        let found = left(&[brick(0.0, 0.0), brick(20.0, 0.0), brick(10.0, 10.0)]);
        assert!((length(&found) - (180.0 - 10.0 - 20.0)).abs() < 1e-6, "{}", length(&found));
    }

    #[test]
    fn cells_apart_and_a_lone_cell_stay_as_they_are() {
        let apart = [cell(&[(0.0, 0.0), (9.0, 0.0), (0.0, 9.0)]), cell(&[(20.0, 0.0), (29.0, 0.0), (20.0, 9.0)])];
        assert!(left(&apart).iter().all(Option::is_none) && left(&apart[..1]).iter().all(Option::is_none));
    }
}
