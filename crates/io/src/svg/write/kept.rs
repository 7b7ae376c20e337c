//! What a result keeps of a file: strokes and obstacles beside the elements, and the file itself where only a part is made anew.

use std::fmt::Write as _;

use arabesque_core::{Placement, Result};

use crate::svg::{
    read::host_document::Rest,
    write::result::{Sheet, Writer},
};

impl<'a> Writer<'a> {
    /// The new at the end of the file that it belongs to.
    pub(crate) fn hosted(&mut self, host: &Rest) -> Result<()> {
        self.out.push_str(&host.head);
        self.metadata();
        self.definitions();
        if !host.moved.is_empty() {
            let _ = write!(
                self.out,
                "<g inkscape:groupmode=\"layer\" inkscape:label=\"Kept\" id=\"{}-kept\">\n{}</g>\n",
                self.prefix, host.moved
            );
        }
        self.elements()?;
        self.out.push_str(&host.tail);
        Ok(())
    }

    /// The strokes that the user drew, unchanged and whole.
    pub(crate) fn kept_strokes(&mut self) {
        let Some(kept) = self.sheet.kept.filter(|k| !k.curve_fragments.is_empty()) else { return };
        let _ = writeln!(
            self.out,
            "<g inkscape:groupmode=\"layer\" inkscape:label=\"Kept strokes\" id=\"{}-kept-strokes\">",
            self.prefix
        );
        for (fragment, extent) in &kept.curve_fragments {
            for shift in self.shifts(extent) {
                let _ = writeln!(self.out, "<g{}>{}</g>", self.shifted(shift), fragment.markup);
            }
        }
        self.out.push_str("</g>\n");
    }

    /// What the user placed beside elements of the exemplar.
    pub(crate) fn obstacles(&mut self) {
        let Some(kept) = self.sheet.kept.filter(|k| !k.obstacle_fragments.is_empty()) else { return };
        let _ =
            writeln!(self.out, "<g inkscape:groupmode=\"layer\" inkscape:label=\"Kept\" id=\"{}-kept\">", self.prefix);
        for (fragment, outline) in kept.obstacle_fragments.iter().zip(&kept.obstacles) {
            for shift in self.shifts(&outline.bounds()) {
                let _ = writeln!(self.out, "<g{}>{}</g>", self.shifted(shift), fragment.markup);
            }
        }
        self.out.push_str("</g>\n");
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
            .chain(k.curve_fragments.iter().map(|(f, _)| f))
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
    let starts = |t: &str, prefix: &str| ['"', '\''].iter().any(|q| t.contains(&format!("{q}{prefix}-")));
    let taken = |prefix: &str| texts.iter().any(|t| starts(t, prefix));
    let candidates = std::iter::once("arabesque".to_owned()).chain((2..).map(|n| format!("arabesque{n}")));
    candidates.into_iter().find(|p| !taken(p)).unwrap_or_else(|| "arabesque".to_owned())
}
