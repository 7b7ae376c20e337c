//! The cascade: which presentation properties an element has, and what they are worth.

use std::{borrow::Cow, rc::Rc, str::FromStr};

use roxmltree::Node as Xml;
use svgtypes::{Length, LengthListParser};

use crate::{
    svg::parse::{
        css::style_declarations,
        geometry::LARGEST,
        length::{Axis, Viewport},
        notes::Note,
        paint::{fraction, paint},
        sheet::{
            rules,
            variables::{self, Variables},
        },
        source::{Source, clip_text},
    },
    text::{short::short, xml::number},
};

/// Bytes of a value beyond which it is not understood: everything that inherits it would be written with it.
const LONGEST: usize = 4096;

/// Dashes and gaps beyond which a pattern is not understood, for the same reason.
const DASHES: usize = 512;

/// An inherited property: index into [`PROPERTIES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Property {
    Color,
    FontSize,
    Fill,
    FillOpacity,
    FillRule,
    Stroke,
    StrokeWidth,
    StrokeOpacity,
    StrokeLinecap,
    StrokeLinejoin,
    StrokeMiterlimit,
    StrokeDasharray,
    StrokeDashoffset,
    ClipRule,
    Visibility,
    PaintOrder,
    ColorInterpolation,
    ColorInterpolationFilters,
    ShapeRendering,
    ImageRendering,
    MarkerStart,
    MarkerMid,
    MarkerEnd,
}

use Property as P;

/// Every inherited property with its SVG name and initial value, in the order of [`Property`].
const PROPERTIES: [(Property, &str, &str); 23] = [
    (P::Color, "color", "#000000"),
    (P::FontSize, "font-size", "16"),
    (P::Fill, "fill", "#000000"),
    (P::FillOpacity, "fill-opacity", "1"),
    (P::FillRule, "fill-rule", "nonzero"),
    (P::Stroke, "stroke", "none"),
    (P::StrokeWidth, "stroke-width", "1"),
    (P::StrokeOpacity, "stroke-opacity", "1"),
    (P::StrokeLinecap, "stroke-linecap", "butt"),
    (P::StrokeLinejoin, "stroke-linejoin", "miter"),
    (P::StrokeMiterlimit, "stroke-miterlimit", "4"),
    (P::StrokeDasharray, "stroke-dasharray", "none"),
    (P::StrokeDashoffset, "stroke-dashoffset", "0"),
    (P::ClipRule, "clip-rule", "nonzero"),
    (P::Visibility, "visibility", "visible"),
    (P::PaintOrder, "paint-order", "normal"),
    (P::ColorInterpolation, "color-interpolation", "sRGB"),
    (P::ColorInterpolationFilters, "color-interpolation-filters", "linearRGB"),
    (P::ShapeRendering, "shape-rendering", "auto"),
    (P::ImageRendering, "image-rendering", "auto"),
    (P::MarkerStart, "marker-start", "none"),
    (P::MarkerMid, "marker-mid", "none"),
    (P::MarkerEnd, "marker-end", "none"),
];

/// Properties that are not inherited and that are carried along.
const OWN: [&str; 15] = [
    "opacity",
    "clip-path",
    "mask",
    "filter",
    "mix-blend-mode",
    "isolation",
    "vector-effect",
    "overflow",
    "display",
    "stop-color",
    "stop-opacity",
    "flood-color",
    "flood-opacity",
    "lighting-color",
    "mask-type",
];

/// The inherited properties of an element, computed. Absent values are initial.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ComputedStyle([Option<Rc<str>>; PROPERTIES.len()], Rc<Variables>);

impl ComputedStyle {
    /// The computed value.
    pub(crate) fn get(&self, property: Property) -> &str {
        let (_, _, initial) = PROPERTIES[property as usize];
        self.0[property as usize].as_deref().unwrap_or(initial)
    }

    /// The computed value as a number, 0 when it is none.
    pub(crate) fn number(&self, property: Property) -> f64 {
        self.get(property).parse().unwrap_or(0.0)
    }

    /// Name and value of each property that is not initial and that changes how things look.
    pub(crate) fn attributes(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let silent = [P::Color, P::FontSize, P::Visibility, P::MarkerStart, P::MarkerMid, P::MarkerEnd];
        PROPERTIES.iter().zip(&self.0).filter_map(move |((property, name, initial), value)| {
            let value = value.as_deref().filter(|v| v != initial && !silent.contains(property))?;
            Some((*name, value))
        })
    }

    /// Whether two are painted alike.
    pub(crate) fn looks_like(&self, other: &Self) -> bool {
        self.0 == other.0
    }

