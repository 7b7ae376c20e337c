//! STL as text: `solid`, `facet normal`, `outer loop`, three times `vertex`, and their ends.

use arabesque_core::{Budget, Error, Result, Vector};

use super::weld::Welded;
use crate::{
    geometry::{Geometry, attributes::Attribute},
    text::short::short,
};

/// Work for each byte.
const PER_BYTE: u64 = 10;

pub(super) fn read(name: &str, text: &str, budget: &Budget) -> Result<Geometry> {
    let mut reader =
        Reader { name, budget, line: 0, welded: Welded::new(budget), normal: Vector::ZERO, corners: Vec::new() };
    for content in text.lines() {
        reader.line += 1;
        budget.spend(PER_BYTE * content.len() as u64)?;
        reader.statement(content)?;
    }
    if !reader.corners.is_empty() {
        return reader.fail("the file ends within a triangle", "the file may have been cut off; write it again");
    }
    reader.welded.finish((name, "line"), Vec::new())
}

struct Reader<'a> {
    name: &'a str,
    budget: &'a Budget,
    line: usize,
    welded: Welded<'a>,
    normal: Vector<3>,
    corners: Vec<Vector<3>>,
}

impl Reader<'_> {
    fn fail<T>(&self, problem: impl Into<String>, advice: &str) -> Result<T> {
        Err(Error::input(format!("{}: line {}", self.name, self.line), problem, advice))
    }

    fn statement(&mut self, content: &str) -> Result<()> {
        let content = content.trim();
        let (keyword, rest) = content.split_once(char::is_whitespace).unwrap_or((content, ""));
        match keyword.to_ascii_lowercase().as_str() {
            "" | "outer" | "endloop" | "endsolid" => Ok(()),
            "solid" => {
                self.welded.begin_part(rest.trim());
                Ok(())
            }
            "facet" => {
                // A normal that is none counts for nothing, and many programs write one.
                let words: Vec<f64> = rest.split_whitespace().skip(1).take(3).filter_map(|w| w.parse().ok()).collect();
                self.normal = words.try_into().map_or(Vector::ZERO, Vector);
                Ok(())
            }
            "vertex" => self.vertex(rest),
            "endfacet" => self.triangle(),
            _ => {
                let problem = format!("\"{}\" where facet, vertex or their ends were expected", short(keyword));
                self.fail(problem, "give an STL file, or correct the line")
            }
        }
    }

    fn vertex(&mut self, rest: &str) -> Result<()> {
        let mut corner = Vector::ZERO;
        let mut words = rest.split_whitespace();
        for axis in 0..3 {
            let Some(word) = words.next() else {
                return self.fail(format!("a vertex of {axis} numbers"), "write it as vertex 1 2 3");
            };
            let Ok(value) = word.parse::<f64>() else {
                let problem = format!("\"{}\" is not a number", short(word));
                return self.fail(problem, "write numbers like 12.5 or 1.25e1");
            };
            let checked = Attribute::Position(axis).checked(value, || word.to_owned(), self.budget.limits());
            corner[axis] = checked.or_else(|(problem, advice)| self.fail(problem, advice))?;
        }
        self.corners.push(corner);
        match self.corners.len() {
            0..=3 => Ok(()),
            _ => self.fail("a triangle of more than three vertices", "cut the face into triangles"),
        }
    }

    fn triangle(&mut self) -> Result<()> {
        let found = self.corners.len();
        let Ok(corners) = std::mem::take(&mut self.corners).try_into() else {
            return self.fail(format!("a triangle of {found} vertices"), "give it three");
        };
        let limit = ("nodes", self.budget.limits().nodes);
        self.budget.within(&format!("{}: triangles", self.name), self.welded.len() + 1, limit)?;
        self.welded.push(self.line, self.normal, corners)
    }
}
