//! Elements that stay where they are: reading them back and matching them to the elements of an exemplar.

use std::collections::BTreeMap;

use arabesque_core::{
    Bounds, Budget, Decimals, Drawn, Element, Matrix, Outline, Path, Placement, Result, Role, Similarity, Vector,
};
use kurbo::Affine;

use crate::{
    svg::{
        drawing::{Drawing, Fragment, Page, Placed, Stroke},
        options::{Method, ReadOptions},
        parse::{definitions::Definitions, meta::Meta},
        read::document::{Document, Opened},
        shape::{
            cut_path::{Side, cut},
            extent::bounds,
            painted_area::Painter,
        },
        understand::{
            classes::{self, WOBBLE},
            curves::{Curves, Gatherer},
            fragment::fragment,
            item::{Item, Kind},
            select::select,
            signature::Signature,
            surroundings::Surroundings,
        },
    },
    text::unit::Unit,
};

/// Work for looking at an element that something may be a copy of.
const LOOK: u64 = 10;
/// Work for comparing two outlines.
const FIT: u64 = 12_000;

/// Largest difference of mean colours (Euclidean, channels in [0, 1]) between an element and its copy.
const COLOUR: f64 = 0.2;

/// Reads what stays where it is from a text of which nothing else is read.
///
/// # Errors
/// As for [`Document::with`] and [`Document::placed`].
pub fn read_placed(text: &str, drawing: &Drawing, options: &ReadOptions) -> Result<Placed> {
    Document::with(text, options, |document| document.placed(drawing))
}

impl Document<'_> {
    /// Reads what stays where it is, and matches it to the elements and curves of `drawing`.
    ///
    /// Copies made by arabesque say what they are copies of (`data-arabesque-source`, `data-arabesque-curve`); other
    /// elements are matched by name, colour and outline, other strokes by their paint. What matches nothing becomes an
    /// obstacle. Nothing at all in the file is not an error: there is nothing to keep.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Input`] when the text is not usable SVG, [`arabesque_core::Error::Limit`] when it is
    /// too large.
    pub fn placed(&self, drawing: &Drawing) -> Result<Placed> {
        let Opened { source, root, page, .. } = self.open()?;
        let source = &source;
        let painter = Painter::new(source);
        painter.check_all(&root, Affine::IDENTITY)?;
        let content = bounds(&root, Affine::IDENTITY);
        let page = page.unwrap_or(Page { view: content, unit: Unit::Px, unit_per_user: 1.0 });
        let mut definitions = Definitions::new(source, "kept");
        let mut placed = Placed::on(page);
        if page.view.measure() > 0.0 && page.view.size().is_finite() {
            let method = if drawing.exemplar.curves.is_empty() { Method::Elements } else { Method::Curves };
            let found = select(&painter, page.view, method, &[(Surroundings::new(Affine::IDENTITY), root)])?;
            let mut sorter = Sorter {
                painter: &painter,
                matcher: Matcher::new(drawing),
                area: None,
                window: content.union(&page.view),
            };
            for item in &found.items {
                let kept = sorter.sort(item, &mut definitions)?;
                placed.add(item, kept, &mut definitions);
            }
        }
        placed.definitions = definitions.finish()?;
        placed.warnings = source.notes.warnings(source.name);
        Ok(placed)
    }
}

impl Placed {
    /// Nothing yet.
    pub(crate) fn on(page: Page) -> Self {
        Self {
            placements: Vec::new(),
            curves: Vec::new(),
            obstacles: Vec::new(),
            fragments: Vec::new(),
            curve_fragments: Vec::new(),
            obstacle_fragments: Vec::new(),
            definitions: String::new(),
            page,
            warnings: Vec::new(),
        }
    }

    /// Adds what stays, without its looks.
    pub(crate) fn freeze(&mut self, kept: Sorted) {
        match kept {
            Sorted::Removed => {}
            Sorted::Element(placement) => self.placements.push(placement),
            Sorted::Strokes { drawn, .. } => self.curves.extend(drawn),
            Sorted::Obstacle { outline, .. } => self.obstacles.push(outline),
        }
    }

    fn add(&mut self, item: &Item, kept: Sorted, definitions: &mut Definitions<'_, '_>) {
        match kept {
            Sorted::Removed => {}
            Sorted::Element(placement) => {
                self.placements.push(placement);
                self.fragments.push(fragment(item, definitions));
            }
            Sorted::Strokes { drawn, cut, .. } => {
                let extent = drawn.iter().fold(Bounds::EMPTY, |all, d| all.union(&d.path.bounds()));
                self.curves.extend(drawn);
                let whole = fragment(item, definitions);
                let markup = cut.unwrap_or_else(|| whole.markup.clone());
                let width = item.outline.bounds();
                self.curve_fragments.push((Fragment { markup, ..whole }, extent.union(&width)));
            }
            Sorted::Obstacle { outline, .. } => {
                self.obstacles.push(outline);
                self.obstacle_fragments.push(fragment(item, definitions));
            }
        }
    }
}

