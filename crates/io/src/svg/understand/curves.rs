//! Strokes of a drawing as curves: their lines as cubics in the coordinates of the root, and how they are painted.

use std::{collections::BTreeMap, fmt::Write as _, rc::Rc};

use arabesque_core::{Area, Bounds, Class, Curve, Outline, Path, Result};
use kurbo::{Affine, BezPath};

use crate::{
    svg::{
        centreline::Centrelines,
        drawing::Stroke,
        options::Dashes,
        parse::{
            colour,
            definitions::Definitions,
            guard::over,
            meta::Meta,
            notes::Note,
            paint::{fraction, reference},
            scene::{Content, Node},
            style::Property as P,
        },
        reason::Reason,
        shape::{
            cut_path::{Side, cut},
            duplicates::Seen,
            painted_area::Painter,
            stroke::growth,
            subpath::{is_closed, line},
        },
        understand::{
            classes::names_of,
            dashes::DashPattern,
            item::{Item, Kind},
            parts::cells::shared_once,
        },
    },
    text::xml::{number, push_attribute},
};

/// Work for each edge of a clip that a stroke may cross.
const PER_EDGE: u64 = 5;

/// The curves of a drawing, each in one paint.
#[derive(Debug, Default)]
pub(crate) struct Curves {
    pub(crate) curves: Vec<Curve<2>>,
    pub(crate) areas: Vec<Area<2>>,
    /// How area `i` is painted.
    pub(crate) fills: Vec<Stroke>,
    pub(crate) styles: Vec<Class>,
    /// How curve `i` is painted.
    pub(crate) strokes: Vec<Stroke>,
}

/// What holds for everything inside a node.
#[derive(Clone)]
struct Inside {
    parent: Affine,
    opacity: f64,
    clip: Option<Rc<Outline<2>>>,
}

/// Gathers the curves of a file.
pub(crate) struct Gatherer<'a, 's, 'i, 'd> {
    pub(crate) painter: &'i Painter<'a, 's>,
    pub(crate) definitions: &'d mut Definitions<'a, 's>,
    /// Nothing outside of it is of interest.
    pub(crate) window: Bounds<2>,
    dashes: Dashes,
    found: Curves,
    /// What is added is painted in this one of the levels of its look.
    pub(crate) level: usize,
    /// Index into the styles by paint.
    style_of: BTreeMap<String, usize>,
    /// What was found already, to tell strokes that lie on top of each other.
    seen: Seen,
}

impl<'a, 's, 'i, 'd> Gatherer<'a, 's, 'i, 'd> {
    pub(crate) fn new(
        painter: &'i Painter<'a, 's>,
        definitions: &'d mut Definitions<'a, 's>,
        window: Bounds<2>,
        dashes: Dashes,
    ) -> Self {
        let (found, style_of, seen) = (Curves::default(), BTreeMap::new(), Seen::new(&window));
        Self { painter, definitions, window, dashes, found, level: 0, style_of, seen }
    }

    /// Adds the strokes of an item.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Limit`] for too many.
    pub(crate) fn add(&mut self, item: &Item) -> Result<()> {
        if item.kind == Kind::Area {
            return self.add_area(item);
        }
        if let Some(lines) = &item.lines {
            return self.add_lines(item, lines);
        }
        for (parent, node) in &item.parts {
            let inside = Inside { parent: *parent, opacity: item.opacity, clip: item.clip.clone() };
            self.node(node, &inside, item)?;
        }
        Ok(())
    }

