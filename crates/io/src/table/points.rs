//! CSV: points with attributes, in and out.
//!
//! Read: a header that names the columns in any order and case: `x`, `y` and, in space, `z`; `nx`, `ny`, `nz`; `red`, `green`, `blue`
//! from 0 to 1, to 255 or to 65535; `radius`, `group`, `element`, `class`; each under its usual names ([`crate::geometry`]). Two columns
//! without a header are `x` and `y`. Other columns are passed over with a warning. Written: the same, colours from 0 to 1, and the
//! recipe in comment lines at the end.

use arabesque_core::{Budget, Decimals, Error, PointSet, Result, Warning};

use crate::{
    geometry::{
        Columns, Geometry,
        attributes::{Attribute, NAMES, columns_of, is_known},
    },
    table::records::{PER_BYTE, check_length, fields, is_data, recipe_comments, separator_of},
    text::short::{list, short},
};

/// Work and bytes of one number that is written.
const PER_NUMBER: u64 = 150;
const NUMBER_BYTES: usize = 14;
/// Decimals of shares of colours, and of coordinates of normals.
const SHARE: f64 = 100.0;
const DIRECTION: f64 = 10.0;

/// Reads points with attributes.
///
/// # Errors
/// [`Error::Input`] with the line and the column when a value is no number of its kind, when a coordinate is missing or a line has the
/// wrong number of fields; [`Error::Limit`] for too many lines or when the work or the memory is used up.
pub fn read_table(name: &str, text: &str, budget: &Budget) -> Result<Geometry> {
    let made_up = |fields: usize| match fields {
        2 => Some(["x", "y"].as_slice()),
        _ => None,
    };
    let table =
        Table { name, budget, made_up: &made_up, expected: "two columns, x and y, or a header that names them" };
    table.read(text)?.into_geometry(name, budget)
}

/// How a table of numbers is read.
pub(super) struct Table<'a> {
    pub(super) name: &'a str,
    pub(super) budget: &'a Budget,
    /// The names of so many columns, for a file without a header.
    pub(super) made_up: &'a dyn Fn(usize) -> Option<&'static [&'static str]>,
    /// What is expected of a file without a header.
    pub(super) expected: &'a str,
}

/// The columns of a table, and what is passed over.
pub(super) struct Found {
    pub(super) columns: Columns,
    warnings: Vec<Warning>,
}

impl Found {
    pub(super) fn into_geometry(self, name: &str, budget: &Budget) -> Result<Geometry> {
        let mut geometry = self.columns.into_geometry(name, budget)?;
        geometry.warnings.splice(0..0, self.warnings);
        Ok(geometry)
    }
}

