//! A parsed SVG file with everything needed to look things up in it.

use std::{
    cell::{Cell, RefCell},
    collections::BTreeMap,
    rc::Rc,
};

use arabesque_core::{Budget, Error, Limits, Result};
use roxmltree::{Document, Node as Xml, NodeId, ParsingOptions};

use crate::svg::{
    namespace::{SVG, XLINK},
    options::ReadOptions,
    parse::{
        css::{self, StyleRules},
        guard,
        notes::{Note, Notes},
        sheet::rules::{self, Plain},
    },
};
use crate::{file::text_called, text::short::short};

/// Work units of reading one path segment.
const SEGMENT: u64 = 100;
/// Work units of reading one node.
const NODE: u64 = 1000;
/// Bytes of one node.
const NODE_BYTES: usize = 700;
/// Work units of comparing an element with a part of a selector.
const STEP: u64 = 10;

/// A parsed file. A clone shares what was parsed, and goes on from the notes and counts so far by itself.
#[derive(Clone)]
pub(crate) struct Source<'a> {
    pub(crate) name: &'a str,
    pub(crate) limits: &'a Limits,
    pub(crate) budget: &'a Budget,
    pub(crate) text: &'a str,
    pub(crate) xml: &'a Document<'a>,
    pub(crate) sheet: StyleRules<'a>,
    /// Values of the sheet that stand there by their number.
    pub(crate) values: &'a [String],
    pub(crate) notes: Notes,
    ids: Rc<BTreeMap<&'a str, NodeId>>,
    /// Where in the text each line ends.
    line_ends: Rc<[usize]>,
    /// Fill and stroke of the shape whose marker is being built: what `context-fill` and `context-stroke` mean.
    pub(crate) context: RefCell<Option<[Rc<str>; 2]>>,
    /// Path segments read so far, against the limit.
    segments: Cell<usize>,
    /// Scene nodes made so far, against the limit.
    nodes: Cell<usize>,
    /// Bytes that they take, against the limit.
    bytes: Cell<usize>,
    /// Steps of matching style rules that are paid.
    matched: Cell<u64>,
    /// Mean colours of gradients, by the node that has the stops.
    pub(crate) colours: RefCell<BTreeMap<u32, Option<[f64; 3]>>>,
}

/// Parses `text` and hands it to `work`: what was parsed borrows the text, so it cannot outlive this call.
pub(crate) fn with_source<T>(
    text: &str,
    options: &ReadOptions,
    work: impl FnOnce(&Source<'_>) -> Result<T>,
) -> Result<T> {
    let (name, limits) = (options.name.as_str(), options.budget.limits());
    options.budget.check()?;
    guard::check(text, name, limits)?;
    check_kind(name, text)?;
    let parsing = ParsingOptions {
        allow_dtd: true,
        nodes_limit: u32::try_from(limits.nodes).unwrap_or(u32::MAX),
        entity_resolver: None,
    };
    let xml = Document::parse_with_options(text, parsing).map_err(|e| unreadable(name, limits, &e))?;
    if xml.root_element().tag_name().name() != "svg" {
        let found = xml.root_element().tag_name().name().to_owned();
        return Err(Error::input(name, format!("the root is <{found}>, expected <svg>"), "give an SVG file"));
    }
    let css = style_text(&xml);
    let Plain { css: plain, values, unknown } = rules::plain(&css);
    let plain = css::sparing_comments(plain);
    let source = Source {
        name,
        limits,
        budget: &options.budget,
        text,
        xml: &xml,
        sheet: StyleRules::new(&plain),
        values: &values,
        notes: Notes::default(),
        ids: Rc::new(ids(&xml)),
        line_ends: text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(at, _)| at).collect(),
        context: RefCell::default(),
        segments: Cell::new(0),
        nodes: Cell::new(0),
        bytes: Cell::new(0),
        matched: Cell::new(0),
        colours: RefCell::default(),
    };
    source.note_outside_styles(&css);
    unknown.iter().for_each(|what| source.notes.add(Note::Selector, || short(what)));
    if xml.root_element().tag_name().namespace() != Some(SVG) {
        source.notes.add(Note::NoNamespace, String::new);
    }
    work(&source).map_err(|error| in_file(name, error))
}

/// The same error with the name of the file, where it speaks of an outline or a stage only.
fn in_file(file: &str, error: Error) -> Error {
    match error {
        Error::Limit { what, found, limit, advice } if !what.contains(file) => {
            Error::Limit { what: format!("{file}: {what}"), found, limit, advice }
        }
        Error::Input { place, problem, advice } if !place.contains(file) => {
            Error::Input { place: format!("{file}: {place}"), problem, advice }
        }
        error => error,
    }
}

/// Refuses what is no markup by what it is: what the parser says of it helps nobody.
fn check_kind(name: &str, text: &str) -> Result<()> {
    if text.trim_start().starts_with('<') {
        return Ok(());
    }
    Err(Error::input(name, format!("{}, where SVG was expected", text_called(text)), "give an SVG file"))
}

fn unreadable(name: &str, limits: &Limits, error: &roxmltree::Error) -> Error {
    if matches!(error, roxmltree::Error::NodesLimitReached) {
        return guard::over_nodes(name, limits);
    }
    let place = format!("{name}:{}", error.pos());
    Error::input(place, format!("not well-formed XML: {error}"), "open the file in a drawing program and save it again")
}

fn ids<'a>(xml: &'a Document<'a>) -> BTreeMap<&'a str, NodeId> {
    let mut ids = BTreeMap::new();
    for node in xml.descendants().filter(Xml::is_element) {
        if let Some(id) = node.attribute("id") {
            ids.entry(id).or_insert(node.id());
        }
    }
    ids
}

