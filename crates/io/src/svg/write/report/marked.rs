//! A drawing in pale with numbered places on it, and a panel of text beside it that says what they are.

use std::fmt::Write as _;

use arabesque_core::{Decimals, Outline, Vector};

use crate::{
    svg::{
        drawing::Drawing,
        namespace::{NAMESPACE, SVG, XLINK},
        write::{
            document::DECLARATION,
            report::survey::faded_curves,
            text::{outline_data, rectangle},
        },
    },
    text::xml::escape,
};

/// Longer side of the drawing in the picture, in CSS pixels.
const SIDE: f64 = 1000.0;
/// Width of the panel, margin around everything, size of the text, and from line to line.
const PANEL: f64 = 560.0;
const MARGIN: f64 = 16.0;
const TEXT: f64 = 13.0;
const LINE: f64 = 18.0;
/// How pale the drawing is.
const PALE: f64 = 0.32;
/// Radius of the discs that hold the numbers, and of the smallest circle around a place.
const DISC: f64 = 10.0;
const SMALLEST: f64 = 7.0;
/// Letters of a line of the panel.
const LETTERS: usize = 74;

/// A place that is marked.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkedPlace {
    /// Its middle, in the coordinates of the drawing.
    pub at: Vector<2>,
    /// Radius of the circle around it.
    pub radius: f64,
    /// What it takes; where there is something, it is drawn in place of the circle.
    pub outline: Outline<2>,
    /// Colour of the mark.
    pub colour: &'static str,
    /// Number beside it.
    pub number: usize,
    /// What is said where it is pointed at.
    pub title: String,
}

/// A line of the panel.
#[derive(Clone, Debug, PartialEq)]
pub struct PanelLine {
    /// Colour of the dot before it, and the number in that; no dot without.
    pub dot: Option<(&'static str, Option<usize>)>,
    /// The text; what does not fit goes on in the next line.
    pub text: String,
    /// Whether it is a heading.
    pub is_heading: bool,
}

/// Everything that a marked drawing shows.
#[derive(Clone, Copy, Debug)]
pub struct MarkedSheet<'a> {
    /// What is shown in pale.
    pub drawing: &'a Drawing,
    /// Places on it, from bottom to top.
    pub places: &'a [MarkedPlace],
    /// The panel, from top to bottom.
    pub lines: &'a [PanelLine],
}

/// Writes a marked drawing.
pub fn write_marked(sheet: &MarkedSheet<'_>) -> String {
    let view = sheet.drawing.page.view;
    let size = view.size();
    let scale = SIDE / size[0].max(size[1]);
    let (width, height) = (size[0] * scale, size[1] * scale);
    let lines: Vec<(Option<&PanelLine>, String)> = sheet.lines.iter().flat_map(wrapped).collect();
    let all = (width + PANEL + 3.0 * MARGIN, height.max(lines.len() as f64 * LINE + LINE) + 2.0 * MARGIN);
    let d = Decimals::for_extent(SIDE);
    let (w, h) = (d.format(all.0), d.format(all.1));
    let mut out = format!(
        "{DECLARATION}<svg xmlns=\"{SVG}\" xmlns:xlink=\"{XLINK}\" xmlns:arabesque=\"{NAMESPACE}\" width=\"{w}\" \
         height=\"{h}\" viewBox=\"0 0 {w} {h}\" font-family=\"sans-serif\" font-size=\"{TEXT}\">\n\
         <rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n"
    );
    pale(&mut out, sheet.drawing, (width, height));
    let _ = writeln!(out, "<g transform=\"translate({MARGIN} {MARGIN})\">");
    let place = |p: Vector<2>| (p - view.min) * scale;
    for marked in sheet.places {
        mark(&mut out, marked, &place, scale);
    }
    out.push_str("</g>\n");
    panel(&mut out, &lines, 2.0 * MARGIN + width);
    out.push_str("</svg>\n");
    out
}

/// The drawing itself, cut at its page.
fn pale(out: &mut String, drawing: &Drawing, (width, height): (f64, f64)) {
    let view = drawing.page.view;
    let size = view.size();
    let inner = Decimals::for_extent(size[0].max(size[1]));
    let outer = Decimals::for_extent(SIDE);
    let [x, y, w, h] = [view.min[0], view.min[1], size[0], size[1]].map(|v| inner.format(v));
    let _ = write!(
        out,
        "<svg x=\"{MARGIN}\" y=\"{MARGIN}\" width=\"{}\" height=\"{}\" viewBox=\"{x} {y} {w} {h}\" overflow=\"hidden\">\n\
         <defs>{}</defs>\n<g opacity=\"{PALE}\">\n",
        outer.format(width),
        outer.format(height),
        drawing.definitions
    );
    out.extend(drawing.background.iter().chain(drawing.fragments.iter().map(|f| &f.markup)).map(|m| format!("{m}\n")));
    faded_curves(out, drawing, inner);
    let frame = outline_data(&rectangle(&view), inner);
    let line = inner.plus(2).format(2.0 * size[0].max(size[1]) / SIDE);
    let _ =
        writeln!(out, "</g>\n<path d=\"{frame}\" fill=\"none\" stroke=\"#808080\" stroke-width=\"{line}\"/>\n</svg>");
}

