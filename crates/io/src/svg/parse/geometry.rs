//! Basic shapes: what they enclose, and the shortest markup that draws them.

use std::{fmt::Write as _, rc::Rc};

use arabesque_core::{Error, Result, rounded};
use kurbo::{BezPath, Point, Shape as _};
use roxmltree::Node as Xml;
use svgtypes::{Length, PointsParser, SimplePathSegment, SimplifyingPathParser};

use crate::{
    svg::parse::{
        guard,
        length::{Axis, Viewport},
        notes::Note,
        source::{Source, clip_text, href},
    },
    text::xml::{escaped, number},
};

/// A shape in its own coordinates.
#[derive(Clone, Debug)]
pub(crate) struct Geometry {
    /// Its outline.
    pub(crate) path: BezPath,
    /// Tag name and geometry attributes, without brackets: `circle cx="1" cy="2" r="3"`.
    pub(crate) markup: Rc<str>,
    /// Whether it is painted with fill and stroke, or a picture.
    pub(crate) paint: Painted,
}

/// What gives a shape its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Painted {
    /// Fill and stroke.
    Style,
    /// Its own pixels.
    Picture,
}

impl Geometry {
    fn new(path: BezPath, markup: String) -> Option<Self> {
        (path.elements().len() > 1).then(|| Self { path, markup: markup.into(), paint: Painted::Style })
    }

    /// A shape drawn as `<path>` with the given outline.
    pub(crate) fn from_path(path: BezPath) -> Self {
        let markup = format!("path d=\"{}\"", path_data(&path)).into();
        Self { path, markup, paint: Painted::Style }
    }
}

/// Largest coordinate or length of a shape before any transform: far beyond anything drawn, and its square is a number that can be
/// reckoned with.
pub(crate) const LARGEST: f64 = 1e15;

/// Bytes that a segment of a path takes.
const SEGMENT_BYTES: usize = 56;

/// Segments of one path after which the limit is looked at, while it is read.
const FORESEEN: usize = 1024;

/// Whether an element of this name is a shape that [`read`] knows.
pub(crate) fn is_shape(name: &str) -> bool {
    matches!(name, "path" | "rect" | "circle" | "ellipse" | "line" | "polyline" | "polygon" | "image")
}

