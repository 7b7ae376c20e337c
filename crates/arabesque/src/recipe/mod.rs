//! Recipes: a run, described completely.
//!
//! A recipe is a TOML document. Every file that arabesque writes carries one, with small inputs inside it, so that the run can be
//! repeated from the result alone. What to read, which seed and what to write are the same for all methods; the [`Job`] says what is to
//! be made, and owns every option that only this kind of job has.

mod edit;
mod embedded;
mod field;
mod format;
mod input;
mod job;
mod legacy;
mod output;
mod region;
mod size;
mod version;

pub use edit::{Edit, Insertion};
pub use embedded::{Carrier, carried_recipe, is_result, recipe_in};
pub use field::{FieldFile, FieldSource};
pub use format::Format;
pub use input::{EMBEDDED_BYTES, Encoding, Input};
pub use job::{
    Constraint, Deform, Direction, ExemplarTile, Fill, Job, Method, Parameters, Physics, Reading, Redo, Relief, Ribbon,
    Space, Structures, Surface, Unit, Up, WidthSource, ribbon_options,
};
pub use output::OutputOptions;
pub use region::Region;
pub use size::{Cuboid, Size, Tile};

pub(crate) use embedded::NO_RECIPE;
pub(crate) use input::encode;
pub(crate) use size::pixels_per_user;

use arabesque_core::{Error, Result, suggest::nearest};
use arabesque_patterns::Params;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};

use legacy::{FLAT_KEYS, FlatRecipe, Head};
use version::version;

/// A run, described completely: what to read, what to make of it, and what to write.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Document", into = "Document")]
pub struct Recipe {
    /// Version of arabesque that the recipe was written by.
    pub arabesque: String,
    /// Seed of all random choices. Default: 0.
    pub seed: u64,
    /// The exemplar.
    pub exemplar: Input,
    /// What is to be made.
    pub job: Job,
    /// What is changed of the result after the run, one after the other.
    pub edits: Vec<Edit>,
    /// What to write.
    pub output: OutputOptions,
}

/// A recipe as its TOML has it: one table for each kind of job, of which at most one is there.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Recipe")]
struct Document {
    /// Version of arabesque that the recipe was written by.
    #[serde(default = "version")]
    arabesque: String,
    /// Seed of all random choices. Default: 0.
    #[serde(default)]
    seed: u64,
    /// The exemplar.
    exemplar: Input,
    /// Fill a part of the plane. One of `fill`, `redo`, `space`, `ribbon`, `surface`, `structures` and `relief` may be there; with none of them the
    /// layer Domain of the exemplar is filled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fill: Option<Fill>,
    /// Fill a region of the exemplar's own file again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    redo: Option<Redo>,
    /// Fill a box in space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    space: Option<Space>,
    /// Lay the pattern of a picture along curves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ribbon: Option<Ribbon>,
    /// Make a surface of points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    surface: Option<Surface>,
    /// Continue a repetitive structure that is given as points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    structures: Option<Structures>,
    /// Continue a relief: more of a patch of surface detail.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    relief: Option<Relief>,
    /// What to write.
    #[serde(default)]
    output: OutputOptions,
    /// What is changed of the result after the run, one after the other.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    edit: Vec<Edit>,
}

impl TryFrom<Document> for Recipe {
    type Error = String;

    fn try_from(document: Document) -> std::result::Result<Self, String> {
        let Document {
            arabesque,
            seed,
            exemplar,
            fill,
            redo,
            space,
            ribbon,
            surface,
            structures,
            relief,
            output,
            edit,
        } = document;
        let plane = [fill.map(Job::Fill), redo.map(Job::Redo), ribbon.map(Job::Ribbon)];
        let mut jobs = plane
            .into_iter()
            .chain([space.map(Job::Space), surface.map(Job::Surface), structures.map(Job::from), relief.map(Job::from)])
            .flatten();
        match (jobs.next(), jobs.next()) {
            (Some(job), None) => Ok(Self { arabesque, seed, exemplar, job, edits: edit, output }),
            (None, _) => Ok(Self { arabesque, seed, exemplar, job: Job::Fill(Fill::default()), edits: edit, output }),
            (Some(a), Some(b)) => Err(format!("two jobs, {} and {}; expected one", a.name(), b.name())),
        }
    }
}

impl From<Recipe> for Document {
    fn from(recipe: Recipe) -> Self {
        let Recipe { arabesque, seed, exemplar, job, edits: edit, output } = recipe;
        let (mut fill, mut redo, mut space, mut ribbon, mut surface, mut structures, mut relief) =
            (None, None, None, None, None, None, None);
        match job {
            Job::Surface(job) => surface = Some(job),
            Job::Structures(job) => structures = Some(*job),
            Job::Relief(job) => relief = Some(*job),
            Job::Fill(job) => fill = Some(job),
            Job::Redo(job) => redo = Some(job),
            Job::Space(job) => space = Some(job),
            Job::Ribbon(job) => ribbon = Some(job),
        }
        Self { arabesque, seed, exemplar, fill, redo, space, ribbon, surface, structures, relief, output, edit }
    }
}

