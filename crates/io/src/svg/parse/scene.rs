//! The drawing as a tree: styles computed, `<use>` resolved, hidden things left out, structure kept.

use std::rc::Rc;

use arabesque_core::Result;
use kurbo::{Affine, Rect};
use roxmltree::{Node as Xml, NodeId};
use svgtypes::Length;

use crate::svg::parse::{
    geometry::{self, Geometry},
    guard,
    length::{self, Axis, Viewport},
    marker,
    meta::{Meta, meta},
    notes::Note,
    source::{Source, clip_text},
    style::{ComputedStyle, Own, Property, computed},
};

/// One thing of the drawing.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// From its coordinates to those of its parent.
    pub(crate) transform: Affine,
    /// Computed inherited properties.
    pub(crate) style: Rc<ComputedStyle>,
    /// Properties of its own: opacity, clip, mask, filter.
    pub(crate) own: Own,
    /// What percentages refer to.
    pub(crate) viewport: Viewport,
    /// The part of a nested viewport that shows, in its own coordinates.
    pub(crate) viewport_clip: Option<Rect>,
    /// What the file says about it.
    pub(crate) meta: Rc<Meta>,
    /// What it is made of.
    pub(crate) content: Content,
}

/// What a node is made of.
#[derive(Clone, Debug)]
pub(crate) enum Content {
    /// Other nodes, drawn in order.
    Group(Vec<Rc<Node>>),
    /// One shape.
    Shape(Rc<Geometry>),
}

impl Node {
    /// The nodes it is made of; none for a shape.
    pub(crate) fn children(&self) -> &[Rc<Self>] {
        match &self.content {
            Content::Group(children) => children,
            Content::Shape(_) => &[],
        }
    }
}

/// Where the walk is.
#[derive(Clone)]
struct Position<'u> {
    style: Rc<ComputedStyle>,
    viewport: Viewport,
    depth: usize,
    /// The `<use>` targets that the walk is inside of.
    uses: Option<&'u Used<'u>>,
}

struct Used<'u> {
    id: NodeId,
    outer: Option<&'u Used<'u>>,
}

impl Used<'_> {
    fn contains(&self, id: NodeId) -> bool {
        self.id == id || self.outer.is_some_and(|outer| outer.contains(id))
    }
}

/// The whole drawing, in user coordinates of the root.
pub(crate) fn build(source: &Source<'_>, viewport: Viewport) -> Result<Node> {
    let root = source.xml.root_element();
    let (style, _) = computed(source, root, &Rc::new(ComputedStyle::default()), viewport);
    let place = Position { style: Rc::clone(&style), viewport, depth: 0, uses: None };
    let node = Node {
        transform: transform(source, root),
        style,
        own: Own::default(),
        viewport,
        viewport_clip: None,
        meta: Rc::new(meta(source, root, "svg")),
        content: Content::Group(children(source, root, &place)?),
    };
    Ok(node)
}

/// The content of a definition such as `<clipPath>`, as a group.
pub(crate) fn build_definition(source: &Source<'_>, xml: Xml<'_, '_>, viewport: Viewport) -> Result<Option<Rc<Node>>> {
    let Some(xml) = source.xml.get_node(xml.id()) else { return Ok(None) };
    let mut style = Rc::new(ComputedStyle::default());
    let mut chain: Vec<_> = xml.ancestors().filter(Xml::is_element).collect();
    chain.reverse();
    let mut own = Own::default();
    for node in chain {
        (style, own) = computed(source, node, &style, viewport);
    }
    let place = Position { style: Rc::clone(&style), viewport, depth: 1, uses: None };
    let content = Content::Group(children(source, xml, &place)?);
    let meta = Rc::new(meta(source, xml, "g"));
    let transform = transform(source, xml);
    Ok(Some(Rc::new(Node { transform, style, own, viewport, viewport_clip: None, meta, content })))
}

fn children<'a>(source: &Source<'a>, xml: Xml<'a, 'a>, place: &Position<'_>) -> Result<Vec<Rc<Node>>> {
    let mut nodes = Vec::new();
    for child in xml.children() {
        nodes.extend(node(source, child, place)?);
    }
    Ok(nodes)
}

