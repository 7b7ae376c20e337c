//! Physics for elements in space: between the iterations of the engine, and at the end.

use std::{
    collections::{BTreeMap, btree_map::Entry},
    sync::{Arc, Mutex},
};

use arabesque_core::{
    Between, Border, Bounds, Buckets, Budget, Domain, Error, Matrix, Outcome, Placement, Request as EngineRequest,
    Result, Similarity, StopReason, Vector, Warning,
};
use arabesque_patterns::Deform;
use arabesque_physics::{Body, PhysicsParams, Run, Shape, Side, Surface, Surroundings, World, clearance};
use arabesque_surface::MeshIndex;

use crate::{
    artwork::PhysicsSummary,
    method::RunContext,
    recipe::{Physics, Space},
    solid::read::{indexed_mesh, mesh},
    space::{scene::Bodies, stacks::Stacks},
};

/// The strongest gravity, where that of the earth is 1.
const STRONGEST: f64 = 10.0;

/// How often a heap that has sunk is filled up again, and by what share at most.
const REFILLS: usize = 3;
const MORE: f64 = 0.09;
/// How much higher than before, in sizes of an element, what is filled in may fall from where the heap is open above.
const LIFTS: [f64; 3] = [0.0, 0.5, 1.0];
/// How far above the box it is filled, in sizes of an element: what lies there comes to lie in the box, or is cut off.
const ABOVE: f64 = 0.6;
/// How far beyond the box, in its sizes, an element at rest on a side of it may lie.
const SLACK: f64 = 0.02;
/// An element has room where others are no nearer than this share of their mean size.
const FREE: f64 = 0.95;
/// Work of a place that is looked at.
const PER_PLACE: u64 = 1000;

/// Elements as bodies, and what is around them.
#[derive(Debug)]
pub(super) struct Physical {
    /// What stands for each mesh that a node of the scene shows.
    shapes: BTreeMap<usize, Arc<Shape>>,
    /// The mesh of each element of the exemplar, and how it lies there.
    sources: Vec<(usize, Similarity<3>)>,
    /// Whether each is held where it is by what is not shown.
    is_held: Vec<bool>,
    /// How much larger than elements their colliders are, so that what touches keeps the gap that it has in the exemplar.
    larger: f64,
    /// Whether the exemplar is a heap, of which most elements touch others.
    is_heap: bool,
    surroundings: Surroundings,
    gravity: Vector<3>,
    /// The mesh towards which elements fall, where they do.
    ground: Option<MeshIndex>,
    params: PhysicsParams,
    /// Steps after each iteration.
    substeps: usize,
    /// What went wrong in an iteration first.
    trouble: Mutex<Option<Warning>>,
}

