//! Parts of space: scenes of meshes, networks of curves and clouds of points.

mod bending;
#[cfg(test)]
mod bending_tests;
mod layer;
mod made;
#[cfg(feature = "physics")]
mod physics;
#[cfg(not(feature = "physics"))]
#[path = "no_physics.rs"]
mod physics;
#[cfg(all(test, feature = "physics"))]
mod physics_tests;
mod pile;
mod place;
mod scene;
#[cfg(test)]
mod scene_tests;
mod shell;
mod skinned;
mod stacks;
mod suiting;

use std::sync::Arc;

use arabesque_core::{
    Border, Budget, Domain, Error, Exemplar, Limits, Outcome, Progress, Request as EngineRequest, Result, Snapshot,
    StopReason, Warning, Watch, rounded,
};
use arabesque_io::mesh::scene::Convention;
use arabesque_patterns::Prepared as Engine;

use crate::{
    artwork::{Artwork, PhysicsSummary},
    exemplar::{LoadedExemplar, understood},
    inspect::SceneUnderstood,
    method::{Preparation, Ready, RunContext, Show},
    plane::{in_exemplar, snapshot},
    recipe::{Input, Job, Recipe, Space},
    resources::{Files, Resources},
    solid::scene::{may_be_scene, scene_of},
    spacing::spacing,
};

use layer::{Layer, layer};
use made::VolumeMade;
use physics::Physical;
use pile::Pile;
use place::{Filling, place};
use scene::Bodies;
use shell::Shell;
use stacks::{Stacks, stacked};

/// An exemplar in space, analysed.
#[derive(Debug)]
pub(crate) struct Volume {
    exemplar: Arc<Exemplar<3>>,
    /// The meshes of its elements, where it is a scene.
    bodies: Option<Arc<Bodies>>,
    /// The same as a drawing, where it is a single layer.
    layer: Option<Arc<Layer>>,
    /// The same as a lattice of space, where it is one.
    pile: Option<Arc<Pile>>,
    engine: Engine<3>,
    /// The scene as it is in its file, where what lies on something else is one element with it.
    stacks: Option<Stacks>,
}

/// Reads an exemplar to fill a box in space.
pub(crate) fn prepare(space: &Space, preparation: &mut Preparation<'_>) -> Result<Volume> {
    let params = space.params.engine_params()?;
    let bytes = preparation.files.read(&preparation.exemplar)?;
    let budget = preparation.files.budget();
    if may_be_scene(preparation.exemplar.name(), &bytes) {
        let scene = scene_of(&preparation.exemplar, &bytes, preparation.files)?;
        let (bodies, warnings) =
            Bodies::read(preparation.exemplar.name(), scene, (space.up.axis(), &space.deform, params.samples), budget)?;
        preparation.warnings.extend(warnings);
        let others = space.floor || space.on.is_some();
        let (bodies, stacks) =
            if space.stacks() { stacked(preparation.exemplar.name(), bodies, budget)? } else { (bodies, None) };
        let bodies = if space.stands() { bodies.on_floor(others, &space.constrain)? } else { bodies };
        preparation.exemplar = preparation.exemplar.embedding(&bytes);
        let exemplar = Arc::clone(&bodies.exemplar);
        budget.allow_exemplar(exemplar.elements.len());
        let engine = Engine::new(Arc::clone(&exemplar), &params, budget)
            .map_err(|error| in_exemplar(error, preparation.exemplar.name()))?;
        let is_soft = !exemplar.softs.is_empty();
        let layer = if is_soft { None } else { layer(&exemplar, &params, budget)? };
        let pile = if layer.is_none() && !is_soft { Pile::of(&exemplar, budget)?.map(Arc::new) } else { None };
        return Ok(Volume { exemplar, bodies: Some(Arc::new(bodies)), layer, pile, engine, stacks });
    }
    let exemplar = match LoadedExemplar::read(&preparation.exemplar, &bytes, space.method, budget)? {
        LoadedExemplar::Space(exemplar, warnings) => {
            preparation.warnings.extend(warnings);
            exemplar
        }
        LoadedExemplar::Drawing(..) | LoadedExemplar::Points(_) => {
            return Err(Error::input(
                preparation.exemplar.name(),
                "an exemplar of the plane, where a box in space is to be filled",
                "give curves as OBJ or points as CSV with a column z, or fill a page with --size",
            ));
        }
    };
    preparation.exemplar = preparation.exemplar.embedding(&bytes);
    let exemplar = Arc::new(exemplar);
    budget.allow_exemplar(exemplar.elements.len());
    let engine = Engine::new(Arc::clone(&exemplar), &params, budget)
        .map_err(|error| in_exemplar(error, preparation.exemplar.name()))?;
    Ok(Volume { exemplar, bodies: None, layer: None, pile: None, engine, stacks: None })
}

