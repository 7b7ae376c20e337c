//! Bands filled with a gradient across them: alike bands at even distances are painted by one gradient that begins anew
//! at every step, so that bands of any length, and as many as are wanted, look as those of the exemplar.

use std::{collections::BTreeMap, rc::Rc};

use arabesque_core::{Bounds, Result, Vector};
use kurbo::{Affine, Point, Shape as _, Vec2};
use roxmltree::Node as Xml;
use svgtypes::Length;

use crate::svg::{
    parse::{
        definitions::{RepeatedGradient, Stop, stops},
        length::{Axis, Viewport},
        paint::reference,
        scene::Content,
        source::Source,
        style::Property as P,
    },
    reason::Reason,
    shape::extent::{longer, sole_shape},
    understand::{
        frame::{reaches, runs_through},
        item::{Item, Kind, Origin},
    },
};

/// Places of gradients that differ by less than this share of the frame are one, and so are steps between them by less
/// than this share.
const SAME: (f64, f64) = (1e-4, 0.01);

/// Most gradients that one takes what it lacks from.
const CHAIN: usize = 32;

/// Work for each gradient.
const WORK: u64 = 2000;

/// A linear gradient in the coordinates of the root: where it begins, and how far it goes, across its lines of one colour.
struct Linear {
    start: Vector<2>,
    way: Vector<2>,
    length: f64,
    stops: Rc<[Stop]>,
}

/// Takes fills with gradients that run through the frame for areas, where one gradient paints all that are alike.
///
/// # Errors
/// As [`arabesque_core::Budget::spend`].
pub(crate) fn take_gradients(source: &Source<'_>, items: &mut [Item], frame: &Bounds<2>) -> Result<()> {
    let mut families: BTreeMap<String, Vec<(usize, Linear)>> = BTreeMap::new();
    for (i, item) in items.iter().enumerate() {
        let is_large = item.kind == Kind::Large && reaches(item, frame) >= 2;
        let is_through = item.kind == Kind::Element && runs_through(item, frame);
        if !(is_large || is_through) || item.origin == Origin::Whole || item.is_cut {
            continue;
        }
        source.budget.spend(WORK)?;
        if let Some(linear) = linear(source, item) {
            let Linear { way, length, stops, .. } = &linear;
            let key = format!("{:.3} {:.3} {:.4} {stops:?}", way[0], way[1], length / longer(frame));
            families.entry(key).or_default().push((i, linear));
        }
    }
    for family in families.into_values() {
        let Some(gradient) = repeated(&family, SAME.0 * longer(frame)) else { continue };
        let gradient = Rc::new(gradient);
        for (i, _) in family {
            items[i].gradient = Some(Rc::clone(&gradient));
            (items[i].kind, items[i].reason) = (Kind::Area, Reason::Area);
        }
    }
    Ok(())
}

/// The gradient that paints all of a family; `None` where they do not follow one another in even steps.
fn repeated(family: &[(usize, Linear)], near: f64) -> Option<RepeatedGradient> {
    let (_, first) = family.first()?;
    let mut places: Vec<f64> = family.iter().map(|(_, linear)| (linear.start - first.start).dot(first.way)).collect();
    places.sort_by(f64::total_cmp);
    places.dedup_by(|next, last| *next - *last <= near);
    let step = places.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
    let is_even = |place: &f64| {
        let steps = (place - places[0]) / step;
        (steps - steps.round()).abs() <= SAME.1
    };
    let fits = step.is_finite() && first.length <= step * (1.0 + SAME.1) && places.iter().all(is_even);
    fits.then(|| RepeatedGradient {
        start: first.start.0,
        step: (first.way * step).0,
        share: (first.length / step).min(1.0),
        stops: Rc::clone(&first.stops),
    })
}

