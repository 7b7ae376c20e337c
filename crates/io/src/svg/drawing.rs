//! What reading an SVG gives and writing one takes: pages, looks of elements and strokes, exemplars, what is placed
//! already.

use std::{collections::BTreeSet, fmt::Write as _, ops::Range};

use std::sync::Arc;

use arabesque_core::{Bounds, Decimals, Drawn, Exemplar, FlowStroke, Outline, Path, Placement, Shape, Warning};

use crate::{
    svg::{options::Parts, reason::Understood},
    text::{path_data::path_data, unit::Unit},
};

/// Size and coordinate system of a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Page {
    /// User coordinates that the page shows: the viewBox.
    pub view: Bounds<2>,
    /// Unit in which the page states its width and height.
    pub unit: Unit,
    /// How many of that unit one user unit is: 1.0 for a plain pixel page, 1.0 for
    /// `width="210mm" viewBox="0 0 210 297"`.
    pub unit_per_user: f64,
}

/// The appearance of one element: markup that draws it in the coordinates of the exemplar.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fragment {
    /// One SVG element, usually a `<g>`: transforms, inherited presentation attributes and style rules resolved into
    /// it; references only to [`Drawing::definitions`].
    pub markup: String,
    /// Name of the layer it came from, for round trips.
    pub layer: Option<String>,
    /// Its own name: `inkscape:label`, else `id`.
    pub label: Option<String>,
    /// Where the file is a result: the element of its exemplar that it says this is a copy of.
    pub source: Option<usize>,
}

/// The appearance of one curve: everything that paints a path alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Presentation attributes for a `<path>`, each with a blank before it, except those that scale with the stroke;
    /// references only to [`Drawing::definitions`].
    pub paint: String,
    /// Attributes of the path alone, which a group around it must not have in its stead: opacity, filter, blending.
    pub effects: String,
    /// Width, in user units.
    pub width: f64,
    /// Lengths of dashes and gaps in turn, in user units; empty for an unbroken line.
    pub dashes: Vec<f64>,
    /// Where in the dashes the line starts, in user units.
    pub dash_offset: f64,
    /// Name of the layer it came from, for round trips.
    pub layer: Option<String>,
    /// Its own name: `inkscape:label`.
    pub label: Option<String>,
}

impl Stroke {
    /// The same stroke with all lengths times `factor`.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let dashes = self.dashes.iter().map(|d| d * factor).collect();
        Self { width: self.width * factor, dashes, dash_offset: self.dash_offset * factor, ..self.clone() }
    }

    /// The same with dashes times `factor`.
    pub(crate) fn with_dashes(&self, factor: f64) -> Self {
        let dashes = self.dashes.iter().map(|d| d * factor).collect();
        Self { dashes, dash_offset: self.dash_offset * factor, ..self.clone() }
    }

    /// Width and dashes times `scale`, as attributes.
    pub(crate) fn lengths(&self, scale: f64, decimals: Decimals) -> String {
        let fine = decimals.plus(2);
        let mut out = format!(" stroke-width=\"{}\"", fine.format(self.width * scale));
        if !self.dashes.is_empty() {
            let dashes: Vec<_> = self.dashes.iter().map(|d| fine.format(d * scale)).collect();
            let _ = write!(out, " stroke-dasharray=\"{}\"", dashes.join(" "));
            if self.dash_offset != 0.0 {
                let _ = write!(out, " stroke-dashoffset=\"{}\"", fine.format(self.dash_offset * scale));
            }
        }
        out
    }

    /// A path painted like this, as an element of its own.
    pub(crate) fn markup(&self, path: &Path<2>, decimals: Decimals) -> String {
        let (data, lengths) = (path_data(path, decimals), self.lengths(1.0, decimals));
        format!("<path d=\"{data}\"{}{lengths}{}/>", self.paint, self.effects)
    }

    /// A text that is the same for strokes that look the same, whatever file and layer they come from.
    pub(crate) fn key(&self) -> String {
        let key = without_prefixes(&format!("{}{}", self.paint, self.effects));
        let lengths = std::iter::once(&self.width).chain(&self.dashes).chain(std::iter::once(&self.dash_offset));
        lengths.fold(key, |key, length| format!("{key} {length:.3e}"))
    }
}

/// References without what marks the file that they are in: `url(#exemplar-a)` and `url(#kept2-exemplar-a)` are
/// `url(#a)`.
fn without_prefixes(text: &str) -> String {
    let mut parts = text.split("url(#");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let mut id = part;
        while let Some(rest) = ["kept", "exemplar"].iter().find_map(|prefix| id.strip_prefix(prefix)) {
            let Some(rest) = rest.trim_start_matches(|c: char| c.is_ascii_digit()).strip_prefix('-') else { break };
            id = rest;
        }
        out.push_str("url(#");
        out.push_str(id);
    }
    out
}