fn node<'a>(source: &Source<'a>, xml: Xml<'a, 'a>, place: &Position<'_>) -> Result<Option<Rc<Node>>> {
    if !source.is_svg(xml) {
        return Ok(None);
    }
    let Some(tag) = drawn_tag(source, xml) else { return Ok(None) };
    source.count_node()?;
    if place.depth > source.limits.depth {
        let what = format!("{}: nested groups, <use> resolved", source.name);
        return Err(guard::over(what, place.depth, ("depth", source.limits.depth)));
    }
    let (style, own) = computed(source, xml, &place.style, place.viewport);
    if own.get("display") == Some("none") {
        return Ok(None);
    }
    let inside = Position { style: Rc::clone(&style), depth: place.depth + 1, ..place.clone() };
    let mut built = Node {
        transform: own_transform(source, xml, &own),
        style,
        own,
        viewport: place.viewport,
        viewport_clip: None,
        meta: Rc::new(meta(source, xml, tag)),
        content: Content::Group(Vec::new()),
    };
    source.count_bytes(built.meta.bytes())?;
    match tag {
        "use" => reuse(source, xml, &inside, &mut built)?,
        "svg" => nested(source, xml, &inside, &mut built, [None, None])?,
        "switch" => built.content = Content::Group(choice(source, xml, &inside)?),
        "g" | "a" => built.content = Content::Group(children(source, xml, &inside)?),
        _ => match shape(source, xml, &built)? {
            Some(geometry) => built.content = with_markers(source, xml, geometry, &built)?,
            None => return Ok(None),
        },
    }
    let empty = matches!(&built.content, Content::Group(children) if children.is_empty());
    Ok((!empty).then(|| Rc::new(built)))
}

/// The name of a tag that draws something; what cannot be drawn is noted.
fn drawn_tag(source: &Source<'_>, xml: Xml<'_, '_>) -> Option<&'static str> {
    const DRAWN: [&str; 13] =
        ["g", "a", "svg", "switch", "use", "path", "rect", "circle", "ellipse", "line", "polyline", "polygon", "image"];
    let name = xml.tag_name().name();
    let id = || xml.attribute("id").map_or_else(String::new, |id| clip_text(id, 40).to_owned());
    match name {
        "text" | "flowRoot" if xml.descendants().any(|n| n.text().is_some_and(|t| !t.trim().is_empty())) => {
            source.notes.add(Note::Text, id);
        }
        "foreignObject" if xml.has_children() => source.notes.add(Note::Foreign, id),
        _ => {}
    }
    DRAWN.into_iter().find(|tag| *tag == name)
}

fn shape(source: &Source<'_>, xml: Xml<'_, '_>, node: &Node) -> Result<Option<Geometry>> {
    if node.style.get(Property::Visibility) != "visible" || !geometry::is_shape(xml.tag_name().name()) {
        return Ok(None);
    }
    geometry::read(source, xml, node.viewport)
}

/// A shape, with its markers where it has any: they make a group with it.
fn with_markers(source: &Source<'_>, xml: Xml<'_, '_>, geometry: Geometry, built: &Node) -> Result<Content> {
    let style = &built.style;
    // Markers in markers are not drawn.
    if !style.has_markers() || !marker::may_have(built.meta.tag) || source.context.borrow().is_some() {
        return Ok(Content::Shape(Rc::new(geometry)));
    }
    let vertices = marker::vertices(&geometry.path, xml.attribute("d"));
    let width = style.number(Property::StrokeWidth);
    let mut markers = Vec::new();
    for (k, vertex) in vertices.iter().enumerate() {
        for spot in marker::spots(k, vertices.len()) {
            let Some(found) = marker::find(source, style.get(spot.property())) else { continue };
            let Some(placed) = marker::placed(source, found, (vertex, spot), width, built.viewport)? else { continue };
            *source.context.borrow_mut() = Some([Property::Fill, Property::Stroke].map(|p| style.get(p).into()));
            let content = build_definition(source, found, placed.viewport);
            source.context.borrow_mut().take();
            markers.extend(content?.and_then(|content| as_placed(&content, &placed)));
        }
    }
    if markers.is_empty() {
        return Ok(Content::Shape(Rc::new(geometry)));
    }
    let style = Rc::new(style.unmarked());
    let meta = Rc::new(Meta { mark: None, part: None, ..(*built.meta).clone() });
    let content = Content::Shape(Rc::new(geometry));
    let line = Node { transform: Affine::IDENTITY, style, own: Own::default(), meta, content, ..built.clone() };
    markers.insert(0, Rc::new(line));
    Ok(Content::Group(markers))
}

/// The content of a marker at its place; cut where it reaches beyond what shows of it.
fn as_placed(content: &Node, placed: &marker::Placed) -> Option<Rc<Node>> {
    let reach = reach(content, Affine::IDENTITY)?;
    let is_inside = |clip: &Rect| clip.union(reach) == *clip;
    let viewport_clip = placed.clip.filter(|clip| !is_inside(clip));
    Some(Rc::new(Node { transform: placed.transform, viewport_clip, ..content.clone() }))
}

/// Box around everything that a node can paint, where `world` leads from the node.
fn reach(node: &Node, world: Affine) -> Option<Rect> {
    match &node.content {
        Content::Group(children) => {
            children.iter().filter_map(|c| reach(c, world * c.transform)).reduce(|a, b| a.union(b))
        }
        Content::Shape(geometry) => {
            let mitre = 0.5 * node.style.number(Property::StrokeMiterlimit).max(1.5);
            let width = if node.style.strokes() { node.style.number(Property::StrokeWidth) } else { 0.0 };
            Some(world.transform_rect_bbox(geometry.path.control_box().inflate(mitre * width, mitre * width)))
        }
    }
}

/// The first child of a `<switch>` that asks for nothing special.
fn choice<'a>(source: &Source<'a>, xml: Xml<'a, 'a>, place: &Position<'_>) -> Result<Vec<Rc<Node>>> {
    let accepts = |child: &Xml<'a, 'a>| {
        let language = child.attribute("systemLanguage");
        let extension = child.attribute("requiredExtensions");
        source.is_svg(*child)
            && extension.is_none()
            && language.is_none_or(|l| l.split(',').any(|l| l.trim().starts_with("en")))
    };
    match xml.children().find(accepts) {
        Some(child) => Ok(node(source, child, place)?.into_iter().collect()),
        None => Ok(Vec::new()),
    }
}

