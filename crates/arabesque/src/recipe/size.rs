//! Sizes as people write them: `800x600`, `210mmx297mm`, `8inx8in`, and boxes in space such as `10x10x5`.

use std::{borrow::Cow, fmt, str::FromStr};

use arabesque_core::{Bounds, Error, Limits, Vector};
use arabesque_io::svg::{Page, Unit};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error as _};

/// Width and height, in the units of the exemplar or in a unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Width and height, both positive.
    pub sides: [f64; 2],
    /// Unit of both; `None` stands for the user unit of the exemplar.
    pub unit: Option<Unit>,
}

/// CSS pixels of one user unit of a page.
pub(crate) fn pixels_per_user(page: &Page) -> f64 {
    page.unit.pixels() * page.unit_per_user
}

impl Size {
    /// Width and height in user units of `page`, and a page of that size that starts at the origin.
    pub(crate) fn on(&self, page: &Page) -> ([f64; 2], Page) {
        let user = pixels_per_user(page);
        let (factor, unit, unit_per_user) = match self.unit {
            None => (1.0, page.unit, page.unit_per_user),
            Some(unit) => (unit.pixels() / user, unit, user / unit.pixels()),
        };
        let sides = self.sides.map(|s| s * factor);
        let view = Bounds::new(Vector::ZERO, Vector(sides));
        (sides, Page { view, unit, unit_per_user })
    }
}

impl FromStr for Size {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let fail = || {
            Error::parameter(
                "size",
                format!("\"{text}\""),
                "width x height with positive numbers up to 1e9, such as 800x600, 210mmx297mm or 8inx8in (px, mm, cm, in, pt, pc, q)",
            )
        };
        let lower = text.trim().to_ascii_lowercase();
        let (first, second) = halves(&lower).ok_or_else(fail)?;
        let ((width, unit_w), (height, unit_h)) = (length(first).ok_or_else(fail)?, length(second).ok_or_else(fail)?);
        let unit = match (unit_w, unit_h) {
            (Some(a), Some(b)) if a != b => return Err(fail()),
            (a, b) => a.or(b),
        };
        let limit = Limits::default().coordinate;
        if [width, height].iter().all(|v| v.is_finite() && *v > 0.0 && *v <= limit) {
            Ok(Self { sides: [width, height], unit })
        } else {
            Err(fail())
        }
    }
}

/// What stands before and after the `x` between two lengths: the one that is not the end of `px`.
fn halves(text: &str) -> Option<(&str, &str)> {
    let text_bytes = text.as_bytes();
    let at = (1..text.len().saturating_sub(1))
        .find(|&k| matches!(text_bytes[k], b'x' | b'*') && (text_bytes[k - 1] != b'p' || text_bytes[k] == b'*'))?;
    Some((text.get(..at)?, text.get(at + 1..)?))
}

fn length(text: &str) -> Option<(f64, Option<Unit>)> {
    let text = text.trim();
    let named = Unit::ALL.iter().find_map(|unit| Some((text.strip_suffix(unit.name())?, *unit)));
    match named {
        Some((number, unit)) => Some((number.trim().parse().ok()?, Some(unit))),
        None => Some((text.parse().ok()?, None)),
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = self.unit.map_or("", Unit::name);
        write!(f, "{}{unit}x{}{unit}", self.sides[0], self.sides[1])
    }
}

/// What is said of a seamless tile: its size, or that the repeat of the exemplar decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tile {
    /// As small as the repeat of the exemplar allows.
    Auto,
    /// Of this size.
    Of(Size),
}

impl FromStr for Tile {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        if text.trim().eq_ignore_ascii_case("auto") { Ok(Self::Auto) } else { text.parse().map(Self::Of) }
    }
}

impl fmt::Display for Tile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Of(size) => size.fmt(f),
        }
    }
}

/// Width, depth and height of a box in space, in the units of the exemplar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid(pub [f64; 3]);

impl Cuboid {
    /// The box with a corner at the origin.
    pub(crate) fn bounds(&self) -> Bounds<3> {
        Bounds::new(Vector::ZERO, Vector(self.0))
    }
}

