//! Style sheets: which rules apply to an element.

use std::{
    cell::Cell,
    collections::{BTreeMap, BTreeSet},
    rc::Rc,
};

use roxmltree::Node as Xml;
use simplecss::{AttributeOperator, Declaration, PseudoClass, Rule, StyleSheet};

use crate::svg::parse::sheet::{
    declarations::{Declared, declarations},
    rules::ROOT,
};

/// Steps of matching selectors in a whole file: parts of a selector compared, and moves in the tree.
pub(crate) const STEPS: u64 = 200_000_000;

/// Bytes of a selector beyond which its rule is skipped: each part of it may be one level deeper.
const SELECTOR: usize = 2000;
/// Comments in a row beyond which they are put together, for the same reason.
const COMMENTS: usize = 500;
/// Length of a style sheet beyond which it is parsed in parts: whatever is not understood is looked up from the start.
const PART: usize = 1 << 13;

/// The rules of a file, weakest first. A clone shares the rules, and counts its own steps from there.
#[derive(Clone)]
pub(crate) struct StyleRules<'a> {
    rules: Rc<[Rule<'a>]>,
    /// Which rules may apply to an element, by what their selectors ask of it.
    by_key: Rc<BTreeMap<Key, Vec<usize>>>,
    /// Class names that some rule refers to.
    styled: Rc<BTreeSet<String>>,
    steps: Cell<u64>,
}

impl<'a> StyleRules<'a> {
    /// Parses style sheet text. Rules that are not understood are skipped, as CSS demands.
    pub(crate) fn new(css: &'a str) -> Self {
        let mut rules = Vec::new();
        for part in parts(css) {
            rules.extend(StyleSheet::parse(part).rules);
        }
        rules.sort_by_cached_key(|rule| rule.selector.specificity());
        // A selector that starts with a combinator is an error in CSS; the parser lets it through.
        rules.retain(|rule| {
            let selector = rule.selector.to_string();
            selector.starts_with(|c: char| c.is_alphanumeric() || ".#[*:_".contains(c)) && selector.len() <= SELECTOR
        });
        let styled: BTreeSet<String> = rules.iter().flat_map(|rule| class_names(&rule.selector.to_string())).collect();
        let mut by_key: BTreeMap<Key, Vec<usize>> = BTreeMap::new();
        for (k, rule) in rules.iter().enumerate() {
            by_key.entry(Key::of(&rule.selector.to_string())).or_default().push(k);
        }
        Self { rules: rules.into(), by_key: Rc::new(by_key), styled: Rc::new(styled), steps: Cell::new(0) }
    }

    /// Declarations that apply to `node`, weakest first.
    pub(crate) fn declarations<'s>(&'s self, node: Xml<'s, 's>) -> impl Iterator<Item = Declaration<'a>> + 's {
        let element = Element { node, steps: &self.steps };
        let lists = Key::all_of(node).into_iter().filter_map(|key| self.by_key.get(&key));
        let mut may_apply: Vec<usize> = lists.flatten().copied().collect();
        may_apply.sort_unstable();
        may_apply.dedup();
        let matching = may_apply.into_iter().map(|k| &self.rules[k]).filter(move |rule| {
            element.count(1);
            !self.is_exhausted() && rule.selector.matches(&element)
        });
        matching.flat_map(|rule| rule.declarations.iter().copied())
    }

    /// Whether a class is used for styling, and so says nothing about what an element is.
    pub(crate) fn styles_class(&self, class: &str) -> bool {
        self.styled.contains(class)
    }

    /// Steps of matching so far.
    pub(crate) fn steps(&self) -> u64 {
        self.steps.get()
    }

    /// Whether matching was cut short.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.steps.get() > STEPS
    }
}

/// What the last part of a selector asks of an element, as far as it is soon found.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    Class(String),
    Id(String),
    Tag(String),
    Any,
}

