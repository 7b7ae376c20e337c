//! What a result keeps of another file beside elements: strokes and obstacles.

use std::fmt::Write as _;

use crate::svg::{drawing::KeptStrokes, write::writer::Writer};

impl Writer<'_> {
    /// The strokes that the user drew, unchanged and whole.
    pub(crate) fn kept_strokes(&mut self) {
        let all = self.sheet.kept.iter().flat_map(|k| &k.curve_fragments).collect::<Vec<_>>();
        self.kept_group(&all, "");
    }

    /// Some of them in a group whose id ends in `suffix`; nothing without any.
    pub(crate) fn kept_group(&mut self, strokes: &[&KeptStrokes], suffix: &str) {
        if strokes.is_empty() {
            return;
        }
        let _ = writeln!(
            self.out,
            "<g inkscape:groupmode=\"layer\" inkscape:label=\"Kept strokes\" id=\"{}-kept-strokes{suffix}\">",
            self.prefix
        );
        for strokes in strokes {
            for shift in self.shifts(&strokes.extent) {
                let _ = writeln!(self.out, "<g{}>{}</g>", self.shifted(shift), strokes.fragment.markup);
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
}
