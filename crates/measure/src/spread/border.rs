//! What happens at the edge of the page.

use arabesque_core::Budget;

use crate::{
    natural::{Rule, Side},
    report::Measure,
    scene::{Body, Scene},
    spread::evenness::Field,
    verdict::Family,
};

/// Width of the strip along the border, in spacings.
const STRIP: f64 = 0.4;

/// Ink in the strip along the border, over that of the whole.
fn strip<const D: usize>(scene: &Scene<'_, D>, field: &Field<D>) -> Option<f64> {
    let share = |is_in: &dyn Fn(f64) -> bool| {
        let (mut ink, mut all) = (0.0, 0.0);
        for (k, _) in field.depths.iter().enumerate().filter(|(_, depth)| is_in(f64::from(**depth))) {
            all += 1.0;
            ink += f64::from(u8::from(field.raster.ink[k]));
        }
        if all > 0.0 { Some(ink / all) } else { None }
    };
    let width = STRIP * scene.spacing;
    Some(share(&|depth| (0.0..width).contains(&depth))? / share(&|depth| depth >= 0.0)?.max(1e-9))
}

/// Length of the border of the box around a domain, or its surface, in spacings.
fn border<const D: usize>(scene: &Scene<'_, D>) -> f64 {
    let size = scene.domain.bounds().size();
    let side = |k: usize| (0..D).filter(|j| *j != k).map(|j| size[j] / scene.spacing).product::<f64>();
    2.0 * (0..D).map(side).sum::<f64>()
}

/// Elements that cross the border.
fn cut<const D: usize>(scene: &Scene<'_, D>) -> f64 {
    let crosses = |b: &&Body<D>| {
        let depth = scene.domain.signed_distance(b.centre);
        !b.is_whole || (depth.abs() < b.radius && b.outline.points().any(|p| !scene.domain.contains(p)))
    };
    scene.bodies.iter().filter(crosses).count() as f64
}

/// Compares the edges.
pub(crate) fn edges<const D: usize>(
    exemplar: (&Scene<'_, D>, &Field<D>),
    result: (&Scene<'_, D>, &Field<D>),
    budget: &Budget,
) -> arabesque_core::Result<Vec<Measure>> {
    budget.spend(4 * (exemplar.1.depths.len() + result.1.depths.len()) as u64)?;
    let mut measures = Vec::new();
    if let (Some(own), Some(found)) = (strip(exemplar.0, exemplar.1), strip(result.0, result.1)) {
        let rule = Rule {
            name: "ink along the border",
            family: Family::Border,
            unit: "of the whole's",
            means: "Ink in a strip along the border over that of the whole; less means a bare margin, as where nothing is cut by it.",
            side: Side::Below,
            least: 0.4,
            most: 0.4,
        };
        measures.push(rule.judge_within(own.min(1.0), rule.least, found));
    }
    let has_outlines = exemplar.0.bodies.iter().any(|b| !b.outline.rings.is_empty());
    if D == 2 && has_outlines {
        let own = 100.0 * cut(exemplar.0) / border(exemplar.0);
        let found = 100.0 * cut(result.0) / border(result.0);
        let rule = Rule {
            name: "elements cut by the border",
            family: Family::Border,
            unit: "per 100 spacings",
            means: "Elements that the border goes through; none means that the page ends where the elements do.",
            side: Side::Both,
            least: 20.0,
            most: 20.0,
        };
        measures.push(rule.judge_within(own, rule.least.max(0.7 * own), found));
    }
    Ok(measures)
}