impl Key {
    /// Of a selector, as it is written out: `svg > g[class~='a'] path[id='b']`.
    fn of(selector: &str) -> Self {
        let (mut start, mut inside) = (0, false);
        for (k, c) in selector.char_indices() {
            match c {
                '[' => inside = true,
                ']' => inside = false,
                ' ' if !inside => start = k + 1,
                _ => {}
            }
        }
        let last = &selector[start..];
        let quoted = |before: &str| Some(last.split_once(before)?.1.split_once("']")?.0.to_owned());
        let is_plain = |name: &String| name.chars().all(|c| c.is_alphanumeric() || matches!(c, '-' | '_'));
        if let Some(class) = quoted("[class~='").filter(is_plain) {
            return Self::Class(class);
        }
        if let Some(id) = quoted("[id='").filter(is_plain) {
            return Self::Id(id);
        }
        let tag = last.split(['[', ':']).next().unwrap_or_default().to_owned();
        if tag.is_empty() || tag == "*" || !is_plain(&tag) { Self::Any } else { Self::Tag(tag) }
    }

    /// Everything that selectors may ask of an element and find.
    fn all_of(node: Xml<'_, '_>) -> Vec<Self> {
        let classes = node.attribute("class").unwrap_or_default().split_ascii_whitespace();
        let mut keys: Vec<_> = classes.map(|class| Self::Class(class.to_owned())).collect();
        keys.extend(node.attribute("id").map(|id| Self::Id(id.to_owned())));
        keys.extend([Self::Tag(node.tag_name().name().to_owned()), Self::Any]);
        keys
    }
}

/// The declarations of a style attribute.
pub(crate) fn style_declarations(style: &str) -> impl Iterator<Item = Declared<'_>> {
    declarations(style)
}

/// A long style sheet in parts that end with rules.
fn parts(css: &str) -> Vec<&str> {
    if css.len() <= PART {
        return vec![css];
    }
    let (mut parts, mut from, mut depth) = (Vec::new(), 0, 0_usize);
    for (k, b) in css.bytes().enumerate() {
        match b {
            b'{' => depth += 1,
            b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if b == b'}' && depth == 0 && k + 1 - from >= PART / 8 {
            parts.push(&css[from..=k]);
            from = k + 1;
        }
    }
    parts.push(&css[from..]);
    parts
}

/// Style sheet text as the parser may have it, which takes every comment in a row one level deeper: these are one.
pub(crate) fn sparing_comments(css: String) -> String {
    if css.matches("/*").count() <= COMMENTS {
        return css;
    }
    let (mut out, mut rest) = (String::with_capacity(css.len()), css.as_str());
    let mut in_row = false;
    while let Some(start) = rest.find("/*") {
        let before = &rest[..start];
        let is_blank = before.bytes().all(|b| b.is_ascii_whitespace());
        if in_row && is_blank {
            // The blank is kept once: it may tell two names apart.
            if !before.is_empty() && !out.ends_with(' ') {
                out.push(' ');
            }
        } else {
            out.push_str(before);
            out.push_str("/**/");
        }
        let Some(end) = rest[start + 2..].find("*/") else { return out };
        rest = &rest[start + 2 + end + 2..];
        in_row = true;
    }
    out.push_str(rest);
    out
}

/// Names after a dot, or in a class attribute test, in a selector.
fn class_names(selector: &str) -> Vec<String> {
    let dotted = selector.split('.').skip(1);
    let tested = selector.split("[class~='").skip(1).chain(selector.split("[class~=\"").skip(1));
    let name = |s: &str| s.chars().take_while(|c| c.is_alphanumeric() || matches!(c, '-' | '_')).collect::<String>();
    dotted.chain(tested).map(name).filter(|n| !n.is_empty()).collect()
}

struct Element<'a> {
    node: Xml<'a, 'a>,
    steps: &'a Cell<u64>,
}

impl<'a> Element<'a> {
    fn count(&self, steps: u64) {
        self.steps.set(self.steps.get() + steps);
    }

    fn step(&self, to: Option<Xml<'a, 'a>>) -> Option<Self> {
        self.count(1);
        to.filter(|_| self.steps.get() <= STEPS).map(|node| Self { node, steps: self.steps })
    }

    /// The element before this one; texts and comments between them are steps too.
    fn previous(&self) -> Option<Xml<'a, 'a>> {
        let before = self.node.prev_siblings().skip(1).inspect(|_| self.count(1));
        before.take_while(|_| self.steps.get() <= STEPS).find(Xml::is_element)
    }
}

