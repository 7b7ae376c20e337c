//! Changes put into the text of a result.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write as _,
};

use arabesque_core::{Bounds, Budget, Error, Result, Similarity, Vector};

use super::{
    open::{Drawn, SvgElements, transform_of},
    paint::{check_paint, repainted},
};
use crate::{
    placed::{
        digits::digits,
        layout::{Changes, Item, Layout, PER_BYTE, PER_ITEM, PlacedFile, Replaced},
        splice::Splices,
    },
    svg::{copies::shifts, write::document::recipe_element},
};

impl PlacedFile<2> for SvgElements {
    fn layout(&self) -> &Layout<2> {
        &self.layout
    }

    fn rewritten(&self, changes: &Changes<2>, recipe: Option<&str>, budget: &Budget) -> Result<Vec<u8>> {
        let budget = budget.stage("writing elements");
        budget.spend(PER_BYTE.saturating_mul(self.text.len() as u64))?;
        let mut rewriting = Rewriting {
            file: self,
            numbers: self.layout.numbers(),
            splices: Splices::default(),
            fresh: BTreeMap::new(),
            shown: BTreeMap::new(),
            taken: self.definitions.keys().cloned().collect(),
            budget: &budget,
        };
        for (number, item) in self.layout.items.iter().enumerate() {
            if changes.removed.contains(&item.id) {
                for line in &self.drawn[number].lines {
                    rewriting.splices.put(line.range.clone(), "");
                }
            } else if let Some(replaced) = changes.replaced.get(&item.id) {
                rewriting.replace(number, replaced)?;
            } else {
                rewriting.show(self.drawn[number].shows.as_deref());
            }
        }
        let ends = self.ends();
        for (id, inserted) in &changes.inserted {
            rewriting.insert(*id, inserted, &ends)?;
        }
        rewriting.define();
        if let (Some(range), Some(recipe)) = (&self.recipe, recipe) {
            rewriting.splices.put(range.clone(), recipe_element(recipe, ""));
        }
        Ok(rewriting.splices.apply(&self.text).into_bytes())
    }
}

impl SvgElements {
    /// Where the last element of each class ends.
    fn ends(&self) -> Vec<usize> {
        let mut ends = vec![0; self.layout.classes.len()];
        for (item, drawn) in self.layout.items.iter().zip(&self.drawn) {
            let end = drawn.lines.iter().map(|line| line.range.end).max().unwrap_or(0);
            ends[item.class] = end.max(ends[item.class]);
        }
        ends
    }
}

struct Rewriting<'a> {
    file: &'a SvgElements,
    /// Index of each element by its number.
    numbers: BTreeMap<usize, usize>,
    splices: Splices,
    /// Definitions that are new: their ids, by the one that they are made of and their content.
    fresh: BTreeMap<(String, String), String>,
    /// How often each definition is shown in the end.
    shown: BTreeMap<String, usize>,
    /// Ids of definitions that there are.
    taken: BTreeSet<String>,
    budget: &'a Budget,
}

impl<'a> Rewriting<'a> {
    fn show(&mut self, definition: Option<&str>) {
        if let Some(definition) = definition {
            *self.shown.entry(definition.to_owned()).or_insert(0) += 1;
        }
    }

    fn base(&self, replaced: &Replaced<2>) -> Result<(usize, &'a Item<2>, &'a Drawn)> {
        let number = self.numbers.get(&replaced.base).copied().ok_or_else(|| {
            Error::input("changes", format!("no element {}", replaced.base), "name an element of the file")
        })?;
        Ok((number, &self.file.layout.items[number], &self.file.drawn[number]))
    }

    fn replace(&mut self, number: usize, replaced: &Replaced<2>) -> Result<()> {
        let (base, _, _) = self.base(replaced)?;
        let own = &self.file.drawn[number];
        let texts = self.texts(self.file.layout.items[number].id, replaced, (base == number).then_some(own))?;
        // What is apart in the order of drawing stays where it is as far as it is still there.
        for (k, line) in own.lines.iter().enumerate() {
            let mut text = texts.get(k).cloned().unwrap_or_default();
            if k + 1 == own.lines.len() {
                text.extend(texts.iter().skip(k + 1).map(String::as_str));
            }
            self.splices.put(line.range.clone(), text);
        }
        Ok(())
    }