impl FromStr for Cuboid {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let most = Limits::default().coordinate;
        let sound = |side: &f64| side.is_finite() && *side > 0.0 && *side <= most;
        let lower = text.trim().to_ascii_lowercase();
        let sides: Option<Vec<f64>> =
            lower.split(['x', '*']).map(|side| side.trim().parse().ok().filter(sound)).collect();
        sides.and_then(|sides| <[f64; 3]>::try_from(sides).ok()).map(Self).ok_or_else(|| {
            let expected = "three positive numbers up to 1e9 in the units of the exemplar, such as 10x10x5";
            Error::parameter("box", format!("\"{text}\""), expected)
        })
    }
}

impl fmt::Display for Cuboid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0;
        write!(f, "{x}x{y}x{z}")
    }
}

/// A type that a recipe holds as text.
macro_rules! written_as_text {
    ($type:ident, $words:literal) => {
        impl Serialize for $type {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_str(self)
            }
        }

        impl<'de> Deserialize<'de> for $type {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                String::deserialize(deserializer)?.parse().map_err(D::Error::custom)
            }
        }

        impl JsonSchema for $type {
            fn schema_name() -> Cow<'static, str> {
                stringify!($type).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!({ "type": "string", "description": $words })
            }
        }
    };
}

written_as_text!(Size, "width x height, such as 800x600, 210mmx297mm or 8inx8in (px, mm, cm, in, pt, pc, q)");
written_as_text!(
    Tile,
    "width x height, such as 400x400, or auto for the smallest tile that the repeat of the exemplar fills"
);
written_as_text!(Cuboid, "width x depth x height in the units of the exemplar, such as 10x10x5");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_units_or_none() {
        for (text, sides, unit) in [
            ("800x600", [800.0, 600.0], None),
            ("210mmx297mm", [210.0, 297.0], Some(Unit::Mm)),
            ("8inx8in", [8.0, 8.0], Some(Unit::In)),
            ("800pxx600px", [800.0, 600.0], Some(Unit::Px)),
            ("10 x 20cm", [10.0, 20.0], Some(Unit::Cm)),
            ("3.1X3.1", [3.1, 3.1], None),
        ] {
            assert_eq!(text.parse::<Size>().unwrap(), Size { sides, unit }, "{text}");
        }
        for text in
            ["", "x", "800", "0x5", "-3x5", "nanx5", "infx5", "1e300x1", "5x5x5", "5mmx5in", "5furlongx5furlong"]
        {
            assert!(text.parse::<Size>().is_err(), "{text}");
        }
        let size = Size { sides: [800.0, 600.0], unit: Some(Unit::Px) };
        assert_eq!(size.to_string().parse::<Size>().unwrap(), size);
    }

    #[test]
    fn a_tile_may_leave_its_size_to_the_exemplar() {
        for text in ["auto", "400x300", "10mmx20mm"] {
            assert_eq!(text.parse::<Tile>().unwrap().to_string(), text);
        }
        assert!("automatic".parse::<Tile>().is_err());
    }

    #[test]
    fn millimetres_on_a_pixel_page() {
        let page = Page { view: Bounds::new(Vector::ZERO, Vector::xy(1.0, 1.0)), unit: Unit::Px, unit_per_user: 1.0 };
        let (sides, out) = "25.4mmx50.8mm".parse::<Size>().unwrap().on(&page);
        assert!((sides[0] - 96.0).abs() < 1e-9 && (sides[1] - 192.0).abs() < 1e-9);
        assert_eq!(out.unit, Unit::Mm);
        assert!((out.view.size()[0] * out.unit_per_user - 25.4).abs() < 1e-9);
    }

    #[test]
    fn boxes_have_three_positive_sides() {
        let cuboid: Cuboid = "10x10X5.5".parse().unwrap();
        assert_eq!((cuboid, cuboid.to_string().parse().unwrap()), (Cuboid([10.0, 10.0, 5.5]), cuboid));
        for text in ["", "10", "10x10", "10x10x0", "axbxc", "1x2x3x4", "1xx2x3", "1e99x1x1", "nanx1x1"] {
            assert!(text.parse::<Cuboid>().is_err(), "{text}");
        }
    }
}
