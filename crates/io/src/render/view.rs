//! Where the eye stands.

use std::str::FromStr;

use arabesque_core::{Error, Result, Vector};

/// Direction from which one looks, in degrees; z is up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Around z, from the x axis towards the y axis.
    pub azimuth: f64,
    /// Above the plane of x and y; 90 looks straight down.
    pub elevation: f64,
}

impl View {
    /// Straight down, x to the right and y up: how things in the plane are seen.
    pub const TOP: Self = Self { azimuth: -90.0, elevation: 90.0 };
}

impl Default for View {
    /// From the front, a little from the right and from above.
    fn default() -> Self {
        Self { azimuth: -60.0, elevation: 30.0 }
    }
}

impl FromStr for View {
    type Err = Error;

    /// `azimuth,elevation`, as `-60,30`.
    fn from_str(text: &str) -> Result<Self> {
        let fail = || {
            let expected = "azimuth,elevation in degrees, such as -60,30: any azimuth, an elevation from -90 to 90";
            Error::parameter("view", text, expected)
        };
        let (azimuth, elevation) = text.split_once(',').ok_or_else(fail)?;
        let number = |word: &str| word.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        let view = Self { azimuth: number(azimuth).ok_or_else(fail)?, elevation: number(elevation).ok_or_else(fail)? };
        if view.elevation.abs() <= 90.0 { Ok(view) } else { Err(fail()) }
    }
}

/// The directions of a picture in space, at length 1 and at right angles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    pub(super) right: Vector<3>,
    pub(super) up: Vector<3>,
    /// Towards the eye.
    pub(super) near: Vector<3>,
}

impl Axes {
    pub(super) fn of(view: View) -> Self {
        // Degrees from 0 to 360 first, so that a turn more changes no bit.
        let [azimuth, elevation] = [view.azimuth.rem_euclid(360.0), view.elevation].map(f64::to_radians);
        let near = Vector([azimuth.cos() * elevation.cos(), azimuth.sin() * elevation.cos(), elevation.sin()]);
        let right = Vector([-azimuth.sin(), azimuth.cos(), 0.0]);
        Self { right, up: near.cross(right), near }
    }

    /// A direction as the picture has it: right, up, near.
    pub(super) fn turned(&self, v: Vector<3>) -> Vector<3> {
        Vector([v.dot(self.right), v.dot(self.up), v.dot(self.near)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_above_x_goes_right_and_y_up() {
        let axes = Axes::of(View::TOP);
        let off = |a: Vector<3>, b: [f64; 3]| (a - Vector(b)).norm();
        assert!(off(axes.turned(Vector([1.0, 2.0, 3.0])), [1.0, 2.0, 3.0]) < 1e-12);
        let front = Axes::of(View { azimuth: 270.0, elevation: 0.0 });
        assert!(off(front.turned(Vector([1.0, 2.0, 3.0])), [1.0, 3.0, -2.0]) < 1e-12);
    }

    #[test]
    fn views_are_two_numbers() {
        assert_eq!("-60, 30".parse::<View>().unwrap(), View::default());
        for text in ["", "30", "a,b", "0,91", "nan,0", "0,30,1"] {
            assert!(text.parse::<View>().unwrap_err().to_string().contains("azimuth,elevation"), "{text}");
        }
    }
}
