//! Warnings, gathered while a file is read: one for each kind of trouble, however often it occurs.

use std::{cell::RefCell, collections::BTreeMap};

use arabesque_core::Warning;

/// A kind of trouble that does not prevent reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Note {
    /// Something outside the file is referred to.
    External,
    /// A reference leads nowhere.
    Missing,
    /// A fill or stroke refers to a paint that is not there.
    MissingPaint,
    /// Text that is not converted to paths.
    Text,
    /// Markers on lines that are continued.
    Marker,
    /// A reference that leads back to itself.
    Cycle,
    /// Embedded foreign content.
    Foreign,
    /// A mask, filter or blend mode on a container of elements.
    ContainerEffect,
    /// The opacity of a container of things that overlap.
    ContainerOpacity,
    /// A path without extent.
    ZeroSize,
    /// An element beyond the frame.
    Outside,
    /// A stroke that draws the frame.
    Border,
    /// A unit convention that changed.
    OldInkscape,
    /// A file without any size.
    NoSize,
    /// A style value that is not understood.
    Style,
    /// A selector or rule of a style sheet that is not understood.
    Selector,
    /// A gradient stretched over pieces that were split.
    SplitGradient,
    /// Too many crossing parts to take apart.
    TooTangled,
    /// A filled piece larger than half of the exemplar.
    LargeElement,
    /// An element that the frame cuts.
    Cut,
    /// No namespace.
    NoNamespace,
    /// A transform that is not understood.
    Transform,
    /// An override with an unknown value.
    Override,
    /// A background among several shapes of a domain.
    DomainBackground,
    /// A page that is one period.
    Period,
    /// A drawing in a corner of its page.
    Corner,
    /// Path data that stops in the middle.
    CutShort,
    /// A stroke without length.
    ZeroLength,
    /// A stroke of no width.
    NoWidth,
    /// A stroke on top of one like it.
    Duplicate,
    /// Strokes and what is drawn with them cover one another in turn.
    Weaving,
    /// More strokes on one geometry than one stroke may have paints.
    ManyPaints,
    /// A stroke whose transform stretches it unevenly.
    UnevenWidth,
    /// The fill of a shape that is marked as a curve.
    CurveFill,
    /// A mask on a curve.
    CurveMask,
    /// An outline that was taken for the strokes that it really is.
    Traced,
}

impl Note {
    fn message(self) -> (&'static str, &'static str) {
        match self {
            Self::External => ("reference to something outside the file, not fetched", "embed it in the file"),
            Self::Missing => ("reference to an id that does not exist", "remove it, or restore what it refers to"),
            Self::Text => ("text ignored", "convert it to paths (Inkscape: Path > Object to Path)"),
            Self::Marker => (
                "markers of a long stroke taken for elements of their own, which do not follow its ends",
                "mark the stroke data-arabesque=\"element\" to have it copied with its markers as it is",
            ),
            Self::Cycle => {
                ("reference in a cycle ignored", "remove one of the references that lead back to each other")
            }
            Self::Foreign => ("foreign content ignored", "draw it as SVG shapes"),
            Self::ContainerEffect => {
                ("mask, filter or blend mode on a group of many elements ignored", "put it on each element")
            }
            Self::ContainerOpacity => (
                "opacity of a group of things that overlap given to each of them, so that they show through one another",
                "put it on each thing, or mark the group data-arabesque=\"element\"",
            ),
            Self::ZeroSize => ("element without extent ignored", "delete it, or give it a size"),
            Self::Outside => (
                "more than half of what is drawn lies beyond the frame and is ignored",
                "make the page larger, or move the drawing onto it",
            ),
            Self::Border => ("stroke along the frame ignored", "mark it data-arabesque=\"element\" to keep it"),
            Self::OldInkscape => (
                "file of an Inkscape before 0.92, whose pixels were 90 to an inch; 96 are assumed",
                "open and save it once with a newer Inkscape if physical sizes matter",
            ),
            Self::NoSize => {
                ("no width, height or viewBox; the frame is the box around the drawing", "give the file a viewBox")
            }
            Self::Style => ("style value ignored", "use a plain SVG value"),
            Self::Selector => (
                "rule of a style sheet ignored, for its selector is not understood",
                "select by element, class, id or attribute, or put the style on the shapes themselves",
            ),
            Self::SplitGradient => {
                ("gradient over a path that was split into pieces; it is stretched over each piece", "use plain fills")
            }
            Self::TooTangled => {
                ("path with too many crossings left in one piece", "break it apart in the drawing program")
            }
            Self::LargeElement => (
                "element larger than half of the exemplar",
                "show more of the pattern, or mark it data-arabesque=\"ignore\"",
            ),
            Self::Cut => (
                "element cut by the frame: kept as context, never copied",
                "draw it whole, reaching over the frame, to have it copied",
            ),
            Self::NoNamespace => ("no SVG namespace", "write xmlns=\"http://www.w3.org/2000/svg\" on the root"),
            Self::Transform => ("transform ignored", "use the transform attribute with plain numbers"),
            Self::Override => ("unknown data-arabesque value ignored", "use element, curve or ignore"),
            Self::Period => (
                "the page is taken for one period of a pattern: its opposite edges fit together, and it shows no repeat of its own",
                "use --exemplar-tile=no to have it read as a page",
            ),
            Self::Corner => (
                "the drawing covers only a part of the page; the box around it is taken for the frame",
                "resize the page to the drawing, or draw a rectangle with the id \"frame\"",
            ),
            Self::CutShort => ("path data stops in the middle; drawn up to there", "repair the path"),
            Self::ZeroLength
            | Self::NoWidth
            | Self::MissingPaint
            | Self::Duplicate
            | Self::Weaving
            | Self::ManyPaints
            | Self::UnevenWidth
            | Self::CurveFill
            | Self::Traced
            | Self::CurveMask => self.stroke_message(),
            Self::DomainBackground => {
                ("shape around all others taken for a background, not for the domain", "choose a shape by its id")
            }
        }
    }

