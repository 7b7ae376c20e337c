//! The exemplar in a file: what is selected of the drawing, as elements and curves with their looks, and the other
//! layers of a job.

use std::{rc::Rc, sync::Arc};

use arabesque_core::{Area, Bounds, Contents, Element, Error, Exemplar, Outline, Result, Role, Vector, Warning};
use kurbo::Affine;

use crate::{
    svg::{
        drawing::{Drawing, Job, Page, Stroke},
        layers::{
            stacks::{Stacked, stacked},
            visible::keep_visible,
        },
        options::{LargeFills, Method, Parts, ReadOptions},
        parse::{definitions::Definitions, guard, meta::Part, notes::Note, scene::Node, source::Source},
        read::{
            document::{Document, Opened, parts},
            domain::shape,
            flow::strokes,
            layers::{Order, Sorted, layers},
            missing_paints::note_missing_paints,
        },
        reason::{Reason, Understood},
        shape::{
            extent::{self, bounds},
            idle::without_idle_clips,
            painted_area::Painter,
        },
        swatch::{period::periods, unroll::Unrolled},
        understand::{
            classes::{self, Classes},
            curves::Gatherer,
            fragment::{fragment, push_placed},
            frame::{self, frame_mark, is_frame_mark, shows},
            item::{Item, Kind, Origin, Selection},
            outlined_lines::{refuse_through, take_areas, take_backgrounds, trace},
            parts::{
                bands::follow_bands, gradients::take_gradients, hand::follow_by_hand, outlined::part_outlined,
                uncovered::uncover,
            },
            select::select,
            surroundings::Surroundings,
        },
    },
    text::unit::Unit,
};

/// Reads an exemplar from a text of which nothing else is read.
///
/// # Errors
/// As for [`Document::with`] and [`Document::exemplar`].
pub fn read_exemplar(text: &str, options: &ReadOptions) -> Result<Drawing> {
    Document::with(text, options, |document| document.exemplar())
}

/// Whether the exemplar in a text would be read as a period of a pattern: [`read_exemplar`] with these options gives it one.
///
/// # Errors
/// As for [`Document::with`], and [`Error::Input`] where the text has to be a period and is none.
pub fn shows_period(text: &str, options: &ReadOptions) -> Result<bool> {
    Document::with(text, options, |document| {
        let Opened { source, root, page, .. } = document.open()?;
        Ok(document.periods(&source, &root, page.as_ref())?.is_some())
    })
}

impl Document<'_> {
    /// Reads an exemplar, and the rest of the job where the file holds one.
    ///
    /// # Errors
    /// [`Error::Input`] when the text is not usable SVG or holds neither a whole element nor a curve, [`Error::Limit`]
    /// when it is too large, [`Error::Unsupported`] when it holds a network of lines turned into an outline and the
    /// method is not [`Method::Elements`].
    pub fn exemplar(&self) -> Result<Drawing> {
        let Opened { source, root, page, .. } = self.open()?;
        let source = &source;
        let painter = Painter::new(source);
        painter.check_all(&root, Affine::IDENTITY)?;
        note_missing_paints(source, &root);
        let unrolled = self.periods(source, &root, page.as_ref())?;
        let mut scope = match &unrolled {
            Some(unrolled) => Scope::of(unrolled),
            None => scope(&painter, &root, page.as_ref())?,
        };
        scope.roots.iter_mut().for_each(|(context, _)| *context = context.clone().without(&self.options.without));
        if let Some(window) = &scope.window {
            for (context, root) in &mut scope.roots {
                *root = without_idle_clips(&painter, root, context.parent, window)?;
            }
        }
        // Periods repeat, whatever is in them.
        let parts = if unrolled.is_some() { Parts::Apart } else { self.options.parts };
        let mut found =
            select(&painter, scope.frame, (self.options.method, parts, self.options.large_fills), &scope.roots)?;
        found.items.retain(|item| !is_frame_mark(item));
        let window = scope.window.unwrap_or_else(|| frame::around(&found.items));
        if unrolled.is_some() {
            // Copies beside the window are nothing to speak of.
            found.items.retain(|item| item.outline.bounds().intersects(&window));
        }
        let window = settle(&painter, &mut found, (window, scope.window.is_some()), self.options)?;
        let job = job(&painter, &root)?;
        let is_line = |item: &Item| matches!(item.kind, Kind::Curve | Kind::Area);
        let is_curve = |item: &Item| is_line(item) && self.options.method != Method::Elements;
        let is_line: Vec<bool> = found.items.iter().map(is_curve).collect();
        let (lines, items): (Vec<Item>, Vec<Item>) = std::mem::take(&mut found.items).into_iter().partition(is_curve);
        let mut definitions = Definitions::new(source, "exemplar");
        let mut gatherer = Gatherer::new(&painter, &mut definitions, window, self.options.dashes);
        let order = Order { is_line: &is_line, lines: &lines, items: &items };
        let (meetings, levels) = order.meetings(source, &window)?;
        let leveled = lines.iter().zip(levels);
        let styles_of =
            leveled.map(|(item, level)| gathered(&mut gatherer, item, level)).collect::<Result<Vec<_>>>()?;
        let found_curves = gatherer.finish()?;
        let paints = found_curves.styles.len();
        let stack = stacked(found_curves, &window, source.budget)?;
        (0..stack.doubled).for_each(|_| source.notes.add(Note::Duplicate, String::new));
        (0..stack.surplus).for_each(|_| source.notes.add(Note::ManyPaints, String::new));
        // No edge of the window cuts anything of periods that are laid out.
        let frame = scope.window.as_ref().filter(|_| unrolled.is_none());
        let (elements, classes) = elements(source, &items, frame)?;
        if elements.is_empty() && stack.curves.is_empty() && stack.areas.is_empty() {
            return Err(nothing_found(source, &found));
        }
        let sorted = Sorted { is_line: &is_line, styles_of: &styles_of, classes: &classes, meetings: &meetings };
        let layers = layers(source, &sorted, (paints, &stack.paints))?;
        let Stacked { curves, areas, fills, styles, strokes, .. } = stack;
        let (areas, fills) = seen(source, areas, fills, &window)?;
        let contents = Contents { elements, classes: classes.classes, curves, areas, styles };
        let period = unrolled.as_ref().map(|unrolled| unrolled.period);
        let exemplar = Exemplar { period, ..Exemplar::with_curves(source.name, contents, window)? };
        let fragments = items.iter().map(|item| fragment(item, &mut definitions)).collect();
        let background = background(&found, &mut definitions);
        let understood = understood(source, &items, &lines, found.left_out);
        let definitions = definitions.finish()?;
        let page = page_of(page, window, unrolled.is_some());
        let warnings = warnings(source);
        Ok(Drawing {
            exemplar: Arc::new(exemplar),
            fragments,
            strokes,
            fills,
            layers,
            background,
            parts,
            definitions,
            page,
            job,
            understood,
            warnings,
        })
    }
}

