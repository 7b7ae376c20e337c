//! The header of a PLY file: its elements and their properties.

use std::collections::BTreeSet;

use arabesque_core::{Budget, Error, Result};

use super::scalar::Scalar;
use crate::text::short::{list, short};

/// Work for each byte of the header.
const PER_BYTE: u64 = 4;

/// How the numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    Text,
    LittleEndian,
    BigEndian,
}

/// A property of an element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Property {
    /// Its name in lower case.
    pub(super) name: String,
    pub(super) kind: Scalar,
    /// The type of the length, for a list.
    pub(super) length: Option<Scalar>,
}

/// An element: a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// Bytes of a row at least; in text every number takes one, and one that parts it from the next.
    pub(super) fn least_bytes(&self, order: Order) -> usize {
        let of = |p: &Property| match order {
            Order::Text => 2,
            _ => p.length.unwrap_or(p.kind).size(),
        };
        self.properties.iter().map(of).sum()
    }
}

/// What stands above the data.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) order: Order,
    pub(super) elements: Vec<Element>,
    /// Where the data begin, and the number of their first line.
    pub(super) data: usize,
    pub(super) line: usize,
}

/// Reads the header.
///
/// # Errors
/// [`Error::Input`] with the line for what is no header; those of the budget.
pub(super) fn read_header(name: &str, bytes: &[u8], budget: &Budget) -> Result<Header> {
    let mut lines = Lines::new(bytes);
    if bytes.is_empty() {
        return Err(Error::input(name, "an empty file", "give a PLY file"));
    }
    if lines.next().is_none_or(|first| first.trim_end() != "ply") {
        return Err(Error::input(name, "a file that does not begin with the word ply", "give a PLY file"));
    }
    let mut reader = Reader { name, line: 1, order: None, elements: Vec::new(), names: BTreeSet::new() };
    while let Some(content) = lines.next() {
        reader.line += 1;
        budget.spend(PER_BYTE * content.len() as u64)?;
        budget.within(&format!("{name}: lines of the header"), reader.line, ("nodes", budget.limits().nodes))?;
        // No statement has more words than a list; more of them show that it is none.
        let words: Vec<&str> = content.split_ascii_whitespace().take(6).collect();
        match words[..] {
            ["end_header"] => return reader.finish(lines.at),
            [] | ["comment" | "obj_info", ..] => {}
            ["format", ref rest @ ..] => reader.format(rest)?,
            ["element", ref rest @ ..] => reader.element(rest)?,
            ["property", ref rest @ ..] => reader.property(rest)?,
            [word, ..] => {
                let problem = format!(
                    "\"{}\" where one of format, comment, element, property and end_header was expected",
                    short(word)
                );
                return reader.fail(problem, "correct or remove the line");
            }
        }
    }
    reader.fail("a header that nothing ends", "close it with a line end_header; the file may have been cut off")
}

/// The text of a comment line.
fn comment(line: &str) -> &str {
    let rest = line.trim_start().strip_prefix("comment").unwrap_or_default();
    rest.strip_prefix([' ', '\t']).unwrap_or(rest)
}

/// The comments of a file, as far as its header can be read.
pub(super) fn comments(bytes: &[u8]) -> Vec<String> {
    let lines = Lines::new(bytes).take_while(|line| line.trim() != "end_header");
    lines.filter(|line| line.trim_start().starts_with("comment")).map(|line| comment(&line).to_owned()).collect()
}

/// Lines that end with a line feed, a carriage return, or both, as the first one does.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    /// What ends a line.
    end: &'static [u8],
}

impl<'a> Lines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        let first = bytes.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(0);
        let end: &[u8] = match bytes.get(first..first + 2) {
            Some(b"\r\n") => b"\r\n",
            Some([b'\r', _]) => b"\r",
            _ => b"\n",
        };
        Self { bytes, at: 0, end }
    }
}