/// Fills in what a `<use>` shows.
fn reuse<'a>(source: &Source<'a>, xml: Xml<'a, 'a>, place: &Position<'_>, built: &mut Node) -> Result<()> {
    let Some(target) = source.target(xml) else { return Ok(()) };
    let inside_itself = xml.ancestors().any(|a| a.id() == target.id());
    if inside_itself || place.uses.is_some_and(|uses| uses.contains(target.id())) {
        source.notes.add(Note::Cycle, || format!("{} shows itself", source.place(xml)));
        return Ok(());
    }
    let used = Used { id: target.id(), outer: place.uses };
    let inside = Position { uses: Some(&used), ..place.clone() };
    let at = |name, axis| offset(xml, place.viewport, name, axis).unwrap_or(0.0);
    built.transform *= Affine::translate((at("x", Axis::X), at("y", Axis::Y)));
    let name = target.tag_name().name();
    if !matches!(name, "symbol" | "svg") {
        built.content = Content::Group(node(source, target, &inside)?.into_iter().collect());
        return Ok(());
    }
    let size = ["width", "height"].map(|name| {
        let axis = if name == "width" { Axis::X } else { Axis::Y };
        offset(xml, place.viewport, name, axis)
    });
    source.count_node()?;
    let (style, own) = computed(source, target, &inside.style, inside.viewport);
    let inside = Position { style: Rc::clone(&style), depth: inside.depth + 1, ..inside };
    let mut content = Node {
        transform: own_transform(source, target, &own),
        style,
        own,
        viewport: place.viewport,
        viewport_clip: None,
        meta: Rc::new(meta(source, target, "symbol")),
        content: Content::Group(Vec::new()),
    };
    nested(source, target, &inside, &mut content, size)?;
    let empty = content.children().is_empty();
    built.content = Content::Group(if empty { Vec::new() } else { vec![Rc::new(content)] });
    Ok(())
}

/// A length attribute in user units, where it is present and sensible.
fn offset(xml: Xml<'_, '_>, viewport: Viewport, name: &str, axis: Axis) -> Option<f64> {
    let length: Length = xml.attribute(name)?.trim().parse().ok()?;
    Some(viewport.resolve(length, axis, 16.0)).filter(|v| v.is_finite())
}

