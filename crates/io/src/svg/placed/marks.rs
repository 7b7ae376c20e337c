//! Marks over a drawing: what an edit would change.

use std::fmt::Write as _;

use arabesque_core::{Bounds, Decimals, Vector};

/// Colour of what changes, and of what goes.
const CHANGED: &str = "#e6007e";
const GONE: &str = "#d00000";
/// Width of marks, in sides of the page.
const WIDTH: f64 = 0.002;
/// Least radius of a mark, in sides of the page.
const LEAST: f64 = 0.006;
/// Room around what is marked, in its radii.
const ROOM: f64 = 1.15;

/// An element that an edit changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Where its centre was; nowhere, where it is new.
    pub from: Option<Vector<2>>,
    /// Where it is; nowhere, where it is gone.
    pub to: Option<Vector<2>>,
    /// How far it reaches from there.
    pub reach: f64,
}

/// The text of a drawing with marks on top: a ring around each element that changes, dashed where it was before, with a line between;
/// a cross through each that goes.
pub fn with_marks(text: &str, page: &Bounds<2>, marks: &[Mark]) -> String {
    let size = page.size();
    let side = size[0].max(size[1]);
    let decimals = Decimals::for_extent(side);
    let number = |v: f64| decimals.format(v);
    let mut out = format!(
        "<g id=\"arabesque-preview\" fill=\"none\" stroke=\"{CHANGED}\" stroke-width=\"{}\">\n",
        number(WIDTH * side)
    );
    for mark in marks {
        let radius = number((ROOM * mark.reach).max(LEAST * side));
        let ring = |p: Vector<2>, more: &str| {
            format!("<circle cx=\"{}\" cy=\"{}\" r=\"{radius}\"{more}/>", number(p[0]), number(p[1]))
        };
        let line = |a: Vector<2>, b: Vector<2>, more: &str| {
            let [x, y, u, v] = [a[0], a[1], b[0], b[1]].map(number);
            format!("<path d=\"M{x} {y}L{u} {v}\"{more}/>")
        };
        let dash = format!(" stroke-dasharray=\"{}\"", number(4.0 * WIDTH * side));
        match (mark.from, mark.to) {
            (Some(from), Some(to)) if (to - from).norm() > 0.5 * WIDTH * side => {
                let _ = writeln!(out, "{}{}{}", ring(from, &dash), line(from, to, ""), ring(to, ""));
            }
            (_, Some(to)) => {
                let _ = writeln!(out, "{}", ring(to, ""));
            }
            (Some(from), None) => {
                let (a, b) =
                    (Vector::splat(mark.reach.max(LEAST * side)), Vector::xy(1.0, -1.0) * mark.reach.max(LEAST * side));
                let red = format!(" stroke=\"{GONE}\"");
                let _ = writeln!(out, "{}{}", line(from - a, from + a, &red), line(from - b, from + b, &red));
            }
            (None, None) => {}
        }
    }
    out.push_str("</g>\n");
    let end = text.rfind("</").unwrap_or(text.len());
    format!("{}{out}{}", &text[..end], &text[end..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_tell_what_moves_comes_and_goes() {
        let text = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 100 50\"><rect/></svg>\n";
        let mark = |from: Option<Vector<2>>, to: Option<Vector<2>>| Mark { from, to, reach: 3.0 };
        let p = Some(Vector::xy(10.0, 20.0));
        let marks = [mark(p, p), mark(p, Some(Vector::xy(15.0, 20.0))), mark(None, p), mark(p, None)];
        let page = Bounds::new(Vector::ZERO, Vector::xy(100.0, 50.0));
        let marked = with_marks(text, &page, &marks);
        roxmltree::Document::parse(&marked).unwrap();
        assert_eq!((marked.matches("<circle").count(), marked.matches("<path").count()), (4, 3));
        assert_eq!(marked.matches("stroke-dasharray").count(), 1);
        assert!(marked.contains("M10 20L15 20") && marked.ends_with("</g>\n</svg>\n"));
    }
}
