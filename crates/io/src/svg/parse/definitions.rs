//! Definitions that fragments refer to: gradients, patterns, clips, masks, filters; copied with ids of their own.

use std::{
    collections::{BTreeMap, VecDeque},
    fmt::Write as _,
    rc::Rc,
};

use arabesque_core::{Error, Result};
use kurbo::Rect;
use roxmltree::{Node as Xml, NodeId};
use svgtypes::Length;

use crate::{
    svg::parse::{
        geometry::{self, Geometry},
        guard,
        length::{Axis, Viewport},
        notes::Note,
        paint::{fraction, reference},
        source::{Source, clip_text, href},
        style::{ComputedStyle, Own, computed},
    },
    text::xml::{number, push_attribute},
};

/// A stop of a gradient: where it is, from 0 to 1, and its properties as attributes.
pub(crate) type Stop = (f64, String);

/// A linear gradient that begins anew at every step.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RepeatedGradient {
    /// Where one of them begins, in the coordinates of the root.
    pub(crate) start: [f64; 2],
    /// From there to where the next begins.
    pub(crate) step: [f64; 2],
    /// The share of the step that the stops are spread over; before and after them, the nearest goes on.
    pub(crate) share: f64,
    pub(crate) stops: Rc<[Stop]>,
}

/// The stops that a gradient has itself.
pub(crate) fn stops<'a>(source: &Source<'a>, node: Xml<'a, 'a>, viewport: Viewport) -> Vec<Stop> {
    let all = node.children().filter(|n| n.tag_name().name() == "stop");
    all.map(|stop| (fraction(stop.attribute("offset").unwrap_or("0")), stop_properties(source, stop, viewport)))
        .collect()
}

/// The properties of a stop as attributes.
fn stop_properties<'a>(source: &Source<'a>, stop: Xml<'a, 'a>, viewport: Viewport) -> String {
    let mut style = Rc::new(ComputedStyle::default());
    let mut own = Own::default();
    let mut chain: Vec<_> = stop.ancestors().filter(Xml::is_element).collect();
    chain.reverse();
    for node in chain {
        (style, own) = computed(source, node, &style, viewport);
    }
    let mut out = String::new();
    for (name, value) in own.iter().filter(|(name, _)| name.starts_with("stop-")) {
        push_attribute(&mut out, name, value);
    }
    out
}

/// The definitions of one file that are referred to, by their new ids.
pub(crate) struct Definitions<'a, 's> {
    source: &'s Source<'a>,
    prefix: String,
    names: BTreeMap<String, String>,
    queue: VecDeque<(NodeId, String, Viewport)>,
    /// Clips by rectangles: their markup, and which of them it is.
    rectangles: BTreeMap<String, usize>,
    /// Gradients that begin anew at every step: all but their ids, and which of them each is.
    repeated: BTreeMap<String, usize>,
    /// The stops that gradients have themselves, written.
    stops: BTreeMap<u32, Rc<str>>,
    /// What drawing each definition takes, in nodes.
    weights: BTreeMap<u32, usize>,
    /// What went wrong with one of them.
    failed: Option<Error>,
}

/// Work for writing one byte, and for weighing one node.
const PER_BYTE: u64 = 10;
const NODE: u64 = 200;

/// Tags that may be copied into definitions.
const COPIED: [&str; 10] =
    ["linearGradient", "radialGradient", "stop", "pattern", "clipPath", "mask", "g", "use", "symbol", "filter"];

impl<'a, 's> Definitions<'a, 's> {
    /// No definitions yet; new ids will start with `prefix`, numbered where ids of the file start so.
    pub(crate) fn new(source: &'s Source<'a>, prefix: &str) -> Self {
        let numbered = (2..).map(|n| format!("{prefix}{n}"));
        let mut prefixes = std::iter::once(prefix.to_owned()).chain(numbered);
        let prefix = prefixes.find(|p| !source.has_ids_in(p)).unwrap_or_else(|| prefix.to_owned());
        Self {
            source,
            prefix,
            names: BTreeMap::new(),
            queue: VecDeque::new(),
            rectangles: BTreeMap::new(),
            repeated: BTreeMap::new(),
            stops: BTreeMap::new(),
            weights: BTreeMap::new(),
            failed: None,
        }
    }

