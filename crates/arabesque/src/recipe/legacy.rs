//! Recipes in the earlier, flat form, which files in the wild carry: the options of all jobs side by side, and which job was
//! meant follows from what is there.

use std::{collections::BTreeMap, fmt};

use arabesque_core::{Border, Error, Result};
use arabesque_ribbons::Closing;
use serde::{
    Deserialize, Deserializer,
    de::{IgnoredAny, MapAccess, SeqAccess, Visitor},
};

use crate::recipe::{
    field::FieldSource,
    input::Input,
    job::{ExemplarTile, Fill, Job, Method, Parameters, Redo, Ribbon, Space, WidthSource, plain_values},
    output::OutputOptions,
    region::Region,
    size::{Cuboid, Size, Tile},
    version::version,
};

/// Keys that stand at the top of a flat recipe, and nowhere near the top of one of today.
pub(super) const FLAT_KEYS: &[&str] = &[
    "size",
    "tile",
    "box",
    "border",
    "method",
    "preset",
    "radius",
    "levels",
    "iterations",
    "domain",
    "keep",
    "from",
    "to",
    "orient",
    "scale",
    "density",
    "avoid",
    "set",
];

/// A recipe in the flat form.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FlatRecipe {
    #[serde(default = "version")]
    arabesque: String,
    #[serde(default)]
    seed: u64,
    size: Option<Size>,
    tile: Option<Size>,
    #[serde(rename = "box")]
    cuboid: Option<Cuboid>,
    border: Option<Border>,
    #[serde(default)]
    method: Method,
    preset: Option<String>,
    radius: Option<f64>,
    levels: Option<usize>,
    iterations: Option<usize>,
    exemplar: Input,
    domain: Option<Input>,
    keep: Option<Input>,
    redo: Option<Region>,
    from: Option<Region>,
    to: Option<Region>,
    orient: Option<FieldSource>,
    scale: Option<FieldSource>,
    density: Option<FieldSource>,
    #[serde(default)]
    avoid: Vec<Input>,
    #[serde(default, deserialize_with = "plain_values")]
    set: BTreeMap<String, String>,
    ribbon: Option<FlatRibbon>,
    #[serde(default)]
    output: OutputOptions,
}

/// What a value of a recipe looks like, whatever is in it.
enum Shape {
    /// A table with these keys.
    Table(Vec<String>),
    /// Anything else.
    Other,
}

impl<'de> Deserialize<'de> for Shape {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        struct Look;

        impl<'de> Visitor<'de> for Look {
            type Value = Shape;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("any value")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<Shape, A::Error> {
                let mut keys = Vec::new();
                while let Some((key, IgnoredAny)) = map.next_entry()? {
                    keys.push(key);
                }
                Ok(Shape::Table(keys))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> std::result::Result<Shape, A::Error> {
                while list.next_element::<IgnoredAny>()?.is_some() {}
                Ok(Shape::Other)
            }

            fn visit_str<E>(self, _: &str) -> std::result::Result<Shape, E> {
                Ok(Shape::Other)
            }

            fn visit_bool<E>(self, _: bool) -> std::result::Result<Shape, E> {
                Ok(Shape::Other)
            }

            fn visit_i64<E>(self, _: i64) -> std::result::Result<Shape, E> {
                Ok(Shape::Other)
            }

            fn visit_u64<E>(self, _: u64) -> std::result::Result<Shape, E> {
                Ok(Shape::Other)
            }

            fn visit_f64<E>(self, _: f64) -> std::result::Result<Shape, E> {
                Ok(Shape::Other)
            }
        }

        deserializer.deserialize_any(Look)
    }
}

/// What recipes of all jobs have.
pub(super) struct Head {
    pub(super) arabesque: String,
    pub(super) seed: u64,
    pub(super) exemplar: Input,
    pub(super) output: OutputOptions,
}

/// The table of ribbons, which had its canvas, scale and avoided areas at the top of the recipe.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FlatRibbon {
    along: Input,
    #[serde(default)]
    then: Vec<Input>,
    #[serde(default)]
    changes: Vec<f64>,
    width: Option<WidthSource>,
    step: Option<f64>,
    first: Option<[i64; 2]>,
    start: Option<[usize; 2]>,
    end: Option<[usize; 2]>,
    closing: Option<Closing>,
    stitch: Option<bool>,
    #[serde(default)]
    relax: bool,
}

impl FlatRecipe {
    /// Whether `text` is a flat recipe: it has a key that only those have at the top, and no table of a job of today.
    pub(super) fn is_one(text: &str) -> bool {
        let Ok(top) = toml::from_str::<BTreeMap<String, Shape>>(text) else { return false };
        let has = |table: &str, key: &str| matches!(top.get(table), Some(Shape::Table(keys)) if keys.iter().any(|k| k == key));
        let is_table = |name: &str| matches!(top.get(name), Some(Shape::Table(_)));
        let own = ["size", "scale", "avoid", "params"];
        if is_table("fill") || is_table("space") || has("redo", "region") || own.iter().any(|key| has("ribbon", key)) {
            return false;
        }
        let has_region = top.contains_key("redo") && (!is_table("redo") || has("redo", "path"));
        has_region || top.keys().any(|key| FLAT_KEYS.contains(&key.as_str()))
    }

