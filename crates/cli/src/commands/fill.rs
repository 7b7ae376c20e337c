//! `arabesque fill`: a page, a shape, a seamless tile or a box from an exemplar.

use std::{collections::BTreeMap, process::ExitCode};

use arabesque::{
    Border, Constraint, Deform, Direction, Error, ExemplarTile, FieldSource, Fill as FillJob, Input, Job, Method,
    Parameters, Physics, Recipe, Redo, Region, Resources, Space, Structures, Unit, Up,
    core::options::{Choice, help_list, preset_list},
    io::file,
    is_scene_of_meshes,
    patterns::Params,
    structures::StructureParams,
};
use clap::{
    Args,
    builder::{PossibleValue, PossibleValuesParser, TypedValueParser},
};

use crate::{
    failure::Failure,
    pair::pair,
    produce::{RunOptions, produce},
    summary,
};

/// Fill a page, a shape, a seamless tile or a box in space with the pattern of an exemplar
#[derive(Args, Debug)]
#[command(after_long_help = parameters(), allow_negative_numbers = true)]
pub(crate) struct Fill {
    /// The example: an SVG drawing, points as CSV, curves in space as OBJ, or a structure: points with attributes as PLY or XYZ, points
    /// and meshes as GLB; - is standard input
    exemplar: String,
    /// Where to write; the extension chooses SVG, PNG, JSON, CSV, OBJ, PLY, GLB or TOML (the recipe alone); - is standard output
    #[arg(short, long, value_name = "OUT")]
    output: String,
    #[command(flatten)]
    place: Place,
    #[command(flatten)]
    fields: Fields,
    #[command(flatten)]
    engine: Engine,
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
    /// Fill a page: 800x600 in the units of the exemplar, or with a unit such as 210mmx297mm, 8inx8in, 800pxx600px
    #[arg(long, value_name = "WxH", group = "where")]
    size: Option<String>,
    /// Fill the closed shapes of an SVG file, holes included; #ID takes one of them
    #[arg(long, value_name = "SHAPE.svg[#ID]", group = "where")]
    domain: Option<String>,
    /// Make a tile that repeats without a seam; auto is the smallest that the repeat of the exemplar fills exactly
    #[arg(long, value_name = "WxH|auto", group = "where")]
    tile: Option<String>,
    /// Fill a box in space, in the units of the exemplar: curves (OBJ) or points (CSV with a column z)
    #[arg(long = "box", value_name = "XxYxZ", group = "where")]
    cuboid: Option<String>,
    /// Structures and scenes of meshes: follow the lines of an OBJ file; structures in the plane the paths of an SVG file
    #[arg(long, value_name = "CURVE[#ID]", group = "where")]
    along: Option<String>,
    /// Structures and scenes of meshes: cover a mesh
    #[arg(long, value_name = "MESH", group = "where")]
    on: Option<String>,
    /// Structures and scenes of meshes: fill a closed mesh
    #[arg(long, value_name = "MESH", group = "where")]
    inside: Option<String>,
    /// Scenes of meshes: what lies on the floor in the exemplar (its lowest place) lies on the floor of the result, and stacks that stand apart stay stacks
    #[arg(long)]
    floor: bool,
    /// Scenes of meshes: where the elements of a class may lie: floor as with --floor, free anywhere; may be given several times
    #[arg(long, value_name = "CLASS=RULE", value_parser = pair)]
    constrain: Vec<(String, String)>,
    /// Scenes of meshes: the axis that is up in the files that are read; results have the same, GLB always y
    #[arg(long, value_name = "AXIS", default_value = Up::default().name(), value_parser = choice::<Up>())]
    up: Up,
    /// Scenes of meshes: length of a unit of the files that are read; results have the same, GLB always m
    #[arg(long, value_name = "UNIT", default_value = Unit::default().name(), value_parser = choice::<Unit>())]
    unit: Unit,
    /// Scenes of meshes: elements bend: all, those of some classes (names with commas between them), or off for none; by default those
    /// that the exemplar shows bent in several ways [a value needs =; without one: all]
    #[arg(long, value_name = "CLASS,..", num_args = 0..=1, require_equals = true, default_missing_value = "all",
        value_parser = str::parse::<Deform>)]
    deform: Option<Deform>,
    /// Scenes of meshes: elements push one another apart, fall and come to rest: so many steps of physics after each iteration, or settle
    /// for the end alone [a value needs =; without one: 5]
    #[arg(long, value_name = "N|settle", num_args = 0..=1, require_equals = true, default_missing_value = "5",
        value_parser = str::parse::<Physics>)]
    physics: Option<Physics>,
    /// With --physics: the direction in which elements fall, its length the strength [default: 0,-1,0; on a mesh towards it]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = triple, requires = "physics")]
    gravity: Option<[f64; 3]>,
    /// With --physics: friction between elements and with what is around them, from 0 to 2 [default: 0.5]
    #[arg(long, value_name = "F", requires = "physics")]
    friction: Option<f64>,
    /// Keep these shapes free; structures also what is dark in a PNG picture; scenes of meshes closed meshes; may be given several times
    #[arg(long, value_name = "SHAPE.svg[#ID]")]
    avoid: Vec<String>,
    /// Elements and strokes, or points, that stay exactly where this file has them; the rest is fitted around them and joined to them
    #[arg(long, value_name = "FILE")]
    keep: Option<String>,
    /// Fill a region of the exemplar's own file again and leave the rest as it is: x,y,w,h, or #ID of a shape in the file
    #[arg(long, value_name = "REGION", group = "where", allow_hyphen_values = true, value_parser = Region::parse)]
    redo: Option<Region>,
    /// Continue the pattern of this region of the file in the region --to
    #[arg(long, value_name = "REGION", requires = "to", allow_hyphen_values = true, value_parser = Region::parse)]
    from: Option<Region>,
    /// Fill this region of the file with the pattern of the region --from and leave the rest as it is
    #[arg(long, value_name = "REGION", group = "where", requires = "from", allow_hyphen_values = true, value_parser = Region::parse)]
    to: Option<Region>,
    /// What happens to elements and strokes at the border
    /// [default: clip; with --redo and --to, where all are elements, cross]
    #[arg(long, value_name = "RULE", value_parser = choice::<Border>())]
    border: Option<Border>,
}

