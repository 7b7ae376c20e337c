//! A result as JSON whose elements can be changed: everything else keeps its bytes.
//!
//! Placements are read in both forms: with `transform` and `centre`, as results of the plane and of points in space have them, and with
//! `translation`, `rotation` and `scale`, as scenes of meshes have them. Numbers of elements are their places in the list; once elements
//! are gone, `ids` says the numbers that are left.

use std::{collections::BTreeMap, ops::Range};

use arabesque_core::{Bounds, Budget, Error, Matrix, Result, Similarity, Vector};
use serde::Deserialize;
use serde_json::value::RawValue;

use crate::placed::{
    digits::json_digits,
    ids::{numbers, runs},
    layout::{Changes, Item, Layout, PER_BYTE, PER_ITEM, PlacedFile, Replaced},
    splice::Splices,
};

/// Memory of a byte that is read.
const GROWTH: usize = 8;

/// A result as JSON, with the elements in it.
#[derive(Debug)]
pub struct JsonElements<const D: usize> {
    text: String,
    layout: Layout<D>,
    records: Vec<Record<D>>,
    /// Where the list of placements begins, with its name.
    list: usize,
    ids: Option<Range<usize>>,
    recipe: Option<Range<usize>>,
    extent: f64,
}

/// Where the parts of a placement stand.
#[derive(Clone, Debug)]
struct Record<const D: usize> {
    range: Range<usize>,
    centre: [Range<usize>; D],
    /// Column by column, the shift last.
    transform: Vec<Range<usize>>,
    /// Where bending leads to, coordinate by coordinate.
    bent: Vec<Range<usize>>,
    /// With the comma before it, where the user placed the element.
    kept: Option<Range<usize>>,
}

#[derive(Deserialize)]
struct FileIn<'a> {
    #[serde(borrow)]
    page: PageIn<'a>,
    #[serde(borrow)]
    placements: &'a RawValue,
    #[serde(borrow, default)]
    ids: Option<&'a RawValue>,
    #[serde(borrow, default)]
    recipe: Option<&'a RawValue>,
}

#[derive(Deserialize)]
struct PageIn<'a> {
    #[serde(borrow)]
    min: Vec<&'a RawValue>,
    #[serde(borrow)]
    size: Vec<&'a RawValue>,
}

#[derive(Deserialize)]
struct PlacementIn<'a> {
    #[serde(default)]
    source: Option<usize>,
    class: String,
    #[serde(borrow)]
    centre: Vec<&'a RawValue>,
    #[serde(borrow)]
    transform: Vec<&'a RawValue>,
    #[serde(borrow, default)]
    kept: Option<&'a RawValue>,
    #[serde(borrow, default)]
    control: Vec<[Vec<&'a RawValue>; 2]>,
}

/// How many coordinates the places of a result have; `None` for another file.
pub fn dimension(text: &str) -> Option<usize> {
    let file: FileIn<'_> = serde_json::from_str(text).ok()?;
    Some(file.page.min.len()).filter(|n| (2..=3).contains(n))
}

/// Where a value stands in the text that it was read from.
fn place(text: &str, raw: &RawValue) -> Range<usize> {
    let at = (raw.get().as_ptr() as usize).saturating_sub(text.as_ptr() as usize);
    at..at + raw.get().len()
}

fn number(raw: &RawValue) -> Option<f64> {
    raw.get().parse().ok().filter(|v: &f64| v.is_finite())
}

