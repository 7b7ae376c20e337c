//! Lengths with units, and the page.

use arabesque_core::{Bounds, Error, Limits, Result, Vector, rounded};
use roxmltree::Node as Xml;
use svgtypes::{AspectRatio, Length, LengthUnit, ViewBox};

use crate::{
    svg::{
        drawing::Page,
        namespace::INKSCAPE,
        parse::{
            notes::Note,
            source::{Source, clip_text},
        },
    },
    text::unit::Unit,
};

/// Width and height that percentages refer to, in user units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Viewport {
    pub(crate) width: f64,
    pub(crate) height: f64,
}

/// Which extent of the viewport a percentage refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Axis {
    X,
    Y,
    Both,
}

impl Viewport {
    fn extent(&self, axis: Axis) -> f64 {
        match axis {
            Axis::X => self.width,
            Axis::Y => self.height,
            Axis::Both => (0.5 * (self.width * self.width + self.height * self.height)).sqrt(),
        }
    }

    /// A length in user units. `font` is the font size that `em` refers to.
    pub(crate) fn resolve(&self, length: Length, axis: Axis, font: f64) -> f64 {
        let n = length.number;
        match (unit_of(length.unit), length.unit) {
            (Some(unit), _) => unit.in_pixels(n),
            (None, LengthUnit::Em) => n * font,
            (None, LengthUnit::Ex) => n * font * 0.5,
            (None, _) => n / 100.0 * self.extent(axis),
        }
    }
}

/// The unit of a length; `None` for those that are relative to something else.
pub(crate) fn unit_of(unit: LengthUnit) -> Option<Unit> {
    match unit {
        LengthUnit::None | LengthUnit::Px => Some(Unit::Px),
        LengthUnit::Mm => Some(Unit::Mm),
        LengthUnit::Cm => Some(Unit::Cm),
        LengthUnit::In => Some(Unit::In),
        LengthUnit::Pt => Some(Unit::Pt),
        LengthUnit::Pc => Some(Unit::Pc),
        LengthUnit::Em | LengthUnit::Ex | LengthUnit::Percent => None,
    }
}

/// A stated width or height: a number and its unit. Percentages and `auto` state nothing.
fn stated(source: &Source<'_>, root: Xml<'_, '_>, name: &str) -> Result<Option<(f64, Unit)>> {
    let Some(text) = root.attribute(name).map(str::trim).filter(|t| !t.is_empty() && *t != "auto") else {
        return Ok(None);
    };
    let wrong = || {
        let problem = format!("{name}=\"{}\" is not a length", clip_text(text, 40));
        Error::input(source.place(root), problem, "write a positive number with px, mm, cm, in, pt, pc or Q")
    };
    if let Some(number) = text.strip_suffix(['q', 'Q']) {
        return number.trim().parse().map(|n| Some((n, Unit::Q))).map_err(|_| wrong());
    }
    let length: Length = text.parse().map_err(|_| wrong())?;
    let unit = match (unit_of(length.unit), length.unit) {
        (Some(unit), _) => unit,
        (None, LengthUnit::Percent) => return Ok(None),
        (None, _) => return Ok(Some((length.number * 16.0, Unit::Px))),
    };
    if !length.number.is_finite() || length.number < 0.0 {
        return Err(wrong());
    }
    Ok(Some((length.number, unit)))
}

/// The page of a file, and how its content lies on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sheet {
    pub(crate) page: Page,
    /// From the coordinates of the content to those of the page: where the file asks for it, the content is stretched more one way than
    /// the other.
    pub(crate) stretch: [f64; 2],
}

impl Sheet {
    /// What percentages in the content refer to.
    pub(crate) fn viewport(&self) -> Viewport {
        let size = self.page.view.size();
        Viewport { width: size[0] / self.stretch[0], height: size[1] / self.stretch[1] }
    }
}

/// The page of the file; `None` when it states no size at all.
pub(crate) fn page(source: &Source<'_>) -> Result<Option<Sheet>> {
    let root = source.xml.root_element();
    let (width, height) = (stated(source, root, "width")?, stated(source, root, "height")?);
    note_old_inkscape(source, root);
    let unit = width.or(height).map_or(Unit::Px, |(_, unit)| unit);
    let pixels = |stated: Option<(f64, Unit)>| stated.map(|(n, unit)| n * unit.pixels());
    let page = match (view_box(source, root)?, pixels(width), pixels(height)) {
        (Some(view), w, h) => {
            let size = view.size();
            let scales = [w.map(|w| w / size[0]), h.map(|h| h / size[1])];
            let scales = scales.map(|scale| scale.filter(|s| *s > 0.0));
            let (view, scale, stretch) = match scales {
                [Some(sx), Some(sy)] => laid(view, [sx, sy], aspect_ratio(root)),
                // What is not stated follows from the other.
                [a, b] => (view, a.or(b).unwrap_or(1.0), [1.0; 2]),
            };
            Some((Page { view, unit, unit_per_user: scale / unit.pixels() }, stretch))
        }
        (None, Some(w), Some(h)) => {
            let view = Bounds::new(Vector::ZERO, Vector::xy(w, h));
            Some((Page { view, unit, unit_per_user: 1.0 / unit.pixels() }, [1.0; 2]))
        }
        (None, ..) => None,
    };
    page.map(|(page, stretch)| Ok(Sheet { page: checked(source, page)?, stretch })).transpose()
}