#[derive(Args, Debug)]
#[command(next_help_heading = "Fields")]
struct Fields {
    /// Turn the pattern: degrees (clockwise), strokes in an SVG file, or a PNG picture whose hue, or gray, is the direction
    #[arg(long, value_name = "FIELD", allow_hyphen_values = true, value_parser = FieldSource::parse)]
    orient: Option<FieldSource>,
    /// Scale the pattern: a factor, or a PNG picture from black (0.5) to white (2); PICTURE.png@0.8..1.2 for another range
    #[arg(long, value_name = "FIELD", allow_hyphen_values = true, value_parser = FieldSource::parse)]
    scale: Option<FieldSource>,
    /// Elements per area: a factor, or a PNG picture from black (0.2) to white (1); PICTURE.png@0.5..1 for another range
    #[arg(long, value_name = "FIELD", allow_hyphen_values = true, value_parser = FieldSource::parse)]
    density: Option<FieldSource>,
    /// On meshes: where the structure runs: least or most (along which the mesh bends so), a direction in space such as 0,0,1, or the
    /// lines of an OBJ file as strokes on the mesh [default: least]
    #[arg(long, value_name = "DIRECTION", allow_hyphen_values = true)]
    direction: Option<String>,
    /// Along curves: size from start to end, as 1..0.5, or at shares of the length, as 0:1,0.5:2,1:1
    #[arg(long, value_name = "FACTORS")]
    taper: Option<String>,
    /// Along curves: degrees by which the pattern turns about the curve from start to end
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true)]
    twist: Option<f64>,
    /// Along curves: how far from the curve elements, or points that repeat across it too, may lie
    #[arg(long, value_name = "R")]
    tube: Option<f64>,
}