impl<const D: usize> JsonElements<D> {
    /// The elements of a result; `is_tile` says that opposite edges of its page meet.
    ///
    /// # Errors
    /// [`Error::Input`] with the number of the placement for what arabesque would not write, [`Error::Limit`] for too large a file.
    pub fn open(name: &str, text: String, is_tile: bool, budget: &Budget) -> Result<Self> {
        let budget = budget.stage("reading elements");
        budget.spend(PER_BYTE.saturating_mul(text.len() as u64))?;
        let _held = budget.hold("placements", text.len().saturating_mul(GROWTH))?;
        let advice = "edit a result as arabesque wrote it";
        let broken = |e: serde_json::Error| Error::input(name, e.to_string(), advice);
        let file: FileIn<'_> = serde_json::from_str(&text).map_err(broken)?;
        let placements: Vec<&RawValue> = serde_json::from_str(file.placements.get()).map_err(broken)?;
        budget.within(&format!("{name}: placements"), placements.len(), ("elements", budget.limits().elements))?;
        if placements.is_empty() {
            return Err(Error::input(name, "a result without elements", "edit a result that has elements"));
        }
        let ids = file.ids.and_then(|raw| serde_json::from_str::<String>(raw.get()).ok());
        let ids =
            ids.and_then(|ids| numbers(&ids, placements.len())).unwrap_or_else(|| (0..placements.len()).collect());
        let frame = frame(&file.page).ok_or_else(|| Error::input(name, "a page that is no box", advice))?;
        let mut layout = Layout {
            items: Vec::with_capacity(placements.len()),
            classes: Vec::new(),
            frame,
            is_tile,
            turns: true,
            paints: false,
            next: ids.iter().max().map_or(0, |id| id + 1),
        };
        let (mut records, mut known) = (Vec::with_capacity(placements.len()), BTreeMap::new());
        for (index, (raw, &id)) in placements.iter().zip(&ids).enumerate() {
            budget.spend(PER_ITEM)?;
            let refused = |problem: String| Error::input(format!("{name}: placement {index}"), problem, advice);
            let placement: PlacementIn<'_> = serde_json::from_str(raw.get()).map_err(|e| refused(e.to_string()))?;
            let record = Record::new(&text, raw, &placement);
            let (record, mut item) = record
                .zip(item(id, &placement, budget.limits().coordinate))
                .ok_or_else(|| refused("a place whose transform does not only turn, scale and shift".to_owned()))?;
            item.class = *known.entry(placement.class).or_insert_with_key(|class| {
                layout.classes.push(class.clone());
                layout.classes.len() - 1
            });
            layout.items.push(item);
            records.push(record);
        }
        let listed = place(&text, file.placements).start;
        let list = text[..listed].rfind("\"placements\"").unwrap_or(listed);
        let (ids, recipe) = (file.ids.map(|raw| place(&text, raw)), file.recipe.map(|raw| place(&text, raw)));
        let extent = frame.min.0.into_iter().chain(frame.max.0).fold(0.0, |most: f64, v| most.max(v.abs()));
        Ok(Self { layout, records, list, ids, recipe, extent, text })
    }

    /// A placement that is replaced, as text.
    fn placement(&self, replaced: &Replaced<D>, index: &BTreeMap<usize, usize>, own: bool) -> Result<String> {
        let missing =
            || Error::input("changes", format!("no element {}", replaced.base), "name an element of the file");
        let number = *index.get(&replaced.base).ok_or_else(missing)?;
        // How it is painted is not said here.
        let (item, record) = (&self.layout.items[number], &self.records[number]);
        let after = replaced.motion.after(&item.place);
        let centre = replaced.motion.apply(item.centre);
        let mut splices = Splices::default();
        let at = |range: &Range<usize>| range.start - record.range.start..range.end - record.range.start;
        for (range, value) in record.centre.iter().zip(centre.0) {
            splices.put(at(range), json_digits(value, self.extent));
        }
        let linear = (0..D).flat_map(|c| (0..D).map(move |r| (r, c)));
        let linear = linear.map(|(r, c)| json_digits(after.rotation.0[r][c] * after.scale, self.extent.min(1.0)));
        let shift = after.translation.0.map(|v| json_digits(v, self.extent));
        for (range, value) in record.transform.iter().zip(linear.chain(shift)) {
            splices.put(at(range), value);
        }
        for range in record.bent.chunks_exact(D) {
            let target = self.point(range);
            for (range, value) in range.iter().zip(replaced.motion.apply(target).0) {
                splices.put(at(range), json_digits(value, self.extent));
            }
        }
        // A copy is none that the user placed.
        if let Some(kept) = record.kept.as_ref().filter(|_| !own) {
            splices.put(at(kept), "");
        }
        Ok(splices.apply(&self.text[record.range.clone()]))
    }
}