/// The geometry of a shape element; `None` when it draws nothing.
pub(crate) fn read(source: &Source<'_>, node: Xml<'_, '_>, viewport: Viewport) -> Result<Option<Geometry>> {
    let reader = Reader { source, node, viewport };
    let geometry = match node.tag_name().name() {
        "path" => reader.path()?,
        "rect" => reader.rect()?,
        "circle" | "ellipse" => reader.ellipse()?,
        "line" => reader.line()?,
        "polyline" => reader.points(Ends::Open)?,
        "polygon" => reader.points(Ends::Joined)?,
        "image" => reader.image()?,
        _ => None,
    };
    let Some(geometry) = geometry else { return Ok(None) };
    source.count_segments(geometry.path.elements().len())?;
    source.count_bytes(geometry.markup.len() + SEGMENT_BYTES * geometry.path.elements().len())?;
    let extent = geometry.path.control_box();
    if let Some(v) = [extent.x0, extent.y0, extent.x1, extent.y1].iter().find(|v| !(0.0..=LARGEST).contains(&v.abs())) {
        return Err(reader.wrong(format!(
            "a coordinate is {}, expected a number between -{LARGEST:e} and {LARGEST:e}",
            rounded(*v)
        )));
    }
    Ok(Some(geometry))
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Ends {
    Open,
    Joined,
}

struct Reader<'a, 's> {
    source: &'s Source<'s>,
    node: Xml<'a, 'a>,
    viewport: Viewport,
}

impl Reader<'_, '_> {
    fn wrong(&self, problem: impl Into<String>) -> Error {
        Error::input(self.source.place(self.node), problem, "correct or delete this shape")
    }

    /// A length attribute in user units; `None` where it is absent or `auto`.
    fn length(&self, name: &str, axis: Axis) -> Result<Option<f64>> {
        let Some(text) = self.node.attribute(name).map(str::trim).filter(|t| *t != "auto") else { return Ok(None) };
        let length = text
            .parse::<Length>()
            .map_err(|_| self.wrong(format!("{name}=\"{}\" is not a length", clip_text(text, 40))))?;
        let value = self.viewport.resolve(length, axis, 16.0);
        if !(0.0..=LARGEST).contains(&value.abs()) {
            let shown = clip_text(text, 40);
            let problem = format!("{name}=\"{shown}\", expected a number between -{LARGEST:e} and {LARGEST:e}");
            return Err(self.wrong(problem));
        }
        Ok(Some(value))
    }

    fn coordinate(&self, name: &str, axis: Axis) -> Result<f64> {
        Ok(self.length(name, axis)?.unwrap_or(0.0))
    }

    fn path(&self) -> Result<Option<Geometry>> {
        let Some(data) = self.node.attribute("d") else { return Ok(None) };
        let data = &*guard::path_data(data, LARGEST).map_err(|problem| self.wrong(problem))?;
        let mut path = BezPath::new();
        for segment in SimplifyingPathParser::from(data) {
            match segment {
                Ok(segment) => append(&mut path, segment),
                // Data that merely stops is drawn up to there, as browsers do.
                Err(svgtypes::Error::UnexpectedEndOfStream) => {
                    self.source.notes.add(Note::CutShort, || self.source.place(self.node));
                    return Ok(Geometry::new(path.clone(), format!("path d=\"{}\"", path_data(&path))));
                }
                Err(e) => return Err(self.wrong(format!("the path data cannot be read: {e}"))),
            }
            // A large arc is hundreds of segments in a few characters.
            if path.elements().len().is_multiple_of(FORESEEN) {
                self.source.foresee_segments(path.elements().len())?;
            }
        }
        if path.elements().len() < 2 {
            return Ok(None);
        }
        Ok(Geometry::new(path, format!("path d=\"{}\"", escaped(data.trim()))))
    }

    fn rect(&self) -> Result<Option<Geometry>> {
        let (x, y) = (self.coordinate("x", Axis::X)?, self.coordinate("y", Axis::Y)?);
        let (w, h) = (self.coordinate("width", Axis::X)?, self.coordinate("height", Axis::Y)?);
        if w <= 0.0 || h <= 0.0 {
            return Ok(None);
        }
        let radius = |name, axis| self.length(name, axis).map(|r| r.filter(|r| *r >= 0.0));
        let (rx, ry) = (radius("rx", Axis::X)?, radius("ry", Axis::Y)?);
        let (rx, ry) = (rx.or(ry).unwrap_or(0.0).min(w / 2.0), ry.or(rx).unwrap_or(0.0).min(h / 2.0));
        let mut markup = attributes("rect", &[("x", x), ("y", y), ("width", w), ("height", h)]);
        if rx > 0.0 && ry > 0.0 {
            markup += &attributes("", &[("rx", rx), ("ry", ry)]);
        }
        Ok(Geometry::new(rounded_rect(kurbo::Rect::new(x, y, x + w, y + h), rx, ry), markup))
    }

    fn ellipse(&self) -> Result<Option<Geometry>> {
        let (cx, cy) = (self.coordinate("cx", Axis::X)?, self.coordinate("cy", Axis::Y)?);
        let circle = self.node.tag_name().name() == "circle";
        let (rx, ry) = if circle {
            let r = self.coordinate("r", Axis::Both)?;
            (r, r)
        } else {
            let (rx, ry) = (self.length("rx", Axis::X)?, self.length("ry", Axis::Y)?);
            (rx.or(ry).unwrap_or(0.0), ry.or(rx).unwrap_or(0.0))
        };
        if rx <= 0.0 || ry <= 0.0 {
            return Ok(None);
        }
        let path = kurbo::Ellipse::new((cx, cy), (rx, ry), 0.0).to_path(1e-4 * rx.max(ry));
        let markup = if circle {
            attributes("circle", &[("cx", cx), ("cy", cy), ("r", rx)])
        } else {
            attributes("ellipse", &[("cx", cx), ("cy", cy), ("rx", rx), ("ry", ry)])
        };
        Ok(Geometry::new(path, markup))
    }

    fn line(&self) -> Result<Option<Geometry>> {
        let (x1, y1) = (self.coordinate("x1", Axis::X)?, self.coordinate("y1", Axis::Y)?);
        let (x2, y2) = (self.coordinate("x2", Axis::X)?, self.coordinate("y2", Axis::Y)?);
        let mut path = BezPath::new();
        path.move_to((x1, y1));
        path.line_to((x2, y2));
        Ok(Geometry::new(path, attributes("line", &[("x1", x1), ("y1", y1), ("x2", x2), ("y2", y2)])))
    }

    fn points(&self, ends: Ends) -> Result<Option<Geometry>> {
        let text = self.node.attribute("points").unwrap_or_default();
        if text.split([' ', ',', '\n', '\t']).any(|n| n.parse::<f64>().is_ok_and(|v| !v.is_finite())) {
            return Err(self.wrong("a point is not a finite number"));
        }
        let points: Vec<Point> = PointsParser::from(text).map(Point::from).collect();
        if points.len() < 2 {
            return Ok(None);
        }
        let mut path = BezPath::new();
        for (k, &p) in points.iter().enumerate() {
            if k == 0 { path.move_to(p) } else { path.line_to(p) }
        }
        if ends == Ends::Joined {
            path.close_path();
        }
        let list: Vec<_> = points.iter().map(|p| format!("{},{}", number(p.x), number(p.y))).collect();
        Ok(Geometry::new(path, format!("{} points=\"{}\"", self.node.tag_name().name(), list.join(" "))))
    }

    fn image(&self) -> Result<Option<Geometry>> {
        let data = href(self.node).unwrap_or_default().trim();
        if !data.starts_with("data:") {
            self.source.notes.add(Note::External, || format!("image {}", clip_text(data, 60)));
            return Ok(None);
        }
        let (x, y) = (self.coordinate("x", Axis::X)?, self.coordinate("y", Axis::Y)?);
        let (w, h) = (self.coordinate("width", Axis::X)?, self.coordinate("height", Axis::Y)?);
        if w <= 0.0 || h <= 0.0 {
            return Ok(None);
        }
        let mut markup = attributes("image", &[("x", x), ("y", y), ("width", w), ("height", h)]);
        if let Some(ratio) = self.node.attribute("preserveAspectRatio") {
            let _ = write!(markup, " preserveAspectRatio=\"{}\"", escaped(ratio));
        }
        let _ = write!(markup, " href=\"{}\"", escaped(data));
        let path = kurbo::Rect::new(x, y, x + w, y + h).to_path(0.1);
        Ok(Some(Geometry { path, markup: markup.into(), paint: Painted::Picture }))
    }
}

fn append(path: &mut BezPath, segment: SimplePathSegment) {
    match segment {
        SimplePathSegment::MoveTo { x, y } => path.move_to((x, y)),
        // Data that starts with something else than a move draws nothing.
        _ if path.elements().is_empty() => {}
        SimplePathSegment::LineTo { x, y } => path.line_to((x, y)),
        SimplePathSegment::CurveTo { x1, y1, x2, y2, x, y } => path.curve_to((x1, y1), (x2, y2), (x, y)),
        SimplePathSegment::Quadratic { x1, y1, x, y } => path.quad_to((x1, y1), (x, y)),
        SimplePathSegment::ClosePath => path.close_path(),
    }
}

fn attributes(tag: &str, values: &[(&str, f64)]) -> String {
    values.iter().fold(tag.to_owned(), |mut text, (name, value)| {
        let _ = write!(text, " {name}=\"{}\"", number(*value));
        text
    })
}

fn rounded_rect(rect: kurbo::Rect, rx: f64, ry: f64) -> BezPath {
    if rx <= 0.0 || ry <= 0.0 {
        return rect.to_path(0.1);
    }
    // Distance of the handles of a quarter ellipse, as a share of its radius.
    const HANDLE: f64 = 0.552_284_749_8;
    let (hx, hy) = (rx * (1.0 - HANDLE), ry * (1.0 - HANDLE));
    let kurbo::Rect { x0: x, y0: y, x1: r, y1: b } = rect;
    let mut path = BezPath::new();
    path.move_to((x + rx, y));
    path.line_to((r - rx, y));
    path.curve_to((r - hx, y), (r, y + hy), (r, y + ry));
    path.line_to((r, b - ry));
    path.curve_to((r, b - hy), (r - hx, b), (r - rx, b));
    path.line_to((x + rx, b));
    path.curve_to((x + hx, b), (x, b - hy), (x, b - ry));
    path.line_to((x, y + ry));
    path.curve_to((x, y + hy), (x + hx, y), (x + rx, y));
    path.close_path();
    path
}

/// Path data with as many decimals as its size deserves.
pub(crate) fn path_data(path: &BezPath) -> String {
    let extent = path.control_box();
    let size = extent.width().max(extent.height()).max(f64::MIN_POSITIVE);
    let decimals = (6.0 - size.log10()).ceil().clamp(0.0, 12.0) as usize;
    let mut text = String::new();
    let mut point = |command: &str, points: &[Point]| {
        text.push_str(command);
        for (k, p) in points.iter().enumerate() {
            let gap = if k == 0 { "" } else { " " };
            let _ = write!(text, "{gap}{},{}", trimmed(p.x, decimals), trimmed(p.y, decimals));
        }
    };
    for element in path.elements() {
        match *element {
            kurbo::PathEl::MoveTo(p) => point("M", &[p]),
            kurbo::PathEl::LineTo(p) => point("L", &[p]),
            kurbo::PathEl::QuadTo(a, p) => point("Q", &[a, p]),
            kurbo::PathEl::CurveTo(a, b, p) => point("C", &[a, b, p]),
            kurbo::PathEl::ClosePath => point("Z", &[]),
        }
    }
    text
}

fn trimmed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".into() } else { text.into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::{options::ReadOptions, parse::source::with_source};

    fn shape(markup: &str) -> Result<Option<Geometry>> {
        let text = format!("<svg xmlns='http://www.w3.org/2000/svg'>{markup}</svg>");
        with_source(&text, &ReadOptions::new("g.svg"), |source| {
            let node = source.xml.root_element().first_element_child().unwrap();
            read(source, node, Viewport { width: 200.0, height: 100.0 })
        })
    }

    #[test]
    fn areas_of_the_basic_shapes() {
        let pi = std::f64::consts::PI;
        let cases = [
            ("<rect width='4' height='3'/>", 12.0),
            ("<rect width='10' height='10' rx='2'/>", 100.0 - 16.0 + 4.0 * pi),
            ("<circle r='2' cx='1'/>", 4.0 * pi),
            ("<ellipse rx='2' ry='3'/>", 6.0 * pi),
            ("<rect width='50%' height='1in'/>", 9600.0),
            ("<polygon points='0,0 4,0 4,4'/>", 8.0),
            ("<path d='M-5 0 A5 5 0 0 1 5 0 A5 5 0 0 1 -5 0z'/>", 25.0 * pi),
            ("<path d='m0 0h4v4h-4z'/>", 16.0),
        ];
        for (markup, area) in cases {
            let path = shape(markup).unwrap().unwrap().path;
            assert!((path.area().abs() - area).abs() < 2e-3 * area, "{markup}: {}", path.area());
        }
    }

    #[test]
    fn shapes_without_size_draw_nothing() {
        for markup in
            ["<rect width='0' height='4'/>", "<circle r='-1'/>", "<path d=''/>", "<path d='M1 1'/>", "<path/>"]
        {
            assert!(shape(markup).unwrap().is_none(), "{markup}");
        }
    }

    #[test]
    fn broken_numbers_are_errors_with_a_place() {
        for markup in [
            "<path d='M0 0L nan 4'/>",
            "<rect width='inf' height='3'/>",
            "<circle r='1e400'/>",
            "<path d='M0 0 L1e309 0'/>",
            "<polygon points='0,0 nan,1 3,3'/>",
        ] {
            let error = shape(markup).unwrap_err().to_string();
            assert!(error.starts_with("g.svg:1: <"), "{markup}: {error}");
        }
    }

    #[test]
    fn path_data_reads_back() {
        let path = shape("<path d='M0.123456789 0 L1000 .5 q4 5 6 7 Z'/>").unwrap().unwrap().path;
        assert_eq!(path_data(&path), "M0.123,0L1000,0.5Q1004,5.5 1006,7.5Z");
    }
}
