//! Which period a file shows, if it shows one.

use std::rc::Rc;

use arabesque_core::{Bounds, Error, Result, rounded};
use kurbo::{Affine, Rect, Shape};

use crate::svg::{
    options::Tiling,
    parse::{
        geometry::Geometry,
        meta::Meta,
        notes::Note,
        scene::{Content, Node},
        source::Source,
        style::Own,
    },
    swatch::{
        cell::{Cell, name, opposite},
        fit::{Ending, Misfit, misfit},
        found::{MOST, is_likely, is_period, is_possible},
        links::{Links, links},
        meet::meet,
        pattern::{Painted, painted},
        pieces::{Piece, pieces},
        units::{Unit, Units, units},
        unroll::{Period, Unrolled},
    },
};

/// The periods of a drawing laid out, where it shows one: what the `roots` hold, each with the transform from its parent to the root, in
/// the `frame`.
///
/// # Errors
/// [`Error::Input`] for a pattern that cannot be repeated, and for a period whose opposite edges do not fit.
pub(crate) fn periods(
    source: &Source<'_>,
    base: &Rc<Node>,
    roots: &[(Affine, Rc<Node>)],
    frame: Option<Bounds<2>>,
    tiling: Tiling,
) -> Result<Option<Unrolled>> {
    if tiling == Tiling::Page {
        return Ok(None);
    }
    if let [(_, only)] = roots
        && let Some(painted) = painted(source, only, frame)?
    {
        return of_pattern(source, base, painted).map(Some);
    }
    let Some(frame) = frame else {
        let advice = "give the file a viewBox, or a width and a height";
        let no_size = || Error::input(source.name, "one period without a size", advice);
        return if tiling == Tiling::Period { Err(no_size()) } else { Ok(None) };
    };
    if tiling != Tiling::Period && roots.iter().map(|(_, node)| count(node)).sum::<usize>() > 10 * MOST {
        return Ok(None);
    }
    of_page(source, base, roots, (frame, tiling))
}

fn count(node: &Node) -> usize {
    1 + node.children().iter().map(|child| count(child)).sum::<usize>()
}

/// The page as one period.
fn of_page(
    source: &Source<'_>,
    root: &Rc<Node>,
    roots: &[(Affine, Rc<Node>)],
    (frame, tiling): (Bounds<2>, Tiling),
) -> Result<Option<Unrolled>> {
    let frame = Rect::new(frame.min[0], frame.min[1], frame.max[0], frame.max[1]);
    let cell = Cell { frame, to_root: Affine::IDENTITY };
    let mut found = units(roots, &cell, source.budget)?;
    found.all.retain(|unit| !is_frame_mark(&unit.node.meta));
    let (mut pieces, mut links) = taken_apart(source, &found, &cell)?;
    let off = misfit(&pieces, &found.all, &links, (&cell, Ending::Whole));
    let is_taken = match tiling {
        Tiling::Page => false,
        Tiling::Auto => is_period(&found, &pieces, &links, &cell),
        Tiling::Likely => off.is_none() && is_likely(&found, &pieces, &links, &cell),
        Tiling::Possible => off.is_none() && is_possible(&found, &pieces, &links, &cell),
        Tiling::Period => true,
    };
    if !is_taken {
        return Ok(None);
    }
    if tiling != Tiling::Period {
        source.notes.add(Note::Period, String::new);
    }
    if let Some(off) = off {
        return Err(does_not_fit(source, &off, &found.all[off.unit]));
    }
    meet(&mut pieces, &mut links, &found.all, &cell, source.budget)?;
    let period = Period { cell, units: &found.all, pieces: &pieces, links: &links };
    period.unroll(source, root).map(Some)
}

fn is_frame_mark(meta: &Meta) -> bool {
    let is_named = |name: &Option<String>| name.as_ref().is_some_and(|name| name.eq_ignore_ascii_case("frame"));
    meta.tag == "rect" && (is_named(&meta.id) || is_named(&meta.label))
}

/// What the edges cut, and how it goes on.
fn taken_apart(source: &Source<'_>, found: &Units, cell: &Cell) -> Result<(Vec<Piece>, Links)> {
    let cut = found.all.iter().enumerate().filter(|(_, unit)| unit.is_cut);
    let pieces: Vec<Piece> = cut.flat_map(|(number, unit)| pieces(number, unit, cell)).collect();
    let links = links(&pieces, &found.all, cell, source.budget)?;
    Ok((pieces, links))
}

fn does_not_fit(source: &Source<'_>, off: &Misfit, unit: &Unit) -> Error {
    let xml = source.xml.get_node(unit.node.meta.xml);
    let place = xml.map_or_else(|| source.name.to_owned(), |xml| source.place(xml));
    let (here, there, at) = (name(off.side), name(opposite(off.side)), rounded(off.along));
    let from = if off.side < 2 { "top" } else { "left" };
    let problem = format!(
        "the opposite edges of the period do not fit: the {here} edge cuts this {at} from the {from}, and it does not go on \
         at the {there} edge"
    );
    Error::input(place, problem, "continue it there, or leave --exemplar-tile out")
}

/// What a pattern repeats, over what lies below it.
fn of_pattern(source: &Source<'_>, root: &Rc<Node>, painted: Painted) -> Result<Unrolled> {
    let Painted { cell, roots, below, name, opacity } = painted;
    let found = units(&roots, &cell, source.budget)?;
    if found.all.is_empty() {
        let problem = format!("{name} draws nothing in its box");
        return Err(Error::input(source.name, problem, "draw something inside of x, y, width and height"));
    }
    let (mut pieces, mut links) = taken_apart(source, &found, &cell)?;
    meet(&mut pieces, &mut links, &found.all, &cell, source.budget)?;
    let period = Period { cell, units: &found.all, pieces: &pieces, links: &links };
    let unrolled = period.unroll(source, root)?;
    let window = unrolled.window;
    let cover = Rect::new(window.min[0], window.min[1], window.max[0], window.max[1]).to_path(0.1);
    let mut children: Vec<Rc<Node>> = Vec::new();
    for (parent, node) in below {
        let world = parent * node.transform;
        let content = Content::Shape(Rc::new(Geometry::from_path(world.inverse() * cover.clone())));
        children.push(Rc::new(Node { transform: world, content, ..(*node).clone() }));
    }
    let own = if opacity < 1.0 { Own::opacity(&opacity.to_string()) } else { Own::default() };
    children.push(Rc::new(Node { own, ..(*unrolled.root).clone() }));
    let content = Content::Group(children);
    let all =
        Node { transform: Affine::IDENTITY, own: Own::default(), viewport_clip: None, content, ..(**root).clone() };
    Ok(Unrolled { root: Rc::new(all), ..unrolled })
}
