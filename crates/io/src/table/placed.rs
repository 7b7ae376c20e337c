//! A result as a table of points whose elements can be changed: the rows that do not change keep their bytes.
//!
//! What a row cannot say (how an element is turned, scaled and painted) is refused by whoever edits. Numbers of elements are the places of
//! their rows; once rows are gone, a comment says the numbers that are left.

use std::{collections::BTreeMap, ops::Range};

use arabesque_core::{Bounds, Budget, Error, Result, Similarity, Vector};

use crate::{
    placed::{
        digits::digits,
        ids::{numbers, runs},
        layout::{Changes, Item, Layout, PER_BYTE, PER_ITEM, PlacedFile, Replaced},
        splice::Splices,
    },
    table::records::{RECIPE_MARK, recipe_comments, recipe_of},
    text::short::short,
};

/// The comment that says numbers of elements.
const IDS_MARK: &str = "# arabesque ids: ";

/// A table of points that arabesque wrote.
#[derive(Debug)]
pub struct CsvElements<const D: usize> {
    text: String,
    layout: Layout<D>,
    rows: Vec<Row<D>>,
    /// Where the comments behind the rows begin.
    end: usize,
    recipe: Option<String>,
    extent: f64,
}

/// A row of the table.
#[derive(Debug)]
struct Row<const D: usize> {
    /// All of it, with the end of the line.
    range: Range<usize>,
    /// Each coordinate.
    values: [Range<usize>; D],
    /// The class, as it is written.
    class: Range<usize>,
}

/// How many coordinates the points of a table have that arabesque wrote; `None` for another table.
pub fn dimension(text: &str) -> Option<usize> {
    match text.lines().next()? {
        "x,y,class" => Some(2),
        "x,y,z,class" => Some(3),
        _ => None,
    }
}

impl<const D: usize> CsvElements<D> {
    /// The elements of a table; `tile` is the tile whose opposite edges meet, where it is one.
    ///
    /// # Errors
    /// [`Error::Input`] with the line for what arabesque would not write, [`Error::Limit`] for too many points.
    pub fn open(name: &str, text: String, tile: Option<Bounds<D>>, budget: &Budget) -> Result<Self> {
        let budget = budget.stage("reading elements");
        budget.spend(PER_BYTE.saturating_mul(text.len() as u64))?;
        let head = text.find('\n').map_or(text.len(), |at| at + 1);
        let (mut at, mut rows) = (head, Vec::new());
        while at < text.len() && !text[at..].starts_with(RECIPE_MARK) && !text[at..].starts_with(IDS_MARK) {
            let line = || 1 + text[..at].matches('\n').count();
            let row = row(&text, at).ok_or_else(|| {
                let expected = if D == 3 { "x,y,z,class" } else { "x,y,class" };
                let found = short(text[at..].lines().next().unwrap_or_default());
                let problem = format!("\"{found}\" where {expected} was expected");
                Error::input(format!("{name}: line {}", line()), problem, "edit a table as arabesque wrote it")
            })?;
            at = row.range.end;
            rows.push(row);
            budget.within(&format!("{name}: points"), rows.len(), ("elements", budget.limits().elements))?;
        }
        if rows.is_empty() {
            return Err(Error::input(name, "a table without points", "edit a result that has elements"));
        }
        let ids = text[at..].strip_prefix(IDS_MARK).and_then(|rest| rest.lines().next());
        let ids = ids.and_then(|ids| numbers(ids, rows.len())).unwrap_or_else(|| (0..rows.len()).collect());
        let mut file = Self {
            layout: Layout {
                items: Vec::with_capacity(rows.len()),
                classes: Vec::new(),
                frame: Bounds::EMPTY,
                is_tile: tile.is_some(),
                turns: false,
                paints: false,
                next: ids.iter().max().map_or(0, |id| id + 1),
            },
            recipe: recipe_of(&text),
            end: at,
            rows,
            text,
            extent: 0.0,
        };
        file.items(name, &ids, &budget)?;
        file.layout.frame = tile.unwrap_or_else(|| Bounds::around(file.layout.items.iter().map(|item| item.centre)));
        let (low, high) = (file.layout.frame.min, file.layout.frame.max);
        file.extent = low.0.into_iter().chain(high.0).fold(0.0, |most, v| most.max(v.abs()));
        Ok(file)
    }

