//! Boxes in space: networks of curves and clouds of points.

use std::path::Path;

use arabesque_core::{
    Bounds, Domain, Error, Exemplar, Limits, Outcome, Request, Result, ScalarField, Snapshot, StopReason, Vector,
    Warning, Watch,
};
use arabesque_io::{csv, json, obj};
use arabesque_patterns::Prepared as Engine;

use crate::{
    BorderRule, Encoded, FieldSource, Format, OutputOptions, Recipe, Subject, prepare::Preparation, spacing::spacing,
};

/// How far a written polyline may lie from its curve, in mean spacings.
const CHORD: f64 = 0.005;
/// Smallest and largest factor of scale and density.
const FACTORS: [f64; 2] = [0.01, 100.0];

/// A run in space, ready to be started with any seed.
#[derive(Clone, Debug)]
pub struct SpacePrepared {
    recipe: Recipe,
    exemplar: Exemplar<3>,
    engine: Engine<3>,
    request: Request<3>,
    warnings: Vec<Warning>,
}

/// The result of one run in space.
#[derive(Clone, Debug)]
pub struct SpaceArtwork<'a> {
    prepared: &'a SpacePrepared,
    /// Placements, curves, energy trace, warnings, and why the run ended.
    pub outcome: Outcome<3>,
    /// Seed of the run.
    pub seed: u64,
}

impl Recipe {
    /// Whether a box in space is filled: then [`Recipe::prepare_space`] takes the place of [`Recipe::prepare`].
    pub fn is_space(&self) -> bool {
        self.cuboid.is_some()
    }

    /// The file format where nobody says which: SVG for the plane, OBJ for curves and CSV for points in space, PNG for ribbons, GLB for
    /// ribbons in space.
    pub fn usual_format(&self) -> Format {
        if let Some(ribbon) = &self.ribbon {
            let in_space = Format::of_path(&ribbon.along.path).ok().flatten() == Some(Format::Obj);
            return if in_space { Format::Glb } else { Format::Png };
        }
        let is_points = Format::of_path(&self.exemplar.path).ok().flatten() == Some(Format::Csv);
        match (self.is_space(), is_points) {
            (false, _) => Format::Svg,
            (true, false) => Format::Obj,
            (true, true) => Format::Csv,
        }
    }

    /// Reads the exemplar, beside `base` first, and analyses it for the box of the recipe.
    ///
    /// # Errors
    /// Whatever the file or the parameters are wrong with; [`Error::Unsupported`] for what the plane alone has, such as `avoid`.
    pub fn prepare_space(&self, base: Option<&Path>) -> Result<SpacePrepared> {
        Preparation::new(self, base).finish_space()
    }

    /// What of this recipe has a meaning in the plane alone.
    fn plane_only(&self) -> Option<&'static str> {
        let given = [
            (self.size.is_some(), "size"),
            (self.tile.is_some(), "tile"),
            (self.domain.is_some(), "domain"),
            (self.keep.is_some(), "keep"),
            (self.redo.is_some(), "redo"),
            (self.from.is_some() || self.to.is_some(), "from and to"),
            (self.orient.is_some(), "orient"),
            (!self.avoid.is_empty(), "avoid"),
        ];
        given.into_iter().find(|(is_given, _)| *is_given).map(|(_, name)| name)
    }
}

/// The side lengths in a text such as `10x10x5`.
fn sides(text: &str) -> Result<Vector<3>> {
    let most = Limits::default().coordinate;
    let numbers: Vec<f64> =
        text.trim().to_ascii_lowercase().split(['x', '*']).filter_map(|side| side.trim().parse().ok()).collect();
    match numbers[..] {
        [x, y, z]
            if text.matches(['x', 'X', '*']).count() == 2
                && [x, y, z].iter().all(|s| s.is_finite() && *s > 0.0 && *s <= most) =>
        {
            Ok(Vector([x, y, z]))
        }
        _ => {
            let expected = "three positive numbers in the units of the exemplar, such as 10x10x5";
            Err(Error::parameter("box", format!("\"{text}\""), expected))
        }
    }
}

