//! A cell of a repeat, drawn over a picture of what was understood.

use std::fmt::Write as _;

use arabesque_core::{Bounds, Decimals, Vector};

use crate::svg::drawing::Page;

/// Colour of the cell.
const COLOUR: &str = "#d6006c";

/// Width of its lines, length and half width of the heads of its arrows, as shares of the shorter vector.
const LINE: f64 = 0.015;
const HEAD: [f64; 2] = [0.12, 0.05];

/// A cell: the parallelogram of two vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RepeatCell {
    /// Its corner.
    pub corner: Vector<2>,
    /// The vectors along its sides.
    pub vectors: [Vector<2>; 2],
}

impl RepeatCell {
    /// The cell in the middle of a frame.
    pub fn in_the_middle(vectors: [Vector<2>; 2], frame: &Bounds<2>) -> Self {
        Self { corner: frame.centre() - (vectors[0] + vectors[1]) * 0.5, vectors }
    }
}

/// A finished picture on `page` with the cell over it: the parallelogram, and both vectors as arrows from its corner.
pub fn with_cell(picture: String, page: &Page, cell: &RepeatCell) -> String {
    let Some(body) = picture.trim_end().strip_suffix("</svg>") else { return picture };
    let (p, [a, b]) = (cell.corner, cell.vectors);
    let d = Decimals::for_extent(page.view.size()[0].max(page.view.size()[1])).plus(2);
    let at = |v: Vector<2>| format!("{} {}", d.format(v[0]), d.format(v[1]));
    let unit = a.norm().min(b.norm());
    let mut out = body.to_owned();
    let _ = writeln!(
        out,
        "<g stroke=\"{COLOUR}\" stroke-width=\"{}\" fill=\"{COLOUR}\"><title>cell of the repeat</title>\
         <path d=\"M{}L{}L{}L{}Z\" fill-opacity=\"0.12\"/>",
        d.format(LINE * unit),
        at(p),
        at(p + a),
        at(p + a + b),
        at(p + b)
    );
    for v in [a, b] {
        let (way, tip) = (v.unit_or_zero(), p + v);
        let (back, aside) = (tip - way * (HEAD[0] * unit), Vector::xy(-way[1], way[0]) * (HEAD[1] * unit));
        let _ = writeln!(
            out,
            "<path d=\"M{}L{}\" stroke-width=\"{}\"/><path d=\"M{}L{}L{}Z\" stroke=\"none\"/>",
            at(p),
            at(back),
            d.format(2.0 * LINE * unit),
            at(tip),
            at(back + aside),
            at(back - aside)
        );
    }
    out.push_str("</g>\n</svg>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::unit::Unit;

    #[test]
    fn a_cell_lies_in_the_middle_and_on_top() {
        let view = Bounds::new(Vector::ZERO, Vector::xy(100.0, 60.0));
        let cell = RepeatCell::in_the_middle([Vector::xy(20.0, 0.0), Vector::xy(10.0, 30.0)], &view);
        assert_eq!(cell.corner, Vector::xy(35.0, 15.0));
        let page = Page { view, unit: Unit::Px, unit_per_user: 1.0 };
        let text = with_cell("<svg><path d=\"M0 0\"/></svg>\n".into(), &page, &cell);
        assert!(text.starts_with("<svg><path d=\"M0 0\"/><g ") && text.ends_with("</g>\n</svg>\n"), "{text}");
        assert!(text.contains("M35 15L55 15L65 45L45 45Z"), "{text}");
        assert_eq!(with_cell("not a picture".into(), &page, &cell), "not a picture");
    }
}
