//! Units of length: their names, and how many CSS pixels each has.

/// CSS pixels per inch.
pub const PIXELS_PER_INCH: f64 = 96.0;
/// Inches per metre.
pub const INCHES_PER_METRE: f64 = 1.0 / 0.0254;

/// Physical unit of a page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Unit {
    /// CSS pixel, 96 per inch.
    #[default]
    Px,
    /// Millimetre.
    Mm,
    /// Centimetre.
    Cm,
    /// Inch.
    In,
    /// Point, 72 per inch.
    Pt,
    /// Pica, 6 per inch.
    Pc,
    /// A quarter of a millimetre.
    Q,
}

impl Unit {
    /// Every unit.
    pub const ALL: [Self; 7] = [Self::Px, Self::Mm, Self::Cm, Self::In, Self::Pt, Self::Pc, Self::Q];

    /// Its name in small letters, and its length in CSS pixels as a fraction.
    fn entry(self) -> (&'static str, [f64; 2]) {
        match self {
            Self::Px => ("px", [1.0, 1.0]),
            Self::Mm => ("mm", [PIXELS_PER_INCH, 25.4]),
            Self::Cm => ("cm", [PIXELS_PER_INCH, 2.54]),
            Self::In => ("in", [PIXELS_PER_INCH, 1.0]),
            Self::Pt => ("pt", [PIXELS_PER_INCH, 72.0]),
            Self::Pc => ("pc", [16.0, 1.0]),
            Self::Q => ("q", [PIXELS_PER_INCH, 101.6]),
        }
    }

    /// Its name in small letters: `px`, `mm`, `cm`, `in`, `pt`, `pc` or `q`.
    pub fn name(self) -> &'static str {
        self.entry().0
    }

    /// The unit as SVG writes it after a number: nothing for pixels.
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Px => "",
            Self::Q => "Q",
            _ => self.name(),
        }
    }

    /// CSS pixels in one of this unit.
    pub fn pixels(self) -> f64 {
        let (_, [pixels, units]) = self.entry();
        pixels / units
    }

    /// A length in this unit as CSS pixels, rounded as CSS readers do: multiplied before it is divided.
    pub(crate) fn in_pixels(self, length: f64) -> f64 {
        let (_, [pixels, units]) = self.entry();
        length * pixels / units
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inch_is_the_same_in_every_unit() {
        let per_inch = [96.0, 25.4, 2.54, 1.0, 72.0, 6.0, 101.6];
        for (unit, count) in Unit::ALL.into_iter().zip(per_inch) {
            assert!((unit.pixels() * count - PIXELS_PER_INCH).abs() < 1e-9, "{}", unit.name());
            assert!((unit.in_pixels(count) - PIXELS_PER_INCH).abs() < 1e-9, "{}", unit.name());
        }
    }

    #[test]
    fn svg_leaves_pixels_out_and_writes_a_large_q() {
        assert_eq!(Unit::ALL.map(Unit::suffix), ["", "mm", "cm", "in", "pt", "pc", "Q"]);
    }
}