impl<const D: usize> PlacedFile<D> for JsonElements<D> {
    fn layout(&self) -> &Layout<D> {
        &self.layout
    }

    fn rewritten(&self, changes: &Changes<D>, recipe: Option<&str>, budget: &Budget) -> Result<Vec<u8>> {
        let budget = budget.stage("writing elements");
        budget.spend(PER_BYTE.saturating_mul(self.text.len() as u64))?;
        let index = self.layout.numbers();
        let mut splices = Splices::default();
        let mut kept: Vec<(usize, usize)> = Vec::with_capacity(self.records.len());
        for (number, item) in self.layout.items.iter().enumerate() {
            if !changes.removed.contains(&item.id) {
                kept.push((number, item.id));
            }
        }
        let mut ids: Vec<usize> = kept.iter().map(|(_, id)| *id).collect();
        let mut texts = Vec::new();
        for (id, inserted) in &changes.inserted {
            budget.spend(PER_ITEM)?;
            ids.push(*id);
            texts.push(self.placement(inserted, &index, false)?);
        }
        for (id, replaced) in &changes.replaced {
            budget.spend(PER_ITEM)?;
            let Some(&number) = index.get(id).filter(|_| !changes.removed.contains(id)) else { continue };
            let text = self.placement(replaced, &index, replaced.base == *id)?;
            splices.put(self.records[number].range.clone(), text);
        }
        self.cut(&kept, &mut splices);
        self.add(&texts, kept.is_empty(), &mut splices);
        match (runs(&ids), &self.ids) {
            (Some(runs), Some(range)) => splices.put(range.clone(), format!("\"{runs}\"")),
            (Some(runs), None) => {
                let blank = self.text[..self.list].rfind(|c: char| !c.is_whitespace()).map_or(0, |at| at + 1);
                let blank = self.text.get(blank..self.list).unwrap_or_default();
                splices.put(self.list..self.list, format!("\"ids\": \"{runs}\",{blank}"));
            }
            (None, Some(range)) => {
                let from = self.text[..range.start].rfind("\"ids\"").unwrap_or(range.start);
                splices.put(from..self.list.max(range.end), "");
            }
            (None, None) => {}
        }
        if let (Some(range), Some(recipe)) = (&self.recipe, recipe) {
            let text = serde_json::to_string(recipe)
                .map_err(|e| Error::input("recipe", e.to_string(), "report this together with the result"))?;
            splices.put(range.clone(), text);
        }
        Ok(splices.apply(&self.text).into_bytes())
    }
}

impl<const D: usize> JsonElements<D> {
    fn point(&self, ranges: &[Range<usize>]) -> Vector<D> {
        Vector(std::array::from_fn(|k| self.text[ranges[k].clone()].parse().unwrap_or(0.0)))
    }

    /// Removes the placements between those that stay, with one comma each.
    fn cut(&self, kept: &[(usize, usize)], splices: &mut Splices) {
        let (first, last) = (&self.records[0], &self.records[self.records.len() - 1]);
        let Some((&(from, _), &(to, _))) = kept.first().zip(kept.last()) else {
            return splices.put(first.range.start..last.range.end, "");
        };
        splices.put(first.range.start..self.records[from].range.start, "");
        splices.put(self.records[to].range.end..last.range.end, "");
        for pair in kept.windows(2) {
            let ((a, _), (b, _)) = (pair[0], pair[1]);
            if b > a + 1 {
                splices.put(self.records[a + 1].range.start..self.records[b].range.start, "");
            }
        }
    }

    /// Adds placements at the end of the list.
    fn add(&self, texts: &[String], is_empty: bool, splices: &mut Splices) {
        let last = &self.records[self.records.len() - 1];
        let between = match self.records.len() {
            0 | 1 => ",\n    ",
            n => &self.text[self.records[n - 2].range.end..last.range.start],
        };
        let mut added = String::new();
        for (k, text) in texts.iter().enumerate() {
            if k > 0 || !is_empty {
                added.push_str(between);
            }
            added.push_str(text);
        }
        splices.put(last.range.end..last.range.end, added);
    }
}

