//! What a result keeps of another file beside elements: strokes and obstacles.

use std::fmt::Write as _;

use crate::svg::write::writer::Writer;

impl Writer<'_> {
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
}
