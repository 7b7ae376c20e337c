//! The text of a drawing of which a part is refilled, without what goes and with what is left of it in its place.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write as _,
    ops::Range,
};

use roxmltree::NodeId;

use crate::svg::{
    namespace::{INKSCAPE, NAMESPACE, SVG, XLINK},
    parse::source::Source,
};

/// A file as it is before and after the end of its root.
pub(crate) struct Around {
    pub(crate) head: String,
    pub(crate) tail: String,
    pub(crate) copied: Copied,
}

/// What of a text was copied or replaced where.
#[derive(Default)]
pub(crate) struct Copied {
    /// Where stretches of the text begin in it, and in the copy.
    stretches: Vec<(usize, usize)>,
    /// What stands in the place of a node.
    replaced: BTreeMap<u32, Range<usize>>,
}

impl Copied {
    /// The part of the copy that draws a node.
    pub(crate) fn find(&self, source: &Source<'_>, id: u32) -> Option<Range<usize>> {
        if let Some(range) = self.replaced.get(&id) {
            return Some(range.clone());
        }
        let range = source.xml.get_node(NodeId::new(id))?.range();
        let after = self.stretches.partition_point(|(from, _)| *from <= range.start);
        let (from, to) = self.stretches.get(after.checked_sub(1)?)?;
        Some(range.start - from + to..range.end - from + to)
    }
}

/// The file without its recipe, what is left of the affected nodes in their places.
pub(crate) fn around(source: &Source<'_>, affected: &BTreeSet<u32>, left: &BTreeMap<u32, String>) -> Around {
    let text = source.text;
    let node = |id: &u32| Some((source.xml.get_node(NodeId::new(*id))?.range(), Some(*id)));
    let mut gaps: Vec<(Range<usize>, Option<u32>)> = affected.iter().filter_map(node).collect();
    for recipe in source.xml.descendants().filter(|n| n.has_tag_name((NAMESPACE, "recipe"))) {
        let alone = recipe.parent().filter(|p| p.tag_name().name() == "metadata");
        let alone = alone.filter(|p| p.children().filter(roxmltree::Node::is_element).count() == 1);
        gaps.push((alone.unwrap_or(recipe).range(), None));
    }
    gaps.sort_by_key(|(r, _)| (r.start, std::cmp::Reverse(r.end)));
    let root = source.xml.root_element().range();
    let end = text.get(..root.end).and_then(|t| t.rfind("</")).unwrap_or(root.end);
    let tag = text.get(root.start..).and_then(|t| t.find(|c: char| c.is_whitespace() || c == '>')).unwrap_or(0);
    let (mut head, mut from) = (declaration(text), prolog(text));
    head.push_str(text.get(from..root.start + tag).unwrap_or_default());
    head.push_str(&namespaces(source));
    from = from.max(root.start + tag);
    let mut copied = Copied::default();
    for (gap, id) in gaps {
        copied.stretches.push((from, head.len()));
        head.push_str(text.get(from..gap.start).unwrap_or_default());
        if let Some((id, left)) = id.and_then(|id| Some((id, left.get(&id)?))) {
            copied.replaced.insert(id, head.len()..head.len() + left.len());
            head.push_str(left);
        }
        from = from.max(gap.end);
    }
    copied.stretches.push((from, head.len()));
    head.push_str(text.get(from..end).unwrap_or_default());
    Around { head, tail: text.get(end..).unwrap_or_default().to_owned(), copied }
}

/// Where the file begins after an XML declaration that names another encoding than the one it will be written in.
fn prolog(text: &str) -> usize {
    let end = text.strip_prefix("<?xml").and_then(|t| t.find("?>")).map_or(0, |k| k + "<?xml?>".len());
    let names_other =
        text.get(..end).is_some_and(|d| d.contains("encoding") && !d.to_ascii_lowercase().contains("utf-8"));
    if names_other { end } else { 0 }
}

fn declaration(text: &str) -> String {
    if prolog(text) > 0 { "<?xml version=\"1.0\" encoding=\"UTF-8\"?>".to_owned() } else { String::new() }
}

/// Declarations of the namespaces that new things need and the root lacks.
fn namespaces(source: &Source<'_>) -> String {
    let needed = [(None, SVG), (Some("xlink"), XLINK), (Some("inkscape"), INKSCAPE), (Some("arabesque"), NAMESPACE)];
    let root = source.xml.root_element();
    let mut out = String::new();
    for (prefix, uri) in needed {
        if root.namespaces().all(|n| n.name() != prefix) {
            let name = prefix.map_or_else(|| "xmlns".to_owned(), |p| format!("xmlns:{p}"));
            let _ = write!(out, " {name}=\"{uri}\"");
        }
    }
    out
}