    /// Adds the lines of an outline, as strokes in the paint of its fill.
    fn add_lines(&mut self, item: &Item, lines: &Centrelines) -> Result<()> {
        let Some((leaf, opacity)) = item.parts.first().and_then(|(_, node)| first_shape(node, item.opacity)) else {
            return Ok(());
        };
        let fill = leaf.style.get(P::Fill);
        let mut paint = " fill=\"none\"".to_owned();
        match reference(fill) {
            Some(_) => push_attribute(&mut paint, "stroke", &self.definitions.paint(fill, leaf.viewport)),
            None => push_attribute(&mut paint, "stroke", fill),
        }
        if fraction(leaf.style.get(P::FillOpacity)) < 1.0 {
            push_attribute(&mut paint, "stroke-opacity", leaf.style.get(P::FillOpacity));
        }
        paint.push_str(match item.reason {
            Reason::Band => " stroke-miterlimit=\"20\"",
            Reason::HandBand => " stroke-linejoin=\"round\"",
            _ => " stroke-linecap=\"round\"",
        });
        let stroke = Stroke {
            paint,
            effects: self.effects(leaf, opacity),
            width: lines.width,
            dashes: Vec::new(),
            dash_offset: 0.0,
            layer: item.layer.as_deref().map(str::to_owned),
            label: item.meta.label.clone(),
        };
        let style = self.style(&stroke, &item.meta);
        let colour = colour::of_paint(self.painter.source, fill);
        for path in &lines.paths {
            self.push(Curve { path: path.clone(), style, width: lines.width, colour }, &stroke, item)?;
        }
        self.check_count()
    }

    /// Adds a filled area.
    fn add_area(&mut self, item: &Item) -> Result<()> {
        let Some((leaf, opacity)) = item.parts.first().and_then(|(_, node)| first_shape(node, item.opacity)) else {
            return Ok(());
        };
        let mut paint = String::new();
        let fill = leaf.style.get(P::Fill);
        match (&item.gradient, reference(fill)) {
            (Some(gradient), _) => push_attribute(&mut paint, "fill", &self.definitions.repeated(gradient)),
            (None, Some(_)) => push_attribute(&mut paint, "fill", &self.definitions.paint(fill, leaf.viewport)),
            (None, None) => push_attribute(&mut paint, "fill", fill),
        }
        if fraction(leaf.style.get(P::FillOpacity)) < 1.0 {
            push_attribute(&mut paint, "fill-opacity", leaf.style.get(P::FillOpacity));
        }
        let fill = Stroke {
            paint,
            effects: self.effects(leaf, opacity),
            width: 0.0,
            dashes: Vec::new(),
            dash_offset: 0.0,
            layer: item.layer.as_deref().map(str::to_owned),
            label: item.meta.label.clone(),
        };
        let style = self.style(&fill, &item.meta);
        let (mut outline, colour) = (item.fine_outline(self.painter)?, item.painted.colour());
        if let Some(hidden) = &item.hidden {
            outline = outline.try_difference(hidden, self.painter.source.budget)?;
        }
        self.found.areas.push(Area { outline, style, colour });
        self.found.fills.push(fill);
        Ok(())
    }

    /// Number of the curves and areas so far.
    pub(crate) fn count(&self) -> (usize, usize) {
        (self.found.curves.len(), self.found.areas.len())
    }

    /// The styles of what was added since there were so many curves and areas, each once.
    pub(crate) fn styles_from(&self, (curves, areas): (usize, usize)) -> Vec<usize> {
        let mut styles: Vec<usize> = Vec::new();
        let of_curves = self.found.curves[curves..].iter().map(|curve| curve.style);
        for style in of_curves.chain(self.found.areas[areas..].iter().map(|area| area.style)) {
            if !styles.contains(&style) {
                styles.push(style);
            }
        }
        styles
    }

    /// The curves, with the edges that closed outlines share once each.
    ///
    /// # Errors
    /// As [`arabesque_core::Budget::spend`].
    pub(crate) fn finish(self) -> Result<Curves> {
        let Curves { curves, areas, fills, styles, strokes } = self.found;
        let is_plain = |k: usize| strokes[k].dashes.is_empty();
        let shared = shared_once(&curves, is_plain, &self.window, self.painter.source.budget)?;
        let mut found = Curves { areas, fills, styles, ..Curves::default() };
        for ((curve, stroke), rest) in curves.into_iter().zip(strokes).zip(shared) {
            for path in rest.unwrap_or_else(|| vec![curve.path.clone()]) {
                if path.bounds().grown(0.5 * curve.width).intersects(&self.window) {
                    found.curves.push(Curve { path, ..curve.clone() });
                    found.strokes.push(stroke.clone());
                }
            }
        }
        Ok(found)
    }

