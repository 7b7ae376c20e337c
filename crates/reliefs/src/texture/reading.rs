//! What is checked of the points of a texture, and made of them before it is understood.

use arabesque_core::{Bounds, Budget, Error, PointSet, Result, Vector, Warning};
use arabesque_surface::{OrientedPoints, estimated_normals};

use crate::{params::Plane, texture::axes::Axes};

/// Least points of a texture.
const LEAST: usize = 60;
/// A plane that is narrower than this share of the height is none.
const COLLAPSED: f64 = 1e-9;

/// Side of the columns in which sheets are told from what has two sides, and how high what is in one of a sheet may be, in spacings.
const COLUMN: f64 = 1.5;
const THICK: f64 = 4.0;
/// Share of the points of a sheet that lie in such columns.
const SHEET: f64 = 0.75;
/// Normals fall by more than this where the side of a sheet is wrong; the others stand at its steep places.
const DOWN: f64 = 0.3;

/// Share of neighbouring normals that may face opposite ways, and from which on it is told.
const REFUSED: f64 = 0.1;
const TOLD: f64 = 0.01;

/// A fault of the texture, whose name the caller knows.
pub(super) fn fail(problem: impl Into<String>, advice: impl Into<String>) -> Error {
    Error::input("the texture", problem.into(), advice.into())
}

/// Normals of the points; estimated where there are none, and outliers left out.
pub(super) fn oriented(points: &PointSet<3>, budget: &Budget, warnings: &mut Vec<Warning>) -> Result<PointSet<3>> {
    if let Some(normals) = &points.normals {
        let bad = normals.iter().filter(|n| !n.is_finite() || n.norm() < 1e-6).count();
        if bad > 0 {
            return Err(fail(
                format!("{bad} of {} normals have no direction", normals.len()),
                "write the points with all their normals, or without, so that they are estimated",
            ));
        }
        let mut points = points.clone();
        points.normals = Some(normals.iter().map(|n| n.unit()).collect());
        return Ok(points);
    }
    let found = estimated_normals(&points.positions, budget)?;
    let mut points = PointSet { normals: Some(found.normals), ..points.clone() };
    if !found.outliers.is_empty() {
        let message = format!("{} of {} points lie alone: left out", found.outliers.len(), points.len());
        warnings.push(Warning::new(message, "clean the scan if they belong to the texture"));
        let is_out: std::collections::BTreeSet<usize> = found.outliers.into_iter().collect();
        let kept: Vec<usize> = (0..points.len()).filter(|i| !is_out.contains(i)).collect();
        points = points.selected(&kept);
    }
    Ok(points)
}

/// Points with their normals as a surface, and the share of the normals that contradict one another. Estimated ones face up where the texture is a sheet.
pub(super) fn surface(
    positions: Vec<Vector<3>>,
    (normals, are_estimated): (Vec<Vector<3>>, bool),
    (spacing, radius): (f64, f64),
    budget: &Budget,
) -> Result<(OrientedPoints, f64)> {
    let facing = if are_estimated { face_up(&positions, &normals, spacing, budget)? } else { None };
    let surface = |normals| -> Result<(OrientedPoints, f64)> {
        let points = OrientedPoints::new(positions.clone(), normals, radius, budget)?;
        let share = contradictions(&points, radius, budget)?;
        Ok((points, share))
    };
    let found = surface(normals)?;
    let Some(facing) = facing else { return Ok(found) };
    // What is no sheet after all contradicts itself more when it faces up.
    let other = surface(facing)?;
    Ok(if other.1 <= found.1.max(TOLD) { other } else { found })
}

