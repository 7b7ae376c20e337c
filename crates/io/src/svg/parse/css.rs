//! Style sheets: which rules apply to an element.

use std::{cell::Cell, collections::BTreeSet, rc::Rc};

use roxmltree::Node as Xml;
use simplecss::{AttributeOperator, Declaration, PseudoClass, Rule, StyleSheet};

/// Steps that selectors may take up the tree for a whole file; beyond it descendant rules no longer match.
const STEPS: u64 = 200_000_000;

/// The rules of a file, weakest first. A clone shares the rules, and counts its own steps from there.
#[derive(Clone)]
pub(crate) struct StyleRules<'a> {
    rules: Rc<[Rule<'a>]>,
    /// Class names that some rule refers to.
    styled: Rc<BTreeSet<String>>,
    steps: Cell<u64>,
}

impl<'a> StyleRules<'a> {
    /// Parses style sheet text. Rules that are not understood are skipped, as CSS demands.
    pub(crate) fn new(css: &'a str) -> Self {
        let mut rules = StyleSheet::parse(css).rules;
        // A selector that starts with a combinator is an error in CSS; the parser lets it through.
        rules.retain(|rule| {
            rule.selector.to_string().starts_with(|c: char| c.is_alphanumeric() || ".#[*:_".contains(c))
        });
        let styled: BTreeSet<String> = rules.iter().flat_map(|rule| class_names(&rule.selector.to_string())).collect();
        Self { rules: rules.into(), styled: Rc::new(styled), steps: Cell::new(0) }
    }

    /// Declarations that apply to `node`, weakest first.
    pub(crate) fn declarations<'s>(&'s self, node: Xml<'s, 's>) -> impl Iterator<Item = Declaration<'a>> + 's {
        let element = Element { node, steps: &self.steps };
        let matching = self.rules.iter().filter(move |rule| rule.selector.matches(&element));
        matching.flat_map(|rule| rule.declarations.iter().copied())
    }

    /// Whether a class is used for styling, and so says nothing about what an element is.
    pub(crate) fn styles_class(&self, class: &str) -> bool {
        self.styled.contains(class)
    }

    /// Whether matching was cut short.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.steps.get() > STEPS
    }
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
    fn step(&self, to: Option<Xml<'a, 'a>>) -> Option<Self> {
        self.steps.set(self.steps.get() + 1);
        to.filter(|_| self.steps.get() <= STEPS).map(|node| Self { node, steps: self.steps })
    }
}

impl simplecss::Element for Element<'_> {
    fn parent_element(&self) -> Option<Self> {
        self.step(self.node.parent_element())
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.step(self.node.prev_sibling_element())
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.node.tag_name().name() == name
    }

    fn attribute_matches(&self, local_name: &str, operator: AttributeOperator<'_>) -> bool {
        self.node.attribute(local_name).is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        matches!(class, PseudoClass::FirstChild) && self.node.prev_sibling_element().is_none()
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
    fn classes_in_selectors_are_known() {
        let sheet = StyleRules::new("g.st0 > path, .st1.st-2 {fill:red}");
        assert!(["st0", "st1", "st-2"].iter().all(|c| sheet.styles_class(c)));
        assert!(!sheet.styles_class("leaf"));
    }
}
