//! Matching what a file has to the elements and curves of an exemplar.

use std::collections::BTreeMap;

use arabesque_core::{
    Bounds, Budget, Drawn, Element, Matrix, Outline, Path, Placement, Result, Role, Signature, Similarity, Vector,
};
use kurbo::Affine;

use crate::svg::{
    drawing::{Drawing, Stroke},
    parse::meta::Meta,
    understand::{classes::WOBBLE, item::Item},
};

/// Work for looking at an element that something may be a copy of.
const LOOK: u64 = 10;
/// Work for comparing two outlines.
const FIT: u64 = 12_000;

/// Largest difference of mean colours (Euclidean, channels in [0, 1]) between an element and its copy.
const COLOUR: f64 = 0.2;

/// The elements and curves of an exemplar, ready to be compared with.
pub(crate) struct Matcher<'d> {
    pub(crate) drawing: &'d Drawing,
    elements: &'d [Element<2>],
    class_names: Vec<&'d str>,
    signatures: Vec<Option<Signature>>,
    /// The first curve painted in each way.
    painted: BTreeMap<String, usize>,
    /// Whether copies that say what they are copies of mean this drawing.
    is_origin: bool,
}

impl<'d> Matcher<'d> {
    /// For a file that was made from `drawing`.
    pub(crate) fn new(drawing: &'d Drawing) -> Self {
        Self { is_origin: true, ..Self::of_itself(drawing) }
    }

    /// For the file that `drawing` was read from: what it says of copies is about the exemplar that it was made from
    /// itself.
    pub(crate) fn of_itself(drawing: &'d Drawing) -> Self {
        let elements = drawing.exemplar.elements.as_slice();
        let signature = |e: &Element<2>| (e.role == Role::Source).then(|| Signature::new(&e.outline)).flatten();
        let class_names = drawing.exemplar.classes.iter().map(|c| c.name.as_str()).collect();
        let mut painted = BTreeMap::new();
        for (k, strokes) in drawing.strokes.iter().enumerate() {
            painted.entry(joint_key(strokes.iter(), 1.0)).or_insert(k);
        }
        Self {
            drawing,
            elements,
            class_names,
            signatures: elements.iter().map(signature).collect(),
            painted,
            is_origin: false,
        }
    }

    /// A line in several paints, from bottom to top, as one painted like a curve of the exemplar: the one that it says
    /// where that is painted so except for its width, else the first that is painted exactly so.
    pub(crate) fn stroke(&self, path: &Path<2>, paints: &[(&Stroke, f64)], meta: &Meta) -> Option<Drawn<2>> {
        let key = joint_key(paints.iter().map(|(stroke, _)| *stroke), 1.0);
        let width = paints.first()?.1;
        let stated = meta.curve.filter(|_| self.is_origin).filter(|&k| {
            let known = self.drawing.strokes.get(k).filter(|known| known.len() == paints.len());
            known.is_some_and(|known| joint_key(known.iter(), width / known[0].width) == key)
        });
        let source = stated.or_else(|| self.painted.get(&key).copied())?;
        let scale = width / self.drawing.strokes.get(source)?.first()?.width;
        let scale = if (scale - 1.0).abs() < 1e-3 { 1.0 } else { scale };
        Some(Drawn { path: path.clone(), source, scale, frozen: None })
    }

    pub(crate) fn place(&self, item: &Item, names: &[String], budget: &Budget) -> Result<Option<Placement<2>>> {
        // A clip around everything takes nothing away from what an element is.
        let whole = if item.is_cut { item.painted.outline(budget)? } else { item.outline.clone() };
        let found = match self.stated(item, &whole) {
            Some(stated) => Some(stated),
            None => self.alike(item, &whole, names, budget)?,
        };
        Ok(found.map(|(source, transform)| Placement { source, transform, control: Vec::new(), frozen: None }))
    }

    /// The element that a copy says it is: by its transform when its painted area then lies where it should, else by
    /// its outline.
    fn stated(&self, item: &Item, whole: &Outline<2>) -> Option<(usize, Similarity<2>)> {
        let source = item.meta.source.filter(|_| self.is_origin)?;
        let element = self.elements.get(source).filter(|e| e.role == Role::Source)?;
        if let [(parent, node)] = item.parts.as_slice() {
            let transform = similarity(*parent * node.transform);
            let fits = transform.filter(|t| lies_on(&element.outline.transformed(t), whole));
            if let Some(transform) = fits {
                return Some((source, transform));
            }
        }
        let fit = self.signatures[source].as_ref()?.fit(&Signature::new(whole)?);
        (fit.distance <= 0.5 * WOBBLE).then_some((source, fit.pose))
    }

    /// The element that looks most like the item.
    fn alike(
        &self,
        item: &Item,
        whole: &Outline<2>,
        names: &[String],
        budget: &Budget,
    ) -> Result<Option<(usize, Similarity<2>)>> {
        let Some(signature) = Signature::new(whole) else { return Ok(None) };
        budget.spend(LOOK * self.elements.len() as u64 * (1 + names.len() as u64))?;
        let colour = item.painted.colour();
        let named = |e: &Element<2>| names.iter().any(|n| n == self.class_names[e.class]);
        let any_named = self.elements.iter().any(named);
        let mut best: Option<(f64, usize, Similarity<2>)> = None;
        for (i, element) in self.elements.iter().enumerate() {
            let Some(own) = &self.signatures[i] else { continue };
            let paint = (0..3).map(|k| (element.colour[k] - colour[k]).powi(2)).sum::<f64>().sqrt();
            if (any_named && !named(element)) || paint > COLOUR || !own.may_match(&signature) {
                continue;
            }
            budget.spend(FIT)?;
            let fit = own.fit(&signature);
            let off = fit.distance + 0.1 * paint + 0.05 * fit.pose.scale.ln().abs();
            if fit.distance <= 1.5 * WOBBLE && best.is_none_or(|(least, ..)| off < least) {
                best = Some((off, i, fit.pose));
            }
        }
        Ok(best.map(|(_, i, pose)| (i, pose)))
    }
}

/// A text that is the same for lines whose paints, all lengths times `factor`, look the same.
fn joint_key<'a>(strokes: impl Iterator<Item = &'a Stroke>, factor: f64) -> String {
    let key = |stroke: &Stroke| if factor == 1.0 { stroke.key() } else { stroke.scaled(factor).key() };
    strokes.map(key).collect::<Vec<_>>().join("\n")
}

/// A transform as turn, scale and shift; `None` when it mirrors or distorts.
fn similarity(transform: Affine) -> Option<Similarity<2>> {
    let [a, b, c, d, e, f] = transform.as_coeffs();
    let scale = a.hypot(b);
    let off = (a - d).abs().max((b + c).abs());
    let sound = scale.is_finite() && scale > 0.0 && off <= 1e-3 * scale;
    sound.then(|| Similarity { rotation: Matrix::rotation(b.atan2(a)), scale, translation: Vector::xy(e, f) })
}

/// Whether two outlines fill about the same box.
fn lies_on(a: &Outline<2>, b: &Outline<2>) -> bool {
    let (a, b): (Bounds<2>, Bounds<2>) = (a.bounds(), b.bounds());
    let near = 0.02 * b.size().norm();
    (a.min - b.min).norm() <= near && (a.max - b.max).norm() <= near
}