impl Preparation<'_> {
    fn finish_space(mut self) -> Result<SpacePrepared> {
        let params = self.recipe.params()?;
        let size = sides(self.recipe.cuboid.as_deref().unwrap_or_default())?;
        if let Some(what) = self.recipe.plane_only() {
            let advice = "leave it away, or leave the box away";
            return Err(Error::Unsupported { what: format!("{what} together with box"), advice: advice.into() });
        }
        if self.recipe.border == Some(BorderRule::Turn) {
            let expected = "inside, cross or clip: in space there is no line along the border for strokes to turn into";
            return Err(Error::parameter("border", "turn", expected));
        }
        self.check_version();
        let bytes = self.recipe.exemplar.read(self.base, &self.limits)?;
        let exemplar = self.space_exemplar(&bytes)?;
        self.recipe.exemplar = self.recipe.exemplar.carrying(&bytes);
        let bounds = Bounds::new(Vector::ZERO, size);
        self.check_volume(&exemplar, &bounds)?;
        let mut request = Request::new(Domain::Box(bounds));
        request.border = self.recipe.border.unwrap_or(BorderRule::Clip).into();
        request.fields.scale = constant("scale", self.recipe.scale.as_ref())?;
        request.fields.density = constant("density", self.recipe.density.as_ref())?;
        let engine = Engine::new(&exemplar, &params)?;
        Ok(SpacePrepared { recipe: self.recipe, exemplar, engine, request, warnings: self.warnings })
    }

    fn space_exemplar(&mut self, bytes: &[u8]) -> Result<Exemplar<3>> {
        match Subject::read(&self.recipe.exemplar, bytes, self.recipe.method, &self.limits)? {
            Subject::Space(exemplar, warnings) => {
                self.warnings.extend(warnings);
                Ok(exemplar)
            }
            Subject::Drawing(_) | Subject::Points(_) => Err(Error::input(
                self.recipe.exemplar.name(),
                "an exemplar of the plane, where a box in space is to be filled",
                "give curves as OBJ or points as CSV with a column z, or fill a page with --size",
            )),
        }
    }

    fn check_volume(&self, exemplar: &Exemplar<3>, bounds: &Bounds<3>) -> Result<()> {
        let spacing = spacing(exemplar);
        let expected = bounds.measure() / spacing.powi(3);
        if expected.is_nan() || expected > self.limits.output_elements as f64 {
            return Err(Error::Limit {
                what: "size of the box".into(),
                found: format!("room for about {expected:.0} elements or cells"),
                limit: self.limits.output_elements.to_string(),
                advice: "make it smaller; its sides are in the units of the exemplar".into(),
            });
        }
        if expected < 0.5 {
            return Err(Error::no_result(
                format!("the box has no room for anything: the exemplar has a spacing of {spacing:.4}"),
                "make it larger; its sides are in the units of the exemplar",
            ));
        }
        Ok(())
    }
}

/// The field of a constant factor.
fn constant(name: &str, source: Option<&FieldSource>) -> Result<ScalarField<3>> {
    match source {
        None => Ok(ScalarField::Constant(1.0)),
        Some(FieldSource::Constant(v)) if (FACTORS[0]..=FACTORS[1]).contains(v) => Ok(ScalarField::Constant(*v)),
        Some(FieldSource::Constant(v)) => {
            Err(Error::parameter(name, v, format!("a factor between {} and {}", FACTORS[0], FACTORS[1])))
        }
        Some(FieldSource::File(_)) => {
            Err(Error::Unsupported { what: format!("{name} from a picture, in space"), advice: "give a number".into() })
        }
    }
}

impl SpacePrepared {
    /// What was noticed while reading.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Number of elements and of classes of the exemplar.
    pub fn exemplar_size(&self) -> (usize, usize) {
        (self.exemplar.elements.len(), self.exemplar.classes.len())
    }

    /// Number of curves and of styles of the exemplar.
    pub fn exemplar_curves(&self) -> (usize, usize) {
        (self.exemplar.curves.len(), self.exemplar.styles.len())
    }

