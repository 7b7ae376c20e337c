//! Where in a file of which a part was refilled the new is drawn: under what stays and belongs above it.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Domain, GridIndex, Placement, Result};

use crate::svg::{drawing::Anchored, write::sheet::Sheet};

/// Work for each element, and for each pair of them that lie near each other.
const WORK: (u64, u64) = (500, 20);

/// Places in the head of the file, as numbers of bytes from its start.
#[derive(Debug, Default)]
pub(crate) struct Between {
    /// For elements, by their numbers; where there is none, at the end.
    elements: BTreeMap<usize, usize>,
    /// For strokes and areas, by style and paint.
    strokes: BTreeMap<(usize, usize), usize>,
}

impl Between {
    /// The places for what a sheet holds.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(sheet: &Sheet<'_>) -> Result<Self> {
        let Some(host) = sheet.host else { return Ok(Self::default()) };
        let (mut strokes, mut before) = (BTreeMap::new(), BTreeMap::new());
        for anchor in &host.anchors {
            match anchor.what {
                // Strokes of a paint come after the last of their kind.
                Anchored::Strokes(style, paint) => {
                    strokes.insert((style, paint), anchor.range.end);
                }
                Anchored::Element(number) => {
                    before.insert(number, anchor.range.start);
                }
            }
        }
        Ok(Self { elements: elements(sheet, &before)?, strokes })
    }

    /// Where an element is drawn.
    pub(crate) fn of_element(&self, index: usize) -> Option<usize> {
        self.elements.get(&index).copied()
    }

    /// Where strokes of a paint, or areas, are drawn.
    pub(crate) fn of_strokes(&self, style: usize, paint: usize) -> Option<usize> {
        self.strokes.get(&(style, paint)).copied()
    }
}

/// For new elements that lie under something that stays, or under a new one that does, where the first of that stands.
fn elements(sheet: &Sheet<'_>, before: &BTreeMap<usize, usize>) -> Result<BTreeMap<usize, usize>> {
    let extent = |p: &Placement<2>| {
        let outline = &sheet.drawing.exemplar.elements[p.source].outline;
        Bounds::around(outline.points().map(|q| p.transform.apply(q)))
    };
    let boxes: Vec<Bounds<2>> = sheet.placements.iter().map(extent).collect();
    let sized = || boxes.iter().filter(|b| !b.is_empty());
    let reach = sized().map(|b| b.size().norm()).fold(0.0, f64::max);
    let mut places = BTreeMap::new();
    if reach <= 0.0 || before.is_empty() {
        return Ok(places);
    }
    let centres: Vec<_> =
        boxes.iter().map(|b| if b.is_empty() { sheet.page.view.centre() } else { b.centre() }).collect();
    let all = Bounds::around(centres.iter().copied()).grown(reach);
    let index = GridIndex::new(&centres, reach, &Domain::Box(all));
    // From top to bottom: what is drawn above it is placed already.
    for (k, placement) in sheet.placements.iter().enumerate().rev() {
        if placement.frozen.is_some() || boxes[k].is_empty() {
            continue;
        }
        let mut first: Option<usize> = None;
        let looked = index.within(centres[k], reach, |other, _| {
            let meets = boxes[other].intersects(&boxes[k].grown(-1e-6 * reach));
            if other > k && meets {
                let place = match sheet.placements[other].frozen {
                    Some(number) => before.get(&number),
                    None => places.get(&other),
                };
                first = first.into_iter().chain(place.copied()).min();
            }
        });
        sheet.budget.spend(WORK.0 + WORK.1 * looked)?;
        if let Some(place) = first {
            places.insert(k, place);
        }
    }
    Ok(places)
}
