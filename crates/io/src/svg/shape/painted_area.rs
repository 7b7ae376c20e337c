//! The area that shapes cover once they are painted, and its colours.

use std::{cell::RefCell, collections::BTreeMap, rc::Rc};

use arabesque_core::{Budget, Error, FillRule, Outline, Result, Ring, Vector, rounded};
use kurbo::{Affine, Shape as _};

use crate::svg::{
    parse::{
        colour,
        geometry::{Geometry, Painted},
        length::Viewport,
        notes::Note,
        paint::{fraction, reference},
        scene::{Content, Node, build_definition},
        source::{Source, clip_text},
        style::Property as P,
    },
    shape::{
        flatten::{fill_rule, filled},
        stroke::{growth, stroked},
    },
};

/// Area covered by something, in user coordinates of the root.
#[derive(Clone, Debug, Default)]
pub(crate) struct PaintedArea {
    /// The covered area shape by shape; shapes may overlap.
    shapes: Vec<Outline<2>>,
    /// Colours with the area that they cover.
    pub(crate) colours: Vec<([f64; 3], f64)>,
}

impl PaintedArea {
    /// The covered area as disjoint polygons.
    ///
    /// # Errors
    /// As [`Outline::try_union`].
    pub(crate) fn outline(&self, budget: &Budget) -> Result<Outline<2>> {
        united(&self.shapes, budget)
    }

    /// Mean colour by area; black where there is none.
    pub(crate) fn colour(&self) -> [f64; 3] {
        let total: f64 = self.colours.iter().map(|(_, area)| area).sum();
        let mean = |k: usize| self.colours.iter().map(|(c, area)| c[k] * area).sum::<f64>() / total;
        if total > 0.0 { std::array::from_fn(mean) } else { [0.0; 3] }
    }

    /// Which way each channel leans, as [`arabesque_core::Element::lean`] has it; zero where shapes and colours are not known one by
    /// one.
    pub(crate) fn lean(&self, centre: Vector<2>) -> [Vector<2>; 3] {
        let total: f64 = self.colours.iter().map(|(_, area)| area).sum();
        if self.shapes.len() != self.colours.len() || self.shapes.len() < 2 || total <= 0.0 {
            return [Vector::ZERO; 3];
        }
        let mean = self.colour();
        let mut lean = [Vector::ZERO; 3];
        for (shape, (colour, area)) in self.shapes.iter().zip(&self.colours) {
            let Some(at) = shape.centroid() else { continue };
            for k in 0..3 {
                lean[k] += (at - centre) * ((colour[k] - mean[k]) * area / total);
            }
        }
        lean
    }

    /// The colours that cover at least a tenth of the painted area each, rounded, as text: items alike in paint have
    /// the same.
    pub(crate) fn colours_key(&self) -> String {
        let total: f64 = self.colours.iter().map(|(_, area)| area).sum();
        let mut shares: BTreeMap<String, f64> = BTreeMap::new();
        for (colour, area) in &self.colours {
            let [r, g, b] = colour.map(|v| (v * 15.0).round() as u8);
            *shares.entry(format!("{r:x}{g:x}{b:x}")).or_default() += area;
        }
        let main: Vec<_> = shares.into_iter().filter(|(_, area)| *area >= 0.1 * total).map(|(key, _)| key).collect();
        main.join("+")
    }

    /// Adds a shape in one colour.
    fn add(&mut self, outline: Outline<2>, colour: [f64; 3]) {
        if !outline.rings.is_empty() {
            self.colours.push((colour, outline.area()));
            self.shapes.push(outline);
        }
    }

    /// Adds another area.
    pub(crate) fn append(&mut self, other: Self) {
        self.shapes.extend(other.shapes);
        self.colours.extend(other.colours);
    }

    fn clipped(self, clip: &Outline<2>, budget: &Budget) -> Result<Self> {
        let outline = self.outline(budget)?.try_intersection(clip, budget)?;
        let shapes = if outline.rings.is_empty() { Vec::new() } else { vec![outline] };
        Ok(Self { shapes, colours: self.colours })
    }
}

/// Shapes that are united at once.
const AT_ONCE: usize = 8;