    /// The new id of a definition with one of the given tags (any where none is given), which is queued to be copied;
    /// `None` when the id leads to none.
    fn refer(&mut self, id: &str, tags: &[&str], viewport: Viewport) -> Option<String> {
        let fits = |node: &Xml<'_, '_>| tags.is_empty() || tags.contains(&node.tag_name().name());
        let Some(node) = self.source.by_id(id).filter(fits) else {
            self.source.notes.add(Note::Missing, || format!("#{}", clip_text(id, 60)));
            return None;
        };
        if let Some(name) = self.names.get(id) {
            return Some(name.clone());
        }
        let plain = id.len() <= 60 && id.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.'));
        // A number can follow the prefix only where the id is not plain: plain ids keep their own name after `-`.
        let name = if plain { format!("{}-{id}", self.prefix) } else { format!("{}{}", self.prefix, self.names.len()) };
        self.names.insert(id.to_owned(), name.clone());
        if let Err(error) = self.weigh(node, 0) {
            self.failed.get_or_insert(error);
        }
        self.queue.push_back((node.id(), name.clone(), viewport));
        Some(name)
    }

    /// How many nodes drawing a definition takes, what it refers to counted each time; a cycle counts once.
    fn weigh(&mut self, node: Xml<'a, 'a>, depth: usize) -> Result<usize> {
        if let Some(&known) = self.weights.get(&node.id().get()) {
            return Ok(known);
        }
        let limits = self.source.limits;
        if depth > limits.depth {
            let what = format!("{}: definitions that refer to each other in a chain", self.source.name);
            return Err(guard::over(what, depth, ("depth", limits.depth)));
        }
        self.weights.insert(node.id().get(), 0);
        let mut weight = 0_usize;
        for inner in node.descendants().filter(Xml::is_element) {
            self.source.budget.spend(NODE)?;
            weight = weight.saturating_add(1);
            for target in inner.attributes().flat_map(|attribute| targets(attribute.value())) {
                if let Some(target) = self.source.by_id(target) {
                    weight = weight.saturating_add(self.weigh(target, depth + 1)?);
                }
            }
        }
        if weight > limits.nodes {
            let what = format!("{}: nodes of a definition, references resolved", self.source.name);
            return Err(guard::over(what, weight, ("nodes", limits.nodes)));
        }
        self.weights.insert(node.id().get(), weight);
        Ok(weight)
    }

