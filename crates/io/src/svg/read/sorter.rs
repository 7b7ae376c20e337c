//! What becomes of the things in a file of which some stay and some are made anew.

use arabesque_core::{Bounds, Decimals, Drawn, Outline, Path, Placement, Result};

use crate::svg::{
    drawing::Stroke,
    layers::stacks::{Stack, nearness, paints_of, stacks},
    options::Dashes,
    parse::definitions::Definitions,
    read::matcher::Matcher,
    shape::{
        cut_path::{Side, cut},
        painted_area::Painter,
    },
    understand::{
        classes,
        curves::{Curves, Gatherer},
        item::{Item, Kind},
    },
    write::text::outline_data,
};

/// Work for each corner of an area that a stroke may cross.
const LOOK: u64 = 10;

/// What becomes of an item.
pub(crate) enum Sorted {
    /// It lies where everything is refilled.
    Removed,
    /// It is an element of the exemplar.
    Element(Placement<2>),
    /// It is strokes in paints of the exemplar's styles, `paint` the first of them; `drawn` has those of which it is the
    /// lowest paint, `cut` is their markup where they are not whole, and `is_touched` says whether what is refilled
    /// takes something away from them.
    Strokes { drawn: Vec<Drawn<2>>, paint: Option<(usize, usize)>, cut: Option<String>, is_touched: bool },
    /// It is nothing that the exemplar knows; `is_touched` as for strokes.
    Obstacle { outline: Outline<2>, is_touched: bool },
}

/// What is left of the strokes of an item.
#[derive(Default)]
struct Remains {
    parts: Vec<Part>,
    /// What draws it where it is not whole.
    cut: Option<String>,
    is_touched: bool,
}

/// A line that is left, with its paint.
struct Part {
    path: Path<2>,
    width: f64,
    stroke: Stroke,
}

/// What the exemplar knows of a part: the strokes of which it is the lowest paint, and which paint of which style it is.
#[derive(Clone, Default)]
struct Known {
    drawn: Vec<Drawn<2>>,
    paint: (usize, usize),
}

/// Decides what becomes of items.
pub(crate) struct Sorter<'a, 's, 'i, 'd> {
    pub(crate) painter: &'i Painter<'a, 's>,
    pub(crate) matcher: Matcher<'d>,
    /// What is refilled; nothing when everything stays.
    pub(crate) area: Option<&'i Outline<2>>,
    /// Box around everything.
    pub(crate) window: Bounds<2>,
}

impl<'a, 's> Sorter<'a, 's, '_, '_> {
    /// What becomes of all items of a drawing: strokes on one geometry are looked at together.
    pub(crate) fn sort(&self, items: &[Item], definitions: &mut Definitions<'a, 's>) -> Result<Vec<Sorted>> {
        let mut remains = Vec::with_capacity(items.len());
        for item in items {
            remains.push(if self.is_strokes(item)? { Some(self.remains(item, definitions)?) } else { None });
        }
        let mut known = self.known(items, &remains)?.into_iter();
        let mut sorted = Vec::with_capacity(items.len());
        for (item, remains) in items.iter().zip(remains) {
            sorted.push(match remains {
                None if item.kind == Kind::Area => self.area(item, definitions)?,
                None => self.element(item)?,
                Some(Remains { parts, .. }) if parts.is_empty() => Sorted::Removed,
                Some(Remains { parts, cut, is_touched }) => {
                    let known: Option<Vec<Known>> = known.by_ref().take(parts.len()).collect();
                    match known {
                        Some(known) => {
                            let paint = known.first().map(|k| k.paint);
                            let drawn = known.into_iter().flat_map(|k| k.drawn).collect();
                            Sorted::Strokes { drawn, paint, cut, is_touched }
                        }
                        None => Sorted::Obstacle { outline: self.outside(item)?, is_touched },
                    }
                }
            });
        }
        Ok(sorted)
    }

    /// Markup of what is left of an item; `None` where nothing is, and inside of it where it is whole.
    pub(crate) fn rest(&self, item: &Item, definitions: &mut Definitions<'a, 's>) -> Result<Option<Option<String>>> {
        if item.kind == Kind::Area {
            return Ok(match self.area(item, definitions)? {
                Sorted::Strokes { cut, .. } => Some(cut),
                _ => None,
            });
        }
        if self.is_strokes(item)? {
            let remains = self.remains(item, definitions)?;
            return Ok((!remains.parts.is_empty()).then_some(remains.cut));
        }
        Ok((!self.is_refilled(item)).then_some(None))
    }

    /// What becomes of an area: its part outside of what is refilled stays.
    fn area(&self, item: &Item, definitions: &mut Definitions<'a, 's>) -> Result<Sorted> {
        let budget = self.painter.source.budget;
        let mut gatherer = Gatherer::new(self.painter, definitions, self.window, Dashes::OfStroke);
        gatherer.add(item)?;
        let Curves { areas, fills, .. } = gatherer.finish()?;
        let (mut markup, mut is_touched) = (String::new(), false);
        let decimals = Decimals::for_extent(self.window.size()[0].max(self.window.size()[1])).plus(1);
        for (area, fill) in areas.iter().zip(&fills) {
            let rest = match self.area {
                Some(refilled) if area.outline.bounds().intersects(&refilled.bounds()) => {
                    is_touched |= area.outline.try_intersection(refilled, budget)?.area() > 0.0;
                    area.outline.try_difference(refilled, budget)?
                }
                _ => area.outline.clone(),
            };
            if !rest.rings.is_empty() {
                let data = outline_data(&rest, decimals);
                markup.push_str(&format!("<path d=\"{data}\" fill-rule=\"evenodd\"{}{}/>", fill.paint, fill.effects));
            }
        }
        if markup.is_empty() {
            return Ok(Sorted::Removed);
        }
        let own = self.matcher.drawing.fills.iter().zip(&self.matcher.drawing.exemplar.areas);
        let key = fills.first().map(Stroke::key);
        let paint = own.into_iter().find(|(fill, _)| Some(fill.key()) == key).map(|(_, area)| (area.style, 0));
        Ok(Sorted::Strokes { drawn: Vec::new(), paint, cut: is_touched.then_some(markup), is_touched })
    }