#[derive(Args, Debug)]
#[command(next_help_heading = "Method")]
struct Engine {
    /// What the exemplar is made of
    #[arg(long, value_name = "METHOD", default_value = Method::default().name(), value_parser = choice::<Method>())]
    method: Method,
    /// The exemplar is one period of the pattern: what an edge of it cuts goes on at the opposite edge
    #[arg(long, value_name = "WHETHER", num_args = 0..=1, require_equals = true, default_missing_value = "yes",
        default_value = ExemplarTile::default().name(), value_parser = choice::<ExemplarTile>())]
    exemplar_tile: ExemplarTile,
    /// Named set of parameters: default, ma2011, tu2020
    #[arg(long, value_name = "NAME", default_value = "default")]
    preset: String,
    /// Neighbourhood radius, in the units of the exemplar [default: chosen from the exemplar]
    #[arg(long, value_name = "R", allow_hyphen_values = true)]
    radius: Option<f64>,
    /// Levels of the hierarchy [default: as the preset has it]
    #[arg(long, value_name = "N")]
    levels: Option<usize>,
    /// Iterations per level [default: as the preset has it]
    #[arg(long, value_name = "N")]
    iterations: Option<usize>,
    /// Set one parameter by its name (listed under --help); may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = pair)]
    set: Vec<(String, String)>,
}

#[derive(Args, Debug)]
#[command(next_help_heading = "Writing")]
struct Writing {
    /// SVG: write every element out in place, flattened, for cutters and plotters
    #[arg(long)]
    expand: bool,
    /// PNG: pixels per inch [default: 96]
    #[arg(long, value_name = "N", conflicts_with = "pixels_per_unit")]
    dpi: Option<f64>,
    /// PNG: pixels per user unit of the page
    #[arg(long, value_name = "N")]
    pixels_per_unit: Option<f64>,
    /// PNG of a structure in space: azimuth and elevation of the eye in degrees [default: -60,30]
    #[arg(long, value_name = "A,E", allow_hyphen_values = true)]
    view: Option<String>,
    /// GLB of a scene of meshes: a list of places for each mesh (EXT_mesh_gpu_instancing) instead of a node for each element
    #[arg(long)]
    instancing: bool,
    /// PLY of a scene of meshes: the centres of the elements instead of their meshes
    #[arg(long)]
    centres: bool,
    /// Structures: write the surface of the points instead of the points
    #[arg(long)]
    mesh: bool,
    /// With --mesh: set a parameter of the surface by its name (listed under surface --help); may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = pair, requires = "mesh")]
    surface: Vec<(String, String)>,
}

/// Reads three numbers.
fn triple(text: &str) -> Result<[f64; 3], Error> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
    let three = numbers.and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
    three.ok_or_else(|| Error::parameter("gravity", text, "three numbers, such as 0,-1,0"))
}

impl Place {
    /// Whether it is a part of space that elements can fill.
    fn is_in_space(&self) -> bool {
        self.cuboid.is_some() || self.inside.is_some() || self.on.is_some() || self.along.is_some()
    }
}

/// Reads the names of an enumeration of the library, and lists them in the help.
pub(crate) fn choice<T: Choice + Send + Sync>() -> impl TypedValueParser<Value = T> {
    let known = T::CHOICES.iter().map(|(name, help)| PossibleValue::new(*name).help(help.trim_end_matches('.')));
    PossibleValuesParser::new(known).try_map(|text| text.parse::<T>())
}

/// The parameters that `--set` knows, for the long help.
fn parameters() -> String {
    let (list, presets) = (help_list(&Params::specs()), preset_list(Params::PRESETS));
    let structures = help_list(&StructureParams::specs());
    format!(
        "Parameters for --set, by name:\n{list}\nPresets:\n{presets}\nParameters for --set of structures:\n{structures}"
    )
}

impl Engine {
    /// What is set by name; the shortcuts count more than `--set`.
    fn parameters(self) -> Parameters {
        let mut set: BTreeMap<String, String> = self.set.into_iter().collect();
        let shortcuts = [
            ("radius", self.radius.map(|v| v.to_string())),
            ("levels", self.levels.map(|v| v.to_string())),
            ("iterations", self.iterations.map(|v| v.to_string())),
        ];
        set.extend(shortcuts.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?))));
        Parameters { preset: Some(self.preset).filter(|name| name != "default"), set }
    }
}

impl Fill {
    pub(crate) fn execute(self) -> Result<ExitCode, Failure> {
        let (tells_json, path) = (self.run.talk.json, self.output.clone());
        let (recipe, run) = self.recipe().inspect_err(|failure| {
            if tells_json && path != file::STANDARD {
                summary::print_failure(failure);
            }
        })?;
        produce(recipe, None, &path, &run)
    }