impl Volume {
    /// Refuses what this exemplar cannot do.
    fn suits(&self, space: &Space) -> Result<()> {
        if space.border == Some(Border::Turn) {
            let expected = "inside, cross or clip: in space there is no line along the border for strokes to turn into";
            return Err(Error::parameter("border", "turn", expected));
        }
        let unsupported = |what: String, advice: &str| Err(Error::Unsupported { what, advice: advice.into() });
        let is_elsewhere = space.place()? != "box";
        if self.bodies.is_none() && (is_elsewhere || !space.avoid.is_empty()) {
            let what = if is_elsewhere { "a place other than a box" } else { "avoid" };
            return unsupported(
                format!("{what} for points and curves in space"),
                "give a scene of meshes, or a box alone",
            );
        }
        if self.stacks.is_some() && space.keep.is_some() {
            let advice = "give both in the recipe that is prepared";
            return unsupported("keep for a scene whose stacks are elements".into(), advice);
        }
        let asked = [("physics", space.physics.is_some()), ("keep", space.keep.is_some())];
        match asked.into_iter().find(|(_, is_given)| *is_given) {
            Some((name, _)) if !self.exemplar.softs.is_empty() => {
                let advice = "leave it out, or let nothing bend (--deform=off)";
                unsupported(format!("{name} for a scene of which something bends"), advice)
            }
            _ => Ok(()),
        }
    }

    fn resolve(&self, context: &mut RunContext<'_>) -> Result<Resolved> {
        let Job::Space(mut space) = context.job.clone() else {
            return Err(Error::parameter("request", context.job.name(), "a request for a part of space"));
        };
        self.suits(&space)?;
        let floor = self.bodies.as_ref().and_then(|bodies| bodies.floor);
        let filling = Filling { exemplar: &self.exemplar, floor, layer: self.layer.as_deref() };
        let place = place(&mut space, filling, context)?;
        let shell = place.shell;
        check_volume(&self.exemplar, place.domain.measure(), context.budget())?;
        let usual = match (&self.bodies, &place.domain) {
            (None, _) => Border::Clip,
            (Some(_), Domain::Region(_)) if space.on.is_none() && space.along.is_none() || !space.avoid.is_empty() => {
                Border::Inside
            }
            (Some(_), _) => Border::Cross,
        };
        let mut request = EngineRequest::new(place.domain);
        request.border = space.border.unwrap_or(usual);
        request.fields = place.fields;
        request.ground = place.ground;
        if let Some(input) = &mut space.keep {
            let Some(bodies) = &self.bodies else {
                let advice = "leave it out, or give a scene of meshes";
                return Err(Error::Unsupported {
                    what: "keep for points and curves in space".into(),
                    advice: advice.into(),
                });
            };
            let bytes = context.files.embed(input)?;
            let kept = scene_of(input, &bytes, context.files)?;
            request.frozen = bodies.kept(input.name(), &kept, context.budget())?;
        }
        let physical = Physical::new(&mut space, (self.bodies.as_deref(), self.stacks.as_ref()), &request, context)?;
        request.between = physical.as_ref().and_then(Physical::between);
        context.job = Job::Space(space);
        request.seed = context.seed;
        request.budget = context.budget().clone();
        Ok(Resolved { request, physical, shell })
    }
}

/// What is to be done, and where.
struct Resolved {
    request: EngineRequest<3>,
    physical: Option<Arc<Physical>>,
    /// The layer on a mesh that is filled, where it is one.
    shell: Option<Arc<Shell>>,
}

impl Ready for Volume {
    fn understood(&self) -> String {
        let shown = self.stacks.as_ref().map_or(self.bodies.as_ref(), |stacks| Some(&stacks.single));
        let told = shown.map_or("", |bodies| bodies.told.as_str());
        let mut more = if told.is_empty() { String::new() } else { format!("; {told}") };
        if let Some(stacks) = &self.stacks {
            let (count, elements) = stacks.count();
            more += &format!("; {count} stacks of {elements} elements, each placed as one");
        }
        understood(shown.map_or(&self.exemplar, |bodies| &bodies.exemplar)) + &more
    }

