//! What is painted over what in an exemplar: its layers, and the levels of strokes of one look.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Result};

use crate::svg::{
    drawing::Layer,
    layers::{
        covering::{Counts, Painted, by_kind, counts},
        levels::{Meetings, levels},
        order::{Kinds, Layered, layered},
    },
    parse::{notes::Note, source::Source},
    swatch::units::first_look,
    understand::{classes::Classes, item::Item},
};

/// What a drawing shows, in drawing order.
pub(crate) struct Order<'a> {
    /// Of each item in drawing order, whether it is strokes.
    pub(crate) is_line: &'a [bool],
    pub(crate) lines: &'a [Item],
    pub(crate) items: &'a [Item],
}

impl Order<'_> {
    /// What lies on what, and for each of the lines the level of its look.
    ///
    /// # Errors
    /// As [`arabesque_core::Budget::spend`].
    pub(crate) fn meetings(&self, source: &Source<'_>, window: &Bounds<2>) -> Result<(Counts, Vec<usize>)> {
        let (mut lines, mut items) = (self.lines.iter(), self.items.iter());
        let next = |&is_line: &bool| if is_line { lines.next() } else { items.next() };
        let all: Vec<&Item> = self.is_line.iter().filter_map(next).collect();
        let mut numbers: BTreeMap<String, usize> = BTreeMap::new();
        let mut number = |item: &Item| {
            let first = item.parts.first().map(|(parent, node)| first_look(node, *parent)).unwrap_or_default();
            let known = numbers.len();
            *numbers.entry(format!("{first}|{}", item.layer.as_deref().unwrap_or_default())).or_insert(known)
        };
        let looks: Vec<usize> = all.iter().map(|item| number(item)).collect();
        let is_one = looks.iter().zip(self.is_line).all(|(look, is_line)| *is_line && *look == looks[0]);
        if self.lines.is_empty() || is_one {
            return Ok((Counts::new(), vec![0; self.lines.len()]));
        }
        let painted = all.iter().zip(self.is_line);
        let painted = painted.map(|(item, &is_strokes)| Painted { outline: &item.outline, is_strokes });
        let counts = counts(&painted.collect::<Vec<_>>(), window, source.budget)?;
        let levels = levels(&Meetings { counts: &counts, looks: &looks, is_line: self.is_line });
        let of_lines = levels.into_iter().zip(self.is_line).filter(|(_, is_line)| **is_line).map(|(level, _)| level);
        let of_lines = of_lines.collect();
        Ok((counts, of_lines))
    }
}

/// A drawing, sorted into strokes and elements.
pub(crate) struct Sorted<'a> {
    /// Of each item in drawing order, whether it is strokes.
    pub(crate) is_line: &'a [bool],
    /// The styles of each of the lines.
    pub(crate) styles_of: &'a [Vec<usize>],
    pub(crate) classes: &'a Classes,
    /// What lies on what.
    pub(crate) meetings: &'a Counts,
}

/// The layers of a drawing, given how many paints there are and those of each style.
///
/// # Errors
/// As [`arabesque_core::Budget::spend`].
pub(crate) fn layers(
    source: &Source<'_>,
    drawn: &Sorted<'_>,
    (paints, styles): (usize, &[Vec<usize>]),
) -> Result<Vec<Layer>> {
    let element = drawn.is_line.iter().position(|is_line| !is_line);
    let elements_first = element.is_some() && element < drawn.is_line.iter().position(|&is_line| is_line);
    let kinds = Kinds { paints, classes: drawn.classes.classes.len(), styles, elements_first };
    let (mut lines, mut elements) = (drawn.styles_of.iter(), drawn.classes.members.iter());
    let mut kinds_of = |&is_line: &bool| {
        if is_line { lines.next().cloned() } else { elements.next().map(|member| vec![paints + member.0]) }
    };
    let kinds_of: Vec<Vec<usize>> = drawn.is_line.iter().map(|is| kinds_of(is).unwrap_or_default()).collect();
    let Layered { layers, weaving } = layered(&kinds, &by_kind(drawn.meetings, &kinds_of), source.budget)?;
    if weaving > 0 {
        source.notes.add(Note::Weaving, String::new);
    }
    Ok(layers)
}