    fn checked<'v>(&self, value: &'v str) -> Option<(&'v str, &'v str)> {
        match reference(value)? {
            Ok(found) => Some(found),
            Err(outside) => {
                self.source.notes.add(Note::External, || clip_text(outside, 60).to_owned());
                None
            }
        }
    }

    /// A paint that refers to a gradient or pattern, with the new id; its fallback where it leads nowhere.
    pub(crate) fn paint(&mut self, value: &str, viewport: Viewport) -> String {
        let Some((id, fallback)) = self.checked(value) else { return "none".into() };
        let fallback = if fallback.is_empty() { "none" } else { fallback };
        match self.refer(id, &["linearGradient", "radialGradient", "pattern"], viewport) {
            Some(name) => format!("url(#{name})"),
            None => fallback.to_owned(),
        }
    }

    /// The value of the property `name` (clip-path, mask or filter) with the new id; `None` where it leads nowhere.
    pub(crate) fn effect(&mut self, name: &str, value: &str, viewport: Viewport) -> Option<String> {
        let (id, _) = self.checked(value)?;
        let tag = if name == "clip-path" { "clipPath" } else { name };
        Some(format!("url(#{})", self.refer(id, &[tag], viewport)?))
    }

    /// A reference to a gradient that begins anew at every step.
    pub(crate) fn repeated(&mut self, gradient: &RepeatedGradient) -> String {
        let RepeatedGradient { start: [x, y], step: [dx, dy], share, stops } = gradient;
        let mut text = String::from(" gradientUnits=\"userSpaceOnUse\" spreadMethod=\"repeat\"");
        for (name, value) in [("x1", *x), ("y1", *y), ("x2", x + dx), ("y2", y + dy)] {
            push_attribute(&mut text, name, &number(value));
        }
        text.push('>');
        let mut stop = |at: f64, properties: &str| {
            let _ = write!(text, "<stop offset=\"{}\"{properties}/>", number(at));
        };
        stops.iter().for_each(|(at, properties)| stop(at * share, properties));
        if let (Some((_, first)), Some((_, last)), true) = (stops.first(), stops.last(), *share < 1.0) {
            let middle = 0.5 * (1.0 + share);
            [(middle, last), (middle, first), (1.0, first)].into_iter().for_each(|(at, p)| stop(at, p));
        }
        let number = self.repeated.len();
        let number = *self.repeated.entry(text).or_insert(number);
        format!("url(#{}-repeat_{number})", self.prefix)
    }

    /// A reference to a clip by a rectangle.
    pub(crate) fn rectangle(&mut self, clip: &Rect) -> String {
        let [x, y, w, h] = [clip.x0, clip.y0, clip.width(), clip.height()].map(number);
        let shape = format!("<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"/>");
        let number = self.rectangles.len();
        let number = *self.rectangles.entry(shape).or_insert(number);
        format!("url(#{}-viewport_{number})", self.prefix)
    }

    /// The markup of everything referred to, and of what that refers to in turn.
    ///
    /// # Errors
    /// [`Error::Limit`] when it is too long, or when drawing it would take too many nodes.
    pub(crate) fn finish(mut self) -> Result<String> {
        let mut out = String::new();
        while let Some((id, name, viewport)) = self.queue.pop_front() {
            let before = out.len();
            if let Some(error) = self.failed.take() {
                return Err(error);
            }
            if let Some(node) = self.source.xml.get_node(id) {
                self.copy_root(&mut out, node, &name, viewport);
            }
            if out.len() == before {
                // What is referred to draws nothing; the reference must not dangle.
                let _ = write!(out, "<g id=\"{name}\"/>");
            }
            self.source.count_bytes(out.len() - before)?;
            self.source.budget.spend(PER_BYTE * (out.len() - before) as u64)?;
        }
        let mut rectangles: Vec<_> = self.rectangles.iter().map(|(shape, number)| (number, shape)).collect();
        rectangles.sort();
        for (number, shape) in rectangles {
            let _ = write!(out, "<clipPath id=\"{}-viewport_{number}\">{shape}</clipPath>", self.prefix);
        }
        let mut repeated: Vec<_> = self.repeated.iter().map(|(text, number)| (number, text)).collect();
        repeated.sort();
        for (number, text) in repeated {
            let _ = write!(out, "<linearGradient id=\"{}-repeat_{number}\"{text}</linearGradient>", self.prefix);
        }
        self.failed.map_or(Ok(out), Err)
    }

    fn copy_root(&mut self, out: &mut String, node: Xml<'a, 'a>, name: &str, viewport: Viewport) {
        let mut style = Rc::new(ComputedStyle::default());
        let mut chain: Vec<_> = node.ancestors().skip(1).filter(Xml::is_element).collect();
        chain.reverse();
        for ancestor in chain {
            (style, _) = computed(self.source, ancestor, &style, viewport);
        }
        if node.tag_name().name().ends_with("Gradient") {
            self.gradient(out, node, name, viewport);
        } else {
            self.copy(out, node, Some(name), &Inherited { style, viewport });
        }
    }

    /// A gradient with everything that it takes from others written into it.
    fn gradient(&mut self, out: &mut String, node: Xml<'a, 'a>, name: &str, viewport: Viewport) {
        let chain = self.chain(node);
        let tag = node.tag_name().name();
        let find = |attribute: &str| chain.iter().find_map(|n| n.attribute(attribute));
        let _ = write!(out, "<{tag} id=\"{name}\"");
        let in_user_space = find("gradientUnits") == Some("userSpaceOnUse");
        for attribute in ["gradientUnits", "gradientTransform", "spreadMethod"] {
            find(attribute).into_iter().for_each(|value| push_attribute(out, attribute, value));
        }
        let geometry: &[Coordinate] = if tag == "linearGradient" { &LINEAR } else { &RADIAL };
        for &Coordinate { attribute, axis, initial } in geometry {
            let value = chain.iter().filter(|n| n.tag_name().name() == tag).find_map(|n| n.attribute(attribute));
            if let Some(value) = value.or(if in_user_space { initial } else { None }) {
                push_attribute(out, attribute, &in_space(value, axis, viewport, in_user_space));
            }
        }
        out.push('>');
        if let Some(with_stops) = chain.iter().find(|n| n.children().any(|c| c.tag_name().name() == "stop")) {
            // Many gradients may share theirs.
            let known = self.stops.get(&with_stops.id().get()).cloned();
            let text = known.unwrap_or_else(|| self.stops_of(*with_stops, viewport));
            self.stops.insert(with_stops.id().get(), Rc::clone(&text));
            out.push_str(&text);
        }
        let _ = write!(out, "</{tag}>");
    }

    fn stops_of(&self, node: Xml<'a, 'a>, viewport: Viewport) -> Rc<str> {
        let mut out = String::new();
        for stop in node.children().filter(|n| n.tag_name().name() == "stop") {
            self.stop(&mut out, stop, viewport);
        }
        out.into()
    }

    fn stop(&self, out: &mut String, stop: Xml<'a, 'a>, viewport: Viewport) {
        out.push_str("<stop");
        push_attribute(out, "offset", stop.attribute("offset").unwrap_or("0"));
        out.push_str(&stop_properties(self.source, stop, viewport));
        out.push_str("/>");
    }

    /// A gradient or pattern and those it refers to, in turn.
    fn chain(&self, node: Xml<'a, 'a>) -> Vec<Xml<'a, 'a>> {
        let mut chain = vec![node];
        while let Some(next) = chain.last().filter(|n| href(**n).is_some()).and_then(|n| self.source.target(*n)) {
            if chain.iter().any(|n| n.id() == next.id()) {
                self.source.notes.add(Note::Cycle, || self.source.place(next));
                break;
            }
            if chain.len() > 32 {
                break;
            }
            chain.push(next);
        }
        chain
    }

    /// Copies a node with its content; what inherited properties it needs is written onto it.
    fn copy(&mut self, out: &mut String, node: Xml<'a, 'a>, name: Option<&str>, inherited: &Inherited) {
        let tag = node.tag_name().name();
        let in_filter = tag.starts_with("fe");
        if !self.source.is_svg(node) || !(COPIED.contains(&tag) || in_filter || geometry::is_shape(tag)) {
            return;
        }
        let (style, own) = computed(self.source, node, &inherited.style, inherited.viewport);
        if own.get("display") == Some("none") {
            return;
        }
        let Some(attributes) = self.attributes(node, inherited.viewport) else { return };
        let _ = write!(out, "<{tag}");
        // What is inside keeps no id: where it is referred to, it is copied once more by itself.
        name.into_iter().for_each(|name| push_attribute(out, "id", name));
        out.push_str(&attributes);
        self.properties(out, &own, inherited.viewport);
        let shape = geometry::is_shape(tag) && tag != "image";
        if shape || tag == "use" {
            for (name, value) in style.attributes() {
                let value =
                    if reference(value).is_some() { self.paint(value, inherited.viewport) } else { value.into() };
                push_attribute(out, name, &value);
            }
        }
        out.push('>');
        let inside = Inherited { style, viewport: inherited.viewport };
        let content = if tag == "pattern" { self.pattern_content(node) } else { node };
        for child in content.children().filter(Xml::is_element) {
            self.copy(out, child, None, &inside);
        }
        let _ = write!(out, "</{tag}>");
    }

    /// Where a pattern takes its content from.
    fn pattern_content(&self, node: Xml<'a, 'a>) -> Xml<'a, 'a> {
        let chain = self.chain(node);
        chain.into_iter().find(|n| n.children().any(|c| c.is_element())).unwrap_or(node)
    }

    /// Attributes that are not properties; `None` when the element refers to something outside.
    fn attributes(&mut self, node: Xml<'a, 'a>, viewport: Viewport) -> Option<String> {
        let mut out = String::new();
        let tag = node.tag_name().name();
        if geometry::is_shape(tag) {
            // Shapes are written from what was understood, so that lengths come out as plain numbers.
            let geometry: Geometry = geometry::read(self.source, node, viewport).ok()??;
            let attributes = geometry.markup.split_once(' ').map_or("", |(_, rest)| rest).to_owned();
            let _ = write!(out, " {attributes}");
        }
        let chain = if tag == "pattern" { self.chain(node) } else { vec![node] };
        for attribute in KEPT.iter().filter(|_| !geometry::is_shape(tag)).chain(&["transform"]) {
            if let Some(value) = chain.iter().find_map(|n| n.attribute(*attribute)) {
                let in_user_space = in_user_space(&chain, tag, attribute);
                let axis = match *attribute {
                    "x" | "width" => Axis::X,
                    "y" | "height" => Axis::Y,
                    _ => Axis::Both,
                };
                let sized = matches!(*attribute, "x" | "y" | "width" | "height");
                let value = if sized { in_space(value, axis, viewport, in_user_space) } else { value.to_owned() };
                push_attribute(&mut out, attribute, &value);
            }
        }
        if matches!(tag, "use" | "feImage") {
            let target = self.source.target(node)?;
            let name = self.refer(target.attribute("id")?, &[], viewport)?;
            push_attribute(&mut out, "href", &format!("#{name}"));
        }
        Some(out)
    }

    fn properties(&mut self, out: &mut String, own: &Own, viewport: Viewport) {
        for (name, value) in own.iter() {
            match name {
                "clip-path" | "mask" | "filter" => {
                    let value = self.effect(name, value, viewport);
                    value.into_iter().for_each(|value| push_attribute(out, name, &value));
                }
                "display" | "transform" => {}
                "mix-blend-mode" | "isolation" | "mask-type" => {
                    push_attribute(out, "style", &format!("{name}:{value}"))
                }
                _ => push_attribute(out, name, value),
            }
        }
    }
}

