//! Fills and strokes by gradients and patterns that are not there.

use crate::svg::parse::{
    notes::Note,
    paint::reference,
    scene::{Content, Node},
    source::{Source, clip_text},
    style::Property as P,
};

/// Notes every shape that is to be painted with something that does not exist, and has no colour to fall back on.
pub(crate) fn note_missing_paints(source: &Source<'_>, node: &Node) {
    if let Content::Shape(_) = &node.content {
        for paint in [P::Fill, P::Stroke] {
            if let Some(Ok((id, fallback))) = reference(node.style.get(paint))
                && (fallback.is_empty() || fallback == "none")
                && source.by_id(id).is_none()
            {
                let line = || source.xml.get_node(node.meta.xml).map_or(1, |xml| source.line(&xml));
                source.notes.add(Note::MissingPaint, || {
                    format!("url(#{}) of <{}> in line {}", clip_text(id, 60), node.meta.tag, line())
                });
            }
        }
    }
    node.children().iter().for_each(|child| note_missing_paints(source, child));
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use crate::svg::{ReadOptions, read_exemplar};

    #[test]
    fn a_paint_that_is_not_there_is_named_with_its_place() {
        let text = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'>\n<rect width='9' height='9' fill='url(#nope)'/></svg>";
        let error = read_exemplar(text, &ReadOptions::new("a.svg")).unwrap_err().to_string();
        assert!(error.contains("url(#nope) of <rect> in line 2"), "{error}");
    }
}