    /// Runs with the given seed. Any number of runs may be made from one preparation.
    ///
    /// # Errors
    /// [`Error::NoResult`] when nothing can be placed, [`Error::Limit`] when a limit is reached.
    pub fn run(&self, seed: u64, watch: &mut dyn Watch<Snapshot<3>>) -> Result<SpaceArtwork<'_>> {
        let mut request = self.request.clone();
        request.seed = seed;
        let mut outcome = self.engine.run(&request, watch)?;
        if outcome.placements.is_empty() && outcome.curves.is_empty() {
            return Err(match outcome.stopped {
                StopReason::Stopped => Error::no_result("stopped before anything was placed", "give it more time"),
                StopReason::Finished => Error::no_result("nothing fits the box", "make it larger"),
            });
        }
        outcome.warnings.splice(0..0, self.warnings.iter().cloned());
        Ok(SpaceArtwork { prepared: self, outcome, seed })
    }
}

impl SpaceArtwork<'_> {
    /// The name of the class of each placement.
    pub fn classes(&self) -> impl Iterator<Item = &str> {
        let exemplar = &self.prepared.exemplar;
        self.outcome.placements.iter().map(|p| exemplar.classes[exemplar.elements[p.source].class].name.as_str())
    }

    /// The name of the style of each curve.
    pub fn styles(&self) -> impl Iterator<Item = &str> {
        let exemplar = &self.prepared.exemplar;
        self.outcome.curves.iter().map(|c| exemplar.styles[exemplar.curves[c.source].style].name.as_str())
    }

    /// The recipe of this very result, as its file carries it.
    ///
    /// # Errors
    /// As [`Recipe::to_toml`].
    pub fn recipe(&self, output: &OutputOptions) -> Result<String> {
        // A recipe that stands alone leaves the format open: running it makes a result, not the recipe again.
        let format = output.format.filter(|f| *f != Format::Toml);
        let output = OutputOptions { path: None, format, ..output.clone() };
        let version = env!("CARGO_PKG_VERSION").to_owned();
        Recipe { seed: self.seed, arabesque: version, output, ..self.prepared.recipe.clone() }.to_toml()
    }

    /// The file in the format that `output` asks for: OBJ for curves, CSV for points, JSON for both.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for SVG and PNG, and where the format can hold nothing of the result.
    pub fn encode(&self, output: &OutputOptions) -> Result<Encoded> {
        let format = output.format.unwrap_or_else(|| self.prepared.recipe.usual_format());
        let recipe = self.recipe(&OutputOptions { format: Some(format), ..output.clone() })?;
        let carried = (!output.bare).then_some(recipe.as_str());
        let (exemplar, outcome) = (&self.prepared.exemplar, &self.outcome);
        let frame = self.prepared.request.domain.bounds();
        let (text, warnings) = match format {
            Format::Obj => {
                let sheet = obj::Sheet { frame, tolerance: CHORD * spacing(exemplar), recipe: carried };
                let warnings = left_out([outcome.placements.len(), outcome.curves.len()], ["points", "curves"])?;
                (obj::write_curves(exemplar, &outcome.curves, &sheet), warnings)
            }
            Format::Csv => {
                let extent = frame.size().0.into_iter().fold(0.0, f64::max);
                let warnings = left_out([outcome.curves.len(), outcome.placements.len()], ["curves", "points"])?;
                (csv::write_points(exemplar, &outcome.placements, extent, carried), warnings)
            }
            Format::Json => {
                let frame = json::Frame { view: frame, unit: None, recipe: carried };
                (json::write_json(exemplar, outcome, &frame)?, Vec::new())
            }
            Format::Toml => (recipe, Vec::new()),
            Format::Svg | Format::Png | Format::Glb => {
                let what = format!("a result in space as {}", format.name());
                let advice = "write obj (curves), csv (points) or json (both)";
                return Err(Error::Unsupported { what, advice: advice.into() });
            }
        };
        Ok(Encoded { bytes: text.into_bytes(), warnings })
    }
}