impl Physical {
    /// What `job` asks for, whose place and border rule are known; `None` where it asks for no physics.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for what physics cannot do, [`Error::Parameter`] for numbers out of range, [`Error::Input`] for meshes without
    /// a volume.
    pub(super) fn new(
        job: &mut Space,
        (bodies, stacks): (Option<&Bodies>, Option<&Stacks>),
        request: &EngineRequest<3>,
        context: &mut RunContext<'_>,
    ) -> Result<Option<Arc<Self>>> {
        let Some(physics) = job.asked_physics()? else { return Ok(None) };
        let Some(bodies) = bodies else {
            return Err(unsupported("physics for points and curves", "give a scene of meshes, or leave it out"));
        };
        if job.params.engine_params()?.deform != Deform::Rigid {
            return Err(unsupported("physics for elements that bend", "leave out deform or physics"));
        }
        let mut params = PhysicsParams::default();
        if let Some(friction) = job.friction {
            params.set("friction", &friction.to_string())?;
        }
        let scene = &bodies.scene;
        let budget = context.budget().stage("preparing physics");
        let mut shapes = BTreeMap::new();
        for k in scene.nodes.iter().map(|node| node.mesh) {
            if let Entry::Vacant(entry) = shapes.entry(k) {
                let called = format!("{}: mesh {k} {}", context.exemplar_name(), scene.meshes[k].name);
                entry.insert(Arc::new(Shape::new(&scene.meshes[k].mesh, called.trim_end(), &budget)?));
            }
        }
        context.warnings.extend(shapes.values().filter_map(|shape| shape.warning().cloned()));
        let gravity = gravity(job)?;
        let ground = match &mut job.on {
            Some(on) if gravity.is_none() => Some(indexed_mesh(on, context.files)?.0),
            _ => None,
        };
        let sources: Vec<_> = scene.nodes.iter().map(|node| (node.mesh, node.transform)).collect();
        let body = |(mesh, pose): &(usize, Similarity<3>)| Body {
            pose: *pose,
            shape: Arc::clone(&shapes[mesh]),
            frozen: false,
            gravity: None,
        };
        let gap = clearance(&sources.iter().map(body).collect::<Vec<_>>(), &budget)?;
        let (larger, is_heap) = (1.0 + gap.unwrap_or(0.0), gap.is_some());
        let mut half: Vec<f64> = sources.iter().map(|(mesh, pose)| 0.5 * shapes[mesh].size() * pose.scale).collect();
        half.sort_by(f64::total_cmp);
        let gap = (larger - 1.0) * half.get(half.len() / 2).copied().unwrap_or(0.0);
        let surroundings = surroundings(job, request, (gap, context))?;
        if surroundings.middles.is_some() && request.ground.is_none() {
            let message = "physics in a box without a floor: elements at its bottom lie with their middles on it";
            context
                .warnings
                .push(Warning::new(message, "give --floor, so that they lie on a floor as those of the exemplar do"));
        }
        let substeps = if let Physics::Substeps(count) = physics { count } else { 0 };
        let is_held = (0..sources.len()).map(|k| stacks.is_some_and(|stacks| stacks.is_held(k))).collect();
        Ok(Some(Arc::new(Self {
            shapes,
            sources,
            is_held,
            surroundings,
            larger,
            is_heap,
            gravity: if ground.is_some() { Vector::ZERO } else { gravity.unwrap_or_else(|| down(job)) },
            ground,
            params,
            substeps,
            trouble: Mutex::new(None),
        })))
    }

    /// What the engine calls after each iteration, if anything.
    pub(super) fn between(self: &Arc<Self>) -> Option<Arc<dyn Between<3>>> {
        (self.substeps > 0).then(|| Arc::clone(self) as Arc<dyn Between<3>>)
    }

    /// Lets everything come to rest.
    ///
    /// # Errors
    /// Where the scene is too wide for physics.
    pub(super) fn settle(&self, outcome: &mut Outcome<3>, budget: &Budget) -> Result<PhysicsSummary> {
        let given = outcome.placements.clone();
        let budget = budget.stage("settling");
        let mut run = self.rest(&mut outcome.placements, &self.surroundings, &budget)?;
        let (open, before) = (self.open_above(), outcome.placements.len());
        for _ in 0..if self.is_heap { REFILLS } else { 0 } {
            let most = (MORE * given.len() as f64) as usize + given.len();
            let room = most.min(budget.limits().output_elements).saturating_sub(outcome.placements.len());
            let more = self.sunk(&given, &outcome.placements, room, &budget)?;
            if run.stopped != StopReason::Finished || more.is_empty() {
                break;
            }
            outcome.placements.extend(more);
            let again = self.rest(&mut outcome.placements, open.as_ref().unwrap_or(&self.surroundings), &budget)?;
            run = Run { steps: run.steps + again.steps, before: run.before, ..again };
        }
        // A heap that goes on beyond the box: its upper side cuts it, as the others do.
        if let Some(bounds) = self.surroundings.middles.filter(|_| outcome.placements.len() > before) {
            let stays = |(place, size): (Vector<3>, f64)| bounds.grown(SLACK * size).contains(place);
            outcome.placements.retain(|p| p.frozen.is_some() || stays(self.middle(p)));
        }
        if let Ok(mut trouble) = self.trouble.lock() {
            outcome.warnings.extend(trouble.take());
        }
        outcome.warnings.extend(run.warnings.iter().cloned());
        if run.stopped != StopReason::Finished {
            outcome.stopped = run.stopped;
        }
        Ok(summary(&run))
    }