/// Stretches that differ by less are the same: sizes are written with few digits.
const UNEVEN: f64 = 1e-3;

/// What of the view box the page shows, in coordinates of the page; pixels per unit of these; how the content is stretched to them.
fn laid(view: Bounds<2>, scales: [f64; 2], ratio: AspectRatio) -> (Bounds<2>, f64, [f64; 2]) {
    let [least, most] = [scales[0].min(scales[1]), scales[0].max(scales[1])];
    if most <= least * (1.0 + UNEVEN) {
        return (view, least, [1.0; 2]);
    }
    if ratio.align == svgtypes::Align::None {
        let stretch = scales.map(|s| s / least);
        let laid = |p: Vector<2>| Vector::xy(p[0] * stretch[0], p[1] * stretch[1]);
        return (Bounds::new(laid(view.min), laid(view.max)), least, stretch);
    }
    if !ratio.slice {
        // The room that is left beside the view box is no part of the drawing.
        return (view, least, [1.0; 2]);
    }
    let size = view.size();
    let shown = Vector::xy(size[0] * scales[0] / most, size[1] * scales[1] / most);
    let (ax, ay) = alignment(ratio.align);
    let corner = view.min + Vector::xy(ax * (size[0] - shown[0]), ay * (size[1] - shown[1]));
    (Bounds::new(corner, corner + shown), most, [1.0; 2])
}

/// How a node says that its view box is to be fitted into its size.
fn aspect_ratio(node: Xml<'_, '_>) -> AspectRatio {
    let stated = node.attribute("preserveAspectRatio").and_then(|t| t.trim().parse::<AspectRatio>().ok());
    stated.unwrap_or(AspectRatio { defer: false, align: svgtypes::Align::XMidYMid, slice: false })
}

fn checked(source: &Source<'_>, page: Page) -> Result<Page> {
    let size = page.view.size();
    let root = || source.place(source.xml.root_element());
    let extremes = page.view.min.0.iter().chain(page.view.max.0.iter());
    if let Some(v) = { extremes }.find(|v| !(0.0..=source.limits.coordinate).contains(&v.abs())) {
        let problem =
            format!("the page reaches beyond {} user units: {}", rounded(source.limits.coordinate), rounded(*v));
        let raising = Limits::raising("coordinate", v.abs());
        let advice = format!("give it a sensible width, height and viewBox{raising}");
        return Err(Error::input(root(), problem, advice));
    }
    if size[0] <= source.limits.extent || size[1] <= source.limits.extent {
        return Err(Error::input(root(), "the page has no area", "give it a width, a height and a viewBox"));
    }
    if !page.unit_per_user.is_finite() || page.unit_per_user <= 0.0 {
        return Err(Error::input(root(), "width and height do not fit the viewBox", "make them positive numbers"));
    }
    Ok(page)
}

fn view_box(source: &Source<'_>, node: Xml<'_, '_>) -> Result<Option<Bounds<2>>> {
    let Some(text) = node.attribute("viewBox") else { return Ok(None) };
    let wrong = || {
        let problem = format!("viewBox=\"{}\" is not four numbers with a positive size", clip_text(text, 60));
        Error::input(source.place(node), problem, "write viewBox=\"0 0 WIDTH HEIGHT\"")
    };
    let v: ViewBox = text.parse().map_err(|_| wrong())?;
    if ![v.x, v.y, v.w, v.h].iter().all(|n| n.is_finite()) {
        return Err(wrong());
    }
    Ok(Some(Bounds::new(Vector::xy(v.x, v.y), Vector::xy(v.x + v.w, v.y + v.h))))
}

fn note_old_inkscape(source: &Source<'_>, root: Xml<'_, '_>) {
    let version = root.attribute((INKSCAPE, "version")).unwrap_or_default();
    let mut numbers = version.split(|c: char| !c.is_ascii_digit()).map(|n| n.parse::<u32>().unwrap_or(0));
    let (major, minor) = (numbers.next(), numbers.next().unwrap_or(0));
    if major == Some(0) && minor < 92 && !version.is_empty() {
        source.notes.add(Note::OldInkscape, || format!("version {}", clip_text(version, 20)));
    }
}

/// Offset and scales by which the content of a nested viewport is drawn.
pub(crate) struct Fit {
    pub(crate) shift: [f64; 2],
    pub(crate) scale: [f64; 2],
    /// What the content may use of its own coordinates.
    pub(crate) viewport: Viewport,
}

