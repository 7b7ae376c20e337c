//! Elements that stay where they are: reading them back and matching them to the elements of an exemplar.

use arabesque_core::{Bounds, Element, Matrix, Outline, Placement, Result, Role, Similarity, Vector};
use kurbo::Affine;

use super::{
    Drawing, Method, Page, Placed, ReadOptions, Unit,
    classes::{self, WOBBLE},
    definitions::Definitions,
    ink::Inker,
    item::Item,
    read::{fragment, root},
    select::{Context, select},
    signature::Signature,
    source::with_source,
};

/// Largest difference of mean colours (Euclidean, channels in [0, 1]) between an element and its copy.
const COLOUR: f64 = 0.2;

/// Reads elements that stay where they are, and matches them to the elements of `drawing`.
///
/// Copies made by arabesque say which element they are (`data-arabesque-source`); others are matched by name, colour and outline.
/// What matches no element becomes an obstacle. Nothing at all in the file is no error: there is nothing to keep.
///
/// # Errors
/// [`arabesque_core::Error::Input`] when the text is no usable SVG, [`arabesque_core::Error::Limit`] when it is too large.
pub fn read_placed(text: &str, drawing: &Drawing, options: &ReadOptions) -> Result<Placed> {
    with_source(text, options, |source| {
        let (root, page) = root(source)?;
        let inker = Inker::new(source);
        inker.check_all(&root, Affine::IDENTITY)?;
        let content = super::extent::bounds(&root, Affine::IDENTITY);
        let page = page.unwrap_or(Page { view: content, unit: Unit::Px, unit_per_user: 1.0 });
        let mut definitions = Definitions::new(source, "kept");
        let mut placed = Placed {
            placements: Vec::new(),
            obstacles: Vec::new(),
            fragments: Vec::new(),
            obstacle_fragments: Vec::new(),
            definitions: String::new(),
            page,
            warnings: Vec::new(),
        };
        if page.view.measure() > 0.0 && page.view.size().is_finite() {
            let found = select(&inker, page.view, Method::Elements, &[(Context::new(Affine::IDENTITY), root)])?;
            let matcher = Matcher::new(drawing);
            for item in &found.items {
                let names = classes::names_of(&item.meta, &source.sheet);
                let markup = fragment(item, &mut definitions);
                match matcher.place(item, &names) {
                    Some(placement) => {
                        placed.placements.push(placement);
                        placed.fragments.push(markup);
                    }
                    None => {
                        placed.obstacles.push(item.outline.clone());
                        placed.obstacle_fragments.push(markup);
                    }
                }
            }
        }
        placed.definitions = definitions.finish();
        placed.warnings = source.notes.warnings(source.name);
        Ok(placed)
    })
}

/// The elements of an exemplar, ready to be compared with.
struct Matcher<'d> {
    elements: &'d [Element<2>],
    class_names: Vec<&'d str>,
    signatures: Vec<Option<Signature>>,
}

impl<'d> Matcher<'d> {
    fn new(drawing: &'d Drawing) -> Self {
        let elements = drawing.exemplar.elements.as_slice();
        let signature = |e: &Element<2>| (e.role == Role::Source).then(|| Signature::new(&e.outline)).flatten();
        let class_names = drawing.exemplar.classes.iter().map(|c| c.name.as_str()).collect();
        Self { elements, class_names, signatures: elements.iter().map(signature).collect() }
    }

    fn place(&self, item: &Item, names: &[String]) -> Option<Placement<2>> {
        // A clip around everything takes nothing away from what an element is.
        let whole = if item.is_cut { item.ink.outline() } else { item.outline.clone() };
        let (source, transform) = self.stated(item, &whole).or_else(|| self.alike(item, &whole, names))?;
        Some(Placement { source, transform, control: Vec::new(), frozen: None })
    }

    /// The element that a copy says it is: by its transform when its ink then lies where it should, else by its outline.
    fn stated(&self, item: &Item, whole: &Outline<2>) -> Option<(usize, Similarity<2>)> {
        let source = item.meta.source?;
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
    fn alike(&self, item: &Item, whole: &Outline<2>, names: &[String]) -> Option<(usize, Similarity<2>)> {
        let signature = Signature::new(whole)?;
        let colour = item.ink.colour();
        let named = |e: &Element<2>| names.iter().any(|n| n == self.class_names[e.class]);
        let any_named = self.elements.iter().any(named);
        let mut best: Option<(f64, usize, Similarity<2>)> = None;
        for (i, element) in self.elements.iter().enumerate() {
            let Some(own) = &self.signatures[i] else { continue };
            let paint = (0..3).map(|k| (element.colour[k] - colour[k]).powi(2)).sum::<f64>().sqrt();
            if (any_named && !named(element)) || paint > COLOUR || !own.may_match(&signature) {
                continue;
            }
            let fit = own.fit(&signature);
            let off = fit.distance + 0.1 * paint + 0.05 * fit.pose.scale.ln().abs();
            if fit.distance <= 1.5 * WOBBLE && best.is_none_or(|(least, ..)| off < least) {
                best = Some((off, i, fit.pose));
            }
        }
        best.map(|(_, i, pose)| (i, pose))
    }
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