impl JsonSchema for Recipe {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Recipe".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        Document::json_schema(generator)
    }
}

impl Recipe {
    /// A recipe for `exemplar` with everything but the job at its default.
    pub fn new(exemplar: Input, job: impl Into<Job>) -> Self {
        Self {
            arabesque: version(),
            seed: 0,
            exemplar,
            job: job.into(),
            edits: Vec::new(),
            output: OutputOptions::default(),
        }
    }

    /// Reads a recipe from TOML, in the present form or in the earlier, flat one.
    ///
    /// # Errors
    /// [`Error::Input`] with the line: not TOML, a missing or unknown key (the nearest known one is named), a value of the wrong kind.
    pub fn from_toml(name: &str, text: &str) -> Result<Self> {
        if FlatRecipe::is_one(text) {
            let (head, job) = toml::from_str::<FlatRecipe>(text).map_err(|e| refused(name, text, &e))?.into_job()?;
            let Head { arabesque, seed, exemplar, output } = head;
            return Ok(Self { arabesque, seed, exemplar, job, edits: Vec::new(), output });
        }
        toml::from_str(text).map_err(|e| refused(name, text, &e))
    }

    /// The recipe as TOML.
    ///
    /// # Errors
    /// [`Error::Input`] when a value has no form in TOML, such as a seed beyond 2^63.
    pub fn to_toml(&self) -> Result<String> {
        toml::to_string_pretty(self)
            .map_err(|e| Error::input("recipe", e.to_string(), "use a seed below 9223372036854775808"))
    }

    /// Every file that the recipe reads, with what it is read for: `exemplar`, or the option that wants it.
    pub fn inputs(&self) -> Vec<(&'static str, &Input)> {
        std::iter::once(("exemplar", &self.exemplar)).chain(self.job.inputs()).collect()
    }

    /// The JSON schema of recipes.
    pub fn schema() -> String {
        let schema = schemars::schema_for!(Recipe);
        serde_json::to_string_pretty(&schema).unwrap_or_default() + "\n"
    }

    /// Refuses a file format that never holds what is made, before anything is read.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for drawings of surfaces, structures and reliefs, which are pictures at best.
    pub fn check_format(&self, format: Format) -> Result<()> {
        self.job.check_format(format)
    }

    /// The file format where nobody says which.
    pub fn usual_format(&self) -> Format {
        self.job.usual_format(&self.exemplar)
    }
}

/// What the parser says of a recipe, with the line and the nearest known key.
fn refused(name: &str, text: &str, error: &toml::de::Error) -> Error {
    let line = error.span().and_then(|span| text.get(..span.start)).map(|before| before.matches('\n').count() + 1);
    let place = line.map_or_else(|| name.to_owned(), |n| format!("{name}: line {n}"));
    let mut message = error.message().replace('\n', " ");
    if message == "duplicate key"
        && let Some(key) = error.span().and_then(|span| text.get(span))
    {
        message = format!("the key `{key}` is there twice");
    }
    let advice = advice(&message);
    Error::input(place, message, advice)
}