    /// What all recipes have, and the job in the form of today.
    ///
    /// # Errors
    /// [`Error::Parameter`] or [`Error::Unsupported`] for options that do not go together, as ever.
    pub(super) fn into_job(mut self) -> Result<(Head, Job)> {
        let job = match (&self.ribbon, &self.cuboid) {
            (Some(_), _) => self.ribbon()?,
            (None, Some(_)) => self.space()?,
            (None, None) if self.redo.is_some() || self.from.is_some() || self.to.is_some() => self.redo()?,
            (None, None) => self.fill(),
        };
        let Self { arabesque, seed, exemplar, output, .. } = self;
        Ok((Head { arabesque, seed, exemplar, output }, job))
    }

    /// The keys that were given, of those that some job does not have.
    fn given(&self) -> Vec<&'static str> {
        let keys = [
            (self.size.is_some(), "size"),
            (self.tile.is_some(), "tile"),
            (self.cuboid.is_some(), "box"),
            (self.domain.is_some(), "domain"),
            (self.border.is_some(), "border"),
            (self.keep.is_some(), "keep"),
            (self.redo.is_some(), "redo"),
            (self.from.is_some() || self.to.is_some(), "from and to"),
            (self.orient.is_some(), "orient"),
            (self.density.is_some(), "density"),
            (!self.avoid.is_empty(), "avoid"),
            (self.radius.is_some(), "radius"),
            (self.levels.is_some(), "levels"),
            (self.iterations.is_some(), "iterations"),
            // These two were written always.
            (self.preset.as_ref().is_some_and(|preset| preset != "default"), "preset"),
            (self.method != Method::Auto, "method"),
        ];
        keys.into_iter().filter(|(is_given, _)| *is_given).map(|(_, name)| name).collect()
    }

    /// Refuses what a job does not have.
    fn refuse(&self, unknown: &[&str], job: &str) -> Result<()> {
        match self.given().into_iter().find(|name| unknown.contains(name)) {
            Some(name) => Err(Error::Unsupported {
                what: format!("{name} together with {job}"),
                advice: format!("leave it out, or leave {job} out"),
            }),
            None => Ok(()),
        }
    }

    fn params(&mut self) -> Parameters {
        let mut set = std::mem::take(&mut self.set);
        let shortcuts = [
            ("radius", self.radius.map(|v| v.to_string())),
            ("levels", self.levels.map(|v| v.to_string())),
            ("iterations", self.iterations.map(|v| v.to_string())),
        ];
        set.extend(shortcuts.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?))));
        Parameters { preset: self.preset.take().filter(|preset| preset != "default"), set }
    }

    fn fill(&mut self) -> Job {
        Job::Fill(Fill {
            exemplar_tile: ExemplarTile::Auto,
            size: self.size.take(),
            tile: self.tile.take().map(Tile::Of),
            border: self.border.take(),
            method: self.method,
            domain: self.domain.take(),
            keep: self.keep.take(),
            orient: self.orient.take(),
            scale: self.scale.take(),
            density: self.density.take(),
            avoid: std::mem::take(&mut self.avoid),
            params: self.params(),
        })
    }

    fn redo(&mut self) -> Result<Job> {
        let (region, from) = match (self.redo.take(), self.from.take(), self.to.take()) {
            (Some(region), None, None) => (region, None),
            (None, Some(from), Some(region)) => (region, Some(from)),
            (Some(_), ..) => {
                return Err(Error::parameter("redo", "given with from or to", "redo alone, or from and to"));
            }
            (None, ..) => return Err(Error::parameter("from and to", "only one given", "both from and to")),
        };
        self.refuse(&["size", "tile", "domain", "keep"], "redo")?;
        Ok(Job::Redo(Redo {
            border: self.border.take(),
            method: self.method,
            region,
            from,
            orient: self.orient.take(),
            scale: self.scale.take(),
            density: self.density.take(),
            avoid: std::mem::take(&mut self.avoid),
            params: self.params(),
        }))
    }

    fn space(&mut self) -> Result<Job> {
        self.refuse(&["size", "tile", "domain", "keep", "redo", "from and to", "orient", "avoid"], "box")?;
        let Some(cuboid) = self.cuboid.take() else { return Ok(self.fill()) };
        Ok(Job::Space(Space {
            cuboid: Some(cuboid),
            border: self.border.take(),
            method: self.method,
            scale: self.scale.take(),
            density: self.density.take(),
            params: self.params(),
            ..Space::default()
        }))
    }

    fn ribbon(&mut self) -> Result<Job> {
        let foreign = [
            "tile",
            "box",
            "domain",
            "border",
            "keep",
            "redo",
            "from and to",
            "orient",
            "density",
            "radius",
            "levels",
            "iterations",
            "preset",
            "method",
        ];
        self.refuse(&foreign, "ribbon")?;
        let Some(flat) = self.ribbon.take() else { return Ok(self.fill()) };
        let scale = match self.scale.take() {
            None => None,
            Some(FieldSource::Constant(scale)) => Some(scale),
            Some(FieldSource::File(file)) => {
                let expected = "a number: user units per pixel of the exemplar";
                return Err(Error::parameter("scale", &file.file.path, expected));
            }
        };
        Ok(Job::Ribbon(Ribbon {
            along: flat.along,
            then: flat.then,
            changes: flat.changes,
            size: self.size.take(),
            scale,
            width: flat.width,
            step: flat.step,
            first: flat.first,
            start: flat.start,
            end: flat.end,
            closing: flat.closing,
            stitch: flat.stitch.unwrap_or(true),
            relax: flat.relax,
            avoid: std::mem::take(&mut self.avoid),
            params: std::mem::take(&mut self.set),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Recipe;

    fn read(text: &str) -> Result<Recipe> {
        Recipe::from_toml("r.toml", text)
    }

    #[test]
    fn flat_recipes_become_the_job_that_they_meant() {
        let fill = read("exemplar = \"a.svg\"\nsize = \"10x20\"\nlevels = 2\n[set]\nmatching = \"hard\"\n").unwrap();
        let Job::Fill(fill) = fill.job else { panic!() };
        assert_eq!((fill.params.preset, fill.params.set.len()), (None, 2));
        let redo = read("exemplar = \"a.svg\"\nmethod = \"auto\"\npreset = \"default\"\nredo = \"1,2,3,4\"\n").unwrap();
        assert!(matches!(redo.job, Job::Redo(r) if r.from.is_none() && r.region == Region::Box([1.0, 2.0, 3.0, 4.0])));
        let copy = read("exemplar = \"a.svg\"\nfrom = \"#a\"\nto = \"#b\"\n").unwrap();
        assert!(matches!(copy.job, Job::Redo(r) if r.from == Some(Region::Own("a".into()))));
        let space = read("exemplar = \"a.csv\"\nbox = \"1x2x3\"\npreset = \"ma2011\"\n").unwrap();
        assert!(matches!(space.job, Job::Space(s) if s.params.preset.as_deref() == Some("ma2011")));
        let ribbon =
            "exemplar = \"a.png\"\nsize = \"9x9\"\nscale = 0.5\n[set]\nvariety = 2\n[ribbon]\nalong = \"c.svg\"\n";
        let Job::Ribbon(ribbon) = read(ribbon).unwrap().job else { panic!() };
        assert_eq!((ribbon.scale, ribbon.stitch, &*ribbon.params["variety"]), (Some(0.5), true, "2"));
    }

    #[test]
    fn what_did_not_go_together_is_still_refused() {
        for (text, words) in [
            ("box = \"1x1x1\"\ntile = \"3x3\"\n", "tile together with box"),
            ("redo = \"#a\"\nkeep = \"b.svg\"\n", "keep together with redo"),
            ("redo = \"#a\"\nto = \"#b\"\n", "redo alone"),
            ("from = \"#a\"\n", "both from and to"),
            ("levels = 2\n[ribbon]\nalong = \"c.svg\"\n", "levels together with ribbon"),
        ] {
            let message = read(&format!("exemplar = \"a.svg\"\n{text}")).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
    }

    #[test]
    fn mistyped_keys_of_flat_recipes_are_told_with_their_line() {
        let message = read("exemplar = \"a\"\nsize = \"3x3\"\nbordr = \"clip\"\n").unwrap_err().to_string();
        assert!(message.contains("line 3") && message.contains("`border`"), "{message}");
    }

    #[test]
    fn seeds_beyond_the_integers_of_toml_are_read_as_ever() {
        let recipe = read("exemplar = \"a.svg\"\nsize = \"3x3\"\nseed = 9223372036854775808\n").unwrap();
        assert_eq!(recipe.seed, 1 << 63);
    }

    #[test]
    fn a_stray_key_beside_a_table_of_a_job_is_told_where_it_belongs() {
        for (text, words) in [
            ("size = \"40x40\"\n[fill]\n", "table of the job"),
            ("border = \"clip\"\n[redo]\nregion = \"#a\"\n", "table of the job"),
            ("[fill]\nlevels = 2\n", "table `params`"),
            ("szie = \"3x3\"\n", "`size`"),
        ] {
            let message = read(&format!("exemplar = \"a.svg\"\n{text}")).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
    }
}