/// How the view box of a nested `<svg>` or `<symbol>` of the given size is fitted into it.
pub(crate) fn fit(source: &Source<'_>, node: Xml<'_, '_>, width: f64, height: f64) -> Result<Fit> {
    let Some(view) = view_box(source, node)? else {
        return Ok(Fit { shift: [0.0; 2], scale: [1.0; 2], viewport: Viewport { width, height } });
    };
    let size = view.size();
    let ratio = aspect_ratio(node);
    let (sx, sy) = (width / size[0], height / size[1]);
    let one = if ratio.slice { sx.max(sy) } else { sx.min(sy) };
    let scale = if ratio.align == svgtypes::Align::None { [sx, sy] } else { [one, one] };
    let (ax, ay) = alignment(ratio.align);
    let shift = [
        ax * (width - size[0] * scale[0]) - view.min[0] * scale[0],
        ay * (height - size[1] * scale[1]) - view.min[1] * scale[1],
    ];
    Ok(Fit { shift, scale, viewport: Viewport { width: size[0], height: size[1] } })
}

/// Shares of the free space that go before the content.
fn alignment(align: svgtypes::Align) -> (f64, f64) {
    use svgtypes::Align as A;
    match align {
        A::None | A::XMinYMin => (0.0, 0.0),
        A::XMidYMin => (0.5, 0.0),
        A::XMaxYMin => (1.0, 0.0),
        A::XMinYMid => (0.0, 0.5),
        A::XMidYMid => (0.5, 0.5),
        A::XMaxYMid => (1.0, 0.5),
        A::XMinYMax => (0.0, 1.0),
        A::XMidYMax => (0.5, 1.0),
        A::XMaxYMax => (1.0, 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::{options::ReadOptions, parse::source::with_source};

    fn sheet_of(attributes: &str) -> Result<Option<Sheet>> {
        with_source(
            &format!("<svg xmlns='http://www.w3.org/2000/svg' {attributes}/>"),
            &ReadOptions::new("p.svg"),
            page,
        )
    }

    fn page_of(attributes: &str) -> Result<Option<Page>> {
        Ok(sheet_of(attributes)?.map(|sheet| sheet.page))
    }

    #[test]
    fn content_is_stretched_cropped_or_fitted_as_the_root_says() {
        let at = |ratio: &str| {
            let sheet = sheet_of(&format!("width='480' height='180' viewBox='10 0 240 180' {ratio}")).unwrap().unwrap();
            let (view, units) = (sheet.page.view, sheet.page.unit_per_user);
            ([view.min[0], view.min[1], view.max[0], view.max[1]], units, sheet.stretch)
        };
        assert_eq!(at("preserveAspectRatio='none'"), ([20.0, 0.0, 500.0, 180.0], 1.0, [2.0, 1.0]));
        assert_eq!(at(""), ([10.0, 0.0, 250.0, 180.0], 1.0, [1.0, 1.0]));
        assert_eq!(at("preserveAspectRatio='xMidYMid slice'"), ([10.0, 45.0, 250.0, 135.0], 2.0, [1.0, 1.0]));
        assert_eq!(at("preserveAspectRatio='xMinYMin slice'"), ([10.0, 0.0, 250.0, 90.0], 2.0, [1.0, 1.0]));
        let fits = "width='48mm' height='36.001mm' viewBox='0 0 240 180' preserveAspectRatio='none'";
        assert_eq!(sheet_of(fits).unwrap().unwrap().stretch, [1.0, 1.0]);
        let viewport = sheet_of("width='9' height='3' viewBox='0 0 3 3' preserveAspectRatio='none'").unwrap();
        assert_eq!(viewport.unwrap().viewport(), Viewport { width: 3.0, height: 3.0 });
    }

    #[test]
    fn millimetre_pages_have_millimetre_units() {
        let p = page_of("width='210mm' height='297mm' viewBox='0 0 210 297'").unwrap().unwrap();
        assert_eq!(p.unit, Unit::Mm);
        assert!((p.unit_per_user - 1.0).abs() < 1e-12);
    }

    #[test]
    fn without_view_box_user_units_are_pixels() {
        let p = page_of("width='1in' height='2in'").unwrap().unwrap();
        assert_eq!(p.view.max, Vector::xy(96.0, 192.0));
        assert!((p.unit_per_user * 96.0 - 1.0).abs() < 1e-12);
        let q = page_of("width='101.6Q' height='96'").unwrap().unwrap();
        assert!((q.view.max[0] - 96.0).abs() < 1e-9);
    }

    #[test]
    fn percentages_state_nothing() {
        assert!(page_of("width='100%' height='100%'").unwrap().is_none());
        assert_eq!(page_of("width='100%' viewBox='1 2 3 4'").unwrap().unwrap().unit_per_user, 1.0);
    }

    #[test]
    fn absurd_pages_are_errors() {
        let broken = [
            "viewBox='0 0 nan 5'",
            "viewBox='0 0 0 5'",
            "viewBox='0 0 1e300 5'",
            "width='1e-300' height='5'",
            "width='inf' height='5'",
            "width='12furlong'",
            "viewBox='0 0 1e-300 1e-300'",
            "width='-5' height='5'",
        ];
        for attributes in broken {
            let error = page_of(attributes).unwrap_err().to_string();
            assert!(error.starts_with("p.svg:1: <svg>: "), "{error}");
        }
    }
}
