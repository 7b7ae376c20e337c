//! `arabesque ribbon`: the pattern of a picture along curves.

use std::process::ExitCode;

use arabesque::{Closing, Input, Recipe, Ribbon as RibbonJob, WidthSource, core::options::help_list, ribbon_options};
use clap::Args;

use crate::{
    failure::Failure,
    produce::{RunOptions, produce},
};

/// Lay the pattern of a picture along curves: undistorted, without visible repetition, around bends and obstacles
#[derive(Args, Debug)]
#[command(after_long_help = parameters(), allow_negative_numbers = true)]
pub(crate) struct Ribbon {
    /// The pattern, from left to right on a transparent background: PNG pictures or SVG drawings; of several, the pattern passes from one
    /// into the next along each curve; objects with transparent columns between them are laid whole
    #[arg(required = true, value_name = "EXEMPLAR")]
    exemplars: Vec<String>,
    /// The curves: every path and shape of an SVG file, or #ID of one, or of a group or layer; or the lines of an OBJ file, in space
    #[arg(long, value_name = "CURVE.svg[#ID]")]
    along: String,
    /// Where to write; the extension chooses PNG, SVG, JSON, OBJ, GLB or TOML (the recipe alone); - is standard output
    #[arg(short, long, value_name = "OUT")]
    output: String,
    #[command(flatten)]
    shape: Shape,
    #[command(flatten)]
    pattern: Pattern,
    #[command(flatten)]
    canvas: Canvas,
    /// Seed of all random choices
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    seed: u64,
    #[command(flatten)]
    run: RunOptions,
}

#[derive(Args, Debug)]
#[command(next_help_heading = "Ribbon")]
struct Shape {
    /// Width of the ribbon in user units: 40, or 20..40 from start to end, or 0:20,0.5:40,1:20 at shares of the length
    /// [default: as wide as the exemplar is high]
    #[arg(long, value_name = "B")]
    width: Option<String>,
    /// Length of a piece in user units [default: a tenth of the height of the exemplar]
    #[arg(long, value_name = "D")]
    step: Option<f64>,
    /// User units per pixel of the exemplar, or per unit of an SVG exemplar [default: 1]
    #[arg(long, value_name = "S")]
    scale: Option<f64>,
    /// Put no ink on these shapes, or on the dark opaque pixels of a PNG picture that covers the canvas; may be given several times
    #[arg(long, value_name = "SHAPE.svg[#ID]|MASK.png")]
    avoid: Vec<String>,
    /// Do not bend neighbouring pieces to meet
    #[arg(long)]
    no_stitch: bool,
    /// How closed curves are closed
    #[arg(long, value_name = "RULE", value_parser = super::fill::choice::<Closing>())]
    closing: Option<Closing>,
}

#[derive(Args, Debug)]
#[command(next_help_heading = "Pattern")]
struct Pattern {
    /// Pixel of the exemplar at which the first piece begins, by its top left corner; the row may lie above the picture
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    first: Option<[i64; 2]>,
    /// Columns of the first exemplar that begin an open curve, and are used nowhere else: from A up to B, without B
    #[arg(long, value_name = "A..B", value_parser = range)]
    start: Option<[usize; 2]>,
    /// Columns of the last exemplar that end an open curve, and are used nowhere else
    #[arg(long, value_name = "A..B", value_parser = range)]
    end: Option<[usize; 2]>,
    /// With several exemplars: shares of the length at which one passes into the next, such as 0.3,0.6 [default: equal parts]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    changes: Vec<f64>,
    /// Strength of the penalty on showing a part again within the window; 0 switches it off [default: 1]
    #[arg(long, value_name = "N")]
    repetition: Option<f64>,
    /// Where showing a part again is penalised, in lengths of the exemplar [default: 1]
    #[arg(long, value_name = "N")]
    window: Option<f64>,
    /// Strength of the random preference of one part over another; 0 makes all seeds equal [default: 1]
    #[arg(long, value_name = "N")]
    variety: Option<f64>,
    /// Strength of the pull to the middle of the ribbon; 0 lets the pattern wander across it freely [default: 1]
    #[arg(long, value_name = "N")]
    centring: Option<f64>,
    /// Where no part of the exemplar is valid, cut the pattern there instead of giving up; a picture may then be opaque
    #[arg(long)]
    relax: bool,
    /// Search with pixels averaged to one, N along each side: for large exemplars [default: 1]
    #[arg(long, value_name = "N")]
    coarse: Option<usize>,
    /// Set one parameter by its name (listed under --help); may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = crate::pair::pair)]
    set: Vec<(String, String)>,
}

