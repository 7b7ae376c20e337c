//! Finding the elements that a result placed.

use std::{collections::BTreeMap, str::FromStr};

use arabesque_core::{Bounds, Budget, Error, Matrix, Outline, Result, Similarity, Vector};

use super::{
    line::Line,
    shapes::{Shape, shapes},
};
use crate::{
    placed::layout::{Item, Layout, PER_BYTE, PER_ITEM},
    svg::{
        namespace::{INKSCAPE, NAMESPACE},
        options::ReadOptions,
        parse::guard,
    },
};

type Xml<'a, 'b> = roxmltree::Node<'a, 'b>;

/// A result in SVG, with the elements in it.
#[derive(Debug)]
pub struct SvgElements {
    pub(super) text: String,
    /// What the ids of the result begin with.
    pub(super) prefix: String,
    pub(super) layout: Layout<2>,
    /// The elements as they are written, in the order of the layout.
    pub(super) drawn: Vec<Drawn>,
    /// Definitions of elements, by id.
    pub(super) definitions: BTreeMap<String, Definition>,
    /// Where the element of the recipe stands.
    pub(super) recipe: Option<std::ops::Range<usize>>,
}

/// An element as it is written: once, or on a tile as often as it is seen.
#[derive(Debug)]
pub(super) struct Drawn {
    pub(super) lines: Vec<Line>,
    /// How far each is from the first, where they are drawn in place.
    pub(super) apart: Vec<Vector<2>>,
    /// The definition that it shows; none for what is drawn in place.
    pub(super) shows: Option<String>,
}

/// A definition of an element.
#[derive(Debug)]
pub(super) struct Definition {
    pub(super) line: Line,
    pub(super) outline: Outline<2>,
    /// The element of the exemplar that it is.
    pub(super) source: Option<usize>,
}

/// What a text holds, before anything is measured.
struct Found {
    prefix: String,
    drawn: BTreeMap<usize, Raw>,
    order: Vec<usize>,
    definitions: BTreeMap<String, Line>,
    recipe: Option<std::ops::Range<usize>>,
    page: Bounds<2>,
    /// A small file with the shapes alone.
    shapes: String,
}

/// An element before anything is measured.
struct Raw {
    /// As often as it is written, with the number of the copy.
    lines: Vec<(usize, Line)>,
    class: String,
    source: Option<usize>,
    shows: Option<String>,
    kept: bool,
}

impl SvgElements {
    /// The elements of a result; `is_tile` says that its opposite edges meet.
    ///
    /// # Errors
    /// [`Error::Input`] for a text that is no SVG, or without elements that arabesque placed; [`Error::Limit`] for too large a file.
    pub fn open(name: &str, text: String, is_tile: bool, budget: &Budget) -> Result<Self> {
        let budget = budget.stage("reading elements");
        budget.spend(PER_BYTE.saturating_mul(text.len() as u64))?;
        guard::check(&text, name, budget.limits())?;
        let mut found = find(name, &text, &budget)?;
        let options = ReadOptions { budget: budget.clone(), ..ReadOptions::new(name) };
        let known = shapes(&found.shapes, &options, |id| found.definitions.contains_key(id))?;
        let mut layout = Layout {
            items: Vec::with_capacity(found.order.len()),
            classes: Vec::new(),
            frame: found.page,
            is_tile,
            turns: true,
            paints: true,
            next: found.order.iter().max().map_or(0, |id| id + 1),
        };
        let mut numbers = BTreeMap::new();
        let mut drawn = Vec::with_capacity(found.order.len());
        for &id in &found.order {
            budget.spend(PER_ITEM)?;
            let Some(mut raw) = found.drawn.remove(&id) else { continue };
            raw.lines.sort_by_key(|(copy, _)| *copy);
            let class = *numbers.entry(raw.class.clone()).or_insert_with(|| {
                layout.classes.push(raw.class.clone());
                layout.classes.len() - 1
            });
            layout.items.push(item(name, (id, class), &raw, &text, &known)?);
            let apart = if raw.shows.is_none() { apart(&raw, &text, &known) } else { Vec::new() };
            drawn.push(Drawn { lines: raw.lines.into_iter().map(|(_, line)| line).collect(), apart, shows: raw.shows });
        }
        let definition = |(id, line): (String, Line)| {
            let outline = known.get(&id).map(|shape| shape.outline.clone()).unwrap_or_default();
            let source = source_of(&id, &found.prefix);
            (id, Definition { line, outline, source })
        };
        let definitions = std::mem::take(&mut found.definitions).into_iter().map(definition).collect();
        Ok(Self { prefix: found.prefix, layout, drawn, definitions, recipe: found.recipe, text })
    }
}

