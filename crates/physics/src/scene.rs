//! The sets of the solver for one run.

use arabesque_core::{Bounds, Error, Result};
use rapier3d::{
    math::{Pose, Vector as Vec3},
    parry::shape::SharedShape,
    prelude::{
        ColliderBuilder, Group, InteractionGroups, InteractionTestMode, PhysicsWorld, RigidBodyBuilder, RigidBodyHandle,
    },
};

use crate::{
    figures::{Figures, Hold},
    guard::Guard,
    params::PhysicsParams,
    setting::{Body, Setting},
    units::{Units, vec3},
};

/// Acceleration of gravity of length 1, in sizes of an element per second squared.
const GRAVITY: f32 = 10.0;
/// Speed, in sizes per second, that nothing reaches but what bursts apart: falls are damped to a tenth of it.
const BURST: f32 = 100.0;

/// Radius of the ball in the middle of a body that touches the walls around middles.
const CORE: f32 = 0.25;
/// What touches what: bodies touch one another and what is around them, cores touch the walls around middles alone.
const BODIES: Group = Group::GROUP_1;
const CORES: Group = Group::GROUP_2;
const WALLS: Group = Group::GROUP_3;

/// How far a body may get in one call of substeps.
#[derive(Clone, Copy)]
pub(crate) struct Reach {
    /// In sizes.
    shift: f32,
    /// In radians.
    turn: f32,
}

impl Reach {
    pub(crate) fn of(params: &PhysicsParams) -> Self {
        Self { shift: params.reach as f32, turn: params.turn.to_radians() as f32 }
    }
}

pub(crate) struct Scene {
    world: PhysicsWorld,
    handles: Vec<RigidBodyHandle>,
    guards: Vec<Guard>,
    /// Where bodies were given.
    pub(crate) given: Vec<Pose>,
    /// Where they began: pushed to the right side of surfaces.
    begun: Vec<Pose>,
    /// Where they were when all was last well.
    kept: Vec<Pose>,
    sizes: Vec<f32>,
    inradii: Vec<f32>,
    downs: Vec<Vec3>,
    is_frozen: Vec<bool>,
    /// Bodies that the solver lost.
    pub(crate) lost: Vec<bool>,
    pub(crate) units: Units,
    /// How far a body may get from where it was, in units.
    bound: f32,
    middles: Option<[Vec3; 2]>,
}

impl Scene {
    pub(crate) fn new(setting: &Setting) -> Result<Self> {
        let bodies = &setting.bodies;
        let places = bodies.iter().map(|b| b.pose.apply(b.shape.centre()));
        let bounds = Bounds::around(places);
        let own: Vec<_> = bodies.iter().map(|b| b.shape.size() * b.pose.scale).collect();
        let mut sizes = own.clone();
        sizes.sort_unstable_by(f64::total_cmp);
        let unit = sizes[sizes.len() / 2];
        let units = Units::new(&bounds, unit)?;
        let mut inner = PhysicsWorld::new();
        inner.gravity = Vec3::ZERO;
        let mut scene = Self {
            world: inner,
            handles: Vec::new(),
            guards: Vec::new(),
            given: Vec::new(),
            begun: Vec::new(),
            kept: Vec::new(),
            sizes: own.iter().map(|size| (size / unit) as f32).collect(),
            inradii: bodies.iter().map(|b| (b.shape.inradius() * b.pose.scale / unit) as f32).collect(),
            downs: bodies.iter().map(|b| vec3(b.gravity.unwrap_or(setting.gravity))).collect(),
            is_frozen: bodies.iter().map(|b| b.frozen).collect(),
            lost: vec![false; bodies.len()],
            units,
            bound: (2.0 * bounds.size().norm() / unit) as f32 + 50.0,
            middles: setting.surroundings.middles.map(|b| [units.place(b.min), units.place(b.max)]),
        };
        scene.surround(setting)?;
        for (k, body) in bodies.iter().enumerate() {
            scene.insert(setting, k, body)?;
        }
        scene.kept.clone_from(&scene.begun);
        // With no time to pass, contacts are found and nothing moves.
        scene.world.integration_parameters.dt = 0.0;
        scene.world.step();
        scene.world.integration_parameters.dt = 1.0 / 60.0;
        Ok(scene)
    }

