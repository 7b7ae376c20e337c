//! CSV: points with classes, in and out.
//!
//! Read: a header that names the columns in any order and case (`x`, `y`, `z`, `class` and their usual aliases), or two
//! columns without a header. Commas, semicolons, tabs or spaces separate; `#` starts a comment line; a class in double
//! quotes may hold separators and line breaks. Written: `x,y,class`, and the recipe in comment lines at the end.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Budget, Decimals, Error, Exemplar, Limits, Placement, Result, Vector};

pub use crate::table::records::recipe_of;
use crate::{
    table::records::{recipe_comments, records},
    text::short::{list, short},
};

/// Points of a file, by dimension.
#[derive(Clone, Debug)]
pub enum Points {
    /// No `z` column.
    Plane(Exemplar<2>),
    /// With a `z` column.
    Space(Exemplar<3>),
}

const ALIASES: [(&str, &[&str]); 4] = [
    ("x", &["x", "px", "pos_x", "posx", "position_x", "x_pos", "easting", "lon", "longitude"]),
    ("y", &["y", "py", "pos_y", "posy", "position_y", "y_pos", "northing", "lat", "latitude"]),
    ("z", &["z", "pz", "pos_z", "posz", "position_z", "z_pos", "height", "elevation"]),
    ("class", &["class", "label", "type", "kind", "category", "cls", "species", "group", "id", "name"]),
];

/// The class of every point of a file without a class column.
const ONLY_CLASS: &str = "point";

/// Reads points.
///
/// # Errors
/// [`Error::Input`] with the line when a value is not a finite number within the limits, a column is missing or a line
/// has the wrong number of fields; [`Error::Limit`] for too many points.
pub fn read_points(name: &str, text: &str, budget: &Budget) -> Result<Points> {
    let table = Table::new(name, text, budget)?;
    let (class_of, names) = table.classes();
    let missing = |axis: &str| {
        Error::input(
            format!("{name}: line {}", table.header_line),
            format!("no column {axis} among {}", list(&table.header)),
            "name the columns x, y and, if wanted, z and class",
        )
    };
    let x = table.column("x").ok_or_else(|| missing("x"))?;
    let y = table.column("y").ok_or_else(|| missing("y"))?;
    match table.column("z") {
        None => Ok(Points::Plane(exemplar(&table, [x, y], &class_of, &names, budget)?)),
        Some(z) => Ok(Points::Space(exemplar(&table, [x, y, z], &class_of, &names, budget)?)),
    }
}

fn exemplar<const D: usize>(
    table: &Table<'_>,
    columns: [usize; D],
    class_of: &[usize],
    names: &[String],
    budget: &Budget,
) -> Result<Exemplar<D>> {
    let points = table.points(columns, budget)?;
    let size = Bounds::around(points.iter().copied()).size();
    if points.len() > 1 && size.0.iter().all(|s| *s < budget.limits().extent) {
        return Err(Error::input(table.name, "all points lie at one place", "give points that are spread out"));
    }
    Exemplar::from_points(table.name, &points, class_of, names)
}

/// Lines cut into fields.
struct Table<'a> {
    name: &'a str,
    /// Lower-case column names; made up where the file has no header.
    header: Vec<String>,
    header_line: usize,
    /// Line number and fields.
    rows: Vec<(usize, Vec<String>)>,
}

impl<'a> Table<'a> {
    fn new(name: &'a str, text: &str, budget: &Budget) -> Result<Self> {
        let limit = budget.limits().elements;
        let most = limit.saturating_add(2);
        let records = records(name, text, budget, most)?;
        let count = records.len();
        let mut records = records.into_iter();
        let Some((first_line, first)) = records.next() else {
            return Err(Error::input(name, "no point found", "give one point per line, as x,y or x,y,class"));
        };
        let head: Vec<_> = first.iter().map(|f| f.to_ascii_lowercase()).collect();
        let has_header = head.iter().any(|f| f.parse::<f64>().is_err() && is_known(f));
        let (header, first) = match has_header {
            true => (head, None),
            false => (made_up_header(name, first_line, &head)?, Some((first_line, first))),
        };
        let mut rows = Vec::new();
        for (line, fields) in first.into_iter().chain(records) {
            if fields.len() != header.len() {
                return Err(Error::input(
                    format!("{name}: line {line}"),
                    format!("{} fields where {} were expected ({})", fields.len(), header.len(), list(&header)),
                    "give every line the same fields",
                ));
            }
            rows.push((line, fields));
        }
        if rows.len() > limit {
            return Err(Error::Limit {
                what: format!("{name}: number of points"),
                found: if count < most { rows.len().to_string() } else { format!("more than {limit}") },
                limit: limit.to_string(),
                advice: format!(
                    "keep a smaller part of the pattern as the exemplar{}",
                    Limits::raising("elements", rows.len().max(2 * limit) as f64)
                ),
            });
        }
        if rows.is_empty() {
            return Err(Error::input(name, "a header but no point", "give one point per line below the header"));
        }
        Ok(Self { name, header, header_line: first_line, rows })
    }

