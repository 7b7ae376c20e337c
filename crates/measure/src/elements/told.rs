//! Elements one by one: how many are broken, turned, mirrored or scaled beyond what is natural for their class.

use arabesque_core::{Exemplar, Role};

use crate::{
    elements::shapes::Match,
    natural::{Rule, Side},
    report::{Fault, Mark, Measure},
    scene::Scene,
    verdict::Family,
};

/// Elements that are marked, of each fault.
const MARKS: usize = 8;

/// What is judged besides shapes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Judged {
    pub(crate) turns: bool,
    pub(crate) sizes: bool,
}

/// Shares of whole elements: broken, mirrored, turned, scaled.
fn shares<const D: usize>(content: &Exemplar<D>, matches: &[Match]) -> [f64; 4] {
    let whole: Vec<&Match> =
        content.elements.iter().zip(matches).filter(|(e, _)| e.role == Role::Source).map(|(_, m)| m).collect();
    let share = |is: &dyn Fn(&Match) -> bool| whole.iter().filter(|m| is(m)).count() as f64 / whole.len().max(1) as f64;
    [
        share(&|m| m.broken > 1.0),
        share(&|m| m.is_mirrored),
        share(&|m| m.broken <= 1.0 && m.turned > 1.0),
        share(&|m| m.broken <= 1.0 && m.scaled > 1.0),
    ]
}

const NAMES: [(&str, &str, f64); 4] = [
    (
        "broken elements",
        "Elements whose outline or colour is like none in the exemplar: cut, torn, bent, or strange.",
        0.03,
    ),
    ("mirrored elements", "Elements that are mirror images of those of the exemplar, where it has none.", 0.02),
    ("turned elements", "Elements that lie in a direction in which none of their class lies in the exemplar.", 0.04),
    ("scaled elements", "Elements larger or smaller than any of their class in the exemplar.", 0.04),
];

/// Tells how elements are. `own` are the exemplar's own, each compared with the others.
pub(crate) fn elements<const D: usize>(
    exemplar: &Exemplar<D>,
    result: (&Scene<'_, D>, &[Match]),
    judged: Judged,
) -> (Vec<Measure>, Vec<Mark>) {
    let (scene, matches) = result;
    let has_outlines = |e: &Exemplar<D>| D == 2 && e.elements.iter().any(|e| !e.outline.rings.is_empty());
    if !has_outlines(exemplar) || !has_outlines(scene.content) {
        return (Vec::new(), Vec::new());
    }
    let values = shares(scene.content, matches);
    let measures = NAMES.iter().zip(values).enumerate().map(|(k, (&(name, means, least), value))| {
        let rule = Rule { name, family: Family::Elements, unit: "share", means, side: Side::Above, least, most: least };
        let is_told = match k {
            2 => judged.turns,
            3 => judged.sizes,
            _ => true,
        };
        // One element in twenty is beyond what nineteen are within.
        let natural = if k == 1 { 0.0 } else { 0.02 };
        is_told.then(|| rule.judge_within(natural, least, value))
    });
    let measures = measures.flatten().collect();
    let mut marks = worst(scene, Fault::Broken, |k| matches[k].broken, "like no element of the exemplar", matches);
    let turned = |k: usize| {
        let m = &matches[k];
        let turned = if judged.turns { m.turned } else { 0.0 };
        let scaled = if judged.sizes { m.scaled } else { 0.0 };
        if m.broken > 1.0 { 0.0 } else { turned.max(scaled).max(if m.is_mirrored { 2.0 } else { 0.0 }) }
    };
    marks.extend(worst(scene, Fault::Turned, turned, "lies as none of its class does", matches));
    (measures, marks)
}

/// The elements that are farthest beyond what is natural.
fn worst<const D: usize>(
    scene: &Scene<'_, D>,
    fault: Fault,
    beyond: impl Fn(usize) -> f64,
    says: &str,
    matches: &[Match],
) -> Vec<Mark> {
    let is_seen = |k: usize| scene.domain.contains(scene.bodies[k].centre);
    let whole = (0..scene.bodies.len()).filter(|&k| scene.bodies[k].is_whole && is_seen(k) && beyond(k) > 1.2);
    let mut off: Vec<usize> = whole.collect();
    off.sort_by(|&a, &b| beyond(b).total_cmp(&beyond(a)).then(a.cmp(&b)));
    let mark = |k: usize| {
        let (body, found) = (&scene.bodies[k], &matches[k]);
        let says = match fault {
            Fault::Turned if found.is_mirrored => "mirrored".to_owned(),
            Fault::Turned if found.scaled > found.turned => "larger or smaller than any of its class".to_owned(),
            _ => says.to_owned(),
        };
        Mark {
            fault,
            at: body.centre.0.to_vec(),
            radius: body.radius.max(0.2 * scene.spacing),
            says,
            outline: body.outline.rings.iter().map(|ring| ring.iter().map(|p| [p[0], p[1]]).collect()).collect(),
        }
    };
    off.into_iter().take(MARKS).map(mark).collect()
}
