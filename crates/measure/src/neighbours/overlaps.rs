//! Elements that lie on top of each other.

use arabesque_core::{Bounds, Budget, Outline, Result, Vector, ring};
use rayon::prelude::*;

use crate::{
    natural::{Natural, Rule, Side},
    neighbours::clearance::Near,
    report::{Fault, Mark, Measure},
    scene::{Scene, flat},
    verdict::Family,
};

/// What two elements share counts from this part of the smaller one on.
const TOUCH: f64 = 0.003;
/// Overlaps that are marked.
const MARKS: usize = 8;

/// What two elements share.
struct Overlap {
    at: Vector<2>,
    area: f64,
    /// Mean width of it, in user units.
    depth: f64,
    outline: Outline<2>,
}

fn overlaps_of<const D: usize>(scene: &Scene<'_, D>, near: &[Vec<Near>], budget: &Budget) -> Result<Vec<Overlap>> {
    let pairs: Vec<(usize, usize)> = near
        .iter()
        .enumerate()
        .flat_map(|(i, list)| list.iter().filter(move |n| n.is_overlap && n.other > i).map(move |n| (i, n.other)))
        .collect();
    let shared = |&(i, j): &(usize, usize)| -> Result<Option<Overlap>> {
        let (Some(a), Some(b)) = (flat(&scene.bodies[i].outline), flat(&scene.bodies[j].outline)) else {
            return Ok(None);
        };
        let outline = a.try_intersection(&b, budget)?;
        let area = outline.area();
        let border: f64 = outline.rings.iter().flat_map(|r| ring::edges(r)).map(|(p, q)| (q - p).norm()).sum();
        let counts = area > TOUCH * a.area().min(b.area()) && border > 0.0;
        let at = outline.centroid().unwrap_or(Vector::ZERO);
        Ok(counts.then_some(Overlap { at, area, depth: 2.0 * area / border, outline }))
    };
    let found: Vec<Option<Overlap>> = pairs.par_iter().map(shared).collect::<Result<_>>()?;
    Ok(found.into_iter().flatten().collect())
}

/// Figures of a scene, or of a part: overlaps for a hundred elements, mean width of the deepest, share of the ink of elements.
fn figures<const D: usize>(scene: &Scene<'_, D>, found: &[Overlap], part: Option<&Bounds<D>>) -> [f64; 3] {
    let in_plane = |b: &Bounds<D>, p: Vector<2>| (0..2).all(|k| b.min[k] <= p[k] && p[k] <= b.max[k]);
    let bodies = scene.bodies.iter().filter(|b| part.is_none_or(|part| part.contains(b.centre)));
    let (mut count, mut ink) = (0.0, 0.0);
    for body in bodies {
        count += 1.0;
        ink += flat(&body.outline).map_or(0.0, |o| o.area());
    }
    let inside = found.iter().filter(|o| part.is_none_or(|part| in_plane(part, o.at)));
    let (mut overlaps, mut deepest, mut shared) = (0.0, 0.0_f64, 0.0);
    for overlap in inside {
        overlaps += 1.0;
        deepest = deepest.max(overlap.depth);
        shared += overlap.area;
    }
    [100.0 * overlaps / f64::max(count, 1.0), deepest / scene.spacing, shared / f64::max(ink, 1e-12)]
}

/// Compares what lies on top of each other.
pub(crate) fn overlaps<const D: usize>(
    exemplar: (&Scene<'_, D>, &[Vec<Near>]),
    result: (&Scene<'_, D>, &[Vec<Near>]),
    budget: &Budget,
) -> Result<(Vec<Measure>, Vec<Mark>)> {
    let has_outlines = |scene: &Scene<'_, D>| scene.bodies.iter().any(|b| !b.outline.rings.is_empty());
    if D != 2 || !has_outlines(exemplar.0) || !has_outlines(result.0) {
        return Ok((Vec::new(), Vec::new()));
    }
    let own = overlaps_of(exemplar.0, exemplar.1, budget)?;
    let mut found = overlaps_of(result.0, result.1, budget)?;
    let whole = figures(exemplar.0, &own, None);
    let parts: Vec<([f64; 3], f64)> =
        exemplar.0.parts().into_iter().map(|(part, share)| (figures(exemplar.0, &own, Some(&part)), share)).collect();
    let times = result.0.domain.measure() / exemplar.0.domain.measure();
    let rules = [
        ("overlaps", "per 100 elements", "Pairs of elements that lie on top of each other.", 2.0, 2.0 + 0.5 * whole[0]),
        (
            "deepest overlap",
            "spacings",
            "Mean width of what two elements share, at its widest.",
            0.04 + 0.35 * whole[1],
            0.06 + 0.6 * whole[1],
        ),
        (
            "overlapped ink",
            "share",
            "Share of the area of elements that is covered twice.",
            0.006 + 0.25 * whole[2],
            0.01 + 0.6 * whole[2],
        ),
    ];
    let values = figures(result.0, &found, None);
    let measures = rules.into_iter().enumerate().map(|(k, (name, unit, means, least, most))| {
        let rule = Rule { name, family: Family::Overlaps, unit, means, side: Side::Above, least, most };
        let parts = parts.iter().map(|(figures, share)| (figures[k], *share)).collect();
        rule.judge(&Natural { whole: whole[k], parts, times }, values[k])
    });
    let measures: Vec<Measure> = measures.collect();
    let page = result.0.domain.bounds();
    let deepest = own.iter().map(|o| o.depth).fold(0.0, f64::max);
    let is_seen = |o: &Overlap| (0..2).all(|k| (page.min[k]..=page.max[k]).contains(&o.at[k]));
    found.retain(|o| o.depth > 1.05 * deepest && is_seen(o));
    found.sort_by(|a, b| b.depth.total_cmp(&a.depth).then(a.at.0[0].total_cmp(&b.at.0[0])));
    let mark = |o: Overlap| Mark {
        fault: Fault::Overlap,
        at: o.at.0.to_vec(),
        radius: o.outline.radius(o.at),
        says: format!(
            "{:.2} spacings deep, where the exemplar has {:.2} at most",
            o.depth / exemplar.0.spacing,
            whole[1]
        ),
        outline: o.outline.rings.iter().map(|ring| ring.iter().map(|p| p.0).collect()).collect(),
    };
    Ok((measures, found.into_iter().take(MARKS).map(mark).collect()))
}