    fn column(&self, which: &str) -> Option<usize> {
        let (_, aliases) = ALIASES.iter().find(|(n, _)| *n == which)?;
        aliases.iter().find_map(|alias| self.header.iter().position(|h| h == alias))
    }

    /// Class of each row, and the names of the classes in order of appearance.
    fn classes(&self) -> (Vec<usize>, Vec<String>) {
        let Some(column) = self.column("class") else {
            return (vec![0; self.rows.len()], vec![ONLY_CLASS.to_owned()]);
        };
        let (mut names, mut known) = (Vec::new(), BTreeMap::new());
        let class_of = self.rows.iter().map(|(_, fields)| {
            *known.entry(fields[column].as_str()).or_insert_with(|| {
                names.push(fields[column].clone());
                names.len() - 1
            })
        });
        (class_of.collect(), names)
    }

    fn points<const D: usize>(&self, columns: [usize; D], budget: &Budget) -> Result<Vec<Vector<D>>> {
        let value = |line: usize, fields: &[String], k: usize| {
            let text = &fields[columns[k]];
            let place = || format!("{}: line {line}, column {}", self.name, self.header[columns[k]]);
            let v: f64 = text.parse().map_err(|_| {
                Error::input(
                    place(),
                    format!("\"{}\" is not a number", short(text)),
                    "write numbers like 12.5 or 1.25e1",
                )
            })?;
            if v.is_finite() && v.abs() <= budget.limits().coordinate {
                return Ok(v);
            }
            let expected = format!(
                "{} where a coordinate between -{1} and {1} was expected",
                short(text),
                budget.limits().coordinate
            );
            let raising = Limits::raising("coordinate", v.abs());
            Err(Error::input(place(), expected, format!("correct or remove the line{raising}")))
        };
        self.rows
            .iter()
            .map(|(line, fields)| {
                let mut p = Vector::ZERO;
                for k in 0..D {
                    p[k] = value(*line, fields, k)?;
                }
                Ok(p)
            })
            .collect()
    }
}

fn is_known(field: &str) -> bool {
    ALIASES.iter().any(|(_, aliases)| aliases.contains(&field))
}

fn made_up_header(name: &str, line: usize, first: &[String]) -> Result<Vec<String>> {
    let place = format!("{name}: line {line}");
    if let Some(field) = first.iter().take(2).find(|f| f.parse::<f64>().is_err()) {
        let problem = format!("\"{}\" is neither a number nor the name of a column", short(field));
        return Err(Error::input(place, problem, "start with a header such as x,y,class"));
    }
    let names: &[&str] = match first.len() {
        2 => &["x", "y"],
        3 if first[2].parse::<f64>().is_err() => &["x", "y", "class"],
        n => {
            let problem = format!("{n} columns without a header");
            return Err(Error::input(place, problem, "add a header that names them, such as x,y,class"));
        }
    };
    Ok(names.iter().map(|&n| n.to_owned()).collect())
}

/// Writes placements as `x,y,class` (`x,y,z,class` in space), one per line, with six significant digits of `extent`.
/// `recipe` follows in comment lines.
pub fn write_points<const D: usize>(
    exemplar: &Exemplar<D>,
    placements: &[Placement<D>],
    extent: f64,
    recipe: Option<&str>,
) -> String {
    let decimals = Decimals::for_extent(extent);
    let mut out = String::from(if D == 3 { "x,y,z,class\n" } else { "x,y,class\n" });
    for placement in placements {
        let element = &exemplar.elements[placement.source];
        for coordinate in placement.transform.apply(element.centre).0 {
            out.push_str(&decimals.format(coordinate));
            out.push(',');
        }
        out.push_str(&quoted(&exemplar.classes[element.class].name));
        out.push('\n');
    }
    out + &recipe.map(recipe_comments).unwrap_or_default()
}

