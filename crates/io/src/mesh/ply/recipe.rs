//! The recipe in the comments of a PLY file.
//!
//! Programs that read PLY take comments of ASCII alone and of up to about a thousand bytes. So the lines of a recipe are cut, what
//! starts a line is marked `|` and what continues one `+`, and other characters are written as `\u{...}`. Some programs take the first
//! `end_header` for the end of the header wherever it stands, so that no comment has it.

use super::header::comments;

/// The comment that a recipe follows, and the one that ends it.
const BEGIN: &str = "arabesque recipe:";
const END: &str = "arabesque recipe ends";
/// What ends a header.
const HEADER_END: &str = "end_header";
/// Characters of the recipe in one comment.
const LONGEST: usize = 200;

/// Whether the bytes start as a PLY file does.
pub fn is_ply(bytes: &[u8]) -> bool {
    bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r")
}

/// The recipe in a file that [`super::write_ply`] wrote.
pub fn recipe_of(bytes: &[u8]) -> Option<String> {
    if !is_ply(bytes) {
        return None;
    }
    let comments = comments(bytes);
    let begin = comments.iter().position(|c| c == BEGIN)?;
    let mut escaped = String::new();
    for comment in &comments[begin + 1..] {
        if comment == END {
            break;
        }
        if let Some(line) = comment.strip_prefix('|') {
            escaped.push_str(line);
        } else {
            escaped.truncate(escaped.len().saturating_sub(1));
            escaped.push_str(comment.strip_prefix('+')?);
        }
        escaped.push('\n');
    }
    unescaped(&escaped)
}

/// Comment lines that hold a recipe.
pub(crate) fn recipe_comments(recipe: &str) -> String {
    let mut out = format!("comment {BEGIN}\n");
    for line in recipe.lines() {
        let escaped = escaped(line);
        let mut mark = '|';
        let mut rest = escaped.as_str();
        loop {
            let (now, later) = rest.split_at(length(rest));
            out += &format!("comment {mark}{now}\n");
            (mark, rest) = ('+', later);
            if rest.is_empty() {
                break;
            }
        }
    }
    out + &format!("comment {END}\n")
}

/// How much of a line of ASCII goes into one comment: none ends with a blank.
fn length(rest: &str) -> usize {
    if rest.len() <= LONGEST {
        return rest.len();
    }
    match rest[..LONGEST].trim_end_matches(' ').len() {
        0 => LONGEST,
        length => length,
    }
}

/// A line in printable ASCII; blanks at its end, which programs cut off, are kept.
fn escaped(line: &str) -> String {
    let mut out = String::with_capacity(line.len());
    let kept = line.trim_end_matches(' ').len();
    let ends: Vec<usize> = line.match_indices(HEADER_END).map(|(at, _)| at + "end".len()).collect();
    for (at, c) in line.char_indices() {
        match c {
            '_' if ends.contains(&at) => out.push_str("\\u{5f}"),
            '\\' => out.push_str("\\\\"),
            ' ' if at >= kept => out.push_str("\\u{20}"),
            ' '..='~' => out.push(c),
            c => out += &format!("\\u{{{:x}}}", u32::from(c)),
        }
    }
    out
}

fn unescaped(text: &str) -> Option<String> {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('\\') {
        out.push_str(before);
        if let Some(after) = after.strip_prefix('\\') {
            out.push('\\');
            rest = after;
        } else {
            let (code, after) = after.strip_prefix("u{")?.split_once('}')?;
            out.push(char::from_u32(u32::from_str_radix(code, 16).ok()?)?);
            rest = after;
        }
    }
    out.push_str(rest);
    Some(out)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn file(recipe: &str) -> String {
        format!("ply\nformat ascii 1.0\ncomment by hand\n{}end_header\n", recipe_comments(recipe))
    }

    #[test]
    fn long_lines_and_other_letters_are_ascii_and_short() {
        let recipe = format!("seed = 1\n\n  name = \"Bäume \\ 🌳\"  \ndata = \"{}\"\n", "0123456789 ".repeat(100));
        let text = file(&recipe);
        assert!(text.is_ascii() && text.lines().all(|l| l.len() < 220 && l.trim_end() == l), "{text}");
        assert_eq!(recipe_of(text.as_bytes()), Some(recipe));
    }

    #[test]
    fn the_end_of_the_header_is_the_first_place_that_says_so() {
        let recipe = "content = \"\"\"\nply\nend_header\nend_end_header_end_header\n\"\"\"\n".to_owned();
        let text = file(&recipe);
        assert_eq!(text.matches(HEADER_END).count(), 1, "{text}");
        assert_eq!(recipe_of(text.as_bytes()), Some(recipe));
    }

    #[test]
    fn files_without_a_recipe_or_with_a_broken_one_have_none() {
        for text in [
            "ply\nformat ascii 1.0\nend_header\n",
            "ply\ncomment arabesque recipe:\ncomment |\\x\nend_header\n",
            "ply\ncomment arabesque recipe:\ncomment |\\u{fffffff}\nend_header\n",
            "ply\nend_header\ncomment arabesque recipe:\n",
            "solid\n",
            "",
        ] {
            assert_eq!(recipe_of(text.as_bytes()), None, "{text:?}");
        }
    }

    proptest! {
        #[test]
        fn every_recipe_comes_back(lines in prop::collection::vec("[^\r\n]{0,300}", 0..5)) {
            let recipe: String = lines.iter().map(|line| format!("{line}\n")).collect();
            prop_assert_eq!(recipe_of(file(&recipe).as_bytes()), Some(recipe));
        }
    }
}