    fn insert(&mut self, id: usize, inserted: &Replaced<2>, ends: &[usize]) -> Result<()> {
        let (_, item, _) = self.base(inserted)?;
        let end = ends[item.class];
        let texts = self.texts(id, inserted, None)?;
        self.splices.put(end..end, texts.concat());
        Ok(())
    }

    /// The text of an element, once for each copy of it that is seen. `own` is how it is written already.
    fn texts(&mut self, id: usize, replaced: &Replaced<2>, own: Option<&Drawn>) -> Result<Vec<String>> {
        self.budget.spend(PER_ITEM)?;
        replaced.paint.iter().try_for_each(check_paint)?;
        let (_, item, drawn) = self.base(replaced)?;
        let drawn = own.unwrap_or(drawn);
        let text = &self.file.text;
        let class = Some(self.file.layout.classes[item.class].clone());
        let source = item.source.map(|n| n.to_string());
        let mut common = vec![("data-arabesque-source", source), ("data-arabesque-class", class)];
        if let Some(opacity) = replaced.paint.iter().rev().find(|paint| paint.property == "opacity") {
            let is_plain = opacity.value.trim().parse() == Ok(1.0_f64);
            common.push(("opacity", (!is_plain).then(|| opacity.value.clone())));
        }
        if own.is_none() {
            common.push(("data-arabesque-kept", None));
        }
        let Some(definition) = &drawn.shows else {
            return self.in_place(id, replaced, drawn, &common);
        };
        let shows = self.painted(definition, replaced)?;
        self.show(Some(&shows));
        let place = replaced.motion.after(&item.place);
        let shifts = self.seen(definition, &place)?;
        let mut texts = Vec::with_capacity(shifts.len());
        for (copy, shift) in shifts.into_iter().enumerate() {
            let line = drawn.lines.get(copy).unwrap_or(&drawn.lines[0]);
            let link = if line.raw("href", text).is_some() { "href" } else { "xlink:href" };
            let mut values = common.clone();
            values.push(("id", Some(self.id(id, copy))));
            values.push((link, Some(format!("#{shows}"))));
            values.push(("transform", Some(self.transform(&place, shift))));
            texts.push(ended(line.with(text, &values, None)));
        }
        Ok(texts)
    }

    /// The texts of an element that is drawn where it is: it gets a transform of its own.
    fn in_place(
        &self,
        id: usize,
        replaced: &Replaced<2>,
        drawn: &Drawn,
        common: &[(&str, Option<String>)],
    ) -> Result<Vec<String>> {
        let text = &self.file.text;
        let mut texts = Vec::with_capacity(drawn.lines.len());
        for (copy, line) in drawn.lines.iter().enumerate() {
            let raw = line.raw("transform", text);
            let before = transform_of(raw).unwrap_or_else(Similarity::identity);
            let apart = drawn.apart.get(copy).copied().unwrap_or(Vector::ZERO);
            let there = Similarity::shift(apart).after(&replaced.motion).after(&Similarity::shift(-apart));
            let after = there.after(&before);
            let content = &text[line.content.clone()];
            let painted = repainted(content, &replaced.paint)?;
            let mut values = common.to_vec();
            values.push(("id", Some(self.id(id, copy))));
            let transform = self.transform(&after, Vector::ZERO);
            values.push(("transform", Some(transform).filter(|transform| transform != "translate(0 0)")));
            texts.push(ended(line.with(text, &values, (painted != content).then_some(painted))));
        }
        Ok(texts)
    }

    fn id(&self, id: usize, copy: usize) -> String {
        match copy {
            0 => format!("{}-{id}", self.file.prefix),
            _ => format!("{}-{id}-{copy}", self.file.prefix),
        }
    }