fn frame<const D: usize>(page: &PageIn<'_>) -> Option<Bounds<D>> {
    let corner = |list: &[&RawValue]| -> Option<Vector<D>> {
        let values: Vec<f64> = list.iter().map(|raw| number(raw)).collect::<Option<_>>()?;
        Some(Vector(values.try_into().ok()?))
    };
    let (min, size) = (corner(&page.min)?, corner(&page.size)?);
    size.0.iter().all(|s| *s > 0.0).then(|| Bounds::new(min, min + size))
}

impl<const D: usize> Record<D> {
    fn new(text: &str, raw: &RawValue, placement: &PlacementIn<'_>) -> Option<Self> {
        let ranges = |list: &[&RawValue]| list.iter().map(|raw| place(text, raw)).collect::<Vec<_>>();
        let range = place(text, raw);
        let kept = placement.kept.and_then(|raw| {
            let value = place(text, raw);
            let comma = text.get(range.start..value.start)?.rfind("\"kept\"")?;
            let comma = text.get(range.start..range.start + comma)?.rfind(',')?;
            Some(range.start + comma..value.end)
        });
        let targets = placement.control.iter().map(|[_, target]| target);
        let is_whole = placement.transform.len() == D * D + D && targets.clone().all(|target| target.len() == D);
        is_whole.then_some(Self {
            range,
            centre: ranges(&placement.centre).try_into().ok()?,
            transform: ranges(&placement.transform),
            bent: targets.flat_map(|target| ranges(target)).collect(),
            kept,
        })
    }
}