    /// What the command line asks for.
    fn recipe(self) -> Result<(Recipe, RunOptions), Failure> {
        let exemplar = Input::file(&self.exemplar);
        let writing = self.writing;
        let is_structure = match self.engine.method {
            Method::Structures => true,
            Method::Auto => {
                is_structure(&self.exemplar)
                    && !(self.place.is_in_space() && is_scene_of_meshes(&exemplar, &Resources::default())?)
            }
            Method::Elements | Method::Curves => false,
        };
        let is_scene = !is_structure && self.place.is_in_space() && is_scene(&exemplar)?;
        if self.place.physics.is_some() && !is_scene {
            let advice =
                "leave it out, or give a scene of meshes as GLB, with --method elements where there are points in it";
            return Err(Error::Unsupported {
                what: "physics for anything but elements in space".into(),
                advice: advice.into(),
            }
            .into());
        }
        let job = if is_structure {
            structures(self.place, self.fields, self.engine, &writing)?
        } else if is_scene {
            not_for_scenes(&self.fields, &writing)?;
            job(self.place, self.fields, self.engine)?
        } else {
            not_for_structures(&self.place, &self.fields, &writing)?;
            job(self.place, self.fields, self.engine)?
        };
        let mut recipe = Recipe::new(exemplar, job);
        recipe.seed = self.seed;
        recipe.output.expand = writing.expand;
        recipe.output.dpi = writing.dpi;
        recipe.output.pixels_per_unit = writing.pixels_per_unit;
        recipe.output.view = writing.view;
        recipe.output.instancing = writing.instancing;
        recipe.output.centres = writing.centres;
        Ok((recipe, self.run))
    }
}

/// Whether a file holds a scene of meshes: by its ending, or an OBJ file that has faces.
fn is_scene(exemplar: &Input) -> Result<bool, Error> {
    let lower = exemplar.name().to_ascii_lowercase();
    let by_ending = [".glb", ".gltf"].iter().any(|ending| lower.ends_with(ending));
    Ok(by_ending || lower.ends_with(".obj") && is_scene_of_meshes(exemplar, &Resources::default())?)
}

/// Refuses what scenes of meshes do not have.
fn not_for_scenes(fields: &Fields, writing: &Writing) -> Result<(), Error> {
    let given = [("taper", fields.taper.is_some()), ("mesh", writing.mesh)];
    match given.into_iter().find(|(_, is_given)| *is_given) {
        None => Ok(()),
        Some((name, _)) => Err(Error::Unsupported {
            what: format!("{name} for a scene of meshes"),
            advice: "leave it out, or use --method structures".into(),
        }),
    }
}

/// Whether a file holds points with attributes, by its ending.
fn is_structure(exemplar: &str) -> bool {
    let lower = exemplar.to_ascii_lowercase();
    [".ply", ".xyz", ".glb", ".gltf"].iter().any(|ending| lower.ends_with(ending))
}

/// Refuses what drawings and elements do not have.
fn not_for_structures(place: &Place, fields: &Fields, writing: &Writing) -> Result<(), Error> {
    let given = [
        ("along", place.along.is_some()),
        ("on", place.on.is_some()),
        ("inside", place.inside.is_some()),
        ("direction", fields.direction.is_some()),
        ("taper", fields.taper.is_some()),
        ("twist", fields.twist.is_some()),
        ("tube", fields.tube.is_some()),
        ("view", writing.view.is_some()),
        ("mesh", writing.mesh),
    ];
    match given.into_iter().find(|(_, is_given)| *is_given) {
        None => Ok(()),
        Some((name, _)) => {
            let advice = "leave it out, or give points as PLY, or as CSV with --method structures";
            Err(Error::Unsupported {
                what: format!("{name} for an exemplar that is no structure of points"),
                advice: advice.into(),
            })
        }
    }
}

