//! What is known of a parameter, as data.

use crate::text::rounded;

/// What values a parameter may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// One of several names.
    Choice(&'static [&'static str]),
    /// `off` or `on`.
    Switch,
    /// A whole number in a closed range.
    Integer {
        /// The least.
        min: usize,
        /// The greatest.
        max: usize,
    },
    /// A number in a closed range. From [`Kind::TINY`] or less to [`Kind::HUGE`] or more it is told as positive.
    Real {
        /// The least.
        min: f64,
        /// The greatest.
        max: f64,
    },
    /// A text of the form that is described here.
    Text(&'static str),
}

impl Kind {
    /// A least value that stands for anything above 0.
    pub const TINY: f64 = 1e-9;
    /// A greatest value that stands for any finite number.
    pub const HUGE: f64 = 1e9;

    /// The names that the value may be one of; none for numbers and texts.
    pub fn names(&self) -> &'static [&'static str] {
        match self {
            Self::Choice(names) => names,
            Self::Switch => &["off", "on"],
            Self::Integer { .. } | Self::Real { .. } | Self::Text(_) => &[],
        }
    }

    /// Whether the value may be any positive number.
    fn is_positive(&self) -> bool {
        matches!(self, Self::Real { min, max } if *min > 0.0 && *min <= Self::TINY && *max >= Self::HUGE)
    }

    /// The allowed values in short, as in a table: `hard, robust` or `1 to 5`.
    fn short(&self) -> String {
        match self {
            Self::Choice(_) | Self::Switch => self.names().join(", "),
            Self::Real { .. } if self.is_positive() => "a positive number".to_owned(),
            Self::Integer { min, max } => format!("{min} to {max}"),
            Self::Real { min, max } => format!("{min} to {max}"),
            Self::Text(form) => (*form).to_owned(),
        }
    }

    /// The allowed values in a sentence: `one of hard, robust` or `a whole number from 1 to 5`.
    fn long(&self) -> String {
        match self {
            Self::Choice(_) | Self::Switch => format!("one of {}", self.short()),
            Self::Integer { .. } => format!("a whole number from {}", self.short()),
            Self::Real { max, .. } if self.is_positive() => format!("{} up to {}", self.short(), rounded(*max)),
            Self::Real { .. } => format!("a number from {}", self.short()),
            Self::Text(_) => self.short(),
        }
    }
}

/// A parameter, described.
#[derive(Clone, Debug, PartialEq)]
pub struct ParamSpec {
    /// Name, as in `--set name=value`.
    pub name: &'static str,
    /// What values it may have.
    pub kind: Kind,
    /// Where it may be `auto`: what the method then chooses.
    pub auto: Option<&'static str>,
    /// The default, in the form that setting it by name takes.
    pub default: String,
    /// What the number counts.
    pub unit: Option<&'static str>,
    /// What it is, in one sentence, without the default.
    pub help: &'static str,
    /// Whether the program has an option of its own for it, so that `--set` does not list it.
    pub own_option: bool,
}

impl ParamSpec {
    /// The allowed values in short, with the unit: `auto, or 1 to 64`.
    pub fn values(&self) -> String {
        let auto = if self.auto.is_some() { "auto, or " } else { "" };
        let of = if self.kind.is_positive() { " of" } else { "" };
        let unit = self.unit.map(|unit| format!("{of} {unit}")).unwrap_or_default();
        format!("{auto}{}{unit}", self.kind.short())
    }

    /// What an error says was expected.
    pub fn expected(&self) -> String {
        let auto = if self.auto.is_some() { "auto, or " } else { "" };
        format!("{auto}{}", self.kind.long())
    }

    /// The default as it is told: for `auto` with what is then chosen.
    pub fn default_text(&self) -> String {
        match self.auto {
            Some(chosen) if self.default == "auto" => format!("auto, {chosen}"),
            _ => self.default.clone(),
        }
    }
}

/// A named set of parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preset {
    /// Its name.
    pub name: &'static str,
    /// What it stands for, in one sentence.
    pub help: &'static str,
}