    /// The same without line markers.
    pub(crate) fn unmarked(&self) -> Self {
        let mut style = self.clone();
        [P::MarkerStart, P::MarkerMid, P::MarkerEnd].into_iter().for_each(|p| style.0[p as usize] = None);
        style
    }

    /// The same without a stroke.
    pub(crate) fn unstroked(&self) -> Self {
        let mut style = self.unmarked();
        style.0[P::Stroke as usize] = None;
        style
    }

    /// The same without a fill.
    pub(crate) fn unfilled(&self) -> Self {
        let mut style = self.clone();
        style.0[P::Fill as usize] = Some("none".into());
        style
    }

    /// Whether line markers are asked for.
    pub(crate) fn has_markers(&self) -> bool {
        [P::MarkerStart, P::MarkerMid, P::MarkerEnd].iter().any(|&p| self.get(p) != "none")
    }

    /// Share of light that a paint with its opacity stops: 0 for none.
    pub(crate) fn opacity(&self, paint: Property, opacity: Property) -> f64 {
        if self.get(paint) == "none" { 0.0 } else { fraction(self.get(opacity)) }
    }

    /// Whether anything of a fill can be seen.
    pub(crate) fn fills(&self) -> bool {
        self.opacity(P::Fill, P::FillOpacity) > 0.0
    }

    /// Whether a stroke is asked for that has no width.
    pub(crate) fn has_no_width(&self) -> bool {
        self.opacity(P::Stroke, P::StrokeOpacity) > 0.0 && self.number(P::StrokeWidth) <= 0.0
    }

    /// Whether anything of a stroke can be seen.
    pub(crate) fn strokes(&self) -> bool {
        self.opacity(P::Stroke, P::StrokeOpacity) > 0.0 && self.number(P::StrokeWidth) > 0.0
    }
}

/// Properties that an element sets on itself and does not hand down.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Own(Vec<(&'static str, Rc<str>)>);

impl Own {
    /// An opacity alone.
    pub(crate) fn opacity(value: &str) -> Self {
        Self(vec![("opacity", value.into())])
    }

    /// Whether a container with these does something to its content that its items cannot do alone.
    pub(crate) fn has_effects(&self) -> bool {
        ["mask", "filter", "mix-blend-mode"].iter().any(|e| self.get(e).is_some_and(|v| v != "none" && v != "normal"))
    }

    /// The value of a property, where it is set.
    pub(crate) fn get(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|(n, _)| *n == name).map(|(_, value)| &**value)
    }

    /// The same properties except one.
    pub(crate) fn without(&self, name: &str) -> Self {
        Self(self.0.iter().filter(|(n, _)| *n != name).cloned().collect())
    }

    /// All properties that are set, in a fixed order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.0.iter().map(|(name, value)| (*name, &**value))
    }
}

/// Computed style of `node` under a parent with style `parent`.
pub(crate) fn computed<'a>(
    source: &Source<'a>,
    node: Xml<'a, 'a>,
    parent: &Rc<ComputedStyle>,
    viewport: Viewport,
) -> (Rc<ComputedStyle>, Own) {
    let mut set = Setter { source, parent, viewport, style: Rc::clone(parent), own: Own::default() };
    let declared = declarations(source, node);
    for (name, value) in declared.iter().filter(|(name, _)| name.starts_with("--")) {
        set.variable(name, value);
    }
    // `color` and `font-size` first: other values refer to them.
    for first in [true, false] {
        for (name, value) in declared.iter().filter(|(name, _)| !name.starts_with("--")) {
            if matches!(*name, "color" | "font-size" | "font") == first {
                set.declare(name, value);
            }
        }
    }
    set.own.0.sort_by_key(|(name, _)| OWN.iter().position(|n| n == name));
    (set.style, set.own)
}

/// All declarations of an element, weakest first: presentation attributes, style sheets, the style attribute, important
/// ones.
fn declarations<'a>(source: &Source<'a>, node: Xml<'a, 'a>) -> Vec<(&'a str, String)> {
    let mut all: Vec<(&str, String)> = Vec::new();
    let known = |name: &str| PROPERTIES.iter().any(|(_, n, _)| *n == name) || OWN.contains(&name);
    for attribute in node.attributes() {
        if attribute.namespace().is_none() && known(attribute.name()) {
            all.push((attribute.name(), attribute.value().to_owned()));
        }
    }
    let mut important = Vec::new();
    for rule in source.sheet.declarations(node) {
        let name = rule.name.strip_prefix("v--").map_or(rule.name, |_| &rule.name[1..]);
        if is_known(name) {
            let list = if rule.important { &mut important } else { &mut all };
            list.push((name, rules::value(source.values, rule.value).to_owned()));
        }
    }
    if let Some(style) = node.attribute("style") {
        for declared in style_declarations(style).filter(|declared| is_known(declared.name)) {
            let list = if declared.is_important { &mut important } else { &mut all };
            list.push((declared.name, declared.value.to_owned()));
        }
    }
    all.append(&mut important);
    all
}