/// A coordinate that a gradient states.
struct Coordinate {
    attribute: &'static str,
    axis: Axis,
    /// What it is in user space where it is absent and not 0.
    initial: Option<&'static str>,
}

const fn coordinate(attribute: &'static str, axis: Axis, initial: Option<&'static str>) -> Coordinate {
    Coordinate { attribute, axis, initial }
}

const LINEAR: [Coordinate; 4] = [
    coordinate("x1", Axis::X, Some("0%")),
    coordinate("y1", Axis::Y, None),
    coordinate("x2", Axis::X, Some("100%")),
    coordinate("y2", Axis::Y, None),
];

const RADIAL: [Coordinate; 6] = [
    coordinate("cx", Axis::X, Some("50%")),
    coordinate("cy", Axis::Y, Some("50%")),
    coordinate("r", Axis::Both, Some("50%")),
    coordinate("fx", Axis::X, None),
    coordinate("fy", Axis::Y, None),
    coordinate("fr", Axis::Both, None),
];

/// The ids that an attribute refers to.
fn targets(value: &str) -> impl Iterator<Item = &str> {
    let by_url = value.split("url(").skip(1).filter_map(|rest| {
        let (inside, _) = rest.split_once(')')?;
        inside.trim().trim_matches(['"', '\'']).trim().strip_prefix('#')
    });
    value.trim().strip_prefix('#').into_iter().chain(by_url)
}

