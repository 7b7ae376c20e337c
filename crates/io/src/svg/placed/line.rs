//! The text of one element, and its attributes.

use std::ops::Range;

use crate::{placed::splice::Splices, text::xml::escape};

/// One element of the text: a `<use>` or a group.
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// From the start of its tag to the end of it, with the end of the line.
    pub(super) range: Range<usize>,
    /// Where its content stands; empty for an empty element.
    pub(super) content: Range<usize>,
    /// Where further attributes may be put in.
    slot: usize,
    /// Where the values of its attributes stand.
    attributes: Vec<(String, Range<usize>)>,
}

impl Line {
    pub(super) fn new(node: roxmltree::Node<'_, '_>, text: &str) -> Self {
        let attributes: Vec<_> =
            node.attributes().map(|a| (a.name().to_owned(), a.range_value(), a.range().end)).collect();
        let slot = attributes.first().map_or(node.range().start, |(_, _, end)| *end);
        let content = match (node.first_child(), node.last_child()) {
            (Some(first), Some(last)) => first.range().start..last.range().end,
            _ => 0..0,
        };
        let mut range = node.range();
        range.end += text[range.end..].bytes().take_while(|b| matches!(b, b'\r' | b'\n')).take(2).count();
        Self {
            range,
            content,
            slot,
            attributes: attributes.into_iter().map(|(name, value, _)| (name, value)).collect(),
        }
    }

    /// The value of an attribute as it is written.
    pub(super) fn raw<'t>(&self, name: &str, text: &'t str) -> Option<&'t str> {
        let (_, range) = self.attributes.iter().find(|(known, _)| known == name)?;
        text.get(range.clone())
    }

    /// The same element with other attributes, and other content where that is given. An attribute without a value is left out.
    pub(super) fn with(&self, text: &str, values: &[(&str, Option<String>)], content: Option<String>) -> String {
        let own = text.get(self.range.clone()).unwrap_or_default();
        let local = |range: &Range<usize>| range.start - self.range.start..range.end - self.range.start;
        let mut splices = Splices::default();
        for (name, value) in values {
            let known = self.attributes.iter().find(|(known, _)| known == name);
            match (known, value) {
                (Some((_, range)), Some(value)) => splices.put(local(range), escape(value)),
                (Some((_, range)), None) => {
                    // With the blank before it, its name, and the quotes.
                    let head = &own[..local(range).start];
                    let from = head.rfind(name).map_or(local(range).start, |at| head[..at].trim_end().len());
                    splices.put(from..local(range).end + 1, "");
                }
                (None, Some(value)) => {
                    let slot = self.slot - self.range.start;
                    splices.put(slot..slot, format!(" {name}=\"{}\"", escape(value)));
                }
                (None, None) => {}
            }
        }
        if let Some(content) = content {
            splices.put(local(&self.content), content);
        }
        splices.apply(own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_are_changed_added_and_removed() {
        let text = "<s>\n<use id=\"a\" opacity = \"0.5\" href='#b'/>\n<g id=\"c\"><path/></g>\n</s>";
        let document = roxmltree::Document::parse(text).unwrap();
        let lines: Vec<_> = document
            .root_element()
            .children()
            .filter(roxmltree::Node::is_element)
            .map(|node| Line::new(node, text))
            .collect();
        let put = |v: &str| Some(v.to_owned());
        let changed = lines[0].with(text, &[("href", put("#z")), ("opacity", None), ("transform", put("\"x\""))], None);
        assert_eq!(changed, "<use id=\"a\" transform=\"&quot;x&quot;\" href='#z'/>\n");
        assert_eq!(lines[1].with(text, &[("id", put("d"))], put("<rect/>")), "<g id=\"d\"><rect/></g>\n");
        assert_eq!(lines[1].with(text, &[("opacity", None)], None), "<g id=\"c\"><path/></g>\n");
    }
}
