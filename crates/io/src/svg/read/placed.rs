//! Elements that stay where they are: reading them back and matching them to the elements of an exemplar.

use std::collections::BTreeMap;

use arabesque_core::{
    Bounds, Budget, Decimals, Drawn, Element, Matrix, Outline, Path, Placement, Result, Role, Similarity, Vector,
};
use kurbo::Affine;

use crate::{
    svg::{
        drawing::{Drawing, Fragment, KeptStrokes, Page, Placed, Stroke},
        layers::stacks::{Stack, nearness, paints_of, stacks},
        options::{Method, ReadOptions},
        parse::{definitions::Definitions, meta::Meta},
        read::document::{Document, Opened},
        shape::{
            cut_path::{Side, cut},
            extent::bounds,
            idle::without_idle_clips,
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
            let method = match (drawing.exemplar.elements.is_empty(), drawing.exemplar.curves.is_empty()) {
                (_, true) => Method::Elements,
                (true, false) => Method::Curves,
                (false, false) => Method::Auto,
            };
            let root = without_idle_clips(&painter, &root, Affine::IDENTITY, &page.view)?;
            let found = select(&painter, page.view, method, &[(Surroundings::new(Affine::IDENTITY), root)])?;
            let sorter = Sorter {
                painter: &painter,
                matcher: Matcher::new(drawing),
                area: None,
                window: content.union(&page.view),
            };
            let sorted = sorter.sort(&found.items, &mut definitions)?;
            for (item, kept) in found.items.iter().zip(sorted) {
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
            Sorted::Strokes { drawn, paint, cut, .. } => {
                let extent = drawn.iter().fold(Bounds::EMPTY, |all, d| all.union(&d.path.bounds()));
                self.curves.extend(drawn);
                let whole = fragment(item, definitions);
                let markup = cut.unwrap_or_else(|| whole.markup.clone());
                let width = item.outline.bounds();
                let fragment = Fragment { markup, ..whole };
                self.curve_fragments.push(KeptStrokes { fragment, extent: extent.union(&width), paint });
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
    /// It is strokes in paints of the exemplar's styles, `paint` the first of them; `drawn` has those of which it is the
    /// lowest paint, `cut` is their markup where they are not whole, and `is_touched` says whether what is refilled
    /// takes something away from them.
    Strokes { drawn: Vec<Drawn<2>>, paint: Option<(usize, usize)>, cut: Option<String>, is_touched: bool },
    /// It is nothing that the exemplar knows; `is_touched` as for strokes.
    Obstacle { outline: Outline<2>, is_touched: bool },
}

/// What is left of the strokes of an item.
#[derive(Default)]
struct Remains {
    parts: Vec<Part>,
    /// What draws it where it is not whole.
    cut: Option<String>,
    is_touched: bool,
}

/// A line that is left, with its paint.
struct Part {
    path: Path<2>,
    width: f64,
    stroke: Stroke,
}

/// What the exemplar knows of a part: the strokes of which it is the lowest paint, and which paint of which style it is.
#[derive(Clone, Default)]
struct Known {
    drawn: Vec<Drawn<2>>,
    paint: (usize, usize),
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
    /// What becomes of all items of a drawing: strokes on one geometry are looked at together.
    pub(crate) fn sort(&self, items: &[Item], definitions: &mut Definitions<'a, 's>) -> Result<Vec<Sorted>> {
        let mut remains = Vec::with_capacity(items.len());
        for item in items {
            remains.push(if self.is_strokes(item)? { Some(self.remains(item, definitions)?) } else { None });
        }
        let mut known = self.known(items, &remains)?.into_iter();
        let mut sorted = Vec::with_capacity(items.len());
        for (item, remains) in items.iter().zip(remains) {
            sorted.push(match remains {
                None => self.element(item)?,
                Some(Remains { parts, .. }) if parts.is_empty() => Sorted::Removed,
                Some(Remains { parts, cut, is_touched }) => {
                    let known: Option<Vec<Known>> = known.by_ref().take(parts.len()).collect();
                    match known {
                        Some(known) => {
                            let paint = known.first().map(|k| k.paint);
                            let drawn = known.into_iter().flat_map(|k| k.drawn).collect();
                            Sorted::Strokes { drawn, paint, cut, is_touched }
                        }
                        None => Sorted::Obstacle { outline: self.outside(item)?, is_touched },
                    }
                }
            });
        }
        Ok(sorted)
    }

    /// Markup of what is left of an item; `None` where nothing is, and inside of it where it is whole.
    pub(crate) fn rest(&self, item: &Item, definitions: &mut Definitions<'a, 's>) -> Result<Option<Option<String>>> {
        if self.is_strokes(item)? {
            let remains = self.remains(item, definitions)?;
            return Ok((!remains.parts.is_empty()).then_some(remains.cut));
        }
        Ok((!self.is_refilled(item)).then_some(None))
    }

    fn is_strokes(&self, item: &Item) -> Result<bool> {
        if self.matcher.drawing.exemplar.curves.is_empty() {
            return Ok(false);
        }
        if item.kind == Kind::Curve {
            return Ok(true);
        }
        // A few strokes of a net look like things of their own.
        Ok(item.reason.is_loose() && !self.is_refilled(item) && self.placement(item)?.is_none())
    }

    fn placement(&self, item: &Item) -> Result<Option<Placement<2>>> {
        let names = classes::names_of(&item.meta, &self.painter.source.sheet);
        self.matcher.place(item, &names, self.painter.source.budget)
    }

    fn is_refilled(&self, item: &Item) -> bool {
        let centre = item.outline.centroid().unwrap_or_else(|| item.outline.bounds().centre());
        self.area.is_some_and(|area| area.contains(centre))
    }

    fn element(&self, item: &Item) -> Result<Sorted> {
        if self.is_refilled(item) {
            return Ok(Sorted::Removed);
        }
        Ok(match self.placement(item)? {
            Some(placement) => Sorted::Element(placement),
            None => Sorted::Obstacle { outline: item.outline.clone(), is_touched: false },
        })
    }

    /// The painted area of an item without what is refilled.
    fn outside(&self, item: &Item) -> Result<Outline<2>> {
        match self.area {
            Some(area) => item.outline.try_difference(area, self.painter.source.budget),
            None => Ok(item.outline.clone()),
        }
    }

    fn remains(&self, item: &Item, definitions: &mut Definitions<'a, 's>) -> Result<Remains> {
        let mut gatherer = Gatherer::new(self.painter, definitions, self.window);
        gatherer.add(item)?;
        let Curves { curves, strokes, .. } = gatherer.finish()?;
        // A clip takes something away as well: then the line alone is not what the file shows.
        let (mut is_touched, mut rest) = (false, Vec::new());
        for (curve, stroke) in curves.iter().zip(strokes) {
            self.painter.source.budget.spend(LOOK * self.area.map_or(0, |area| area.points().count()) as u64)?;
            let parts = self.area.and_then(|area| cut(&curve.path, area, Side::Outside));
            is_touched |= parts.is_some();
            let parts = parts.unwrap_or_else(|| vec![curve.path.clone()]);
            rest.extend(parts.into_iter().map(|path| Part { path, width: curve.width, stroke: stroke.clone() }));
        }
        let decimals = Decimals::for_extent(self.window.size()[0].max(self.window.size()[1]));
        let markup = rest.iter().map(|part| part.stroke.markup(&part.path, decimals)).collect::<String>();
        let markup =
            (is_touched || item.is_cut).then(|| if rest.len() == 1 { markup } else { format!("<g>{markup}</g>") });
        Ok(Remains { parts: rest, cut: markup, is_touched })
    }

    /// What the exemplar knows of all parts, in their order.
    fn known(&self, items: &[Item], remains: &[Option<Remains>]) -> Result<Vec<Option<Known>>> {
        let of_items = items.iter().zip(remains);
        let parts: Vec<(&Item, &Part)> =
            of_items.flat_map(|(item, r)| r.iter().flat_map(move |r| r.parts.iter().map(move |p| (item, p)))).collect();
        let lines = parts.iter().map(|(_, part)| part.path.clone());
        let exemplar = &self.matcher.drawing.exemplar;
        let stacks = if self.matcher.drawing.strokes.iter().any(|paints| paints.len() > 1) {
            let strokes: Vec<Stroke> = parts.iter().map(|(_, part)| part.stroke.clone()).collect();
            let near = nearness(&self.window, exemplar.curves.iter().map(|c| &c.width));
            stacks(lines.zip(paints_of(&strokes)).collect(), near, self.painter.source.budget)?
        } else {
            lines.enumerate().map(|(k, path)| Stack::of_one(path, k)).collect()
        };
        // A second line in the same paint is as good as the first.
        let mut all: Vec<Option<Known>> = vec![Some(Known::default()); parts.len()];
        for Stack { path, members, .. } in stacks {
            let paints: Vec<(&Stroke, f64)> = members.iter().map(|&m| (&parts[m].1.stroke, parts[m].1.width)).collect();
            let meta = members.first().map(|&m| &*parts[m].0.meta);
            let mut drawn = meta.and_then(|meta| self.matcher.stroke(&path, &paints, meta));
            let style = drawn.as_ref().map(|d| exemplar.curves[d.source].style);
            for (paint, &m) in members.iter().enumerate() {
                match (style, &mut all[m]) {
                    (None, known) => *known = None,
                    (Some(style), Some(known)) => {
                        known.drawn.extend(drawn.take());
                        known.paint = (style, paint);
                    }
                    (Some(_), None) => {}
                }
            }
        }
        Ok(all)
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
    fn stroke(&self, path: &Path<2>, paints: &[(&Stroke, f64)], meta: &Meta) -> Option<Drawn<2>> {
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
