//! Lengths with units, and the page.

use arabesque_core::{Bounds, Error, Result, Vector};
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

/// The page of the file; `None` when it states no size at all.
pub(crate) fn page(source: &Source<'_>) -> Result<Option<Page>> {
    let root = source.xml.root_element();
    let (width, height) = (stated(source, root, "width")?, stated(source, root, "height")?);
    note_old_inkscape(source, root);
    let unit = width.or(height).map_or(Unit::Px, |(_, unit)| unit);
    let pixels = |stated: Option<(f64, Unit)>| stated.map(|(n, unit)| n * unit.pixels());
    let page = match (view_box(source, root)?, pixels(width), pixels(height)) {
        (Some(view), w, h) => {
            let size = view.size();
            // The drawing is scaled to fit in the smaller direction (preserveAspectRatio meet).
            let scales = [w.map(|w| w / size[0]), h.map(|h| h / size[1])];
            let scale = scales.into_iter().flatten().filter(|s| *s > 0.0).fold(f64::INFINITY, f64::min);
            let scale = if scale.is_finite() { scale } else { 1.0 };
            Some(Page { view, unit, unit_per_user: scale / unit.pixels() })
        }
        (None, Some(w), Some(h)) => {
            Some(Page { view: Bounds::new(Vector::ZERO, Vector::xy(w, h)), unit, unit_per_user: 1.0 / unit.pixels() })
        }
        (None, ..) => None,
    };
    page.map(|page| checked(source, page)).transpose()
}

fn checked(source: &Source<'_>, page: Page) -> Result<Page> {
    let size = page.view.size();
    let root = || source.place(source.xml.root_element());
    let extremes = page.view.min.0.iter().chain(page.view.max.0.iter());
    if let Some(v) = { extremes }.find(|v| !(0.0..=source.limits.coordinate).contains(&v.abs())) {
        let problem = format!("the page reaches beyond {:e} user units: {v:e}", source.limits.coordinate);
        return Err(Error::input(root(), problem, "give it a sensible width, height and viewBox"));
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
    let ratio = node.attribute("preserveAspectRatio").and_then(|t| t.parse::<AspectRatio>().ok());
    let ratio = ratio.unwrap_or(AspectRatio { defer: false, align: svgtypes::Align::XMidYMid, slice: false });
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

    fn page_of(attributes: &str) -> Result<Option<Page>> {
        with_source(
            &format!("<svg xmlns='http://www.w3.org/2000/svg' {attributes}/>"),
            &ReadOptions::new("p.svg"),
            page,
        )
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
