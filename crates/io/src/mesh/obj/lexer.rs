//! The text of an OBJ file as statements, and the words of statements as numbers, with errors that name the line.
//!
//! Nothing here knows what is read of a file: polylines now, and whatever else refers to numbered vertices.

use arabesque_core::{Budget, Error, Limits, Result, Vector};

use crate::{table::records, text::short::short};

/// Lines without comments, joined where a backslash continues them, with the number of their first line. Box comments
/// stay.
pub(crate) fn logical_lines(text: &str) -> impl Iterator<Item = (usize, String)> {
    // The recipe of a result has a box of its own.
    let mut own = text.lines().take_while(|line| *line != records::RECIPE_MARK).enumerate();
    std::iter::from_fn(move || {
        let (first, raw) = own.next()?;
        let (content, mut more) = content_of(raw);
        let mut line = content.to_owned();
        while more && let Some((_, raw)) = own.next() {
            let (content, goes_on) = content_of(raw);
            line.push(' ');
            line.push_str(content);
            more = goes_on;
        }
        Some((first + 1, line))
    })
}

/// A line without its comment, and whether the next one belongs to it.
fn content_of(raw: &str) -> (&str, bool) {
    let content = match raw.split_once('#') {
        Some((before, comment)) if before.trim().is_empty() && is_box(comment) => raw.trim(),
        Some((before, _)) => before.trim(),
        None => raw.trim(),
    };
    content.strip_suffix('\\').map_or((content, false), |content| (content, true))
}

fn is_box(comment: &str) -> bool {
    comment.split_whitespace().next() == Some("box")
}

/// Reads the words of statements.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lexer<'a> {
    /// Name of the file, for messages.
    pub(crate) name: &'a str,
    pub(crate) budget: &'a Budget,
    /// What to do about a file beyond a limit.
    pub(crate) advice: &'a str,
}

impl Lexer<'_> {
    /// An error in a line.
    pub(crate) fn fail<T>(&self, line: usize, problem: impl Into<String>, advice: &str) -> Result<T> {
        Err(Error::input(format!("{}: line {line}", self.name), problem, advice))
    }

    /// A coordinate within the limits.
    pub(crate) fn coordinate(&self, line: usize, word: &str) -> Result<f64> {
        let most = self.budget.limits().coordinate;
        match word.parse::<f64>() {
            Ok(v) if v.is_finite() && v.abs() <= most => Ok(v),
            Ok(v) => {
                let problem = format!("{} where a coordinate between -{most} and {most} was expected", short(word));
                let raising = Limits::raising("coordinate", v.abs());
                self.fail(line, problem, &format!("correct or remove the vertex{raising}"))
            }
            Err(_) => {
                self.fail(line, format!("\"{}\" is not a number", short(word)), "write numbers like 12.5 or 1.25e1")
            }
        }
    }

    /// Three coordinates; a weight or a colour after them is passed over.
    pub(crate) fn vertex(&self, line: usize, words: &[&str]) -> Result<Vector<3>> {
        if !matches!(words.len(), 3 | 4 | 6 | 7) {
            return self.fail(line, format!("a vertex of {} numbers", words.len()), "write it as v x y z");
        }
        let mut p = Vector::ZERO;
        for (k, word) in words.iter().enumerate() {
            let v = self.coordinate(line, word)?;
            if k < 3 {
                p[k] = v;
            }
        }
        Ok(p)
    }

    /// A vertex counted from zero: `3`, `-1` for the last one so far, `3/7` with a texture vertex. It may follow later
    /// in the file.
    pub(crate) fn index(&self, line: usize, word: &str, so_far: usize) -> Result<usize> {
        let number = word.split('/').next().and_then(|n| n.parse::<i64>().ok());
        let index = match number {
            Some(n) if n > 0 => usize::try_from(n - 1).ok(),
            Some(n) if n < 0 => usize::try_from(n.unsigned_abs()).ok().and_then(|n| so_far.checked_sub(n)),
            _ => None,
        };
        let problem = || {
            format!(
                "\"{}\" is not a vertex: expected 1, 2, ... or -1 to -{so_far} for the last ones so far",
                short(word)
            )
        };
        index.map_or_else(|| self.fail(line, problem(), "correct the number of the vertex"), Ok)
    }

    /// Refuses more of something than `times` the limit of that name.
    pub(crate) fn check_limit(
        &self,
        what: &str,
        found: usize,
        (name, each): (&str, usize),
        times: usize,
    ) -> Result<()> {
        let limit = each.saturating_mul(times);
        if found <= limit {
            return Ok(());
        }
        Err(Error::Limit {
            what: format!("{}: number of {what}", self.name),
            found: found.to_string(),
            limit: limit.to_string(),
            advice: format!("{}{}", self.advice, Limits::raising(name, 2.0 * each as f64)),
        })
    }
}