    fn node(&mut self, node: &Node, at: &Inside, item: &Item) -> Result<()> {
        let world = at.parent * node.transform;
        let opacity = at.opacity * node.own.get("opacity").map_or(1.0, fraction);
        let clip = match (&at.clip, self.painter.clip(node, world)?) {
            (Some(a), Some(b)) => Some(Rc::new(a.try_intersection(&b, self.painter.source.budget)?)),
            (a, b) => b.map(Rc::new).or_else(|| a.clone()),
        };
        let inside = Inside { parent: world, opacity, clip };
        if let Content::Shape(geometry) = &node.content {
            return self.shape(node, &geometry.path, &inside, item);
        }
        node.children().iter().try_for_each(|child| self.node(child, &inside, item))
    }

    fn shape(&mut self, node: &Node, path: &BezPath, at: &Inside, item: &Item) -> Result<()> {
        let notes = &self.painter.source.notes;
        let name = || item.meta.id.clone().unwrap_or_default();
        if !node.style.strokes() {
            return Ok(());
        }
        if node.style.fills() && path.segments().count() > 1 && node.meta.mark.or(item.meta.mark).is_some() {
            notes.add(Note::CurveFill, name);
        }
        if node.own.get("mask").is_some_and(|m| m != "none") {
            notes.add(Note::CurveMask, name);
        }
        let mut stroke = self.stroke(node, at, item);
        let is_apart = self.dashes == Dashes::Apart && !stroke.dashes.is_empty();
        let pattern = is_apart.then(|| DashPattern::taken_from(&mut stroke));
        let style = self.style(&stroke, &item.meta);
        let colour = colour::of_paint(self.painter.source, node.style.get(P::Stroke));
        for elements in path.subpaths() {
            let closed = is_closed(elements);
            let line =
                line(&(at.parent * BezPath::from_vec(elements.to_vec())), closed, self.painter.source.limits.extent);
            if length(&line) <= self.painter.source.limits.extent {
                self.painter.source.notes.add(Note::ZeroLength, || item.meta.id.clone().unwrap_or_default());
                continue;
            }
            let budget = self.painter.source.budget;
            budget.spend(PER_EDGE * at.clip.as_ref().map_or(0, |clip| clip.points().count()) as u64)?;
            let mut lines = match &pattern {
                Some(pattern) => pattern.dashes(&line, self.painter.source)?,
                None => vec![line],
            };
            if let Some(clip) = &at.clip {
                lines =
                    lines.into_iter().flat_map(|l| cut(&l, clip, Side::Inside).unwrap_or_else(|| vec![l])).collect();
            }
            for path in self.uncovered(lines, item)? {
                self.push(Curve { path, style, width: stroke.width, colour }, &stroke, item)?;
            }
            self.check_count()?;
        }
        Ok(())
    }

    /// What shows of lines of an item below what is painted over them.
    fn uncovered(&self, lines: Vec<Path<2>>, item: &Item) -> Result<Vec<Path<2>>> {
        let Some(hidden) = &item.hidden else { return Ok(lines) };
        let mut seen = Vec::new();
        for line in lines {
            let edges = (hidden.points().count() * line.cubics.len()) as u64;
            self.painter.source.budget.spend(PER_EDGE * edges)?;
            seen.extend(cut(&line, hidden, Side::Outside).unwrap_or_else(|| vec![line]));
        }
        Ok(seen)
    }

    fn push(&mut self, curve: Curve<2>, stroke: &Stroke, item: &Item) -> Result<()> {
        if !curve.path.bounds().grown(0.5 * curve.width).intersects(&self.window) {
            return Ok(());
        }
        if !self.seen.insert(curve.style, &curve.path, self.painter.source.budget)? {
            self.painter.source.notes.add(Note::Duplicate, || item.meta.id.clone().unwrap_or_default());
            return Ok(());
        }
        self.found.curves.push(curve);
        self.found.strokes.push(stroke.clone());
        Ok(())
    }

    /// Refuses more curves than the limit.
    fn check_count(&self) -> Result<()> {
        let (found, source) = (self.found.curves.len(), self.painter.source);
        if found <= source.limits.elements {
            return Ok(());
        }
        Err(over(format!("{}: curves", source.name), found, ("elements", source.limits.elements)))
    }