/// An element as its placement says, without its class.
fn item<const D: usize>(id: usize, placement: &PlacementIn<'_>, most: f64) -> Option<Item<D>> {
    let values =
        |list: &[&RawValue]| list.iter().map(|raw| number(raw).filter(|v| v.abs() <= most)).collect::<Option<Vec<_>>>();
    let (transform, centre) = (values(&placement.transform)?, values(&placement.centre)?);
    let (linear, shift) = transform.split_at_checked(D * D)?;
    let columns = Matrix(std::array::from_fn(|r| std::array::from_fn(|c| linear[c * D + r])));
    let lengths: [f64; D] = std::array::from_fn(|c| (0..D).map(|r| columns.0[r][c].powi(2)).sum::<f64>().sqrt());
    let scale = lengths.iter().sum::<f64>() / D as f64;
    let rotation = Matrix(columns.0.map(|row| row.map(|v| v / scale)));
    let is_rotation = || {
        let nearest = rotation.nearest_rotation();
        (0..D).all(|r| (0..D).all(|c| (nearest.0[r][c] - rotation.0[r][c]).abs() < 1e-3))
    };
    if !(scale > 0.0 && is_rotation()) {
        return None;
    }
    let place = Similarity { rotation, scale, translation: Vector(shift.to_vec().try_into().ok()?) };
    let centre = Vector(centre.try_into().ok()?);
    Some(Item { id, class: 0, source: placement.source, place, centre, reach: 0.0, kept: placement.kept.is_some() })
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Exemplar, Outcome, Placement, StopReason};

    use super::*;
    use crate::json::{Frame, recipe_of, write_json};

    fn result() -> String {
        let points = [Vector::xy(1.0, 0.0), Vector::xy(3.0, 1.0)];
        let exemplar = Exemplar::from_points("t", &points, &[0, 1], &["dot".into(), "leaf".into()]).unwrap();
        let placed = |source, x, y, angle| Placement {
            source,
            transform: Similarity { rotation: Matrix::rotation(angle), scale: 1.5, translation: Vector::xy(x, y) },
            control: if source == 1 { vec![(Vector::ZERO, Vector::xy(2.0, 2.5))] } else { Vec::new() },
            frozen: (source == 1).then_some(0),
        };
        let outcome = Outcome {
            curves: Vec::new(),
            areas: Vec::new(),
            sequence: Vec::new(),
            placements: vec![placed(0, 5.0, 6.0, 0.0), placed(1, 1.25, 2.0, 0.7), placed(0, -3.0, 2.0, -2.0)],
            energy: Vec::new(),
            warnings: Vec::new(),
            stopped: StopReason::Finished,
        };
        let view = Bounds::new(Vector::ZERO, Vector::xy(10.0, 10.0));
        write_json(&exemplar, &outcome, &Frame { view, unit: None, recipe: Some("seed = 3\n") }).unwrap()
    }

    fn open(text: &str) -> JsonElements<2> {
        JsonElements::open("r.json", text.to_owned(), false, &Budget::default()).unwrap()
    }

    fn changed(text: &str, changes: &Changes<2>) -> String {
        String::from_utf8(open(text).rewritten(changes, None, &Budget::default()).unwrap()).unwrap()
    }

    fn about(text: &str, id: usize, angle: f64, scale: f64, shift: Vector<2>) -> Changes<2> {
        let centre = open(text).layout.item(id).unwrap().centre;
        let motion = Similarity::about(centre, centre + shift, Matrix::rotation(angle), scale);
        Changes { replaced: [(id, Replaced { base: id, motion, paint: Vec::new() })].into(), ..Changes::default() }
    }

    #[test]
    fn motion_and_back_restores_every_byte() {
        let text = result();
        assert_eq!(dimension(&text), Some(2));
        assert_eq!(changed(&text, &Changes::default()), text);
        for id in 0..3 {
            let there = changed(&text, &about(&text, id, 0.4, 2.0, Vector::xy(0.1, -0.7)));
            assert_ne!(there, text);
            assert_eq!(changed(&there, &about(&there, id, -0.4, 0.5, Vector::xy(-0.1, 0.7))), text);
        }
    }

    #[test]
    fn elements_go_and_come_and_keep_their_numbers() {
        let text = result();
        let gone = changed(&text, &Changes { removed: [0, 2].into(), ..Changes::default() });
        assert!(gone.contains("\"ids\": \"1\",\n  \"placements\": [\n    {"), "{gone}");
        assert_eq!(open(&gone).layout.items.iter().map(|item| item.id).collect::<Vec<_>>(), [1]);
        let copy = Replaced { base: 1, motion: Similarity::shift(Vector::xy(1.0, 0.0)), paint: Vec::new() };
        let more = changed(&text, &Changes { inserted: vec![(3, copy)], removed: [1].into(), ..Changes::default() });
        let file = open(&more);
        assert_eq!(file.layout.items.iter().map(|item| item.id).collect::<Vec<_>>(), [0, 2, 3]);
        assert!(!file.layout.items[2].kept && open(&text).layout.items[1].kept);
        let copy = Replaced { base: 1, motion: Similarity::shift(Vector::xy(1.0, 0.0)), paint: Vec::new() };
        let more = changed(&text, &Changes { inserted: vec![(3, copy)], ..Changes::default() });
        assert_eq!(changed(&more, &Changes { removed: [3].into(), ..Changes::default() }), text);
        let none = changed(&text, &Changes { removed: [0, 1, 2].into(), ..Changes::default() });
        serde_json::from_str::<serde_json::Value>(&none).unwrap();
        let new = open(&text).rewritten(&Changes::default(), Some("seed = 4\n"), &Budget::default()).unwrap();
        assert_eq!(recipe_of(&String::from_utf8(new).unwrap()).as_deref(), Some("seed = 4\n"));
    }

    #[test]
    fn what_arabesque_would_not_write_is_refused() {
        let text = result();
        let cases = [
            (
                text.replace("\"transform\": [\n        1.5", "\"transform\": [\n        -1.5"),
                "placement 0: a place whose",
            ),
            (text.replace("\"centre\"", "\"center\""), "placement 0: missing field `centre`"),
            ("{\"page\":{\"min\":[0,0],\"size\":[1,1]},\"placements\":[]}".into(), "without elements"),
            ("{\"page\":{\"min\":[0],\"size\":[1,1]},\"placements\":[1]}".into(), "no box"),
            ("[".into(), "r.json"),
        ];
        for (text, expected) in cases {
            let error = JsonElements::<2>::open("r.json", text, false, &Budget::default()).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