/// Whether a property says anything here; custom ones do.
fn is_known(name: &str) -> bool {
    let inherited = PROPERTIES.iter().map(|(_, n, _)| *n);
    matches!(name, "marker" | "transform") || name.starts_with("--") || inherited.chain(OWN).any(|n| n == name)
}

struct Setter<'a, 's> {
    source: &'s Source<'a>,
    parent: &'s Rc<ComputedStyle>,
    viewport: Viewport,
    style: Rc<ComputedStyle>,
    own: Own,
}

impl Setter<'_, '_> {
    /// Sets a custom property.
    fn variable(&mut self, name: &str, value: &str) {
        let variables = &mut Rc::make_mut(&mut self.style).1;
        if value.len() > LONGEST || name.len() > LONGEST || variables.len() >= variables::MOST {
            self.source.notes.add(Note::Style, || short(name));
            return;
        }
        Rc::make_mut(variables).insert(name.into(), value.into());
    }

    /// The value with what it refers to in its place; `None` where that is nothing.
    fn plain<'v>(&self, name: &str, value: &'v str) -> Option<Cow<'v, str>> {
        let value = variables::default_of(value)?.trim();
        if !value.contains("var(") {
            return Some(Cow::Borrowed(value));
        }
        let resolved = variables::resolved(value, &self.style.1);
        if resolved.is_none() {
            self.source.notes.add(Note::Style, || format!("{name}: {}", clip_text(value, 40)));
        }
        Some(Cow::Owned(resolved?.trim().to_owned()))
    }

    fn declare(&mut self, name: &str, value: &str) {
        let Some(value) = self.plain(name, value) else { return };
        let value = &*value;
        if name == "marker" {
            [P::MarkerStart, P::MarkerMid, P::MarkerEnd].into_iter().for_each(|p| self.inherited(p, value));
        } else if name == "transform" {
            self.own.0.push(("transform", value.into()));
        } else if let Some((property, _, _)) = PROPERTIES.iter().find(|(_, n, _)| *n == name) {
            self.inherited(*property, value);
        } else if let Some(name) = OWN.iter().find(|n| **n == name) {
            let value = match value {
                "currentColor" | "currentcolor" => self.style.get(P::Color),
                "inherit" | "" => return,
                _ => value,
            };
            if value.len() > LONGEST {
                self.source.notes.add(Note::Style, || format!("{name}: {}", clip_text(value, 40)));
                return;
            }
            let value: Rc<str> = value.into();
            self.own.0.retain(|(n, _)| n != name);
            self.own.0.push((name, value));
        }
    }

    fn inherited(&mut self, property: Property, value: &str) {
        let index = property as usize;
        let new = match value {
            "inherit" | "unset" => self.parent.0[index].clone(),
            "initial" => None,
            _ => match self.value(property, value) {
                Some(value) => Some(value.into()),
                None => {
                    let name = PROPERTIES[index].1;
                    self.source.notes.add(Note::Style, || format!("{name}: {}", clip_text(value, 40)));
                    return;
                }
            },
        };
        if self.style.0[index] != new {
            Rc::make_mut(&mut self.style).0[index] = new;
        }
    }

    /// The computed form of a value: lengths become numbers, colours `#rrggbb`; `None` when it is not understood.
    fn value(&self, property: Property, value: &str) -> Option<String> {
        let font = self.style.number(P::FontSize);
        let length = |text: &str, axis, font| {
            let number = self.viewport.resolve(Length::from_str(text).ok()?, axis, font);
            number.is_finite().then_some(number)
        };
        match property {
            P::Fill | P::Stroke if value.len() > LONGEST => None,
            P::Fill | P::Stroke if value.starts_with("context-") => {
                // Outside of markers there is none.
                let context = self.source.context.borrow();
                let of = |k: usize| context.as_ref().map_or("none", |context| &context[k]).to_owned();
                Some(of(usize::from(value == "context-stroke")))
            }
            P::Fill | P::Stroke => paint(value, self.style.get(P::Color)),
            P::Color => paint(value, self.parent.get(P::Color)),
            P::StrokeWidth => length(value, Axis::Both, font).filter(|w| *w >= 0.0).map(number),
            P::StrokeDashoffset => length(value, Axis::Both, font).map(number),
            P::FontSize => {
                let size = length(value, Axis::Both, self.parent.number(P::FontSize)).filter(|s| *s >= 0.0);
                // Named sizes matter to nothing but `em`, which hardly any drawing uses.
                Some(size.map_or_else(|| self.parent.get(P::FontSize).to_owned(), number))
            }
            P::StrokeDasharray if value == "none" => Some(value.to_owned()),
            P::StrokeDasharray => self.dashes(value, font),
            P::StrokeMiterlimit => value.parse().ok().filter(|m: &f64| m.is_finite()).map(|m| number(m.max(1.0))),
            P::FillOpacity | P::StrokeOpacity => Some(number(fraction(value))),
            _ => (value.len() <= LONGEST).then(|| value.to_owned()),
        }
    }

    fn dashes(&self, value: &str, font: f64) -> Option<String> {
        let lengths: Option<Vec<f64>> = LengthListParser::from(value)
            .map(|length| {
                Some(self.viewport.resolve(length.ok()?, Axis::Both, font)).filter(|n| (0.0..=LARGEST).contains(n))
            })
            .collect();
        let lengths = lengths.filter(|lengths| lengths.len() <= DASHES)?;
        if lengths.iter().sum::<f64>() <= 0.0 {
            return Some("none".to_owned());
        }
        Some(lengths.into_iter().map(number).collect::<Vec<_>>().join(" "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::{options::ReadOptions, parse::source::with_source};

    fn style_of_last(svg: &str) -> (Rc<ComputedStyle>, Own) {
        let text = format!("<svg xmlns='http://www.w3.org/2000/svg'>{svg}</svg>");
        with_source(&text, &ReadOptions::new("s.svg"), |source| {
            let mut style = Rc::new(ComputedStyle::default());
            let mut own = Own::default();
            let last = source.xml.descendants().rfind(Xml::is_element).unwrap();
            let mut chain: Vec<_> = last.ancestors().filter(Xml::is_element).collect();
            chain.reverse();
            for node in chain {
                (style, own) = computed(source, node, &style, Viewport { width: 300.0, height: 400.0 });
            }
            Ok((style, own))
        })
        .unwrap()
    }

    #[test]
    fn the_style_attribute_beats_the_sheet_and_the_sheet_beats_attributes() {
        let css = "<style>path{stroke:blue;fill:lime} .x{stroke-width:2mm !important}</style>";
        let (style, _) = style_of_last(&format!(
            "{css}<path class='x' fill='red' stroke='red' style='stroke:#00f8;stroke-width:1'/>"
        ));
        assert_eq!(style.get(P::Fill), "#00ff00");
        assert_eq!(style.get(P::Stroke), "rgba(0,0,255,0.5333333)");
        assert!((style.number(P::StrokeWidth) - 7.5590551).abs() < 1e-6);
    }

    #[test]
    fn inheritance_and_current_colour() {
        let (style, own) = style_of_last(
            "<g color='teal' opacity='.5' stroke-width='10%' fill='none'><path stroke='currentColor' \
             fill='inherit'/></g>",
        );
        assert_eq!((style.get(P::Stroke), style.get(P::Fill)), ("#008080", "none"));
        assert!((style.number(P::StrokeWidth) - 35.3553391).abs() < 1e-6);
        assert_eq!(own.get("opacity"), None);
    }

    #[test]
    fn values_that_make_no_sense_are_ignored() {
        let (style, _) =
            style_of_last("<g fill='red'><path fill='var(--x)' stroke-width='-3' stroke-miterlimit='nan'/></g>");
        assert_eq!((style.get(P::Fill), style.get(P::StrokeWidth)), ("#ff0000", "1"));
    }

    #[test]
    fn variables_are_inherited_and_parameters_have_defaults() {
        let css = "<style>:root{--ink:teal;--w:2px} .a{--ink:rgb(0, 0, 255)} path{stroke:var(--ink)} \
                   path:nth-of-type(2){fill:lime}</style>";
        let (style, _) = style_of_last(&format!(
            "{css}<g class='a'><path fill='param(fill) #378add' fill-opacity='param(o)' \
             style='stroke-width:var(--w);font:1px/2 x;stroke-linecap:var(--none, round)'/></g>"
        ));
        assert_eq!((style.get(P::Stroke), style.get(P::Fill), style.get(P::FillOpacity)), ("#0000ff", "#378add", "1"));
        assert_eq!((style.get(P::StrokeWidth), style.get(P::StrokeLinecap)), ("2", "round"));
    }

    #[test]
    fn selectors_that_are_not_understood_are_told_on_one_line() {
        let text = "<svg xmlns='http://www.w3.org/2000/svg'><style>path ~ g,\n path:not(.a) {fill:red}\n\
             @media screen { g{fill:red} }</style></svg>";
        let told = with_source(text, &ReadOptions::new("s.svg"), |source| Ok(source.notes.warnings("s.svg"))).unwrap();
        assert!(told[0].message.ends_with("(3 times): path ~ g, path:not(.a), @media screen"), "{}", told[0].message);
    }
}
