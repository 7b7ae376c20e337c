//! How large a drawing is once every reference to an element stands for that element itself.

use std::collections::HashMap;

use arabesque_core::{Budget, Error, Result};
use resvg::usvg::roxmltree::{Document, Node};

/// References in references, beyond which a drawing is refused.
const DEPTH: usize = 64;
/// Work of looking at one node.
const NODE: u64 = 60;

/// A reference that is resolved by a copy: where it stands in the text, and the name of what it shows.
struct Use<'a> {
    at: usize,
    target: &'a str,
}

/// Bytes of the text of `document` when each `use` is replaced by what it shows.
///
/// # Errors
/// [`Error::Limit`] when references are nested too deeply, or the work is used up.
pub(super) fn expanded(document: &Document<'_>, budget: &Budget) -> Result<usize> {
    let mut meter = budget.meter();
    let (mut uses, mut named) = (Vec::new(), HashMap::new());
    for node in document.root().descendants().filter(Node::is_element) {
        meter.spend(NODE)?;
        if let Some(id) = node.attribute("id") {
            named.entry(id).or_insert_with(|| node.range());
        }
        if node.tag_name().name() == "use"
            && let Some(target) = reference(&node)
        {
            uses.push(Use { at: node.range().start, target });
        }
    }
    let mut sizes = Sizes { uses, named, known: HashMap::new() };
    let all = document.root().range();
    sizes.of(all, 0, budget)
}

fn reference<'a>(node: &Node<'a, '_>) -> Option<&'a str> {
    let href = node.attributes().find(|a| a.name() == "href")?;
    href.value().strip_prefix('#')
}

struct Sizes<'a> {
    /// In the order of the text.
    uses: Vec<Use<'a>>,
    named: HashMap<&'a str, std::ops::Range<usize>>,
    known: HashMap<&'a str, usize>,
}

impl<'a> Sizes<'a> {
    /// Bytes of a part of the text, with what is shown in it.
    fn of(&mut self, range: std::ops::Range<usize>, depth: usize, budget: &Budget) -> Result<usize> {
        if depth > DEPTH {
            return Err(Error::Limit {
                what: "references within references of the drawing".into(),
                found: format!("more than {DEPTH}"),
                limit: DEPTH.to_string(),
                advice: "place the elements themselves".into(),
            });
        }
        let first = self.uses.partition_point(|u| u.at < range.start);
        let end = self.uses.partition_point(|u| u.at < range.end);
        let mut size = range.len();
        for k in first..end {
            budget.spend(NODE)?;
            let target = self.uses[k].target;
            let more = match (self.known.get(target), self.named.get(target).cloned()) {
                (Some(&known), _) => known,
                (None, None) => 0,
                (None, Some(range)) => {
                    let found = self.of(range, depth + 1, budget)?;
                    self.known.insert(target, found);
                    found
                }
            };
            size = size.saturating_add(more);
        }
        Ok(size)
    }
}