impl Table<'_> {
    /// Reads all lines; `//` starts a comment as `#` does.
    pub(super) fn read(&self, text: &str) -> Result<Found> {
        self.budget.spend(PER_BYTE * text.len() as u64)?;
        let count = text.lines().count();
        self.budget.within(&format!("{}: lines", self.name), count, ("nodes", self.budget.limits().nodes))?;
        let _held = self.budget.hold("lines of the file", count.saturating_mul(size_of::<&str>()))?;
        let mut lines: Vec<&str> = text.lines().collect();
        for line in &mut lines {
            if line.trim_start().starts_with("//") {
                *line = "";
            }
        }
        let Some(first) = lines.iter().position(|line| is_data(line.trim())) else {
            return Err(Error::input(self.name, "no point found", "give one point per line, as x,y or x,y,z"));
        };
        check_length(self.name, first + 1, lines[first], self.budget)?;
        let separator = separator_of(lines[first].trim());
        let Some((head, more)) = fields(lines[first], &lines[first + 1..], separator) else {
            return Err(self.open_quote(first));
        };
        let names: Vec<String> = head.iter().map(|f| f.to_ascii_lowercase()).collect();
        let is_header = names.iter().any(|f| f.parse::<f64>().is_err() && is_known(f));
        let (names, from) = match is_header {
            true => (names, first + 1 + more),
            false => (self.made_up_names(first, &head)?, first),
        };
        self.rows(&lines, from, separator, (names, first))
    }

    fn open_quote(&self, line: usize) -> Error {
        let problem = "a quote that nothing closes, expected one more on this line or after it";
        Error::input(format!("{}: line {}", self.name, line + 1), problem, "close the quote, or remove it")
    }

    fn made_up_names(&self, line: usize, head: &[String]) -> Result<Vec<String>> {
        let place = format!("{}: line {}", self.name, line + 1);
        if let Some(word) = head.iter().find(|word| word.parse::<f64>().is_err()) {
            let problem = format!("\"{}\" is neither a number nor the name of a column", short(word));
            return Err(Error::input(place, problem, "start with a header such as x,y,z"));
        }
        match (self.made_up)(head.len()) {
            Some(names) => Ok(names.iter().map(|&n| n.to_owned()).collect()),
            None => {
                let problem = format!("{} columns without a header, expected {}", head.len(), self.expected);
                Err(Error::input(place, problem, "add a header that names them, such as x,y,z,nx,ny,nz"))
            }
        }
    }

    fn rows(
        &self,
        lines: &[&str],
        from: usize,
        separator: Option<char>,
        (names, header): (Vec<String>, usize),
    ) -> Result<Found> {
        let mut found = columns_of(&names);
        self.without_words(&mut found, &lines[from..], separator);
        for axis in [0, 1].map(Attribute::Position) {
            if found[axis.index()].is_none() {
                let problem = format!("no column {} among {}", axis.name(), list(&names));
                let place = format!("{}: line {}", self.name, header + 1);
                return Err(Error::input(place, problem, "name the columns x, y and, in space, z"));
            }
        }
        let used: Vec<(Attribute, usize)> = NAMES.iter().filter_map(|(a, _)| Some((*a, found[a.index()]?))).collect();
        let count = lines[from..].iter().filter(|line| is_data(line.trim())).count();
        let mut columns = Columns::with_room(found.map(|k| k.is_some()), count, self.budget)?;
        let mut at = from;
        while let Some(line) = lines.get(at) {
            at += 1;
            if !is_data(line.trim()) {
                continue;
            }
            let number = at;
            check_length(self.name, number, line, self.budget)?;
            let Some((fields, more)) = fields(line, &lines[at..], separator) else {
                return Err(self.open_quote(number - 1));
            };
            at += more;
            self.row(number, &fields, &names, &used, &mut columns)?;
        }
        let passed: Vec<&String> = (0..names.len()).filter(|k| !found.contains(&Some(*k))).map(|k| &names[k]).collect();
        let message = format!("{}: columns passed over: {}", self.name, list(&passed));
        let warning = Warning::new(message, "nothing need be done if they do not matter");
        let warnings = if passed.is_empty() { Vec::new() } else { vec![warning] };
        Ok(Found { columns, warnings })
    }

    /// Classes that are words are passed over, as any column is that says nothing of points by a number.
    fn without_words(&self, found: &mut [Option<usize>; NAMES.len()], lines: &[&str], separator: Option<char>) {
        let class = &mut found[Attribute::Class.index()];
        let first = lines.iter().position(|line| is_data(line.trim()));
        if let (Some(k), Some(at)) = (*class, first)
            && let Some((fields, _)) = fields(lines[at], &lines[at + 1..], separator)
            && fields.get(k).is_some_and(|text| text.parse::<f64>().is_err())
        {
            *class = None;
        }
    }

    fn row(
        &self,
        line: usize,
        fields: &[String],
        names: &[String],
        used: &[(Attribute, usize)],
        columns: &mut Columns,
    ) -> Result<()> {
        let fail = |column: Option<usize>, problem: String, advice: &str| {
            let column = column.map(|k| format!(", column {}", short(&names[k]))).unwrap_or_default();
            Error::input(format!("{}: line {line}{column}", self.name), problem, advice)
        };
        if fields.len() != names.len() {
            let problem = format!("{} fields where {} were expected ({})", fields.len(), names.len(), list(names));
            return Err(fail(None, problem, "give every line the same fields"));
        }
        for &(attribute, k) in used {
            let text = &fields[k];
            let value: f64 = text.parse().map_err(|_| {
                let problem = format!("\"{}\" is not a number", short(text));
                fail(Some(k), problem, "write numbers like 12.5 or 1.25e1")
            })?;
            let checked = attribute.checked(value, || text.clone(), self.budget.limits());
            let value = checked.map_err(|(problem, advice)| fail(Some(k), problem, advice))?;
            columns.values[attribute.index()].push(value);
        }
        Ok(())
    }
}