/// Normals that face up where the texture is one sheet over its plane, whose upper side is meant: nothing tells the sides of a scan apart, and the sides of
/// parts beyond a crack less still. What has something that faces up above it is the lower side of something, and stays. Points and normals are in the
/// plane; `None` where none is turned.
fn face_up(
    positions: &[Vector<3>],
    normals: &[Vector<3>],
    spacing: f64,
    budget: &Budget,
) -> Result<Option<Vec<Vector<3>>>> {
    let all = Bounds::around(positions.iter().copied());
    let [across, down, _] = all.size().0;
    // No more columns than points, wherever these lie.
    let count = positions.len() as f64;
    let cell = (COLUMN * spacing).max((across * down / count).sqrt()).max(across.max(down) / count);
    let (width, height) = ((across / cell) as usize + 1, (down / cell) as usize + 1);
    budget.spend((width * height + positions.len() * 20) as u64)?;
    let column = |p: Vector<3>| {
        let [x, y] = [0, 1].map(|k| ((p[k] - all.min[k]) / cell) as usize);
        y.min(height - 1) * width + x.min(width - 1)
    };
    // Lowest and highest of each column, and the highest that faces up.
    let mut columns = vec![(f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY); width * height];
    for (p, n) in positions.iter().zip(normals) {
        let (low, high, up) = &mut columns[column(*p)];
        (*low, *high) = (low.min(p[2]), high.max(p[2]));
        if n[2] > 0.0 {
            *up = up.max(p[2]);
        }
    }
    let is_flat = |p: &&Vector<3>| {
        let (low, high, _) = columns[column(**p)];
        high - low <= THICK * spacing
    };
    if (positions.iter().filter(is_flat).count() as f64) < SHEET * count {
        return Ok(None);
    }
    let is_wrong = |p: &Vector<3>, n: &Vector<3>| n[2] < -DOWN && columns[column(*p)].2 < p[2] + 0.5 * spacing;
    let mut turned = 0;
    let facing = positions.iter().zip(normals).map(|(p, n)| {
        let is_wrong = is_wrong(p, n);
        turned += usize::from(is_wrong);
        if is_wrong { -*n } else { *n }
    });
    let facing = facing.collect();
    Ok((turned > 0).then_some(facing))
}

/// What of normals contradicts itself: the share of points whose neighbours on the same sheet face the other way.
fn contradictions(points: &OrientedPoints, radius: f64, budget: &Budget) -> Result<f64> {
    let step = points.len().div_ceil(2000).max(1);
    let (mut all, mut against, mut meter) = (0_usize, 0_usize, budget.meter());
    for i in (0..points.len()).step_by(step) {
        meter.spend(1500)?;
        let (at, n) = (points.positions()[i], points.normals()[i]);
        points.around(at, 0.7 * radius, |j, d2| {
            let way = points.positions()[j] - at;
            let m = points.normals()[j];
            let is_flat = |n: Vector<3>| n.dot(way).powi(2) < 0.04 * d2;
            if j != i && is_flat(n) && is_flat(m) {
                all += 1;
                against += usize::from(n.dot(m) < -0.3);
            }
        });
    }
    Ok(against as f64 / all.max(1) as f64)
}

/// Refuses normals of which too large a share contradicts itself, and tells of fewer.
pub(super) fn told(share: f64, is_estimated: bool) -> Result<Option<Warning>> {
    let advice = if is_estimated {
        "give normals, or more points: what lies closer together than a few spacings is not told apart, and what fills a volume is no surface"
    } else {
        "if they are wrong, leave them out, so that they are estimated; two sides of something thin may be right; lower the heights of a picture"
    };
    let whose = if is_estimated { "neighbouring normals, which were estimated," } else { "neighbouring normals" };
    if share > REFUSED {
        return Err(fail(format!("{whose} face opposite ways"), advice));
    }
    let message = || format!("{:.1} % of {whose} face opposite ways", 100.0 * share);
    Ok((share > TOLD).then(|| Warning::new(message(), advice)))
}