    fn surround(&mut self, setting: &Setting) -> Result<()> {
        let friction = setting.params.friction as f32;
        for wall in &setting.surroundings.walls {
            let shape = SharedShape::halfspace(vec3(wall.normal.unit()));
            let collider = ColliderBuilder::new(shape).translation(self.units.place(wall.place)).friction(friction);
            self.world.colliders.insert(collider);
        }
        for (k, surface) in setting.surroundings.surfaces.iter().enumerate() {
            let guard = Guard::new(k + 1, surface, &self.units)?;
            self.world.colliders.insert(ColliderBuilder::new(guard.shape.clone()).friction(friction));
            self.guards.push(guard);
        }
        let Some([low, high]) = self.middles else { return Ok(()) };
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for (normal, corner) in [(axis, low), (-axis, high)] {
                let collider = ColliderBuilder::new(SharedShape::halfspace(normal))
                    .translation(corner - normal * CORE)
                    .friction(friction)
                    .collision_groups(InteractionGroups::new(WALLS, CORES, InteractionTestMode::And));
                self.world.colliders.insert(collider);
            }
        }
        Ok(())
    }

    fn insert(&mut self, setting: &Setting, k: usize, body: &Body) -> Result<()> {
        let given = self.units.pose(&body.pose, body.shape.centre());
        let Some(shape) = body.shape.scaled(body.pose.scale / self.units.length()) else {
            let problem = "its scale is too small or too large beside the others";
            return Err(Error::input(format!("element {}", k + 1), problem, "make the elements more alike in size"));
        };
        let begun = if body.frozen { given } else { self.right_side(k, given) };
        let kind = if body.frozen { RigidBodyBuilder::fixed() } else { RigidBodyBuilder::dynamic() };
        let handle = self.world.insert_body(kind.pose(begun).linear_damping(2.0).angular_damping(4.0));
        let user_data = if body.frozen { 0 } else { k as u128 + 1 };
        let mass = self.sizes[k].powi(3).clamp(0.05, 20.0);
        let collider = ColliderBuilder::new(shape)
            .mass(mass)
            .friction(setting.params.friction as f32)
            .restitution(0.0)
            .collision_groups(InteractionGroups::new(BODIES, !(CORES | WALLS), InteractionTestMode::And))
            .user_data(user_data);
        self.world.insert_collider(collider, Some(handle));
        if self.middles.is_some() {
            let core = ColliderBuilder::ball(CORE)
                .density(0.0)
                .friction(setting.params.friction as f32)
                .collision_groups(InteractionGroups::new(CORES, WALLS, InteractionTestMode::And))
                .user_data(user_data);
            self.world.insert_collider(core, Some(handle));
        }
        if !body.frozen {
            self.world.bodies[handle].add_force(self.downs[k] * (GRAVITY * mass), true);
        }
        self.handles.push(handle);
        self.given.push(given);
        self.begun.push(begun);
        Ok(())
    }

    /// A pose with its middle on the right side of every surface.
    fn right_side(&self, k: usize, mut pose: Pose) -> Pose {
        for guard in &self.guards {
            if let Some(place) = guard.back(pose.translation, self.inradii[k]) {
                pose.translation = place;
            }
        }
        self.within(pose)
    }

    /// A pose with its middle in the box for middles.
    fn within(&self, mut pose: Pose) -> Pose {
        if let Some([low, high]) = self.middles {
            pose.translation = pose.translation.clamp(low, high);
        }
        pose
    }

    pub(crate) fn pose(&self, k: usize) -> Pose {
        *self.world.bodies[self.handles[k]].position()
    }

    pub(crate) fn figures(&self) -> Figures {
        let hold = |k: usize| {
            let down = self.downs[k].try_normalize().unwrap_or(Vec3::ZERO);
            Hold { down, is_held: self.is_frozen[k] }
        };
        let holds: Vec<_> = (0..self.handles.len()).map(hold).collect();
        Figures::of(&self.world.narrow_phase, &self.world.colliders, self.units.length(), &holds)
    }

    /// One step; the speed of the fastest body, relative to its size. `None` where all burst apart.
    pub(crate) fn step(&mut self, reach: Option<Reach>) -> Option<f32> {
        self.world.step();
        let mut fastest = 0.0_f32;
        for k in 0..self.handles.len() {
            if self.is_frozen[k] || self.lost[k] {
                continue;
            }
            let (begun, size) = (self.begun[k], self.sizes[k]);
            let rigid = &mut self.world.bodies[self.handles[k]];
            let shift = rigid.translation() - begun.translation;
            if !rigid.is_enabled() || !rigid.position().is_finite() || shift.length() > self.bound {
                self.lost[k] = true;
                rigid.set_enabled(false);
                continue;
            }
            fastest = fastest.max(rigid.linvel().length() / size);
            let Some(reach) = reach else { continue };
            if shift.length() > reach.shift * size {
                rigid.set_translation(begun.translation + shift * (reach.shift * size / shift.length()), true);
                rigid.set_linvel(Vec3::ZERO, true);
            }
            let angle = begun.rotation.angle_between(*rigid.rotation());
            if angle > reach.turn {
                rigid.set_rotation(begun.rotation.slerp(*rigid.rotation(), reach.turn / angle).normalize(), true);
                rigid.set_angvel(Vec3::ZERO, true);
            }
        }
        (fastest < BURST).then_some(fastest)
    }

    /// Remembers where everything is.
    pub(crate) fn keep(&mut self) {
        self.kept = (0..self.handles.len()).map(|k| self.pose(k)).collect();
    }

    /// Puts everything back to where it was last kept.
    pub(crate) fn restore(&mut self) {
        for (handle, pose) in self.handles.iter().zip(&self.kept) {
            self.world.bodies[*handle].set_position(*pose, true);
        }
    }

    /// Puts everything back to where it began.
    pub(crate) fn restart(&mut self) {
        self.kept.clone_from(&self.begun);
        self.restore();
    }

    /// Puts what came through a surface back to where it began. Returns how many there were.
    pub(crate) fn put_back(&mut self) -> usize {
        let strayed = |&k: &usize| {
            let place = self.pose(k).translation;
            !self.is_frozen[k] && !self.lost[k] && self.guards.iter().any(|guard| guard.back(place, 0.0).is_some())
        };
        let strayed: Vec<_> = (0..self.handles.len()).filter(strayed).collect();
        for &k in &strayed {
            self.world.bodies[self.handles[k]].set_position(self.begun[k], true);
        }
        strayed.len()
    }

    /// Where a body ended that was not lost; else where it began.
    pub(crate) fn end(&self, k: usize) -> Pose {
        if self.lost[k] { self.begun[k] } else { self.pose(k) }
    }
}