/// Writes points with all their attributes, one per line, with six significant digits of their extent. `recipe` follows in comment
/// lines.
///
/// # Errors
/// [`Error::Limit`] when the work or the memory is used up, [`Error::Stopped`] when somebody asked to stop.
pub fn write_table<const D: usize>(points: &PointSet<D>, recipe: Option<&str>, budget: &Budget) -> Result<String> {
    let has = [
        true,
        points.normals.is_some(),
        points.colours.is_some(),
        points.radii.is_some(),
        points.groups.is_some(),
        points.elements.is_some(),
        points.classes.is_some(),
    ];
    let is_written = |attribute: &Attribute| match *attribute {
        Attribute::Position(k) => k < D,
        Attribute::Normal(k) => has[1] && k < D,
        Attribute::Colour(_) => has[2],
        Attribute::Radius => has[3],
        Attribute::Group => has[4],
        Attribute::Element => has[5],
        Attribute::Class => has[6],
    };
    let written: Vec<Attribute> = NAMES.iter().map(|(a, _)| *a).filter(is_written).collect();
    let bytes = points.len().saturating_mul(written.len() * NUMBER_BYTES);
    let _held = budget.hold("the text of the points", bytes)?;
    let extent = points.bounds().size().0.into_iter().fold(0.0, f64::max);
    let [place, share, direction] = [extent, SHARE, DIRECTION].map(Decimals::for_extent);
    let mut out = written.iter().map(|a| a.name()).collect::<Vec<_>>().join(",");
    out.push('\n');
    let mut meter = budget.meter();
    for n in 0..points.len() {
        meter.spend(PER_NUMBER * written.len() as u64)?;
        for (k, attribute) in written.iter().enumerate() {
            let value = |list: &Option<Vec<i32>>| list.as_ref().map_or(String::new(), |list| list[n].to_string());
            let text = match *attribute {
                Attribute::Position(axis) => place.format(points.positions[n][axis]),
                Attribute::Normal(axis) => {
                    points.normals.as_ref().map_or(String::new(), |v| direction.format(v[n][axis]))
                }
                Attribute::Colour(c) => points.colours.as_ref().map_or(String::new(), |v| share.format(v[n][c])),
                Attribute::Radius => points.radii.as_ref().map_or(String::new(), |v| place.plus(2).format(v[n])),
                Attribute::Group => value(&points.groups),
                Attribute::Element => value(&points.elements),
                Attribute::Class => value(&points.classes),
            };
            out.push_str(if k == 0 { "" } else { "," });
            out.push_str(&text);
        }
        out.push('\n');
    }
    Ok(out + &recipe.map(recipe_comments).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Limits, Vector};
    use proptest::prelude::*;

    use super::*;
    use crate::{geometry::Cloud, table::records::recipe_of};

    fn read(text: &str) -> Result<Geometry> {
        read_table("a.csv", text, &Budget::default())
    }

    #[test]
    fn columns_come_in_any_order_and_case() {
        let geometry = read("# made by hand\nGroup;Y;X;Note\n3;1;2;\"a;b\"\n4;5;6;\"c\nd\"\n").unwrap();
        let Cloud::Plane(points) = geometry.points else { panic!("no z was given") };
        assert_eq!(points.positions, [Vector::xy(2.0, 1.0), Vector::xy(6.0, 5.0)]);
        assert_eq!(points.groups, Some(vec![3, 4]));
        assert_eq!(geometry.warnings[0].message, "a.csv: columns passed over: note");
    }

    #[test]
    fn classes_are_numbers_and_words_are_passed_over() {
        let Cloud::Plane(points) = read("x,y,class\n0,0,2\n1,0,-1\n").unwrap().points else { panic!("no z was given") };
        assert_eq!(points.classes, Some(vec![2, -1]));
        let words = read("x,y,class\n0,0,leaf\n1,0,stem\n").unwrap();
        assert_eq!(words.warnings[0].message, "a.csv: columns passed over: class");
        assert!(read("x,y,class\n0,0,1\n1,0,stem\n").unwrap_err().to_string().contains("is not a number"));
    }

    #[test]
    fn two_columns_need_no_header_and_z_makes_space() {
        assert!(matches!(read("0 0\n1 0\n").unwrap().points, Cloud::Plane(p) if p.len() == 2));
        assert!(matches!(read("x\ty\tz\n0\t0\t1\n").unwrap().points, Cloud::Space(p) if p.len() == 1));
    }

    #[test]
    fn bad_lines_are_named() {
        for (text, expected) in [
            ("x,y\n0,0\n1,nan\n", "a.csv: line 3, column y: nan where a coordinate"),
            ("x,y\n0,1e300\n", "line 2, column y: 1e300 where"),
            ("x,y,radius\n0,0,-1\n", "line 2, column radius: -1 where a radius"),
            ("x,y,element\n0,0,1.5\n", "line 2, column element: 1.5 where a whole number"),
            ("x,y,red,green,blue\n0,0,1,2,700000\n", "column blue: 700000 where 0 to 1"),
            ("x,y\n0,zero\n", "\"zero\" is not a number"),
            ("x,y,radius\n0,0,\n", "\"\" is not a number"),
            ("x,y\n0,0\n1\n", "line 3: 1 fields where 2 were expected (x, y)"),
            ("x,nx\n0,1\n", "line 1: no column y among x, nx"),
            ("", "no point found"),
            ("# nothing\n", "no point found"),
            ("x,y\n", "without a coordinate x"),
            ("1,2,3\n", "3 columns without a header, expected two columns"),
            ("hello\n", "neither a number nor the name"),
            ("x,y,\"z\n", "line 1: a quote that nothing closes"),
            ("x,y,note\n1,2,\"z\n", "line 2: a quote that nothing closes"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(expected) && message.len() < 300, "{text:?}: {message}");
        }
    }

    #[test]
    fn limits_hold() {
        for limits in [
            Limits { nodes: 2, ..Limits::default() },
            Limits { memory: 20, ..Limits::default() },
            Limits { work: 0, ..Limits::default() },
        ] {
            let read = read_table("a", "x,y\n0,0\n1,1\n", &Budget::new(limits));
            assert!(matches!(read, Err(Error::Limit { .. })), "{limits:?}");
        }
    }

    proptest! {
        #[test]
        fn what_is_written_is_read_again(
            list in prop::collection::vec((0..4096_i32, 0..4096_i32, any::<[u8; 3]>(), any::<i32>()), 1..20),
            has: [bool; 6],
        ) {
            // The first two corners make the extent the same each time.
            let corners = [(0, 0, [0; 3], 0), (4096, 0, [255; 3], 1)];
            let list: Vec<_> = corners.into_iter().chain(list).collect();
            let points = PointSet::<2> {
                positions: list.iter().map(|p| Vector::xy(f64::from(p.0), f64::from(p.1)) * 0.25).collect(),
                normals: has[0].then(|| list.iter().map(|p| Vector::xy(f64::from(p.3.signum() | 1), 0.0)).collect()),
                colours: has[1].then(|| list.iter().map(|p| p.2.map(|c| (f64::from(c) / 255.0 * 1e4).round() / 1e4)).collect()),
                radii: has[2].then(|| list.iter().map(|p| f64::from(p.0 + 1) * 0.125).collect()),
                groups: has[3].then(|| list.iter().map(|p| p.3).collect()),
                elements: has[4].then(|| list.iter().map(|p| p.1).collect()),
                classes: has[5].then(|| list.iter().map(|p| p.0).collect()),
            };
            let text = write_table(&points, Some("seed = 1\n"), &Budget::default()).unwrap();
            prop_assert_eq!(recipe_of(&text), Some("seed = 1\n".to_owned()));
            let back = read(&text).unwrap();
            prop_assert!(back.warnings.is_empty());
            prop_assert_eq!(back.points, Cloud::Plane(points));
        }
    }
}