/// What is painted together, before anything of the next layer is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Layer {
    /// One of the paints of all curves of a style.
    Strokes {
        /// Index into [`Exemplar::styles`].
        style: usize,
        /// Which of their paints, counted from the bottom.
        paint: usize,
    },
    /// The elements of some classes: indices into [`Exemplar::classes`].
    Elements(BTreeSet<usize>),
}

impl Layer {
    /// A layer of all elements.
    pub fn all_elements(exemplar: &Exemplar<2>) -> Self {
        Self::Elements((0..exemplar.classes.len()).collect())
    }
}

/// The other parts of a file that is a whole job: what layers labelled Domain, Avoid, Flow and Keep hold.
#[derive(Clone, Debug, Default)]
pub struct Job {
    /// Where to fill.
    pub domain: Option<Shape>,
    /// Where not to fill.
    pub avoid: Option<Shape>,
    /// Which way the pattern flows.
    pub flow: Vec<FlowStroke>,
}

/// An SVG exemplar: what it means and how it looks.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Elements and classes.
    pub exemplar: Arc<Exemplar<2>>,
    /// How element `i` of the exemplar looks.
    pub fragments: Vec<Fragment>,
    /// How curve `i` of the exemplar is painted: a stroke for each paint from bottom to top, such as a casing and the
    /// core on it; at least one.
    pub strokes: Vec<Vec<Stroke>>,
    /// How area `i` of the exemplar is painted: attributes of its fill, no width.
    pub fills: Vec<Stroke>,
    /// What is painted before what, from bottom to top, the background aside: every paint of every style and every
    /// class is in one of them.
    pub layers: Vec<Layer>,
    /// Markup that fills the frame behind everything, in exemplar coordinates: repeated over the output page as it is
    /// where it is a plain colour. `None` without a background.
    pub background: Option<String>,
    /// How loose parts were taken.
    pub parts: Parts,
    /// Content of `<defs>` that the fragments refer to: gradients, clips, masks, patterns, filters, symbols.
    pub definitions: String,
    /// Size and units of the exemplar's page.
    pub page: Page,
    /// Layers beside the exemplar.
    pub job: Job,
    /// What everything in the file was taken for, and why.
    pub understood: Vec<Understood>,
    /// What was noticed while reading.
    pub warnings: Vec<Warning>,
}

/// Elements and strokes that were placed already: a file for `--keep`.
#[derive(Clone, Debug)]
pub struct Placed {
    /// What matches an element of the exemplar; `frozen` is `None`. Coordinates of the kept file become output
    /// coordinates.
    pub placements: Vec<Placement<2>>,
    /// Strokes that are painted like curves of the exemplar; `frozen` is `None`. Same coordinates.
    pub curves: Vec<Drawn<2>>,
    /// The painted area of everything else, in the same coordinates.
    pub obstacles: Vec<Outline<2>>,
    /// Looks of placement `i`, to be drawn unchanged: markup in the coordinates of the kept file.
    pub fragments: Vec<Fragment>,
    /// Looks of the strokes, in the same way; several strokes of one path share one.
    pub curve_fragments: Vec<KeptStrokes>,
    /// Looks of obstacle `i`, in the same way.
    pub obstacle_fragments: Vec<Fragment>,
    /// Content of `<defs>` that both kinds of fragments refer to; its ids do not clash with those of the exemplar.
    pub definitions: String,
    /// Page of the kept file.
    pub page: Page,
    /// What was noticed while reading.
    pub warnings: Vec<Warning>,
}

/// The looks of strokes that were drawn already.
#[derive(Clone, Debug)]
pub struct KeptStrokes {
    /// What draws them.
    pub fragment: Fragment,
    /// Box around their ink.
    pub extent: Bounds<2>,
    /// Style of the exemplar in which they are painted, and which of its paints they are, counted from the bottom.
    pub paint: Option<(usize, usize)>,
}

/// What stays in a file of which a part is refilled, and between what of its text it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Anchor {
    /// The bytes of the head that draw it.
    pub(crate) range: Range<usize>,
    pub(crate) what: Anchored,
}

/// What stands at an anchor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchored {
    /// A kept element, by its number.
    Element(usize),
    /// A paint of a style: strokes, or an area.
    Strokes(usize, usize),
}

/// A drawing of which a part is refilled: what stays, and the text of the file around that part.
#[derive(Clone, Debug)]
pub struct HostDocument {
    /// What stays, for the engine to fit the new to. Its fragments are not drawn: they stand in the file.
    pub placed: Placed,
    /// Box around everything that the file draws.
    pub content: Bounds<2>,
    /// How many things are replaced or cut.
    pub replaced: usize,
    /// The file up to where new things are drawn.
    pub(crate) head: String,
    /// Where in it something new can be drawn before or after what stays, in drawing order.
    pub(crate) anchors: Vec<Anchor>,
    /// The file from there on.
    pub(crate) tail: String,
    /// What had to be rewritten: the outside parts of strokes that are cut, and pieces of paths of which another piece
    /// is replaced.
    pub(crate) moved: String,
    /// Content of `<defs>` that this refers to.
    pub(crate) definitions: String,
}