impl simplecss::Element for Element<'_> {
    fn parent_element(&self) -> Option<Self> {
        self.step(self.node.parent_element())
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.step(self.previous())
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.node.tag_name().name() == name
    }

    fn attribute_matches(&self, local_name: &str, operator: AttributeOperator<'_>) -> bool {
        self.count(self.node.attributes().len() as u64);
        if local_name == ROOT {
            return self.node.parent_element().is_none();
        }
        self.node.attribute(local_name).is_some_and(|value| {
            self.count(value.len() as u64 / 32);
            operator.matches(value)
        })
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        matches!(class, PseudoClass::FirstChild) && self.previous().is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fills(css: &str, svg: &str) -> Vec<String> {
        let xml = roxmltree::Document::parse(svg).unwrap();
        let sheet = StyleRules::new(css);
        let last = xml.descendants().rfind(Xml::is_element).unwrap();
        sheet.declarations(last).map(|d| d.value.to_owned()).collect()
    }

    #[test]
    fn the_more_specific_rule_comes_last() {
        let svg = "<svg><g id='a'><path class='b c'/></g></svg>";
        assert_eq!(fills("#a path{fill:red} path{fill:blue} .c{fill:lime}", svg), ["blue", "lime", "red"]);
    }

    #[test]
    fn broken_rules_are_skipped() {
        let svg = "<svg><path class='b'/></svg>";
        assert_eq!(fills("> path{fill:red} @media x{path{fill:blue}} .b{fill:lime}", svg), ["lime"]);
        assert!(fills("}}}{{{,,,", svg).is_empty());
    }

    #[test]
    fn long_sheets_long_selectors_and_comments_in_a_row_are_no_trouble() {
        let svg = "<svg><path class='b'/></svg>";
        let long = format!("{} .b{{fill:lime}}", "a{b:}".repeat(100_000));
        assert_eq!(fills(&long, svg), ["lime"]);
        let sheet = format!(".b{{fill:red}} {}{{fill:lime}}", vec!["path"; 50_000].join("+"));
        assert_eq!(fills(&sheet, svg), ["red"]);
        for run in ["/**/", "/* x */ ", "\n/**/"] {
            let css = sparing_comments(format!("svg >{}.b{{fill:{}lime}}", run.repeat(50_000), run.repeat(900)));
            assert_eq!(fills(&css, svg), ["lime"], "{run}");
        }
    }

    #[test]
    fn steps_are_counted_for_every_rule_and_every_move() {
        let svg = format!("<svg>{}<path a='x'/></svg>", "<!-- -->".repeat(1000));
        let xml = roxmltree::Document::parse(&svg).unwrap();
        let sheet = StyleRules::new("path:first-child{fill:red} [a]{fill:lime} g{x:y}");
        assert_eq!(sheet.declarations(xml.descendants().rfind(Xml::is_element).unwrap()).count(), 2);
        assert!(sheet.steps() > 1000, "{}", sheet.steps());
    }

    #[test]
    fn rules_are_found_by_what_they_ask_for() {
        let css = "* {a:any} path{a:tag} .b{a:class} #i{a:id} g .b[x='y z']{a:both} g > path:first-child{a:first}
            [x]{a:has} .b.c{a:two} [class='b c']{a:whole} .d path{a:none} path.e{a:none}";
        let svg = "<svg><g><path class='b c' id='i' x='y z'/></g></svg>";
        let found = fills(css, svg);
        assert_eq!(found, ["any", "tag", "class", "has", "whole", "first", "two", "both", "id"].map(str::to_owned));
        assert_eq!(Key::of("g[class~='a b'] > path[x='c d']"), Key::Tag("path".into()));
        let long = format!("fill:url(';');{}stroke:red", "fill:lime;".repeat(50_000));
        assert_eq!(style_declarations(&long).count(), 50_002);
    }

    #[test]
    fn classes_in_selectors_are_known() {
        let sheet = StyleRules::new("g.st0 > path, .st1.st-2 {fill:red}");
        assert!(["st0", "st1", "st-2"].iter().all(|c| sheet.styles_class(c)));
        assert!(!sheet.styles_class("leaf"));
    }
}