#[derive(Args, Debug)]
#[command(next_help_heading = "Canvas")]
struct Canvas {
    /// Size of the canvas, from the origin, such as 800x600 or 210mmx297mm [default: the page of the file of curves]
    #[arg(long, value_name = "WxH")]
    on_canvas: Option<String>,
    /// PNG: pixels per user unit [default: 1]
    #[arg(long, value_name = "N", conflicts_with = "dpi")]
    pixels_per_unit: Option<f64>,
    /// PNG: pixels per inch, instead
    #[arg(long, value_name = "N")]
    dpi: Option<f64>,
}

fn point(text: &str) -> Result<[i64; 2], String> {
    let parsed = text.split_once(',').and_then(|(x, y)| Some([x.trim().parse().ok()?, y.trim().parse().ok()?]));
    parsed.ok_or_else(|| "expected a column and a row, such as 120,-4".to_owned())
}

fn range(text: &str) -> Result<[usize; 2], String> {
    let parsed = text.split_once("..").and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    parsed.filter(|[a, b]| a < b).ok_or_else(|| "expected columns such as 0..60".to_owned())
}

/// The parameters that `--set` knows, for the long help.
fn parameters() -> String {
    format!("Parameters for --set, by name:\n{}", help_list(&ribbon_options()))
}

impl Ribbon {
    pub(crate) fn execute(self) -> Result<ExitCode, Failure> {
        let mut exemplars = self.exemplars.into_iter().map(Input::file);
        let first = exemplars.next().ok_or_else(|| Failure::usage("name an exemplar"))?;
        let mut ribbon = RibbonJob::new(Input::shape(&self.along));
        ribbon.then = exemplars.collect();
        ribbon.width = self.shape.width.map(|text| text.parse().map_or(WidthSource::Text(text), WidthSource::Constant));
        ribbon.step = self.shape.step;
        ribbon.scale = self.shape.scale;
        ribbon.stitch = !self.shape.no_stitch;
        ribbon.closing = self.shape.closing;
        ribbon.avoid = self.shape.avoid.iter().map(|text| Input::shape(text)).collect();
        ribbon.first = self.pattern.first;
        ribbon.start = self.pattern.start;
        ribbon.end = self.pattern.end;
        ribbon.changes = self.pattern.changes;
        ribbon.relax = self.pattern.relax;
        ribbon.size = self.canvas.on_canvas.map(|text| text.parse()).transpose()?;
        let strengths = [
            ("repetition", self.pattern.repetition),
            ("window", self.pattern.window),
            ("variety", self.pattern.variety),
            ("centring", self.pattern.centring),
        ];
        ribbon.params = self.pattern.set.into_iter().collect();
        ribbon.params.extend(strengths.into_iter().filter_map(|(name, v)| Some((name.to_owned(), v?.to_string()))));
        ribbon.params.extend(self.pattern.coarse.map(|n| ("coarse".to_owned(), n.to_string())));
        let mut recipe = Recipe::new(first, ribbon);
        recipe.seed = self.seed;
        recipe.output.pixels_per_unit = self.canvas.pixels_per_unit;
        recipe.output.dpi = self.canvas.dpi;
        produce(recipe, None, &self.output, &self.run)
    }
}