    fn items(&mut self, name: &str, ids: &[usize], budget: &Budget) -> Result<()> {
        let mut known: BTreeMap<String, usize> = BTreeMap::new();
        for (row, &id) in self.rows.iter().zip(ids) {
            budget.spend(PER_ITEM)?;
            let class = unquoted(&self.text[row.class.clone()]);
            let classes = &mut self.layout.classes;
            let class = *known.entry(class).or_insert_with_key(|class| {
                classes.push(class.clone());
                classes.len() - 1
            });
            let values = row.values.clone().map(|range| self.text[range].trim().parse::<f64>().unwrap_or(f64::NAN));
            if values.iter().any(|v| !v.is_finite() || v.abs() > budget.limits().coordinate) {
                let problem = format!("element {id} has a coordinate that is no number within the limits");
                return Err(Error::input(name, problem, "edit a table as arabesque wrote it"));
            }
            let place = Similarity::shift(Vector(values));
            let centre = place.translation;
            self.layout.items.push(Item { id, class, source: None, place, centre, reach: 0.0, kept: false });
        }
        Ok(())
    }

    /// The row of an element that is replaced.
    fn row(&self, replaced: &Replaced<D>, index: &BTreeMap<usize, usize>) -> Result<String> {
        let missing =
            || Error::input("changes", format!("no element {}", replaced.base), "name an element of the file");
        let number = *index.get(&replaced.base).ok_or_else(missing)?;
        let item = &self.layout.items[number];
        let centre = replaced.motion.apply(item.centre);
        let values = centre.0.map(|v| digits(v, self.extent)).join(",");
        Ok(format!("{values},{}\n", &self.text[self.rows[number].class.clone()]))
    }
}

impl<const D: usize> PlacedFile<D> for CsvElements<D> {
    fn layout(&self) -> &Layout<D> {
        &self.layout
    }

    fn rewritten(&self, changes: &Changes<D>, recipe: Option<&str>, budget: &Budget) -> Result<Vec<u8>> {
        let budget = budget.stage("writing elements");
        budget.spend(PER_BYTE.saturating_mul(self.text.len() as u64))?;
        let index = self.layout.numbers();
        let mut splices = Splices::default();
        let mut ids = Vec::with_capacity(self.rows.len());
        for (item, row) in self.layout.items.iter().zip(&self.rows) {
            if changes.removed.contains(&item.id) {
                splices.put(row.range.clone(), "");
                continue;
            }
            ids.push(item.id);
            if let Some(replaced) = changes.replaced.get(&item.id) {
                budget.spend(PER_ITEM)?;
                splices.put(row.range.clone(), self.row(replaced, &index)?);
            }
        }
        // The last row may end where the file does.
        let is_open = self.end > 0 && !self.text[..self.end].ends_with('\n');
        let mut tail = String::from(if is_open { "\n" } else { "" });
        for (id, inserted) in &changes.inserted {
            budget.spend(PER_ITEM)?;
            ids.push(*id);
            tail.push_str(&self.row(inserted, &index)?);
        }
        if let Some(runs) = runs(&ids) {
            tail.push_str(&format!("{IDS_MARK}{runs}\n"));
        }
        let recipe = recipe.filter(|_| self.recipe.is_some()).or(self.recipe.as_deref());
        tail.push_str(&recipe.map(recipe_comments).unwrap_or_default());
        splices.put(self.end..self.text.len(), tail);
        Ok(splices.apply(&self.text).into_bytes())
    }
}

/// The row that begins at a place in the text.
fn row<const D: usize>(text: &str, from: usize) -> Option<Row<D>> {
    let mut at = from;
    let mut values: [Range<usize>; D] = std::array::from_fn(|_| 0..0);
    for value in &mut values {
        let length = text[at..].find([',', '\n'])?;
        *value = at..at + length;
        text[value.clone()].trim().parse::<f64>().ok()?;
        at += length;
        at += text[at..].starts_with(',').then_some(1)?;
    }
    let class = at;
    if text[at..].starts_with('"') {
        at += 1;
        loop {
            at += text[at..].find('"')? + 1;
            if !text[at..].starts_with('"') {
                break;
            }
            at += 1;
        }
    } else {
        at += text[at..].find(['\n', '\r']).unwrap_or(text.len() - at);
    }
    let class = class..at;
    let rest = &text[at..];
    let end = rest.strip_prefix("\r\n").or_else(|| rest.strip_prefix('\n')).map_or(at, |left| text.len() - left.len());
    (end > at || at == text.len()).then_some(Row { range: from..end, values, class })
}

