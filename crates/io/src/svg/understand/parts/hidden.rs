//! What nobody sees: things that something opaque covers in full, and the original that lies under its first tiled
//! clone.

use std::{collections::BTreeMap, mem};

use arabesque_core::{Budget, Outline, Result};

use crate::svg::{
    namespace::INKSCAPE,
    parse::{
        geometry::Painted,
        paint::fraction,
        scene::{Content, Node},
        source::Source,
        style::Property as P,
    },
    reason::Reason,
    shape::adjacency::meeting,
    understand::item::{Item, Kind, Selection},
};

/// Share of something that may show where it counts as covered: rounding.
const SHOWS: f64 = 0.002;
/// Share of an original that its first clone covers at least.
const LIES_ON: f64 = 0.5;
/// Covers of one thing that are looked at.
const COVERS: usize = 24;
/// Work for each edge that a point is compared with.
const EDGE: u64 = 2;

/// Takes out what cannot be seen.
///
/// # Errors
/// As [`Outline::try_difference`].
pub(crate) fn drop_hidden(found: &mut Selection, source: &Source<'_>) -> Result<()> {
    let items = &found.items;
    let covers = covers(items, source.budget)?;
    let originals = originals(items, source)?;
    let mut fate: Vec<Option<Reason>> = vec![None; items.len()];
    for (i, item) in items.iter().enumerate().filter(|(_, item)| item.kind != Kind::Curve) {
        let over: Vec<&Outline<2>> = covers.get(&i).into_iter().flatten().map(|&j| &items[j].outline).collect();
        if originals.contains(&i) {
            fate[i] = Some(Reason::Original);
        } else if is_covered(&item.outline, &over, source.budget)? {
            fate[i] = Some(Reason::Covered);
        }
    }
    for (item, fate) in mem::take(&mut found.items).into_iter().zip(fate) {
        match fate {
            None => found.items.push(item),
            Some(reason) => found.left_out.push((reason, item.name(source), item.outline)),
        }
    }
    Ok(())
}

/// For each item what is opaque and drawn later over a part of it.
fn covers(items: &[Item], budget: &Budget) -> Result<BTreeMap<usize, Vec<usize>>> {
    let boxes: Vec<_> = items.iter().map(|item| item.outline.bounds()).collect();
    let opaque: Vec<bool> = items.iter().map(is_opaque).collect();
    let mut covers: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    meeting(
        &boxes,
        |_| 0.0,
        budget,
        |i, j| {
            let (below, above) = (i.min(j), i.max(j));
            if opaque[above] && items[below].kind != Kind::Curve {
                let all = covers.entry(below).or_default();
                if all.len() < COVERS {
                    all.push(above);
                }
            }
            true
        },
    )?;
    Ok(covers)
}

/// Whether nothing of an outline shows below others.
fn is_covered(outline: &Outline<2>, over: &[&Outline<2>], budget: &Budget) -> Result<bool> {
    if over.is_empty() {
        return Ok(false);
    }
    let mut meter = budget.meter();
    let edges: u64 = over.iter().map(|cover| cover.points().count() as u64).sum();
    // Most things show at one of their corners, which is soon found.
    for corner in outline.points().step_by(1 + outline.points().count() / 16) {
        meter.spend(EDGE * edges)?;
        if !over.iter().any(|cover| is_in(cover, corner)) {
            return Ok(false);
        }
    }
    let mut rest = outline.clone();
    for cover in over {
        rest = rest.try_difference(cover, budget)?;
    }
    Ok(rest.area() <= SHOWS * outline.area())
}

/// Whether a point lies in an outline or, by a hair, on its border.
fn is_in(outline: &Outline<2>, p: arabesque_core::Vector<2>) -> bool {
    let near = 1e-3 * outline.bounds().size().norm();
    outline.contains(p) || outline.edges().any(|edge| arabesque_core::segment::distance(edge, p) <= near)
}

/// Whether nothing is seen through any part of an item.
pub(crate) fn is_opaque(item: &Item) -> bool {
    item.opacity >= 1.0 && item.kind != Kind::Curve && item.parts.iter().all(|(_, node)| is_solid(node))
}

/// Whether everything in a node is painted in plain colours without effects.
fn is_solid(node: &Node) -> bool {
    let is_plain = !node.own.has_effects() && node.own.get("opacity").is_none_or(|o| fraction(o) >= 1.0);
    let is_full = |paint: P, opacity: P| {
        let paint = node.style.get(paint);
        paint == "none" || paint.starts_with('#') && fraction(node.style.get(opacity)) >= 1.0
    };
    is_plain
        && match &node.content {
            Content::Group(children) => children.iter().all(|child| is_solid(child)),
            Content::Shape(geometry) => {
                geometry.paint == Painted::Style
                    && is_full(P::Fill, P::FillOpacity)
                    && is_full(P::Stroke, P::StrokeOpacity)
            }
        }
}

/// The originals of tiled clones that lie under their first copies.
fn originals(items: &[Item], source: &Source<'_>) -> Result<Vec<usize>> {
    let tiled = |item: &Item| {
        let xml = source.xml.get_node(item.meta.xml)?;
        xml.attribute((INKSCAPE, "tiled-clone-of")).map(|of| of.trim().trim_start_matches('#').to_owned())
    };
    let mut first: BTreeMap<String, usize> = BTreeMap::new();
    for (k, item) in items.iter().enumerate() {
        if let Some(of) = tiled(item) {
            first.entry(of).or_insert(k);
        }
    }
    let mut found = Vec::new();
    for (k, item) in items.iter().enumerate() {
        let Some(&copy) = item.meta.id.as_ref().and_then(|id| first.get(id)) else { continue };
        let common = item.outline.try_intersection(&items[copy].outline, source.budget)?;
        if common.area() >= LIES_ON * item.outline.area() {
            found.push(k);
        }
    }
    Ok(found)
}