/// What becomes of an item.
pub(crate) enum Sorted {
    /// It lies where everything is refilled.
    Removed,
    /// It is an element of the exemplar.
    Element(Placement<2>),
    /// It is one or more strokes of the exemplar's styles; `cut` is their markup where they are not whole, and
    /// `is_touched` says whether what is refilled takes something away from them.
    Strokes { drawn: Vec<Drawn<2>>, cut: Option<String>, is_touched: bool },
    /// It is nothing that the exemplar knows; the rest as for strokes.
    Obstacle { outline: Outline<2>, cut: Option<String>, is_touched: bool },
}

/// Decides what becomes of items.
pub(crate) struct Sorter<'a, 's, 'i, 'd> {
    pub(crate) painter: &'i Painter<'a, 's>,
    pub(crate) matcher: Matcher<'d>,
    /// What is refilled; nothing when everything stays.
    pub(crate) area: Option<&'i Outline<2>>,
    /// Box around everything.
    pub(crate) window: Bounds<2>,
}

impl<'a, 's> Sorter<'a, 's, '_, '_> {
    pub(crate) fn sort(&mut self, item: &Item, definitions: &mut Definitions<'a, 's>) -> Result<Sorted> {
        if item.kind == Kind::Curve && !self.matcher.drawing.exemplar.curves.is_empty() {
            return self.strokes(item, definitions);
        }
        let centre = item.outline.centroid().unwrap_or_else(|| item.outline.bounds().centre());
        if self.area.is_some_and(|area| area.contains(centre)) {
            return Ok(Sorted::Removed);
        }
        let names = classes::names_of(&item.meta, &self.painter.source.sheet);
        Ok(match self.matcher.place(item, &names, self.painter.source.budget)? {
            Some(placement) => Sorted::Element(placement),
            None => Sorted::Obstacle { outline: item.outline.clone(), cut: None, is_touched: false },
        })
    }

    fn strokes(&self, item: &Item, definitions: &mut Definitions<'a, 's>) -> Result<Sorted> {
        let mut gatherer = Gatherer::new(self.painter, definitions, self.window);
        gatherer.add(item)?;
        let Curves { curves, strokes, .. } = gatherer.finish();
        // A clip takes something away as well: then the line alone is not what the file shows.
        let (mut is_touched, mut rest) = (false, Vec::new());
        for (curve, stroke) in curves.iter().zip(&strokes) {
            self.painter.source.budget.spend(LOOK * self.area.map_or(0, |area| area.points().count()) as u64)?;
            let parts = self.area.and_then(|area| cut(&curve.path, area, Side::Outside));
            is_touched |= parts.is_some();
            rest.extend(
                parts.unwrap_or_else(|| vec![curve.path.clone()]).into_iter().map(|path| (path, curve, stroke)),
            );
        }
        if rest.is_empty() {
            return Ok(Sorted::Removed);
        }
        let decimals = Decimals::for_extent(self.window.size()[0].max(self.window.size()[1]));
        let markup = rest.iter().map(|(path, _, stroke)| stroke.markup(path, decimals)).collect::<String>();
        let markup =
            (is_touched || item.is_cut).then(|| if rest.len() == 1 { markup } else { format!("<g>{markup}</g>") });
        let drawn = rest.iter().map(|(path, curve, stroke)| self.matcher.stroke(path, curve.width, stroke, &item.meta));
        match drawn.collect::<Option<Vec<_>>>() {
            Some(drawn) => Ok(Sorted::Strokes { drawn, cut: markup, is_touched }),
            None => {
                let outline = match self.area {
                    Some(area) => item.outline.try_difference(area, self.painter.source.budget)?,
                    None => item.outline.clone(),
                };
                Ok(Sorted::Obstacle { outline, cut: markup, is_touched })
            }
        }
    }
}

/// The elements and curves of an exemplar, ready to be compared with.
pub(crate) struct Matcher<'d> {
    drawing: &'d Drawing,
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
        for (k, stroke) in drawing.strokes.iter().enumerate() {
            painted.entry(stroke.key()).or_insert(k);
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

    /// The stroke as one painted like a curve of the exemplar: the one that it says where that is painted so except for
    /// its width, else the first that is painted exactly so.
    fn stroke(&self, path: &Path<2>, width: f64, stroke: &Stroke, meta: &Meta) -> Option<Drawn<2>> {
        let stated = meta.curve.filter(|_| self.is_origin).filter(|&k| {
            let known = self.drawing.strokes.get(k);
            known.is_some_and(|known| known.scaled(width / known.width).key() == stroke.key())
        });
        let source = stated.or_else(|| self.painted.get(&stroke.key()).copied())?;
        let scale = width / self.drawing.strokes.get(source)?.width;
        let scale = if (scale - 1.0).abs() < 1e-3 { 1.0 } else { scale };
        Some(Drawn { path: path.clone(), source, scale, frozen: None })
    }

    fn place(&self, item: &Item, names: &[String], budget: &Budget) -> Result<Option<Placement<2>>> {
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
