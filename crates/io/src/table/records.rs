//! Tables as text: lines cut into fields, and the recipe in comment lines at the end.

use arabesque_core::{Budget, Error, Result};

/// Work for each byte.
pub(crate) const PER_BYTE: u64 = 10;

/// Whether a line holds more than a comment.
pub(crate) fn is_data(line: &str) -> bool {
    !line.is_empty() && !line.starts_with('#')
}

/// Refuses lines so long that a list of their fields would be larger than the rest of the file.
pub(crate) fn check_length(name: &str, number: usize, line: &str, budget: &Budget) -> Result<()> {
    budget.within(&format!("{name}: characters of line {number}"), line.len(), ("nodes", budget.limits().nodes))
}

/// What separates fields: the first of comma, semicolon and tab that occurs, else white space.
pub(crate) fn separator_of(line: &str) -> Option<char> {
    [',', ';', '\t'].into_iter().find(|c| line.contains(*c))
}

/// The fields of every line that holds data, with its number. A line that ends inside quotes goes on in the lines after
/// it, until one of these closes them. No more than `most` are read.
///
/// The crate `csv` is not used for this: it tells the line of a record only as the line after the last record, comments
/// included, and a quote after a blank is not a quote to it.
pub(crate) fn records(name: &str, text: &str, budget: &Budget, most: usize) -> Result<Vec<(usize, Vec<String>)>> {
    budget.spend(PER_BYTE * text.len() as u64)?;
    let count = text.lines().count();
    budget.within(&format!("{name}: lines"), count, ("nodes", budget.limits().nodes))?;
    let lines: Vec<&str> = text.lines().collect();
    let first = lines.iter().map(|line| line.trim()).find(|line| is_data(line));
    let separator = first.and_then(separator_of);
    let mut records = Vec::new();
    let mut at = 0;
    while let Some(line) = lines.get(at).filter(|_| records.len() < most) {
        at += 1;
        if !is_data(line.trim()) {
            continue;
        }
        let number = at;
        check_length(name, number, line, budget)?;
        let Some((fields, more)) = fields(line, &lines[at..], separator) else {
            let problem = "a quote that nothing closes, expected one more on this line or after it";
            return Err(Error::input(format!("{name}: line {number}"), problem, "close the quote, or remove it"));
        };
        at += more;
        records.push((number, fields));
    }
    Ok(records)
}

/// The trimmed fields of a line, and how many of the lines `after` it belong to it; `None` where it ends inside quotes
/// that none of them closes.
pub(crate) fn fields(line: &str, after: &[&str], separator: Option<char>) -> Option<(Vec<String>, usize)> {
    let Some(separator) = separator else {
        return Some((line.split_whitespace().map(str::to_owned).collect(), 0));
    };
    let mut whole = Splitter { separator, ..Splitter::default() };
    whole.feed(line.trim());
    let mut more = 0;
    while whole.quoted && more < after.len() {
        whole.feed("\n");
        whole.feed(after[more]);
        more += 1;
    }
    (!whole.quoted).then(|| (whole.finish(), more))
}

/// Cuts text into fields; double quotes protect separators, and a doubled quote inside them is a quote.
#[derive(Default)]
struct Splitter {
    separator: char,
    fields: Vec<String>,
    field: String,
    /// Whether the text so far ends inside quotes.
    quoted: bool,
}

impl Splitter {
    fn feed(&mut self, text: &str) {
        let mut rest = text.chars().peekable();
        while let Some(c) = rest.next() {
            match c {
                '"' if self.quoted && rest.peek() == Some(&'"') => self.field.extend(rest.next()),
                '"' if self.quoted || self.field.trim().is_empty() => self.quoted = !self.quoted,
                c if c == self.separator && !self.quoted => self.fields.push(std::mem::take(&mut self.field)),
                c => self.field.push(c),
            }
        }
    }

    fn finish(mut self) -> Vec<String> {
        self.fields.push(self.field);
        self.fields.iter().map(|f| f.trim().to_owned()).collect()
    }
}

/// A recipe as comment lines, for [`recipe_of`] to find.
pub(crate) fn recipe_comments(recipe: &str) -> String {
    let lines: String = recipe.lines().map(|line| format!("# {line}\n")).collect();
    format!("{RECIPE_MARK}\n{lines}")
}

/// The comment line that a recipe follows.
pub(crate) const RECIPE_MARK: &str = "# arabesque recipe:";

/// The recipe in the comments of a table that this library wrote. A name that looks like one is none.
pub fn recipe_of(text: &str) -> Option<String> {
    // Names with quotes are quoted and their quotes doubled, so that every other one opens.
    let mut quoted = false;
    recipe_behind(text, |line| {
        if !quoted && line.starts_with('#') {
            return line == RECIPE_MARK;
        }
        quoted ^= line.matches('"').count() % 2 == 1;
        false
    })
}

/// The recipe in the comment lines behind the one that is its mark.
pub(crate) fn recipe_behind(text: &str, mut is_mark: impl FnMut(&str) -> bool) -> Option<String> {
    let mut lines = text.lines();
    lines.find(|line| is_mark(line))?;
    let lines = lines.map_while(|line| line.strip_prefix("# ").or_else(|| line.strip_prefix('#')));
    Some(lines.map(|line| format!("{line}\n")).collect())
}