/// The gradient of an item that is one shape with that fill alone.
fn linear(source: &Source<'_>, item: &Item) -> Option<Linear> {
    let [(parent, node)] = item.parts.as_slice() else { return None };
    let only = sole_shape(node, *parent)?;
    let (leaf, Content::Shape(geometry)) = (only.leaf, &only.leaf.content) else { return None };
    if leaf.style.strokes() || !leaf.style.fills() {
        return None;
    }
    let (id, _) = reference(leaf.style.get(P::Fill))?.ok()?;
    let chain = chain(source, source.by_id(id).filter(|n| n.tag_name().name() == "linearGradient")?);
    let find = |name: &str| chain.iter().find_map(|n| n.attribute(name));
    if find("spreadMethod").is_some_and(|spread| spread != "pad") {
        return None;
    }
    let is_user = find("gradientUnits") == Some("userSpaceOnUse");
    let own = match find("gradientTransform") {
        Some(text) => text.parse::<svgtypes::Transform>().ok().map(|t| Affine::new([t.a, t.b, t.c, t.d, t.e, t.f]))?,
        None => Affine::IDENTITY,
    };
    let around = geometry.path.bounding_box();
    let to_box = if is_user {
        Affine::IDENTITY
    } else {
        Affine::translate(around.origin().to_vec2()) * Affine::scale_non_uniform(around.width(), around.height())
    };
    let to_root = only.parent * leaf.transform * to_box * own;
    let at = |name: &str, axis: Axis, initial: &str| {
        coordinate(find(name).unwrap_or(initial), axis, is_user.then_some(leaf.viewport))
    };
    let from = Point::new(at("x1", Axis::X, "0")?, at("y1", Axis::Y, "0")?);
    let to = Point::new(at("x2", Axis::X, "100%")?, at("y2", Axis::Y, "0")?);
    let across = Vec2::new(from.y - to.y, to.x - from.x);
    // Lines of one colour stay lines; how the gradient goes is at right angles to them in the root.
    let line = to_root * (from + across) - to_root * from;
    let (start, whole) = (to_root * from, to_root * to - to_root * from);
    let mut way = Vector::xy(line.y, -line.x).unit_or_zero();
    let mut length = way.dot(Vector::xy(whole.x, whole.y));
    if length < 0.0 {
        (way, length) = (-way, -length);
    }
    let holder = chain.iter().find(|n| n.children().any(|c| c.tag_name().name() == "stop"))?;
    let stops: Rc<[Stop]> = stops(source, *holder, leaf.viewport).into();
    (length > source.limits.extent && !stops.is_empty()).then(|| Linear {
        start: Vector::xy(start.x, start.y),
        way,
        length,
        stops,
    })
}

/// A coordinate in user space, or as a share of the box of what is painted.
fn coordinate(text: &str, axis: Axis, viewport: Option<Viewport>) -> Option<f64> {
    let text = text.trim();
    match viewport {
        Some(viewport) => Some(viewport.resolve(text.parse::<Length>().ok()?, axis, 16.0)),
        None => match text.strip_suffix('%') {
            Some(percent) => percent.trim().parse::<f64>().ok().map(|p| p / 100.0),
            None => text.parse().ok(),
        },
    }
    .filter(|v| v.is_finite())
}

/// A gradient and those that it takes what it lacks from, in turn.
fn chain<'a>(source: &Source<'a>, node: Xml<'a, 'a>) -> Vec<Xml<'a, 'a>> {
    let mut chain = vec![node];
    while let Some(next) =
        chain.last().and_then(|last| last.attribute("href").or(last.attribute(XLINK)).and(source.target(*last)))
    {
        if chain.len() > CHAIN || chain.contains(&next) {
            break;
        }
        chain.push(next);
    }
    chain
}

/// The older attribute that refers to another gradient.
const XLINK: (&str, &str) = ("http://www.w3.org/1999/xlink", "href");

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use crate::svg::{LargeFills, ReadOptions, read_exemplar};

    fn bands(gradient: &str, step: f64) -> String {
        let rect = |k: u32| {
            let y = 5.0 + step * f64::from(k);
            format!("<rect x='-5' y='{y}' width='110' height='12' fill='url(#g)'/>")
        };
        let rects: String = (0..5).map(rect).collect();
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'><linearGradient id='g' {gradient}>\
             <stop offset='0' stop-color='#fff'/><stop offset='1' stop-color='#36c'/></linearGradient>{rects}</svg>"
        )
    }

    fn read(text: &str) -> arabesque_core::Result<crate::svg::Drawing> {
        read_exemplar(text, &ReadOptions { large_fills: LargeFills::Areas, ..ReadOptions::new("g.svg") })
    }

    #[test]
    fn one_gradient_paints_bands_at_even_distances() {
        let found = read(&bands("x2='0' y2='1'", 20.0)).unwrap();
        assert_eq!((found.exemplar.areas.len(), found.exemplar.styles.len()), (5, 1));
        assert_eq!(found.definitions.matches("spreadMethod=\"repeat\"").count(), 1);
        assert!(
            found.definitions.contains("y1=\"5\"") && found.definitions.contains("y2=\"25\""),
            "{}",
            found.definitions
        );
    }

    #[test]
    fn a_gradient_along_the_bands_is_refused() {
        let along = read(&bands("gradientUnits='userSpaceOnUse' x2='100'", 20.0)).unwrap_err().to_string();
        assert!(along.contains("gradients"), "{along}");
    }
}