/// The union of shapes. Many are united by halves: where they lie on top of each other, as in blends, most borders
/// vanish early.
fn united(shapes: &[Outline<2>], budget: &Budget) -> Result<Outline<2>> {
    match shapes {
        [] => Ok(Outline::default()),
        [one] => Ok(one.clone()),
        few if few.len() <= AT_ONCE => {
            let rings: Vec<_> = few.iter().flat_map(|shape| shape.rings.iter().cloned()).collect();
            Outline::try_union(&rings, FillRule::NonZero, budget)
        }
        many => {
            let (left, right) = many.split_at(many.len() / 2);
            united(&[united(left, budget)?, united(right, budget)?], budget)
        }
    }
}

/// Finds the painted area of nodes.
pub(crate) struct Painter<'a, 's> {
    pub(crate) source: &'s Source<'a>,
    clips: RefCell<BTreeMap<String, Option<Rc<Node>>>>,
    /// The last area of each clip path, with the transforms that it was found under.
    areas: RefCell<BTreeMap<String, ClipArea>>,
}

/// The area of a clip path under the transforms from its content and from the clipped node to the root.
#[derive(Clone)]
struct ClipArea {
    space: Affine,
    world: Affine,
    area: Option<Outline<2>>,
}

impl<'a, 's> Painter<'a, 's> {
    pub(crate) fn new(source: &'s Source<'a>) -> Self {
        Self { source, clips: RefCell::default(), areas: RefCell::default() }
    }

    /// The painted area of a node whose parent has the transform `parent` to the root.
    pub(crate) fn painted(&self, node: &Node, parent: Affine) -> Result<PaintedArea> {
        let mut painted = PaintedArea::default();
        self.collect(node, parent, &mut painted)?;
        Ok(painted)
    }

    fn collect(&self, node: &Node, parent: Affine, painted: &mut PaintedArea) -> Result<()> {
        if node.own.get("opacity").is_some_and(|o| fraction(o) == 0.0) {
            return Ok(());
        }
        let world = parent * node.transform;
        let mut own = PaintedArea::default();
        match &node.content {
            Content::Group(children) => {
                for child in children {
                    self.collect(child, world, &mut own)?;
                }
            }
            Content::Shape(geometry) => self.shape(node, geometry, world, &mut own)?,
        }
        if let Some(clip) = self.clip(node, world)? {
            own = own.clipped(&clip, self.source.budget)?;
        }
        painted.append(own);
        Ok(())
    }

    fn shape(&self, node: &Node, geometry: &Geometry, world: Affine, painted: &mut PaintedArea) -> Result<()> {
        self.check(node, geometry, world)?;
        if flattens(world) {
            return Ok(());
        }
        if geometry.paint == Painted::Picture {
            painted.add(filled(&geometry.path, world, FillRule::NonZero, self.source.budget)?, [0.5; 3]);
            return Ok(());
        }
        let style = &node.style;
        if style.fills() {
            let rule = fill_rule(style.get(P::FillRule));
            let outline = filled(&geometry.path, world, rule, self.source.budget)?;
            painted.add(outline, colour::of_paint(self.source, style.get(P::Fill)));
        }
        if style.strokes() {
            let outline = stroked(node, &geometry.path, world, self.source.budget)?;
            painted.add(outline, colour::of_paint(self.source, style.get(P::Stroke)));
        }
        Ok(())
    }

    /// Refuses shapes with coordinates beyond the limit, in the whole tree.
    pub(crate) fn check_all(&self, node: &Node, parent: Affine) -> Result<()> {
        let world = parent * node.transform;
        if let Content::Shape(geometry) = &node.content {
            self.check(node, geometry, world)?;
        }
        node.children().iter().try_for_each(|child| self.check_all(child, world))
    }

    /// Refuses coordinates beyond the limit.
    pub(crate) fn check(&self, node: &Node, geometry: &Geometry, world: Affine) -> Result<()> {
        let extent = (world * geometry.path.clone()).control_box();
        let width = if node.style.strokes() { node.style.number(P::StrokeWidth) * growth(world) } else { 0.0 };
        self.check_extent(node, extent, width)
    }

    fn check_extent(&self, node: &Node, extent: kurbo::Rect, width: f64) -> Result<()> {
        let most = self.source.limits.coordinate;
        let numbers = [extent.x0, extent.y0, extent.x1, extent.y1, width];
        let Some(found) = numbers.into_iter().find(|v| !(0.0..=most).contains(&v.abs())) else { return Ok(()) };
        let place = self.source.xml.get_node(node.meta.xml).map_or_else(String::new, |xml| self.source.place(xml));
        let problem = format!("a coordinate beyond {most:e} user units: {}", rounded(found));
        Err(Error::input(place, problem, "correct or delete this shape"))
    }

