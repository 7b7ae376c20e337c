//! Parameters, with defaults that work.

use arabesque_core::{choices, params};

choices! {
    /// How points become a surface.
    pub enum Method {
        /// By metaballs where points have radii and no normals, by robust moving least squares otherwise.
        Auto = "auto",
        /// Robust implicit moving least squares, through points with normals.
        Rimls = "rimls",
        /// Metaballs: balls that melt together, with the radii of the points.
        Metaballs = "metaballs",
    }
}

choices! {
    /// What becomes a surface of its own.
    pub enum Parts {
        /// Each group, and each rigid element.
        Groups = "groups",
        /// All points together.
        One = "one",
    }
}

choices! {
    /// Where normals come from.
    pub enum Normals {
        /// From the points; estimated where there are none, turned to one side where they contradict one another.
        Auto = "auto",
        /// From the points alone.
        Given = "given",
        /// Estimated from the places of the points.
        Estimated = "estimated",
    }
}

params! {
    /// How points become a surface.
    pub struct SurfaceParams {
        /// How points become a surface.
        method "method": Method = Method::Auto;
        /// Side of the cells of the grid.
        cell "cell": Option<f64> = None, in 1e-9..=1e9, auto "two thirds of the mean spacing of the points", unit "units of the points";
        /// Cells along the longest side of the points, instead of the side of a cell.
        cells "cells": Option<usize> = None, in 8..=100_000, auto "by the spacing of the points";
        /// Radius in which points matter, in spacings: larger is smoother, and closes larger gaps.
        kernel "kernel": f64 = 2.0, in 1.2..=10.0, unit "spacings";
        /// Rounds in which points that do not fit lose weight; 0 is plain moving least squares.
        rounds "rounds": usize = 3, in 0..=20;
        /// Difference in height, in radii of the kernel, from which points lose weight: less keeps more detail.
        residual "residual": f64 = 0.5, in 0.05..=10.0, unit "radii of the kernel";
        /// Difference of normals from which points lose weight: less keeps sharper edges, more is smoother.
        sharpness "sharpness": f64 = 0.8, in 0.1..=10.0;
        /// Where normals come from.
        normals "normals": Normals = Normals::Auto;
        /// Neighbours of a point from which its spacing and its normal are told.
        neighbours "neighbours": usize = 10, in 4..=100;
        /// How far beyond the outermost points an open surface reaches, in spacings.
        border "border": f64 = 0.5, in 0.0..=5.0, unit "spacings";
        /// Reach of a metaball, in its radii: larger melts more together.
        reach "reach": f64 = 2.0, in 1.1..=10.0, unit "radii";
        /// What becomes a surface of its own.
        parts "parts": Parts = Parts::Groups;
    }
}
