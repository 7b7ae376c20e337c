//! Why something of a drawing was taken for what it is.

use arabesque_core::Outline;

/// Names that are kept of things understood alike.
const NAMED: usize = 5;

/// Things of a drawing that were taken for the same for one reason.
#[derive(Clone, Debug)]
pub struct Understood {
    /// What they were taken for, and why.
    pub reason: Reason,
    /// How many there are.
    pub count: usize,
    /// What the first of them are called.
    pub names: Vec<String>,
    /// Where they are, for those that are no part of the pattern.
    pub outlines: Vec<Outline<2>>,
}

impl Understood {
    /// Adds a thing to those of its reason.
    pub(crate) fn add(all: &mut Vec<Self>, reason: Reason, name: impl FnOnce() -> String, outline: Option<Outline<2>>) {
        let at = all.iter().position(|known| known.reason == reason).unwrap_or_else(|| {
            all.push(Self { reason, count: 0, names: Vec::new(), outlines: Vec::new() });
            all.len() - 1
        });
        let known = &mut all[at];
        known.count += 1;
        if known.names.len() < NAMED {
            known.names.push(name());
        }
        known.outlines.extend(outline);
    }
}

/// What was made of something, and why.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reason {
    /// A filled shape.
    Fill,
    /// A connected piece of a filled path.
    Piece,
    /// A group or `<use>`.
    Group,
    /// Something marked by hand, or placed by arabesque, as an element.
    MarkedElement,
    /// A stroke that is joined to nothing.
    Stroke,
    /// Strokes, and fills, that touch one another.
    Touching,
    /// Things with clear space around them.
    Together,
    /// Parts that come together in the same way again and again.
    Recurring,
    /// A stroke of no length.
    Dot,
    /// A fill too large for an element.
    Large,
    /// Something marked by hand as a curve.
    MarkedCurve,
    /// Strokes that run from one side of the frame to another.
    Through,
    /// Connected strokes beyond half of the frame.
    Vast,
    /// Strokes with no clear space between them, which run through together.
    Crowded,
    /// A stroke painted like a net that the frame has cut off, or that runs along it.
    Beside,
    /// A stroke on squared paper, unlike those around it.
    Ruled,
    /// A stroke where all strokes are asked for as curves.
    Asked,
    /// The outline of lines of one width.
    Traced,
    /// A filled band of one width.
    Band,
    /// A filled band of about one width.
    HandBand,
    /// The outline of a filled band.
    BandOutline,
    /// A fill that runs through the frame.
    Area,
    /// A fill painted like one at the frame.
    AreaAlike,
    /// A fill that covers the frame.
    Background,
    /// Something under what is opaque.
    Covered,
    /// The original of a tiled clone, under its first copy.
    Original,
    /// A stroke along the frame.
    Border,
    /// Something beyond the frame.
    Outside,
}

impl Reason {
    /// Whether it holds for a thing drawn with strokes that may be a part of a larger one.
    pub(crate) fn is_loose(self) -> bool {
        matches!(self, Self::Stroke | Self::Touching | Self::Dot)
    }

    /// What it was taken for, in the plural.
    pub fn taken_for(self) -> &'static str {
        match self {
            Self::Fill | Self::Piece | Self::Group | Self::MarkedElement | Self::Stroke | Self::Touching => "elements",
            Self::Together | Self::Recurring | Self::Dot | Self::Large => "elements",
            Self::MarkedCurve | Self::Through | Self::Vast | Self::Crowded | Self::Beside | Self::Asked => "curves",
            Self::Ruled => "curves",
            Self::Traced | Self::Band | Self::HandBand | Self::BandOutline => "curves",
            Self::Area | Self::AreaAlike => "areas",
            Self::Background => "background",
            Self::Covered | Self::Original | Self::Border | Self::Outside => "left out",
        }
    }

    /// The reason, for people.
    pub fn why(self) -> &'static str {
        match self {
            Self::Fill => "filled shapes",
            Self::Piece => "connected pieces of filled paths",
            Self::Group => "groups and copies by <use>",
            Self::MarkedElement => "marked as elements",
            Self::Stroke => "strokes joined to no net",
            Self::Touching => "strokes that touch one another or a fill, joined to no net",
            Self::Together => "loose parts close together, with clear space around them",
            Self::Recurring => "loose parts that lie together in the same way again and again",
            Self::Dot => "dots: strokes of no length with round or square caps",
            Self::Large => "fills larger than half of the frame",
            Self::MarkedCurve => "marked as curves",
            Self::Through => "strokes of a net that runs from one side of the frame to another",
            Self::Vast => "strokes of a net longer than half of the frame",
            Self::Crowded => "strokes along one another, with no clear space between, through the frame",
            Self::Beside => "strokes painted like a net, cut off it by the frame or close along it",
            Self::Ruled => "straight strokes on squared paper, of many shapes",
            Self::Asked => "strokes, as --method curves asks",
            Self::Traced => "outlines of lines of one width",
            Self::Band => "filled bands of one width through the frame",
            Self::HandBand => "filled bands of about one width through the frame, as lines of their mean width",
            Self::BandOutline => "outlines of fills that run through the frame",
            Self::Area => "fills that run through the frame",
            Self::AreaAlike => "fills painted like those at the frame, with which they repeat",
            Self::Background => "fills that cover the frame",
            Self::Covered => "fully covered by something opaque",
            Self::Original => "originals of tiled clones, under their first copies",
            Self::Border => "strokes along the frame",
            Self::Outside => "beyond the frame",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_say_what_they_lead_to() {
        assert_eq!((Reason::Dot.taken_for(), Reason::Band.taken_for()), ("elements", "curves"));
        assert!(Reason::Covered.why().contains("opaque"));
    }
}
