//! Types that a parameter may have.

use super::spec::Kind;

/// A type that a parameter may have.
pub trait ParamValue: Sized {
    /// The allowed values, given the range of the declaration.
    fn kind(range: Option<(f64, f64)>) -> Kind;

    /// The value that a text stands for; `None` where it stands for none that `kind` allows.
    fn parse(text: &str, kind: &Kind) -> Option<Self>;

    /// The text that stands for the value.
    fn show(&self) -> String;
}

/// A number that bounds the range of a parameter.
pub trait Bound: Copy {
    /// The number.
    fn real(self) -> f64;
}

impl Bound for f64 {
    fn real(self) -> f64 {
        self
    }
}

impl Bound for usize {
    fn real(self) -> f64 {
        self as f64
    }
}

impl ParamValue for f64 {
    fn kind(range: Option<(f64, f64)>) -> Kind {
        let (min, max) = range.unwrap_or((f64::MIN, f64::MAX));
        Kind::Real { min, max }
    }

    fn parse(text: &str, kind: &Kind) -> Option<Self> {
        let value = text.parse().ok()?;
        matches!(kind, Kind::Real { min, max } if (*min..=*max).contains(&value)).then_some(value)
    }

    fn show(&self) -> String {
        self.to_string()
    }
}

impl ParamValue for usize {
    fn kind(range: Option<(f64, f64)>) -> Kind {
        let (min, max) = range.map_or((usize::MIN, usize::MAX), |(min, max)| (min as Self, max as Self));
        Kind::Integer { min, max }
    }

    fn parse(text: &str, kind: &Kind) -> Option<Self> {
        let value = text.parse().ok()?;
        matches!(kind, Kind::Integer { min, max } if (*min..=*max).contains(&value)).then_some(value)
    }

    fn show(&self) -> String {
        self.to_string()
    }
}

impl ParamValue for bool {
    fn kind(_: Option<(f64, f64)>) -> Kind {
        Kind::Switch
    }

    fn parse(text: &str, _: &Kind) -> Option<Self> {
        match text {
            "on" => Some(true),
            "off" => Some(false),
            _ => None,
        }
    }

    fn show(&self) -> String {
        if *self { "on" } else { "off" }.to_owned()
    }
}

/// `auto` is `None`: the method chooses.
impl<T: ParamValue> ParamValue for Option<T> {
    fn kind(range: Option<(f64, f64)>) -> Kind {
        T::kind(range)
    }

    fn parse(text: &str, kind: &Kind) -> Option<Self> {
        if text == "auto" { Some(None) } else { T::parse(text, kind).map(Some) }
    }

    fn show(&self) -> String {
        self.as_ref().map_or_else(|| "auto".to_owned(), T::show)
    }
}
