//! The layer of a result that holds what was made: placed elements and strokes.

use std::{collections::BTreeMap, fmt::Write as _};

use arabesque_core::{Border, Bounds, Domain, Drawn, Outline, Placement, Result, Vector, Warning};

use crate::{
    svg::{
        drawing::{KeptStrokes, Layer},
        write::{
            areas::areas,
            curves::{StrokeLayer, by_style, curves},
            flat::{Flattener, Warp},
            hosted::between::Between,
            sheet::Style,
            text::{matrix, rectangle},
            writer::Writer,
        },
    },
    text::xml::escape,
};

/// Work for writing one element.
const PER_ELEMENT: u64 = 3000;

/// The layer of what was made, which is closed where something kept comes between.
#[derive(Default)]
struct Group {
    is_open: bool,
    opened: usize,
    kept: usize,
}

impl Group {
    /// What the id of the next group of kept strokes ends in.
    fn next_kept(&mut self) -> String {
        self.kept += 1;
        if self.kept == 1 { String::new() } else { format!("-{}", self.kept) }
    }
}

/// Whether elements are below all strokes.
fn elements_first(layers: &[Layer]) -> bool {
    layers.len() > 1 && matches!(layers.first(), Some(Layer::Elements(_)))
}

/// Whether strokes have one paint each, and all elements are above or below all of them.
fn is_plain(layers: &[Layer]) -> bool {
    let is_elements = |layer: &Layer| matches!(layer, Layer::Elements(_));
    let last = layers.len().saturating_sub(1);
    let inner = layers.get(1..last).unwrap_or_default();
    let simple = |layer: &Layer| matches!(layer, Layer::Elements(_) | Layer::Strokes { paint: 0, .. });
    layers.iter().all(simple)
        && !inner.iter().any(is_elements)
        && layers.iter().filter(|layer| is_elements(layer)).count() < 2
}

/// An element as it is drawn: a placement, which copy of it, and where that is moved.
struct Copy {
    index: usize,
    copy: usize,
    shift: Vector<2>,
}

impl<'a> Writer<'a> {
    /// What was made, layer by layer, and what is kept of strokes in the layers where it belongs. In a file of which a
    /// part was refilled, what belongs under something that stays goes there.
    pub(crate) fn output(&mut self) -> Result<()> {
        let sheet = self.sheet;
        let layers = &sheet.drawing.layers;
        let cut = self.cut_outline();
        let clip = sheet.shape.map(|_| format!("{}-domain", self.prefix));
        let flattener = Flattener::new(sheet.drawing, cut.as_ref(), clip.as_deref(), self.decimals, sheet.budget)?;
        let by_style = by_style(sheet);
        let elements = self.by_layer()?;
        let mut kept = self.kept_by_layer();
        let between = Between::new(sheet)?;
        let (mut clipped, mut group) = (0, Group::default());
        if kept.is_none() && !elements_first(layers) {
            self.kept_strokes();
        }
        for (k, layer) in layers.iter().enumerate() {
            match layer {
                &Layer::Strokes { style, paint } => {
                    if let Some(strokes) = kept.as_mut().and_then(|kept| kept.remove(&k)) {
                        self.close(&mut group);
                        self.kept_group(&strokes, &group.next_kept());
                    }
                    let place = between.of_strokes(style, paint);
                    self.go_to(place, &mut group);
                    if paint == 0 && sheet.areas.iter().any(|a| sheet.drawing.exemplar.areas[a.source].style == style) {
                        self.open(&mut group);
                        let text = areas(sheet, style, &self.prefix, self.decimals.plus(1));
                        self.out.push_str(&text);
                    }
                    if let Some(members) = by_style.get(&style) {
                        self.open(&mut group);
                        self.curves(StrokeLayer { style, paint }, members);
                    }
                }
                Layer::Elements(_) => {
                    for element in &elements[k] {
                        self.go_to(between.of_element(element.index), &mut group);
                        self.open(&mut group);
                        clipped += self.element(&flattener, element)?;
                    }
                }
            }
        }
        self.go_to(None, &mut group);
        if group.opened == 0 {
            self.open(&mut group);
        }
        self.close(&mut group);
        if kept.is_none() && elements_first(layers) {
            self.kept_strokes();
        }
        if clipped > 0 {
            self.warnings.push(Warning::new(
                format!(
                    "{clipped} pieces (pictures, text, linked parts, or pieces with gradients, clips or filters) \
                     were not flattened"
                ),
                "convert them to plain paths in the exemplar where the receiving machine needs that",
            ));
        }
        Ok(())
    }

