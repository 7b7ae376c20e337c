//! Bodies, and the steps that move them.

use arabesque_core::{Budget, Error, Result, StopReason, Vector, Warning};

use crate::{
    figures::Figures,
    params::PhysicsParams,
    scene::{Reach, Scene},
    setting::{Body, Setting},
    surroundings::Surroundings,
};

/// Work of one body in one step, in units of the budget.
const STEP: u64 = 5_000;
/// Steps at rest in a row after which a run ends.
const STILL: usize = 10;
/// Steps after which a run remembers where everything is.
const KEPT: usize = 10;
/// Penetration of each element, in sizes, that a heap at rest may have beyond twice what there was.
const WORSE: f64 = 0.1;

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
    setting: Setting,
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
        Ok(Self { setting: Setting { bodies: Vec::new(), surroundings, gravity, params: params.clone() } })
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
            let finite = body.pose.translation.is_finite() && body.gravity.is_none_or(|g| g.is_finite());
            let sound = off.iter().all(|e| e.abs() < 1e-3) && finite;
            if !(sound && scale > 0.0 && scale.is_finite()) {
                let problem = "its pose is not a rotation, a positive scale and a finite place";
                return Err(Error::input(
                    format!("element {}", k + 1),
                    problem,
                    "give it one, without mirroring or shear",
                ));
            }
        }
        self.setting.bodies = bodies;
        Ok(())
    }

    /// The bodies, in the order in which they were placed.
    pub fn bodies(&self) -> &[Body] {
        &self.setting.bodies
    }

    /// `count` small steps from rest, in which no body moves farther than [`PhysicsParams::reach`] or turns by more than [`PhysicsParams::turn`]: for between iterations.
    ///
    /// # Errors
    /// Where the scene cannot be computed with. A stop or limit is no error: the run tells it.
    pub fn substeps(&mut self, count: usize, budget: &Budget) -> Result<Run> {
        self.run(count, Some(Reach::of(&self.setting.params)), budget)
    }

    /// Steps until all is at rest, at most [`PhysicsParams::steps`].
    ///
    /// # Errors
    /// As [`World::substeps`].
    pub fn settle(&mut self, budget: &Budget) -> Result<Run> {
        self.run(self.setting.params.steps, None, budget)
    }

    fn run(&mut self, count: usize, reach: Option<Reach>, budget: &Budget) -> Result<Run> {
        let empty = Figures::default();
        let mut run =
            Run { steps: 0, before: empty, after: empty, warnings: Vec::new(), stopped: StopReason::Finished };
        if self.setting.bodies.is_empty() {
            return Ok(run);
        }
        let mut scene = Scene::new(&self.setting)?;
        run.before = scene.figures();
        let mut still = 0;
        while run.steps < count && still < STILL {
            if let Err(error) = budget.spend(STEP * self.setting.bodies.len() as u64) {
                let stopped = matches!(error, Error::Stopped { .. });
                run.stopped = if stopped { StopReason::Stopped } else { StopReason::Limit };
                run.warnings.push(Warning::new(error.to_string(), "what is there lies as it did when it ended"));
                break;
            }
            let fastest = scene.step(reach);
            run.steps += 1;
            let Some(fastest) = fastest else {
                let advice = "what is there lies as it did shortly before; let things begin farther apart";
                run.warnings.push(Warning::new(format!("elements burst apart after {} steps", run.steps), advice));
                scene.restore();
                break;
            };
            if run.steps.is_multiple_of(KEPT) {
                scene.keep();
            }
            still = if f64::from(fastest) < self.setting.params.rest && reach.is_none() { still + 1 } else { 0 };
        }
        if reach.is_none() && run.steps == count && still < STILL {
            let advice = "raise steps, or let things begin closer to where they will lie";
            run.warnings.push(Warning::new(format!("not everything was at rest after {count} steps"), advice));
        }
        self.end(&mut scene, &mut run);
        if reach.is_none() {
            // The solver looks at contacts that hardly change now and then only.
            run.after = Scene::new(&self.setting)?.figures();
        }
        Ok(run)
    }

    /// Takes over what the solver made, as far as it is any better.
    fn end(&mut self, scene: &mut Scene, run: &mut Run) {
        let lost = scene.lost.iter().filter(|lost| **lost).count();
        if lost > 0 {
            let advice = "give them a floor or walls, or place them farther apart";
            run.warnings.push(Warning::new(format!("{lost} elements left the scene and were put back"), advice));
        }
        let strayed = scene.put_back();
        if strayed > 0 {
            let advice = "make the surface simpler, or the elements smaller beside it";
            run.warnings
                .push(Warning::new(format!("{strayed} elements came through a surface and were put back"), advice));
        }
        run.after = scene.figures();
        let most = 2.0 * run.before.total + WORSE * self.setting.bodies.len() as f64 * scene.units.length();
        if run.after.total > most {
            let advice =
                "everything lies as it did before them; let things begin farther apart, or give them more room";
            run.warnings.push(Warning::new("elements were in one another more deeply after the steps", advice));
            scene.restart();
            run.after = run.before;
        }
        for (k, body) in self.setting.bodies.iter_mut().enumerate().filter(|(_, body)| !body.frozen) {
            let after = scene.end(k);
            body.pose = scene.units.pose_back(&body.pose, body.shape.centre(), (&scene.given[k], &after));
        }
    }
}

#[cfg(test)]
#[path = "world_tests.rs"]
mod tests;
