//! `arabesque relief`: more of a patch of surface detail.

use std::process::ExitCode;

use arabesque::{
    Direction, Format, Input, Recipe, Relief as ReliefJob, Size,
    core::{Error, options::help_list},
    reliefs::{Plane, ReliefParams},
};
use clap::Args;

use super::fill::choice;
use crate::{
    failure::Failure,
    pair::pair,
    produce::{RunOptions, produce},
};

/// Continue a relief: from a scanned or modelled patch of surface detail as much as you want, in the plane, as a tile, on a mesh, or in a gap
///
/// The patch may be of any topology: bark, chain mail, knit, scales, threads, loose pieces.
#[derive(Args, Debug)]
#[command(after_long_help = parameters(), allow_negative_numbers = true)]
pub(crate) struct Relief {
    /// The patch: points with or without normals (PLY, XYZ, CSV), a mesh (OBJ, PLY, STL, GLB), or a height field (PNG); - is standard input
    texture: String,
    /// Where to write; the extension chooses PLY, OBJ, GLB, CSV, JSON, PNG or TOML (the recipe alone); - is standard output
    #[arg(short, long, value_name = "OUT")]
    output: String,
    #[command(flatten)]
    place: Place,
    #[command(flatten)]
    pattern: Pattern,
    #[command(flatten)]
    writing: Writing,
    /// Seed of all random choices
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    seed: u64,
    #[command(flatten)]
    run: RunOptions,
}

#[derive(Args, Debug)]
#[command(next_help_heading = "Where")]
struct Place {
    /// Cover so much of the plane: width and depth in the units of the patch, such as 3x2
    #[arg(long, value_name = "WxD", group = "where")]
    extent: Option<String>,
    /// Make of the extent a tile that repeats without a seam
    #[arg(long, requires = "extent")]
    tile: bool,
    /// Cover a mesh
    #[arg(long, value_name = "MESH", group = "where")]
    on: Option<String>,
    /// Fill a gap in the patch itself from what is around it
    #[arg(long, group = "where")]
    fill_hole: bool,
    /// On a mesh: least, most, a direction such as 0,0,1, or the lines of an OBJ file [default: least]
    #[arg(long, value_name = "WAY", requires = "on", allow_hyphen_values = true)]
    direction: Option<String>,
    /// On a mesh: size of the relief relative to the patch [default: 1]
    #[arg(long, value_name = "N", requires = "on")]
    scale: Option<f64>,
}

#[derive(Args, Debug)]
#[command(next_help_heading = "Pattern")]
struct Pattern {
    /// Side of the pieces that are put together, in the units of the patch [default: by what repeats]
    #[arg(long, value_name = "P")]
    patch: Option<f64>,
    /// Axis across the plane along which the relief goes on [default: along which it is thinnest]
    #[arg(long, value_name = "AXIS", value_parser = choice::<Plane>())]
    plane: Option<Plane>,
    /// The box of the relief proper along its plane; the points go on beyond it [default: the patch without its border]
    #[arg(long = "box", value_name = "X0,Y0,X1,Y1", value_parser = corners, allow_hyphen_values = true)]
    bounds: Option<[f64; 4]>,
    /// Of a height field: how much higher white is than black, in pixels [default: a tenth of the shorter side]
    #[arg(long, value_name = "H")]
    height: Option<f64>,
    /// Set one parameter by its name (listed under --help); may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = pair)]
    set: Vec<(String, String)>,
}

#[derive(Args, Debug)]
#[command(next_help_heading = "Writing")]
struct Writing {
    /// Make the surface of the points, and write that
    #[arg(long)]
    mesh: bool,
    /// With --mesh: set one parameter of the surface by its name; may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = pair, requires = "mesh")]
    surface: Vec<(String, String)>,
    /// PNG: write the heights of the result with 16 bits, for displacement, instead of a picture
    #[arg(long, conflicts_with = "mesh")]
    height_field: bool,
    /// PNG: azimuth and elevation of the eye in degrees [default: -60,30]
    #[arg(long, value_name = "A,E", allow_hyphen_values = true)]
    view: Option<String>,
}

fn corners(text: &str) -> Result<[f64; 4], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
    let corners = numbers.and_then(|numbers| numbers.try_into().ok());
    corners.ok_or_else(|| "expected four numbers, such as 0.1,0.1,0.9,0.9".to_owned())
}

/// The parameters that `--set` knows, for the long help.
fn parameters() -> String {
    format!("Parameters for --set, by name:\n{}", help_list(&ReliefParams::specs()))
}

/// Width and depth, in the units of the texture.
fn extent(text: &str) -> Result<Size, Error> {
    let expected = "width x depth with positive numbers up to 1e9 in the units of the texture, such as 2x1.5";
    text.parse().map_err(|_| Error::parameter("extent", format!("\"{text}\""), expected))
}

impl Relief {
    pub(crate) fn execute(self) -> Result<ExitCode, Failure> {
        let format = self.run.format.or(Format::of_path(&self.output).ok().flatten());
        if self.writing.height_field && format.is_some_and(|format| format != Format::Png) {
            return Err(Failure::usage("--height-field is a picture; give -o OUT.png"));
        }
        let mut job = ReliefJob {
            extent: self.place.extent.as_deref().map(extent).transpose()?,
            tile: self.place.tile,
            on: self.place.on.map(Input::file),
            direction: self.place.direction.map(|text| Direction::parse(&text)),
            scale: self.place.scale,
            fill_hole: self.place.fill_hole,
            bounds: self.pattern.bounds,
            height: self.pattern.height,
            height_field: self.writing.height_field,
            mesh: self.writing.mesh,
            ..ReliefJob::default()
        };
        job.params.extend(self.pattern.set);
        let shortcuts = [
            ("patch", self.pattern.patch.map(|v| v.to_string())),
            ("plane", self.pattern.plane.map(|v| v.name().to_owned())),
        ];
        job.params.extend(shortcuts.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?))));
        job.surface.extend(self.writing.surface);
        let mut recipe = Recipe::new(Input::file(&self.texture), job);
        recipe.seed = self.seed;
        recipe.output.view = self.writing.view;
        produce(recipe, None, &self.output, &self.run)
    }
}