/// The text of all style sheets in the file, one after the other.
fn style_text(xml: &Document<'_>) -> String {
    let mut css = String::new();
    for style in xml.descendants().filter(|n| n.has_tag_name((SVG, "style")) || n.has_tag_name("style")) {
        let kind = style.attribute("type").unwrap_or("text/css");
        if kind.is_empty() || kind.eq_ignore_ascii_case("text/css") {
            style.descendants().filter_map(|n| n.is_text().then(|| n.text()).flatten()).for_each(|t| css.push_str(t));
            css.push('\n');
        }
    }
    css.replace("<!--", " ").replace("-->", " ")
}

impl<'a> Source<'a> {
    /// Whether an id is that prefix with something after it.
    pub(crate) fn has_ids_in(&self, prefix: &str) -> bool {
        self.ids.range(prefix..).next().is_some_and(|(id, _)| id.starts_with(prefix) && id.len() > prefix.len())
    }

    fn note_outside_styles(&self, css: &str) {
        for rule in css.split("@import").skip(1) {
            let what: String = rule.trim_start().chars().take_while(|c| !matches!(c, ';' | '\n')).take(80).collect();
            self.notes.add(Note::External, || format!("@import {what}"));
        }
        for node in self.xml.root().children() {
            if let Some(pi) = node.pi().filter(|pi| pi.target == "xml-stylesheet") {
                self.notes.add(Note::External, || format!("style sheet {}", pi.value.unwrap_or_default()));
            }
        }
    }

    /// The line that a node begins in. Counted once for all of them: with thousands of nodes to be named, each of them would be
    /// another way through the text.
    pub(crate) fn line(&self, node: &Xml<'_, '_>) -> usize {
        let start = node.range().start;
        self.line_ends.partition_point(|end| *end < start) + 1
    }

    /// File, line and tag of a node, for messages.
    pub(crate) fn place(&self, node: Xml<'_, '_>) -> String {
        let line = self.line(&node);
        let id = node.attribute("id").map_or_else(String::new, |id| format!(" id=\"{}\"", clip_text(id, 40)));
        format!("{}:{line}: <{}{id}>", self.name, node.tag_name().name())
    }

    /// The node with an id.
    pub(crate) fn by_id(&self, id: &str) -> Option<Xml<'a, 'a>> {
        self.xml.get_node(*self.ids.get(id)?)
    }

    /// Whether the node belongs to the drawing rather than to an editor.
    pub(crate) fn is_svg(&self, node: Xml<'_, '_>) -> bool {
        node.is_element() && matches!(node.tag_name().namespace(), None | Some(SVG))
    }

    /// The node that `href` leads to; a reference that leaves the file or dangles is noted.
    pub(crate) fn target(&self, node: Xml<'a, 'a>) -> Option<Xml<'a, 'a>> {
        let href = href(node)?.trim();
        let Some(id) = href.strip_prefix('#') else {
            self.notes.add(Note::External, || clip_text(href, 80).to_owned());
            return None;
        };
        let found = self.by_id(id);
        if found.is_none() {
            self.notes.add(Note::Missing, || format!("#{}", clip_text(id, 60)));
        }
        found
    }

    /// Counts `more` path segments against the limit.
    pub(crate) fn count_segments(&self, more: usize) -> Result<()> {
        self.foresee_segments(more)?;
        self.segments.set(self.segments.get() + more);
        self.budget.spend(SEGMENT * more as u64)
    }

    /// Whether `more` path segments would still be within the limit.
    pub(crate) fn foresee_segments(&self, more: usize) -> Result<()> {
        let total = self.segments.get().saturating_add(more);
        if total > self.limits.segments {
            return Err(guard::over(
                format!("{}: path segments", self.name),
                total,
                ("segments", self.limits.segments),
            ));
        }
        self.budget.foresee(SEGMENT * more as u64)
    }

    /// Counts one node of the drawing, `<use>` resolved, against the limit.
    pub(crate) fn count_node(&self) -> Result<()> {
        self.nodes.set(self.nodes.get() + 1);
        if self.nodes.get() > self.limits.nodes {
            let what = format!("{}: nodes after <use> is resolved", self.name);
            return Err(guard::over(what, self.nodes.get(), ("nodes", self.limits.nodes)));
        }
        self.count_bytes(NODE_BYTES)?;
        let steps = self.sheet.steps();
        self.budget.spend(NODE + STEP * (steps - self.matched.replace(steps)))?;
        if self.sheet.is_exhausted() {
            let what = format!("{}: style rules and the elements they are compared with", self.name);
            return Err(guard::too_much(what, steps, css::STEPS));
        }
        Ok(())
    }

    /// Counts `more` bytes of the drawing against the limit.
    pub(crate) fn count_bytes(&self, more: usize) -> Result<()> {
        let total = self.bytes.get().saturating_add(more);
        self.bytes.set(total);
        self.budget.within(
            &format!("{}: bytes of the drawing, <use> resolved", self.name),
            total,
            ("memory", self.limits.memory),
        )
    }
}

/// The reference of a node, `xlink:href` or `href`.
pub(crate) fn href<'a>(node: Xml<'a, 'a>) -> Option<&'a str> {
    node.attribute("href").or_else(|| node.attribute((XLINK, "href")))
}

/// The first `most` characters of a text.
pub(crate) fn clip_text(text: &str, most: usize) -> &str {
    text.char_indices().nth(most).map_or(text, |(end, _)| &text[..end])
}
