//! The size of a tile that the repeat of the exemplar suggests: `--tile auto`.

use arabesque_core::{Bounds, Domain, Error, Matrix, Result, ScalarField, Vector};
use arabesque_patterns::repeat::Repeat;

use crate::{
    method::RunContext,
    plane::{Plane, fields::constant_factor, place::check_room},
    recipe::{FieldSource, Fill, Job, Size, Tile},
};

/// Digits of a side: as many as tell a length, and not the rounding of the arithmetic.
const DIGITS: i32 = 7;

/// A tile that is too small for the elements is doubled so often.
const DOUBLED: usize = 8;

/// A size that may stand in for `auto`.
const EXAMPLE: &str = "a size such as 400x400";

impl Plane {
    /// Puts a size in the place of `auto`, so that whatever comes of the request carries the size.
    pub(super) fn settle_tile(&self, context: &mut RunContext<'_>) -> Result<()> {
        let name = context.exemplar_name().to_owned();
        let budget = context.budget().clone();
        let Job::Fill(fill) = &mut context.job else { return Ok(()) };
        if fill.tile != Some(Tile::Auto) || fill.size.is_some() || fill.domain.is_some() {
            return Ok(());
        }
        let repeat = self.engine.repeat().ok_or_else(|| {
            let why = "no repeat was found in the exemplar (arabesque inspect tells more), or repeat=off is set";
            refused(&format!("{EXAMPLE}: {name}: {why}"))
        })?;
        let (turn, scale) = self.constant_fields(fill)?;
        let exemplar = self.exemplar.exemplar();
        let least = repeat
            .seamless_tile(exemplar.window.size(), &turn, scale)
            .ok_or_else(|| refused(&without_tile(&name, repeat, &turn, scale)))?;
        let mut sides = least.map(rounded);
        for _ in 0..DOUBLED {
            let domain = Domain::Torus(Bounds::new(Vector::ZERO, Vector(sides)));
            match check_room(exemplar, &domain, false, &budget) {
                Err(Error::NoResult { .. }) => sides[usize::from(sides[1] < sides[0])] *= 2.0,
                Ok(()) | Err(_) => break,
            }
        }
        fill.tile = Some(Tile::Of(Size { sides, unit: None }));
        Ok(())
    }

    /// The turn and the scale of distances of fields that are the same everywhere.
    fn constant_fields(&self, fill: &Fill) -> Result<(Matrix<2>, f64)> {
        let bent = |name: &str| refused(&format!("{EXAMPLE}: {name} is not the same everywhere, and bends the repeat"));
        let turn = match &fill.orient {
            Some(FieldSource::Constant(degrees)) => Matrix::rotation(degrees.to_radians()),
            Some(FieldSource::File(_)) => return Err(bent("orient")),
            None if self.exemplar.drawing.job.flow.is_empty() => Matrix::identity(),
            None => return Err(bent("the layer Flow of the exemplar")),
        };
        let factor = |name: &str, source: Option<&FieldSource>| match source {
            Some(FieldSource::File(_)) => Err(bent(name)),
            other => match constant_factor::<2>(name, other)? {
                ScalarField::Constant(factor) => Ok(factor),
                ScalarField::Grid(_) => Err(bent(name)),
            },
        };
        let (scale, density) = (factor("scale", fill.scale.as_ref())?, factor("density", fill.density.as_ref())?);
        Ok((turn, scale * density.powf(-0.5)))
    }
}

fn refused(expected: &str) -> Error {
    Error::parameter("tile", "auto", expected)
}

/// Why there is no size, and which one would nearly do.
fn without_tile(name: &str, repeat: &Repeat, turn: &Matrix<2>, scale: f64) -> String {
    let near = repeat.near_tile(turn, scale).map_or_else(String::new, |near| {
        let [width, height] = near.size.map(|side| rounded_to(side, 4));
        let percent = (100.0 * near.stretch).max(0.1);
        format!("; {width}x{height} takes {percent:.1} % of stretching")
    });
    format!("{EXAMPLE}: the repeat of {name} does not lie along the axes{near}")
}

fn rounded(side: f64) -> f64 {
    rounded_to(side, DIGITS)
}

fn rounded_to(side: f64, digits: i32) -> f64 {
    let unit = 10_f64.powi(digits - 1 - side.log10().floor() as i32);
    (side * unit).round() / unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_told_without_the_rounding_of_the_arithmetic() {
        assert_eq!(rounded(40.000_000_000_1), 40.0);
        assert_eq!(rounded(86.602_540_378), 86.602_54);
        assert_eq!(rounded(0.019_999_999_999), 0.02);
        assert_eq!(rounded_to(1234.567, 4), 1235.0);
    }
}