    /// The area that the clips of a node leave visible; `world` leads from the node to the root.
    pub(crate) fn clip(&self, node: &Node, world: Affine) -> Result<Option<Outline<2>>> {
        let by_path = match node.own.get("clip-path").and_then(reference) {
            Some(Ok((id, _))) => self.clip_area(id, node, world, &mut Vec::new())?,
            _ => None,
        };
        let by_viewport = match node.viewport_clip {
            Some(viewport) => {
                self.check_extent(node, world.transform_rect_bbox(viewport), 0.0)?;
                Some(filled(&viewport.to_path(0.1), world, FillRule::NonZero, self.source.budget)?)
            }
            None => None,
        };
        Ok(match (by_path, by_viewport) {
            (Some(a), Some(b)) => Some(a.try_intersection(&b, self.source.budget)?),
            (a, b) => a.or(b),
        })
    }

    /// The area of a clip path, cut by the clip path that clips it, and so on; `within` holds those on the way.
    fn clip_area(&self, id: &str, node: &Node, world: Affine, within: &mut Vec<String>) -> Result<Option<Outline<2>>> {
        if within.iter().any(|outer| outer == id) {
            self.source.notes.add(Note::Cycle, || format!("clip path #{}", clip_text(id, 60)));
            return Ok(None);
        }
        if within.len() > 8 {
            return Ok(None);
        }
        let Some(clip) = self.clip_node(id, node.viewport)? else { return Ok(None) };
        let in_box = self.source.xml.get_node(clip.meta.xml).and_then(|n| n.attribute("clipPathUnits"));
        let mut space = world;
        if in_box == Some("objectBoundingBox") {
            let Some(extent) = extent(node) else { return Ok(Some(Outline::default())) };
            space = space
                * Affine::translate(extent.origin().to_vec2())
                * Affine::scale_non_uniform(extent.width(), extent.height());
        }
        if let Some(known) = self.areas.borrow().get(id)
            && (known.space, known.world) == (space, world)
        {
            self.source.budget.spend(known.area.as_ref().map_or(0, |area| area.points().count()) as u64)?;
            return Ok(known.area.clone());
        }
        let mut rings = Vec::new();
        for child in clip.children() {
            self.clip_rings(child, space * clip.transform, &mut rings)?;
        }
        let area = Outline::try_union(&rings, FillRule::NonZero, self.source.budget)?;
        within.push(id.to_owned());
        let outer = match clip.own.get("clip-path").and_then(reference) {
            Some(Ok((outer, _))) => self.clip_area(outer, node, world, within)?,
            _ => None,
        };
        let area = match outer {
            Some(outer) => area.try_intersection(&outer, self.source.budget)?,
            None => area,
        };
        let known = ClipArea { space, world, area: Some(area.clone()) };
        self.areas.borrow_mut().insert(id.to_owned(), known);
        Ok(Some(area))
    }

    fn clip_rings(&self, node: &Node, parent: Affine, rings: &mut Vec<Ring<2>>) -> Result<()> {
        let world = parent * node.transform;
        if let (Content::Shape(geometry), false) = (&node.content, flattens(world)) {
            self.check(node, geometry, world)?;
            let rule = fill_rule(node.style.get(P::ClipRule));
            rings.extend(filled(&geometry.path, world, rule, self.source.budget)?.rings);
        }
        node.children().iter().try_for_each(|child| self.clip_rings(child, world, rings))
    }

    fn clip_node(&self, id: &str, viewport: Viewport) -> Result<Option<Rc<Node>>> {
        if let Some(known) = self.clips.borrow().get(id) {
            return Ok(known.clone());
        }
        let found = self.source.by_id(id).filter(|n| n.tag_name().name() == "clipPath");
        if found.is_none() {
            self.source.notes.add(Note::Missing, || format!("clip path #{id}"));
        }
        let node = match found {
            Some(xml) => build_definition(self.source, xml, viewport)?,
            None => None,
        };
        self.clips.borrow_mut().insert(id.to_owned(), node.clone());
        Ok(node)
    }
}

/// Whether a transform presses everything onto a line or a point: then nothing is drawn.
fn flattens(transform: Affine) -> bool {
    let [a, b, c, d, ..] = transform.as_coeffs();
    let sound = transform.determinant().abs() > 1e-9 * (a * a + b * b + c * c + d * d);
    !sound
}