    fn run(self: Arc<Self>, mut context: RunContext<'_>, watch: &mut dyn Watch<Artwork>) -> Result<Artwork> {
        let Resolved { request, physical, shell } = self.resolve(&mut context)?;
        let frame = request.domain.bounds();
        let origin = context.origin();
        let (exemplar, bodies) = match &self.stacks {
            None => (Arc::clone(&self.exemplar), self.bodies.clone()),
            Some(stacks) => (Arc::clone(&stacks.single.exemplar), Some(Arc::clone(&stacks.single))),
        };
        let kind = (&exemplar, &bodies);
        let convention = match &context.job {
            Job::Space(space) => Convention { up: space.up.into(), metres_per_unit: space.unit.metres() },
            _ => Convention::default(),
        };
        let make = |mut snapshot: Snapshot<3>| {
            if let Some(stacks) = &self.stacks {
                snapshot.placements = stacks.taken_apart(&snapshot.placements);
            }
            VolumeMade::of_snapshot(kind, (frame, convention), snapshot)
        };
        let mut show = Show { watch, origin: &origin, make };
        let floor = self.bodies.as_ref().and_then(|bodies| bodies.floor);
        let flat = match (&self.layer, shell) {
            (Some(layer), Some(shell)) => layer.cover((&shell, &self.engine), &request)?,
            (Some(layer), None) => layer.run(&request, &mut show)?,
            (None, _) => match &self.pile {
                Some(pile) => pile.fill((&self.exemplar, floor), &request)?,
                None => None,
            },
        };
        let mut outcome = match flat {
            Some(outcome) => outcome,
            None => self.engine.run(&request, &mut show)?,
        };
        let physics = match physical {
            Some(physical) => settle(&physical, &mut outcome, &request.budget, &mut show)?,
            None => None,
        };
        outcome.warnings.splice(0..0, context.warnings);
        if let Some(stacks) = &self.stacks {
            outcome.placements = stacks.taken_apart(&outcome.placements);
        }
        Ok(Artwork::new(origin, VolumeMade { exemplar, bodies, frame, convention, outcome, physics }))
    }
}

/// Whether a file is a scene of meshes and nothing else, which are elements; points beside them make it a structure, and an OBJ file
/// without faces a net of curves.
///
/// # Errors
/// As [`Recipe::prepare`] for a file that cannot be read.
pub fn is_scene_of_meshes(exemplar: &Input, resources: &Resources) -> Result<bool> {
    let recipe = Recipe::new(exemplar.clone(), Space::default());
    let files = Files::new(resources.clone(), &recipe);
    let bytes = files.read(exemplar)?;
    if !may_be_scene(exemplar.name(), &bytes) {
        return Ok(false);
    }
    let scene = scene_of(exemplar, &bytes, &files)?;
    Ok(scene.points.is_empty() && !scene.nodes.is_empty())
}

/// A scene of meshes as an exemplar, what is to be told of it, and warnings; `None` for files of another kind.
///
/// # Errors
/// As [`Recipe::prepare`] for a file that cannot be read.
pub(crate) fn scene_understood(input: &Input, bytes: &[u8], resources: &Resources) -> Result<Option<SceneUnderstood>> {
    if !may_be_scene(input.name(), bytes) {
        return Ok(None);
    }
    let files = Files::new(resources.clone(), &Recipe::new(input.clone(), Space::default()));
    let scene = scene_of(input, bytes, &files)?;
    if scene.nodes.is_empty() || !scene.points.is_empty() {
        return Ok(None);
    }
    let space = Space::default();
    let (bodies, warnings) = Bodies::read(input.name(), scene, (space.up.axis(), &space.deform, None), files.budget())?;
    let mut told = Vec::new();
    told.extend(Some(bodies.told.clone()).filter(|told| !told.is_empty()));
    let exemplar = Arc::clone(&bodies.exemplar);
    if let (_, Some(stacks)) = stacked(input.name(), bodies, files.budget())? {
        let (count, elements) = stacks.count();
        told.push(format!("on a floor {count} stacks of {elements} elements, each placed as one"));
    }
    Ok(Some(SceneUnderstood { exemplar, told, warnings, work: files.budget().millions() }))
}

/// Lets the elements of a run come to rest that nobody stopped; where it reached a limit, on an account of its own.
fn settle(
    physical: &Physical,
    outcome: &mut Outcome<3>,
    budget: &Budget,
    watch: &mut dyn Watch<Snapshot<3>>,
) -> Result<Option<PhysicsSummary>> {
    let budget = &if outcome.stopped == StopReason::Limit { budget.fresh() } else { budget.clone() };
    if outcome.stopped == StopReason::Stopped {
        let advice = "let the run end by itself";
        outcome.warnings.push(Warning::new("elements were not left to come to rest: the run was stopped", advice));
        return Ok(None);
    }
    let count = outcome.placements.len();
    let progress = Progress { stage: "settling".into(), done: 0, total: 1, fraction: 1.0, energy: None, count };
    if watch.step(&progress, &|| snapshot(outcome)).is_break() {
        outcome.stopped = StopReason::Stopped;
        return Ok(None);
    }
    physical.settle(outcome, budget).map(Some)
}