/// What was noticed while reading.
fn warnings(source: &Source<'_>) -> Vec<Warning> {
    if source.sheet.is_exhausted() {
        source.notes.add(Note::Style, || "rules of an oversized style sheet".to_owned());
    }
    source.notes.warnings(source.name)
}

/// The page of a drawing in this window, which is all that it shows of periods that are laid out.
fn page_of(page: Option<Page>, window: Bounds<2>, is_unrolled: bool) -> Page {
    let page = page.unwrap_or(Page { view: window, unit: Unit::Px, unit_per_user: 1.0 });
    if is_unrolled { Page { view: window, ..page } } else { page }
}

impl Document<'_> {
    /// The periods that the file shows, where it is one of a pattern.
    fn periods(&self, source: &Source<'_>, root: &Rc<Node>, page: Option<&Page>) -> Result<Option<Unrolled>> {
        let layers = parts(root, Part::Exemplar);
        let roots = if layers.is_empty() { vec![(Affine::IDENTITY, Rc::clone(root))] } else { layers };
        let marked = roots.iter().find_map(|(parent, node)| frame_mark(node, *parent));
        let frame = marked.or_else(|| page.map(|page| page.view));
        periods(source, root, &roots, frame, self.options.tiling)
    }
}

/// Adds the strokes of an item, in one of the levels of its look. Returns their styles.
fn gathered(gatherer: &mut Gatherer<'_, '_, '_, '_>, item: &Item, level: usize) -> Result<Vec<usize>> {
    let before = gatherer.count();
    gatherer.level = level;
    gatherer.add(item)?;
    Ok(gatherer.styles_from(before))
}

/// What is seen of areas, with their fills: where others hide nothing of them, and in the frame.
fn seen(
    source: &Source<'_>,
    mut areas: Vec<Area<2>>,
    fills: Vec<Stroke>,
    window: &Bounds<2>,
) -> Result<(Vec<Area<2>>, Vec<Stroke>)> {
    let is_opaque = |k: usize| {
        !fills[k].paint.contains("opacity") && !fills[k].paint.contains("url(") && fills[k].effects.is_empty()
    };
    keep_visible(&mut areas, &is_opaque, source.budget)?;
    let shows = |area: &Area<2>| !area.outline.rings.is_empty() && area.outline.bounds().intersects(window);
    Ok(areas.into_iter().zip(fills).filter(|(area, _)| shows(area)).unzip())
}

