//! Global step: the points go where the matches want them [Roveri 2015 §5.1].
//!
//! Along the direction of [`super::newton`], with a step that is halved until the energy falls.

use arabesque_core::{Budget, Result, Similarity, Vector};

use super::apart::Crowd;
use super::newton::{System, direction, spin};
use crate::{
    energy::level::{Level, Matches, Near, Pull},
    exemplar::pattern::Pattern,
    output::state::Output,
};

/// Farthest that a point moves in one step, in units of `sigma`.
const FARTHEST: f64 = 0.7;
/// How often a step is halved before the points count as settled.
const HALVINGS: usize = 5;

/// What a step came to.
pub(crate) struct Moved {
    /// `T` after it; never higher than before, but where elements had to make way for each other.
    pub(crate) energy: f64,
    /// Mean movement of a point.
    pub(crate) distance: f64,
}

/// Moves the points once. `pulls` are those on the points as they are, before and after; `T` is `before`.
pub(crate) fn merge<const D: usize>(
    level: &Level<'_, D>,
    output: &mut Output<D>,
    near: &Near,
    matches: &Matches<D>,
    (pulls, before): (&mut Vec<Pull<D>>, f64),
    budget: &Budget,
) -> Result<Moved> {
    let crowd = Crowd::new(level, output, pulls, budget)?;
    let whole = before + crowd.energy();
    let system = System::new(level, output, near, (pulls, &crowd), budget)?;
    let mut moves = direction(output, near, &system, budget)?;
    for (i, v) in moves.iter_mut().enumerate() {
        let most = FARTHEST * level.tables.kernel.sigma * pulls[i].scale;
        let length = v.norm();
        if length > most {
            *v = *v * (most / length);
        }
    }
    let mut step = 1.0;
    for _ in 0..HALVINGS {
        let moved = moved(level.pattern, output, &moves, step);
        let next = level.pulls(&moved, near, matches, budget)?;
        let energy = level.energy(&moved, near, &next, matches, budget)?;
        if energy + Crowd::new(level, &moved, &next, budget)?.energy() < whole {
            let distance = moves.iter().map(|v| v.norm()).sum::<f64>() * step / moves.len().max(1) as f64;
            *output = moved;
            *pulls = next;
            return Ok(Moved { energy, distance });
        }
        step *= 0.4;
    }
    Ok(Moved { energy: before, distance: 0.0 })
}

/// The output with every point moved, rigid elements as a whole.
fn moved<const D: usize>(pattern: &Pattern<D>, output: &Output<D>, moves: &[Vector<D>], step: f64) -> Output<D> {
    let mut to = output.clone();
    for i in output.kept..to.places.len() {
        to.places[i] += moves[i] * step;
    }
    for b in 0..output.bodies.len() {
        let body = &output.bodies[b];
        if body.first < output.kept {
            continue;
        }
        let range = body.first..body.first + body.count;
        let n = 1.0 / body.count.max(1) as f64;
        let mean = |v: &[Vector<D>]| v.iter().fold(Vector::ZERO, |s, &p| s + p) * n;
        let centre = mean(&output.places[range.clone()]);
        let shift = mean(&moves[range.clone()]) * step;
        let spin = spin(&output.places[range.clone()], centre, &moves[range]);
        let mut turn = arabesque_core::Matrix::identity();
        let square = spin.compose(&spin);
        for r in 0..D {
            for c in 0..D {
                turn.0[r][c] += step * spin.0[r][c] + 0.5 * step * step * square.0[r][c];
            }
        }
        let turn = Similarity::about(centre, centre + shift, turn.nearest_rotation(), 1.0);
        let pose = turn.after(&body.pose);
        let rotation = pose.rotation.nearest_rotation();
        to.set_pose(pattern, b, Similarity { rotation, ..pose });
    }
    to
}
