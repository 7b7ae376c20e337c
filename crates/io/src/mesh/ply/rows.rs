//! The rows of the elements of a PLY file, from text or bytes.

use arabesque_core::{Budget, Error, Meter, Result};

use super::{
    header::{Element, Header, Order, Property},
    scalar::Scalar,
};
use crate::text::short::short;

/// Work of one number in text and in bytes.
const PER_WORD: u64 = 40;
const PER_NUMBER: u64 = 6;

/// A row of an element.
#[derive(Debug, Default)]
pub(super) struct Row {
    /// The numbers, by property; the lengths of lists.
    pub(super) numbers: Vec<f64>,
    /// The items of the list that was asked for.
    pub(super) items: Vec<f64>,
}

/// Where the data of a file are read.
#[derive(Debug)]
pub(super) struct Rows<'a> {
    name: &'a str,
    bytes: &'a [u8],
    order: Order,
    at: usize,
    /// Number of the next line of text.
    line: usize,
    meter: Meter<'a>,
}

impl<'a> Rows<'a> {
    pub(super) fn new(name: &'a str, bytes: &'a [u8], header: &Header, budget: &'a Budget) -> Self {
        Self { name, bytes, order: header.order, at: header.data, line: header.line, meter: budget.meter() }
    }

    /// Refuses an element with more rows than the rest of the file can hold, before anything is made for them.
    pub(super) fn check_room(&self, element: &Element) -> Result<()> {
        let least = element.least_bytes(self.order);
        // The last number of a text need not be parted from anything.
        let left = self.bytes.len() - self.at + usize::from(self.order == Order::Text);
        if least.checked_mul(element.count).is_some_and(|needed| needed <= left) {
            return Ok(());
        }
        let problem = format!(
            "{} rows of element {} where there is room for {} at most",
            element.count,
            short(&element.name),
            left / least.max(1)
        );
        let advice = "correct the count in the header; the file may have been cut off";
        Err(Error::input(self.name, problem, advice))
    }

    /// Reads all rows of an element, and hands each over with its number, counted from 0, and the place of its values in the file.
    /// `list` is the property whose items are kept.
    pub(super) fn each(
        &mut self,
        element: &Element,
        list: Option<usize>,
        mut take: impl FnMut(usize, &Row, &dyn Fn() -> String) -> Result<()>,
    ) -> Result<()> {
        self.check_room(element)?;
        if element.properties.is_empty() {
            return Ok(());
        }
        let mut row = Row { numbers: vec![0.0; element.properties.len()], items: Vec::new() };
        for number in 0..element.count {
            row.items.clear();
            match self.order {
                Order::Text => self.text_row(element, number, list, &mut row)?,
                _ => self.binary_row(element, number, list, &mut row)?,
            }
            let line = (self.order == Order::Text).then_some(self.line - 1);
            take(number, &row, &|| place_of(self.name, element, line, number))?;
        }
        Ok(())
    }

    /// What stands behind the last element: lines of text, or bytes.
    pub(super) fn left_over(&self) -> Option<String> {
        let rest = &self.bytes[self.at..];
        if rest.iter().all(u8::is_ascii_whitespace) {
            return None;
        }
        Some(match self.order {
            Order::Text => format!("{} lines", String::from_utf8_lossy(rest).trim().lines().count()),
            _ => format!("{} bytes", rest.len()),
        })
    }

    fn binary_row(&mut self, element: &Element, number: usize, list: Option<usize>, row: &mut Row) -> Result<()> {
        let big = self.order == Order::BigEndian;
        for (k, property) in element.properties.iter().enumerate() {
            self.meter.spend(PER_NUMBER)?;
            let kind = property.length.unwrap_or(property.kind);
            let Some(value) = kind.decode(&self.bytes[self.at..], big) else {
                return self.cut_off(element, number, property);
            };
            self.at += kind.size();
            row.numbers[k] = value;
            if property.length.is_none() {
                continue;
            }
            let size = property.kind.size();
            let left = (self.bytes.len() - self.at) / size;
            if !(0.0..=left as f64).contains(&value) {
                let problem = format!(
                    "a list {} of length {value} where there is room for {left} items at most",
                    short(&property.name)
                );
                let advice = "write the file again; it is damaged, or has other types than its header says";
                return Err(Error::input(place_of(self.name, element, None, number), problem, advice));
            }
            let items = &self.bytes[self.at..self.at + value as usize * size];
            self.at += items.len();
            self.meter.spend(PER_NUMBER * value as u64)?;
            if list == Some(k) {
                row.items.extend(items.chunks_exact(size).filter_map(|item| property.kind.decode(item, big)));
            }
        }
        Ok(())
    }

    fn cut_off<T>(&self, element: &Element, number: usize, property: &Property) -> Result<T> {
        let problem = format!("the file ends before {}", short(&property.name));
        let advice = "correct the count in the header; the file may have been cut off";
        Err(Error::input(place_of(self.name, element, None, number), problem, advice))
    }

    /// The next line that is not blank.
    fn next_line(&mut self) -> Option<&'a [u8]> {
        while self.at < self.bytes.len() {
            let rest = &self.bytes[self.at..];
            let length = rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len());
            let end = if rest[length..].starts_with(b"\r\n") { 2 } else { 1 };
            self.at = (self.at + length + end).min(self.bytes.len());
            self.line += 1;
            if !rest[..length].iter().all(u8::is_ascii_whitespace) {
                return Some(&rest[..length]);
            }
        }
        None
    }

    fn text_row(&mut self, element: &Element, number: usize, list: Option<usize>, row: &mut Row) -> Result<()> {
        let Some(line) = self.next_line() else {
            return self.cut_off(element, number, &element.properties[0]);
        };
        let fail = |problem: String, advice: &str| -> Error {
            Error::input(format!("{}: line {}", self.name, self.line - 1), problem, advice)
        };
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        let mut next = |kind: Scalar, property: &Property| -> Result<f64> {
            self.meter.spend(PER_WORD)?;
            let what = short(&property.name);
            let Some(word) = words.next() else {
                let problem = format!("the line ends before {what} of element {}", short(&element.name));
                return Err(fail(problem, "give every line all values that the header names"));
            };
            let word = std::str::from_utf8(word).unwrap_or("?");
            kind.parse(word).ok_or_else(|| {
                let problem =
                    format!("{what} is \"{}\" where a number of type {} was expected", short(word), kind.name());
                fail(problem, "correct the value, or the type in the header")
            })
        };
        for (k, property) in element.properties.iter().enumerate() {
            let value = next(property.length.unwrap_or(property.kind), property)?;
            row.numbers[k] = value;
            if property.length.is_none() {
                continue;
            }
            if !(0.0..=line.len() as f64).contains(&value) {
                let problem = format!(
                    "a list {} of length {value} in a line of {} characters",
                    short(&property.name),
                    line.len()
                );
                return Err(fail(problem, "correct the length of the list"));
            }
            for _ in 0..value as usize {
                let item = next(property.kind, property)?;
                if list == Some(k) {
                    row.items.push(item);
                }
            }
        }
        if words.next().is_some() {
            let problem = format!("more values than element {} has", short(&element.name));
            return Err(fail(problem, "correct the line, or the properties in the header"));
        }
        Ok(())
    }
}

/// Where a row stands: its line in text, its number among bytes.
fn place_of(name: &str, element: &Element, line: Option<usize>, number: usize) -> String {
    match line {
        Some(line) => format!("{name}: line {line}"),
        None => format!("{name}: {} {number}, counted from 0", short(&element.name)),
    }
}