struct Inherited {
    style: Rc<ComputedStyle>,
    viewport: Viewport,
}

/// Attributes of definitions that are copied as they are, except for lengths.
const KEPT: [&str; 58] = [
    "x",
    "y",
    "width",
    "height",
    "viewBox",
    "preserveAspectRatio",
    "patternUnits",
    "patternContentUnits",
    "patternTransform",
    "clipPathUnits",
    "maskUnits",
    "maskContentUnits",
    "filterUnits",
    "primitiveUnits",
    "in",
    "in2",
    "result",
    "stdDeviation",
    "edgeMode",
    "dx",
    "dy",
    "type",
    "values",
    "mode",
    "operator",
    "k1",
    "k2",
    "k3",
    "k4",
    "radius",
    "scale",
    "xChannelSelector",
    "yChannelSelector",
    "baseFrequency",
    "numOctaves",
    "seed",
    "stitchTiles",
    "surfaceScale",
    "specularConstant",
    "specularExponent",
    "diffuseConstant",
    "kernelMatrix",
    "order",
    "divisor",
    "bias",
    "targetX",
    "targetY",
    "preserveAlpha",
    "tableValues",
    "slope",
    "intercept",
    "amplitude",
    "exponent",
    "offset",
    "azimuth",
    "elevation",
    "z",
    "limitingConeAngle",
];

fn in_user_space(chain: &[Xml<'_, '_>], tag: &str, attribute: &str) -> bool {
    let units = match tag {
        "pattern" => "patternUnits",
        "mask" => "maskUnits",
        "filter" => "filterUnits",
        _ => return matches!(attribute, "x" | "y" | "width" | "height") && tag == "use",
    };
    chain.iter().find_map(|n| n.attribute(units)) == Some("userSpaceOnUse")
}

/// A length for the given space: a plain number in user space, as it is in the box of the painted object.
fn in_space(value: &str, axis: Axis, viewport: Viewport, in_user_space: bool) -> String {
    match value.trim().parse::<Length>() {
        Ok(length) if in_user_space => number(viewport.resolve(length, axis, 16.0)),
        _ => value.trim().to_owned(),
    }
}