/// The axis across the plane, and how the texture leans from it, without the points that were left out. Where the plane or its box are given, it is taken as it lies.
pub(super) fn axes(
    (points, kept): (&PointSet<3>, &[Vector<3>]),
    (plane, has_box, has_gap): (Plane, bool, bool),
    warnings: &mut Vec<Warning>,
) -> Result<Axes> {
    let thinnest = Axes::of(points, Plane::Auto).across_axis();
    let axes = Axes::of(points, plane);
    let level = axes.levelled(kept);
    let axis = axes.across_axis();
    let name = ["x", "y", "z"][axis];
    let is_levelled = plane == Plane::Auto && !has_box;
    if level != axes && !has_gap {
        let leans = format!("the texture leans by {:.1} degrees from the plane across {name}", level.lean());
        warnings.push(if is_levelled {
            Warning::new(format!("{leans}: laid flat"), format!("give --plane {name} if it is to be taken as it lies"))
        } else {
            Warning::new(leans, "leave --plane and --box out if it is to be laid flat, or turn it before")
        });
    }
    let axes = if is_levelled { level } else { axes };
    let flat = Bounds::around(kept.iter().map(|&p| axes.level(p))).size();
    if flat[0].min(flat[1]) <= COLLAPSED * flat[2] || flat[0].min(flat[1]) <= 0.0 {
        if plane == Plane::Auto {
            return Err(fail("all points lie on one line or at one place", "give points of a surface"));
        }
        return Err(fail(
            format!("the points have no extent across {name}"),
            "choose another plane with --plane, or leave it out",
        ));
    }
    if flat[2] > flat[0].min(flat[1]) {
        let (advice, other) =
            ("choose the plane along which the texture goes on with --plane", ["x", "y", "z"][thinnest]);
        let message = format!("the texture is higher across {name} than it is wide; it is thinnest across {other}");
        if thinnest != axis {
            return Err(fail(message, advice));
        }
        warnings.push(Warning::new(message, advice));
    }
    Ok(axes)
}

/// Checks that there are enough points and that they are numbers.
pub(super) fn checked<'a>(points: &'a PointSet<3>, budget: &Budget) -> Result<&'a PointSet<3>> {
    points.check("the texture")?;
    if let Some(k) = points.positions.iter().position(|p| !p.is_finite()) {
        return Err(fail(format!("point {} has a coordinate that is not a number", k + 1), "leave it out"));
    }
    if points.len() < LEAST {
        return Err(fail(
            format!("{} points are no texture", points.len()),
            format!("give at least {LEAST}, a few thousand for most textures"),
        ));
    }
    budget.within("points of the texture", points.len(), ("nodes", budget.limits().nodes))?;
    budget.spend(points.len() as u64 * 50)?;
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of points one apart, at a height and facing a way by place.
    fn square(of: impl Fn(f64, f64) -> (f64, f64)) -> (Vec<Vector<3>>, Vec<Vector<3>>) {
        let at = |k: u32| {
            let (x, y) = (f64::from(k % 30), f64::from(k / 30));
            let (height, up) = of(x, y);
            (Vector([x, y, height]), Vector([0.0, 0.0, up]))
        };
        (0..900).map(at).unzip()
    }

    #[test]
    fn a_sheet_whose_sides_are_guessed_wrong_faces_up_and_the_lower_side_of_a_cloth_stays() {
        let budget = Budget::default();
        let facing = |(at, normals): &(Vec<Vector<3>>, Vec<Vector<3>>)| face_up(at, normals, 1.0, &budget).unwrap();
        let is_up = |n: &Vector<3>| n[2] > 0.0;
        let parts = square(|x, y| ((0.4 * x).sin(), if x < 12.0 && y > 9.0 { -1.0 } else { 1.0 }));
        assert!(facing(&parts).is_some_and(|normals| normals.iter().all(is_up)));
        let whole = square(|_, _| (0.0, -1.0));
        assert!(facing(&whole).is_some_and(|normals| normals.iter().all(is_up)));
        let high = square(|_, _| (2.0, 1.0));
        assert!(facing(&([&whole.0[..], &high.0].concat(), [&whole.1[..], &high.1].concat())).is_none());
    }

    #[test]
    fn what_is_no_sheet_keeps_the_sides_that_contradict_one_another_least() {
        let budget = Budget::default();
        // A sheet that faces down, with bits above every other block of it: turned up beside these, it would be a chessboard.
        let (mut at, mut normals) = square(|_, _| (0.0, -1.0));
        let is_below = |p: &Vector<3>| (p[0] / 3.0).floor() as usize % 2 == (p[1] / 3.0).floor() as usize % 2;
        at.extend(at.clone().iter().filter(|p| is_below(p)).map(|p| *p + Vector([0.0, 0.0, 1.2])));
        normals.resize(at.len(), Vector([0.0, 0.0, 1.0]));
        let turned = face_up(&at, &normals, 1.0, &budget).unwrap().unwrap();
        assert!(turned[..900].iter().any(|n| n[2] > 0.0) && turned[..900].iter().any(|n| n[2] < 0.0));
        let (points, share) = surface(at, (normals.clone(), true), (1.0, 2.5), &budget).unwrap();
        assert!(share < TOLD && points.normals() == normals, "{share}");
    }
}