    /// What is around a heap whose box is open above, so that what is filled in falls onto it from there; `None` where nothing is open.
    fn open_above(&self) -> Option<Surroundings> {
        let mut bounds = self.surroundings.middles?;
        let size = self.sources.iter().map(|(mesh, own)| self.shapes[mesh].size() * own.scale).fold(0.0, f64::max);
        for (k, down) in self.gravity.0.into_iter().enumerate() {
            let higher = ABOVE * size * down.abs().min(1.0);
            if down < 0.0 {
                bounds.max[k] += higher;
            } else {
                bounds.min[k] -= higher;
            }
        }
        Some(Surroundings { middles: Some(bounds), ..self.surroundings.clone() })
    }

    /// Middle and size of an element.
    fn middle(&self, placement: &Placement<3>) -> (Vector<3>, f64) {
        let (mesh, own) = &self.sources[placement.source];
        let (pose, shape) = (placement.transform.after(own), &self.shapes[mesh]);
        (pose.apply(shape.centre()), shape.size() * pose.scale * self.larger)
    }

    /// Steps until everything is at rest.
    fn rest(&self, placements: &mut [Placement<3>], around: &Surroundings, budget: &Budget) -> Result<Run> {
        let mut world = self.world(placements, around)?;
        let run = world.settle(budget)?;
        self.take_over(&world, placements);
        Ok(run)
    }

    /// Elements again that were at places where there is room for them now, since the heap has sunk, or higher where it is open above: at
    /// most `room`.
    fn sunk(
        &self,
        given: &[Placement<3>],
        placements: &[Placement<3>],
        room: usize,
        budget: &Budget,
    ) -> Result<Vec<Placement<3>>> {
        let mut all: Vec<(Vector<3>, f64)> = placements.iter().map(|p| self.middle(p)).collect();
        let largest = all.iter().map(|(_, size)| *size).fold(0.0, f64::max);
        let bounds = Bounds::around(all.iter().map(|(p, _)| *p).chain(given.iter().map(|p| self.middle(p).0)));
        let bounds = bounds.grown(LIFTS[LIFTS.len() - 1] * largest);
        let (up, open) = (self.gravity.unit_or_zero() * -1.0, self.open_above().and_then(|around| around.middles));
        let lifts = if self.surroundings.middles.is_some() { &LIFTS[..] } else { &LIFTS[..1] };
        let mut near = Buckets::new(&Domain::Box(bounds), largest, largest);
        (0..).zip(&all).for_each(|(k, (p, _))| near.insert(k, *p));
        let mut found = Vec::new();
        let movable = || given.iter().filter(|placement| placement.frozen.is_none());
        for (placement, lift) in lifts.iter().flat_map(|lift| movable().map(move |placement| (placement, lift))) {
            budget.spend(PER_PLACE)?;
            if found.len() >= room {
                break;
            }
            let (place, size) = self.middle(placement);
            let lift = up * (lift * size);
            let place = place + lift;
            let mut is_free = open.is_none_or(|open| open.contains(place));
            near.near(place, largest, |k| {
                let (p, other) = all[k as usize];
                is_free &= (p - place).norm() >= FREE * 0.5 * (size + other);
            });
            if is_free {
                near.insert(all.len() as u32, place);
                all.push((place, size));
                let transform = Similarity::shift(lift).after(&placement.transform);
                found.push(Placement { transform, ..placement.clone() });
            }
        }
        Ok(found)
    }

    fn world(&self, placements: &[Placement<3>], around: &Surroundings) -> Result<World> {
        let mut world = World::new(around.clone(), self.gravity, &self.params)?;
        let body = |placement: &Placement<3>| {
            let (mesh, own) = &self.sources[placement.source];
            let shape = Arc::clone(&self.shapes[mesh]);
            let pose = placement.transform.after(own);
            let towards = |ground: &MeshIndex| -ground.closest(pose.apply(shape.centre())).normal;
            let gravity = self.ground.as_ref().map(towards);
            let pose = pose.after(&resized(&shape, self.larger));
            let frozen = placement.frozen.is_some() || self.is_held[placement.source];
            Body { pose, shape, frozen, gravity }
        };
        world.place(placements.iter().map(body).collect())?;
        Ok(world)
    }

