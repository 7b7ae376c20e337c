//! Bodies, and the steps that move them.

use std::sync::Arc;

use arabesque_core::{Bounds, Budget, Error, Result, Similarity, StopReason, Vector, Warning};
use rapier3d::{
    math::{Pose, Vector as Vec3},
    parry::shape::SharedShape,
    prelude::{ColliderBuilder, PhysicsWorld, RigidBodyBuilder, RigidBodyHandle},
};

use crate::{
    figures::Figures,
    params::PhysicsParams,
    shape::Shape,
    surroundings::Surroundings,
    units::{Units, vec3},
};

/// Acceleration of gravity of length 1, in sizes of an element per second squared.
const GRAVITY: f32 = 10.0;
/// Work of one body in one step, in units of the budget.
const STEP: u64 = 5_000;
/// Steps at rest in a row after which a run ends.
const STILL: usize = 10;

/// One element.
#[derive(Clone, Debug)]
pub struct Body {
    /// What it looks like.
    pub shape: Arc<Shape>,
    /// From coordinates of its mesh to the scene.
    pub pose: Similarity<3>,
    /// It stays where it is to the last bit.
    pub frozen: bool,
}

/// What a run did.
#[derive(Clone, Debug)]
pub struct Run {
    /// Steps that were made.
    pub steps: usize,
    /// Before the first.
    pub before: Figures,
    /// After the last.
    pub after: Figures,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// Why it ended.
    pub stopped: StopReason,
}

/// Elements and what is around them.
#[derive(Clone, Debug)]
pub struct World {
    bodies: Vec<Body>,
    surroundings: Surroundings,
    gravity: Vector<3>,
    params: PhysicsParams,
}

impl World {
    /// A world without bodies. `gravity` is the direction in which things fall; its length is relative, 1 suits piles, and with none bodies
    /// only push one another apart.
    ///
    /// # Errors
    /// Where the surroundings or gravity are not numbers.
    pub fn new(surroundings: Surroundings, gravity: Vector<3>, params: &PhysicsParams) -> Result<Self> {
        surroundings.check()?;
        if !gravity.is_finite() {
            return Err(Error::parameter("gravity", format!("{:?}", gravity.0), "three finite numbers"));
        }
        Ok(Self { bodies: Vec::new(), surroundings, gravity, params: params.clone() })
    }

    /// Puts these bodies in place of those that were there.
    ///
    /// # Errors
    /// [`Error::Input`] where a pose is not a similarity of finite numbers.
    pub fn place(&mut self, bodies: Vec<Body>) -> Result<()> {
        for (k, body) in bodies.iter().enumerate() {
            let [x, y, z] = body.pose.rotation.transpose().0.map(Vector);
            let off = [x.dot(y), y.dot(z), z.dot(x), x.norm() - 1.0, y.norm() - 1.0, x.cross(y).dot(z) - 1.0];
            let scale = body.pose.scale;
            let sound = off.iter().all(|e| e.abs() < 1e-3) && body.pose.translation.is_finite();
            if !(sound && scale > 0.0 && scale.is_finite()) {
                let problem = "its pose is not a rotation, a positive scale and a finite place";
                return Err(Error::input(
                    format!("element {}", k + 1),
                    problem,
                    "give it one, without mirroring or shear",
                ));
            }
        }
        self.bodies = bodies;
        Ok(())
    }

    /// The bodies, in the order in which they were placed.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// `count` small steps from rest, in which no body moves farther than [`PhysicsParams::reach`]: for between iterations.
    ///
    /// # Errors
    /// Where the scene cannot be computed with. A stop or limit is no error: the run tells it.
    pub fn substeps(&mut self, count: usize, budget: &Budget) -> Result<Run> {
        self.run(count, Some(self.params.reach), budget)
    }

    /// Steps until all is at rest, at most [`PhysicsParams::steps`].
    ///
    /// # Errors
    /// As [`World::substeps`].
    pub fn settle(&mut self, budget: &Budget) -> Result<Run> {
        self.run(self.params.steps, None, budget)
    }

    fn run(&mut self, count: usize, reach: Option<f64>, budget: &Budget) -> Result<Run> {
        let empty = Figures::default();
        let mut run =
            Run { steps: 0, before: empty, after: empty, warnings: Vec::new(), stopped: StopReason::Finished };
        if self.bodies.is_empty() {
            return Ok(run);
        }
        let mut scene = Scene::new(self)?;
        run.before = scene.figures();
        let mut still = 0;
        while run.steps < count && still < STILL {
            if let Err(error) = budget.spend(STEP * self.bodies.len() as u64) {
                let stopped = matches!(error, Error::Stopped { .. });
                run.stopped = if stopped { StopReason::Stopped } else { StopReason::Limit };
                run.warnings.push(Warning::new(error.to_string(), "what is there lies as it did when it ended"));
                break;
            }
            let fastest = scene.step(self, reach);
            run.steps += 1;
            still = if f64::from(fastest) < self.params.rest && reach.is_none() { still + 1 } else { 0 };
        }
        if reach.is_none() && run.steps == count && still < STILL {
            let advice = "raise steps, or let things begin closer to where they will lie";
            run.warnings.push(Warning::new(format!("not everything was at rest after {count} steps"), advice));
        }
        let lost = scene.lost.iter().filter(|lost| **lost).count();
        if lost > 0 {
            let advice = "give them a floor or walls, or place them farther apart";
            run.warnings.push(Warning::new(format!("{lost} elements left the scene and were put back"), advice));
        }
        run.after = scene.figures();
        for (k, body) in self.bodies.iter_mut().enumerate() {
            let after = scene.pose(k);
            if !body.frozen && !scene.lost[k] {
                body.pose = scene.units.pose_back(&body.pose, body.shape.centre(), (&scene.start[k], &after));
            }
        }
        Ok(run)
    }
}