/// An element, measured.
fn item(
    name: &str,
    (id, class): (usize, usize),
    raw: &Raw,
    text: &str,
    known: &BTreeMap<String, Shape>,
) -> Result<Item<2>> {
    let (_, line) = &raw.lines[0];
    let place = transform_of(line.raw("transform", text)).ok_or_else(|| {
        let problem = format!("element {id} is sheared, mirrored or stretched, or its transform is none");
        Error::input(name, problem, "edit a result as arabesque wrote it")
    })?;
    let shape = match &raw.shows {
        Some(definition) => known.get(definition),
        None => line.raw("id", text).and_then(|id| known.get(id)),
    };
    let (centre, reach) = match (shape, &raw.shows) {
        (Some(shape), Some(_)) => (place.apply(shape.centre), shape.reach * place.scale),
        // What is drawn in place is measured where it is.
        (Some(shape), None) => (shape.centre, shape.reach),
        (None, _) => (place.translation, 0.0),
    };
    Ok(Item { id, class, source: raw.source, place, centre, reach, kept: raw.kept })
}

/// How far the copies of an element that is drawn in place are from the first.
fn apart(raw: &Raw, text: &str, known: &BTreeMap<String, Shape>) -> Vec<Vector<2>> {
    let centre = |line: &Line| line.raw("id", text).and_then(|id| known.get(id)).map(|shape| shape.centre);
    let first = raw.lines.first().and_then(|(_, line)| centre(line));
    raw.lines.iter().map(|(_, line)| centre(line).zip(first).map_or(Vector::ZERO, |(at, first)| at - first)).collect()
}

/// A transform that turns, scales and shifts alone; nothing at all is the identity.
pub(super) fn transform_of(raw: Option<&str>) -> Option<Similarity<2>> {
    let Some(raw) = raw else { return Some(Similarity::identity()) };
    let t = svgtypes::Transform::from_str(raw).ok()?;
    let all = [t.a, t.b, t.c, t.d, t.e, t.f];
    let scale = (t.a * t.d - t.b * t.c).sqrt();
    if !(all.iter().all(|v| v.is_finite()) && scale > 0.0) {
        return None;
    }
    let (skew, stretch) = ((t.b + t.c).abs(), (t.a - t.d).abs());
    if skew.max(stretch) > 1e-3 * scale + 1e-5 {
        return None;
    }
    let rotation = Matrix([[t.a, t.c], [t.b, t.d]].map(|row| row.map(|v| v / scale)));
    Some(Similarity { rotation, scale, translation: Vector::xy(t.e, t.f) })
}

fn unreadable(name: &str, budget: &Budget, error: &roxmltree::Error) -> Error {
    match error {
        roxmltree::Error::NodesLimitReached => guard::over_nodes(name, budget.limits()),
        error => Error::input(name, error.to_string(), "choose a result that arabesque wrote as SVG"),
    }
}

fn find(name: &str, text: &str, budget: &Budget) -> Result<Found> {
    let parsing = roxmltree::ParsingOptions {
        nodes_limit: u32::try_from(budget.limits().nodes).unwrap_or(u32::MAX),
        ..roxmltree::ParsingOptions::default()
    };
    let document =
        roxmltree::Document::parse_with_options(text, parsing).map_err(|error| unreadable(name, budget, &error))?;
    let root = document.root_element();
    let none =
        || Error::input(name, "no element that arabesque placed", "edit a result of arabesque that has elements");
    let prefix = prefix_of(root).ok_or_else(none)?;
    let mut found = Found {
        drawn: BTreeMap::new(),
        order: Vec::new(),
        definitions: BTreeMap::new(),
        recipe: root.descendants().find(|n| n.has_tag_name((NAMESPACE, "recipe"))).map(|n| n.range()),
        page: page_of(root),
        shapes: String::new(),
        prefix,
    };
    let layers: Vec<_> = root.descendants().filter(|n| is_output(*n, &found.prefix)).collect();
    for layer in layers {
        for node in layer.children().filter(Xml::is_element) {
            budget.spend(PER_ITEM)?;
            found.take(node, text);
        }
    }
    if found.drawn.is_empty() {
        return Err(none());
    }
    budget.within(&format!("{name}: elements"), found.drawn.len(), ("elements", budget.limits().elements))?;
    found.define(root, text);
    Ok(found)
}