    /// The messages about strokes and paints.
    fn stroke_message(self) -> (&'static str, &'static str) {
        match self {
            Self::ZeroLength => ("stroke without length ignored", "delete it, or give it round caps if it is a dot"),
            Self::MissingPaint => (
                "fill or stroke by a paint that does not exist, not painted",
                "define a gradient or pattern of that id, or give it a colour",
            ),
            Self::NoWidth => ("stroke of no width ignored", "give it a stroke-width above 0"),
            Self::Weaving => (
                "strokes go over and under something in turn; the result has all strokes of one look in one layer",
                "draw what goes over as a shape of its own, with a gap in what goes under",
            ),
            Self::ManyPaints => ("stroke left out that lies under thirty others", "use fewer strokes"),
            Self::UnevenWidth => (
                "stroke that is stretched more one way than the other; its mean width is used",
                "apply the transform to the path, or convert the stroke to a path",
            ),
            Self::CurveFill => ("fill of a curve ignored", "draw the fill as a shape of its own"),
            Self::Traced => (
                "outline of lines of one width taken for strokes",
                "mark it data-arabesque=\"element\" to have it copied as it is",
            ),
            Self::CurveMask => ("mask on a curve ignored", "cut the curve instead"),
            // `message` asks for strokes alone.
            _ => ("stroke exactly on top of one like it ignored", "delete one of the two"),
        }
    }
}

/// The warnings of one file so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Notes(RefCell<BTreeMap<Note, (usize, Vec<String>)>>);

/// Examples that are named for each kind.
const NAMED: usize = 3;
/// Occurrences that are asked for their names: finding out may take a walk through the file.
const ASKED: usize = 200;

impl Notes {
    /// Notes one occurrence; `what` names it, and is called only for the first few.
    pub(crate) fn add(&self, note: Note, what: impl FnOnce() -> String) {
        let mut all = self.0.borrow_mut();
        let (count, examples) = all.entry(note).or_default();
        *count += 1;
        if examples.len() < NAMED && *count <= ASKED {
            let what = what();
            if !examples.contains(&what) {
                examples.push(what);
            }
        }
    }

    /// The kinds of trouble so far that may explain why nothing was found, in few message.
    pub(crate) fn summary(&self) -> String {
        let all = self.0.borrow();
        let is_relevant = |note: &Note| {
            !matches!(note, Note::Corner | Note::Period | Note::NoSize | Note::OldInkscape | Note::NoNamespace)
        };
        let told = all.iter().filter(|(note, _)| is_relevant(note));
        let one = |(note, (count, examples)): (&Note, &(usize, Vec<String>))| match examples.first() {
            Some(name) if *note == Note::MissingPaint => format!("{}: {name} ({count}x)", note.message().0),
            _ => format!("{} ({count}x)", note.message().0),
        };
        told.map(one).collect::<Vec<_>>().join(", ")
    }

    /// One warning per kind.
    pub(crate) fn warnings(&self, file: &str) -> Vec<Warning> {
        let all = self.0.borrow();
        all.iter().map(|(&note, (count, examples))| warning(file, note, *count, examples)).collect()
    }
}

fn warning(file: &str, note: Note, count: usize, examples: &[String]) -> Warning {
    let (what, advice) = note.message();
    let named: Vec<_> = examples.iter().filter(|e| !e.is_empty()).map(String::as_str).collect();
    let times = if count > 1 { format!(" ({count} times)") } else { String::new() };
    let list = if named.is_empty() { String::new() } else { format!(": {}", named.join(", ")) };
    let more = if !named.is_empty() && count > examples.len() && examples.len() == NAMED { ", ..." } else { "" };
    Warning::new(format!("{file}: {what}{times}{list}{more}"), advice)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_occurrences_make_one_warning() {
        let notes = Notes::default();
        for k in 0..10 {
            notes.add(Note::Text, || format!("t{k}"));
        }
        let warnings = notes.warnings("a.svg");
        assert_eq!(warnings.len(), 1);
        assert_eq!(warnings[0].message, "a.svg: text ignored (10 times): t0, t1, t2, ...");
    }
}