/// One place: its outline or a circle, and its number.
fn mark(out: &mut String, marked: &MarkedPlace, place: &dyn Fn(Vector<2>) -> Vector<2>, scale: f64) {
    let d = Decimals::for_extent(SIDE);
    let (at, colour) = (place(marked.at), marked.colour);
    let radius = (marked.radius * scale).max(SMALLEST);
    let _ = write!(out, "<g stroke=\"{colour}\"><title>{}</title>", escape(&marked.title));
    let (x, y) = (d.format(at[0]), d.format(at[1]));
    if marked.outline.rings.is_empty() {
        let _ = write!(
            out,
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\" fill=\"{colour}\" fill-opacity=\"0.14\" stroke-width=\"2.5\"/>",
            d.format(radius)
        );
    } else {
        let rings = marked.outline.rings.iter().map(|ring| ring.iter().map(|&p| place(p)).collect()).collect();
        let data = outline_data(&Outline { rings }, d);
        let _ = write!(
            out,
            "<path d=\"{data}\" fill=\"{colour}\" fill-opacity=\"0.3\" fill-rule=\"evenodd\" stroke-width=\"2\"/>"
        );
        // What is small is seen by the circle around it.
        if radius < 2.0 * DISC {
            let r = d.format(radius + SMALLEST);
            let _ = write!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"none\" stroke-width=\"2\"/>");
        }
    }
    let aside = Vector::xy(1.0, -1.0) * (radius.min(6.0 * DISC) * std::f64::consts::FRAC_1_SQRT_2 + 0.4 * DISC);
    number(out, at + aside, colour, marked.number);
    out.push_str("</g>\n");
}

/// A number in a disc.
fn number(out: &mut String, at: Vector<2>, colour: &str, number: usize) {
    let d = Decimals::for_extent(SIDE);
    let _ = write!(
        out,
        "<circle cx=\"{}\" cy=\"{}\" r=\"{DISC}\" fill=\"#ffffff\" stroke=\"{colour}\" stroke-width=\"1.5\"/>\
         <text x=\"{}\" y=\"{}\" text-anchor=\"middle\" font-size=\"11\" stroke=\"none\" fill=\"#000000\">{number}</text>",
        d.format(at[0]),
        d.format(at[1]),
        d.format(at[0]),
        d.format(at[1] + 4.0)
    );
}

/// A line of the panel as lines that fit, the dot at the first.
fn wrapped(line: &PanelLine) -> Vec<(Option<&PanelLine>, String)> {
    let mut lines: Vec<String> = vec![String::new()];
    for word in line.text.split_whitespace() {
        let last = lines.len() - 1;
        if !lines[last].is_empty() && lines[last].chars().count() + word.chars().count() >= LETTERS {
            lines.push(word.to_owned());
            continue;
        }
        if !lines[last].is_empty() {
            lines[last].push(' ');
        }
        lines[last].push_str(word);
    }
    lines.into_iter().enumerate().map(|(k, text)| ((k == 0).then_some(line), text)).collect()
}

fn panel(out: &mut String, lines: &[(Option<&PanelLine>, String)], left: f64) {
    let d = Decimals::for_extent(SIDE);
    for (k, (line, text)) in lines.iter().enumerate() {
        let y = MARGIN + (k as f64 + 0.8) * LINE;
        let weight = if line.is_some_and(|l| l.is_heading) { " font-weight=\"bold\"" } else { "" };
        match line.and_then(|l| l.dot) {
            Some((colour, Some(n))) => {
                number(out, Vector::xy(left + DISC, y - 0.3 * TEXT), colour, n);
            }
            Some((colour, None)) => {
                let (x, y) = (d.format(left + DISC), d.format(y - 0.3 * TEXT));
                let _ = write!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"5\" fill=\"{colour}\"/>");
            }
            None => {}
        }
        let is_heading = line.is_some_and(|l| l.is_heading && l.dot.is_none());
        let x = d.format(if is_heading { left } else { left + 2.5 * DISC });
        let _ = writeln!(out, "<text x=\"{x}\" y=\"{}\"{weight} fill=\"#202020\">{}</text>", d.format(y), escape(text));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::{ReadOptions, read_exemplar};

    #[test]
    fn marks_lie_where_they_belong_and_long_lines_go_on() {
        let text = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='10 20 50 100'><circle cx='20' cy='40' r='3'/>\
                    <circle cx='40' cy='90' r='3'/></svg>";
        let drawing = read_exemplar(text, &ReadOptions::new("d.svg")).unwrap();
        let place = MarkedPlace {
            at: Vector::xy(35.0, 70.0),
            radius: 5.0,
            outline: Outline::default(),
            colour: "#d55e00",
            number: 1,
            title: "a <hole>".into(),
        };
        let line = PanelLine { dot: Some(("#d55e00", Some(1))), text: "word ".repeat(30), is_heading: false };
        let svg = write_marked(&MarkedSheet { drawing: &drawing, places: &[place], lines: &[line] });
        assert!(svg.contains("<title>a &lt;hole&gt;</title><circle cx=\"250\" cy=\"500\" r=\"50\""), "{svg}");
        assert_eq!(svg.matches("<text").count(), 1 + 1 + 2, "two numbers and two lines: {svg}");
        roxmltree::Document::parse(&svg).unwrap();
    }
}