/// Box around the shapes of a node, strokes left out, in its own coordinates.
fn extent(node: &Node) -> Option<kurbo::Rect> {
    match &node.content {
        Content::Shape(geometry) => Some(geometry.path.bounding_box()),
        Content::Group(children) => {
            let boxes = children.iter().filter_map(|c| Some(c.transform.transform_rect_bbox(extent(c)?)));
            boxes.reduce(|a, b| a.union(b))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::{
        options::ReadOptions,
        parse::{scene, source::with_source},
    };

    fn area(svg: &str) -> f64 {
        let text = format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>{svg}</svg>");
        with_source(&text, &ReadOptions::new("i.svg"), |source| {
            let root = scene::build(source, Viewport { width: 100.0, height: 100.0 })?;
            Ok(Painter::new(source).painted(&root, Affine::IDENTITY)?.outline(source.budget)?.area())
        })
        .unwrap()
    }

    fn is_near(svg: &str, want: f64) {
        let got = area(svg);
        assert!((got - want).abs() < 0.01 * want, "{svg}: {got}, expected {want}");
    }

    #[test]
    fn fills_and_strokes_count_once_where_they_overlap() {
        is_near("<rect width='10' height='10'/>", 100.0);
        is_near("<rect width='10' height='10' stroke='red' stroke-width='2' stroke-linejoin='miter'/>", 144.0);
        is_near("<rect width='10' height='10' stroke='red' stroke-width='2' fill='none'/>", 144.0 - 64.0);
        is_near("<g fill='red'><rect width='10' height='10'/><rect x='5' width='10' height='10'/></g>", 150.0);
    }

    #[test]
    fn opposite_turning_sense_does_not_cancel() {
        is_near("<path d='M0 0h10v10h-10z'/><path d='M0 0v10h10v-10z'/>", 100.0);
        is_near(
            "<g transform='scale(-1 1)'><path d='M0 0h10v10h-10z'/></g><rect x='-5' width='10' height='10'/>",
            150.0,
        );
    }

    #[test]
    fn caps_joins_dashes_and_dots() {
        is_near("<path d='M0 0H10' stroke='red' stroke-width='2'/>", 20.0);
        is_near("<path d='M0 0H10' stroke='red' stroke-width='2' stroke-linecap='square'/>", 24.0);
        is_near("<path d='M0 0H12' stroke='red' stroke-width='2' stroke-dasharray='1 2'/>", 8.0);
        is_near("<path d='M5 5h0' stroke='red' stroke-width='2' stroke-linecap='round'/>", std::f64::consts::PI);
        is_near("<g transform='scale(1 3)'><path d='M0 0H10' stroke='red' stroke-width='2'/></g>", 60.0);
        is_near(
            "<g transform='scale(3)'><path d='M0 0H10' vector-effect='non-scaling-stroke' stroke='red'/></g>",
            30.0,
        );
    }

    #[test]
    fn holes_follow_the_fill_rule() {
        let d = "M0 0h10v10h-10z M2 2h6v6h-6z";
        is_near(&format!("<path d='{d}'/>"), 100.0);
        is_near(&format!("<path fill-rule='evenodd' d='{d}'/>"), 64.0);
    }

    #[test]
    fn clips_cut_the_painted_area() {
        let clip = "<clipPath id='c'><rect width='5' height='100'/></clipPath>";
        is_near(&format!("{clip}<rect clip-path='url(#c)' width='10' height='10'/>"), 50.0);
        is_near(
            &format!("{clip}<g transform='scale(2)' clip-path='url(#c)'><rect width='10' height='10'/></g>"),
            200.0,
        );
        let boxed = "<clipPath id='b' clipPathUnits='objectBoundingBox'><rect width='.5' height='.5'/></clipPath>";
        is_near(&format!("{boxed}<rect x='7' clip-path='url(#b)' width='10' height='10'/>"), 25.0);
        let looped = "<clipPath id='l' clip-path='url(#l)'><rect width='5' height='5'/></clipPath>";
        is_near(&format!("{looped}<rect clip-path='url(#l)' width='10' height='10'/>"), 25.0);
        is_near("<svg width='10' height='10'><rect width='30' height='5'/></svg>", 50.0);
    }

    #[test]
    fn no_visible_paint_is_no_area() {
        assert_eq!(area("<rect width='9' height='9' fill='none'/><rect width='9' height='9' fill-opacity='0'/>"), 0.0);
    }
}
