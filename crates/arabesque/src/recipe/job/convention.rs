//! What coordinates of files in space mean.

use arabesque_core::choices;

choices! {
    /// The axis that is up.
    pub enum Up {
        /// As in glTF.
        Y = "y",
        /// As in Blender and in drawings of buildings.
        Z = "z",
    }
}

impl Default for Up {
    /// [`Up::Y`].
    fn default() -> Self {
        Self::Y
    }
}

impl Up {
    /// The number of the axis.
    pub(crate) fn axis(self) -> usize {
        if self == Self::Y { 1 } else { 2 }
    }
}

choices! {
    /// A unit of length.
    pub enum Unit {
        /// Millimetres.
        Millimetre = "mm",
        /// Centimetres.
        Centimetre = "cm",
        /// Metres.
        Metre = "m",
        /// Inches.
        Inch = "in",
        /// Feet.
        Foot = "ft",
    }
}

impl From<Up> for arabesque_io::mesh::scene::Up {
    fn from(up: Up) -> Self {
        if up == Up::Y { Self::Y } else { Self::Z }
    }
}

impl Default for Unit {
    /// [`Unit::Metre`].
    fn default() -> Self {
        Self::Metre
    }
}

impl Unit {
    /// Its length in metres.
    pub(crate) fn metres(self) -> f64 {
        match self {
            Self::Millimetre => 1e-3,
            Self::Centimetre => 1e-2,
            Self::Metre => 1.0,
            Self::Inch => 0.0254,
            Self::Foot => 0.3048,
        }
    }
}