/// What to do about a message of the parser: the nearest known key to an unknown one, or the table where that belongs.
fn advice(message: &str) -> String {
    let usual = || "see docs/recipe.schema.json for what a recipe can say".to_owned();
    let mut quoted = message.split('`').skip(1).step_by(2);
    let Some(unknown) = quoted.next().filter(|_| message.contains("unknown")) else { return usual() };
    let known: Vec<&str> = quoted.collect();
    let is_top = known.contains(&"exemplar");
    if is_top && FLAT_KEYS.contains(&unknown) {
        return format!("move `{unknown}` into the table of the job, such as [fill]");
    }
    if !is_top && (matches!(unknown, "preset" | "set") || Params::specs().iter().any(|spec| spec.name == unknown)) {
        return "move it into the table `params` of the job, such as [fill.params]".to_owned();
    }
    match (nearest(unknown, known.iter().copied()), nearest(unknown, FLAT_KEYS.iter().copied()).filter(|_| is_top)) {
        (Some(near), _) => format!("did you mean `{near}`?"),
        (None, Some(near)) => format!("did you mean `{near}`? it belongs into the table of the job, such as [fill]"),
        (None, None) => usual(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawings_hold_neither_surfaces_nor_points_with_attributes() {
        let format = |job: &str, format| {
            let text = format!("[exemplar]\npath = 'a.ply'\n{job}\n");
            Recipe::from_toml("t.toml", &text).unwrap().check_format(format)
        };
        for job in ["[surface]", "[structures]\nsize = '9x9'", "[relief]\nextent = '9x9'"] {
            assert!(format(job, Format::Svg).unwrap_err().to_string().contains("as svg is not supported"), "{job}");
            format(job, Format::Ply).unwrap();
        }
        format("[fill]\nsize = '9x9'", Format::Svg).unwrap();
    }

    #[test]
    fn a_short_recipe_is_enough() {
        let recipe = Recipe::from_toml(
            "r.toml",
            "exemplar = \"leaves.svg\"\n[fill]\nsize = \"210mmx297mm\"\navoid = [\"a.svg#b\"]\nscale = 2\norient = \"flow.svg\"\n\
             params = { levels = 2, matching = \"hard\", preset = \"tu2020\" }\n",
        )
        .unwrap();
        assert_eq!(recipe.exemplar.path, "leaves.svg");
        let Job::Fill(fill) = recipe.job else { panic!("{:?}", recipe.job) };
        assert_eq!(fill.scale, Some(FieldSource::Constant(2.0)));
        assert_eq!(fill.avoid, [Input::shape("a.svg#b")]);
        assert_eq!((fill.params.preset.as_deref(), &*fill.params.set["levels"]), (Some("tu2020"), "2"));
        assert!(matches!(fill.orient, Some(FieldSource::File(f)) if f.file.path == "flow.svg"));
    }

    #[test]
    fn recipes_survive_being_written() {
        let exemplar = Input::file("a.svg").embedding(b"<svg>\n'''\"\"\"]]>\\ \x09</svg>\n");
        let mut fill = Fill { tile: Some("400x400".parse().unwrap()), ..Fill::default() };
        fill.orient = Some(FieldSource::Constant(30.0));
        fill.density = Some(FieldSource::parse("map.png@0.1..0.9").unwrap());
        fill.avoid = vec![Input::shape("logo.svg#mark")];
        fill.params.set.insert("search".into(), "exhaustive".into());
        let mut recipe = Recipe::new(exemplar, fill);
        recipe.output = OutputOptions { expand: true, dpi: Some(300.0), ..OutputOptions::default() };
        let text = recipe.to_toml().unwrap();
        assert_eq!(Recipe::from_toml("again", &text).unwrap(), recipe, "{text}");
        let mut ribbon = Ribbon::new(Input::shape("c.svg#wave"));
        ribbon.avoid = vec![Input::file("mask.png")];
        for job in [
            Job::from(Redo::of(Region::Own("hole".into()))),
            Job::from(Space::new("5x5x5".parse().unwrap())),
            Job::from(Structures::along(Input::file("curve.obj"))),
            Job::from(Relief { on: Some(Input::file("hull.ply")), ..Relief::default() }),
            Job::from(Surface { trim: Some(Input::file("hull.ply")), ..Surface::default() }),
            Job::from(ribbon),
        ] {
            let recipe = Recipe::new(Input::file("a"), job);
            let text = recipe.to_toml().unwrap();
            assert_eq!(Recipe::from_toml("again", &text).unwrap(), recipe, "{text}");
        }
    }

    #[test]
    fn unknown_keys_are_refused_with_the_nearest() {
        for (text, line, near) in [
            ("sede = 1\nexemplar = \"a\"\n[fill]\n", "line 1", "`seed`"),
            ("exemplar = \"a\"\n[fill]\n[output]\nexpend = true\n", "line 4", "`expand`"),
            ("exemplar = { pth = \"a\" }\n[fill]\n", "line 1", "`path`"),
            ("exemplar = \"a\"\n[fill]\nborder = \"clop\"\n", "line 3", "`clip`"),
            ("exemplar = \"a\"\n[ribbon]\nalong = \"b\"\nwidht = 3\n", "line 4", "`width`"),
            ("exemplar = \"a\"\n[ribbon]\nalong = \"b\"\ntile = \"3x3\"\n", "line 4", "tile"),
        ] {
            let message = Recipe::from_toml("r.toml", text).unwrap_err().to_string();
            assert!(message.contains(line) && message.contains(near), "{message}");
        }
        assert!(Recipe::from_toml("r.toml", "seed = 1\n[fill]\n").unwrap_err().to_string().contains("exemplar"));
        assert!(Recipe::from_toml("r.toml", "seed = ").is_err());
    }

    #[test]
    fn a_recipe_has_one_job() {
        let none = Recipe::from_toml("r.toml", "exemplar = \"a\"\n").unwrap();
        assert_eq!(none.job, Job::Fill(Fill::default()));
        let mistyped = Recipe::from_toml("r.toml", "exemplar = \"a\"\n[fil]\n").unwrap_err().to_string();
        assert!(mistyped.contains("`fill`"), "{mistyped}");
        let two = "exemplar = \"a\"\n[fill]\n[space]\nbox = \"1x1x1\"\n";
        let two = Recipe::from_toml("r.toml", two).unwrap_err().to_string();
        assert!(two.contains("two jobs, fill and space"), "{two}");
    }

    #[test]
    fn the_schema_names_every_key() {
        let schema = Recipe::schema();
        for key in ["exemplar", "fill", "tile", "redo", "box", "ribbon", "pixels_per_unit", "range", "hash", "matching"]
        {
            assert!(schema.contains(&format!("\"{key}\"")), "{key}");
        }
    }
}