impl Iterator for Lines<'_> {
    type Item = String;

    /// The next line without its end; none behind the last end. Text that is not UTF-8 shows a mark in the place of what is not.
    fn next(&mut self) -> Option<String> {
        let rest = &self.bytes[self.at..];
        let last = *self.end.last()?;
        let length = rest.iter().position(|b| *b == last)?;
        self.at += length + 1;
        let line = rest[..length].strip_suffix(b"\r").unwrap_or(&rest[..length]);
        Some(String::from_utf8_lossy(line).into_owned())
    }
}

struct Reader<'a> {
    name: &'a str,
    line: usize,
    order: Option<Order>,
    elements: Vec<Element>,
    /// The elements so far, and the properties of the last one, each with its element.
    names: BTreeSet<(Option<usize>, String)>,
}

impl Reader<'_> {
    fn fail<T>(&self, problem: impl Into<String>, advice: &str) -> Result<T> {
        Err(Error::input(format!("{}: line {}", self.name, self.line), problem, advice))
    }

    fn format(&mut self, words: &[&str]) -> Result<()> {
        const KNOWN: [(&str, Order); 3] = [
            ("ascii", Order::Text),
            ("binary_little_endian", Order::LittleEndian),
            ("binary_big_endian", Order::BigEndian),
        ];
        let [word, version] = words else {
            return self.fail("a format without a version", "write it as format ascii 1.0");
        };
        let Some((_, order)) = KNOWN.iter().find(|(known, _)| known == word) else {
            let problem = format!("format {} where one of {} was expected", short(word), list(KNOWN.map(|(k, _)| k)));
            return self.fail(problem, "save the file as ASCII or binary PLY");
        };
        if *version != "1.0" {
            let problem = format!("version {} where 1.0 was expected", short(version));
            return self.fail(problem, "save the file as PLY 1.0");
        }
        if self.order.replace(*order).is_some() {
            return self.fail("a second format", "leave one of the lines out");
        }
        Ok(())
    }

    fn element(&mut self, words: &[&str]) -> Result<()> {
        let [name, count] = words else {
            return self.fail("an element without a name or a count", "write it as element vertex 100");
        };
        let Ok(number) = count.parse::<usize>() else {
            let problem = format!("{} where a number of {} was expected", short(count), short(name));
            return self.fail(problem, "write how many there are, as 100");
        };
        let name = name.to_ascii_lowercase();
        if !self.names.insert((None, name.clone())) {
            return self.fail(format!("a second element {}", short(&name)), "give each element a name of its own");
        }
        self.elements.push(Element { name, count: number, properties: Vec::new() });
        Ok(())
    }

    fn property(&mut self, words: &[&str]) -> Result<()> {
        let (kind, length, name) = match words {
            [kind, name] => (self.kind(kind)?, None, name),
            ["list", length, kind, name] => {
                let length = self.kind(length)?;
                if !length.is_whole() {
                    let problem = format!("a list whose length is of type {}", length.name());
                    return self.fail(problem, "use a type of whole numbers, such as uchar");
                }
                (self.kind(kind)?, Some(length), name)
            }
            _ => {
                let advice = "write it as property float x, or property list uchar int vertex_indices";
                return self.fail("a property that is neither a number nor a list", advice);
            }
        };
        let number = self.elements.len();
        let Some(element) = self.elements.last_mut() else {
            return self.fail("a property before any element", "begin with a line such as element vertex 100");
        };
        let name = name.to_ascii_lowercase();
        if !self.names.insert((Some(number), name.clone())) {
            let problem = format!("a second property {} of element {}", short(&name), short(&element.name));
            return self.fail(problem, "give each property a name of its own");
        }
        element.properties.push(Property { name, kind, length });
        Ok(())
    }

    fn kind(&self, word: &str) -> Result<Scalar> {
        Scalar::named(word).map_or_else(
            || {
                let names: Vec<_> = Scalar::names().collect();
                let problem = format!("type {} where one of {} was expected", short(word), names.join(", "));
                self.fail(problem, "save the file with usual types")
            },
            Ok,
        )
    }

    fn finish(self, data: usize) -> Result<Header> {
        match self.order {
            Some(order) => {
                let Self { line, elements, .. } = self;
                Ok(Header { order, elements, data, line: line + 1 })
            }
            None => self.fail("a header without a format", "add a line such as format ascii 1.0"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Header> {
        read_header("a.ply", text.as_bytes(), &Budget::default())
    }

    const CUBE: &str = "ply\nformat ascii 1.0\ncomment  made by hand\nelement vertex 8\nproperty float x\nproperty \
         list uchar int other\nelement face 6\nproperty list uint8 int32 vertex_indices\nobj_info x\nend_header\n1 2";

    #[test]
    fn many_elements_and_properties_take_little() {
        let names: String =
            (0..20_000).map(|k| format!("element e{k} 0\nproperty int a{k}\nproperty int b\n")).collect();
        let text = format!("ply\nformat ascii 1.0\n{names}comment {}\nend_header\n", "a ".repeat(100_000));
        assert_eq!(read(&text).unwrap().elements.len(), 20_000);
    }

    #[test]
    fn elements_properties_and_comments_are_read() {
        let header = read(CUBE).unwrap();
        assert_eq!((header.order, header.line, &CUBE[header.data..]), (Order::Text, 11, "1 2"));
        assert_eq!(comments(CUBE.as_bytes()), [" made by hand"]);
        assert_eq!(header.elements[0].properties[1].length, Some(Scalar::U8));
        assert_eq!((header.elements[1].name.as_str(), header.elements[1].count), ("face", 6));
        assert_eq!(header.elements[0].least_bytes(Order::LittleEndian), 5);
    }

    #[test]
    fn lines_end_as_the_first_one_does() {
        let of = |end: &str| CUBE.replace('\n', end);
        let expected = read(CUBE).unwrap();
        for end in ["\r\n", "\r"] {
            let text = of(end);
            let header = read(&text).unwrap();
            assert_eq!(&text[header.data..], "1 2");
            assert_eq!(Header { data: expected.data, ..header }, expected);
        }
        // A first byte of data that looks like the end of a line stays with the data.
        let data = b"ply\nformat binary_little_endian 1.0\nend_header\n\r\n";
        assert_eq!(read_header("a", data, &Budget::default()).unwrap().data, data.len() - 2);
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        let with = |lines: &str| format!("ply\nformat ascii 1.0\n{lines}\nend_header\n");
        for (text, expected) in [
            ("solid a\n".to_owned(), "a.ply: a file that does not begin with the word ply"),
            ("ply\nend_header\n".to_owned(), "a header without a format"),
            ("ply\nformat ascii 1.0\nelement vertex 1\n".to_owned(), "line 3: a header that nothing ends"),
            ("ply\nformat text 1.0\nend_header\n".to_owned(), "line 2: format text where one of ascii"),
            ("ply\nformat ascii 2.0\nend_header\n".to_owned(), "version 2.0"),
            ("ply\nformat ascii\nend_header\n".to_owned(), "a format without a version"),
            (with("format ascii 1.0"), "a second format"),
            (with("element vertex -3"), "line 3: -3 where a number of vertex was expected"),
            (with("element vertex 99999999999999999999999"), "999 where a number of vertex"),
            (with("element vertex"), "an element without a name or a count"),
            (with("element vertex 1\nelement vertex 2"), "a second element vertex"),
            (with("property float x"), "a property before any element"),
            (with("element vertex 1\nproperty half x"), "type half where one of char, uchar"),
            (with("element vertex 1\nproperty list float int x"), "a list whose length is of type float"),
            (with("element vertex 1\nproperty list uchar int"), "neither a number nor a list"),
            (with("element vertex 1\nproperty float x\nproperty double X"), "a second property x"),
            (with("elements vertex 1"), "\"elements\" where one of format"),
        ] {
            let message = read(&text).unwrap_err().to_string();
            assert!(message.contains(expected), "{text:?}: {message}");
        }
    }
}
