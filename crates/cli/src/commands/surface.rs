//! `arabesque surface`: the surface of points.

use std::process::ExitCode;

use arabesque::{
    Input, Recipe, Surface as SurfaceJob,
    core::options::help_list,
    surfaces::{Method, SurfaceParams},
};
use clap::Args;

use super::fill::choice;
use crate::{
    failure::Failure,
    pair::pair,
    produce::{RunOptions, produce},
};

/// Make the surface of points: through points with normals, or around points with radii
///
/// Groups and rigid elements become parts of their own. Where the points surround something the surface is closed; elsewhere it ends near the
/// outermost of them. Normals that are missing are estimated.
#[derive(Args, Debug)]
#[command(after_long_help = parameters(), allow_negative_numbers = true)]
pub(crate) struct Surface {
    /// The points: PLY, XYZ or CSV, or those of an OBJ or GLB file; - is standard input
    points: String,
    /// Where to write; the extension chooses PLY, OBJ, GLB, JSON, PNG or TOML (the recipe alone); - is standard output
    #[arg(short, long, value_name = "OUT")]
    output: String,
    /// How the points become a surface
    #[arg(long, value_name = "METHOD", value_parser = choice::<Method>())]
    method: Option<Method>,
    /// Side of the cells of the grid, in the units of the points [default: two thirds of their mean spacing]
    #[arg(long, value_name = "H", conflicts_with = "cells")]
    resolution: Option<f64>,
    /// Cells along the longest side of the points, instead of the side of a cell
    #[arg(long, value_name = "N")]
    cells: Option<usize>,
    /// Cut off what is outside of this closed mesh
    #[arg(long, value_name = "MESH")]
    trim: Option<String>,
    /// PNG: azimuth and elevation of the eye in degrees [default: -60,30]
    #[arg(long, value_name = "A,E", allow_hyphen_values = true)]
    view: Option<String>,
    /// Set one parameter by its name (listed under --help); may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = pair)]
    set: Vec<(String, String)>,
    #[command(flatten)]
    run: RunOptions,
}

/// The parameters that `--set` knows, for the long help.
fn parameters() -> String {
    format!("Parameters for --set, by name:\n{}", help_list(&SurfaceParams::specs()))
}

impl Surface {
    pub(crate) fn execute(self) -> Result<ExitCode, Failure> {
        let mut job = SurfaceJob { trim: self.trim.map(Input::file), ..SurfaceJob::default() };
        job.params.extend(self.set);
        let shortcuts = [
            ("method", self.method.map(|m| m.name().to_owned())),
            ("cell", self.resolution.map(|v| v.to_string())),
            ("cells", self.cells.map(|v| v.to_string())),
        ];
        job.params.extend(shortcuts.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?))));
        let mut recipe = Recipe::new(Input::file(&self.points), job);
        recipe.output.view = self.view;
        produce(recipe, None, &self.output, &self.run)
    }
}
