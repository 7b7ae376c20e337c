//! How an SVG file is to be read.

use arabesque_core::Budget;

/// What open strokes are taken for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Filled shapes, groups and `<use>` are elements, and so are small closed strokes where no stroke is open; all
    /// other strokes are curves.
    #[default]
    Auto,
    /// Every stroke without a fill is a curve; what is filled is an element.
    Curves,
    /// Every connected piece is one element; strokes that touch are one piece.
    Elements,
}

/// Whether an exemplar is a page of a pattern, or one period of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tiling {
    /// One period where a `<pattern>` fills it, or where what its opposite edges cut fits together beyond doubt.
    #[default]
    Auto,
    /// One period where most of what the edges cut goes on at the opposite ones, and the rest ends there.
    Likely,
    /// One period where nothing that an edge cuts is drawn beyond it without going on at the opposite one.
    Possible,
    /// One period: what an edge cuts goes on at the opposite one.
    Period,
    /// A page; a `<pattern>` that fills it is a background.
    Page,
}

/// What fills are taken for that run through the frame and are no bands of one width.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LargeFills {
    /// The outlines of lines, where they are that; else they are refused.
    #[default]
    Lines,
    /// Areas, which only a repeat can continue.
    Areas,
    /// The same, and areas too are all fills that are painted like one of these, or like a piece of a compound path that reaches a
    /// side of the frame, whatever their size: contour lines turned into outlines, of which some run through the frame and others
    /// close in it.
    AreasAlike,
}

impl LargeFills {
    /// Whether fills that run through the frame are areas.
    pub fn are_areas(self) -> bool {
        matches!(self, Self::Areas | Self::AreasAlike)
    }
}

/// What the dashes of a stroke are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dashes {
    /// A property of the stroke, which begins with a whole one wherever it begins.
    #[default]
    OfStroke,
    /// The same, and strokes are alike whose dashes begin differently.
    Shifted,
    /// Strokes of their own: where each of them lies is part of the pattern.
    Apart,
}

/// What loose parts are that come together in the same way again and again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Parts {
    /// One element each time: a flower of petals and a heart.
    #[default]
    Together,
    /// Elements of their own, which a repeat keeps in place.
    Apart,
}

/// How an SVG file is to be read.
#[derive(Clone, Debug)]
pub struct ReadOptions {
    /// Name of the file, for messages.
    pub name: String,
    /// What open strokes are taken for. Default: [`Method::Auto`].
    pub method: Method,
    /// Whether it shows a page or one period. Default: [`Tiling::Auto`].
    pub tiling: Tiling,
    /// What large fills are taken for. Default: [`LargeFills::Lines`].
    pub large_fills: LargeFills,
    /// What dashes are. Default: [`Dashes::OfStroke`].
    pub dashes: Dashes,
    /// What loose parts are. Default: [`Parts::Together`].
    pub parts: Parts,
    /// Ids (or labels) of items that are not part of the drawing, because they only say where something is. Default:
    /// none.
    pub without: Vec<String>,
    /// What reading may use up. Default: an account of its own with the usual limits.
    pub budget: Budget,
}

impl ReadOptions {
    /// Default options for the file called `name` in messages.
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            method: Method::default(),
            tiling: Tiling::default(),
            large_fills: LargeFills::default(),
            dashes: Dashes::default(),
            parts: Parts::default(),
            without: Vec::new(),
            budget: Budget::default(),
        }
    }
}
