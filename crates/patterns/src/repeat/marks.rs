//! Marks: what can be recognised again at another place of the exemplar.

use std::{collections::BTreeMap, sync::Arc};

use arabesque_core::{Bounds, Budget, Domain, Exemplar, GridIndex, Result, Vector};

use crate::repeat::{
    lines::{AT_FRAME, Feature, Lines},
    looks,
    unknown::{Unknown, may_be_cut},
};

/// Which elements count as one kind of mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kinds {
    /// Those that look alike as they lie.
    Looks,
    /// Those of one class.
    Classes,
    /// Those of one shape as they lie, painted in whatever: what repeats are the places for each shape.
    Shapes,
    /// All: what repeats are the places.
    Any,
}

impl Kinds {
    /// Whether what repeats are places, with something at each that may differ.
    pub(crate) fn is_of_places(self) -> bool {
        matches!(self, Self::Shapes | Self::Any)
    }
}

/// The point of an element that is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its centre of area.
    Centre,
    /// The centre of the box around it: where people align different things.
    Box,
}

/// Something that can be recognised.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mark {
    pub(crate) place: Vector<2>,
    pub(crate) kind: u32,
    /// What must lie in the frame for the mark to be seen.
    pub(crate) extent: Bounds<2>,
    /// The element that it is, `None` for a feature of a line.
    pub(crate) element: Option<u32>,
    /// Whether it is an element that may be cut at the frame: others may find it, it looks for none.
    pub(crate) is_context: bool,
}

/// The marks of an exemplar.
#[derive(Clone, Debug)]
pub(crate) struct Marks {
    pub(crate) all: Vec<Mark>,
    pub(crate) window: Bounds<2>,
    /// Mean distance of marks.
    pub(crate) unit: f64,
    /// Distance of the nearest mark of the same kind, that of half of the marks at most: less than the mean where they crowd.
    pub(crate) closest: f64,
    pub(crate) unknown: Arc<Unknown>,
    index: GridIndex<2>,
}

/// Whether there are several shapes, and some of them in several looks; `looks`: none where there are too many.
fn is_coarser(shapes: &[u32], looks: Option<&[u32]>) -> bool {
    let count = |numbers: &[u32]| numbers.iter().max().map_or(0, |most| *most as usize + 1);
    count(shapes) > 1 && looks.is_none_or(|looks| count(looks) > count(shapes))
}

/// Marks that are asked for the nearest of their kind.
const ASKED: usize = 100;

/// The median over some marks of the distance to the nearest of their kind; infinite where most are alone.
fn closest(all: &[Mark], budget: &Budget) -> Result<f64> {
    let asked = all.len().min(ASKED);
    budget.spend((asked * all.len()) as u64)?;
    let nearest = |i: usize| {
        let others = all.iter().enumerate().filter(|(j, other)| *j != i && other.kind == all[i].kind);
        others.map(|(_, other)| (other.place - all[i].place).norm2()).fold(f64::INFINITY, f64::min).sqrt()
    };
    let mut distances: Vec<f64> = (0..asked).map(|k| nearest(k * all.len() / asked)).collect();
    distances.sort_by(f64::total_cmp);
    Ok(distances.get(asked / 2).copied().unwrap_or(f64::INFINITY))
}

/// The place of an element.
pub(crate) fn place_of(element: &arabesque_core::Element<2>, anchor: Anchor) -> Vector<2> {
    match anchor {
        Anchor::Box if !element.outline.rings.is_empty() => element.outline.bounds().centre(),
        Anchor::Box | Anchor::Centre => element.centre,
    }
}

impl Marks {
    /// The marks of an exemplar; `None` where elements of too many looks are to be told apart, or shapes tell no more than looks
    /// or places do.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(
        exemplar: &Exemplar<2>,
        lines: &Lines,
        kinds: Kinds,
        anchor: Anchor,
        budget: &Budget,
    ) -> Result<Option<Self>> {
        let exact = looks::looks(exemplar, looks::ALIKE, budget)?;
        let looks = match kinds {
            Kinds::Looks => match &exact {
                Some(looks) => looks.clone(),
                None => return Ok(None),
            },
            Kinds::Shapes => match looks::shapes(exemplar, looks::ALIKE, budget)? {
                // Of one shape they are places, and of shapes that are told by looks already, these have been tried.
                Some(shapes) if is_coarser(&shapes, exact.as_deref()) => shapes,
                _ => return Ok(None),
            },
            Kinds::Classes => exemplar.elements.iter().map(|e| e.class as u32).collect(),
            Kinds::Any => vec![0; exemplar.elements.len()],
        };
        // With too many looks, each is taken for one of its own.
        let exact = exact.unwrap_or_else(|| (0..exemplar.elements.len() as u32).collect());
        let mut number: BTreeMap<(Option<u32>, Option<Feature>), u32> = BTreeMap::new();
        let mut kind = |key| {
            let next = number.len() as u32;
            *number.entry(key).or_insert(next)
        };
        let mut all = Vec::new();
        let window = exemplar.window;
        // Features nearer to the frame are not looked at.
        let from_frame = 1.01 * AT_FRAME * exemplar.view().side();
        let may_be_cut = may_be_cut(exemplar, &exact);
        for (e, (element, look)) in (0..).zip(exemplar.elements.iter().zip(looks)) {
            let place = place_of(element, anchor);
            let extent =
                if element.outline.rings.is_empty() { Bounds::new(place, place) } else { element.outline.bounds() };
            // What was cut at the frame looks like another thing.
            let is_context = may_be_cut[e as usize];
            all.push(Mark { place, kind: kind((Some(look), None)), extent, element: Some(e), is_context });
        }
        for &(place, feature) in &lines.features {
            let (kind, extent) = (kind((None, Some(feature))), Bounds::new(place, place).grown(from_frame));
            all.push(Mark { place, kind, extent, element: None, is_context: false });
        }
        let unit = (window.measure() / all.len().max(1) as f64).sqrt();
        let places: Vec<_> = all.iter().map(|mark| mark.place).collect();
        let index = GridIndex::new(&places, 0.25 * unit, &Domain::Box(window));
        let closest = closest(&all, budget)?;
        Ok(Some(Self { all, window, unit, closest, unknown: Arc::clone(&lines.unknown), index }))
    }

    /// The same marks, of which nothing is known beyond a box.
    pub(crate) fn seen_in(&self, window: Bounds<2>) -> Self {
        Self { window, ..self.clone() }
    }

    /// The mark of this kind that is nearest to a place, within a distance.
    pub(crate) fn find(&self, place: Vector<2>, kind: u32, within: f64) -> (Option<usize>, u64) {
        let mut best: Option<(usize, f64)> = None;
        let looked = self.index.within(place, within, |i, offset| {
            let apart = offset.norm2();
            let nearer = best.is_none_or(|(j, least)| (apart, i) < (least, j));
            if self.all[i].kind == kind && nearer {
                best = Some((i, apart));
            }
        });
        (best.map(|(i, _)| i), looked)
    }
}