/// What everything was taken for, by reasons.
fn understood(
    source: &Source<'_>,
    items: &[Item],
    lines: &[Item],
    left_out: Vec<(Reason, String, Outline<2>)>,
) -> Vec<Understood> {
    let mut all = Vec::new();
    for item in items.iter().chain(lines) {
        Understood::add(&mut all, item.reason, || item.name(source), None);
    }
    for (reason, name, outline) in left_out {
        Understood::add(&mut all, reason, || name, Some(outline));
    }
    all.sort_by_key(|known| known.reason);
    all
}

/// Where the elements are looked for.
struct Scope {
    roots: Vec<(Surroundings, Rc<Node>)>,
    /// What sizes are compared with.
    frame: Bounds<2>,
    /// The frame of the exemplar, where it is known before the elements are.
    window: Option<Bounds<2>>,
}

impl Scope {
    /// Periods that are laid out.
    fn of(unrolled: &Unrolled) -> Self {
        let roots = vec![(Surroundings::new(Affine::IDENTITY), Rc::clone(&unrolled.root))];
        Self { roots, frame: unrolled.window, window: Some(unrolled.window) }
    }
}

/// Content that covers less than this share of the page lies in a corner of it: the page is not its frame.
const CORNER: f64 = 0.4;
/// The same for a layer that is the exemplar by name.
const LAYER: f64 = 0.7;

fn scope(painter: &Painter<'_, '_>, root: &Rc<Node>, page: Option<&Page>) -> Result<Scope> {
    let layers = parts(root, Part::Exemplar);
    let by_layer = !layers.is_empty();
    let roots = if by_layer { layers } else { vec![(Affine::IDENTITY, Rc::clone(root))] };
    let content = roots.iter().fold(Bounds::EMPTY, |all, (parent, node)| all.union(&content(node, *parent)));
    let marked = roots.iter().find_map(|(parent, node)| frame_mark(node, *parent));
    let share = page.map_or(0.0, |p| content.measure() / p.view.measure());
    // The box around a straight line is not a frame, whatever its share of the page.
    let fits = page.is_some() && (frame::is_thin(&content) || share >= if by_layer { LAYER } else { CORNER });
    if !fits && marked.is_none() && page.is_some() && !by_layer && !content.is_empty() {
        painter.source.notes.add(Note::Corner, String::new);
    }
    if page.is_none() {
        painter.source.notes.add(Note::NoSize, String::new);
    }
    let window = marked.or_else(|| page.map(|p| p.view).filter(|_| fits));
    let frame = window.unwrap_or(content);
    let frame = if frame.measure() > 0.0 { frame } else { page.map_or(frame, |p| p.view) };
    let roots = roots.into_iter().map(|(parent, node)| (Surroundings::new(parent), node)).collect();
    Ok(Scope { roots, frame, window })
}

/// Box around what the selection will look at.
fn content(node: &Node, parent: Affine) -> Bounds<2> {
    if matches!(node.meta.part, Some(part) if part != Part::Exemplar) {
        return Bounds::EMPTY;
    }
    let world = parent * node.transform;
    match node.children() {
        [] => bounds(node, parent),
        children => children.iter().fold(Bounds::EMPTY, |all, child| all.union(&content(child, world))),
    }
}

/// Drops what lies outside, and refuses what cannot be handled. Returns the frame, given the one so far and whether the
/// file states it.
fn settle(
    painter: &Painter<'_, '_>,
    found: &mut Selection,
    (mut window, is_stated): (Bounds<2>, bool),
    options: &ReadOptions,
) -> Result<Bounds<2>> {
    let source = painter.source;
    let Selection { items, left_out, .. } = found;
    items.retain(|item| {
        let inside = shows(item, &window);
        if !inside {
            left_out.push((Reason::Outside, item.name(source), Outline::default()));
        }
        inside
    });
    // A pattern that was drawn by a program mostly reaches over its page; most of it beside the page is a mistake.
    if left_out.iter().filter(|(reason, ..)| *reason == Reason::Outside).count() > items.len() {
        source.notes.add(Note::Outside, String::new);
    }
    if items.len() > source.limits.elements {
        return Err(guard::over(
            format!("{}: elements", source.name),
            items.len(),
            ("elements", source.limits.elements),
        ));
    }
    if options.method != Method::Elements {
        let as_areas = options.large_fills.are_areas();
        let all_alike = options.large_fills == LargeFills::AreasAlike;
        part_outlined(&mut found.items, painter, &window, as_areas)?;
        if !all_alike {
            follow_bands(source, &mut found.items, &window)?;
        }
        if as_areas {
            take_areas(&mut found.items, &window, all_alike);
            take_gradients(source, &mut found.items, &window)?;
            take_backgrounds(found, painter, &window)?;
            window = uncover(&mut found.items, painter, &window)?;
        }
        trace(source, &mut found.items, &window)?;
        follow_by_hand(source, &mut found.items, &window)?;
        refuse_networks(source, &found.items, &window)?;
        if is_stated {
            refuse_through(source, &found.items, &window)?;
        }
    }
    for item in found.items.iter().filter(|item| item.kind == Kind::Large) {
        source.notes.add(Note::LargeElement, || item.name(source));
    }
    Ok(window)
}

