//! How far a result is from the continued drawing.

use arabesque_core::{
    Bounds, Budget, Domain, Exemplar, GridIndex, Outcome, Request, Unobserved, Vector, polyline_length,
};
use arabesque_patterns::{Params, Prepared};

use crate::drawing::{Pattern, cut};

/// Share of the spacing that a place may be off.
pub(crate) const TOLERANCE: f64 = 0.02;

pub(crate) fn page(width: f64, height: f64) -> Bounds<2> {
    Bounds::new(Vector::ZERO, Vector::xy(width, height))
}

/// An analysed exemplar that is taken to repeat.
pub(crate) fn prepared(exemplar: &Exemplar<2>, name: &str) -> Prepared<2> {
    let prepared = Prepared::new(exemplar.clone(), &Params::default(), &Budget::default()).unwrap();
    assert!(prepared.repeat().is_some(), "{name}: no repeat found");
    prepared
}

pub(crate) fn run(prepared: &Prepared<2>, request: &Request<2>) -> Outcome<2> {
    prepared.run(request, &mut Unobserved).unwrap()
}

/// Centres of the elements of a result, with their classes.
pub(crate) fn centres(exemplar: &Exemplar<2>, outcome: &Outcome<2>) -> Vec<(Vector<2>, usize)> {
    let one = |p: &arabesque_core::Placement<2>| {
        let element = &exemplar.elements[p.source];
        (p.transform.apply(element.centre), element.class)
    };
    outcome.placements.iter().map(one).collect()
}

/// Centres in the drawing itself, in a box that is moved by `by`.
pub(crate) fn expected(pattern: &Pattern, by: Vector<2>, page: &Bounds<2>) -> Vec<(Vector<2>, usize)> {
    let there = Bounds::new(page.min - by, page.max - by);
    let centre = |(outline, class): (arabesque_core::Outline<2>, usize)| (outline.centroid().unwrap() + by, class);
    pattern.outlines(&there).into_iter().map(centre).collect()
}

/// Every expected centre that passes `counts` has an element of its class within `slack`, and there is no other.
pub(crate) fn assert_same(
    found: &[(Vector<2>, usize)],
    wanted: &[(Vector<2>, usize)],
    slack: f64,
    counts: impl Fn(Vector<2>) -> bool,
    name: &str,
) {
    let missing = unmatched(wanted, found, slack, &counts);
    let surplus = unmatched(found, wanted, slack, &counts);
    assert!(missing.is_empty(), "{name}: {} of {} missing, such as {:?}", missing.len(), wanted.len(), missing[0]);
    assert!(surplus.is_empty(), "{name}: {} too many, such as {:?}", surplus.len(), surplus[0]);
    let (found, wanted) = (found.iter().filter(|f| counts(f.0)), wanted.iter().filter(|w| counts(w.0)));
    let (found, wanted) = (found.count(), wanted.count());
    assert!(wanted > 3 && found.abs_diff(wanted) * 25 <= wanted + 49, "{name}: {found} for {wanted}");
}

fn unmatched(
    of: &[(Vector<2>, usize)],
    among: &[(Vector<2>, usize)],
    slack: f64,
    counts: &impl Fn(Vector<2>) -> bool,
) -> Vec<(Vector<2>, usize)> {
    let places: Vec<_> = among.iter().map(|(p, _)| *p).collect();
    let bounds = Bounds::around(places.iter().copied()).grown(slack);
    let index = GridIndex::new(&places, slack, &Domain::Box(bounds));
    let lonely = |(p, class): &&(Vector<2>, usize)| {
        let mut met = false;
        index.within(*p, slack, |k, _| met = met || among[k].1 == *class);
        counts(*p) && !met
    };
    of.iter().filter(lonely).copied().collect()
}

/// Farthest that strokes of a style in `page` lie from those of the drawing moved by `by`, and the other way round.
pub(crate) fn hausdorff(
    pattern: &Pattern,
    exemplar: &Exemplar<2>,
    outcome: &Outcome<2>,
    by: Vector<2>,
    page: &Bounds<2>,
) -> f64 {
    let there = Bounds::new(page.min - by, page.max - by);
    let step = 0.004 * pattern.shorter();
    let mut farthest = 0.0_f64;
    for style in 0..exemplar.styles.len() {
        let wanted = pattern.lines(&there).into_iter().filter(|(_, s)| *s == style);
        let wanted = wanted.map(|(line, _)| line.into_iter().map(|p| p + by).collect::<Vec<_>>());
        let wanted = dense(wanted, step);
        let of_style = outcome.curves.iter().filter(|c| exemplar.curves[c.source].style == style);
        let found = dense(of_style.flat_map(|c| cut(&closed(&c.path), page)), step);
        farthest = farthest.max(apart(&wanted, &found, page)).max(apart(&found, &wanted, page));
    }
    farthest
}

fn closed(path: &arabesque_core::Path<2>) -> Vec<Vector<2>> {
    let mut points = path.flatten(1e-4 * path.bounds().size().norm());
    if let (true, Some(&first)) = (path.closed, points.first()) {
        points.push(first);
    }
    points
}

fn dense(lines: impl Iterator<Item = Vec<Vector<2>>>, step: f64) -> Vec<Vector<2>> {
    let mut points = Vec::new();
    for line in lines.filter(|line| polyline_length(line) > step) {
        for w in line.windows(2) {
            let count = ((w[1] - w[0]).norm() / step).ceil().max(1.0);
            points.extend((0..=count as usize).map(|k| w[0] + (w[1] - w[0]) * (k as f64 / count)));
        }
    }
    points
}

fn apart(of: &[Vector<2>], from: &[Vector<2>], page: &Bounds<2>) -> f64 {
    if of.is_empty() {
        return 0.0;
    }
    let reach = 0.02 * page.size().norm();
    let index = GridIndex::new(from, 0.1 * reach, &Domain::Box(page.grown(reach)));
    let nearest = |p: &Vector<2>| {
        let mut radius = 0.02 * reach;
        while radius < reach {
            if let Some((_, apart)) = index.nearest(*p, radius, None) {
                return apart;
            }
            radius *= 4.0;
        }
        index.nearest(*p, reach, None).map_or(f64::INFINITY, |(_, apart)| apart)
    };
    of.iter().map(nearest).fold(0.0, f64::max)
}