impl Found {
    /// Takes a node of the layer of what was made, if it is an element.
    fn take(&mut self, node: Xml<'_, '_>, text: &str) {
        let Some((id, copy)) = node.attribute("id").and_then(|id| numbers_of(id, &self.prefix)) else { return };
        let Some(class) = node.attribute("data-arabesque-class") else { return };
        let line = (copy, Line::new(node, text));
        if let Some(raw) = self.drawn.get_mut(&id) {
            raw.lines.push(line);
            return;
        }
        let shows = node.has_tag_name("use").then(|| {
            let link = node.attributes().find(|a| a.name() == "href").map(|a| a.value());
            link.and_then(|link| link.trim().strip_prefix('#')).unwrap_or_default().to_owned()
        });
        let source = node.attribute("data-arabesque-source").and_then(|s| s.trim().parse().ok());
        let kept = node.attribute("data-arabesque-kept").is_some();
        let raw = Raw { lines: vec![line], class: class.to_owned(), source, shows, kept };
        self.drawn.insert(id, raw);
        self.order.push(id);
    }

    /// Finds the definitions, and puts the shapes together that are to be measured.
    fn define(&mut self, root: Xml<'_, '_>, text: &str) {
        let tag_end = root.first_child().map_or(root.range().end, |child| child.range().start);
        let (mut others, mut shapes) = (String::new(), String::new());
        for defs in root.descendants().filter(|n| n.tag_name().name() == "defs") {
            for node in defs.children().filter(Xml::is_element) {
                let id = node.attribute("id").filter(|id| source_of(id, &self.prefix).is_some());
                match id {
                    Some(id) => {
                        shapes.push_str(&text[node.range()]);
                        self.definitions.insert(id.to_owned(), Line::new(node, text));
                    }
                    None => others.push_str(&text[node.range()]),
                }
            }
        }
        let in_place = self.drawn.values().filter(|raw| raw.shows.is_none()).flat_map(|raw| &raw.lines);
        in_place.for_each(|(_, line)| shapes.push_str(&text[line.range.clone()]));
        self.shapes = format!("{}<defs>{others}</defs>{shapes}</svg>", &text[root.range().start..tag_end]);
    }
}

/// Number and copy in the id of an element.
fn numbers_of(id: &str, prefix: &str) -> Option<(usize, usize)> {
    let rest = id.strip_prefix(prefix)?.strip_prefix('-')?;
    let (id, copy) = rest.split_once('-').unwrap_or((rest, "0"));
    Some((id.parse().ok()?, copy.parse().ok()?))
}

/// The element of the exemplar in the id of a definition.
fn source_of(id: &str, prefix: &str) -> Option<usize> {
    let rest = id.strip_prefix(prefix)?.strip_prefix("-element-")?;
    rest.split('-').next()?.parse().ok()
}

fn is_output(node: Xml<'_, '_>, prefix: &str) -> bool {
    let is_layer = node.attribute((INKSCAPE, "groupmode")) == Some("layer");
    let id = node.attribute("id").and_then(|id| id.strip_prefix(prefix));
    is_layer && id.is_some_and(|id| id.starts_with("-output"))
}

/// The prefix of the last result that was written into the file.
fn prefix_of(root: Xml<'_, '_>) -> Option<String> {
    let prefix = |node: Xml<'_, '_>| {
        let (prefix, _) = node.attribute("id")?.split_once("-output")?;
        let number = prefix.strip_prefix("arabesque")?;
        let number: u64 = if number.is_empty() { 1 } else { number.parse().ok()? };
        is_output(node, prefix).then(|| (number, prefix.to_owned()))
    };
    root.descendants().filter_map(prefix).max().map(|(_, prefix)| prefix)
}

/// What the page shows.
fn page_of(root: Xml<'_, '_>) -> Bounds<2> {
    let view = root.attribute("viewBox").and_then(|view| svgtypes::ViewBox::from_str(view).ok());
    match view {
        Some(v) => Bounds::new(Vector::xy(v.x, v.y), Vector::xy(v.x + v.w, v.y + v.h)),
        None => Bounds::EMPTY,
    }
}
