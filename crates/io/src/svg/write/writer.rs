//! A file of a result while it grows, and what all of its parts need: ids, definitions, shifts.

use std::{collections::BTreeSet, fmt::Write as _};

use arabesque_core::{Bounds, Decimals, Domain, Placement, Vector, Warning};

use crate::svg::{
    copies::shifts,
    write::{
        document::recipe_element,
        sheet::{Sheet, Style},
        text::outline_data,
    },
};

/// A file on its way.
pub(crate) struct Writer<'a> {
    pub(crate) sheet: &'a Sheet<'a>,
    pub(crate) decimals: Decimals,
    pub(crate) prefix: String,
    pub(crate) out: String,
    /// The place in the head of a refilled file for which is written now; none for its end.
    pub(crate) place: Option<usize>,
    /// Where in the text what is written for that begins.
    pub(crate) written_from: usize,
    /// What was written for places in the head, and for its end.
    pub(crate) inserted: Vec<(usize, String)>,
    pub(crate) at_end: String,
    pub(crate) warnings: Vec<Warning>,
}

impl<'a> Writer<'a> {
    /// Nothing yet.
    pub(crate) fn new(sheet: &'a Sheet<'a>) -> Self {
        let extent = sheet.page.view.size();
        let decimals = Decimals::for_extent(extent[0].max(extent[1]));
        Self {
            sheet,
            decimals,
            prefix: free_prefix(sheet),
            out: String::new(),
            place: None,
            written_from: 0,
            inserted: Vec::new(),
            at_end: String::new(),
            warnings: Vec::new(),
        }
    }

    /// The recipe, where there is one.
    pub(crate) fn metadata(&mut self) {
        if let Some(recipe) = self.sheet.recipe {
            let _ = write!(self.out, "<metadata>\n{}\n</metadata>\n", recipe_element(recipe, ""));
        }
    }

    pub(crate) fn definitions(&mut self) {
        self.out.push_str("<defs>\n");
        let of_kept = self.sheet.kept.map(|k| &k.definitions);
        let of_host = self.sheet.host.map(|h| &h.definitions);
        for text in [Some(&self.sheet.drawing.definitions), of_kept, of_host].into_iter().flatten() {
            if !text.trim().is_empty() {
                self.out.push_str(text.trim_end());
                self.out.push('\n');
            }
        }
        if let Some(shape) = self.sheet.shape {
            let _ = writeln!(
                self.out,
                "<clipPath id=\"{}-domain\"><path d=\"{}\" clip-rule=\"evenodd\"/></clipPath>",
                self.prefix,
                outline_data(shape, self.decimals)
            );
        }
        if self.sheet.style == Style::Linked {
            for source in self.linked_sources() {
                let markup = &self.sheet.drawing.fragments[source].markup;
                let _ = writeln!(self.out, "<g id=\"{}-element-{source}\">{markup}</g>", self.prefix);
            }
        }
        self.out.push_str("</defs>\n");
    }

    /// The exemplar elements that are placed by `<use>`, each once.
    fn linked_sources(&self) -> BTreeSet<usize> {
        let is_new = |p: &&Placement<2>| !self.is_hosted(p) && self.kept_markup(p).is_none();
        let own = self.sheet.placements.iter().filter(|p| !self.is_bent(p)).filter(is_new);
        own.map(|p| p.source).collect()
    }

    pub(crate) fn shifted(&self, shift: Vector<2>) -> String {
        if shift == Vector::ZERO {
            return String::new();
        }
        format!(" transform=\"translate({} {})\"", self.decimals.format(shift[0]), self.decimals.format(shift[1]))
    }

    pub(crate) fn is_bent(&self, placement: &Placement<2>) -> bool {
        self.sheet.bend.is_some() && !placement.control.is_empty()
    }

    /// The shifts under which a box is seen: none, or on a torus one for every tile that it reaches into.
    pub(crate) fn shifts(&self, bounds: &Bounds<2>) -> Vec<Vector<2>> {
        let Domain::Torus(tile) = self.sheet.domain else { return vec![Vector::ZERO] };
        shifts(bounds, tile)
    }

    /// Whether a placement stands in the file already.
    pub(crate) fn is_hosted(&self, placement: &Placement<2>) -> bool {
        self.sheet.host.is_some() && placement.frozen.is_some()
    }

    pub(crate) fn kept_markup(&self, placement: &Placement<2>) -> Option<&'a str> {
        let fragment = self.sheet.kept?.fragments.get(placement.frozen?)?;
        Some(&fragment.markup)
    }
}

/// A prefix for new ids that no id of the exemplar starts with.
pub(crate) fn free_prefix(sheet: &Sheet<'_>) -> String {
    let kept = sheet.kept.into_iter().flat_map(|k| {
        k.fragments
            .iter()
            .chain(&k.obstacle_fragments)
            .chain(k.curve_fragments.iter().map(|k| &k.fragment))
            .map(|f| &f.markup)
            .chain(std::iter::once(&k.definitions))
    });
    let texts: Vec<&String> = sheet
        .drawing
        .fragments
        .iter()
        .map(|f| &f.markup)
        .chain(std::iter::once(&sheet.drawing.definitions))
        .chain(&sheet.drawing.background)
        .chain(kept)
        .collect();
    let host = sheet.host.into_iter().flat_map(|h| [&h.head, &h.tail, &h.moved, &h.definitions]);
    let texts: Vec<&String> = texts.into_iter().chain(host).collect();
    let taken: BTreeSet<&str> = texts.iter().flat_map(|t| numbers_of(t)).collect();
    let number = std::iter::once(String::new()).chain((2..).map(|n: u64| n.to_string()));
    let free = { number }.find(|n| !taken.contains(n.as_str()));
    format!("{PREFIX}{}", free.unwrap_or_default())
}

/// What ids of the program start with, before a number and a dash.
const PREFIX: &str = "arabesque";

/// The numbers in ids, or references to them, that could be the program's own; none at all is empty.
fn numbers_of(text: &str) -> impl Iterator<Item = &str> {
    text.match_indices(PREFIX).filter_map(|(at, _)| {
        let is_start = text[..at].ends_with(['"', '\'']);
        let rest = &text[at + PREFIX.len()..];
        let number = &rest[..rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len())];
        (is_start && rest[number.len()..].starts_with('-')).then_some(number)
    })
}