    /// Goes on writing at a place in the head of the file in which a part was refilled, or at its end.
    fn go_to(&mut self, place: Option<usize>, group: &mut Group) {
        if place == self.place {
            return;
        }
        self.close(group);
        let written = self.out.split_off(self.written_from);
        match self.place {
            Some(place) => self.inserted.push((place, written)),
            None => self.at_end.push_str(&written),
        }
        self.place = place;
    }

    /// Begins the layer of what was made, unless it is open.
    fn open(&mut self, group: &mut Group) {
        if std::mem::replace(&mut group.is_open, true) {
            return;
        }
        group.opened += 1;
        let suffix = if group.opened == 1 { String::new() } else { format!("-{}", group.opened) };
        let _ = write!(
            self.out,
            "<g inkscape:groupmode=\"layer\" inkscape:label=\"Arabesque output\" id=\"{}-output{suffix}\"",
            self.prefix
        );
        if self.clips_by_reference() {
            let _ = write!(self.out, " clip-path=\"url(#{}-domain)\"", self.prefix);
        }
        self.out.push_str(">\n");
    }

    /// Ends it, where it is open.
    fn close(&mut self, group: &mut Group) {
        if std::mem::take(&mut group.is_open) {
            self.out.push_str("</g>\n");
        }
    }

    fn curves(&mut self, layer: StrokeLayer, members: &[(usize, &Drawn<2>)]) {
        let (sheet, decimals) = (self.sheet, self.decimals.minus(1));
        let text = curves(sheet, layer, members, &self.prefix, decimals, &|bounds| self.shifts(bounds));
        self.out.push_str(&text);
    }