/// Refuses outlines that are too large for an element and neither lines nor areas that repeat.
fn refuse_networks(source: &Source<'_>, items: &[Item], window: &Bounds<2>) -> Result<()> {
    let networks: Vec<&Item> = items.iter().filter(|item| is_network(item, window)).collect();
    if networks.is_empty() {
        return Ok(());
    }
    let named: Vec<_> = networks.iter().take(5).map(|item| item.name(source)).collect();
    let more = if networks.len() > named.len() { ", ..." } else { "" };
    let (count, s, does) = match networks.len() {
        1 => (1, "", "repeats nor is"),
        count => (count, "s", "repeat nor are"),
    };
    Err(Error::Unsupported {
        what: format!(
            "{}: going on with {count} outline{s} that reach{} several sides of the frame ({}{more}), which neither {does} \
             made of lines of one width",
            source.name,
            if count == 1 { "es" } else { "" },
            named.join(", ")
        ),
        advice: "show two whole periods of what repeats, draw lines as strokes, use --method elements to treat every connected \
                 piece as one element, or mark items with data-arabesque=\"element\" or \"ignore\""
            .into(),
    })
}

/// Whether an item is a fill that reaches over several sides of the frame.
fn is_network(item: &Item, window: &Bounds<2>) -> bool {
    let b = item.outline.bounds();
    let near = 1e-3 * extent::longer(window);
    let reaches =
        |k: usize| usize::from(b.min[k] <= window.min[k] + near) + usize::from(b.max[k] >= window.max[k] - near);
    item.kind == Kind::Large && item.origin == Origin::Piece && reaches(0) + reaches(1) >= 2
}

/// What to say when no element is left, with what may explain it.
fn nothing_found(source: &Source<'_>, found: &Selection) -> Error {
    let seen = source.notes.summary();
    let background = match found.background.len() {
        0 => String::new(),
        1 => "what covers the whole frame is background".to_owned(),
        count => format!("what covers the whole frame is background, which {count} shapes do"),
    };
    let why: Vec<&str> = [background.as_str(), seen.as_str()].into_iter().filter(|w| !w.is_empty()).collect();
    let why = if why.is_empty() { String::new() } else { format!(" ({})", why.join(", ")) };
    let advice = "draw a few shapes, groups or strokes that should be repeated";
    Error::input(source.name, format!("no element and no curve found{why}"), advice)
}

/// Centre of area of an item.
fn centre_of(item: &Item) -> Vector<2> {
    item.outline.centroid().unwrap_or_else(|| item.outline.bounds().centre())
}

fn elements(source: &Source<'_>, items: &[Item], window: Option<&Bounds<2>>) -> Result<(Vec<Element<2>>, Classes)> {
    let roles = frame::roles(items, window);
    let cut = roles.iter().filter(|r| **r == Role::Context).count();
    (0..cut).for_each(|_| source.notes.add(Note::Cut, String::new));
    let is_whole: Vec<bool> = roles.iter().map(|r| *r == Role::Source).collect();
    let classes = classes::classify(items, &is_whole, &source.sheet, source.budget)?;
    let element = |((item, role), &(class, pose)): ((&Item, Role), &(usize, _))| Element {
        class,
        centre: centre_of(item),
        pose,
        outline: item.outline.clone(),
        colour: item.painted.colour(),
        lean: item.painted.lean(centre_of(item)),
        role,
    };
    Ok((items.iter().zip(roles).zip(&classes.members).map(element).collect(), classes))
}

fn background(found: &Selection, definitions: &mut Definitions<'_, '_>) -> Option<String> {
    let mut markup = String::new();
    for (parent, node) in &found.background {
        push_placed(&mut markup, *parent, node, definitions);
    }
    (!markup.is_empty()).then_some(markup)
}

/// The layers of a whole job beside the exemplar.
fn job(painter: &Painter<'_, '_>, root: &Rc<Node>) -> Result<Job> {
    let area = |part, name| {
        let nodes = parts(root, part);
        let place = format!("{}: layer \"{name}\"", painter.source.name);
        if nodes.is_empty() { Ok(None) } else { shape(painter, &place, &nodes, None).map(Some) }
    };
    Ok(Job {
        domain: area(Part::Domain, "Domain")?,
        avoid: area(Part::Avoid, "Avoid")?,
        flow: strokes(painter, &parts(root, Part::Flow))?,
    })
}