/// Fills in the content of a nested viewport; `size` overrides its stated size.
fn nested<'a>(
    source: &Source<'a>,
    xml: Xml<'a, 'a>,
    place: &Position<'_>,
    built: &mut Node,
    size: [Option<f64>; 2],
) -> Result<()> {
    let at = |name, axis| offset(xml, place.viewport, name, axis);
    let width = size[0].or_else(|| at("width", Axis::X)).unwrap_or(place.viewport.width);
    let height = size[1].or_else(|| at("height", Axis::Y)).unwrap_or(place.viewport.height);
    if width <= 0.0 || height <= 0.0 {
        return Ok(());
    }
    let fit = length::fit(source, xml, width, height)?;
    let corner = if built.meta.tag == "svg" { (at("x", Axis::X), at("y", Axis::Y)) } else { (None, None) };
    let place = Position { viewport: fit.viewport, ..place.clone() };
    built.transform *= Affine::translate((corner.0.unwrap_or(0.0), corner.1.unwrap_or(0.0)))
        * Affine::new([fit.scale[0], 0.0, 0.0, fit.scale[1], fit.shift[0], fit.shift[1]]);
    if !matches!(built.own.get("overflow"), Some("visible" | "auto")) && fit.scale[0] > 0.0 && fit.scale[1] > 0.0 {
        let (x, y) = (-fit.shift[0] / fit.scale[0], -fit.shift[1] / fit.scale[1]);
        built.viewport_clip = Some(Rect::new(x, y, x + width / fit.scale[0], y + height / fit.scale[1]));
    }
    built.content = Content::Group(children(source, xml, &place)?);
    Ok(())
}

fn transform(source: &Source<'_>, xml: Xml<'_, '_>) -> Affine {
    xml.attribute("transform").map_or(Affine::IDENTITY, |text| parsed_transform(source, text))
}

/// The transform property: from the style where it is set there, else from the attribute.
fn own_transform(source: &Source<'_>, xml: Xml<'_, '_>, own: &Own) -> Affine {
    if xml.attribute("transform-origin").is_some() {
        source.notes.add(Note::Transform, || "transform-origin".to_owned());
    }
    own.get("transform").map_or_else(|| transform(source, xml), |text| parsed_transform(source, text))
}