/// Tells that a format holds only the second of two kinds; an error where there is nothing of it.
fn left_out([lost, held]: [usize; 2], [what, kept]: [&str; 2]) -> Result<Vec<Warning>> {
    let message = format!("{lost} {what} in a file of {kept}");
    let advice = "write json, which holds both, or csv for points and obj for curves";
    match (lost, held) {
        (0, _) => Ok(Vec::new()),
        (_, 0) => Err(Error::Unsupported { what: message, advice: advice.into() }),
        _ => Ok(vec![Warning::new(format!("{message} cannot be written: left out"), advice)]),
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::Unobserved;

    use super::*;
    use crate::{Input, recipe_in};

    /// A cubic lattice of points of two classes.
    fn lattice() -> String {
        let rows = (0..125).map(|k| {
            let (x, y, z) = (k % 5, k / 5 % 5, k / 25);
            format!("{x},{y},{z},{}\n", ["salt", "chlorine"][(x + y + z) % 2])
        });
        format!("x,y,z,class\n{}", rows.collect::<String>())
    }

    fn recipe(name: &str, text: &str, cuboid: &str) -> Recipe {
        let mut recipe = Recipe::new(Input::file(name).carrying(text.as_bytes()));
        recipe.cuboid = Some(cuboid.into());
        recipe
    }

    #[test]
    fn sides_are_three_positive_numbers() {
        assert_eq!(sides("10x10X5.5").unwrap(), Vector([10.0, 10.0, 5.5]));
        for text in ["", "10", "10x10", "10x10x0", "axbxc", "1x2x3x4", "1xx2x3", "1e99x1x1", "nanx1x1"] {
            assert!(sides(text).is_err(), "{text}");
        }
    }

    #[test]
    fn points_fill_a_box_and_the_recipe_repeats_it() {
        let recipe = recipe("salt.csv", &lattice(), "6x6x6");
        let prepared = recipe.prepare_space(None).unwrap();
        let artwork = prepared.run(3, &mut Unobserved).unwrap();
        let count = artwork.outcome.placements.len();
        assert!((100..400).contains(&count), "{count}");
        let output = OutputOptions::default();
        let bytes = artwork.encode(&output).unwrap().bytes;
        assert!(bytes.starts_with(b"x,y,z,class\n"));
        let again = recipe_in("salt-out.csv", &bytes).unwrap();
        assert_eq!((again.cuboid.as_deref(), again.seed), (Some("6x6x6"), 3));
        let repeated = again.prepare_space(None).unwrap();
        assert_eq!(repeated.run(again.seed, &mut Unobserved).unwrap().encode(&output).unwrap().bytes, bytes);
    }

    #[test]
    fn what_the_plane_alone_has_is_refused() {
        let with = |change: fn(&mut Recipe)| {
            let mut recipe = recipe("salt.csv", &lattice(), "6x6x6");
            change(&mut recipe);
            recipe.prepare_space(None).unwrap_err().to_string()
        };
        assert!(with(|r| r.tile = Some("4x4".into())).contains("tile together with box"));
        assert!(with(|r| r.orient = Some(FieldSource::Constant(3.0))).contains("orient together with box"));
        assert!(with(|r| r.scale = Some(FieldSource::Constant(-1.0))).contains("a factor between"));
        assert!(with(|r| r.cuboid = Some("1e8x1e8x1e8".into())).contains("over the limit"));
        assert!(with(|r| r.cuboid = Some("0.1x0.1x0.1".into())).contains("no room"));
        let flat = recipe("flat.csv", "x,y\n0,0\n1,0\n0,1\n", "6x6x6").prepare_space(None).unwrap_err();
        assert!(flat.to_string().contains("of the plane"));
    }

    #[test]
    fn points_are_no_curves() {
        let prepared = recipe("salt.csv", &lattice(), "3x3x3").prepare_space(None).unwrap();
        let artwork = prepared.run(0, &mut Unobserved).unwrap();
        for format in [Format::Obj, Format::Svg] {
            let output = OutputOptions { format: Some(format), ..OutputOptions::default() };
            assert!(matches!(artwork.encode(&output), Err(Error::Unsupported { .. })));
        }
    }
}
