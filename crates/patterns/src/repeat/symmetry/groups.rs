//! The groups, by name, and how they are told by their operations.

use std::fmt;

/// A wallpaper group, in the short notation of the International Tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[expect(missing_docs, reason = "the names are explained by PlaneGroup::meaning")]
pub enum PlaneGroup {
    P1,
    P2,
    Pm,
    Pg,
    Cm,
    Pmm,
    Pmg,
    Pgg,
    Cmm,
    P4,
    P4m,
    P4g,
    P3,
    P3m1,
    P31m,
    P6,
    P6m,
}

/// A frieze group, in the notation of the International Tables: what follows `p` or `p2` says what the axes across and
/// along the frieze are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[expect(missing_docs, reason = "the names are explained by FriezeGroup::meaning")]
pub enum FriezeGroup {
    P1,
    P11g,
    P1m1,
    P2,
    P2mg,
    P11m,
    P2mm,
}

/// The symmetry of what repeats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// Of a pattern in the plane.
    Plane(PlaneGroup),
    /// Of a frieze.
    Frieze(FriezeGroup),
    /// Of stripes, along which nothing changes: whether they read the same from both sides.
    Stripes {
        /// Whether they are their own mirror image.
        mirrored: bool,
    },
}

impl PlaneGroup {
    /// Its name, such as `p4m`.
    pub fn name(self) -> &'static str {
        self.words().0
    }

    /// What it has beside translations, in words.
    pub fn meaning(self) -> &'static str {
        self.words().1
    }

    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::P1 => ("p1", "translations only"),
            Self::P2 => ("p2", "half turns"),
            Self::Pm => ("pm", "mirrors in one direction"),
            Self::Pg => ("pg", "glides in one direction"),
            Self::Cm => ("cm", "mirrors in one direction, with glides between them"),
            Self::Pmm => ("pmm", "mirrors in two directions"),
            Self::Pmg => ("pmg", "mirrors in one direction, glides across them, half turns"),
            Self::Pgg => ("pgg", "glides in two directions, half turns"),
            Self::Cmm => ("cmm", "mirrors in two directions, with half turns off them"),
            Self::P4 => ("p4", "quarter turns"),
            Self::P4m => ("p4m", "quarter turns, mirrors through their centres"),
            Self::P4g => ("p4g", "quarter turns, mirrors that miss their centres"),
            Self::P3 => ("p3", "third turns"),
            Self::P3m1 => ("p3m1", "third turns, mirrors through all their centres"),
            Self::P31m => ("p31m", "third turns, mirrors that miss some of their centres"),
            Self::P6 => ("p6", "sixth turns"),
            Self::P6m => ("p6m", "sixth turns, mirrors"),
        }
    }
}

impl FriezeGroup {
    /// Its name, such as `p2mg`.
    pub fn name(self) -> &'static str {
        self.words().0
    }

    /// What it has beside translations, in words.
    pub fn meaning(self) -> &'static str {
        self.words().1
    }

    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::P1 => ("p1", "translations only"),
            Self::P11g => ("p11g", "a glide along it"),
            Self::P1m1 => ("p1m1", "mirrors across it"),
            Self::P2 => ("p2", "half turns"),
            Self::P2mg => ("p2mg", "mirrors across it, a glide along it, half turns"),
            Self::P11m => ("p11m", "a mirror along it"),
            Self::P2mm => ("p2mm", "mirrors across and along it, half turns"),
        }
    }
}

impl Symmetry {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plane(group) => group.name(),
            Self::Frieze(group) => group.name(),
            Self::Stripes { mirrored: true } => "mirrored stripes",
            Self::Stripes { mirrored: false } => "stripes",
        }
    }

    /// What it means, in words.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Plane(group) => group.meaning(),
            Self::Frieze(group) => group.meaning(),
            Self::Stripes { mirrored: true } => "the same read from both sides",
            Self::Stripes { mirrored: false } => "different read from the other side",
        }
    }
}

impl fmt::Display for Symmetry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A reflection that a pattern has, in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Mirror {
    /// Whether some of its axes are mirrors; else all are glides.
    pub(super) is_mirror: bool,
    /// Whether glides lie between the mirrors, because the lattice is centred in this direction.
    pub(super) is_centred: bool,
    /// Whether the axis runs along a shortest vector of the lattice.
    pub(super) is_along_shortest: bool,
}

impl PlaneGroup {
    /// The group of a pattern with rotations up to this order and these reflections.
    pub(super) fn of(order: u32, mirrors: &[Mirror]) -> Self {
        let any = |test: fn(&Mirror) -> bool| mirrors.iter().any(test);
        let none = mirrors.is_empty();
        match order {
            6 if none => Self::P6,
            6 => Self::P6m,
            4 if none => Self::P4,
            4 if any(|m| m.is_along_shortest && m.is_mirror) => Self::P4m,
            4 => Self::P4g,
            3 if none => Self::P3,
            3 if any(|m| m.is_along_shortest) => Self::P31m,
            3 => Self::P3m1,
            2 if none => Self::P2,
            2 if any(|m| m.is_centred) => Self::Cmm,
            2 if any(|m| m.is_mirror) && any(|m| !m.is_mirror) => Self::Pmg,
            2 if any(|m| m.is_mirror) => Self::Pmm,
            2 => Self::Pgg,
            _ if none => Self::P1,
            _ if any(|m| m.is_centred) => Self::Cm,
            _ if any(|m| m.is_mirror) => Self::Pm,
            _ => Self::Pg,
        }
    }
}

impl FriezeGroup {
    /// The group of a frieze. `along`: whether it has a reflection along itself, and whether that is a mirror.
    pub(super) fn of(turns: bool, across: bool, along: Option<bool>) -> Self {
        match (turns || (across && along.is_some()), across, along) {
            (true, _, Some(true)) => Self::P2mm,
            (true, true, _) | (true, false, Some(false)) => Self::P2mg,
            (true, false, None) => Self::P2,
            (false, true, _) => Self::P1m1,
            (false, false, Some(true)) => Self::P11m,
            (false, false, Some(false)) => Self::P11g,
            (false, false, None) => Self::P1,
        }
    }
}
