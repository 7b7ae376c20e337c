//! Parameters, with defaults that work.

use arabesque_core::{choices, params};

choices! {
    /// How much of a neighbourhood counts [Roveri 2015 §4.2, §4.3].
    pub enum Window {
        /// Less the farther from its middle, as a Gaussian.
        Gaussian = "gaussian",
        /// All alike up to its border.
        Box = "box",
    }
}

choices! {
    /// Where the points are before they are optimised [Roveri 2015 fig. 4].
    pub enum Start {
        /// Grown from a seed, each part fitted to what is there already.
        Grow = "grow",
        /// Patches of the exemplar, side by side, from anywhere in it.
        Patches = "patches",
        /// At random, as densely as in the exemplar.
        Noise = "noise",
    }
}

params! {
    /// How a structure is continued. Lengths are in mean spacings of the points of the exemplar.
    pub struct StructureParams {
        /// Size of the window that has to look like the exemplar, at first; half of it in the end.
        window "window": Option<f64> = None, in 1.0..=1000.0, auto "about half of what repeats in the exemplar", unit "spacings";
        /// Width of the Gaussians that stand for the points.
        sigma "sigma": Option<f64> = None, in 0.2..=5.0, auto "1, and less where points lie as evenly as in a lattice or, but for volumes, on both sides of something thin", unit "spacings";
        /// Width of these Gaussians in the last levels, which make the spacing of the points even.
        fine "fine": f64 = 0.45, in 0.1..=5.0, unit "spacings";
        /// How much of a neighbourhood counts.
        shape "shape": Window = Window::Gaussian;
        /// Along how many directions the exemplar repeats: 1 for ropes, 2 for surfaces, 3 for volumes.
        repeats "repeats": Option<usize> = None, in 1..=3, auto "those along which the exemplar is long";
        /// Where the points are before they are optimised.
        start "start": Start = Start::Grow;
        /// Size of the patches that `start=patches` begins with.
        patch "patch": f64 = 6.0, in 1.0..=1000.0, unit "spacings";
        /// How far points are shaken after they were laid out from pieces of the exemplar, so that they are not its very points.
        shake "shake": Option<f64> = None, in 0.0..=2.0, auto "as unevenly as the points of the exemplar lie", unit "spacings";
        /// Factor from one size of the window to the next.
        shrink "shrink": f64 = 0.7, in 0.3..=0.99;
        /// Rounds of matching, moving, adding and removing for each size of the window.
        rounds "rounds": usize = 3, in 1..=1000;
        /// Steps of moving in each round.
        steps "steps": usize = 3, in 1..=1000;
        /// Matches that are tried at random for each place in each round, beside those of its neighbours.
        tries "tries": usize = 3, in 0..=10_000;
        /// Weight of normals beside places.
        normals "normals": f64 = 1.0, in 0.0..=10.0;
        /// Weight of colours beside places.
        colours "colours": f64 = 0.5, in 0.0..=10.0;
        /// Weight of radii beside places.
        radii "radii": f64 = 0.5, in 0.0..=10.0;
    }
}