/// The sets of the solver for one run.
struct Scene {
    world: PhysicsWorld,
    handles: Vec<RigidBodyHandle>,
    start: Vec<Pose>,
    sizes: Vec<f32>,
    lost: Vec<bool>,
    units: Units,
    /// How far a body may get from where it was, in units.
    bound: f32,
}

impl Scene {
    fn new(world: &World) -> Result<Self> {
        let places = world.bodies.iter().map(|b| b.pose.apply(b.shape.centre()));
        let bounds = Bounds::around(places);
        let mut sizes: Vec<_> = world.bodies.iter().map(|b| b.shape.size() * b.pose.scale).collect();
        let own = sizes.clone();
        sizes.sort_unstable_by(f64::total_cmp);
        let unit = sizes[sizes.len() / 2];
        let units = Units::new(&bounds, unit)?;
        let mut inner = PhysicsWorld::new();
        inner.gravity = vec3(world.gravity) * GRAVITY;
        let mut scene = Self {
            world: inner,
            handles: Vec::new(),
            start: Vec::new(),
            sizes: own.iter().map(|size| (size / unit) as f32).collect(),
            lost: vec![false; world.bodies.len()],
            units,
            bound: (2.0 * bounds.size().norm() / unit) as f32 + 50.0,
        };
        scene.surround(world);
        for (k, body) in world.bodies.iter().enumerate() {
            scene.insert(world, k, body)?;
        }
        // With no time to pass, contacts are found and nothing moves.
        scene.world.integration_parameters.dt = 0.0;
        scene.world.step();
        scene.world.integration_parameters.dt = 1.0 / 60.0;
        Ok(scene)
    }

    fn surround(&mut self, world: &World) {
        let friction = world.params.friction as f32;
        for wall in &world.surroundings.walls {
            let shape = SharedShape::halfspace(vec3(wall.normal.unit()));
            let collider = ColliderBuilder::new(shape).translation(self.units.place(wall.place)).friction(friction);
            self.world.colliders.insert(collider);
        }
        for mesh in &world.surroundings.surfaces {
            let points = mesh.positions.iter().map(|&p| self.units.place(p)).collect();
            if let Ok(shape) = SharedShape::trimesh(points, mesh.triangles.clone()) {
                self.world.colliders.insert(ColliderBuilder::new(shape).friction(friction));
            }
        }
    }

    fn insert(&mut self, world: &World, k: usize, body: &Body) -> Result<()> {
        let pose = self.units.pose(&body.pose, body.shape.centre());
        let Some(shape) = body.shape.scaled(body.pose.scale / self.units.length()) else {
            let problem = "its scale is too small or too large beside the others";
            return Err(Error::input(format!("element {}", k + 1), problem, "make the elements more alike in size"));
        };
        let kind = if body.frozen { RigidBodyBuilder::fixed() } else { RigidBodyBuilder::dynamic() };
        let handle = self.world.insert_body(kind.pose(pose).linear_damping(2.0).angular_damping(4.0));
        let mass = self.sizes[k].powi(3).clamp(0.05, 20.0);
        let collider = ColliderBuilder::new(shape).mass(mass).friction(world.params.friction as f32).restitution(0.0);
        self.world.insert_collider(collider, Some(handle));
        self.handles.push(handle);
        self.start.push(pose);
        Ok(())
    }

    fn pose(&self, k: usize) -> Pose {
        *self.world.bodies[self.handles[k]].position()
    }

    fn figures(&self) -> Figures {
        Figures::of(&self.world.narrow_phase, &self.world.colliders, self.units.length())
    }

    /// One step; the speed of the fastest body, relative to its size.
    fn step(&mut self, world: &World, reach: Option<f64>) -> f32 {
        self.world.step();
        let mut fastest = 0.0_f32;
        for (k, _) in world.bodies.iter().enumerate().filter(|(_, body)| !body.frozen) {
            if self.lost[k] {
                continue;
            }
            let (start, size) = (self.start[k], self.sizes[k]);
            let rigid = &mut self.world.bodies[self.handles[k]];
            let shift = rigid.translation() - start.translation;
            if !rigid.is_enabled() || !rigid.position().is_finite() || shift.length() > self.bound {
                self.lost[k] = true;
                rigid.set_enabled(false);
                continue;
            }
            fastest = fastest.max(rigid.linvel().length() / size);
            let most = reach.map_or(f32::INFINITY, |reach| reach as f32 * size);
            if shift.length() > most {
                rigid.set_translation(start.translation + shift * (most / shift.length()), true);
                rigid.set_linvel(Vec3::ZERO, true);
            }
        }
        fastest
    }
}

#[cfg(test)]
#[path = "world_tests.rs"]
mod tests;