fn unquoted(class: &str) -> String {
    let inner = class.strip_prefix('"').and_then(|inner| inner.strip_suffix('"'));
    inner.map_or_else(|| class.to_owned(), |inner| inner.replace("\"\"", "\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "x,y,class\n1,2,dot\n3.5,2,\"a,\"\"b\nc\"\n-1,0.25,dot\n# arabesque recipe:\n# seed = 1\n";

    fn open(text: &str) -> CsvElements<2> {
        CsvElements::open("t.csv", text.to_owned(), None, &Budget::default()).unwrap()
    }

    fn changed(text: &str, changes: &Changes<2>) -> String {
        String::from_utf8(open(text).rewritten(changes, None, &Budget::default()).unwrap()).unwrap()
    }

    fn moved(base: usize, x: f64, y: f64) -> Replaced<2> {
        Replaced { base, motion: Similarity::shift(Vector::xy(x, y)), paint: Vec::new() }
    }

    #[test]
    fn rows_are_read_and_stay() {
        let file = open(TABLE);
        assert_eq!(file.layout.classes, ["dot", "a,\"b\nc"]);
        assert_eq!(file.layout.items[2].centre, Vector::xy(-1.0, 0.25));
        assert_eq!(changed(TABLE, &Changes::default()), TABLE);
    }

    #[test]
    fn a_row_is_added_behind_one_that_ends_with_the_file() {
        let more =
            changed("x,y,class\n1,2,dot", &Changes { inserted: vec![(1, moved(0, 1.0, 0.0))], ..Changes::default() });
        assert_eq!(open(&more).layout.items.len(), 2, "{more}");
    }

    #[test]
    fn rows_move_go_and_come_and_keep_their_numbers() {
        let move_one = |x, y| Changes { replaced: [(1, moved(1, x, y))].into(), ..Changes::default() };
        let there = changed(TABLE, &move_one(0.1, -1.0 / 3.0));
        assert!(
            there.contains("\n3.6,1.66666666666667,\"a,\"\"b\nc\"\n") || there.contains("\n3.6,1.6666666666667,"),
            "{there}"
        );
        assert_eq!(changed(&there, &move_one(-0.1, 1.0 / 3.0)), TABLE);
        let gone = changed(TABLE, &Changes { removed: [0].into(), ..Changes::default() });
        assert!(gone.contains("# arabesque ids: 1-2\n"), "{gone}");
        assert_eq!(open(&gone).layout.items[0].id, 1);
        let more = changed(&gone, &Changes { inserted: vec![(3, moved(2, 5.0, 0.0))], ..Changes::default() });
        assert!(more.contains("\n4,0.25,dot\n# arabesque ids: 1-3\n# arabesque recipe:\n"), "{more}");
        let new = open(TABLE).rewritten(&Changes::default(), Some("seed = 2\n"), &Budget::default()).unwrap();
        assert_eq!(recipe_of(&String::from_utf8(new).unwrap()).as_deref(), Some("seed = 2\n"));
    }

    #[test]
    fn other_tables_are_refused_with_the_line() {
        for (text, expected) in [
            ("x,y,class\n1,2,a\n1;2;b\n", "line 3: \"1;2;b\""),
            ("x,y,class\n", "without points"),
            ("x,y,class\n1,nan,a\n", "element 0 has"),
            ("x,y,class\n1,2,\"a\n", "line 2"),
            ("x,y,class\n1\n", "line 2"),
        ] {
            let error = CsvElements::<2>::open("t.csv", text.into(), None, &Budget::default()).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
        assert_eq!(["x,y,class\n", "x,y,z,class\n", "a,b\n"].map(dimension), [Some(2), Some(3), None]);
    }
}