/// The job that the options mean for a structure of points.
fn structures(place: Place, fields: Fields, engine: Engine, writing: &Writing) -> Result<Job, Error> {
    let given = [
        ("redo", place.redo.is_some()),
        ("from", place.from.is_some()),
        ("to", place.to.is_some()),
        ("border", place.border.is_some()),
        ("density", fields.density.is_some()),
        ("exemplar-tile", engine.exemplar_tile == ExemplarTile::Yes),
        ("radius", engine.radius.is_some()),
        ("levels", engine.levels.is_some()),
        ("preset", engine.preset != "default"),
        ("expand", writing.expand),
    ];
    if let Some((name, _)) = given.into_iter().find(|(_, is_given)| *is_given) {
        let advice = "leave it out; --set sets the parameters of structures, as --help lists them";
        return Err(Error::Unsupported { what: format!("{name} for a structure of points"), advice: advice.into() });
    }
    let mut params: BTreeMap<String, String> = engine.set.into_iter().collect();
    params.extend(engine.iterations.map(|n| ("rounds".to_owned(), n.to_string())));
    Ok(Job::from(Structures {
        size: place.size.map(|text| text.parse()).transpose()?,
        tile: place.tile.map(|text| text.parse()).transpose()?,
        domain: place.domain.as_deref().map(Input::shape),
        cuboid: place.cuboid.map(|text| text.parse()).transpose()?,
        along: place.along.as_deref().map(Input::shape),
        on: place.on.map(Input::file),
        inside: place.inside.map(Input::file),
        keep: place.keep.map(Input::file),
        avoid: place.avoid.iter().map(|text| Input::shape(text)).collect(),
        orient: fields.orient,
        scale: fields.scale,
        direction: fields.direction.as_deref().map(Direction::parse),
        radius: fields.tube,
        taper: fields.taper,
        twist: fields.twist,
        mesh: writing.mesh,
        params,
        surface: writing.surface.iter().cloned().collect(),
    }))
}

/// The job that the options mean.
fn job(place: Place, fields: Fields, engine: Engine) -> Result<Job, Error> {
    if place.from.is_some() && place.to.is_none() {
        return Err(match place.redo {
            Some(_) => Error::parameter("redo", "given with from or to", "redo alone, or from and to"),
            None => Error::parameter("from", "given without to", "both from and to"),
        });
    }
    let avoid = place.avoid.iter().map(|text| Input::shape(text)).collect();
    let (method, border, exemplar_tile) = (engine.method, place.border, engine.exemplar_tile);
    let elsewhere = place.cuboid.is_some() || place.redo.is_some() || place.to.is_some();
    if exemplar_tile == ExemplarTile::Yes && elsewhere {
        let advice = "leave it out, or fill a page, a shape or a tile";
        return Err(Error::Unsupported {
            what: "exemplar-tile together with box, redo or to".into(),
            advice: advice.into(),
        });
    }
    let Fields { orient, scale, density, direction, tube, twist, .. } = fields;
    if place.is_in_space() {
        let rule = |(class, rule): &(String, String)| Ok::<_, Error>((class.clone(), rule.parse::<Constraint>()?));
        return Ok(Job::from(Space {
            cuboid: place.cuboid.map(|text| text.parse()).transpose()?,
            inside: place.inside.map(Input::file),
            on: place.on.map(Input::file),
            keep: place.keep.map(Input::file),
            direction: direction.as_deref().map(Direction::parse),
            along: place.along.map(Input::file),
            tube,
            twist,
            avoid,
            constrain: place.constrain.iter().map(rule).collect::<Result<_, _>>()?,
            up: place.up,
            unit: place.unit,
            floor: place.floor,
            deform: place.deform.unwrap_or_default(),
            physics: place.physics,
            gravity: place.gravity,
            friction: place.friction,
            method,
            border,
            orient,
            scale,
            density,
            params: engine.parameters(),
        }));
    }
    if let Some(region) = place.redo.or(place.to) {
        if place.keep.is_some() {
            let name = if place.from.is_some() { "to" } else { "redo" };
            let expected = "the region alone: the page and what stays are those of the file";
            return Err(Error::parameter(name, "given with size, tile, domain or keep", expected));
        }
        let (from, params) = (place.from, engine.parameters());
        return Ok(Job::from(Redo { border, method, from, orient, scale, density, avoid, params, ..Redo::of(region) }));
    }
    Ok(Job::from(FillJob {
        size: place.size.map(|text| text.parse()).transpose()?,
        tile: place.tile.map(|text| text.parse()).transpose()?,
        border,
        method,
        exemplar_tile,
        domain: place.domain.as_deref().map(Input::shape),
        keep: place.keep.map(Input::file),
        orient,
        scale,
        density,
        avoid,
        params: engine.parameters(),
    }))
}