    /// The shifts under which an element is seen: on a tile across its edges too.
    fn seen(&self, definition: &str, place: &Similarity<2>) -> Result<Vec<Vector<2>>> {
        let outline = self.file.definitions.get(definition).map(|definition| &definition.outline);
        let (true, Some(outline)) = (self.file.layout.is_tile, outline) else { return Ok(vec![Vector::ZERO]) };
        let tile = &self.file.layout.frame;
        let bounds = Bounds::around(outline.points().map(|p| place.apply(p)));
        let size = tile.size();
        let copies = (0..2).map(|k| (bounds.size()[k].max(0.0) / size[k] + 2.0).ceil()).product::<f64>();
        let limit = self.budget.limits().elements;
        self.budget.within_expected("copies of one element on the tile", copies, ("elements", limit))?;
        self.budget.spend((copies as u64).saturating_mul(PER_ITEM))?;
        Ok(shifts(&bounds, tile))
    }

    /// The definition to show: the same, or one that is painted as wanted.
    fn painted(&mut self, definition: &str, replaced: &Replaced<2>) -> Result<String> {
        let Some(known) = self.file.definitions.get(definition) else { return Ok(definition.to_owned()) };
        let content = &self.file.text[known.line.content.clone()];
        if replaced.paint.iter().all(|paint| paint.property == "opacity") {
            return Ok(definition.to_owned());
        }
        self.budget.spend(PER_BYTE.saturating_mul(content.len() as u64))?;
        let painted = repainted(content, &replaced.paint)?;
        let Some(source) = known.source else { return Ok(definition.to_owned()) };
        let first = format!("{}-element-{source}", self.file.prefix);
        // One that looks like it may be there already: the original before all.
        let alike = self.file.definitions.iter().find(|(id, other)| {
            (**id == first || id.strip_prefix(&first).is_some_and(|rest| rest.starts_with('-')))
                && self.file.text[other.line.content.clone()] == painted
        });
        if let Some((id, _)) = alike {
            return Ok(id.clone());
        }
        let key = (first.clone(), painted);
        if let Some(id) = self.fresh.get(&key) {
            return Ok(id.clone());
        }
        let mut number = 1_usize;
        while self.taken.contains(&format!("{first}-{number}")) {
            number += 1;
        }
        let id = format!("{first}-{number}");
        self.taken.insert(id.clone());
        self.fresh.insert(key, id.clone());
        Ok(id)
    }

    /// Writes new definitions behind those that they are made of, and removes those of other paint that nothing shows any more.
    fn define(&mut self) {
        let mut new: BTreeMap<String, Vec<(&String, &String)>> = BTreeMap::new();
        for ((first, content), id) in &self.fresh {
            new.entry(first.clone()).or_default().push((id, content));
        }
        for (first, list) in new {
            let Some(known) = self.file.definitions.get(&first) else { continue };
            let mut text = String::new();
            for (id, content) in list {
                let _ = writeln!(text, "<g id=\"{id}\">{content}</g>");
            }
            self.splices.put(known.line.range.end..known.line.range.end, text);
        }
        for (id, definition) in &self.file.definitions {
            let is_first = definition.source.is_some_and(|n| *id == format!("{}-element-{n}", self.file.prefix));
            if !is_first && !self.shown.contains_key(id) {
                self.splices.put(definition.line.range.clone(), "");
            }
        }
    }

    /// A transform as [`crate::svg::write_svg`] has it, with digits that come back.
    fn transform(&self, place: &Similarity<2>, shift: Vector<2>) -> String {
        let size = self.file.layout.frame.size();
        let extent = size[0].max(size[1]);
        let (r, s) = (place.rotation.0, place.scale);
        let at = place.translation + shift;
        let [e, f] = [at[0], at[1]].map(|v| digits(v, extent));
        let linear = [r[0][0], r[1][0], r[0][1], r[1][1]].map(|v| digits(v * s, extent.min(1.0)));
        if linear == ["1", "0", "0", "1"] {
            return format!("translate({e} {f})");
        }
        format!("matrix({} {e} {f})", linear.join(" "))
    }
}

/// With the end of the line.
fn ended(mut text: String) -> String {
    if !text.ends_with('\n') {
        text.push('\n');
    }
    text
}