    /// The kept strokes by the number of the layer to which they belong, where they cannot all be drawn before or after
    /// everything else.
    fn kept_by_layer(&self) -> Option<BTreeMap<usize, Vec<&'a KeptStrokes>>> {
        let layers = &self.sheet.drawing.layers;
        if is_plain(layers) {
            return None;
        }
        let place = |layer: &Layer| match *layer {
            Layer::Strokes { style, paint } => Some((style, paint)),
            Layer::Elements(_) => None,
        };
        let places = layers.iter().enumerate().filter_map(|(k, layer)| Some((place(layer)?, k)));
        let places: BTreeMap<(usize, usize), usize> = places.collect();
        let mut kept: BTreeMap<usize, Vec<&KeptStrokes>> = BTreeMap::new();
        let first = places.values().min().copied().unwrap_or(0);
        for strokes in self.sheet.kept.iter().flat_map(|k| &k.curve_fragments) {
            let layer = strokes.paint.and_then(|paint| places.get(&paint).copied()).unwrap_or(first);
            kept.entry(layer).or_default().push(strokes);
        }
        Some(kept)
    }

    /// The elements of each layer, with their copies, from bottom to top.
    fn by_layer(&self) -> Result<Vec<Vec<Copy>>> {
        let (sheet, exemplar) = (self.sheet, &self.sheet.drawing.exemplar);
        let mut layer_of: Vec<Option<usize>> = vec![None; exemplar.classes.len()];
        for (k, layer) in sheet.drawing.layers.iter().enumerate() {
            let Layer::Elements(classes) = layer else { continue };
            for &class in classes {
                if let Some(layer) = layer_of.get_mut(class) {
                    *layer = Some(k);
                }
            }
        }
        let mut all = Vec::new();
        let is_new = |p: &Placement<2>| sheet.host.is_none() || p.frozen.is_none();
        for (index, placement) in sheet.placements.iter().enumerate().filter(|(_, p)| is_new(p)) {
            sheet.budget.spend(PER_ELEMENT)?;
            let copies = self.copies(placement).into_iter().enumerate();
            all.extend(copies.map(|(copy, shift)| Copy { index, copy, shift }));
        }
        self.sort(&mut all);
        let mut layers: Vec<Vec<Copy>> = sheet.drawing.layers.iter().map(|_| Vec::new()).collect();
        for copy in all {
            let class = exemplar.elements[sheet.placements[copy.index].source].class;
            if let Some(layer) = layer_of[class] {
                layers[layer].push(copy);
            }
        }
        Ok(layers)
    }

    /// Puts copies into the sequence of the sheet, if there is one; those that it does not name follow what they are
    /// copies of.
    fn sort(&self, copies: &mut [Copy]) {
        let (Domain::Torus(tile), false) = (self.sheet.domain, self.sheet.sequence.is_empty()) else { return };
        let size = tile.size();
        let ranks = self.sheet.sequence.iter().enumerate().map(|(rank, i)| ((i.placement, i.around), rank));
        let ranks: BTreeMap<(usize, [i32; 2]), usize> = ranks.collect();
        let rank = |copy: &Copy| {
            let around = [0, 1].map(|k| (copy.shift[k] / size[k]).round() as i32);
            ranks.get(&(copy.index, around)).or_else(|| ranks.get(&(copy.index, [0, 0]))).copied()
        };
        copies.sort_by_cached_key(|copy| (rank(copy), copy.index, copy.copy));
    }

    /// Writes one copy of one placement; returns how many of its pieces could not be flattened.
    fn element(&mut self, flattener: &Flattener<'_>, &Copy { index, copy, shift }: &Copy) -> Result<usize> {
        let id = match copy {
            0 => format!("{}-{index}", self.prefix),
            _ => format!("{}-{index}-{copy}", self.prefix),
        };
        let placement = &self.sheet.placements[index];
        let exemplar = &self.sheet.drawing.exemplar;
        let class = escape(&exemplar.classes[exemplar.elements[placement.source].class].name);
        let data = format!("data-arabesque-source=\"{}\" data-arabesque-class=\"{class}\"", placement.source);
        if let Some(markup) = self.kept_markup(placement) {
            let _ = writeln!(
                self.out,
                "<g id=\"{id}\" {data} data-arabesque-kept=\"true\"{}>{markup}</g>",
                self.shifted(shift)
            );
            return Ok(0);
        }
        let bent = self.is_bent(placement);
        if self.sheet.style == Style::Linked && !bent {
            let matrix = matrix(placement, shift, self.decimals);
            let _ = writeln!(
                self.out,
                "<use id=\"{id}\" href=\"#{}-element-{}\" transform=\"{matrix}\" {data}/>",
                self.prefix, placement.source
            );
            return Ok(0);
        }
        let bend = |p: Vector<2>| match self.sheet.bend {
            Some(bend) => bend(index, p) + shift,
            None => placement.transform.apply(p) + shift,
        };
        let mut moved = placement.transform;
        moved.translation += shift;
        let warp = if bent { Warp::Bent(&bend, moved) } else { Warp::Rigid(moved) };
        let flat = flattener.element(placement.source, &warp, self.sheet.style)?;
        if !flat.markup.is_empty() {
            let _ = writeln!(self.out, "<g id=\"{id}\" {data}>{}</g>", flat.markup);
        }
        Ok(flat.kept_whole)
    }

    fn clips_by_reference(&self) -> bool {
        self.sheet.border == Border::Clip && self.sheet.shape.is_some() && self.sheet.style == Style::Linked
    }

    /// What expanded elements are cut with: nothing on a torus, whose copies must stay whole to meet across the seam.
    fn cut_outline(&self) -> Option<Outline<2>> {
        if self.sheet.border != Border::Clip || self.sheet.style == Style::Linked {
            return None;
        }
        match (self.sheet.shape, self.sheet.domain) {
            (Some(shape), _) => Some(shape.clone()),
            (None, Domain::Box(b)) => Some(rectangle(b)),
            (None, _) => None,
        }
    }

    /// The shifts under which a placement is seen.
    fn copies(&self, placement: &Placement<2>) -> Vec<Vector<2>> {
        if !matches!(self.sheet.domain, Domain::Torus(_)) {
            return vec![Vector::ZERO];
        }
        let outline = &self.sheet.drawing.exemplar.elements[placement.source].outline;
        self.shifts(&Bounds::around(outline.points().map(|p| placement.transform.apply(p))))
    }
}