fn quoted(name: &str) -> String {
    if name.contains([',', ';', '\t', '"', '#', '\n']) || name.trim() != name {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Points> {
        read_points("t.csv", text, &Budget::default())
    }

    fn plane(text: &str) -> Exemplar<2> {
        match read(text).unwrap() {
            Points::Plane(e) => e,
            Points::Space(_) => panic!("no z was given"),
        }
    }

    #[test]
    fn columns_come_in_any_order_and_case() {
        let e = plane("Kind; Y; X\nleaf;1;2\n\"a;b\";3;5\n");
        assert_eq!(e.elements[0].centre, Vector::xy(2.0, 1.0));
        assert_eq!(e.classes[1].name, "a;b");
        assert_eq!(e.elements[1].class, 1);
    }

    #[test]
    fn two_columns_need_no_header() {
        let e = plane("# comment\n0 0\n1 0\n\n0 1\n");
        assert_eq!(e.elements.len(), 3);
        assert_eq!(e.classes.len(), 1);
    }

    #[test]
    fn a_z_column_makes_space() {
        assert!(matches!(read("x,y,z\n0,0,0\n1,1,1\n1,0,0\n0,0,1\n"), Ok(Points::Space(e)) if e.elements.len() == 4));
    }

    #[test]
    fn bad_lines_are_named() {
        for (text, expected) in [
            ("x,y\n0,0\n1,nan\n", "line 3, column y"),
            ("x,y\n0,0\n1,inf\n", "line 3, column y"),
            ("x,y\n0,1e300\n", "line 2, column y"),
            ("x,y\n0,zero\n", "\"zero\" is not a number"),
            ("x,y\n0,0\n1\n", "line 3: 1 fields where 2"),
            ("x,class\n0,a\n", "no column y"),
            ("", "no point found"),
            ("x,y\n", "a header but no point"),
            ("1,2,3,4\n", "4 columns without a header"),
            ("hello\n", "neither a number"),
            ("x,y\n1,1\n1,1\n", "one place"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(expected), "{text:?}: {message}");
        }
    }

    #[test]
    fn quotes_reach_over_lines_and_errors_still_name_the_line() {
        let e = plane("x,y,class\n0,0,\"a\n# b \"\"c\"\"\"\n1,1, \"d,e\"\n");
        assert_eq!(e.classes.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), ["a\n# b \"c\"", "d,e"]);
        let message = read("x,y,class\n0,0,\"a\nb\"\n1,no,c\n").unwrap_err().to_string();
        assert!(message.contains("line 4, column y"), "{message}");
        let message = read("x,y,class\n0,0,a\n0,1,\"a\n1,0,b\n").unwrap_err().to_string();
        assert!(message.starts_with("t.csv: line 3: a quote that nothing closes"), "{message}");
    }

    #[test]
    fn names_that_look_like_a_recipe_are_none() {
        for class in [
            "a\n# arabesque recipe:\n# seed = 9",
            "# arabesque recipe:\n",
            "\"\n# arabesque recipe:\n#",
            "# arabesque recipe:",
        ] {
            let points = [Vector::ZERO, Vector::xy(1.0, 2.0)];
            let exemplar = Exemplar::from_points("t", &points, &[0, 0], &[class.into()]).unwrap();
            let placed = |source| Placement {
                source,
                transform: arabesque_core::Similarity::identity(),
                control: Vec::new(),
                frozen: None,
            };
            let text = write_points(&exemplar, &[placed(0), placed(1)], 2.0, Some("seed = 1\n"));
            assert_eq!(recipe_of(&text).as_deref(), Some("seed = 1\n"), "{text}");
            assert_eq!(recipe_of(&write_points(&exemplar, &[placed(0)], 2.0, None)), None);
        }
        assert_eq!(recipe_of("# curves as polylines\ng # arabesque recipe:\n# seed = 9\n"), None);
    }

    #[test]
    fn what_a_message_shows_of_a_file_is_short() {
        let long = "z".repeat(100_000);
        for text in [
            format!("x,y\n0,{long}\n"),
            format!("0,{long}\n"),
            format!("{},z\n0,0\n", vec!["q"; 50_000].join(",")),
            format!("x,y,class{}\n0,0\n", ",q".repeat(50_000)),
            format!("x,y\n0,1{}\n", "0".repeat(400)),
        ] {
            let message = read(&text).unwrap_err().to_string();
            assert!(message.len() < 300, "{message}");
        }
    }

    #[test]
    fn too_many_points_are_a_limit() {
        let budget = Budget::new(arabesque_core::Limits { elements: 2, ..Default::default() });
        let err = read_points("t", "0,0\n1,0\n1,1\n", &budget).unwrap_err();
        assert!(matches!(&err, Error::Limit { found, .. } if found == "3"), "{err}");
        let many = "0,0\n".repeat(100_000);
        assert!(read_points("t", &many, &budget).unwrap_err().to_string().contains("more than 2"));
        let lines = Budget::new(arabesque_core::Limits { nodes: 1000, ..Default::default() });
        assert!(read_points("t", &"\n".repeat(2000), &lines).unwrap_err().to_string().contains("lines"));
    }

    #[test]
    fn written_points_read_back_with_their_recipe() {
        let e = plane("x,y,class\n0,0,\"a,b\"\n1,0,c\n0,1,c\n");
        let placements: Vec<_> = (0..3)
            .map(|source| Placement {
                source,
                transform: arabesque_core::Similarity::shift(Vector::xy(0.5, 0.25)),
                control: Vec::new(),
                frozen: None,
            })
            .collect();
        let text = write_points(&e, &placements, 3.0, Some("seed = 1\n\n[a]\n"));
        let back = plane(&text);
        assert_eq!(back.classes, e.classes);
        assert_eq!(back.elements[1].centre, Vector::xy(1.5, 0.25));
        assert_eq!(recipe_of(&text).unwrap(), "seed = 1\n\n[a]\n");
    }
}
