//! A drawing as painted areas, in drawing order: fills as they are, strokes as the areas that they cover.

use arabesque_core::{Outline, Result, Warning};
use kurbo::Affine;

use crate::{
    svg::{
        drawing::Page,
        options::ReadOptions,
        parse::{
            colour,
            geometry::Painted,
            paint::{fraction, reference},
            scene::{Content, Node},
            style::Property as P,
        },
        read::document::{Document, Opened},
        shape::{extent::bounds, flatten, painted_area::Painter, stroke::stroked},
    },
    text::unit::Unit,
};

/// A painted area.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    /// What is covered, in user coordinates of the page.
    pub outline: Outline<2>,
    /// Its colour, as SVG has it.
    pub colour: String,
    /// Its opacity, in (0, 1].
    pub opacity: f64,
}

/// A drawing taken apart.
#[derive(Clone, Debug)]
pub struct Areas {
    /// The areas, the lowest first.
    pub areas: Vec<Area>,
    /// The page; around the drawing where the file states no size.
    pub page: Page,
    /// What could not be kept as it was.
    pub warnings: Vec<Warning>,
}

/// Takes a drawing apart whose text nothing else is read of.
///
/// # Errors
/// As for [`Document::with`] and [`Document::painted_areas`].
pub fn read_areas(text: &str, options: &ReadOptions) -> Result<Areas> {
    Document::with(text, options, |document| document.painted_areas())
}

impl Document<'_> {
    /// Takes a drawing apart. Clips are applied; a gradient or pattern becomes its mean colour, with a warning.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Input`] when the text is not usable SVG, [`arabesque_core::Error::Limit`] when it is
    /// too large.
    pub fn painted_areas(&self) -> Result<Areas> {
        let Opened { source, root, page, .. } = self.open()?;
        let source = &source;
        let painter = Painter::new(source);
        painter.check_all(&root, Affine::IDENTITY)?;
        let mut taker = Taker { painter: &painter, areas: Vec::new(), gradients: 0, pictures: 0, effects: 0 };
        taker.node(&root, Affine::IDENTITY, &Inherited { opacity: 1.0, clip: None })?;
        let page = page.unwrap_or(Page { view: bounds(&root, Affine::IDENTITY), unit: Unit::Px, unit_per_user: 1.0 });
        let mut warnings = taker.warnings(source.name);
        warnings.extend(source.notes.warnings(source.name));
        Ok(Areas { areas: taker.areas, page, warnings })
    }
}

/// The properties that give an area its colour.
#[derive(Clone, Copy)]
struct PaintedBy {
    paint: P,
    opacity: P,
}

const FILL: PaintedBy = PaintedBy { paint: P::Fill, opacity: P::FillOpacity };
const STROKE: PaintedBy = PaintedBy { paint: P::Stroke, opacity: P::StrokeOpacity };

/// What holds for everything inside a node.
struct Inherited {
    opacity: f64,
    clip: Option<Outline<2>>,
}

struct Taker<'a, 's, 'i> {
    painter: &'i Painter<'a, 's>,
    areas: Vec<Area>,
    gradients: usize,
    pictures: usize,
    effects: usize,
}

impl Taker<'_, '_, '_> {
    fn node(&mut self, node: &Node, parent: Affine, at: &Inherited) -> Result<()> {
        let world = parent * node.transform;
        let opacity = at.opacity * node.own.get("opacity").map_or(1.0, fraction);
        if opacity == 0.0 {
            return Ok(());
        }
        let has = |name: &str| node.own.get(name).is_some_and(|v| v != "none" && v != "normal");
        self.effects += usize::from(has("mask") || has("filter") || has("mix-blend-mode"));
        let clip = match (&at.clip, self.painter.clip(node, world)?) {
            (Some(a), Some(b)) => Some(a.try_intersection(&b, self.painter.source.budget)?),
            (a, b) => b.or_else(|| a.clone()),
        };
        let inside = Inherited { opacity, clip };
        let Content::Shape(geometry) = &node.content else {
            return node.children().iter().try_for_each(|child| self.node(child, world, &inside));
        };
        if geometry.paint == Painted::Picture {
            self.pictures += 1;
            return Ok(());
        }
        let style = &node.style;
        if style.fills() {
            let rule = flatten::fill_rule(style.get(P::FillRule));
            let outline = flatten::filled(&geometry.path, world, rule, self.painter.source.budget)?;
            self.add(outline, node, FILL, &inside)?;
        }
        if style.strokes() {
            let outline = stroked(node, &geometry.path, world, self.painter.source.budget)?;
            self.add(outline, node, STROKE, &inside)?;
        }
        Ok(())
    }

    fn add(&mut self, outline: Outline<2>, node: &Node, by: PaintedBy, at: &Inherited) -> Result<()> {
        let outline = match &at.clip {
            Some(clip) => outline.try_intersection(clip, self.painter.source.budget)?,
            None => outline,
        };
        if outline.rings.is_empty() {
            return Ok(());
        }
        let paint = node.style.get(by.paint);
        let colour = if reference(paint).is_some() {
            self.gradients += 1;
            let [r, g, b] = colour::of_paint(self.painter.source, paint).map(|v| (v * 255.0).round() as u8);
            format!("#{r:02x}{g:02x}{b:02x}")
        } else {
            paint.to_owned()
        };
        self.areas.push(Area { outline, colour, opacity: at.opacity * fraction(node.style.get(by.opacity)) });
        Ok(())
    }

    fn warnings(&self, name: &str) -> Vec<Warning> {
        let counts = [
            (self.gradients, "gradients and patterns become their mean colour", "use plain colours, or a PNG exemplar"),
            (self.pictures, "pictures in the drawing are left out", "use a PNG exemplar"),
            (self.effects, "masks, filters and blend modes are left out", "use a PNG exemplar"),
        ];
        let found = counts.into_iter().filter(|(n, ..)| *n > 0);
        found.map(|(n, what, advice)| Warning::new(format!("{name}: {what} ({n})"), advice)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fills_and_strokes_are_areas_in_drawing_order() {
        let text = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 20 10'>
            <linearGradient id='l'><stop stop-color='#000000'/><stop stop-color='#ffffff'/></linearGradient>
            <rect width='10' height='10' fill='#ff0000' stroke='#0000ff' stroke-width='2' stroke-linejoin='miter'/>
            <g opacity='0.5'><rect x='12' width='2' height='2' fill='url(#l)' fill-opacity='0.5'/></g></svg>";
        let taken = read_areas(text, &ReadOptions::new("a.svg")).unwrap();
        let seen: Vec<_> =
            taken.areas.iter().map(|a| (a.outline.area().round(), a.colour.as_str(), a.opacity)).collect();
        assert_eq!(seen, [(100.0, "#ff0000", 1.0), (80.0, "#0000ff", 1.0), (4.0, "#808080", 0.25)]);
        assert_eq!(taken.page.view.size().0, [20.0, 10.0]);
        assert!(taken.warnings[0].message.contains("mean colour (1)"));
    }
}