fn parsed_transform(source: &Source<'_>, text: &str) -> Affine {
    match text.parse::<svgtypes::Transform>() {
        Ok(t) => Affine::new([t.a, t.b, t.c, t.d, t.e, t.f]),
        Err(_) if matches!(text.trim(), "" | "none") => Affine::IDENTITY,
        Err(_) => {
            source.notes.add(Note::Transform, || clip_text(text, 40).to_owned());
            Affine::IDENTITY
        }
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Budget, Limits};

    use super::*;
    use crate::svg::{options::ReadOptions, parse::source::with_source};

    fn outline(node: &Node, world: Affine) -> Vec<String> {
        let world = world * node.transform;
        match &node.content {
            Content::Shape(g) => {
                let b = (world * g.path.clone()).control_box();
                vec![format!("{:.0} {:.0} {:.0} {:.0}", b.x0, b.y0, b.x1, b.y1)]
            }
            Content::Group(children) => children.iter().flat_map(|c| outline(c, world)).collect(),
        }
    }

    fn boxes(svg: &str) -> Vec<String> {
        let text = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' viewBox='0 0 100 \
             100'>{svg}</svg>"
        );
        with_source(&text, &ReadOptions::new("s.svg"), |source| {
            let root = build(source, Viewport { width: 100.0, height: 100.0 })?;
            Ok(outline(&root, Affine::IDENTITY))
        })
        .unwrap()
    }

    #[test]
    fn nested_transforms_multiply() {
        let svg = "<g transform='translate(10 0)'><g transform='scale(2)'><rect x='1' width='3' height='4'/></g></g>";
        assert_eq!(boxes(svg), ["12 0 18 8"]);
    }

    #[test]
    fn use_places_shapes_groups_and_symbols() {
        let svg = "<defs><rect id='r' width='2' height='2'/>
            <symbol id='s' viewBox='0 0 10 10'><rect width='10' height='10'/></symbol></defs>
            <use href='#r' x='5' y='6'/><use xlink:href='#s' x='20' width='30' height='40'/>";
        assert_eq!(boxes(svg), ["5 6 7 8", "20 5 50 35"]);
    }

    #[test]
    fn markers_stand_at_their_lines_in_the_way_that_these_go() {
        let arrow = |attributes: &str| {
            format!("<marker id='m' markerWidth='4' markerHeight='4' {attributes}><path d='M0 0L4 2L0 4z'/></marker>")
        };
        let line = "<path d='M10 10V30' stroke='red' stroke-width='2' fill='none' marker-end='url(#m)'/>";
        let of = |attributes: &str| boxes(&format!("{}{line}", arrow(attributes)))[1].clone();
        assert_eq!(of("refX='0' refY='2' orient='auto'"), "6 30 14 38");
        assert_eq!(of("refX='4' refY='2' orient='auto'"), "6 22 14 30");
        assert_eq!(of("refX='0' refY='2' orient='-90deg'"), "6 22 14 30");
        assert_eq!(of("refX='center' refY='center'"), "6 26 14 34");
        assert_eq!(of("markerUnits='userSpaceOnUse' refY='2'"), "10 28 14 32");
        assert_eq!(of("viewBox='0 0 8 8' refY='4'"), "10 26 14 30");
        let start = "<path d='M10 10V30' stroke='red' marker-start='url(#m)'/>";
        assert_eq!(boxes(&format!("{}{start}", arrow("refY='2' orient='auto-start-reverse'")))[1], "8 6 12 10");
    }

    #[test]
    fn markers_take_paint_from_their_line_and_have_none_themselves() {
        let text = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'><marker id='m' style='overflow:visible'>
            <path d='M0 0L4 2L0 4' fill='context-stroke' stroke='context-fill' marker-end='url(#m)'/></marker>
            <line x2='10' stroke='#0066cc' fill='lime' marker-end='url(#m)'/><path d='M0 0h9' fill='context-fill'/></svg>";
        with_source(text, &ReadOptions::new("m.svg"), |source| {
            let root = build(source, Viewport { width: 100.0, height: 100.0 })?;
            let head = &root.children()[0].children()[1];
            let style = &head.children()[0].style;
            assert_eq!((style.get(Property::Fill), style.get(Property::Stroke)), ("#0066cc", "#00ff00"));
            assert!(head.viewport_clip.is_none() && matches!(head.children()[0].content, Content::Shape(_)));
            assert_eq!(root.children()[1].style.get(Property::Fill), "none");
            Ok(())
        })
        .unwrap();
    }

    #[test]
    fn nested_svg_has_its_own_coordinates() {
        assert_eq!(
            boxes("<svg x='10' y='10' width='20' height='20' viewBox='0 0 4 4'><rect width='50%' height='1'/></svg>"),
            ["10 10 20 15"]
        );
    }

    #[test]
    fn hidden_things_are_left_out() {
        let svg = "<g style='display:none'><rect width='1' height='1'/></g><rect visibility='hidden' width='1' \
             height='1'/>
            <g visibility='hidden'><rect visibility='visible' width='2' height='2'/></g>
            <switch><foreignObject requiredExtensions='x'/><rect width='3' height='3'/><rect width='4' \
            height='4'/></switch>";
        assert_eq!(boxes(svg), ["0 0 2 2", "0 0 3 3"]);
    }

    #[test]
    fn use_of_itself_ends() {
        assert!(boxes("<g id='a'><use href='#a'/><g id='b'><use href='#b'/></g></g>").is_empty());
        assert!(
            boxes("<defs><g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g></defs><use href='#a'/>")
                .is_empty()
        );
    }

    #[test]
    fn use_explosions_meet_a_limit() {
        let mut svg =
            String::from("<svg xmlns='http://www.w3.org/2000/svg'><defs><rect id='u0' width='1' height='1'/>");
        for k in 1..9 {
            svg += &format!("<g id='u{k}'>{}</g>", format!("<use href='#u{}'/>", k - 1).repeat(10));
        }
        svg += "</defs><use href='#u8'/></svg>";
        let mut options = ReadOptions::new("s.svg");
        options.budget = Budget::new(Limits { nodes: 10_000, ..Limits::default() });
        let read = with_source(&svg, &options, |source| build(source, Viewport { width: 1.0, height: 1.0 }));
        assert!(read.unwrap_err().to_string().contains("over the limit of 10000"));
    }
}
