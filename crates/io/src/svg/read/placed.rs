//! Elements that stay where they are: reading them back and matching them to the elements of an exemplar.

use arabesque_core::{Bounds, Result};
use kurbo::Affine;

use crate::{
    svg::{
        drawing::{Drawing, Fragment, KeptStrokes, Page, Placed},
        options::{LargeFills, Method, ReadOptions},
        parse::definitions::Definitions,
        read::{
            document::{Document, Opened},
            matcher::Matcher,
            sorter::{Sorted, Sorter},
        },
        shape::{extent::bounds, idle::without_idle_clips, painted_area::Painter},
        understand::{fragment::fragment, item::Item, select::select, surroundings::Surroundings},
    },
    text::unit::Unit,
};

/// Reads what stays where it is from a text of which nothing else is read.
///
/// # Errors
/// As for [`Document::with`] and [`Document::placed`].
pub fn read_placed(text: &str, drawing: &Drawing, options: &ReadOptions) -> Result<Placed> {
    Document::with(text, options, |document| document.placed(drawing))
}

impl Document<'_> {
    /// Reads what stays where it is, and matches it to the elements and curves of `drawing`.
    ///
    /// Copies made by arabesque say what they are copies of (`data-arabesque-source`, `data-arabesque-curve`); other
    /// elements are matched by name, colour and outline, other strokes by their paint. What matches nothing becomes an
    /// obstacle. Nothing at all in the file is not an error: there is nothing to keep.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Input`] when the text is not usable SVG, [`arabesque_core::Error::Limit`] when it is
    /// too large.
    pub fn placed(&self, drawing: &Drawing) -> Result<Placed> {
        let Opened { source, root, page, .. } = self.open()?;
        let source = &source;
        let painter = Painter::new(source);
        painter.check_all(&root, Affine::IDENTITY)?;
        let content = bounds(&root, Affine::IDENTITY);
        let page = page.unwrap_or(Page { view: content, unit: Unit::Px, unit_per_user: 1.0 });
        let mut definitions = Definitions::new(source, "kept");
        let mut placed = Placed::on(page);
        if page.view.measure() > 0.0 && page.view.size().is_finite() {
            let method = match (drawing.exemplar.elements.is_empty(), drawing.exemplar.curves.is_empty()) {
                (_, true) => Method::Elements,
                (true, false) => Method::Curves,
                (false, false) => Method::Auto,
            };
            let root = without_idle_clips(&painter, &root, Affine::IDENTITY, &page.view)?;
            let reading = (method, drawing.parts, LargeFills::Lines);
            let found = select(&painter, page.view, reading, &[(Surroundings::new(Affine::IDENTITY), root)])?;
            let sorter = Sorter {
                painter: &painter,
                matcher: Matcher::new(drawing),
                area: None,
                window: content.union(&page.view),
            };
            let sorted = sorter.sort(&found.items, &mut definitions)?;
            for (item, kept) in found.items.iter().zip(sorted) {
                placed.add(item, kept, &mut definitions);
            }
        }
        placed.definitions = definitions.finish()?;
        placed.warnings = source.notes.warnings(source.name);
        Ok(placed)
    }
}

impl Placed {
    /// Nothing yet.
    pub(crate) fn on(page: Page) -> Self {
        Self {
            placements: Vec::new(),
            curves: Vec::new(),
            obstacles: Vec::new(),
            fragments: Vec::new(),
            curve_fragments: Vec::new(),
            obstacle_fragments: Vec::new(),
            definitions: String::new(),
            page,
            warnings: Vec::new(),
        }
    }

    /// Adds what stays, without its looks.
    pub(crate) fn freeze(&mut self, kept: Sorted) {
        match kept {
            Sorted::Removed => {}
            Sorted::Element(placement) => self.placements.push(placement),
            Sorted::Strokes { drawn, .. } => self.curves.extend(drawn),
            Sorted::Obstacle { outline, .. } => self.obstacles.push(outline),
        }
    }

    fn add(&mut self, item: &Item, kept: Sorted, definitions: &mut Definitions<'_, '_>) {
        match kept {
            Sorted::Removed => {}
            Sorted::Element(placement) => {
                self.placements.push(placement);
                self.fragments.push(fragment(item, definitions));
            }
            Sorted::Strokes { drawn, paint, cut, .. } => {
                let extent = drawn.iter().fold(Bounds::EMPTY, |all, d| all.union(&d.path.bounds()));
                self.curves.extend(drawn);
                let whole = fragment(item, definitions);
                let markup = cut.unwrap_or_else(|| whole.markup.clone());
                let width = item.outline.bounds();
                let fragment = Fragment { markup, ..whole };
                self.curve_fragments.push(KeptStrokes { fragment, extent: extent.union(&width), paint });
            }
            Sorted::Obstacle { outline, .. } => {
                self.obstacles.push(outline);
                self.obstacle_fragments.push(fragment(item, definitions));
            }
        }
    }
}