/// Refuses a box that is too large or too small for the pattern.
fn check_volume(exemplar: &Exemplar<3>, volume: f64, budget: &Budget) -> Result<()> {
    let spacing = spacing(exemplar);
    let shown = exemplar.elements.len() as f64;
    let expected = if shown > 0.0 { volume * shown / exemplar.window.measure() } else { volume / spacing.powi(3) };
    if expected.is_nan() || expected > budget.limits().output_elements as f64 {
        return Err(Error::Limit {
            what: "size of the place to fill".into(),
            found: format!("room for about {} elements or cells", rounded(expected.round())),
            limit: budget.limits().output_elements.to_string(),
            advice: format!(
                "make it smaller{}; it is in the units of the exemplar",
                Limits::raising("output-elements", expected)
            ),
        });
    }
    if expected < 0.5 {
        return Err(Error::no_result(
            format!("the place has no room for anything: the exemplar has a spacing of {spacing:.4}"),
            "make it larger; it is in the units of the exemplar",
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use arabesque_core::Unobserved;

    use super::*;
    use crate::{FieldSource, Format, OutputOptions, recipe_in};

    /// A cubic lattice of points of two classes.
    fn lattice() -> String {
        let rows = (0..125).map(|k| {
            let (x, y, z) = (k % 5, k / 5 % 5, k / 25);
            format!("{x},{y},{z},{}\n", ["salt", "chlorine"][(x + y + z) % 2])
        });
        format!("x,y,z,class\n{}", rows.collect::<String>())
    }

    fn recipe(name: &str, text: &str, cuboid: &str) -> Recipe {
        Recipe::new(Input::file(name).embedding(text.as_bytes()), Space::new(cuboid.parse().unwrap()))
    }

    fn run(recipe: &Recipe) -> Result<Artwork> {
        let prepared = recipe.prepare(&Resources::default())?;
        prepared.run(&prepared.request(), &mut Unobserved)
    }

    #[test]
    fn points_fill_a_box_and_the_recipe_repeats_it() {
        let recipe = Recipe { seed: 3, ..recipe("salt.csv", &lattice(), "6x6x6") };
        let artwork = run(&recipe).unwrap();
        let count = artwork.summary().elements;
        assert!((100..400).contains(&count), "{count}");
        let output = OutputOptions::default();
        let bytes = artwork.encode(&output).unwrap().bytes;
        assert!(bytes.starts_with(b"x,y,z,class\n"));
        let again = recipe_in("salt-out.csv", &bytes).unwrap();
        assert!(matches!(&again.job, Job::Space(space) if space.cuboid.unwrap().to_string() == "6x6x6"));
        assert_eq!(again.seed, 3);
        assert_eq!(run(&again).unwrap().encode(&output).unwrap().bytes, bytes);
    }

    #[test]
    fn what_makes_no_sense_in_space_is_refused() {
        let with = |change: fn(&mut Space)| {
            let mut space = Space::new("6x6x6".parse().unwrap());
            change(&mut space);
            run(&Recipe::new(Input::file("salt.csv").embedding(lattice().as_bytes()), space)).unwrap_err().to_string()
        };
        assert!(with(|s| s.scale = Some(FieldSource::Constant(-1.0))).contains("a factor between"));
        assert!(with(|s| s.density = Some(FieldSource::parse("a.png").unwrap())).contains("no such file"));
        assert!(with(|s| s.border = Some(Border::Turn)).contains("no line along the border"));
        assert!(with(|s| s.cuboid = Some("1e8x1e8x1e8".parse().unwrap())).contains("over the limit"));
        assert!(with(|s| s.cuboid = Some("0.1x0.1x0.1".parse().unwrap())).contains("no room"));
        let flat = run(&recipe("flat.csv", "x,y\n0,0\n1,0\n0,1\n", "6x6x6")).unwrap_err();
        assert!(flat.to_string().contains("of the plane"));
    }

    #[test]
    fn points_are_not_curves() {
        let artwork = run(&recipe("salt.csv", &lattice(), "3x3x3")).unwrap();
        for format in [Format::Obj, Format::Svg] {
            let output = OutputOptions { format: Some(format), ..OutputOptions::default() };
            assert!(matches!(artwork.encode(&output), Err(Error::Unsupported { .. })));
        }
    }
}