    fn is_strokes(&self, item: &Item) -> Result<bool> {
        if item.kind == Kind::Area {
            return Ok(false);
        }
        if self.matcher.drawing.exemplar.curves.is_empty() {
            return Ok(false);
        }
        if item.kind == Kind::Curve {
            return Ok(true);
        }
        // A few strokes of a net look like things of their own.
        Ok(item.reason.is_loose() && !self.is_refilled(item) && self.placement(item)?.is_none())
    }

    fn placement(&self, item: &Item) -> Result<Option<Placement<2>>> {
        let names = classes::names_of(&item.meta, &self.painter.source.sheet);
        self.matcher.place(item, &names, self.painter.source.budget)
    }

    fn is_refilled(&self, item: &Item) -> bool {
        let centre = item.outline.centroid().unwrap_or_else(|| item.outline.bounds().centre());
        self.area.is_some_and(|area| area.contains(centre))
    }

    fn element(&self, item: &Item) -> Result<Sorted> {
        if self.is_refilled(item) {
            return Ok(Sorted::Removed);
        }
        Ok(match self.placement(item)? {
            Some(placement) => Sorted::Element(placement),
            None => Sorted::Obstacle { outline: item.outline.clone(), is_touched: false },
        })
    }

    /// The painted area of an item without what is refilled.
    fn outside(&self, item: &Item) -> Result<Outline<2>> {
        match self.area {
            Some(area) => item.outline.try_difference(area, self.painter.source.budget),
            None => Ok(item.outline.clone()),
        }
    }

    fn remains(&self, item: &Item, definitions: &mut Definitions<'a, 's>) -> Result<Remains> {
        let mut gatherer = Gatherer::new(self.painter, definitions, self.window, Dashes::OfStroke);
        gatherer.add(item)?;
        let Curves { curves, strokes, .. } = gatherer.finish()?;
        // A clip takes something away as well: then the line alone is not what the file shows.
        let (mut is_touched, mut rest) = (false, Vec::new());
        for (curve, stroke) in curves.iter().zip(strokes) {
            self.painter.source.budget.spend(LOOK * self.area.map_or(0, |area| area.points().count()) as u64)?;
            let parts = self.area.and_then(|area| cut(&curve.path, area, Side::Outside));
            is_touched |= parts.is_some();
            let parts = parts.unwrap_or_else(|| vec![curve.path.clone()]);
            rest.extend(parts.into_iter().map(|path| Part { path, width: curve.width, stroke: stroke.clone() }));
        }
        let decimals = Decimals::for_extent(self.window.size()[0].max(self.window.size()[1]));
        let markup = rest.iter().map(|part| part.stroke.markup(&part.path, decimals)).collect::<String>();
        let markup =
            (is_touched || item.is_cut).then(|| if rest.len() == 1 { markup } else { format!("<g>{markup}</g>") });
        Ok(Remains { parts: rest, cut: markup, is_touched })
    }

    /// What the exemplar knows of all parts, in their order.
    fn known(&self, items: &[Item], remains: &[Option<Remains>]) -> Result<Vec<Option<Known>>> {
        let of_items = items.iter().zip(remains);
        let parts: Vec<(&Item, &Part)> =
            of_items.flat_map(|(item, r)| r.iter().flat_map(move |r| r.parts.iter().map(move |p| (item, p)))).collect();
        let lines = parts.iter().map(|(_, part)| part.path.clone());
        let exemplar = &self.matcher.drawing.exemplar;
        let stacks = if self.matcher.drawing.strokes.iter().any(|paints| paints.len() > 1) {
            let strokes: Vec<Stroke> = parts.iter().map(|(_, part)| part.stroke.clone()).collect();
            let near = nearness(&self.window, exemplar.curves.iter().map(|c| &c.width));
            stacks(lines.zip(paints_of(&strokes)).collect(), near, self.painter.source.budget)?
        } else {
            lines.enumerate().map(|(k, path)| Stack::of_one(path, k)).collect()
        };
        // A second line in the same paint is as good as the first.
        let mut all: Vec<Option<Known>> = vec![Some(Known::default()); parts.len()];
        for Stack { path, members, .. } in stacks {
            let paints: Vec<(&Stroke, f64)> = members.iter().map(|&m| (&parts[m].1.stroke, parts[m].1.width)).collect();
            let meta = members.first().map(|&m| &*parts[m].0.meta);
            let mut drawn = meta.and_then(|meta| self.matcher.stroke(&path, &paints, meta));
            let style = drawn.as_ref().map(|d| exemplar.curves[d.source].style);
            for (paint, &m) in members.iter().enumerate() {
                match (style, &mut all[m]) {
                    (None, known) => *known = None,
                    (Some(style), Some(known)) => {
                        known.drawn.extend(drawn.take());
                        known.paint = (style, paint);
                    }
                    (Some(_), None) => {}
                }
            }
        }
        Ok(all)
    }
}