    /// Places that physics did not change stay as they are, to the last bit.
    fn take_over(&self, world: &World, placements: &mut [Placement<3>]) {
        for (placement, body) in placements.iter_mut().zip(world.bodies()) {
            let own = &self.sources[placement.source].1;
            let before = placement.transform.after(own).after(&resized(&body.shape, self.larger));
            if !body.frozen && body.pose != before {
                let pose = body.pose.after(&resized(&body.shape, 1.0 / self.larger));
                placement.transform = pose.after(&own.inverse());
            }
        }
    }
}

impl Between<3> for Physical {
    fn step(&self, placements: &mut [Placement<3>], budget: &Budget) -> Result<()> {
        let mut world = self.world(placements, &self.surroundings)?;
        let run = world.substeps(self.substeps, budget)?;
        if run.stopped != StopReason::Finished {
            // The run tells that it ended; the account tells why.
            budget.spend(0)?;
        }
        self.take_over(&world, placements);
        if let (Some(warning), Ok(mut trouble)) = (run.warnings.into_iter().next(), self.trouble.lock()) {
            trouble.get_or_insert(warning);
        }
        Ok(())
    }
}

fn unsupported(what: &str, advice: &str) -> Error {
    Error::Unsupported { what: what.into(), advice: advice.into() }
}

/// Straight down, as strong as on earth.
fn down(job: &Space) -> Vector<3> {
    Vector(std::array::from_fn(|k| if k == job.up.axis() { -1.0 } else { 0.0 }))
}

fn gravity(job: &Space) -> Result<Option<Vector<3>>> {
    let Some(given) = job.gravity.map(Vector) else { return Ok(None) };
    if given.is_finite() && given.norm() <= STRONGEST {
        return Ok(Some(given));
    }
    let expected = format!("three numbers, together no longer than {STRONGEST}");
    Err(Error::parameter("gravity", given.0.map(|x| x.to_string()).join(","), expected))
}

/// What makes a body larger about its middle.
fn resized(shape: &Shape, factor: f64) -> Similarity<3> {
    Similarity::about(shape.centre(), shape.centre(), Matrix::identity(), factor)
}

/// Walls, floors and containers at the place of the job. The floor is lower by the gap that is around elements.
fn surroundings(
    job: &mut Space,
    request: &EngineRequest<3>,
    (gap, context): (f64, &RunContext<'_>),
) -> Result<Surroundings> {
    let (border, bounds) = (request.border, request.domain.bounds());
    let mut around = Surroundings::default();
    if let Some(inside) = &mut job.inside {
        if border != Border::Inside {
            return Err(unsupported(
                &format!("physics inside a mesh with border {}", border.name()),
                "use border inside, for which the mesh is a container, or leave physics out",
            ));
        }
        around.surfaces.push(Surface { mesh: mesh(inside, context.files)?.0, side: Side::Inside });
    } else if let Some(on) = &mut job.on {
        around.surfaces.push(Surface { mesh: mesh(on, context.files)?.0, side: Side::Outside });
        return Ok(around);
    } else if let Some(along) = &job.along {
        let what = format!("physics in a tube along {}", along.name());
        return Err(unsupported(&what, "fill a mesh of the tube with --inside, or leave physics out"));
    } else if !job.avoid.is_empty() {
        return Err(unsupported("physics together with avoid", "leave one of them out"));
    } else if border == Border::Inside {
        around = around.inside_box(&bounds);
    } else {
        around.middles = Some(bounds);
    }
    Ok(if request.ground.is_some() { around.floor(job.up.axis(), bounds.min[job.up.axis()] - gap) } else { around })
}

fn summary(run: &Run) -> PhysicsSummary {
    PhysicsSummary {
        steps: run.steps,
        overlaps_before: run.before.overlaps,
        overlaps: run.after.overlaps,
        deepest_before: run.before.deepest,
        deepest: run.after.deepest,
        floating_before: run.before.floating,
        floating: run.after.floating,
    }
}
