//! What a file says about its items: names, marks, parts in a job.

use roxmltree::{Node as Xml, NodeId};

use crate::svg::{
    namespace::INKSCAPE,
    parse::{
        notes::Note,
        source::{Source, clip_text, href},
    },
};

/// What the author says an item is, with `data-arabesque`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mark {
    Element,
    Curve,
    Ignore,
}

/// The part that a layer plays in a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    Exemplar,
    Domain,
    Avoid,
    Flow,
}

/// Names, marks and place of a node in the file.
#[derive(Clone, Debug)]
pub(crate) struct Meta {
    pub(crate) xml: NodeId,
    pub(crate) tag: &'static str,
    pub(crate) id: Option<String>,
    pub(crate) label: Option<String>,
    pub(crate) class: Option<String>,
    /// `data-arabesque-class`: written by arabesque itself.
    pub(crate) kind: Option<String>,
    /// `data-arabesque-source`: which exemplar element it is a copy of.
    pub(crate) source: Option<usize>,
    /// `data-arabesque-curve`: which exemplar curve it is painted like.
    pub(crate) curve: Option<usize>,
    /// Id of what a `<use>` shows.
    pub(crate) shows: Option<String>,
    pub(crate) is_layer: bool,
    pub(crate) part: Option<Part>,
    pub(crate) mark: Option<Mark>,
}

impl Meta {
    /// Bytes of its names.
    pub(crate) fn bytes(&self) -> usize {
        [&self.id, &self.label, &self.class, &self.kind, &self.shows].into_iter().flatten().map(String::len).sum()
    }
}

/// Reads the names and marks of a node.
pub(crate) fn meta(source: &Source<'_>, xml: Xml<'_, '_>, tag: &'static str) -> Meta {
    let text = |name: &str| xml.attribute(name).map(str::trim).filter(|t| !t.is_empty()).map(str::to_owned);
    let label = xml.attribute((INKSCAPE, "label")).map(|l| l.trim().to_owned()).filter(|l| !l.is_empty());
    let is_layer = xml.attribute((INKSCAPE, "groupmode")) == Some("layer");
    let mark = xml.attribute("data-arabesque").and_then(|value| {
        let mark = match value.trim().to_ascii_lowercase().as_str() {
            "element" => Some(Mark::Element),
            "curve" => Some(Mark::Curve),
            "ignore" => Some(Mark::Ignore),
            _ => None,
        };
        if mark.is_none() {
            source.notes.add(Note::Override, || clip_text(value, 40).to_owned());
        }
        mark
    });
    let stated = xml.attribute("data-arabesque-role").and_then(part);
    Meta {
        xml: xml.id(),
        tag,
        id: text("id"),
        class: text("class"),
        kind: text("data-arabesque-class"),
        source: xml.attribute("data-arabesque-source").and_then(|s| s.trim().parse().ok()),
        curve: xml.attribute("data-arabesque-curve").and_then(|s| s.trim().parse().ok()),
        shows: (tag == "use").then(|| href(xml)).flatten().map(|h| h.trim().to_owned()),
        is_layer,
        part: stated.or_else(|| label.as_deref().filter(|_| is_layer).and_then(part)),
        label,
        mark,
    }
}

/// Layer names that say what a layer is for, in any case.
const PARTS: [(Part, &[&str]); 4] = [
    (Part::Exemplar, &["exemplar", "example", "vorlage", "exemplaire", "ejemplar", "esempio"]),
    (Part::Domain, &["domain", "bereich", "domaine", "dominio"]),
    (Part::Avoid, &["avoid", "meiden", "éviter", "evitar", "evita"]),
    (Part::Flow, &["flow", "fluss", "flux", "flujo", "flusso"]),
];

/// The part that a layer of that name plays.
pub(crate) fn part(name: &str) -> Option<Part> {
    let name = name.trim().to_lowercase();
    PARTS.iter().find(|(_, names)| names.contains(&name.as_str())).map(|(part, _)| *part)
}