    /// How a shape's stroke is painted, in the units of the root.
    fn stroke(&mut self, node: &Node, at: &Inside, item: &Item) -> Stroke {
        let notes = &self.painter.source.notes;
        let fixed = node.own.get("vector-effect") == Some("non-scaling-stroke");
        let scale = if fixed { 1.0 } else { growth(at.parent) };
        if !fixed && !is_even(at.parent) {
            notes.add(Note::UnevenWidth, || item.meta.id.clone().unwrap_or_default());
        }
        let style = &node.style;
        let dashes = style.get(P::StrokeDasharray).split(' ').filter_map(|n| n.parse::<f64>().ok());
        let dashes: Vec<f64> = dashes.map(|d| d * scale).collect();
        let is_free = dashes.is_empty() || self.dashes == Dashes::Shifted;
        let dash_offset = if is_free { 0.0 } else { style.number(P::StrokeDashoffset) * scale };
        Stroke {
            paint: self.paint(node),
            effects: self.effects(node, at.opacity),
            width: style.number(P::StrokeWidth) * scale,
            dashes,
            dash_offset,
            layer: item.layer.as_deref().map(str::to_owned),
            label: item.meta.label.clone(),
        }
    }

    /// The presentation attributes of a stroke, except for its lengths and effects.
    fn paint(&mut self, node: &Node) -> String {
        let mut out = " fill=\"none\"".to_owned();
        for (name, value) in node.style.attributes() {
            if name.starts_with("fill") || LENGTHS.contains(&name) || matches!(name, "clip-rule" | "paint-order") {
                continue;
            }
            match reference(value) {
                Some(_) => push_attribute(&mut out, name, &self.definitions.paint(value, node.viewport)),
                None => push_attribute(&mut out, name, value),
            }
        }
        out
    }

    /// What a stroke has for itself: opacity, filter, blending.
    fn effects(&mut self, node: &Node, opacity: f64) -> String {
        let mut out = String::new();
        if opacity < 1.0 {
            push_attribute(&mut out, "opacity", &number(opacity));
        }
        for (name, value) in node.own.iter() {
            match name {
                "filter" => {
                    if let Some(value) = self.definitions.effect(name, value, node.viewport) {
                        push_attribute(&mut out, name, &value);
                    }
                }
                "mix-blend-mode" if value != "normal" => push_attribute(&mut out, "style", &format!("{name}:{value}")),
                _ => {}
            }
        }
        out
    }

    /// The style of that paint in that layer.
    fn style(&mut self, stroke: &Stroke, meta: &Meta) -> usize {
        let mut key = stroke.key();
        let _ = write!(key, "|{}|{}", stroke.layer.as_deref().unwrap_or_default(), self.level);
        if let Some(known) = self.style_of.get(&key) {
            return *known;
        }
        let names = names_of(meta, &self.painter.source.sheet);
        let name = names.into_iter().next().unwrap_or_else(|| format!("style {}", self.found.styles.len() + 1));
        let taken = |name: &str| self.found.styles.iter().any(|s| s.name == name);
        let free = (2..).map(|n| format!("{name} {n}"));
        let name = std::iter::once(name.clone()).chain(free).find(|n| !taken(n)).unwrap_or(name);
        self.found.styles.push(Class { name });
        self.style_of.insert(key, self.found.styles.len() - 1);
        self.found.styles.len() - 1
    }
}

/// The first shape in a node, with the opacity of what is around it and its own.
fn first_shape(node: &Node, opacity: f64) -> Option<(&Node, f64)> {
    let opacity = opacity * node.own.get("opacity").map_or(1.0, fraction);
    match &node.content {
        Content::Shape(_) => Some((node, opacity)),
        Content::Group(children) => children.iter().find_map(|child| first_shape(child, opacity)),
    }
}

/// Properties that scale with the stroke.
const LENGTHS: [&str; 3] = ["stroke-width", "stroke-dasharray", "stroke-dashoffset"];

/// Whether a transform stretches all directions alike, up to one part in a hundred.
fn is_even(transform: Affine) -> bool {
    let [a, b, c, d, ..] = transform.as_coeffs();
    let (p, q) = (a.hypot(b), c.hypot(d));
    (p - q).abs() <= 0.01 * p.max(q) && (a * c + b * d).abs() <= 0.01 * p * q
}

/// Length of the chords of a path.
fn length(path: &Path<2>) -> f64 {
    path.cubics.iter().flat_map(|c| c.windows(2)).map(|w| (w[1] - w[0]).norm()).sum()
}
